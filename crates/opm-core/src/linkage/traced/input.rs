//! A traced loop, driven by one of its joints.

use super::{ArcEnd, Arcs, Traced};
use crate::linkage::cycle::{Cycle, CycleArc, CycleShape, NoCycle};
use crate::linkage::{InputRange, Joints, LinkageBranch, Position, Rates};
use crate::mechanism::joint::{JointCoordinate, Quantity};
use std::f64::consts::{PI, TAU};
use std::ops::RangeInclusive;

/// Ends of intervals that differ by so much, in radians or sizes, are one: where curves meet.
const SAME: f64 = 1e-9;
/// An open end beyond this, in radians or sizes, is at infinity: another joint was as far as joints are followed.
const FAR: f64 = 0.1 * super::curve::FAR;

/// An input of a traced loop.
#[derive(Clone, Copy, Debug)]
pub struct TracedInput<'a> {
    traced: &'a Traced,
    arcs: &'a Arcs,
    joints: &'a Joints,
    coordinate: usize,
}

impl<'a> TracedInput<'a> {
    pub fn new(traced: &'a Traced, joints: &'a Joints, coordinate: usize) -> Option<Self> {
        let arcs = traced.arcs(coordinate)?;
        Some(Self { traced, arcs, joints, coordinate })
    }

    /// The number of arcs.
    pub fn count(&self) -> usize {
        self.arcs.all.len()
    }

    fn own(&self) -> &'a JointCoordinate {
        &self.joints.coordinates[self.coordinate]
    }

    /// The displacement of the freedom for a value of the input.
    fn inward(&self, value: f64) -> f64 {
        self.traced.inward(self.coordinate, value - self.own().home)
    }

    /// The position in an arc, counted from 1. With `near`, angles are those nearest to their values in `position`.
    pub fn position(&self, value: f64, arc: usize, position: &mut Position, near: bool) -> bool {
        let inside = value.is_finite() && (1..=self.count()).contains(&arc);
        let found =
            inside.then(|| self.traced.position(self.arcs, arc - 1, self.inward(value))).flatten();
        let Some(found) = found else { return false };
        position.branch = LinkageBranch::Arc(arc);
        position.imaginary = None;
        position.within_limits = true;
        for (i, displacement) in found.into_iter().enumerate() {
            let held = near.then_some(position.joints[i]);
            let (placed, within) = self.joints.value(i, displacement, held);
            position.joints[i] = if i == self.coordinate { value } else { placed };
            position.within_limits &= within;
        }
        position.within_limits &= self.joints.differences_allow(&position.joints);
        true
    }

    /// The rates at a position.
    pub fn rates(&self, position: &Position) -> Option<Rates> {
        let LinkageBranch::Arc(arc) = position.branch else { return None };
        let at = self.inward(position.joints[self.coordinate]);
        let arc = arc.checked_sub(1).filter(|&arc| arc < self.count())?;
        let joints = self.traced.rates(self.arcs, arc, (self.coordinate, at))?;
        Some(Rates { joints, imaginary: None })
    }

    /// The values in these arcs.
    pub fn range(&self, arcs: RangeInclusive<usize>) -> InputRange {
        let period = self.traced.turns(self.coordinate).then_some(TAU);
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        for arc in arcs {
            let [low, high] = self.arcs.interval(arc - 1);
            if period.is_some_and(|period| high - low >= period - SAME) {
                return InputRange::FullTurn;
            }
            match period {
                Some(period) => {
                    // A period earlier and later, so that neighbours across its end are joined.
                    let low_in = (low + PI).rem_euclid(period) - PI;
                    let own = [low_in, low_in + high - low];
                    intervals.extend([-period, 0.0, period].map(|by| own.map(|end| end + by)));
                }
                None => intervals.push(self.opened([low, high], arc - 1)),
            }
        }
        intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for [low, high] in intervals {
            match joined.last_mut() {
                Some(before) if low <= before[1] + SAME => before[1] = before[1].max(high),
                _ => joined.push([low, high]),
            }
        }
        if let Some(period) = period {
            if joined.iter().any(|[low, high]| high - low >= period - SAME) {
                return InputRange::FullTurn;
            }
            // Of each, that with its middle nearest to home; if home is inside, it is that one.
            joined.retain(|[low, high]| (-PI..PI).contains(&(0.5 * (low + high))));
        }
        let (home, unit) = (self.own().home, self.traced.unit(self.coordinate));
        let reported = |interval: [f64; 2]| interval.map(|end| home + unit * end);
        InputRange::Intervals { intervals: joined.into_iter().map(reported).collect(), period }
    }

    /// An interval of a slider without its open ends.
    fn opened(&self, [low, high]: [f64; 2], arc: usize) -> [f64; 2] {
        let mut ends = self.arcs.all[arc].ends;
        let [from, to] = self.arcs.run(arc);
        if from > to {
            ends.reverse();
        }
        let far = |value: f64| value.abs() >= FAR;
        [
            if ends[0] == ArcEnd::Open && far(low) { f64::NEG_INFINITY } else { low },
            if ends[1] == ArcEnd::Open && far(high) { f64::INFINITY } else { high },
        ]
    }

    /// Whether home's arc has no end either way.
    fn goes_on(&self) -> bool {
        self.opened(self.arcs.interval(0), 0).iter().all(|end| end.is_infinite())
    }

    /// The motion around home's curve.
    pub fn cycle(&self) -> Result<Cycle, NoCycle> {
        let JointCoordinate { name, quantity, home, .. } = self.own();
        let (unit, count) = (self.traced.unit(self.coordinate), self.arcs.of_home);
        let open = (0..count).find_map(|arc| {
            let end = self.arcs.all[arc].ends.iter().position(|end| *end == ArcEnd::Open)?;
            Some(home + unit * self.arcs.run(arc)[end])
        });
        if let Some(end) = open {
            // A screw turns on without end, and the loop is as before, but further on.
            if *quantity == Quantity::Angle && count == 1 && self.goes_on() {
                let branches = vec![LinkageBranch::Arc(1)];
                return Ok(Cycle { home: *home, shape: CycleShape::Revolution(branches, TAU) });
            }
            let far = (end - home).abs() >= FAR * unit;
            let end = if far { f64::INFINITY } else { end };
            return Err(NoCycle { input: name.clone(), end, quantity: *quantity });
        }
        if self.arcs.all[0].ends[0] == ArcEnd::Turn {
            let branches = (1..=count).map(LinkageBranch::Arc).collect();
            return Ok(Cycle { home: *home, shape: CycleShape::Revolution(branches, TAU) });
        }
        let arc = |number: usize| {
            let [from, to] = self.arcs.run(number).map(|end| unit * end);
            CycleArc { from, to, branch: LinkageBranch::Arc(number + 1) }
        };
        Ok(Cycle::arcs(*home, (0..count).map(arc).collect()))
    }
}
