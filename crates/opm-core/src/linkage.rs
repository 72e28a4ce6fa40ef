//! Position analysis of single loops that decompose: Bennett's double spherical 6R linkage (G. T.
//! Bennett, "The skew isogram mechanism", Proc. London Math. Soc. s2-13, 1914; Fig. 1 of the paper)
//! as an input-output linkage.
//!
//! Two legs close one loop, `L₁U₁ = L₂U₂`, where the lower parts turn about a centre `A` and the
//! upper parts about a centre `B`. Then
//!
//! ```text
//! L₂⁻¹ L₁ = U₂ U₁⁻¹ = exp(I τ)
//! ```
//!
//! lies in both groups of rotations: it is a rotation about the line of the two centres, the
//! imaginary joint. With three revolutes in each section the loop falls into two spherical
//! four-bars that share that joint,
//!
//! ```text
//! exp(-I τ) · L₂⁻¹ L₁ = 1      exp(-I τ) · U₂ U₁⁻¹ = 1
//! ```
//!
//! The one that has the input joint gives `τ`, from which the other follows: two two-valued choices,
//! so up to four positions an input. In these products a joint that is passed from its platform to
//! its base side has its axis reversed, so that its rotation is always what the joint reports.
//!
//! ```
//! use opm_core::linkage::Linkage;
//! use opm_core::mechanism::{examples, file};
//!
//! let text = examples::find("bennett-double-spherical-6r").unwrap().text;
//! let linkage = Linkage::new(file::read(text)?.mechanism)?;
//! let crank = linkage.input("a1").unwrap();
//! assert!(crank.range().is_full_turn());
//! for position in crank.solve(30_f64.to_radians()) {
//!     println!("{}: {:?}, tau = {}", position.branch, position.joints, position.imaginary);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cycle;
pub mod four_bar;
mod range;

pub use cycle::Cycle;
pub use range::InputRange;

use crate::chain::{Amount, Branch, ChainError, unit};
use crate::decomposition::{DecomposeError, Decomposition, Freedom, LegSplit, decompose};
use crate::joint::{JointCoordinate, JointKind};
use crate::leg::Leg;
use crate::limits::Limits;
use crate::manipulator::{ImaginaryJoint, Section};
use crate::mechanism::Mechanism;
use crate::task::{SubspaceKind, Task, TaskError};
use four_bar::FourBar;
use nalgebra::{Complex, Unit, Vector3};
use std::fmt;

/// Why a mechanism is not a linkage that this module covers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkageError {
    /// It does not decompose.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// It decomposes otherwise.
    #[error(
        "{0}; a linkage has two legs, with three revolute axes through each of two centres (two \
         spherical four-bars that share an imaginary joint)"
    )]
    NotCovered(Obstacle),
    /// Two neighbouring axes of a four-bar, the imaginary one among them, are parallel.
    #[error("the {section} four-bar has no closed form: {error}")]
    FourBar {
        /// Which.
        section: Section,
        /// Why.
        error: ChainError,
    },
    /// A home value for a coordinate that there is not.
    #[error(transparent)]
    Task(#[from] TaskError),
}

/// What a mechanism has instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Obstacle {
    /// More than one loop.
    #[error("{0} legs")]
    Legs(usize),
    /// Sections that are not spherical.
    #[error("a {lower} and a {upper} section")]
    Subspaces {
        /// The lower section's subspace.
        lower: &'static str,
        /// The upper section's subspace.
        upper: &'static str,
    },
    /// A loop of more or less than four.
    #[error("{count} joint freedoms in the {section} section")]
    Freedoms {
        /// Which section.
        section: Section,
        /// Of both legs together.
        count: usize,
    },
    /// A joint whose freedoms have no axes of their own.
    #[error("the spherical joint {0}")]
    Ball(String),
}

/// The signs of a position's two choices, in the order in which they are made: first the four-bar
/// that has the input joint, then the other one. `+` where the triple product of the three axes that
/// follow the input (or the imaginary joint) in its loop, with the directions that they have there,
/// is positive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinkageBranch {
    /// Of the four-bar that has the input.
    pub first: Branch,
    /// Of the other one.
    pub second: Branch,
}

impl LinkageBranch {
    /// All four, in the order `+ +`, `+ -`, `- +`, `- -`.
    pub const ALL: [Self; 4] = [
        Self { first: Branch::Plus, second: Branch::Plus },
        Self { first: Branch::Plus, second: Branch::Minus },
        Self { first: Branch::Minus, second: Branch::Plus },
        Self { first: Branch::Minus, second: Branch::Minus },
    ];
}

impl fmt::Display for LinkageBranch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = |branch| if branch == Branch::Plus { '+' } else { '-' };
        write!(f, "{} {}", sign(self.first), sign(self.second))
    }
}

/// Where all joints of a linkage are.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// In which branch.
    pub branch: LinkageBranch,
    /// Every joint coordinate, in the order of [`Linkage::coordinates`], as reported: the home value
    /// plus the displacement, radians.
    pub joints: Vec<f64>,
    /// The imaginary joint, radians.
    pub imaginary: f64,
    /// Whether every joint is within its limits.
    pub within_limits: bool,
}

/// A single loop, decomposed into two spherical four-bars. Immutable; share it between threads.
#[derive(Clone, Debug)]
pub struct Linkage {
    mechanism: Mechanism,
    decomposition: Decomposition,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    imaginary: ImaginaryJoint,
    /// `τ` is the displacement of the first leg's imaginary joint, or the opposite of the second's.
    reversed: bool,
    sections: [Loop; 2],
}

/// A four-bar of the linkage: its first joint is the imaginary one.
#[derive(Clone, Debug)]
struct Loop {
    four_bar: FourBar,
    /// Numbers of the coordinates of the other three.
    coordinates: [usize; 3],
}

impl Linkage {
    /// Decomposes a mechanism, and compiles the first of its decompositions that is covered.
    ///
    /// # Errors
    /// Where it does not decompose, or what its preferred decomposition has instead of two spherical
    /// four-bars.
    pub fn new(mechanism: Mechanism) -> Result<Self, LinkageError> {
        let mut refused = None;
        for decomposition in decompose(&mechanism)? {
            match Self::with_decomposition(mechanism.clone(), decomposition) {
                Ok(linkage) => return Ok(linkage),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        Err(refused.expect("decompose gives at least one decomposition, or an error"))
    }

    /// Compiles a mechanism by one of its decompositions.
    ///
    /// # Errors
    /// What it has instead of two spherical four-bars.
    pub fn with_decomposition(
        mechanism: Mechanism,
        decomposition: Decomposition,
    ) -> Result<Self, LinkageError> {
        let ([one, two], [split_one, split_two]) = (&*mechanism.legs, &*decomposition.legs) else {
            return Err(LinkageError::NotCovered(Obstacle::Legs(mechanism.legs.len())));
        };
        let subspaces = Obstacle::Subspaces {
            lower: decomposition.lower.name(),
            upper: decomposition.upper.name(),
        };
        let task = match Task::new(&mechanism, &decomposition) {
            Err(TaskError::Subspace(_) | TaskError::Screw) => {
                return Err(LinkageError::NotCovered(subspaces));
            }
            task => task?,
        };
        if [&task.lower, &task.upper].iter().any(|s| s.kind != SubspaceKind::Spherical) {
            return Err(LinkageError::NotCovered(subspaces));
        }

        let first = [0, one.coordinates().count()];
        let axes = |(leg, number): (&Leg, usize), part: &[Freedom]| {
            let axis = |freedom: &Freedom| loop_axis(leg, first[number], *freedom);
            part.iter().map(axis).collect::<Result<Vec<_>, _>>()
        };
        let compile = |section: Section, part: fn(&LegSplit) -> &[Freedom]| {
            let one = axes((one, 0), part(split_one))?;
            let two = axes((two, 1), part(split_two))?;
            Loop::new(section, -task.direction, one, two)
        };
        let sections = [
            compile(Section::Lower, |split| &split.lower)?,
            compile(Section::Upper, |split| &split.upper)?,
        ];
        let owner = decomposition.legs.iter().position(|split| split.imaginary).unwrap_or(0);
        let coordinates: Vec<_> = mechanism.coordinates().cloned().collect();
        Ok(Self {
            imaginary: ImaginaryJoint::new(&mechanism.legs[owner], owner, &task),
            reversed: owner == 1,
            limits: coordinates.iter().map(|c| Limits::new(c.limits, c.home)).collect(),
            coordinates,
            sections,
            mechanism,
            decomposition,
        })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// How it was decomposed.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// Every joint coordinate, leg by leg: the order of [`Position::joints`].
    pub fn coordinates(&self) -> &[JointCoordinate] {
        &self.coordinates
    }

    /// The imaginary joint.
    pub fn imaginary(&self) -> &ImaginaryJoint {
        &self.imaginary
    }

    /// The linkage moved by the joint coordinate of this name; `None` where there is none.
    pub fn input(&self, name: &str) -> Option<Input<'_>> {
        let coordinate = self.coordinates.iter().position(|c| c.name == name)?;
        self.sections.iter().enumerate().find_map(|(section, four_bar)| {
            let place = four_bar.coordinates.iter().position(|&c| c == coordinate)? + 1;
            Some(Input { linkage: self, coordinate, section, place })
        })
    }

    /// A position to solve into: home.
    fn home(&self, branch: LinkageBranch) -> Position {
        Position {
            branch,
            joints: self.coordinates.iter().map(|c| c.home).collect(),
            imaginary: self.imaginary.home,
            within_limits: true,
        }
    }
}

/// A freedom's coordinate number, and its axis.
type LoopAxis = (usize, Unit<Vector3<f64>>);

/// A freedom of a leg whose coordinates start with the number `first`.
fn loop_axis(leg: &Leg, first: usize, freedom: Freedom) -> Result<LoopAxis, LinkageError> {
    let joint = &leg.joints[freedom.joint];
    if joint.kind == JointKind::Spherical {
        return Err(LinkageError::NotCovered(Obstacle::Ball(joint.name.clone())));
    }
    let before: usize = leg.joints[..freedom.joint].iter().map(|j| j.freedoms()).sum();
    let axis = Unit::new_normalize(joint.screws()[freedom.index].angular);
    Ok((first + before + freedom.index, axis))
}

impl Loop {
    /// `imaginary`, then the second leg's and the first leg's joints, all towards the centre of the
    /// linkage in the one leg and away from it in the other.
    fn new(
        section: Section,
        imaginary: Unit<Vector3<f64>>,
        one: Vec<LoopAxis>,
        two: Vec<LoopAxis>,
    ) -> Result<Self, LinkageError> {
        let count = one.len() + two.len();
        let reverse = |axes: Vec<LoopAxis>| axes.into_iter().rev().map(|(c, axis)| (c, -axis));
        let joints: Vec<LoopAxis> = match section {
            Section::Lower => reverse(two).chain(one).collect(),
            Section::Upper => two.into_iter().chain(reverse(one)).collect(),
        };
        let [a, b, c] = *joints else {
            return Err(LinkageError::NotCovered(Obstacle::Freedoms { section, count }));
        };
        let four_bar = FourBar::new([imaginary, a.1, b.1, c.1])
            .map_err(|error| LinkageError::FourBar { section, error })?;
        Ok(Self { four_bar, coordinates: [a.0, b.0, c.0] })
    }
}

/// A linkage moved by one of its joints.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    linkage: &'a Linkage,
    /// Number of the input's coordinate.
    coordinate: usize,
    /// The section that it is in.
    section: usize,
    /// Its place in that section's loop.
    place: usize,
}

impl<'a> Input<'a> {
    /// The input's joint coordinate.
    pub fn coordinate(&self) -> &'a JointCoordinate {
        &self.linkage.coordinates[self.coordinate]
    }

    /// The branch that the linkage is assembled in.
    pub fn home_branch(&self) -> LinkageBranch {
        LinkageBranch {
            first: self.own().four_bar.driven_by(self.place).home(),
            second: self.other().four_bar.driven_by(0).home(),
        }
    }

    /// The home position: a place for [`Input::position`] to write to.
    pub fn home(&self) -> Position {
        self.linkage.home(self.home_branch())
    }

    /// Every position with the input at `value`, radians, as reported (home value included): at most
    /// four, none where the loop does not close. Angles are within half a turn of home, unless
    /// limits ask for another turn. Where links are folded, branches that meet are all given.
    pub fn solve(&self, value: f64) -> Vec<Position> {
        let solved = |branch| {
            let mut position = self.home();
            self.position(value, branch, &mut position).then_some(position)
        };
        LinkageBranch::ALL.into_iter().filter_map(solved).collect()
    }

    /// The position in one branch, without allocating; `false`, and `position` as it was, where the
    /// loop does not close.
    #[inline]
    pub fn position(&self, value: f64, branch: LinkageBranch, position: &mut Position) -> bool {
        let home = |coordinate: usize, _: &Position| self.linkage.coordinates[coordinate].home;
        self.solve_at(value, branch, position, (home, self.linkage.imaginary.home))
    }

    /// As [`Input::position`], with every angle at the turn that is nearest to where `position` has
    /// it: along a motion in small steps no angle jumps.
    #[inline]
    pub fn position_near(
        &self,
        value: f64,
        branch: LinkageBranch,
        position: &mut Position,
    ) -> bool {
        let imaginary = position.imaginary;
        let before = |coordinate: usize, position: &Position| position.joints[coordinate];
        self.solve_at(value, branch, position, (before, imaginary))
    }

    fn solve_at(
        &self,
        value: f64,
        branch: LinkageBranch,
        position: &mut Position,
        (reference, imaginary): (impl Fn(usize, &Position) -> f64, f64),
    ) -> bool {
        let linkage = self.linkage;
        let displacement = value - self.coordinate().home;
        let Some([own, other]) = self.amounts(unit(displacement), branch) else { return false };
        position.branch = branch;
        position.within_limits =
            linkage.limits[self.coordinate].admits(Amount::Value(displacement));
        position.joints[self.coordinate] = value;
        let mut put = |coordinate: usize, amount: Amount| {
            let (home, limits) =
                (linkage.coordinates[coordinate].home, &linkage.limits[coordinate]);
            let near = reference(coordinate, position) - home;
            position.joints[coordinate] = home + limits.report(amount, near);
            position.within_limits &= limits.admits(amount);
        };
        for (i, &amount) in own.iter().enumerate() {
            let place = (self.place + 1 + i) % 4;
            if place > 0 {
                put(self.own().coordinates[place - 1], amount);
            }
        }
        for (&coordinate, amount) in self.other().coordinates.iter().zip(other) {
            put(coordinate, amount);
        }
        let tau = own[self.imaginary_amount()];
        let tau = if linkage.reversed { tau.inverse() } else { tau };
        position.imaginary = linkage.imaginary.value(tau, imaginary);
        true
    }

    /// The rotations of the three joints after the input in its loop, and of the three after the
    /// imaginary joint in the other one.
    #[inline]
    fn amounts(&self, turn: Complex<f64>, branch: LinkageBranch) -> Option<[[Amount; 3]; 2]> {
        let own = self.own().four_bar.driven_by(self.place).solve(turn, branch.first).ok()?;
        let tau = own[self.imaginary_amount()].turn();
        let other = self.other().four_bar.driven_by(0).solve(tau, branch.second).ok()?;
        Some([own, other])
    }

    /// Which of the joints after the input is the imaginary one.
    fn imaginary_amount(&self) -> usize {
        3 - self.place
    }

    /// The four-bar that has the input.
    fn own(&self) -> &'a Loop {
        &self.linkage.sections[self.section]
    }

    /// The one that follows.
    fn other(&self) -> &'a Loop {
        &self.linkage.sections[1 - self.section]
    }
}
