//! The printed positions of a linkage.

use crate::decompose::describe;
use crate::load::Loaded;
use crate::output::named;
use crate::text::{self, Table};
use nalgebra::Point3;
use opm_core::Quantity;
use opm_core::chain::limits::Limits;
use opm_core::group::JointDisplacement;
use opm_core::linkage::{Input, Linkage, Position};
use opm_core::mechanism::joint::JointCoordinate;
use opm_study::input_intervals;
use serde_json::{Value, json};
use std::fmt::Write;

/// A linkage, and the joint that moves it.
pub struct Run<'a> {
    pub loaded: &'a Loaded,
    pub linkage: &'a Linkage,
    pub input: Input<'a>,
    /// A point of the platform, where it is at home.
    pub coupler: Option<Point3<f64>>,
}

impl Run<'_> {
    /// Where the point of the platform is, if one is asked for.
    pub fn coupler_at(&self, position: &Position) -> Option<Point3<f64>> {
        let leg = &self.linkage.mechanism().legs[0];
        let own = &position.joints[..leg.coordinates().count()];
        let platform = leg.displacement(own).expect("a position has a value for every joint");
        self.coupler.map(|point| platform * point)
    }

    pub fn json(&self, value: f64, positions: &[Position]) -> Value {
        let coordinates = self.linkage.coordinates();
        let imaginary = self.linkage.imaginary().iter().map(|joint| &*joint.name);
        let solution = |position: &Position| {
            let joints = coordinates.iter().map(|c| &*c.name).zip(position.joints.iter().copied());
            let mut answer = json!({
                "branch": position.branch.to_string(),
                "within_limits": position.within_limits,
                "joints": named(joints),
                "imaginary": named(imaginary.clone().zip(position.imaginary)),
            });
            if let Some(at) = self.coupler_at(position) {
                answer["coupler"] = json!([at.x, at.y, at.z]);
            }
            answer
        };
        json!({
            "name": self.linkage.mechanism().name,
            "input": { "joint": self.input.coordinate().name, "value": value },
            "range": input_intervals(&self.input),
            "full_turn": self.input.range().is_full_turn(),
            "home_branch": self.input.home_branch().to_string(),
            "solutions": positions.iter().map(solution).collect::<Vec<_>>(),
        })
    }

    fn range(&self) -> String {
        if self.input.range().is_full_turn() {
            return "the full turn".to_owned();
        }
        let units = self.loaded.file.units;
        let quantity = self.input.coordinate().quantity;
        let intervals = input_intervals(&self.input);
        if intervals.iter().any(|[low, high]| low.is_infinite() && high.is_infinite()) {
            return "no end".to_owned();
        }
        let range = |ends: &[f64; 2]| text::range(*ends, quantity, units);
        let ranges: Vec<String> = intervals.iter().map(range).collect();
        format!("{} {}", ranges.join(", "), units.symbol(quantity))
    }

    pub fn text(&self, value: f64, positions: &[Position]) -> String {
        let units = self.loaded.file.units;
        let name = &self.input.coordinate().name;
        let mut text = format!(
            "{}, moved by {name} = {}\nrange of {name}: {}\n\n",
            self.linkage.mechanism().name,
            units.show(value, self.input.coordinate().quantity),
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
        if self.linkage.platform_is_imaginary()
            && let (Some(decomposition), [joint]) =
                (self.linkage.decomposition(), self.linkage.imaginary())
        {
            let (name, common) = (&joint.name, describe(&decomposition.intersection, units));
            let _ = write!(text, "\n{name} is the motion of the platform: {common}\n");
        }
        if self.linkage.is_traced() {
            text.push_str(&self.completeness());
        }
        if positions.iter().any(|position| !position.within_limits) {
            text.push_str("\n* beyond its limits\n");
        }
        text
    }

    /// Of a loop that is traced, which of its assemblies are known.
    fn completeness(&self) -> String {
        match self.linkage.assemblies() {
            Some(1) => "\n1 assembly for each value of a joint, complex ones included\n".to_owned(),
            Some(count) => format!(
                "\n{count} assemblies, complex ones included, where the first revolute joint is held; branches are numbered \
                 along the motion from home\n"
            ),
            None => "\nonly the motion through home is known: other assemblies of a loop with helical joints, or of more than \
                     seven freedoms, are not looked for\n"
                .to_owned(),
        }
    }

    /// A table with a row for each joint and a column for each branch.
    fn table(&self, positions: &[Position]) -> Table {
        let units = self.loaded.file.units;
        let mut headers = ["leg", "joint", "", "unit"].map(String::from).to_vec();
        headers.extend(positions.iter().map(|position| format!(">{}", position.branch)));
        let mut table = Table::new(headers);
        let mut row = |leg: &str, name: &str, kind: &str, quantity, values: Vec<String>| {
            let head = [leg, name, kind, units.symbol(quantity)].map(String::from);
            table.row(head.into_iter().chain(values));
        };
        let mut number = 0;
        for leg in &self.linkage.mechanism().legs {
            for joint in &leg.joints {
                for coordinate in &joint.coordinates {
                    let value = |position: &Position| {
                        let value = position.joints[number];
                        text::number(value, coordinate.quantity, units)
                            + if within(&self.linkage.limits()[number], coordinate, value) {
                                ""
                            } else {
                                "*"
                            }
                    };
                    let values = positions.iter().map(value).collect();
                    let kind = if joint.actuated { "actuated" } else { "passive" };
                    row(&leg.name, &coordinate.name, kind, coordinate.quantity, values);
                    number += 1;
                }
            }
        }
        for imaginary in self.linkage.imaginary() {
            let leg = &self.linkage.mechanism().legs[imaginary.leg].name;
            let quantity = imaginary.quantity;
            let value = |position: &Position| {
                text::number(position.imaginary.unwrap_or(f64::NAN), quantity, units)
            };
            let values = positions.iter().map(value).collect();
            row(leg, &imaginary.name, "imaginary", quantity, values);
        }
        for (axis, name) in ["coupler.x", "coupler.y", "coupler.z"].into_iter().enumerate() {
            let place = |position: &Position| self.coupler_at(position).map(|at| at[axis]);
            let places: Option<Vec<f64>> = positions.iter().map(place).collect();
            if let Some(places) = places {
                let shown = |value: &f64| text::number(*value, Quantity::Length, units);
                row("", name, "point", Quantity::Length, places.iter().map(shown).collect());
            }
        }
        table
    }
}

/// Whether a value is within the limits of its joint.
fn within(limits: &Limits, coordinate: &JointCoordinate, value: f64) -> bool {
    limits.admits(JointDisplacement::Value(value - coordinate.home))
}
