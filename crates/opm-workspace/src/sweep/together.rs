//! Poses that are decided one after the other, blocks of them together, whatever their rows and slices: where slices have few
//! poses, and where regions do not tell what legs reach in a slice.

use super::clear::ClearPoses;
use super::reach::Reach;
use super::runs::{self, Run};
use super::tile::Tile;
use super::worker::{Ranges, Visitor};
use super::{BLOCK, Count, Hits, Sweep};
use crate::grid::Sections;
use std::ops::Range;

/// The most poses of a slice that are decided together with those of other slices. With more of them, it is faster to make a
/// slice ready, and to find the ends of what its rows reach.
const FEW: u64 = 8;

/// Most poses that are decided together, which are kept with their coordinates.
const MOST: u64 = 1024;

/// A thread's working memory for poses that are decided together.
pub struct Together<'a> {
    ranges: Ranges,
    reach: Reach<'a>,
    /// Decides by the clearance, if there is one.
    clear: Option<Box<ClearPoses<'a>>>,
    /// The first two coordinates that vary, if there are so many.
    varying: [usize; 2],
    /// Their values in a tile.
    values: [Vec<f64>; 2],
    /// The numbers of the present pose's coordinates, and their values.
    digits: Vec<u64>,
    pose: Vec<f64>,
    /// Poses that are decided together, one after the other.
    poses: Vec<f64>,
    reached: Vec<bool>,
    /// Those of them that are left.
    kept: Vec<f64>,
    runs: Vec<Run>,
    first: Vec<f64>,
}

impl<'a> Sweep<'a> {
    /// Working memory for the clearance, if there is one.
    pub(super) fn clear_poses(&self) -> Option<Box<ClearPoses<'a>>> {
        let (limit, mode) = self.clearance?;
        Some(Box::new(ClearPoses::new(self.manipulator, limit, mode)))
    }

    /// Whether poses are decided together, whatever their slices. They are where legs are solved whole, where some task
    /// coordinates follow from those of the grid, or heights of legs from imaginary joints.
    pub(super) fn takes_poses_together(&self) -> bool {
        let manipulator = self.manipulator;
        let tied = manipulator.is_whole()
            || manipulator.shares_limits()
            || !manipulator.dependent_coordinates().is_empty()
            || manipulator.task().shares_height();
        let few = self.side * self.sheets <= FEW / self.grid.row().max(1);
        self.grid.sections() == Sections::Whole
            && (tied || few && manipulator.reach().decides_many())
    }
}

impl<'a> Together<'a> {
    pub fn new(sweep: &Sweep<'a>, ranges: Ranges) -> Self {
        let axes = sweep.grid.axes().len();
        let mut varying = sweep.grid.axes().iter().enumerate().filter(|(_, axis)| axis.count > 1);
        let mut next = || varying.next().map_or(0, |(number, _)| number);
        Self {
            ranges,
            reach: Reach::new(sweep),
            clear: sweep.clear_poses(),
            varying: [next(), next()],
            values: [Vec::new(), Vec::new()],
            digits: vec![0; axes],
            pose: vec![0.0; axes],
            poses: Vec::new(),
            reached: Vec::new(),
            kept: Vec::new(),
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
        self.go_to(sweep, numbers.start);
        let mut next = numbers.start;
        while next < numbers.end {
            let count = self.at_once(sweep, next..numbers.end);
            let some = next..next + count;
            next = some.end;
            self.take(sweep, count);
            self.reached.clear();
            self.reached.resize(count as usize, false);
            let wanted = self.ranges == Ranges::Wanted;
            let mut used = |imaginary: usize, range: [f64; 2]| {
                range.into_iter().for_each(|end| found.widen(imaginary, end));
            };
            let Self { reach, poses, reached, .. } = self;
            if self.clear.is_none() {
                reach.decide(poses, reached, wanted, used);
            } else {
                reach.decide(poses, reached, false, &mut used);
                self.retain_clear(sweep);
                if wanted {
                    // Imaginary joints are taken where the clearance is kept.
                    let Self { reach, kept, reached, .. } = self;
                    let left = reached.iter().filter(|&&reached| reached).count();
                    reach.decide(kept, &mut vec![false; left], true, used);
                }
            }
            found.poses += count;
            found.reachable += self.reached.iter().filter(|&&reached| reached).count() as u64;
            if let Some(hit) = hit {
                self.hand_over(sweep, some.start, hit);
            }
        }
    }

    /// The number of the first of some poses that are decided together: those of some rows or of a part of one; as many
    /// as make a tile, if there is a clearance.
    fn at_once(&self, sweep: &Sweep<'_>, numbers: Range<u64>) -> u64 {
        let count = numbers.end - numbers.start;
        if self.clear.is_none() {
            let of_row = sweep.grid.row();
            let most = MOST - MOST % of_row;
            let rest = of_row - numbers.start % of_row;
            return count.min(if most > 0 { most } else { rest.min(MOST) });
        }
        let [along, across] = self.counts(sweep);
        let (pose, tile) = (numbers.start, along * across);
        if pose % along > 0 {
            // Up to the end of a row of the tile.
            return count.min(along - pose % along);
        }
        // Up to the end of the tile, in whole rows of it.
        let most = (tile - pose % tile).min(count).min(BLOCK.max(along));
        let whole = most - most % along;
        if whole > 0 { whole } else { count }
    }

    /// How many values the first two coordinates have that vary.
    fn counts(&self, sweep: &Sweep<'_>) -> [u64; 2] {
        let axes = sweep.grid.axes();
        let [along, across] = self.varying;
        [axes[along].count, if across > along { axes[across].count } else { 1 }]
    }

    /// Leaves those of the reached poses that keep the clearance.
    fn retain_clear(&mut self, sweep: &Sweep<'_>) {
        let Self { clear: Some(clear), poses, reached, kept, values, varying, .. } = self else {
            return;
        };
        let width = sweep.grid.axes().len();
        let along = sweep.grid.axes()[varying[0]].count as usize;
        let columns = along.min(reached.len());
        let [first, second] = values;
        first.clear();
        first.extend(poses.chunks(width).take(columns).map(|pose| pose[varying[0]]));
        second.clear();
        second.extend(poses.chunks(columns * width).map(|row| row[varying[1]]));
        if second.len() < 2 {
            second.clear();
        }
        clear.retain_tile(&Tile { axes: *varying, first, second }, &poses[..width], reached);
        kept.clear();
        let left = poses.chunks(width).zip(reached).filter(|(_, left)| **left);
        left.for_each(|(pose, _)| kept.extend_from_slice(pose));
    }

    /// Hands over the reached poses, row by row. They begin with the pose that has this number.
    fn hand_over(&mut self, sweep: &Sweep<'_>, first: u64, hit: &mut dyn FnMut(&Hits<'_>)) {
        let (width, of_row) = (self.pose.len(), sweep.grid.row());
        let (row, from) = (first / of_row, first % of_row);
        // The poses are those of whole rows, or of a part of one.
        let count = (of_row - from) as usize;
        let of_rows = self.reached.chunks(count).zip(self.poses.chunks(count * width));
        for (row, (reached, poses)) in (row..).zip(of_rows) {
            self.runs.clear();
            self.first.clear();
            for (number, pose) in poses.chunks(width).enumerate().filter(|(i, _)| reached[*i]) {
                runs::push(&mut self.runs, from + number as u64);
                self.first.push(pose[0]);
            }
            if !self.runs.is_empty() {
                let slice = row / (sweep.side * sweep.sheets);
                let (runs, first, others) = (&self.runs, &self.first, &poses[1..width]);
                hit(&Hits { slice, row, runs, first, others });
            }
        }
    }

    /// Goes to a pose of the grid.
    fn go_to(&mut self, sweep: &Sweep<'_>, mut number: u64) {
        for ((axis, digit), value) in
            sweep.grid.axes().iter().zip(&mut self.digits).zip(&mut self.pose)
        {
            *digit = number % axis.count;
            *value = axis.value(*digit);
            number /= axis.count;
        }
    }

    /// Takes some poses from the present one on, and goes on to the next.
    fn take(&mut self, sweep: &Sweep<'_>, count: u64) {
        let (width, along) = (self.pose.len(), self.varying[0]);
        let axis = &sweep.grid.axes()[along];
        self.poses.resize(count as usize * width, 0.0);
        let mut rest = &mut self.poses[..];
        while !rest.is_empty() {
            let first = self.digits[along];
            let last = axis.count.min(first + (rest.len() / width) as u64);
            let (poses, others) = rest.split_at_mut((last - first) as usize * width);
            rest = others;
            for (number, &value) in self.pose.iter().enumerate() {
                poses[number..].iter_mut().step_by(width).for_each(|to| *to = value);
            }
            for (to, digit) in poses[along..].iter_mut().step_by(width).zip(first..last) {
                *to = axis.value(digit);
            }
            advance(sweep, last - first, &mut self.digits, &mut self.pose, along);
        }
    }
}

/// Goes on by so many values of coordinate number `along`, up to its last one at most, and from there to the first pose with
/// the next value of the following coordinate.
fn advance(sweep: &Sweep<'_>, by: u64, digits: &mut [u64], pose: &mut [f64], along: usize) {
    let mut by = by;
    for (number, axis) in sweep.grid.axes().iter().enumerate().skip(along) {
        digits[number] += by;
        let carries = digits[number] == axis.count;
        if carries {
            digits[number] = 0;
        }
        pose[number] = axis.value(digits[number]);
        if !carries {
            break;
        }
        by = 1;
    }
}
