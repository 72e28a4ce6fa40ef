//! Poses at which all bodies keep a clearance, tile by tile.
//!
//! A tile is what is left of some rows of a sheet, or, where slices have few poses, of the first two coordinates that vary. It
//! is halved until bounds over a box of it tell that all of its poses keep the clearance, or none; the pairs that a box leaves
//! open are those that its halves are tested for. In a small box, bounds at each pose follow from those over the box. Only the
//! poses that these leave open are solved.

use super::Sweep;
use super::asked::AskedRows;
use super::tile::{Tile, TileBox, TilePart};
use crate::clearance::ClearanceLimit;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_interference::{BoxTest, Clearance, Open};
use std::ops::Range;

/// A box of as many poses or fewer is not bounded: it takes longer than to solve them.
const FEW: usize = 12;

/// In a box of as many poses or fewer, each of them is tested before the box is halved.
const MANY: usize = 64;

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
    /// The box of the present part.
    bound: TileBox,
    pose: Vec<f64>,
    /// Lists that are not in use.
    spare: Vec<Open>,
}

impl<'a> ClearPoses<'a> {
    pub fn new(manipulator: &'a Manipulator, limit: ClearanceLimit<'a>, mode: Mode) -> Self {
        let test = BoxTest::new(manipulator, limit.interference, limit.least);
        Self {
            manipulator,
            mode,
            all: test.all(),
            test,
            solution: manipulator.solution(),
            open: Vec::new(),
            clear: Vec::new(),
            bound: TileBox::new(manipulator),
            pose: vec![0.0; manipulator.task_coordinates().len()],
            spare: Vec::new(),
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
        self.bound.begin(&self.pose);
        let all = std::mem::take(&mut self.all);
        self.decide(tile, &TilePart { rows, poses: 0..tile.first.len() }, &all);
        self.all = all;
    }

    /// Decides the open poses of a part of a tile, for the pairs that are open.
    fn decide(&mut self, tile: &Tile<'_>, part: &TilePart, open: &Open) {
        let width = tile.first.len();
        let of_rows = part.rows.clone().map(|row| &self.open[row * width..][part.poses.clone()]);
        let count = of_rows.flatten().filter(|&&open| open).count();
        if count == 0 {
            return;
        }
        if count <= FEW || !self.test.takes_boxes() {
            self.decide_each(tile, part, |this| this.solve(open));
            return;
        }
        let lengths = self.bound.bound(tile, part);
        let mut next = self.spare.pop().unwrap_or_default();
        match self.test.over_box(self.mode, &self.bound.sides, open, &mut next) {
            Clearance::Open => {
                if count <= MANY {
                    self.decide_each(tile, part, |this| this.test.in_box(&this.pose));
                }
                part.halves(lengths).iter().for_each(|half| self.decide(tile, half, &next));
            }
            decided => self.decide_each(tile, part, |_| decided),
        }
        self.spare.push(next);
    }

    /// Decides the open poses of a part of a tile, one by one.
    fn decide_each(
        &mut self,
        tile: &Tile<'_>,
        TilePart { rows, poses }: &TilePart,
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
