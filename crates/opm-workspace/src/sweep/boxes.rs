//! Poses of mechanisms with dependent coordinates, or with legs that are solved whole, tile by tile.
//!
//! A tile is some rows of a grid, or a part of one. It is halved until bounds over a box of it tell that all of its poses are in
//! reach and within the limits, or none. Only in small boxes that these leave open, poses are decided each for itself. In coarse
//! grids bounds may tell little: then there are few boxes, until it is tried again.

use super::reach::Reach;
use super::runs::{self, Run};
use super::tile::{Tile, TileBox, TilePart};
use super::worker::{Ranges, Visitor};
use super::{Count, Hits, Sweep};
use crate::grid::{Axis, Sections};
use opm_core::enclosure::BoxQuery;
use opm_core::manipulator::{Manipulator, Mode};
use std::ops::Range;

/// A box of as many poses or fewer is not bounded: it takes longer than to decide them.
const FEW: usize = 64;

/// What a box takes, in poses that could be decided in this time.
const BOX: i64 = 64;

/// Boxes may take so much time more than they have saved, in poses.
const DEBT: i64 = 2048;

/// The most time that is counted as saved, in poses.
const SAVED: i64 = 1 << 16;

/// Of so many poses that are decided without boxes, one pays off a debt.
const PER_DEBT: i64 = 32;

/// Most poses that are decided together, each for itself: they are kept with their coordinates.
const MOST: usize = 1024;

/// How far inside the range of an imaginary joint the values of a box have to be, as a share of the larger end: far more than
/// they are rounded.
const MARGIN: f64 = 1e-9;

/// What is known of a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Known {
    Nothing,
    Reached,
    Missed,
}

/// A thread's working memory for tiles.
pub struct Boxes<'a> {
    manipulator: &'a Manipulator,
    mode: Option<Mode>,
    /// Whether poses in reach count, whatever their condition numbers.
    all_count: bool,
    /// Whether ranges of imaginary joints are wanted, of which there are some.
    ranges: bool,
    reach: Reach<'a>,
    bound: TileBox,
    /// The time that boxes have saved, in poses.
    saved: i64,
    /// What is known of the poses of the present tile, row by row.
    known: Vec<Known>,
    /// The values of the first coordinate along its rows, and of the second one that varies in each row.
    values: [Vec<f64>; 2],
    /// The coordinates of a pose of it.
    pose: Vec<f64>,
    /// Poses that are decided each for itself, one after the other, with their numbers in the tile.
    poses: Vec<f64>,
    numbers: Vec<usize>,
    reached: Vec<bool>,
    runs: Vec<Run>,
    first: Vec<f64>,
}

impl Sweep<'_> {
    /// Whether bounds over boxes decide most poses. They do where some task coordinates follow from those of the grid, and where
    /// legs are solved whole.
    pub(super) fn takes_boxes(&self) -> bool {
        let manipulator = self.manipulator;
        self.grid.sections() == Sections::Whole
            && self.clearance.is_none()
            && (manipulator.is_whole() || !manipulator.dependent_coordinates().is_empty())
            && !manipulator.task().shares_height()
            && manipulator.has_enclosures()
    }
}

impl<'a> Boxes<'a> {
    pub fn new(sweep: &Sweep<'a>, ranges: Ranges) -> Self {
        let manipulator = sweep.manipulator;
        Self {
            manipulator,
            mode: sweep.modes.one(),
            all_count: sweep.limit.is_none(),
            ranges: ranges == Ranges::Wanted && !manipulator.imaginary().is_empty(),
            reach: Reach::new(sweep),
            bound: TileBox::new(manipulator),
            saved: 0,
            known: Vec::new(),
            values: [Vec::new(), Vec::new()],
            pose: Vec::new(),
            poses: Vec::new(),
            numbers: Vec::new(),
            reached: Vec::new(),
            runs: Vec::new(),
            first: Vec::new(),
        }
    }

    /// Decides poses with these numbers, of whole segments of rows.
    pub fn decide(
        &mut self,
        sweep: &Sweep<'_>,
        numbers: Range<u64>,
        found: &mut Count,
        hit: &mut Visitor<'_>,
    ) {
        let axes = sweep.grid.axes();
        let along = sweep.grid.row();
        // The second coordinate that varies.
        let across = (1..axes.len()).find(|&number| axes[number].count > 1);
        let mut next = numbers.start;
        while next < numbers.end {
            let (row, from) = (next / along, next % along);
            let rest = numbers.end - next;
            let (rows, columns) = if from > 0 || rest < along {
                (1, rest.min(along - from))
            } else {
                let of_tile =
                    across.map_or(1, |number| axes[number].count - row % axes[number].count);
                ((rest / along).min(of_tile), along)
            };
            self.go_to(axes, next, columns, across.map(|number| (number, rows)));
            self.decide_tile(across.unwrap_or(0), rows as usize, found);
            found.poses += rows * columns;
            let reached = self.known.iter().filter(|&&known| known == Known::Reached);
            found.reachable += reached.count() as u64;
            if let Some(hit) = hit {
                self.hand_over(sweep, (row, from), across, hit);
            }
            next += rows * columns;
        }
    }

    /// Goes to a tile that begins with a pose: takes the values of so many columns, and of the rows.
    fn go_to(&mut self, axes: &[Axis], pose: u64, columns: u64, rows: Option<(usize, u64)>) {
        self.pose.clear();
        let [first, second] = &mut self.values;
        let mut rest = pose;
        for (number, axis) in axes.iter().enumerate() {
            let digit = rest % axis.count;
            rest /= axis.count;
            self.pose.push(axis.value(digit));
            if number == 0 {
                first.clear();
                first.extend((digit..digit + columns).map(|digit| axis.value(digit)));
            }
            if let Some((_, rows)) = rows.filter(|(across, _)| *across == number) {
                second.clear();
                second.extend((digit..digit + rows).map(|digit| axis.value(digit)));
            }
        }
    }

    /// Decides the poses of a tile, whose rows differ in coordinate number `across`.
    fn decide_tile(&mut self, across: usize, rows: usize, found: &mut Count) {
        let [first, second] = std::mem::take(&mut self.values);
        self.known.clear();
        self.known.resize(rows * first.len(), Known::Nothing);
        self.bound.begin(&self.pose);
        let tile = Tile { axes: [0, across], first: &first, second: &second };
        let all = TilePart { rows: 0..rows, poses: 0..first.len() };
        self.decide_part(&tile, &all, false, found);
        let mut next = 0;
        while next < self.known.len() {
            next = self.take_open(&tile, next);
            self.decide_taken(found, self.ranges);
            for (&number, &reached) in self.numbers.iter().zip(&self.reached) {
                self.known[number] = if reached { Known::Reached } else { Known::Missed };
            }
        }
        self.values = [first, second];
    }

    /// Decides what boxes tell of a part of a tile, of which all poses are in reach if it is `inside`.
    fn decide_part(&mut self, tile: &Tile<'_>, part: &TilePart, inside: bool, found: &mut Count) {
        if part.len() <= FEW {
            return;
        }
        if self.saved < -DEBT {
            self.saved += part.len() as i64 / PER_DEBT;
            return;
        }
        self.saved -= BOX;
        let lengths = self.bound.bound(tile, part);
        let mut inside = inside;
        if !inside {
            let verdict = self.manipulator.enclose(BoxQuery::Whole, self.mode, &self.bound.sides);
            if verdict.upper <= 0.0 {
                self.fill(tile, part, Known::Missed);
                return;
            }
            inside = self.all_count && verdict.lower >= 1.0;
        }
        if inside && self.widens_no_range(tile, part, found) {
            self.fill(tile, part, Known::Reached);
            return;
        }
        for half in part.halves(lengths) {
            self.decide_part(tile, &half, inside, found);
        }
    }

    /// Whether the imaginary joints are within known ranges in all of a box, which is in reach. If they are not, its corners
    /// widen these first.
    fn widens_no_range(&mut self, tile: &Tile<'_>, part: &TilePart, found: &mut Count) -> bool {
        if !self.ranges {
            return true;
        }
        let values = self.manipulator.imaginary_over(self.mode, &self.bound.sides);
        let known = |found: &Count| {
            values.iter().zip(&found.imaginary).all(|(&[least, most], known)| {
                known.is_some_and(|[from, to]| {
                    let margin = MARGIN * from.abs().max(to.abs());
                    least >= from + margin && most <= to - margin
                })
            })
        };
        if known(found) {
            return true;
        }
        self.poses.clear();
        let TilePart { rows, poses } = part;
        for row in [rows.start, rows.end - 1] {
            for column in [poses.start, poses.end - 1] {
                place(&mut self.pose, tile, row, column);
                self.poses.extend_from_slice(&self.pose);
            }
        }
        self.decide_taken(found, true);
        known(found)
    }

    /// Takes open poses of a tile from a number on. Returns the number from which on to take the next.
    fn take_open(&mut self, tile: &Tile<'_>, from: usize) -> usize {
        let Self { known, pose, poses, numbers, .. } = self;
        let open = known[from..].iter().zip(from..).filter(|(known, _)| **known == Known::Nothing);
        numbers.clear();
        numbers.extend(open.map(|(_, number)| number).take(MOST));
        let (width, columns) = (pose.len(), tile.first.len());
        poses.clear();
        poses.resize(numbers.len() * width, 0.0);
        for (coordinate, &value) in pose.iter().enumerate() {
            poses.iter_mut().skip(coordinate).step_by(width).for_each(|to| *to = value);
        }
        for (pose, number) in poses.chunks_mut(width).zip(&*numbers) {
            place(pose, tile, number / columns, number % columns);
        }
        numbers.last().map_or(known.len(), |last| last + 1)
    }

    /// Decides the poses that were taken.
    fn decide_taken(&mut self, found: &mut Count, ranges: bool) {
        self.reached.clear();
        self.reached.resize(self.poses.len() / self.pose.len(), false);
        self.reach.decide(&self.poses, &mut self.reached, ranges, |imaginary, range| {
            range.into_iter().for_each(|end| found.widen(imaginary, end));
        });
    }

    /// Notes what a box tells.
    fn fill(&mut self, tile: &Tile<'_>, part: &TilePart, known: Known) {
        self.saved = SAVED.min(self.saved + part.len() as i64);
        let TilePart { rows, poses } = part;
        for row in self.known.chunks_mut(tile.first.len()).take(rows.end).skip(rows.start) {
            row[poses.clone()].fill(known);
        }
    }

    /// Hands over the reached poses of a tile, row by row.
    fn hand_over(
        &mut self,
        sweep: &Sweep<'_>,
        (row, from): (u64, u64),
        across: Option<usize>,
        hit: &mut dyn FnMut(&Hits<'_>),
    ) {
        let [first, second] = &self.values;
        for (number, known) in self.known.chunks(first.len()).enumerate() {
            self.runs.clear();
            self.first.clear();
            let mut next = 0;
            while let Some(start) = known[next..].iter().position(|&of| of == Known::Reached) {
                let start = next + start;
                let of_run = known[start..].iter().position(|&of| of != Known::Reached);
                let end = of_run.map_or(known.len(), |count| start + count);
                runs::append(
                    &mut self.runs,
                    Run { from: from + start as u64, to: from + end as u64 },
                );
                self.first.extend_from_slice(&first[start..end]);
                next = end;
            }
            if self.runs.is_empty() {
                continue;
            }
            if let Some(across) = across {
                self.pose[across] = second[number];
            }
            let row = row + number as u64;
            let slice = row / (sweep.side * sweep.sheets);
            let (runs, first, others) = (&self.runs, &self.first, &self.pose[1..]);
            hit(&Hits { slice, row, runs, first, others });
        }
    }
}

/// Places a pose in a tile, whose other coordinates it has.
fn place(pose: &mut [f64], tile: &Tile<'_>, row: usize, column: usize) {
    if let Some(&second) = tile.second.get(row) {
        pose[tile.axes[1]] = second;
    }
    pose[tile.axes[0]] = tile.first[column];
}
