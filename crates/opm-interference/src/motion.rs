//! Interference along a motion: when, which pair, and by how much; also between samples.
//!
//! The distance of each pair is a continuous function of time. As with the gauges of a
//! [`Trajectory`](opm_core::trajectory), its value and its slope are computed at each sample. Where it crosses the clearance
//! between two samples, the time is found by bisection; where it falls at the first sample and rises at the second, its
//! lowest value by a golden-section search, and then both crossings. So these are all contacts, unless a distance falls and
//! rises several times between two samples.

use crate::distances::{Distances, Nearest};
use opm_core::manipulator::{Manipulator, Mode, PoseError, Solution};
use opm_core::motion::{Instant, PlatformMotion};

/// The accuracy of times, as a share of the step between two samples.
const RESOLUTION: f64 = 1e-10;

/// Slopes are differences over this share of the step; only their signs matter.
const SLOPE_STEP: f64 = 1e-3;

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
    open: Vec<Option<Contact>>,
    found: Vec<Contact>,
    nearest: Option<(Nearest, f64)>,
}

/// Buffers for a solution at any time.
struct Solver {
    instant: Instant,
    solution: Solution,
}

/// A sample in reach.
#[derive(Clone)]
struct Sampled {
    time: f64,
    solution: Solution,
    /// The distance of every pair less the clearance, metres.
    levels: Vec<f64>,
    /// The slopes after and before the sample; NaN where the pose beside it is out of reach.
    slopes: [Vec<f64>; 2],
}

impl<'a> Watch<'a> {
    /// Prepares to watch a motion; `distances` are working memory for the manipulator's pairs.
    pub fn new(of: Watched<'a>, distances: Distances<'a>) -> Self {
        let pairs = distances.interference().pairs();
        let instant = Instant::new(of.manipulator.task_coordinates().len());
        let solver = Solver { instant, solution: of.manipulator.solution() };
        let (last, nearest) = (None, None);
        Self { of, distances, solver, last, open: vec![None; pairs], found: Vec::new(), nearest }
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
        let slope = |watch: &mut Self, by: f64, levels: &[f64]| -> Result<Vec<f64>, PoseError> {
            let beside = watch.levels_at(time + by, solution)?;
            Ok(match beside {
                Some(beside) => beside.iter().zip(levels).map(|(b, a)| (b - a) / by).collect(),
                None => vec![f64::NAN; levels.len()],
            })
        };
        self.distances.place(self.of.manipulator, solution);
        let levels = self.levels();
        let by = SLOPE_STEP * step;
        let none = || vec![f64::NAN; levels.len()];
        let after =
            if time + by < self.of.motion.end() { slope(self, by, &levels)? } else { none() };
        let before = if self.last.is_some() { slope(self, -by, &levels)? } else { none() };
        let slopes = [after, before];
        let sampled = Sampled { time, solution: solution.clone(), levels, slopes };
        let last = self.last.take();
        for pair in 0..self.open.len() {
            match &last {
                None => self.begin(pair, &sampled),
                Some(last) => self.between(pair, last, &sampled)?,
            }
            self.note(pair, time, sampled.levels[pair]);
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

    fn levels(&self) -> Vec<f64> {
        (0..self.open.len()).map(|pair| self.distances.of(pair) - self.of.clearance).collect()
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

    fn levels_at(&mut self, time: f64, near: &Solution) -> Result<Option<Vec<f64>>, PoseError> {
        Ok(self.place(time, near)?.map(|()| self.levels()))
    }

    /// The level of one pair at a time; infinite out of reach.
    fn level_at(&mut self, pair: usize, time: f64, near: &Solution) -> Result<f64, PoseError> {
        let placed = self.place(time, near)?;
        Ok(placed.map_or(f64::INFINITY, |()| self.distances.of(pair) - self.of.clearance))
    }

    /// Opens a contact at the first sample, or the first one back in reach.
    fn begin(&mut self, pair: usize, at: &Sampled) {
        if at.levels[pair] < 0.0 {
            self.open(pair, at.time);
        }
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
        if self.nearest.is_none_or(|(nearest, _)| distance < nearest.distance) {
            self.nearest = Some((Nearest { pair, distance }, time));
        }
    }

    /// Finds what happens to a pair between two samples.
    fn between(&mut self, pair: usize, from: &Sampled, to: &Sampled) -> Result<(), PoseError> {
        let (a, b) = (from.levels[pair], to.levels[pair]);
        let dips = from.slopes[0][pair] < 0.0 && to.slopes[1][pair] > 0.0;
        if dips {
            let (time, level) = self.lowest(pair, from, to)?;
            if level < 0.0 && a >= 0.0 {
                let start = self.crossing(pair, from, [from.time, time])?;
                self.open(pair, start);
            }
            self.note(pair, time, level);
            if level < 0.0 && b >= 0.0 {
                let end = self.crossing(pair, from, [to.time, time])?;
                self.close(pair, end);
            }
            return Ok(());
        }
        if (a < 0.0) == (b < 0.0) {
            return Ok(());
        }
        if b < 0.0 {
            let start = self.crossing(pair, from, [from.time, to.time])?;
            self.open(pair, start);
        } else {
            let end = self.crossing(pair, from, [to.time, from.time])?;
            self.close(pair, end);
        }
        Ok(())
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
