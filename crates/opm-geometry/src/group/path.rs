//! Displacements that move along an intersection motion, as a function of one number.

use super::{
    Cylindrical, CylindricalDisplacement, Planar, PlanarDisplacement, Spherical, SubspaceKind,
    TranslationalPlane, TranslationalSpace, mismatch, subgroup::Subgroup,
};
use nalgebra::{Complex, Matrix3, Vector3};

/// A displacement as a function of one number `t`: `exp(t · rate) · start`. `t` is in radians along a
/// rotation and in metres along a translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// There is no motion: the displacement is the identity for every `t`.
    Identity,
    /// The displacement is in a plane.
    Planar(PlanarPath),
    /// The displacement is a rotation about a centre, and `t` rotates it about an axis.
    Spherical {
        /// The displacement at `t = 0`.
        start: Matrix3<f64>,
        /// The axis of the rotation, a unit vector.
        axis: Vector3<f64>,
    },
    /// The displacement is about and along the axis of a cylinder.
    Cylindrical {
        /// The displacement at `t = 0`.
        start: CylindricalDisplacement,
        /// The displacement for a unit of `t`.
        rate: CylindricalDisplacement,
    },
    /// The displacement is a translation in a plane.
    Translational {
        /// The displacement at `t = 0`.
        start: Complex<f64>,
        /// The translation for a unit of `t`.
        rate: Complex<f64>,
    },
    /// The displacement is a translation in space.
    Spatial {
        /// The displacement at `t = 0`.
        start: Vector3<f64>,
        /// The translation for a unit of `t`.
        rate: Vector3<f64>,
    },
}

/// A path of planar displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarPath {
    /// `t` translates the plane.
    Translation {
        /// The displacement at `t = 0`.
        start: PlanarDisplacement,
        /// The translation for a unit of `t`.
        rate: Complex<f64>,
    },
    /// `t` rotates the plane about the frame's origin.
    Rotation {
        /// The displacement at `t = 0`.
        start: PlanarDisplacement,
    },
}

impl Path {
    /// A bound on the components of the displacements on the path (see `Subgroup::size`) for `|t|` up to
    /// `range`.
    pub fn size(&self, range: f64) -> f64 {
        let far = |start: f64, rate: f64| start + rate * range;
        match self {
            Self::Identity => 0.0,
            Self::Planar(PlanarPath::Translation { start, rate }) => {
                far(Planar::size(start), rate.norm())
            }
            Self::Planar(PlanarPath::Rotation { start }) => Planar::size(start),
            Self::Spherical { start, .. } => Spherical::size(start),
            Self::Cylindrical { start, rate } => far(start.angle.abs(), rate.angle.abs())
                .max(far(start.advance.abs(), rate.advance.abs())),
            Self::Translational { start, rate } => far(start.norm(), rate.norm()),
            Self::Spatial { start, rate } => far(start.norm(), rate.norm()),
        }
    }

    /// The kind of subspace that the displacements are in.
    fn kind(&self) -> SubspaceKind {
        match self {
            Self::Identity => SubspaceKind::Identity,
            Self::Planar(_) => Planar::KIND,
            Self::Spherical { .. } => Spherical::KIND,
            Self::Cylindrical { .. } => Cylindrical::KIND,
            Self::Translational { .. } => TranslationalPlane::KIND,
            Self::Spatial { .. } => TranslationalSpace::KIND,
        }
    }

    /// The planar path. Panics if the path is of another kind.
    #[inline(always)]
    pub(crate) fn planar(&self) -> &PlanarPath {
        match self {
            Self::Planar(path) => path,
            Self::Identity
            | Self::Spherical { .. }
            | Self::Cylindrical { .. }
            | Self::Translational { .. }
            | Self::Spatial { .. } => mismatch(Planar::KIND, self.kind()),
        }
    }

    /// The start and the axis of a spherical path. Panics if the path is of another kind.
    #[inline(always)]
    pub(crate) fn spherical(&self) -> (&Matrix3<f64>, &Vector3<f64>) {
        match self {
            Self::Spherical { start, axis } => (start, axis),
            Self::Identity
            | Self::Planar(_)
            | Self::Cylindrical { .. }
            | Self::Translational { .. }
            | Self::Spatial { .. } => mismatch(Spherical::KIND, self.kind()),
        }
    }

    /// The start and the rate of a cylindrical path. Panics if the path is of another kind.
    #[inline(always)]
    pub(crate) fn cylindrical(&self) -> [&CylindricalDisplacement; 2] {
        match self {
            Self::Cylindrical { start, rate } => [start, rate],
            Self::Identity
            | Self::Planar(_)
            | Self::Spherical { .. }
            | Self::Translational { .. }
            | Self::Spatial { .. } => mismatch(Cylindrical::KIND, self.kind()),
        }
    }

    /// The start and the rate of a translational path. Panics if the path is of another kind.
    #[inline(always)]
    pub(crate) fn translational(&self) -> [&Complex<f64>; 2] {
        match self {
            Self::Translational { start, rate } => [start, rate],
            Self::Identity
            | Self::Planar(_)
            | Self::Spherical { .. }
            | Self::Cylindrical { .. }
            | Self::Spatial { .. } => mismatch(TranslationalPlane::KIND, self.kind()),
        }
    }

    /// The start and the rate of a path of translations in space. Panics if the path is of another kind.
    #[inline(always)]
    pub(crate) fn spatial(&self) -> [&Vector3<f64>; 2] {
        match self {
            Self::Spatial { start, rate } => [start, rate],
            Self::Identity
            | Self::Planar(_)
            | Self::Spherical { .. }
            | Self::Cylindrical { .. }
            | Self::Translational { .. } => mismatch(TranslationalSpace::KIND, self.kind()),
        }
    }
}
