//! Poses at which all bodies keep a clearance, tile by tile.
//!
//! A tile is what is left of some rows of a sheet. It is halved until bounds over a box of it tell that all of its poses
//! keep the clearance, or none; the pairs that a box leaves open are those that its halves are tested for. The poses of a
//! small box are decided one by one, for the pairs that are open.

use super::Sweep;
use super::asked::AskedRows;
use crate::clearance::ClearanceLimit;
use opm_core::enclosure::Side;
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_interference::{BoxTest, Clearance, Open};
use std::ops::Range;

/// A box of as many poses or fewer is not bounded: it takes longer than to decide them.
const FEW: u32 = 24;

/// The least share by which boxes are wider than their poses are apart, for rounding.
const ROUNDING: f64 = 1e-15;

/// A thread's working memory for the poses that keep a clearance.
pub struct ClearPoses<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    test: BoxTest<'a>,
    all: Open,
    solution: Solution,
    /// What may be left of the present tile, row by row: for each pose whether it is clear.
    clear: Vec<bool>,
    /// For each row, how many poses are left before each place in it, and at its end.
    before: Vec<u32>,
    sides: Vec<Side>,
    pose: Vec<f64>,
    /// Lists that are not in use.
    spare: Vec<Open>,
    /// For each of the two coordinates of a tile, how much a unit of it counts, metres.
    weights: [f64; 2],
}

/// The rows of a tile.
struct Tile<'t> {
    /// The first coordinates, and the second ones of all rows.
    first: &'t [f64],
    second: &'t [f64],
}

impl<'a> ClearPoses<'a> {
    pub fn new(manipulator: &'a Manipulator, limit: ClearanceLimit<'a>, mode: Mode) -> Self {
        let test = BoxTest::new(manipulator, limit.interference, limit.least);
        let coordinates = manipulator.task_coordinates();
        let weight = |number: usize| {
            let length = coordinates.get(number).is_some_and(|c| c.quantity.unit() == "m");
            if length { 1.0 } else { manipulator.characteristic_length() }
        };
        Self {
            manipulator,
            mode,
            all: test.all(),
            test,
            solution: manipulator.solution(),
            clear: Vec::new(),
            before: Vec::new(),
            sides: Vec::new(),
            pose: vec![0.0; coordinates.len()],
            spare: Vec::new(),
            weights: [weight(0), weight(1)],
        }
    }

    /// Whether a pose is in reach, and keeps the clearance. Gives the values of its imaginary joints then.
    pub fn at(&mut self, pose: &[f64]) -> Option<&[f64]> {
        let Self { manipulator, mode, test, all, solution, .. } = self;
        let found = manipulator.inverse(pose, *mode, solution).ok()??;
        test.at(found, all).then_some(found.imaginary())
    }

    /// Leaves those poses of the rows that keep the clearance. `others` are the coordinates of the sheet's poses behind the
    /// first one.
    pub fn retain(&mut self, sweep: &Sweep<'_>, asked: &mut AskedRows, others: &[f64]) {
        let rows = asked.numbers().len();
        if asked.count() == 0 {
            return;
        }
        let width = asked.first().len();
        self.clear.clear();
        self.clear.resize(rows * width, false);
        for (row, from, to) in asked.pieces() {
            self.clear[row * width + from..row * width + to].fill(true);
        }
        self.before.clear();
        for row in self.clear.chunks(width) {
            let mut count = 0;
            for &left in row {
                self.before.push(count);
                count += u32::from(left);
            }
            self.before.push(count);
        }
        self.pose[1..].copy_from_slice(others);
        self.sides.clear();
        let side = |&middle: &f64| Side { middle, half: 0.0, half_turn: None };
        self.sides.extend(self.pose.iter().map(side));
        let planar = sweep.grid.lower() > 1;
        let second = if planar { asked.second() } else { &[] };
        let tile = Tile { first: asked.first(), second };
        let all = std::mem::take(&mut self.all);
        if planar {
            self.decide(&tile, 0..rows, 0..width, &all);
        } else {
            // The rows of a sheet with one row.
            (0..rows).for_each(|row| self.decide(&tile, row..row + 1, 0..width, &all));
        }
        self.all = all;
        asked.keep(&self.clear);
    }

    /// Decides the poses that are left of a part of a tile, for the pairs that are open.
    fn decide(&mut self, tile: &Tile<'_>, rows: Range<usize>, poses: Range<usize>, open: &Open) {
        let width = tile.first.len();
        let left = |row: usize| {
            let row = &self.before[row * (width + 1)..];
            row[poses.end] - row[poses.start]
        };
        let count: u32 = rows.clone().map(left).sum();
        if count == 0 {
            return;
        }
        if count <= FEW || !self.test.takes_boxes() {
            for row in rows {
                self.decide_each(tile, row, poses.clone(), open);
            }
            return;
        }
        let halves = self.bound(tile, &rows, &poses);
        let mut next = self.spare.pop().unwrap_or_default();
        match self.test.over_box(self.mode, &self.sides, open, &mut next) {
            Clearance::Clear => {}
            Clearance::Blocked => {
                for row in rows {
                    self.clear[row * width..][poses.clone()].fill(false);
                }
            }
            Clearance::Open => {
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
        let along = set(0, &tile.first[poses.clone()]);
        let across = match tile.second.get(rows.clone()) {
            Some(second) if !second.is_empty() => set(1, second),
            _ => 0.0,
        };
        [along, across]
    }

    /// Decides the poses that are left of a part of a row, one by one.
    fn decide_each(&mut self, tile: &Tile<'_>, row: usize, poses: Range<usize>, open: &Open) {
        let width = tile.first.len();
        if let Some(&second) = tile.second.get(row) {
            self.pose[1] = second;
        }
        for number in poses {
            let place = row * width + number;
            if !self.clear[place] {
                continue;
            }
            self.pose[0] = tile.first[number];
            let found = self.manipulator.inverse(&self.pose, self.mode, &mut self.solution);
            // A pose on the boundary of reach may be out of it for the one and not the other.
            self.clear[place] = match found {
                Ok(Some(found)) => self.test.at(found, open),
                Ok(None) | Err(_) => false,
            };
        }
    }
}
