//! A linkage of two sections, driven by one of its joints.

use super::{DrivenLoop, LinkageSection, Sections};
use crate::chain::Branch;
use crate::group::JointDisplacement;
use crate::linkage::{Joints, LinkageBranch, Position, Rates};
use crate::mechanism::joint::{JointCoordinate, Quantity};
use crate::numeric::angle::unit;
use std::fmt;

/// The signs of a position's two choices, in the order of solution: first for the loop with the input
/// joint, then for the other one. A sign is that of the chain of joints that follow the input (or the
/// imaginary joint) in its loop: in a spherical loop it is `+` if the triple product of their three
/// axes, in their directions at that position, is positive; for planar chains see
/// [`PlanarChain`](crate::chain::planar::PlanarChain). A loop without a choice has `+`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SectionSigns {
    /// The sign for the loop with the input.
    pub first: Branch,
    /// The sign for the other loop.
    pub second: Branch,
}

impl SectionSigns {
    /// All four branches, in the order `+ +`, `+ -`, `- +`, `- -`.
    pub const ALL: [Self; 4] = [
        Self { first: Branch::Plus, second: Branch::Plus },
        Self { first: Branch::Plus, second: Branch::Minus },
        Self { first: Branch::Minus, second: Branch::Plus },
        Self { first: Branch::Minus, second: Branch::Minus },
    ];
}

impl fmt::Display for SectionSigns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = |branch| if branch == Branch::Plus { '+' } else { '-' };
        write!(f, "{} {}", sign(self.first), sign(self.second))
    }
}

/// A linkage of two sections, driven by one of its joints.
#[derive(Clone, Copy, Debug)]
pub struct SectionInput<'a> {
    pub(super) linkage: &'a Sections,
    pub(super) joints: &'a Joints,
    /// Index of the input's coordinate.
    pub(super) coordinate: usize,
    /// Index of the section with the input: 0 for the lower one, 1 for the upper one.
    pub(super) section: usize,
    /// Index of the input in that section's loop; the imaginary joint has the index 0.
    pub(super) loop_index: usize,
}

impl<'a> SectionInput<'a> {
    /// The input's joint coordinate.
    pub fn coordinate(&self) -> &'a JointCoordinate {
        &self.joints.coordinates[self.coordinate]
    }

    /// The branch in which the linkage is assembled.
    pub fn home_branch(&self) -> SectionSigns {
        SectionSigns { first: self.first_loop().home(), second: self.second_loop().home() }
    }

    /// The home position, which [`SectionInput::position`] can overwrite.
    pub fn home(&self) -> Position {
        Position {
            branch: LinkageBranch::Signs(self.home_branch()),
            joints: self.joints.home(),
            imaginary: Some(self.linkage.imaginary.home),
            within_limits: true,
        }
    }

    /// Computes the position in one branch, without allocation. Returns `false`, and leaves
    /// `position` unchanged, if the loop does not close.
    #[inline]
    pub fn position(&self, value: f64, branch: SectionSigns, position: &mut Position) -> bool {
        self.solve_at(value, branch, position, (|_, _| None, self.linkage.imaginary.home))
    }

    /// As [`SectionInput::position`], but every angle is the one nearest to its value in `position`,
    /// modulo 2π. Along a motion in small steps no angle jumps, not even to stay within its limits.
    #[inline]
    pub fn position_near(&self, value: f64, branch: SectionSigns, position: &mut Position) -> bool {
        let imaginary = position.imaginary.unwrap_or(self.linkage.imaginary.home);
        let held = |coordinate: usize, position: &Position| Some(position.joints[coordinate]);
        self.solve_at(value, branch, position, (held, imaginary))
    }

    fn solve_at(
        &self,
        value: f64,
        branch: SectionSigns,
        position: &mut Position,
        (held, imaginary): (impl Fn(usize, &Position) -> Option<f64>, f64),
    ) -> bool {
        let linkage = self.linkage;
        let displacement = value - self.coordinate().home;
        let near = linkage.imaginary.displacement(imaginary);
        let near = if linkage.reversed { -near } else { near };
        let Some([own, other]) = self.displacements(displacement, branch, near) else {
            return false;
        };
        position.branch = LinkageBranch::Signs(branch);
        position.within_limits =
            self.joints.limits[self.coordinate].admits(JointDisplacement::Value(displacement));
        position.joints[self.coordinate] = value;
        let mut put = |coordinate: usize, displacement: JointDisplacement| {
            let held = held(coordinate, position);
            let (value, within) = self.joints.value(coordinate, displacement, held);
            position.joints[coordinate] = value;
            position.within_limits &= within;
        };
        let joints = self.own().closed.joints();
        for (i, &displacement) in own.iter().enumerate().take(joints - 1) {
            let index = (self.loop_index + 1 + i) % joints;
            if index > 0 {
                put(self.own().coordinates[index - 1], displacement);
            }
        }
        let others = self.other().closed.joints() - 1;
        for (&coordinate, displacement) in self.other().coordinates[..others].iter().zip(other) {
            put(coordinate, displacement);
        }
        position.within_limits &= self.joints.differences_allow(&position.joints);
        let tau = own[self.imaginary_index()];
        let tau = if linkage.reversed { tau.inverse() } else { tau };
        position.imaginary = Some(linkage.imaginary.value(tau, imaginary));
        true
    }

    /// The rates of all joints at a position, for a unit rate of the input. `None` at a dead point of
    /// either loop, where they are infinite or free.
    pub fn rates(&self, position: &Position) -> Option<Rates> {
        let displacement = position.joints[self.coordinate] - self.coordinate().home;
        let near = self.linkage.imaginary.displacement(position.imaginary?);
        let LinkageBranch::Signs(branch) = position.branch else { return None };
        let near = if self.linkage.reversed { -near } else { near };
        let [own, other] = self.displacements(displacement, branch, near)?;
        let own_rates = self.first_loop().rates(&own)?;
        let tau = own_rates[self.imaginary_index()];
        let mut joints = vec![0.0; position.joints.len()];
        joints[self.coordinate] = 1.0;
        let count = self.own().closed.joints();
        for (i, rate) in own_rates.into_iter().enumerate().take(count - 1) {
            let index = (self.loop_index + 1 + i) % count;
            if index > 0 {
                joints[self.own().coordinates[index - 1]] = rate;
            }
        }
        let others = self.other().closed.joints() - 1;
        let other_rates = self.second_loop().rates(&other)?;
        for (&coordinate, rate) in self.other().coordinates[..others].iter().zip(other_rates) {
            joints[coordinate] = tau * rate;
        }
        let sign = self.linkage.imaginary.sign * if self.linkage.reversed { -1.0 } else { 1.0 };
        Some(Rates { joints, imaginary: Some(sign * tau) })
    }

    /// The displacements of the joints after the input in its loop, and of those after the imaginary
    /// joint in the other loop. Where revolutions of the imaginary joint count, it is the one nearest
    /// to `near`.
    #[inline]
    fn displacements(
        &self,
        displacement: f64,
        branch: SectionSigns,
        near: f64,
    ) -> Option<[[JointDisplacement; 3]; 2]> {
        let (first, second) = (self.first_loop(), self.second_loop());
        let absent = |driven: &DrivenLoop, branch| branch == Branch::Minus && !driven.has_choice();
        if absent(first, branch.first) || absent(second, branch.second) {
            return None;
        }
        let own = first.solve(self.driving(displacement)?, branch.first).ok()?;
        let tau = own[self.imaginary_index()];
        let tau = match tau {
            JointDisplacement::Direction(_) if second.counts_revolutions() => {
                JointDisplacement::Value(tau.nearest(near))
            }
            JointDisplacement::Direction(_) => JointDisplacement::Direction(tau.unit_direction()),
            JointDisplacement::Value(_) => tau,
        };
        let other = second.solve(tau, branch.second).ok()?;
        Some([own, other])
    }

    /// The input's displacement as its loop takes it; `None` where it is not finite.
    #[inline]
    pub(super) fn driving(&self, displacement: f64) -> Option<JointDisplacement> {
        let angle = self.coordinate().quantity == Quantity::Angle;
        let direction = angle && !self.first_loop().counts_revolutions();
        displacement.is_finite().then(|| {
            if direction {
                JointDisplacement::Direction(unit(displacement))
            } else {
                JointDisplacement::Value(displacement)
            }
        })
    }

    /// The index of the imaginary joint among the joints after the input.
    pub(super) fn imaginary_index(&self) -> usize {
        self.own().closed.joints() - 1 - self.loop_index
    }

    /// The section with the input.
    pub(super) fn own(&self) -> &'a LinkageSection {
        &self.linkage.sections[self.section]
    }

    /// The section driven by the imaginary joint.
    pub(super) fn other(&self) -> &'a LinkageSection {
        &self.linkage.sections[1 - self.section]
    }

    /// The loop of the section with the input, driven by the input.
    pub(super) fn first_loop(&self) -> &'a DrivenLoop {
        self.own().closed.driven_by(self.loop_index)
    }

    /// The loop of the other section, driven by the imaginary joint.
    pub(super) fn second_loop(&self) -> &'a DrivenLoop {
        self.other().closed.driven_by(0)
    }
}
