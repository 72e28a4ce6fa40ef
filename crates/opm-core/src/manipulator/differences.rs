//! Limits of the differences of joints, as limits of a pose.
//!
//! They tie the choices of legs: in any working mode, a pose is in reach within them if some combination of the legs' solutions is.

use super::{Manipulator, Mode, Solution};
use crate::mechanism::JointDifference;

impl Manipulator {
    /// The limited differences of joints. Poses are in reach within the limits where these are kept, too.
    pub fn differences(&self) -> &[JointDifference] {
        &self.differences
    }

    /// Whether there are limits that several coordinates share: cones of joints, or limits of differences.
    pub fn shares_limits(&self) -> bool {
        self.has_cones() || !self.differences.is_empty()
    }

    /// The numbers of the differences that are beyond their limits at these values of all joint coordinates.
    pub fn beyond_differences<'a>(&'a self, joints: &'a [f64]) -> impl Iterator<Item = usize> + 'a {
        let all = self.differences.iter().enumerate();
        all.filter(|(_, difference)| !difference.allows(joints)).map(|(number, _)| number)
    }

    /// Notes whether the joints of a solution are within their cones, and their differences within their limits.
    #[inline]
    pub(super) fn test_shared_limits(&self, out: &mut Solution) {
        self.test_cones(out);
        if !self.differences.is_empty() {
            let Solution { joints, unreachable, within_limits, .. } = out;
            let closed = |leg: usize| unreachable.iter().all(|missed| missed.leg != leg);
            let has_value = |number: &usize| self.differences[*number].legs.into_iter().all(closed);
            *within_limits &= self.beyond_differences(joints).find(has_value).is_none();
        }
    }

    /// The combinations of modes of legs, one list for each leg, in which differences are within their limits: the legs that
    /// have part in one take each of their modes, the others their first. `within` solves a mode, and tells whether it is so.
    pub(super) fn combined(
        &self,
        of_legs: &[Vec<Mode>],
        common: Mode,
        mut within: impl FnMut(Mode) -> bool,
    ) -> Vec<Mode> {
        let tied = |leg: usize| self.differences.iter().any(|d| d.legs.contains(&leg));
        let mut all = vec![common];
        for (leg, modes) in of_legs.iter().enumerate() {
            let modes = if tied(leg) { &modes[..] } else { &modes[..1.min(modes.len())] };
            all = all.iter().flat_map(|mode| modes.iter().map(|own| mode.with(*own))).collect();
        }
        all.sort_unstable_by_key(|mode| mode.bits());
        all.retain(|&mode| within(mode));
        all
    }
}
