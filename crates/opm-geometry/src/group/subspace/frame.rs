//! The frame in which ranks are decided: its origin is in the middle of the mechanism, and its unit of
//! length is the mechanism's size.

use super::TOLERANCE;
use crate::group::screw::Screw;
use nalgebra::{Matrix3, Point3, Vector3, Vector6};

/// An eigenvalue below this share of the largest does not determine the origin along its eigenvector,
/// because the axes are nearly parallel. The mean of the given points is used in that direction.
const DETERMINED: f64 = 1e-2;

/// A length below this share of the coordinates may be nothing but their rounding, if they are written
/// with six digits.
const ROUNDING: f64 = 5e-6;

/// A frame for normalised screws: its origin is in the middle of a set of axes, its unit of length is
/// their spread.
///
/// Screws mix radians and metres, so the rank of a set of them within a tolerance depends on the
/// unit of length and on the origin. Both are taken from the axes themselves: rigid displacement,
/// the distance from the base's origin and the choice of metres or millimetres then change nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point nearest to all axes, in base coordinates, metres.
    pub origin: Point3<f64>,
    /// The characteristic length, metres: the root mean square of the axes' distances from the origin
    /// and of their pitches.
    pub length: f64,
}

impl Frame {
    /// The frame of a set of joint screws, each with a point on its axis (ignored for a translation).
    /// If all axes meet in one point, the length is the spread of the given points; if that is zero
    /// too, it is one metre.
    pub fn of(axes: &[(Screw, Point3<f64>)]) -> Self {
        let lines: Vec<(Vector3<f64>, Vector3<f64>, f64)> = axes
            .iter()
            .filter_map(|(screw, point)| {
                let axis = screw.angular.try_normalize(0.0)?;
                let pitch = screw.angular.dot(&screw.linear) / screw.angular.norm_squared();
                Some((axis, point.coords, pitch))
            })
            .collect();
        if lines.is_empty() {
            return Self { origin: Point3::origin(), length: 1.0 };
        }
        let count = lines.len() as f64;
        let mean = lines.iter().map(|(_, p, _)| p).sum::<Vector3<f64>>() / count;
        let perpendicular = |axis: &Vector3<f64>, d: Vector3<f64>| d - axis * axis.dot(&d);

        let normal: Matrix3<f64> =
            lines.iter().map(|(a, ..)| Matrix3::identity() - a * a.transpose()).sum();
        let offset: Vector3<f64> = lines.iter().map(|(a, p, _)| perpendicular(a, p - mean)).sum();
        let eigen = normal.symmetric_eigen();
        let cutoff = DETERMINED * eigen.eigenvalues.max();
        let step: Vector3<f64> = (0..3)
            .filter(|&i| eigen.eigenvalues[i] > cutoff)
            .map(|i| {
                let direction = eigen.eigenvectors.column(i);
                direction * (direction.dot(&offset) / eigen.eigenvalues[i])
            })
            .sum();
        let origin = mean + step;

        let root_mean = |squares: f64| (squares / count).sqrt();
        let spread = root_mean(lines.iter().map(|(_, p, _)| (p - mean).norm_squared()).sum());
        let distance = root_mean(
            lines.iter().map(|(a, p, h)| perpendicular(a, p - origin).norm_squared() + h * h).sum(),
        );
        let farthest = lines.iter().map(|(_, p, _)| p.amax()).fold(0.0, f64::max);
        let least = (TOLERANCE * spread).max(ROUNDING * farthest);
        let length = [distance, spread].into_iter().find(|&l| l > least).unwrap_or(1.0);
        Self { origin: origin.into(), length }
    }

    /// A screw in this frame. A translation keeps its unit rate: its coordinate is measured in
    /// characteristic lengths.
    pub fn normalised(&self, screw: &Screw) -> Screw {
        let moved = screw.linear + screw.angular.cross(&self.origin.coords);
        let unit = if screw.angular == Vector3::zeros() { 1.0 } else { self.length };
        Screw { angular: screw.angular, linear: moved / unit }
    }

    /// A screw in this frame, scaled to unit length. Ranks are decided on these.
    pub fn unit(&self, screw: &Screw) -> Vector6<f64> {
        let vector = self.normalised(screw).to_vector();
        vector.try_normalize(0.0).unwrap_or(vector)
    }

    /// Converts a normalised screw to base coordinates and metres.
    pub(crate) fn restored(&self, vector: &Vector6<f64>) -> Screw {
        let Screw { angular, linear } = Screw::from_vector(vector);
        Screw { angular, linear: linear * self.length - angular.cross(&self.origin.coords) }
    }

    /// Converts a normalised point to base coordinates and metres.
    pub(crate) fn restored_point(&self, point: &Point3<f64>) -> Point3<f64> {
        self.origin + point.coords * self.length
    }
}
