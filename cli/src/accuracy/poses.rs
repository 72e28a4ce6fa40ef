//! `opm accuracy --poses`: a CSV file of poses in, one of errors out, row by row.

use super::{Setting, row};
use crate::args::{AccuracyArgs, Format, Output};
use crate::failure::Failure;
use crate::pose::find;
use crate::stream::{self, Stop, Stream, Streams, Wanted, other_columns};
use crate::text::{count, short};
use crate::unitless::Plausible;
use opm_accuracy::Budget;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// The totals of a batch.
#[derive(Debug, Serialize)]
struct Summary {
    poses: u64,
    reachable: u64,
    within_limits: u64,
    seconds: f64,
    poses_per_second: f64,
}

pub fn run(
    args: &AccuracyArgs,
    input: &Path,
    output: &Output,
    setting: &Setting<'_>,
) -> Result<(), Failure> {
    let streams = Streams { input, output: args.output.as_deref() };
    let solve = |stream: Stream<'_>| solve(stream, setting);
    let Some(summary) = stream::run(&streams, output, setting.loaded, solve)? else {
        return Ok(());
    };
    output.note(format_args!(
        "{}: {} poses, {} in reach, {} within limits; {} s, {} poses/s",
        args.output.as_deref().unwrap_or(input).display(),
        count(summary.poses),
        count(summary.reachable),
        count(summary.within_limits),
        short(summary.seconds),
        count(summary.poses_per_second as u64),
    ));
    if output.format == Format::Json { output.print(&summary, "") } else { Ok(()) }
}

fn solve(mut stream: Stream<'_>, setting: &Setting<'_>) -> Result<Summary, Stop> {
    let start = Instant::now();
    let (manipulator, mode) = (setting.manipulator(), setting.mode);
    let coordinates = manipulator.task_coordinates();
    let values = coordinates.iter().map(|c| Wanted {
        name: c.name,
        quantity: c.quantity,
        plausible: Plausible::new(c.quantity, c.home, (setting.loaded, manipulator)),
        optional: false,
    });
    let errors = row::header(manipulator);
    let others = other_columns(manipulator);
    let mut columns = stream.columns(values.collect(), |name| {
        // A table that this command wrote is read, too.
        if others.iter().chain(&errors).any(|other| other == name) {
            return Ok(None);
        }
        manipulator.refuse_following(name).map_err(|error| error.to_string())?;
        find(name, coordinates).map(Some).map_err(|error| error.to_string())
    })?;
    let header = (columns.timed().then_some("t").into_iter())
        .chain(coordinates.iter().map(|c| c.name))
        .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
        .chain(["reachable", "within_limits", "mode"])
        .chain(errors.iter().map(String::as_str));
    stream.writer.write_record(header)?;
    let (mut at, mut pose) = (manipulator.solution(), manipulator.home_pose());
    let (mut reachable, mut within_limits) = (0, 0);
    let mode_text = manipulator.format_mode(mode);
    stream.each(&mut columns, &mut pose, |stream, line, time, pose| {
        let label = stream.label;
        let found = manipulator.inverse(pose, mode, &mut at);
        let reached = found.map_err(|error| stream::at(label, line, error))?.is_some();
        let within = reached && at.within_limits();
        let mut dependent = vec![None; manipulator.dependent_coordinates().len()];
        let mut cells = vec![None; errors.len()];
        if reached {
            dependent = at.dependent().iter().map(|&value| Some(value)).collect();
            let response = setting.model.at(&at);
            let response = response.map_err(|error| stream::at(label, line, error))?;
            cells = row::cells(&Budget::new(&response, &setting.sizes)).collect();
        }
        reachable += u64::from(reached);
        within_limits += u64::from(within);
        let answers = (u8::from(reached), u8::from(within), &mode_text);
        Ok(stream.writer.serialize((time.as_slice(), pose, dependent, answers, cells))?)
    })?;
    let seconds = start.elapsed().as_secs_f64().max(1e-9);
    let poses = stream.rows.load(Ordering::Relaxed);
    let poses_per_second = poses as f64 / seconds;
    Ok(Summary { poses, reachable, within_limits, seconds, poses_per_second })
}
