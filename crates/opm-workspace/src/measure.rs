//! Measures of the workspace with guaranteed bounds: areas, volumes, shares of all orientations.
//!
//! A [`Domain`] is a box of poses. It is split into ever smaller boxes, first those of which it is least
//! known how much is in the workspace; [`opm_core::enclosure`] bounds that from both sides. The rounds of
//! splits do not depend on when to stop: with a larger budget the same rounds go on, and the bounds only
//! come closer. Boxes are summed in a fixed order, so that the result does not depend on the number of
//! threads, nor on who evaluates which box. [`measure`](fn@measure) does it all. To evaluate boxes
//! elsewhere, [`Search`] gives the boxes of each round, and an [`Evaluator`] bounds them.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # use opm_core::Manipulator;
//! # let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! use opm_workspace::measure::{CoordinateRange, Domain, Goal, measure};
//! use opm_workspace::{Modes, Progress, Sections};
//!
//! // The area that is reachable with the platform level, in a square.
//! let ranges = [CoordinateRange::new("x", -0.2, 0.2), CoordinateRange::new("y", -0.2, 0.2)];
//! let domain = Domain::new(&manipulator, Sections::Whole, &ranges)?;
//! let (modes, goal) = (Modes::Any, Goal { tolerance: 0.02, ..Goal::default() });
//! let area = measure(&manipulator, &domain, modes, &goal, &Progress::default());
//! assert!(area.lower <= area.upper && area.upper <= 0.16 * (1.0 + 1e-9));
//! assert!(area.meets(0.02));
//! # Ok(())
//! # }
//! ```

mod cell;
mod coordinate_range;
mod domain;
mod ranges;

pub use cell::{Bounds, Cell};
pub use coordinate_range::{CoordinateRange, RangeError};
pub use domain::{Domain, DomainAxis, DomainError};
pub use ranges::default_ranges;

use crate::progress::{Cancelled, Progress};
use crate::sweep::Modes;
use opm_core::manipulator::{Manipulator, Mode};
use rayon::prelude::*;
use std::cmp::Reverse;

/// Fewest boxes that a round splits, if there are so many.
const ROUND: usize = 256;

/// The share of the undecided boxes that a round splits.
const SHARE: usize = 4;

/// The rounding of a compensated sum of products of a few numbers, as a share of the whole measure.
const ROUNDING: f64 = 1e-14;

/// The budget of boxes where none is asked for. Two cores answer within some ten seconds.
pub const DEFAULT_BUDGET: u64 = 500_000;

/// When a measure is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// How far the true measure may be from the value, as a share of the value.
    pub tolerance: f64,
    /// Most boxes to evaluate, which take some 100 bytes of memory each. The first boxes are evaluated in any
    /// case.
    pub budget: u64,
}

/// Checks a tolerance that a user gave.
///
/// # Errors
/// The text of what was expected instead.
pub fn check_tolerance(tolerance: f64) -> Result<(), &'static str> {
    match tolerance {
        0.0..1.0 => Ok(()),
        _ => Err("expected a share of at least 0 and less than 1"),
    }
}

impl Default for Goal {
    fn default() -> Self {
        Self { tolerance: 0.01, budget: DEFAULT_BUDGET }
    }
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SearchEnd {
    /// The measure is within the tolerance.
    Tolerance,
    /// The next round would be beyond the budget.
    Budget,
    /// The search was cancelled.
    Cancelled,
    /// Splitting boxes brings the bounds no closer: what lies between them is on the boundary of the
    /// workspace.
    Exhausted,
}

/// A measure between two bounds, in the product of the units, metres or radians, of the axes with a width. The
/// bounds hold, whatever the reason was to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The lower bound.
    pub lower: f64,
    /// The upper bound.
    pub upper: f64,
    /// The measure of the whole domain.
    pub whole: f64,
    /// The number of boxes that were evaluated.
    pub boxes: u64,
    /// Why there are no more boxes.
    pub stop: SearchEnd,
}

impl Measured {
    /// The middle of the bounds.
    pub fn value(&self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    /// The value as a share of the whole domain.
    pub fn fraction(&self) -> f64 {
        self.value() / self.whole
    }

    /// How far the measure may be from the value, as a share of the value.
    pub fn uncertainty(&self) -> f64 {
        let half = 0.5 * (self.upper - self.lower);
        if half > 0.0 { half / self.value() } else { 0.0 }
    }

    /// Whether the uncertainty is at most `tolerance`.
    pub fn meets(&self, tolerance: f64) -> bool {
        self.uncertainty() <= tolerance
    }
}

/// Measures how much of a domain is in reach and within the limits. A search that is cancelled by
/// [`Progress::cancel`] gives the bounds that it has found so far.
pub fn measure(
    manipulator: &Manipulator,
    domain: &Domain,
    modes: Modes,
    goal: &Goal,
    progress: &Progress,
) -> Measured {
    measure_told(manipulator, domain, modes, goal, progress, |_| ())
}

/// As [`measure`], telling what is known after each round.
pub fn measure_told(
    manipulator: &Manipulator,
    domain: &Domain,
    modes: Modes,
    goal: &Goal,
    progress: &Progress,
    mut told: impl FnMut(&Measured),
) -> Measured {
    let evaluator = Evaluator::new(manipulator, domain, modes);
    let mut search = Search::new(domain, *goal);
    while let Some(cells) = search.round() {
        let Ok(bounds) = evaluator.evaluate(cells, progress) else { break };
        search.settle_round(bounds);
        told(&search.found());
    }
    search.found()
}

/// Bounds how much of a box is in reach.
#[derive(Clone, Copy, Debug)]
pub struct Evaluator<'a> {
    manipulator: &'a Manipulator,
    domain: &'a Domain,
    mode: Option<Mode>,
}

impl<'a> Evaluator<'a> {
    /// An evaluator for boxes of this domain, in these working modes.
    pub fn new(manipulator: &'a Manipulator, domain: &'a Domain, modes: Modes) -> Self {
        Self { manipulator, domain, mode: modes.one() }
    }

    /// The bounds of some boxes, in their order, found on all threads. They depend on nothing but the box:
    /// on every machine they are the same to the bit.
    ///
    /// # Errors
    /// [`Cancelled`] if [`Progress::cancel`] was called.
    pub fn evaluate(&self, cells: &[Cell], progress: &Progress) -> Result<Vec<Bounds>, Cancelled> {
        let of = |cell: &Cell| progress.advance(1).map(|()| self.bounds(cell));
        cells.par_iter().map(of).collect()
    }

    /// The bounds of a cell and how to split it.
    fn bounds(&self, cell: &Cell) -> Bounds {
        let sides = self.domain.sides(cell);
        let verdict = self.manipulator.enclose(self.domain.query(), self.mode, &sides);
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

/// A sum of numbers that are not negative, whose rounding does not grow with the number of its terms (A.
/// Neumaier, 1974).
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

/// There are more or fewer bounds than boxes in a round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found} bounds, expected {expected}: one for each box of the round")]
pub struct WrongAnswer {
    /// The number of bounds.
    pub found: usize,
    /// The number of boxes in the round.
    pub expected: usize,
}

/// The search for the measure of a domain. It goes on in rounds, whose boxes may be evaluated anywhere: by an
/// [`Evaluator`] in this process or in others, to which [`Cell::pack`] and [`Bounds::pack`] carry them.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// # use opm_workspace::measure::{CoordinateRange, Domain, Evaluator, Goal, Search};
/// # use opm_workspace::{Modes, Progress, Sections};
/// # let ranges = [CoordinateRange::new("x", -0.2, 0.2)];
/// # let domain = Domain::new(&manipulator, Sections::Whole, &ranges)?;
/// let evaluator = Evaluator::new(&manipulator, &domain, Modes::Any);
/// let mut search = Search::new(&domain, Goal::default());
/// while let Some(cells) = search.round() {
///     let bounds = evaluator.evaluate(cells, &Progress::default())?;
///     search.answer(bounds)?;
/// }
/// assert!(search.found().meets(0.01));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Search<'a> {
    domain: &'a Domain,
    goal: Goal,
    /// The boxes that are worth splitting.
    open: Vec<(Cell, Bounds)>,
    /// The sums of the bounds of all other boxes.
    settled: [Sum; 2],
    /// The best bounds so far.
    bounds: [f64; 2],
    boxes: u64,
    /// The boxes of the round.
    cells: Vec<Cell>,
    /// The numbers of the open boxes that they are the halves of, two of each. It is empty in the first
    /// round, whose boxes are those of the domain.
    halved: Vec<usize>,
    stop: Option<SearchEnd>,
}

impl<'a> Search<'a> {
    /// A search of which nothing is known yet.
    pub fn new(domain: &'a Domain, goal: Goal) -> Self {
        Self {
            domain,
            goal,
            open: Vec::new(),
            settled: [Sum::default(); 2],
            bounds: [0.0, domain.whole()],
            boxes: 0,
            cells: Vec::new(),
            halved: Vec::new(),
            stop: None,
        }
    }

    /// The boxes to evaluate next, whose bounds go to [`Search::answer`]; `None` if the search is over.
    pub fn round(&mut self) -> Option<&[Cell]> {
        self.halved.clear();
        self.cells.clear();
        if self.boxes == 0 {
            self.cells.extend(self.domain.cells());
            return Some(&self.cells);
        }
        let count = (self.open.len() / SHARE).max(ROUND).min(self.open.len());
        self.stop = if self.found().meets(self.goal.tolerance) {
            Some(SearchEnd::Tolerance)
        } else if count == 0 {
            Some(SearchEnd::Exhausted)
        } else if self.boxes + 2 * count as u64 > self.goal.budget {
            Some(SearchEnd::Budget)
        } else {
            None
        };
        if self.stop.is_some() {
            return None;
        }
        self.choose(count);
        Some(&self.cells)
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
        self.cells.extend(halves);
    }

    /// Takes the bounds of the boxes of the round, in their order.
    ///
    /// # Errors
    /// [`WrongAnswer`] if there are more or fewer bounds than boxes; then nothing is taken.
    pub fn answer(&mut self, bounds: Vec<Bounds>) -> Result<(), WrongAnswer> {
        let (found, expected) = (bounds.len(), self.cells.len());
        if found != expected {
            return Err(WrongAnswer { found, expected });
        }
        self.settle_round(bounds);
        Ok(())
    }

    /// Takes as many bounds as there are boxes in the round.
    fn settle_round(&mut self, bounds: Vec<Bounds>) {
        self.boxes += bounds.len() as u64;
        let mut known = self.cells.drain(..).zip(bounds);
        for number in self.halved.drain(..) {
            if let (Some(first), Some(second)) = (known.next(), known.next()) {
                self.open[number] = first;
                self.open.push(second);
            }
        }
        self.open.extend(known);
        self.settle();
    }

    /// Takes away the boxes that no split makes better known, and sums up.
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
        // A sum of nothing is not rounded.
        let rounded = |sum: Sum, sign: f64| match sum.value() {
            0.0 => 0.0,
            value => value + sign * ROUNDING * whole,
        };
        self.bounds[0] = self.bounds[0].max(rounded(lower, -1.0));
        self.bounds[1] = self.bounds[1].min(rounded(upper, 1.0));
    }

    /// The measure as far as it is known. A search that is not over stops with [`SearchEnd::Cancelled`].
    pub fn found(&self) -> Measured {
        let [lower, upper] = self.bounds;
        let (whole, stop) = (self.domain.whole(), self.stop.unwrap_or(SearchEnd::Cancelled));
        Measured { lower, upper, whole, boxes: self.boxes, stop }
    }
}
