//! `opm accuracy --grid`: the largest errors over a grid, and a table of them.

use super::report::{
    allocation_json, allocation_text, error_model, finite, heading, misfit_table, significant,
};
use super::{Setting, row};
use crate::args::{AccuracyArgs, Format, Output};
use crate::failure::Failure;
use crate::output::{Shown, is_stdout, named, stdout};
use crate::pose::GridAxis;
use crate::progress::{clean_up_at_ctrl_c, interruptible, watch};
use crate::target::ends_in;
use crate::text::{self, Table, count, short};
use crate::unitless;
use crate::workspace::threads;
use opm_accuracy::Largest;
use opm_core::Quantity;
use opm_mcap::PartialFile;
use opm_mcap::csv::Rows;
use opm_study::{AccuracyField, AccuracyRequest, AccuracyRow, StudyError};
use opm_workspace::{Cancelled, Grid, Sections};
use serde_json::{Map, Value, json};
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;
use std::time::Instant;

/// Why the work ends early.
enum GridStop {
    Cancelled,
    Write(io::Error),
}

impl From<Cancelled> for GridStop {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<StudyError> for GridStop {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Cancelled => Self::Cancelled,
            other => Self::Write(io::Error::other(other)),
        }
    }
}

impl From<io::Error> for GridStop {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

pub fn run(args: &AccuracyArgs, output: &Output, setting: &Setting<'_>) -> Result<(), Failure> {
    let manipulator = setting.manipulator();
    let coordinates = Sections::Whole.coordinates(manipulator);
    let axes = args.grid.iter().map(|axis| axis.resolve(&coordinates));
    let grid = Grid::new(manipulator, axes.collect::<Result<_, _>>()?);
    let grid = grid.map_err(|error| Failure::flag("--grid", error))?;
    let ends = args.grid.iter().flat_map(GridAxis::ends);
    unitless::note_ranges(output, "--grid", (setting.loaded, manipulator), ends);
    let clearance = args.clearance.map(|pair| pair.0);
    let request = AccuracyRequest {
        model: &setting.model,
        sizes: &setting.sizes,
        mode: setting.mode,
        clearance,
    };
    let path = args.output.as_deref();
    if path.is_some_and(is_stdout) {
        if output.format == Format::Json {
            let problem = "the CSV takes standard output; give it a file with --output";
            return Err(Failure::flag("--format json", problem));
        }
        let work = Work { args, output, setting, grid: &grid, request };
        return match work.run(&mut stdout()) {
            Ok(_) => Ok(()),
            Err(GridStop::Cancelled) => Err(Failure::interrupted("interrupted")),
            Err(GridStop::Write(error)) => Err(Failure::stdout(error)),
        };
    }
    let work = Work { args, output, setting, grid: &grid, request };
    let start = Instant::now();
    let field = match path {
        None => work.run(&mut io::sink()).map_err(|stop| match stop {
            GridStop::Cancelled => Failure::interrupted("interrupted"),
            GridStop::Write(error) => Failure::work(error.to_string()),
        })?,
        Some(path) => work.to_file(path)?,
    };
    let seconds = start.elapsed().as_secs_f64().max(1e-9);
    output.print(&json(setting, &grid, &field, seconds), text(setting, &field, seconds))
}

struct Work<'a> {
    args: &'a AccuracyArgs,
    output: &'a Output,
    setting: &'a Setting<'a>,
    grid: &'a Grid,
    request: AccuracyRequest<'a>,
}

impl Work<'_> {
    /// Writes the table to a file that gets its name when it is whole.
    fn to_file(&self, path: &Path) -> Result<AccuracyField, Failure> {
        self.setting.loaded.refuse_as_output(path, &[])?;
        ends_in(path, &["csv"])?;
        clean_up_at_ctrl_c()?;
        let place = path.shown();
        let mut file = PartialFile::create(path).map_err(|error| Failure::at(&place, error))?;
        match self.run(&mut file) {
            Ok(field) => {
                file.commit().map_err(|error| Failure::at(&place, error))?;
                Ok(field)
            }
            Err(GridStop::Cancelled) => {
                let text = format!("interrupted; what was solved is in {place}.partial");
                Err(Failure::interrupted(text))
            }
            Err(GridStop::Write(error)) => {
                file.discard();
                Err(Failure::at(&place, error))
            }
        }
    }

    fn run(&self, sink: &mut (dyn Write + Send)) -> Result<AccuracyField, GridStop> {
        let manipulator = self.setting.manipulator();
        let mut rows = Rows::new(sink);
        let errors = row::header(manipulator);
        let header = (manipulator.task_coordinates().iter().map(|c| c.name))
            .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
            .chain(["reachable", "within_limits", "mode"])
            .chain(errors.iter().map(String::as_str));
        rows.header(header)?;
        let mode = manipulator.format_mode(self.setting.mode);
        let progress = interruptible().map_err(|error| GridStop::Write(io::Error::other(error)))?;
        let pool =
            threads(self.args.threads).map_err(|error| GridStop::Write(io::Error::other(error)))?;
        let job = || {
            pool.install(|| {
                self.request.over(
                    self.grid,
                    &progress,
                    |row: &AccuracyRow| -> Result<(), GridStop> {
                        rows.numbers(&row.pose)?;
                        rows.numbers(&row.dependent)?;
                        [true; 2].iter().try_for_each(|&answer| rows.answer(answer))?;
                        rows.text(&mode)?;
                        rows.cells(&row::cells(&row.budget).collect::<Vec<_>>())?;
                        Ok(rows.end()?)
                    },
                )
            })
        };
        let field =
            watch(self.output, "solving", Some(self.grid.poses()), || progress.done(), job)?;
        rows.flush()?;
        Ok(field)
    }
}

fn json(setting: &Setting<'_>, grid: &Grid, field: &AccuracyField, seconds: f64) -> Value {
    let manipulator = setting.manipulator();
    let names = || manipulator.task_coordinates().iter().map(|c| c.name);
    let largest = |found: &Largest| match found.pose.is_empty() {
        true => Value::Null,
        false => json!({
            "value": finite(found.value),
            "pose": named(names().zip(found.pose.iter().copied())),
            "undetermined": found.unknown,
        }),
    };
    let worst = &field.worst;
    let errors: Map<String, Value> =
        names().map(str::to_owned).zip(worst.coordinates.iter().map(largest)).collect();
    let joints = manipulator.mechanism().joints().zip(&worst.misfit);
    let misfit: Map<String, Value> = joints
        .map(|(joint, [length, angle])| {
            (joint.name.clone(), json!({ "length": largest(length), "angle": largest(angle) }))
        })
        .collect();
    let axes = grid.axes().iter();
    let axes: Map<String, Value> =
        axes.map(|a| (a.name.clone(), json!([a.min, a.max, a.count]))).collect();
    json!({
        "poses": field.poses,
        "reachable": worst.poses,
        "not_held": worst.loose,
        "grid": axes,
        "mode": manipulator.format_mode(setting.mode),
        "errors": error_model(setting.model.error_model()),
        "length": setting.model.length(),
        "pose_error": errors,
        "worst": { "length": largest(&worst.length), "angle": largest(&worst.angle) },
        "misfit": misfit,
        "clearance": field.allocation.as_ref().map(|found| allocation_json(setting, found)),
        "seconds": seconds,
        "poses_per_second": field.poses as f64 / seconds,
    })
}

fn text(setting: &Setting<'_>, field: &AccuracyField, seconds: f64) -> String {
    let manipulator = setting.manipulator();
    let units = setting.loaded.file.units;
    let coordinates = manipulator.task_coordinates();
    let worst = &field.worst;
    let mut text = heading(setting);
    let rate = count((field.poses as f64 / seconds) as u64);
    let _ = writeln!(
        text,
        "\n\n{} of {} poses in reach and within limits; {} s, {rate} poses/s",
        count(worst.poses),
        count(field.poses),
        short(seconds)
    );
    if worst.poses == 0 {
        return text;
    }
    if worst.loose > 0 {
        let _ = writeln!(
            text,
            "at {} of them the actuators do not hold the platform: its error there is not known",
            count(worst.loose)
        );
    }
    let headers = coordinates.iter().map(|c| text::header(c.name, c.quantity, units));
    let headers = ["largest error", ">worst", "unit"].map(str::to_owned).into_iter().chain(headers);
    let mut table = Table::new(headers);
    let own = coordinates.iter().zip(&worst.coordinates).map(|(c, l)| (c.name, l, c.quantity));
    let whole = [
        ("displacement", &worst.length, Quantity::Length),
        ("rotation", &worst.angle, Quantity::Angle),
    ];
    for (name, largest, quantity) in own.chain(whole) {
        let shown = match largest.pose.is_empty() {
            true => "-".to_owned(),
            false => significant(largest.value / units.factor(quantity)),
        };
        let mut row = vec![name.to_owned(), shown, units.symbol(quantity).to_owned()];
        let pose = coordinates.iter().zip(&largest.pose);
        row.extend(pose.map(|(c, &value)| text::number(value, c.quantity, units)));
        table.row(row);
    }
    let _ = writeln!(text, "\n{table}");
    for (c, largest) in coordinates.iter().zip(&worst.coordinates).filter(|(_, l)| l.unknown > 0) {
        let number = text::plural(largest.unknown, "pose");
        let _ =
            writeln!(text, "{} is not determined at {number}, which do not count for it\n", c.name);
    }
    if setting.sizes.iter().any(|&size| size > 0.0) {
        let misfit = worst.misfit.iter().map(|[length, angle]| [length.value, angle.value]);
        let _ = write!(text, "{}", misfit_table(setting, misfit));
    }
    if let Some(allocation) = &field.allocation {
        let _ = write!(text, "\n{}", allocation_text(setting, allocation));
    }
    text
}
