//! Ranges of coordinates, by their names.

use crate::grid::Sections;
use opm_core::manipulator::{LARGEST, Manipulator};
use opm_core::numeric::number::readable;

/// The range of one coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct CoordinateRange {
    /// The name of the coordinate.
    pub name: String,
    /// The lowest value, radians or metres.
    pub min: f64,
    /// The highest value, radians or metres. It equals the lowest if the coordinate has a single value.
    pub max: f64,
}

impl CoordinateRange {
    /// The range of coordinate `name` from `min` to `max`, radians or metres.
    pub fn new(name: impl Into<String>, min: f64, max: f64) -> Self {
        Self { name: name.into(), min, max }
    }

    /// The lowest and the highest value of each coordinate of these sections, in their order. A coordinate without a range
    /// has its home value for both.
    ///
    /// # Errors
    /// [`RangeError`]: a coordinate is unknown or repeated, or its ends are not finite numbers in their order.
    pub fn of_each(
        manipulator: &Manipulator,
        sections: Sections,
        given: &[Self],
    ) -> Result<Vec<[f64; 2]>, RangeError> {
        let coordinates = sections.coordinates(manipulator);
        let mut ends: Vec<[f64; 2]> = coordinates.iter().map(|c| [c.home; 2]).collect();
        let mut seen = vec![false; ends.len()];
        for Self { name, min, max } in given {
            let (name, [min, max]) = (name.clone(), [*min, *max]);
            let Some(number) = coordinates.iter().position(|c| c.name == name) else {
                let names: Vec<_> = coordinates.iter().map(|c| &*c.name).collect();
                let expected = names.join(", ");
                return Err(RangeError::Unknown { name, sections, expected });
            };
            if std::mem::replace(&mut seen[number], true) {
                return Err(RangeError::Twice(name));
            }
            if !(min <= max && min.abs().max(max.abs()) <= LARGEST) {
                return Err(RangeError::Ends { name, min, max });
            }
            ends[number] = [min, max];
        }
        Ok(ends)
    }
}

/// What is wrong with ranges.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RangeError {
    /// No coordinate has the name of the range.
    #[error("no {} {name}, expected one of {expected}", sections.coordinate())]
    Unknown {
        /// The name, as given.
        name: String,
        /// The sections whose coordinates have ranges.
        sections: Sections,
        /// The names of all coordinates, separated by commas.
        expected: String,
    },
    /// Two ranges are of the same coordinate.
    #[error("{0} is given twice")]
    Twice(String),
    /// An end of a range is not a finite number, or the ends are reversed.
    #[error(
        "{name}: {} to {}, expected numbers up to {LARGEST:e}, the smaller one first",
        readable(*min),
        readable(*max)
    )]
    Ends {
        /// The name of the coordinate.
        name: String,
        /// The lowest value, as given.
        min: f64,
        /// The highest value, as given.
        max: f64,
    },
}
