//! The splits of a mechanism within a tolerance.

use super::relation::{BOTH, related};
use crate::decomposition::Freedom;
use crate::decomposition::element::{Element, generated, robust, worst};
use crate::decomposition::search::candidates;
use crate::group::subspace::{Frame, MotionSubspace, SubspaceClass};
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;

/// The largest number of partial splits that are visited, and of splits that are tried. Mechanisms
/// with partial subspaces need far fewer, because wrong splits are dropped after one or two legs.
const MOST_VISITED: usize = 4000;
const MOST_SPLITS: usize = 32;

/// Two proper subgroups of SE(3) that share one dimension have at most this many together.
pub(in crate::decomposition) const MOST_DIMENSIONS: usize = 7;

/// The freedoms of a leg in two parts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Parts {
    pub lower: Vec<Freedom>,
    pub upper: Vec<Freedom>,
}

/// A split of every leg whose sections nearly move in two groups.
#[derive(Clone, Debug)]
pub(super) struct NearSplit {
    pub legs: Vec<Parts>,
    pub lower: SubspaceClass,
    pub upper: SubspaceClass,
}

/// A way to split a leg, with the elements of both parts.
struct Candidate {
    parts: Parts,
    lower: Vec<Element>,
    upper: Vec<Element>,
}

/// The elements of some freedoms of a leg.
pub(in crate::decomposition) fn elements(leg: &Leg, freedoms: &[Freedom]) -> Vec<Element> {
    let element = |f: &Freedom| Element::of(&leg.joints[f.joint], f.index);
    freedoms.iter().filter_map(element).collect()
}

/// The splits within a tolerance (in radians and characteristic lengths), best fit first.
pub(super) fn splits(mechanism: &Mechanism, frame: &Frame, tolerance: f64) -> Vec<NearSplit> {
    let of_leg = |leg: &Leg| -> Vec<Candidate> {
        let candidates = candidates(leg, frame).into_iter();
        let parts = candidates.map(|c| Parts { lower: c.lower, upper: c.upper });
        let with_elements = |parts: Parts| Candidate {
            lower: elements(leg, &parts.lower),
            upper: elements(leg, &parts.upper),
            parts,
        };
        parts.map(with_elements).collect()
    };
    let candidates: Vec<_> = mechanism.legs.iter().map(of_leg).collect();
    let mut search = Search {
        candidates: &candidates,
        frame,
        tolerance,
        chosen: vec![],
        lower: vec![],
        upper: vec![],
        visited: 0,
        found: vec![],
    };
    search.descend();
    let mut found = search.found;
    found.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    found.into_iter().map(|(_, split)| split).collect()
}

struct Search<'a> {
    candidates: &'a [Vec<Candidate>],
    frame: &'a Frame,
    tolerance: f64,
    chosen: Vec<&'a Candidate>,
    /// The elements of the legs that are split already.
    lower: Vec<Element>,
    upper: Vec<Element>,
    visited: usize,
    /// Splits, with the largest offset of an element.
    found: Vec<(f64, NearSplit)>,
}

impl Search<'_> {
    fn descend(&mut self) {
        let Some(candidates) = self.candidates.get(self.chosen.len()) else {
            self.complete();
            return;
        };
        for candidate in candidates {
            if self.visited >= MOST_VISITED || self.found.len() >= MOST_SPLITS {
                return;
            }
            self.visited += 1;
            let before = (self.lower.len(), self.upper.len());
            self.lower.extend(&candidate.lower);
            self.upper.extend(&candidate.upper);
            if self.possible() {
                self.chosen.push(candidate);
                self.descend();
                self.chosen.pop();
            }
            self.lower.truncate(before.0);
            self.upper.truncate(before.1);
        }
    }

    fn generated(&self, elements: &[Element]) -> SubspaceClass {
        generated(elements, self.frame.length, self.tolerance)
    }

    /// Whether the sections so far can become two proper groups with at most one dimension in common.
    /// Two groups within a third one have at least as many dimensions in common as they have in excess
    /// of it. This also drops two groups that are the same within the tolerance.
    fn possible(&self) -> bool {
        let dimension = |elements: &[Element]| self.generated(elements).dimension();
        let (a, b) = (dimension(&self.lower), dimension(&self.upper));
        if a > 4 || b > 4 || a + b > MOST_DIMENSIONS {
            return false;
        }
        let both = [&self.lower[..], &self.upper[..]].concat();
        let together = generated(&both, self.frame.length, BOTH * self.tolerance);
        a + b <= together.dimension() + 1
    }

    /// Fits the groups of a complete split.
    fn complete(&mut self) {
        let length = self.frame.length;
        let fit = |elements: &[Element]| robust(self.generated(elements), elements, length);
        let fitted = [fit(&self.lower), fit(&self.upper)];
        let counts = [self.lower.len(), self.upper.len()];
        let [lower, upper] = related(fitted, counts, length, self.tolerance);
        if upper != SubspaceClass::Identity {
            let span = |class: &SubspaceClass| MotionSubspace::span(*self.frame, &class.screws());
            // Groups that meet in nothing are left to the decomposition to accept or not.
            if span(&lower).intersection(&span(&upper)).dimension() > 1 {
                return;
            }
        }
        let offset = worst(&self.lower, &lower, length).max(worst(&self.upper, &upper, length));
        let legs = self.chosen.iter().map(|candidate| candidate.parts.clone()).collect();
        self.found.push((offset, NearSplit { legs, lower, upper }));
    }
}
