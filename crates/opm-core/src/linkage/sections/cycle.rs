//! The full cycle of a linkage: everything that it can do without being taken apart.

use super::range::{ClosingSet, Fold, Span};
use super::{SectionInput, SectionSigns};
use crate::chain::Branch;
use crate::linkage::cycle::{CycleArc, CycleShape};
use crate::linkage::{Cycle, LinkageBranch, NoCycle};
use crate::mechanism::joint::JointCoordinate;

/// How far apart the ends of two branches that meet in a fold may be, in radians or as a fraction of the
/// mechanism's size: the square root of rounding.
const MEET: f64 = 1e-6;

/// More arcs than any cycle has: it has two signs and up to twelve folds.
const MOST_ARCS: usize = 64;

/// The other branch of a two-valued choice.
fn flipped(branch: Branch) -> Branch {
    match branch {
        Branch::Plus => Branch::Minus,
        Branch::Minus => Branch::Plus,
    }
}

impl SectionInput<'_> {
    /// The motion that starts at home with the input increasing, until the linkage is home again.
    ///
    /// # Errors
    /// The linkage goes to infinity instead.
    pub fn cycle(&self) -> Result<Cycle, NoCycle> {
        let branch = self.home_branch();
        let home = self.coordinate().home;
        match (self.home_span(branch), self.period()) {
            (Some(span), _) => Ok(Cycle::arcs(home, self.arcs(span, branch)?)),
            (None, Some(period)) => {
                let branches = vec![LinkageBranch::Signs(branch)];
                Ok(Cycle { home, shape: CycleShape::Revolution(branches, period) })
            }
            (None, None) => Err(self.no_cycle(f64::INFINITY)),
        }
    }

    fn no_cycle(&self, end: f64) -> NoCycle {
        let JointCoordinate { name, quantity, home, .. } = self.coordinate();
        NoCycle { input: name.clone(), end: home + end, quantity: *quantity }
    }

    /// The interval of the home branch around home; `None` if it is every displacement.
    fn home_span(&self, branch: SectionSigns) -> Option<Span> {
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

    fn arcs(&self, span: Span, mut branch: SectionSigns) -> Result<Vec<CycleArc>, NoCycle> {
        let arc = |[from, to]: [f64; 2], branch| CycleArc {
            from,
            to,
            branch: LinkageBranch::Signs(branch),
        };
        let (home, start) = (span.ends, branch);
        let (mut span, mut forward) = (span, true);
        let mut arcs = vec![arc(home, start)];
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
            let run = if forward { [low, high] } else { [high, low] };
            if forward && branch == start && (run[0] - home[0]).abs() <= MEET * self.unit() {
                break;
            }
            arcs.push(arc(run, branch));
        }
        Ok(arcs)
    }

    /// The interval of the other branch that meets this one at the given end.
    fn meeting(&self, span: Span, end: usize, branch: SectionSigns) -> Option<Span> {
        let ClosingSet::Intervals(spans) = self.closing(&[branch.first]) else { return None };
        spans.into_iter().find_map(|other| {
            let away = span.ends[end] - other.ends[end];
            let revolutions = self.period().map_or(0.0, |period| (away / period).round() * period);
            let met = (away - revolutions).abs() <= MEET * self.unit();
            met.then(|| Span { ends: other.ends.map(|e| e + revolutions), ..other })
        })
    }
}
