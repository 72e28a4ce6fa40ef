//! Closure of the legs as they stand in the mechanism, without any decomposition.

use nalgebra::Isometry3;
use opm_core::manipulator::Manipulator;

/// How far two displacements are apart: entries of their matrices, the platform's way over the size.
pub fn apart(m: &Manipulator, a: &Isometry3<f64>, b: &Isometry3<f64>) -> f64 {
    let turn =
        a.rotation.to_rotation_matrix().into_inner() - b.rotation.to_rotation_matrix().into_inner();
    let point = m.mechanism().platform;
    turn.amax().max((a * point - b * point).amax() / m.characteristic_length())
}

/// By how much the legs miss the platform: each is a product of the exponentials of its joints. Infinite where
/// the values do not fit the joints.
pub fn gap(m: &Manipulator, joints: &[f64], target: &Isometry3<f64>) -> f64 {
    let mut joints = joints;
    m.mechanism().legs.iter().fold(0.0, |worst: f64, leg| {
        let Some((own, rest)) = joints.split_at_checked(leg.coordinates().count()) else {
            return f64::INFINITY;
        };
        joints = rest;
        let end = leg.displacement(own);
        worst.max(end.map_or(f64::INFINITY, |end| apart(m, &end, target)))
    })
}
