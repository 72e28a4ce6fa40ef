//! Rows clipped to regions: which poses of many rows are in all of some regions at once, without asking for
//! any of them.
//!
//! Everything is in units of the row's step, so that the poses of a row are the whole numbers of an
//! interval. The loops are over rows, branch-free, and compiled for the processor at hand.

mod loops;

use super::runs::Run;
use loops::{ConvexClip, count_overlaps, round, sum};
use opm_core::chain::region::{Precision, Region, larger};
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Rows that are clipped together.
pub const ROWS: usize = 64;

/// A number of rows that vectors divide.
const LANES: usize = 8;

/// An end of an interval that is nearer to a pose than this, in steps, does not decide on which side of it
/// the pose is. Ends are right to within this.
const TIE: f64 = 1e-6;

/// Ends that are rounded by more than this many steps are of no use.
const COARSE: f64 = 0.1;

/// The most holes of one row whose common parts are counted exactly.
const MOST_HOLES: usize = 2;

/// How the rows of a sheet are clipped to one region, in steps.
#[derive(Clone, Copy, Debug)]
pub struct ClipPlan {
    /// From where on intervals are right to within `tie`.
    precision: Precision,
    /// How far an end may be off.
    tie: f64,
    /// Second coordinates between which the hole meets the rows.
    hole_rows: [f64; 2],
}

impl ClipPlan {
    /// `None` where rounding makes the region useless. `last` is the last pose of a row, and `extent`
    /// the largest number of the grid, in steps.
    pub fn new(region: &Region, last: f64, extent: f64) -> Option<Self> {
        let size = larger(region.size(), extent);
        // As fine as the numbers allow, and a hundred roundings at least.
        let tie = TIE.max(size * 1e-12);
        let precision = Precision::new(size, tie);
        if tie >= COARSE || !region.suits(&precision) {
            return None;
        }
        // A step more on all sides, so that nothing that is left out is too close to call.
        let hole_rows = region.hole.as_ref().map_or([0.0, -1.0], |hole| {
            let [from, to] = hole.rows([-1.0, last + 1.0]);
            [from - 1.0, to + 1.0]
        });
        Some(Self { precision, tie, hole_rows })
    }
}

/// Rows of a sheet, evenly spaced, and the window of each that is looked at.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Second coordinates.
    at: [f64; ROWS],
    step: f64,
    count: usize,
    window: Run,
}

impl Rows {
    /// `count` rows, whose second coordinates begin with `first`.
    pub fn new(first: f64, step: f64, count: usize, window: Run) -> Self {
        Self { at: std::array::from_fn(|i| first + step * i as f64), step, count, window }
    }

    /// No rows.
    pub fn none() -> Self {
        Self::new(0.0, 0.0, 0, Run { from: 0, to: 0 })
    }

    /// All rows, and some more so that they are whole vectors.
    fn all(&self) -> Range<usize> {
        0..self.count.next_multiple_of(LANES).min(ROWS)
    }

    /// The rows whose second coordinate lies in a range, and some more.
    fn between(&self, [from, to]: [f64; 2]) -> Range<usize> {
        // Of a single row the step is zero, and the quotient infinite, or no number on the row itself.
        let row = |at: f64| (at - self.at[0]) / self.step;
        let (first, last) = (row(from).ceil() as usize, row(to));
        let end = if last < self.count as f64 { (last + 1.0) as usize } else { self.count };
        if first < end {
            first / LANES * LANES..end.next_multiple_of(LANES).min(ROWS)
        } else {
            0..0
        }
    }
}

/// One interval for each row; empty where `last < first`.
#[derive(Clone, Debug)]
struct Intervals {
    first: [f64; ROWS],
    last: [f64; ROWS],
}

impl Intervals {
    /// Empty, and no end is a tie.
    const NONE: Self = Self { first: [0.5; ROWS], last: [-0.5; ROWS] };

    fn ends(&self, row: usize) -> [f64; 2] {
        [self.first[row], self.last[row]]
    }
}

/// Marks of rows. They are as wide as the numbers that decide on them, so that loops over rows are vectorised
/// without packing.
#[derive(Clone, Debug)]
struct RowMarks {
    /// Whether any row is marked. If not, `rows` has no meaning.
    any: bool,
    /// Not zero for the rows that are marked.
    rows: [u64; ROWS],
}

impl RowMarks {
    const NONE: Self = Self { any: false, rows: [0; ROWS] };

    fn has(&self, row: usize) -> bool {
        self.any && self.rows[row] != 0
    }
}

/// Where doubts are noted down: answers that are too close to call.
trait Doubts {
    fn add(&mut self, row: usize, doubt: bool);
}

/// Not zero where there is a doubt in any row.
#[derive(Clone, Copy, Debug)]
struct AnyDoubt(u64);

impl Doubts for AnyDoubt {
    #[inline(always)]
    fn add(&mut self, _: usize, doubt: bool) {
        self.0 |= u64::from(doubt);
    }
}

/// Not zero for the rows in which there is a doubt.
impl Doubts for [u64; ROWS] {
    #[inline(always)]
    fn add(&mut self, row: usize, doubt: bool) {
        self[row] |= u64::from(doubt);
    }
}

/// The intersection of rows with some regions, whose holes are left aside, before any end is rounded.
#[derive(Clone, Debug)]
pub struct Intersection {
    left: Intervals,
    doubtful: RowMarks,
    tie: f64,
}

impl Intersection {
    pub fn new() -> Self {
        Self { left: Intervals::NONE, doubtful: RowMarks::NONE, tie: TIE }
    }
}

/// Whether the poses of a clipped row are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowState {
    /// Its poses are known, and counted.
    Counted,
    /// Its poses are known, but not counted: holes overlap in it that were only counted in pairs.
    Uncounted,
    /// Rounding could change an answer: its poses have to be decided in another way.
    Doubtful,
}

/// Rows clipped to some regions: the whole numbers of a window that lie in all of them, row by row.
#[derive(Clone, Debug)]
pub struct ClippedRows {
    /// The intersection of the regions without their holes.
    intersection: Intervals,
    /// What the holes remove from the intersection.
    holes: Vec<Hole>,
    doubtful: RowMarks,
    /// Rows in which more than [`MOST_HOLES`] holes take something, if any two holes overlap.
    crowded: RowMarks,
    /// The number of poses of each row that is counted.
    counts: [f64; ROWS],
    total: u64,
    /// The intersection of some of the regions, and that with one more region, in alternation. A loop that
    /// overwrites its own input would be compiled to masked stores, which are slow.
    partial: [Intervals; 2],
}

/// What one hole removes from the rows.
#[derive(Clone, Debug)]
struct Hole {
    /// The rows that it can meet; the intervals of other rows have no meaning.
    rows: Range<usize>,
    missing: Intervals,
    /// Whether something is missing in any row.
    met: bool,
}

impl ClippedRows {
    pub fn new() -> Self {
        Self {
            intersection: Intervals::NONE,
            holes: Vec::new(),
            doubtful: RowMarks::NONE,
            crowded: RowMarks::NONE,
            counts: [0.0; ROWS],
            total: 0,
            partial: [Intervals::NONE; 2],
        }
    }

    /// The number of poses of all rows that are counted.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// Whether all rows are counted.
    pub fn all_counted(&self) -> bool {
        !(self.doubtful.any || self.crowded.any)
    }

    /// Whether the poses of row number `row` are known.
    pub fn state(&self, row: usize) -> RowState {
        if self.doubtful.has(row) {
            RowState::Doubtful
        } else if self.crowded.has(row) {
            RowState::Uncounted
        } else {
            RowState::Counted
        }
    }

    /// The poses of row number `row`, in order.
    pub fn runs(&self, row: usize) -> impl Iterator<Item = Run> {
        let holes = move || {
            let holes = self.holes.iter().filter(move |hole| hole.rows.contains(&row));
            let ends = holes.map(move |hole| hole.missing.ends(row));
            ends.filter(|[first, last]| first <= last)
        };
        let [mut next, last] = self.intersection.ends(row);
        std::iter::from_fn(move || {
            if next > last {
                return None;
            }
            while let Some([_, end]) = holes().find(|&[start, end]| start <= next && next <= end) {
                next = end + 1.0;
            }
            if next > last {
                return None;
            }
            let from = next;
            let starts = holes().map(|[start, _]| start).filter(|&start| start > from);
            next = starts.fold(last + 1.0, f64::min);
            Some(Run { from: from as u64, to: next as u64 })
        })
    }
}

/// The step that intersects rows with some regions, which stays so for other regions to come.
pub struct Intersect<'a, R> {
    pub regions: R,
    pub rows: &'a Rows,
    pub intersection: &'a mut Intersection,
}

/// The step that clips rows to `regions` and to those that `begun` was made of, and counts what they have in
/// common. All of these regions are in `with_holes`, but for those of `links`.
pub struct Clip<'a, R, H> {
    pub rows: &'a Rows,
    pub begun: &'a Intersection,
    pub regions: R,
    pub with_holes: H,
    /// Regions that are like `regions`; in most sheets there are none.
    pub links: &'a [(Region, ClipPlan)],
    pub clipped: &'a mut ClippedRows,
}

impl<'a, R: Iterator<Item = (&'a Region, &'a ClipPlan)>> WithSimd for Intersect<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { regions, rows, intersection } = self;
        *intersection = Intersection::new();
        let Intersection { left, doubtful, tie } = intersection;
        // Half-way to the next pose on both sides: ends that are farther away are no ties.
        left.first[..rows.count].fill(rows.window.from as f64 - 0.5);
        left.last[..rows.count].fill(rows.window.to as f64 - 0.5);
        for (region, plan) in regions {
            let set = ConvexClip { set: &region.whole, precision: &plan.precision };
            set.intersect(rows, &left.clone(), left, &mut doubtful.rows);
            *tie = larger(*tie, plan.tie);
        }
        doubtful.any = doubtful.rows.iter().any(|&doubt| doubt != 0);
    }
}

impl<'a, R, H> WithSimd for Clip<'a, R, H>
where
    R: Iterator<Item = (&'a Region, &'a ClipPlan)> + Clone,
    H: Iterator<Item = (&'a Region, &'a ClipPlan)> + Clone,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        // In few windows is anything in doubt: only then it is found out where.
        let mut doubt = AnyDoubt(0);
        if !self.begun.doubtful.any {
            self.clip(&mut doubt);
            self.clipped.doubtful.any = doubt.0 != 0;
        }
        if self.begun.doubtful.any || doubt.0 != 0 {
            let mut doubts = self.begun.doubtful.rows;
            self.clip(&mut doubts);
            self.clipped.doubtful = RowMarks { any: true, rows: doubts };
        }
        let ClippedRows { doubtful, crowded, counts, total, .. } = self.clipped;
        for marks in [doubtful, crowded] {
            if marks.any {
                for (count, &mark) in counts.iter_mut().zip(&marks.rows) {
                    *count = if mark != 0 { 0.0 } else { *count };
                }
            }
        }
        *total = sum(&counts[self.rows.all()]);
    }
}

impl<'a, R, H> Clip<'a, R, H>
where
    R: Iterator<Item = (&'a Region, &'a ClipPlan)> + Clone,
    H: Iterator<Item = (&'a Region, &'a ClipPlan)> + Clone,
{
    #[inline(always)]
    fn clip(&mut self, doubts: &mut impl Doubts) {
        let Self { rows, begun, regions, with_holes, links, clipped } = self;
        let ClippedRows { intersection, holes, crowded, counts, partial, .. } = &mut **clipped;
        let [now, next] = partial;
        let mut left = Left { now, next, tie: begun.tie };
        left.now.clone_from(&begun.left);
        // In two loops: in most sheets there are no links.
        for (region, plan) in regions.clone() {
            left.intersect(rows, region, plan, doubts);
        }
        for (region, plan) in *links {
            left.intersect(rows, region, plan, doubts);
        }
        let Left { now, tie, .. } = left;
        let is_tie = |end: f64| (end - end.round_ties_even()).abs() <= tie;
        round(rows, now, intersection, counts, is_tie, doubts);
        let mut number = 0;
        for (region, plan) in with_holes.clone() {
            let Some(set) = &region.hole else { continue };
            let hole = ConvexClip { set, precision: &plan.precision };
            number += hole.subtract_as(number, holes, plan, rows, now, counts, is_tie, doubts);
        }
        for (region, plan) in *links {
            let Some(set) = &region.hole else { continue };
            let hole = ConvexClip { set, precision: &plan.precision };
            number += hole.subtract_as(number, holes, plan, rows, now, counts, is_tie, doubts);
        }
        holes.truncate(number);
        count_overlaps(holes, counts, crowded);
    }
}

/// What regions leave of rows, and where that of one region more goes.
struct Left<'a> {
    now: &'a mut Intervals,
    next: &'a mut Intervals,
    /// How far an end may be off.
    tie: f64,
}

impl Left<'_> {
    /// Leaves what is in the convex set of a region.
    #[inline(always)]
    fn intersect(
        &mut self,
        rows: &Rows,
        region: &Region,
        plan: &ClipPlan,
        doubts: &mut impl Doubts,
    ) {
        let set = ConvexClip { set: &region.whole, precision: &plan.precision };
        set.intersect(rows, self.now, self.next, doubts);
        std::mem::swap(&mut self.now, &mut self.next);
        self.tie = larger(self.tie, plan.tie);
    }
}
