//! The cones that spherical and universal joints stay in, as limits of a pose.

use super::leg::{CompiledLeg, LegSolution};
use super::{Manipulator, Solution};
use crate::mechanism::JointCone;
use crate::mechanism::leg::Leg;

/// The cone of a joint.
#[derive(Clone, Debug)]
pub(crate) struct ConeLimit {
    cone: JointCone,
    /// The number of its first joint coordinate, and how many it has.
    first: usize,
    count: usize,
}

impl ConeLimit {
    /// Those of a leg whose first joint coordinate has a number.
    pub fn of_leg(leg: &Leg, first: usize) -> Vec<Self> {
        let limit = |cone: JointCone| {
            let before = &leg.joints[..cone.joint];
            let before: usize = before.iter().map(|joint| joint.coordinates.len()).sum();
            let count = leg.joints[cone.joint].coordinates.len();
            Self { cone, first: first + before, count }
        };
        leg.cones().into_iter().map(limit).collect()
    }
}

impl CompiledLeg {
    /// The displacement of a joint coordinate from home.
    fn displacement(&self, solution: &LegSolution, coordinate: usize) -> f64 {
        let sections = [(&self.lower, &solution.lower), (&self.upper, &solution.upper)];
        let of_sections = sections.into_iter().flat_map(|(section, found)| {
            section
                .coordinates
                .iter()
                .zip(found)
                .filter_map(|(c, found)| Some((c.as_ref()?, found)))
        });
        let between = self.whole.as_ref().and_then(|whole| whole.between.as_ref());
        let mut all = of_sections.chain(between.map(|joint| (joint, &solution.tau)));
        let found = all.find(|(joint, _)| joint.number == coordinate);
        found.map_or(0.0, |(_, displacement)| displacement.value())
    }

    /// Whether the joints of a solution are within their cones.
    #[inline]
    pub(super) fn within_cones(&self, solution: &LegSolution) -> bool {
        self.cones.is_empty() || self.are_within_cones(solution)
    }

    #[inline(never)]
    fn are_within_cones(&self, solution: &LegSolution) -> bool {
        self.cones.iter().all(|limit| {
            let mut displacements = [0.0; 3];
            for (i, value) in displacements.iter_mut().take(limit.count).enumerate() {
                *value = self.displacement(solution, limit.first + i);
            }
            limit.cone.admits(&displacements)
        })
    }
}

impl Manipulator {
    /// Whether joints have cones. Then poses are in reach within the limits where these are kept, too.
    pub fn has_cones(&self) -> bool {
        self.legs.iter().any(|leg| !leg.cones.is_empty())
    }

    /// The numbers of the first coordinates of those joints that are beyond their cones at these values of all joint coordinates,
    /// with their legs.
    pub fn beyond_cones<'a>(
        &'a self,
        joints: &'a [f64],
    ) -> impl Iterator<Item = (usize, usize)> + 'a {
        let all = self.legs.iter().enumerate();
        let all = all.flat_map(|(leg, own)| own.cones.iter().map(move |limit| (leg, limit)));
        all.filter_map(|(leg, limit)| {
            let mut displacements = [0.0; 3];
            for (i, value) in displacements.iter_mut().take(limit.count).enumerate() {
                let number = limit.first + i;
                *value = joints[number] - self.coordinates[number].home;
            }
            (!limit.cone.admits(&displacements)).then_some((leg, limit.first))
        })
    }

    /// Notes whether the joints of a solution are within their cones.
    #[inline]
    pub(super) fn test_cones(&self, out: &mut Solution) {
        if self.has_cones() {
            let Solution { joints, unreachable, within_limits, .. } = out;
            let closed = |leg: usize| unreachable.iter().all(|missed| missed.leg != leg);
            *within_limits &= !self.beyond_cones(joints).any(|(leg, _)| closed(leg));
        }
    }
}
