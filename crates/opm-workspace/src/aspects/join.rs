//! Which pieces of neighbouring rows belong together.

use super::screen::Piece;
use super::step::is_clear;
use crate::set::{GridSet, SetAxis};
use crate::sweep::Run;
use opm_core::manipulator::{Manipulator, Mode};
use std::f64::consts::TAU;
use std::ops::Range;

/// The pieces of all rows of a set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pieces {
    /// Where the pieces of each row end among all.
    pub ends: Vec<usize>,
    /// The numbers of the poses of each piece in its row.
    pub runs: Vec<Run>,
    /// A number for each combination of signs, and zero for singular poses.
    pub kinds: Vec<u32>,
}

impl Pieces {
    /// Adds the pieces of the next row. `kind` gives the number of a combination of signs.
    pub fn push(&mut self, row: Vec<Piece>, mut kind: impl FnMut(Vec<bool>) -> u32) {
        for Piece { run, signs } in row {
            self.runs.push(run);
            self.kinds.push(signs.map_or(0, &mut kind));
        }
        self.ends.push(self.runs.len());
    }

    /// Where the pieces of a row are among all.
    pub fn span(&self, row: usize) -> Range<usize> {
        let start = if row == 0 { 0 } else { self.ends[row - 1] };
        start..self.ends[row]
    }

    /// The piece that has a pose, by its number in a row.
    pub fn find(&self, row: usize, place: u64) -> Option<usize> {
        let span = self.span(row);
        let runs = &self.runs[span.clone()];
        let after = runs.partition_point(|run| run.from <= place);
        (after > 0 && place < runs[after - 1].to).then(|| span.start + after - 1)
    }
}

/// Two neighbouring rows, or the two ends of rows that come full circle.
#[derive(Clone, Copy)]
struct Neighbours {
    /// The number of the axis that they differ in.
    axis: usize,
    /// The rows' numbers.
    rows: [usize; 2],
    /// Whether the way from the first to the second closes a circle.
    circle: bool,
}

/// Joins pieces by steps between neighbours that are watched.
pub struct Joiner<'a> {
    pub manipulator: &'a Manipulator,
    pub mode: Mode,
    pub set: &'a GridSet,
    pub pieces: &'a Pieces,
}

impl Joiner<'_> {
    /// The pairs of pieces that a row joins: its own, and with those of rows before it.
    pub fn row(&self, row: usize) -> Vec<[usize; 2]> {
        let Self { set, pieces, .. } = self;
        let row_axis = set.varying().first().copied().unwrap_or(0);
        let mut joined = Vec::new();
        let span = pieces.span(row);
        for after in span.clone().skip(1) {
            let before = after - 1;
            let [a, b] = [before, after].map(|piece| pieces.runs[piece]);
            if a.to == b.from && self.alike(before, after) {
                let step = [(row, a.to - 1), (row, b.from)];
                joined.extend(self.clear(step, None).then_some([before, after]));
            }
        }
        if set.axes()[row_axis].circle && !span.is_empty() {
            let (first, last) = (span.start, span.end - 1);
            let ends = [pieces.runs[first], pieces.runs[last]];
            if ends[0].from == 0 && ends[1].to == set.row() && self.alike(first, last) {
                let step = [(row, ends[1].to - 1), (row, 0)];
                joined.extend(self.clear(step, Some(row_axis)).then_some([first, last]));
            }
        }
        let mut stride = 1;
        for (i, SetAxis { axis, circle }) in set.axes()[row_axis + 1..].iter().enumerate() {
            let (count, number) = (axis.count as usize, row / stride % axis.count as usize);
            let axis = row_axis + 1 + i;
            if number > 0 {
                let rows = [row - stride, row];
                self.rows(Neighbours { axis, rows, circle: false }, &mut joined);
            }
            if *circle && number + 1 == count {
                let rows = [row, row - number * stride];
                self.rows(Neighbours { axis, rows, circle: true }, &mut joined);
            }
            stride *= count;
        }
        joined
    }

    /// Joins the pieces of two neighbouring rows that overlap, where one step between them is clear.
    fn rows(&self, Neighbours { axis, rows, circle }: Neighbours, joined: &mut Vec<[usize; 2]>) {
        let [mut spans_a, mut spans_b] = rows.map(|row| self.pieces.span(row));
        while !spans_a.is_empty() && !spans_b.is_empty() {
            let pair = [spans_a.start, spans_b.start];
            let [a, b] = pair.map(|piece| self.pieces.runs[piece]);
            let overlap = a.from.max(b.from)..a.to.min(b.to);
            if !overlap.is_empty() && self.alike(pair[0], pair[1]) {
                let clear =
                    |place: &u64| self.clear(rows.map(|row| (row, *place)), circle.then_some(axis));
                if outwards(overlap).any(|place| clear(&place)) {
                    joined.push(pair);
                }
            }
            if a.to < b.to { spans_a.start += 1 } else { spans_b.start += 1 }
        }
    }

    /// Whether two pieces have the same signs.
    fn alike(&self, a: usize, b: usize) -> bool {
        self.pieces.kinds[a] == self.pieces.kinds[b] && self.pieces.kinds[a] != 0
    }

    /// Whether the step between two poses, each given by its row and its place in that, is clear. Along `circle`, the
    /// step goes on from the last value to the first.
    fn clear(&self, step: [(usize, u64); 2], circle: Option<usize>) -> bool {
        let pose = |(row, place): (usize, u64)| self.set.point(row as u64 * self.set.row() + place);
        let [from, mut to] = step.map(pose);
        if let Some(axis) = circle {
            to[axis] += TAU;
        }
        is_clear(self.manipulator, self.mode, &from, &to)
    }
}

/// The numbers of a range from its middle outwards.
fn outwards(range: Range<u64>) -> impl Iterator<Item = u64> {
    let middle = range.start + (range.end - range.start) / 2;
    let up = (middle..range.end).map(Some).chain(std::iter::repeat(None));
    let down = (range.start..middle).rev().map(Some).chain(std::iter::repeat(None));
    let pairs = up.zip(down).take_while(|(up, down)| up.is_some() || down.is_some());
    pairs.flat_map(|(up, down)| up.into_iter().chain(down))
}

#[cfg(test)]
mod tests {
    use super::outwards;

    #[test]
    fn every_place_of_an_overlap_is_tried_once_the_middle_first() {
        assert_eq!(outwards(3..8).collect::<Vec<_>>(), [5, 4, 6, 3, 7]);
        assert_eq!(outwards(3..4).collect::<Vec<_>>(), [3]);
        assert_eq!(outwards(2..4).collect::<Vec<_>>(), [3, 2]);
    }
}
