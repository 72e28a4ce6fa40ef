//! The names of columns in tables, with or without units: `x`, `x [mm]`, `x (mm)`.

use super::units::{AngleUnit, FileUnits, LengthUnit};
use crate::numeric::Quantity;

/// The heading of a column: its name, and its unit if one follows in brackets.
///
/// ```
/// use opm_core::mechanism::file::Heading;
/// use opm_core::numeric::Quantity;
///
/// let heading = Heading::parse("S1 [mm]");
/// let units = heading.units(Quantity::Length)?.expect("a unit");
/// assert_eq!((heading.name, units.si(12.5, Quantity::Length)), ("S1", 0.0125));
/// assert_eq!(Heading::parse("S1(mm)"), heading);
/// assert_eq!(Heading::parse("S1 (left)").name, "S1 (left)");
/// assert_eq!(Heading::parse("S1").units(Quantity::Length)?, None);
/// assert!(heading.units(Quantity::Angle).is_err());
/// # Ok::<(), String>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Heading<'a> {
    /// The name of the values.
    pub name: &'a str,
    /// The symbol of their unit.
    pub unit: Option<&'a str>,
}

impl<'a> Heading<'a> {
    /// Reads the text of a heading. A unit may stand in parentheses, too; other words in them belong to the name.
    pub fn parse(text: &'a str) -> Self {
        let is_unit = |unit: &str| {
            unit == "s"
                || LengthUnit::from_symbol(unit).is_some()
                || AngleUnit::from_symbol(unit).is_some()
        };
        let split = text.trim().strip_suffix(']').and_then(|text| text.split_once('['));
        let split = split.or_else(|| {
            let split = text.trim().strip_suffix(')').and_then(|text| text.rsplit_once('('));
            split.filter(|(_, unit)| is_unit(unit.trim()))
        });
        match split {
            Some((name, unit)) => Self { name: name.trim_end(), unit: Some(unit.trim()) },
            None => Self { name: text.trim(), unit: None },
        }
    }

    /// The units of the column, whose values are of this quantity; `None` if it names none.
    ///
    /// # Errors
    /// The unit is unknown, or of the other quantity.
    pub fn units(&self, quantity: Quantity) -> Result<Option<FileUnits>, String> {
        let Some(unit) = self.unit else { return Ok(None) };
        let length = LengthUnit::from_symbol(unit);
        let angle = AngleUnit::from_symbol(unit);
        let (units, known) = match quantity {
            Quantity::Length => (
                length.map(|length| FileUnits { length, ..FileUnits::SI }),
                LengthUnit::ALL.map(LengthUnit::symbol).join(", "),
            ),
            Quantity::Angle => (
                angle.map(|angle| FileUnits { angle, ..FileUnits::SI }),
                AngleUnit::ALL.map(AngleUnit::symbol).join(", "),
            ),
        };
        let what = match quantity {
            Quantity::Length => "a length",
            Quantity::Angle => "an angle",
        };
        units
            .map(Some)
            .ok_or_else(|| format!("{} is {what}, expected {known}, not {unit:?}", self.name))
    }
}
