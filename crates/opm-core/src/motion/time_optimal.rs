//! The fastest timing along the path of a motion, within the limits of the joints' rates and accelerations, of efforts ([`efforts`])
//! and of the tool's motion ([`tool`]).
//!
//! The parameter `s` is the motion's own time, so the joints' derivatives by it, `q'` and `q''`, are the rates and
//! accelerations along the motion. With `x = (ds/dt)²` and `u = d²s/dt²`, the joints have the rate `q' √x` and the
//! acceleration `q' u + q'' x`. On a grid, `u` is constant between two points, so that `x` is linear there. The method is
//! TOPP-RA (H. Pham, Q.-C. Pham, *A New Approach to Time-Optimal Path Parameterization Based on Reachability Analysis*,
//! IEEE Transactions on Robotics 34, 2018):
//!
//! * backwards, the largest `x` at each point from which the end can still be reached (controllable sets; as every limit
//!   holds in both directions, they all contain `x = 0`);
//! * forwards, from each point to the largest `x` at the next one that is in its controllable set.
//!
//! Both ends of an interval obey the limits with the `u` of the interval (the interpolation scheme of the paper), which
//! keeps accelerations steady where a joint reverses. The grid is refined until the limits hold between its points too.
//! What rounding and the last [`EXCESS`] leave is removed by a slower clock for the whole motion.
//!
//! At an end at which the motion itself is at rest, `q'` is zero and every `ds/dt` is rest: `x` is free there, and the
//! acceleration `q'' x` limits it. At other ends `x` is zero.

mod efforts;
mod error;
mod half_planes;
mod limits;
mod tool;

pub use efforts::{PathEffort, PathEfforts};
pub use error::TimingError;
pub use limits::PathLimits;
pub use tool::ToolLimits;

use super::{Instant, Path, PlatformMotion, TimedPath, Timing};
use crate::manipulator::{Manipulator, Mode, Solution};
use crate::mechanism::joint::DriveLimit;
use crate::velocity::{JointMotion, VelocityError};
use efforts::Effort;
use half_planes::{HalfPlane, largest_end, largest_start};
use limits::{Limit, all_limited, limits};
use tool::{Tool, Twists};

/// The smallest number of intervals of the grid. The duration is above the shortest by a share of the order of one in
/// this number, because accelerations are at their limits at one end of each interval.
const INTERVALS: f64 = 4000.0;

/// The grid is refined until no square of a rate and no acceleration is above its limit by more than this share of it.
const EXCESS: f64 = 5e-7;

/// How often a timing is computed anew with viscous friction at the speeds of the last one.
const REPETITIONS: usize = 4;

/// How much larger a square may be than in the last timing: the tighter, the better the line for braking friction.
const NEAR: f64 = 1.2;

/// How often intervals are halved at most.
const ROUNDS: usize = 24;

/// The largest number of intervals.
const MOST_INTERVALS: usize = 1 << 20;

/// Where rates and accelerations of an interval are compared with their limits.
const QUARTERS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The ends of an interval are evaluated this share of it inside (far less than [`ROOM`]), because second derivatives may jump between intervals.
const INSET: f64 = 1e-9;

/// The forward pass stays this share below the largest `x`. Where a joint has `q' = 0`, an `x` right at the largest one
/// would leave no choice of `u`. Sets that contain zero and are convex can be reached as well when they are shrunk.
const ROOM: f64 = 1e-7;

/// A motion is at rest at an end if all speeds are at most this share of the largest ones.
const REST: f64 = 1e-9;

/// The largest `x` as a multiple of the usual one, for places where the motion stands still for a while: they are passed
/// a thousand times faster than others.
const FASTEST: f64 = 1e6;

impl PlatformMotion {
    /// The same path, from rest to rest, in the shortest time within `max_rate` and `max_acceleration` of all joints
    /// that have them. Every actuated joint must have a `max_acceleration`.
    ///
    /// Rates and accelerations stay within their limits between the points of the grid too. The duration is above the
    /// shortest possible one by less than 5e-4 of it where that is known in closed form, mostly by less than 1e-4. Limits of the joints' values and
    /// singularities are not considered.
    ///
    /// # Errors
    /// [`TimingError`]: an actuated joint has no limit, nothing moves, or the motion cannot be followed.
    pub fn time_optimal(&self, manipulator: &Manipulator, mode: Mode) -> Result<Self, TimingError> {
        self.time_optimal_within(manipulator, mode, PathLimits::default())
    }

    /// The same, also within the largest efforts of actuators and caps of the tool's motion. Each actuator needs a
    /// `max_acceleration` or a `max_effort`, if the caps do not limit all accelerations: that of the reference point where
    /// a task coordinate is a length, and the angular one where one is an angle.
    ///
    /// # Errors
    /// As for [`PlatformMotion::time_optimal`]; also if an actuator cannot stand what there is at rest, efforts are not known,
    /// or a cap is not above zero.
    pub fn time_optimal_within(
        &self,
        manipulator: &Manipulator,
        mode: Mode,
        PathLimits { tool, efforts }: PathLimits<'_>,
    ) -> Result<Self, TimingError> {
        if let Some((name, cap)) = tool.odd() {
            return Err(TimingError::Cap { name, cap });
        }
        if !tool.limit_all(manipulator) {
            all_limited(manipulator, efforts.as_deref())?;
        }
        let (numbers, mut limits) = limits(manipulator);
        limits.extend(tool.rows());
        let (given, expected) = (self.coordinate_count(), manipulator.task_coordinates().len());
        if given != expected {
            return Err(TimingError::Coordinates { given, expected });
        }
        let moving = (self, manipulator, mode);
        let mut joints = Joints::new(moving, (&numbers, &limits), PathLimits { tool, efforts });
        let mut grid = Grid::new(&mut joints)?;
        let (mut squares, mut excess);
        let mut round = 0;
        loop {
            squares = grid.squares(&limits);
            let excesses = grid.excesses(&mut joints, &squares)?;
            excess = excesses.iter().copied().fold(0.0, f64::max);
            let more = excesses.iter().filter(|&&excess| excess > EXCESS).count();
            if more == 0 || round == ROUNDS || grid.intervals.len() + more > MOST_INTERVALS {
                break;
            }
            grid.refine(&mut joints, &excesses)?;
            round += 1;
        }
        // A clock that is slower by the factor k divides rates by k and accelerations by k².
        squares.iter_mut().for_each(|square| *square /= 1.0 + excess + EXCESS);
        let timing = Timing::new(grid.points.clone(), &squares, self.start)
            .map_err(|knot| TimingError::Singular { time: grid.points[knot] })?;
        let duration = timing.end() - self.start;
        let path = Path::Timed(TimedPath { path: Box::new(self.path.clone()), timing });
        Ok(Self { duration, path, ..self.clone() })
    }
}

/// The first and the second derivative by the parameter of a limited joint, or of what else is limited.
type Derivatives = [f64; 2];

/// What is limited at a point of the path.
#[derive(Clone, Debug)]
struct Place {
    /// The derivatives of every limited joint, and of the tool.
    joints: Vec<Derivatives>,
    /// What the tool's rows follow from.
    twists: Twists,
    /// The efforts of every limited actuator.
    efforts: Vec<Effort>,
}

/// The joints along the motion.
struct Joints<'a, 'e> {
    motion: &'a PlatformMotion,
    manipulator: &'a Manipulator,
    mode: Mode,
    /// The numbers of the joint coordinates that have limits.
    numbers: &'a [usize],
    /// Their limits, and then those of the tool.
    limits: &'a [Limit],
    tool: Option<Tool<'a>>,
    instant: Instant,
    solution: Solution,
    rates: JointMotion,
    efforts: Option<&'e mut (dyn PathEfforts + 'e)>,
}

impl<'a, 'e> Joints<'a, 'e> {
    fn new(
        (motion, manipulator, mode): (&'a PlatformMotion, &'a Manipulator, Mode),
        (numbers, limits): (&'a [usize], &'a [Limit]),
        PathLimits { tool, efforts }: PathLimits<'e>,
    ) -> Self {
        let tool = Tool::new(manipulator, mode, tool);
        let instant = Instant::new(manipulator.task_coordinates().len());
        let (solution, rates) = (manipulator.solution(), manipulator.joint_motion());
        Self { motion, manipulator, mode, numbers, limits, tool, instant, solution, rates, efforts }
    }

    /// What is limited at a point.
    fn at(&mut self, time: f64) -> Result<Place, TimingError> {
        let Self { motion, manipulator, mode, numbers, tool, instant, solution, rates, .. } = self;
        motion.at(time, instant);
        let reached = manipulator.inverse(&instant.pose, *mode, solution);
        if reached.map_err(|source| TimingError::Pose { time, source })?.is_none() {
            let leg = solution.unreachable().first().map_or(0, |unreachable| unreachable.leg);
            let leg = manipulator.mechanism().legs[leg].name.clone();
            return Err(TimingError::OutOfReach { time, leg });
        }
        let regular =
            manipulator.velocity(solution, &instant.velocity, &instant.acceleration, rates);
        match regular {
            Ok(true) => {}
            Ok(false) | Err(VelocityError::Overflow { .. }) => {
                return Err(TimingError::Singular { time });
            }
            Err(source) => return Err(TimingError::Velocity { time, source }),
        }
        let of = |&number: &usize| [rates.joint_rates[number], rates.joint_accelerations[number]];
        let mut joints: Vec<Derivatives> = numbers.iter().map(of).collect();
        let twists = match tool {
            Some(tool) => tool.at(instant, time, &mut joints)?,
            None => Twists::default(),
        };
        Ok(Place { joints, twists, efforts: self.efforts_at(time)? })
    }

    /// The efforts of every limited actuator at the solution.
    fn efforts_at(&mut self, time: f64) -> Result<Vec<Effort>, TimingError> {
        let Some(model) = &mut self.efforts else { return Ok(Vec::new()) };
        let mut found = vec![PathEffort::default(); model.limits().len()];
        if !model.at(&self.solution, &self.rates, &mut found) {
            return Err(TimingError::NoEffort { time });
        }
        let each = model.limits().iter().zip(found);
        each.map(|(&(number, limit), of)| {
            let room = [limit - of.still, limit + of.still];
            if room[0] > 0.0 && room[1] > 0.0 {
                return Ok(Effort { of, room });
            }
            let coordinate = &self.manipulator.coordinates()[number];
            let unit = DriveLimit::Effort.unit(coordinate.quantity);
            let (joint, effort) = (coordinate.name.clone(), of.still.abs());
            Err(TimingError::Effort { time, joint, effort, limit, unit })
        })
        .collect()
    }
}

/// The interval between two points of the grid: what is limited at its ends.
struct Interval([Place; 2]);

/// The points at which the timing is computed.
struct Grid {
    /// The parameter at the points, increasing.
    points: Vec<f64>,
    /// The intervals between them.
    intervals: Vec<Interval>,
    /// The largest `x` at the first and at the last point.
    ends: [f64; 2],
    /// The largest `x` anywhere.
    fastest: f64,
}

impl Grid {
    fn new(joints: &mut Joints<'_, '_>) -> Result<Self, TimingError> {
        let motion = joints.motion;
        let mut knots = vec![motion.start];
        let inside = |t: &&f64| **t > motion.start && **t < motion.end();
        knots.extend(motion.path.knots().iter().filter(inside));
        knots.push(motion.end());
        let mut points = vec![motion.start];
        for pair in knots.windows(2) {
            let width = pair[1] - pair[0];
            let parts = (INTERVALS * width / motion.duration).ceil().max(2.0) as usize;
            points.extend((1..parts).map(|i| pair[0] + width * i as f64 / parts as f64));
            points.push(pair[1]);
        }
        let mut intervals = Vec::with_capacity(points.len());
        for pair in points.windows(2) {
            intervals.push(Interval::new(joints, [pair[0], pair[1]])?);
        }
        let mut grid = Self { points, intervals, ends: [0.0; 2], fastest: f64::INFINITY };
        grid.limit_ends(joints);
        if grid.fastest.is_finite() { Ok(grid) } else { Err(TimingError::Still) }
    }

    /// Finds the largest `x` anywhere, and at both ends.
    fn limit_ends(&mut self, joints: &Joints<'_, '_>) {
        let Joints { motion, limits, .. } = joints;
        let mut instant = joints.instant.clone();
        let mut largest = vec![0.0_f64; instant.velocity.len()];
        let mut moves = Vec::with_capacity(self.points.len());
        for &point in &self.points {
            motion.at(point, &mut instant);
            for (largest, velocity) in largest.iter_mut().zip(&instant.velocity) {
                *largest = largest.max(velocity.abs());
            }
            moves.push(instant.velocity.clone());
        }
        let rests = |velocity: &[f64]| {
            velocity.iter().zip(&largest).all(|(now, largest)| now.abs() <= REST * largest)
        };
        let mut usual: Vec<f64> = Vec::new();
        for (interval, velocity) in self.intervals.iter().zip(&moves) {
            let of = |(limit, [first, second]): (&Limit, &Derivatives)| {
                let by_rate = limit.rate / first.abs();
                let by_acceleration =
                    limit.acceleration / (second.abs() + first.abs() / motion.duration);
                (by_rate * by_rate).min(by_acceleration)
            };
            if !rests(velocity) {
                let Place { joints, efforts, .. } = &interval.0[0];
                let by_effort = efforts.iter().map(|effort| effort.usual_square(motion.duration));
                let each = limits.iter().zip(joints).map(of).chain(by_effort);
                usual.push(each.fold(f64::INFINITY, f64::min));
            }
        }
        usual.sort_by(f64::total_cmp);
        self.fastest = usual.get(usual.len() / 2).map_or(f64::INFINITY, |usual| FASTEST * usual);
        let [first, last] = [0, moves.len() - 1];
        self.ends = [first, last].map(|end| if rests(&moves[end]) { self.fastest } else { 0.0 });
    }

    /// The squares of the parameter's rate at the points.
    fn squares(&self, limits: &[Limit]) -> Vec<f64> {
        let most = self.largest(limits);
        let mut squares = self.squares_about(limits, &most, &most);
        let viscous = |place: &Place| place.efforts.iter().any(|effort| effort.of.viscous != 0.0);
        if self.intervals.iter().flat_map(|interval| &interval.0).any(viscous) {
            for _ in 0..REPETITIONS {
                let near = most.iter().zip(&squares);
                let near = near.map(|(most, x)| most.min(NEAR * x).max(efforts::LEAST * most));
                squares = self.squares_about(limits, &near.collect::<Vec<_>>(), &squares);
            }
        }
        squares
    }

    /// The largest squares by the limits of rates, and of efforts against friction.
    fn largest(&self, limits: &[Limit]) -> Vec<f64> {
        let last = self.intervals.len();
        let mut largest = vec![self.fastest; last + 1];
        for (i, Interval(ends)) in self.intervals.iter().enumerate() {
            let joints = ends.each_ref().map(|place| &place.joints);
            for (limit, [before, after]) in
                limits.iter().zip(joints[0].iter().zip(joints[1]).map(|(a, b)| [a[0], b[0]]))
            {
                largest[i] = largest[i].min((limit.rate / before).powi(2));
                largest[i + 1] = largest[i + 1].min((limit.rate / after).powi(2));
            }
            for (end, place) in ends.iter().enumerate() {
                let by_friction = place.efforts.iter().map(Effort::largest_square);
                largest[i + end] = by_friction.fold(largest[i + end], f64::min);
            }
        }
        largest
    }

    /// Controllable sets backwards, then the largest values forwards, with viscous friction about some squares.
    fn squares_about(&self, limits: &[Limit], most: &[f64], guess: &[f64]) -> Vec<f64> {
        let last = self.intervals.len();
        let mut largest = most.to_vec();
        largest[0] = largest[0].min(self.ends[0]);
        largest[last] = largest[last].min(self.ends[1]);
        let mut planes = Vec::new();
        for i in (0..last).rev() {
            self.half_planes(i, limits, [guess, most], &mut planes);
            largest[i] = largest_start(&planes, [largest[i], largest[i + 1]]);
        }
        largest.iter_mut().for_each(|largest| *largest *= 1.0 - ROOM);
        let mut squares = vec![largest[0]];
        for i in 0..last {
            self.half_planes(i, limits, [guess, most], &mut planes);
            squares.push(largest_end(&planes, squares[i], largest[i + 1]));
        }
        squares
    }

    /// The limits of accelerations and efforts in an interval, at its two ends.
    fn half_planes(
        &self,
        i: usize,
        limits: &[Limit],
        [guess, most]: [&[f64]; 2],
        planes: &mut Vec<HalfPlane>,
    ) {
        // u = (y - x) / twice.
        let twice = 2.0 * (self.points[i + 1] - self.points[i]);
        let Interval(ends) = &self.intervals[i];
        planes.clear();
        for (end, place) in ends.iter().enumerate() {
            let mut add = |by_u: f64, by_x: f64, c: f64| {
                planes.push(match end {
                    0 => HalfPlane::at_start(by_u, by_x, c, twice),
                    _ => HalfPlane::at_end(by_u, by_x, c, twice),
                });
            };
            for (limit, [first, second]) in limits.iter().zip(&place.joints) {
                if limit.acceleration.is_finite() {
                    add(*first, *second, limit.acceleration);
                    add(-first, -second, limit.acceleration);
                }
            }
            for effort in &place.efforts {
                effort.half_planes([guess[i + end], most[i + end]], &mut add);
            }
        }
    }

    /// For each interval, by which share a square of a rate, an acceleration or an effort is above its limit: at the quarters, and
    /// between them where it has its peak there.
    fn excesses(
        &self,
        joints: &mut Joints<'_, '_>,
        squares: &[f64],
    ) -> Result<Vec<f64>, TimingError> {
        let mut excesses = Vec::with_capacity(self.intervals.len());
        // Shares of the limits of each joint, of the tool twice, and of each effort: of the square of its rate, and of its acceleration.
        let count = joints.efforts.as_ref().map_or(0, |efforts| efforts.limits().len());
        let (own, tool) = (joints.numbers.len(), joints.tool.as_ref().map(|tool| tool.limits));
        let mut shares = vec![[[0.0; QUARTERS.len()]; 2]; own + 2 + count];
        for (i, Interval(ends)) in self.intervals.iter().enumerate() {
            let [from, to] = [self.points[i], self.points[i + 1]];
            let [x, y] = [squares[i], squares[i + 1]];
            let u = (y - x) / (2.0 * (to - from));
            for (place, share) in QUARTERS.into_iter().enumerate() {
                let square = x + share * (y - x);
                let between;
                let Place { joints: derivatives, twists, efforts } = match share {
                    0.0 => &ends[0],
                    1.0 => &ends[1],
                    share => {
                        between = joints.at(from + share * (to - from))?;
                        &between
                    }
                };
                let each = joints.limits.iter().zip(derivatives).zip(&mut shares[..own]);
                for ((limit, [first, second]), shares) in each {
                    let rate = first / limit.rate;
                    shares[0][place] = rate * rate * square;
                    shares[1][place] = (first * u + second * square) / limit.acceleration;
                }
                let of_tool = tool.map(|tool| tool.shares(twists, u, square));
                for (shares, found) in shares[own..].iter_mut().zip(of_tool.iter().flatten()) {
                    [shares[0][place], shares[1][place]] = *found;
                }
                for (effort, shares) in efforts.iter().zip(&mut shares[own + 2..]) {
                    // A slower clock lessens viscous friction by half as much as what else there is.
                    let weight = if effort.of.viscous == 0.0 { 1.0 } else { 2.0 };
                    for (to, share) in shares.iter_mut().zip(effort.shares(u, square)) {
                        to[place] = if share > 1.0 { 1.0 + weight * (share - 1.0) } else { share };
                    }
                }
            }
            let most = shares.as_flattened().iter().map(peak).fold(0.0, f64::max);
            excesses.push((most - 1.0).max(0.0));
        }
        Ok(excesses)
    }

    /// Halves the intervals with too large an excess.
    fn refine(&mut self, joints: &mut Joints<'_, '_>, excesses: &[f64]) -> Result<(), TimingError> {
        let mut points = vec![self.points[0]];
        let mut intervals = Vec::with_capacity(self.intervals.len());
        let old = std::mem::take(&mut self.intervals);
        for (i, interval) in old.into_iter().enumerate() {
            let [from, to] = [self.points[i], self.points[i + 1]];
            let middle = from + 0.5 * (to - from);
            if excesses[i] > EXCESS && middle > from && middle < to {
                intervals.push(Interval::new(joints, [from, middle])?);
                intervals.push(Interval::new(joints, [middle, to])?);
                points.push(middle);
            } else {
                intervals.push(interval);
            }
            points.push(to);
        }
        (self.points, self.intervals) = (points, intervals);
        Ok(())
    }
}

/// The largest size of what has these values at equal distances: of the values, and of the peaks of the parabolas through
/// three of them.
fn peak(values: &[f64; QUARTERS.len()]) -> f64 {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    values.windows(3).fold(largest, |largest, three| {
        let (rise, bend) = (three[2] - three[0], three[2] - 2.0 * three[1] + three[0]);
        match rise.abs() < 2.0 * bend.abs() {
            true => largest.max((three[1] - rise * rise / (8.0 * bend)).abs()),
            false => largest,
        }
    })
}

impl Interval {
    fn new(joints: &mut Joints<'_, '_>, [from, to]: [f64; 2]) -> Result<Self, TimingError> {
        let inset = INSET * (to - from);
        Ok(Self([joints.at(from + inset)?, joints.at(to - inset)?]))
    }
}
