//! The cylindrical subgroup: rotations about and translations along one axis, the frame's third direction.
//! They commute. Angles count full revolutions, because a screw on the axis advances with each of them. A
//! twist is `(ω, v, 0)`.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{MotionType, SubspaceKind};
use crate::numbers::{Joint, Real};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Rotation3, Vector3};

/// The cylindrical subgroup.
pub struct Cylindrical;

/// A rotation about an axis and a translation along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylindricalDisplacement<T = f64> {
    /// The angle of rotation in radians; full revolutions count.
    pub angle: T,
    /// The translation along the axis, metres.
    pub advance: T,
}

/// A one-parameter motion about or along the axis that another subspace may share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CylindricalMotion {
    /// Rotation about the axis.
    Rotation,
    /// Translation along the axis.
    Translation,
}

impl CylindricalMotion {
    /// The product `v · exp(I τ)`, or `exp(I τ) · v`: they commute.
    #[inline(always)]
    pub fn after<T: Real>(
        &self,
        v: &CylindricalDisplacement<T>,
        tau: T::Joint,
    ) -> CylindricalDisplacement<T> {
        match self {
            Self::Rotation => CylindricalDisplacement { angle: v.angle + tau.number(), ..*v },
            Self::Translation => {
                CylindricalDisplacement { advance: v.advance + tau.number(), ..*v }
            }
        }
    }
}

impl Subgroup for Cylindrical {
    type Displacement = CylindricalDisplacement;
    type Intersection = CylindricalMotion;

    const KIND: SubspaceKind = SubspaceKind::Cylindrical;
    const DIMENSION: usize = 2;
    const COMMUTES: bool = true;

    fn product(
        first: &CylindricalDisplacement,
        second: &CylindricalDisplacement,
    ) -> CylindricalDisplacement {
        CylindricalDisplacement {
            angle: first.angle + second.angle,
            advance: first.advance + second.advance,
        }
    }

    fn inverse(g: &CylindricalDisplacement) -> CylindricalDisplacement {
        CylindricalDisplacement { angle: -g.angle, advance: -g.advance }
    }

    fn exponential(twist: &LocalTwist) -> CylindricalDisplacement {
        CylindricalDisplacement { angle: twist.x, advance: twist.y }
    }

    fn logarithm(g: &CylindricalDisplacement) -> LocalTwist {
        LocalTwist::new(g.angle, g.advance, 0.0)
    }

    #[inline]
    fn adjoint(_: &CylindricalDisplacement, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn adjoint_of_inverse(_: &CylindricalDisplacement, twist: &LocalTwist) -> LocalTwist {
        *twist
    }

    #[inline]
    fn bracket(_: &LocalTwist, _: &LocalTwist) -> LocalTwist {
        LocalTwist::zeros()
    }

    #[inline]
    fn act(g: &CylindricalDisplacement, point: &Vector3<f64>) -> Vector3<f64> {
        let z = unit(g.angle) * Complex::new(point.x, point.y);
        Vector3::new(z.re, z.im, point.z + g.advance)
    }

    fn rotation_and_translation(g: &CylindricalDisplacement) -> (Rotation3<f64>, Vector3<f64>) {
        (Rotation3::from_axis_angle(&Vector3::z_axis(), g.angle), Vector3::z() * g.advance)
    }

    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2] {
        [Vector3::z() * twist.x, Vector3::z() * twist.y]
    }

    fn is_translation(twist: &LocalTwist) -> bool {
        twist.x == 0.0
    }

    fn size(g: &CylindricalDisplacement) -> f64 {
        g.angle.abs().max(g.advance.abs())
    }

    fn motion(_: &Vector3<f64>, motion: MotionType) -> CylindricalMotion {
        match motion {
            MotionType::Rotation => CylindricalMotion::Rotation,
            MotionType::Translation => CylindricalMotion::Translation,
        }
    }

    #[inline]
    fn unit_twist(motion: &CylindricalMotion) -> LocalTwist {
        match motion {
            CylindricalMotion::Rotation => LocalTwist::x(),
            CylindricalMotion::Translation => LocalTwist::y(),
        }
    }

    fn complement(motion: &CylindricalMotion) -> Vec<LocalTwist> {
        match motion {
            CylindricalMotion::Rotation => vec![LocalTwist::y()],
            CylindricalMotion::Translation => vec![LocalTwist::x()],
        }
    }

    fn path(motion: &CylindricalMotion, b: &CylindricalDisplacement) -> Path {
        Path::Cylindrical { start: *b, rate: Self::exponential(&Self::unit_twist(motion)) }
    }
}
