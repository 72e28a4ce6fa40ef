//! Interference along a motion: when, which pair, and by how much; also between samples.
//!
//! The distance of each pair is a continuous function of time. As with the gauges of a
//! [`Trajectory`](opm_core::trajectory), its value and its slope are computed at each sample at which it may matter
//! ([`moved`]): most pairs are far apart most of the time. Where it crosses the clearance between two samples, the time is
//! found by bisection; where it falls at the first sample and rises at the second, its lowest value by a golden-section
//! search, and then both crossings. So these are all contacts that are deeper than 1e-9 of the mechanism's size, if there are
//! several samples in each period of the motion's highest frequency, and no distance falls and rises several times between
//! two samples.

mod moved;

use crate::distances::{Distances, Nearest};
use moved::Moved;
use opm_core::manipulator::{Manipulator, Mode, PoseError, Solution};
use opm_core::motion::{Instant, PlatformMotion};
use parry3d_f64::math::Vector;

/// The accuracy of times, as a share of the step between two samples.
const RESOLUTION: f64 = 1e-10;

/// Slopes are differences over this share of the step.
const SLOPE_STEP: f64 = 1e-3;

/// A distance that changes by less than this in a step, as a share of the mechanism's size, neither falls nor rises. Where two
/// bodies keep their distance, it changes by rounding.
const NO_CHANGE: f64 = 1e-9;

/// The number of steps of a golden-section search, which shrink the interval to 1e-8 of its length.
const STEPS: usize = 39;
/// The golden section, `(√5 − 1) / 2`.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// A part of a motion in which two bodies are nearer than the clearance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The number of the pair.
    pub pair: usize,
    /// The time when it begins, seconds.
    pub start: f64,
    /// The time when it ends, seconds: the last sample in reach, if the motion leaves the mechanism's reach.
    pub end: f64,
    /// The time when the two are nearest, seconds.
    pub worst: f64,
    /// Their distance then, metres; negative where they overlap.
    pub distance: f64,
}

/// The motion whose contacts are found.
#[derive(Clone, Copy, Debug)]
pub struct Watched<'a> {
    /// The manipulator.
    pub manipulator: &'a Manipulator,
    /// The motion.
    pub motion: &'a PlatformMotion,
    /// The working mode.
    pub mode: Mode,
    /// The least distance that is no contact, metres.
    pub clearance: f64,
}

/// Finds contacts along a motion, sample by sample.
pub struct Watch<'a> {
    of: Watched<'a>,
    distances: Distances<'a>,
    solver: Solver,
    last: Option<Sampled>,
    moved: Moved,
    open: Vec<Option<Contact>>,
    found: Vec<Contact>,
    nearest: Option<(Nearest, f64)>,
}

/// Buffers for a solution at any time.
struct Solver {
    instant: Instant,
    solution: Solution,
}

/// The ends of every capsule, in units of the mechanism's size.
type Ends = Vec<[Vector; 2]>;

/// A sample in reach.
struct Sampled {
    time: f64,
    solution: Solution,
    ends: Ends,
    /// A little after and before the sample; `None` where that is not part of the motion, or out of reach.
    after: Option<Beside>,
    before: Option<Beside>,
}

/// A pose beside a sample.
struct Beside {
    /// How much later it is, seconds.
    by: f64,
    ends: Ends,
}

impl<'a> Watch<'a> {
    /// Prepares to watch a motion; `distances` are working memory for the manipulator's pairs.
    pub fn new(of: Watched<'a>, distances: Distances<'a>) -> Self {
        let interference = distances.interference();
        let open = vec![None; interference.pairs()];
        let moved = Moved::new(interference);
        let instant = Instant::new(of.manipulator.task_coordinates().len());
        let solver = Solver { instant, solution: of.manipulator.solution() };
        let (last, found, nearest) = (None, Vec::new(), None);
        Self { of, distances, solver, last, moved, open, found, nearest }
    }

    /// Takes the next sample: its time, seconds, the step to its neighbours, and its solution if it is in reach.
    ///
    /// # Errors
    /// A pose of the motion cannot be computed with.
    pub fn advance(
        &mut self,
        time: f64,
        step: f64,
        solution: Option<&Solution>,
    ) -> Result<(), PoseError> {
        let Some(solution) = solution else {
            self.close_all();
            return Ok(());
        };
        let last = self.last.take();
        let by = SLOPE_STEP * step;
        let ahead = time + by < self.of.motion.end();
        let after = if ahead { self.beside(time, by, solution)? } else { None };
        let before = if last.is_some() { self.beside(time, -by, solution)? } else { None };
        self.distances.place(self.of.manipulator, solution);
        let ends = self.distances.ends().to_vec();
        let sampled = Sampled { time, solution: solution.clone(), ends, after, before };
        if let Some(last) = &last {
            self.moved.add(self.distances.interference(), last, &sampled);
        }
        for pair in 0..self.open.len() {
            let Some(last) = &last else {
                let level = self.level(&sampled.ends, pair);
                if level < 0.0 {
                    self.open(pair, time);
                }
                self.measured(pair, time, level);
                continue;
            };
            if !self.moved.is_far(self.distances.interference(), pair) {
                let level = self.between(pair, last, &sampled)?;
                self.measured(pair, time, level);
            }
        }
        self.last = Some(sampled);
        Ok(())
    }

    /// The contacts in the order of time, and the nearest pair with its time, seconds.
    pub fn finish(mut self) -> (Vec<Contact>, Option<(Nearest, f64)>) {
        self.close_all();
        self.found.sort_by(|a, b| a.start.total_cmp(&b.start).then(a.pair.cmp(&b.pair)));
        (self.found, self.nearest)
    }

    /// Ends all contacts at the last sample.
    fn close_all(&mut self) {
        if let Some(last) = self.last.take() {
            for open in &mut self.open {
                self.found.extend(open.take().map(|contact| Contact { end: last.time, ..contact }));
            }
        }
    }

    /// The distance of a pair less the clearance, metres.
    fn level(&self, ends: &[[Vector; 2]], pair: usize) -> f64 {
        self.distances.interference().distance(ends, pair) - self.of.clearance
    }

    /// Places the bodies at a time; `None` out of reach. Angles are those nearest to a solution.
    fn place(&mut self, time: f64, near: &Solution) -> Result<Option<()>, PoseError> {
        let Solver { instant, solution } = &mut self.solver;
        self.of.motion.at(time, instant);
        solution.clone_from(near);
        let found = self.of.manipulator.inverse_near(&instant.pose, self.of.mode, solution)?;
        let Some(found) = found else { return Ok(None) };
        self.distances.place(self.of.manipulator, found);
        Ok(Some(()))
    }

    fn beside(&mut self, time: f64, by: f64, near: &Solution) -> Result<Option<Beside>, PoseError> {
        let placed = self.place(time + by, near)?;
        Ok(placed.map(|()| Beside { by, ends: self.distances.ends().to_vec() }))
    }

    /// The level of one pair at a time; infinite out of reach.
    fn level_at(&mut self, pair: usize, time: f64, near: &Solution) -> Result<f64, PoseError> {
        let placed = self.place(time, near)?;
        Ok(placed.map_or(f64::INFINITY, |()| self.level(self.distances.ends(), pair)))
    }

    fn open(&mut self, pair: usize, start: f64) {
        let distance = f64::INFINITY;
        self.open[pair] = Some(Contact { pair, start, end: start, worst: start, distance });
    }

    fn close(&mut self, pair: usize, end: f64) {
        let closed = self.open[pair].take().map(|contact| Contact { end, ..contact });
        self.found.extend(closed);
    }

    /// Notes the level of a pair at a time: for its open contact, and for the nearest pair.
    fn note(&mut self, pair: usize, time: f64, level: f64) {
        let distance = level + self.of.clearance;
        if let Some(open) = &mut self.open[pair]
            && distance < open.distance
        {
            (open.worst, open.distance) = (time, distance);
        }
        if distance < self.nearest_yet() {
            self.nearest = Some((Nearest { pair, distance }, time));
        }
    }

    /// The distance of the nearest pair up to now, metres.
    fn nearest_yet(&self) -> f64 {
        self.nearest.map_or(f64::INFINITY, |(nearest, _)| nearest.distance)
    }

    /// Notes the level of a pair at a sample, and by how much that is above what counts: a contact, or the nearest pair's
    /// distance.
    fn measured(&mut self, pair: usize, time: f64, level: f64) {
        self.note(pair, time, level);
        let spare = level.min(level + self.of.clearance - self.nearest_yet());
        let interference = self.distances.interference();
        self.moved.measured(interference, pair, spare / interference.unit);
    }

    /// Finds what happens to a pair between two samples. Returns its level at the second one.
    fn between(&mut self, pair: usize, from: &Sampled, to: &Sampled) -> Result<f64, PoseError> {
        let [a, b] = [from, to].map(|sample| self.level(&sample.ends, pair));
        let dip = if self.dips(pair, from, to, [a, b]) {
            Some(self.lowest(pair, from, to)?).filter(|&(_, level)| level < a.min(b))
        } else {
            None
        };
        if let Some((time, level)) = dip {
            if level < 0.0 && a >= 0.0 {
                let start = self.crossing(pair, from, [from.time, time])?;
                self.open(pair, start);
            }
            self.note(pair, time, level);
            if level < 0.0 && b >= 0.0 {
                let end = self.crossing(pair, from, [to.time, time])?;
                self.close(pair, end);
            }
        } else if a >= 0.0 && b < 0.0 {
            let start = self.crossing(pair, from, [from.time, to.time])?;
            self.open(pair, start);
        } else if a < 0.0 && b >= 0.0 {
            let end = self.crossing(pair, from, [to.time, from.time])?;
            self.close(pair, end);
        }
        Ok(b)
    }

    /// Whether a level falls at the first of two samples and rises at the second.
    fn dips(&self, pair: usize, from: &Sampled, to: &Sampled, [a, b]: [f64; 2]) -> bool {
        let (Some(after), Some(before)) = (&from.after, &to.before) else { return false };
        let slope = |beside: &Beside, at: f64| (self.level(&beside.ends, pair) - at) / beside.by;
        let least = NO_CHANGE * self.distances.interference().unit / (to.time - from.time);
        slope(after, a) < -least && slope(before, b) > least
    }

    /// The time at which a level becomes negative, from a time at which it is not to one at which it is.
    fn crossing(
        &mut self,
        pair: usize,
        from: &Sampled,
        [mut outside, mut inside]: [f64; 2],
    ) -> Result<f64, PoseError> {
        let step = (inside - outside).abs();
        while (inside - outside).abs() > RESOLUTION * step {
            let middle = 0.5 * (outside + inside);
            if middle == outside || middle == inside {
                break;
            }
            let level = self.level_at(pair, middle, &from.solution)?;
            if level < 0.0 { inside = middle } else { outside = middle }
        }
        Ok(inside)
    }

    /// The time and the value of the lowest level between two samples.
    fn lowest(
        &mut self,
        pair: usize,
        from: &Sampled,
        to: &Sampled,
    ) -> Result<(f64, f64), PoseError> {
        let [mut low, mut high] = [from.time, to.time];
        let mut level = |time: f64| self.level_at(pair, time, &from.solution);
        let [mut left, mut right] = [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
        let [mut of_left, mut of_right] = [level(left)?, level(right)?];
        for _ in 0..STEPS {
            if of_left < of_right {
                high = right;
                (right, of_right) = (left, of_left);
                left = high - GOLDEN * (high - low);
                of_left = level(left)?;
            } else {
                low = left;
                (left, of_left) = (right, of_right);
                right = low + GOLDEN * (high - low);
                of_right = level(right)?;
            }
        }
        Ok(if of_left < of_right { (left, of_left) } else { (right, of_right) })
    }
}
