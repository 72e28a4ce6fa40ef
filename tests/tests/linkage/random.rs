//! Random double spherical linkages, anywhere in space.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::{ImaginaryLabel, Leg};
use opm_core::mechanism::{Mechanism, TaskHints};
use std::f64::consts::PI;

/// The number of joints that the first leg has about each centre. The second leg has the rest of
/// three. No leg is without joints.
pub const PATTERNS: [[usize; 2]; 14] = [
    [0, 1],
    [0, 2],
    [0, 3],
    [1, 0],
    [1, 1],
    [1, 2],
    [1, 3],
    [2, 0],
    [2, 1],
    [2, 2],
    [2, 3],
    [3, 0],
    [3, 1],
    [3, 2],
];

/// The smallest angle between neighbouring axes of a loop, and between a loop's joint planes and
/// folding: home is well away from singularities.
const CLEAR: f64 = 0.2;

pub fn direction(rng: &mut Rng) -> Unit<Vector3<f64>> {
    loop {
        let v = Vector3::from_fn(|_, _| rng.f64() * 2.0 - 1.0);
        if (0.1..1.0).contains(&v.norm()) {
            return Unit::new_normalize(v);
        }
    }
}

pub fn displacement(rng: &mut Rng) -> Isometry3<f64> {
    let turn = direction(rng).into_inner() * (PI * rng.f64());
    Isometry3::new(direction(rng).into_inner() * (2.0 * rng.f64()), turn)
}

/// Three axes that form a loop with `fourth`, without parallel neighbours and not folded, whichever
/// of its joints drives it.
fn axes(rng: &mut Rng, fourth: Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 3] {
    loop {
        let axes = [direction(rng), direction(rng), direction(rng)];
        let all = [fourth, axes[0], axes[1], axes[2]];
        let clear = (0..4).all(|i| {
            let [a, b, c] = [0, 1, 2].map(|k| all[(i + k) % 4]);
            a.cross(&b).norm() > CLEAR && a.dot(&b.cross(&c)).abs() > CLEAR * CLEAR
        });
        if clear {
            return axes;
        }
    }
}

/// Revolutes through `centre`; some neighbouring ones are combined into a universal joint.
fn joints(
    rng: &mut Rng,
    letter: char,
    axes: &[Unit<Vector3<f64>>],
    centre: Point3<f64>,
) -> Vec<Joint> {
    let mut joints = Vec::new();
    let mut rest = axes;
    while let [axis, after @ ..] = rest {
        let name = format!("{letter}{}", axes.len() - after.len());
        let home = rng.f64() * 4.0 - 2.0;
        let joint = match after {
            [second, after @ ..] if rng.u8(..4) == 0 => {
                rest = after;
                Joint::new(name, JointKind::Universal { second: *second }, *axis, centre)
            }
            _ => {
                rest = after;
                let point = centre + axis.into_inner() * (rng.f64() - 0.5);
                Joint::new(name, JointKind::Revolute, *axis, point)
            }
        };
        joints.push(joint.at(home));
    }
    joints
}

/// A linkage whose first leg has `pattern` joints about the centres.
pub fn linkage(rng: &mut Rng, pattern: [usize; 2]) -> Mechanism {
    let moved = displacement(rng);
    let [near, far] = [Point3::origin(), Point3::new(0.1 + rng.f64(), 0.0, 0.0)].map(|p| moved * p);
    let between = Unit::new_normalize(far - near);
    let (about_near, about_far) = (axes(rng, between), axes(rng, between));
    // Each loop consists of one leg's joints from the base, the other leg's back to it, and the
    // imaginary joint.
    let (one_low, two_low) = about_near.split_at(pattern[0]);
    let (two_up, one_up) = about_far.split_at(3 - pattern[1]);
    let reverse = |axes: &[Unit<Vector3<f64>>]| axes.iter().rev().copied().collect::<Vec<_>>();
    // Lower: imaginary, leg two reversed, leg one. Upper: imaginary, leg two, leg one reversed.
    let (one_low, two_low) = (one_low.to_vec(), reverse(two_low));
    let (one_up, two_up) = (reverse(one_up), two_up.to_vec());
    let mut legs = vec![
        Leg::new(
            "one",
            [joints(rng, 'a', &one_low, near), joints(rng, 'b', &one_up, far)].concat(),
        ),
        Leg::new(
            "two",
            [joints(rng, 'c', &two_low, near), joints(rng, 'd', &two_up, far)].concat(),
        ),
    ];
    if rng.bool() {
        legs.swap(0, 1);
    }
    if rng.u8(..4) == 0 {
        for leg in &mut legs {
            let positive = between.into_inner() * if rng.bool() { 1.0 } else { -1.0 };
            let (name, home) = (format!("theta.{}", leg.name), rng.f64() - 0.5);
            leg.imaginary = Some(ImaginaryLabel { name, home, positive });
        }
    }
    let leg = rng.usize(..2);
    let joint = rng.usize(..legs[leg].joints.len());
    legs[leg].joints[joint].actuated = true;
    Mechanism {
        name: "random".into(),
        legs,
        platform: far,
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}
