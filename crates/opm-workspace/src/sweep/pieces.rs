//! Rows of a leg that leaves no region of the plane, in pieces: what can change its mind is in closed
//! form ([`Manipulator::changes`]), and between two changes one pose speaks for all.
//!
//! [`Manipulator::changes`]: opm_core::manipulator::Manipulator::changes

use super::runs::{self, Run};

/// How near to a change a pose may be, in steps, and still be spoken for by another.
const TIE: f64 = 1e-6;

/// Where a leg may change its mind in one row: poses that are near to a change, and (a run of none) changes
/// between two poses.
#[derive(Clone, Debug, Default)]
pub struct Changes {
    found: Vec<Run>,
    sorted: Vec<Run>,
}

impl Changes {
    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.found.clear();
    }

    /// Adds an interval of the row, in steps from its first pose, of which no number is larger than
    /// `extent`.
    pub fn add(&mut self, [from, to]: [f64; 2], extent: f64) {
        let tie = TIE.max(extent * 1e-12);
        // Negative numbers become zero.
        let (first, after) = ((from - tie).ceil() as u64, ((to + tie).floor() + 1.0) as u64);
        self.found.push(Run { from: first, to: after.max(first) });
    }

    /// Adds every pose of a run.
    pub fn add_all(&mut self, run: Run) {
        self.found.push(run);
    }

    /// Which poses of `among` the leg follows to: asks for all that are near to a change, and for one of
    /// every piece between them.
    pub fn decide(
        &mut self,
        among: &[Run],
        mut follows: impl FnMut(u64) -> bool,
        out: &mut Vec<Run>,
    ) {
        out.clear();
        let Some((first, last)) = among.first().zip(among.last()) else { return };
        runs::union(self.found.drain(..), &mut self.sorted);
        let end = Run { from: last.to, to: last.to };
        let mut next = first.from;
        for change in self.sorted.iter().chain([&end]) {
            let mut parts = runs::within(among, Run { from: next, to: change.from }).peekable();
            let speaker = parts.peek().map(|part| part.from.midpoint(part.to));
            if speaker.is_some_and(&mut follows) {
                parts.for_each(|part| runs::append(out, part));
            }
            for part in runs::within(among, *change) {
                (part.from..part.to)
                    .filter(|&pose| follows(pose))
                    .for_each(|pose| runs::push(out, pose));
            }
            next = change.to.max(next);
        }
    }
}
