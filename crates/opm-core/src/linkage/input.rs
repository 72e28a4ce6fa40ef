//! A linkage driven by one of its joints, and the resulting positions of the others.

use super::{Linkage, Loop};
use crate::chain::Branch;
use crate::group::JointDisplacement;
use crate::mechanism::joint::JointCoordinate;
use crate::numeric::angle::unit;
use nalgebra::Complex;
use std::fmt;

/// The signs of a position's two choices, in the order of solution: first for the four-bar with the
/// input joint, then for the other one. A sign is `+` if the triple product of the three axes that
/// follow the input (or the imaginary joint) in its loop is positive, in their directions at that
/// position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LinkageBranch {
    /// The sign for the four-bar with the input.
    pub first: Branch,
    /// The sign for the other four-bar.
    pub second: Branch,
}

impl LinkageBranch {
    /// All four branches, in the order `+ +`, `+ -`, `- +`, `- -`.
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

/// A position of a linkage: the values of all its joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Position {
    /// The branch of the position.
    pub branch: LinkageBranch,
    /// Every joint coordinate in radians, in the order of [`Linkage::coordinates`]: the home value
    /// plus the displacement.
    pub joints: Vec<f64>,
    /// The value of the imaginary joint, radians.
    pub imaginary: f64,
    /// Whether every joint is within its limits.
    pub within_limits: bool,
}

/// A linkage driven by one of its joints.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    pub(super) linkage: &'a Linkage,
    /// Index of the input's coordinate.
    pub(super) coordinate: usize,
    /// Index of the section with the input: 0 for the lower one, 1 for the upper one.
    pub(super) section: usize,
    /// Index of the input in that section's loop; the imaginary joint has the index 0.
    pub(super) loop_index: usize,
}

impl<'a> Input<'a> {
    /// The input's joint coordinate.
    pub fn coordinate(&self) -> &'a JointCoordinate {
        &self.linkage.coordinates[self.coordinate]
    }

    /// The branch in which the linkage is assembled.
    pub fn home_branch(&self) -> LinkageBranch {
        LinkageBranch {
            first: self.own().four_bar.driven_by(self.loop_index).home(),
            second: self.other().four_bar.driven_by(0).home(),
        }
    }

    /// The home position, which [`Input::position`] can overwrite.
    pub fn home(&self) -> Position {
        Position {
            branch: self.home_branch(),
            joints: self.linkage.coordinates.iter().map(|c| c.home).collect(),
            imaginary: self.linkage.imaginary.home,
            within_limits: true,
        }
    }

    /// Every position with the input at `value`, radians, with the home value included: at most
    /// four, and none if the loop does not close. Angles are within π of home, unless limits
    /// require another revolution. Where links are folded, branches that meet are all listed.
    pub fn solve(&self, value: f64) -> Vec<Position> {
        let solved = |branch| {
            let mut position = self.home();
            self.position(value, branch, &mut position).then_some(position)
        };
        LinkageBranch::ALL.into_iter().filter_map(solved).collect()
    }

    /// Computes the position in one branch, without allocation. Returns `false`, and leaves
    /// `position` unchanged, if the loop does not close.
    #[inline]
    pub fn position(&self, value: f64, branch: LinkageBranch, position: &mut Position) -> bool {
        self.solve_at(value, branch, position, (|_, _| None, self.linkage.imaginary.home))
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
        let Some([own, other]) = self.displacements(unit(displacement), branch) else {
            return false;
        };
        position.branch = branch;
        position.within_limits =
            linkage.limits[self.coordinate].admits(JointDisplacement::Value(displacement));
        position.joints[self.coordinate] = value;
        let mut put = |coordinate: usize, displacement: JointDisplacement| {
            let home = linkage.coordinates[coordinate].home;
            let held = held(coordinate, position).map(|held| held - home);
            let (value, within) = linkage.limits[coordinate].place(displacement, held);
            position.joints[coordinate] = home + value;
            position.within_limits &= within;
        };
        for (i, &displacement) in own.iter().enumerate() {
            let index = (self.loop_index + 1 + i) % 4;
            if index > 0 {
                put(self.own().coordinates[index - 1], displacement);
            }
        }
        for (&coordinate, displacement) in self.other().coordinates.iter().zip(other) {
            put(coordinate, displacement);
        }
        let tau = own[self.imaginary_index()];
        let tau = if linkage.reversed { tau.inverse() } else { tau };
        position.imaginary = linkage.imaginary.value(tau, imaginary);
        true
    }

    /// The rotations of the three joints after the input in its loop, and of the three after the
    /// imaginary joint in the other loop.
    #[inline]
    fn displacements(
        &self,
        turn: Complex<f64>,
        branch: LinkageBranch,
    ) -> Option<[[JointDisplacement; 3]; 2]> {
        let own = self.own().four_bar.driven_by(self.loop_index).solve(turn, branch.first).ok()?;
        let tau = own[self.imaginary_index()].unit_direction();
        let other = self.other().four_bar.driven_by(0).solve(tau, branch.second).ok()?;
        Some([own, other])
    }

    /// The index of the imaginary joint among the joints after the input.
    pub(super) fn imaginary_index(&self) -> usize {
        3 - self.loop_index
    }

    /// The loop with the input.
    pub(super) fn own(&self) -> &'a Loop {
        &self.linkage.sections[self.section]
    }

    /// The loop driven by the imaginary joint.
    pub(super) fn other(&self) -> &'a Loop {
        &self.linkage.sections[1 - self.section]
    }
}
