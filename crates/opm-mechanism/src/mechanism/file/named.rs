//! `[parameters]`: numbers and points of a file that have names, by which expressions give all others.

#[cfg(feature = "files")]
mod read;

use super::checks;
use super::units::FileUnits;
use crate::mechanism::family::ParameterValue;
use crate::numeric::Quantity;

#[cfg(feature = "schema")]
pub(super) use read::KEYS;
#[cfg(feature = "files")]
pub(super) use read::{Names, read};

/// What a parameter measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterUnit {
    /// A length in the file's unit, or a point.
    Length,
    /// An angle in the file's unit.
    Angle,
    /// A number without a unit, or a direction.
    Number,
}

impl ParameterUnit {
    /// The units with their words in files.
    pub const NAMED: [(&'static str, Self); 3] =
        [("length", Self::Length), ("angle", Self::Angle), ("number", Self::Number)];

    /// The quantity; `None` for a number without a unit.
    pub fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Length => Some(Quantity::Length),
            Self::Angle => Some(Quantity::Angle),
            Self::Number => None,
        }
    }

    /// A number of the file in SI.
    pub fn si(self, number: f64, units: FileUnits) -> f64 {
        self.quantity().map_or(number, |quantity| units.si(number, quantity))
    }

    /// An SI value in the unit of the file.
    pub fn number_of(self, value: f64, units: FileUnits) -> f64 {
        self.quantity().map_or(value, |quantity| units.number_of(value, quantity))
    }

    /// An SI value with its unit in the file, shown.
    pub fn show(self, value: f64, units: FileUnits) -> String {
        match self.quantity() {
            Some(quantity) => units.show(value, quantity).to_string(),
            None => value.to_string(),
        }
    }
}

/// The value of a named parameter, SI.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NamedValue {
    /// One number.
    Number(f64),
    /// A point or a direction.
    Point([f64; 3]),
}

/// A number, or a point, that a file names in `[parameters]`.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedParameter {
    /// Its name.
    pub name: String,
    /// What it measures.
    pub unit: ParameterUnit,
    /// Its value, SI.
    pub value: NamedValue,
    /// How it follows from others, as it was typed; `None` where it is given by itself.
    pub formula: Option<String>,
    /// The least and the largest value that it may have, SI.
    pub range: [Option<f64>; 2],
    /// What it is, in words.
    pub text: Option<String>,
}

impl NamedParameter {
    /// The number of a new value, SI, or why it cannot have that value. Its range is checked where the file is read with it.
    ///
    /// # Errors
    /// What the value is and what is expected, without the name.
    pub fn takes(&self, value: ParameterValue) -> Result<f64, String> {
        match (value, self.value) {
            (_, NamedValue::Point(_)) => {
                Err("is a point, expected a parameter that is a number".to_owned())
            }
            (ParameterValue::Number(value), NamedValue::Number(_)) => checks::finite(value),
            (ParameterValue::None, _) => Err("is nothing, expected a number".to_owned()),
            (ParameterValue::Pair(_), _) => Err("is a pair, expected a number".to_owned()),
        }
    }
}
