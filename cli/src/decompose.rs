//! `opm decompose`: partial subspaces and imaginary joints.

mod answer;
mod joints;
mod next;
mod report;
mod whole;

use crate::args::{DecomposeArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::parameters;
use crate::pose::GridAxis;
use crate::runs::{self, Cell};
use crate::text::{Table, chain, plural, short};
use answer::Answer;
use nalgebra::Vector3;
use opm_core::Quantity;
use opm_core::decomposition::mobility::Mobility;
use opm_core::decomposition::{
    Applies, Decomposition, Freedom, JointMiss, check_actuators, doubts, slightly_off, survey,
};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::{CompileError, Manipulator};
use opm_core::mechanism::file::FileUnits;
use opm_core::mechanism::leg::Leg;
use opm_core::task::{Subspace, Task, TaskCoordinate};
use report::Report;
use serde::Serialize;
use serde_json::{Value, json};
use std::fmt::Write;

/// A joint screw farther than this from its subspace (the sine of an angle, with lengths divided by the
/// mechanism's size) gives a warning. Files with nine digits stay well below.
const ROUNDING: f64 = 1e-7;

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
            Applies::Decomposed(_) | Applies::Outside(_) => warnings_of(&loaded, &found.mobility),
        };
        let next = match found.applies {
            // The answer offers a tolerance.
            Applies::Nearly => None,
            Applies::Decomposed(_) | Applies::Outside(_) => {
                next::steps(&args.mechanism, &loaded, None)
            }
        };
        let text = answer.text() + &parameters::section(&loaded.file) + &next.unwrap_or_default();
        output.print(&answer.json(&warnings), text)?;
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
    let mut warnings = warnings_of(&loaded, &found.mobility);
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
    let next = next::steps(&args.mechanism, &loaded, manipulator).unwrap_or_default();
    let text = report.text() + &parameters::section(&loaded.file) + &next;
    output.print(&report.json(&warnings), text)?;
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

/// What is wrong with the actuators, and what is probably a mistake in the file.
fn warnings_of(loaded: &Loaded, report: &Mobility) -> Vec<String> {
    let doubts = doubts(&loaded.file.mechanism);
    actuator_warnings(loaded, report).into_iter().chain(doubts).collect()
}

/// What is wrong with the actuators: none yet, too few, too many, or in the wrong places.
fn actuator_warnings(loaded: &Loaded, report: &Mobility) -> Vec<String> {
    let mut warnings = Vec::new();
    if let Err(error) = check_actuators(report) {
        warnings.push(format!("{error}{}", loaded.motors_hint()));
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
