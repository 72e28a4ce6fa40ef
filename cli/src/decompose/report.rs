//! The report of a mechanism that decomposes.

use super::{Way, actuation, joints, line_of_snapped, misses, triple};
use crate::load::Loaded;
use crate::text::{self, Table};
use nalgebra::Point3;
use opm_core::decomposition::MAX_DECOMPOSITIONS;
use opm_core::decomposition::mobility::Mobility;
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::file::FileUnits;
use opm_core::task::{CoordinateKind, Subspace, Task};
use serde_json::{Value, json};
use std::fmt::{Display, Write};

/// Number of alternatives that the text lists. JSON has all of them.
const LISTED: usize = 6;

/// All decompositions of a mechanism, for people and for programs.
pub(super) struct Report<'a> {
    pub(super) loaded: &'a Loaded,
    /// Which part of the crate applies: see [`Applies::name`].
    pub(super) applies: &'static str,
    pub(super) mobility: &'a Mobility,
    pub(super) ways: &'a [Way<'a>],
    /// `None` if there are no closed forms.
    pub(super) manipulator: Option<&'a Manipulator>,
}

impl Report<'_> {
    pub(super) fn json(&self, warnings: &[String]) -> Value {
        let first = &self.ways[0];
        let mut json = json!({
            "name": self.loaded.file.mechanism.name,
            "lambda": first.decomposition.lambda,
            "mobility": first.decomposition.mobility,
        });
        if let (Value::Object(json), Value::Object(way)) = (&mut json, first.json()) {
            json.extend(way);
            if self.ways.len() > 1 {
                let others = self.ways[1..].iter().map(Way::json).collect();
                json.insert("alternatives".to_owned(), Value::Array(others));
            }
            json.insert("applies".to_owned(), self.applies.into());
            joints::insert(json, &self.loaded.file);
            json.insert("warnings".to_owned(), warnings.into());
            if let Some(snapped) = &self.loaded.snapped {
                json.insert("snapped".to_owned(), misses(snapped));
            }
        }
        json
    }

    pub(super) fn text(&self) -> String {
        let units = self.loaded.file.units;
        let mechanism = &self.loaded.file.mechanism;
        let way = &self.ways[0];
        let d = way.decomposition;
        let (n, j, m) = (d.mobility, d.imaginary_joints, d.first_section_motions);
        let mut text = String::new();
        let mut line = |line: &dyn Display| {
            let _ = writeln!(text, "{line}");
        };
        line(&format_args!(
            "{}: {} legs, joint screws of rank lambda = {}, mobility N = {n}\n",
            mechanism.name,
            mechanism.legs.len(),
            d.lambda,
        ));
        line(&way.sections(units));
        if d.is_whole() {
            line(&way.solved_whole());
        } else if way.is_one_subspace() {
            line(
                &"All legs move in one subspace: there is nothing to split, and no imaginary joint.",
            );
        } else if d.intersection == SubspaceClass::Identity {
            line(
                &"The sections share no motion: a pose fixes each of them, without imaginary joints.",
            );
            line(&format_args!(
                "The upper section has {} of the {n} motions, the lower one {m}.",
                n - m
            ));
        } else {
            line(&format_args!("With the imaginary joints the upper section has J = {j} motions."));
            line(&format_args!(
                "The lower section has M = N - J = {n} - {j} = {m} of its own (Eq. 1)."
            ));
        }
        if d.upper_mobility > 0 && d.intersection != SubspaceClass::Identity {
            line(&format_args!(
                "The upper section is not passive: with the imaginary joints locked, {} {} left.",
                text::plural(d.upper_mobility as u64, "motion"),
                if d.upper_mobility == 1 { "is" } else { "are" }
            ));
        }
        if d.redundancy > 0 {
            let verb = if d.redundancy == 1 { "is" } else { "are" };
            line(&format_args!("Of the imaginary joints, {} {verb} redundant.", d.redundancy));
        }

        if let Some(task) = way.task() {
            let mut table = Table::new(["task coordinate", ">home", "unit", ""]);
            let [independent, dependent] = way.coordinates();
            let rows = independent.iter().map(|c| (c, ""));
            for (c, note) in rows.chain(dependent.iter().map(|c| (c, "dependent"))) {
                let home = text::number(c.home, c.quantity, units);
                table.row([c.name, &home, units.symbol(c.quantity), note]);
            }
            line(&format_args!("\n{table}"));
            let constraints = way.constraints();
            if !constraints.is_empty() {
                line(&constraints);
            }
            line(&frame_table(task, way.is_one_subspace(), units));
            line(&reference_point(mechanism, task, units));
            let has = |kind| task.coordinates.iter().any(|c| c.kind() == kind);
            if has(CoordinateKind::Zeta) {
                line(&"Euler angles: R = Rz(zeta) Ry(xi) Rz(psi)\n");
            }
            if has(CoordinateKind::Azimuth) {
                line(&"tilt and torsion: R = Rz(azimuth) Ry(tilt) Rz(torsion - azimuth)\n");
            }
            if has(CoordinateKind::Roll) {
                line(&"roll, pitch and yaw: R = Rz(yaw) Ry(pitch) Rx(roll)\n");
            }
        }
        for difference in mechanism.joint_differences().unwrap_or_default() {
            let limits = text::range(difference.limits, difference.quantity, units);
            let unit = units.symbol(difference.quantity);
            line(&format_args!("limits of {}: {limits} {unit}", difference.name));
        }
        line(&actuation(self.loaded, self.mobility));
        if let Some(manipulator) = self.manipulator {
            line(&self.inverse_kinematics(manipulator));
        }
        if self.ways.len() > 1 {
            let more = if self.ways.len() == MAX_DECOMPOSITIONS { " or more" } else { "" };
            line(&format_args!("\nalternatives: {}{more}", self.ways.len() - 1));
            for (number, way) in self.ways.iter().enumerate().skip(1).take(LISTED) {
                line(&format_args!("  {number}. {}", way.summary()));
            }
            if self.ways.len() > LISTED + 1 {
                line(&"  ... (--format json lists them all)");
            }
        }
        line_of_snapped(&mut text, self.loaded);
        text
    }

    /// The consequences for `opm ik`.
    fn inverse_kinematics(&self, manipulator: &Manipulator) -> String {
        let mut text = "inverse kinematics in closed form".to_owned();
        let used = self.ways.iter().position(|w| w.decomposition == manipulator.decomposition());
        if let Some(used @ 1..) = used {
            let _ = write!(text, ", by alternative {used}");
        }
        match manipulator.choices() {
            0 => text.push_str(", one working mode"),
            choices => {
                let home = manipulator.format_mode(manipulator.home_mode());
                let _ = write!(text, ", 2^{choices} working modes, assembled in {home}");
            }
        }
        text
    }
}

/// The frames of the sections, in the file's units.
fn frame_table(task: &Task, one_subspace: bool, units: FileUnits) -> Table {
    let unit = units.length.symbol();
    let places = [format!("origin, {unit}"), format!("centre, {unit}")];
    let mut table =
        Table::new(["frame", &places[0], &places[1], "first axis", "second axis", "third axis"]);
    let both = [("lower", &task.lower), ("upper", &task.upper)];
    for (name, frame) in both.into_iter().take(if one_subspace { 1 } else { 2 }) {
        let place = |point: Point3<f64>| triple(&point.coords, units.length.factor());
        let axis = |number: usize| triple(&frame.axes.column(number).into_owned(), 1.0);
        let (origin, centre) = (place(frame.measured_from), place(frame.origin));
        table.row([name, &origin, &centre, &axis(0), &axis(1), &axis(2)]);
    }
    table
}

/// Where the platform's reference point is at home, and what it is where a frame has another centre.
fn reference_point(mechanism: &Mechanism, task: &Task, units: FileUnits) -> String {
    /// Nearer points are the same but for rounding, metres.
    const SAME: f64 = 1e-9;
    let platform = mechanism.platform;
    let unit = units.length;
    let place = triple(&platform.coords, unit.factor());
    let apart = |frame: &Subspace| (frame.origin - platform).norm() > SAME;
    let more = match apart(&task.lower) || apart(&task.upper) {
        true => "; --transform and velocities are about it, coordinates about the centres",
        false => "",
    };
    format!("reference point of the platform at home: {place} {}{more}\n", unit.symbol())
}
