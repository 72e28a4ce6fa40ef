//! The joints that a chain is built from, projected into the frame of its subspace. What they deviate from
//! the subspace by is dropped.

use super::cylindrical::CoaxialJoint;
use super::planar::PlanarJoint;
use super::{ChainError, DEGENERATE};
use crate::group::Subspace;
use nalgebra::{Complex, Point3, Unit, Vector3};

/// A joint of a chain, as it is at home, in base coordinates.
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

/// The results of a function for every joint, or its first error.
pub(super) fn each<T, const N: usize>(
    joints: &[ChainJoint; N],
    of: impl Fn(&ChainJoint) -> Result<T, ChainError>,
) -> Result<[T; N], ChainError> {
    let found: Vec<T> = joints.iter().map(of).collect::<Result<_, _>>()?;
    Ok(found.try_into().unwrap_or_else(|_| unreachable!("there is one for each joint")))
}

pub(super) fn planar_joint(
    subspace: &Subspace,
    joint: &ChainJoint,
) -> Result<PlanarJoint, ChainError> {
    match joint {
        ChainJoint::Screw { axis, point, pitch: 0.0 } => {
            let at = subspace.point(point);
            let reversed = subspace.direction(axis).z < 0.0;
            Ok(PlanarJoint::Revolute { at: Complex::new(at.x, at.y), reversed })
        }
        ChainJoint::Slide { axis } => {
            Ok(PlanarJoint::Prismatic { along: in_plane(subspace, axis)? })
        }
        _ => Err(ChainError::Foreign("planar")),
    }
}

pub(super) fn spherical_axis(
    subspace: &Subspace,
    joint: &ChainJoint,
) -> Result<Unit<Vector3<f64>>, ChainError> {
    match joint {
        ChainJoint::Screw { axis, pitch: 0.0, .. } => {
            Ok(Unit::new_normalize(subspace.direction(axis)))
        }
        _ => Err(ChainError::Foreign("spherical")),
    }
}

/// A joint on the axis of a cylindrical subspace.
pub fn coaxial_joint(subspace: &Subspace, joint: &ChainJoint) -> Result<CoaxialJoint, ChainError> {
    let sign = |axis: &Unit<Vector3<f64>>| subspace.direction(axis).z.signum();
    Ok(match joint {
        ChainJoint::Screw { axis, pitch, .. } => {
            CoaxialJoint { rotation: sign(axis), advance: sign(axis) * pitch }
        }
        ChainJoint::Slide { axis } => CoaxialJoint { rotation: 0.0, advance: sign(axis) },
        ChainJoint::Ball => return Err(ChainError::Foreign("cylindrical")),
    })
}

pub(super) fn slide(subspace: &Subspace, joint: &ChainJoint) -> Result<Complex<f64>, ChainError> {
    match joint {
        ChainJoint::Slide { axis } => in_plane(subspace, axis),
        _ => Err(ChainError::Foreign("translational")),
    }
}

/// The unit direction of a slider in the frame of a translational space.
pub fn spatial_slide(subspace: &Subspace, joint: &ChainJoint) -> Result<Vector3<f64>, ChainError> {
    match joint {
        ChainJoint::Slide { axis } => Ok(subspace.direction(axis).normalize()),
        _ => Err(ChainError::Foreign("translational")),
    }
}

/// The unit direction in the plane of a direction given in base coordinates.
pub fn in_plane(subspace: &Subspace, axis: &Vector3<f64>) -> Result<Complex<f64>, ChainError> {
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
