//! Regions cut by rows: which poses of many rows at once, without asking for any of them.
//!
//! Everything is in units of the row's step, so that the poses of a row are the whole numbers of an
//! interval. The loops are over rows, branch-free, and compiled for the processor at hand.

use super::runs::Run;
use opm_core::chain::region::{self, Convex, Precision, Region, Section};
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Rows that are cut together.
pub const ROWS: usize = 64;

/// A number of rows that vectors divide.
const LANES: usize = 8;

/// How near to a pose the end of an interval may come, in steps, and still tell on which side of it
/// the pose is; the ends are right to within this.
const TIE: f64 = 1e-6;

/// Ends that are rounded by more than this many steps are of no use.
const COARSE: f64 = 0.1;

/// How the rows of a sheet are cut from a region in steps.
#[derive(Clone, Copy, Debug)]
pub struct Fit {
    /// Of its sections, and the tolerance that they are right to.
    precision: Precision,
    tie: f64,
    /// Second coordinates between which the hole meets the rows.
    hole_rows: [f64; 2],
}

impl Fit {
    /// `None` where rounding leaves no use in the region. `last` is the last pose of a row, and `extent`
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

/// Rows of a sheet, evenly apart, and the window of each that is looked at.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Second coordinates.
    at: [f64; ROWS],
    step: f64,
    count: usize,
    window: Run,
}

impl Rows {
    /// So many, whose second coordinates begin with `first`.
    pub fn new(first: f64, step: f64, count: usize, window: Run) -> Self {
        Self { at: std::array::from_fn(|i| first + step * i as f64), step, count, window }
    }

    /// All of them, and some more so that they are whole vectors.
    fn all(&self) -> Range<usize> {
        0..self.count.next_multiple_of(LANES).min(ROWS)
    }

    /// Those whose second coordinate lies in a range, and some more.
    fn between(&self, [from, to]: [f64; 2]) -> Range<usize> {
        // Of a row alone the step is zero, and the quotient infinite, or no number on the row itself.
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

/// An interval a row; empty where `last < first`.
#[derive(Clone, Debug)]
struct Intervals {
    first: [f64; ROWS],
    last: [f64; ROWS],
}

/// What some regions without their holes have in common, before any end is rounded.
#[derive(Clone, Debug)]
pub struct Common {
    left: Intervals,
    doubts: Each,
    doubtful: bool,
    tie: f64,
}

/// The whole numbers of a window that lie in every one of some regions, row by row.
#[derive(Clone, Debug)]
pub struct Cuts {
    /// What the regions without their holes have in common.
    common: Intervals,
    /// What is missing of it.
    holes: Vec<Hole>,
    doubts: Each,
    doubtful: bool,
    /// Numbers of poses; negative in rows that are to be asked for in another way.
    counts: [f64; ROWS],
    total: u64,
    unsure: bool,
    /// What some of the regions have in common, with one more by turns: a loop that writes over what it
    /// reads is compiled to stores under a mask, which are slow.
    narrowed: [Intervals; 2],
}

#[derive(Clone, Debug)]
struct Hole {
    /// Numbers of the rows that it can meet; what the intervals of others are does not matter.
    rows: Range<usize>,
    missing: Intervals,
    /// In any row is something missing.
    met: bool,
}

/// In which rows an answer is too close to call: as wide as the numbers that decide it, so that loops over
/// rows are vectorised without packing.
trait Doubts {
    fn add(&mut self, row: usize, doubt: bool);
}

/// Not zero where there is one in any row.
#[derive(Clone, Copy, Debug)]
struct Any(u64);

/// Not zero for rows in which there is one.
type Each = [u64; ROWS];

impl Doubts for Any {
    #[inline(always)]
    fn add(&mut self, _: usize, doubt: bool) {
        self.0 |= u64::from(doubt);
    }
}

impl Doubts for Each {
    #[inline(always)]
    fn add(&mut self, row: usize, doubt: bool) {
        self[row] |= u64::from(doubt);
    }
}

impl Common {
    pub fn new() -> Self {
        Self { left: Intervals::NONE, doubts: [0; ROWS], doubtful: false, tie: TIE }
    }
}

impl Cuts {
    pub fn new() -> Self {
        Self {
            common: Intervals::NONE,
            holes: Vec::new(),
            doubts: [0; ROWS],
            doubtful: false,
            counts: [0.0; ROWS],
            total: 0,
            unsure: false,
            narrowed: [Intervals::NONE; 2],
        }
    }

    /// Poses of all rows that are counted.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// There are rows that are not counted.
    pub fn unsure(&self) -> bool {
        self.unsure
    }

    /// Row number `row` is counted: it is not in doubt, and no more than two holes take of it.
    pub fn is_counted(&self, row: usize) -> bool {
        self.counts[row] >= 0.0
    }

    /// An answer in row number `row` is too close to call.
    pub fn in_doubt(&self, row: usize) -> bool {
        self.doubtful && self.doubts[row] != 0
    }

    /// The poses of row number `row`, in order.
    pub fn runs(&self, row: usize) -> impl Iterator<Item = Run> {
        let holes = move || {
            let holes = self.holes.iter().filter(move |hole| hole.rows.contains(&row));
            let ends = holes.map(move |hole| hole.missing.ends(row));
            ends.filter(|[first, last]| first <= last)
        };
        let [mut next, last] = self.common.ends(row);
        std::iter::from_fn(move || {
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

impl Intervals {
    /// Empty, and no end is a tie.
    const NONE: Self = Self { first: [0.5; ROWS], last: [-0.5; ROWS] };

    fn ends(&self, row: usize) -> [f64; 2] {
        [self.first[row], self.last[row]]
    }
}

/// Takes what some regions have in common, which stays so for other regions to come.
pub struct Begin<'a, R> {
    pub regions: R,
    pub rows: &'a Rows,
    pub common: &'a mut Common,
}

/// Cuts regions, and those that `begun` was taken from, by rows, and counts what they have in common.
/// All of them give their holes.
pub struct Cut<'a, R, H> {
    pub rows: &'a Rows,
    pub begun: &'a Common,
    pub regions: R,
    pub holes: H,
    pub cuts: &'a mut Cuts,
}

impl<'a, R: Iterator<Item = (&'a Region, &'a Fit)>> WithSimd for Begin<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { regions, rows, common } = self;
        *common = Common::new();
        let Common { left, doubts, doubtful, tie } = common;
        // Half-way to the next pose on both sides: ends that are farther away are no ties.
        left.first[..rows.count].fill(rows.window.from as f64 - 0.5);
        left.last[..rows.count].fill(rows.window.to as f64 - 0.5);
        for (region, fit) in regions {
            let knife = Knife { set: &region.whole, precision: &fit.precision };
            knife.narrow(rows, &left.clone(), left, doubts);
            *tie = larger(*tie, fit.tie);
        }
        *doubtful = doubts.iter().any(|&doubt| doubt != 0);
    }
}

impl<'a, R, H> WithSimd for Cut<'_, R, H>
where
    R: Iterator<Item = (&'a Region, &'a Fit)> + Clone,
    H: Iterator<Item = (&'a Region, &'a Fit)> + Clone,
{
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        // In few windows is anything in doubt: then it is found out where.
        let mut any = Any(0);
        if !self.begun.doubtful {
            self.cut(&mut any);
            self.cuts.doubtful = any.0 != 0;
        }
        if self.begun.doubtful || any.0 != 0 {
            let mut doubts = self.begun.doubts;
            self.cut(&mut doubts);
            for (count, &doubt) in self.cuts.counts.iter_mut().zip(&doubts) {
                *count -= if doubt != 0 { f64::INFINITY } else { 0.0 };
            }
            (self.cuts.doubts, self.cuts.doubtful) = (doubts, true);
        }
        (self.cuts.total, self.cuts.unsure) = sum(&self.cuts.counts[self.rows.all()]);
    }
}

impl<'a, R, H> Cut<'_, R, H>
where
    R: Iterator<Item = (&'a Region, &'a Fit)> + Clone,
    H: Iterator<Item = (&'a Region, &'a Fit)> + Clone,
{
    #[inline(always)]
    fn cut(&mut self, doubts: &mut impl Doubts) {
        let Self { rows, begun, regions, holes: with_holes, cuts } = self;
        let Cuts { common, holes, counts, narrowed: [now, next], .. } = &mut **cuts;
        let (mut now, mut next, mut tie) = (now, next, begun.tie);
        now.clone_from(&begun.left);
        for (region, fit) in regions.clone() {
            let knife = Knife { set: &region.whole, precision: &fit.precision };
            knife.narrow(rows, now, next, doubts);
            (now, next) = (next, now);
            tie = larger(tie, fit.tie);
        }
        let near = |end: f64| (end - end.round_ties_even()).abs() <= tie;
        round(rows, now, common, counts, near, doubts);
        let mut number = 0;
        for (region, fit) in with_holes.clone() {
            let Some(set) = &region.hole else { continue };
            let met = rows.between(fit.hole_rows);
            if met.is_empty() {
                continue;
            }
            if number == holes.len() {
                holes.push(Hole { rows: 0..0, missing: Intervals::NONE, met: false });
            }
            let knife = Knife { set, precision: &fit.precision };
            holes[number].rows = met;
            knife.hollow(rows, now, &mut holes[number], counts, near, doubts);
            number += 1;
        }
        holes.truncate(number);
        count_twice(holes, counts);
    }
}

/// A convex set that rows cut.
struct Knife<'a> {
    set: &'a Convex,
    precision: &'a Precision,
}

impl Knife<'_> {
    /// Leaves of each row what is in the set.
    #[inline(always)]
    fn narrow(self, rows: &Rows, from: &Intervals, to: &mut Intervals, doubts: &mut impl Doubts) {
        let Self { set, precision } = self;
        match set {
            Convex::Bands(bands) => {
                narrow(rows, from, to, doubts, |y| region::common(bands, y, precision));
            }
            Convex::Disc(disc) => narrow(rows, from, to, doubts, |y| disc.section(y, precision)),
            Convex::Stadium(stadium) => {
                narrow(rows, from, to, doubts, |y| stadium.section(y, precision));
            }
        }
    }

    /// Takes of each row what is in the set.
    #[inline(always)]
    fn hollow(
        self,
        rows: &Rows,
        from: &Intervals,
        to: &mut Hole,
        counts: &mut [f64; ROWS],
        near: impl Fn(f64) -> bool,
        doubts: &mut impl Doubts,
    ) {
        let Self { set, precision } = self;
        match set {
            Convex::Bands(bands) => hollow(rows, from, to, counts, near, doubts, |y| {
                region::common(bands, y, precision)
            }),
            Convex::Disc(disc) => {
                hollow(rows, from, to, counts, near, doubts, |y| disc.section(y, precision));
            }
            Convex::Stadium(stadium) => {
                hollow(rows, from, to, counts, near, doubts, |y| stadium.section(y, precision));
            }
        }
    }
}

#[inline(always)]
fn narrow(
    rows: &Rows,
    from: &Intervals,
    to: &mut Intervals,
    doubts: &mut impl Doubts,
    section: impl Fn(f64) -> Section,
) {
    for i in rows.all() {
        let cut = section(rows.at[i]);
        to.first[i] = larger(from.first[i], cut.from);
        to.last[i] = smaller(from.last[i], cut.to);
        doubts.add(i, !cut.sure);
    }
}

/// Cut to what is left of the row, since what is beyond is no tie either.
#[inline(always)]
fn hollow(
    rows: &Rows,
    from: &Intervals,
    to: &mut Hole,
    counts: &mut [f64; ROWS],
    near: impl Fn(f64) -> bool,
    doubts: &mut impl Doubts,
    section: impl Fn(f64) -> Section,
) {
    let Hole { rows: met, missing, met: any } = to;
    let mut some = 0;
    for i in within(met) {
        let cut = section(rows.at[i]);
        let (first, last) = (larger(from.first[i], cut.from), smaller(from.last[i], cut.to));
        doubts.add(i, !cut.sure | near(first) | near(last));
        let (first, last) = (first.ceil(), last.floor());
        (missing.first[i], missing.last[i]) = (first, last);
        let number = larger(last - first + 1.0, 0.0);
        counts[i] -= number;
        some |= number.to_bits();
    }
    *any = some != 0;
}

/// The first and last whole numbers in intervals, and how many there are.
#[inline(always)]
fn round(
    rows: &Rows,
    from: &Intervals,
    to: &mut Intervals,
    counts: &mut [f64; ROWS],
    near: impl Fn(f64) -> bool,
    doubts: &mut impl Doubts,
) {
    for i in rows.all() {
        let (first, last) = (from.first[i], from.last[i]);
        doubts.add(i, near(first) | near(last));
        let (first, last) = (first.ceil(), last.floor());
        (to.first[i], to.last[i]) = (first, last);
        counts[i] = larger(last - first + 1.0, 0.0);
    }
}

/// The same rows, in a way that tells the compiler how many there are at most.
#[inline(always)]
fn within(rows: &Range<usize>) -> Range<usize> {
    rows.start.min(ROWS)..rows.end.min(ROWS)
}

/// Counts once what two holes both leave out, which was taken twice. A number becomes negative where
/// more than two holes take of a row, if any two of all leave out the same.
#[inline(always)]
fn count_twice(holes: &[Hole], counts: &mut [f64; ROWS]) {
    let met = || holes.iter().filter(|hole| hole.met);
    let mut twice = 0;
    for (number, a) in met().enumerate() {
        for b in met().take(number) {
            let rows = a.rows.start.max(b.rows.start)..a.rows.end.min(b.rows.end);
            if rows.is_empty() {
                continue;
            }
            let (a, b) = (&a.missing, &b.missing);
            for i in within(&rows) {
                let (first, last) = (larger(a.first[i], b.first[i]), smaller(a.last[i], b.last[i]));
                let both = larger(last - first + 1.0, 0.0);
                counts[i] += both;
                twice |= both.to_bits();
            }
        }
    }
    if twice != 0 && met().count() > 2 {
        let mut in_row = [0.0; ROWS];
        for Hole { rows, missing, .. } in met() {
            for i in within(rows) {
                in_row[i] += if missing.first[i] <= missing.last[i] { 1.0 } else { 0.0 };
            }
        }
        for (count, number) in counts.iter_mut().zip(in_row) {
            *count -= if number > 2.0 { f64::INFINITY } else { 0.0 };
        }
    }
}

/// The sum of the numbers that are not negative, and whether any is. Whole numbers: their sum does not
/// depend on the order, which the compiler cannot know.
#[inline(always)]
fn sum(counts: &[f64]) -> (u64, bool) {
    let (mut sums, mut least) = ([0.0; LANES], [0.0; LANES]);
    let mut add = |lane: usize, count: f64| {
        sums[lane] += larger(count, 0.0);
        least[lane] = smaller(count, least[lane]);
    };
    let (parts, rest) = counts.as_chunks::<LANES>();
    for part in parts {
        (0..LANES).for_each(|lane| add(lane, part[lane]));
    }
    rest.iter().enumerate().for_each(|(lane, &count)| add(lane, count));
    (sums.iter().sum::<f64>() as u64, least.iter().any(|&lane| lane < 0.0))
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
