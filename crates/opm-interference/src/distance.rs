//! Signed distances of a capsule from other shapes, in units of the mechanism's size.

use parry3d_f64::math::{Pose, Vector};
use parry3d_f64::query::details::{
    closest_points_segment_segment_with_locations_nD, distance_support_map_support_map,
};
use parry3d_f64::shape::{Cuboid, Segment};

/// The most by which these distances may be too large or too small, in units of the mechanism's size: that of a segment from
/// a box is iterated to a relative accuracy of 5e-8, and segments that are parallel to within 2e-8 count as parallel.
pub(crate) const INACCURACY: f64 = 1e-6;

/// A capsule: the points within `radius` of a segment.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Capsule {
    pub ends: [Vector; 2],
    pub radius: f64,
}

impl Capsule {
    /// The signed distance from another capsule.
    pub fn to_capsule(&self, other: &Self) -> f64 {
        self.axes_apart(other) - self.radius - other.radius
    }

    /// The distance of the two axes.
    fn axes_apart(&self, other: &Self) -> f64 {
        let ([a, b], [c, d]) = (&self.ends, &other.ends);
        let (first, second) = closest_points_segment_segment_with_locations_nD((a, b), (c, d));
        let point = |ends: &[Vector; 2], at: [f64; 2]| ends[0] * at[0] + ends[1] * at[1];
        let first = point(&self.ends, first.barycentric_coordinates());
        (first - point(&other.ends, second.barycentric_coordinates())).length()
    }

    /// At most the distance from another capsule: that of the balls around them.
    pub fn at_least_to(&self, other: &Self) -> f64 {
        let middle = |c: &Self| (c.ends[0] + c.ends[1]) * 0.5;
        let half = |c: &Self| (c.ends[1] - c.ends[0]).length() * 0.5;
        let apart = (middle(self) - middle(other)).length();
        apart - half(self) - half(other) - self.radius - other.radius
    }

    /// The signed distance from a box with these half edges; minus the radius where the axis is inside.
    pub fn to_box(&self, pose: &Pose, half: Vector) -> f64 {
        let [a, b] = self.ends.map(|end| pose.inverse_transform_point(end));
        let (cuboid, axis) = (Cuboid::new(half), Segment::new(a, b));
        distance_support_map_support_map(&Pose::IDENTITY, &cuboid, &axis) - self.radius
    }

    /// The signed distance from a half-space: see [`Shape::HalfSpace`](crate::member::Shape::HalfSpace).
    pub fn to_half_space(&self, normal: Vector, offset: f64) -> f64 {
        let [a, b] = self.ends.map(|end| normal.dot(end));
        a.min(b) - offset - self.radius
    }
}
