//! The motion that the two subspaces of a decomposition share.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{
    Cylindrical, CylindricalMotion, Displacement, JointDisplacement, Planar, PlanarMotion,
    SpatialMotion, Spherical, SphericalMotion, SubspaceKind, TranslationalMotion,
    TranslationalPlane, TranslationalSpace, mismatch,
};
use crate::numbers::{Over, Plane};
use nalgebra::{Complex, Vector3};

/// What a one-parameter motion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionType {
    /// A rotation about an axis.
    Rotation,
    /// A translation along a direction.
    Translation,
}

/// The intersection motion `I` of two subspaces, in the frame of one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntersectionMotion<Z = Complex<f64>> {
    /// A planar motion.
    Planar(PlanarMotion<Z>),
    /// A rotation about a centre.
    Spherical(SphericalMotion),
    /// A motion about or along the axis of a cylinder.
    Cylindrical(CylindricalMotion),
    /// A translation in a translational plane.
    Translational(TranslationalMotion<Z>),
    /// A translation in space.
    Spatial(SpatialMotion),
    /// No motion: the two subspaces share the identity alone. This one is of the kind given.
    None(SubspaceKind),
}

/// Calls a function of [`Subgroup`] for the subgroup of a motion, `G`; for no motion, evaluates the second
/// expression.
macro_rules! of_motion {
    ($motion:expr, $G:ident, $m:ident => $call:expr, $kind:ident => $none:expr) => {
        match $motion {
            IntersectionMotion::None($kind) => $none,
            IntersectionMotion::Planar($m) => {
                type $G = Planar;
                $call
            }
            IntersectionMotion::Spherical($m) => {
                type $G = Spherical;
                $call
            }
            IntersectionMotion::Cylindrical($m) => {
                type $G = Cylindrical;
                $call
            }
            IntersectionMotion::Translational($m) => {
                type $G = TranslationalPlane;
                $call
            }
            IntersectionMotion::Spatial($m) => {
                type $G = TranslationalSpace;
                $call
            }
        }
    };
}

impl<Z: Plane> IntersectionMotion<Z> {
    /// The product `v · exp(I τ)`.
    ///
    /// # Panics
    /// If `v` is a displacement of another kind of subspace.
    #[inline(always)]
    pub fn after<T: Over<Z::Real>>(&self, v: &Displacement<T>, tau: T::Joint) -> Displacement<T> {
        match self {
            Self::None(_) => *v,
            Self::Planar(m) => Displacement::Planar(m.after::<T>(v.planar(), tau)),
            Self::Spherical(m) => Displacement::Spherical(m.after::<T>(v.spherical(), tau)),
            Self::Cylindrical(m) => Displacement::Cylindrical(m.after(v.cylindrical(), tau)),
            Self::Translational(m) => {
                Displacement::Translational(m.after::<T>(v.translational(), tau))
            }
            Self::Spatial(m) => Displacement::Spatial(m.after::<T>(v.spatial(), tau)),
        }
    }

    /// The product `exp(I τ) · b`.
    ///
    /// # Panics
    /// If `b` is a displacement of another kind of subspace.
    #[inline(always)]
    pub fn before<T: Over<Z::Real>>(&self, b: &Displacement<T>, tau: T::Joint) -> Displacement<T> {
        match self {
            Self::Planar(m) => Displacement::Planar(m.before::<T>(b.planar(), tau)),
            Self::Spherical(m) => Displacement::Spherical(m.before::<T>(b.spherical(), tau)),
            // There is no motion, or displacements commute.
            Self::None(_) | Self::Cylindrical(_) | Self::Translational(_) | Self::Spatial(_) => {
                self.after(b, tau)
            }
        }
    }
}

impl IntersectionMotion {
    /// The intersection motion in a subspace of a kind. `direction` is a unit vector in the subspace's frame:
    /// the axis of a rotation, which passes through the frame's origin, or the direction of a translation. Except in a
    /// plane, it is the frame's third direction. In a plane that is a Schoenflies section without its height, a
    /// translation may be inclined; then the motion is its part in the plane.
    ///
    /// # Panics
    /// If the subspace does not contain such a motion. The trivial one gives [`IntersectionMotion::None`].
    pub fn new(kind: SubspaceKind, direction: &Vector3<f64>, motion: MotionType) -> Self {
        match kind {
            SubspaceKind::Identity => Self::None(kind),
            SubspaceKind::Planar => Self::Planar(Planar::motion(direction, motion)),
            SubspaceKind::Spherical => Self::Spherical(Spherical::motion(direction, motion)),
            SubspaceKind::Cylindrical => Self::Cylindrical(Cylindrical::motion(direction, motion)),
            SubspaceKind::TranslationalPlane => {
                Self::Translational(TranslationalPlane::motion(direction, motion))
            }
            SubspaceKind::TranslationalSpace => {
                Self::Spatial(TranslationalSpace::motion(direction, motion))
            }
        }
    }

    /// The kind of subspace in whose frame the motion is given.
    #[inline]
    pub fn kind(&self) -> SubspaceKind {
        of_motion!(self, G, _m => G::KIND, kind => *kind)
    }

    /// What the motion is; `None` for no motion.
    #[inline]
    pub fn motion_type(&self) -> Option<MotionType> {
        match self {
            Self::None(_) => None,
            Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => {
                let translation = self.kind().is_translation(&self.unit_twist());
                Some(if translation { MotionType::Translation } else { MotionType::Rotation })
            }
        }
    }

    /// Whether the motion is a rotation.
    #[inline]
    pub fn is_rotation(&self) -> bool {
        self.motion_type() == Some(MotionType::Rotation)
    }

    /// The twist of the motion for a unit rate, in the subspace's frame; zero for no motion. It has unit length, but for
    /// the part in a plane of an inclined translation.
    #[inline]
    pub fn unit_twist(&self) -> Vector3<f64> {
        of_motion!(self, G, m => G::unit_twist(m), _kind => LocalTwist::zeros())
    }

    /// What a unit of the motion adds to the logarithm of a displacement, in a subspace whose displacements
    /// commute.
    #[inline]
    pub fn sum(&self) -> LocalTwist {
        self.unit_twist()
    }

    /// The twist whose scalar product with another one is the rate of the motion in it; the rest is in the span of
    /// [`IntersectionMotion::complement`]. Zero for no motion.
    #[inline]
    pub fn reciprocal(&self) -> LocalTwist {
        let unit = self.unit_twist();
        match self {
            Self::Planar(PlanarMotion::Translation(along)) => unit / along.norm_sqr(),
            Self::None(_)
            | Self::Planar(PlanarMotion::Rotation)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => unit,
        }
    }

    /// Orthonormal twists that complete the unit twist to a basis of the subspace's twists; a whole basis for no motion.
    pub fn complement(&self) -> Vec<LocalTwist> {
        of_motion!(self, G, m => G::complement(m), kind => kind.basis())
    }

    /// The products `exp(I τ) · b` for all τ, as a path; `None` for no motion.
    ///
    /// # Panics
    /// If `b` is a displacement of another kind of subspace.
    pub fn path(&self, b: &Displacement) -> Option<Path> {
        match self {
            Self::None(_) => None,
            Self::Planar(m) => Some(Planar::path(m, b.planar())),
            Self::Spherical(m) => Some(Spherical::path(m, b.spherical())),
            Self::Cylindrical(m) => Some(Cylindrical::path(m, b.cylindrical())),
            Self::Translational(m) => Some(TranslationalPlane::path(m, b.translational())),
            Self::Spatial(m) => Some(TranslationalSpace::path(m, b.spatial())),
        }
    }

    /// The displacement `exp(I τ)`.
    #[inline]
    pub fn displacement(&self, tau: JointDisplacement) -> Displacement {
        self.before(&self.kind().identity(), tau)
    }

    /// The adjoint action of `exp(I τ)` on a twist.
    #[inline]
    pub fn adjoint(&self, tau: JointDisplacement, twist: &LocalTwist) -> LocalTwist {
        // Where displacements commute, the adjoint action is the identity. This case avoids computing the
        // angle of τ.
        if self.kind().commutes() { *twist } else { self.displacement(tau).adjoint(twist) }
    }

    /// The planar motion. Panics if it is of another kind, or no motion.
    #[inline(always)]
    pub fn planar(&self) -> &PlanarMotion {
        match self {
            Self::Planar(m) => m,
            Self::None(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(Planar::KIND, self.kind()),
        }
    }

    /// The spherical motion. Panics if it is of another kind, or no motion.
    #[inline(always)]
    pub fn spherical(&self) -> &SphericalMotion {
        match self {
            Self::Spherical(m) => m,
            Self::None(_)
            | Self::Planar(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(Spherical::KIND, self.kind()),
        }
    }
}
