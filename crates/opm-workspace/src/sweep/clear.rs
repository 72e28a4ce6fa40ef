//! Poses at which all bodies keep a clearance, tile by tile.
//!
//! A tile is what is left of some rows of a sheet, or, where slices have few poses, of the first two coordinates that vary. It
//! is halved until bounds over a box of it tell that all of its poses keep the clearance, or none; the pairs that a box leaves
//! open are those that its halves are tested for. In a small box, bounds at each pose follow from those over the box. Only the
//! poses that these leave open are solved.

use super::Sweep;
use super::asked::AskedRows;
use crate::clearance::ClearanceLimit;
use opm_core::enclosure::Side;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::{Quantity, TaskCoordinate};
use opm_interference::{BoxTest, Clearance, Open};
use std::ops::Range;

/// A box of as many poses or fewer is not bounded: it takes longer than to solve them.
const FEW: usize = 12;

/// In a box of as many poses or fewer, each of them is tested before the box is halved.
const MANY: usize = 64;

/// The least share by which boxes are wider than their poses are apart, for rounding.
const ROUNDING: f64 = 1e-15;

/// A thread's working memory for the poses that keep a clearance.
pub struct ClearPoses<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    test: BoxTest<'a>,
    all: Open,
    solution: Solution,
    /// The poses of the present tile, row by row: whether each is left and not decided, and whether it is clear.
    open: Vec<bool>,
    clear: Vec<bool>,
    sides: Vec<Side>,
    pose: Vec<f64>,
    /// Lists that are not in use.
    spare: Vec<Open>,
    /// For each coordinate, how much a unit of it counts, metres.
    weights: Vec<f64>,
}

/// The poses of a tile: they differ in two coordinates.
#[derive(Clone, Copy)]
pub struct Tile<'t> {
    /// The numbers of these coordinates.
    pub axes: [usize; 2],
    /// The values of the first one along every row.
    pub first: &'t [f64],
    /// The value of the second one in each row; none, if there is one row and all poses share it.
    pub second: &'t [f64],
}

impl<'a> ClearPoses<'a> {
    pub fn new(manipulator: &'a Manipulator, limit: ClearanceLimit<'a>, mode: Mode) -> Self {
        let test = BoxTest::new(manipulator, limit.interference, limit.least);
        let coordinates = manipulator.task_coordinates();
        let angle = manipulator.characteristic_length();
        let weight = |c: &TaskCoordinate| if c.quantity == Quantity::Length { 1.0 } else { angle };
        Self {
            manipulator,
            mode,
            all: test.all(),
            test,
            solution: manipulator.solution(),
            open: Vec::new(),
            clear: Vec::new(),
            sides: Vec::new(),
            pose: vec![0.0; coordinates.len()],
            spare: Vec::new(),
            weights: coordinates.iter().map(weight).collect(),
        }
    }

    /// Leaves those poses of the rows that keep the clearance. `others` are the coordinates of the sheet's poses behind the
    /// first one.
    pub fn retain(&mut self, sweep: &Sweep<'_>, asked: &mut AskedRows, others: &[f64]) {
        let rows = asked.numbers().len();
        if asked.count() == 0 {
            return;
        }
        let width = asked.first().len();
        self.begin(rows * width);
        for (row, from, to) in asked.pieces() {
            self.open[row * width + from..row * width + to].fill(true);
        }
        self.pose[1..].copy_from_slice(others);
        let first = asked.first();
        if sweep.grid.lower() > 1 {
            self.decide_all(&Tile { axes: [0, 1], first, second: asked.second() }, 0..rows);
        } else {
            // The rows of a sheet with one row.
            let tile = Tile { axes: [0, 1], first, second: &[] };
            (0..rows).for_each(|row| self.decide_all(&tile, row..row + 1));
        }
        asked.keep(&self.clear);
    }

    /// Leaves those poses of a tile that keep the clearance. `pose` is any of them, and `left` has an answer for each, row by
    /// row.
    pub fn retain_tile(&mut self, tile: &Tile<'_>, pose: &[f64], left: &mut [bool]) {
        self.begin(left.len());
        self.open.copy_from_slice(left);
        self.pose.copy_from_slice(pose);
        self.decide_all(tile, 0..left.len() / tile.first.len());
        left.copy_from_slice(&self.clear);
    }

    /// Begins a tile of some poses, of which none is left.
    fn begin(&mut self, poses: usize) {
        for flags in [&mut self.open, &mut self.clear] {
            flags.clear();
            flags.resize(poses, false);
        }
    }

    /// Decides the open poses of some rows of a tile, for all pairs. The present pose has its other coordinates.
    fn decide_all(&mut self, tile: &Tile<'_>, rows: Range<usize>) {
        self.sides.clear();
        let side = |&middle: &f64| Side { middle, half: 0.0, half_turn: None };
        self.sides.extend(self.pose.iter().map(side));
        let all = std::mem::take(&mut self.all);
        self.decide(tile, rows, 0..tile.first.len(), &all);
        self.all = all;
    }

    /// Decides the open poses of a part of a tile, for the pairs that are open.
    fn decide(&mut self, tile: &Tile<'_>, rows: Range<usize>, poses: Range<usize>, open: &Open) {
        let width = tile.first.len();
        let of_rows = rows.clone().map(|row| &self.open[row * width..][poses.clone()]);
        let count = of_rows.flatten().filter(|&&open| open).count();
        if count == 0 {
            return;
        }
        if count <= FEW || !self.test.takes_boxes() {
            self.decide_each(tile, (&rows, &poses), |this| this.solve(open));
            return;
        }
        let halves = self.bound(tile, &rows, &poses);
        let mut next = self.spare.pop().unwrap_or_default();
        match self.test.over_box(self.mode, &self.sides, open, &mut next) {
            Clearance::Open => {
                if count <= MANY {
                    self.decide_each(tile, (&rows, &poses), |this| this.test.in_box(&this.pose));
                }
                let middle = |range: &Range<usize>| range.start + range.len() / 2;
                let along = rows.len() < 2 || (poses.len() > 1 && halves[0] >= halves[1]);
                if along {
                    let at = middle(&poses);
                    self.decide(tile, rows.clone(), poses.start..at, &next);
                    self.decide(tile, rows, at..poses.end, &next);
                } else {
                    let at = middle(&rows);
                    self.decide(tile, rows.start..at, poses.clone(), &next);
                    self.decide(tile, at..rows.end, poses, &next);
                }
            }
            decided => self.decide_each(tile, (&rows, &poses), |_| decided),
        }
        self.spare.push(next);
    }

    /// Makes the box of a part of a tile; returns half of its lengths in both coordinates, metres.
    fn bound(&mut self, tile: &Tile<'_>, rows: &Range<usize>, poses: &Range<usize>) -> [f64; 2] {
        let mut set = |number: usize, values: &[f64]| {
            let ends = [values[0], values[values.len() - 1]];
            let middle = 0.5 * (ends[0] + ends[1]);
            let half = 0.5 * (ends[1] - ends[0]).abs();
            let rounding = ROUNDING * (ends[0].abs() + ends[1].abs());
            let half = if half > 0.0 { half + rounding } else { 0.0 };
            self.sides[number] = Side { middle, half, half_turn: None };
            half * self.weights[number]
        };
        let along = set(tile.axes[0], &tile.first[poses.clone()]);
        let across = match tile.second.get(rows.clone()) {
            Some(second) if !second.is_empty() => set(tile.axes[1], second),
            _ => 0.0,
        };
        [along, across]
    }

    /// Decides the open poses of a part of a tile, one by one.
    fn decide_each(
        &mut self,
        tile: &Tile<'_>,
        (rows, poses): (&Range<usize>, &Range<usize>),
        mut test: impl FnMut(&mut Self) -> Clearance,
    ) {
        let width = tile.first.len();
        for row in rows.clone() {
            if let Some(&second) = tile.second.get(row) {
                self.pose[tile.axes[1]] = second;
            }
            for number in poses.clone() {
                let place = row * width + number;
                if self.open[place] {
                    self.pose[tile.axes[0]] = tile.first[number];
                    let tested = test(self);
                    self.open[place] = tested == Clearance::Open;
                    self.clear[place] = tested == Clearance::Clear;
                }
            }
        }
    }

    /// Decides the present pose by its distances.
    fn solve(&mut self, open: &Open) -> Clearance {
        match self.manipulator.inverse(&self.pose, self.mode, &mut self.solution) {
            Ok(Some(found)) if self.test.at(found, open) => Clearance::Clear,
            // A pose on the boundary of reach may be out of it for the one and not the other.
            Ok(_) | Err(_) => Clearance::Blocked,
        }
    }
}
