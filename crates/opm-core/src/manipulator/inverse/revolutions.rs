//! How many full revolutions a reported angle has, and a reported rotation vector.

use crate::group::{JointDisplacement, nearest};
use crate::manipulator::section::CompiledSection;
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// How the number of full revolutions of a reported angle is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::manipulator) enum Revolutions {
    /// The angle is within π of home, or within the limits where that is possible.
    NearHome,
    /// The angle is the one nearest to the value that the buffer holds.
    NearHeld,
}

impl Revolutions {
    #[inline(always)]
    pub(super) fn near(self, held: f64, home: f64) -> f64 {
        match self {
            Self::NearHome => home,
            Self::NearHeld => held,
        }
    }

    /// An angle within π of home, or the same one nearest to the displacement that the buffer holds.
    #[inline(always)]
    pub(super) fn place(self, angle: f64, held: f64) -> f64 {
        match self {
            Self::NearHome => angle,
            Self::NearHeld => nearest(angle, held),
        }
    }
}

/// The rotation vector nearest to `reference` among those of the same rotation, which differ by full
/// revolutions.
fn nearest_rotation(vector: Vector3<f64>, reference: &Vector3<f64>) -> Vector3<f64> {
    /// A rotation by a smaller angle is the identity up to rounding, and its axis is arbitrary.
    const NONE: f64 = 1e-14;
    let angle = vector.norm();
    if angle < NONE {
        // Full revolutions about any axis are the identity: the nearest axis is that of the reference.
        let turns = (reference.norm() / TAU).round();
        return if turns == 0.0 { vector } else { reference.normalize() * (TAU * turns) };
    }
    let axis = vector / angle;
    let turns = (reference.dot(&axis) - angle) / TAU;
    // A rotation by π is as near as its opposite: it is not changed.
    if turns.abs() <= 0.5 { vector } else { axis * (angle + TAU * turns.round()) }
}

/// Writes the rotation vector of a spherical joint that is nearest to the values that are there. Returns whether it is
/// within its limits.
pub(super) fn write_ball_near(
    section: &CompiledSection,
    displacements: &[JointDisplacement; 3],
    joints: &mut [f64],
) -> bool {
    let [Some(x), Some(y), Some(z)] = &section.coordinates else { return true };
    let own = [x, y, z];
    let near = Vector3::from_fn(|i, _| joints[own[i].number] - own[i].home);
    let vector = nearest_rotation(Vector3::from_fn(|i, _| displacements[i].value()), &near);
    let mut within = true;
    for (joint, &value) in own.into_iter().zip(&vector) {
        within &= joint.limits.admits(JointDisplacement::Value(value));
        joints[joint.number] = joint.home + value;
    }
    within
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Limits are tested on the vector that the closed form gives, so that the reported one must be the same.
    #[test]
    fn a_rotation_by_pi_is_not_changed() {
        for half in [Vector3::z() * PI, Vector3::z() * -PI] {
            assert_eq!(nearest_rotation(half, &Vector3::zeros()), half);
            assert_eq!(nearest_rotation(half, &half), half);
        }
        let beyond = nearest_rotation(Vector3::z() * (0.1 - PI), &(Vector3::z() * PI));
        assert!((beyond - Vector3::z() * (0.1 + PI)).norm() < 1e-12);
    }

    /// A spherical joint that keeps rotating passes through a full revolution, where its rotation is the
    /// identity.
    #[test]
    fn a_full_revolution_does_not_jump_to_zero() {
        let round = Vector3::new(0.6, 0.0, -0.8) * TAU;
        for rounding in [Vector3::zeros(), Vector3::x() * 1e-16, Vector3::new(0.0, -3e-16, 1e-16)] {
            for before in [round * 0.999, round, round * 1.001, round * -2.0] {
                let turns = (before.dot(&round) / TAU / TAU).round();
                let found = nearest_rotation(rounding, &before);
                assert!((found - round * turns).norm() < 1e-14, "{rounding} {before}: {found}");
            }
            assert_eq!(nearest_rotation(rounding, &(round * 0.4)), rounding);
        }
    }
}
