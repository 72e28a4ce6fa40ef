//! The nearest pose in reach to one that is not.
//!
//! The distance of two poses is `√(Σ (wᵢ Δqᵢ)²)` over the coordinates of a pose: `w` is 1 for lengths and a characteristic
//! length for angles, so that it is in metres. Nothing but the answer of inverse kinematics is used, so that every kind of
//! leg, limit and cone counts. From poses in reach the way to the wanted pose is bisected; a few thousand random poses in
//! the ball that is left are asked for; and from the best the boundary is followed down: directions seen from the wanted
//! pose are turned, in random orthonormal directions and in that of the last successes, by steps that grow and shrink, and
//! a direction counts if a pose on it that is nearer is in reach. That is a local search: what it finds is in reach, and
//! nothing proves that it is the nearest of all.

use super::Reach;
use crate::manipulator::{AllModes, Manipulator, Mode, PoseError, Solution};
use crate::numeric::Quantity;
use fastrand::Rng;
use std::f64::consts::TAU;

/// The same poses are asked for in every run.
const SEED: u64 = 20_261_129;
/// Steps of the way from a pose in reach to the wanted one, of which the last in reach is taken.
const STEPS: u32 = 64;
/// Halvings of an interval that holds the boundary: to the rounding of its ends.
const HALVINGS: u32 = 48;
/// Random poses in each round.
const SAMPLES: u32 = 1000;
/// Rounds, each among the poses that are nearer than the best one so far.
const ROUNDS: u32 = 6;
/// How far about the best pose random ones are, at most, in sizes of the mechanism, and the share of it that is the least.
const FARTHEST: f64 = 4.0;
const NEAREST: f64 = 1e-2;
/// Random poses about home that are asked for where home itself is not in reach.
const STARTS: u32 = 20_000;
/// The poses that the boundary is followed from, at most.
const DESCENTS: usize = 4;
/// Poses that one descent asks for, at most.
const MOST: u32 = 12_000;
/// The first turn of a direction, and the least, radians. At a smooth boundary a turn gains no more than its square; next to
/// an edge, as much as itself.
const TURNS: [f64; 2] = [0.5, 1e-12];
/// The share of a squared turn by which the distance has to fall: less is no progress, and the turn is halved.
const PROGRESS: f64 = 1e-3;
/// A share of the distance that is more than its rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// How many sets of directions fail before the turn is halved: near an edge of the boundary few directions lead down.
const TRIES: u32 = 3;

/// A pose in reach near one that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct NearestPose {
    /// The pose, radians and metres: in reach, within all limits.
    pub pose: Vec<f64>,
    /// Its distance, metres: an angle counts as an arc with the characteristic length as radius.
    pub distance: f64,
}

impl Reach<'_> {
    /// The nearest pose found that is in reach within all limits, in a working mode or (`None`) in any: the pose itself
    /// where it is. Angles count modulo a revolution, but where a screw turns with them. `length` is the characteristic
    /// length in metres by which angles are multiplied, for example [`Manipulator::characteristic_length`]. The search is
    /// local: a nearer pose may exist. The result is `None` if no pose in reach was found at all.
    ///
    /// # Errors
    /// The pose has the wrong length, or a coordinate that is not a finite number.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// // The right arm of this five-bar, 445 mm long, does not reach (-1 m, 1 m) from its shoulder at (160 mm, 0).
    /// let five_bar = Manipulator::example("five-bar")?;
    /// let (wanted, length) = ([-1.0, 1.0], five_bar.characteristic_length());
    /// let found = five_bar.reach().nearest(&wanted, None, length)?.expect("a pose in reach");
    /// assert!((found.distance - (1.16_f64.hypot(1.0) - 0.445)).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn nearest(
        self,
        pose: &[f64],
        mode: Option<Mode>,
        length: f64,
    ) -> Result<Option<NearestPose>, PoseError> {
        let manipulator = self.manipulator;
        let mut asked = Asked {
            manipulator,
            mode,
            wanted: pose,
            weights: weights(manipulator, length),
            solution: manipulator.solution(),
            all: manipulator.all_modes(),
            number: 0,
        };
        // Also finds out whether the pose is valid.
        if asked.solves(pose)? {
            return Ok(Some(NearestPose { pose: pose.to_owned(), distance: 0.0 }));
        }
        let mut rng = Rng::with_seed(SEED);
        let starts = asked.starts(&mut rng);
        let mut best: Option<Found> = None;
        for start in starts {
            let found = asked.descend(start, &mut rng);
            if best.as_ref().is_none_or(|best| found.distance < best.distance) {
                best = Some(found);
            }
        }
        Ok(best.map(|best| NearestPose {
            pose: asked.pose(&best.direction, best.distance),
            distance: best.distance,
        }))
    }
}

/// Metres for a unit of each coordinate.
fn weights(manipulator: &Manipulator, length: f64) -> Vec<f64> {
    let weight = |quantity| match quantity {
        Quantity::Length => 1.0,
        Quantity::Angle => length,
    };
    manipulator.task_coordinates().iter().map(|c| weight(c.quantity)).collect()
}

/// A pose in reach, as it is seen from the wanted one.
#[derive(Clone, Debug)]
struct Found {
    /// A unit vector of weighted coordinates.
    direction: Vec<f64>,
    distance: f64,
}

/// What is asked about poses near a wanted one.
struct Asked<'a> {
    manipulator: &'a Manipulator,
    mode: Option<Mode>,
    wanted: &'a [f64],
    weights: Vec<f64>,
    solution: Solution,
    all: AllModes,
    /// How many poses were asked for.
    number: u32,
}

impl Asked<'_> {
    /// Whether a pose is in reach within all limits.
    fn solves(&mut self, pose: &[f64]) -> Result<bool, PoseError> {
        self.number += 1;
        let Self { manipulator, mode, solution, all, .. } = self;
        Ok(match mode {
            Some(mode) => {
                let found = manipulator.inverse(pose, *mode, solution)?;
                found.is_some_and(Solution::within_limits)
            }
            None => {
                let found = manipulator.inverse_all(pose, all)?;
                found.is_some_and(|all| {
                    let found = manipulator.solution_within_limits(all, solution);
                    found.is_some_and(|(_, solution)| solution.within_limits())
                })
            }
        })
    }

    /// The pose at a distance in a direction.
    fn pose(&self, direction: &[f64], distance: f64) -> Vec<f64> {
        let along = direction.iter().zip(&self.weights).map(|(d, weight)| distance * d / weight);
        self.wanted.iter().zip(along).map(|(wanted, along)| wanted + along).collect()
    }

    /// Whether the pose there is in reach. A number that is not finite is not.
    fn reaches(&mut self, direction: &[f64], distance: f64) -> bool {
        let pose = self.pose(direction, distance);
        self.solves(&pose).unwrap_or(false)
    }

    /// Between a distance out of reach and one in reach in the same direction, the least in reach at the boundary, to a
    /// tolerance or to rounding.
    fn bisect(
        &mut self,
        direction: &[f64],
        [mut outside, mut inside]: [f64; 2],
        tolerance: f64,
    ) -> f64 {
        for _ in 0..HALVINGS {
            if inside - outside <= tolerance {
                break;
            }
            let middle = 0.5 * (outside + inside);
            match self.reaches(direction, middle) {
                true => inside = middle,
                false => outside = middle,
            }
        }
        inside
    }

    /// The nearest pose in reach on the way from one in reach, in steps.
    fn approach(&mut self, start: &Found) -> Found {
        let direction = start.direction.clone();
        let at = |step: u32| start.distance * f64::from(step) / f64::from(STEPS);
        let first = (1..STEPS).find(|&step| self.reaches(&direction, at(step)));
        let first = first.unwrap_or(STEPS);
        let distance = self.bisect(&direction, [at(first - 1), at(first)], 0.0);
        Found { direction, distance }
    }

    /// A pose, as it is seen from the wanted one. Angles take the revolution that is nearest.
    fn seen(&self, pose: &[f64]) -> Option<Found> {
        let coordinates = self.manipulator.task_coordinates();
        let apart = coordinates.iter().zip(pose.iter().zip(self.wanted)).map(|(c, (at, from))| {
            let turns =
                matches!(c.quantity, Quantity::Angle) && !self.manipulator.counts_turns(c.kind());
            let apart = at - from;
            if turns { apart - TAU * (apart / TAU).round() } else { apart }
        });
        let mut direction: Vec<f64> = apart.zip(&self.weights).map(|(d, w)| d * w).collect();
        let distance = normalise(&mut direction)?;
        Some(Found { direction, distance })
    }

    /// Poses in reach from which the boundary is followed, nearest first: towards home and among random ones.
    fn starts(&mut self, rng: &mut Rng) -> Vec<Found> {
        let home = self.manipulator.home_pose();
        let Some(mut start) = self.seen(&home) else { return Vec::new() };
        if !self.reaches(&start.direction, start.distance) {
            let Some(other) = self.somewhere(&home, rng) else { return Vec::new() };
            start = other;
        }
        let mut found = vec![self.approach(&start)];
        for _ in 0..ROUNDS {
            let best = found.iter().min_by(|a, b| a.distance.total_cmp(&b.distance)).cloned();
            let Some(best) = best.and_then(|best| self.nearer(&best, rng)) else { break };
            found.push(self.approach(&best));
        }
        found.sort_by(|a, b| a.distance.total_cmp(&b.distance));
        found.truncate(DESCENTS);
        found
    }

    /// The nearest of random poses in reach that are nearer than one: half of them in the ball about the wanted pose, as many
    /// in each part of its volume, and half about that one, near and far alike.
    fn nearer(&mut self, than: &Found, rng: &mut Rng) -> Option<Found> {
        let dimension = self.weights.len();
        let size = FARTHEST * self.manipulator.characteristic_length();
        let mut best: Option<Found> = None;
        for number in 0..SAMPLES {
            let Some(mut direction) = random_direction(dimension, rng) else { continue };
            let mut distance = than.distance * rng.f64().powf((dimension as f64).recip());
            if number % 2 == 1 {
                let away = size * NEAREST.powf(rng.f64());
                for (part, from) in direction.iter_mut().zip(&than.direction) {
                    *part = *part * away + from * than.distance;
                }
                let Some(length) = normalise(&mut direction) else { continue };
                distance = length;
            }
            let most = best.as_ref().map_or(than.distance, |best| best.distance);
            if distance < most && self.reaches(&direction, distance) {
                best = Some(Found { direction, distance });
            }
        }
        best
    }

    /// A pose in reach near home, where home itself is not: in this working mode, say.
    fn somewhere(&mut self, home: &[f64], rng: &mut Rng) -> Option<Found> {
        let size = self.manipulator.characteristic_length();
        for number in 0..STARTS {
            // Farther away with each.
            let radius = 4.0 * size * f64::from(number + 1) / f64::from(STARTS);
            let mut pose = home.to_owned();
            for (c, value) in self.manipulator.task_coordinates().iter().zip(&mut pose) {
                let unit = if c.quantity == Quantity::Angle { size } else { 1.0 };
                *value += radius * (2.0 * rng.f64() - 1.0) / unit;
            }
            if self.solves(&pose).unwrap_or(false)
                && let Some(found) = self.seen(&pose)
                && self.reaches(&found.direction, found.distance)
            {
                return Some(found);
            }
        }
        None
    }

    /// Follows the boundary down from a pose on it.
    fn descend(&mut self, start: Found, rng: &mut Rng) -> Found {
        let Found { mut direction, mut distance } = start;
        let last = self.number + MOST;
        let [mut turn, least] = TURNS;
        let mut trend = vec![0.0; direction.len()];
        let mut failed = 0;
        while turn > least && self.number < last {
            let shorter = distance * (1.0 - (PROGRESS * turn * turn).max(ROUNDING));
            let mut moves = tangents(&direction, rng);
            if let Some(along) = tangent(&direction, trend.clone()) {
                moves.insert(0, along);
            }
            let turned = moves.into_iter().find_map(|along| {
                let mut turned: Vec<f64> =
                    direction.iter().zip(&along).map(|(d, t)| d + turn * t).collect();
                normalise(&mut turned)?;
                self.reaches(&turned, shorter).then_some((turned, along))
            });
            let Some((turned, along)) = turned else {
                failed += 1;
                if failed == TRIES {
                    (turn, failed) = (0.5 * turn, 0);
                }
                continue;
            };
            (direction, failed) = (turned, 0);
            distance = self.shorten(&direction, shorter, distance - shorter);
            for (trend, along) in trend.iter_mut().zip(along) {
                *trend = 0.5 * *trend + along;
            }
            turn = (1.5 * turn).min(TURNS[0]);
        }
        let distance = self.shorten(&direction, distance, ROUNDING * distance);
        Found { direction, distance }
    }

    /// The boundary nearer to the wanted pose than a distance in reach, by steps that double, to the first of them.
    fn shorten(&mut self, direction: &[f64], mut inside: f64, mut step: f64) -> f64 {
        let tolerance = step;
        loop {
            let nearer = (inside - step).max(0.0);
            if !self.reaches(direction, nearer) {
                return self.bisect(direction, [nearer, inside], tolerance);
            }
            (inside, step) = (nearer, 2.0 * step);
        }
    }
}

/// Divides a vector by its length, which it returns; `None` where it has none.
fn normalise(vector: &mut [f64]) -> Option<f64> {
    let length = vector.iter().map(|v| v * v).sum::<f64>().sqrt();
    if !(length > 0.0 && length.is_finite()) {
        return None;
    }
    vector.iter_mut().for_each(|v| *v /= length);
    Some(length)
}

/// The part of a vector across a direction, as a unit vector.
fn tangent(direction: &[f64], mut vector: Vec<f64>) -> Option<Vec<f64>> {
    remove(direction, &mut vector);
    normalise(&mut vector)?;
    Some(vector)
}

/// Removes from a vector its part along a unit vector.
fn remove(direction: &[f64], vector: &mut [f64]) {
    let along: f64 = direction.iter().zip(&*vector).map(|(d, v)| d * v).sum();
    vector.iter_mut().zip(direction).for_each(|(v, d)| *v -= along * d);
}

/// A random unit vector, evenly distributed.
fn random_direction(dimension: usize, rng: &mut Rng) -> Option<Vec<f64>> {
    // Box and Muller's normal deviates.
    let normal = |rng: &mut Rng| (-2.0 * (1.0 - rng.f64()).ln()).sqrt() * (TAU * rng.f64()).cos();
    let mut vector: Vec<f64> = (0..dimension).map(|_| normal(rng)).collect();
    normalise(&mut vector)?;
    Some(vector)
}

/// An orthonormal basis, at random, of the vectors across a direction, and its opposite.
fn tangents(direction: &[f64], rng: &mut Rng) -> Vec<Vec<f64>> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for _ in 1..direction.len() {
        let Some(mut vector) = random_direction(direction.len(), rng) else { continue };
        for known in std::iter::once(direction).chain(basis.iter().map(Vec::as_slice)) {
            remove(known, &mut vector);
        }
        if normalise(&mut vector).is_some() {
            basis.push(vector);
        }
    }
    let opposite: Vec<Vec<f64>> =
        basis.iter().map(|vector| vector.iter().map(|v| -v).collect()).collect();
    basis.into_iter().chain(opposite).collect()
}
