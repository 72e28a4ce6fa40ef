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

use super::columns::is_column;
use super::points::{through, wraps};
use super::{Ends, PlatformMotion};
use crate::manipulator::Manipulator;
use crate::mechanism::file::{FileErrors, FileUnits, Heading, LARGEST, Problem};
use crate::numeric::{Quantity, angle::near};

/// The largest number of problems that are listed one by one. A file with more of them is probably
/// not a table of poses.
const MOST_PROBLEMS: usize = 100;

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
    ends: Ends,
) -> Result<PlatformMotion, FileErrors> {
    let mut problems = Problems::default();
    let motion = read_table(text, Given { name, ends }, manipulator, &mut problems);
    match motion {
        Some(motion) if problems.list.is_empty() => Ok(motion),
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
        FileErrors { problems: self.list }
    }
}

/// The cells of a line with their columns, counted in characters from 1.
fn cells(line: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut column = 1;
    line.split(',').map(move |cell| {
        let blank = cell.chars().take_while(|c| c.is_whitespace()).count();
        let at = column + blank;
        column += cell.chars().count() + 1;
        let text = cell.trim();
        let quoted = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"'));
        (at, quoted.map_or(text, str::trim))
    })
}

/// What a table of poses does not have in its text.
struct Given<'a> {
    /// The name of the motion.
    name: &'a str,
    ends: Ends,
}

fn read_table(
    text: &str,
    Given { name, ends }: Given<'_>,
    manipulator: &Manipulator,
    problems: &mut Problems,
) -> Option<PlatformMotion> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let lines = text.lines().enumerate().map(|(number, line)| (number + 1, line));
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let expected = || {
        let names: Vec<_> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
        format!("expected a header of t and of task coordinates ({})", names.join(", "))
    };
    let Some((number, header)) = lines.next() else {
        problems.report(1, 1, format!("the file is empty, {}", expected()));
        return None;
    };
    let columns = read_header(number, header, manipulator, problems, &expected)?;

    let mut times: Vec<f64> = Vec::new();
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); manipulator.task_coordinates().len()];
    let mut last = number;
    for (number, line) in lines {
        last = number;
        read_row(Row { number, line, columns: &columns }, &mut times, &mut values, problems);
    }
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
        column.map_or(FileUnits::SI, |column| column.units)
    };
    let motion = through(name, times, values, ends, manipulator, units);
    motion.map_err(|error| problems.report(last, 1, error.to_string())).ok()
}

/// What a column holds, and the units of its values.
#[derive(Clone, Copy)]
struct Column {
    holds: Holds,
    quantity: Quantity,
    units: FileUnits,
}

#[derive(Clone, Copy, PartialEq)]
enum Holds {
    Time,
    /// The task coordinate with this index.
    Coordinate(usize),
    /// What follows from the pose, and is not read.
    Other,
}

/// Whether a table has columns of joints: then `opm` wrote it, with what follows from the poses beside them.
fn has_joints(header: &str, manipulator: &Manipulator) -> bool {
    cells(header).any(|(_, cell)| is_joint(Heading::parse(cell).name, manipulator))
}

fn is_joint(name: &str, manipulator: &Manipulator) -> bool {
    manipulator.coordinates().iter().any(|c| c.name == name)
        || manipulator.imaginary().iter().any(|joint| joint.name == name)
}

/// Whether a name is that of a column that `opm` writes beside t and the coordinates of a pose.
fn follows(name: &str, manipulator: &Manipulator) -> bool {
    is_column(name) || is_joint(name, manipulator) || manipulator.refuse_following(name).is_err()
}

fn read_header(
    number: usize,
    header: &str,
    manipulator: &Manipulator,
    problems: &mut Problems,
    expected: &dyn Fn() -> String,
) -> Option<Vec<Column>> {
    let coordinates = manipulator.task_coordinates();
    let written = has_joints(header, manipulator);
    let mut columns: Vec<Column> = Vec::new();
    for (at, cell) in cells(header) {
        let heading = Heading::parse(cell);
        let found = coordinates.iter().position(|c| c.name == heading.name);
        let (holds, quantity) = match (found, heading.name, heading.unit) {
            (Some(number), ..) => (Holds::Coordinate(number), coordinates[number].quantity),
            (None, "t", None | Some("s")) => (Holds::Time, Quantity::Length),
            (None, name, _) if name != "t" && written && follows(name, manipulator) => {
                (Holds::Other, Quantity::Length)
            }
            (None, name, _) => {
                let problem = match (name, manipulator.refuse_following(name)) {
                    ("t", _) => format!("{cell:?}, expected t or t [s]"),
                    (name, Ok(())) => format!("no coordinate {name:?}, {}", expected()),
                    (_, Err(follows)) => follows.to_string(),
                };
                problems.report(number, at, problem);
                continue;
            }
        };
        let units = match holds {
            Holds::Coordinate(_) => heading.units(quantity).map(Option::unwrap_or_default),
            Holds::Time | Holds::Other => Ok(FileUnits::SI),
        };
        let units = units.unwrap_or_else(|problem| {
            problems.report(number, at, problem);
            FileUnits::SI
        });
        if holds != Holds::Other && columns.iter().any(|column| column.holds == holds) {
            let problem = format!("two columns are called {}, {}", heading.name, expected());
            problems.report(number, at, problem);
        }
        columns.push(Column { holds, quantity, units });
    }
    if columns.iter().all(|column| column.holds != Holds::Time) && problems.list.is_empty() {
        problems.report(number, 1, format!("no column t, {}", expected()));
    }
    problems.list.is_empty().then_some(columns)
}

/// A line of the table, with the meaning of its columns.
#[derive(Clone, Copy)]
struct Row<'a> {
    number: usize,
    line: &'a str,
    columns: &'a [Column],
}

fn read_row(row: Row<'_>, times: &mut Vec<f64>, values: &mut [Vec<f64>], problems: &mut Problems) {
    let Row { number, line, columns } = row;
    let mut found = 0;
    for (at, cell) in cells(line) {
        let Some(column) = columns.get(found) else {
            found += 1;
            continue;
        };
        found += 1;
        if column.holds == Holds::Other {
            continue;
        }
        let value: f64 = cell.parse().unwrap_or(f64::NAN);
        if value.is_nan() || value.abs() > LARGEST {
            let expected = format!("expected a finite number of at most {LARGEST:e}");
            problems.report(number, at, format!("{cell:?}, {expected}"));
            continue;
        }
        match column.holds {
            Holds::Coordinate(coordinate) => {
                values[coordinate].push(column.units.si(value, column.quantity));
            }
            Holds::Other => {}
            Holds::Time => {
                if let Some(&before) = times.last()
                    && value <= before
                {
                    let problem = format!("t is {value} after {before}, expected a later time");
                    problems.report(number, at, problem);
                }
                times.push(value);
            }
        }
    }
    if found != columns.len() {
        let (cells, expected) = (if found == 1 { "cell" } else { "cells" }, columns.len());
        let problem = format!("{found} {cells}, expected {expected} as in the header");
        problems.report(number, 1, problem);
    }
}

/// Shifts every angle by multiples of 2π to within π of the previous one.
fn unwrap(angles: &mut [f64]) {
    for i in 1..angles.len() {
        angles[i] = near(angles[i], angles[i - 1]);
    }
}
