//! Regions cut by rows: which poses of many rows at once, without asking for any of them.
//!
//! Everything is in units of the row's step, so that the poses of a row are the whole numbers of an
//! interval. The loops are over rows, branch-free, and compiled for the processor at hand.

use super::runs::Run;
use opm_core::chain::region::{Convex, Precision, Region, Section, common};
use pulp::{Simd, WithSimd};

/// Rows that are cut together.
pub const ROWS: usize = 64;

/// How near to a pose the end of an interval may come, in steps, and still tell on which side of it
/// the pose is; the ends are right to within this.
const TIE: f64 = 1e-6;

/// Ends that are rounded by more than this many steps are of no use.
const COARSE: f64 = 0.1;

/// A region in steps, with the tolerance that its sections are right to.
#[derive(Clone, Copy, Debug)]
pub struct RowRegion {
    region: Region,
    precision: Precision,
    tie: f64,
}

impl RowRegion {
    /// `None` where rounding leaves no use in it. `extent` is the largest number of the grid, in steps.
    pub fn new(region: Region, extent: f64) -> Option<Self> {
        let size = region.size().max(extent);
        // As fine as the numbers allow, and a hundred roundings at least.
        let tie = TIE.max(size * 1e-12);
        let precision = Precision::new(size, tie);
        (tie < COARSE && region.suits(&precision)).then_some(Self { region, precision, tie })
    }
}

/// The whole numbers of a window of some rows that lie in one region: `first..=last` without
/// `hole_first..=hole_last`.
#[derive(Clone, Debug)]
pub struct Cuts {
    first: [f64; ROWS],
    last: [f64; ROWS],
    hole_first: [f64; ROWS],
    hole_last: [f64; ROWS],
    /// The region has a hole; without one `hole_first` and `hole_last` are not to be read.
    hole: bool,
}

/// Not zero for rows of which an answer is too close to call; as wide as the numbers that decide it, so that
/// the loop over rows is vectorised without packing.
pub type Doubts = [u64; ROWS];

impl Cuts {
    pub fn new() -> Self {
        let none = [0.0; ROWS];
        Self { first: none, last: none, hole_first: none, hole_last: none, hole: false }
    }

    /// The poses of row number `row` that lie in the region, in order: at most two runs.
    pub fn runs(&self, row: usize) -> impl Iterator<Item = Run> {
        let run = |first: f64, last: f64| {
            let (from, to) = (first as u64, (last + 1.0) as u64);
            (from < to).then_some(Run { from, to })
        };
        let (first, last) = (self.first[row], self.last[row]);
        let [start, end] = [self.hole_first[row], self.hole_last[row]];
        let pierced = self.hole && start.max(first) <= end.min(last);
        let runs = if pierced {
            [run(first, start - 1.0), run(end + 1.0, last)]
        } else {
            [run(first, last), None]
        };
        runs.into_iter().flatten()
    }
}

/// Cuts a region by a window of the rows at some second coordinates.
pub struct Cut<'a> {
    pub region: &'a RowRegion,
    pub rows: &'a [f64],
    pub window: Run,
    pub cuts: &'a mut Cuts,
    /// Added to.
    pub doubts: &'a mut Doubts,
}

impl WithSimd for Cut<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { region, rows, window, cuts, doubts } = self;
        let RowRegion { region: Region { whole, hole }, precision, tie } = region;
        let Cuts { first, last, hole_first, hole_last, .. } = cuts;
        let knife = Knife { rows, window, precision, tie: *tie };
        knife.cut(whole, &mut Ends { first, last, doubts });
        if let Some(hole) = hole {
            knife.cut(hole, &mut Ends { first: hole_first, last: hole_last, doubts });
        }
        cuts.hole = hole.is_some();
    }
}

/// Numbers of poses.
#[derive(Clone, Debug)]
pub struct Counts {
    /// Of each row, negative where it is to be asked for in another way.
    pub rows: [f64; ROWS],
    /// Of all rows whose number is not negative.
    pub total: u64,
    /// The number of some row is negative.
    pub unsure: bool,
}

impl Default for Counts {
    fn default() -> Self {
        Self { rows: [0.0; ROWS], total: 0, unsure: false }
    }
}

/// Counts the poses of each row that lie in all regions, one a leg: negative for doubtful rows, and
/// where more than two holes take of the same row, which [`Cuts::runs`] can tell. Holes are cut to
/// what the regions without them have in common.
pub struct Common<'a> {
    pub legs: &'a mut [Cuts],
    /// Number of rows.
    pub rows: usize,
    pub doubts: &'a Doubts,
    pub counts: &'a mut Counts,
}

impl WithSimd for Common<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        const LANES: usize = 8;
        let Self { legs, rows, doubts, counts } = self;
        let count = rows.min(ROWS);
        let rows = &mut counts.rows;
        let (mut first, mut last) = (legs[0].first, legs[0].last);
        for cuts in &legs[1..] {
            for i in 0..count {
                first[i] = larger(first[i], cuts.first[i]);
                last[i] = smaller(last[i], cuts.last[i]);
            }
        }
        for i in 0..count {
            rows[i] = larger(last[i] - first[i] + 1.0, 0.0);
        }
        let mut holes = [0.0; ROWS];
        for cuts in legs.iter_mut().filter(|cuts| cuts.hole) {
            for i in 0..count {
                cuts.hole_first[i] = larger(first[i], cuts.hole_first[i]);
                cuts.hole_last[i] = smaller(last[i], cuts.hole_last[i]);
                let missing = larger(cuts.hole_last[i] - cuts.hole_first[i] + 1.0, 0.0);
                rows[i] -= missing;
                holes[i] += if missing > 0.0 { 1.0 } else { 0.0 };
            }
        }
        for (number, a) in legs.iter().enumerate() {
            for b in legs[..number].iter().filter(|b| a.hole && b.hole) {
                for i in 0..count {
                    // What two holes both take was taken twice.
                    let first = larger(a.hole_first[i], b.hole_first[i]);
                    rows[i] += larger(smaller(a.hole_last[i], b.hole_last[i]) - first + 1.0, 0.0);
                }
            }
        }
        for i in 0..count {
            rows[i] = if (holes[i] > 2.0) | (doubts[i] != 0) { -1.0 } else { rows[i] };
        }
        // Whole numbers: their sum does not depend on the order, which the compiler cannot know.
        let (mut sums, mut least) = ([0.0; LANES], [0.0; LANES]);
        for part in rows.as_chunks::<LANES>().0 {
            for lane in 0..LANES {
                sums[lane] += larger(part[lane], 0.0);
                least[lane] = smaller(part[lane], least[lane]);
            }
        }
        counts.total = sums.iter().sum::<f64>() as u64;
        counts.unsure = least.iter().any(|&lane| lane < 0.0);
    }
}

/// What cuts, and where.
struct Knife<'a> {
    rows: &'a [f64],
    window: Run,
    precision: &'a Precision,
    tie: f64,
}

/// Where the sections go.
struct Ends<'a> {
    first: &'a mut [f64; ROWS],
    last: &'a mut [f64; ROWS],
    doubts: &'a mut Doubts,
}

impl Knife<'_> {
    #[inline(always)]
    fn cut(&self, set: &Convex, ends: &mut Ends<'_>) {
        match set {
            Convex::Bands(bands) => self.fill(ends, |y| common(bands, y, self.precision)),
            Convex::Disc(disc) => self.fill(ends, |y| disc.section(y, self.precision)),
            Convex::Stadium(stadium) => self.fill(ends, |y| stadium.section(y, self.precision)),
        }
    }

    #[inline(always)]
    fn fill(&self, ends: &mut Ends<'_>, section: impl Fn(f64) -> Section) {
        // Half-way to the next pose on both sides: ends that are farther away are no ties.
        let (low, high) = (self.window.from as f64 - 0.5, self.window.to as f64 - 0.5);
        let within = |end: f64| smaller(larger(end, low), high);
        let near = |end: f64| (end - end.round_ties_even()).abs() <= self.tie;
        let count = self.rows.len().min(ROWS);
        let (rows, first) = (&self.rows[..count], &mut ends.first[..count]);
        let (last, doubts) = (&mut ends.last[..count], &mut ends.doubts[..count]);
        for i in 0..count {
            let Section { from, to, sure } = section(rows[i]);
            let (from, to) = (within(from), within(to));
            first[i] = from.ceil();
            last[i] = to.floor();
            doubts[i] |= u64::from(!sure) | u64::from(near(from)) | u64::from(near(to));
        }
    }
}

#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}
