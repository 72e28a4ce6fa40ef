//! Where a linkage closes: the range of its input.
//!
//! The four-bar that has the input folds at the inputs where its reach condition is an equality.
//! The other one does so at certain `τ`, and these are inputs of the first four-bar as well: it
//! tells, in closed form, at which values of the linkage's input they are passed. Between two
//! neighbours of all these values nothing changes, so one position in between says whether the
//! linkage closes there.

use super::Input;
use crate::chain::Branch;
use crate::numeric::angle::unit;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Values of the input this close to each other are one: two roots that meet are apart by the
/// square root of what they are rounded by, and no gap as small as this can be told from none.
const SAME: f64 = 1e-12;

/// The values of the input, as reported, at which the loop closes; whole turns apart they repeat.
/// Single values, at which it closes but not beside them, are left out.
#[derive(Clone, Debug, PartialEq)]
pub enum InputRange {
    /// All of them: the input is a crank.
    FullTurn,
    /// Closed intervals `[lowest, highest]`, radians, ascending. The one around home has the home
    /// value in it; of the others the middles are within half a turn of home.
    Intervals(Vec<[f64; 2]>),
}

impl InputRange {
    /// Whether the input can turn all the way round.
    pub fn is_full_turn(&self) -> bool {
        *self == Self::FullTurn
    }

    /// Whether the loop closes with the input at this value.
    pub fn contains(&self, value: f64) -> bool {
        let within = |[low, high]: &[f64; 2]| (value - low).rem_euclid(TAU) <= high - low;
        match self {
            Self::FullTurn => value.is_finite(),
            Self::Intervals(intervals) => intervals.iter().any(within),
        }
    }
}

/// Which four-bar folds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Fold {
    /// The one that has the input.
    First,
    /// The other one.
    Second,
}

/// An interval of displacements of the input, and what ends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    pub ends: [f64; 2],
    pub folds: [Fold; 2],
}

/// Where a set of branches closes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Spans {
    Full,
    /// Ascending, without overlap.
    Some(Vec<Span>),
}

impl Input<'_> {
    /// The values at which the loop closes in any branch.
    pub fn range(&self) -> InputRange {
        self.reported(&self.spans(&Branch::BOTH))
    }

    /// The values at which the loop closes with this sign of the first choice. (The second choice
    /// makes no difference: both of its branches end where they meet.)
    pub fn branch_range(&self, first: Branch) -> InputRange {
        self.reported(&self.spans(&[first]))
    }

    fn reported(&self, spans: &Spans) -> InputRange {
        let home = self.coordinate().home;
        match spans {
            Spans::Full => InputRange::FullTurn,
            Spans::Some(spans) => {
                let mut intervals: Vec<_> =
                    spans.iter().map(|span| span.ends.map(|end| home + end)).collect();
                intervals.sort_by(|a, b| a[0].total_cmp(&b[0]));
                InputRange::Intervals(intervals)
            }
        }
    }

    /// Where any of these branches of the first four-bar, and the second one with it, closes.
    pub(super) fn spans(&self, first: &[Branch]) -> Spans {
        let folds = self.folds();
        let closes = |turn: Complex<f64>| first.iter().any(|&branch| self.closes(turn, branch));
        let Some(&(last, _)) = folds.last() else {
            return if closes(unit(0.0)) { Spans::Full } else { Spans::Some(vec![]) };
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
        // The last one may go on in the first, a turn later.
        if let [head, .., tail] = &mut *spans
            && tail.ends[1] - TAU == head.ends[0]
        {
            (head.ends[0], head.folds[0]) = (tail.ends[0] - TAU, tail.folds[0]);
            spans.pop();
        }
        match *spans {
            [Span { ends: [low, high], .. }] if high - low >= TAU - SAME => Spans::Full,
            _ => {
                spans.iter_mut().for_each(|span| span.ends = near_home(span.ends));
                Spans::Some(spans)
            }
        }
    }

    /// The displacements of the input, in one turn and ascending, at which either four-bar folds.
    fn folds(&self) -> Vec<(f64, Fold)> {
        let angle = |turn: Complex<f64>| turn.im.atan2(turn.re);
        let own = &self.own().four_bar;
        let mut folds: Vec<(f64, Fold)> = own
            .driven_by(self.place)
            .dead_points()
            .map(|turn| (angle(turn), Fold::First))
            .collect();
        for tau in self.other().four_bar.driven_by(0).dead_points() {
            for branch in Branch::BOTH {
                if let Ok(amounts) = own.driven_by(0).solve(tau, branch) {
                    folds.push((angle(amounts[self.place - 1].unit_direction()), Fold::Second));
                }
            }
        }
        folds.sort_by(|a, b| a.0.total_cmp(&b.0));
        folds.dedup_by(|b, a| b.0 - a.0 <= SAME);
        folds
    }

    /// Whether both four-bars close.
    fn closes(&self, turn: Complex<f64>, first: Branch) -> bool {
        let own = self.own().four_bar.driven_by(self.place).solve(turn, first);
        own.is_ok_and(|amounts| {
            let tau = amounts[self.imaginary_amount()].unit_direction();
            self.other().four_bar.driven_by(0).closes(tau)
        })
    }
}

/// The same interval, whole turns away: around zero, or with its middle within half a turn of it.
fn near_home([low, high]: [f64; 2]) -> [f64; 2] {
    let around = (high / TAU).floor() * TAU;
    if low <= around {
        return [low - around, high - around];
    }
    let turns = (0.5 * (low + high) / TAU - 0.5).ceil() * TAU;
    [low - turns, high - turns]
}
