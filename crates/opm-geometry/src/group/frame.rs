//! A subspace, and the frame that its chains and its task coordinates use.

use super::subgroup::LocalTwist;
use super::{Displacement, SubspaceKind};
use nalgebra::{Isometry3, Matrix3, Point3, Quaternion, UnitQuaternion, Vector3};

/// A subspace with the frame that its chains and its task coordinates use.
///
/// ```
/// # extern crate opm_geometry as opm_core;
/// use nalgebra::{Matrix3, Point3, Vector3};
/// use opm_core::group::{Subspace, SubspaceKind};
/// use std::f64::consts::FRAC_PI_2;
///
/// // Planar motion in a level plane at z = 2 m, about a centre above (1, 0, 0).
/// let origin = Point3::new(1.0, 0.0, 2.0);
/// let axes = Matrix3::identity();
/// let plane =
///     Subspace { kind: SubspaceKind::Planar, origin, axes, measured_from: Point3::origin() };
/// assert_eq!(plane.dimension(), 3);
/// // A quarter revolution about the centre, as a displacement in base coordinates.
/// let quarter = plane.kind.exponential(&Vector3::new(FRAC_PI_2, 0.0, 0.0));
/// let moved = plane.isometry(&quarter) * Point3::new(2.0, 0.0, 2.0);
/// assert!((moved - Point3::new(1.0, 1.0, 2.0)).norm() < 1e-15);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Subspace {
    /// The kind of subspace: which subgroup its displacements form.
    pub kind: SubspaceKind,
    /// The frame's centre at home, in base coordinates and metres: the point that lengths move, and about which angles
    /// are measured.
    pub origin: Point3<f64>,
    /// The frame's three directions in base coordinates, as columns. The third is the normal of a plane,
    /// the axis of a cylinder, or the axis of the intersection motion in a spherical subspace.
    pub axes: Matrix3<f64>,
    /// The point from which lengths are measured along the frame's directions, in base coordinates and
    /// metres: the base's origin unless the file says otherwise, or the centre of a spherical subspace.
    pub measured_from: Point3<f64>,
}

impl Subspace {
    /// The centre at home, along the frame's directions and relative to the point that lengths are
    /// measured from.
    #[inline]
    pub fn home(&self) -> Vector3<f64> {
        self.axes.tr_mul(&(self.origin - self.measured_from))
    }

    /// The dimension of the subspace: its number of degrees of freedom.
    #[inline]
    pub fn dimension(&self) -> usize {
        self.kind.dimension()
    }

    /// Converts a direction from base coordinates to this frame.
    #[inline]
    pub fn direction(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(direction)
    }

    /// Converts a point from base coordinates to this frame.
    #[inline]
    pub fn point(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(&(point - self.origin))
    }

    /// Converts a point from this frame to base coordinates.
    #[inline]
    pub fn restored(&self, point: &Vector3<f64>) -> Point3<f64> {
        self.origin + self.axes * point
    }

    /// Converts a displacement of this subspace to base coordinates.
    #[inline]
    pub fn isometry(&self, displacement: &Displacement) -> Isometry3<f64> {
        let (rotation, translation) = displacement.rotation_and_translation();
        // In other directions, a rotation is about the same axis by the same angle.
        let local = UnitQuaternion::from_rotation_matrix(&rotation).into_inner();
        let turned = Quaternion::from_parts(local.scalar(), self.axes * local.vector());
        let rotation = UnitQuaternion::new_unchecked(turned);
        let origin = self.origin.coords;
        let translation = origin + self.axes * translation - rotation * origin;
        Isometry3::from_parts(translation.into(), rotation)
    }

    /// Converts a twist of this subspace to base directions: the angular velocity, and the velocity of the
    /// point at this frame's origin.
    #[inline]
    pub fn embedded(&self, twist: &LocalTwist) -> [Vector3<f64>; 2] {
        self.kind.embed(twist).map(|part| self.axes * part)
    }
}
