//! A closed loop, with another of its links as the platform.
//!
//! Of a loop of two legs any link can be the platform. A four-bar's coupler has no coordinates in closed form, but its crank
//! has. So the link is taken behind the first joints of a leg that have as many freedoms as the loop: these are all that
//! the platform then does, and the rest of the loop is the other leg.

use super::decompose;
use super::mobility::mobility;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::Unit;

/// The same loop with other links as the platform, the one behind a motor first. There are none of a mechanism of more than two
/// legs, nor of one that has an imaginary joint: that is a [linkage](crate::linkage).
pub fn rerooted(mechanism: &Mechanism) -> Vec<Mechanism> {
    let [_, _] = &*mechanism.legs else { return Vec::new() };
    if decompose(mechanism).is_ok_and(|ways| ways.iter().any(|way| way.imaginary_joints > 0)) {
        return Vec::new();
    }
    let links = (0..2)
        .flat_map(|stem| (1..mechanism.legs[stem].joints.len()).map(move |count| (stem, count)));
    let mut found: Vec<(bool, Mechanism)> = links
        .filter_map(|(stem, count)| {
            let other = cut(mechanism, stem, count);
            let joints = &other.legs[stem].joints;
            let freedoms: usize = joints.iter().map(Joint::freedoms).sum();
            let report = mobility(&other).ok()?;
            let driven = joints.iter().all(|joint| joint.actuated);
            (report.mobility.saturating_sub(report.idle) == freedoms).then_some((driven, other))
        })
        .collect();
    found.sort_by_key(|(driven, _)| !driven);
    found.into_iter().map(|(_, mechanism)| mechanism).collect()
}

/// The loop with the link behind the first `count` joints of a leg as the platform.
fn cut(mechanism: &Mechanism, stem: usize, count: usize) -> Mechanism {
    let mut changed = mechanism.clone();
    let rest = changed.legs[stem].joints.split_off(count);
    let passed = rest.into_iter().rev().map(turned);
    changed.legs[1 - stem].joints.extend(passed);
    changed
}

/// A joint passed from its other side, with the same values: its axis points back. The rotation vector of a ball cannot, and
/// is measured from home anew.
fn turned(mut joint: Joint) -> Joint {
    joint.axis = -joint.axis;
    match &mut joint.kind {
        JointKind::Universal { second } => {
            let first = joint.axis;
            joint.axis = Unit::new_unchecked(-second.into_inner());
            *second = first;
            joint.coordinates.swap(0, 1);
        }
        JointKind::Spherical => joint.coordinates.iter_mut().for_each(|c| c.home = 0.0),
        JointKind::Revolute
        | JointKind::Prismatic
        | JointKind::Helical { .. }
        | JointKind::Cylindrical => {}
    }
    joint
}
