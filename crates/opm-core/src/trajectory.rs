//! A motion of the platform, followed by the joints: sampled at a rate, and watched in between.
//!
//! Along a motion no joint jumps by a whole turn: every angle is the one nearest to its last value
//! ([`Manipulator::inverse_near`]), and the working mode stays the same. What the mechanism cannot
//! follow is a [`Violation`]: a leg that does not reach, a joint past a limit (actuated or passive), a
//! singularity that is passed through. [`ViolationReport`] puts it into words.
//!
//! # What is found between the samples
//!
//! Each of these is watched by a [`Gauge`], a continuous function of time:
//!
//! * how far a joint is from its limit;
//! * how far a leg is from the end of its reach: its serial singularity measure, or, out of reach, the
//!   gap;
//! * the signed parallel singularity measure of a section.
//!
//! A gauge and its slope are known at every sample. Then
//!
//! * where a gauge changes sign from one sample to the next, the time is found by bisection;
//! * where it does not, but falls towards zero at the one sample and rises from it at the next, its
//!   lowest value in between is found by a golden-section search. Where that is past zero, both
//!   crossings are found by bisection. However short the dip is, these are all of its crossings if the
//!   gauge falls and rises only once between the two samples.
//!
//! A gauge that falls and rises several times between two samples may be missed. A sampling rate of
//! several times the motion's highest frequency leaves nothing out. Times are accurate to
//! [`RESOLUTION`] of the step between samples, the times of lowest values to about 1e-8 of it.
//!
//! # Example
//!
//! ```
//! use opm_core::motion::{Harmonics, Path, PlatformMotion, Sinusoid};
//! use opm_core::trajectory::Gauge;
//! use opm_core::{Manipulator, Trajectory};
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! // x swings by this amplitude once in two seconds; every other coordinate stays at home.
//! let swing = |amplitude: f64| {
//!     let coordinates = manipulator.task_coordinates();
//!     let mut path: Vec<_> = coordinates.iter().map(|c| Harmonics::constant(c.home)).collect();
//!     path[0].sinusoids.push(Sinusoid { amplitude, frequency: 0.5, phase: 0.0 });
//!     let (name, path) = ("swing".to_owned(), Path::Harmonics(path));
//!     PlatformMotion { name, start: 0.0, duration: 2.0, rate: None, mode: None, path }
//! };
//!
//! // Five millimetres, 20 samples a second: 41 samples, with one at either end.
//! let motion = swing(0.005);
//! let mut trajectory = Trajectory::new(&manipulator, &motion, manipulator.home_mode(), 20.0)?;
//! let mut samples = 0;
//! while trajectory.advance()? {
//!     assert!(trajectory.sample().reached && trajectory.changes().is_empty());
//!     samples += 1;
//! }
//! assert_eq!(samples, 41);
//!
//! // Ten metres: the legs, which are far shorter, go out of reach.
//! let motion = swing(10.0);
//! let mut trajectory = Trajectory::new(&manipulator, &motion, manipulator.home_mode(), 20.0)?;
//! let mut out_of_reach = false;
//! while trajectory.advance()? {
//!     let mut open = trajectory.open();
//!     out_of_reach |= open.any(|violation| matches!(violation.gauge, Gauge::Reach { .. }));
//! }
//! assert!(out_of_reach);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod gauge;
mod report;
mod search;
mod violations;
mod watch;

pub use gauge::{Bound, Gauge, Part, Violation};
pub use report::ViolationReport;
pub use violations::Change;

use crate::chain::limits::Limits;
use crate::manipulator::{Manipulator, Mode, PoseError, Section, Solution, Unreachable};
use crate::motion::{Instant, PlatformMotion};
use crate::numeric::Quantity;
use crate::velocity::{self, Jacobians, Measures, Singularities, VelocityError};

/// The accuracy of the times that are found, as a share of the step between two samples.
pub const RESOLUTION: f64 = 1e-10;

/// Gauges are differenced over this share of the step: the sign of a slope is all that is asked, and
/// the rounding of a gauge, some 1e-16, is far below.
const SLOPE_STEP: f64 = 1e-3;

/// More samples than this cannot be told apart by a double.
const MOST_SAMPLES: f64 = 9e15;

/// Why a motion cannot be sampled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The motion is not in the task coordinates of this manipulator.
    #[error("the motion has {given} task coordinates, expected {expected}, as the manipulator has")]
    Coordinates {
        /// The number of coordinates of the motion.
        given: usize,
        /// The number of task coordinates of the manipulator.
        expected: usize,
    },
    /// The sampling rate is not a positive number, or gives too many samples.
    #[error(
        "{rate:e} samples a second for {duration:e} s, expected a rate above zero, and at most {MOST_SAMPLES:e} samples"
    )]
    Rate {
        /// Samples a second.
        rate: f64,
        /// The duration of the motion, seconds.
        duration: f64,
    },
    /// A pose of the motion cannot be computed with.
    #[error("at t = {time} s: {source}")]
    Pose {
        /// The time, seconds.
        time: f64,
        /// The reason.
        source: PoseError,
    },
    /// A velocity or acceleration of the motion cannot be computed with.
    #[error("at t = {time} s: {source}")]
    Velocity {
        /// The time, seconds.
        time: f64,
        /// The reason.
        source: VelocityError,
    },
}

/// The mechanism at one instant of a motion.
#[derive(Clone, Debug)]
pub struct Sample {
    /// The time, seconds.
    pub time: f64,
    /// The pose of the platform and its derivatives by time.
    pub instant: Instant,
    /// Whether every leg reaches the pose. If not, the fields below have no meaning.
    pub reached: bool,
    /// The joint values, actuated, passive and imaginary.
    pub solution: Solution,
    /// Whether no leg is singular, so that the joints have rates.
    pub regular: bool,
    /// The rates and accelerations of the joints; they have a meaning where `regular` is true.
    pub motion: velocity::JointMotion,
    /// The condition number of the actuated joints' Jacobian; infinite at a singularity and out of reach.
    pub condition: f64,
    /// The singularity measures of the upper section.
    pub upper: Measures,
    /// The singularity measures of the lower section.
    pub lower: Measures,
    /// The level of every gauge; `None` where it has none.
    levels: Vec<Option<f64>>,
    /// The derivatives of the levels by time; only their signs are reliable.
    slopes: Vec<Option<f64>>,
}

impl Sample {
    fn new(solver: &Solver<'_>) -> Self {
        let manipulator = solver.manipulator;
        Self {
            time: solver.motion.start,
            instant: Instant::new(manipulator.task_coordinates().len()),
            reached: false,
            solution: manipulator.solution(),
            regular: false,
            motion: manipulator.joint_motion(),
            condition: f64::INFINITY,
            upper: Measures::default(),
            lower: Measures::default(),
            levels: vec![None; solver.gauges.len()],
            slopes: vec![None; solver.gauges.len()],
        }
    }

    /// Copies another sample of the same manipulator into this one, without allocating.
    pub fn copy_from(&mut self, other: &Self) {
        let Instant { pose, velocity, acceleration } = &other.instant;
        self.time = other.time;
        self.instant.pose.clone_from(pose);
        self.instant.velocity.clone_from(velocity);
        self.instant.acceleration.clone_from(acceleration);
        (self.reached, self.regular) = (other.reached, other.regular);
        self.solution.copy_from(&other.solution);
        self.motion.joint_rates.clone_from(&other.motion.joint_rates);
        self.motion.joint_accelerations.clone_from(&other.motion.joint_accelerations);
        self.motion.imaginary_rates.clone_from(&other.motion.imaginary_rates);
        self.motion.imaginary_accelerations.clone_from(&other.motion.imaginary_accelerations);
        self.motion.singular.clone_from(&other.motion.singular);
        self.condition = other.condition;
        (self.upper, self.lower) = (other.upper, other.lower);
        self.levels.clone_from(&other.levels);
        self.slopes.clone_from(&other.slopes);
    }

    /// Whether the pose is in reach and within all joint limits.
    pub fn valid(&self) -> bool {
        self.reached && self.solution.within_limits
    }
}

/// A motion as a manipulator follows it, sample by sample.
///
/// Call [`advance`](Self::advance) until it returns `false`; after each call, read
/// [`sample`](Self::sample) and [`changes`](Self::changes).
pub struct Trajectory<'a> {
    solver: Solver<'a>,
    samples: u64,
    next: u64,
    previous: Sample,
    current: Sample,
    /// Working memory for the solutions beside a sample that slopes are taken from.
    probe: Sample,
    open: Vec<Option<Violation>>,
    changes: Vec<Change>,
}

/// Solves one instant of the motion.
struct Solver<'a> {
    manipulator: &'a Manipulator,
    motion: &'a PlatformMotion,
    mode: Mode,
    rate: f64,
    gauges: Vec<Gauge>,
    /// The leg of every joint coordinate.
    legs: Vec<usize>,
    /// The characteristic length for the condition number, metres.
    length: f64,
    jacobians: Jacobians,
    measured: Singularities,
}

/// The side on which a slope is taken: a motion has nothing beyond its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    Ahead,
    Back,
}

/// Where the angles of a solution start from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turns {
    /// From home.
    Home,
    /// From what the solution held before.
    Held,
}

impl<'a> Trajectory<'a> {
    /// Prepares to follow `motion` in one working mode, at so many samples a second.
    ///
    /// The first sample is at the motion's start, the last at its end, whether or not that is a whole
    /// number of steps away.
    ///
    /// # Errors
    /// If the motion gives another number of task coordinates than the manipulator has, or if the rate
    /// is not a positive number or gives too many samples.
    pub fn new(
        manipulator: &'a Manipulator,
        motion: &'a PlatformMotion,
        mode: Mode,
        rate: f64,
    ) -> Result<Self, TrajectoryError> {
        let (given, expected) = (motion.coordinate_count(), manipulator.task_coordinates().len());
        if given != expected {
            return Err(TrajectoryError::Coordinates { given, expected });
        }
        let steps = motion.duration * rate;
        if !(rate > 0.0 && rate.is_finite() && steps <= MOST_SAMPLES) {
            return Err(TrajectoryError::Rate { rate, duration: motion.duration });
        }
        // A whole number of steps that rounding has left a little short is whole.
        let whole = (steps * (1.0 + 1e-12)).floor();
        let samples = whole as u64 + 1 + u64::from(steps - whole > 1e-6);
        let measured = manipulator.singularities();
        let legs = manipulator.mechanism().legs.iter().enumerate();
        let solver = Solver {
            manipulator,
            motion,
            mode,
            rate,
            gauges: gauge::gauges(manipulator),
            legs: legs.flat_map(|(number, leg)| leg.coordinates().map(move |_| number)).collect(),
            length: manipulator.characteristic_length(),
            jacobians: manipulator.jacobians(),
            measured,
        };
        let sample = Sample::new(&solver);
        Ok(Self {
            samples,
            next: 0,
            previous: sample.clone(),
            current: sample.clone(),
            probe: sample,
            open: vec![None; solver.gauges.len()],
            changes: Vec::new(),
            solver,
        })
    }

    /// The number of samples.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// The gauges that are watched.
    pub fn gauges(&self) -> &[Gauge] {
        &self.solver.gauges
    }

    /// The time of the sample of this number, seconds.
    pub fn time(&self, number: u64) -> f64 {
        let motion = self.solver.motion;
        let time = motion.start + number as f64 / self.solver.rate;
        if number + 1 >= self.samples { motion.end() } else { time }
    }

    /// Goes on to the next sample, which [`Trajectory::sample`] gives; returns `false` after the last one.
    /// What happened since the sample before, and at this one, is in [`Trajectory::changes`].
    ///
    /// # Errors
    /// A pose or a velocity of the motion that cannot be computed with.
    pub fn advance(&mut self) -> Result<bool, TrajectoryError> {
        self.changes.clear();
        if self.next >= self.samples {
            return Ok(false);
        }
        let (number, time) = (self.next, self.time(self.next));
        self.next += 1;
        let last = self.next == self.samples;
        std::mem::swap(&mut self.previous, &mut self.current);
        self.current.solution.copy_from(&self.previous.solution);
        let turns = if number == 0 { Turns::Home } else { Turns::Held };
        self.solver.solve(time, turns, &mut self.current)?;
        self.solver.rates(&mut self.current)?;
        let look = if last { Look::Back } else { Look::Ahead };
        self.solver.slope(&mut self.current, look, &mut self.probe)?;
        if number == 0 {
            self.begin();
        } else if self.eventful() {
            self.current = self.watch(self.previous.clone(), self.current.clone())?;
        }
        if last && number > 0 {
            self.end();
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

    /// The violations that have not ended yet. After the last sample these last to the end of the motion.
    pub fn open(&self) -> impl Iterator<Item = &Violation> {
        self.open.iter().flatten()
    }
}

impl Solver<'_> {
    /// The joints, how near to singular they are, and the gauges, at one time.
    fn solve(&mut self, time: f64, turns: Turns, out: &mut Sample) -> Result<(), TrajectoryError> {
        let manipulator = self.manipulator;
        out.time = time;
        self.motion.at(time, &mut out.instant);
        let (pose, solution) = (&out.instant.pose, &mut out.solution);
        let reached = match turns {
            Turns::Home => manipulator.inverse(pose, self.mode, solution),
            Turns::Held => manipulator.inverse_near(pose, self.mode, solution),
        };
        let reached = reached.map_err(|source| TrajectoryError::Pose { time, source })?;
        out.reached = reached.is_some();
        if out.reached {
            let differentiated = manipulator.differentiate(&out.solution, &mut self.jacobians);
            differentiated.map_err(|source| TrajectoryError::Velocity { time, source })?;
            manipulator.measure_singularities(&self.jacobians, &mut self.measured);
            (out.upper, out.lower) = (self.measured.upper, self.measured.lower);
        }
        for (&gauge, level) in self.gauges.iter().zip(&mut out.levels) {
            *level = self.level(gauge, &out.solution);
        }
        Ok(())
    }

    /// Rates of the joints and the condition number at the solution that was found last.
    fn rates(&mut self, out: &mut Sample) -> Result<(), TrajectoryError> {
        (out.regular, out.condition) = (false, f64::INFINITY);
        if out.reached {
            let Instant { velocity, acceleration, .. } = &out.instant;
            let (solution, motion) = (&out.solution, &mut out.motion);
            let rates = self.manipulator.velocity(solution, velocity, acceleration, motion);
            out.regular = match rates {
                Ok(regular) => regular,
                Err(VelocityError::Overflow { .. }) => false,
                Err(source) => return Err(TrajectoryError::Velocity { time: out.time, source }),
            };
            out.condition = self.manipulator.conditioning(&self.jacobians, self.length).condition;
        }
        Ok(())
    }

    /// The level of a gauge for a solution, the last one that was measured if it is in reach.
    fn level(&self, gauge: Gauge, solution: &Solution) -> Option<f64> {
        let gap = |leg: usize| solution.unreachable.iter().find(|u| u.leg == leg);
        let reached = solution.unreachable.is_empty();
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
            Gauge::Parallel { part } => {
                let Singularities { upper, lower, whole, .. } = &self.measured;
                let both = upper.parallel.is_some() && lower.parallel.is_some();
                let measure = match part {
                    Part::Section(Section::Upper) => upper.parallel,
                    Part::Section(Section::Lower) => lower.parallel,
                    Part::Whole => whole.parallel.filter(|_| !both),
                };
                measure.filter(|_| reached)
            }
        }
    }

    /// A gap without a unit: lengths are divided by the characteristic length.
    fn depth(&self, unreachable: &Unreachable) -> f64 {
        let scale = match unreachable.deficit.quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => self.length,
        };
        unreachable.deficit.excess / scale
    }

    /// Finds the slopes of the gauges of a sample.
    fn slope(
        &mut self,
        sample: &mut Sample,
        look: Look,
        probe: &mut Sample,
    ) -> Result<(), TrajectoryError> {
        let step = SLOPE_STEP / self.rate;
        let time = if look == Look::Ahead { sample.time + step } else { sample.time - step };
        probe.solution.copy_from(&sample.solution);
        self.solve(time, Turns::Held, probe)?;
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
