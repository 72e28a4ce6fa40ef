//! Checks of numbers, whether they come from a file or from a call. A message does not contain the
//! name of the value; it is in the units of the caller.

use super::units::FileUnits;
use crate::mechanism::joint::DriveLimit;
use crate::numeric::Quantity;

/// Largest accepted length or angle in metres or radians: larger than any machine. Squares and
/// products of larger numbers could overflow.
pub const LARGEST: f64 = 1e9;

/// Checks that a number is neither NaN nor infinite.
pub(crate) fn finite(value: f64) -> Result<f64, String> {
    if value.is_finite() { Ok(value) } else { Err(format!("is {value}, expected a finite number")) }
}

/// Checks that a length or an angle, SI, is not larger than [`LARGEST`].
pub(crate) fn size(value: f64, quantity: Quantity, units: FileUnits) -> Result<f64, String> {
    if value.abs() <= LARGEST {
        return Ok(value);
    }
    let [found, largest] = [value, LARGEST].map(|value| units.show(value, quantity).to_string());
    Err(format!("is {found}, expected an absolute value of at most {largest}"))
}

/// Checks that limits, SI, are in order: the lower one first.
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

/// Checks that the largest rate, acceleration or effort of a joint, SI, is above zero and not larger than [`LARGEST`].
pub(crate) fn drive_limit(
    value: f64,
    limit: DriveLimit,
    quantity: Quantity,
    units: FileUnits,
) -> Result<f64, String> {
    let show = |value| match limit {
        DriveLimit::Motion(limit) => format!("{}{}", units.show(value, quantity), limit.per_time()),
        DriveLimit::Effort => format!("{value} {}", limit.unit(quantity)),
    };
    if value > 0.0 && value <= LARGEST {
        return Ok(value);
    }
    let found = show(value);
    Err(match value > 0.0 {
        true => format!("is {found}, expected an absolute value of at most {}", show(LARGEST)),
        false => format!("is {found}, expected a value above 0"),
    })
}

/// Checks that a number of a joint's drive is at least zero and not larger than [`LARGEST`].
pub(crate) fn drive_number(value: f64) -> Result<f64, String> {
    match (0.0..=LARGEST).contains(&value) {
        true => Ok(value),
        false => Err(format!("is {value}, expected 0 to {LARGEST:e}")),
    }
}

/// The densities that bodies may have, kilograms per cubic metre: from less than air to more than any metal.
pub(crate) const DENSITIES: [f64; 2] = [1e-3, 1e6];
/// The masses that bodies may have, kilograms: from a microgram to a thousand tons.
pub(crate) const MASSES: [f64; 2] = [1e-9, 1e6];

/// Checks that a number is in a range.
pub(crate) fn within(value: f64, [least, most]: [f64; 2], unit: &str) -> Result<f64, String> {
    match (least..=most).contains(&value) {
        true => Ok(value),
        false => Err(format!("is {value} {unit}, expected {least:?} to {most:?} {unit}")),
    }
}
