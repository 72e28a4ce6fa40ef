//! Tables of places: where the platform is in SE(3), as `t,x,y,z,qx,qy,qz,qw`, or in the form of the TUM benchmark.

use super::table::TableOptions;
use crate::manipulator::{Manipulator, place};
use crate::mechanism::file::{FileErrors, FileUnits, Heading, Problem};
use crate::numeric::Quantity;
use crate::table::{Line, Lines, tum};
use crate::text::quoted;
use std::io::{Cursor, Read};

/// What a place consists of, in the order of [`crate::manipulator::PLACE`].
const NAMES: [&str; 7] = ["x", "y", "z", "qw", "qx", "qy", "qz"];

/// A table of places as one of poses.
pub(super) struct Converted {
    /// A header of `t` and the task coordinates, and a line for each place, on its line of the file.
    pub text: String,
    /// The number of lines before the first one of the file.
    pub before: u64,
}

/// The table as one of poses, if it is one of places: the header names a quaternion, or there is none and each line has the
/// eight numbers of TUM. `None` for any other table.
///
/// # Errors
/// The first line that is no place, or a place that the platform does not have.
pub(super) fn as_poses(
    text: &str,
    manipulator: &Manipulator,
    options: &TableOptions<'_>,
) -> Result<Option<Converted>, FileErrors> {
    let wrong = |line: u64, column: usize, message: String| {
        FileErrors::new(vec![Problem { line: line as usize, column, message }])
    };
    let io = |error: std::io::Error| wrong(1, 1, error.to_string());
    let (mut table, before) = tum::as_csv(Box::new(Cursor::new(text.to_owned()))).map_err(io)?;
    let mut csv = String::new();
    if table.read_to_string(&mut csv).is_err() {
        return Ok(None);
    }
    let mut lines = Lines::new(Box::new(csv.as_bytes()));
    let header = match lines.next() {
        Ok(Some(header)) => match Header::of(header, options) {
            None => return Ok(None),
            Some(found) => {
                found.map_err(|(at, problem)| wrong(header.number - before, at, problem))?
            }
        },
        _ => return Ok(None),
    };
    let names = manipulator.task_coordinates().iter().map(|c| c.name);
    let mut text = ["t"].into_iter().chain(names).collect::<Vec<_>>().join(",") + "\n";
    let (mut written, mut last) = (1, None);
    loop {
        let line = match lines.next() {
            Ok(Some(line)) => line,
            Ok(None) => return Ok(Some(Converted { text, before })),
            Err(error) => return Err(wrong(written - before, 1, error.to_string())),
        };
        let of = Row { line, header: &header, manipulator };
        let row = of.pose(last.as_deref());
        let (time, pose) = row.map_err(|(at, problem)| wrong(line.number - before, at, problem))?;
        while written + 1 < line.number {
            text.push('\n');
            written += 1;
        }
        let cells = [time].into_iter().chain(pose.iter().map(|value| format!("{value:?}")));
        text += &cells.collect::<Vec<_>>().join(",");
        text.push('\n');
        (written, last) = (line.number, Some(pose));
    }
}

/// The fields of the time and of each part of a place, and the units of the position.
struct Header {
    count: usize,
    time: usize,
    fields: [usize; 7],
    units: [FileUnits; 3],
}

impl Header {
    /// `None` if the header names no quaternion; a problem and its column if it is no header of places.
    fn of(line: Line<'_>, options: &TableOptions<'_>) -> Option<Result<Self, (usize, String)>> {
        let cells: Vec<_> = line.fields().map(String::from_utf8_lossy).collect();
        let headings: Vec<_> = cells.iter().map(|cell| Heading::parse(cell)).collect();
        let named = |i: usize| match options.columns {
            None => Some(headings[i].name),
            Some(columns) => columns.name_of(headings[i], &cells[i]).ok().flatten(),
        };
        let find =
            |name: &str| (0..cells.len()).filter(|&i| named(i) == Some(name)).collect::<Vec<_>>();
        if NAMES[3..].iter().all(|name| find(name).is_empty()) {
            return None;
        }
        let expected = "expected a place in each row: t,x,y,z,qx,qy,qz,qw";
        let one = |name: &str| match *find(name) {
            [one] => Ok(one),
            [] => Err((1, format!("no column {name}, {expected}"))),
            [_, twice, ..] => {
                Err((line.column(twice), format!("two columns are called {name}, {expected}")))
            }
        };
        let read = || {
            let time = one("t")?;
            let mut fields = [0; 7];
            for (field, name) in fields.iter_mut().zip(NAMES) {
                *field = one(name)?;
            }
            let known = |i: &usize| *i == time || fields.contains(i) || named(*i).is_none();
            if let Some(odd) = (0..cells.len()).find(|i| !known(i)) {
                let problem = format!("{} beside a quaternion, {expected}", quoted(&cells[odd]));
                return Err((line.column(odd), problem));
            }
            let mut units = [FileUnits::SI; 3];
            for (units, &field) in units.iter_mut().zip(&fields) {
                let given = headings[field].units(Quantity::Length);
                let given = given.map_err(|problem| (line.column(field), problem))?;
                *units = given.unwrap_or(FileUnits::SI);
            }
            Ok(Self { count: cells.len(), time, fields, units })
        };
        Some(read())
    }
}

/// A row of a table of places.
struct Row<'a> {
    line: Line<'a>,
    header: &'a Header,
    manipulator: &'a Manipulator,
}

impl Row<'_> {
    /// The text of the time and the pose, with the angles nearest to those of the last one; or a problem and its column.
    fn pose(&self, last: Option<&[f64]>) -> Result<(String, Vec<f64>), (usize, String)> {
        let Self { line, header, manipulator } = self;
        let cells: Vec<_> = line.fields().map(String::from_utf8_lossy).collect();
        if cells.len() != header.count {
            let (given, expected) = (cells.len(), header.count);
            return Err((1, format!("{given} cells, expected {expected} as in the header")));
        }
        let mut values = [0.0; 7];
        for (number, (value, &field)) in values.iter_mut().zip(&header.fields).enumerate() {
            let cell = &cells[field];
            let problem = || (line.column(field), format!("{}, expected a number", quoted(cell)));
            *value = cell.trim().parse().map_err(|_| problem())?;
            if let Some(units) = header.units.get(number) {
                *value = units.si(*value, Quantity::Length);
            }
        }
        let found = place(values).map_err(|problem| (1, problem))?;
        let pose = manipulator.locate_written(&found, manipulator.home_mode());
        let mut pose = pose.map_err(|outside| {
            let lacks = "; expected places that it has, as `opm ik` tells them";
            (1, format!("{outside}{lacks}"))
        })?;
        if let Some(last) = last {
            manipulator.angles_near(&mut pose, last);
        }
        Ok((cells[header.time].trim().to_owned(), pose))
    }
}
