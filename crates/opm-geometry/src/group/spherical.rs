//! The spherical subgroup, `SO(3)`: rotations about a centre, as matrices. A twist is the angular velocity.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{MotionType, SubspaceKind};
use crate::numbers::{Joint, Real, Rotation};
use crate::numeric::angle::atan2;
use nalgebra::{Complex, Matrix3, Rotation3, Vector3};

/// The spherical subgroup.
pub struct Spherical;

/// A one-parameter spherical motion that another subspace may share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SphericalMotion {
    /// Rotation about the frame's third direction.
    Rotation,
}

impl SphericalMotion {
    /// The product `v · exp(I τ)`.
    #[inline(always)]
    pub fn after<T: Real>(&self, v: &T::Rotation, tau: T::Joint) -> T::Rotation {
        match self {
            Self::Rotation => v.after_turn(tau.unit()),
        }
    }

    /// The product `exp(I τ) · b`.
    #[inline(always)]
    pub fn before<T: Real>(&self, b: &T::Rotation, tau: T::Joint) -> T::Rotation {
        match self {
            Self::Rotation => b.before_turn(tau.unit()),
        }
    }
}

/// The rotation about a unit axis by an angle, which is given as the unit complex number `e(angle)`
/// (Rodrigues' formula).
pub fn rotation_about(axis: &Vector3<f64>, angle: Complex<f64>) -> Matrix3<f64> {
    let (cos, sin) = (angle.re, angle.im);
    Matrix3::from_diagonal_element(cos)
        + axis.cross_matrix() * sin
        + axis * axis.transpose() * (1.0 - cos)
}

/// The vector `v` rotated about a unit axis by an angle, which is given as the unit complex number
/// `e(angle)`.
#[inline]
pub fn rotated(axis: &Vector3<f64>, angle: Complex<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    v * angle.re + axis.cross(v) * angle.im + axis * (axis.dot(v) * (1.0 - angle.re))
}

/// The rotation vector of `r`, whose angle is at most π. The entries of `r` give four multiples of its
/// quaternion, of which the longest is used.
#[inline(always)]
pub fn rotation_vector(r: &Matrix3<f64>) -> Vector3<f64> {
    let [xx, yy, zz] = [r[(0, 0)], r[(1, 1)], r[(2, 2)]];
    // Four times the products of two components of the quaternion (w, x, y, z), and four times their
    // squares.
    let (wx, wy, wz) = (r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    let (xy, xz, yz) = (r[(0, 1)] + r[(1, 0)], r[(0, 2)] + r[(2, 0)], r[(1, 2)] + r[(2, 1)]);
    let (ww, xx, yy, zz) =
        (1.0 + (xx + yy + zz), 1.0 + (xx - yy - zz), 1.0 + (yy - xx - zz), 1.0 + (zz - xx - yy));
    // Each is a square and its multiple of the quaternion.
    let longer = |a: [f64; 5], b: [f64; 5]| {
        let longer = b[0] > a[0];
        // Without a loop over the numbers, the loop over many rotations is vectorised.
        let pick = |i: usize| if longer { b[i] } else { a[i] };
        [pick(0), pick(1), pick(2), pick(3), pick(4)]
    };
    let found = longer([ww, ww, wx, wy, wz], [xx, wx, xx, xy, xz]);
    let found = longer(found, [yy, wy, xy, yy, yz]);
    let [_, w, x, y, z] = longer(found, [zz, wz, xz, yz, zz]);
    let length = (x * x + y * y + z * z).sqrt();
    let angle = 2.0 * atan2(length, w.abs());
    let scale = angle / if length > 0.0 { length } else { 1.0 };
    Vector3::new(x, y, z) * if w < 0.0 { -scale } else { scale }
}

impl Subgroup for Spherical {
    type Displacement = Matrix3<f64>;
    type Intersection = SphericalMotion;

    const KIND: SubspaceKind = SubspaceKind::Spherical;
    const DIMENSION: usize = 3;
    const COMMUTES: bool = false;

    #[inline]
    fn product(first: &Matrix3<f64>, second: &Matrix3<f64>) -> Matrix3<f64> {
        first * second
    }

    #[inline]
    fn inverse(r: &Matrix3<f64>) -> Matrix3<f64> {
        r.transpose()
    }

    fn exponential(twist: &LocalTwist) -> Matrix3<f64> {
        Rotation3::new(*twist).into_inner()
    }

    fn logarithm(r: &Matrix3<f64>) -> LocalTwist {
        rotation_vector(r)
    }

    #[inline]
    fn adjoint(r: &Matrix3<f64>, twist: &LocalTwist) -> LocalTwist {
        r * twist
    }

    #[inline]
    fn adjoint_of_inverse(r: &Matrix3<f64>, twist: &LocalTwist) -> LocalTwist {
        r.tr_mul(twist)
    }

    #[inline]
    fn bracket(a: &LocalTwist, b: &LocalTwist) -> LocalTwist {
        a.cross(b)
    }

    #[inline]
    fn act(r: &Matrix3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
        r * point
    }

    fn rotation_and_translation(r: &Matrix3<f64>) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::from_matrix_unchecked(*r), Vector3::zeros())
    }

    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2] {
        [*twist, Vector3::zeros()]
    }

    fn is_translation(_: &LocalTwist) -> bool {
        false
    }

    fn size(_: &Matrix3<f64>) -> f64 {
        0.0
    }

    fn motion(_: &Vector3<f64>, motion: MotionType) -> SphericalMotion {
        match motion {
            MotionType::Rotation => SphericalMotion::Rotation,
            MotionType::Translation => panic!("a spherical subspace contains no translation"),
        }
    }

    #[inline]
    fn unit_twist(motion: &SphericalMotion) -> LocalTwist {
        match motion {
            SphericalMotion::Rotation => LocalTwist::z(),
        }
    }

    fn complement(motion: &SphericalMotion) -> Vec<LocalTwist> {
        match motion {
            SphericalMotion::Rotation => vec![LocalTwist::x(), LocalTwist::y()],
        }
    }

    fn path(motion: &SphericalMotion, b: &Matrix3<f64>) -> Path {
        match motion {
            SphericalMotion::Rotation => Path::Spherical { start: *b, axis: Vector3::z() },
        }
    }
}
