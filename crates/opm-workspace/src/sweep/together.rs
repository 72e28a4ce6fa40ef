//! Slices of few poses: poses of many slices are decided together.

use super::clear::ClearPoses;
use super::runs::{self, Run};
use super::worker::{Ranges, Visitor};
use super::{Count, Hits, Sweep};
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
    batch: Batch,
    /// Decides by the limit on the condition number, if there is one.
    limited: Option<Conditioned<'a>>,
    /// Decides by the clearance, if there is one.
    clear: Option<Box<ClearPoses<'a>>>,
    /// The numbers of the present pose's coordinates, and their values.
    digits: Vec<u64>,
    pose: Vec<f64>,
    /// Poses that are decided together, one after the other.
    poses: Vec<f64>,
    reached: [bool; Manipulator::DECIDED],
    runs: Vec<Run>,
    first: Vec<f64>,
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
        Self {
            ranges,
            batch: sweep.manipulator.batch(),
            limited: sweep.limit.clone().map(limited),
            clear: sweep.clear_poses(),
            digits: vec![0; axes],
            pose: vec![0.0; axes],
            poses: Vec::new(),
            reached: [false; Manipulator::DECIDED],
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
        let at_once = Manipulator::DECIDED as u64 / row;
        self.go_to(sweep, rows.start * row);
        let mut next = rows.start;
        while next < rows.end {
            let some = next..rows.end.min(next + at_once);
            next = some.end;
            let count = (some.end - some.start) * row;
            self.poses.clear();
            for _ in 0..count {
                self.poses.extend_from_slice(&self.pose);
                self.advance(sweep);
            }
            let reached = &mut self.reached[..count as usize];
            // With a clearance, imaginary joints are taken where it is kept.
            let any = self.clear.is_none();
            let mut used = |imaginary: usize, range: [f64; 2]| {
                range.into_iter().filter(|_| any).for_each(|end| found.widen(imaginary, end));
            };
            match &mut self.limited {
                Some(conditioned) => {
                    let mut conditions = [0.0; Manipulator::DECIDED];
                    let conditions = &mut conditions[..reached.len()];
                    let used: Option<&mut dyn FnMut(usize, [f64; 2])> =
                        if self.ranges == Ranges::Wanted { Some(&mut used) } else { None };
                    conditioned.decide(&self.poses, sweep.modes, conditions, used);
                    let admitted = conditions.iter().map(|condition| !condition.is_nan());
                    reached.iter_mut().zip(admitted).for_each(|(to, admitted)| *to = admitted);
                }
                None => {
                    let (mode, batch) = (sweep.modes.one(), &mut self.batch);
                    sweep.manipulator.decide_many(&self.poses, mode, batch, reached, used);
                }
            }
            if let Some(clear) = &mut self.clear {
                let poses = self.poses.chunks(self.pose.len());
                for (reached, pose) in
                    reached.iter_mut().zip(poses).filter(|(reached, _)| **reached)
                {
                    match clear.at(pose) {
                        Some(imaginary) if self.ranges == Ranges::Wanted => {
                            let values = imaginary.iter().enumerate();
                            values.for_each(|(number, &value)| found.widen(number, value));
                        }
                        Some(_) => {}
                        None => *reached = false,
                    }
                }
            }
            found.poses += count;
            found.reachable += reached.iter().filter(|&&reached| reached).count() as u64;
            if let Some(hit) = hit {
                self.hand_over(sweep, some, hit);
            }
        }
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
