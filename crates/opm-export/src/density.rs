//! The density of bodies whose masses are not given.

use opm_core::mechanism::Mechanism;

/// The density of all bodies whose masses a mechanism does not give: that of the mechanism, unless another one is set.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Density(Option<f64>);

/// An option is not a positive number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{value}, expected a positive number")]
pub struct NotPositive {
    /// The option: `density` or `time_step`.
    pub option: &'static str,
    /// Its value.
    pub value: f64,
}

impl Density {
    /// The density of aluminium, kilograms per cubic metre, where neither a caller nor the mechanism gives one.
    pub const ALUMINIUM: f64 = 2700.0;

    /// A density in kilograms per cubic metre, instead of that of the mechanism if it is given.
    ///
    /// # Errors
    /// It is not a positive number.
    pub fn new(given: Option<f64>) -> Result<Self, NotPositive> {
        given.map_or(Ok(()), |value| positive("density", value)).map(|()| Self(given))
    }

    /// Kilograms per cubic metre.
    pub(crate) fn of(self, mechanism: &Mechanism) -> f64 {
        self.0.or(mechanism.bodies.density).unwrap_or(Self::ALUMINIUM)
    }
}

/// Checks that an option is a positive number.
pub(crate) fn positive(option: &'static str, value: f64) -> Result<(), NotPositive> {
    match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(NotPositive { option, value }),
    }
}
