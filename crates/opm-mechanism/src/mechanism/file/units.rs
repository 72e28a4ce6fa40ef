//! The units that a mechanism file names for its numbers; every value after reading is SI.

use crate::numeric::Quantity;
use crate::numeric::number::readable;
use std::fmt;

/// A unit of length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LengthUnit {
    /// Metre, `m`.
    #[default]
    Metre,
    /// Centimetre, `cm`.
    Centimetre,
    /// Millimetre, `mm`.
    Millimetre,
    /// Micrometre, `um`.
    Micrometre,
    /// Inch, `in`: 25.4 mm.
    Inch,
}

impl LengthUnit {
    /// Every unit that a file may name.
    pub const ALL: [Self; 5] =
        [Self::Metre, Self::Centimetre, Self::Millimetre, Self::Micrometre, Self::Inch];

    /// The symbol of the unit in files.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metre => "m",
            Self::Centimetre => "cm",
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
            Self::Inch => "in",
        }
    }

    /// The number of metres in one unit.
    pub fn factor(self) -> f64 {
        self.metres(1.0)
    }

    /// Converts a number in this unit to metres. Millimetres are divided by 1000: `9.0 / 1000.0` is
    /// exactly the double 0.009, while `9.0 * 0.001` is not.
    pub fn metres(self, value: f64) -> f64 {
        match self {
            Self::Metre => value,
            Self::Centimetre => value / 100.0,
            Self::Millimetre => value / 1000.0,
            Self::Micrometre => value / 1e6,
            Self::Inch => value * 0.0254,
        }
    }

    /// The unit with this symbol.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.symbol() == symbol)
    }
}

/// A unit of angle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AngleUnit {
    /// Radian, `rad`.
    #[default]
    Radian,
    /// Milliradian, `mrad`.
    Milliradian,
    /// Microradian, `urad`.
    Microradian,
    /// Degree, `deg`.
    Degree,
}

impl AngleUnit {
    /// Every unit that a file may name.
    pub const ALL: [Self; 4] = [Self::Radian, Self::Milliradian, Self::Microradian, Self::Degree];

    /// The symbol of the unit in files.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Radian => "rad",
            Self::Milliradian => "mrad",
            Self::Microradian => "urad",
            Self::Degree => "deg",
        }
    }

    /// The number of radians in one unit.
    pub fn factor(self) -> f64 {
        self.radians(1.0)
    }

    /// Converts a number in this unit to radians. Those of decimal parts are divided, as in [`LengthUnit::metres`].
    pub fn radians(self, value: f64) -> f64 {
        match self {
            Self::Radian => value,
            Self::Milliradian => value / 1000.0,
            Self::Microradian => value / 1e6,
            Self::Degree => value * (std::f64::consts::PI / 180.0),
        }
    }

    /// The unit with this symbol.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.symbol() == symbol)
    }
}

/// The units of one file; the default is SI.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FileUnits {
    /// The unit of every length, also in pitches (length per radian).
    pub length: LengthUnit,
    /// The unit of every angle.
    pub angle: AngleUnit,
}

impl FileUnits {
    /// SI units: metres and radians.
    pub const SI: Self = Self { length: LengthUnit::Metre, angle: AngleUnit::Radian };

    /// Converts a number of the file to SI.
    pub fn si(self, value: f64, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Angle => self.angle.radians(value),
            Quantity::Length => self.length.metres(value),
        }
    }

    /// The number of SI units in one unit of the file.
    pub fn factor(self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::Angle => self.angle.factor(),
            Quantity::Length => self.length.factor(),
        }
    }

    /// Converts an SI value to a number of the file: one that [`si`](Self::si) converts to this value, with the fewest
    /// digits if there is one of at most 15; the nearest number where there is none, as between the doubles of degrees.
    pub fn number_of(self, value: f64, quantity: Quantity) -> f64 {
        /// Digits behind the first one, with which decimals tell all doubles apart.
        const DIGITS: usize = 16;
        let number = value / self.factor(quantity);
        let rounded = (0..=DIGITS).filter_map(|digits| format!("{number:.digits$e}").parse().ok());
        let mut candidates = rounded.chain([number.next_down(), number.next_up()]);
        candidates.find(|&candidate| self.si(candidate, quantity) == value).unwrap_or(number)
    }

    /// The symbol of the file's unit for a quantity.
    pub fn symbol(self, quantity: Quantity) -> &'static str {
        match quantity {
            Quantity::Angle => self.angle.symbol(),
            Quantity::Length => self.length.symbol(),
        }
    }

    /// Formats an SI value in the file's unit, to six significant digits.
    pub fn show(self, value: f64, quantity: Quantity) -> impl fmt::Display {
        format!("{} {}", six_digits(value / self.factor(quantity)), self.symbol(quantity))
    }
}

/// Formats a number to six significant digits, without trailing zeros.
fn six_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    // `-0` would look like a mistake.
    if rounded == 0.0 { "0".to_owned() } else { readable(rounded) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_shown_in_the_unit_of_the_file() {
        let file = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
        assert_eq!(file.show(0.012_345_678_9, Quantity::Length).to_string(), "12.3457 mm");
        assert_eq!(file.show(std::f64::consts::FRAC_PI_2, Quantity::Angle).to_string(), "90 deg");
        assert_eq!(FileUnits::SI.show(-0.0, Quantity::Length).to_string(), "0 m");
        assert_eq!(FileUnits::SI.show(-1.5e-9, Quantity::Length).to_string(), "-0.0000000015 m");
    }

    #[test]
    fn decimals_of_a_millimetre_are_decimals_of_a_metre() {
        let file = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Radian };
        assert_eq!(file.si(9.0, Quantity::Length), 0.009);
        assert_eq!(file.si(9.0, Quantity::Angle), 9.0);
        assert_eq!(LengthUnit::Centimetre.metres(7.0), 0.07);
        assert_eq!(LengthUnit::Inch.factor(), 0.0254);
        assert_eq!(LengthUnit::Micrometre.metres(20.0), 20e-6);
        assert_eq!(AngleUnit::Microradian.radians(7.0), 7e-6);
        assert_eq!(AngleUnit::Milliradian.radians(0.3), 0.3e-3);
    }

    /// Short numbers and those of all digits, in every unit: what was read is written so that it is read again to the last
    /// bit, and short ones are written as they were.
    #[test]
    fn numbers_are_written_as_they_were_read() {
        let lengths = LengthUnit::ALL.map(|length| FileUnits { length, ..FileUnits::SI });
        let angles = AngleUnit::ALL.map(|angle| FileUnits { angle, ..FileUnits::SI });
        let quantities = [Quantity::Length, Quantity::Angle];
        let all = lengths.into_iter().zip([quantities[0]; 5]);
        for (units, quantity) in all.chain(angles.into_iter().zip([quantities[1]; 4])) {
            for step in -40_000_i32..40_000 {
                let short = f64::from(step) / 100.0;
                let long = (f64::from(step) * 0.7).sin() * 360.0;
                for number in [short, long] {
                    let value = units.si(number, quantity);
                    let written = units.number_of(value, quantity);
                    assert_eq!(units.si(written, quantity), value, "{number} {units:?}");
                    assert!(written == number || number != short, "{number} {written} {units:?}");
                }
            }
        }
        let degrees = FileUnits { angle: AngleUnit::Degree, ..FileUnits::SI };
        assert_eq!(degrees.number_of(30_f64.to_radians(), Quantity::Angle), 30.0);
        // What was no number of degrees is off by rounding alone.
        for step in 1..40_000_i32 {
            let value = f64::from(step) * 1e-4 * std::f64::consts::SQRT_2;
            let again = degrees.si(degrees.number_of(value, Quantity::Angle), Quantity::Angle);
            assert!((again / value - 1.0).abs() <= f64::EPSILON, "{value} {again}");
        }
        assert!(degrees.number_of(f64::NAN, Quantity::Angle).is_nan());
        assert_eq!(degrees.number_of(f64::INFINITY, Quantity::Angle), f64::INFINITY);
    }

    #[test]
    fn every_unit_is_found_by_its_symbol() {
        for unit in LengthUnit::ALL {
            assert_eq!(LengthUnit::from_symbol(unit.symbol()), Some(unit));
        }
        for unit in AngleUnit::ALL {
            assert_eq!(AngleUnit::from_symbol(unit.symbol()), Some(unit));
        }
        assert_eq!(LengthUnit::from_symbol("MM"), None);
    }
}
