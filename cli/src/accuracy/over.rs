//! `opm accuracy --over`: the worst pose error over a box of poses, with a guaranteed bound.

use super::Setting;
use super::report::{error_model, finite};
use crate::args::{AccuracyArgs, Output};
use crate::failure::Failure;
use crate::output::named;
use crate::pose::OverAxis;
use crate::progress::{interruptible, watch_boxes};
use crate::text::{self, Table, short};
use crate::unitless;
use crate::workspace::threads;
use opm_core::Quantity;
use opm_study::{Bounded, BoxError, BoxErrors, BoxRequest};
use opm_workspace::Sections;
use serde_json::{Value, json};
use std::fmt::Write as _;

pub fn run(args: &AccuracyArgs, output: &Output, setting: &Setting<'_>) -> Result<(), Failure> {
    let manipulator = setting.manipulator();
    let ends = args.over.iter().flat_map(OverAxis::ends);
    unitless::note_ranges(output, "--over", (setting.loaded, manipulator), ends);
    if !(args.gap > 0.0 && args.gap.is_finite()) {
        return Err(Failure::flag("--gap", format!("{}, expected a positive share", args.gap)));
    }
    let coordinates = Sections::Whole.coordinates(manipulator);
    let over = args.over.iter().map(|axis| axis.resolve(&coordinates));
    let over: Result<Vec<_>, _> = over.collect();
    let over = over.map_err(|error| Failure::flag("--over", error))?;
    let request = BoxRequest {
        model: &setting.model,
        sizes: &setting.sizes,
        mode: setting.mode,
        over: &over,
        gap: args.gap,
        most: args.budget,
    };
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    let job = || pool.install(|| request.errors(&progress));
    let found = watch_boxes(output, args.budget, || "bounding".to_owned(), || progress.done(), job);
    let found = found.map_err(|error| match error {
        BoxError::Cancelled(_) => Failure::interrupted("interrupted"),
        error => Failure::flag("--over", error),
    })?;
    if found.length.found.is_nan() {
        output.warn("no pose of the box that was tried is in reach");
    } else if !found.tight {
        output.warn(format_args!(
            "the --budget of {} boxes ended before the bounds came within --gap; they hold; a smaller box helps, above all one \
             that is farther from the boundary of the workspace and from singularities",
            args.budget
        ));
    }
    output.print(&json(setting, &found), text(setting, &found))
}

fn json(setting: &Setting<'_>, found: &BoxErrors) -> Value {
    let coordinates = setting.manipulator().task_coordinates();
    let over =
        coordinates.iter().zip(&found.over).map(|(c, ends)| (c.name.to_owned(), json!(ends)));
    let of = |bounded: &Bounded| {
        let pose = coordinates.iter().map(|c| c.name).zip(bounded.pose.iter().copied());
        json!({ "found": finite(bounded.found), "bound": finite(bounded.bound), "pose": named(pose) })
    };
    json!({
        "over": over.collect::<serde_json::Map<_, _>>(),
        "mode": setting.manipulator().format_mode(setting.mode),
        "errors": error_model(setting.model.error_model()),
        "length": of(&found.length),
        "angle": of(&found.angle),
        "boxes": found.boxes,
        "tight": found.tight,
    })
}

fn text(setting: &Setting<'_>, found: &BoxErrors) -> String {
    let units = setting.loaded.file.units;
    let mut table = Table::new(["", ">largest found", ">guaranteed", "unit", "found at"]);
    let coordinates = setting.manipulator().task_coordinates();
    for (name, bounded, quantity) in [
        ("displacement", &found.length, Quantity::Length),
        ("rotation", &found.angle, Quantity::Angle),
    ] {
        let shown = |value: f64| match value.is_finite() {
            true => short(value / units.factor(quantity)),
            false => "unknown".to_owned(),
        };
        let pose = coordinates
            .iter()
            .zip(&bounded.pose)
            .map(|(c, value)| format!("{} = {}", c.name, text::number(*value, c.quantity, units)));
        table.row([
            name.to_owned(),
            shown(bounded.found),
            shown(bounded.bound),
            units.symbol(quantity).to_owned(),
            pose.collect::<Vec<_>>().join(", "),
        ]);
    }
    let mut text = format!("{table}");
    let _ = write!(
        text,
        "\n{} boxes; no pose of them that is in reach has larger errors than guaranteed\n",
        found.boxes
    );
    text
}
