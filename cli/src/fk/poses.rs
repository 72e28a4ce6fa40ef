//! `opm fk --poses`: a CSV file of actuated joints in, one of poses out, row by row.

use super::least;
use crate::args::{FkArgs, Output};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::Shown;
use crate::stream::{self, Stream, StreamStop, Streams, Wanted, other_columns};
use crate::text::{count, short};
use crate::unitless::plausible;
use opm_core::forward::{Assembly, NearError};
use opm_core::manipulator::{Manipulator, Mode};
use opm_mcap::csv::Rows;
use opm_study::Tracker;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// The totals of a batch.
#[derive(Debug, Serialize)]
struct Summary {
    rows: u64,
    reachable: u64,
    within_limits: u64,
    assemblies: u64,
    seconds: f64,
    rows_per_second: f64,
}

/// What is asked for.
struct Request<'a> {
    loaded: &'a Loaded,
    manipulator: &'a Manipulator,
    /// The pose to start from, and that the assemblies are sorted by.
    seed: Vec<f64>,
    /// Only assemblies in this mode.
    only: Option<Mode>,
    /// Every assembly, and not the one near the last.
    all: bool,
}

pub fn run(
    args: &FkArgs,
    input: &Path,
    output: &Output,
    (loaded, manipulator): (&Loaded, &Manipulator),
) -> Result<(), Failure> {
    let seed = match &args.near {
        Some(pose) => pose.resolve_for("--near", manipulator)?,
        None => manipulator.home_pose(),
    };
    let only = args.mode.as_deref().map(|mode| load::mode(manipulator, mode)).transpose()?;
    if let (true, Err(why)) = (args.all, manipulator.forward_method()) {
        let problem = format_args!(
            "no closed form of the forward kinematics: {why}; without --all, one assembly is found near the \
             row before"
        );
        return Err(Failure::flag("--all", problem));
    }
    let request = Request { loaded, manipulator, seed, only, all: args.all };
    let (target, columns) = (args.output.as_deref(), args.columns.as_ref());
    let streams = Streams { input, output: target, columns };
    let solve = |stream: Stream<'_>| request.solve(stream);
    let Some((summary, unmet)) = stream::run(&streams, output, loaded, solve)? else {
        return Ok(());
    };
    if let Some((line, joints)) = unmet
        && let Ok(Some(change)) = manipulator.least_change(&joints)
    {
        let lines = least::lines(manipulator, &change, loaded.file.units).join("; ");
        output.note(format_args!("line {line} is the first that has no assembly: {lines}"));
    }
    let assemblies = match args.all {
        true => format!(", {} assemblies", count(summary.assemblies)),
        false => String::new(),
    };
    output.note(format_args!(
        "{}: {} rows, {} in reach, {} within limits{assemblies}; {} s, {} rows/s",
        args.output.as_deref().unwrap_or(input).shown(),
        count(summary.rows),
        count(summary.reachable),
        count(summary.within_limits),
        short(summary.seconds),
        count(summary.rows_per_second as u64),
    ));
    if output.format == crate::args::Format::Json { output.print(&summary, "") } else { Ok(()) }
}

/// The line and the joints of the first row without an assembly, if there is one.
type Unassembled = Option<(u64, Vec<f64>)>;

impl Request<'_> {
    /// Solves all rows.
    fn solve(&self, mut stream: Stream<'_>) -> Result<(Summary, Unassembled), StreamStop> {
        let start = Instant::now();
        let m = self.manipulator;
        let actuated: Vec<_> = m.actuated().iter().map(|&i| &m.coordinates()[i]).collect();
        let joints: Vec<&str> = actuated.iter().map(|c| &*c.name).collect();
        let listed = joints.join(", ");
        // The other columns of a table that `opm ik` or `opm trajectory` wrote.
        let others = other_columns(m);
        let values = actuated.iter().map(|c| Wanted {
            name: &c.name,
            quantity: c.quantity,
            plausible: plausible(c.quantity, c.home, (self.loaded, m)),
            optional: false,
            offered: true,
        });
        let tasks = m.task_coordinates().iter().chain(m.dependent_coordinates());
        let tasks: Vec<&str> = tasks.map(|c| c.name).collect();
        let mut columns = stream.columns(values.collect(), |name| {
            let found = joints.iter().position(|joint| *joint == name);
            match found {
                Some(number) => Ok(Some(number)),
                None if tasks.contains(&name) || others.iter().any(|other| other == name) => {
                    Ok(None)
                }
                None => Err(format!("no joint {name:?}; the actuated joints are {listed}")),
            }
        })?;
        let missing = columns.missing();
        if !missing.is_empty() {
            let problem =
                format!("no column {}; the actuated joints are {listed}", missing.join(", "));
            return Err(stream::at(stream.label, columns.number, problem).into());
        }
        stream.rows.header(self.header(columns.timed(), &joints))?;

        let mode = self.only.unwrap_or(m.home_mode());
        let seed = m.displacement_in(&self.seed, mode);
        let seed = m.platform_at(&seed.map_err(|error| Failure::flag("--near", error))?);
        let mut tracker = Tracker::new(m, &self.seed, mode);
        let (mut reachable, mut within_limits, mut assemblies) = (0, 0, 0);
        let mut unmet = None;
        stream.each(&mut columns, &vec![0.0; joints.len()], |stream, line, time, joints| {
            let label = stream.label;
            let wrong = |error: &dyn std::error::Error| stream::at(label, line, error);
            let mut list: Vec<Assembly>;
            let found: &[Assembly] = if self.all {
                list = m.forward(joints).map_err(|error| wrong(&error))?.list;
                if let Some(only) = self.only {
                    m.keep_assemblies_in(&mut list, only);
                }
                m.sort_assemblies(&mut list, &seed);
                &list
            } else {
                let found = tracker.step(joints).map_err(|error| match error {
                    NearError::Start(error) => Failure::flag("--near", error),
                    error => wrong(&error),
                })?;
                found.map(std::slice::from_ref).unwrap_or_default()
            };
            reachable += u64::from(!found.is_empty());
            within_limits += u64::from(found.iter().any(|assembly| assembly.within_limits));
            assemblies += found.len() as u64;
            let row = stream.number.load(Ordering::Relaxed) + 1;
            for (number, assembly) in found.iter().enumerate() {
                self.write(&mut stream.rows, (row, number + 1), (time, joints), Some(assembly))?;
            }
            if found.is_empty() {
                unmet.get_or_insert_with(|| (line, joints.to_vec()));
                self.write(&mut stream.rows, (row, 0), (time, joints), None)?;
            }
            Ok(())
        })?;
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        let rows = stream.number.load(Ordering::Relaxed);
        let rows_per_second = rows as f64 / seconds;
        let summary =
            Summary { rows, reachable, within_limits, assemblies, seconds, rows_per_second };
        Ok((summary, unmet))
    }

    fn header<'n>(&'n self, timed: bool, joints: &[&'n str]) -> Vec<&'n str> {
        let m = self.manipulator;
        let mut header = Vec::new();
        header.extend(timed.then_some("t"));
        if self.all {
            header.extend(["row", "assembly"]);
        }
        header.extend(m.task_coordinates().iter().map(|c| c.name));
        header.extend(m.dependent_coordinates().iter().map(|c| c.name));
        header.extend(["mode", "reachable", "within_limits"]);
        header.extend(joints);
        header
    }

    /// Writes the row of an assembly. Where there is none, the cells of its pose are empty.
    fn write(
        &self,
        rows: &mut Rows<'_>,
        (row, number): (u64, usize),
        (time, joints): (Option<f64>, &[f64]),
        assembly: Option<&Assembly>,
    ) -> Result<(), StreamStop> {
        let m = self.manipulator;
        let numbers: &[u64] = if self.all { &[row, number as u64] } else { &[] };
        rows.numbers(time.as_slice())?;
        numbers.iter().try_for_each(|&number| rows.count(number))?;
        rows.known(assembly.map(|a| &*a.pose), m.task_coordinates().len())?;
        rows.known(assembly.map(|a| &*a.dependent), m.dependent_coordinates().len())?;
        rows.text(&assembly.map_or_else(String::new, |a| m.format_mode(a.mode)))?;
        rows.answer(assembly.is_some())?;
        rows.answer(assembly.is_some_and(|a| a.within_limits))?;
        rows.numbers(joints)?;
        Ok(rows.end()?)
    }
}
