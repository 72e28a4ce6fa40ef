//! The twists of `v` and `b` from the rates of the task coordinates.
//!
//! Both displacements are products of exponentials of their coordinates, relative to home, in the order of
//! the table in [`crate::task`]: `(x, y, theta)` are two translations and a rotation, `(zeta, xi, psi)` are
//! rotations about z, y and z, and `(mu, nu)` are rotations about x and y. [`Screws`] gives their
//! derivatives. Tilt and torsion are no such displacements, but Euler angles are linear in them; roll, pitch and yaw are
//! rotations about x, y and z in the opposite order.

use super::screws::Screws;
use crate::group::{
    CylindricalMotion, IntersectionMotion, LocalTwist, PlanarMotion, SphericalMotion, SubspaceKind,
};
use crate::mechanism::OrientationCoordinates;
use crate::mechanism::leg::Section;
use crate::numeric::angle::unit;
use crate::task::Task;
use nalgebra::Complex;

impl Task {
    /// The rates of a section's screws for those of its coordinates other than a height, or the accelerations.
    #[inline]
    pub(crate) fn screw_rates(&self, section: Section, rates: LocalTwist) -> LocalTwist {
        if self.oriented_section() == Some(section) {
            self.angles.to_factors(rates.into()).into()
        } else {
            rates
        }
    }

    /// The screws of the coordinates of `v` at a pose, in the frame of the lower section; of an orientation, those of the
    /// rotations whose product it is.
    pub(crate) fn lower_screws(&self, pose: &[f64]) -> Screws {
        let q = |i: usize| pose[i] - self.coordinates[i].home;
        let zero = LocalTwist::zeros();
        let moved = match self.lower_intersection {
            IntersectionMotion::None(kind) => self.alone(kind, pose, q),
            IntersectionMotion::Planar(PlanarMotion::Rotation) => {
                [LocalTwist::y(), LocalTwist::z(), zero]
            }
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => planar(q(0), q(1)),
            IntersectionMotion::Spherical(SphericalMotion::Rotation) => {
                let e = unit(q(0));
                [LocalTwist::x(), LocalTwist::new(0.0, e.re, e.im), zero]
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => {
                [LocalTwist::y(), zero, zero]
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation)
            | IntersectionMotion::Translational(_) => [LocalTwist::x(), LocalTwist::y(), zero],
            IntersectionMotion::Spatial(_) => [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()],
        };
        Screws { kind: self.lower.kind, moved }
    }

    /// The screws of the coordinates of `b` at a pose (the task coordinates of both sections), in the frame
    /// of the upper section.
    pub(crate) fn upper_screws(&self, pose: &[f64]) -> Screws {
        let at = |i: usize| pose[self.lower_count + i];
        let q = |i: usize| at(i) - self.coordinates[self.lower_count + i].home;
        let zero = LocalTwist::zeros();
        let moved = match self.upper_intersection {
            IntersectionMotion::None(kind) => self.alone(kind, &pose[self.lower_count..], q),
            IntersectionMotion::Spherical(SphericalMotion::Rotation) => {
                self.orientation_screws([at(0), at(1), at(2)])
            }
            IntersectionMotion::Planar(PlanarMotion::Rotation) => planar(q(0), q(1)),
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => {
                let [_, second, third] = planar(0.0, q(0));
                [second, third, zero]
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => {
                [LocalTwist::x(), LocalTwist::y(), zero]
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => {
                [LocalTwist::x(), zero, zero]
            }
            IntersectionMotion::Translational(_) => [LocalTwist::y(), zero, zero],
            IntersectionMotion::Spatial(_) => [LocalTwist::x(), LocalTwist::y(), zero],
        };
        Screws { kind: self.upper.kind, moved }
    }

    /// The screws of the coordinates of a section that shares no motion with the other one. `pose` begins with its
    /// coordinates, and `q` gives them minus their values at home.
    fn alone(&self, kind: SubspaceKind, pose: &[f64], q: impl Fn(usize) -> f64) -> [LocalTwist; 3] {
        let zero = LocalTwist::zeros();
        match kind {
            SubspaceKind::Identity => [zero; 3],
            SubspaceKind::Planar => planar(q(0), q(1)),
            SubspaceKind::Spherical => self.orientation_screws([pose[0], pose[1], pose[2]]),
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => {
                [LocalTwist::x(), LocalTwist::y(), zero]
            }
            SubspaceKind::TranslationalSpace => [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()],
        }
    }

    /// The screws of the three rotations whose product is an orientation: about the third direction, the second one, and
    /// the third or, of roll, pitch and yaw, the first.
    fn orientation_screws(&self, angles: [f64; 3]) -> [LocalTwist; 3] {
        let [first, second, _] = self.angles.to_factors(angles).map(unit);
        let level = match self.angles {
            OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => second,
            // The first direction is the third one, rotated about the second by a right angle.
            OrientationCoordinates::RollPitchYaw => Complex::new(-second.im, second.re),
        };
        let last = LocalTwist::new(first.re * level.im, first.im * level.im, level.re);
        [LocalTwist::z(), LocalTwist::new(-first.im, first.re, 0.0), last]
    }
}

/// The screws of two translations along the directions of the plane, followed by a rotation about the point
/// that they have moved to.
fn planar(x: f64, y: f64) -> [LocalTwist; 3] {
    [LocalTwist::y(), LocalTwist::z(), LocalTwist::new(1.0, y, -x)]
}
