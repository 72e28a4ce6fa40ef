//! `opm calibrate --plan`: poses to measure.

use super::{failure, table};
use crate::args::{CalibrateArgs, Format, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::output::{is_stdout, print_with};
use crate::progress::{interruptible, watch_steps};
use crate::target::{Target, ends_in};
use crate::text::{Table, plural, short};
use opm_calibrate::{BasePoint, Column, Options, Plan, candidates, plan};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io::Write;

pub fn run(
    args: &CalibrateArgs,
    output: &Output,
    (loaded, manipulator): (&Loaded, &Manipulator),
    points: &[BasePoint],
    (options, count): (&Options, u32),
) -> Result<(), Failure> {
    let named = args.columns.iter().map(|name| Column::named(name, manipulator, points));
    let named: Result<Vec<Column>, String> = named.collect();
    let mut columns = named.map_err(|problem| Failure::flag("--columns", problem))?;
    if columns.is_empty() {
        columns = Column::all(manipulator);
    }
    let file = args.output.as_deref().filter(|path| !is_stdout(path));
    let target = match file {
        Some(path) => {
            loaded.refuse_as_output(path, &args.poses.iter().map(|p| &**p).collect::<Vec<_>>())?;
            ends_in(path, &["csv"])?;
            Some(Target::create(path)?)
        }
        None => None,
    };
    let given = match &args.poses {
        Some(path) => Some(poses(path, (loaded, manipulator), output)?),
        None => None,
    };
    let progress = interruptible()?;
    let mode = options.mode.unwrap_or(manipulator.home_mode());
    let (drawn, found) = watch_steps(
        output,
        "choosing poses",
        None,
        || progress.done(),
        || {
            let drawn = match given {
                Some(poses) => Ok(poses),
                None => {
                    candidates(manipulator, mode, args.candidates as usize, args.seed, &progress)
                }
            };
            let Ok(drawn) = drawn else {
                return (Vec::new(), Err(Failure::interrupted("interrupted")));
            };
            let found = plan(&loaded.file, &columns, &drawn, count as usize, options, &progress);
            (drawn, found.map_err(|error| failure(error, &loaded.label)))
        },
    );
    let found = found?;
    if found.chosen.len() < count as usize {
        output.warn(format_args!(
            "only {} of {} are in reach and not singular",
            plural(found.chosen.len() as u64, "pose"),
            drawn.len(),
        ));
    }
    if found.rank < found.rank_of_all {
        output.warn(format_args!(
            "{} tell {} of {} combinations of parameters; more poses tell more",
            plural(found.chosen.len() as u64, "pose"),
            found.rank,
            found.rank_of_all,
        ));
    }
    let chosen: Vec<&Vec<f64>> = found.chosen.iter().map(|&number| &drawn[number]).collect();
    let csv = csv(manipulator, mode, &chosen)?;
    match (target, output.format) {
        (Some(target), format) => {
            target.commit(csv.as_bytes())?;
            match format {
                Format::Json => output.print(&json(manipulator, &found, &chosen), ""),
                Format::Text => output.print(&(), text(loaded, &found)),
            }
        }
        (None, Format::Json) => output.print(&json(manipulator, &found, &chosen), ""),
        (None, Format::Text) => print_with(|out| out.write_all(csv.as_bytes())),
    }
}

/// The poses of a CSV file; coordinates that it does not have stay at home.
fn poses(
    path: &std::path::Path,
    (loaded, manipulator): (&Loaded, &Manipulator),
    output: &Output,
) -> Result<Vec<Vec<f64>>, Failure> {
    let table = table::read(path, (loaded, manipulator), &[], output)?;
    let names: Vec<&str> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
    let pose = |row: &Vec<Option<f64>>| {
        let mut pose = manipulator.home_pose();
        for (column, value) in table.measurements.columns.iter().zip(row) {
            let place = names.iter().position(|name| *name == column.name);
            if let (Some(place), Some(value)) = (place, value) {
                pose[place] = *value;
            }
        }
        pose
    };
    Ok(table.measurements.rows.iter().map(pose).collect())
}

fn csv(
    manipulator: &Manipulator,
    mode: opm_core::manipulator::Mode,
    poses: &[&Vec<f64>],
) -> Result<String, Failure> {
    let coordinates = manipulator.task_coordinates().iter().map(|c| c.name);
    let actuated = manipulator.actuated().iter();
    let joints = actuated.map(|&number| &*manipulator.coordinates()[number].name);
    let mut text = coordinates.chain(joints).collect::<Vec<_>>().join(",") + "\n";
    let mut at = manipulator.solution();
    for pose in poses {
        let found = manipulator.inverse(pose, mode, &mut at);
        let found = found.map_err(|error| Failure::at("a pose", error))?;
        let joints = found.map(opm_core::Solution::joints).unwrap_or_default();
        let joints = manipulator.actuated().iter().filter_map(|&number| joints.get(number));
        let cells: Vec<String> =
            pose.iter().chain(joints).map(|value| format!("{value:?}")).collect();
        text += &(cells.join(",") + "\n");
    }
    Ok(text)
}

fn json(manipulator: &Manipulator, found: &Plan, poses: &[&Vec<f64>]) -> Value {
    let names = manipulator.task_coordinates().iter().map(|c| c.name);
    let pose = |pose: &&Vec<f64>| {
        let named = names.clone().zip(pose.iter()).map(|(name, q)| (name.to_owned(), (*q).into()));
        Value::Object(named.collect::<Map<_, _>>())
    };
    let parameters = found.parameters.iter().map(|(name, quantity, error)| {
        let unit = if *quantity == Quantity::Length { "m" } else { "rad" };
        json!({
            "name": name, "unit": unit, "standard_error": error, "identifiable": error.is_some(),
        })
    });
    json!({
        "poses": poses.iter().map(pose).collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "rank": found.rank,
        "rank_of_all": found.rank_of_all,
        "log_determinant": found.log_determinant,
    })
}

fn text(loaded: &Loaded, found: &Plan) -> String {
    let units = loaded.file.units;
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{}: {} to measure; they tell {} of {} combinations of parameters\n",
        loaded.file.mechanism.name,
        plural(found.chosen.len() as u64, "pose"),
        found.rank,
        found.rank_of_all,
    );
    let mut table = Table::new(["parameter", ">standard error", "unit"]);
    for (name, quantity, error) in &found.parameters {
        let error = error.map_or_else(|| "not told".into(), |e| short(e / units.factor(*quantity)));
        table.row([name.clone(), error, units.symbol(*quantity).to_owned()]);
    }
    let _ = write!(text, "{table}");
    text
}
