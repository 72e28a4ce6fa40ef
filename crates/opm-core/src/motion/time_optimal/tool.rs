//! Caps of the tool's speed and acceleration, as limits of the timing of a motion.
//!
//! The tool is the platform with its reference point `p`. With the parameter `s` of a path, its rate `√x` and its second
//! derivative `u`, the tool's speed is `|p'| √x` and its acceleration `p' u + p'' x`; its angular velocity and acceleration
//! are `ω √x` and `ω u + ω' x`, with the angular velocity `ω` for a unit rate of `s`. The cap of an acceleration is a disc in
//! the plane of the two vectors. The timing needs limits that are linear in `u` and `x`: a regular polygon inside the disc,
//! with [`STRIPS`] pairs of parallel sides, stands for it. It has corners along the first vector and across it, so that
//! straight ways, and curves at a constant speed, use all of the cap.

use super::{Derivatives, Limit, TimingError};
use crate::manipulator::{Manipulator, Mode, Solution};
use crate::motion::Instant;
use crate::numeric::Quantity;
use crate::velocity::Jacobians;
use nalgebra::{Vector3, Vector6};
use std::f64::consts::PI;

/// Pairs of parallel sides of the polygon: 99.9 % of the cap are used in the worst direction. Even, for corners across.
const STRIPS: usize = 36;

/// How far the pose moves on each side for the derivative of the twist, radians and shares of the mechanism's size: the error
/// is its square, 1e-10 of the derivative, and that of rounding is 1e-11.
const STEP: f64 = 1e-5;

/// Caps of the tool's motion. The tool is the platform: its reference point, and how it turns. `None` is no cap.
///
/// ```
/// use opm_core::Manipulator;
/// use opm_core::motion::{Ends, Path, PathLimits, PlatformMotion, Spline, ToolLimits};
///
/// // 100 mm along x, at 200 mm/s and 2 m/s² at most: 0.1 / 0.2 + 0.2 / 2 s.
/// let manipulator = Manipulator::example("delta")?;
/// let home = manipulator.home_pose();
/// let columns = vec![vec![home[0], home[0] + 0.1], vec![home[1]; 2], vec![home[2]; 2]];
/// let path = Path::Spline(Spline::new(vec![0.0, 1.0], columns, Ends::Rest)?);
/// let name = "ahead".to_owned();
/// let given = PlatformMotion { name, start: 0.0, duration: 1.0, rate: None, mode: None, path };
/// let tool = ToolLimits { speed: Some(0.2), acceleration: Some(2.0), ..ToolLimits::default() };
/// let limits = PathLimits { tool, efforts: None };
/// let timed = given.time_optimal_within(&manipulator, manipulator.home_mode(), limits)?;
/// assert!((timed.duration - 0.6).abs() < 6e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolLimits {
    /// The largest speed of the reference point, m/s.
    pub speed: Option<f64>,
    /// Its largest acceleration, m/s².
    pub acceleration: Option<f64>,
    /// The largest angular speed, rad/s.
    pub angular_speed: Option<f64>,
    /// The largest angular acceleration, rad/s².
    pub angular_acceleration: Option<f64>,
}

impl ToolLimits {
    /// The caps of speed and acceleration for the translation and for the rotation, with the first row of a twist.
    fn kinds(&self) -> [(usize, Option<f64>, Option<f64>); 2] {
        [(3, self.speed, self.acceleration), (0, self.angular_speed, self.angular_acceleration)]
    }

    /// Whether there is no cap.
    fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The first cap that is no number above zero.
    pub(super) fn odd(&self) -> Option<(&'static str, f64)> {
        let all = [
            ("speed", self.speed),
            ("acceleration", self.acceleration),
            ("angular speed", self.angular_speed),
            ("angular acceleration", self.angular_acceleration),
        ];
        let odd = |cap: f64| !(cap > 0.0 && cap.is_finite());
        all.into_iter().find_map(|(name, cap)| Some((name, cap.filter(|cap| odd(*cap))?)))
    }

    /// Whether every motion of the platform has a limited acceleration of the tool.
    pub(super) fn limit_all(&self, manipulator: &Manipulator) -> bool {
        manipulator.task_coordinates().iter().all(|c| match c.quantity {
            Quantity::Length => self.acceleration.is_some(),
            Quantity::Angle => self.angular_acceleration.is_some(),
        })
    }

    /// For the translation and for the rotation, the shares that a motion takes of the square of the largest speed and of the
    /// largest acceleration. Unlike the rows of the polygon, these are smooth where the tool turns back.
    pub(super) fn shares(&self, twists: &Twists, u: f64, x: f64) -> [[f64; 2]; 2] {
        let parts = self.kinds().into_iter().zip(twists);
        let mut shares = [[0.0; 2]; 2];
        for (shares, ((_, speed, acceleration), [rate, bend])) in shares.iter_mut().zip(parts) {
            let of = |cap: Option<f64>| cap.unwrap_or(f64::INFINITY);
            *shares = [
                rate.norm_squared() * x / of(speed).powi(2),
                (rate * u + bend * x).norm() / of(acceleration),
            ];
        }
        shares
    }

    /// The limits of what [`Tool::at`] gives.
    pub(super) fn rows(&self) -> Vec<Limit> {
        const FREE: f64 = f64::INFINITY;
        let inside = (0.5 * PI / STRIPS as f64).cos();
        let mut rows = Vec::new();
        for (_, speed, acceleration) in self.kinds() {
            rows.extend(speed.map(|rate| Limit { rate, acceleration: FREE }));
            let strip = acceleration.map(|most| Limit { rate: FREE, acceleration: most * inside });
            rows.extend(strip.into_iter().flat_map(|strip| [strip; STRIPS]));
        }
        rows
    }
}

/// The velocity and its derivative, of the reference point and of the rotation, for a unit rate of the parameter.
pub(super) type Twists = [[Vector3<f64>; 2]; 2];

/// The tool along a motion.
pub(super) struct Tool<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    pub limits: ToolLimits,
    solution: Solution,
    jacobians: Jacobians,
    moved: Vec<f64>,
}

impl<'a> Tool<'a> {
    /// That of a manipulator in a mode; `None` without a cap.
    pub fn new(manipulator: &'a Manipulator, mode: Mode, limits: ToolLimits) -> Option<Self> {
        let (solution, jacobians) = (manipulator.solution(), manipulator.jacobians());
        let tool = Self { manipulator, mode, limits, solution, jacobians, moved: Vec::new() };
        (!limits.is_empty()).then_some(tool)
    }

    /// Adds what is limited, as [`ToolLimits::rows`] has it, at an instant of the motion, and gives what it follows from.
    pub fn at(
        &mut self,
        instant: &Instant,
        time: f64,
        out: &mut Vec<Derivatives>,
    ) -> Result<Twists, TimingError> {
        let singular = || TimingError::Singular { time };
        let [first, second] = self.derivatives(instant).ok_or_else(singular)?;
        let mut twists = Twists::default();
        for (twist, (row, speed, acceleration)) in twists.iter_mut().zip(self.limits.kinds()) {
            *twist = [&first, &second].map(|twist| twist.fixed_rows::<3>(row).into_owned());
            let [rate, bend] = &*twist;
            if speed.is_some() {
                out.push([rate.norm(), 0.0]);
            }
            if acceleration.is_some() {
                out.extend(strips(rate, bend));
            }
        }
        Ok(twists)
    }

    /// The platform's twist and its derivative; `None` where coordinates have no rates.
    fn derivatives(&mut self, instant: &Instant) -> Option<[Vector6<f64>; 2]> {
        let [here, bend] = self.twists(instant, 0.0, [&instant.velocity, &instant.acceleration])?;
        Some([here, bend + self.change(instant, &here)?])
    }

    /// The twists for rates of the coordinates, at the pose of an instant moved by a multiple of its velocity. `None` where the
    /// pose is out of reach, or coordinates do not follow.
    fn twists<const N: usize>(
        &mut self,
        instant: &Instant,
        step: f64,
        rates: [&[f64]; N],
    ) -> Option<[Vector6<f64>; N]> {
        let Self { manipulator, mode, solution, jacobians, moved, .. } = self;
        moved.clear();
        moved.extend(instant.pose.iter().zip(&instant.velocity).map(|(q, v)| q + step * v));
        manipulator.inverse(moved, *mode, solution).ok()??;
        manipulator.differentiate(solution, jacobians).ok()?;
        let columns = manipulator.twist_by_pose(jacobians);
        let twists = rates.map(|rates| {
            let each = columns.column_iter().zip(rates);
            each.fold(Vector6::zeros(), |sum, (column, rate)| sum + column * *rate)
        });
        twists.iter().flatten().all(|part| part.is_finite()).then_some(twists)
    }

    /// The derivative of the twist while the pose moves on with constant rates, by differences to both sides, or to one where
    /// the other is out of reach.
    fn change(&mut self, instant: &Instant, here: &Vector6<f64>) -> Option<Vector6<f64>> {
        let size = self.manipulator.characteristic_length();
        let coordinates = self.manipulator.task_coordinates().iter().zip(&instant.velocity);
        let fastest = coordinates.fold(0.0_f64, |fastest, (c, rate)| match c.quantity {
            Quantity::Length => fastest.max(rate.abs() / size),
            Quantity::Angle => fastest.max(rate.abs()),
        });
        if fastest == 0.0 {
            return Some(Vector6::zeros());
        }
        let step = STEP / fastest;
        let mut at = |step| Some(self.twists(instant, step, [&instant.velocity])?[0]);
        match (at(-step), at(step)) {
            (Some(before), Some(after)) => Some((after - before) / (2.0 * step)),
            (None, Some(after)) => Some((after - here) / step),
            (Some(before), None) => Some((here - before) / step),
            (None, None) => None,
        }
    }
}

/// The components of `rate u + bend x` across the sides of the polygon.
fn strips(rate: &Vector3<f64>, bend: &Vector3<f64>) -> impl Iterator<Item = Derivatives> + use<> {
    let direction = |vector: &Vector3<f64>| vector.try_normalize(f64::MIN_POSITIVE);
    // At rest the way that begins or ends there has the direction.
    let along = direction(rate).or(direction(bend)).unwrap_or_else(Vector3::x);
    let speed = rate.norm();
    let straight = along.dot(bend);
    let across = (bend - along * straight).norm();
    (0..STRIPS).map(move |strip| {
        let (sin, cos) = (PI * (strip as f64 + 0.5) / STRIPS as f64).sin_cos();
        [cos * speed, cos * straight + sin * across]
    })
}
