//! `opm analyze --poses`: a CSV file of poses in, one of efforts and indices out, row by row.

use super::{Analyser, word};
use crate::args::{AnalyzeArgs, Format, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose_table;
use crate::stream::{self, Stop, Stream, Streams};
use crate::text::{count, short};
use opm_analysis::Index;
use opm_core::manipulator::Mode;
use opm_study::effort_names;
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
    balanced: u64,
    seconds: f64,
    poses_per_second: f64,
}

pub fn run(
    args: &AnalyzeArgs,
    input: &Path,
    output: &Output,
    loaded: &Loaded,
    (analyser, mode): (&mut Analyser<'_>, Mode),
) -> Result<(), Failure> {
    let streams = Streams { input, output: args.output.as_deref() };
    let solve = |stream: Stream<'_>| solve(stream, loaded, analyser, mode);
    let Some(summary) = stream::run(&streams, output, loaded, solve)? else { return Ok(()) };
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

fn solve(
    mut stream: Stream<'_>,
    loaded: &Loaded,
    analyser: &mut Analyser<'_>,
    mode: Mode,
) -> Result<Summary, Stop> {
    let start = Instant::now();
    let manipulator = analyser.manipulator;
    // Those that the mechanism has.
    let known: Vec<Index> = analyser.indices.indices().to_vec();
    let coordinates = manipulator.task_coordinates();
    let mut columns = pose_table::columns(&mut stream, (loaded, manipulator))?;
    let loaded_with = analyser.loads.is_some();
    let carried: Vec<String> = effort_names(manipulator).collect();
    let efforts: &[String] = if loaded_with { &carried } else { &[] };
    let header = (columns.timed().then_some("t").into_iter())
        .chain(coordinates.iter().map(|c| c.name))
        .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
        .chain(["reachable", "within_limits", "mode"])
        .chain(loaded_with.then_some("balance"))
        .chain(efforts.iter().map(String::as_str))
        .chain(known.iter().map(|index| index.name()));
    stream.writer.write_record(header)?;
    let (mut at, mut values) = (manipulator.solution(), pose_table::blank(manipulator));
    let (mut reachable, mut within_limits, mut balanced) = (0, 0, 0);
    let mode_text = manipulator.format_mode(mode);
    stream.each(&mut columns, &mut values, |stream, line, time, values| {
        let label = stream.label;
        let (pose, checks) = pose_table::split(manipulator, values);
        let found = manipulator.inverse(pose, mode, &mut at);
        let reached = found.map_err(|error| stream::at(label, line, error))?.is_some();
        let within = reached && at.within_limits();
        let blank = |count: usize| vec![None::<f64>; count];
        let mut dependent = blank(manipulator.dependent_coordinates().len());
        let mut cells = blank(efforts.len());
        let mut numbers = blank(known.len());
        let mut balance = String::new();
        if reached {
            let verified = checks.verify(manipulator, at.dependent(), loaded.file.units);
            verified.map_err(|error| stream::at(label, line, error))?;
            analyser.update(&at)?;
            dependent = at.dependent().iter().map(|&value| Some(value)).collect();
            let finite = |&value: &f64| value.is_finite().then_some(value);
            numbers = analyser.indices.values().iter().map(finite).collect();
            if let Some((_, found)) = &analyser.acting {
                word(found.balance).clone_into(&mut balance);
                balanced += u64::from(found.balance == opm_analysis::Balance::Balanced);
                cells = found.actuated.iter().chain(&found.imaginary).copied().collect();
            }
        }
        reachable += u64::from(reached);
        within_limits += u64::from(within);
        let balance = if loaded_with { std::slice::from_ref(&balance) } else { &[] };
        let answers = (u8::from(reached), u8::from(within), &mode_text);
        let row = (time.as_slice(), pose, dependent, answers, balance, cells, numbers);
        Ok(stream.writer.serialize(row)?)
    })?;
    let seconds = start.elapsed().as_secs_f64().max(1e-9);
    let poses = stream.rows.load(Ordering::Relaxed);
    let poses_per_second = poses as f64 / seconds;
    Ok(Summary { poses, reachable, within_limits, balanced, seconds, poses_per_second })
}
