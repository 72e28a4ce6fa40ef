//! Slices of few poses: poses of many slices are decided together.

use super::clear::{ClearPoses, Tile};
use super::runs::{self, Run};
use super::worker::{Ranges, Visitor};
use super::{BLOCK, Count, Hits, Modes, Sweep};
use crate::condition::Conditioned;
use crate::grid::Sections;
use opm_core::manipulator::{Batch, Manipulator};
use std::ops::Range;

/// The most poses of a slice that are decided together with those of other slices. With more of them, it is faster to make a
/// slice ready, and to find the ends of what its rows reach.
const FEW: u64 = 8;

/// A thread's working memory for poses of several slices.
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

/// Decides which poses are in reach, and within the limit if there is one.
struct Reach<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    batch: Batch,
    limited: Option<Conditioned<'a>>,
}

impl Reach<'_> {
    /// Decides some poses, and gives the ranges of imaginary joints in those that are reached, if these are `wanted`.
    fn decide(
        &mut self,
        poses: &[f64],
        reached: &mut [bool],
        wanted: bool,
        mut used: impl FnMut(usize, [f64; 2]),
    ) {
        let width = self.manipulator.task_coordinates().len();
        let poses = poses.chunks(Manipulator::DECIDED * width);
        for (poses, reached) in poses.zip(reached.chunks_mut(Manipulator::DECIDED)) {
            let mut take = |imaginary: usize, range: [f64; 2]| {
                if wanted {
                    used(imaginary, range);
                }
            };
            let Some(conditioned) = &mut self.limited else {
                let (mode, batch) = (self.modes.one(), &mut self.batch);
                self.manipulator.decide_many(poses, mode, batch, reached, take);
                continue;
            };
            let mut conditions = [0.0; Manipulator::DECIDED];
            let conditions = &mut conditions[..reached.len()];
            let used: Option<&mut dyn FnMut(usize, [f64; 2])> =
                if wanted { Some(&mut take) } else { None };
            conditioned.decide(poses, self.modes, conditions, used);
            let admitted = conditions.iter().map(|condition| !condition.is_nan());
            reached.iter_mut().zip(admitted).for_each(|(to, admitted)| *to = admitted);
        }
    }
}

impl<'a> Sweep<'a> {
    /// Working memory for the clearance, if there is one.
    pub(super) fn clear_poses(&self) -> Option<Box<ClearPoses<'a>>> {
        let (limit, mode) = self.clearance?;
        Some(Box::new(ClearPoses::new(self.manipulator, limit, mode)))
    }

    /// Whether poses of several slices are decided together.
    pub(super) fn takes_slices_together(&self) -> bool {
        self.grid.sections() == Sections::Whole
            && self.manipulator.decides_many()
            && self.side * self.sheets <= FEW / self.grid.row().max(1)
    }
}

impl<'a> Together<'a> {
    pub fn new(sweep: &Sweep<'a>, ranges: Ranges) -> Self {
        let axes = sweep.grid.axes().len();
        let limited = |limit| Conditioned::new(sweep.manipulator, limit);
        let mut varying = sweep.grid.axes().iter().enumerate().filter(|(_, axis)| axis.count > 1);
        let mut next = || varying.next().map_or(0, |(number, _)| number);
        Self {
            ranges,
            reach: Reach {
                manipulator: sweep.manipulator,
                modes: sweep.modes,
                batch: sweep.manipulator.batch(),
                limited: sweep.limit.clone().map(limited),
            },
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

    /// Decides all poses of some rows.
    pub fn decide(
        &mut self,
        sweep: &Sweep<'_>,
        rows: Range<u64>,
        found: &mut Count,
        hit: &mut Visitor<'_>,
    ) {
        let row = sweep.grid.row();
        self.go_to(sweep, rows.start * row);
        let mut next = rows.start;
        while next < rows.end {
            let some = next..next + self.at_once(sweep, next..rows.end);
            next = some.end;
            let count = (some.end - some.start) * row;
            self.poses.clear();
            for _ in 0..count {
                self.poses.extend_from_slice(&self.pose);
                self.advance(sweep);
            }
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
                self.hand_over(sweep, some, hit);
            }
        }
    }

    /// The number of the first of some rows that are decided together: as many as make a tile, if there is a clearance.
    fn at_once(&self, sweep: &Sweep<'_>, rows: Range<u64>) -> u64 {
        let of_row = sweep.grid.row();
        let count = rows.end - rows.start;
        if self.clear.is_none() {
            return count.min(Manipulator::DECIDED as u64 / of_row);
        }
        let [along, across] = self.counts(sweep);
        let (pose, tile) = (rows.start * of_row, along * across);
        if pose % along > 0 {
            // Up to the end of a row of the tile.
            return count.min((along - pose % along) / of_row);
        }
        // Up to the end of the tile, in whole rows of it.
        let most = (tile - pose % tile).min(count * of_row).min(BLOCK.max(along));
        let whole = most - most % along;
        if whole > 0 { whole / of_row } else { count }
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

    /// Hands over the reached poses of some rows.
    fn hand_over(&mut self, sweep: &Sweep<'_>, rows: Range<u64>, hit: &mut dyn FnMut(&Hits<'_>)) {
        let (width, count) = (self.pose.len(), sweep.grid.row() as usize);
        let of_rows = self.reached.chunks(count).zip(self.poses.chunks(count * width));
        for (row, (reached, poses)) in rows.zip(of_rows) {
            self.runs.clear();
            self.first.clear();
            for (number, pose) in poses.chunks(width).enumerate().filter(|(i, _)| reached[*i]) {
                runs::push(&mut self.runs, number as u64);
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

    /// Goes to the next pose of the grid, and after the last one to the first.
    fn advance(&mut self, sweep: &Sweep<'_>) {
        for ((axis, digit), value) in
            sweep.grid.axes().iter().zip(&mut self.digits).zip(&mut self.pose)
        {
            if axis.count == 1 {
                continue;
            }
            *digit += 1;
            let carries = *digit == axis.count;
            if carries {
                *digit = 0;
            }
            *value = axis.value(*digit);
            if !carries {
                break;
            }
        }
    }
}
