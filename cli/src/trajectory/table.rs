//! `opm trajectory --vary`: how well a motion is followed for each value of a number of the mechanism file.

use super::{motion, request};
use crate::args::{Output, TrajectoryArgs};
use crate::failure::Failure;
use crate::interference;
use crate::load::Loaded;
use crate::pose::GridAxis;
use crate::progress::interruptible;
use crate::runs::{self, Cell};
use crate::text::short;
use opm_core::Quantity;
use opm_study::StudyError;
use std::sync::Once;

pub fn run(
    args: &TrajectoryArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let clearance = interference::clearance(args.clearance)?;
    if args.clearance.is_some()
        && let Ok(manipulator) = loaded.compile()
    {
        interference::note_clearance(output, args.clearance, (loaded, &manipulator));
    }
    let (units, progress) = (loaded.file.units, interruptible()?);
    // Once, and not for every value.
    let doubted = Once::new();
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let (motion, _) = motion(args, (changed, &manipulator))?;
        doubted.call_once(|| motion.note_doubts(output));
        let request = request(args, &manipulator, &motion, clearance);
        let trajectory = request.trajectory()?;
        let followed = request.follow(trajectory, |_, _, _| Ok(()), |_| !progress.is_cancelled());
        let summary = followed.map_err(|error| match error {
            StudyError::Cancelled => Failure::interrupted("interrupted"),
            other => other.into(),
        })?;
        let duration = motion.motion.duration;
        let header = "duration [s]".to_owned();
        let worst = summary.condition.map_or(f64::NAN, |[worst, _]| worst);
        let nearest = summary.contacts.as_ref().and_then(|contacts| contacts.nearest);
        let nearest = nearest.map_or(f64::NAN, |(nearest, _)| nearest.distance);
        Ok(vec![
            Cell { header, ..Cell::new("duration", duration, short(duration)) },
            Cell::count("samples", summary.samples),
            Cell::count("reached", summary.reached),
            Cell::count("valid", summary.valid),
            Cell::count("violations", summary.violation_count),
            Cell::number("worst_condition", worst),
            Cell::measured("nearest", nearest, Quantity::Length, units),
        ])
    })
}
