//! Tables of poses as CSV, with cubic splines between the poses.
//!
//! The first line is a header: `t` and names of task coordinates, in any order. A coordinate that
//! is not named stays at home. Every other line is a pose in seconds, metres and radians, or in the
//! units that the header names (`x [mm]`). There are at least two lines, and times increase from line
//! to line, at equal or different steps. A table that has columns of joints is one that `opm` wrote: what it has beside
//! the time and the task coordinates follows from these, and is not read.
//!
//! A cubic spline ([`Spline`](super::Spline)) runs between the lines: position, velocity and acceleration are
//! continuous. [`Ends`] says how it starts and ends.
//!
//! Angles are unwrapped first: each angle is shifted by multiples of 2π to within π of the previous
//! line. A table that wraps around at ±π then continues and does not rotate back. An angle whose
//! full revolutions matter, because a helical joint follows it, is not unwrapped.
//!
//! A table may have places in SE(3) instead: columns `t,x,y,z,qx,qy,qz,qw`, metres and a unit quaternion, or lines of the TUM
//! benchmark (`t x y z qx qy qz qw` with blanks, without a header). Of the angles of an orientation, those nearest to the
//! previous line are taken.
//!
//! A table of somebody else may have other columns, other names and other times: [`TableOptions`] says which columns are
//! read, and whether times count from the first row.

use super::clock::Clock;
use super::columns::is_column;
use super::places::{Converted, as_poses};
use super::points::{through, wraps};
use super::{Ends, PlatformMotion};
use crate::manipulator::Manipulator;
use crate::mechanism::file::{FileErrors, FileUnits, Heading, LARGEST, Problem};
use crate::numeric::{Quantity, angle::near};
use crate::table::{
    ColumnNames, Line, Lines, Plausible, Suggestion, hint, hint_of_row, not_commas,
};
use crate::text::quoted;
use std::path::Path;

/// The largest number of problems that are listed one by one. A file with more of them is probably
/// not a table of poses.
const MOST_PROBLEMS: usize = 100;

/// How a table of poses is read.
#[derive(Clone, Copy, Debug)]
pub struct TableOptions<'a> {
    /// How the spline starts and ends.
    pub ends: Ends,
    /// Which columns are read; `None` for all of them, by their own names.
    pub columns: Option<&'a ColumnNames>,
    /// Whether times count from that of the first row.
    pub relative_time: bool,
    /// The units of the mechanism's file, which a doubtful number was probably meant in.
    pub units: FileUnits,
    /// How the caller's user asks for other columns and other times.
    pub advice: Advice,
}

/// How the user of a caller asks for something else, in that caller's words.
#[derive(Clone, Copy, Debug)]
pub struct Advice {
    /// How columns are chosen, with a suggestion; an empty text if they cannot be.
    pub columns: fn(&Suggestion) -> String,
    /// What counts times from the first row; empty if nothing does.
    pub relative_time: &'static str,
}

impl Default for TableOptions<'_> {
    /// All columns, by their own names, and nothing to ask for.
    fn default() -> Self {
        let advice = Advice { columns: |_| String::new(), relative_time: "" };
        let (ends, units) = (Ends::default(), FileUnits::SI);
        Self { ends, columns: None, relative_time: false, units, advice }
    }
}

/// A table of poses that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct PoseTable {
    /// The motion through its poses.
    pub motion: PlatformMotion,
    /// The columns without a unit whose numbers look as if they were meant in another one: the line of the first such
    /// number, and what to say.
    pub doubts: Vec<(u64, String)>,
}

/// Whether a file of this name is a table of poses, or of places: `.csv`, and `.tum` and `.txt` for those of the TUM benchmark.
pub fn is_table(name: &Path) -> bool {
    let endings = ["csv", "tum", "txt"];
    let ending = name.extension();
    ending.is_some_and(|ending| endings.iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// Reads the text of a table of poses, in the task coordinates of `manipulator`. The motion gets
/// the name `name`.
///
/// # Errors
/// [`FileErrors`] lists every problem of the table with its location; beyond the first hundred,
/// only their number.
pub fn read(
    text: &str,
    name: &str,
    manipulator: &Manipulator,
    options: &TableOptions<'_>,
) -> Result<PoseTable, FileErrors> {
    if let Some(Converted { text, before }) = as_poses(text, manipulator, options)? {
        // It has all columns, by their own names.
        let options = TableOptions { columns: None, ..*options };
        return read(&text, name, manipulator, &options).map_err(|mut errors| {
            for problem in &mut errors.problems {
                problem.line -= (before as usize).min(problem.line - 1);
            }
            errors
        });
    }
    let mut problems = Problems::default();
    let table = read_table(text, Given { name, options }, manipulator, &mut problems);
    match table {
        Some(table) if problems.list.is_empty() => Ok(table),
        _ => Err(problems.into_errors()),
    }
}

/// The problems of a table that were found so far.
#[derive(Default)]
struct Problems {
    /// The first problems, up to [`MOST_PROBLEMS`].
    list: Vec<Problem>,
    /// The number of further problems.
    more: usize,
}

impl Problems {
    fn report(&mut self, line: usize, column: usize, message: impl Into<String>) {
        if self.list.len() < MOST_PROBLEMS {
            self.list.push(Problem { line, column, message: message.into() });
        } else {
            self.more += 1;
        }
    }

    fn into_errors(mut self) -> FileErrors {
        if self.more > 0 {
            let problems = if self.more == 1 { "problem" } else { "problems" };
            let last = self.list.last().map_or(1, |problem| problem.line);
            let message = format!("and {} more {problems} from here on", self.more);
            self.list.push(Problem { line: last, column: 1, message });
        }
        FileErrors::new(self.list)
    }
}

/// What a table of poses does not have in its text.
#[derive(Clone, Copy)]
struct Given<'a> {
    /// The name of the motion.
    name: &'a str,
    options: &'a TableOptions<'a>,
}

fn read_table(
    text: &str,
    given: Given<'_>,
    manipulator: &Manipulator,
    problems: &mut Problems,
) -> Option<PoseTable> {
    let Given { name, options } = given;
    let mut lines = Lines::new(Box::new(text.as_bytes()));
    // Text in memory can be read; a line may be too long.
    let mut next = |problems: &mut Problems,
                    last: usize,
                    take: &mut dyn FnMut(Line<'_>, &mut Problems) -> bool| {
        match lines.next() {
            Ok(Some(line)) => take(line, problems),
            Ok(None) => false,
            Err(error) => {
                problems.report(last + 1, 1, error.to_string());
                false
            }
        }
    };
    let mut columns = None;
    let mut header = None;
    next(problems, 0, &mut |line, problems| {
        header = Some(line.number as usize);
        columns = Header { line, manipulator, options }.columns(problems);
        true
    });
    let Some(number) = header else {
        if problems.list.is_empty() {
            let expected = expected(manipulator);
            problems.report(1, 1, format!("the file is empty, {expected}"));
        }
        return None;
    };
    let columns = columns?;
    let mut rows = Rows::new(&columns, manipulator, options);
    let mut last = number;
    while next(problems, last, &mut |line, problems| {
        last = line.number as usize;
        rows.take(line, problems)
    }) {}
    let Rows { times, mut values, doubts, .. } = rows;
    if !problems.list.is_empty() {
        return None;
    }
    for (coordinate, values) in manipulator.task_coordinates().iter().zip(&mut values) {
        if wraps(manipulator, coordinate) {
            unwrap(values);
        }
    }
    let units = |number: usize| {
        let column = columns.iter().find(|column| column.holds == Holds::Coordinate(number));
        column.and_then(|column| column.units).unwrap_or(FileUnits::SI)
    };
    let motion = through(name, times, values, options.ends, manipulator, units);
    let motion = motion.map_err(|error| problems.report(last, 1, error.to_string())).ok()?;
    Some(PoseTable { motion, doubts: doubts.into_iter().flatten().collect() })
}

/// What a header is expected to be.
fn expected(manipulator: &Manipulator) -> String {
    let names: Vec<_> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
    format!("expected a header of t and of task coordinates ({})", names.join(", "))
}

/// What a column holds, and the units of its values if its heading names any.
#[derive(Clone, Copy)]
struct Column {
    holds: Holds,
    quantity: Quantity,
    units: Option<FileUnits>,
}

#[derive(Clone, Copy, PartialEq)]
enum Holds {
    Time,
    /// The task coordinate with this index.
    Coordinate(usize),
    /// What follows from the pose or was not asked for, and is not read.
    Other,
}

fn is_joint(name: &str, manipulator: &Manipulator) -> bool {
    manipulator.coordinates().iter().any(|c| c.name == name)
        || manipulator.imaginary().iter().any(|joint| joint.name == name)
}

/// Whether a name is that of a column that `opm` writes beside t and the coordinates of a pose.
fn follows(name: &str, manipulator: &Manipulator) -> bool {
    is_column(name) || is_joint(name, manipulator) || manipulator.refuse_following(name).is_err()
}

/// The first line of a table.
#[derive(Clone, Copy)]
struct Header<'a> {
    line: Line<'a>,
    manipulator: &'a Manipulator,
    options: &'a TableOptions<'a>,
}

impl Header<'_> {
    /// What the columns hold; `None` with a problem.
    fn columns(&self, problems: &mut Problems) -> Option<Vec<Column>> {
        let Self { line, manipulator, options } = *self;
        let number = line.number as usize;
        if let Some(problem) = not_commas(line) {
            problems.report(number, 1, problem);
            return None;
        }
        let cells: Vec<_> = line.fields().map(String::from_utf8_lossy).collect();
        let cells: Vec<&str> = cells.iter().map(|cell| &**cell).collect();
        if cells.iter().all(|cell| cell.parse::<f64>().is_ok()) {
            problems.report(number, 1, format!("no header, {}", expected(manipulator)));
            return None;
        }
        if let Some((name, heading)) = options.columns.and_then(|c| c.missing(&cells)) {
            let headings =
                cells.iter().map(|cell| quoted(cell).to_string()).collect::<Vec<_>>().join(", ");
            let problem = format!("no column {heading:?} for {name}, the table has {headings}");
            problems.report(number, 1, problem);
            return None;
        }
        // With columns of joints it is a table that `opm` wrote, with what follows from the poses beside them.
        let written = cells.iter().any(|cell| is_joint(Heading::parse(cell).name, manipulator));
        let (mut columns, mut unknown) = (Vec::new(), Vec::new());
        for (field, cell) in cells.iter().enumerate() {
            let at = line.column(field);
            let mut heading = Heading::parse(cell);
            let named = options.columns.map(|columns| columns.name_of(heading, cell)).transpose();
            let named = match named {
                Ok(named) => named,
                Err(problem) => {
                    problems.report(number, at, format!("{}: {problem}", quoted(cell)));
                    continue;
                }
            };
            if let Some(Some(name)) = named {
                heading.name = name;
            }
            match self.column(heading, named.is_some_and(|name| name.is_none()), written) {
                Ok(Some(column)) => {
                    let twice = |other: &Column| other.holds == column.holds;
                    if column.holds != Holds::Other && columns.iter().any(twice) {
                        let name = heading.name;
                        let expected = expected(manipulator);
                        let problem = format!("two columns are called {name}, {expected}");
                        problems.report(number, at, problem);
                    }
                    columns.push(column);
                }
                Ok(None) => unknown.push((at, *cell)),
                Err(problem) => problems.report(number, at, problem),
            }
        }
        let known = |holds| columns.iter().any(|column| column.holds == holds);
        let first = unknown.first().map(|(at, _)| *at);
        let what = match first {
            Some(_) => {
                let names: Vec<_> =
                    unknown.iter().map(|(_, cell)| quoted(cell).to_string()).collect();
                format!("no coordinate {}", names.join(", "))
            }
            None if !known(Holds::Time) && problems.list.is_empty() => "no column t".to_owned(),
            None => String::new(),
        };
        if !what.is_empty() {
            let names = manipulator.task_coordinates().iter().map(|c| c.name);
            let suggestion = Suggestion::new(["t"].into_iter().chain(names), &cells);
            let advice = (options.advice.columns)(&suggestion);
            let problem = format!("{what}, {}{advice}", expected(manipulator));
            problems.report(number, first.unwrap_or(1), problem);
        }
        problems.list.is_empty().then_some(columns)
    }

    /// What a column holds; `None` if its name is unknown.
    fn column(
        &self,
        heading: Heading<'_>,
        passed_over: bool,
        written: bool,
    ) -> Result<Option<Column>, String> {
        let coordinates = self.manipulator.task_coordinates();
        let other = Column { holds: Holds::Other, quantity: Quantity::Length, units: None };
        if passed_over {
            return Ok(Some(other));
        }
        let found = coordinates.iter().position(|c| c.name == heading.name);
        match (found, heading.name, heading.unit) {
            (Some(number), ..) => {
                let quantity = coordinates[number].quantity;
                let units = heading.units(quantity)?;
                Ok(Some(Column { holds: Holds::Coordinate(number), quantity, units }))
            }
            (None, "t", None | Some("s")) => Ok(Some(Column { holds: Holds::Time, ..other })),
            (None, "t", Some(unit)) => Err(format!("\"t [{unit}]\", expected t or t [s]")),
            (None, name, _) if written && follows(name, self.manipulator) => Ok(Some(other)),
            (None, name, _) => match self.manipulator.refuse_following(name) {
                Err(follows) => Err(follows.to_string()),
                Ok(()) => Ok(None),
            },
        }
    }
}

/// The rows of a table that were read so far.
struct Rows<'a> {
    columns: &'a [Column],
    clock: Clock<'a>,
    times: Vec<f64>,
    /// A column for each task coordinate; empty if it is not in the table.
    values: Vec<Vec<f64>>,
    /// For each column, what its values should look like if it names no unit, and by which name.
    plausible: Vec<Option<(&'static str, Plausible)>>,
    /// For each column, the doubt about it.
    doubts: Vec<Option<(u64, String)>>,
}

impl<'a> Rows<'a> {
    fn new(columns: &'a [Column], manipulator: &Manipulator, options: &TableOptions<'a>) -> Self {
        let coordinates = manipulator.task_coordinates();
        let size = manipulator.characteristic_length();
        let plausible = |column: &Column| match (column.holds, column.units) {
            (Holds::Coordinate(number), None) => {
                let c = &coordinates[number];
                Some((c.name, Plausible::new(c.quantity, c.home, size, options.units)))
            }
            (Holds::Coordinate(_), Some(_)) | (Holds::Time | Holds::Other, _) => None,
        };
        Self {
            columns,
            clock: Clock::new(options.relative_time, options.advice.relative_time),
            times: Vec::new(),
            values: vec![Vec::new(); coordinates.len()],
            plausible: columns.iter().map(plausible).collect(),
            doubts: vec![None; columns.len()],
        }
    }

    /// Reads a row. Returns whether it makes sense to read on: a table that is none of plain numbers tells the same of every
    /// row.
    fn take(&mut self, line: Line<'_>, problems: &mut Problems) -> bool {
        let number = line.number as usize;
        let first = problems.list.is_empty();
        let (given, expected) = (line.fields().len(), self.columns.len());
        if given != expected {
            let cells = if given == 1 { "cell" } else { "cells" };
            let hint = hint_of_row(line, expected);
            let problem = format!("{given} {cells}, expected {expected} as in the header{hint}");
            problems.report(number, 1, problem);
            return hint.is_empty() || !first;
        }
        for (field, (cell, column)) in line.fields().zip(self.columns).enumerate() {
            if column.holds == Holds::Other {
                continue;
            }
            let at = line.column(field);
            let cell = String::from_utf8_lossy(cell);
            let value: f64 = cell.parse().unwrap_or(f64::NAN);
            let time = column.holds == Holds::Time;
            if value.is_nan() || value.abs() > LARGEST && !time {
                let hint = hint(&cell);
                let expected = format!("expected a finite number of at most {LARGEST:e}{hint}");
                problems.report(number, at, format!("{}, {expected}", quoted(&cell)));
                if time && first && !hint.is_empty() {
                    return false;
                }
                continue;
            }
            match column.holds {
                Holds::Coordinate(coordinate) => {
                    if let Some((name, plausible)) = &self.plausible[field]
                        && self.doubts[field].is_none()
                        && !plausible.holds(value)
                    {
                        self.doubts[field] = Some((line.number, plausible.column(name, value)));
                    }
                    let units = column.units.unwrap_or(FileUnits::SI);
                    self.values[coordinate].push(units.si(value, column.quantity));
                }
                Holds::Other => {}
                Holds::Time => match self.clock.seconds(&cell, value) {
                    Ok(time) => {
                        if let Some(&before) = self.times.last()
                            && time <= before
                        {
                            let problem =
                                format!("t is {time} after {before}, expected a later time");
                            problems.report(number, at, problem);
                        }
                        self.times.push(time);
                    }
                    Err(problem) => {
                        problems.report(number, at, problem);
                        return !first;
                    }
                },
            }
        }
        true
    }
}

/// Shifts every angle by multiples of 2π to within π of the previous one.
fn unwrap(angles: &mut [f64]) {
    for i in 1..angles.len() {
        angles[i] = near(angles[i], angles[i - 1]);
    }
}
