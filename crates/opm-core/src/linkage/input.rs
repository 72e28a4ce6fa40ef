//! A linkage driven by one of its joints, and the resulting positions of the others.

use super::sections::{SectionInput, SectionSigns};
use super::traced::TracedInput;
use super::{Cycle, InputRange, Linkage, NoCycle, Solver};
use crate::mechanism::joint::JointCoordinate;
use std::fmt;

/// Which of a linkage's positions it is, for a value of its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LinkageBranch {
    /// The two choices of the loops of two sections.
    Signs(SectionSigns),
    /// The number of an arc of a traced loop, from 1: along an arc the input moves one way. Those of home's curve come first, in
    /// the order of its motion from home with the input growing.
    Arc(usize),
}

impl fmt::Display for LinkageBranch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Signs(signs) => signs.fmt(f),
            Self::Arc(number) => number.fmt(f),
        }
    }
}

/// A position of a linkage: the values of all its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// The branch of the position.
    pub branch: LinkageBranch,
    /// Every joint coordinate in radians or metres, in the order of [`Linkage::coordinates`]: the home
    /// value plus the displacement.
    pub joints: Vec<f64>,
    /// The value of the imaginary joint, radians or metres; of a loop that is traced there is none.
    pub imaginary: Option<f64>,
    /// Whether every joint is within its limits.
    pub within_limits: bool,
}

/// The rates of all joints for a unit rate of the input: the linkage's transmission ratios.
#[derive(Clone, Debug, PartialEq)]
pub struct Rates {
    /// The derivative of every joint coordinate by the input, in the order of [`Linkage::coordinates`].
    pub joints: Vec<f64>,
    /// The derivative of the imaginary joint by the input, if there is one.
    pub imaginary: Option<f64>,
}

/// A linkage driven by one of its joints.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    linkage: &'a Linkage,
    coordinate: usize,
    solver: InputSolver<'a>,
}

#[derive(Clone, Copy, Debug)]
enum InputSolver<'a> {
    Sections(SectionInput<'a>),
    Traced(TracedInput<'a>),
}

impl<'a> Input<'a> {
    pub(super) fn new(linkage: &'a Linkage, coordinate: usize) -> Option<Self> {
        let solver = match &linkage.solver {
            Solver::Sections(sections) => {
                InputSolver::Sections(sections.input(&linkage.joints, coordinate)?)
            }
            Solver::Traced(traced) => {
                InputSolver::Traced(TracedInput::new(traced, &linkage.joints, coordinate)?)
            }
        };
        Some(Self { linkage, coordinate, solver })
    }

    /// The input's joint coordinate.
    pub fn coordinate(&self) -> &'a JointCoordinate {
        &self.linkage.coordinates()[self.coordinate]
    }

    /// Every branch that there is for some value of the input.
    pub fn branches(&self) -> Vec<LinkageBranch> {
        match &self.solver {
            InputSolver::Sections(_) => SectionSigns::ALL.map(LinkageBranch::Signs).to_vec(),
            InputSolver::Traced(input) => (1..=input.count()).map(LinkageBranch::Arc).collect(),
        }
    }

    /// The branch in which the linkage is assembled.
    pub fn home_branch(&self) -> LinkageBranch {
        match &self.solver {
            InputSolver::Sections(input) => LinkageBranch::Signs(input.home_branch()),
            InputSolver::Traced(_) => LinkageBranch::Arc(1),
        }
    }

    /// The home position, which [`Input::position`] can overwrite.
    pub fn home(&self) -> Position {
        match &self.solver {
            InputSolver::Sections(input) => input.home(),
            InputSolver::Traced(_) => Position {
                branch: self.home_branch(),
                joints: self.linkage.joints.home(),
                imaginary: None,
                within_limits: true,
            },
        }
    }

    /// Every position with the input at `value`, radians or metres, with the home value included: none
    /// if the loop does not close. Angles are within π of home, unless limits
    /// require another revolution. Where links are folded, branches that meet are all listed.
    ///
    /// Coaxial joints count revolutions. With other numbers of revolutions, a linkage with screws has
    /// further positions without end; only those with home's are given, and an imaginary joint on the
    /// screws' axis is within π of home.
    pub fn solve(&self, value: f64) -> Vec<Position> {
        let solved = |branch| {
            let mut position = self.home();
            self.position(value, branch, &mut position).then_some(position)
        };
        self.branches().into_iter().filter_map(solved).collect()
    }

    /// Computes the position in one branch. Returns `false`, and leaves `position` unchanged, if the loop does not close.
    /// Positions of two sections are computed without allocation.
    #[inline]
    pub fn position(&self, value: f64, branch: LinkageBranch, position: &mut Position) -> bool {
        match (&self.solver, branch) {
            (InputSolver::Sections(input), LinkageBranch::Signs(signs)) => {
                input.position(value, signs, position)
            }
            (InputSolver::Traced(input), LinkageBranch::Arc(number)) => {
                input.position(value, number, position, false)
            }
            _ => false,
        }
    }

    /// As [`Input::position`], but every angle is the one nearest to its value in `position`,
    /// modulo 2π. Along a motion in small steps no angle jumps, not even to stay within its limits.
    #[inline]
    pub fn position_near(
        &self,
        value: f64,
        branch: LinkageBranch,
        position: &mut Position,
    ) -> bool {
        match (&self.solver, branch) {
            (InputSolver::Sections(input), LinkageBranch::Signs(signs)) => {
                input.position_near(value, signs, position)
            }
            (InputSolver::Traced(input), LinkageBranch::Arc(number)) => {
                input.position(value, number, position, true)
            }
            _ => false,
        }
    }

    /// The rates of all joints at a position, for a unit rate of the input. `None` at a dead point, where they are infinite or
    /// free.
    pub fn rates(&self, position: &Position) -> Option<Rates> {
        match &self.solver {
            InputSolver::Sections(input) => input.rates(position),
            InputSolver::Traced(input) => input.rates(position),
        }
    }

    /// The values of the input at which the loop closes in any branch.
    pub fn range(&self) -> InputRange {
        match &self.solver {
            InputSolver::Sections(input) => input.range(),
            InputSolver::Traced(input) => input.range(1..=input.count()),
        }
    }

    /// The values of the input at which the loop closes in a branch. Of two sections it is the first sign that counts: the two
    /// branches of the second choice end where they meet.
    pub fn branch_range(&self, branch: LinkageBranch) -> InputRange {
        match (&self.solver, branch) {
            (InputSolver::Sections(input), LinkageBranch::Signs(signs)) => {
                input.branch_range(signs.first)
            }
            (InputSolver::Traced(input), LinkageBranch::Arc(number)) => {
                input.range(number..=number)
            }
            _ => InputRange::Intervals { intervals: Vec::new(), period: None },
        }
    }

    /// The motion that starts at home with the input increasing, until the linkage is home again.
    ///
    /// # Errors
    /// The linkage goes to infinity instead.
    pub fn cycle(&self) -> Result<Cycle, NoCycle> {
        match &self.solver {
            InputSolver::Sections(input) => input.cycle(),
            InputSolver::Traced(input) => input.cycle(),
        }
    }
}
