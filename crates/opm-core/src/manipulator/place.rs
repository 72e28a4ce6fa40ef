//! Places of the platform as people and programs write them: a position and a quaternion, with a few digits.

use super::{Manipulator, Mode, OutsideMotion};
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};

/// The names of the numbers of a place.
pub const PLACE: [&str; 7] = ["X", "Y", "Z", "QW", "QX", "QY", "QZ"];

/// Largest deviation of a quaternion's length from one. Three digits are enough; more means a wrong number.
const UNIT: f64 = 2e-3;

/// Largest distance from the motion, in radians or sizes of the mechanism. Six digits are enough.
const WRITTEN: f64 = 1e-5;

/// Largest coordinate, metres, as in mechanism files. At much larger ones, rounding hides the mechanism.
const FARTHEST: f64 = 1e9;

/// The place of these numbers, in the order of [`PLACE`]: the position of the platform's reference point, metres, and its
/// orientation as a quaternion, whose length is rounded to one.
///
/// # Errors
/// A number is none or too large, or the quaternion has no unit length: says which.
///
/// ```
/// use opm_core::manipulator::place;
///
/// let found = place([0.01, 0.0, 0.0, 0.966, 0.0, 0.0, 0.259])?; // turned by 30 degrees about z
/// assert!((found.rotation.angle().to_degrees() - 30.0).abs() < 0.1);
/// assert!(place([0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]).unwrap_err().contains("has length 2.0000, expected 1"));
/// # Ok::<(), String>(())
/// ```
pub fn place(values: [f64; 7]) -> Result<Isometry3<f64>, String> {
    for (value, name) in values.into_iter().zip(PLACE) {
        if value.is_nan() || value.abs() > FARTHEST {
            return Err(format!("{name} is {value:?}, expected a number of at most {FARTHEST:e}"));
        }
    }
    let [x, y, z, qw, qx, qy, qz] = values;
    let quaternion = Quaternion::new(qw, qx, qy, qz);
    let length = quaternion.norm();
    if (length - 1.0).abs() > UNIT {
        return Err(format!(
            "the quaternion {qw},{qx},{qy},{qz} has length {length:.4}, expected 1"
        ));
    }
    let rotation = UnitQuaternion::new_normalize(quaternion);
    Ok(Isometry3::from_parts(Translation3::new(x, y, z), rotation))
}

impl Manipulator {
    /// The pose at which the platform has a place that was written with six digits or more, in a working mode if that is
    /// possible: as [`Manipulator::locate_platform_in`], or the nearest pose if it differs by rounding alone.
    ///
    /// # Errors
    /// The place is outside the motion.
    pub fn locate_written(
        &self,
        platform: &Isometry3<f64>,
        mode: Mode,
    ) -> Result<Vec<f64>, OutsideMotion> {
        self.locate_platform_in(platform, mode).or_else(|outside| {
            let translation = outside.translation.norm() / self.characteristic_length();
            match outside.rotation.norm().max(translation) < WRITTEN {
                true => Ok(outside.nearest),
                false => Err(outside),
            }
        })
    }

    /// Replaces the angles of a pose by those of the same orientation that are nearest to another pose: other full turns, and,
    /// where two triples of angles give one orientation, the nearer one. Nothing is replaced where full turns count or
    /// coordinates depend on the mode.
    pub(crate) fn angles_near(&self, pose: &mut Vec<f64>, before: &[f64]) {
        if self.dependent.is_some() {
            return;
        }
        let coordinates = &self.task.coordinates;
        let brought = |pose: &[f64]| -> Vec<f64> {
            let each = coordinates.iter().zip(pose).zip(before);
            each.map(|((c, &value), &before)| match c.quantity {
                Quantity::Angle if !self.counts_turns(c.kind()) => near(value, before),
                _ => value,
            })
            .collect()
        };
        let apart = |pose: &[f64]| -> f64 {
            let each = coordinates.iter().zip(pose).zip(before);
            each.filter(|((c, _), _)| c.quantity == Quantity::Angle)
                .map(|((_, value), before)| (value - before).powi(2))
                .sum()
        };
        let mut best = brought(pose);
        for second in 0..coordinates.len() {
            let mut other = pose.clone();
            self.task.take_other_angles(second, &mut other);
            let other = brought(&other);
            if apart(&other) < apart(&best) {
                best = other;
            }
        }
        *pose = best;
    }
}
