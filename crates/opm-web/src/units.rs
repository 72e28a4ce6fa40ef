//! Numbers in the units of a mechanism file.

use opm_core::Quantity;
use opm_core::mechanism::file::FileUnits;

/// Digits after the first one of a number that is shown: fewer than a double has, so that 0.12 m is 120 mm and not
/// 119.99999999999999 mm.
const DIGITS: usize = 11;

/// An SI value in the file's unit.
pub fn shown(value: f64, quantity: Quantity, units: FileUnits) -> f64 {
    rounded(value / units.factor(quantity))
}

/// Both ends of a range, SI, in the file's unit.
pub fn shown_range(range: [f64; 2], quantity: Quantity, units: FileUnits) -> [f64; 2] {
    range.map(|end| shown(end, quantity, units))
}

/// A number without the digits that rounding has made, and without a negative zero.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.DIGITS$e}").parse().unwrap_or(value) + 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use opm_core::mechanism::file::{AngleUnit, LengthUnit};

    #[test]
    fn what_is_typed_is_shown_again() {
        let units = FileUnits { length: LengthUnit::Millimetre, angle: AngleUnit::Degree };
        for typed in [120.0, 0.1, -300.0, 12.5, 74.3, 1e-3] {
            for quantity in [Quantity::Length, Quantity::Angle] {
                assert_eq!(shown(units.si(typed, quantity), quantity, units), typed);
            }
        }
        assert!(shown(-0.0, Quantity::Length, units).is_sign_positive());
    }
}
