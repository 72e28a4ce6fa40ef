//! Motions of the platform, followed from end to end.

mod summary;

pub use summary::{CoordinateRanges, MOST_LISTED, MotionSummary, Range};

use crate::error::StudyError;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::motion::PlatformMotion;
use opm_core::trajectory::{Change, Sample, Trajectory, TrajectoryError, Violation};
use std::panic::resume_unwind;
use std::sync::mpsc::{self, Receiver, SyncSender};
use std::thread;

/// Samples a second, of a motion that does not say how many.
pub const DEFAULT_RATE: f64 = 100.0;

/// Longest motion, seconds: the stamps of a recording count seconds in 32 bits.
const LONGEST: f64 = 4e9;

/// Samples that are handed over at a time; in between, the work can be stopped.
const BATCH: usize = 256;

/// Batches that may wait for whoever takes them.
const WAITING: usize = 4;

/// A motion that a manipulator is to follow.
#[derive(Clone, Copy, Debug)]
pub struct MotionRequest<'a> {
    /// The manipulator.
    pub manipulator: &'a Manipulator,
    /// The motion of its platform.
    pub motion: &'a PlatformMotion,
    /// What messages call the motion.
    pub label: &'a str,
    /// The working mode.
    pub mode: Mode,
    /// Samples a second.
    pub rate: f64,
}

impl<'a> MotionRequest<'a> {
    /// A motion with the working mode and the rate that it asks for itself, else those of home and
    /// [`DEFAULT_RATE`].
    pub fn new(manipulator: &'a Manipulator, motion: &'a PlatformMotion, label: &'a str) -> Self {
        let mode = motion.mode.unwrap_or_else(|| manipulator.home_mode());
        let rate = motion.rate.unwrap_or(DEFAULT_RATE);
        Self { manipulator, motion, label, mode, rate }
    }

    /// Asks for another working mode.
    #[must_use]
    pub fn mode(self, mode: Mode) -> Self {
        Self { mode, ..self }
    }

    /// Asks for other samples a second.
    #[must_use]
    pub fn rate(self, rate: f64) -> Self {
        Self { rate, ..self }
    }

    /// The trajectory, checked, with no sample yet.
    ///
    /// # Errors
    /// A motion that cannot be sampled, or lasts too long.
    pub fn trajectory(&self) -> Result<Trajectory<'a>, StudyError> {
        let Self { manipulator, motion, label, mode, rate } = *self;
        if motion.duration > LONGEST {
            let (motion, duration) = (label.to_owned(), motion.duration);
            return Err(StudyError::LongMotion { motion, duration, most: LONGEST });
        }
        Trajectory::new(manipulator, motion, mode, rate).map_err(|error| self.failed(error))
    }

    fn failed(&self, error: TrajectoryError) -> StudyError {
        StudyError::Trajectory { motion: self.label.to_owned(), error }
    }

    /// Follows the motion from end to end on a thread of its own, and gives every sample, with its number
    /// and with what changed up to it, to `take` on this one. `go_on` hears how many samples are done, and
    /// says whether to continue.
    ///
    /// # Errors
    /// A pose that cannot be computed with; what `take` gives; that it was told to stop.
    pub fn follow(
        &self,
        trajectory: Trajectory<'_>,
        mut take: impl FnMut(u64, &Sample, &[Change]) -> Result<(), StudyError>,
        go_on: impl Fn(u64) -> bool,
    ) -> Result<MotionSummary, StudyError> {
        let mut summary = MotionSummary::new(self.manipulator);
        let open = thread::scope(|scope| {
            let (ahead, batches) = mpsc::sync_channel::<Batch>(WAITING);
            let (back, used) = mpsc::channel::<Batch>();
            let follower = scope.spawn(move || follow(trajectory, &ahead, &used));
            let mut number = 0;
            for batch in batches {
                for (sample, changes) in &batch {
                    summary.add(sample);
                    take(number, sample, changes)?;
                    for change in changes {
                        if let Change::Ends(violation) = change {
                            summary.add_violation(*violation);
                        }
                    }
                    number += 1;
                }
                if !go_on(number) {
                    return Err(StudyError::Cancelled);
                }
                // Once the follower has come to its end it needs no more room.
                let _ = back.send(batch);
            }
            let followed = follower.join().unwrap_or_else(|panic| resume_unwind(panic));
            followed.map_err(|error| self.failed(error))
        })?;
        open.into_iter().for_each(|violation| summary.add_violation(violation));
        summary.sort();
        Ok(summary)
    }
}

/// Samples on their way from the thread that follows the motion to the one that takes them.
type Batch = Vec<(Sample, Vec<Change>)>;

/// Sends all samples, batch by batch, in batches that come back; the violations that last to the end.
fn follow(
    mut trajectory: Trajectory<'_>,
    ahead: &SyncSender<Batch>,
    used: &Receiver<Batch>,
) -> Result<Vec<Violation>, TrajectoryError> {
    loop {
        let mut batch = used.try_recv().unwrap_or_default();
        let mut length = 0;
        while length < BATCH && trajectory.advance()? {
            let (sample, changes) = (trajectory.sample(), trajectory.changes());
            match batch.get_mut(length) {
                Some((held, held_changes)) => {
                    held.copy_from(sample);
                    held_changes.clear();
                    held_changes.extend_from_slice(changes);
                }
                None => batch.push((sample.clone(), changes.to_vec())),
            }
            length += 1;
        }
        batch.truncate(length);
        // Nobody listens any more once the work has failed or was stopped.
        if length == 0 || ahead.send(batch).is_err() {
            return Ok(trajectory.open().copied().collect());
        }
    }
}
