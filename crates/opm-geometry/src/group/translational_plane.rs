//! The translational plane: translations along the frame's first two directions, as complex numbers in
//! metres. A twist is `(vx, vy, 0)`.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{MotionType, SubspaceKind, quarter};
use crate::numbers::{Joint, Over, Plane, PlaneOver};
use nalgebra::{Complex, Rotation3, Vector3};

/// The subgroup of the translations in a plane.
pub struct TranslationalPlane;

/// A one-parameter translation in the plane that another subspace may share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TranslationalMotion<Z = Complex<f64>> {
    /// Translation along a direction of the plane, which is a unit complex number.
    Translation(Z),
}

impl<Z: Plane> TranslationalMotion<Z> {
    /// The product `v · exp(I τ)`, or `exp(I τ) · v`: they commute.
    #[inline(always)]
    pub fn after<T: Over<Z::Real>>(&self, v: &T::Plane, tau: T::Joint) -> T::Plane {
        match *self {
            Self::Translation(along) => *v + T::Plane::from_constant(along).scaled(tau.number()),
        }
    }
}

impl Subgroup for TranslationalPlane {
    type Displacement = Complex<f64>;
    type Intersection = TranslationalMotion;

    const KIND: SubspaceKind = SubspaceKind::TranslationalPlane;
    const DIMENSION: usize = 2;
    const COMMUTES: bool = true;

    fn product(first: &Complex<f64>, second: &Complex<f64>) -> Complex<f64> {
        first + second
    }

    fn inverse(t: &Complex<f64>) -> Complex<f64> {
        -t
    }

    fn exponential(twist: &LocalTwist) -> Complex<f64> {
        Complex::new(twist.x, twist.y)
    }

    fn logarithm(t: &Complex<f64>) -> LocalTwist {
        LocalTwist::new(t.re, t.im, 0.0)
    }

    #[inline]
    fn adjoint(_: &Complex<f64>, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn adjoint_of_inverse(_: &Complex<f64>, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn bracket(_: &LocalTwist, _: &LocalTwist) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn act(t: &Complex<f64>, point: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(point.x + t.re, point.y + t.im, point.z)
    }

    fn rotation_and_translation(t: &Complex<f64>) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::identity(), Vector3::new(t.re, t.im, 0.0))
    }

    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2] {
        [Vector3::zeros(), Vector3::new(twist.x, twist.y, 0.0)]
    }

    fn is_translation(_: &LocalTwist) -> bool {
        true
    }

    fn size(t: &Complex<f64>) -> f64 {
        t.norm()
    }

    fn motion(direction: &Vector3<f64>, motion: MotionType) -> TranslationalMotion {
        match motion {
            MotionType::Rotation => panic!("a translational plane contains no rotation"),
            MotionType::Translation => {
                TranslationalMotion::Translation(Complex::new(direction.x, direction.y))
            }
        }
    }

    #[inline]
    fn unit_twist(motion: &TranslationalMotion) -> LocalTwist {
        match motion {
            TranslationalMotion::Translation(along) => LocalTwist::new(along.re, along.im, 0.0),
        }
    }

    fn complement(motion: &TranslationalMotion) -> Vec<LocalTwist> {
        match motion {
            TranslationalMotion::Translation(along) => {
                let across = quarter(*along);
                vec![LocalTwist::new(across.re, across.im, 0.0)]
            }
        }
    }

    fn path(motion: &TranslationalMotion, b: &Complex<f64>) -> Path {
        match motion {
            TranslationalMotion::Translation(along) => {
                Path::Translational { start: *b, rate: *along }
            }
        }
    }
}
