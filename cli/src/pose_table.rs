//! Tables of poses that are read row by row: task coordinates, and coordinates that follow from them.

use crate::args::{Format, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::output::Shown;
use crate::pose::{Checks, Misread, find};
use crate::stream::{self, Columns, MODE, Stream, Streams, Wanted, other_columns};
use crate::text::{count, short};
use crate::transform::Transform;
use crate::unitless::plausible;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::table::Plausible;
use opm_core::task::TaskCoordinate;
use opm_mcap::csv::Rows;
use serde::Serialize;
use std::io;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// Begins a row about a pose: its time if it has one, its coordinates and those that follow from them if they are known,
/// whether it is in reach and within limits, and the mode.
pub fn begin(
    rows: &mut Rows<'_>,
    time: Option<f64>,
    pose: &[f64],
    (dependent, count): (Option<&[f64]>, usize),
    answers: [bool; 2],
    mode: &str,
) -> io::Result<()> {
    rows.numbers(time.as_slice())?;
    rows.numbers(pose)?;
    rows.known(dependent, count)?;
    rows.answers(&answers)?;
    rows.text(mode)
}

/// The totals of a table.
#[derive(Debug, Serialize)]
pub struct Totals {
    poses: u64,
    reachable: u64,
    within_limits: u64,
    seconds: f64,
    poses_per_second: f64,
}

impl Totals {
    /// Those of the poses that a stream has read since `start`.
    pub fn new(stream: &Stream<'_>, start: Instant, [reachable, within_limits]: [u64; 2]) -> Self {
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        let poses = stream.number.load(Ordering::Relaxed);
        let poses_per_second = poses as f64 / seconds;
        Self { poses, reachable, within_limits, seconds, poses_per_second }
    }

    /// Tells them in words, and in JSON if that was asked for: as a part of `summary`.
    pub fn tell(
        &self,
        streams: &Streams<'_>,
        output: &Output,
        summary: &impl Serialize,
    ) -> Result<(), Failure> {
        output.note(format_args!(
            "{}: {} poses, {} in reach, {} within limits; {} s, {} poses/s",
            streams.output.unwrap_or(streams.input).shown(),
            count(self.poses),
            count(self.reachable),
            count(self.within_limits),
            short(self.seconds),
            count(self.poses_per_second as u64),
        ));
        if output.format == Format::Json { output.print(summary, "") } else { Ok(()) }
    }
}

/// The columns of a table of poses. Their values are the task coordinates, and then the coordinates that follow from them.
pub fn columns<'m>(
    stream: &mut Stream<'_>,
    mechanism: (&Loaded, &'m Manipulator),
) -> Result<Columns<'m>, Failure> {
    columns_beside(stream, mechanism, &[])
}

/// The columns of a table of poses, or of places in SE(3): `x,y,z,qx,qy,qz,qw`, metres and a unit quaternion, as --transform
/// has them. Where there are quaternions, [`transform`] reads a row. Their values come behind those of poses.
pub fn columns_or_places<'m>(
    stream: &mut Stream<'_>,
    (loaded, manipulator): (&Loaded, &'m Manipulator),
) -> Result<(Columns<'m>, bool), Failure> {
    let columns = read_columns(stream, (loaded, manipulator), (&[], true))?;
    let given = |name: &str| columns.has(name);
    if !QUATERNION.into_iter().any(given) {
        let lost = POSITION.into_iter().find(|&name| {
            given(name) && manipulator.task_coordinates().iter().all(|c| c.name != name)
        });
        return match lost {
            None => Ok((columns, false)),
            Some(name) => {
                let error = find(name, manipulator.task_coordinates()).err();
                let error = error.map_or_else(String::new, |error| error.to_string());
                Err(stream::at(stream.label, columns.number, format!("column {name}: {error}")))
            }
        };
    }
    let all = POSITION.into_iter().chain(QUATERNION);
    let lost: Vec<&str> = all.clone().filter(|&name| !given(name)).collect();
    let own = manipulator.task_coordinates().iter().chain(manipulator.dependent_coordinates());
    let more: Vec<&str> = own
        .map(|c| c.name)
        .filter(|&name| given(name) && all.clone().all(|other| other != name))
        .collect();
    let problem = match (&*lost, &*more) {
        ([], []) => return Ok((columns, true)),
        ([], more) => {
            format!("{} beside a quaternion, which gives the orientation", more.join(", "))
        }
        (lost, _) => format!("no column {}, expected a place: x,y,z,qx,qy,qz,qw", lost.join(", ")),
    };
    Err(stream::at(stream.label, columns.number, problem))
}

/// The position of the reference point in a table of places.
const POSITION: [&str; 3] = ["x", "y", "z"];
/// The orientation of the platform in a table of places.
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];

/// The place in SE(3) of a row whose columns are those of [`columns_or_places`].
pub fn transform(manipulator: &Manipulator, row: &[f64]) -> Result<Transform, Misread> {
    let own = manipulator.task_coordinates();
    let places = &row[own.len() + manipulator.dependent_coordinates().len()..];
    let position = |number: usize| {
        let coordinate = own.iter().position(|c| c.name == POSITION[number]);
        coordinate.map_or(places[number], |number| row[number])
    };
    let [x, y, z] = [0, 1, 2].map(position);
    let [qx, qy, qz, qw] = [3, 4, 5, 6].map(|number| places[number]);
    Transform::new([x, y, z, qw, qx, qy, qz])
}

/// The same where the table may have columns with these names, too, which are passed over.
pub fn columns_beside<'m>(
    stream: &mut Stream<'_>,
    mechanism: (&Loaded, &'m Manipulator),
    beside: &[String],
) -> Result<Columns<'m>, Failure> {
    read_columns(stream, mechanism, (beside, false))
}

/// The same, with the columns of places behind the others if these are read.
fn read_columns<'m>(
    stream: &mut Stream<'_>,
    (loaded, manipulator): (&Loaded, &'m Manipulator),
    (beside, places): (&[String], bool),
) -> Result<Columns<'m>, Failure> {
    let (own, following) = (manipulator.task_coordinates(), manipulator.dependent_coordinates());
    let wanted = |optional: bool| {
        move |c: &'m TaskCoordinate| Wanted {
            name: c.name,
            quantity: c.quantity,
            plausible: plausible(c.quantity, c.home, (loaded, manipulator)),
            optional,
            offered: true,
        }
    };
    let values = own.iter().map(wanted(false)).chain(following.iter().map(wanted(true)));
    let place = |name: &'static str| Wanted {
        name,
        quantity: Quantity::Length,
        plausible: match POSITION.contains(&name) {
            true => plausible(Quantity::Length, 0.0, (loaded, manipulator)),
            // A part of a unit vector.
            false => Plausible::new(Quantity::Length, 0.0, 1.0, loaded.file.units),
        },
        optional: false,
        offered: false,
    };
    let before = own.len() + following.len();
    let places: Vec<&str> =
        if places { POSITION.into_iter().chain(QUATERNION).collect() } else { Vec::new() };
    let values = values.chain(places.iter().copied().map(place));
    // The other columns of a table that this program wrote.
    let others = other_columns(manipulator);
    let mut has_mode = false;
    let columns = stream.columns(values.collect(), |name| {
        has_mode |= name == MODE;
        if others.iter().chain(beside).any(|other| other == name) {
            return Ok(None);
        }
        if let Some(number) = following.iter().position(|c| c.name == name) {
            return Ok(Some(own.len() + number));
        }
        let place = places.iter().position(|&place| place == name);
        match (find(name, own), place) {
            (Err(_), Some(number)) => Ok(Some(before + number)),
            (found, _) => found.map(Some).map_err(|error| error.to_string()),
        }
    })?;
    if has_mode {
        stream.note(format_args!("column {MODE} is not read; --mode chooses the working mode"));
    }
    Ok(columns)
}

/// The values of a row in which nothing is given, not even a place: see [`columns_or_places`].
pub fn blank_or_places(manipulator: &Manipulator) -> Vec<f64> {
    let mut row = blank(manipulator);
    row.extend([f64::NAN; POSITION.len() + QUATERNION.len()]);
    row
}

/// The values of a row in which nothing is given: the pose at home, and no value of what follows from it.
pub fn blank(manipulator: &Manipulator) -> Vec<f64> {
    let following = manipulator.dependent_coordinates().len();
    manipulator.home_pose().into_iter().chain(std::iter::repeat_n(f64::NAN, following)).collect()
}

/// The pose of a row, and the given values of what follows from it.
pub fn split<'r>(manipulator: &Manipulator, row: &'r [f64]) -> (&'r [f64], Checks) {
    let (pose, following) = row.split_at(manipulator.task_coordinates().len());
    (pose, Checks::of_row(&following[..manipulator.dependent_coordinates().len()]))
}
