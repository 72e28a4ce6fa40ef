//! The density of bodies whose masses are not given.

use crate::mechanism::Mechanism;

/// The density of all bodies whose masses a mechanism does not give: that of the mechanism, unless another one is set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Density(Option<f64>);

/// The densities that a body may have, kilograms per cubic metre: from less than air to more than any metal.
const DENSITIES: [f64; 2] = [1e-3, 1e6];

/// An option is outside the range of what makes sense.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{value}, expected a number from {least} to {most}")]
pub struct OutOfRange {
    /// The option: `density` or `time_step`.
    pub option: &'static str,
    /// Its value.
    pub value: f64,
    /// The least value that it may have.
    pub least: f64,
    /// The greatest value that it may have.
    pub most: f64,
}

impl Density {
    /// The density of aluminium, kilograms per cubic metre, where neither a caller nor the mechanism gives one.
    pub const ALUMINIUM: f64 = 2700.0;

    /// A density in kilograms per cubic metre, instead of that of the mechanism if it is given.
    ///
    /// # Errors
    /// It is not a number from 0.001 to 1,000,000.
    pub fn new(given: Option<f64>) -> Result<Self, OutOfRange> {
        let checked = given.map_or(Ok(()), |value| OutOfRange::check("density", value, DENSITIES));
        checked.map(|()| Self(given))
    }

    /// The density that was set instead of the mechanism's, kilograms per cubic metre.
    pub fn given(self) -> Option<f64> {
        self.0
    }

    /// Kilograms per cubic metre, for a mechanism.
    pub fn of(self, mechanism: &Mechanism) -> f64 {
        self.0.or(mechanism.bodies.density).unwrap_or(Self::ALUMINIUM)
    }
}

impl OutOfRange {
    /// Checks that an option is in its range.
    ///
    /// # Errors
    /// It is not.
    pub fn check(
        option: &'static str,
        value: f64,
        [least, most]: [f64; 2],
    ) -> Result<(), OutOfRange> {
        match (least..=most).contains(&value) {
            true => Ok(()),
            false => Err(OutOfRange { option, value, least, most }),
        }
    }
}
