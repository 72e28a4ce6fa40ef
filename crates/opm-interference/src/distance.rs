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
    pub fn distance_to_capsule(&self, other: &Self) -> f64 {
        self.axes_apart(other) - self.radius - other.radius
    }

    /// The distance of the two axes.
    fn axes_apart(&self, other: &Self) -> f64 {
        let [p, q] = self.nearest_points(other);
        let point = |ends: &[Vector; 2], at: [f64; 2]| ends[0] * at[0] + ends[1] * at[1];
        (point(&self.ends, p) - point(&other.ends, q)).length()
    }

    /// The points of the two axes that are nearest to each other, as weights of the ends.
    pub fn nearest_points(&self, other: &Self) -> [[f64; 2]; 2] {
        let ([a, b], [c, d]) = (&self.ends, &other.ends);
        let (first, second) = closest_points_segment_segment_with_locations_nD((a, b), (c, d));
        [first.barycentric_coordinates(), second.barycentric_coordinates()]
    }

    /// At most the distance from another capsule: that of the balls around them.
    pub fn at_least_to(&self, other: &Self) -> f64 {
        let middle = |c: &Self| (c.ends[0] + c.ends[1]) * 0.5;
        let half = |c: &Self| (c.ends[1] - c.ends[0]).length() * 0.5;
        let apart = (middle(self) - middle(other)).length();
        apart - half(self) - half(other) - self.radius - other.radius
    }

    /// The signed distance from a box with these half edges; minus the radius where the axis is inside.
    pub fn distance_to_box(&self, pose: &Pose, half: Vector) -> f64 {
        let [a, b] = self.ends.map(|end| pose.inverse_transform_point(end));
        let (cuboid, axis) = (Cuboid::new(half), Segment::new(a, b));
        distance_support_map_support_map(&Pose::IDENTITY, &cuboid, &axis) - self.radius
    }

    /// The signed distance from a half-space: see [`Shape::HalfSpace`](crate::member::Shape::HalfSpace).
    pub fn distance_to_half_space(&self, normal: Vector, offset: f64) -> f64 {
        let [a, b] = self.ends.map(|end| normal.dot(end));
        a.min(b) - offset - self.radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn to_segment(p: Vector, [a, b]: [Vector; 2]) -> f64 {
        let along = b - a;
        let square = along.length_squared();
        let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        (p - (a + along * t)).length()
    }

    /// The distance from the segment at a share of the other one falls and then rises.
    fn apart(one: [Vector; 2], other: [Vector; 2]) -> f64 {
        let at = |t: f64| to_segment(one[0] + (one[1] - one[0]) * t, other);
        let (mut from, mut to) = (0.0, 1.0);
        for _ in 0..200 {
            let [c, d] = [from + (to - from) * 0.4, from + (to - from) * 0.6];
            if at(c) < at(d) { to = d } else { from = c }
        }
        at(0.0).min(at(1.0)).min(at(from)).min(at(to))
    }

    fn close(one: [Vector; 2], other: [Vector; 2]) {
        let capsule = |ends| Capsule { ends, radius: 0.125 };
        let (one_c, other_c) = (capsule(one), capsule(other));
        let (found, expected) = (one_c.distance_to_capsule(&other_c), apart(one, other) - 0.25);
        assert!(
            (found - expected).abs() < INACCURACY,
            "{one:?} {other:?}: {found}, not {expected}"
        );
        assert!((other_c.distance_to_capsule(&one_c) - found).abs() < 1e-12);
        assert!(one_c.at_least_to(&other_c) <= found + 1e-12);
    }

    /// Random segments: crossing, parallel, nearly parallel, on one line, with a common end, without length.
    #[test]
    fn segments_are_as_far_apart_as_a_search_finds() {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut vector = |size: f64| {
            Vector::new(rng.f64() - 0.5, rng.f64() - 0.5, rng.f64() - 0.5) * (2.0 * size)
        };
        for case in 0..20_000 {
            let (a, u, c, v) = (vector(1.0), vector(1.0), vector(1.0), vector(1.0));
            let share = [0.0, 1.0, -0.5, 0.3][case % 4];
            let other = match case % 6 {
                0 => [c, c + v],
                1 => [c, c + u],
                2 => [c, c + u + vector(1e-8)],
                3 => [a + u * share, a + u * share + v],
                4 => [a + u * (1.5 + share), a + u * 4.0],
                _ => [c, c],
            };
            close([a, a + u], other);
        }
    }

    /// A box against the distance of the nearest point, which falls and then rises along the axis.
    #[test]
    fn boxes_are_as_far_as_a_search_finds() {
        let mut rng = fastrand::Rng::with_seed(4);
        let half = Vector::new(0.3, 0.2, 0.5);
        for case in 0..20_000 {
            let mut vector = || {
                let part = |rng: &mut fastrand::Rng| 2.0 * rng.f64() - 1.0;
                Vector::new(part(&mut rng), part(&mut rng), part(&mut rng))
            };
            let (a, mut b) = (vector(), vector());
            if case % 3 == 0 {
                // Parallel to an edge, on a face or beside it.
                b = Vector::new(a.x, a.y, b.z);
            }
            let at = |t: f64| ((a + (b - a) * t).abs() - half).max(Vector::ZERO).length();
            let (mut from, mut to) = (0.0, 1.0);
            for _ in 0..200 {
                let [c, d] = [from + (to - from) * 0.4, from + (to - from) * 0.6];
                // Inside of the box there is nothing to fall.
                if at(c) <= at(d) { to = d } else { from = c }
            }
            let expected = at(0.0).min(at(1.0)).min(at(from)).min(at(to));
            let capsule = Capsule { ends: [a, b], radius: 0.1 };
            let found = capsule.distance_to_box(&Pose::IDENTITY, half) + 0.1;
            assert!((found - expected).abs() < INACCURACY, "{a} {b}: {found}, not {expected}");
        }
    }
}
