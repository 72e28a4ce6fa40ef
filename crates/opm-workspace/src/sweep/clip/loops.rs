//! The loops over rows that are clipped: branch-free, with arrays as arguments, which the compiler then knows not to overlap.

use super::{ClipPlan, Doubts, Hole, Intervals, LANES, MOST_HOLES, ROWS, RowMarks, Rows};
use opm_core::chain::region::{self, Chord, Convex, Precision, larger, smaller};
use std::ops::Range;

/// A convex set that rows are clipped to.
pub struct ConvexClip<'a> {
    pub set: &'a Convex,
    pub precision: &'a Precision,
}

impl ConvexClip<'_> {
    /// Leaves of each row what is in the set.
    #[inline(always)]
    pub fn intersect(
        self,
        rows: &Rows,
        from: &Intervals,
        to: &mut Intervals,
        doubts: &mut impl Doubts,
    ) {
        let Self { set, precision } = self;
        match set {
            Convex::Bands(bands) => {
                intersect(rows, from, to, doubts, |y| region::common(bands, y, precision));
            }
            Convex::Disc(disc) => intersect(rows, from, to, doubts, |y| disc.chord(y, precision)),
            Convex::Capsule(capsule) => {
                intersect(rows, from, to, doubts, |y| capsule.chord(y, precision));
            }
        }
    }

    /// Takes from each row what is in the set, as hole number `number`; returns how many holes that makes.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the compiler tells arrays apart that are arguments"
    )]
    pub fn subtract_as(
        self,
        number: usize,
        holes: &mut Vec<Hole>,
        plan: &ClipPlan,
        rows: &Rows,
        from: &Intervals,
        counts: &mut [f64; ROWS],
        is_tie: impl Fn(f64) -> bool,
        doubts: &mut impl Doubts,
    ) -> usize {
        let met = rows.between(plan.hole_rows);
        if met.is_empty() {
            return 0;
        }
        if number == holes.len() {
            holes.push(Hole { rows: 0..0, missing: Intervals::NONE, met: false });
        }
        holes[number].rows = met;
        self.subtract(rows, from, &mut holes[number], counts, is_tie, doubts);
        1
    }

    /// Takes from each row what is in the set.
    #[inline(always)]
    fn subtract(
        self,
        rows: &Rows,
        from: &Intervals,
        to: &mut Hole,
        counts: &mut [f64; ROWS],
        is_tie: impl Fn(f64) -> bool,
        doubts: &mut impl Doubts,
    ) {
        let Self { set, precision } = self;
        match set {
            Convex::Bands(bands) => subtract(rows, from, to, counts, is_tie, doubts, |y| {
                region::common(bands, y, precision)
            }),
            Convex::Disc(disc) => {
                subtract(rows, from, to, counts, is_tie, doubts, |y| disc.chord(y, precision));
            }
            Convex::Capsule(capsule) => {
                subtract(rows, from, to, counts, is_tie, doubts, |y| capsule.chord(y, precision));
            }
        }
    }
}

#[inline(always)]
fn intersect(
    rows: &Rows,
    from: &Intervals,
    to: &mut Intervals,
    doubts: &mut impl Doubts,
    chord: impl Fn(f64) -> Chord,
) {
    for i in rows.all() {
        let inside = chord(rows.at[i]);
        to.first[i] = larger(from.first[i], inside.from);
        to.last[i] = smaller(from.last[i], inside.to);
        doubts.add(i, !inside.sure);
    }
}

/// The chords are clipped to what is left of the row, since an end beyond that is no tie either.
#[inline(always)]
fn subtract(
    rows: &Rows,
    from: &Intervals,
    to: &mut Hole,
    counts: &mut [f64; ROWS],
    is_tie: impl Fn(f64) -> bool,
    doubts: &mut impl Doubts,
    chord: impl Fn(f64) -> Chord,
) {
    let Hole { rows: met, missing, met: any } = to;
    let mut some = 0;
    for i in within(met) {
        let inside = chord(rows.at[i]);
        let first = larger(from.first[i], inside.from);
        let last = smaller(from.last[i], inside.to);
        doubts.add(i, !inside.sure | is_close(first, last, &is_tie));
        let (first, last) = (first.ceil(), last.floor());
        (missing.first[i], missing.last[i]) = (first, last);
        let number = larger(last - first + 1.0, 0.0);
        counts[i] -= number;
        some |= number.to_bits();
    }
    *any = some != 0;
}

/// Whether an end of an interval is too close to a pose. It does not matter where the interval is empty by far.
#[inline(always)]
fn is_close(first: f64, last: f64, is_tie: impl Fn(f64) -> bool) -> bool {
    (is_tie(first) | is_tie(last)) & (first - last <= 1.0)
}

/// The first and last whole numbers in intervals, and how many there are.
#[inline(always)]
pub fn round(
    rows: &Rows,
    from: &Intervals,
    to: &mut Intervals,
    counts: &mut [f64; ROWS],
    is_tie: impl Fn(f64) -> bool,
    doubts: &mut impl Doubts,
) {
    for i in rows.all() {
        let (first, last) = (from.first[i], from.last[i]);
        doubts.add(i, is_close(first, last, &is_tie));
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

/// Counts once what two holes both take, which was subtracted twice. That is exact in rows of at most
/// [`MOST_HOLES`] holes, or where none overlap; other rows become `crowded`.
#[inline(always)]
pub fn count_overlaps(holes: &[Hole], counts: &mut [f64; ROWS], crowded: &mut RowMarks) {
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
    crowded.any = twice != 0 && met().count() > MOST_HOLES;
    if crowded.any {
        let mut in_row = [0.0; ROWS];
        for Hole { rows, missing, .. } in met() {
            for i in within(rows) {
                in_row[i] += if missing.first[i] <= missing.last[i] { 1.0 } else { 0.0 };
            }
        }
        for (mark, number) in crowded.rows.iter_mut().zip(in_row) {
            *mark = u64::from(number > MOST_HOLES as f64);
        }
    }
}

/// The sum of whole numbers. It does not depend on the order, which the compiler cannot know.
#[inline(always)]
pub fn sum(counts: &[f64]) -> u64 {
    let mut sums = [0.0; LANES];
    let (parts, rest) = counts.as_chunks::<LANES>();
    for part in parts {
        (0..LANES).for_each(|lane| sums[lane] += part[lane]);
    }
    rest.iter().enumerate().for_each(|(lane, &count)| sums[lane] += count);
    sums.iter().sum::<f64>() as u64
}
