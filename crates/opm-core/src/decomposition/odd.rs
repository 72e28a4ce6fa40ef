//! The one joint that prevents a decomposition, if there is exactly one.

use super::mobility::Mobility;
use super::near::{JointMiss, misses_of};
use super::{Decomposition, Freedom, frame, one_subspace, search};
use crate::group::subspace::{MotionSubspace, SubspaceClass};
use crate::mechanism::Mechanism;
use crate::mechanism::joint::Joint;
use crate::mechanism::leg::{Leg, Section};

/// The only joint that must be left out for the mechanism to have partial subspaces, or for its legs to move in one
/// subspace, with how far it is from the nearer section; `None` if there is no such joint, or more than one.
///
/// If all other axes meet in one point, the mechanism has no size that a miss could be small against: that is found
/// here, and never [`nearly`](super::near::nearly).
pub(super) fn odd_joint(mechanism: &Mechanism, report: &Mobility) -> Option<JointMiss> {
    let frame = frame(mechanism);
    let mut odd = None;
    for (number, leg) in mechanism.legs.iter().enumerate().filter(|(_, leg)| leg.joints.len() > 1) {
        for joint in 0..leg.joints.len() {
            let mut others = mechanism.clone();
            let left_out = others.legs[number].joints.remove(joint);
            let screws: Vec<_> = others.legs.iter().flat_map(Leg::screws).collect();
            let lambda = MotionSubspace::span(frame, &screws).dimension();
            // The pose nearby is that of all joints.
            let report = Mobility { lambda, nearby: None, ..report.clone() };
            let mut found = search(&others, &report, 1).0;
            found.extend(one_subspace(&others, &report));
            let misses = found.iter().flat_map(|split| joint_misses(leg, &left_out, split));
            let relative = |miss: &JointMiss| miss.relative(frame.length);
            if let Some(miss) = misses.min_by(|a, b| relative(a).total_cmp(&relative(b))) {
                if odd.is_some() {
                    return None;
                }
                odd = Some(miss.in_units(mechanism.units));
            }
        }
    }
    odd
}

/// How far a joint is from either section of a decomposition.
fn joint_misses(leg: &Leg, joint: &Joint, split: &Decomposition) -> Vec<JointMiss> {
    let alone = Leg::new(leg.name.clone(), vec![joint.clone()]);
    let freedoms: Vec<Freedom> =
        (0..joint.freedoms()).map(|index| Freedom { joint: 0, index }).collect();
    [(Section::Lower, split.lower), (Section::Upper, split.upper)]
        .into_iter()
        // There is no upper section where the others move in one subspace.
        .filter(|(_, subspace)| *subspace != SubspaceClass::Identity)
        .flat_map(|(section, subspace)| misses_of(&alone, &freedoms, section, subspace))
        .map(|(_, miss)| miss)
        .collect()
}
