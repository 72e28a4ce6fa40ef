//! What `--set`, `--vary` and `--coordinates` change of a mechanism file.

use crate::args::ChangeArgs;
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::{GridAxis, Misread, Number, assignment, ends};
use opm_core::Quantity;
use opm_core::mechanism::OrientationCoordinates;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file;
use std::fmt;
use std::str::FromStr;

/// A number of a mechanism file by name, and its new value.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    name: String,
    value: ChangedTo,
    /// As it was given.
    text: String,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A new value.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ChangedTo {
    None,
    Number(Number),
    Pair([Number; 2]),
}

impl FromStr for Change {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        const FORM: &str = "NAME=VALUE, NAME=LOWEST:HIGHEST or NAME=none, for example leg1.h=140mm";
        let (name, value) = assignment(text, FORM)?;
        let value = match *value.split(':').collect::<Vec<_>>() {
            ["none"] => ChangedTo::None,
            [value] => ChangedTo::Number(value.parse()?),
            [low, high] => ChangedTo::Pair(ends(low, high)?),
            _ => return Err(Misread::new(format!("{text:?}, expected {FORM}"))),
        };
        Ok(Self { name: name.to_owned(), value, text: text.to_owned() })
    }
}

impl Change {
    /// The name of what is changed.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The new number, both ends of a range, or nothing.
    pub fn numbers(&self) -> impl Iterator<Item = Number> {
        let numbers = match self.value {
            ChangedTo::None => [None, None],
            ChangedTo::Number(value) => [Some(value), None],
            ChangedTo::Pair(ends) => ends.map(Some),
        };
        numbers.into_iter().flatten()
    }

    /// The value, SI.
    fn resolve(&self, file: &file::MechanismFile) -> Result<ParameterValue, Misread> {
        // An unknown name is reported with those that are known.
        let quantity = file.quantity_of(&self.name);
        let si = |number: Number| match quantity {
            Some(quantity) => number.value_of(&self.name, quantity),
            None if file.is_effort(&self.name) => number.without_unit().ok_or_else(|| {
                Misread::new(format!(
                    "{} is in N or N m, expected a number without a unit",
                    self.name
                ))
            }),
            None if is_bare(file, &self.name) => number.bare(&self.name),
            None => number.value_of(&self.name, Quantity::Length).or(Ok(0.0)),
        };
        Ok(match self.value {
            ChangedTo::None => ParameterValue::None,
            ChangedTo::Number(value) => ParameterValue::Number(si(value)?),
            ChangedTo::Pair([low, high]) => ParameterValue::Pair([si(low)?, si(high)?]),
        })
    }
}

/// Whether a number is given without a unit: it has none, or one that is the same in all files, as masses have.
fn is_bare(file: &file::MechanismFile, name: &str) -> bool {
    file.is_plain(name) || file.drive_number(name).is_some() || file.is_of_bodies(name)
}

impl Loaded {
    /// Changes what the flags say.
    pub fn change(&mut self, given: &ChangeArgs) -> Result<(), Failure> {
        let mut changes = Vec::new();
        for change in &given.set {
            if changes.iter().any(|(name, _)| *name == change.name) {
                return Err(Failure::flag("--set", format!("{} is given twice", change.name)));
            }
            let value = change.resolve(&self.file);
            let value = value.map_err(|error| Failure::flag("--set", error))?;
            changes.push((change.name.as_str(), value));
        }
        if changes.is_empty() && given.coordinates.is_none() {
            return Ok(());
        }
        self.change_to(&changes, given.coordinates)
            .map_err(|problem| Failure::flag("--set", problem))
    }

    /// Changes numbers of the file by name, and the angles of orientations if they are given. The mechanism is that of
    /// the changed text, which recordings hold.
    fn change_to(
        &mut self,
        changes: &[(&str, ParameterValue)],
        coordinates: Option<OrientationCoordinates>,
    ) -> Result<(), String> {
        let mut changed = self.file.clone();
        if !changes.is_empty() {
            changed = changed.with(changes.iter().copied()).map_err(|errors| errors.to_string())?;
        }
        changed.mechanism.task.coordinates = coordinates.or(changed.mechanism.task.coordinates);
        let text = changed.text();
        let read =
            file::read(&text).map_err(|errors| format!("the changed {}: {errors}", self.label))?;
        // Lines of the changed text are no lines of the file.
        let file = file::MechanismFile { places: file::Locations::default(), ..read };
        (self.text, self.file) = (text, file);
        Ok(())
    }

    /// The same mechanism with one number changed.
    pub fn with(&self, name: &str, value: f64) -> Result<Self, Failure> {
        let mut changed = self.clone();
        changed.change_to(&[(name, ParameterValue::Number(value))], None).map_err(Failure::work)?;
        Ok(changed)
    }

    /// The number of the file that `--vary` names, its values in SI, and its quantity.
    pub fn varied<'a>(&self, vary: &'a GridAxis) -> Result<Varied<'a>, Failure> {
        let name = vary.name();
        if self.file.is_effort(name) {
            let problem =
                format!("{name} is an effort: nothing that is counted here depends on it");
            return Err(Failure::flag("--vary", problem));
        }
        let quantity = self.file.quantity_of(name);
        if quantity.is_none() && !is_bare(&self.file, name) {
            let unknown = self.file.with([(name, ParameterValue::Number(0.0))]);
            let problem = unknown.err().map_or_else(String::new, |errors| errors.to_string());
            return Err(Failure::flag("--vary", problem));
        }
        let axis = vary.of_quantity(quantity).map_err(|error| Failure::flag("--vary", error))?;
        const MOST: u64 = 100_000;
        if !(1..=MOST).contains(&axis.count) {
            let problem = format!("{} values, expected 1 to {MOST}", axis.count);
            return Err(Failure::flag("--vary", problem));
        }
        let values = (0..axis.count).map(|number| axis.value(number)).collect();
        Ok(Varied { name, values, quantity })
    }
}

/// A number of a mechanism file that takes several values.
pub struct Varied<'a> {
    pub name: &'a str,
    /// Radians and metres.
    pub values: Vec<f64>,
    /// `None` for a number without a unit.
    pub quantity: Option<Quantity>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_numbers_pairs_or_none() {
        let change = |text: &str| text.parse::<Change>();
        assert!(matches!(change("h=140mm").unwrap().value, ChangedTo::Number(_)));
        assert!(matches!(change("limits.S=-1:2").unwrap().value, ChangedTo::Pair(_)));
        assert!(matches!(change("limits.S=none").unwrap().value, ChangedTo::None));
        for wrong in ["h", "h=", "=1", "h=1:2:3", "h=tall"] {
            assert!(change(wrong).is_err(), "{wrong}");
        }
    }
}
