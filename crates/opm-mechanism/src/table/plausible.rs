//! Numbers without a unit that look as if they were meant in another one: `x = 10` is ten metres.

use crate::mechanism::file::FileUnits;
use crate::numeric::Quantity;
use std::f64::consts::TAU;

/// A length so many times as large as the mechanism was probably meant in another unit.
const FAR: f64 = 10.0;
/// Numbers from here on are refused by name.
const ABSURD: f64 = 1e15;

/// What a value that is not misread looks like: near home in the size of the mechanism, and within a turn.
#[derive(Clone, Copy, Debug)]
pub struct Plausible {
    quantity: Quantity,
    home: f64,
    size: f64,
    /// How many times that large a length may be.
    far: f64,
    units: FileUnits,
}

impl Plausible {
    /// For values of a quantity whose home is this, of a mechanism of this size, in SI; `units` are those of its file.
    pub fn new(quantity: Quantity, home: f64, size: f64, units: FileUnits) -> Self {
        Self { quantity, home, size, far: FAR, units }
    }

    /// The same where lengths may be so many times as large as the mechanism.
    #[must_use]
    pub fn within(self, far: f64) -> Self {
        Self { far, ..self }
    }

    /// The least and the largest value in SI that looks right.
    pub fn usual(&self) -> [f64; 2] {
        let (middle, most) = match self.quantity {
            Quantity::Length => (self.home, self.far * self.size),
            Quantity::Angle => (0.0, TAU),
        };
        [middle - most, middle + most]
    }

    /// Whether a value in SI looks right. What is refused anyway is not judged.
    pub fn holds(&self, value: f64) -> bool {
        let [low, high] = self.usual();
        (low..=high).contains(&value) || value.abs() >= ABSURD
    }

    /// How a number in SI was read, and how large that is.
    pub fn reading(&self, value: f64) -> String {
        let read = self.quantity.unit();
        let large = match self.quantity {
            Quantity::Length => {
                let times = (value - self.home).abs() / self.size;
                format!("{times:.0} times the size of the mechanism")
            }
            Quantity::Angle => format!("{:.0} degrees", value.to_degrees()),
        };
        format!("was read as {value} {read}, {large}")
    }

    /// The unit that was probably meant: that of the file, if it is not the one that was assumed.
    pub fn meant(&self) -> &'static str {
        match (self.units.symbol(self.quantity), self.quantity) {
            ("m", _) => "mm",
            ("rad", _) => "deg",
            (own, _) => own,
        }
    }

    /// The note on a value of a column without a unit.
    pub fn column(&self, name: &str, value: f64) -> String {
        let unit = self.meant();
        let reading = self.reading(value);
        format!(
            "{name} has no unit and {reading}; if it is in {unit}, head the column {name} [{unit}]"
        )
    }
}
