//! A subspace with the frame that its chains and its task coordinates use.

use super::subgroup::LocalTwist;
use super::{Displacement, SubspaceKind};
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};

/// A subspace with the frame that its chains and its task coordinates use.
#[derive(Clone, Debug, PartialEq)]
pub struct Subspace {
    /// Which subgroup it is.
    pub kind: SubspaceKind,
    /// Its reference point at home, base coordinates: the frame's origin for displacements, about
    /// which angles turn.
    pub origin: Point3<f64>,
    /// Columns: the frame's directions in base coordinates. The third is the normal of a plane, the
    /// axis of a cylinder, and the intersection motion's axis in a sphere.
    pub axes: Matrix3<f64>,
    /// The point that lengths are measured from, along the frame's directions, base coordinates: the
    /// base's origin unless the file says otherwise; of a sphere the centre.
    pub measured_from: Point3<f64>,
}

impl Subspace {
    /// Where its reference point is at home, in its frame and from where lengths are measured.
    pub(crate) fn home(&self) -> Vector3<f64> {
        self.axes.tr_mul(&(self.origin - self.measured_from))
    }

    /// Number of freedoms of the motion inside it.
    pub fn dimension(&self) -> usize {
        self.kind.dimension()
    }

    /// A direction of the base in this frame.
    pub fn direction(&self, direction: &Vector3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(direction)
    }

    /// A point of the base in this frame.
    pub fn point(&self, point: &Point3<f64>) -> Vector3<f64> {
        self.axes.tr_mul(&(point - self.origin))
    }

    /// A point of this frame in base coordinates.
    pub(crate) fn restored(&self, point: &Vector3<f64>) -> Point3<f64> {
        self.origin + self.axes * point
    }

    /// A displacement of this subspace in base coordinates.
    pub fn isometry(&self, displacement: &Displacement) -> Isometry3<f64> {
        let (rotation, translation) = displacement.rotation_and_translation();
        let axes =
            UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(self.axes));
        let frame = Isometry3::from_parts(Translation3::from(self.origin), axes);
        let local = Isometry3::from_parts(
            Translation3::from(translation),
            UnitQuaternion::from_rotation_matrix(&rotation),
        );
        frame * local * frame.inverse()
    }

    /// A twist of this subspace in base coordinates: its angular part, and the velocity of the point
    /// at this frame's origin.
    pub(crate) fn embedded(&self, twist: &LocalTwist) -> [Vector3<f64>; 2] {
        self.kind.embed(twist).map(|part| self.axes * part)
    }
}
