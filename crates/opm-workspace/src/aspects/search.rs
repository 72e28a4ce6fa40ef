//! The way through the poses of one aspect that stays far from singularities.

use super::Aspects;
use super::levels::Levels;
use super::step::is_clear;
use crate::progress::{Cancelled, Progress};
use opm_core::manipulator::{Manipulator, Mode};
use std::cmp::{Ordering, Reverse};
use std::collections::{BinaryHeap, HashMap, HashSet};
use std::f64::consts::TAU;

/// The number of poses between two checks for cancellation.
const PORTION: u64 = 1 << 10;

/// Searches ways in one working mode.
pub struct Search<'a> {
    pub manipulator: &'a Manipulator,
    pub mode: Mode,
    pub aspects: &'a Aspects,
    pub progress: &'a Progress,
}

impl Search<'_> {
    /// A way from one pose of the grid to another, by steps of the grid that are all watched; `None` if there is none.
    /// Angles go on beyond a full turn.
    ///
    /// The way is the cheapest one by Dijkstra's algorithm (*A note on two problems in connexion with graphs*, 1959),
    /// where a step costs one over the clearance at either end. A step is watched only when it is on the cheapest way, and
    /// is banned if it is not clear (C. Dellin, S. Srinivasa, *A unifying formalism for shortest path problems with
    /// expensive edge evaluations*, 2016).
    pub fn way(&self, from: u64, to: u64) -> Result<Option<Vec<Vec<f64>>>, Cancelled> {
        let (mut banned, mut clear) = (HashSet::new(), HashSet::new());
        let mut costs = Costs::new(self);
        loop {
            let Some(numbers) = self.cheapest(from, to, &banned, &mut costs)? else {
                return Ok(None);
            };
            let poses = self.unrolled(&numbers);
            let steps = numbers.windows(2).zip(poses.windows(2));
            let mut blocked = false;
            for (numbers, poses) in steps {
                let step = [numbers[0], numbers[1]];
                if clear.contains(&step) {
                    continue;
                }
                self.progress.advance(0)?;
                if is_clear(self.manipulator, self.mode, &poses[0], &poses[1]) {
                    clear.insert(step);
                } else {
                    banned.insert(step);
                    banned.insert([step[1], step[0]]);
                    blocked = true;
                    break;
                }
            }
            if !blocked {
                return Ok(Some(poses));
            }
        }
    }

    fn cheapest(
        &self,
        from: u64,
        to: u64,
        banned: &HashSet<[u64; 2]>,
        costs: &mut Costs<'_>,
    ) -> Result<Option<Vec<u64>>, Cancelled> {
        let label = self.aspects.label(from);
        let mut before: HashMap<u64, (f64, u64)> = HashMap::from([(from, (0.0, from))]);
        let mut done: HashSet<u64> = HashSet::new();
        let mut open = BinaryHeap::from([Reverse(Open { cost: 0.0, number: from })]);
        while let Some(Reverse(Open { cost, number })) = open.pop() {
            if !done.insert(number) {
                continue;
            }
            if (done.len() as u64).is_multiple_of(PORTION) {
                self.progress.advance(0)?;
            }
            if number == to {
                let mut way = vec![to];
                while way[way.len() - 1] != from {
                    way.push(before[&way[way.len() - 1]].1);
                }
                way.reverse();
                return Ok(Some(way));
            }
            for next in self.neighbours(number) {
                if done.contains(&next)
                    || self.aspects.label(next) != label
                    || banned.contains(&[number, next])
                {
                    continue;
                }
                let cost = cost + costs.of(number) + costs.of(next);
                if before.get(&next).is_none_or(|known| cost < known.0) {
                    before.insert(next, (cost, number));
                    open.push(Reverse(Open { cost, number: next }));
                }
            }
        }
        Ok(None)
    }

    /// The neighbours of a pose in the grid.
    fn neighbours(&self, number: u64) -> Vec<u64> {
        let (mut found, mut stride) = (Vec::new(), 1);
        for axis in &self.aspects.axes {
            let count = axis.axis.count;
            let place = number / stride % count;
            if place > 0 {
                found.push(number - stride);
            } else if axis.circle {
                found.push(number + (count - 1) * stride);
            }
            if place + 1 < count {
                found.push(number + stride);
            } else if axis.circle {
                found.push(number - (count - 1) * stride);
            }
            stride *= count;
        }
        found
    }

    /// The poses of these numbers, with angles that go on where a step closes a circle.
    fn unrolled(&self, numbers: &[u64]) -> Vec<Vec<f64>> {
        let axes = &self.aspects.axes;
        let mut turns = vec![0.0; axes.len()];
        let places = |number: u64| {
            let mut number = number;
            let place = |axis: &crate::set::SetAxis| {
                let place = number % axis.axis.count;
                number /= axis.axis.count;
                place
            };
            axes.iter().map(place).collect::<Vec<u64>>()
        };
        let mut last: Option<Vec<u64>> = None;
        let pose = |&number: &u64| {
            let here = places(number);
            for (i, axis) in axes.iter().enumerate() {
                let Some(last) = last.as_ref().filter(|_| axis.circle) else { continue };
                let end = axis.axis.count - 1;
                match (last[i], here[i]) {
                    (a, 0) if a == end => turns[i] += TAU,
                    (0, b) if b == end => turns[i] -= TAU,
                    _ => {}
                }
            }
            let values = axes.iter().zip(&here).zip(&turns);
            let pose = values.map(|((axis, &place), turn)| axis.axis.value(place) + turn).collect();
            last = Some(here);
            pose
        };
        numbers.iter().map(pose).collect()
    }
}

/// What the poses cost, as far as they are known.
struct Costs<'a> {
    levels: Levels<'a>,
    values: Vec<f64>,
    aspects: &'a Aspects,
    known: HashMap<u64, f64>,
}

impl<'a> Costs<'a> {
    fn new(search: &Search<'a>) -> Self {
        let levels = Levels::new(search.manipulator, search.mode);
        Self { levels, values: Vec::new(), aspects: search.aspects, known: HashMap::new() }
    }

    fn of(&mut self, number: u64) -> f64 {
        let Self { levels, values, aspects, known } = self;
        *known.entry(number).or_insert_with(|| {
            let pose = crate::set::point(&aspects.axes, number);
            if levels.at(&pose, values) { levels.clearance(values).recip() } else { f64::INFINITY }
        })
    }
}

/// A pose that the search goes on from. Those of the same cost come in the order of their numbers.
#[derive(PartialEq)]
struct Open {
    cost: f64,
    number: u64,
}

impl Eq for Open {}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        self.cost.total_cmp(&other.cost).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
