//! `opm decompose`: partial subspaces and imaginary joints.

mod answer;
mod joints;
mod whole;

use crate::args::{DecomposeArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::parameters;
use crate::pose::GridAxis;
use crate::runs::{self, Cell};
use crate::text::{self, Table, chain, plural, short};
use answer::Answer;
use nalgebra::{Point3, Vector3};
use opm_core::Quantity;
use opm_core::decomposition::mobility::Mobility;
use opm_core::decomposition::{
    Applies, Decomposition, Freedom, JointMiss, MAX_DECOMPOSITIONS, check_actuators, slightly_off,
    survey,
};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{CompileError, Manipulator};
use opm_core::mechanism::Mechanism;
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::leg::Leg;
use opm_core::task::{CoordinateKind, Subspace, Task, TaskCoordinate};
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::{Display, Write};

/// A joint screw farther than this from its subspace (the sine of an angle, with lengths divided by the
/// mechanism's size) gives a warning. Files with nine digits stay well below.
const ROUNDING: f64 = 1e-7;

/// Number of alternatives that the text lists. JSON has all of them.
const LISTED: usize = 6;

pub fn run(args: &DecomposeArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::read(&args.mechanism, output)?.rerooted(output);
    if let Some(vary) = &args.vary {
        return table(&loaded, vary, output);
    }
    let mechanism = &loaded.file.mechanism;
    let found = survey(mechanism).map_err(|error| Failure::at(&loaded.label, error))?;
    let Applies::Decomposed(decompositions) = &found.applies else {
        let answer = Answer { loaded: &loaded, survey: &found };
        // The mobility of a mechanism that is nearly right is not that of the right one.
        let warnings = match found.applies {
            Applies::Nearly => Vec::new(),
            Applies::Decomposed(_) | Applies::Outside(_) => actuator_warnings(&found.mobility),
        };
        output
            .print(&answer.json(&warnings), answer.text() + &parameters::section(&loaded.file))?;
        warn(output, &loaded, &warnings);
        return Ok(());
    };
    let ways: Vec<Way<'_>> =
        decompositions.iter().map(|decomposition| Way::new(&loaded, decomposition)).collect();
    let manipulator = ways.iter().find_map(|way| way.compiled.as_ref().ok());
    let refused = match (manipulator, &ways[0].compiled) {
        (None, Err(error)) => Some(error),
        (Some(_), _) | (None, Ok(_)) => None,
    };
    if let Some(CompileError::Task(error)) = refused
        && error.key().is_some()
    {
        let place = loaded.place_of(&CompileError::Task(error.clone()));
        return Err(Failure::at(place, error.clone()));
    }
    let mut warnings = actuator_warnings(&found.mobility);
    let deviation = ways[0].decomposition.deviation;
    match (&found.near, slightly_off(mechanism)) {
        (Some(near), _) => warnings.push(format!(
            "it nearly decomposes into smaller sections, {} and {}: {near}{}",
            near.lower.name(),
            near.upper.name(),
            loaded.tolerance_hint(near)
        )),
        (None, Some(near)) => warnings.push(loaded.misses(&near)),
        (None, None) if deviation > ROUNDING => warnings.push(format!(
            "the joints are off their subspaces by {} (the sine of an angle, lengths over the \
             mechanism's size); are its numbers rounded? --tolerance LENGTH corrects them",
            short(deviation)
        )),
        (None, None) => {}
    }
    let report = Report {
        loaded: &loaded,
        applies: found.applies.name(),
        mobility: &found.mobility,
        ways: &ways,
        manipulator,
    };
    output.print(&report.json(&warnings), report.text() + &parameters::section(&loaded.file))?;
    warn(output, &loaded, &warnings);
    if let Some(error) = refused {
        let (hint, place) = (loaded.linkage_hint(), loaded.place_of(error));
        let error = chain(error);
        output.note(format_args!("{place}: no closed-form inverse kinematics: {error}{hint}"));
    }
    Ok(())
}

/// The decomposition for each value of a number of the mechanism file.
fn table(loaded: &Loaded, vary: &GridAxis, output: &Output) -> Result<(), Failure> {
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let mechanism = &changed.file.mechanism;
        let found = survey(mechanism).map_err(|error| Failure::at(&changed.label, error))?;
        let mobility = found.mobility.mobility as u64;
        let mut cells = vec![
            Cell::new("applies", found.applies.name(), found.applies.name()),
            Cell::count("mobility", mobility),
        ];
        let (lower, upper, imaginary) = match &found.applies {
            Applies::Decomposed(ways) => {
                let Decomposition { lower, upper, imaginary_joints, .. } = &ways[0];
                (lower.name(), upper.name(), Some(*imaginary_joints as u64))
            }
            Applies::Nearly | Applies::Outside(_) => ("-", "-", None),
        };
        let shown = imaginary.map_or("-".to_owned(), |joints| joints.to_string());
        let header = "inverse kinematics".to_owned();
        cells.extend([
            Cell::new("lower", lower, lower),
            Cell::new("upper", upper, upper),
            Cell::new("imaginary_joints", imaginary, shown),
            Cell { header, ..Cell::answer("closed_form", changed.compile().is_ok()) },
        ]);
        Ok(cells)
    })
}

fn warn(output: &Output, loaded: &Loaded, warnings: &[String]) {
    for warning in warnings {
        output.warn(format_args!("{}: {warning}", loaded.label));
    }
}

/// What is wrong with the actuators: none yet, too few, too many, or in the wrong places.
fn actuator_warnings(report: &Mobility) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Err(error) = check_actuators(report) {
        warnings.push(error.to_string());
        return warnings;
    }
    warnings.extend(report.parallel_home());
    if !report.redundant.is_empty() {
        warnings.push(format!(
            "the actuators are redundant: {} actuated freedoms for {} that they control; any one of \
             {} could be passive",
            report.actuators,
            report.controlled,
            report.redundant.join(", ")
        ));
    }
    warnings
}

/// One decomposition, with its task coordinates.
struct Way<'a> {
    decomposition: &'a Decomposition,
    legs: Vec<Parts<'a>>,
    /// An error if there are no closed forms.
    compiled: Result<Manipulator, CompileError>,
}

/// The parts of a leg.
#[derive(Serialize)]
struct Parts<'a> {
    name: &'a str,
    lower: Vec<&'a str>,
    upper: Vec<&'a str>,
    imaginary: Option<String>,
    /// How the leg is solved: `sections`, or `whole`.
    solved: &'static str,
    /// The steps by which a whole leg is solved.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    kernels: Vec<Value>,
}

struct Report<'a> {
    loaded: &'a Loaded,
    /// Which part of the crate applies: see [`Applies::name`].
    applies: &'static str,
    mobility: &'a Mobility,
    ways: &'a [Way<'a>],
    /// `None` if there are no closed forms.
    manipulator: Option<&'a Manipulator>,
}

impl<'a> Way<'a> {
    fn new(loaded: &'a Loaded, decomposition: &'a Decomposition) -> Self {
        let mechanism = &loaded.file.mechanism;
        let legs = (mechanism.legs.iter().zip(&decomposition.legs))
            .map(|(leg, split)| Parts {
                name: &leg.name,
                lower: joints(leg, &split.lower),
                upper: joints(leg, &split.upper),
                imaginary: split.imaginary.then(|| leg.imaginary_name()),
                solved: if split.whole.is_some() { "whole" } else { "sections" },
                kernels: whole::kernels(leg, split),
            })
            .collect();
        let compiled = Manipulator::with_decomposition(mechanism.clone(), decomposition.clone());
        Self { decomposition, legs, compiled }
    }

    /// The frames and coordinates. Without closed forms there are none; a note says so.
    fn task(&self) -> Option<&Task> {
        self.compiled.as_ref().ok().map(Manipulator::task)
    }

    /// Whether all legs move in one subgroup: then there is no upper section.
    fn is_one_subspace(&self) -> bool {
        self.decomposition.upper == SubspaceClass::Identity
    }

    /// The independent coordinates, and those that follow from them.
    fn coordinates(&self) -> [&[TaskCoordinate]; 2] {
        match &self.compiled {
            Ok(manipulator) => {
                [manipulator.task_coordinates(), manipulator.dependent_coordinates()]
            }
            Err(_) => [&[]; 2],
        }
    }

    /// What the legs that tie coordinates together do; empty if there are none.
    fn constraints(&self) -> String {
        let Ok(manipulator) = &self.compiled else { return String::new() };
        let names =
            |list: &[TaskCoordinate]| list.iter().map(|c| c.name).collect::<Vec<_>>().join(" ");
        let [independent, dependent] = self.coordinates();
        if dependent.is_empty() {
            return String::new();
        }
        let mut numbers: Vec<usize> = manipulator.constraining_legs().map(|(leg, _)| leg).collect();
        numbers.sort_unstable();
        numbers.dedup();
        let legs: Vec<&str> = numbers.into_iter().map(|leg| self.legs[leg].name).collect();
        let verb = if legs.len() == 1 { "has" } else { "have" };
        format!(
            "{} {verb} too few freedoms to follow every motion: a pose is given by {}, and {} {} from it.\n",
            legs.join(" and "),
            names(independent),
            names(dependent),
            if dependent.len() == 1 { "follows" } else { "follow" }
        )
    }

    fn json(&self) -> Value {
        let d = self.decomposition;
        let coordinate = |c: &TaskCoordinate| json!({ "name": c.name, "home": c.home, "unit": c.quantity.unit() });
        let [independent, dependent] = self.coordinates();
        let upper = (!self.is_one_subspace()).then_some(d.upper);
        let frames = self.task().map(|task| {
            let upper = upper.map(|_| frame_json(&task.upper));
            json!({ "lower": frame_json(&task.lower), "upper": upper })
        });
        json!({
            "platform": self.platform(),
            "imaginary_joints": d.imaginary_joints,
            "first_section_motions": d.first_section_motions,
            "lower": { "subspace": d.lower.name() },
            "upper": upper.map(|upper| json!({ "subspace": upper.name() })),
            "intersection": intersection(&d.intersection),
            "task_coordinates": independent.iter().map(coordinate).collect::<Vec<_>>(),
            "dependent_coordinates": dependent.iter().map(coordinate).collect::<Vec<_>>(),
            "legs": self.legs,
            "frames": frames,
        })
    }

    /// The subspaces, and the legs' parts in them.
    fn sections(&self, units: FileUnits) -> String {
        let d = self.decomposition;
        if d.is_whole() {
            return self.whole();
        }
        if self.is_one_subspace() {
            let mut legs = Table::new(["leg", "joints"]);
            for leg in &self.legs {
                legs.row([leg.name, &leg.lower.join(" ")]);
            }
            return format!("one subspace    {}\n\n{legs}", describe(&d.lower, units));
        }
        let shared = match d.intersection {
            SubspaceClass::Identity => "nothing".to_owned(),
            _ => describe(&d.intersection, units),
        };
        let mut legs = Table::new(["leg", "lower", "|", "upper", "imaginary joint"]);
        for leg in &self.legs {
            let imaginary = leg.imaginary.clone().unwrap_or_default();
            legs.row([leg.name, &leg.lower.join(" "), "|", &leg.upper.join(" "), &imaginary]);
        }
        format!(
            "lower section   {}\nupper section   {}\nin common       {shared}\n\n{legs}",
            describe(&d.lower, units),
            describe(&d.upper, units)
        )
    }

    /// `J = 3, M = 2: planar + spherical, rotation in common, legs 3|2 3|2 3|2 2|3`.
    fn summary(&self) -> String {
        let d = self.decomposition;
        let shared = match d.intersection {
            SubspaceClass::Identity => "nothing",
            _ => d.intersection.name(),
        };
        let splits: Vec<String> =
            d.legs.iter().map(|leg| format!("{}|{}", leg.lower.len(), leg.upper.len())).collect();
        format!(
            "J = {}, M = {}: {} + {}, {} in common, freedoms {}",
            d.imaginary_joints,
            d.first_section_motions,
            d.lower.name(),
            d.upper.name(),
            shared,
            splits.join(" ")
        )
    }
}

impl Report<'_> {
    fn json(&self, warnings: &[String]) -> Value {
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

    fn text(&self) -> String {
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

/// The effect of the actuated joints.
fn actuation(loaded: &Loaded, report: &Mobility) -> String {
    let joints = loaded.file.mechanism.joints().filter(|joint| joint.actuated);
    let names: Vec<&str> = joints.map(|joint| &*joint.name).collect();
    let names = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let mut text = format!("actuated: {names}; ");
    if report.redundant.is_empty() || check_actuators(report).is_err() {
        let _ = write!(text, "{} for mobility N = {}", report.actuators, report.mobility);
    } else {
        let _ = write!(
            text,
            "{} for mobility N = {}, any one of {} could be left out",
            report.actuators,
            report.mobility,
            report.redundant.join(", ")
        );
    }
    if report.idle > 0 {
        let verb = if report.idle == 1 { "does" } else { "do" };
        let _ = write!(text, "; {} of N {verb} not move the platform", report.idle);
    }
    text
}

/// The joints that --tolerance moved, if it was given.
fn line_of_snapped(text: &mut String, loaded: &Loaded) {
    let Some(snapped) = &loaded.snapped else { return };
    if snapped.is_empty() {
        let _ = writeln!(text, "\nsnapped by --tolerance: none");
        return;
    }
    let _ = writeln!(text, "\nsnapped by --tolerance: {}", plural(snapped.len() as u64, "joint"));
    for miss in snapped {
        let _ = writeln!(text, "  {miss}");
    }
}

/// Joints and by how much they miss their subspaces.
fn misses(joints: &[JointMiss]) -> Value {
    let one = |miss: &JointMiss| {
        json!({
            "leg": miss.leg,
            "joint": miss.joint,
            "section": miss.section.to_string(),
            "subspace": miss.subspace.name(),
            "angle": miss.angle,
            "distance": miss.distance,
            "message": miss.reason(),
        })
    };
    joints.iter().map(one).collect()
}

/// Names of the joints of a part. If a joint is divided between parts, its coordinates are named.
fn joints<'a>(leg: &'a Leg, part: &[Freedom]) -> Vec<&'a str> {
    let mut names = Vec::new();
    for freedom in part {
        let joint = &leg.joints[freedom.joint];
        let whole = part.iter().filter(|f| f.joint == freedom.joint).count() == joint.freedoms();
        if !whole {
            names.push(&*joint.coordinates[freedom.index].name);
        } else if freedom.index == 0 {
            names.push(&*joint.name);
        }
    }
    names
}

/// The components of a vector. Adding zero turns -0 into 0.
fn triple_json(v: &Vector3<f64>) -> [f64; 3] {
    [v.x, v.y, v.z].map(|c| c + 0.0)
}

/// The frame of a section, SI.
fn frame_json(frame: &Subspace) -> Value {
    let axis = |number: usize| triple_json(&frame.axes.column(number).into_owned());
    json!({
        "origin": triple_json(&frame.measured_from.coords),
        "centre": triple_json(&frame.origin.coords),
        "axes": [axis(0), axis(1), axis(2)],
    })
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

/// A vector in a unit, to six decimals.
fn triple(v: &Vector3<f64>, unit: f64) -> String {
    let [x, y, z] = [v.x, v.y, v.z].map(|c| (c / unit * 1e6).round() / 1e6 + 0.0);
    format!("({x}, {y}, {z})")
}

fn intersection(class: &SubspaceClass) -> Value {
    let (axis, point, pitch) = match class {
        SubspaceClass::Rotation { axis, point } => (axis, Some(point), None),
        SubspaceClass::Helical { axis, point, pitch } => (axis, Some(point), Some(*pitch)),
        SubspaceClass::Translation { axis } => (axis, None, None),
        SubspaceClass::Identity => return Value::Null,
        other => return json!({ "kind": other.name(), "axis": null, "point": null, "pitch": null }),
    };
    json!({
        "kind": class.name(),
        "axis": triple_json(axis),
        "point": point.map(|p| triple_json(&p.coords)),
        "pitch": pitch,
    })
}

/// A subspace in words, in the file's units.
pub fn describe(class: &SubspaceClass, units: FileUnits) -> String {
    let direction = |v: &Vector3<f64>| triple(v, 1.0);
    let place = |v: &Vector3<f64>| {
        let unit = units.length;
        format!("{} {}", triple(v, unit.factor()), unit.symbol())
    };
    let advance = |pitch: f64| format!("{}/rad", units.show(pitch, Quantity::Length));
    let name = class.name();
    match class {
        SubspaceClass::Rotation { axis, point } | SubspaceClass::Cylindrical { axis, point } => {
            format!("{name}, axis {} through {}", direction(axis), place(&point.coords))
        }
        SubspaceClass::Translation { axis } => format!("{name} along {}", direction(axis)),
        SubspaceClass::Helical { axis, point, pitch } => format!(
            "{name}, axis {} through {}, pitch {}",
            direction(axis),
            place(&point.coords),
            advance(*pitch)
        ),
        SubspaceClass::TranslationalPlane { normal } | SubspaceClass::Planar { normal } => {
            format!("{name}, normal {}", direction(normal))
        }
        SubspaceClass::Spherical { centre } => format!("{name}, centre {}", place(&centre.coords)),
        SubspaceClass::PlanarHelical { axis, pitch } => {
            format!("{name}, axis {}, pitch {}", direction(axis), advance(*pitch))
        }
        SubspaceClass::Schoenflies { axis } => format!("{name}, axis {}", direction(axis)),
        SubspaceClass::Identity | SubspaceClass::TranslationalSpace | SubspaceClass::Full => {
            name.to_owned()
        }
    }
}
