//! Where on its axis a joint is drawn.
//!
//! A joint is drawn at the point that the mechanism gives, with two exceptions. A slider is drawn
//! at the joint that it carries, if that joint is on its line or was given the same point. Axes through one centre (the joints of a spherical section) are
//! drawn at equal distances from the centre, because otherwise their links would have no length.

use crate::decomposition::mobility::frame;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::{Joint, JointKind};
use crate::numeric::Quantity;
use nalgebra::{Point3, Vector3};

/// Points closer than this, as a share of the mechanism's size, count as one.
pub(super) const TOUCH: f64 = 1e-6;

/// The distance of joints from a common centre of their axes, as a share of the mechanism's size.
const OUT: f64 = 0.25;

/// The mechanism's size is at least this share of its longest slider's travel, however small its
/// links are.
const TRAVEL: f64 = 0.2;

/// The size of the mechanism for drawing, metres. The joints' points and the platform's are within
/// this distance of each other, unless sliders travel farther.
pub(super) fn size(mechanism: &Mechanism) -> f64 {
    let points: Vec<_> =
        mechanism.joints().map(|joint| joint.point).chain([mechanism.platform]).collect();
    let apart = |p: &Point3<f64>| points.iter().map(|q| (q - p).norm()).fold(0.0, f64::max);
    let across = points.iter().map(apart).fold(0.0, f64::max);
    let lengths = mechanism.coordinates().filter(|c| c.quantity == Quantity::Length);
    let travel = lengths.filter_map(|c| c.limits.map(|[low, high]| high - low));
    let size = travel.map(|travel| TRAVEL * travel).fold(across, f64::max);
    // If all axes pass through one point, the mechanism has no length; any size will do for
    // drawing.
    if size > 0.0 { size } else { frame(mechanism).length }
}

/// The centres of all joints, leg by leg, metres.
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
                // On the side of the previous joint.
                let behind = i > 0 && out.dot(&(centres[i - 1] - joint.point)) < -touch * size;
                centres[i] = joint.point + if behind { -out } else { out };
            }
        }
        let slides = |i: usize| leg.joints[i].kind == JointKind::Prismatic;
        let meets = |i: usize, j: usize| (given[number][i] - given[number][j]).norm() <= touch;
        let count = leg.joints.len();
        for i in (0..count.saturating_sub(1)).rev().filter(|&i| slides(i)) {
            let foot = foot(&leg.joints[i], &centres[i + 1]);
            if (foot - centres[i + 1]).norm() <= touch {
                centres[i] = foot;
            } else if meets(i, i + 1) {
                centres[i] = centres[i + 1];
            }
        }
        // Sliders that carry the platform alone are drawn at the joint that carries them.
        let outer = (0..count).rposition(|i| !slides(i)).map_or(count, |last| last + 1);
        for i in outer..count {
            if meets(i, outer - 1) {
                centres[i] = centres[outer - 1];
            }
        }
    }
    legs
}

/// Sorts points by the angle around their middle.
pub(super) fn around(mut points: Vec<Point3<f64>>) -> Vec<Point3<f64>> {
    let sum: Vector3<f64> = points.iter().map(|p| p.coords).sum();
    let middle = Point3::from(sum / points.len().max(1) as f64);
    let out: Vec<Vector3<f64>> = points.iter().map(|p| p - middle).collect();
    let pairs = out.iter().flat_map(|a| out.iter().map(move |b| (a, a.cross(b))));
    let widest = pairs.max_by(|(_, m), (_, n)| m.norm().total_cmp(&n.norm()));
    if let Some((&x, normal)) = widest {
        let y = normal.normalize().cross(&x);
        let angle = |p: &Point3<f64>| y.dot(&(p - middle)).atan2(x.dot(&(p - middle)));
        points.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    }
    points
}

fn turns_about_axis(joint: &Joint) -> bool {
    match joint.kind {
        JointKind::Revolute | JointKind::Helical { .. } | JointKind::Cylindrical => true,
        JointKind::Prismatic | JointKind::Universal { .. } | JointKind::Spherical => false,
    }
}

/// Whether another joint rotates about the same point, but about another axis.
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

/// The point of a joint's axis nearest to `p`.
fn foot(joint: &Joint, p: &Point3<f64>) -> Point3<f64> {
    let axis: Vector3<f64> = joint.axis.into_inner();
    joint.point + axis * axis.dot(&(p - joint.point))
}
