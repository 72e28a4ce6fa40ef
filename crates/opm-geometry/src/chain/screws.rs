//! The screws of a chain's joints at home, in the frame of its subspace.

use super::joint::{coaxial_joint, planar_joint, slide, spatial_slide, spherical_axis};
use super::planar::PlanarJoint;
use super::{ChainError, ChainJoint};
use crate::group::{LocalTwist, Subspace, SubspaceKind, angular_and_linear, linear, quarter};
use nalgebra::Vector3;

/// The screws of a chain's joints at home, in the order from the base, in the frame of their subspace:
/// `(ω, vx, vy)` in a plane, `ω` in a sphere, `(ω, v)` on a cylinder's axis, `(vx, vy)` in a translational plane,
/// `(vx, vy, vz)` in a translational space.
/// Screws with fewer components end in zeros, and a chain of fewer joints gets unit vectors as further screws: so
/// the three screws are always a square matrix, whose determinant is that of the chain.
///
/// # Errors
/// A joint that is not in the subspace, or a wrong number of joints.
pub fn screws(subspace: &Subspace, joints: &[ChainJoint]) -> Result<[LocalTwist; 3], ChainError> {
    let needed = match (subspace.kind, joints) {
        // About the base's directions, as a rotation vector is measured.
        (SubspaceKind::Spherical, [ChainJoint::Ball]) => {
            return Ok([0, 1, 2].map(|i| subspace.axes.row(i).transpose()));
        }
        (kind, _) => kind.dimension(),
    };
    if joints.len() != needed {
        return Err(ChainError::Count { needed, given: joints.len() });
    }
    let mut all = [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()];
    for (screw, joint) in all.iter_mut().zip(joints) {
        *screw = self::screw(subspace, joint)?;
    }
    Ok(all)
}

/// The screw of one joint other than a spherical one, in the frame of its subspace: see [`screws`].
///
/// # Errors
/// A joint that is not in the subspace.
pub fn screw(subspace: &Subspace, joint: &ChainJoint) -> Result<LocalTwist, ChainError> {
    Ok(match subspace.kind {
        SubspaceKind::Identity => return Err(ChainError::Count { needed: 0, given: 1 }),
        SubspaceKind::Planar => match planar_joint(subspace, joint)? {
            // ω = ±1 about the point `at` gives the origin the velocity -i ω at.
            PlanarJoint::Revolute { at, reversed: false } => angular_and_linear(1.0, -quarter(at)),
            PlanarJoint::Revolute { at, reversed: true } => angular_and_linear(-1.0, quarter(at)),
            PlanarJoint::Prismatic { along } => angular_and_linear(0.0, along),
        },
        SubspaceKind::Spherical => spherical_axis(subspace, joint)?.into_inner(),
        SubspaceKind::Cylindrical => {
            let joint = coaxial_joint(subspace, joint)?;
            Vector3::new(joint.rotation, joint.advance, 0.0)
        }
        SubspaceKind::TranslationalPlane => {
            let along = slide(subspace, joint)?;
            Vector3::new(along.re, along.im, 0.0)
        }
        SubspaceKind::TranslationalSpace => spatial_slide(subspace, joint)?,
    })
}

/// The unit of the determinant of a chain's screws, which makes it dimensionless. In a plane it is the
/// product of the lengths of the links between neighbouring pivots, or `size` where a slider is between two
/// pivots. On an axis the determinant is constant, and is its own unit.
pub fn determinant_scale(kind: SubspaceKind, home: &[LocalTwist; 3], size: f64) -> f64 {
    match kind {
        SubspaceKind::Identity
        | SubspaceKind::Spherical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => 1.0,
        SubspaceKind::Cylindrical => home[0].cross(&home[1]).z.abs(),
        SubspaceKind::Planar => {
            let pivot = |s: &LocalTwist| (s.x != 0.0).then(|| quarter(linear(s)) * s.x);
            match home.each_ref().map(pivot) {
                [Some(a), Some(b), Some(c)] => (b - a).norm() * (c - b).norm(),
                [Some(a), Some(b), None] | [None, Some(a), Some(b)] => (b - a).norm(),
                [Some(_), None, Some(_)] => size,
                [Some(_), None, None] | [None, Some(_), None] | [None, None, _] => 1.0,
            }
        }
    }
}
