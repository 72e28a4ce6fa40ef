//! The frame in which ranks are decided: a mechanism's own middle, and its own size as the unit.

use super::TOLERANCE;
use crate::group::screw::Screw;
use nalgebra::{Matrix3, Point3, Vector3, Vector6};

/// Below this share of the largest, the middle is not determined in a direction (axes all but
/// parallel), and the points that were given decide.
const DETERMINED: f64 = 1e-2;

/// Shorter than this share of the coordinates, a length is their rounding: to six digits, at worst.
const ROUNDING: f64 = 5e-6;

/// Origin in the middle of a set of axes, lengths over their spread.
///
/// Screws mix radians and metres, so the rank of a set of them within a tolerance depends on the
/// unit of length and on the origin. Both are taken from the axes themselves: rigid displacement,
/// the distance from the base's origin and the choice of metres or millimetres then change nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The point nearest to all axes, in base coordinates, metres.
    pub origin: Point3<f64>,
    /// Characteristic length, metres: root mean square of the axes' distances from the origin and
    /// of their pitches.
    pub length: f64,
}

impl Frame {
    /// The frame of a set of joint screws, each with a point of its axis (that of a translation is
    /// not read). Axes that all meet are measured by the spread of the points; with no length at
    /// all, one metre.
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
        let across = |axis: &Vector3<f64>, d: Vector3<f64>| d - axis * axis.dot(&d);

        let normal: Matrix3<f64> =
            lines.iter().map(|(a, ..)| Matrix3::identity() - a * a.transpose()).sum();
        let offset: Vector3<f64> = lines.iter().map(|(a, p, _)| across(a, p - mean)).sum();
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

        let size = |squares: f64| (squares / count).sqrt();
        let spread = size(lines.iter().map(|(_, p, _)| (p - mean).norm_squared()).sum());
        let arms =
            size(lines.iter().map(|(a, p, h)| across(a, p - origin).norm_squared() + h * h).sum());
        let farthest = lines.iter().map(|(_, p, _)| p.amax()).fold(0.0, f64::max);
        let least = (TOLERANCE * spread).max(ROUNDING * farthest);
        let length = [arms, spread].into_iter().find(|&l| l > least).unwrap_or(1.0);
        Self { origin: origin.into(), length }
    }

    /// A screw as seen from this frame. A translation keeps its unit rate: its coordinate counts in
    /// characteristic lengths.
    pub fn normalised(&self, screw: &Screw) -> Screw {
        let moved = screw.linear + screw.angular.cross(&self.origin.coords);
        let unit = if screw.angular == Vector3::zeros() { 1.0 } else { self.length };
        Screw { angular: screw.angular, linear: moved / unit }
    }

    /// A screw as seen from this frame, scaled to unit length: what ranks are decided on.
    pub(crate) fn unit(&self, screw: &Screw) -> Vector6<f64> {
        let vector = self.normalised(screw).to_vector();
        vector.try_normalize(0.0).unwrap_or(vector)
    }

    /// A normalised screw in base coordinates, metres.
    pub(crate) fn restored(&self, vector: &Vector6<f64>) -> Screw {
        let Screw { angular, linear } = Screw::from_vector(vector);
        Screw { angular, linear: linear * self.length - angular.cross(&self.origin.coords) }
    }

    /// A normalised point in base coordinates, metres.
    pub(crate) fn restored_point(&self, point: &Point3<f64>) -> Point3<f64> {
        self.origin + point.coords * self.length
    }
}
