//! Ranges of coordinates in the syntax of the command line: `x=-0.1:0.1:11`.

use super::{Misread, Number, assignment};
use crate::failure::Failure;
use opm_core::Quantity;
use opm_core::numeric::number::readable;
use opm_workspace::measure::CoordinateRange;
use opm_workspace::{Axis, Coordinate};
use std::str::FromStr;

/// The values of one task coordinate on a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct GridAxis {
    name: String,
    min: Number,
    max: Number,
    count: u64,
}

/// A range of one coordinate, or a single value.
#[derive(Clone, Debug, PartialEq)]
pub struct OverAxis {
    name: String,
    min: Number,
    /// `None` for a single value.
    max: Option<Number>,
}

impl FromStr for GridAxis {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        const FORM: &str = "AXIS=MIN:MAX:COUNT or AXIS=VALUE, for example x=-100mm:100mm:21";
        let (name, values) = assignment(text, FORM)?;
        let axis = |min, max, count| Ok(Self { name: name.to_owned(), min, max, count });
        match *values.split(':').collect::<Vec<_>>() {
            [value] => {
                let value = value.parse()?;
                axis(value, value, 1)
            }
            [min, max, count] => {
                let [min, max] = ends(min, max)?;
                let count = count.trim().parse().map_err(|_| {
                    Misread(format!("{count:?} is not a number of values, expected 1 or more"))
                })?;
                axis(min, max, count)
            }
            _ => Err(Misread(format!("{text:?}, expected {FORM}"))),
        }
    }
}

impl GridAxis {
    /// The name of the coordinate with each end of its range.
    pub fn ends(&self) -> [(&str, Number); 2] {
        [self.min, self.max].map(|end| (&*self.name, end))
    }

    /// The name of what varies.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The values in SI, for something of this quantity.
    pub fn of_quantity(&self, quantity: Option<Quantity>) -> Result<Axis, Misread> {
        let [min, max] = [self.min, self.max].map(|end| match quantity {
            Some(quantity) => end.value_of(&self.name, quantity),
            None => end.bare(&self.name),
        });
        Ok(Axis::new(&*self.name, min?, max?, self.count))
    }

    /// The axis in SI, for one of these coordinates.
    pub fn resolve(&self, coordinates: &[Coordinate]) -> Result<Axis, Failure> {
        let axis = || {
            let [min, max] =
                [self.min, self.max].map(|end| end.value_among(&self.name, coordinates));
            Ok(Axis::new(&*self.name, min?, max?, self.count))
        };
        axis().map_err(|error: Misread| Failure::flag("--grid", error))
    }
}

/// The two ends of a range.
pub fn ends(min: &str, max: &str) -> Result<[Number; 2], Misread> {
    let (low, high): (Number, Number) = (min.parse()?, max.parse()?);
    // Otherwise -10:10mm would start at minus ten metres.
    let bare = |n: Number| n.quantity.is_none() && n.value != 0.0;
    if (bare(low) && high.quantity.is_some()) || (low.quantity.is_some() && bare(high)) {
        let range = format!("{min}:{max}");
        return Err(Misread(format!(
            "{range:?} has a unit at one end only, expected one at both or none"
        )));
    }
    Ok([low, high])
}

impl FromStr for OverAxis {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        const FORM: &str = "AXIS=MIN:MAX or AXIS=VALUE, for example x=-100mm:100mm";
        let (name, values) = assignment(text, FORM)?;
        let (min, max) = match *values.split(':').collect::<Vec<_>>() {
            [value] => (value.parse()?, None),
            [min, max] => {
                let [min, max] = ends(min, max)?;
                (min, Some(max))
            }
            _ => return Err(Misread(format!("{text:?}, expected {FORM}"))),
        };
        Ok(Self { name: name.to_owned(), min, max })
    }
}

impl OverAxis {
    /// The name of the coordinate with each end of its range.
    pub fn ends(&self) -> [(&str, Number); 2] {
        [self.min, self.max.unwrap_or(self.min)].map(|end| (&*self.name, end))
    }

    /// The range in SI, for one of these coordinates.
    pub fn resolve(&self, coordinates: &[Coordinate]) -> Result<CoordinateRange, Misread> {
        let end = |number: Number| number.value_among(&self.name, coordinates);
        let (name, min) = (&*self.name, end(self.min)?);
        let Some(max) = self.max.map(end).transpose()? else {
            return Ok(CoordinateRange::new(name, min, min));
        };
        // A range without width has measure zero, so it is a mistake.
        if min == max {
            let end = readable(min);
            return Err(Misread(format!(
                "{name}: {end} to {end}, expected MIN below MAX, or {name}=VALUE to hold it"
            )));
        }
        Ok(CoordinateRange::new(name, min, max))
    }
}
