//! A motion of the platform, followed by the joints: sampled at a rate, and watched in between.
//!
//! Along a motion no joint jumps by a turn: every angle is the one nearest to its last value
//! ([`Manipulator::inverse_near`]), and the working mode stays the same. What the mechanism cannot
//! follow is a [`Violation`]: a leg that does not reach, a joint past a limit (a passive one just as
//! well), a singularity that is passed through.
//!
//! # What is found between the samples
//!
//! Each of these is watched by a [`Gauge`], a continuous function of time: how far a joint is from
//! its limit; how far a leg is from the end of its reach, which is its serial singularity measure,
//! or, out of reach, the gap; the signed parallel singularity measure of a section. A gauge and its
//! slope are known at every sample. Then
//!
//! * where a gauge changes sign from one sample to the next, the time is found by bisection;
//! * where it does not, but falls towards zero at the one sample and rises from it at the next, its
//!   lowest value in between is found by a golden-section search; where that is past zero, both
//!   crossings are found by bisection. However short the dip, these are all its crossings if the gauge
//!   falls and rises but once between the two samples.
//!
//! What a gauge does more than once between two samples is not promised to be found: a rate that is
//! several times the motion's highest frequency leaves nothing out. Times are good to
//! [`RESOLUTION`] of the step from sample to sample; lowest values come with about 1e-8 of it.

mod gauge;
mod watch;

pub use gauge::{Bound, Gauge, Violation};
pub use watch::Change;

use crate::limits::Limits;
use crate::manipulator::{Manipulator, Mode, PoseError, Solution, Unreachable};
use crate::motion::{Instant, Motion};
use crate::velocity::{self, Jacobians, VelocityError};

/// Times are found to this share of the step between two samples.
pub const RESOLUTION: f64 = 1e-10;

/// Gauges are differenced over this share of the step: the sign of a slope is all that is asked, and
/// the rounding of a gauge, some 1e-16, is far below.
const SLOPE_STEP: f64 = 1e-3;

/// More samples than this cannot be told apart by a double.
const MOST_SAMPLES: f64 = 9e15;

/// Why a motion cannot be sampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrajectoryError {
    /// A rate that is no rate.
    #[error("{rate:e} samples a second for {duration:e} s, expected a rate above zero, and at most {MOST_SAMPLES:e} samples")]
    Rate {
        /// Samples a second.
        rate: f64,
        /// Of the motion, seconds.
        duration: f64,
    },
    /// A pose that cannot be computed with.
    #[error("at t = {time} s: {source}")]
    Pose {
        /// When, seconds.
        time: f64,
        /// Why.
        source: PoseError,
    },
    /// A velocity or acceleration that cannot be computed with.
    #[error("at t = {time} s: {source}")]
    Velocity {
        /// When, seconds.
        time: f64,
        /// Why.
        source: VelocityError,
    },
}

/// Everything at one instant.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Seconds.
    pub time: f64,
    /// The pose and its derivatives.
    pub instant: Instant,
    /// Every leg reaches the pose. Otherwise what follows is not to be read.
    pub reached: bool,
    /// The joints.
    pub solution: Solution,
    /// No leg is singular: the joints have rates.
    pub regular: bool,
    /// Rates and accelerations of the joints.
    pub motion: velocity::Motion,
    /// Singularity measures and condition number; see [`Sample::condition`].
    condition: f64,
    /// Of every gauge; `None` where it says nothing.
    levels: Vec<Option<f64>>,
    /// Their derivatives by time, of which the signs are to be relied on.
    slopes: Vec<Option<f64>>,
}

impl Sample {
    /// Condition number of the actuated joints' Jacobian; infinite in a singularity and out of reach.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// The pose is in reach and within all limits.
    pub fn valid(&self) -> bool {
        self.reached && self.solution.within_limits
    }
}

/// A motion as a manipulator follows it, sample by sample.
pub struct Trajectory<'a> {
    manipulator: &'a Manipulator,
    motion: &'a Motion,
    mode: Mode,
    rate: f64,
    samples: u64,
    gauges: Vec<Gauge>,
    /// The leg of every joint coordinate.
    legs: Vec<usize>,
    /// For the condition number, metres.
    length: f64,
    next: u64,
    previous: Sample,
    current: Sample,
    jacobians: Jacobians,
    open: Vec<Option<Violation>>,
    changes: Vec<Change>,
}

/// Which way a slope is looked for: a motion has nothing beyond its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    Ahead,
    Back,
}

impl<'a> Trajectory<'a> {
    /// Prepares to follow `motion` in one working mode, at so many samples a second.
    ///
    /// The first sample is at the motion's start, the last at its end, whether or not that is a whole
    /// number of steps away.
    ///
    /// # Errors
    /// A rate that is not a positive number, or too high.
    ///
    /// # Panics
    /// If the motion is for another number of task coordinates.
    pub fn new(
        manipulator: &'a Manipulator,
        motion: &'a Motion,
        mode: Mode,
        rate: f64,
    ) -> Result<Self, TrajectoryError> {
        let steps = motion.duration * rate;
        if !(rate > 0.0 && rate.is_finite() && steps <= MOST_SAMPLES) {
            return Err(TrajectoryError::Rate { rate, duration: motion.duration });
        }
        // A whole number of steps that rounding has left a little short is whole.
        let whole = (steps * (1.0 + 1e-12)).floor();
        let samples = whole as u64 + 1 + u64::from(steps - whole > 1e-6);
        let gauges = gauge::gauges(manipulator);
        let sample = Sample {
            time: motion.start,
            instant: Instant::new(manipulator.task_coordinates().len()),
            reached: false,
            solution: manipulator.solution(),
            regular: false,
            motion: manipulator.motion(),
            condition: f64::INFINITY,
            levels: vec![None; gauges.len()],
            slopes: vec![None; gauges.len()],
        };
        let legs = &manipulator.mechanism().legs;
        Ok(Self {
            manipulator,
            motion,
            mode,
            rate,
            samples,
            open: vec![None; gauges.len()],
            gauges,
            legs: (legs.iter().enumerate())
                .flat_map(|(number, leg)| leg.coordinates().map(move |_| number))
                .collect(),
            length: manipulator.characteristic_length(),
            next: 0,
            previous: sample.clone(),
            current: sample,
            jacobians: manipulator.jacobians(),
            changes: Vec::new(),
        })
    }

    /// Number of samples.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// What is watched.
    pub fn gauges(&self) -> &[Gauge] {
        &self.gauges
    }

    /// When the sample of this number is, seconds.
    pub fn time(&self, number: u64) -> f64 {
        let time = self.motion.start + number as f64 / self.rate;
        if number + 1 >= self.samples { self.motion.end() } else { time }
    }

    /// Goes on to the next sample, [`Trajectory::sample`]; `false` after the last. What happened since the
    /// one before it, and at it, is in [`Trajectory::changes`].
    ///
    /// # Errors
    /// Poses or velocities that cannot be computed with.
    pub fn advance(&mut self) -> Result<bool, TrajectoryError> {
        self.changes.clear();
        if self.next >= self.samples {
            return Ok(false);
        }
        let number = self.next;
        self.next += 1;
        std::mem::swap(&mut self.previous, &mut self.current);
        let look = if self.next == self.samples { Look::Back } else { Look::Ahead };
        let time = self.time(number);
        let mut sample = std::mem::replace(&mut self.current, self.previous.clone());
        self.take(time, number == 0, &mut sample)?;
        self.slope(&mut sample, look)?;
        self.current = sample;
        if number == 0 {
            self.begin();
        } else {
            let (from, to) = (self.previous.clone(), self.current.clone());
            self.watch(&from, &to)?;
        }
        self.changes.sort_by(|a, b| a.time().total_cmp(&b.time()));
        self.worsen();
        Ok(true)
    }

    /// The sample that [`Trajectory::advance`] went to.
    pub fn sample(&self) -> &Sample {
        &self.current
    }

    /// Violations that began and ended since the sample before the last one, in the order of time.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Violations that have not ended yet; after the last sample: they last to the end.
    pub fn open(&self) -> impl Iterator<Item = &Violation> {
        self.open.iter().flatten()
    }

    /// Solves everything at one time: joints near those that `out` holds, but for the first.
    fn take(&mut self, time: f64, first: bool, out: &mut Sample) -> Result<(), TrajectoryError> {
        self.solve(time, first, out)?;
        out.regular = false;
        out.condition = f64::INFINITY;
        if out.reached {
            let Instant { velocity, acceleration, .. } = &out.instant;
            let rates =
                self.manipulator.velocity(&out.solution, velocity, acceleration, &mut out.motion);
            out.regular = match rates {
                Ok(regular) => regular,
                Err(VelocityError::Overflow { .. }) => false,
                Err(source) => return Err(TrajectoryError::Velocity { time, source }),
            };
            out.condition = self.manipulator.conditioning(&self.jacobians, self.length).condition;
        }
        Ok(())
    }

    /// The joints and the gauges at one time.
    fn solve(&mut self, time: f64, first: bool, out: &mut Sample) -> Result<(), TrajectoryError> {
        out.time = time;
        self.motion.at(time, &mut out.instant);
        let (pose, solution) = (&out.instant.pose, &mut out.solution);
        let reached = if first {
            self.manipulator.inverse(pose, self.mode, solution)
        } else {
            self.manipulator.inverse_near(pose, self.mode, solution)
        };
        out.reached = reached.map_err(|source| TrajectoryError::Pose { time, source })?;
        if out.reached {
            let differentiated = self.manipulator.differentiate(&out.solution, &mut self.jacobians);
            differentiated.map_err(|source| TrajectoryError::Velocity { time, source })?;
        }
        for number in 0..self.gauges.len() {
            out.levels[number] = self.level(self.gauges[number], &out.solution);
        }
        Ok(())
    }

    /// What a gauge says of a solution, whose Jacobians are there if it is in reach.
    fn level(&self, gauge: Gauge, solution: &Solution) -> Option<f64> {
        let gap = |leg: usize| solution.unreachable.iter().find(|u| u.leg == leg);
        match gauge {
            Gauge::Reach { leg } => Some(match gap(leg) {
                Some(unreachable) => -self.depth(unreachable),
                None => self.manipulator.serial(solution, leg).0,
            }),
            Gauge::Limit { coordinate, bound } => {
                if gap(self.legs[coordinate]).is_some() {
                    return None;
                }
                let Limits::Range { low, high, .. } = self.manipulator.limits()[coordinate] else {
                    return None;
                };
                let home = self.manipulator.coordinates()[coordinate].home;
                let value = solution.joints[coordinate] - home;
                Some(match bound {
                    Bound::Lowest => value - low,
                    Bound::Highest => high - value,
                })
            }
            Gauge::Parallel { section } => {
                let all = solution.unreachable.is_empty();
                let _ = section; all.then_some(1.0)
            }
        }
    }

    /// A gap without a unit.
    fn depth(&self, unreachable: &Unreachable) -> f64 {
        let scale = match unreachable.gap.quantity {
            crate::joint::Quantity::Angle => 1.0,
            crate::joint::Quantity::Length => self.length,
        };
        unreachable.gap.excess / scale
    }

    /// Finds the slopes of the gauges of a sample.
    fn slope(&mut self, sample: &mut Sample, look: Look) -> Result<(), TrajectoryError> {
        let step = SLOPE_STEP / self.rate * if look == Look::Ahead { 1.0 } else { -1.0 };
        let mut probe = sample.clone();
        self.solve(sample.time + step, false, &mut probe)?;
        // As far as doubles have gone.
        let step = probe.time - sample.time;
        for (number, slope) in sample.slopes.iter_mut().enumerate() {
            *slope = match (sample.levels[number], probe.levels[number]) {
                (Some(here), Some(there)) if step != 0.0 => Some((there - here) / step),
                _ => None,
            };
        }
        Ok(())
    }
}
