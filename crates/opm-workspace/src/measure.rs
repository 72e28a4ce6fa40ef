//! Measures of the workspace with bounds that are guaranteed: areas, volumes, shares of all
//! orientations.
//!
//! The box that is asked for is cut into ever smaller ones, those first whose part in the workspace is
//! least known ([`opm_core::enclosure`] says how much of each is, from both sides). Rounds of splits do
//! not depend on when to stop: with a larger budget the same rounds go on, and bounds only come closer.
//! Boxes are summed in a fixed order, so that nothing depends on the number of threads, nor on who is
//! asked for which box: [`Search`] says what to ask, an [`Asker`] answers.

mod cell;
mod domain;
mod ranges;

pub use cell::{Bounds, Cell};
pub use domain::{Domain, DomainAxis, DomainError, Over};
pub use ranges::ranges;

use crate::progress::{Cancelled, Progress};
use crate::sweep::Modes;
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

/// Whether a tolerance is one.
///
/// # Errors
/// What was expected instead.
pub fn check_tolerance(tolerance: f64) -> Result<(), &'static str> {
    match tolerance {
        0.0..1.0 => Ok(()),
        _ => Err("expected a share of at least 0 and less than 1"),
    }
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

    /// How far the measure may be from the value, as a share of the value.
    pub fn uncertainty(&self) -> f64 {
        let half = 0.5 * (self.upper - self.lower);
        if half > 0.0 { half / self.value() } else { 0.0 }
    }

    /// Whether the measure is certain to be within a share of the value from it.
    pub fn meets(&self, tolerance: f64) -> bool {
        self.uncertainty() <= tolerance
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
    let asker = Asker::new(manipulator, domain, modes);
    let mut search = Search::new(domain, *goal);
    while let Some(cells) = search.round() {
        let Ok(bounds) = asker.ask(cells, progress) else { break };
        search.take(bounds);
    }
    search.found()
}

/// Who knows of every box how much of it is in reach.
#[derive(Clone, Copy, Debug)]
pub struct Asker<'a> {
    manipulator: &'a Manipulator,
    domain: &'a Domain,
    mode: Option<Mode>,
}

impl<'a> Asker<'a> {
    /// For boxes of this domain of a manipulator.
    pub fn new(manipulator: &'a Manipulator, domain: &'a Domain, modes: Modes) -> Self {
        Self { manipulator, domain, mode: modes.one() }
    }

    /// What is known of some boxes, in their order. It depends on nothing but the box: whoever is asked, the
    /// answer is the same to the bit.
    ///
    /// # Errors
    /// When told to stop.
    pub fn ask(&self, cells: &[Cell], progress: &Progress) -> Result<Vec<Bounds>, Cancelled> {
        let of = |cell: &Cell| progress.advance(1).map(|()| self.bounds(cell));
        cells.par_iter().map(of).collect()
    }

    /// What is known of a cell: its bounds and how to split it.
    fn bounds(&self, cell: &Cell) -> Bounds {
        let sides = self.domain.sides(cell);
        let verdict = self.manipulator.enclose(self.domain.asked(), self.mode, &sides);
        let size = self.domain.size(cell);
        let split = verdict.split.and_then(|side| self.domain.wide_number(side));
        let open = verdict.lower < verdict.upper;
        Bounds {
            lower: size * verdict.lower,
            upper: size * verdict.upper,
            split: split.filter(|&axis| open && cell.splits(axis)),
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

/// The boxes of a domain, as far as they are decided. It goes on in rounds, whose boxes may be asked for
/// anywhere: of an [`Asker`], here or in other processes.
#[derive(Clone, Debug)]
pub struct Search<'a> {
    domain: &'a Domain,
    goal: Goal,
    /// Those that are worth splitting.
    open: Vec<(Cell, Bounds)>,
    /// Sums of the bounds of the others.
    settled: [Sum; 2],
    /// The best bounds so far.
    bounds: [f64; 2],
    boxes: u64,
    /// The boxes of the round.
    asked: Vec<Cell>,
    /// Which open ones they are the halves of, two each; none of the first round, whose boxes are the
    /// domain's.
    halved: Vec<usize>,
    stop: Option<Stop>,
}

impl<'a> Search<'a> {
    /// Nothing is known of the domain yet.
    pub fn new(domain: &'a Domain, goal: Goal) -> Self {
        Self {
            domain,
            goal,
            open: Vec::new(),
            settled: [Sum::default(); 2],
            bounds: [0.0, domain.whole()],
            boxes: 0,
            asked: Vec::new(),
            halved: Vec::new(),
            stop: None,
        }
    }

    /// The boxes to ask for next, whose bounds it is to [take](Self::take); `None` where the search is over.
    pub fn round(&mut self) -> Option<&[Cell]> {
        self.halved.clear();
        self.asked.clear();
        if self.boxes == 0 {
            self.asked.extend(self.domain.cells());
            return Some(&self.asked);
        }
        let count = (self.open.len() / SHARE).max(ROUND).min(self.open.len());
        self.stop = if self.found().meets(self.goal.tolerance) {
            Some(Stop::Tolerance)
        } else if count == 0 {
            Some(Stop::Exhausted)
        } else if self.boxes + 2 * count as u64 > self.goal.budget {
            Some(Stop::Budget)
        } else {
            None
        };
        if self.stop.is_some() {
            return None;
        }
        self.choose(count);
        Some(&self.asked)
    }

    /// Chooses the boxes that leave the widest gap.
    fn choose(&mut self, count: usize) {
        let mut chosen: Vec<(u64, usize)> = (self.open.iter().enumerate())
            // Of floats that are not negative, the bits are in their order.
            .map(|(number, (_, bounds))| ((bounds.upper - bounds.lower).to_bits(), number))
            .collect();
        if count < chosen.len() {
            chosen.select_nth_unstable_by_key(count, |&(gap, number)| (Reverse(gap), number));
            chosen.truncate(count);
        }
        self.halved.extend(chosen.into_iter().map(|(_, number)| number));
        self.halved.sort_unstable();
        let halves = self.halved.iter().flat_map(|&number| {
            let (cell, bounds) = self.open[number];
            bounds.split.into_iter().flat_map(move |axis| cell.halves(axis))
        });
        self.asked.extend(halves);
    }

    /// Takes what is known of the boxes of the round, in their order.
    ///
    /// # Panics
    /// Where there are more or fewer than these.
    pub fn take(&mut self, bounds: Vec<Bounds>) {
        assert_eq!(bounds.len(), self.asked.len(), "bounds for every box of the round");
        self.boxes += bounds.len() as u64;
        let mut known = self.asked.drain(..).zip(bounds);
        for number in self.halved.drain(..) {
            if let (Some(first), Some(second)) = (known.next(), known.next()) {
                self.open[number] = first;
                self.open.push(second);
            }
        }
        self.open.extend(known);
        self.settle();
    }

    /// Takes those boxes away that no split makes better known, and sums up.
    fn settle(&mut self) {
        let settled = &mut self.settled;
        self.open.retain(|(_, bounds)| {
            if bounds.split.is_none() {
                settled[0].add(bounds.lower);
                settled[1].add(bounds.upper);
            }
            bounds.split.is_some()
        });
        let [mut lower, mut upper] = self.settled;
        for (_, bounds) in &self.open {
            lower.add(bounds.lower);
            upper.add(bounds.upper);
        }
        let whole = self.domain.whole();
        // Of nothing there is nothing to round.
        let rounded = |sum: Sum, sign: f64| match sum.value() {
            0.0 => 0.0,
            value => value + sign * ROUNDING * whole,
        };
        self.bounds[0] = self.bounds[0].max(rounded(lower, -1.0));
        self.bounds[1] = self.bounds[1].min(rounded(upper, 1.0));
    }

    /// What is known so far; of a search that is not over, as of one that was cancelled.
    pub fn found(&self) -> Measured {
        let [lower, upper] = self.bounds;
        let (whole, stop) = (self.domain.whole(), self.stop.unwrap_or(Stop::Cancelled));
        Measured { lower, upper, whole, boxes: self.boxes, stop }
    }
}
