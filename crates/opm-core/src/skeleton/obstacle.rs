//! What obstacles are drawn as: solids.

use super::solid::Solid;
use crate::mechanism::ObstacleShape;
use nalgebra::{Isometry3, Point3, Unit, Vector3};

/// The radius of the rods that edges are drawn as, as a share of the mechanism's size.
const EDGE: f64 = 0.004;

impl Solid {
    /// The solids, in base coordinates, that an obstacle is drawn as: a box as its edges, a capsule as it is, and of the plane
    /// of a half-space the edges of a square, as large as the mechanism of this `size` and opposite of the point `about`,
    /// with a rod along the normal.
    pub fn of_obstacle(shape: &ObstacleShape, size: f64, about: &Point3<f64>) -> Vec<Self> {
        let edge = |from: Point3<f64>, to: Point3<f64>| Self::rod([from, to], EDGE * size);
        match *shape {
            ObstacleShape::Box { centre, size, edges } => {
                let place = Isometry3::from_parts(centre.into(), ObstacleShape::rotation(edges));
                let corner = |bits: usize| {
                    let sign = |i: usize| if bits >> i & 1 == 0 { -0.5 } else { 0.5 };
                    place * Point3::from(Vector3::from_fn(|i, _| sign(i) * size[i]))
                };
                // Of the edges along a direction, each starts where that one is at its low end.
                let along = (0..3).flat_map(|i| (0..8).map(move |bits: usize| (i, bits)));
                let starts = along.filter(|(i, bits)| bits >> i & 1 == 0);
                starts.map(|(i, bits)| edge(corner(bits), corner(bits | 1 << i))).collect()
            }
            ObstacleShape::Capsule { ends, radius } => {
                let [from, to] = ends.map(|end| Self::ball(end, radius));
                vec![Self::rod(ends, radius), from, to]
            }
            ObstacleShape::HalfSpace { point, normal } => {
                let foot = about - normal.into_inner() * normal.dot(&(about - point));
                let x = normal.cross(&Vector3::ith(normal.iamin(), 1.0));
                let x = Unit::new_normalize(x).into_inner() * (0.5 * size);
                let y = normal.cross(&x);
                let corners = [foot + x + y, foot - x + y, foot - x - y, foot + x - y];
                let sides = (0..4).map(|i| edge(corners[i], corners[(i + 1) % 4]));
                let out = edge(foot, foot + normal.into_inner() * (0.1 * size));
                sides.chain([out]).collect()
            }
        }
    }
}
