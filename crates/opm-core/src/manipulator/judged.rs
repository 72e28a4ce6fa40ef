//! The point that condition numbers are of, where the platform is a link between two legs.

use crate::group::SubspaceKind;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::{Joint, JointKind};
use crate::numeric::Quantity;
use crate::task::{Task, TaskCoordinate};
use nalgebra::Vector3;

/// Where the velocity of a point stands for the platform's twist: from the reference point to it, in base directions at
/// home.
pub(super) fn judged_at(
    mechanism: &Mechanism,
    task: &Task,
    independent: &[TaskCoordinate],
) -> Option<Vector3<f64>> {
    let constrained = task.coordinates.len() == 3 && task.upper.kind == SubspaceKind::Identity;
    if !constrained || independent.len() != 2 {
        return None;
    }
    let lengths = independent.iter().all(|c| c.quantity == Quantity::Length);
    match (task.lower.kind, &mechanism.legs[..]) {
        (SubspaceKind::Planar, _) if lengths => Some(Vector3::zeros()),
        (SubspaceKind::Spherical, [one, other]) => {
            let driven = |joints: &[Joint]| joints.iter().any(|joint| joint.actuated);
            let other = if one.joints.len() == 3 { one } else { other };
            let last = other.joints.iter().rfind(|joint| !joint.actuated)?;
            let fits = other.joints.len() == 3 && last.kind == JointKind::Revolute;
            let point = task.lower.origin + last.axis.into_inner();
            (fits && mechanism.legs.iter().all(|leg| driven(&leg.joints)))
                .then(|| point - mechanism.platform)
        }
        _ => None,
    }
}
