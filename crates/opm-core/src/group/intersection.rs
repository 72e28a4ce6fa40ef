//! The motion that the two subspaces of a decomposition share.

use super::path::Path;
use super::subgroup::{LocalTwist, Subgroup};
use super::{
    Cylindrical, CylindricalMotion, Displacement, JointDisplacement, Planar, PlanarMotion,
    Spherical, SphericalMotion, SubspaceKind, TranslationalMotion, TranslationalPlane, mismatch,
};
use nalgebra::Vector3;

/// The intersection motion `I`, as it is in the frame of one of the two subspaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum IntersectionMotion {
    /// In a plane.
    Planar(PlanarMotion),
    /// About a centre.
    Spherical(SphericalMotion),
    /// About or along an axis.
    Cylindrical(CylindricalMotion),
    /// In a translational plane.
    Translational(TranslationalMotion),
}

/// Calls a function of [`Subgroup`] for the subgroup of a motion, `G`.
macro_rules! of_motion {
    ($motion:expr, $G:ident, $m:ident => $call:expr) => {
        match $motion {
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
        }
    };
}

impl IntersectionMotion {
    /// The motion in a subspace of this kind, by its direction in the frame: a rotation about it through
    /// the frame's origin, or a translation along it.
    ///
    /// # Panics
    /// If the subspace does not hold such a motion.
    pub fn new(kind: SubspaceKind, direction: &Vector3<f64>, rotation: bool) -> Self {
        match kind {
            SubspaceKind::Planar => Self::Planar(Planar::motion(direction, rotation)),
            SubspaceKind::Spherical => Self::Spherical(Spherical::motion(direction, rotation)),
            SubspaceKind::Cylindrical => {
                Self::Cylindrical(Cylindrical::motion(direction, rotation))
            }
            SubspaceKind::TranslationalPlane => {
                Self::Translational(TranslationalPlane::motion(direction, rotation))
            }
        }
    }

    /// The kind of subspace in whose frame it is given.
    pub fn kind(&self) -> SubspaceKind {
        of_motion!(self, G, _m => G::KIND)
    }

    /// Whether it is a rotation; else it is a translation.
    pub fn is_rotation(&self) -> bool {
        !self.kind().is_translation(&self.unit_twist())
    }

    /// Its unit twist.
    #[inline]
    pub fn unit_twist(&self) -> Vector3<f64> {
        of_motion!(self, G, m => G::unit_twist(m))
    }

    /// What a unit of it adds to a displacement, in a subspace whose displacements commute.
    pub(crate) fn sum(&self) -> [f64; 2] {
        let twist = self.unit_twist();
        [twist.x, twist.y]
    }

    /// The subspace's directions beside it.
    pub(crate) fn complement(&self) -> Vec<LocalTwist> {
        of_motion!(self, G, m => G::complement(m))
    }

    /// `v · exp(I τ)`.
    ///
    /// # Panics
    /// If `v` is a displacement of another kind of subspace.
    #[inline(always)]
    pub fn after(&self, v: &Displacement, tau: JointDisplacement) -> Displacement {
        match self {
            Self::Planar(m) => Planar::after(m, v.planar(), tau).into(),
            Self::Spherical(m) => Spherical::after(m, v.spherical(), tau).into(),
            Self::Cylindrical(m) => Cylindrical::after(m, v.cylindrical(), tau).into(),
            Self::Translational(m) => TranslationalPlane::after(m, v.translational(), tau).into(),
        }
    }

    /// `exp(I τ) · b`.
    ///
    /// # Panics
    /// If `b` is a displacement of another kind of subspace.
    #[inline(always)]
    pub fn before(&self, b: &Displacement, tau: JointDisplacement) -> Displacement {
        match self {
            Self::Planar(m) => Planar::before(m, b.planar(), tau).into(),
            Self::Spherical(m) => Spherical::before(m, b.spherical(), tau).into(),
            Self::Cylindrical(m) => Cylindrical::before(m, b.cylindrical(), tau).into(),
            Self::Translational(m) => TranslationalPlane::before(m, b.translational(), tau).into(),
        }
    }

    /// `exp(I τ) · b` for every τ.
    ///
    /// # Panics
    /// If `b` is a displacement of another kind of subspace.
    pub fn path(&self, b: &Displacement) -> Path {
        match self {
            Self::Planar(m) => Planar::path(m, b.planar()),
            Self::Spherical(m) => Spherical::path(m, b.spherical()),
            Self::Cylindrical(m) => Cylindrical::path(m, b.cylindrical()),
            Self::Translational(m) => TranslationalPlane::path(m, b.translational()),
        }
    }

    /// The displacement `exp(I τ)`.
    pub(crate) fn displacement(&self, tau: JointDisplacement) -> Displacement {
        self.before(&self.kind().identity(), tau)
    }

    /// The twist as it is after `exp(I τ)`.
    #[inline]
    pub(crate) fn adjoint(&self, tau: JointDisplacement, twist: &LocalTwist) -> LocalTwist {
        // Where displacements commute no twist changes: that saves the angle of τ.
        if self.kind().commutes() { *twist } else { self.displacement(tau).adjoint(twist) }
    }

    /// The motion, which is one in a plane.
    #[inline(always)]
    pub(crate) fn planar(&self) -> &PlanarMotion {
        match self {
            Self::Planar(m) => m,
            Self::Spherical(_) | Self::Cylindrical(_) | Self::Translational(_) => {
                mismatch(Planar::KIND, self.kind())
            }
        }
    }

    /// The motion, which is one about a centre.
    #[inline(always)]
    pub(crate) fn spherical(&self) -> &SphericalMotion {
        match self {
            Self::Spherical(m) => m,
            Self::Planar(_) | Self::Cylindrical(_) | Self::Translational(_) => {
                mismatch(Spherical::KIND, self.kind())
            }
        }
    }
}
