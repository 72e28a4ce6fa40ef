//! Tables of poses that are read row by row: task coordinates, and coordinates that follow from them.

use crate::args::{Format, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::output::Shown;
use crate::pose::{Checks, find};
use crate::stream::{Columns, MODE, Stream, Streams, Wanted, other_columns};
use crate::text::{count, short};
use crate::unitless::plausible;
use opm_core::manipulator::Manipulator;
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

/// The same where the table may have columns with these names, too, which are passed over.
pub fn columns_beside<'m>(
    stream: &mut Stream<'_>,
    (loaded, manipulator): (&Loaded, &'m Manipulator),
    beside: &[String],
) -> Result<Columns<'m>, Failure> {
    let (own, following) = (manipulator.task_coordinates(), manipulator.dependent_coordinates());
    let wanted = |optional: bool| {
        move |c: &'m TaskCoordinate| Wanted {
            name: c.name,
            quantity: c.quantity,
            plausible: plausible(c.quantity, c.home, (loaded, manipulator)),
            optional,
        }
    };
    let values = own.iter().map(wanted(false)).chain(following.iter().map(wanted(true)));
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
        find(name, own).map(Some).map_err(|error| error.to_string())
    })?;
    if has_mode {
        stream.note(format_args!("column {MODE} is not read; --mode chooses the working mode"));
    }
    Ok(columns)
}

/// The values of a row in which nothing is given: the pose at home, and no value of what follows from it.
pub fn blank(manipulator: &Manipulator) -> Vec<f64> {
    let following = manipulator.dependent_coordinates().len();
    manipulator.home_pose().into_iter().chain(std::iter::repeat_n(f64::NAN, following)).collect()
}

/// The pose of a row, and the given values of what follows from it.
pub fn split<'r>(manipulator: &Manipulator, row: &'r [f64]) -> (&'r [f64], Checks) {
    let (pose, following) = row.split_at(manipulator.task_coordinates().len());
    (pose, Checks::of_row(following))
}
