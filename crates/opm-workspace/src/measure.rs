//! Measures of the workspace with bounds that are guaranteed: areas, volumes, shares of all
//! orientations.
//!
//! The box that is asked for is cut into ever smaller ones, those first whose part in the workspace is
//! least known ([`opm_core::enclosure`] says how much of each is, from both sides). Rounds of splits do
//! not depend on when to stop: with a larger budget the same rounds go on, and bounds only come closer.
//! Boxes are summed in a fixed order, so that nothing depends on the number of threads.

mod cell;
mod domain;
mod ranges;

pub use domain::{Domain, DomainAxis, DomainError, Over};
pub use ranges::ranges;

use crate::progress::Progress;
use crate::sweep::Modes;
use cell::{Bounds, Cell};
use opm_core::manipulator::{Manipulator, Mode};
use rayon::prelude::*;
use std::cmp::Reverse;

/// Fewest boxes that a round splits, where there are as many.
const ROUND: usize = 256;

/// The share of the undecided boxes that a round splits.
const SHARE: usize = 4;

/// Rounding of a compensated sum of products of a few numbers, as a share of the whole.
const ROUNDING: f64 = 1e-14;

/// When a measure is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// How far the true measure may be from the value, as a share of the value.
    pub tolerance: f64,
    /// Most boxes to look at, some 100 bytes of memory each; the first ones are looked at in any case.
    pub budget: u64,
}

impl Default for Goal {
    fn default() -> Self {
        Self { tolerance: 0.01, budget: 1 << 22 }
    }
}

/// Why a measure was taken no further.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// It is as good as it was to be.
    Tolerance,
    /// The next round is beyond the budget.
    Budget,
    /// It was told to.
    Cancelled,
    /// Splitting boxes brings the bounds no closer: they are apart by what is on the rim.
    Exhausted,
}

/// A measure between two bounds, in the product of metres and radians of the axes with a width. The
/// bounds hold, whatever it stopped for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The measure is not less.
    pub lower: f64,
    /// The measure is not more.
    pub upper: f64,
    /// The measure of the whole box.
    pub whole: f64,
    /// Boxes that were looked at.
    pub boxes: u64,
    /// Why there are no more.
    pub stop: Stop,
}

impl Measured {
    /// The middle of the bounds.
    pub fn value(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    /// The value as a share of the whole box.
    pub fn fraction(&self) -> f64 {
        self.value() / self.whole
    }

    /// Whether the measure is certain to be within a share of the value from it.
    pub fn meets(&self, tolerance: f64) -> bool {
        0.5 * (self.upper - self.lower) <= tolerance * self.value()
    }
}

/// Measures how much of a domain is in reach and within the limits.
pub fn measure(
    manipulator: &Manipulator,
    domain: &Domain,
    modes: Modes,
    goal: &Goal,
    progress: &Progress,
) -> Measured {
    let mode = match modes {
        Modes::One(mode) => Some(mode),
        Modes::Any => None,
    };
    let mut search = Search::new(Asker { manipulator, domain, mode });
    loop {
        let found = search.found();
        if found.meets(goal.tolerance) {
            return found;
        }
        let stop = if search.open.is_empty() {
            Stop::Exhausted
        } else if search.boxes + 2 * search.next() as u64 > goal.budget {
            Stop::Budget
        } else if search.round(progress) {
            continue;
        } else {
            Stop::Cancelled
        };
        return Measured { stop, ..found };
    }
}

/// What is asked of every box.
#[derive(Clone, Copy)]
struct Asker<'a> {
    manipulator: &'a Manipulator,
    domain: &'a Domain,
    mode: Option<Mode>,
}

impl Asker<'_> {
    /// What is known of a cell: its bounds and how to split it.
    fn ask(&self, cell: Cell) -> Bounds {
        let sides = self.domain.sides(&cell);
        let verdict = self.manipulator.enclose(self.domain.asked(), self.mode, &sides);
        let size = self.domain.size(&cell);
        let split = verdict.split.and_then(|side| self.domain.wide_number(side));
        let open = verdict.lower < verdict.upper;
        Bounds {
            lower: size * verdict.lower,
            upper: size * verdict.upper,
            split: split.filter(|&axis| open && cell.splits(axis)),
            cell,
        }
    }
}

/// A sum whose rounding does not grow with the number of its terms (A. Neumaier, 1974); of numbers that are
/// not negative.
#[derive(Clone, Copy, Debug, Default)]
struct Sum {
    sum: f64,
    rest: f64,
}

impl Sum {
    fn add(&mut self, term: f64) {
        let sum = self.sum + term;
        let (large, small) = if self.sum >= term { (self.sum, term) } else { (term, self.sum) };
        self.rest += (large - sum) + small;
        self.sum = sum;
    }

    fn value(self) -> f64 {
        self.sum + self.rest
    }
}

/// The boxes of a domain, as far as they are decided.
struct Search<'a> {
    asker: Asker<'a>,
    /// Those that are worth splitting.
    open: Vec<Bounds>,
    /// Sums of the bounds of the others.
    settled: [Sum; 2],
    /// The best bounds so far.
    bounds: [f64; 2],
    boxes: u64,
}

impl<'a> Search<'a> {
    fn new(asker: Asker<'a>) -> Self {
        let whole = asker.domain.whole();
        let mut search = Self {
            asker,
            open: Vec::new(),
            settled: [Sum::default(); 2],
            bounds: [0.0, whole],
            boxes: 0,
        };
        for cell in asker.domain.cells() {
            search.boxes += 1;
            search.open.push(asker.ask(cell));
        }
        search.settle();
        search
    }

    /// Takes those boxes away that no split makes better known, and sums up.
    fn settle(&mut self) {
        let settled = &mut self.settled;
        self.open.retain(|bounds| {
            if bounds.split.is_none() {
                settled[0].add(bounds.lower);
                settled[1].add(bounds.upper);
            }
            bounds.split.is_some()
        });
        let [mut lower, mut upper] = self.settled;
        for bounds in &self.open {
            lower.add(bounds.lower);
            upper.add(bounds.upper);
        }
        // Of nothing there is nothing to round.
        let rounded = |sum: Sum, sign: f64| match sum.value() {
            0.0 => 0.0,
            value => value + sign * ROUNDING * self.asker.domain.whole(),
        };
        self.bounds[0] = self.bounds[0].max(rounded(lower, -1.0));
        self.bounds[1] = self.bounds[1].min(rounded(upper, 1.0));
    }

    fn found(&self) -> Measured {
        let [lower, upper] = self.bounds;
        let whole = self.asker.domain.whole();
        Measured { lower, upper, whole, boxes: self.boxes, stop: Stop::Tolerance }
    }

    /// How many boxes the next round splits.
    fn next(&self) -> usize {
        (self.open.len() / SHARE).max(ROUND).min(self.open.len())
    }

    /// Splits the boxes that leave the widest gap; `false` where it was told to stop, with all as it was.
    fn round(&mut self, progress: &Progress) -> bool {
        let count = self.next();
        let mut chosen: Vec<(u64, usize)> = (self.open.iter().enumerate())
            // Of floats that are not negative, the bits are in their order.
            .map(|(number, bounds)| ((bounds.upper - bounds.lower).to_bits(), number))
            .collect();
        if count < chosen.len() {
            chosen.select_nth_unstable_by_key(count, |&(gap, number)| (Reverse(gap), number));
            chosen.truncate(count);
        }
        let mut chosen: Vec<usize> = chosen.into_iter().map(|(_, number)| number).collect();
        chosen.sort_unstable();
        let (asker, open) = (self.asker, &self.open);
        let halves: Option<Vec<[Bounds; 2]>> = chosen
            .par_iter()
            .map(|&number| {
                progress.advance(2).ok()?;
                let Bounds { cell, split, .. } = open[number];
                Some(cell.halves(split?).map(|half| asker.ask(half)))
            })
            .collect();
        let Some(halves) = halves else { return false };
        for (number, [first, second]) in chosen.into_iter().zip(halves) {
            self.open[number] = first;
            self.open.push(second);
        }
        self.boxes += 2 * count as u64;
        self.settle();
        true
    }
}
