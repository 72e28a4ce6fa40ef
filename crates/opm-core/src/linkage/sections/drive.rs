//! The joint that drives the loop of a section: its displacement, taken to the other side of the
//! equation of closure, is the target of the chain of the other joints.

use crate::chain::cylindrical::CoaxialJoint;
use crate::chain::joint::{coaxial_joint, in_plane, spatial_slide};
use crate::chain::{ChainError, ChainJoint};
use crate::group::{
    CylindricalDisplacement, Displacement, JointDisplacement, LocalTwist, Path, PlanarDisplacement,
    PlanarPath, Subspace, SubspaceKind, angular_and_linear,
};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Matrix3, Vector3};

/// The driving joint `a` of a loop, in the frame of its subspace.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Drive {
    /// A revolute of a plane, at the frame's origin.
    Pivot {
        /// Whether it rotates clockwise.
        reversed: bool,
    },
    /// A slider in a plane, along a unit direction.
    Slider(Complex<f64>),
    /// A revolute through a centre, about a unit direction.
    Spherical(Vector3<f64>),
    /// A joint on an axis.
    Coaxial(CoaxialJoint),
    /// A slider of a section of sliders in a plane, along a unit direction.
    Translational(Complex<f64>),
    /// A slider of a section of sliders in space, along a unit direction.
    Spatial(Vector3<f64>),
}

impl Drive {
    /// The drive, and the frame in which it is: that of the subspace, moved to the pivot.
    pub fn new(subspace: &Subspace, joint: &ChainJoint) -> Result<(Subspace, Self), ChainError> {
        let mut subspace = subspace.clone();
        let drive = match (subspace.kind, joint) {
            (SubspaceKind::Planar, ChainJoint::Screw { axis, point, pitch: 0.0 }) => {
                subspace.origin = *point;
                Self::Pivot { reversed: subspace.direction(axis).z < 0.0 }
            }
            (SubspaceKind::Planar, ChainJoint::Slide { axis }) => {
                Self::Slider(in_plane(&subspace, axis)?)
            }
            (SubspaceKind::Spherical, ChainJoint::Screw { axis, pitch: 0.0, .. }) => {
                Self::Spherical(subspace.direction(axis).normalize())
            }
            (SubspaceKind::Cylindrical, joint) => Self::Coaxial(coaxial_joint(&subspace, joint)?),
            (SubspaceKind::TranslationalPlane, ChainJoint::Slide { axis }) => {
                Self::Translational(in_plane(&subspace, axis)?)
            }
            (SubspaceKind::TranslationalSpace, joint) => {
                Self::Spatial(spatial_slide(&subspace, joint)?)
            }
            (SubspaceKind::Identity, _) => return Err(ChainError::Foreign("rigid")),
            (SubspaceKind::Planar, _) => return Err(ChainError::Foreign("planar")),
            (SubspaceKind::Spherical, _) => return Err(ChainError::Foreign("spherical")),
            (SubspaceKind::TranslationalPlane, _) => {
                return Err(ChainError::Foreign("translational"));
            }
        };
        Ok((subspace, drive))
    }

    /// Whether the joint is a revolute.
    pub fn is_rotation(&self) -> bool {
        match self {
            Self::Pivot { .. } | Self::Spherical(_) => true,
            Self::Coaxial(joint) => joint.rotation != 0.0 && joint.advance == 0.0,
            Self::Slider(_) | Self::Translational(_) | Self::Spatial(_) => false,
        }
    }

    /// The displacement `exp(-a q)`. A direction must have unit length.
    #[inline]
    pub fn target(&self, q: JointDisplacement) -> Displacement {
        let direction = || match q {
            JointDisplacement::Direction(e) => e,
            JointDisplacement::Value(angle) => unit(angle),
        };
        match *self {
            Self::Pivot { reversed } => {
                let e = direction();
                let rotation = if reversed { e } else { e.conj() };
                Displacement::Planar(PlanarDisplacement { rotation, translation: Complex::ZERO })
            }
            Self::Slider(along) => Displacement::Planar(PlanarDisplacement {
                rotation: Complex::ONE,
                translation: -along * q.value(),
            }),
            Self::Spherical(axis) => {
                let e = direction();
                Displacement::Spherical(
                    Matrix3::identity() * e.re + axis * axis.transpose() * (1.0 - e.re)
                        - axis.cross_matrix() * e.im,
                )
            }
            Self::Coaxial(CoaxialJoint { rotation, advance }) => {
                let q = q.value();
                let (angle, advance) = (-rotation * q, -advance * q);
                Displacement::Cylindrical(CylindricalDisplacement { angle, advance })
            }
            Self::Translational(along) => Displacement::Translational(-along * q.value()),
            Self::Spatial(along) => Displacement::Spatial(-along * q.value()),
        }
    }

    /// The targets as a path.
    pub fn path(&self) -> Path {
        match *self {
            Self::Pivot { .. } => {
                Path::Planar(PlanarPath::Rotation { start: PlanarDisplacement::IDENTITY })
            }
            Self::Slider(along) => Path::Planar(PlanarPath::Translation {
                start: PlanarDisplacement::IDENTITY,
                rate: -along,
            }),
            Self::Spherical(axis) => Path::Spherical { start: Matrix3::identity(), axis: -axis },
            Self::Coaxial(CoaxialJoint { rotation, advance }) => Path::Cylindrical {
                start: CylindricalDisplacement { angle: 0.0, advance: 0.0 },
                rate: CylindricalDisplacement { angle: -rotation, advance: -advance },
            },
            Self::Translational(along) => {
                Path::Translational { start: Complex::ZERO, rate: -along }
            }
            Self::Spatial(along) => Path::Spatial { start: Vector3::zeros(), rate: -along },
        }
    }

    /// The joint's displacement at a parameter of its path.
    pub fn at(&self, parameter: JointDisplacement) -> JointDisplacement {
        match self {
            // The path rotates counter-clockwise.
            Self::Pivot { reversed: false } => parameter.inverse(),
            Self::Pivot { reversed: true }
            | Self::Slider(_)
            | Self::Spherical(_)
            | Self::Coaxial(_)
            | Self::Translational(_)
            | Self::Spatial(_) => parameter,
        }
    }

    /// The joint's twist.
    pub fn twist(&self) -> LocalTwist {
        match *self {
            Self::Pivot { reversed } => {
                angular_and_linear(if reversed { -1.0 } else { 1.0 }, Complex::ZERO)
            }
            Self::Slider(along) => angular_and_linear(0.0, along),
            Self::Spherical(axis) => axis,
            Self::Coaxial(CoaxialJoint { rotation, advance }) => {
                LocalTwist::new(rotation, advance, 0.0)
            }
            Self::Translational(along) => LocalTwist::new(along.re, along.im, 0.0),
            Self::Spatial(along) => along,
        }
    }
}
