//! Inputs that iterations and case distinctions trip over, and random ones never hit: half and quarter turns,
//! rotations about coordinate axes and diagonals, zeros, home, whole turns, and values a rounding away from these.

use crate::displace::displace;
use fastrand::Rng;
use nalgebra::{Isometry3, Matrix3, Quaternion, Translation3, UnitQuaternion, Vector3};
pub use opm_check::closure::{apart, gap};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{Mechanism, examples, file};
use std::f64::consts::PI;

/// The 13 lines through the middle of a cube and of its faces, edges and corners; unit vectors.
pub fn axes() -> Vec<Vector3<f64>> {
    let part = |number: usize, place: u32| (number / 3_usize.pow(place) % 3) as f64 - 1.0;
    let all = (0..27).map(|n| Vector3::new(part(n, 0), part(n, 1), part(n, 2)));
    // Of each line the direction whose last part that is not zero is positive.
    let sign = |v: &Vector3<f64>| v.iter().rev().find(|part| **part != 0.0).copied();
    all.filter(|v| sign(v) == Some(1.0)).map(|v| v.normalize()).collect()
}

/// Angles that decide cases: multiples of an eighth and a sixth of a turn up to two turns, and these with a
/// little more or less.
pub fn angles() -> Vec<f64> {
    let exact = (-16..=16).map(|n| f64::from(n) * PI / 4.0);
    let sixths = (-6..=6).map(|n| f64::from(n) * PI / 3.0);
    let near = [0.0, PI / 2.0, PI, -PI, 2.0 * PI].into_iter().flat_map(|angle| {
        [1e-16, 1e-13, 1e-10, 1e-7, 1e-4].into_iter().flat_map(move |by| [angle + by, angle - by])
    });
    exact.chain(sixths).chain(near).collect()
}

/// The rotation matrix about a unit axis, by Rodrigues' formula, with sines and cosines of quarter turns exact.
pub fn matrix(axis: &Vector3<f64>, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = sin_cos(angle);
    Matrix3::identity() * cos + axis.cross_matrix() * sin + axis * axis.transpose() * (1.0 - cos)
}

/// The quaternion about a unit axis, with those of half turns exact.
pub fn quaternion(axis: &Vector3<f64>, angle: f64) -> UnitQuaternion<f64> {
    let (sin, cos) = sin_cos(0.5 * angle);
    UnitQuaternion::new_normalize(Quaternion::from_parts(cos, axis * sin))
}

/// Sine and cosine, zero where the angle is the number next to a multiple of a quarter turn.
fn sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    let exact = |value: f64| if value.abs() < 1e-15 { 0.0 } else { value };
    (exact(sin), exact(cos))
}

/// Rotations about every axis of [`axes`] by every angle of [`angles`].
pub fn rotations() -> Vec<UnitQuaternion<f64>> {
    let angles = angles();
    axes().iter().flat_map(|axis| angles.iter().map(|&angle| quaternion(axis, angle))).collect()
}

/// A rotation of [`rotations`], and a translation with zeros.
pub fn displacement(rng: &mut Rng) -> Isometry3<f64> {
    let (axes, angles) = (axes(), angles());
    let rotation = quaternion(&axes[rng.usize(..axes.len())], angles[rng.usize(..angles.len())]);
    let way = Vector3::from_fn(|_, _| [0.0, 0.0, 1.0, -1.0, 0.5][rng.usize(..5)]);
    Isometry3::from_parts(Translation3::from(way), rotation)
}

/// A pose of special values: of each coordinate home or zero, home and more by a special angle or by a length
/// out of a few.
pub fn pose(rng: &mut Rng, manipulator: &Manipulator) -> Vec<f64> {
    let (angles, size) = (angles(), manipulator.characteristic_length());
    // All coordinates of some poses are near home, where most are in reach.
    let near = rng.bool();
    let coordinates = manipulator.task_coordinates().iter();
    coordinates
        .map(|c| match (rng.u32(..4), c.quantity) {
            (0, _) => c.home,
            (1, _) => 0.0,
            (_, Quantity::Angle) if near => {
                c.home + [PI / 6.0, -PI / 6.0, 1e-9, -1e-13][rng.usize(..4)]
            }
            (2, Quantity::Angle) => c.home + angles[rng.usize(..angles.len())],
            (_, Quantity::Angle) => angles[rng.usize(..angles.len())],
            (_, Quantity::Length) => {
                c.home + size * [0.125, -0.125, 0.5, -0.25, 1e-12][rng.usize(..5)]
            }
        })
        .collect()
}

/// A pose of which the angles are whole numbers of quarter turns, and the lengths as in [`pose`].
pub fn quarter_turns(rng: &mut Rng, manipulator: &Manipulator) -> Vec<f64> {
    let lengths = pose(rng, manipulator);
    let coordinates = manipulator.task_coordinates().iter().zip(lengths);
    coordinates
        .map(|(c, length)| match c.quantity {
            Quantity::Angle => f64::from(rng.i32(-2..=2)) * PI / 2.0,
            Quantity::Length => length,
        })
        .collect()
}

/// Every shipped mechanism that compiles, without limits.
pub fn mechanisms() -> Vec<Mechanism> {
    let read = |text: &str| file::read(text).map(|read| read.mechanism);
    let all = examples::EXAMPLES.iter().filter_map(|example| read(example.text).ok());
    all.filter(|mechanism| Manipulator::new(mechanism.clone()).is_ok()).map(unlimited).collect()
}

/// Every mechanism of [`mechanisms`], compiled.
pub fn manipulators() -> Vec<Manipulator> {
    mechanisms().into_iter().filter_map(|mechanism| Manipulator::new(mechanism).ok()).collect()
}

/// A mechanism without limits.
pub fn unlimited(mut mechanism: Mechanism) -> Mechanism {
    let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    joints.flat_map(|joint| &mut joint.coordinates).for_each(|c| c.limits = None);
    mechanism
}

/// A mechanism after quarter, half and third turns about axes and diagonals, whose matrices have zeros, every other time
/// moved away from the origin; each with the displacement that puts it there.
pub fn placed(mechanism: &Mechanism) -> Vec<(Isometry3<f64>, Mechanism)> {
    let mut places = Vec::new();
    for (number, axis) in axes().iter().enumerate() {
        for angle in [PI / 2.0, PI, -2.0 * PI / 3.0] {
            let way = [Vector3::zeros(), Vector3::new(1.0, 0.0, -2.0)][number % 2];
            let g = Isometry3::from_parts(Translation3::from(way), quaternion(axis, angle));
            places.push((g, displace(mechanism, &g)));
        }
    }
    places
}
