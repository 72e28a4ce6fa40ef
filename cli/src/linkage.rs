//! `opm linkage`: positions of a loop with one input.

mod sweep;

use crate::args::{LinkageArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::named;
use crate::pose::{Misread, Number};
use crate::text::{self, Table};
use opm_core::chain::Amount;
use opm_core::joint::{JointCoordinate, Quantity};
use opm_core::limits::Limits;
use opm_core::linkage::{Input, InputRange, Linkage, Position};
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::fmt::Write;
use std::str::FromStr;

/// A joint, and where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct InputValue {
    name: String,
    value: Option<Number>,
}

impl FromStr for InputValue {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        let (name, value) = match text.split_once('=') {
            Some((name, value)) => (name, Some(value.parse()?)),
            None => (text, None),
        };
        Ok(Self { name: name.trim().to_owned(), value })
    }
}

pub fn run(args: &LinkageArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.file)?;
    let linkage =
        Linkage::new(&loaded.file.mechanism).map_err(|error| Failure::at(&loaded.label, &error))?;
    let (input, value) = resolve(args.input.as_ref(), &linkage)?;
    let run = Run { loaded: &loaded, linkage: &linkage, input };
    match value {
        Some(_) if args.sweep => {
            let problem = "a sweep starts at home; give the name of the joint alone";
            Err(Failure::flag("--input", problem))
        }
        _ if args.sweep => sweep::run(args, output, &run),
        value => {
            let value = value.unwrap_or(input.coordinate().home);
            let positions = input.solve(value);
            output.print(&run.json(value, &positions), run.text(value, &positions))
        }
    }
}

/// The input that was asked for, and its value; otherwise the first actuated joint.
fn resolve<'a>(
    given: Option<&InputValue>,
    linkage: &'a Linkage,
) -> Result<(Input<'a>, Option<f64>), Failure> {
    let actuated = || {
        let joint = linkage.mechanism().joints().find(|joint| joint.actuated);
        joint.map_or("", |joint| &joint.coordinates[0].name)
    };
    let name = given.map_or_else(actuated, |input| &input.name);
    let input = linkage.input(name).ok_or_else(|| {
        let names: Vec<_> = linkage.coordinates().iter().map(|c| &*c.name).collect();
        let problem = format!("no joint {name:?}, expected one of {}", names.join(", "));
        Failure::flag("--input", problem)
    })?;
    let value = given.and_then(|input| input.value);
    let value = value.map(|number| number.value_of(name, Quantity::Angle)).transpose();
    Ok((input, value.map_err(|error| Failure::flag("--input", error))?))
}

/// What is analysed.
struct Run<'a> {
    loaded: &'a Loaded,
    linkage: &'a Linkage,
    input: Input<'a>,
}

impl Run<'_> {
    fn json(&self, value: f64, positions: &[Position]) -> Value {
        let coordinates = self.linkage.coordinates();
        let solution = |position: &Position| {
            let joints = coordinates.iter().map(|c| &*c.name).zip(position.joints.iter().copied());
            json!({
                "branch": position.branch.to_string(),
                "within_limits": position.within_limits,
                "joints": named(joints),
                "imaginary": named([(&*self.linkage.imaginary().name, position.imaginary)]),
            })
        };
        json!({
            "name": self.linkage.mechanism().name,
            "input": { "joint": self.input.coordinate().name, "value": value },
            "range": self.intervals(),
            "full_turn": self.input.range().is_full_turn(),
            "home_branch": self.input.home_branch().to_string(),
            "solutions": positions.iter().map(solution).collect::<Vec<_>>(),
        })
    }

    /// The input's range; of a full turn, the one around home.
    fn intervals(&self) -> Vec<[f64; 2]> {
        let home = self.input.coordinate().home;
        match self.input.range() {
            InputRange::FullTurn => vec![[home - PI, home + PI]],
            InputRange::Intervals(intervals) => intervals,
        }
    }

    fn range(&self) -> String {
        if self.input.range().is_full_turn() {
            return "the full turn".to_owned();
        }
        let units = self.loaded.file.units;
        let range = |ends: &[f64; 2]| text::range(*ends, Quantity::Angle, units);
        let ranges: Vec<String> = self.intervals().iter().map(range).collect();
        format!("{} {}", ranges.join(", "), units.symbol(Quantity::Angle))
    }

    fn text(&self, value: f64, positions: &[Position]) -> String {
        let units = self.loaded.file.units;
        let name = &self.input.coordinate().name;
        let mut text = format!(
            "{}, moved by {name} = {}\nrange of {name}: {}\n\n",
            self.linkage.mechanism().name,
            units.show(value, Quantity::Angle),
            self.range()
        );
        if positions.is_empty() {
            let _ = writeln!(text, "out of range: the loop does not close");
            return text;
        }
        let branches = if positions.len() == 1 { "branch" } else { "branches" };
        let _ = writeln!(
            text,
            "{} {branches}; home is in {}\n",
            positions.len(),
            self.input.home_branch()
        );
        let _ = write!(text, "{}", self.table(positions));
        if positions.iter().any(|position| !position.within_limits) {
            text.push_str("\n* beyond its limits\n");
        }
        text
    }

    /// A row a joint, a column a branch.
    fn table(&self, positions: &[Position]) -> Table {
        let units = self.loaded.file.units;
        let angle = |value: f64| text::number(value, Quantity::Angle, units);
        let unit = units.symbol(Quantity::Angle);
        let mut headers = ["leg", "joint", "", "unit"].map(String::from).to_vec();
        headers.extend(positions.iter().map(|position| format!(">{}", position.branch)));
        let mut table = Table::new(headers);
        let mut row = |leg: &str, name: &str, kind: &str, values: Vec<String>| {
            let head = [leg, name, kind, unit].map(String::from);
            table.row(head.into_iter().chain(values));
        };
        let mut number = 0;
        for leg in &self.linkage.mechanism().legs {
            for joint in &leg.joints {
                for coordinate in &joint.coordinates {
                    let value = |position: &Position| {
                        let value = position.joints[number];
                        angle(value)
                            + if within(&self.linkage.limits()[number], coordinate, value) {
                                ""
                            } else {
                                "*"
                            }
                    };
                    let values = positions.iter().map(value).collect();
                    let kind = if joint.actuated { "actuated" } else { "passive" };
                    row(&leg.name, &coordinate.name, kind, values);
                    number += 1;
                }
            }
        }
        let imaginary = self.linkage.imaginary();
        let leg = &self.linkage.mechanism().legs[imaginary.leg].name;
        let values = positions.iter().map(|position| angle(position.imaginary)).collect();
        row(leg, &imaginary.name, "imaginary", values);
        table
    }
}

/// Whether a value is within the limits of its joint.
fn within(limits: &Limits, coordinate: &JointCoordinate, value: f64) -> bool {
    limits.admits(Amount::Value(value - coordinate.home))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_is_a_name_and_a_value() {
        let value = |text: &str| text.parse::<InputValue>().map_err(|e| e.to_string());
        assert_eq!(value(" a1 ").unwrap(), InputValue { name: "a1".into(), value: None });
        let given = value("a1=180deg").unwrap();
        assert_eq!(given.value.unwrap().value_of("a1", Quantity::Angle), Ok(PI));
        assert!(given.value.unwrap().value_of("a1", Quantity::Length).is_err());
        assert!(value("a1=much").unwrap_err().contains("not a number"));
    }
}
