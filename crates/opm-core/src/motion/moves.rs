//! Straight lines and circular arcs, one after the other, with rounded corners: the pose as a function of the length that
//! the platform's position has gone.
//!
//! Along a line or an arc the position goes one metre for each metre of the parameter; the other coordinates change at
//! constant rates. A blend replaces what is within a distance of a corner by polynomials of the fifth order, one for each
//! coordinate. They take value and two derivatives from both sides, so velocity and acceleration are continuous.

use super::{Instant, Path, PlatformMotion, TimedPath, Timing};
use crate::manipulator::Manipulator;
use crate::numeric::Quantity;
use std::f64::consts::TAU;

/// Where derivatives jump by more than this, in shares of the speed, or in radians over the shorter move, there is a corner.
const SMOOTH: f64 = 1e-6;

/// Three points are on a line if the sine of the angle between them is below this.
const STRAIGHT: f64 = 1e-9;

/// One move of [`PlatformMotion::along`]: where it ends, and how it goes there.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// The pose at its end: all task coordinates, metres and radians.
    pub to: Vec<f64>,
    /// A pose on the arc; only its positions count. `None` for a straight line.
    pub via: Option<Vec<f64>>,
    /// The speed of the position, metres per second.
    pub feed: f64,
    /// The distance from the corner at its end within which the path is rounded, metres. It is not used where the next move goes
    /// on in the same direction, nor at the end of the last move.
    pub blend: f64,
}

/// Why moves do not make a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("move {}: {problem}", .number + 1)]
pub struct MovesError {
    /// The number of the move, from zero. If there are no moves, or the start is wrong, this is zero.
    pub number: usize,
    /// What is wrong with it.
    pub problem: MoveProblem,
}

/// What is wrong with a move.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MoveProblem {
    /// There is no move, or the mechanism has no coordinates that are lengths.
    #[error("expected one move or more, of a mechanism with task coordinates that are lengths")]
    Nothing,
    /// A pose has another number of coordinates than the mechanism, or a number is not finite, or feed rate, acceleration or
    /// blend are not above zero.
    #[error(
        "expected {expected} finite coordinates of each pose, a feed rate and an acceleration above zero, and a blend of zero or \
         more"
    )]
    Numbers {
        /// The number of task coordinates.
        expected: usize,
    },
    /// The position does not change.
    #[error("the position does not change, expected one that does: a feed rate is along a path")]
    Still,
    /// Start, `via` and end of an arc are on a line.
    #[error("start, `via` and `to` are on one line, expected three places of an arc")]
    Straight,
    /// The blends at both ends need more than its length.
    #[error("it is {length} m long, and the blends at its ends need {needed} m, expected less")]
    Overlap {
        /// What the blends at both ends need, metres.
        needed: f64,
        /// How long the move is, metres.
        length: f64,
    },
    /// Its time is zero in floating point.
    #[error("it is too short for its feed rate, expected a time above zero")]
    Short,
}

/// A path of lines and arcs. The parameter is the length of the path without its blends, from zero on.
#[derive(Clone, Debug, PartialEq)]
pub struct Moves {
    segments: Vec<Segment>,
    /// The rounded corners, in order.
    blends: Vec<Blend>,
}

/// A line or an arc.
#[derive(Clone, Debug, PartialEq)]
struct Segment {
    /// The parameter at its start.
    start: f64,
    length: f64,
    /// All coordinates at its start, and their constant rates.
    from: Vec<f64>,
    rates: Vec<f64>,
    /// What the position does, if it goes along an arc.
    arc: Option<Arc>,
}

/// An arc: the position is `centre + radius (u cos φ + v sin φ)`, and goes from `φ = 0` on.
#[derive(Clone, Debug, PartialEq)]
struct Arc {
    /// The numbers of the coordinates of the position.
    positions: Vec<usize>,
    centre: Vec<f64>,
    radius: f64,
    u: Vec<f64>,
    v: Vec<f64>,
}

/// A rounded corner: polynomials in the share of its length.
#[derive(Clone, Debug, PartialEq)]
struct Blend {
    start: f64,
    length: f64,
    coefficients: Vec<[f64; 6]>,
}

impl PlatformMotion {
    /// The motion from rest at a pose to rest along `moves`, with their feed rates and at most this `acceleration` along the
    /// path, metres per second squared.
    ///
    /// The position, which is the task coordinates that are lengths, goes along straight lines and arcs; the other
    /// coordinates change evenly along each of them. At a corner without a blend the motion halts.
    ///
    /// ```
    /// use opm_core::Manipulator;
    /// use opm_core::motion::{Instant, Move, PlatformMotion};
    ///
    /// // 40 mm along x at 100 mm/s, reached within 5 ms.
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let start = manipulator.home_pose();
    /// let mut to = start.clone();
    /// to[0] += 0.04;
    /// let line = Move { to, via: None, feed: 0.1, blend: 0.0 };
    /// let motion = PlatformMotion::along("line", &start, &[line], 20.0, &manipulator)?;
    /// assert!((motion.duration - 0.405).abs() < 1e-12);
    ///
    /// let mut instant = Instant::new(start.len());
    /// motion.at(0.2025, &mut instant);
    /// assert!((instant.pose[0] - start[0] - 0.02).abs() < 1e-12);
    /// assert!((instant.velocity[0] - 0.1).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`MovesError`] has the number of the move and what is wrong with it.
    pub fn along(
        name: &str,
        start: &[f64],
        moves: &[Move],
        acceleration: f64,
        manipulator: &Manipulator,
    ) -> Result<Self, MovesError> {
        let coordinates = manipulator.task_coordinates();
        let numbered = coordinates.iter().enumerate();
        let positions: Vec<usize> = numbered
            .filter(|(_, coordinate)| coordinate.quantity == Quantity::Length)
            .map(|(number, _)| number)
            .collect();
        if moves.is_empty() || positions.is_empty() {
            return Err(MovesError { number: 0, problem: MoveProblem::Nothing });
        }
        let is_pose =
            |pose: &[f64]| pose.len() == coordinates.len() && pose.iter().all(|c| c.is_finite());
        let is_speed = |number: f64| number > 0.0 && number.is_finite();
        let is_wrong = |given: &Move| {
            let poses = is_pose(&given.to) && given.via.as_deref().is_none_or(is_pose);
            !(poses && is_speed(given.feed) && given.blend >= 0.0 && given.blend.is_finite())
        };
        let wrong = match is_pose(start) && is_speed(acceleration) {
            true => moves.iter().position(is_wrong),
            false => Some(0),
        };
        if let Some(number) = wrong {
            let problem = MoveProblem::Numbers { expected: coordinates.len() };
            return Err(MovesError { number, problem });
        }
        let (path, stops) = Moves::new(start, moves, &positions)?;
        let timing = path.timing(moves, &stops, acceleration)?;
        let (name, duration) = (name.to_owned(), timing.end());
        let path = Path::Timed(TimedPath { path: Box::new(Path::Moves(path)), timing });
        Ok(Self { name, start: 0.0, duration, rate: None, mode: None, path })
    }
}

impl Moves {
    /// The path from a pose along moves, and the parameters of its corners that are not rounded. `positions` are the numbers
    /// of the coordinates that are lengths.
    fn new(
        start: &[f64],
        moves: &[Move],
        positions: &[usize],
    ) -> Result<(Self, Vec<f64>), MovesError> {
        let mut segments: Vec<Segment> = Vec::with_capacity(moves.len());
        let mut at = 0.0;
        for (number, next) in moves.iter().enumerate() {
            let from = if number == 0 { start } else { &moves[number - 1].to };
            let segment = Segment::new(at, from, next, positions);
            let segment = segment.map_err(|problem| MovesError { number, problem })?;
            at += segment.length;
            segments.push(segment);
        }
        // Where moves go on in one direction, there is no corner: a blend would leave a line beside an arc.
        let corners: Vec<Option<f64>> = segments
            .windows(2)
            .zip(moves)
            .map(|(pair, given)| (!is_smooth(&pair[0], &pair[1], positions)).then_some(given.blend))
            .collect();
        for (number, segment) in segments.iter().enumerate() {
            let blend =
                |corner: Option<usize>| corner.and_then(|i| *corners.get(i)?).unwrap_or(0.0);
            let needed = blend(number.checked_sub(1)) + blend(Some(number));
            if needed > segment.length {
                let problem = MoveProblem::Overlap { needed, length: segment.length };
                return Err(MovesError { number, problem });
            }
        }
        let (mut blends, mut stops) = (Vec::new(), Vec::new());
        for (pair, corner) in segments.windows(2).zip(corners) {
            match corner {
                None => {}
                Some(distance) if distance > 0.0 => {
                    blends.push(Blend::new(&pair[0], &pair[1], distance));
                }
                Some(_) => stops.push(pair[1].start),
            }
        }
        Ok((Self { segments, blends }, stops))
    }

    /// Writes the pose and its derivatives by the parameter into `out`. Parameters beyond the ends give the values there.
    pub(super) fn at(&self, parameter: f64, out: &mut Instant) {
        let parameter = parameter.clamp(0.0, self.length());
        let blend = self.blends.partition_point(|blend| blend.start <= parameter).checked_sub(1);
        if let Some(blend) = blend.map(|number| &self.blends[number])
            && parameter <= blend.start + blend.length
        {
            blend.at(parameter, out);
            return;
        }
        let number = self.segments.partition_point(|segment| segment.start <= parameter);
        let segment = &self.segments[number.clamp(1, self.segments.len()) - 1];
        segment.at(parameter - segment.start, out);
    }

    /// The number of coordinates.
    pub(super) fn coordinate_count(&self) -> usize {
        self.segments[0].from.len()
    }

    /// The parameter at the end, metres.
    pub fn length(&self) -> f64 {
        let last = &self.segments[self.segments.len() - 1];
        last.start + last.length
    }

    /// The timing from rest to rest that goes along each move with its feed rate, with this largest acceleration along the path,
    /// and with a halt at each of `stops`. `Err` if a move is too short for that in floating point.
    fn timing(
        &self,
        moves: &[Move],
        stops: &[f64],
        acceleration: f64,
    ) -> Result<Timing, MovesError> {
        let squares: Vec<f64> = moves.iter().map(|given| given.feed * given.feed).collect();
        let n = self.segments.len();
        // The squares of the rates where moves meet, that can be reached from both sides.
        let mut ends = vec![0.0; n + 1];
        for i in 1..n {
            if !stops.contains(&self.segments[i].start) {
                ends[i] = squares[i - 1].min(squares[i]);
            }
        }
        let gain = |i: usize| 2.0 * acceleration * self.segments[i].length;
        for i in 0..n {
            ends[i + 1] = f64::min(ends[i + 1], ends[i] + gain(i));
        }
        for i in (0..n).rev() {
            ends[i] = f64::min(ends[i], ends[i + 1] + gain(i));
        }
        let (mut knots, mut rates) = (vec![0.0], vec![0.0]);
        let mut add = |parameter: f64, square: f64| {
            if parameter > knots[knots.len() - 1] {
                knots.push(parameter);
                rates.push(square);
            }
        };
        for (i, segment) in self.segments.iter().enumerate() {
            let [from, to] = [ends[i], ends[i + 1]];
            let end = segment.start + segment.length;
            let [up, down] = [from, to].map(|end| (squares[i] - end) / (2.0 * acceleration));
            if up + down < segment.length {
                add(segment.start + up, squares[i]);
                add(end - down, squares[i]);
            } else {
                // It slows down before it has reached the feed rate.
                let peak = 0.5 * segment.length + (to - from) / (4.0 * acceleration);
                add(segment.start + peak, from + 2.0 * acceleration * peak);
            }
            add(end, to);
        }
        Timing::new(knots.clone(), &rates, 0.0).map_err(|knot| {
            let before = self.segments.partition_point(|segment| segment.start <= knots[knot]);
            MovesError { number: before.max(1) - 1, problem: MoveProblem::Short }
        })
    }
}

impl Segment {
    fn new(
        start: f64,
        from: &[f64],
        next: &Move,
        positions: &[usize],
    ) -> Result<Self, MoveProblem> {
        let place = |pose: &[f64]| positions.iter().map(|&i| pose[i]).collect::<Vec<_>>();
        let (a, b) = (place(from), place(&next.to));
        let (arc, length) = match &next.via {
            None => (None, norm(&difference(&b, &a))),
            Some(via) => {
                let (arc, length) = Arc::through([&a, &place(via), &b], positions)?;
                (Some(arc), length)
            }
        };
        if length == 0.0 {
            return Err(MoveProblem::Still);
        }
        let rates = from.iter().zip(&next.to).map(|(from, to)| (to - from) / length).collect();
        Ok(Self { start, length, from: from.to_vec(), rates, arc })
    }

    /// Writes the pose and its derivatives at a length from its start.
    fn at(&self, length: f64, out: &mut Instant) {
        out.resize(self.from.len());
        for (i, (from, rate)) in self.from.iter().zip(&self.rates).enumerate() {
            out.pose[i] = from + rate * length;
            out.velocity[i] = *rate;
            out.acceleration[i] = 0.0;
        }
        let Some(Arc { positions, centre, radius, u, v }) = &self.arc else { return };
        let (sin, cos) = (length / radius).sin_cos();
        for (k, &i) in positions.iter().enumerate() {
            let (outward, along) = (u[k] * cos + v[k] * sin, v[k] * cos - u[k] * sin);
            out.pose[i] = centre[k] + radius * outward;
            out.velocity[i] = along;
            out.acceleration[i] = -outward / radius;
        }
    }

    fn instant(&self, length: f64) -> Instant {
        let mut out = Instant::new(self.from.len());
        self.at(length, &mut out);
        out
    }
}

impl Arc {
    /// The arc from a place through another to a third, and its length.
    fn through([a, via, b]: [&[f64]; 3], positions: &[usize]) -> Result<(Self, f64), MoveProblem> {
        let (p, q) = (difference(via, a), difference(b, a));
        let [pp, pq, qq] = [dot(&p, &p), dot(&p, &q), dot(&q, &q)];
        // What of the way to the second place is beside the way to the third.
        let beside: Vec<f64> = p.iter().zip(&q).map(|(p, q)| p - pq / qq * q).collect();
        let off = norm(&beside);
        if off.is_nan() || off <= STRAIGHT * pp.sqrt() {
            return Err(MoveProblem::Straight);
        }
        let determinant = qq * off * off;
        // The centre is as far from the start as from the others: a + x p + y q, with its products with p and q known.
        let [x, y] = [0.5 * qq * (pp - pq) / determinant, 0.5 * pp * (qq - pq) / determinant];
        let centre: Vec<f64> = (0..a.len()).map(|k| a[k] + x * p[k] + y * q[k]).collect();
        let out = difference(a, &centre);
        let radius = norm(&out);
        let u: Vec<f64> = out.iter().map(|k| k / radius).collect();
        let along = dot(&p, &u);
        let across: Vec<f64> = p.iter().zip(&u).map(|(p, u)| p - along * u).collect();
        let size = norm(&across);
        let mut v: Vec<f64> = across.iter().map(|k| k / size).collect();
        let angle = |place: &[f64], v: &[f64]| {
            let from = difference(place, &centre);
            dot(&from, v).atan2(dot(&from, &u)).rem_euclid(TAU)
        };
        if angle(via, &v) > angle(b, &v) {
            v.iter_mut().for_each(|k| *k = -*k);
        }
        let length = radius * angle(b, &v);
        Ok((Self { positions: positions.to_vec(), centre, radius, u, v }, length))
    }
}

impl Blend {
    /// The rounded corner between two segments, from a distance before it to the same distance behind it.
    fn new(before: &Segment, after: &Segment, distance: f64) -> Self {
        let [from, to] = [before.instant(before.length - distance), after.instant(distance)];
        let length = 2.0 * distance;
        let coefficients = (0..from.pose.len()).map(|i| {
            let [v0, v1] = [&from, &to].map(|end| end.velocity[i] * length);
            let [a0, a1] = [&from, &to].map(|end| end.acceleration[i] * length * length);
            let step = to.pose[i] - from.pose[i];
            [
                from.pose[i],
                v0,
                0.5 * a0,
                10.0 * step - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1,
                -15.0 * step + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1,
                6.0 * step - 3.0 * (v0 + v1) - 0.5 * (a0 - a1),
            ]
        });
        Self { start: after.start - distance, length, coefficients: coefficients.collect() }
    }

    fn at(&self, parameter: f64, out: &mut Instant) {
        out.resize(self.coefficients.len());
        let t = (parameter - self.start) / self.length;
        for (i, c) in self.coefficients.iter().enumerate() {
            let [mut value, mut first, mut second] = [0.0; 3];
            for c in c.iter().rev() {
                second = second * t + 2.0 * first;
                first = first * t + value;
                value = value * t + c;
            }
            out.pose[i] = value;
            out.velocity[i] = first / self.length;
            out.acceleration[i] = second / (self.length * self.length);
        }
    }
}

/// Whether the first derivatives go on from one segment to the next.
fn is_smooth(before: &Segment, after: &Segment, positions: &[usize]) -> bool {
    let [end, start] = [before.instant(before.length), after.instant(0.0)];
    let shorter = before.length.min(after.length);
    (0..end.velocity.len()).all(|i| {
        let scale = if positions.contains(&i) { 1.0 } else { shorter };
        (end.velocity[i] - start.velocity[i]).abs() * scale <= SMOOTH
    })
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn line(to: [f64; 3], blend: f64) -> Move {
        Move { to: to.into(), via: None, feed: 0.2, blend }
    }

    /// Two positions and an angle.
    const POSITIONS: [usize; 2] = [0, 1];

    /// From rest to rest over a length takes `length / feed + feed / acceleration`, or `2 √(length / acceleration)` where it is
    /// too short to reach the feed rate.
    #[test]
    fn a_line_is_a_trapezoid_in_time() {
        for (length, feed, duration) in [(1.0, 0.2, 5.1), (0.01, 0.2, 0.141_421_356_237_309_5)] {
            let moves = [Move { feed, ..line([0.6 * length, 0.8 * length, 1.0], 0.0) }];
            let (path, stops) = Moves::new(&[0.0; 3], &moves, &POSITIONS).unwrap();
            let timing = path.timing(&moves, &stops, 2.0).unwrap();
            assert!((timing.end() - duration).abs() < 1e-14, "{}", timing.end());
            let [middle, rate, _] = timing.at(0.5 * timing.end());
            assert!((middle - 0.5 * length).abs() < 1e-15);
            assert!((rate - feed.min((2.0 * length).sqrt())).abs() < 1e-15, "{rate}");
            let mut out = Instant::new(3);
            path.at(middle, &mut out);
            assert!(
                (out.pose[0] - 0.3 * length).abs() < 1e-15 && (out.pose[2] - 0.5).abs() < 1e-15
            );
        }
    }

    /// Three quarters of a circle in either direction: the distance from the centre stays, and so does the speed.
    #[test]
    fn an_arc_goes_through_its_three_points() {
        let on = |degrees: f64, angle: f64| {
            let (sin, cos) = degrees.to_radians().sin_cos();
            vec![0.3 + 0.05 * cos, -0.1 + 0.05 * sin, angle]
        };
        for side in [1.0, -1.0] {
            for via in [20.0, 100.0, 250.0] {
                let arc = Move {
                    to: on(270.0 * side, 0.6),
                    via: Some(on(via * side, 7.0)),
                    feed: 0.1,
                    blend: 0.0,
                };
                let (path, _) = Moves::new(&on(0.0, 0.0), &[arc], &POSITIONS).unwrap();
                assert!((path.length() - 1.5 * PI * 0.05).abs() < 1e-14, "{}", path.length());
                let mut out = Instant::new(3);
                for i in 0..=12 {
                    let share = f64::from(i) / 12.0;
                    path.at(share * path.length(), &mut out);
                    let expected = on(270.0 * side * share, 0.6 * share);
                    for (value, expected) in out.pose.iter().zip(&expected) {
                        assert!((value - expected).abs() < 1e-14, "{side} {via} {i}");
                    }
                    assert!((out.velocity[0].hypot(out.velocity[1]) - 1.0).abs() < 1e-14);
                    let turn = out.acceleration[0].hypot(out.acceleration[1]);
                    assert!((turn - 20.0).abs() < 1e-11, "{turn}");
                }
            }
        }
        let straight = Move { via: Some(vec![0.1, 0.1, 0.0]), ..line([0.3, 0.3, 0.0], 0.0) };
        let refused = Moves::new(&[0.0; 3], &[straight], &POSITIONS).unwrap_err();
        assert_eq!(refused, MovesError { number: 0, problem: MoveProblem::Straight });
    }

    /// Round a corner, and from a line into an arc that it does not touch, the path stays C²: derivatives are those of
    /// differences, and no second derivative jumps. Without blends, the motion halts where a direction changes.
    #[test]
    fn blends_keep_speed_and_acceleration_continuous() {
        let arc = Move { via: Some(vec![0.35, 0.15, 0.0]), ..line([0.2, 0.2, -0.5], 0.02) };
        let round = |blend: f64| {
            [
                line([0.3, 0.0, 0.4], blend),
                line([0.3, 0.1, 0.4], blend),
                Move { blend, ..arc.clone() },
                line([0.0, 0.2, 0.0], 0.0),
            ]
        };
        let (path, stops) = Moves::new(&[0.0; 3], &round(0.02), &POSITIONS).unwrap();
        assert_eq!(stops, [0.0; 0]);
        const STEP: f64 = 1e-6;
        let at = |s: f64| {
            let mut out = Instant::new(3);
            path.at(s, &mut out);
            out
        };
        for i in 1..2000 {
            let s = path.length() * f64::from(i) / 2000.0;
            let [before, here, after] = [s - STEP, s, s + STEP].map(at);
            for k in 0..3 {
                let first = (after.pose[k] - before.pose[k]) / (2.0 * STEP);
                assert!((first - here.velocity[k]).abs() < 1e-6, "{s} {k}");
                let second = (after.velocity[k] - before.velocity[k]) / (2.0 * STEP);
                assert!((second - here.acceleration[k]).abs() < 2e-2, "{s} {k}: {second}");
                let jump = after.acceleration[k] - before.acceleration[k];
                assert!(jump.abs() < 0.1, "{s} {k}: {jump}");
            }
        }
        // A corner of a right angle is cut: in its middle three sixteenths of the distance are left to both sides.
        let corner = at(0.3);
        let cut = 0.02 * 3.0 / 16.0;
        assert!(
            (corner.pose[0] - (0.3 - cut)).abs() < 1e-14 && (corner.pose[1] - cut).abs() < 1e-14
        );

        let (path, stops) = Moves::new(&[0.0; 3], &round(0.0), &POSITIONS).unwrap();
        assert_eq!(stops.len(), 3);
        let timing = path.timing(&round(0.0), &stops, 1.0).unwrap();
        // Each of four moves is a trapezoid: feed over acceleration is lost at each.
        assert!((timing.end() - (path.length() / 0.2 + 4.0 * 0.2)).abs() < 1e-12);
        let overlap = Moves::new(&[0.0; 3], &round(0.06), &POSITIONS).unwrap_err();
        let MoveProblem::Overlap { needed, length } = overlap.problem else {
            panic!("{overlap:?}")
        };
        assert!(overlap.number == 1 && needed == 0.12 && (length - 0.1).abs() < 1e-15);
    }

    /// A line and an arc that touch are followed as they are, at their feed rate, whatever the blend; the angle, whose rate
    /// changes there, makes it a corner.
    #[test]
    fn there_is_no_blend_where_moves_touch() {
        let slot = |angle: f64| {
            let across = Move { via: Some(vec![0.4, 0.0, 0.0]), ..line([0.2, 0.2, angle], 0.05) };
            [line([0.2, -0.2, angle], 0.05), across, line([-0.2, 0.2, 0.0], 0.0)]
        };
        let start = [-0.2, -0.2, 0.0];
        let (path, stops) = Moves::new(&start, &slot(0.0), &POSITIONS).unwrap();
        assert!(stops.is_empty() && path.blends.is_empty(), "{stops:?} {:?}", path.blends);
        let timing = path.timing(&slot(0.0), &stops, 2.0).unwrap();
        assert!(
            (timing.end() - (path.length() / 0.2 + 0.2 / 2.0)).abs() < 1e-14,
            "{}",
            timing.end()
        );
        // Nor does what is not rounded need room.
        let long = slot(0.0).map(|given| Move { blend: 0.3, ..given });
        assert_eq!(Moves::new(&start, &long, &POSITIONS).unwrap().0, path);
        let mut out = Instant::new(3);
        for i in 0..=1000 {
            path.at(path.length() * f64::from(i) / 1000.0, &mut out);
            let [x, y] = [out.pose[0], out.pose[1]];
            let off = if x > 0.2 { (x - 0.2).hypot(y) - 0.2 } else { y.abs() - 0.2 };
            assert!(off.abs() < 1e-14, "{x} {y}");
            assert!((out.velocity[0].hypot(out.velocity[1]) - 1.0).abs() < 1e-14);
        }
        let (path, stops) = Moves::new(&start, &slot(0.3), &POSITIONS).unwrap();
        assert!(stops.is_empty() && path.blends.len() == 2, "{stops:?} {:?}", path.blends);
    }

    /// Between moves of different feed rates the speed changes with the acceleration, on the faster side.
    #[test]
    fn feed_rates_change_on_the_faster_move() {
        let slow = Move { feed: 0.1, ..line([0.1, 0.0, 0.0], 0.0) };
        let fast = Move { feed: 0.3, ..line([0.4, 0.0, 0.0], 0.0) };
        let moves = [slow, fast];
        let (path, stops) = Moves::new(&[0.0; 3], &moves, &POSITIONS).unwrap();
        assert_eq!(stops, [0.0; 0]);
        let timing = path.timing(&moves, &stops, 1.0).unwrap();
        let expected = 0.1 + (0.1 - 0.005) / 0.1 + 0.2 + (0.3 - 0.04 - 0.045) / 0.3 + 0.3;
        assert!((timing.end() - expected).abs() < 1e-14, "{} {expected}", timing.end());
    }
}
