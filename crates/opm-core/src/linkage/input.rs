//! A linkage moved by one of its joints, and where that puts the others.

use super::{Linkage, Loop};
use crate::chain::Branch;
use crate::group::JointDisplacement;
use crate::mechanism::joint::JointCoordinate;
use crate::numeric::angle::unit;
use nalgebra::Complex;
use std::fmt;

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

/// A linkage moved by one of its joints.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    pub(super) linkage: &'a Linkage,
    /// Number of the input's coordinate.
    pub(super) coordinate: usize,
    /// The section that it is in.
    pub(super) section: usize,
    /// Its place in that section's loop.
    pub(super) place: usize,
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
        Position {
            branch: self.home_branch(),
            joints: self.linkage.coordinates.iter().map(|c| c.home).collect(),
            imaginary: self.linkage.imaginary.home,
            within_limits: true,
        }
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
        self.solve_at(value, branch, position, (|_, _| None, self.linkage.imaginary.home))
    }

    /// As [`Input::position`], with every angle at the turn that is nearest to where `position` has
    /// it: along a motion in small steps no angle jumps, not even to stay within its limits.
    #[inline]
    pub fn position_near(
        &self,
        value: f64,
        branch: LinkageBranch,
        position: &mut Position,
    ) -> bool {
        let imaginary = position.imaginary;
        let held = |coordinate: usize, position: &Position| Some(position.joints[coordinate]);
        self.solve_at(value, branch, position, (held, imaginary))
    }

    fn solve_at(
        &self,
        value: f64,
        branch: LinkageBranch,
        position: &mut Position,
        (held, imaginary): (impl Fn(usize, &Position) -> Option<f64>, f64),
    ) -> bool {
        let linkage = self.linkage;
        let displacement = value - self.coordinate().home;
        let Some([own, other]) = self.amounts(unit(displacement), branch) else { return false };
        position.branch = branch;
        position.within_limits =
            linkage.limits[self.coordinate].admits(JointDisplacement::Value(displacement));
        position.joints[self.coordinate] = value;
        let mut put = |coordinate: usize, amount: JointDisplacement| {
            let home = linkage.coordinates[coordinate].home;
            let held = held(coordinate, position).map(|held| held - home);
            let (value, within) = linkage.limits[coordinate].place(amount, held);
            position.joints[coordinate] = home + value;
            position.within_limits &= within;
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
    fn amounts(
        &self,
        turn: Complex<f64>,
        branch: LinkageBranch,
    ) -> Option<[[JointDisplacement; 3]; 2]> {
        let own = self.own().four_bar.driven_by(self.place).solve(turn, branch.first).ok()?;
        let tau = own[self.imaginary_amount()].unit_direction();
        let other = self.other().four_bar.driven_by(0).solve(tau, branch.second).ok()?;
        Some([own, other])
    }

    /// Which of the joints after the input is the imaginary one.
    pub(super) fn imaginary_amount(&self) -> usize {
        3 - self.place
    }

    /// The four-bar that has the input.
    pub(super) fn own(&self) -> &'a Loop {
        &self.linkage.sections[self.section]
    }

    /// The one that follows.
    pub(super) fn other(&self) -> &'a Loop {
        &self.linkage.sections[1 - self.section]
    }
}
