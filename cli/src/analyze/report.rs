//! What is said of one pose.

use super::{Analyser, word};
use crate::output::named;
use crate::text::{self, Table, short};
use crate::transform;
use nalgebra::{DMatrix, DVector, Dim, Matrix, RawStorage, Vector3};
use opm_analysis::{
    Balance, Capacity, Efforts, Reactions, Stiffness, Transmission, Vibration, Wrench,
};
use opm_core::Quantity;
use opm_core::manipulator::{Mode, Solution, part_of};
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::leg::Section;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// A pose, and what was computed there.
pub struct Report<'a> {
    pub analyser: &'a Analyser<'a>,
    pub at: &'a Solution,
    pub pose: &'a [f64],
    pub mode: Mode,
    pub reached: bool,
    /// If stiffnesses are given: how the mechanism gives way, unless the pose is singular.
    pub elastic: Option<Option<Elastic>>,
    /// With gravity: the mass matrix, and what the weight of all bodies needs, in task coordinates.
    pub moving: Option<(DMatrix<f64>, DVector<f64>)>,
    pub units: FileUnits,
}

/// How a mechanism gives way at a pose.
pub struct Elastic {
    pub stiffness: Stiffness,
    /// For the load, if there is one.
    pub reactions: Option<Reactions>,
    /// Unless the platform moves without resistance.
    pub vibrations: Option<[Vibration; 6]>,
}

impl Elastic {
    fn json(&self, report: &Report<'_>) -> Value {
        let manipulator = report.analyser.manipulator;
        let legs = &manipulator.mechanism().legs;
        let mut json = json!({ "matrix": rows(&self.stiffness.platform) });
        let vibrations = self.vibrations.iter().flatten().map(|found| {
            json!({ "frequency": finite(found.frequency), "shape": found.shape.as_slice() })
        });
        json["vibrations"] = vibrations.collect::<Vec<_>>().into();
        let Some(found) = &self.reactions else { return json };
        let wrenches = |names: &mut dyn Iterator<Item = String>, all: &[Wrench]| {
            let each = names.zip(all).map(|(name, w)| (name, json!(w.components())));
            Value::Object(each.collect())
        };
        json["displacement"] = json!(found.displacement.as_slice());
        json["legs"] = wrenches(&mut legs.iter().map(|leg| leg.name.clone()), &found.legs);
        let joints = legs.iter().flat_map(|leg| &leg.joints);
        json["joints"] = wrenches(&mut joints.map(|joint| joint.name.clone()), &found.joints);
        let efforts: Vec<_> = found.efforts.iter().map(|&effort| Some(effort)).collect();
        json["efforts"] = report.actuated(&efforts);
        json
    }

    fn text(&self, report: &Report<'_>) -> String {
        let manipulator = report.analyser.manipulator;
        let names = ["FX", "FY", "FZ", "MX", "MY", "MZ"];
        let mut table = Table::new(["stiffness", ">x", ">y", ">z", ">rx", ">ry", ">rz"]);
        for (name, row) in names.iter().zip(self.stiffness.platform.row_iter()) {
            let cells = row.iter().map(|&value| short(value));
            table.row(std::iter::once((*name).to_owned()).chain(cells));
        }
        let mut text = format!("{table}\n");
        if let Some(found) = &self.vibrations {
            let each: Vec<_> = found.iter().map(|found| short(found.frequency)).collect();
            let _ = writeln!(text, "natural frequencies: {} Hz\n", each.join(", "));
        }
        let Some(found) = &self.reactions else { return text };
        let mut table = Table::new(["load on", ">FX", ">FY", ">FZ", ">MX", ">MY", ">MZ"]);
        for (leg, wrench) in manipulator.mechanism().legs.iter().zip(&found.legs) {
            let cells = wrench.components().map(|part| self::part(part, report.scale()));
            table.row(std::iter::once(leg.name.clone()).chain(cells));
        }
        let _ = writeln!(text, "{table}");
        let d = &found.displacement;
        let (moved, turned) = (d.fixed_rows::<3>(0).norm(), d.fixed_rows::<3>(3).norm());
        let moved = report.units.show(moved, Quantity::Length);
        let turned = report.units.show(turned, Quantity::Angle);
        let _ = writeln!(text, "the platform gives way by {moved}, {turned}\n");
        text
    }
}

impl Report<'_> {
    pub fn json(&self) -> Value {
        let manipulator = self.analyser.manipulator;
        let names = manipulator.task_coordinates().iter().map(|c| c.name);
        let mut json = Map::new();
        let pose = match self.reached {
            true => named(text::whole_pose(manipulator, self.pose, self.at.dependent())),
            false => named(names.zip(self.pose.iter().copied())),
        };
        json.insert("pose".into(), pose.into());
        json.insert("mode".into(), manipulator.format_mode(self.mode).into());
        json.insert("reachable".into(), self.reached.into());
        if !self.reached {
            for key in KEYS {
                json.insert(key.into(), Value::Null);
            }
            let legs = &manipulator.mechanism().legs;
            let out = self.at.unreachable().iter().map(|u| &*legs[u.leg].name);
            json.insert("unreachable".into(), out.collect::<Vec<_>>().into());
            return json.into();
        }
        let (efforts, analyser) = (self.efforts(), self.analyser);
        let wrench = analyser.wrench(self.at);
        let gravity = analyser.setup.gravity.zip(analyser.loads.as_ref());
        let values = [
            json!(wrench.map(|wrench| wrench.components().map(|part| part + 0.0))),
            gravity.map_or(Value::Null, |(gravity, loads)| {
                let moving = self.moving.as_ref();
                json!({
                    "acceleration": triple(&gravity.acceleration),
                    "mass": loads.mass(),
                    "mass_matrix": moving.map(|(mass, _)| rows(mass)),
                    "forces": moving.map(|(_, forces)| forces.as_slice()),
                })
            }),
            efforts.map_or(Value::Null, |efforts| word(efforts.balance).into()),
            efforts.map_or(Value::Null, |efforts| self.actuated(&efforts.actuated)),
            efforts.map_or(Value::Null, |efforts| self.imaginary(&efforts.imaginary)),
            self.statics().is_regular().then(|| self.statics().loose()).into(),
            self.statics().is_regular().then(|| self.statics().internal()).into(),
            self.worst(),
            self.capacity().map_or(Value::Null, |found| self.capacity_json(&found)),
            self.transmission(),
            self.elastic.as_ref().map_or(Value::Null, |found| {
                found.as_ref().map_or(Value::Null, |found| found.json(self))
            }),
            self.indices(),
            self.statics().length().into(),
            transform::at(manipulator, self.at),
        ];
        json.extend(KEYS.into_iter().map(str::to_owned).zip(values));
        json.into()
    }

    fn statics(&self) -> &opm_analysis::Statics<'_> {
        &self.analyser.statics
    }

    /// What balances the loads.
    fn efforts(&self) -> Option<&Efforts> {
        self.analyser.acting.as_ref().map(|(_, efforts)| efforts)
    }

    /// The size of the load, or a unit.
    fn scale(&self) -> f64 {
        let wrench = self.analyser.wrench(self.at);
        let size = wrench.map(|w| w.components().iter().map(|part| part.abs()).sum::<f64>());
        let weight = self.analyser.setup.gravity.zip(self.analyser.loads.as_ref());
        let weight = weight.map(|(gravity, loads)| gravity.acceleration.norm() * loads.mass());
        size.into_iter().chain(weight).reduce(|a, b| a + b).unwrap_or(1.0)
    }

    fn capacity(&self) -> Option<Capacity> {
        let work = match &self.analyser.acting {
            Some((work, _)) => (*work)?,
            None => Default::default(),
        };
        self.statics().capacity(&work)
    }

    /// Every index that the mechanism has; null where the pose has none.
    fn indices(&self) -> Value {
        let indices = &self.analyser.indices;
        let each = indices.indices().iter().zip(indices.values());
        Value::Object(each.map(|(index, &v)| (index.name().to_owned(), json!(finite(v)))).collect())
    }

    /// The names and quantities of the actuated joint coordinates.
    fn joints(&self) -> impl Iterator<Item = (&str, Quantity)> {
        let manipulator = self.analyser.manipulator;
        let all = manipulator.coordinates();
        manipulator.actuated().iter().map(|&i| (&*all[i].name, all[i].quantity))
    }

    fn actuated(&self, efforts: &[Option<f64>]) -> Value {
        let each = self.joints().zip(efforts).map(|((name, _), e)| (name.to_owned(), json!(e)));
        Value::Object(each.collect())
    }

    fn imaginary(&self, efforts: &[Option<f64>]) -> Value {
        let joints = self.analyser.manipulator.imaginary().iter();
        Value::Object(joints.zip(efforts).map(|(j, e)| (j.name.clone(), json!(e))).collect())
    }

    fn worst(&self) -> Value {
        let each = self.joints().enumerate().map(|(row, (name, _))| {
            let found = self.statics().worst(row).map(|worst| {
                json!({
                    "per_force": worst.per_force,
                    "force": triple(&worst.force),
                    "per_moment": worst.per_moment,
                    "moment": triple(&worst.moment),
                })
            });
            (name.to_owned(), found.into())
        });
        Value::Object(each.collect())
    }

    fn capacity_json(&self, found: &Capacity) -> Value {
        let facets = self.statics().facets();
        let facets = facets.iter().map(|f| json!({ "normal": f.normal, "bound": f.bound }));
        json!({
            "force": finite(found.force),
            "moment": finite(found.moment),
            "ball": finite(found.ball),
            "facets": facets.collect::<Vec<_>>(),
        })
    }

    fn transmission(&self) -> Value {
        let manipulator = self.analyser.manipulator;
        let found = match &self.analyser.transmissions {
            Ok(found) => found,
            Err(why) => return json!({ "why_none": why.to_string() }),
        };
        let of = |t: Transmission| json!({ "iti": t.input, "oti": t.output, "lti": t.local() });
        let mut json = of(found.whole());
        for section in [Section::Lower, Section::Upper] {
            json[section.to_string()] = found.section(section).map_or(Value::Null, of);
        }
        let inputs = found.inputs().iter().map(|input| {
            json!({
                "leg": manipulator.mechanism().legs[input.leg].name,
                "section": input.section.to_string(),
                "joint": self.input(input),
                "iti": input.input,
                "oti": input.output,
            })
        });
        json["inputs"] = inputs.collect::<Vec<_>>().into();
        let legs = &manipulator.mechanism().legs;
        let constraints = found.constraints().map(|constraint| {
            json!({
                "legs": constraint.legs.iter().map(|&leg| &*legs[leg].name).collect::<Vec<_>>(),
                "section": constraint.section.to_string(),
                "oci": constraint.output,
            })
        });
        json["oci"] = found.constraint().into();
        json["constraints"] = constraints.collect::<Vec<_>>().into();
        json
    }

    /// The name of an input of a section.
    fn input(&self, input: &opm_analysis::InputIndices) -> &str {
        let manipulator = self.analyser.manipulator;
        match input.coordinate {
            Some(number) => &manipulator.coordinates()[number].name,
            None => {
                let mut joints = manipulator.imaginary().iter();
                joints.find(|joint| joint.leg == input.leg).map_or("", |joint| &joint.name)
            }
        }
    }

    pub fn text(&self) -> String {
        let manipulator = self.analyser.manipulator;
        let mut text = manipulator.mechanism().name.clone();
        let mode = manipulator.format_mode(self.mode);
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let mut table = Table::new(["coordinate", ">value", "unit"]);
        for (c, &value) in manipulator.task_coordinates().iter().zip(self.pose) {
            let shown = text::number(value, c.quantity, self.units);
            table.row([c.name, &shown, self.units.symbol(c.quantity)]);
        }
        let _ = writeln!(text, "\n\n{table}");
        if !self.reached {
            let _ = writeln!(text, "out of reach in this mode");
            for out in self.at.unreachable() {
                let leg = &manipulator.mechanism().legs[out.leg].name;
                let _ = writeln!(text, "  {leg}: {} out of reach", out.part());
            }
            return text;
        }
        self.efforts_text(&mut text);
        if let Some((mass, _)) = &self.moving {
            let names: Vec<_> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
            let heads = names.iter().map(|name| format!(">{name}"));
            let heads: Vec<_> = std::iter::once("mass matrix".to_owned()).chain(heads).collect();
            let mut table = Table::new(heads.iter().map(String::as_str));
            let scale = mass.amax();
            for (name, row) in names.iter().zip(mass.row_iter()) {
                let cells = row.iter().map(|&entry| part(entry, scale));
                table.row(std::iter::once((*name).to_owned()).chain(cells));
            }
            let _ = writeln!(text, "{table}");
        }
        if let Some(found) = self.capacity() {
            let more = if self.efforts().is_some() { " on top of the load" } else { "" };
            let _ = writeln!(
                text,
                "borne in every direction{more}: force {} N, moment {} N m\n",
                shown(found.force),
                shown(found.moment)
            );
        }
        match &self.elastic {
            None => {}
            Some(Some(found)) => text += &found.text(self),
            Some(None) => {
                let why = "a leg's passive joints are dependent, or it has no link";
                let _ = writeln!(text, "no stiffness here: {why}\n");
            }
        }
        self.transmission_text(&mut text);
        self.indices_text(&mut text);
        text
    }

    fn efforts_text(&self, text: &mut String) {
        let (manipulator, statics) = (self.analyser.manipulator, self.statics());
        if !statics.is_regular() {
            let _ = writeln!(text, "serial singularity: efforts are not known here");
            for singular in statics.singular() {
                let leg = &manipulator.mechanism().legs[singular.leg].name;
                let _ = writeln!(text, "  {leg}: {} without rates", part_of(singular.section));
            }
            text.push('\n');
            return;
        }
        let efforts = self.efforts();
        let mut table = Table::new(["joint", ">effort", "unit", ">per N", ">per N m"]);
        let scale = self.scale();
        let cell = |value: Option<f64>| value.map_or("-".to_owned(), |value| part(value, scale));
        for (row, (name, quantity)) in self.joints().enumerate() {
            let worst = statics.worst(row);
            table.row([
                name,
                &cell(efforts.and_then(|efforts| efforts.actuated[row])),
                unit(quantity),
                &cell(worst.map(|worst| worst.per_force)),
                &cell(worst.map(|worst| worst.per_moment)),
            ]);
        }
        if let Some(efforts) = efforts {
            for (joint, effort) in manipulator.imaginary().iter().zip(&efforts.imaginary) {
                table.row([&*joint.name, &cell(*effort), unit(joint.quantity), "", ""]);
            }
        }
        let _ = writeln!(text, "{table}");
        if statics.loose() > 0 {
            let loose = text::plural(statics.loose() as u64, "motion");
            let _ = writeln!(text, "the actuators leave the platform {loose}");
        }
        if statics.internal() > 0 {
            let internal = text::plural(statics.internal() as u64, "internal effort");
            // Where they leave a motion, none of them is one too many: they depend on each other at this pose.
            let actuators = if statics.loose() > 0 { "dependent" } else { "redundant" };
            let _ = writeln!(text, "{actuators} actuators: loads do not determine {internal}");
        }
        if efforts.is_some_and(|efforts| efforts.balance == Balance::Driven) {
            let _ = writeln!(text, "the load is not balanced: it drives a motion of the platform");
        }
        if statics.loose() + statics.internal() > 0 {
            text.push('\n');
        }
    }

    fn transmission_text(&self, text: &mut String) {
        let found = match &self.analyser.transmissions {
            Ok(found) => found,
            Err(why) => {
                let _ = writeln!(text, "no transmission indices: {why}\n");
                return;
            }
        };
        let mut table = Table::new(["section", "leg", "input", ">ITI", ">OTI"]);
        for input in found.inputs() {
            let leg = &self.analyser.manipulator.mechanism().legs[input.leg].name;
            let section = input.section.to_string();
            table.row([
                &section,
                leg,
                self.input(input),
                &short(input.input),
                &short(input.output),
            ]);
        }
        let _ = writeln!(text, "{table}");
        for constraint in found.constraints() {
            let all = &self.analyser.manipulator.mechanism().legs;
            let legs: Vec<&str> = constraint.legs.iter().map(|&leg| &*all[leg].name).collect();
            let index = constraint
                .output
                .map_or("no output constraint index: several constraints".into(), |oci| {
                    format!("output constraint index {}", short(oci))
                });
            let _ = writeln!(
                text,
                "{} section, constrained by {}: {index}\n",
                constraint.section,
                legs.join(", ")
            );
        }
    }

    /// Every index that the mechanism has.
    fn indices_text(&self, text: &mut String) {
        let indices = &self.analyser.indices;
        let mut table = Table::new(["index", ">value", "unit", ""]);
        for (index, &value) in indices.indices().iter().zip(indices.values()) {
            let facts = index.facts();
            // Text for people has the file's units.
            let (value, unit) = match facts.unit {
                "m" => (
                    value / self.units.factor(Quantity::Length),
                    self.units.symbol(Quantity::Length),
                ),
                unit => (value, unit),
            };
            let shown = if value.is_nan() { "-".to_owned() } else { shown(value) };
            table.row([facts.name, &shown, unit, facts.about]);
        }
        let _ = write!(text, "{table}");
    }
}

/// The keys of what is computed at a pose.
const KEYS: [&str; 14] = [
    "wrench",
    "gravity",
    "balance",
    "efforts",
    "imaginary_efforts",
    "loose_motions",
    "internal_efforts",
    "worst",
    "capacity",
    "transmission",
    "stiffness",
    "indices",
    "length",
    "transform",
];

/// A number of a table for people: what is only rounding beside the load is zero.
fn part(value: f64, scale: f64) -> String {
    const ROUNDING: f64 = 1e-12;
    short(if value.abs() < ROUNDING * scale { 0.0 } else { value })
}

/// The unit of an effort.
pub fn unit(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Angle => "N m",
        Quantity::Length => "N",
    }
}

fn triple(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(|c| c + 0.0)
}

/// Numbers that JSON cannot hold are null.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// The rows of a matrix.
fn rows<R: Dim, C: Dim, S: RawStorage<f64, R, C>>(matrix: &Matrix<f64, R, C, S>) -> Value {
    let rows = matrix.row_iter().map(|row| row.iter().copied().collect::<Vec<f64>>());
    json!(rows.collect::<Vec<_>>())
}

fn shown(value: f64) -> String {
    if value.is_finite() { short(value) } else { "unlimited".to_owned() }
}
