//! The joints along a motion of the platform: sampled at a rate, with events found between the samples.
//!
//! Along a motion no joint jumps by a full revolution: every angle is the one nearest to its last value
//! ([`Manipulator::inverse_near`]), and the working mode stays the same. A part of the motion that the
//! mechanism cannot follow is a [`Violation`]: a leg is out of reach, a joint (actuated or passive) is
//! beyond a limit or faster than it may be, or the motion passes through a singularity. [`ViolationReport`] describes it in words.
//!
//! # What is found between the samples
//!
//! A [`Gauge`] is a continuous function of time. There is one for each of these:
//!
//! * the distance of a joint from a limit, and that of its rate and of its acceleration;
//! * the distance of a leg from its boundary of reach: its serial singularity measure or, out of reach,
//!   minus the deficit;
//! * the signed parallel singularity measure of a section.
//!
//! The value and the slope of every gauge are computed at each sample. Between two samples there are two
//! cases:
//!
//! * The gauge changes sign. The time is found by bisection.
//! * The gauge falls towards zero at the first sample and rises at the second. Its lowest value is found
//!   by a golden-section search. If that is beyond zero, both crossings are found by bisection. These are
//!   all crossings if the gauge falls and rises only once between the two samples, however short the dip
//!   is.
//!
//! Events may be missed if a gauge falls and rises several times between two samples. A sampling rate of
//! several times the motion's highest frequency is enough in practice. Times are accurate to [`RESOLUTION`]
//! of the step between samples, and the times of lowest values to about 1e-8 of it.
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

pub use gauge::{Bound, Gauge, GaugedPart, Violation};
pub use report::ViolationReport;
pub use violations::Change;

use crate::chain::limits::Limits;
use crate::manipulator::{Manipulator, Mode, PoseError, Section, Solution, Unreachable};
use crate::mechanism::joint::MotionLimit;
use crate::motion::{Instant, PlatformMotion};
use crate::numeric::Quantity;
use crate::velocity::{self, Jacobians, Measures, Singularities, VelocityError};

/// The accuracy of the times that are found, as a share of the step between two samples.
pub const RESOLUTION: f64 = 1e-10;

/// Slopes of gauges are differences over this share of the step. Only the sign of a slope matters, and the
/// rounding of a gauge, some 1e-16, is far below.
const SLOPE_STEP: f64 = 1e-3;

/// A rate or an acceleration is at its limit within this share of it: far above rounding, far below what a motor
/// feels.
const MOTION_TOLERANCE: f64 = 1e-9;

/// The largest number of samples. The numbers of more samples could not be represented exactly.
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
        "the sampling rate is {rate:e} Hz for {duration:e} s, expected a rate above zero and at most {MOST_SAMPLES:e} samples"
    )]
    Rate {
        /// The sampling rate, hertz.
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
        self.solution.clone_from(&other.solution);
        self.motion.joint_rates.clone_from(&other.motion.joint_rates);
        self.motion.joint_accelerations.clone_from(&other.motion.joint_accelerations);
        self.motion.imaginary_rates.clone_from(&other.motion.imaginary_rates);
        self.motion.imaginary_accelerations.clone_from(&other.motion.imaginary_accelerations);
        self.motion.dependent_rates.clone_from(&other.motion.dependent_rates);
        self.motion.dependent_accelerations.clone_from(&other.motion.dependent_accelerations);
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

/// A motion as a manipulator follows it, sample by sample. See the example in the docs of
/// [`trajectory`](crate::trajectory).
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
    /// Whether there are gauges of rates or accelerations.
    watches_rates: bool,
    /// For each joint coordinate, the number of its leg.
    legs: Vec<usize>,
    /// The characteristic length for the condition number, metres.
    length: f64,
    jacobians: Jacobians,
    measured: Singularities,
}

/// The side on which a one-sided slope is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SlopeSide {
    /// After the sample.
    After,
    /// Before the sample, as at the end of the motion.
    Before,
}

/// The values that the angles of a solution are nearest to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NearestTo {
    /// The values at home.
    Home,
    /// The last values, which the solution's buffer has.
    Last,
}

impl<'a> Trajectory<'a> {
    /// Prepares to follow `motion` in one working mode, with a sampling rate in hertz.
    ///
    /// The first sample is at the motion's start and the last at its end. The last step may be shorter than
    /// the others.
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
        // Rounding may leave a whole number of steps slightly too small.
        let whole = (steps * (1.0 + 1e-12)).floor();
        let samples = whole as u64 + 1 + u64::from(steps - whole > 1e-6);
        let measured = manipulator.singularities();
        let legs = manipulator.mechanism().legs.iter().enumerate();
        let gauges = gauge::gauges(manipulator);
        let solver = Solver {
            manipulator,
            motion,
            mode,
            rate,
            watches_rates: gauges.iter().any(|gauge| matches!(gauge, Gauge::Motion { .. })),
            gauges,
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

    /// The gauges that are computed along the motion.
    pub fn gauges(&self) -> &[Gauge] {
        &self.solver.gauges
    }

    /// The time of the sample of this number, seconds.
    pub fn time(&self, number: u64) -> f64 {
        let motion = self.solver.motion;
        let time = motion.start + number as f64 / self.solver.rate;
        if number + 1 >= self.samples { motion.end() } else { time }
    }

    /// Advances to the next sample, which [`Trajectory::sample`] gives, and returns `false` after the last
    /// one. [`Trajectory::changes`] gives the events from the previous sample up to and including this one.
    ///
    /// # Errors
    /// If a pose or a velocity of the motion cannot be computed with.
    pub fn advance(&mut self) -> Result<bool, TrajectoryError> {
        self.changes.clear();
        if self.next >= self.samples {
            return Ok(false);
        }
        let (number, time) = (self.next, self.time(self.next));
        self.next += 1;
        let last = self.next == self.samples;
        std::mem::swap(&mut self.previous, &mut self.current);
        self.current.solution.clone_from(&self.previous.solution);
        let nearest_to = if number == 0 { NearestTo::Home } else { NearestTo::Last };
        self.solver.solve(time, nearest_to, &mut self.current)?;
        self.solver.rates(&mut self.current)?;
        let side = if last { SlopeSide::Before } else { SlopeSide::After };
        self.solver.slope(&mut self.current, side, &mut self.probe)?;
        if number == 0 {
            self.begin();
        } else if self.may_have_events() {
            self.current = self.watch(self.previous.clone(), self.current.clone())?;
        }
        if last && number > 0 {
            self.end();
        }
        self.changes.sort_by(|a, b| a.time().total_cmp(&b.time()));
        self.extend_open();
        Ok(true)
    }

    /// The sample that [`Trajectory::advance`] has advanced to.
    pub fn sample(&self) -> &Sample {
        &self.current
    }

    /// The violations that began or ended after the previous sample and up to the present one, in the order
    /// of time.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// The violations that have not ended yet. After the last sample, these last to the end of the motion.
    pub fn open(&self) -> impl Iterator<Item = &Violation> {
        self.open.iter().flatten()
    }
}

impl Solver<'_> {
    /// Computes the joints, the singularity measures and the gauges at one time.
    fn solve(
        &mut self,
        time: f64,
        nearest_to: NearestTo,
        out: &mut Sample,
    ) -> Result<(), TrajectoryError> {
        let manipulator = self.manipulator;
        out.time = time;
        self.motion.at(time, &mut out.instant);
        let (pose, solution) = (&out.instant.pose, &mut out.solution);
        let reached = match nearest_to {
            NearestTo::Home => manipulator.inverse(pose, self.mode, solution),
            NearestTo::Last => manipulator.inverse_near(pose, self.mode, solution),
        };
        let reached = reached.map_err(|source| TrajectoryError::Pose { time, source })?;
        out.reached = reached.is_some();
        if out.reached {
            let differentiated = manipulator.differentiate(&out.solution, &mut self.jacobians);
            differentiated.map_err(|source| TrajectoryError::Velocity { time, source })?;
            manipulator.measure_singularities(&self.jacobians, &mut self.measured);
            (out.upper, out.lower) = (self.measured.upper, self.measured.lower);
        }
        if self.watches_rates {
            self.joint_motion(out)?;
        }
        for (number, &gauge) in self.gauges.iter().enumerate() {
            out.levels[number] = self.level(gauge, out);
        }
        Ok(())
    }

    /// Computes the rates of the joints and the condition number, at the solution that was found last.
    fn rates(&mut self, out: &mut Sample) -> Result<(), TrajectoryError> {
        if !self.watches_rates {
            self.joint_motion(out)?;
        }
        out.condition = f64::INFINITY;
        if out.reached {
            out.condition = self.manipulator.conditioning(&self.jacobians, self.length).condition;
        }
        Ok(())
    }

    /// Computes the rates and accelerations of the joints, at the solution that was found last.
    fn joint_motion(&self, out: &mut Sample) -> Result<(), TrajectoryError> {
        out.regular = false;
        if out.reached {
            let Instant { velocity, acceleration, .. } = &out.instant;
            let (solution, motion) = (&out.solution, &mut out.motion);
            let rates = self.manipulator.velocity(solution, velocity, acceleration, motion);
            out.regular = match rates {
                Ok(regular) => regular,
                Err(VelocityError::Overflow { .. }) => false,
                Err(source) => return Err(TrajectoryError::Velocity { time: out.time, source }),
            };
        }
        Ok(())
    }

    /// The level of a gauge at a sample. If the sample is in reach, its singularity measures must be the last
    /// ones that were computed.
    fn level(&self, gauge: Gauge, sample: &Sample) -> Option<f64> {
        let solution = &sample.solution;
        let deficit = |leg: usize| solution.unreachable.iter().find(|u| u.leg == leg);
        let reached = solution.unreachable.is_empty();
        match gauge {
            Gauge::Reach { leg } => Some(match deficit(leg) {
                Some(unreachable) => -self.relative_deficit(unreachable),
                None => self.manipulator.serial(solution, leg).0,
            }),
            Gauge::Limit { coordinate, bound } => {
                if deficit(self.legs[coordinate]).is_some() {
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
            Gauge::Difference { number } => {
                let difference = &self.manipulator.differences()[number];
                let closed = difference.legs.into_iter().all(|leg| deficit(leg).is_none());
                closed.then(|| difference.room(&solution.joints))
            }
            Gauge::Motion { coordinate, limit } => {
                let motion = &sample.motion;
                let derivatives = match limit {
                    MotionLimit::Rate => &motion.joint_rates,
                    MotionLimit::Acceleration => &motion.joint_accelerations,
                };
                let largest = limit.of(&self.manipulator.coordinates()[coordinate].motion_limits)?;
                let allowed = largest * (1.0 + MOTION_TOLERANCE);
                (sample.reached && sample.regular).then(|| allowed - derivatives[coordinate].abs())
            }
            Gauge::Parallel { part } => {
                let Singularities { upper, lower, whole, .. } = &self.measured;
                let both = upper.parallel.is_some() && lower.parallel.is_some();
                let measure = match part {
                    GaugedPart::Section(Section::Upper) => upper.parallel,
                    GaugedPart::Section(Section::Lower) => lower.parallel,
                    GaugedPart::Whole => whole.parallel.filter(|_| !both),
                };
                measure.filter(|_| reached)
            }
        }
    }

    /// The reach deficit as a number without a unit: lengths are divided by the characteristic length.
    fn relative_deficit(&self, unreachable: &Unreachable) -> f64 {
        let scale = match unreachable.deficit.quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => self.length,
        };
        unreachable.deficit.excess / scale
    }

    /// Computes the slopes of the gauges of a sample.
    fn slope(
        &mut self,
        sample: &mut Sample,
        side: SlopeSide,
        probe: &mut Sample,
    ) -> Result<(), TrajectoryError> {
        let step = SLOPE_STEP / self.rate;
        let time = if side == SlopeSide::After { sample.time + step } else { sample.time - step };
        probe.solution.clone_from(&sample.solution);
        self.solve(time, NearestTo::Last, probe)?;
        // The step after rounding of the times.
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
