//! How thick the bodies of a mechanism are, and what stands around it: what interference is computed with.

use nalgebra::{Matrix3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};

/// How thick the bodies of a mechanism are (`radius` and `radii` of `[bodies]` in a mechanism file), and what stands around
/// it (`[[obstacle]]`). Kinematics do not depend on it.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Shapes {
    /// The radius of the rods of all bodies whose radius is not given, metres, positive. Without it, it follows from the
    /// size of the mechanism.
    pub radius: Option<f64>,
    /// Radii in metres, positive, by the names of bodies: [`BASE`](Self::BASE),
    /// [`BodyMasses::PLATFORM`](super::BodyMasses::PLATFORM), or the joint that carries the body.
    pub radii: Vec<(String, f64)>,
    /// What stands around the mechanism, at rest in the base.
    pub obstacles: Vec<Obstacle>,
}

/// A body that stands around a mechanism, at rest in the base.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Obstacle {
    /// Its name, which is neither that of another obstacle nor that of a body.
    pub name: String,
    /// What it is.
    pub shape: ObstacleShape,
}

/// The shape of an obstacle, in base coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum ObstacleShape {
    /// A box.
    Box {
        /// Its centre, metres.
        centre: Point3<f64>,
        /// The lengths of its edges, metres, positive.
        size: Vector3<f64>,
        /// The directions of its first and its second edge. The second one is that of this vector's part perpendicular to
        /// the first, and the third edge is perpendicular to both.
        edges: [Unit<Vector3<f64>>; 2],
    },
    /// All points within a distance of a segment: a cylinder with hemispheres at its ends; a ball if both ends are the
    /// same.
    Capsule {
        /// The ends of the segment, metres.
        ends: [Point3<f64>; 2],
        /// The distance, metres, positive.
        radius: f64,
    },
    /// All points on one side of a plane.
    HalfSpace {
        /// A point of the plane, metres.
        point: Point3<f64>,
        /// The direction out of the obstacle.
        normal: Unit<Vector3<f64>>,
    },
}

impl Shapes {
    /// The name of the base among bodies.
    pub const BASE: &'static str = "base";

    /// The radius of the body with a name, metres, if it is given, by itself or for all.
    pub fn radius_of(&self, body: &str) -> Option<f64> {
        let own = self.radii.iter().find(|(name, _)| name == body).map(|&(_, radius)| radius);
        own.or(self.radius)
    }
}

impl ObstacleShape {
    /// The edges of a box along the base's directions.
    pub fn level() -> [Unit<Vector3<f64>>; 2] {
        [Vector3::x_axis(), Vector3::y_axis()]
    }

    /// The rotation that brings the base's directions to the edges of a box.
    pub fn rotation([x, y]: [Unit<Vector3<f64>>; 2]) -> UnitQuaternion<f64> {
        let y = Unit::new_normalize(y.into_inner() - x.into_inner() * x.dot(&y));
        let columns = [x.into_inner(), y.into_inner(), x.cross(&y)];
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&columns));
        UnitQuaternion::from_rotation_matrix(&rotation)
    }
}
