//! `opm velocity`: joint rates, the Jacobian, and how near a pose is to singular.

mod table;

use crate::args::{Output, VelocityArgs};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::named;
use crate::pose::Number;
use crate::text::{self, Table, reason, short};
use crate::transform;
use crate::unitless;
use nalgebra::{DVector, Matrix6xX};
use opm_core::Quantity;
use opm_core::group::SubspaceKind;
use opm_core::manipulator::{Manipulator, Mode, Section, Solution, part_of};
use opm_core::mechanism::file::FileUnits;
use opm_core::velocity::{
    Cause, Conditioning, Jacobians, JointMotion, Measures, Singularities, VelocityError,
};
use opm_study::characteristic_length;
use serde_json::{Map, Value, json};
use std::fmt::Write;

/// The components of a twist: the angular velocity, rad/s, and the velocity of the platform's reference point, m/s.
const TWIST: [&str; 6] = ["wx", "wy", "wz", "vx", "vy", "vz"];

pub fn run(args: &VelocityArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    if let Some(vary) = &args.vary {
        return table::run(args, &loaded, vary, output);
    }
    let manipulator = loaded.compile()?;
    let mode = load::mode(&manipulator, &args.mode)?;
    unitless::note_pose(output, "--pose", &args.pose, &loaded, &manipulator);
    let (pose, checks) = args.pose.resolve_with_checks(&manipulator)?;
    let rates = args.rates.resolve_rates(&manipulator)?;
    let length = args.length.map(Number::characteristic_length).transpose()?;
    let length = characteristic_length(length, &manipulator)?;
    let mut at = manipulator.solution();
    let found = manipulator.inverse(&pose, mode, &mut at);
    let reached = found.map_err(|error| Failure::flag("--pose", error))?.is_some();
    let query = Query { loaded: &loaded, manipulator: &manipulator, pose, rates, mode };
    if reached {
        let verified = checks.verify(&manipulator, at.dependent(), loaded.file.units);
        verified.map_err(|error| Failure::flag("--pose", error))?;
    } else {
        return output.print(&query.out_of_reach(&at), query.out_of_reach_text(&at));
    }
    let answer = Answer::new(&query, &at, length)?;
    output.print(&answer.json(), answer.text())
}

/// The request.
struct Query<'a> {
    loaded: &'a Loaded,
    manipulator: &'a Manipulator,
    pose: Vec<f64>,
    rates: Vec<f64>,
    mode: Mode,
}

impl Query<'_> {
    fn head(&self) -> Map<String, Value> {
        let names = || self.manipulator.task_coordinates().iter().map(|c| c.name);
        let mut head = Map::new();
        head.insert("pose".into(), named(names().zip(self.pose.iter().copied())).into());
        head.insert("mode".into(), self.manipulator.format_mode(self.mode).into());
        head.insert("rates".into(), named(names().zip(self.rates.iter().copied())).into());
        head
    }

    fn out_of_reach(&self, at: &Solution) -> Value {
        let legs = &self.manipulator.mechanism().legs;
        let mut json = self.head();
        json.insert("reachable".into(), false.into());
        for key in [
            "joint_rates",
            "imaginary_rates",
            "jacobian",
            "twist",
            "twist_jacobian",
            "transform",
            "singularity",
        ] {
            json.insert(key.into(), Value::Null);
        }
        if !self.manipulator.dependent_coordinates().is_empty() {
            json.insert("dependent_rates".into(), Value::Null);
        }
        let unreachable = at.unreachable().iter().map(|missed| {
            json!({ "leg": legs[missed.leg].name, "reason": reason(missed, FileUnits::SI) })
        });
        json.insert("unreachable".into(), unreachable.collect::<Vec<_>>().into());
        json.into()
    }

    fn out_of_reach_text(&self, at: &Solution) -> String {
        let mut text = self.title();
        let _ = writeln!(text, "out of reach in this mode");
        for missed in at.unreachable() {
            let leg = &self.manipulator.mechanism().legs[missed.leg].name;
            let _ = writeln!(text, "  {leg}: {}", reason(missed, self.loaded.file.units));
        }
        text
    }

    fn title(&self) -> String {
        let units = self.loaded.file.units;
        let mut text = self.manipulator.mechanism().name.clone();
        let mode = self.manipulator.format_mode(self.mode);
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let mut table = Table::new(["coordinate", ">value", "unit", ">rate", "unit"]);
        let each = self.manipulator.task_coordinates().iter().zip(&self.pose).zip(&self.rates);
        for ((c, &value), &rate) in each {
            let symbol = units.symbol(c.quantity);
            table.row([
                c.name,
                &text::number(value, c.quantity, units),
                symbol,
                &text::number(rate, c.quantity, units),
                &format!("{symbol}/s"),
            ]);
        }
        format!("{text}\n\n{table}\n")
    }
}

/// The results at the pose.
struct Answer<'a> {
    query: &'a Query<'a>,
    at: &'a Solution,
    motion: JointMotion,
    /// Joint coordinates and imaginary joints that have no rate.
    rateless: Vec<usize>,
    rateless_imaginary: Vec<usize>,
    /// Rates of the actuated joints for unit rates of the task coordinates; `None` for a row of a
    /// joint that has none.
    jacobian: Vec<Option<Vec<f64>>>,
    /// The platform's twist for unit rates of the task coordinates.
    twist_jacobian: Matrix6xX<f64>,
    measured: Singularities,
    conditioning: Conditioning,
    length: f64,
}

impl<'a> Answer<'a> {
    fn new(query: &'a Query<'a>, at: &'a Solution, length: f64) -> Result<Self, Failure> {
        let manipulator = query.manipulator;
        let failed = |error: VelocityError| Failure::flag("--rates", error);
        let mut motion = manipulator.joint_motion();
        let still = vec![0.0; query.rates.len()];
        manipulator.velocity(at, &query.rates, &still, &mut motion).map_err(failed)?;
        let mut jacobians: Jacobians = manipulator.jacobians();
        manipulator.differentiate(at, &mut jacobians).map_err(failed)?;
        let mut measured = manipulator.singularities();
        manipulator.measure_singularities(&jacobians, &mut measured);
        let conditioning = manipulator.conditioning(&jacobians, length);
        let singular = || motion.singular.iter();
        let rateless: Vec<usize> = singular().flat_map(|s| manipulator.rateless(s)).collect();
        let rateless_imaginary =
            singular().filter_map(|s| manipulator.rateless_imaginary(s)).collect();
        let all = jacobians.joints_by_pose();
        let row = |&c: &usize| {
            (!rateless.contains(&c)).then(|| all.row(c).iter().copied().collect::<Vec<f64>>())
        };
        let jacobian = manipulator.actuated().iter().map(row).collect();
        Ok(Self {
            query,
            at,
            motion,
            rateless,
            rateless_imaginary,
            jacobian,
            twist_jacobian: manipulator.twist_by_pose(&jacobians),
            measured,
            conditioning,
            length,
        })
    }

    fn joint_rate(&self, coordinate: usize) -> Option<f64> {
        let rate = self.motion.joint_rates[coordinate];
        (!self.rateless.contains(&coordinate)).then_some(rate)
    }

    fn imaginary_rate(&self, number: usize) -> Option<f64> {
        let rate = self.motion.imaginary_rates[number];
        (!self.rateless_imaginary.contains(&number)).then_some(rate)
    }

    /// Names of the legs that make a measure of a section small: serial, parallel.
    fn causes(&self, section: Section) -> [Vec<&str>; 2] {
        let manipulator = self.query.manipulator;
        let name = |cause: Cause| &*manipulator.mechanism().legs[cause.leg].name;
        let serial = manipulator.serial_cause(&self.measured, section);
        let parallel = manipulator.parallel_causes(&self.measured, section);
        [serial.into_iter().map(name).collect(), parallel.into_iter().map(name).collect()]
    }

    fn json(&self) -> Value {
        let manipulator = self.query.manipulator;
        let coordinates = manipulator.coordinates();
        let joint_rates: Map<String, Value> = (coordinates.iter().enumerate())
            .map(|(i, c)| (c.name.clone(), self.joint_rate(i).into()))
            .collect();
        let imaginary_rates: Map<String, Value> = (manipulator.imaginary().iter().enumerate())
            .map(|(i, joint)| (joint.name.clone(), self.imaginary_rate(i).into()))
            .collect();
        let columns = manipulator.task_coordinates();
        let nulls = vec![Value::Null; columns.len()];
        let values = self.jacobian.iter().map(|row| match row {
            Some(row) => json!(row),
            None => json!(nulls),
        });
        let [upper, lower] = [Section::Upper, Section::Lower].map(|s| self.causes(s));
        let Singularities { upper: u, lower: l, whole, coordinates: at_pose, .. } = &self.measured;
        let mut json = self.query.head();
        json.insert("reachable".into(), true.into());
        let dependent = || manipulator.dependent_coordinates().iter().map(|c| c.name);
        if dependent().next().is_some() {
            let pose = text::whole_pose(manipulator, &self.query.pose, self.at.dependent());
            json.insert("pose".into(), named(pose).into());
            let rates = dependent().zip(self.motion.dependent_rates.iter().copied());
            json.insert("dependent_rates".into(), named(rates).into());
        }
        json.insert("joint_rates".into(), joint_rates.into());
        json.insert("imaginary_rates".into(), imaginary_rates.into());
        json.insert(
            "jacobian".into(),
            json!({
                "rows": manipulator.actuated().iter().map(|&i| &coordinates[i].name).collect::<Vec<_>>(),
                "columns": columns.iter().map(|c| c.name).collect::<Vec<_>>(),
                "values": values.collect::<Vec<_>>(),
            }),
        );
        json.insert("twist".into(), self.twist());
        json.insert("twist_jacobian".into(), self.twist_jacobian());
        json.insert("transform".into(), transform::at(manipulator, self.at));
        json.insert(
            "singularity".into(),
            json!({
                "upper_serial": u.serial,
                "upper_parallel": u.parallel,
                "lower_serial": l.serial,
                "lower_parallel": l.parallel,
                "serial": whole.serial,
                "parallel": whole.parallel,
                "condition": finite(self.conditioning.condition),
                "manipulability": finite(self.conditioning.manipulability),
                "length": self.length,
                "coordinates": at_pose,
                "nearest": {
                    "upper_serial": upper[0],
                    "upper_parallel": upper[1],
                    "lower_serial": lower[0],
                    "lower_parallel": lower[1],
                },
            }),
        );
        json.into()
    }

    /// The platform's twist for the given rates.
    fn twist(&self) -> Value {
        let rates = DVector::from_column_slice(&self.query.rates);
        let twist = &self.twist_jacobian * rates;
        let parts = twist.iter().map(|&part| finite(part + 0.0).into());
        Value::Object(TWIST.map(str::to_owned).into_iter().zip(parts).collect())
    }

    /// The platform's twist for a unit rate of each coordinate. The point is the reference point, where `transform` says.
    fn twist_jacobian(&self) -> Value {
        let columns = self.query.manipulator.task_coordinates();
        let rows = self.twist_jacobian.row_iter();
        json!({
            "rows": TWIST,
            "columns": columns.iter().map(|c| c.name).collect::<Vec<_>>(),
            "frame": "base",
            "point": "platform",
            "values": rows.map(|row| json!(row.iter().map(|&v| finite(v + 0.0)).collect::<Vec<_>>()))
                .collect::<Vec<_>>(),
        })
    }

    fn text(&self) -> String {
        let units = self.query.loaded.file.units;
        let mut text = self.query.title();
        let dependent = self.query.manipulator.dependent_coordinates();
        if !dependent.is_empty() {
            let mut table = Table::new(["dependent", ">value", "unit", ">rate", "unit"]);
            let values = self.at.dependent().iter().zip(&self.motion.dependent_rates);
            for (c, (&value, &rate)) in dependent.iter().zip(values) {
                let symbol = units.symbol(c.quantity);
                let [value, rate] = [value, rate].map(|v| match v.is_nan() {
                    true => "-".to_owned(),
                    false => text::number(v, c.quantity, units),
                });
                table.row([c.name, &value, symbol, &rate, &format!("{symbol}/s")]);
            }
            let _ = writeln!(text, "{table}");
        }
        let _ = writeln!(text, "{}", self.joint_table());
        let _ = writeln!(text, "{}", self.jacobian_table());

        let mut table = Table::new(["singularity", ">serial", "nearest", ">parallel", "nearest"]);
        let measure = |value: Option<f64>| value.map_or("-".to_owned(), short);
        let mut row = |name: &str, measures: &Measures, causes: [Vec<&str>; 2]| {
            let (serial, parallel) = (Some(measures.serial), measures.parallel);
            table.row([
                name.to_owned(),
                measure(serial),
                causes[0].join(" "),
                measure(parallel),
                causes[1].join(" "),
            ]);
        };
        if self.query.manipulator.is_whole() {
            row("whole", &self.measured.whole, self.causes(Section::Lower));
        } else if self.query.manipulator.task().upper.kind == SubspaceKind::Identity {
            row("one section", &self.measured.lower, self.causes(Section::Lower));
        } else {
            row("upper section", &self.measured.upper, self.causes(Section::Upper));
            row("lower section", &self.measured.lower, self.causes(Section::Lower));
            row("whole", &self.measured.whole, [vec![], vec![]]);
        }
        let condition = match self.conditioning.condition {
            condition if condition.is_finite() => short(condition),
            _ => "infinite".to_owned(),
        };
        let length = units.show(self.length, Quantity::Length);
        let _ = writeln!(text, "{table}\ncondition number {condition} (lengths over {length})");
        for singular in &self.motion.singular {
            let leg = &self.query.manipulator.mechanism().legs[singular.leg].name;
            let _ = writeln!(text, "{leg}: {} without rates", part_of(singular.section));
        }
        if self.measured.coordinates.abs() < opm_core::velocity::SINGULAR {
            let regular =
                self.motion.singular.is_empty() && self.conditioning.condition.is_finite();
            let mechanism = if regular { ", the mechanism is not" } else { "" };
            let _ = writeln!(text, "the pose's coordinates are singular here{mechanism}");
        }
        text
    }

    fn joint_table(&self) -> Table {
        let units = self.query.loaded.file.units;
        let manipulator = self.query.manipulator;
        let mut table = Table::new(["leg", "joint", "", ">value", "unit", ">rate", "unit"]);
        let mut row = |leg: &str, name: &str, kind: &str, quantity, value, rate: Option<f64>| {
            let symbol = units.symbol(quantity);
            let rate = rate.map_or("-".to_owned(), |rate| text::number(rate, quantity, units));
            let value = text::number(value, quantity, units);
            table.row([leg, name, kind, &value, symbol, &rate, &format!("{symbol}/s")]);
        };
        let mut number = 0;
        for (leg_number, leg) in manipulator.mechanism().legs.iter().enumerate() {
            for joint in &leg.joints {
                let kind = if joint.actuated { "actuated" } else { "passive" };
                for c in &joint.coordinates {
                    let value = self.at.joints()[number];
                    row(&leg.name, &c.name, kind, c.quantity, value, self.joint_rate(number));
                    number += 1;
                }
            }
            let imaginary = manipulator.imaginary().iter().enumerate();
            for (i, joint) in imaginary.filter(|(_, joint)| joint.leg == leg_number) {
                let (value, rate) = (self.at.imaginary()[i], self.imaginary_rate(i));
                row(&leg.name, &joint.name, "imaginary", joint.quantity, value, rate);
            }
        }
        table
    }

    /// Rates of the actuated joints for a unit rate of each coordinate, in the file's units.
    fn jacobian_table(&self) -> Table {
        let units = self.query.loaded.file.units;
        let manipulator = self.query.manipulator;
        let columns = manipulator.task_coordinates();
        let mut headers = vec!["Jacobian".to_owned()];
        headers.extend(columns.iter().map(|c| text::header(c.name, c.quantity, units)));
        let mut table = Table::new(headers);
        for (&i, row) in manipulator.actuated().iter().zip(&self.jacobian) {
            let c = &manipulator.coordinates()[i];
            let mut cells = vec![format!("{} [{}]", c.name, units.symbol(c.quantity))];
            cells.extend(columns.iter().enumerate().map(|(j, column)| {
                let factor = units.factor(column.quantity) / units.factor(c.quantity);
                row.as_ref().map_or("-".to_owned(), |row| short(row[j] * factor))
            }));
            table.row(cells);
        }
        table
    }
}

/// Numbers that JSON cannot hold are null.
fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}
