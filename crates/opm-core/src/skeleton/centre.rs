//! Where on its axis a joint is drawn.
//!
//! At the point that the mechanism gives it, with two exceptions. A slider goes to where the next
//! joint stands on it. And axes of one centre (the joints of a spherical section) are drawn each at
//! the same distance out from there, or all of their links would have no length.

use crate::joint::{Joint, JointKind};
use crate::mechanism::Mechanism;
use nalgebra::{Point3, Vector3};

/// Points closer than this, as a share of the mechanism's size, are one.
pub(super) const TOUCH: f64 = 1e-6;

/// How far out from a common centre its axes' joints are, as a share of the mechanism's size.
const OUT: f64 = 0.35;

/// Centres of every joint, leg by leg.
pub(super) fn centres(mechanism: &Mechanism, size: f64) -> Vec<Vec<Point3<f64>>> {
    let touch = TOUCH * size;
    let mut legs: Vec<Vec<_>> = mechanism
        .legs
        .iter()
        .map(|leg| leg.joints.iter().map(|joint| joint.point).collect())
        .collect();
    let given = legs.clone();
    for (number, (leg, centres)) in mechanism.legs.iter().zip(&mut legs).enumerate() {
        for (i, joint) in leg.joints.iter().enumerate() {
            let crowded = turns_about_axis(joint)
                && (crowd(mechanism, &given, [number, i], touch)
                    || (i + 1 == leg.joints.len()
                        && (joint.point - mechanism.platform).norm() <= touch));
            if crowded {
                let out = joint.axis.into_inner() * (OUT * size);
                // On the side of the joint before.
                let behind = i > 0 && out.dot(&(centres[i - 1] - joint.point)) < -touch * size;
                centres[i] = joint.point + if behind { -out } else { out };
            }
        }
        for i in (0..leg.joints.len().saturating_sub(1)).rev() {
            let joint = &leg.joints[i];
            if joint.kind == JointKind::Prismatic {
                let foot = foot(joint, &centres[i + 1]);
                if (foot - centres[i + 1]).norm() <= touch {
                    centres[i] = foot;
                }
            }
        }
    }
    legs
}

fn turns_about_axis(joint: &Joint) -> bool {
    match joint.kind {
        JointKind::Revolute | JointKind::Helical { .. } | JointKind::Cylindrical => true,
        JointKind::Prismatic | JointKind::Universal { .. } | JointKind::Spherical => false,
    }
}

/// Whether another joint turns about the same point, but about another axis.
fn crowd(mechanism: &Mechanism, given: &[Vec<Point3<f64>>], own: [usize; 2], touch: f64) -> bool {
    let joint = &mechanism.legs[own[0]].joints[own[1]];
    let point = given[own[0]][own[1]];
    mechanism.legs.iter().enumerate().any(|(number, leg)| {
        leg.joints.iter().enumerate().any(|(i, other)| {
            let same = [number, i] == own;
            let near = (given[number][i] - point).norm() <= touch;
            let across = !turns_about_axis(other) || joint.axis.cross(&other.axis).norm() > TOUCH;
            !same && near && across && other.kind != JointKind::Prismatic
        })
    })
}

/// The point of a joint's axis that is nearest to `p`.
fn foot(joint: &Joint, p: &Point3<f64>) -> Point3<f64> {
    let axis: Vector3<f64> = joint.axis.into_inner();
    joint.point + axis * axis.dot(&(p - joint.point))
}
