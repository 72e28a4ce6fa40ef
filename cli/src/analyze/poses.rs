//! `opm analyze --poses`: a CSV file of poses in, one of efforts and indices out, row by row.

use super::{Analyser, word};
use crate::args::{AnalyzeArgs, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose_table::{self, Totals};
use crate::stream::{self, MODE, Stream, StreamStop, Streams};
use opm_analysis::Index;
use opm_core::manipulator::Mode;
use opm_study::effort_names;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// The totals of a table, and at how many poses efforts balance the load.
#[derive(Debug, Serialize)]
struct Summary {
    #[serde(flatten)]
    totals: Totals,
    balanced: u64,
}

pub fn run(
    args: &AnalyzeArgs,
    input: &Path,
    output: &Output,
    loaded: &Loaded,
    (analyser, mode): (&mut Analyser<'_>, Mode),
) -> Result<(), Failure> {
    let (target, columns) = (args.output.as_deref(), args.columns.as_ref());
    let streams = Streams { input, output: target, columns };
    let solve = |stream: Stream<'_>| solve(stream, loaded, analyser, mode);
    let Some(summary) = stream::run(&streams, output, loaded, solve)? else { return Ok(()) };
    summary.totals.tell(&streams, output, &summary)
}

fn solve(
    mut stream: Stream<'_>,
    loaded: &Loaded,
    analyser: &mut Analyser<'_>,
    mode: Mode,
) -> Result<Summary, StreamStop> {
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
        .chain(["reachable", "within_limits", MODE])
        .chain(loaded_with.then_some("balance"))
        .chain(efforts.iter().map(String::as_str))
        .chain(known.iter().map(|index| index.name()));
    stream.rows.header(header)?;
    let mut at = manipulator.solution();
    let (mut reachable, mut within_limits, mut balanced) = (0, 0, 0);
    let mode_text = manipulator.format_mode(mode);
    stream.each(&mut columns, &pose_table::blank(manipulator), |stream, line, time, values| {
        let label = stream.label;
        let (pose, checks) = pose_table::split(manipulator, values);
        let found = manipulator.inverse(pose, mode, &mut at);
        let reached = found.map_err(|error| stream::at(label, line, error))?.is_some();
        let within = reached && at.within_limits();
        let blank = |count: usize| vec![None::<f64>; count];
        let mut cells = blank(efforts.len());
        let mut numbers = blank(known.len());
        let mut balance = "";
        if reached {
            let verified = checks.verify(manipulator, at.dependent(), loaded.file.units);
            verified.map_err(|error| stream::at(label, line, error))?;
            analyser.update(&at)?;
            let finite = |&value: &f64| value.is_finite().then_some(value);
            numbers = analyser.indices.values().iter().map(finite).collect();
            if let Some((_, found)) = &analyser.acting {
                balance = word(found.balance);
                balanced += u64::from(found.balance == opm_analysis::Balance::Balanced);
                cells = found.actuated.iter().chain(&found.imaginary).copied().collect();
            }
        }
        reachable += u64::from(reached);
        within_limits += u64::from(within);
        let rows = &mut stream.rows;
        let following =
            (reached.then(|| at.dependent()), manipulator.dependent_coordinates().len());
        pose_table::begin(rows, time, pose, following, [reached, within], &mode_text)?;
        if loaded_with {
            rows.text(balance)?;
        }
        rows.cells(&cells)?;
        rows.cells(&numbers)?;
        Ok(rows.end()?)
    })?;
    let totals = Totals::new(&stream, start, [reachable, within_limits]);
    Ok(Summary { totals, balanced })
}
