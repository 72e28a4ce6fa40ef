//! What a number of a mechanism has to keep to, whether it comes from a file or not. What is wrong is
//! told without the name, in the units of whoever gave it.

use super::reader::LARGEST;
use super::units::FileUnits;
use crate::numeric::Quantity;

/// A number, neither NaN nor infinite.
pub(crate) fn finite(value: f64) -> Result<f64, String> {
    if value.is_finite() { Ok(value) } else { Err(format!("is {value}, expected a finite number")) }
}

/// A length or an angle, SI, of no more than any machine has.
pub(crate) fn size(value: f64, quantity: Quantity, units: FileUnits) -> Result<f64, String> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    let [found, largest] = [value, LARGEST].map(|value| units.show(value, quantity).to_string());
    Err(format!("is {found}, expected a size of at most {largest}"))
}

/// Limits, SI, the lower one first.
pub(crate) fn ordered(
    [low, high]: [f64; 2],
    quantity: Quantity,
    units: FileUnits,
) -> Result<[f64; 2], String> {
    if low <= high {
        return Ok([low, high]);
    }
    let [low, high] = [low, high].map(|limit| units.show(limit, quantity).to_string());
    Err(format!("are reversed: {low} is above {high}, expected [lowest, highest]"))
}
