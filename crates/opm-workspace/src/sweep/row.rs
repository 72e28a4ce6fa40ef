//! The reachable poses of one row, leg by leg.

use super::Sweep;
use super::clip::ClippedRows;
use super::runs::{self, Run};
use super::sheet::{Sheet, SliceBranch};
use super::transitions::Transitions;
use super::worker::are_clippable;
use opm_core::chain::equation::Span;

/// The row that is being decided, and what it is decided from.
#[derive(Default)]
pub struct Row {
    /// The reachable poses, as far as legs were asked.
    pub reached: Vec<Run>,
    /// The feasible poses of each branch of every leg, in their order, where its leg is not clipped.
    pub feasible: Vec<Vec<Run>>,
    transitions: Transitions,
    /// The poses that any branch of a leg reaches.
    union: Vec<Run>,
    /// The next value of `reached`.
    next: Vec<Run>,
}

impl Row {
    /// Takes these poses for the reachable ones; returns how many they are.
    pub fn take(&mut self, runs: impl Iterator<Item = Run>) -> u64 {
        self.reached.clear();
        self.reached.extend(runs);
        self.count()
    }

    /// Decides a window of row number `i` of those that were clipped. Legs of which all branches are `clipped`
    /// come first, where the row is not in doubt, and leave the others fewer poses to ask for. Returns how
    /// many poses are reachable.
    pub fn decide(
        &mut self,
        sweep: &Sweep<'_>,
        sheet: &Sheet<'_>,
        (i, clipped, doubt): (usize, &[ClippedRows], bool),
        window: Run,
    ) -> u64 {
        self.reached.clear();
        self.reached.push(window);
        self.feasible.resize_with(clipped.len(), Vec::new);
        let mut first = 0;
        for branches in &sheet.legs {
            if !doubt && are_clippable(branches) {
                let clipped = &clipped[first..first + branches.len()];
                runs::union(clipped.iter().flat_map(|rows| rows.runs(i)), &mut self.union);
                self.keep_union();
            }
            first += branches.len();
        }
        first = 0;
        for branches in &sheet.legs {
            if (doubt || !are_clippable(branches)) && !self.reached.is_empty() {
                for (branch, number) in branches.iter().zip(first..) {
                    self.decide_branch(sweep, sheet, (branch, number), window);
                }
                let all = self.feasible[first..first + branches.len()].iter().flatten();
                runs::union(all.copied(), &mut self.union);
                self.keep_union();
            }
            first += branches.len();
        }
        self.count()
    }

    /// Keeps the reachable poses that are also `admitted`; returns how many they are.
    pub fn retain(&mut self, mut admitted: impl FnMut(u64) -> bool) -> u64 {
        self.next.clear();
        for number in runs::poses(&self.reached) {
            if admitted(number) {
                runs::push(&mut self.next, number);
            }
        }
        std::mem::swap(&mut self.reached, &mut self.next);
        self.count()
    }

    fn count(&self) -> u64 {
        self.reached.iter().map(|run| run.to - run.from).sum()
    }

    fn keep_union(&mut self) {
        runs::intersection(&self.reached, &self.union, &mut self.next);
        std::mem::swap(&mut self.reached, &mut self.next);
    }

    /// Finds where in the row one branch is feasible, among the poses that are left.
    fn decide_branch(
        &mut self,
        sweep: &Sweep<'_>,
        sheet: &Sheet<'_>,
        (branch, number): (&SliceBranch, usize),
        window: Run,
    ) {
        let manipulator = sheet.manipulator();
        let lower = sweep.grid.lower();
        let axis = &sweep.grid.axes()[0];
        let SliceBranch { follow, transitions, .. } = branch;
        let others = &sheet.others[..lower - 1];
        self.transitions.clear();
        // A pose alone is asked for.
        let several = window.to - window.from > 1;
        let known =
            several.then(|| transitions.get_or_init(|| manipulator.transitions(follow)).as_ref());
        match known.flatten() {
            Some(known) => {
                let step = sheet.scale.step;
                let (from, to) = (axis.value(window.from) - step, axis.value(window.to - 1) + step);
                let span = Span { from, to, step };
                manipulator.feasibility_changes(follow, known, others, &span, &mut |ends| {
                    let ends = ends.map(|end| (end - axis.min) / step);
                    self.transitions.add(ends, sheet.scale.extent);
                });
            }
            None => self.transitions.add_all(window),
        }
        let mut pose = [0.0; 4];
        pose[1..lower].copy_from_slice(others);
        let feasible = |i: u64| {
            pose[0] = axis.value(i);
            manipulator.reaches(follow, &manipulator.task().lower(&pose[..lower]))
        };
        self.transitions.decide(&self.reached, feasible, &mut self.feasible[number]);
    }
}
