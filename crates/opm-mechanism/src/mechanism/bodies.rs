//! What the bodies of a mechanism weigh.

/// What the bodies of a mechanism weigh: `[bodies]` in a mechanism file. Models for simulators have these masses;
/// kinematics do not depend on them.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct BodyMasses {
    /// The density of all bodies whose masses are not given, kilograms per cubic metre, positive.
    pub density: Option<f64>,
    /// Masses in kilograms, positive, by the names of bodies: [`PLATFORM`](Self::PLATFORM), or the joint that carries the
    /// body.
    pub masses: Vec<(String, f64)>,
}

impl BodyMasses {
    /// The name of the platform among bodies.
    pub const PLATFORM: &'static str = "platform";

    /// The mass of the body with a name, kilograms, if it is given.
    pub fn of(&self, body: &str) -> Option<f64> {
        self.masses.iter().find(|(name, _)| name == body).map(|&(_, mass)| mass)
    }
}
