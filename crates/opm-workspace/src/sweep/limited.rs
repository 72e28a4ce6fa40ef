//! Poses of rows that are held against a limit on the condition number, those of several rows together.

use super::runs::Run;
use super::{Count, Sweep};
use crate::condition::{Conditioned, PoseLimit};
use opm_core::manipulator::Manipulator;
use opm_core::reach::AT_ONCE;

/// A thread's working memory for poses that are held against a limit.
pub struct LimitedRows<'a> {
    conditioned: Conditioned<'a>,
    /// Poses that are decided together, row after row.
    poses: Vec<f64>,
    /// Whether each pose is admitted, in their order.
    admitted: Vec<bool>,
    /// The number of answers that were taken.
    taken: usize,
    /// Whether imaginary joints are asked for.
    ranges: bool,
}

impl<'a> LimitedRows<'a> {
    pub fn new(manipulator: &'a Manipulator, limit: PoseLimit) -> Self {
        let conditioned = Conditioned::new(manipulator, limit);
        Self { conditioned, poses: Vec::new(), admitted: Vec::new(), taken: 0, ranges: false }
    }

    /// Begins with new rows. If `ranges` are wanted, the imaginary joints are taken in every mode in which a pose is
    /// admitted.
    pub fn begin(&mut self, ranges: bool) {
        self.poses.clear();
        self.admitted.clear();
        (self.taken, self.ranges) = (0, ranges);
    }

    /// Adds poses of a row, which has these other coordinates.
    pub fn add(
        &mut self,
        sweep: &Sweep<'_>,
        runs: impl Iterator<Item = Run>,
        others: &[f64],
        found: &mut Count,
    ) {
        let axis = &sweep.grid.axes()[0];
        for number in runs.flat_map(|run| run.from..run.to) {
            self.poses.push(axis.value(number));
            self.poses.extend_from_slice(others);
            if self.poses.len() == AT_ONCE * (1 + others.len()) {
                self.decide(sweep, found);
            }
        }
    }

    /// Decides the poses that were added last.
    pub fn decide(&mut self, sweep: &Sweep<'_>, found: &mut Count) {
        let mut conditions = [0.0; AT_ONCE];
        let conditions = &mut conditions[..self.poses.len() / sweep.grid.axes().len()];
        let mut used = |imaginary: usize, range: [f64; 2]| {
            range.into_iter().for_each(|end| found.widen(imaginary, end));
        };
        let used: Option<&mut dyn FnMut(usize, [f64; 2])> =
            if self.ranges { Some(&mut used) } else { None };
        self.conditioned.decide(&self.poses, sweep.modes, conditions, used);
        self.admitted.extend(conditions.iter().map(|condition| !condition.is_nan()));
        self.poses.clear();
    }

    /// Whether the next pose is admitted, in the order in which they were added.
    pub fn next(&mut self) -> bool {
        self.taken += 1;
        self.admitted[self.taken - 1]
    }
}
