//! A mechanism as the text of a file that lists its joints: what the reader's tests read back, and
//! where the joint lists among the examples come from.

use super::FileUnits;
use crate::joint::{Joint, JointKind, Quantity};
use crate::mechanism::{Mechanism, TaskHints};
use nalgebra::Vector3;
use std::fmt::Write;

/// Decimals of a length or an angle in the file: coarser than the rounding of what computed it, so
/// that 119.99999999999999 mm is written 120.
const DECIMALS: usize = 12;

/// Decimals of the components of a unit vector, likewise.
const UNIT_DECIMALS: usize = 14;

/// The text of the file. A family's names of imaginary joints and home values of task coordinates
/// have no place in it.
pub(in crate::mechanism) fn write(mechanism: &Mechanism, units: FileUnits) -> String {
    let mut text = format!(
        "format = 1\nname = {}\nunits = {{ length = \"{}\", angle = \"{}\" }}\n",
        quoted(&mechanism.name),
        units.length.symbol(),
        units.angle.symbol()
    );
    let length = |v: f64| v / units.length.factor();
    let platform = mechanism.platform.coords.map(length);
    let _ = write!(text, "\n[platform]\npoint = {}\n", array(platform.as_slice()));
    text.push_str(&task(&mechanism.task, units));
    for leg in &mechanism.legs {
        let _ = write!(text, "\n[[leg]]\nname = {}\njoints = [\n", quoted(&leg.name));
        for joint in &leg.joints {
            let _ = writeln!(text, "  {{ {} }},", entries(joint, units).join(", "));
        }
        text.push_str("]\n");
    }
    text
}

/// `[task]`, if it says anything.
fn task(hints: &TaskHints, units: FileUnits) -> String {
    let mut lines = Vec::new();
    if let Some(axis) = hints.axis {
        lines.push(format!("axis = {}", direction(&axis)));
    }
    for (name, frame) in [("lower", &hints.lower), ("upper", &hints.upper)] {
        let directions = [("x", frame.x), ("w", frame.w), ("normal", frame.normal)];
        let mut keys: Vec<_> = directions
            .into_iter()
            .filter_map(|(key, given)| Some(format!("{key} = {}", direction(&given?))))
            .collect();
        if let Some(origin) = frame.origin {
            let origin = origin.coords / units.factor(Quantity::Length);
            keys.push(format!("origin = {}", array(origin.as_slice())));
        }
        if !keys.is_empty() {
            lines.push(format!("{name} = {{ {} }}", keys.join(", ")));
        }
    }
    if lines.is_empty() { String::new() } else { format!("\n[task]\n{}\n", lines.join("\n")) }
}

fn entries(joint: &Joint, units: FileUnits) -> Vec<String> {
    let (kind, second, pitch) = match joint.kind {
        JointKind::Revolute => ("revolute", None, None),
        JointKind::Prismatic => ("prismatic", None, None),
        JointKind::Helical { pitch } => ("helical", None, Some(pitch)),
        JointKind::Cylindrical => ("cylindrical", None, None),
        JointKind::Universal { second } => ("universal", Some(second), None),
        JointKind::Spherical => ("spherical", None, None),
    };
    let mut entries = vec![format!("name = {}", quoted(&joint.name)), format!("type = \"{kind}\"")];
    if joint.kind != JointKind::Spherical {
        entries.push(format!("axis = {}", direction(&joint.axis)));
    }
    if let Some(second) = second {
        entries.push(format!("axis2 = {}", direction(&second)));
    }
    let point = joint.point.coords / units.factor(Quantity::Length);
    entries.push(format!("point = {}", array(point.as_slice())));
    if let Some(pitch) = pitch {
        entries.push(format!("pitch = {}", number(pitch / units.factor(Quantity::Length))));
    }
    if joint.actuated {
        entries.push("actuated = true".into());
    }

    let one_or_all = |values: Vec<String>| match &values[..] {
        [one] => one.clone(),
        all => format!("[{}]", all.join(", ")),
    };
    let coordinates = &joint.coordinates;
    if coordinates.iter().any(|c| c.home != 0.0) {
        let home = coordinates.iter().map(|c| number(c.home / units.factor(c.quantity)));
        entries.push(format!("home = {}", one_or_all(home.collect())));
    }
    let limits = coordinates.iter().map(|c| {
        c.limits.map(|limits| array(&limits.map(|value| value / units.factor(c.quantity))))
    });
    if let Some(limits) = limits.collect() {
        entries.push(format!("limits = {}", one_or_all(limits)));
    }
    entries
}

fn array(values: &[f64]) -> String {
    let numbers: Vec<_> = values.iter().map(|&value| number(value)).collect();
    format!("[{}]", numbers.join(", "))
}

fn direction(axis: &Vector3<f64>) -> String {
    format!(
        "[{}, {}, {}]",
        rounded(axis.x, UNIT_DECIMALS),
        rounded(axis.y, UNIT_DECIMALS),
        rounded(axis.z, UNIT_DECIMALS)
    )
}

fn number(value: f64) -> String {
    rounded(value, DECIMALS)
}

fn rounded(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.into() }
}

fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
}
