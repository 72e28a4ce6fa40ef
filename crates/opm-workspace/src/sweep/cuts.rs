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

/// The whole numbers of a window that lie in every one of some regions, row by row.
#[derive(Clone, Debug)]
pub struct Cuts {
    /// What the regions without their holes have in common.
    common: Intervals,
    /// What is missing of it.
    holes: Vec<Hole>,
    /// Not zero for rows of which an answer is too close to call; as wide as the numbers that decide it,
    /// so that the loop over rows is vectorised without packing.
    doubts: [u64; ROWS],
    /// Numbers of poses; negative in rows that are to be asked for in another way.
    counts: [f64; ROWS],
    total: u64,
    unsure: bool,
    /// What some of the regions have in common, with one more by turns: a loop that writes over what it
    /// reads is compiled to stores under a mask, which are slow.
    narrowed: [Intervals; 2],
}

/// An interval a row; empty where `last < first`.
#[derive(Clone, Debug)]
struct Intervals {
    first: [f64; ROWS],
    last: [f64; ROWS],
}

#[derive(Clone, Debug)]
struct Hole {
    /// Numbers of the rows that it can meet; what the intervals of others are does not matter.
    rows: Range<usize>,
    missing: Intervals,
    /// In any row is something missing.
    met: bool,
}

impl Cuts {
    pub fn new() -> Self {
        Self {
            common: Intervals::NONE,
            holes: Vec::new(),
            doubts: [0; ROWS],
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
        self.doubts[row] != 0
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
    const NONE: Self = Self { first: [0.0; ROWS], last: [-1.0; ROWS] };

    fn ends(&self, row: usize) -> [f64; 2] {
        [self.first[row], self.last[row]]
    }
}

/// Second coordinates of rows, and how many count.
#[derive(Clone, Debug)]
pub struct Rows {
    /// Ascending.
    pub at: [f64; ROWS],
    pub count: usize,
}

impl Rows {
    /// Those whose second coordinate lies in a range, and some more so that they are whole vectors.
    fn between(&self, [from, to]: [f64; 2]) -> Range<usize> {
        const LANES: usize = 8;
        let rows = &self.at[..self.count];
        let first = rows.partition_point(|&at| at < from);
        let end = rows.partition_point(|&at| at <= to);
        if first >= end {
            return 0..0;
        }
        first / LANES * LANES..end.next_multiple_of(LANES).min(self.count)
    }
}

/// Cuts regions by a window of rows, and counts what they have in common.
pub struct Cut<'a, R> {
    pub regions: R,
    pub rows: &'a Rows,
    pub window: Run,
    pub cuts: &'a mut Cuts,
}

impl<'a, R: Iterator<Item = (&'a Region, &'a Fit)> + Clone> WithSimd for Cut<'_, R> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { regions, rows, window, cuts } = self;
        let Cuts { common, holes, doubts, counts, narrowed: [now, next], .. } = cuts;
        let all = 0..rows.count.min(ROWS);
        let (mut now, mut next) = (now, next);
        // Half-way to the next pose on both sides: ends that are farther away are no ties.
        now.first.fill(window.from as f64 - 0.5);
        now.last.fill(window.to as f64 - 0.5);
        doubts.fill(0);
        let mut tie = TIE;
        for (region, fit) in regions.clone() {
            let knife = Knife::new(&region.whole, fit, &rows.at, all.clone());
            knife.narrow(now, next, doubts);
            (now, next) = (next, now);
            tie = larger(tie, fit.tie);
        }
        let mut number = 0;
        for (region, fit) in regions {
            let Some(set) = &region.hole else { continue };
            let met = rows.between(fit.hole_rows);
            if met.is_empty() {
                continue;
            }
            if number == holes.len() {
                holes.push(Hole { rows: 0..0, missing: Intervals::NONE, met: false });
            }
            let hole = &mut holes[number];
            hole.rows = met.clone();
            // Cut to what is left of the row, since what is beyond is no tie either.
            let knife = Knife::new(set, fit, &rows.at, met.clone());
            knife.narrow(now, next, doubts);
            round(met, next, &mut hole.missing, tie, doubts);
            number += 1;
        }
        holes.truncate(number);
        round(all.clone(), now, common, tie, doubts);
        for i in all.clone() {
            counts[i] = larger(common.last[i] - common.first[i] + 1.0, 0.0);
        }
        count_holes(holes, counts);
        for i in all.clone() {
            counts[i] -= if doubts[i] != 0 { f64::INFINITY } else { 0.0 };
        }
        (cuts.total, cuts.unsure) = sum(&counts[all]);
    }
}

/// A convex set that some rows cut.
struct Knife<'a> {
    set: &'a Convex,
    precision: &'a Precision,
    at: &'a [f64; ROWS],
    rows: Range<usize>,
}

impl<'a> Knife<'a> {
    #[inline(always)]
    fn new(set: &'a Convex, fit: &'a Fit, at: &'a [f64; ROWS], rows: Range<usize>) -> Self {
        Self { set, precision: &fit.precision, at, rows }
    }

    /// Leaves of each row what is in the set.
    #[inline(always)]
    fn narrow(self, from: &Intervals, to: &mut Intervals, doubts: &mut [u64; ROWS]) {
        let Self { set, precision, at, rows } = self;
        match set {
            Convex::Bands(bands) => {
                cut(at, rows, from, to, doubts, |y| region::common(bands, y, precision));
            }
            Convex::Disc(disc) => {
                cut(at, rows, from, to, doubts, |y| disc.section(y, precision));
            }
            Convex::Stadium(stadium) => {
                cut(at, rows, from, to, doubts, |y| stadium.section(y, precision));
            }
        }
    }
}

#[inline(always)]
fn cut(
    at: &[f64; ROWS],
    rows: Range<usize>,
    from: &Intervals,
    to: &mut Intervals,
    doubts: &mut [u64; ROWS],
    section: impl Fn(f64) -> Section,
) {
    for i in rows {
        let cut = section(at[i]);
        to.first[i] = larger(from.first[i], cut.from);
        to.last[i] = smaller(from.last[i], cut.to);
        doubts[i] |= u64::from(!cut.sure);
    }
}

/// The first and last whole numbers in intervals.
#[inline(always)]
fn round(
    rows: Range<usize>,
    from: &Intervals,
    to: &mut Intervals,
    tie: f64,
    doubts: &mut [u64; ROWS],
) {
    let near = |end: f64| (end - end.round_ties_even()).abs() <= tie;
    for i in rows {
        let (first, last) = (from.first[i], from.last[i]);
        doubts[i] |= u64::from(near(first)) | u64::from(near(last));
        to.first[i] = first.ceil();
        to.last[i] = last.floor();
    }
}

/// Takes from the poses of each row what holes leave out of it: what two of them both leave out was taken
/// twice, and with more than two in a row the number becomes negative.
#[inline(always)]
fn count_holes(holes: &mut [Hole], counts: &mut [f64; ROWS]) {
    let mut number = 0;
    for Hole { rows, missing: Intervals { first, last }, met } in holes.iter_mut() {
        let mut any = 0;
        for i in rows.clone() {
            let missing = larger(last[i] - first[i] + 1.0, 0.0);
            counts[i] -= missing;
            any |= missing.to_bits();
        }
        *met = any != 0;
        number += usize::from(*met);
    }
    let met = || holes.iter().filter(|hole| hole.met);
    for (number, a) in met().enumerate() {
        for b in met().take(number) {
            let rows = a.rows.start.max(b.rows.start)..a.rows.end.min(b.rows.end);
            let (a, b) = (&a.missing, &b.missing);
            for i in rows {
                let (first, last) = (larger(a.first[i], b.first[i]), smaller(a.last[i], b.last[i]));
                counts[i] += larger(last - first + 1.0, 0.0);
            }
        }
    }
    if number > 2 {
        let mut in_row = [0.0; ROWS];
        for Hole { rows, missing, .. } in met() {
            for i in rows.clone() {
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
    const LANES: usize = 8;
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
