//! Motions of the platform: its pose as a twice differentiable function of time.
//!
//! A motion comes from a motion file ([`mod@file`]: constants and sums of sinusoids, points that cubic splines join, or
//! lines and arcs with feed rates) or from a table of poses ([`table`]: cubic splines). Either way it is a formula in time with exact
//! derivatives, which can be evaluated at any time: nothing is sampled in advance.

mod clock;
mod columns;
pub mod examples;
#[cfg(feature = "files")]
pub mod file;
mod moves;
mod places;
mod points;
#[cfg(feature = "schema")]
mod schema;
mod spline;
pub mod table;
mod time_optimal;
mod timing;

use crate::manipulator::Mode;
pub use moves::{Move, MoveProblem, Moves, MovesError};
pub use spline::{Ends, Spline, SplineError};
use std::f64::consts::TAU;
pub use time_optimal::{PathEffort, PathEfforts, PathLimits, TimingError, ToolLimits};
pub use timing::{TimedPath, Timing};

/// A sinusoid `amplitude · sin(2π · frequency · t + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sinusoid {
    /// Amplitude, metres or radians.
    pub amplitude: f64,
    /// Frequency, hertz.
    pub frequency: f64,
    /// Phase, radians.
    pub phase: f64,
}

/// A constant plus a sum of sinusoids: one task coordinate as a function of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Harmonics {
    /// The constant, metres or radians.
    pub offset: f64,
    /// The sinusoids; empty for a coordinate that does not move.
    pub sinusoids: Vec<Sinusoid>,
}

/// The task coordinates as functions of time.
#[derive(Clone, Debug, PartialEq)]
pub enum Path {
    /// Every coordinate is a sum of sinusoids.
    Harmonics(Vec<Harmonics>),
    /// Every coordinate is a cubic spline; all of them have the same knots.
    Spline(Spline),
    /// Straight lines and arcs; the parameter is their length, and not time.
    Moves(Moves),
    /// Another path, with a timing of its own.
    Timed(TimedPath),
}

impl Path {
    /// Writes the pose and its derivatives at time `t`, in seconds, into `out`.
    fn at(&self, t: f64, out: &mut Instant) {
        match self {
            Self::Harmonics(coordinates) => {
                out.resize(coordinates.len());
                for (i, harmonics) in coordinates.iter().enumerate() {
                    let [value, first, second] = harmonics.at(t);
                    out.pose[i] = value;
                    out.velocity[i] = first;
                    out.acceleration[i] = second;
                }
            }
            Self::Spline(spline) => spline.at(t, out),
            Self::Moves(moves) => moves.at(t, out),
            Self::Timed(timed) => timed.at(t, out),
        }
    }

    /// The number of task coordinates.
    fn coordinate_count(&self) -> usize {
        match self {
            Self::Harmonics(coordinates) => coordinates.len(),
            Self::Spline(spline) => spline.column_count(),
            Self::Moves(moves) => moves.coordinate_count(),
            Self::Timed(timed) => timed.path.coordinate_count(),
        }
    }

    /// The times at which a derivative may jump, in order.
    fn knots(&self) -> &[f64] {
        match self {
            // The timing of moves has knots where they meet.
            Self::Harmonics(_) | Self::Moves(_) => &[],
            Self::Spline(spline) => spline.times(),
            Self::Timed(timed) => timed.timing.times(),
        }
    }
}

/// A motion of the platform, in the task coordinates of one manipulator.
///
/// ```
/// use opm_core::Manipulator;
/// use opm_core::motion::{Harmonics, Instant, Path, PlatformMotion, Sinusoid};
///
/// // x = 10 mm · sin(2π · 0.5 Hz · t); every other coordinate stays at home.
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let coordinates = manipulator.task_coordinates();
/// let mut path: Vec<_> = coordinates.iter().map(|c| Harmonics::constant(c.home)).collect();
/// path[0].sinusoids.push(Sinusoid { amplitude: 0.01, frequency: 0.5, phase: 0.0 });
/// let motion = PlatformMotion {
///     name: "swing".to_owned(),
///     start: 0.0,
///     duration: 2.0,
///     rate: None,
///     mode: None,
///     path: Path::Harmonics(path),
/// };
///
/// // A quarter of the period: x is at its end, where its speed is zero.
/// let mut instant = Instant::new(coordinates.len());
/// motion.at(0.5, &mut instant);
/// assert!((instant.pose[0] - coordinates[0].home - 0.01).abs() < 1e-15);
/// assert!(instant.velocity[0].abs() < 1e-15);
/// assert!((instant.acceleration[0] + 0.01 * std::f64::consts::PI.powi(2)).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PlatformMotion {
    /// The motion's name. For a table of poses the caller gives it.
    pub name: String,
    /// Start time, seconds.
    pub start: f64,
    /// Duration, seconds; positive.
    pub duration: f64,
    /// The sampling rate in hertz, if the motion's file gives one.
    pub rate: Option<f64>,
    /// The working mode, if the motion's file gives one.
    pub mode: Option<Mode>,
    /// The task coordinates as functions of time.
    pub path: Path,
}

/// The pose of the platform at one time, with its derivatives. Vectors are in the order of the task
/// coordinates; units are metres, radians and seconds. Rates of Euler angles are rates of these
/// angles, not an angular velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// The pose: task coordinates, metres or radians.
    pub pose: Vec<f64>,
    /// The first derivative of the pose by time, per second.
    pub velocity: Vec<f64>,
    /// The second derivative of the pose by time, per second squared.
    pub acceleration: Vec<f64>,
}

impl Instant {
    /// A buffer for `coordinates` task coordinates, filled with zeros.
    pub fn new(coordinates: usize) -> Self {
        let zeros = || vec![0.0; coordinates];
        Self { pose: zeros(), velocity: zeros(), acceleration: zeros() }
    }

    /// Makes this a buffer for `coordinates` task coordinates, if it is not one yet.
    fn resize(&mut self, coordinates: usize) {
        let Self { pose, velocity, acceleration } = self;
        for vector in [pose, velocity, acceleration] {
            vector.resize(coordinates, 0.0);
        }
    }
}

impl PlatformMotion {
    /// Writes the pose and its derivatives at time `t`, in seconds, into `out`. Times beyond the
    /// ends of a spline give the values at its end. Nothing is allocated if `out` was made for this
    /// number of coordinates; otherwise it is resized.
    pub fn at(&self, t: f64, out: &mut Instant) {
        self.path.at(t, out);
    }

    /// The number of task coordinates that the motion gives.
    pub fn coordinate_count(&self) -> usize {
        self.path.coordinate_count()
    }

    /// End time, seconds.
    pub fn end(&self) -> f64 {
        self.start + self.duration
    }
}

impl Harmonics {
    /// A coordinate that stays constant.
    pub fn constant(offset: f64) -> Self {
        Self { offset, sinusoids: Vec::new() }
    }

    /// The value and its first and second derivative by time.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let mut sum = [self.offset, 0.0, 0.0];
        for Sinusoid { amplitude, frequency, phase } in &self.sinusoids {
            let rate = TAU * frequency;
            let (sin, cos) = (rate * t + phase).sin_cos();
            sum[0] += amplitude * sin;
            sum[1] += amplitude * rate * cos;
            sum[2] -= amplitude * rate * rate * sin;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pendulum is at its end, at rest, a quarter of a period after the middle.
    #[test]
    fn a_sinusoid_is_where_a_pendulum_is() {
        let swing = Sinusoid { amplitude: 0.5, frequency: 2.0, phase: TAU / 4.0 };
        let slow = Sinusoid { amplitude: 3.0, frequency: 0.25, phase: 0.0 };
        let harmonics = Harmonics { offset: 1.0, sinusoids: vec![swing, slow] };
        let rate = [2.0 * TAU, 0.25 * TAU];
        // At t = 1 s the first sinusoid has made two periods, from its end; the slow one is at its
        // end.
        let [value, first, second] = harmonics.at(1.0);
        assert!((value - (1.0 + 0.5 + 3.0)).abs() < 1e-14);
        assert!(first.abs() < 1e-13);
        assert!((second + 0.5 * rate[0] * rate[0] + 3.0 * rate[1] * rate[1]).abs() < 1e-11);
        // An eighth of a second later the first sinusoid passes the middle, downwards.
        let [value, first, _] = harmonics.at(1.125);
        let angle = rate[1] * 1.125;
        assert!((value - (1.0 + 3.0 * angle.sin())).abs() < 1e-14);
        assert!((first - (-0.5 * rate[0] + 3.0 * rate[1] * angle.cos())).abs() < 1e-13);
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        let sinusoid = |i: f64| Sinusoid { amplitude: 1.0 / i, frequency: 0.3 * i, phase: i };
        let harmonics =
            Harmonics { offset: -2.0, sinusoids: (1..5).map(|i| sinusoid(f64::from(i))).collect() };
        const STEP: f64 = 1e-5;
        // The error is STEP² / 6 times the sum of amplitude · rate⁴, plus rounding.
        const DIFFERENCE: f64 = 1e-7;
        for i in 0..100 {
            let t = 0.173 * f64::from(i);
            let [before, at, after] = [t - STEP, t, t + STEP].map(|t| harmonics.at(t));
            for order in 0..2 {
                let difference = (after[order] - before[order]) / (2.0 * STEP);
                assert!((difference - at[order + 1]).abs() < DIFFERENCE, "{t}: order {order}");
            }
        }
    }
}
