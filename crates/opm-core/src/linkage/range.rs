//! The range of a linkage's input: where the linkage closes.
//!
//! The four-bar with the input folds at the inputs where its reach condition is an equality. The
//! other four-bar folds at certain `τ`. These are inputs of the first four-bar as well, which gives
//! the corresponding values of the linkage's input in closed form. Nothing changes between two
//! neighbouring values of all these, so one position in between decides whether the linkage closes
//! there.

use super::Input;
use crate::chain::Branch;
use crate::numeric::angle::unit;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Values of the input that differ by less than this are equal. Two roots that meet differ by the
/// square root of their rounding, and a difference as small as this cannot be distinguished from zero.
const SAME: f64 = 1e-12;

/// The reported values of the input at which the loop closes, modulo 2π. Isolated values, with no
/// closing neighbours, are left out.
#[derive(Clone, Debug, PartialEq)]
pub enum InputRange {
    /// The loop closes at every value: the input is a crank.
    FullTurn,
    /// The loop closes in these closed intervals `[lowest, highest]`, radians, ascending. The
    /// interval around home contains the home value; the middles of the others are within π of
    /// home.
    Intervals(Vec<[f64; 2]>),
}

impl InputRange {
    /// Whether the input can make a full revolution.
    pub fn is_full_turn(&self) -> bool {
        *self == Self::FullTurn
    }

    /// Whether the loop closes with the input at this value, radians.
    pub fn contains(&self, value: f64) -> bool {
        let within = |[low, high]: &[f64; 2]| (value - low).rem_euclid(TAU) <= high - low;
        match self {
            Self::FullTurn => value.is_finite(),
            Self::Intervals(intervals) => intervals.iter().any(within),
        }
    }
}

/// Which of the two four-bars folds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fold {
    /// The four-bar with the input.
    First,
    /// The four-bar driven by the imaginary joint.
    Second,
}

/// An interval of displacements of the input, and which four-bar folds at each of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub ends: [f64; 2],
    pub folds: [Fold; 2],
}

/// The displacements of the input at which a set of branches closes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ClosingSet {
    /// The whole revolution.
    Everywhere,
    /// Disjoint intervals, ascending.
    Intervals(Vec<Span>),
}

impl Input<'_> {
    /// The values of the input at which the loop closes in any branch.
    pub fn range(&self) -> InputRange {
        self.reported(&self.closing(&Branch::BOTH))
    }

    /// The values of the input at which the loop closes with this sign of the first choice. The
    /// second choice makes no difference: its two branches end where they meet.
    pub fn branch_range(&self, first: Branch) -> InputRange {
        self.reported(&self.closing(&[first]))
    }

    fn reported(&self, spans: &ClosingSet) -> InputRange {
        let home = self.coordinate().home;
        match spans {
            ClosingSet::Everywhere => InputRange::FullTurn,
            ClosingSet::Intervals(spans) => {
                let mut intervals: Vec<_> =
                    spans.iter().map(|span| span.ends.map(|end| home + end)).collect();
                intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
                InputRange::Intervals(intervals)
            }
        }
    }

    /// The displacements at which the first four-bar closes in any of these branches, and the
    /// second one with it.
    pub(super) fn closing(&self, first: &[Branch]) -> ClosingSet {
        let folds = self.folds();
        let closes =
            |rotation: Complex<f64>| first.iter().any(|&branch| self.closes(rotation, branch));
        let Some(&(last, _)) = folds.last() else {
            return if closes(unit(0.0)) {
                ClosingSet::Everywhere
            } else {
                ClosingSet::Intervals(vec![])
            };
        };
        let mut spans: Vec<Span> = Vec::new();
        let mut from = (last - TAU, folds[folds.len() - 1].1);
        for &to in &folds {
            if closes(unit(0.5 * (from.0 + to.0))) {
                match spans.last_mut() {
                    Some(before) if before.ends[1] == from.0 => {
                        (before.ends[1], before.folds[1]) = to;
                    }
                    _ => spans.push(Span { ends: [from.0, to.0], folds: [from.1, to.1] }),
                }
            }
            from = to;
        }
        // The last interval may continue in the first one, a revolution later.
        if let [head, .., tail] = &mut *spans
            && tail.ends[1] - TAU == head.ends[0]
        {
            (head.ends[0], head.folds[0]) = (tail.ends[0] - TAU, tail.folds[0]);
            spans.pop();
        }
        match *spans {
            [Span { ends: [low, high], .. }] if high - low >= TAU - SAME => ClosingSet::Everywhere,
            _ => {
                spans.iter_mut().for_each(|span| span.ends = near_home(span.ends));
                ClosingSet::Intervals(spans)
            }
        }
    }

    /// The displacements of the input within one revolution, ascending, at which either four-bar
    /// folds.
    fn folds(&self) -> Vec<(f64, Fold)> {
        let angle = |rotation: Complex<f64>| rotation.im.atan2(rotation.re);
        let own = &self.own().four_bar;
        let mut folds: Vec<(f64, Fold)> = own
            .driven_by(self.loop_index)
            .dead_points()
            .map(|rotation| (angle(rotation), Fold::First))
            .collect();
        for tau in self.other().four_bar.driven_by(0).dead_points() {
            for branch in Branch::BOTH {
                if let Ok(displacements) = own.driven_by(0).solve(tau, branch) {
                    folds.push((
                        angle(displacements[self.loop_index - 1].unit_direction()),
                        Fold::Second,
                    ));
                }
            }
        }
        folds.sort_by(|a, b| a.0.total_cmp(&b.0));
        folds.dedup_by(|b, a| b.0 - a.0 <= SAME);
        folds
    }

    /// Whether both four-bars close at this rotation of the input.
    fn closes(&self, rotation: Complex<f64>, first: Branch) -> bool {
        let own = self.own().four_bar.driven_by(self.loop_index).solve(rotation, first);
        own.is_ok_and(|displacements| {
            let tau = displacements[self.imaginary_index()].unit_direction();
            self.other().four_bar.driven_by(0).closes(tau)
        })
    }
}

/// The same interval modulo 2π: around zero if possible, else with its middle within π of zero.
fn near_home([low, high]: [f64; 2]) -> [f64; 2] {
    let around = (high / TAU).floor() * TAU;
    if low <= around {
        return [low - around, high - around];
    }
    let revolutions = (0.5 * (low + high) / TAU - 0.5).ceil() * TAU;
    [low - revolutions, high - revolutions]
}
