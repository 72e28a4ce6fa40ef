//! Twists inside one subspace, in the subspace's own frame: three numbers at most.
//!
//! `(ω, vx, vy)` in a plane, with the velocity of the point at the frame's origin; `ω` in a sphere;
//! `(ω, v, 0)` about and along a cylinder's axis; `(vx, vy, 0)` in a translational plane.

use crate::chain::Amount;
use crate::chain::cylindrical::CylindricalDisplacement;
use crate::chain::planar::PlanarDisplacement;
use crate::task::{Cut, Displacement, Subspace, SubspaceKind};
use nalgebra::{Complex, Matrix3, Point3, Vector3};

/// A twist in its subspace's frame.
pub(crate) type Local = Vector3<f64>;

/// The linear part of a planar twist as a complex number.
#[inline]
pub(crate) fn linear(twist: &Local) -> Complex<f64> {
    Complex::new(twist.y, twist.z)
}

#[inline]
pub(crate) fn planar(omega: f64, v: Complex<f64>) -> Local {
    Local::new(omega, v.re, v.im)
}

/// A quarter turn counter-clockwise.
#[inline]
pub(crate) fn quarter(z: Complex<f64>) -> Complex<f64> {
    Complex::new(-z.im, z.re)
}

impl SubspaceKind {
    /// Lie bracket: how the second twist changes when it is carried along by the first.
    #[inline]
    pub(crate) fn bracket(self, a: &Local, b: &Local) -> Local {
        match self {
            Self::Planar => planar(0.0, quarter(linear(b)) * a.x - quarter(linear(a)) * b.x),
            Self::Spherical => a.cross(b),
            Self::Cylindrical | Self::TranslationalPlane => Local::zeros(),
        }
    }

    pub(crate) fn identity(self) -> Displacement {
        match self {
            Self::Planar => Displacement::Planar(PlanarDisplacement::IDENTITY),
            Self::Spherical => Displacement::Spherical(Matrix3::identity()),
            Self::Cylindrical => {
                Displacement::Cylindrical(CylindricalDisplacement { angle: 0.0, advance: 0.0 })
            }
            Self::TranslationalPlane => Displacement::Translational(Complex::new(0.0, 0.0)),
        }
    }
}

impl Displacement {
    /// The twist as it is after the displacement: adjoint action.
    #[inline]
    pub(crate) fn carried(&self, twist: &Local) -> Local {
        match self {
            Self::Planar(g) => planar_carried(g, twist),
            Self::Spherical(r) => r * twist,
            Self::Cylindrical(_) | Self::Translational(_) => *twist,
        }
    }

    /// What is carried to the twist.
    #[inline]
    pub(crate) fn carried_back(&self, twist: &Local) -> Local {
        match self {
            Self::Planar(g) => planar_carried(&g.inverse(), twist),
            Self::Spherical(r) => r.tr_mul(twist),
            Self::Cylindrical(_) | Self::Translational(_) => *twist,
        }
    }

    /// Where a point, given in the subspace's frame, goes.
    #[inline]
    pub(crate) fn moved(&self, p: &Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Planar(g) => {
                let z = g.apply(Complex::new(p.x, p.y));
                Vector3::new(z.re, z.im, p.z)
            }
            Self::Spherical(r) => r * p,
            Self::Cylindrical(g) => {
                let z = crate::chain::unit(g.angle) * Complex::new(p.x, p.y);
                Vector3::new(z.re, z.im, p.z + g.advance)
            }
            Self::Translational(t) => Vector3::new(p.x + t.re, p.y + t.im, p.z),
        }
    }
}

#[inline]
pub(crate) fn planar_carried(g: &PlanarDisplacement, twist: &Local) -> Local {
    planar(twist.x, g.rotation * linear(twist) - quarter(g.translation) * twist.x)
}

impl Cut {
    /// The intersection motion's unit twist.
    #[inline]
    pub(crate) fn twist(&self, kind: SubspaceKind) -> Local {
        match (self, kind) {
            (Self::Turn, SubspaceKind::Spherical) => Local::z(),
            (Self::Turn, _) => Local::x(),
            (Self::Advance, _) => Local::y(),
            (Self::Slide(along), SubspaceKind::Planar) => planar(0.0, *along),
            (Self::Slide(along), _) => Local::new(along.re, along.im, 0.0),
        }
    }

    /// The twist as it is after `exp(I τ)`.
    #[inline]
    pub(crate) fn carried(&self, kind: SubspaceKind, tau: Amount, twist: &Local) -> Local {
        match kind {
            SubspaceKind::Planar | SubspaceKind::Spherical => {
                self.before(&kind.identity(), tau).carried(twist)
            }
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => *twist,
        }
    }
}

impl Subspace {
    /// A twist of this subspace in base coordinates: its angular part, and the velocity of the point
    /// at this frame's origin.
    pub(crate) fn embedded(&self, twist: &Local) -> [Vector3<f64>; 2] {
        let zero = Vector3::zeros();
        let (angular, linear) = match self.kind {
            SubspaceKind::Planar => (Vector3::z() * twist.x, Vector3::new(twist.y, twist.z, 0.0)),
            SubspaceKind::Spherical => (*twist, zero),
            SubspaceKind::Cylindrical => (Vector3::z() * twist.x, Vector3::z() * twist.y),
            SubspaceKind::TranslationalPlane => (zero, Vector3::new(twist.x, twist.y, 0.0)),
        };
        [self.axes * angular, self.axes * linear]
    }

    /// A point of this frame in base coordinates.
    pub(crate) fn restored(&self, point: &Vector3<f64>) -> Point3<f64> {
        self.origin + self.axes * point
    }
}
