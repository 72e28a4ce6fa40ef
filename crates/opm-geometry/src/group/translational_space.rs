//! The translational space: all translations, as vectors along the frame's directions in metres. A twist is
//! `(vx, vy, vz)`. A translation that another subspace shares is along the frame's third direction.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{MotionType, SubspaceKind};
use crate::numbers::{Joint, Real, Space};
use nalgebra::{Rotation3, Vector3};

/// The subgroup of all translations.
pub struct TranslationalSpace;

/// A one-parameter translation that another subspace may share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpatialMotion {
    /// Translation along the frame's third direction.
    Translation,
}

impl SpatialMotion {
    /// The product `v · exp(I τ)`, or `exp(I τ) · v`: they commute.
    #[inline(always)]
    pub fn after<T: Real>(&self, v: &T::Space, tau: T::Joint) -> T::Space {
        let [x, y, z] = v.parts();
        match self {
            Self::Translation => T::Space::new(x, y, z + tau.number()),
        }
    }
}

impl Subgroup for TranslationalSpace {
    type Displacement = Vector3<f64>;
    type Intersection = SpatialMotion;

    const KIND: SubspaceKind = SubspaceKind::TranslationalSpace;
    const DIMENSION: usize = 3;
    const COMMUTES: bool = true;

    fn product(first: &Vector3<f64>, second: &Vector3<f64>) -> Vector3<f64> {
        first + second
    }

    fn inverse(t: &Vector3<f64>) -> Vector3<f64> {
        -t
    }

    fn exponential(twist: &LocalTwist) -> Vector3<f64> {
        *twist
    }

    fn logarithm(t: &Vector3<f64>) -> LocalTwist {
        *t
    }

    #[inline]
    fn adjoint(_: &Vector3<f64>, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn adjoint_of_inverse(_: &Vector3<f64>, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn bracket(_: &LocalTwist, _: &LocalTwist) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn act(t: &Vector3<f64>, point: &Vector3<f64>) -> Vector3<f64> {
        point + t
    }

    fn rotation_and_translation(t: &Vector3<f64>) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::identity(), *t)
    }

    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2] {
        [Vector3::zeros(), *twist]
    }

    fn is_translation(_: &LocalTwist) -> bool {
        true
    }

    fn size(t: &Vector3<f64>) -> f64 {
        t.norm()
    }

    fn motion(_: &Vector3<f64>, motion: MotionType) -> SpatialMotion {
        match motion {
            MotionType::Rotation => panic!("a translational space contains no rotation"),
            MotionType::Translation => SpatialMotion::Translation,
        }
    }

    #[inline]
    fn unit_twist(motion: &SpatialMotion) -> LocalTwist {
        match motion {
            SpatialMotion::Translation => LocalTwist::z(),
        }
    }

    fn complement(motion: &SpatialMotion) -> Vec<LocalTwist> {
        match motion {
            SpatialMotion::Translation => vec![LocalTwist::x(), LocalTwist::y()],
        }
    }

    fn path(motion: &SpatialMotion, b: &Vector3<f64>) -> Path {
        Path::Spatial { start: *b, rate: Self::unit_twist(motion) }
    }
}
