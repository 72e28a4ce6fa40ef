//! Which pairs cannot have come near enough to count, judged by how far their members have moved.
//!
//! The distance of two members changes by no more than the ends of their capsules move. So a pair that was measured is left
//! alone until its two members together have moved as far as it was away from what counts.
//!
//! Between two samples, a coordinate that is a convex or a concave function of time gets beyond its two values by no more than
//! half of the step times the larger of its two speeds there: it stays on one side of its tangents. So a point gets no farther
//! from its first place than the chord and half of the step times the sum of its two speeds. With several samples in each
//! period of the motion, all coordinates are convex or concave in nearly all steps.

use super::Sampled;
use crate::Interference;
use crate::member::Shape;

/// How far the members of a mechanism have moved along a motion, in units of the mechanism's size.
#[derive(Clone, Debug)]
pub(super) struct Moved {
    /// For every member, the sum over the steps of how far any end of its capsules got from where it was at the step's start.
    ways: Vec<f64>,
    /// The sum of the ways of a pair's members up to which the pair does not count.
    far_until: Vec<f64>,
    /// Whether the ends' velocities are known at both ends of the last step.
    known: bool,
}

impl Moved {
    /// Nothing has moved, and no pair has been measured.
    pub fn new(interference: &Interference) -> Self {
        let ways = vec![0.0; interference.members.len()];
        Self { ways, far_until: vec![f64::NEG_INFINITY; interference.pairs()], known: false }
    }

    /// Adds the step from one sample to the next.
    pub fn add(&mut self, interference: &Interference, from: &Sampled, to: &Sampled) {
        let (Some(after), Some(before)) = (&from.after, &to.before) else {
            self.known = false;
            return;
        };
        self.known = true;
        let step = to.time - from.time;
        for (member, way) in interference.members.iter().zip(&mut self.ways) {
            let mut farthest: f64 = 0.0;
            for shape in member.shapes.clone() {
                if !matches!(interference.shapes[shape], Shape::Capsule { .. }) {
                    continue;
                }
                for end in 0..2 {
                    let [start, finish] = [from, to].map(|sample| sample.ends[shape][end]);
                    let speeds = [
                        (after.ends[shape][end] - start).length() / after.by.abs(),
                        (before.ends[shape][end] - finish).length() / before.by.abs(),
                    ];
                    let chord = (finish - start).length();
                    farthest = farthest.max(chord + 0.5 * step * (speeds[0] + speeds[1]));
                }
            }
            *way += farthest;
        }
    }

    /// Whether a pair does not count in the last step.
    pub fn is_far(&self, interference: &Interference, pair: usize) -> bool {
        self.known && self.way(interference, pair) <= self.far_until[pair]
    }

    /// Takes by how much a pair is farther apart than what counts, in units of the mechanism's size, at the last sample.
    pub fn measured(&mut self, interference: &Interference, pair: usize, spare: f64) {
        self.far_until[pair] = self.way(interference, pair) + spare;
    }

    /// The ways of the two members of a pair.
    fn way(&self, interference: &Interference, pair: usize) -> f64 {
        let [one, other] = interference.pairs[pair].members;
        self.ways[one] + self.ways[other]
    }
}
