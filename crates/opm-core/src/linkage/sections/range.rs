//! The range of a linkage's input: where the linkage closes.
//!
//! The loop with the input folds at its dead points, where its reach condition is an equality. The
//! other loop folds at certain `τ`. These are inputs of the first loop as well, which gives the
//! corresponding values of the linkage's input in closed form. Nothing changes between two neighbouring
//! values of all these, so one position in between decides whether the linkage closes there.

use super::{DeadPoint, SectionInput};
use crate::chain::Branch;
use crate::group::JointDisplacement;
use crate::linkage::InputRange;
use crate::mechanism::joint::Quantity;
use std::f64::consts::TAU;

/// Values of the input that differ by less than this, in radians or as a fraction of the mechanism's
/// size, are equal. Two roots that meet differ by the square root of their rounding, and a gap as small
/// as this cannot be distinguished from none.
const SAME: f64 = 1e-12;

/// By how many neighbouring numbers an end of the range may be off.
const MOST_ROUNDED: usize = 64;

/// What happens at an end of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fold {
    /// The loop with the input folds.
    First,
    /// The loop driven by the imaginary joint folds.
    Second,
    /// The linkage does not come to the end: a joint goes to infinity.
    Never,
}

/// An interval of displacements of the input, and what happens at each of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub ends: [f64; 2],
    pub folds: [Fold; 2],
}

/// The displacements of the input at which a set of branches closes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ClosingSet {
    /// Every displacement.
    Everywhere,
    /// Intervals, ascending, that have at most an end in common.
    Intervals(Vec<Span>),
}

/// A displacement of the input at which something changes.
type Change = (f64, Fold);

impl SectionInput<'_> {
    /// The values of the input at which the loop closes in any branch.
    pub fn range(&self) -> InputRange {
        self.reported(self.first_loop().branches())
    }

    /// The values of the input at which the loop closes with this sign of the first choice. The
    /// second choice makes no difference: its two branches end where they meet.
    pub fn branch_range(&self, first: Branch) -> InputRange {
        let branches = self.first_loop().branches().iter().copied();
        self.reported(&branches.filter(|&b| b == first).collect::<Vec<_>>())
    }

    fn reported(&self, first: &[Branch]) -> InputRange {
        let period = self.period();
        let intervals = match self.closing(first) {
            ClosingSet::Everywhere if period == Some(TAU) && self.is_angle() => {
                return InputRange::FullTurn;
            }
            ClosingSet::Everywhere => vec![[f64::NEG_INFINITY, f64::INFINITY]],
            ClosingSet::Intervals(spans) => {
                let inside = |span: &Span| self.inside(span, first);
                let mut intervals: Vec<_> = spans.iter().map(inside).collect();
                intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
                intervals
            }
        };
        InputRange::Intervals { intervals, period }
    }

    /// The values at the ends of an interval. The rounding of a value must not put it outside, where the
    /// input's loop moves the imaginary joint very fast: it is then the next number that is inside.
    fn inside(&self, span: &Span, first: &[Branch]) -> [f64; 2] {
        let home = self.coordinate().home;
        let closes = |value: f64| first.iter().any(|&b| self.closes(value - home, b));
        let [low, high] = span.ends.map(|end| home + end);
        let end = |value: f64, fold: Fold, next: fn(f64) -> f64| {
            let near = std::iter::successors(Some(value), |value| Some(next(*value)));
            let inside = near.take(MOST_ROUNDED).find(|&value| closes(value));
            if fold == Fold::Never { value } else { inside.unwrap_or(value) }
        };
        let [from, to] = span.folds;
        [end(low, from, f64::next_up), end(high, to, f64::next_down)]
    }

    /// The displacement of the input after which its loop is as before; `None` if there is none.
    pub(super) fn period(&self) -> Option<f64> {
        self.own().closed.driven_by(0).period(self.loop_index - 1)
    }

    fn is_angle(&self) -> bool {
        self.coordinate().quantity == Quantity::Angle
    }

    /// The unit in which displacements of the input are near or far: a radian, or the mechanism's size.
    pub(super) fn unit(&self) -> f64 {
        if self.is_angle() { 1.0 } else { self.joints.size }
    }

    /// The displacements at which the first loop closes in any of these branches, and the second one
    /// with it.
    pub(super) fn closing(&self, first: &[Branch]) -> ClosingSet {
        let changes = self.changes();
        let closes = |displacement: f64| first.iter().any(|&b| self.closes(displacement, b));
        let (Some(&lowest), Some(&highest)) = (changes.first(), changes.last()) else {
            let everywhere = closes(0.0);
            return if everywhere { ClosingSet::Everywhere } else { ClosingSet::Intervals(vec![]) };
        };
        match self.period() {
            Some(period) => {
                let before = (highest.0 - period, highest.1);
                let spans = spans(before, &changes, |from, to| closes(0.5 * (from + to)));
                self.around(spans, period)
            }
            None => {
                let far = |value: f64| (value.abs() + 1.0).max(self.unit());
                let (low, high) = (lowest.0 - far(lowest.0), highest.0 + far(highest.0));
                let middle = |from: f64, to: f64| 0.5 * (from.max(low) + to.min(high));
                let end = (f64::INFINITY, Fold::Never);
                let ends = [changes, vec![end]].concat();
                let start = (f64::NEG_INFINITY, Fold::Never);
                let spans = spans(start, &ends, |from, to| closes(middle(from, to)));
                let all = |span: &Span| span.ends.iter().all(|end| end.is_infinite());
                if spans.iter().any(all) {
                    ClosingSet::Everywhere
                } else {
                    ClosingSet::Intervals(spans)
                }
            }
        }
    }

    /// Intervals of one period, as those nearest to home. The last one may continue in the first one, a
    /// period later.
    fn around(&self, mut spans: Vec<Span>, period: f64) -> ClosingSet {
        if let [head, .., tail] = &mut *spans
            && tail.ends[1] - period == head.ends[0]
            && head.folds[0] != Fold::Never
        {
            (head.ends[0], head.folds[0]) = (tail.ends[0] - period, tail.folds[0]);
            spans.pop();
        }
        match *spans {
            [Span { ends: [low, high], folds: [fold, _] }]
                if high - low >= period - SAME * self.unit() && fold != Fold::Never =>
            {
                ClosingSet::Everywhere
            }
            _ => {
                spans.iter_mut().for_each(|span| span.ends = near_home(span.ends, period));
                ClosingSet::Intervals(spans)
            }
        }
    }

    /// The displacements of the input, within one period if there is one, ascending, at which either
    /// loop folds or goes to infinity.
    fn changes(&self) -> Vec<Change> {
        let what = |point: &DeadPoint, fold| if point.is_pole { Fold::Never } else { fold };
        let mut changes: Vec<Change> = self
            .first_loop()
            .dead_points()
            .iter()
            .map(|point| (point.at.value(), what(point, Fold::First)))
            .collect();
        let own = self.own().closed.driven_by(0);
        for point in self.second_loop().dead_points() {
            for &branch in own.branches() {
                if let Some(at) = own.counted(point.at, branch, self.loop_index - 1) {
                    changes.push((at, what(point, Fold::Second)));
                }
            }
        }
        // Of equal ones, the pole decides.
        changes.sort_by(|a, b| {
            a.0.total_cmp(&b.0).then((a.1 != Fold::Never).cmp(&(b.1 != Fold::Never)))
        });
        let same = SAME * self.unit();
        changes.dedup_by(|b, a| b.0 - a.0 <= same);
        changes
    }

    /// Whether both loops close at this displacement of the input.
    fn closes(&self, displacement: f64, first: Branch) -> bool {
        let own = self.driving(displacement).map(|input| self.first_loop().solve(input, first));
        own.is_some_and(|own| {
            own.is_ok_and(|displacements| {
                let tau = match displacements[self.imaginary_index()] {
                    tau @ JointDisplacement::Value(_) => tau,
                    tau => JointDisplacement::Direction(tau.unit_direction()),
                };
                self.second_loop().closes(tau)
            })
        })
    }
}

/// The intervals from `before` through `changes` in which the loop closes; neighbours are joined, except
/// where a joint goes to infinity.
fn spans(before: Change, changes: &[Change], closes: impl Fn(f64, f64) -> bool) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    let mut from = before;
    for &to in changes {
        if closes(from.0, to.0) {
            match spans.last_mut() {
                Some(before) if before.ends[1] == from.0 && from.1 != Fold::Never => {
                    (before.ends[1], before.folds[1]) = to;
                }
                _ => spans.push(Span { ends: [from.0, to.0], folds: [from.1, to.1] }),
            }
        }
        from = to;
    }
    spans
}

/// The same interval modulo the period: around zero if possible, else with its middle within half a
/// period of zero.
pub fn near_home([low, high]: [f64; 2], period: f64) -> [f64; 2] {
    let around = (high / period).floor() * period;
    if low <= around {
        return [low - around, high - around];
    }
    let revolutions = (0.5 * (low + high) / period - 0.5).ceil() * period;
    [low - revolutions, high - revolutions]
}
