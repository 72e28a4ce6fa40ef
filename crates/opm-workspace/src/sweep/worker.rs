//! A thread's working memory: one sheet of the grid, and the rows of it that are being decided.

use super::asked::{AskedRows, Clipped};
use super::boxes::Boxes;
use super::clear::ClearPoses;
use super::clip::{Clip, ClippedRows, Intersect, Intersection, ROWS, RowState, Rows};
use super::known_range::KnownRanges;
use super::limited::LimitedRows;
use super::row::DecidedRow;
use super::runs::{self, Run};
use super::sheet::{Sheet, SheetKind, SliceBranch};
use super::together::Together;
use super::{Count, Hits, Sweep};
use crate::grid::{Axis, Sections};
use pulp::Arch;
use std::ops::Range;

/// Who takes the reachable poses, if anybody does.
pub type Visitor<'v> = Option<&'v mut dyn FnMut(&Hits<'_>)>;

/// Whether the ranges of the imaginary joints are taken over every pose that a worker finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ranges {
    Wanted,
    Unused,
}

/// A thread of a sweep with its working memory.
pub struct Worker<'a> {
    sweep: &'a Sweep<'a>,
    ranges: Ranges,
    pub sheet: Sheet<'a>,
    clipping: Clipping,
    row: DecidedRow,
    asked: Option<Box<AskedRows>>,
    /// The poses that the legs reach that are the same in every slice, of the rows of the range.
    fixed: Option<(Range<u64>, Box<AskedRows>)>,
    hits: HitPoses,
    limit: Option<Box<LimitedRows<'a>>>,
    clear: Option<Box<ClearPoses<'a>>>,
    together: Option<Box<Together<'a>>>,
    /// For poses that are decided by boxes.
    boxes: Option<Box<Boxes<'a>>>,
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
    /// The rows clipped to all legs together in a sheet of regions, else to each branch of
    /// every leg, in their order.
    clipped: Vec<ClippedRows>,
    /// What is left of a row, and working memory for it.
    left: Vec<Run>,
    union: Vec<Run>,
    next: Vec<Run>,
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

impl Clipping {
    fn new() -> Self {
        Self {
            rows: Rows::none(),
            shared: Intersection::new(),
            shared_of: None,
            clipped: Vec::new(),
            left: Vec::new(),
            union: Vec::new(),
            next: Vec::new(),
            arch: Arch::new(),
        }
    }

    /// Clips a window of some rows of a sheet to its regions.
    fn clip(&mut self, sheet: &Sheet<'_>, numbers: &Range<u64>, window: Run) {
        let regions = sheet.kind.clips_together();
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

    /// Begins to ask for the rows that were clipped, or those that are not `counted`, with what clipping leaves of them.
    /// Of rows of which `fixed` is known, that is kept.
    fn begin(
        &mut self,
        (sweep, sheet): (&Sweep<'_>, &Sheet<'_>),
        numbers: &Range<u64>,
        window: Run,
        (counted, fixed): (bool, Option<&AskedRows>),
        asked: &mut AskedRows,
    ) {
        asked.begin(sweep, window);
        let Self { left, union, next, .. } = self;
        for (i, number) in numbers.clone().enumerate() {
            if counted && self.clipped[0].state(i) == RowState::Counted {
                continue;
            }
            let doubt = in_doubt(&self.clipped, sheet.kind, i);
            left.clear();
            if doubt || !sheet.kind.clips_together() {
                left.push(window);
            } else {
                left.extend(self.clipped[0].runs(i));
            }
            let mut keep = |runs: &[Run]| {
                runs::intersection(left, runs, next);
                std::mem::swap(left, next);
            };
            if let Some(fixed) = fixed {
                union.clear();
                union.extend(fixed.runs(i));
                keep(union);
            }
            if !doubt && !sheet.kind.clips_together() {
                let mut clipped = &self.clipped[..];
                for branches in &sheet.legs {
                    let (of_leg, others) = clipped.split_at(branches.len());
                    clipped = others;
                    if are_clippable(branches) {
                        runs::union(of_leg.iter().flat_map(|rows| rows.runs(i)), union);
                        keep(union);
                    }
                }
            }
            asked.push(sweep, number, left, if doubt { Clipped::Not } else { Clipped::Surely });
        }
    }
}

/// Whether any answer in row number `i` is too close to call.
fn in_doubt(clipped: &[ClippedRows], kind: SheetKind, i: usize) -> bool {
    let clipped = if kind.clips_together() { &clipped[..1] } else { clipped };
    clipped.iter().any(|clipped| clipped.state(i) == RowState::Doubtful)
}

impl<'a> Worker<'a> {
    pub fn new(sweep: &'a Sweep<'a>, ranges: Ranges) -> Self {
        let manipulator = sweep.manipulator;
        Self {
            sweep,
            ranges,
            sheet: Sheet::new(sweep),
            clipping: Clipping::new(),
            row: DecidedRow::default(),
            asked: None,
            fixed: None,
            hits: HitPoses { window: Run { from: 0, to: 0 }, values: vec![], hits: vec![] },
            limit: sweep.limit.clone().map(|limit| Box::new(LimitedRows::new(manipulator, limit))),
            clear: sweep.clear_poses(),
            together: None,
            boxes: None,
            known: KnownRanges::new(manipulator.legs()),
        }
    }

    /// Decides poses with these numbers, of whole segments of rows, without regard to sheets.
    pub fn together(&mut self, poses: Range<u64>, found: &mut Count, hit: &mut Visitor<'_>) {
        let (sweep, ranges) = (self.sweep, self.ranges);
        let new = || Box::new(Together::new(sweep, ranges));
        let together = self.together.get_or_insert_with(new);
        together.decide(sweep, poses, found, hit);
    }

    /// Decides poses with these numbers, of whole segments of rows, by boxes.
    pub fn boxes(&mut self, poses: Range<u64>, found: &mut Count, hit: &mut Visitor<'_>) {
        let (sweep, ranges) = (self.sweep, self.ranges);
        let boxes = self.boxes.get_or_insert_with(|| Box::new(Boxes::new(sweep, ranges)));
        boxes.decide(sweep, poses, found, hit);
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
        self.clipping.clip(&self.sheet, &numbers, window);
        // Nobody has to know which poses these are.
        let count_alone = hit.is_none() && self.limit.is_none();
        let counted = count_alone && self.clear.is_none() && self.sheet.kind == SheetKind::Regions;
        let mut reachable = 0;
        if counted {
            reachable += self.clipping.clipped[0].total();
        }
        if !(counted && self.clipping.clipped[0].all_counted()) {
            let fixed = self.fixed_rows(&numbers, window);
            let mut asked = self.asked.take().unwrap_or_else(|| AskedRows::new(sweep.manipulator));
            let known = self.fixed.as_ref().filter(|_| fixed).map(|(_, rows)| &**rows);
            let sheet = &self.sheet;
            self.clipping.begin((sweep, sheet), &numbers, window, (counted, known), &mut asked);
            let wanted = |branches: &[SliceBranch]| !(fixed && is_fixed(branches));
            asked.cut_arcs(sweep, sheet, wanted);
            asked.ask(sweep, sheet, wanted);
            if let Some(clear) = &mut self.clear {
                clear.retain(sweep, &mut asked, &self.sheet.others);
            }
            let unused = self.sheet.branches().any(|branch| branch.unused);
            if unused && self.limit.is_none() && asked.count() > 0 {
                self.use_branches(&asked, numbers.start, fixed, found);
            }
            if count_alone {
                reachable += asked.count();
            } else {
                self.limit_rows(&asked, found);
                for place in 0..asked.numbers().len() {
                    reachable += self.take_row(&asked, place, window, hit);
                }
            }
            self.asked = Some(asked);
        }
        if counted && reachable > 0 {
            for branch in self.sheet.legs.iter_mut().flatten() {
                if std::mem::take(&mut branch.unused) {
                    found.used(sweep.manipulator, &branch.follow, &mut self.known);
                }
            }
        }
        found.reachable += reachable;
    }

    /// Finds which poses of some rows the legs reach that are the same in every slice, once for all slices. Returns whether
    /// there are such legs, and slices that have these rows alone.
    fn fixed_rows(&mut self, numbers: &Range<u64>, window: Run) -> bool {
        let (sweep, sheet) = (self.sweep, &self.sheet);
        let same_rows = sweep.sheets == 1 && sweep.segments == 1 && sweep.side <= ROWS as u64;
        let same_legs = sweep.manipulator.lifts_straight();
        let any = sheet.legs.iter().any(|branches| is_fixed(branches));
        if !(same_rows && same_legs && any) {
            return false;
        }
        let (of, asked) =
            self.fixed.get_or_insert_with(|| (0..0, AskedRows::new(sweep.manipulator)));
        if of != numbers {
            of.clone_from(numbers);
            asked.begin(sweep, window);
            for number in numbers.clone() {
                asked.push(sweep, number, &[window], Clipped::Not);
            }
            asked.ask(sweep, sheet, is_fixed);
        }
        true
    }

    /// Takes the imaginary joints of the branches that reach any of the poses that are left of the rows that were asked for.
    /// `first` is the number of the first row that was clipped.
    fn use_branches(&mut self, asked: &AskedRows, first: u64, fixed: bool, found: &mut Count) {
        let mut number = 0;
        for branches in &mut self.sheet.legs {
            let decided = branches.iter().all(SliceBranch::is_decided);
            let known = branches.len() == 1 || fixed && is_fixed(branches);
            for branch in branches {
                let clipped = self.clipping.clipped.get(number);
                let clips = |place: usize| {
                    let i = (asked.numbers()[place] - first) as usize;
                    let mut clipped = clipped.into_iter().flat_map(|clipped| clipped.runs(i));
                    clipped.any(|run| asked.runs(place).any(|other| runs::overlap(run, other)))
                };
                let used = branch.unused
                    && (known
                        || if decided && !asked.any_unclipped() {
                            (0..asked.numbers().len()).any(clips)
                        } else {
                            asked.uses(number)
                        });
                if used {
                    found.used(self.sweep.manipulator, &branch.follow, &mut self.known);
                    branch.unused = false;
                }
                number += 1;
            }
        }
    }

    /// Takes the reachable poses of the row that is number `place` of those that were asked for. Returns how many they are.
    fn take_row(
        &mut self,
        asked: &AskedRows,
        place: usize,
        window: Run,
        hit: &mut Visitor<'_>,
    ) -> u64 {
        let number = asked.numbers()[place];
        let mut count = self.row.take(asked.runs(place));
        if count == 0 {
            return 0;
        }
        self.go_to_row(number);
        if let Some(limit) = &mut self.limit {
            count = self.row.retain(|_| limit.next());
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

    /// Holds the reachable poses of the rows that were asked for against the limit, if there is one, and takes the imaginary
    /// joints of the modes in which they are admitted, if their ranges are wanted.
    fn limit_rows(&mut self, asked: &AskedRows, found: &mut Count) {
        let Some(mut limit) = self.limit.take() else { return };
        limit.begin(self.ranges == Ranges::Wanted);
        for (place, &number) in asked.numbers().iter().enumerate() {
            self.go_to_row(number);
            limit.add(self.sweep, asked.runs(place), &self.sheet.others, found);
        }
        limit.decide(self.sweep, found);
        self.limit = Some(limit);
    }

    /// Goes to row `number` of the sheet: takes its second coordinate.
    fn go_to_row(&mut self, number: u64) {
        let grid = self.sweep.grid;
        if grid.lower() > 1 {
            self.sheet.others[0] = grid.axes()[1].value(number);
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

/// Whether a leg reaches the same poses in every slice, and regions do not tell which.
fn is_fixed(branches: &[SliceBranch]) -> bool {
    branches.iter().all(|branch| branch.follow.is_independent_of_slice() && !branch.is_decided())
}

/// Whether rows can be clipped to all branches of a leg.
pub fn are_clippable(branches: &[SliceBranch]) -> bool {
    branches.iter().all(SliceBranch::is_clippable)
}
