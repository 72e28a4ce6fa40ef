//! `opm accuracy --poses`: a CSV file of poses in, one of errors out, row by row.

use super::{Setting, row};
use crate::args::{AccuracyArgs, Output};
use crate::failure::Failure;
use crate::pose_table::{self, Totals};
use crate::stream::{self, Stream, StreamStop, Streams};
use opm_accuracy::Budget;
use std::path::Path;
use std::time::Instant;

pub fn run(
    args: &AccuracyArgs,
    input: &Path,
    output: &Output,
    setting: &Setting<'_>,
) -> Result<(), Failure> {
    let (target, columns) = (args.output.as_deref(), args.columns.as_ref());
    let streams = Streams { input, output: target, columns };
    let solve = |stream: Stream<'_>| solve(stream, setting);
    let Some(totals) = stream::run(&streams, output, setting.loaded, solve)? else {
        return Ok(());
    };
    totals.tell(&streams, output, &totals)
}

fn solve(mut stream: Stream<'_>, setting: &Setting<'_>) -> Result<Totals, StreamStop> {
    let start = Instant::now();
    let (manipulator, mode) = (setting.manipulator(), setting.mode);
    let coordinates = manipulator.task_coordinates();
    let errors = row::header(manipulator);
    // A table that this command wrote is read, too.
    let mut columns =
        pose_table::columns_beside(&mut stream, (setting.loaded, manipulator), &errors)?;
    let header = (columns.timed().then_some("t").into_iter())
        .chain(coordinates.iter().map(|c| c.name))
        .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
        .chain(["reachable", "within_limits", "mode"])
        .chain(errors.iter().map(String::as_str));
    stream.rows.header(header)?;
    let mut at = manipulator.solution();
    let (mut reachable, mut within_limits) = (0, 0);
    let mode_text = manipulator.format_mode(mode);
    stream.each(&mut columns, &pose_table::blank(manipulator), |stream, line, time, values| {
        let label = stream.label;
        let (pose, checks) = pose_table::split(manipulator, values);
        let found = manipulator.inverse(pose, mode, &mut at);
        let reached = found.map_err(|error| stream::at(label, line, error))?.is_some();
        let within = reached && at.within_limits();
        let mut cells = vec![None; errors.len()];
        if reached {
            let verified = checks.verify(manipulator, at.dependent(), setting.loaded.file.units);
            verified.map_err(|error| stream::at(label, line, error))?;
            let response = setting.model.at(&at);
            let response = response.map_err(|error| stream::at(label, line, error))?;
            cells = row::cells(&Budget::new(&response, &setting.sizes)).collect();
        }
        reachable += u64::from(reached);
        within_limits += u64::from(within);
        let rows = &mut stream.rows;
        let following =
            (reached.then(|| at.dependent()), manipulator.dependent_coordinates().len());
        pose_table::begin(rows, time, pose, following, [reached, within], &mode_text)?;
        rows.cells(&cells)?;
        Ok(rows.end()?)
    })?;
    Ok(Totals::new(&stream, start, [reachable, within_limits]))
}
