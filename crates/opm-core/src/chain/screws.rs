//! The screws of a chain's joints at home, in the frame of its subspace.

use super::joint::{coaxial_joints, planar_joints, slides, spherical_axes};
use super::planar::PlanarJoint;
use super::{ChainError, ChainJoint};
use crate::group::{LocalTwist, Subspace, SubspaceKind, angular_and_linear, linear, quarter};
use nalgebra::{Unit, Vector3};

/// The screws of a chain's joints at home in their subspace's own frame, base first: `(ω, vx, vy)` in a
/// plane, `ω` in a sphere, `(ω, v)` on a cylinder's axis, `(vx, vy)` in a translational plane. Screws with
/// fewer components are padded with zeros, and a chain of fewer joints gets unit vectors as further screws:
/// then the three screws are always a square matrix, whose determinant is that of the chain.
///
/// # Errors
/// A joint that is not in the subspace, or a wrong number of joints.
pub(crate) fn screws(
    subspace: &Subspace,
    joints: &[ChainJoint],
) -> Result<[LocalTwist; 3], ChainError> {
    let needs = |needed| ChainError::Count { needed, given: joints.len() };
    Ok(match subspace.kind {
        SubspaceKind::Identity => match joints {
            [] => [LocalTwist::x(), LocalTwist::y(), LocalTwist::z()],
            _ => return Err(needs(0)),
        },
        SubspaceKind::Planar => {
            let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
            planar_joints(subspace, joints)?.map(|joint| match joint {
                // ω = ±1 about the point `at` gives the origin the velocity -i ω at.
                PlanarJoint::Revolute { at, reversed: false } => {
                    angular_and_linear(1.0, -quarter(at))
                }
                PlanarJoint::Revolute { at, reversed: true } => {
                    angular_and_linear(-1.0, quarter(at))
                }
                PlanarJoint::Prismatic { along } => angular_and_linear(0.0, along),
            })
        }
        SubspaceKind::Spherical => match joints {
            // About the base's directions, as a rotation vector is measured.
            [ChainJoint::Ball] => [0, 1, 2].map(|i| subspace.axes.row(i).transpose()),
            _ => {
                let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
                spherical_axes(subspace, joints)?.map(Unit::into_inner)
            }
        },
        SubspaceKind::Cylindrical => {
            let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
            let [p, q] = coaxial_joints(subspace, joints)?;
            [
                Vector3::new(p.rotation, p.advance, 0.0),
                Vector3::new(q.rotation, q.advance, 0.0),
                Vector3::z(),
            ]
        }
        SubspaceKind::TranslationalPlane => {
            let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
            let [u, v] = slides(subspace, joints)?;
            [Vector3::new(u.re, u.im, 0.0), Vector3::new(v.re, v.im, 0.0), Vector3::z()]
        }
    })
}

/// The unit of the determinant of a chain's screws, which makes it dimensionless. In a plane it is the
/// product of the lengths of the links between neighbouring pivots, or `size` where a slider is between two
/// pivots. On an axis the determinant is constant, and is its own unit.
pub(crate) fn determinant_scale(kind: SubspaceKind, home: &[LocalTwist; 3], size: f64) -> f64 {
    match kind {
        SubspaceKind::Identity | SubspaceKind::Spherical | SubspaceKind::TranslationalPlane => 1.0,
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
