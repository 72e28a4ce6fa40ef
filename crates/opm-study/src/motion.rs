//! Motions of the platform, followed from end to end.

mod batch;
mod driven;
mod reacting;
mod summary;

pub(crate) use driven::Driven;
pub use driven::Duty;
pub use reacting::Bearing;
#[cfg(feature = "recording")]
pub(crate) use reacting::Reacting;
pub use summary::{Contacts, CoordinateRanges, MOST_LISTED, MotionSummary, Range};

use crate::error::StudyError;
use opm_analysis::Setup;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::motion::PlatformMotion;
use opm_core::trajectory::{Change, Sample, Trajectory, TrajectoryError};
use opm_interference::{Distances, Interference, Watch, Watched};

/// Samples per second of a motion without a rate of its own.
pub const DEFAULT_RATE: f64 = 100.0;

/// Longest motion, seconds: the stamps of a recording count seconds in 32 bits.
const LONGEST: f64 = 4e9;

/// A motion for a manipulator to follow.
#[derive(Clone, Copy, Debug)]
pub struct MotionRequest<'a> {
    /// The manipulator.
    pub manipulator: &'a Manipulator,
    /// The motion of its platform.
    pub motion: &'a PlatformMotion,
    /// The name of the motion in messages.
    pub label: &'a str,
    /// The working mode.
    pub mode: Mode,
    /// Samples per second.
    pub rate: f64,
    /// The least distance of two bodies that is no contact, metres, if contacts are watched for.
    pub clearance: Option<f64>,
    /// What the poses are judged by, if indices are to be recorded or written beside the joints.
    pub indices: Option<&'a Setup>,
    /// What acts on the mechanism, if the efforts are asked for that move it.
    pub efforts: Option<&'a Setup>,
    /// What acts on the mechanism, and how it gives way, if the reactions at joints are asked for.
    pub reactions: Option<&'a Setup>,
}

impl<'a> MotionRequest<'a> {
    /// A request with the motion's own working mode and rate. If it has none, they are the mode of home and
    /// [`DEFAULT_RATE`].
    pub fn new(manipulator: &'a Manipulator, motion: &'a PlatformMotion, label: &'a str) -> Self {
        let mode = motion.mode.unwrap_or_else(|| manipulator.home_mode());
        let rate = motion.rate.unwrap_or(DEFAULT_RATE);
        let (clearance, indices, efforts, reactions) = (None, None, None, None);
        Self { manipulator, motion, label, mode, rate, clearance, indices, efforts, reactions }
    }

    /// Selects another working mode.
    #[must_use]
    pub fn mode(self, mode: Mode) -> Self {
        Self { mode, ..self }
    }

    /// Sets the number of samples per second.
    #[must_use]
    pub fn rate(self, rate: f64) -> Self {
        Self { rate, ..self }
    }

    /// Watches for bodies that are nearer to each other than this, metres.
    #[must_use]
    pub fn clearance(self, least: f64) -> Self {
        Self { clearance: Some(least), ..self }
    }

    /// Adds the indices that the mechanism has in a setup ([`Index`](opm_analysis::Index)) to recordings and tables and, with a
    /// load, the efforts of the actuated and the imaginary joints, as `effort.NAME`.
    #[must_use]
    pub fn indices(self, setup: &'a Setup) -> Self {
        Self { indices: Some(setup), ..self }
    }

    /// Adds the efforts of the actuators that move the mechanism against its inertia and everything in a setup, as `effort.NAME`
    /// to tables and recordings, and what each motor has to do to the summary.
    #[must_use]
    pub fn efforts(self, setup: &'a Setup) -> Self {
        Self { efforts: Some(setup), ..self }
    }

    /// Adds what passes through each joint, with the springs of a setup, the inertia of all bodies and everything that acts, as
    /// `reaction.NAME.FX` ... `MZ` to tables, and the largest force and moment of each joint to the summary. Nothing is known without
    /// springs.
    #[must_use]
    pub fn reactions(self, setup: &'a Setup) -> Self {
        Self { reactions: Some(setup), ..self }
    }

    /// The trajectory, checked, before its first sample.
    ///
    /// # Errors
    /// The motion cannot be sampled, or lasts too long.
    pub fn trajectory(&self) -> Result<Trajectory<'a>, StudyError> {
        let Self { manipulator, motion, label, mode, rate, .. } = *self;
        if motion.duration > LONGEST {
            let (motion, duration) = (label.to_owned(), motion.duration);
            return Err(StudyError::LongMotion { motion, duration, most: LONGEST });
        }
        Trajectory::new(manipulator, motion, mode, rate).map_err(|error| self.failed(error))
    }

    fn failed(&self, error: TrajectoryError) -> StudyError {
        StudyError::Trajectory { motion: self.label.to_owned(), error }
    }

    /// Follows the motion from end to end, on a thread of its own if one can be started. On this thread, calls
    /// `take` with every sample, its number, and the transitions up to it. `go_on` gets the number of finished
    /// samples and returns whether to continue.
    ///
    /// # Errors
    /// A pose is not finite, `take` fails, or the work was cancelled.
    pub fn follow(
        &self,
        trajectory: Trajectory<'_>,
        mut take: impl FnMut(u64, &Sample, &[Change]) -> Result<(), StudyError>,
        go_on: impl Fn(u64) -> bool,
    ) -> Result<MotionSummary, StudyError> {
        let mut summary = MotionSummary::new(self.manipulator);
        let interference = self.clearance.map(|_| Interference::new(self.manipulator.mechanism()));
        let mut watch =
            self.clearance.zip(interference.as_ref()).map(|(clearance, interference)| {
                let Self { manipulator, motion, mode, .. } = *self;
                let of = Watched { manipulator, motion, mode, clearance };
                Watch::new(of, Distances::new(interference))
            });
        let mut driven = self.efforts.map(|setup| Driven::new(self.manipulator, setup));
        let mut reacting =
            self.reactions.and_then(|setup| reacting::Reacting::new(self.manipulator, setup));
        let mut number = 0;
        let open = self.each_batch(trajectory, |batch| {
            for (sample, changes) in batch {
                summary.add(sample);
                if let Some(driven) = &mut driven {
                    summary.add_efforts(sample, driven.values(sample), self.manipulator);
                }
                if let Some(reacting) = &mut reacting {
                    summary.add_reactions(sample, reacting.values(sample));
                }
                if let Some(watch) = &mut watch {
                    let solution = Some(&sample.solution).filter(|_| sample.reached);
                    let time = sample.time;
                    let watched = watch.advance(time, 1.0 / self.rate, solution);
                    let pose = |source| TrajectoryError::Pose { time, source };
                    watched.map_err(|source| self.failed(pose(source)))?;
                }
                take(number, sample, changes)?;
                for change in changes {
                    if let Change::Ends(violation) = change {
                        summary.add_violation(*violation);
                    }
                }
                number += 1;
            }
            if go_on(number) { Ok(()) } else { Err(StudyError::Cancelled) }
        })?;
        open.into_iter().for_each(|violation| summary.add_violation(violation));
        summary.sort();
        let found = watch.map(Watch::finish);
        summary.contacts = interference.zip(found).map(|(interference, (contacts, nearest))| {
            Contacts { interference, contacts, nearest }
        });
        Ok(summary)
    }
}
