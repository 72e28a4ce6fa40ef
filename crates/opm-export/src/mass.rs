//! Masses of solids of one density, and their moments of inertia about an axis.

use nalgebra::{Point3, Unit, Vector3};
use opm_core::skeleton::Solid;
use std::f64::consts::PI;

/// The volume of a solid, cubic metres.
pub fn volume(solid: &Solid) -> f64 {
    match *solid {
        Solid::Cylinder { from, to, radius } => PI * radius * radius * (to - from).norm(),
        Solid::Ball { radius, .. } => 4.0 / 3.0 * PI * radius.powi(3),
        Solid::Block { length, width, .. } => length * width * width,
    }
}

/// The mean square of the distances of a solid's points from an axis, square metres: its moment of inertia over its
/// mass. Solids that are long are taken as thin, across the axis.
pub fn mean_square(solid: &Solid, axis: &Unit<Vector3<f64>>, point: &Point3<f64>) -> f64 {
    let off = |p: Point3<f64>| {
        let arm = p - point;
        arm - axis.into_inner() * axis.dot(&arm)
    };
    // Of a line: the integral of |a + s (b - a)|^2 for s from 0 to 1.
    let line =
        |a: Vector3<f64>, b: Vector3<f64>| (a.norm_squared() + a.dot(&b) + b.norm_squared()) / 3.0;
    match *solid {
        Solid::Cylinder { from, to, radius } => line(off(from), off(to)) + radius * radius / 2.0,
        Solid::Ball { centre, radius } => off(centre).norm_squared() + 0.4 * radius * radius,
        Solid::Block { centre, axis: along, length, width } => {
            let half = along.into_inner() * (0.5 * length);
            line(off(centre - half), off(centre + half)) + width * width / 6.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables of solids give these for a rod about its end, and for all three about their own axes.
    #[test]
    fn moments_are_those_of_tables() {
        let (z, origin) = (Vector3::z_axis(), Point3::origin());
        let rod = |to| Solid::Cylinder { from: origin, to, radius: 1e-6 };
        let across = mean_square(&rod(Point3::new(3.0, 0.0, 0.0)), &z, &origin);
        assert!((across - 3.0).abs() < 1e-9, "{across}");
        let own = Solid::Cylinder { from: origin, to: Point3::new(0.0, 0.0, 5.0), radius: 2.0 };
        assert!((mean_square(&own, &z, &origin) - 2.0).abs() < 1e-12);
        let block = Solid::Block { centre: origin, axis: z, length: 7.0, width: 3.0 };
        assert!((mean_square(&block, &z, &origin) - 1.5).abs() < 1e-12);
        let ball = Solid::Ball { centre: Point3::new(1.0, 0.0, 9.0), radius: 5.0 };
        assert!((mean_square(&ball, &z, &origin) - 11.0).abs() < 1e-12);
        assert!((volume(&block) - 63.0).abs() < 1e-12);
    }
}
