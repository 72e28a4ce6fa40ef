//! The full cycle of a linkage: everything that it can do without being taken apart.

use super::range::{ClosingSet, Fold, Span};
use super::{Input, LinkageBranch};
use crate::chain::Branch;
use crate::mechanism::joint::{JointCoordinate, Quantity};
use std::f64::consts::PI;

/// How far apart the ends of two branches that meet in a fold may be, in radians or as a fraction of the
/// mechanism's size: the square root of rounding.
const MEET: f64 = 1e-6;

/// More arcs than any cycle has: it has two signs and up to twelve folds.
const MOST_ARCS: usize = 64;

/// The closed motion of a linkage that starts at home with its input growing.
///
/// An input that can make a full revolution does so once, in the home branch; so does a slider that is
/// moved by the revolutions of a screw. Any other input comes to an end of its range, where one of the
/// two loops folds. The linkage then moves back in the
/// other branch that meets there, and so on until it is home again.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    home: f64,
    shape: CycleShape,
}

#[derive(Clone, Debug, PartialEq)]
enum CycleShape {
    /// A full revolution of the input, or another period of it, in one branch.
    Revolution(LinkageBranch, f64),
    /// Arcs from fold to fold. The last one ends where the first one starts. The number says at
    /// which part of the first arc home is, 0 to 1. (The input makes no revolution by going back
    /// and forth: if its loop has no full revolution, its range lies between two folds.)
    Arcs(Vec<Arc>, f64),
}

/// A branch between two folds; its ends are displacements of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc {
    from: f64,
    to: f64,
    branch: LinkageBranch,
}

impl Arc {
    /// The input's displacement at a part of the arc, 0 to 1. The input stands still at a fold,
    /// where the velocities of all other joints would otherwise be infinite.
    fn at(&self, part: f64) -> f64 {
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * (self.to - self.from));
        (middle - half * (PI * part).cos()).clamp(self.from.min(self.to), self.from.max(self.to))
    }
}

impl Cycle {
    /// The input's reported value, and the branch, at a phase of 0 to 1 of the cycle. Both ends are
    /// home; for an input with a full revolution, the end is one revolution later. (Screws whose
    /// axis has made revolutions have then moved on.)
    pub fn at(&self, phase: f64) -> (f64, LinkageBranch) {
        let phase = phase.clamp(0.0, 1.0);
        match &self.shape {
            CycleShape::Revolution(branch, period) => (self.home + period * phase, *branch),
            CycleShape::Arcs(arcs, start) => {
                let along = phase * arcs.len() as f64 + start;
                let arc = arcs[along as usize % arcs.len()];
                // Both ends are exactly home, without rounding.
                let ends = phase == 0.0 || phase == 1.0;
                let displacement = if ends { 0.0 } else { arc.at(along.fract()) };
                (self.home + displacement, arc.branch)
            }
        }
    }

    /// Whether the input makes a full revolution.
    pub fn is_revolution(&self) -> bool {
        matches!(self.shape, CycleShape::Revolution(..))
    }
}

/// Why a linkage has no cycle: it moves on to infinity, and does not come home.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "moved by {input}, the linkage does not come home: a joint goes to infinity as {input} nears {}",
    if end.is_finite() { format!("{end} {}", quantity.unit()) } else { "infinity".to_owned() }
)]
pub struct NoCycle {
    /// The name of the input.
    pub input: String,
    /// The value of the input where that happens, radians or metres; it may be infinite.
    pub end: f64,
    /// Whether the input is an angle or a length.
    pub quantity: Quantity,
}

/// The other branch of a two-valued choice.
fn flipped(branch: Branch) -> Branch {
    match branch {
        Branch::Plus => Branch::Minus,
        Branch::Minus => Branch::Plus,
    }
}

impl Input<'_> {
    /// The motion that starts at home with the input increasing, until the linkage is home again.
    ///
    /// # Errors
    /// The linkage goes to infinity instead.
    pub fn cycle(&self) -> Result<Cycle, NoCycle> {
        let branch = self.home_branch();
        let shape = match (self.home_span(branch), self.period()) {
            (Some(span), _) => self.arcs(span, branch)?,
            (None, Some(period)) => CycleShape::Revolution(branch, period),
            (None, None) => return Err(self.no_cycle(f64::INFINITY)),
        };
        Ok(Cycle { home: self.coordinate().home, shape })
    }

    fn no_cycle(&self, end: f64) -> NoCycle {
        let JointCoordinate { name, quantity, home, .. } = self.coordinate();
        NoCycle { input: name.clone(), end: home + end, quantity: *quantity }
    }

    /// The interval of the home branch around home; `None` if it is every displacement.
    fn home_span(&self, branch: LinkageBranch) -> Option<Span> {
        match self.closing(&[branch.first]) {
            ClosingSet::Everywhere => None,
            ClosingSet::Intervals(spans) => {
                let outside = |span: &Span| span.ends[0].max(-span.ends[1]);
                let nearest = |a: &Span, b: &Span| outside(a).total_cmp(&outside(b));
                spans
                    .into_iter()
                    .min_by(nearest)
                    .or(Some(Span { ends: [0.0; 2], folds: [Fold::First; 2] }))
            }
        }
    }

    fn arcs(&self, home: Span, branch: LinkageBranch) -> Result<CycleShape, NoCycle> {
        let first = Arc { from: home.ends[0], to: home.ends[1], branch };
        let (mut span, mut branch, mut forward) = (home, branch, true);
        let mut arcs = vec![first];
        while arcs.len() < MOST_ARCS {
            let end = usize::from(forward);
            match span.folds[end] {
                Fold::First => {
                    branch.first = flipped(branch.first);
                    span = self.meeting(span, end, branch).unwrap_or(span);
                }
                Fold::Second => branch.second = flipped(branch.second),
                Fold::Never => return Err(self.no_cycle(span.ends[end])),
            }
            forward = !forward;
            let [low, high] = span.ends;
            let (from, to) = if forward { (low, high) } else { (high, low) };
            let arc = Arc { from, to, branch };
            if forward && branch == first.branch && (from - first.from).abs() <= MEET * self.unit()
            {
                break;
            }
            arcs.push(arc);
        }
        let half = 0.5 * (first.to - first.from);
        let start = if half > 0.0 {
            ((first.from + half) / half).clamp(-1.0, 1.0).acos() / PI
        } else {
            0.0
        };
        Ok(CycleShape::Arcs(arcs, start))
    }

    /// The interval of the other branch that meets this one at the given end.
    fn meeting(&self, span: Span, end: usize, branch: LinkageBranch) -> Option<Span> {
        let ClosingSet::Intervals(spans) = self.closing(&[branch.first]) else { return None };
        spans.into_iter().find_map(|other| {
            let away = span.ends[end] - other.ends[end];
            let revolutions = self.period().map_or(0.0, |period| (away / period).round() * period);
            let met = (away - revolutions).abs() <= MEET * self.unit();
            met.then(|| Span { ends: other.ends.map(|e| e + revolutions), ..other })
        })
    }
}
