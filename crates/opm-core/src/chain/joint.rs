//! The joints that a chain is built from, projected into the frame of its subspace. What they deviate from
//! the subspace by is dropped.

use super::cylindrical::CoaxialJoint;
use super::planar::PlanarJoint;
use super::{ChainError, DEGENERATE};
use crate::group::Subspace;
use nalgebra::{Complex, Point3, Unit, Vector3};

/// A joint to build a chain from, at home in base coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChainJoint {
    /// Rotation about the line through `point` along `axis`, with an advance of `pitch` metres per radian.
    Screw {
        /// The unit direction of the axis, base coordinates.
        axis: Unit<Vector3<f64>>,
        /// A point of the line, base coordinates, metres.
        point: Point3<f64>,
        /// The advance, metres per radian; zero for a revolute joint.
        pitch: f64,
    },
    /// Translation along `axis`.
    Slide {
        /// The unit direction of the axis, base coordinates.
        axis: Unit<Vector3<f64>>,
    },
    /// A spherical joint.
    Ball,
}

pub(super) fn planar_joints(
    subspace: &Subspace,
    joints: &[ChainJoint; 3],
) -> Result<[PlanarJoint; 3], ChainError> {
    let mut planar = [PlanarJoint::Prismatic { along: Complex::new(1.0, 0.0) }; 3];
    for (planar, joint) in planar.iter_mut().zip(joints) {
        *planar = match joint {
            ChainJoint::Screw { axis, point, pitch: 0.0 } => {
                let at = subspace.point(point);
                let reversed = subspace.direction(axis).z < 0.0;
                PlanarJoint::Revolute { at: Complex::new(at.x, at.y), reversed }
            }
            ChainJoint::Slide { axis } => {
                PlanarJoint::Prismatic { along: in_plane(subspace, axis)? }
            }
            _ => return Err(ChainError::Foreign("planar")),
        };
    }
    Ok(planar)
}

pub(super) fn spherical_axes(
    subspace: &Subspace,
    joints: &[ChainJoint; 3],
) -> Result<[Unit<Vector3<f64>>; 3], ChainError> {
    let mut axes = [Vector3::z_axis(); 3];
    for (local, joint) in axes.iter_mut().zip(joints) {
        match joint {
            ChainJoint::Screw { axis, pitch: 0.0, .. } => {
                *local = Unit::new_normalize(subspace.direction(axis));
            }
            _ => return Err(ChainError::Foreign("spherical")),
        }
    }
    Ok(axes)
}

pub(super) fn coaxial_joints(
    subspace: &Subspace,
    joints: &[ChainJoint; 2],
) -> Result<[CoaxialJoint; 2], ChainError> {
    let [first, second] = joints;
    Ok([coaxial_joint(subspace, first)?, coaxial_joint(subspace, second)?])
}

/// A joint on the axis of a cylindrical subspace.
pub(crate) fn coaxial_joint(
    subspace: &Subspace,
    joint: &ChainJoint,
) -> Result<CoaxialJoint, ChainError> {
    let sign = |axis: &Unit<Vector3<f64>>| subspace.direction(axis).z.signum();
    Ok(match joint {
        ChainJoint::Screw { axis, pitch, .. } => {
            CoaxialJoint { rotation: sign(axis), advance: sign(axis) * pitch }
        }
        ChainJoint::Slide { axis } => CoaxialJoint { rotation: 0.0, advance: sign(axis) },
        ChainJoint::Ball => return Err(ChainError::Foreign("cylindrical")),
    })
}

pub(super) fn slides(
    subspace: &Subspace,
    joints: &[ChainJoint; 2],
) -> Result<[Complex<f64>; 2], ChainError> {
    match joints {
        [ChainJoint::Slide { axis: a }, ChainJoint::Slide { axis: b }] => {
            Ok([in_plane(subspace, a)?, in_plane(subspace, b)?])
        }
        _ => Err(ChainError::Foreign("translational")),
    }
}

/// The unit direction in the plane of a direction given in base coordinates.
pub(crate) fn in_plane(
    subspace: &Subspace,
    axis: &Vector3<f64>,
) -> Result<Complex<f64>, ChainError> {
    let d = subspace.direction(axis);
    let along = Complex::new(d.x, d.y);
    let length = along.norm();
    if length <= DEGENERATE {
        return Err(ChainError::Dependent(
            "a slider is perpendicular to the plane of its subspace",
        ));
    }
    Ok(along / length)
}
