//! Displacements that move along a one-parameter motion.

use super::{
    Cylindrical, CylindricalDisplacement, Planar, PlanarDisplacement, Spherical, SubspaceKind,
    TranslationalPlane, mismatch, subgroup::Subgroup,
};
use nalgebra::{Complex, Matrix3, Vector3};

/// A displacement that one number `t` moves: `exp(t · rate) · start`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Path {
    /// In a plane.
    Planar(PlanarPath),
    /// About the centre of a sphere, by a rotation.
    Spherical {
        /// At `t = 0`.
        start: Matrix3<f64>,
        /// The axis of the rotation, a unit vector.
        axis: Vector3<f64>,
    },
    /// About and along the axis of a cylinder.
    Cylindrical {
        /// At `t = 0`.
        start: CylindricalDisplacement,
        /// Displacement a unit of `t`.
        rate: CylindricalDisplacement,
    },
    /// In a plane, without rotation.
    Translational {
        /// At `t = 0`.
        start: Complex<f64>,
        /// Translation a unit of `t`.
        rate: Complex<f64>,
    },
}

/// A path in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarPath {
    /// By a translation.
    Slide {
        /// At `t = 0`.
        start: PlanarDisplacement,
        /// Translation a unit of `t`.
        rate: Complex<f64>,
    },
    /// By a rotation about the origin.
    Turn {
        /// At `t = 0`.
        start: PlanarDisplacement,
    },
}

impl Path {
    /// The largest number of a displacement on it, `t` being at most `reach` in size.
    pub fn size(&self, reach: f64) -> f64 {
        let far = |start: f64, rate: f64| start + rate * reach;
        match self {
            Self::Planar(PlanarPath::Slide { start, rate }) => {
                far(Planar::size(start), rate.norm())
            }
            Self::Planar(PlanarPath::Turn { start }) => Planar::size(start),
            Self::Spherical { start, .. } => Spherical::size(start),
            Self::Cylindrical { start, rate } => far(start.angle.abs(), rate.angle.abs())
                .max(far(start.advance.abs(), rate.advance.abs())),
            Self::Translational { start, rate } => far(start.norm(), rate.norm()),
        }
    }

    fn kind(&self) -> SubspaceKind {
        match self {
            Self::Planar(_) => Planar::KIND,
            Self::Spherical { .. } => Spherical::KIND,
            Self::Cylindrical { .. } => Cylindrical::KIND,
            Self::Translational { .. } => TranslationalPlane::KIND,
        }
    }

    /// The path, which is one in a plane.
    pub(crate) fn planar(&self) -> &PlanarPath {
        match self {
            Self::Planar(path) => path,
            Self::Spherical { .. } | Self::Cylindrical { .. } | Self::Translational { .. } => {
                mismatch(Planar::KIND, self.kind())
            }
        }
    }

    /// The start and the axis of the path, which is one about a centre.
    pub(crate) fn spherical(&self) -> (&Matrix3<f64>, &Vector3<f64>) {
        match self {
            Self::Spherical { start, axis } => (start, axis),
            Self::Planar(_) | Self::Cylindrical { .. } | Self::Translational { .. } => {
                mismatch(Spherical::KIND, self.kind())
            }
        }
    }

    /// The start and the rate of the path, which is one about and along an axis.
    pub(crate) fn cylindrical(&self) -> [&CylindricalDisplacement; 2] {
        match self {
            Self::Cylindrical { start, rate } => [start, rate],
            Self::Planar(_) | Self::Spherical { .. } | Self::Translational { .. } => {
                mismatch(Cylindrical::KIND, self.kind())
            }
        }
    }

    /// The start and the rate of the path, which is one of translations in a plane.
    pub(crate) fn translational(&self) -> [&Complex<f64>; 2] {
        match self {
            Self::Translational { start, rate } => [start, rate],
            Self::Planar(_) | Self::Spherical { .. } | Self::Cylindrical { .. } => {
                mismatch(TranslationalPlane::KIND, self.kind())
            }
        }
    }
}
