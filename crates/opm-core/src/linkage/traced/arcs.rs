//! The branches of a traced loop for one of its joints as the input: the arcs of its curves between folds.
//!
//! At a fold the input turns back, and the loop goes on in the next arc. Along an arc the input only grows or only falls, so that
//! each of its values has one position.

use super::closed_loop::{ClosedLoop, FreedomKind, Posture};
use super::curve::{Curve, Knot};
use nalgebra::DVector;
use std::f64::consts::TAU;

/// A joint whose share of the motion is nowhere more than this stands still.
const STILL: f64 = 1e-9;
/// How far from an interpolated position the exact one may be.
const NEAR: f64 = 0.05;
/// Values of the input that differ by so much are one: at the end of an arc, rounding is inside.
const ROUNDING: f64 = 1e-11;
const HALVINGS: usize = 60;

/// What happens at an end of an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcEnd {
    /// The input turns back.
    Fold,
    /// A slider goes to infinity, or the curve was not followed on.
    Open,
    /// A full revolution of the input ends, and the next one begins.
    Turn,
}

/// A part of a curve on which the input moves one way.
#[derive(Clone, Debug)]
pub struct Arc {
    knots: Vec<Knot>,
    pub ends: [ArcEnd; 2],
}

/// The arcs of one curve in the order of its motion, the input growing at first; of home's, home is in the first one.
#[derive(Clone, Debug)]
pub struct Arcs {
    /// The freedom that is the input.
    input: usize,
    pub all: Vec<Arc>,
    /// How many of them, the first ones, lie on home's curve.
    pub of_home: usize,
}

impl Arcs {
    /// The arcs of the curves, home's first. `None` if the input stands still.
    pub fn new(of: &ClosedLoop, curves: &[Curve], input: usize) -> Option<Self> {
        let mut arcs = Self { input, all: Vec::new(), of_home: 0 };
        for curve in curves {
            let moves = curve.knots.iter().any(|knot| knot.tangent[input].abs() > STILL);
            if moves {
                arcs.all.extend(split(of, curve, input));
            }
            if arcs.of_home == 0 {
                if !moves {
                    return None;
                }
                arcs.of_home = arcs.all.len();
            }
        }
        Some(arcs)
    }

    /// The lowest and the highest displacement of the input in an arc.
    pub fn interval(&self, arc: usize) -> [f64; 2] {
        let [a, b] = self.run(arc);
        [a.min(b), a.max(b)]
    }

    /// The displacement of the input at the start and the end of an arc, as the loop moves.
    pub fn run(&self, arc: usize) -> [f64; 2] {
        let knots = &self.all[arc].knots;
        [&knots[0], &knots[knots.len() - 1]].map(|knot| knot.at.values[self.input])
    }

    /// The position in an arc with the input displaced so. `None` outside the arc.
    pub fn position(&self, of: &ClosedLoop, arc: usize, displacement: f64) -> Option<Posture> {
        let [low, high] = self.interval(arc);
        let mut value = displacement;
        let inside = |value: f64| (low - ROUNDING..=high + ROUNDING).contains(&value);
        if of.freedoms[self.input].kind == FreedomKind::Turn && !inside(value) {
            value -= ((value - low + ROUNDING) / TAU).floor() * TAU;
        }
        if !inside(value) {
            return None;
        }
        let (value, input) = (value.clamp(low, high), self.input);
        let knots = &self.all[arc].knots;
        let of_knot = |knot: &Knot| knot.at.values[input];
        let grows = of_knot(&knots[0]) <= of_knot(&knots[knots.len() - 1]);
        let before =
            |knot: &Knot| if grows { of_knot(knot) <= value } else { of_knot(knot) >= value };
        let next = knots.partition_point(before).clamp(1, knots.len() - 1);
        let (a, b) = (&knots[next - 1], &knots[next]);
        for end in [a, b] {
            if of_knot(end) == value {
                return Some(end.at.clone());
            }
        }
        let guess = between(of, (a, b), input, value);
        let mut held = guess.clone();
        held.values[input] = value;
        let near = |at: &Posture| of.step(&guess, at).norm() <= NEAR * of.farthest(at).max(1.0);
        let found = of.close(&held, &unit(of, input)).filter(near);
        // At a fold the input says nothing about where the loop is.
        found.or_else(|| of.close(&guess, &of.step(&a.at, &b.at).normalize()).filter(near))
    }
}

/// The row that holds a freedom.
pub fn unit(of: &ClosedLoop, freedom: usize) -> DVector<f64> {
    DVector::from_fn(of.count(), |i, _| f64::from(u8::from(i == freedom)))
}

/// The place between two knots, on the cubic through both with their tangents, where the input has a value.
fn between(of: &ClosedLoop, (a, b): (&Knot, &Knot), input: usize, value: f64) -> Posture {
    let chord = of.step(&a.at, &b.at);
    let length = chord.norm();
    let at = |u: f64| {
        let (u2, u3) = (u * u, u * u * u);
        &chord * (3.0 * u2 - 2.0 * u3)
            + &a.tangent * (length * (u3 - 2.0 * u2 + u))
            + &b.tangent * (length * (u3 - u2))
    };
    let (from, grows) = (a.at.values[input], a.at.values[input] <= b.at.values[input]);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let there = from + at(middle)[input];
        if (there < value) == grows { low = middle } else { high = middle }
    }
    of.moved(&a.at, &at(0.5 * (low + high)))
}

/// The curve's arcs.
fn split(of: &ClosedLoop, curve: &Curve, input: usize) -> Vec<Arc> {
    let mut knots = curve.knots.clone();
    let grows = |knot: &Knot| knot.tangent[input] > 0.0;
    let first = knots.iter().find(|knot| knot.tangent[input].abs() > STILL);
    if first.is_some_and(|knot| !grows(knot)) {
        knots.reverse();
        if curve.closed {
            let back = &knots[knots.len() - 1].at.values - &knots[0].at.values;
            knots.iter_mut().for_each(|knot| knot.at.values += &back);
        }
        knots.iter_mut().for_each(|knot| knot.tangent = -&knot.tangent);
    }
    let mut parts = vec![vec![knots[0].clone()]];
    for pair in knots.windows(2) {
        if grows(&pair[0]) != grows(&pair[1]) {
            let fold = fold(of, &pair[0], &pair[1], input);
            parts.last_mut().expect("there is a first one").push(fold.clone());
            parts.push(vec![fold]);
        }
        parts.last_mut().expect("there is a first one").push(pair[1].clone());
    }
    let (start, end) = (knots[0].at.values.clone(), knots[knots.len() - 1].at.values.clone());
    match (curve.closed, parts.len()) {
        (true, 1) => turns(of, knots, input, end[input] - start[input]),
        (true, _) => {
            // The last part goes on in the first one, full revolutions back.
            let mut last = parts.pop().expect("there are several");
            let back = start - end;
            last.iter_mut().for_each(|knot| knot.at.values += &back);
            last.append(&mut parts[0]);
            parts[0] = last;
            let arc = |knots| Arc { knots, ends: [ArcEnd::Fold; 2] };
            parts.into_iter().filter(|knots| knots.len() > 1).map(arc).collect()
        }
        (false, count) => {
            let arc = |(number, knots)| {
                let end = |is_last| if is_last { ArcEnd::Open } else { ArcEnd::Fold };
                Arc { knots, ends: [end(number == 0), end(number + 1 == count)] }
            };
            let mut arcs: Vec<Arc> = parts.into_iter().enumerate().map(arc).collect();
            // Home's first.
            let is_home = |knot: &Knot| knot.at.values.norm() == 0.0;
            let home = arcs.iter().position(|arc| arc.knots.iter().any(is_home));
            arcs.rotate_left(home.unwrap_or(0));
            arcs
        }
    }
}

/// The arcs of an input that only grows around a closed curve: one for each of its revolutions.
fn turns(of: &ClosedLoop, knots: Vec<Knot>, input: usize, by: f64) -> Vec<Arc> {
    let count = (by / TAU).round().max(1.0) as usize;
    let whole = Arc { knots, ends: [ArcEnd::Turn; 2] };
    if count == 1 {
        return vec![whole];
    }
    let start = whole.knots[0].at.values[input];
    let arcs = Arcs { input, all: vec![whole], of_home: 1 };
    let cut = |number: usize| {
        let knots = &arcs.all[0].knots;
        match number {
            0 => Some(knots[0].clone()),
            number if number == count => knots.last().cloned(),
            number => {
                let value = start + number as f64 * TAU;
                let next = knots.partition_point(|knot| knot.at.values[input] <= value);
                let (a, b) = (&knots[next - 1], &knots[next]);
                let mut guess = between(of, (a, b), input, value);
                guess.values[input] = value;
                Knot::new(of, of.close(&guess, &unit(of, input))?, Some(&a.tangent)).ok()
            }
        }
    };
    let ends: Option<Vec<Knot>> = (0..=count).map(cut).collect();
    let Some(ends) = ends else { return arcs.all };
    let part = |pair: &[Knot]| {
        let value = |knot: &Knot| knot.at.values[input];
        let inside = |knot: &&Knot| (value(&pair[0])..value(&pair[1])).contains(&value(knot));
        let middle = arcs.all[0].knots.iter().filter(inside).cloned();
        let knots =
            std::iter::once(pair[0].clone()).chain(middle).chain([pair[1].clone()]).collect();
        Arc { knots, ends: [ArcEnd::Turn; 2] }
    };
    ends.windows(2).map(part).collect()
}

/// The position between two knots where the input turns back.
fn fold(of: &ClosedLoop, a: &Knot, b: &Knot, input: usize) -> Knot {
    let along = of.step(&a.at, &b.at).norm();
    let (mut low, mut high) = (0.0, along);
    let (mut at_low, mut at_high) = (a.tangent[input], b.tangent[input]);
    let mut best = if at_low.abs() < at_high.abs() { a.clone() } else { b.clone() };
    for round in 0..HALVINGS {
        // The secant, and every third time the middle, so that both ends come nearer.
        let secant = low - at_low * (high - low) / (at_high - at_low);
        let at = if round % 3 == 2 || !secant.is_finite() { 0.5 * (low + high) } else { secant };
        // Where curves cross, the nearest knot has to do.
        let Some(knot) = a.step(of, at) else { break };
        let slope = knot.tangent[input];
        best = knot;
        if slope == 0.0 || high - low <= 1e-13 {
            break;
        }
        if (slope > 0.0) == (at_low > 0.0) {
            (low, at_low) = (at, slope);
        } else {
            (high, at_high) = (at, slope);
        }
    }
    best
}
