//! Rows of a leg branch that leaves no region of the plane. The places along a row where its feasibility can
//! change are in closed form ([`Manipulator::feasibility_changes`]); between two of them one pose decides for all.
//!
//! [`Manipulator::feasibility_changes`]: opm_core::manipulator::Manipulator::feasibility_changes

use super::runs::{self, Run};

/// How near to a transition a pose may be, in steps, and still be decided by another pose.
const TIE: f64 = 1e-6;

/// Where the feasibility of a leg branch may change along one row: the poses near a transition, as runs, which
/// are empty for a transition between two poses.
#[derive(Clone, Debug, Default)]
pub struct Transitions {
    found: Vec<Run>,
    sorted: Vec<Run>,
}

impl Transitions {
    /// Forgets all transitions.
    pub fn clear(&mut self) {
        self.found.clear();
    }

    /// Adds an interval in which feasibility may change, in steps from the row's first pose. No number
    /// that it is computed from is larger than `extent`, in steps.
    pub fn add(&mut self, [from, to]: [f64; 2], extent: f64) {
        let tie = TIE.max(extent * 1e-12);
        // Negative numbers become zero.
        let (first, after) = ((from - tie).ceil() as u64, ((to + tie).floor() + 1.0) as u64);
        self.found.push(Run { from: first, to: after.max(first) });
    }

    /// Adds every pose of a run: each of them has to be decided on its own.
    pub fn add_all(&mut self, run: Run) {
        self.found.push(run);
    }

    /// Finds the poses of `among` that are `feasible`: asks for all that are near a transition, and for one
    /// pose of every piece between two transitions.
    pub fn decide(
        &mut self,
        among: &[Run],
        mut feasible: impl FnMut(u64) -> bool,
        out: &mut Vec<Run>,
    ) {
        out.clear();
        let Some((first, last)) = among.first().zip(among.last()) else { return };
        runs::union(self.found.drain(..), &mut self.sorted);
        let end = Run { from: last.to, to: last.to };
        let mut next = first.from;
        for transition in self.sorted.iter().chain([&end]) {
            let piece = Run { from: next, to: transition.from };
            let mut parts = runs::within(among, piece).peekable();
            let sample = parts.peek().map(|part| part.from.midpoint(part.to));
            if sample.is_some_and(&mut feasible) {
                parts.for_each(|part| runs::append(out, part));
            }
            for part in runs::within(among, *transition) {
                (part.from..part.to)
                    .filter(|&pose| feasible(pose))
                    .for_each(|pose| runs::push(out, pose));
            }
            next = transition.to.max(next);
        }
    }
}
