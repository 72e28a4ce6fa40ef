//! Points of a motion, joined by splines.

use super::{Ends, Path, PlatformMotion, Spline, SplineError};
use crate::manipulator::Manipulator;
use crate::mechanism::file::FileUnits;
use crate::numeric::Quantity;
use crate::numeric::angle::near;
use crate::task::TaskCoordinate;

/// A periodic motion comes back to its start to within this, in metres or radians: what decimals of angles leave.
const SAME: f64 = 1e-9;

/// Why points do not make a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub(super) enum PointsError {
    /// There is no spline through them.
    #[error(transparent)]
    Spline(#[from] SplineError),
    /// The ends are periodic, and the last point is not the first one.
    #[error(
        "{name} is {first} at the first point and {last} at the last, expected the same where the ends are periodic; \
         they differ by {by}"
    )]
    NotPeriodic {
        /// The coordinate.
        name: &'static str,
        /// Its first value, in the unit in which it was given.
        first: String,
        /// Its last value.
        last: String,
        /// The difference.
        by: String,
    },
}

/// The motion through points. `values` has a column for each task coordinate; an empty one stays at home. `units` are those
/// in which the values of a coordinate were given.
pub(super) fn through(
    name: &str,
    times: Vec<f64>,
    mut values: Vec<Vec<f64>>,
    ends: Ends,
    manipulator: &Manipulator,
    units: impl Fn(usize) -> FileUnits,
) -> Result<PlatformMotion, PointsError> {
    let coordinates = manipulator.task_coordinates().iter().enumerate();
    for ((number, coordinate), values) in coordinates.zip(&mut values) {
        if values.is_empty() {
            values.resize(times.len(), coordinate.home);
        }
        if let (Ends::Periodic, &[first, .., last]) = (ends, &**values) {
            // Whole revolutions may be between them, unless something follows these.
            let end = if wraps(manipulator, coordinate) { near(last, first) } else { last };
            if (end - first).abs() > SAME {
                let show = |value| units(number).show(value, coordinate.quantity).to_string();
                let [first, last, by] = [first, last, end - first].map(show);
                return Err(PointsError::NotPeriodic { name: coordinate.name, first, last, by });
            }
        }
    }
    let (start, end) = (*times.first().unwrap_or(&0.0), *times.last().unwrap_or(&0.0));
    let path = Path::Spline(Spline::new(times, values, ends)?);
    let (name, duration) = (name.to_owned(), end - start);
    Ok(PlatformMotion { name, start, duration, rate: None, mode: None, path })
}

/// Whether a coordinate is an angle whose whole revolutions do not matter.
pub(super) fn wraps(manipulator: &Manipulator, coordinate: &TaskCoordinate) -> bool {
    coordinate.quantity == Quantity::Angle && !manipulator.counts_turns(coordinate.kind())
}
