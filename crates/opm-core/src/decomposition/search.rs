//! Depth-first search, leg by leg, over every way to split every leg. Branches that cannot become
//! two proper subgroups are pruned.

use super::Freedom;
use crate::group::subspace::{Basis, Frame};
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;
use nalgebra::Vector6;

/// While screws are collected, a bracket or a screw counts as a new direction only if its component
/// outside the span is this large. That is larger than any rounding, even if brackets of nearly
/// parallel screws amplify it, because an error must never prune a valid branch. A true direction
/// that is missed only costs time: the complete split is fitted with the proper tolerance.
const CLEARLY_NEW: f64 = 0.05;

/// A way to split one leg: its freedoms in two parts, with their unit normalised screws.
pub(super) struct SplitCandidate {
    pub lower: Vec<Freedom>,
    pub upper: Vec<Freedom>,
    /// The screws of the lower part, followed by those of the upper part.
    screws: Vec<Vector6<f64>>,
}

impl SplitCandidate {
    pub fn lower_screws(&self) -> &[Vector6<f64>] {
        &self.screws[..self.lower.len()]
    }

    pub fn upper_screws(&self) -> &[Vector6<f64>] {
        &self.screws[self.lower.len()..]
    }
}

/// The ways to split a leg, longest lower part first: between joints, within a universal joint, and
/// within a cylindrical joint in both orders, since its two freedoms commute. A spherical joint is
/// never split.
pub(super) fn candidates(leg: &Leg, frame: &Frame) -> Vec<SplitCandidate> {
    let freedoms: Vec<(Freedom, Vector6<f64>)> = leg
        .joints
        .iter()
        .enumerate()
        .flat_map(|(joint, j)| {
            let freedom = move |index| Freedom { joint, index };
            let unit = |(index, screw)| (freedom(index), frame.unit(&screw));
            j.screws().into_iter().enumerate().map(unit).collect::<Vec<_>>()
        })
        .collect();
    let split = |freedoms: &[(Freedom, Vector6<f64>)], at: usize| {
        let (lower, upper) = freedoms.split_at(at);
        let names = |part: &[(Freedom, _)]| part.iter().map(|(freedom, _)| *freedom).collect();
        let screws = freedoms.iter().map(|(_, screw)| *screw).collect();
        SplitCandidate { lower: names(lower), upper: names(upper), screws }
    };
    let mut candidates = vec![];
    for at in (0..=freedoms.len()).rev() {
        let above = freedoms.get(at).map(|(freedom, _)| *freedom).filter(|above| above.index > 0);
        match above.map(|above| leg.joints[above.joint].kind) {
            Some(JointKind::Spherical) => {}
            Some(JointKind::Cylindrical) => {
                let mut swapped = freedoms.clone();
                swapped.swap(at - 1, at);
                candidates.push(split(&freedoms, at));
                candidates.push(split(&swapped, at));
            }
            Some(
                JointKind::Revolute
                | JointKind::Prismatic
                | JointKind::Helical { .. }
                | JointKind::Universal { .. },
            )
            | None => candidates.push(split(&freedoms, at)),
        }
    }
    candidates
}

/// Calls `accept` with every split that may consist of two subgroups, given as one candidate per
/// leg. Stops when `accept` returns false. Returns the number of partial splits visited.
pub(super) fn splits(
    candidates: &[Vec<SplitCandidate>],
    lambda: usize,
    accept: &mut dyn FnMut(&[&SplitCandidate]) -> bool,
) -> usize {
    let mut search =
        Search { candidates, lambda, accept, chosen: vec![], visited: 0, stopped: false };
    search.descend(Basis::EMPTY, Basis::EMPTY);
    search.visited
}

struct Search<'a, 'f> {
    candidates: &'a [Vec<SplitCandidate>],
    lambda: usize,
    accept: &'f mut dyn FnMut(&[&SplitCandidate]) -> bool,
    chosen: Vec<&'a SplitCandidate>,
    visited: usize,
    stopped: bool,
}

impl<'a> Search<'a, '_> {
    /// Splits the next leg; `lower` and `upper` are the closures of the screws collected so far.
    fn descend(&mut self, lower: Basis, upper: Basis) {
        let Some(candidates) = self.candidates.get(self.chosen.len()) else {
            self.stopped = !(self.accept)(&self.chosen);
            return;
        };
        for candidate in candidates {
            if self.stopped {
                return;
            }
            self.visited += 1;
            let lower = enlarged(lower, candidate.lower_screws());
            let upper = enlarged(upper, candidate.upper_screws());
            if self.possible(&lower, &upper) {
                self.chosen.push(candidate);
                self.descend(lower, upper);
                self.chosen.pop();
            }
        }
    }

    /// Two proper subalgebras that intersect in one dimension and together span lambda dimensions
    /// have lambda + 1 dimensions between them. Subspaces of them have no more than that, and their
    /// intersection has at most one dimension.
    fn possible(&self, lower: &Basis, upper: &Basis) -> bool {
        let (a, b) = (lower.dimension(), upper.dimension());
        a < self.lambda
            && b < self.lambda
            && a + b <= self.lambda + 1
            && lower.intersection(upper).dimension() <= 1
    }
}

fn enlarged(mut basis: Basis, screws: &[Vector6<f64>]) -> Basis {
    let before = basis.dimension();
    for screw in screws {
        basis.grow(screw, CLEARLY_NEW);
    }
    if basis.dimension() == before { basis } else { basis.closure(CLEARLY_NEW) }
}
