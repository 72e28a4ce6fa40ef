//! Tolerances: how large the error of each part may be, and files of them.
//!
//! ```toml
//! units = { length = "mm", angle = "deg" }   # metres and radians without it
//! length = 0.02                              # every error of an axis that is a length
//! angle = 0.01
//! actuators = { length = 0.01, angle = 0.002 }
//!
//! [joint.S1]                                 # the axis of one joint
//! length = 0.05
//!
//! [parameter]                                # one error by its name, or a parameter of the family
//! "leg1.phi11.angle.2" = 0.03
//! "leg1.h" = 0.1
//! "S1" = 0.005                               # an actuated joint
//! ```

use crate::source::Source;
use opm_core::Quantity;
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::mechanism::file::{FileUnits, Problem, optional_units};
use std::collections::BTreeMap;
use std::fmt::Display;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Tolerances, metres and radians: an error is between minus and plus its tolerance. That of an error by its own name goes
/// before that of its joint, and this before that of all axes. What has no tolerance has no error.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Of all axes, not of the parameters of a family.
    pub axes: Both,
    /// Of the values of actuated joints.
    pub actuators: Both,
    /// Of joints, by name.
    pub joints: BTreeMap<String, Both>,
    /// Of single errors, by name.
    pub single: BTreeMap<String, f64>,
}

/// A tolerance of lengths and one of angles, metres and radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Both {
    /// Of lengths.
    pub length: Option<f64>,
    /// Of angles.
    pub angle: Option<f64>,
}

/// What is wrong with tolerances: every problem, at least one, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", lines(.problems, ""))]
#[non_exhaustive]
pub struct ToleranceErrors {
    /// The problems, each with its line and column.
    pub problems: Vec<Problem>,
}

impl ToleranceErrors {
    /// The text with one line for each problem, `FILE:LINE:COLUMN: message`.
    pub fn in_file(&self, file: impl Display) -> String {
        lines(&self.problems, &format!("{file}:"))
    }
}

fn lines(problems: &[Problem], prefix: &str) -> String {
    problems.iter().map(|p| format!("{prefix}{p}")).collect::<Vec<_>>().join("\n")
}

impl Both {
    /// That of a quantity.
    pub fn of(&self, quantity: Quantity) -> Option<f64> {
        match quantity {
            Quantity::Angle => self.angle,
            Quantity::Length => self.length,
        }
    }
}

impl Tolerances {
    /// The names of joints that tolerances may be given for.
    pub fn joint_names(sources: &[Source]) -> Vec<&str> {
        let mut names = Vec::new();
        for name in sources.iter().filter_map(|source| source.joint.as_deref()) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// The names of errors that tolerances may be given for.
    pub fn single_names(sources: &[Source]) -> Vec<&str> {
        sources.iter().map(|s| &*s.name).collect()
    }

    /// The tolerance of each source, radians and metres; zero where there is none.
    pub fn of(&self, sources: &[Source]) -> Vec<f64> {
        let of = |source: &Source| {
            let own = self.single.get(&source.name).copied();
            if source.is_actuator() {
                return own.or_else(|| self.actuators.of(source.quantity));
            }
            own.or_else(|| {
                let joint = self.joints.get(source.joint.as_ref()?);
                let joint = joint.and_then(|both| both.of(source.quantity));
                joint.or_else(|| self.axes.of(source.quantity))
            })
        };
        sources.iter().map(|source| of(source).unwrap_or(0.0)).collect()
    }

    /// Reads the text of a file, for these sources.
    ///
    /// # Errors
    /// Lists every problem: unknown keys and names, and what is not a number of at least 0.
    pub fn read(text: &str, sources: &[Source]) -> Result<Self, ToleranceErrors> {
        let mut reader = Reader { text, problems: Vec::new(), units: FileUnits::SI };
        let mut read = Self::default();
        match DeTable::parse(text) {
            Ok(table) => reader.file(table.get_ref(), sources, &mut read),
            Err(error) => {
                let at = error.span().map_or(0, |span| span.start);
                reader.report(at, error.message().trim().to_owned());
            }
        }
        if reader.problems.is_empty() {
            return Ok(read);
        }
        reader.problems.sort();
        Err(ToleranceErrors { problems: reader.problems })
    }
}

type Entry<'a> = Spanned<DeValue<'a>>;

struct Reader<'t> {
    text: &'t str,
    problems: Vec<Problem>,
    units: FileUnits,
}

impl Reader<'_> {
    fn report(&mut self, at: usize, message: String) {
        let before = &self.text[..at.min(self.text.len())];
        let start = before.rfind('\n').map_or(0, |newline| newline + 1);
        let line = before.matches('\n').count() + 1;
        self.problems.push(Problem { line, column: before[start..].chars().count() + 1, message });
    }

    fn file(&mut self, table: &DeTable<'_>, sources: &[Source], read: &mut Tolerances) {
        // Units first, wherever they stand.
        let (units, problems) = optional_units(table, self.text);
        self.units = units;
        self.problems.extend(problems);
        for (key, value) in table {
            let name: &str = key.get_ref();
            match name {
                "units" => {}
                "length" => read.axes.length = self.tolerance(name, value, Quantity::Length),
                "angle" => read.axes.angle = self.tolerance(name, value, Quantity::Angle),
                "actuators" => read.actuators = self.both(name, value),
                "joint" => {
                    let known = Tolerances::joint_names(sources);
                    for (key, value) in self.table(name, value).into_iter().flatten() {
                        let name: &str = key.get_ref();
                        if self.is_known(key.span().start, "a joint", name, &known) {
                            let both = self.both(name, value);
                            read.joints.insert(name.to_owned(), both);
                        }
                    }
                }
                "parameter" => {
                    let known = Tolerances::single_names(sources);
                    for (key, value) in self.table(name, value).into_iter().flatten() {
                        let name: &str = key.get_ref();
                        let found = sources.iter().find(|s| s.name == name);
                        if let Some(source) = found {
                            let tolerance = self.tolerance(name, value, source.quantity);
                            read.single.extend(tolerance.map(|t| (name.to_owned(), t)));
                        } else {
                            self.is_known(key.span().start, "an error", name, &known);
                        }
                    }
                }
                _ => {
                    let known = ["units", "length", "angle", "actuators", "joint", "parameter"];
                    self.is_known(key.span().start, "a key", name, &known);
                }
            }
        }
    }

    fn is_known(&mut self, at: usize, what: &str, name: &str, known: &[&str]) -> bool {
        let is_known = known.contains(&name);
        if !is_known {
            self.report(at, format!("`{name}` is not {what}; {}", expected_one_of(name, known)));
        }
        is_known
    }

    fn table<'a>(&mut self, name: &str, value: &'a Entry<'a>) -> Option<&'a DeTable<'a>> {
        let table = value.get_ref().as_table();
        if table.is_none() {
            self.report(value.span().start, format!("`{name}` is not a table"));
        }
        table
    }

    fn both(&mut self, joint: &str, value: &Entry<'_>) -> Both {
        let mut both = Both::default();
        for (key, value) in self.table(joint, value).into_iter().flatten() {
            let name: &str = key.get_ref();
            if self.is_known(key.span().start, "a tolerance", name, &["length", "angle"]) {
                match name {
                    "length" => both.length = self.tolerance(name, value, Quantity::Length),
                    _ => both.angle = self.tolerance(name, value, Quantity::Angle),
                }
            }
        }
        both
    }

    /// A tolerance in SI.
    fn tolerance(&mut self, name: &str, value: &Entry<'_>, quantity: Quantity) -> Option<f64> {
        let number = match value.get_ref() {
            DeValue::Integer(integer) => {
                i64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|i| i as f64)
            }
            DeValue::Float(float) => float.as_str().parse().ok(),
            _ => None,
        };
        let suitable = number.filter(|number: &f64| number.is_finite() && *number >= 0.0);
        if suitable.is_none() {
            let found = number.map_or_else(|| "not a number".to_owned(), |n| n.to_string());
            let message = format!("`{name}` is {found}, expected a number of at least 0");
            self.report(value.span().start, message);
        }
        suitable.map(|number| self.units.si(number, quantity))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::Origin;
    use std::f64::consts::PI;

    fn sources() -> Vec<Source> {
        let named = |name: &str, quantity, joint: Option<&str>| Source {
            name: name.to_owned(),
            quantity,
            joint: joint.map(str::to_owned),
            direction: None,
            origin: Origin::Axis {
                leg: 0,
                first: 0,
                end: 1,
                twist: opm_core::group::screw::Screw::translation(nalgebra::Vector3::x_axis()),
            },
        };
        let actuator = |name: &str, quantity| Source {
            origin: Origin::Actuator(0),
            ..named(name, quantity, None)
        };
        vec![
            named("leg1.S1.angle.1", Quantity::Angle, Some("S1")),
            named("leg1.S1.offset.1", Quantity::Length, Some("S1")),
            named("leg1.r1.offset.1", Quantity::Length, Some("r1")),
            named("leg1.r1.offset.2", Quantity::Length, Some("r1")),
            named("leg1.h", Quantity::Length, None),
            actuator("S1", Quantity::Length),
            actuator("phi", Quantity::Angle),
            actuator("S2", Quantity::Length),
        ]
    }

    #[test]
    fn the_narrowest_name_decides() {
        let text = "length = 0.5\nunits = { length = \"mm\", angle = \"deg\" }\nangle = 180\n\
                    actuators = { length = 7, angle = 90 }\n\
                    [joint.r1]\nlength = 2\n[parameter]\n\"leg1.r1.offset.2\" = 3\nS2 = 1";
        let read = Tolerances::read(text, &sources()).unwrap();
        let expected = [PI, 0.0005, 0.002, 0.003, 0.0, 0.007, PI / 2.0, 0.001];
        assert_eq!(read.of(&sources()), expected);
    }

    #[test]
    fn every_problem_has_its_place() {
        let text = "lenght = 1\nangle = -2\n[joint]\nS2 = { length = 1 }\nr1 = { length = \"a\" }\n\
                    [parameter]\n\"leg1.g\" = 1\n";
        let error = Tolerances::read(text, &sources()).unwrap_err();
        let text = error.in_file("t.toml");
        for expected in [
            "t.toml:1:1: `lenght` is not a key; did you mean `length`?",
            "t.toml:2:9: `angle` is -2, expected a number of at least 0",
            "t.toml:4:1: `S2` is not a joint; did you mean `S1`?",
            "t.toml:5:17: `length` is not a number, expected",
            "t.toml:7:1: `leg1.g` is not an error; did you mean `leg1.h`?",
        ] {
            assert!(text.contains(expected), "{expected}\n{text}");
        }
        assert_eq!(error.problems.len(), 5);
        let error = Tolerances::read("length = \n", &[]).unwrap_err();
        assert_eq!(error.problems[0].line, 1);
    }
}
