//! What can be done with a mechanism after `opm decompose`, as commands that are ready to type.

use crate::args::MechanismArgs;
use crate::load::Loaded;
use crate::output::Shown;
use crate::pose::flag_value;
use crate::text::shell_word;
use opm_core::Quantity;
use opm_core::linkage::Linkage;
use opm_core::manipulator::Manipulator;
use std::path::Path;

/// Some lines for the end of the report; nothing for a mechanism that came through standard input, which cannot be read
/// again. `manipulator` is `None` where there is no closed form.
pub fn steps(
    given: &MechanismArgs,
    loaded: &Loaded,
    manipulator: Option<&Manipulator>,
) -> Option<String> {
    if loaded.is_standard_input() {
        return None;
    }
    let file = given.file.shown();
    // A word that begins with a dash is taken for an option.
    let file = if file.starts_with('-') { format!("./{file}") } else { file };
    let changed = changes(given);
    let command = |name: &str, rest: &str| {
        let (rest, gap) = (rest.trim(), if rest.is_empty() { "" } else { " " });
        format!("  opm {name} {}{changed}{gap}{rest}", shell_word(&file))
    };
    let named = |end: &str| {
        let stem = Path::new(&file).file_stem().unwrap_or_default().display().to_string();
        format!("-o {}", shell_word(&format!("{}{end}", stem.trim_start_matches('-'))))
    };
    let steps = match manipulator {
        Some(manipulator) => [
            (command("ik", &near_home(manipulator, loaded)), "joint values at a pose"),
            (command("workspace", &named(".mcap")), "how far it reaches, as a recording"),
            (command("explore", &named(".html")), "a page for browsers in which it moves"),
        ]
        .to_vec(),
        None if Linkage::new(&loaded.file.mechanism).is_ok() => [
            (command("linkage", "--sweep"), "its joints through a cycle"),
            (command("export mjcf", &named(".xml")), "a model for MuJoCo, loops and all"),
        ]
        .to_vec(),
        None => [
            (
                command("plot", &named(".svg")),
                "a picture, to see whether the file says what it should",
            ),
            (command("export mjcf", &named(".xml")), "a model for MuJoCo, loops and all"),
        ]
        .to_vec(),
    };
    let width = steps.iter().map(|(command, _)| command.chars().count()).max().unwrap_or(0);
    let lines = steps.iter().map(|(command, what)| format!("{command:width$}  {what}\n"));
    Some(format!("\nnext:\n{}", lines.collect::<String>()))
}

/// The options with which the mechanism was changed.
fn changes(given: &MechanismArgs) -> String {
    let mut text = String::new();
    if let Some(Ok(length)) = given.tolerance.map(|t| t.value_of("", Quantity::Length)) {
        text += &format!(" --tolerance {length}m");
    }
    let set: Vec<String> = given.change.set.iter().map(ToString::to_string).collect();
    if !set.is_empty() {
        text += &format!(" --set {}", shell_word(&set.join(",")));
    }
    if let Some(coordinates) = given.change.coordinates {
        text += &format!(" --coordinates {}", coordinates.name());
    }
    text
}

/// A pose a little away from home in one coordinate, if it is in reach there; else home.
fn near_home(manipulator: &Manipulator, loaded: &Loaded) -> String {
    /// Steps that are tried, shares of the mechanism's size or radians.
    const SHARES: [f64; 3] = [0.05, -0.05, 0.01];
    let Some(first) = manipulator.task_coordinates().first() else { return "--pose ''".to_owned() };
    let units = loaded.file.units;
    let size = match first.quantity {
        Quantity::Length => manipulator.characteristic_length(),
        Quantity::Angle => 1.0,
    };
    let (home, mode) = (manipulator.home_pose(), manipulator.home_mode());
    let mut solution = manipulator.solution();
    let value = SHARES.into_iter().find_map(|share| {
        let value = round(first.home + share * size, units.factor(first.quantity));
        let mut pose = home.clone();
        pose[0] = value;
        let found = manipulator.inverse(&pose, mode, &mut solution).ok().flatten()?;
        found.within_limits().then_some(value)
    });
    let value = flag_value(value.unwrap_or(first.home), first.quantity, units);
    format!("--pose {}={value}", first.name)
}

/// A number with one digit, or two where the first is 1, in a unit.
fn round(value: f64, unit: f64) -> f64 {
    let (shown, digits) = (value / unit, (value / unit).abs().log10().floor());
    if !digits.is_finite() {
        return value;
    }
    let step = 10_f64.powf(digits);
    (shown / step).round() * step * unit
}
