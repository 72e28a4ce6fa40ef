//! A thread's working memory: one sheet of the grid, and the rows of it that are being decided.

use super::clip::{Clip, ClippedRows, Intersect, Intersection, RowState, Rows};
use super::known_range::KnownRanges;
use super::row::Row;
use super::runs::{self, Run};
use super::sheet::{Sheet, SheetKind, SliceBranch};
use super::together::Together;
use super::{Count, Hits, Modes, Sweep};
use crate::condition::Conditioned;
use crate::grid::{Axis, Sections};
use opm_core::manipulator::{AllModes, Solution};
use pulp::Arch;
use std::ops::Range;

/// Who takes the reachable poses, if anybody does.
pub type Visitor<'v> = Option<&'v mut dyn FnMut(&Hits<'_>)>;

/// A thread of a sweep with its working memory.
pub struct Worker<'a> {
    sweep: &'a Sweep<'a>,
    pub sheet: Sheet<'a>,
    clipping: Clipping,
    row: Row,
    hits: HitPoses,
    limit: Option<LimitedRow<'a>>,
    one: OnePose,
    together: Option<Together>,
    /// The angles of imaginary joints over the poses that this thread found.
    known: KnownRanges,
}

/// Rows that are being clipped.
struct Clipping {
    rows: Rows,
    /// The intersection of the regions that are the same in every slice.
    shared: Intersection,
    /// What `rows` and `shared` belong to.
    shared_of: Option<(u64, Range<u64>, Run, SheetKind)>,
    /// The rows clipped to all legs together in a sheet of [`SheetKind::Regions`], else to each branch of
    /// every leg, in their order.
    clipped: Vec<ClippedRows>,
    arch: Arch,
}

/// The first coordinates of poses, as they are handed over.
struct HitPoses {
    /// The window of the rows that `values` belongs to.
    window: Run,
    /// The first coordinates of all poses of the window.
    values: Vec<f64>,
    /// The first coordinates of the reachable ones.
    hits: Vec<f64>,
}

/// A pose that is decided by itself, and buffers for its solutions.
struct OnePose {
    pose: Vec<f64>,
    all: AllModes,
    solution: Solution,
}

/// Poses of a row that are held against the limit on the condition number.
struct LimitedRow<'a> {
    conditioned: Conditioned<'a>,
    pose: Vec<f64>,
}

impl Clipping {
    fn new() -> Self {
        Self {
            rows: Rows::none(),
            shared: Intersection::new(),
            shared_of: None,
            clipped: Vec::new(),
            arch: Arch::new(),
        }
    }

    /// Clips a window of some rows of a sheet to its regions.
    fn clip(&mut self, sheet: &Sheet<'_>, numbers: &Range<u64>, window: Run) {
        let regions = sheet.kind == SheetKind::Regions;
        let here = Some((sheet.number, numbers.clone(), window, sheet.kind));
        if self.shared_of != here {
            self.shared_of = here;
            // To within the rounding that clipping allows for.
            let row_step = sheet.scale.row_step;
            let (first, count) = (row_step * numbers.start as f64, numbers.end - numbers.start);
            self.rows = Rows::new(first, row_step, count as usize, window);
            let fixed = sheet
                .branches()
                .filter(|branch| regions && branch.follow.is_independent_of_slice());
            let (rows, intersection) = (&self.rows, &mut self.shared);
            let regions = fixed.filter_map(SliceBranch::clipped_to);
            self.arch.dispatch(Intersect { regions, rows, intersection });
        }
        let branches = sheet.legs.iter().map(Vec::len).sum();
        self.clipped.resize_with(branches, ClippedRows::new);
        let (rows, begun) = (&self.rows, &self.shared);
        if regions {
            let moving = sheet.branches().filter(|branch| !branch.follow.is_independent_of_slice());
            let regions = moving.filter_map(SliceBranch::clipped_to);
            let with_holes = sheet.branches().filter_map(SliceBranch::clipped_to);
            let (links, clipped) = (&*sheet.links, &mut self.clipped[0]);
            self.arch.dispatch(Clip { rows, begun, regions, with_holes, links, clipped });
        } else {
            for (clipped, branch) in self.clipped.iter_mut().zip(sheet.branches()) {
                let regions = branch.clipped_to().into_iter();
                let (with_holes, links) = (regions.clone(), branch.links());
                self.arch.dispatch(Clip { rows, begun, regions, with_holes, links, clipped });
            }
        }
    }

    /// Whether any answer in row number `i` is too close to call.
    fn in_doubt(&self, kind: SheetKind, i: usize) -> bool {
        let clipped = if kind == SheetKind::Regions { &self.clipped[..1] } else { &self.clipped };
        clipped.iter().any(|clipped| clipped.state(i) == RowState::Doubtful)
    }
}

impl<'a> Worker<'a> {
    pub fn new(sweep: &'a Sweep<'a>) -> Self {
        let manipulator = sweep.manipulator;
        let pose = || vec![0.0; sweep.grid.axes().len()];
        let limited =
            |limit| LimitedRow { conditioned: Conditioned::new(manipulator, limit), pose: pose() };
        Self {
            sweep,
            sheet: Sheet::new(sweep),
            clipping: Clipping::new(),
            row: Row::default(),
            hits: HitPoses { window: Run { from: 0, to: 0 }, values: vec![], hits: vec![] },
            limit: sweep.limit.map(limited),
            one: OnePose {
                pose: pose(),
                all: manipulator.all_modes(),
                solution: manipulator.solution(),
            },
            together: None,
            known: KnownRanges::new(manipulator.legs()),
        }
    }

    /// Decides all poses of some rows, where slices have few of them.
    pub fn together(&mut self, rows: Range<u64>, found: &mut Count, hit: &mut Visitor<'_>) {
        let sweep = self.sweep;
        self.together.get_or_insert_with(|| Together::new(sweep)).decide(sweep, rows, found, hit);
    }

    /// Takes the one pose of a slice of the upper section alone, which closes.
    fn take_slice(&mut self, found: &mut Count, hit: &mut Visitor<'_>) {
        for branch in self.sheet.branches() {
            found.used(self.sweep.manipulator, &branch.follow, &mut self.known);
        }
        found.reachable += 1;
        if let Some(hit) = hit {
            let (first, others) = self.sheet.others.split_at(1);
            let (slice, row) = (self.sheet.slice(), self.sheet.first_row);
            hit(&Hits { slice, row, runs: &[Run { from: 0, to: 1 }], first, others });
        }
    }

    /// Decides the poses of a window of some of the sheet's rows.
    pub fn decide(
        &mut self,
        numbers: Range<u64>,
        window: Run,
        found: &mut Count,
        hit: &mut Visitor<'_>,
    ) {
        let sweep = self.sweep;
        if sweep.grid.sections() == Sections::Upper {
            self.take_slice(found, hit);
            return;
        }
        if self.sheet.kind == SheetKind::Single {
            for number in numbers {
                found.reachable += self.decide_poses(number, window, found, hit);
            }
            return;
        }
        self.clipping.clip(&self.sheet, &numbers, window);
        // Nobody has to know which poses these are.
        let count_alone =
            self.sheet.kind == SheetKind::Regions && hit.is_none() && self.limit.is_none();
        let mut reachable = 0;
        if count_alone {
            reachable += self.clipping.clipped[0].total();
            if !self.clipping.clipped[0].all_counted() {
                for (i, number) in numbers.enumerate() {
                    if self.clipping.clipped[0].state(i) != RowState::Counted {
                        reachable += self.decide_row((i, number), window, found, hit);
                    }
                }
            }
            if reachable > 0 {
                for branch in self.sheet.legs.iter_mut().flatten() {
                    if std::mem::take(&mut branch.unused) {
                        found.used(sweep.manipulator, &branch.follow, &mut self.known);
                    }
                }
            }
        } else {
            for (i, number) in numbers.enumerate() {
                reachable += self.decide_row((i, number), window, found, hit);
            }
        }
        found.reachable += reachable;
    }

    /// Decides row number `i` of those that were clipped, which is row `number` of the sheet. Returns how many
    /// of its poses are reachable.
    fn decide_row(
        &mut self,
        (i, number): (usize, u64),
        window: Run,
        found: &mut Count,
        hit: &mut Visitor<'_>,
    ) -> u64 {
        let grid = self.sweep.grid;
        if grid.lower() > 1 {
            self.sheet.others[0] = grid.axes()[1].value(number);
        }
        let doubt = self.clipping.in_doubt(self.sheet.kind, i);
        let clipped = &self.clipping.clipped;
        let mut count = if self.sheet.kind == SheetKind::Regions && !doubt {
            self.row.take(clipped[0].runs(i))
        } else {
            self.row.decide(self.sweep, &self.sheet, (i, clipped, doubt), window)
        };
        if count == 0 {
            return 0;
        }
        if self.limit.is_some() {
            count = self.limit_row(hit.is_none(), found);
        } else {
            self.use_branches(i, doubt, found);
        }
        self.hand_over(number, window, hit);
        count
    }

    /// Hands over the reachable poses of row `number` of the sheet, if there are any.
    fn hand_over(&mut self, number: u64, window: Run, hit: &mut Visitor<'_>) {
        if self.row.reached.is_empty() {
            return;
        }
        if let Some(hit) = hit {
            let first = self.hits.of(&self.sweep.grid.axes()[0], window, &self.row.reached);
            let (slice, row) = (self.sheet.slice(), self.sheet.first_row + number);
            hit(&Hits { slice, row, runs: &self.row.reached, first, others: &self.sheet.others });
        }
    }

    /// Decides the poses of row `number` of the sheet one by one. Returns how many of them are reachable.
    fn decide_poses(
        &mut self,
        number: u64,
        window: Run,
        found: &mut Count,
        hit: &mut Visitor<'_>,
    ) -> u64 {
        let axes = self.sweep.grid.axes();
        if self.sweep.grid.lower() > 1 {
            self.sheet.others[0] = axes[1].value(number);
        }
        self.row.take(std::iter::once(window));
        let count = if self.limit.is_some() {
            self.limit_row(hit.is_none(), found)
        } else {
            let (manipulator, ranges) = (self.sweep.manipulator, hit.is_none());
            let modes = self.sweep.modes;
            let OnePose { pose, all, solution } = &mut self.one;
            pose[1..].copy_from_slice(&self.sheet.others);
            self.row.retain(|number| {
                pose[0] = axes[0].value(number);
                let mut used = |imaginary: usize, value: f64| {
                    if ranges {
                        found.widen(imaginary, value);
                    }
                };
                match modes {
                    Modes::One(mode) => match manipulator.inverse(pose, mode, solution) {
                        Ok(Some(solution)) if solution.within_limits() => {
                            let values = solution.imaginary().iter().enumerate();
                            values.for_each(|(imaginary, &value)| used(imaginary, value));
                            true
                        }
                        Ok(_) | Err(_) => false,
                    },
                    Modes::Any => match manipulator.inverse_all(pose, all) {
                        Ok(Some(all)) => manipulator.within_limits_in_any(all, used),
                        Ok(None) | Err(_) => false,
                    },
                }
            })
        };
        self.hand_over(number, window, hit);
        count
    }

    /// Keeps those of the row's reachable poses that are conditioned well enough, and takes (`ranges`)
    /// the imaginary joints of the modes in which they are; returns how many are left.
    fn limit_row(&mut self, ranges: bool, found: &mut Count) -> u64 {
        let Some(LimitedRow { conditioned, pose }) = &mut self.limit else { return 0 };
        let axis = &self.sweep.grid.axes()[0];
        pose[1..].copy_from_slice(&self.sheet.others);
        self.row.retain(|number| {
            pose[0] = axis.value(number);
            conditioned.any(pose, self.sweep.modes, |solution| {
                if ranges {
                    let values = solution.imaginary().iter().enumerate();
                    values.for_each(|(imaginary, &value)| found.widen(imaginary, value));
                }
                ranges
            })
        })
    }

    /// Takes the imaginary joints of the branches that reach any of the row's poses.
    fn use_branches(&mut self, i: usize, doubt: bool, found: &mut Count) {
        let mut number = 0;
        for branches in &mut self.sheet.legs {
            let (alone, clipped) = (branches.len() == 1, !doubt && are_clippable(branches));
            for branch in branches {
                let reached = |run: Run| runs::meet(&self.row.reached, run);
                let used = branch.unused
                    && (alone
                        || if clipped {
                            self.clipping.clipped[number].runs(i).any(reached)
                        } else {
                            self.row.feasible[number].iter().copied().any(reached)
                        });
                if used {
                    found.used(self.sweep.manipulator, &branch.follow, &mut self.known);
                    branch.unused = false;
                }
                number += 1;
            }
        }
    }
}

impl HitPoses {
    /// The first coordinates of some poses of a window.
    fn of(&mut self, axis: &Axis, window: Run, runs: &[Run]) -> &[f64] {
        if self.window != window {
            self.window = window;
            self.values.clear();
            self.values.extend((window.from..window.to).map(|pose| axis.value(pose)));
        }
        self.hits.clear();
        for &Run { from, to } in runs {
            let [from, to] = [from, to].map(|pose| (pose - window.from) as usize);
            self.hits.extend_from_slice(&self.values[from..to]);
        }
        &self.hits
    }
}

/// Whether rows can be clipped to all branches of a leg.
pub fn are_clippable(branches: &[SliceBranch]) -> bool {
    branches.iter().all(SliceBranch::is_clippable)
}
