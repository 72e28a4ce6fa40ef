//! `opm ik --poses`: a CSV file of poses in, one of joint values out, row by row.

use crate::args::{Format, IkArgs, Output};
use crate::failure::Failure;
use crate::lines::{Line, Lines};
use crate::load::Loaded;
use crate::pose::find;
use crate::progress::{interruptible, watch};
use crate::text::{count, plural, short};
use csv::{ErrorKind, WriterBuilder};
use opm_core::manipulator::{ActuatedJoints, AllModes, Manipulator, Mode, PoseError, Solution};
use opm_mcap::{PartialFile, Sink};
use opm_workspace::Progress;
use serde::Serialize;
use std::fmt::Display;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The requested working modes.
#[derive(Clone, Copy)]
pub enum Modes {
    All,
    One(Mode),
}

/// Number of bytes that are written at a time.
const BUFFER: usize = 1 << 16;

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
    args: &IkArgs,
    output: &Output,
    loaded: &Loaded,
    manipulator: &Manipulator,
    modes: Modes,
) -> Result<(), Failure> {
    let dash = Path::new("-");
    let input = args.poses.as_deref().unwrap_or(dash);
    let target = args.output.as_deref().filter(|path| *path != dash);
    if output.format == Format::Json && target.is_none() {
        let problem = "the CSV takes standard output; give it a file with --output";
        return Err(Failure::flag("--format json", problem));
    }
    let (label, reader): (_, Box<dyn Read + Send>) = if input == dash {
        ("standard input".to_owned(), Box::new(io::stdin()))
    } else {
        let label = input.display().to_string();
        let file = File::open(input).map_err(|error| Failure::at(&label, error))?;
        (label, Box::new(file))
    };
    let batch = Batch { label: &label, manipulator, modes };
    let progress = interruptible()?;
    let rows = AtomicU64::new(0);

    let Some(path) = target else {
        // There is no progress bar, since the rows may go to the terminal.
        return batch.solve(reader, io::stdout().lock(), &rows, &progress).map(|_| ()).map_err(
            |error| match error {
                Stop::Write(error) => Failure::stdout(error),
                Stop::Failure(failure) => failure,
            },
        );
    };
    loaded.refuse_as_output(path, &[input])?;
    let place = path.display();
    let mut file = PartialFile::create(path).map_err(|error| Failure::at(&place, error))?;
    let solve = || batch.solve(reader, &mut file, &rows, &progress);
    let summary =
        match watch(output, "solving", None, || rows.load(Ordering::Relaxed), solve) {
            Ok(summary) => summary,
            Err(Stop::Failure(Failure::Interrupted(message))) => {
                return Err(Failure::Interrupted(message.reworded(|message| {
                    format!("{message}; what was solved is in {place}.partial")
                })));
            }
            Err(stop) => {
                // The file is discarded: the rows before a wrong one would look like the whole answer.
                file.discard();
                return Err(match stop {
                    Stop::Write(error) => Failure::at(&place, error),
                    Stop::Failure(failure) => failure,
                });
            }
        };
    file.commit().map_err(|error| Failure::at(&place, error))?;
    output.note(format_args!(
        "{place}: {} poses, {} in reach, {} within limits; {} s, {} poses/s",
        count(summary.poses),
        count(summary.reachable),
        count(summary.within_limits),
        short(summary.seconds),
        count(summary.poses_per_second as u64),
    ));
    if output.format == Format::Json { output.print(&summary, "") } else { Ok(()) }
}

/// Why a batch ends early.
enum Stop {
    Write(io::Error),
    Failure(Failure),
}

impl From<Failure> for Stop {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl From<csv::Error> for Stop {
    fn from(error: csv::Error) -> Self {
        Self::Write(match error.into_kind() {
            ErrorKind::Io(error) => error,
            other => io::Error::other(format!("{other:?}")),
        })
    }
}

/// What is in a column of the input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    /// A time, which is carried through.
    Time,
    /// The task coordinate of this number.
    Coordinate(usize),
}

struct Batch<'a> {
    /// The name of the input in messages.
    label: &'a str,
    manipulator: &'a Manipulator,
    modes: Modes,
}

impl Batch<'_> {
    fn solve(
        &self,
        input: impl Read,
        output: impl Write,
        rows: &AtomicU64,
        progress: &Progress,
    ) -> Result<Summary, Stop> {
        let start = Instant::now();
        let mut lines = Lines::new(input);
        let columns = self.columns(lines.next().map_err(|error| self.unreadable(error))?)?;
        let timed = columns.contains(&Column::Time);
        let writer =
            WriterBuilder::new().has_headers(false).buffer_capacity(BUFFER).from_writer(output);
        let mut table = Rows::new(self.manipulator, timed, writer)?;

        let mut pose = self.manipulator.home_pose();
        while let Some(line) = lines.next().map_err(|error| self.unreadable(error))? {
            if progress.is_cancelled() {
                return Err(Failure::interrupted("interrupted").into());
            }
            table.time = self.read(line, &columns, &mut pose)?;
            table.pose(&pose, self.modes, |error| self.at(line.number, error))?;
            rows.fetch_add(1, Ordering::Relaxed);
        }
        table.writer.flush().map_err(Stop::Write)?;
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        let poses = rows.load(Ordering::Relaxed);
        Ok(Summary {
            poses,
            reachable: table.reachable,
            within_limits: table.within_limits,
            seconds,
            poses_per_second: poses as f64 / seconds,
        })
    }

    /// What is in every column.
    fn columns(&self, header: Option<Line<'_>>) -> Result<Vec<Column>, Failure> {
        let coordinates = self.manipulator.task_coordinates();
        let number = header.map_or(1, |line| line.number);
        let names: Vec<_> =
            header.iter().flat_map(|h| h.fields()).map(String::from_utf8_lossy).collect();
        if names.iter().all(|name| name.parse::<f64>().is_ok()) {
            let expected = coordinates.iter().map(|c| c.name).collect::<Vec<_>>().join(",");
            let problem = format!("no header, expected names of task coordinates: {expected}");
            return Err(self.at(number, problem));
        }
        let mut columns = Vec::new();
        for name in &names {
            let wrong =
                |error: &dyn Display| self.at(number, format_args!("column {name:?}: {error}"));
            self.manipulator.refuse_following(name).map_err(|error| wrong(&error))?;
            let column = match &**name {
                "t" => Column::Time,
                name => Column::Coordinate(find(name, coordinates).map_err(|error| wrong(&error))?),
            };
            if columns.contains(&column) {
                return Err(self.at(number, format_args!("column {name:?}: given twice")));
            }
            columns.push(column);
        }
        Ok(columns)
    }

    /// Reads a row into the columns of a pose, and returns its time if it has one.
    fn read(
        &self,
        line: Line<'_>,
        columns: &[Column],
        pose: &mut [f64],
    ) -> Result<Option<f64>, Failure> {
        let name = |column: Column| match column {
            Column::Time => "t",
            Column::Coordinate(number) => self.manipulator.task_coordinates()[number].name,
        };
        let given = line.fields().count();
        if given != columns.len() {
            let names: Vec<_> = columns.iter().map(|&column| name(column)).collect();
            let given = plural(given as u64, "column");
            let (expected, names) = (columns.len(), names.join(","));
            let problem = format_args!("{given}, expected {expected}: {names}");
            return Err(self.at(line.number, problem));
        }
        let mut time = None;
        for (field, &column) in line.fields().zip(columns) {
            let wrong = |problem: &str| {
                let (name, field) = (name(column), String::from_utf8_lossy(field));
                self.at(line.number, format_args!("column {name}: {field:?} {problem}"))
            };
            let number = std::str::from_utf8(field).ok().and_then(|text| text.parse().ok());
            let number: f64 = number.ok_or_else(|| wrong("is not a number"))?;
            if !number.is_finite() {
                return Err(wrong("is not a finite number"));
            }
            match column {
                Column::Time => time = Some(number),
                Column::Coordinate(column) => pose[column] = number,
            }
        }
        Ok(time)
    }

    fn unreadable(&self, error: io::Error) -> Failure {
        Failure::at(self.label, error)
    }

    fn at(&self, line: u64, problem: impl Display) -> Failure {
        Failure::work(format!("{}:{line}: {problem}", self.label))
    }
}

/// The rows of the result.
struct Rows<'a, W: Write> {
    manipulator: &'a Manipulator,
    writer: csv::Writer<W>,
    drives: ActuatedJoints,
    all: AllModes,
    solution: Solution,
    /// The time of the pose, if the input has times.
    time: Option<f64>,
    /// Imaginary joints, then actuated joints; empty if the pose is out of reach.
    cells: Vec<Option<f64>>,
    /// Dependent coordinates; empty if they have no solution.
    dependent: Vec<Option<f64>>,
    reachable: u64,
    within_limits: u64,
}

impl<'a, W: Write> Rows<'a, W> {
    fn new(
        manipulator: &'a Manipulator,
        timed: bool,
        mut writer: csv::Writer<W>,
    ) -> Result<Self, Stop> {
        let coordinates = manipulator.coordinates();
        let header: Vec<&str> = (timed.then_some("t").into_iter())
            .chain(manipulator.task_coordinates().iter().map(|c| c.name))
            .chain(manipulator.dependent_coordinates().iter().map(|c| c.name))
            .chain(["reachable", "within_limits", "mode"])
            .chain(manipulator.imaginary().iter().map(|joint| &*joint.name))
            .chain(manipulator.actuated().iter().map(|&i| &*coordinates[i].name))
            .collect();
        writer.write_record(header)?;
        Ok(Self {
            manipulator,
            writer,
            drives: manipulator.actuated_joints(),
            all: manipulator.all_modes(),
            solution: manipulator.solution(),
            time: None,
            cells: Vec::new(),
            dependent: Vec::new(),
            reachable: 0,
            within_limits: 0,
        })
    }

    /// Writes the row of a pose; with all modes, one row for each mode that reaches it.
    fn pose(
        &mut self,
        pose: &[f64],
        modes: Modes,
        wrong: impl Fn(PoseError) -> Failure,
    ) -> Result<(), Stop> {
        let manipulator = self.manipulator;
        match modes {
            Modes::One(mode) => {
                let found =
                    manipulator.inverse_actuated(pose, mode, &mut self.drives).map_err(wrong)?;
                let reachable = found.is_some();
                let within = found.is_some_and(ActuatedJoints::within_limits);
                let joints = self.drives.imaginary().iter().chain(self.drives.actuated());
                fill(&mut self.cells, joints.copied(), reachable);
                self.reachable += u64::from(reachable);
                self.within_limits += u64::from(within);
                let dependent = manipulator.dependent_values(pose, mode).ok().flatten();
                self.depend(dependent.as_deref());
                self.write(pose, reachable, within, &manipulator.format_mode(mode))
            }
            Modes::All => {
                let found = manipulator.inverse_all(pose, &mut self.all).map_err(wrong)?;
                let reachable = found.is_some();
                self.reachable += u64::from(reachable);
                if !reachable {
                    let joints = self.drives.imaginary().iter().chain(self.drives.actuated());
                    fill(&mut self.cells, joints.copied(), false);
                    self.depend(None);
                    return self.write(pose, false, false, "");
                }
                let mut any_within = false;
                let found: Vec<_> = self.all.modes(manipulator).collect();
                for mode in found {
                    let solution =
                        manipulator.solution_in_mode(&self.all, mode, &mut self.solution);
                    let Some(solution) = solution else { continue };
                    let actuated = manipulator.actuated().iter().map(|&i| solution.joints()[i]);
                    let joints = solution.imaginary().iter().copied().chain(actuated);
                    fill(&mut self.cells, joints, true);
                    self.dependent.clear();
                    self.dependent.extend(solution.dependent().iter().map(|&value| Some(value)));
                    let within = solution.within_limits();
                    any_within |= within;
                    self.write(pose, true, within, &manipulator.format_mode(mode))?;
                }
                self.within_limits += u64::from(any_within);
                Ok(())
            }
        }
    }

    /// Takes the values of the dependent coordinates, if they have some.
    fn depend(&mut self, values: Option<&[f64]>) {
        let count = self.manipulator.dependent_coordinates().len();
        self.dependent.clear();
        self.dependent.extend((0..count).map(|i| values.map(|values| values[i])));
    }

    fn write(
        &mut self,
        pose: &[f64],
        reachable: bool,
        within_limits: bool,
        mode: &str,
    ) -> Result<(), Stop> {
        let (reachable, within_limits) = (u8::from(reachable), u8::from(within_limits));
        let time: &[f64] = self.time.as_slice();
        let row = (time, pose, &*self.dependent, reachable, within_limits, mode, &*self.cells);
        Ok(self.writer.serialize(row)?)
    }
}

fn fill(cells: &mut Vec<Option<f64>>, joints: impl Iterator<Item = f64>, reachable: bool) {
    cells.clear();
    cells.extend(joints.map(|value| reachable.then_some(value)));
}
