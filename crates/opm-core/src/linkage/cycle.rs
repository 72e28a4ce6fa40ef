//! Once through everything that a linkage can do without being taken apart.

use super::range::{Fold, Span, Spans};
use super::{Input, LinkageBranch};
use crate::chain::Branch;
use std::f64::consts::{PI, TAU};

/// How far the ends of two branches that meet in a fold may be apart: the square root of rounding.
const MEET: f64 = 1e-6;

/// More arcs than any cycle has: two signs, and up to twelve folds.
const MOST_ARCS: usize = 64;

/// The closed motion of a linkage that starts at home with its input growing.
///
/// An input that can turn all the way round does so once, in the home branch. Any other comes to
/// an end of its range, where one of the two four-bars folds, and the linkage's only way on is back,
/// in the branch that meets the one that it came by; so on, until it is home again.
#[derive(Clone, Debug, PartialEq)]
pub struct Cycle {
    home: f64,
    motion: Motion,
}

#[derive(Clone, Debug, PartialEq)]
enum Motion {
    Turn(LinkageBranch),
    /// Arcs from fold to fold, the last of which ends where the first starts, and how far into the
    /// first one home is, 0 to 1. (Back and forth the input does not get round: what its four-bar
    /// can do without a full turn lies between two folds of that four-bar.)
    Arcs(Vec<Arc>, f64),
}

/// A branch from one fold to the next, displacements of the input.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Arc {
    from: f64,
    to: f64,
    branch: LinkageBranch,
}

impl Arc {
    /// The input's displacement; at a fold it stands still, where all other joints would otherwise
    /// run away.
    fn at(&self, part: f64) -> f64 {
        let (middle, half) = (0.5 * (self.from + self.to), 0.5 * (self.to - self.from));
        (middle - half * (PI * part).cos()).clamp(self.from.min(self.to), self.from.max(self.to))
    }
}

impl Cycle {
    /// The input's value, as reported, and the branch at a phase of 0 to 1 of the cycle; it is home
    /// at both ends (a turn later, where the input turns round).
    pub fn at(&self, phase: f64) -> (f64, LinkageBranch) {
        let phase = phase.clamp(0.0, 1.0);
        match &self.motion {
            Motion::Turn(branch) => (self.home + TAU * phase, *branch),
            Motion::Arcs(arcs, start) => {
                let place = phase * arcs.len() as f64 + start;
                let arc = arcs[place as usize % arcs.len()];
                // At both ends home itself, not what it is rounded to.
                let ends = phase == 0.0 || phase == 1.0;
                let displacement = if ends { 0.0 } else { arc.at(place.fract()) };
                (self.home + displacement, arc.branch)
            }
        }
    }

    /// Whether the input turns all the way round.
    pub fn is_turn(&self) -> bool {
        matches!(self.motion, Motion::Turn(_))
    }
}

/// The other branch of a two-valued choice.
fn flipped(branch: Branch) -> Branch {
    match branch {
        Branch::Plus => Branch::Minus,
        Branch::Minus => Branch::Plus,
    }
}

impl Input<'_> {
    /// The motion that starts at home with the input growing, all the way until it is home again.
    pub fn cycle(&self) -> Cycle {
        let branch = self.home_branch();
        let motion = match self.home_span(branch) {
            Some(span) => self.arcs(span, branch),
            None => Motion::Turn(branch),
        };
        Cycle { home: self.coordinate().home, motion }
    }

    /// The span of the home branch around home; `None` where that is a full turn.
    fn home_span(&self, branch: LinkageBranch) -> Option<Span> {
        match self.spans(&[branch.first]) {
            Spans::Full => None,
            Spans::Some(spans) => {
                let outside = |span: &Span| span.ends[0].max(-span.ends[1]);
                let nearest = |a: &Span, b: &Span| outside(a).total_cmp(&outside(b));
                spans
                    .into_iter()
                    .min_by(nearest)
                    .or(Some(Span { ends: [0.0; 2], folds: [Fold::First; 2] }))
            }
        }
    }

    fn arcs(&self, home: Span, branch: LinkageBranch) -> Motion {
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
            }
            forward = !forward;
            let [low, high] = span.ends;
            let (from, to) = if forward { (low, high) } else { (high, low) };
            let arc = Arc { from, to, branch };
            if forward && branch == first.branch && (from - first.from).abs() <= MEET {
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
        Motion::Arcs(arcs, start)
    }

    /// The span of the other branch that meets the end of this one.
    fn meeting(&self, span: Span, end: usize, branch: LinkageBranch) -> Option<Span> {
        let Spans::Some(spans) = self.spans(&[branch.first]) else { return None };
        spans.into_iter().find_map(|other| {
            let away = span.ends[end] - other.ends[end];
            let turns = (away / TAU).round() * TAU;
            let met = (away - turns).abs() <= MEET;
            met.then(|| Span { ends: other.ends.map(|e| e + turns), ..other })
        })
    }
}
