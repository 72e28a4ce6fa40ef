//! A thread's working memory: one sheet of the grid, and the rows of it that are being decided.

use super::cuts::{Begin, Common, Cut, Cuts, Fit, Rows};
use super::pieces::Changes;
use super::runs::{self, Run};
use super::spans::Spans;
use super::{Count, Hits, Sweep};
use crate::condition::Conditioned;
use crate::grid::{Sections, fill};
use opm_core::chain::equation::Span;
use opm_core::chain::region::Region;
use opm_core::manipulator::{Breaks, Follow};
use pulp::Arch;
use std::cell::OnceCell;
use std::ops::Range;

/// One way in which a leg can follow the present sheet.
#[derive(Clone, Debug)]
struct Way {
    follow: Follow,
    /// Where it does, if that is a region of the plane.
    region: Option<Region>,
    /// How rows are cut from it, if they can be.
    fit: Option<Fit>,
    /// What else tells where it does, if anything but asking does; found when first needed.
    breaks: OnceCell<Option<Breaks>>,
    /// No reachable pose has used it yet.
    pending: bool,
}

impl Way {
    /// What rows are cut from.
    fn cut(&self) -> Option<(&Region, &Fit)> {
        self.region.as_ref().zip(self.fit.as_ref())
    }
}

/// A thread's working memory. A sheet is a set of poses that share all coordinates but the lower
/// section's first two; a slice consists of sheets.
pub struct Scratch<'a> {
    sweep: &'a Sweep<'a>,
    slice: Option<u64>,
    sheet: u64,
    /// Number of the sheet's first row.
    row: u64,
    /// Every leg's upper section closes in this slice.
    pub alive: bool,
    legs: Vec<Vec<Way>>,
    found: Vec<Follow>,
    /// Of the poses that this thread found.
    spans: Spans,
    /// Every leg has one way, and that a region.
    plain: bool,
    /// Number of the sheet, of any slice, that regions which are the same in every slice were taken in.
    shaped: Option<u64>,
    /// A row's step, and the largest number of the grid, in steps.
    step: f64,
    extent: f64,
    /// From a row to the next, in steps.
    row_step: f64,
    /// The rows that are being decided, how far they are from the sheet's first, in steps.
    rows: Rows,
    /// What the legs have in common there which follow alike in every slice, where all are `plain`.
    begun: Common,
    /// Which rows these are: of what sheet, what window of them, and whether all legs are `plain`.
    begun_at: Option<(u64, Range<u64>, Run, bool)>,
    /// Of all legs together where they are `plain`, else of each way of every leg, in their order.
    cuts: Vec<Cuts>,
    /// All coordinates but the first.
    others: Vec<f64>,
    /// Where each of them follows in the present row, if its leg is not decided by cuts.
    followed: Vec<Vec<Run>>,
    changes: Changes,
    /// Reachable poses of the present row, and what they are made from.
    runs: Vec<Run>,
    union: Vec<Run>,
    next_runs: Vec<Run>,
    hits: Vec<f64>,
    /// The window that rows were last decided in, and the first coordinates of its poses.
    window: Run,
    values: Vec<f64>,
    limit: Option<Conditioned<'a>>,
    pose: Vec<f64>,
    arch: Arch,
}

impl<'a> Scratch<'a> {
    pub fn new(sweep: &'a Sweep<'a>) -> Self {
        let manipulator = sweep.manipulator;
        let axes = sweep.grid.axes();
        let reach = |i: usize| axes[i].min.abs().max(axes[i].max.abs());
        let planar = sweep.grid.lower() > 1;
        let plane = if planar { reach(0).max(reach(1)) } else { reach(0) };
        let step = match axes[0].count {
            // A row of one pose: any step will do that is no smaller than the numbers.
            1 if plane > 0.0 => plane,
            1 => 1.0,
            count => (axes[0].max - axes[0].min) / (count - 1) as f64,
        };
        let row_step = match &axes[1..] {
            [axis, ..] if planar => (axis.max - axis.min) / (axis.count.max(2) - 1) as f64,
            _ => 0.0,
        };
        Self {
            sweep,
            slice: None,
            sheet: 0,
            row: 0,
            alive: false,
            legs: vec![Vec::new(); manipulator.legs()],
            found: Vec::new(),
            spans: Spans::new(manipulator.legs()),
            plain: false,
            shaped: None,
            step,
            extent: plane / step,
            row_step: row_step / step,
            rows: Rows::new(0.0, 0.0, 0, Run { from: 0, to: 0 }),
            begun: Common::new(),
            begun_at: None,
            cuts: Vec::new(),
            // A row of the upper section alone has no first coordinate that could differ.
            others: vec![0.0; axes.len() - usize::from(sweep.grid.lower() > 0)],
            followed: Vec::new(),
            changes: Changes::default(),
            runs: Vec::new(),
            union: Vec::new(),
            next_runs: Vec::new(),
            hits: Vec::new(),
            window: Run { from: 0, to: 0 },
            values: Vec::new(),
            limit: sweep.limit.map(|limit| Conditioned::new(manipulator, limit)),
            pose: vec![0.0; axes.len()],
            arch: Arch::new(),
        }
    }

    /// Solves the upper section for a slice, and takes what it leaves the legs in one of its sheets.
    pub fn enter_sheet(&mut self, slice: u64, sheet: u64) {
        let sweep = self.sweep;
        if self.slice != Some(slice) {
            self.slice = Some(slice);
            self.enter_slice(slice);
        } else if self.sheet == sheet {
            return;
        }
        self.sheet = sheet;
        self.row = (slice * sweep.sheets + sheet) * sweep.side;
        if !self.alive || sweep.grid.sections() == Sections::Upper {
            return;
        }
        let axes = &sweep.grid.axes()[..sweep.grid.lower()];
        // The sheet's first pose, which its regions are seen from.
        let mut first = [0.0; 3];
        for (value, axis) in first.iter_mut().zip(&axes[..axes.len().min(2)]) {
            *value = axis.min;
        }
        if axes.len() > 2 {
            fill(&axes[2..], sheet, &mut first[2..axes.len()]);
            self.others[1..axes.len() - 1].copy_from_slice(&first[2..axes.len()]);
        }
        let v = sweep.manipulator.task().lower(&first[..axes.len()]);
        let (scale, last) = (self.step.recip(), (axes[0].count - 1) as f64);
        let shaped = self.shaped == Some(sheet);
        self.shaped = Some(sheet);
        self.plain = true;
        for ways in &mut self.legs {
            for way in ways.iter_mut() {
                if !(shaped && way.follow.is_alike()) {
                    way.region = sweep.manipulator.region(&way.follow, &v, scale);
                    // Steps may be too small to count in.
                    let region = way.region.as_ref().filter(|_| scale.is_finite());
                    way.fit = region.and_then(|region| Fit::new(region, last, self.extent));
                }
                self.plain &= way.fit.is_some();
            }
            self.plain &= ways.len() == 1;
        }
    }

    fn enter_slice(&mut self, slice: u64) {
        let sweep = self.sweep;
        let lower = sweep.grid.lower();
        let upper = &mut self.others[lower.saturating_sub(1)..];
        fill(&sweep.grid.axes()[lower..], slice, upper);
        let manipulator = sweep.manipulator;
        let mode = sweep.modes.one();
        let b = match sweep.grid.sections() {
            Sections::Lower => None,
            Sections::Whole | Sections::Upper => Some(manipulator.task().upper(upper)),
        };
        self.alive = true;
        for (leg, ways) in self.legs.iter_mut().enumerate() {
            if ways.first().is_some_and(|way| way.follow.is_alike()) {
                continue;
            }
            self.found.clear();
            match &b {
                Some(b) => manipulator.follow(leg, b, mode, &mut self.found),
                None => {
                    let tau = sweep.grid.cut(leg, upper);
                    manipulator.follow_lower(leg, tau, mode, &mut self.found);
                }
            }
            ways.clear();
            ways.extend(self.found.iter().map(|&follow| Way {
                follow,
                region: None,
                fit: None,
                breaks: OnceCell::new(),
                pending: true,
            }));
            self.alive &= !ways.is_empty();
        }
    }

    /// Takes the one pose of a slice of the upper section alone, which closes.
    fn take_slice(&mut self, count: &mut Count, hit: &mut Option<&mut dyn FnMut(&Hits<'_>)>) {
        for way in self.legs.iter().flatten() {
            count.used(self.sweep.manipulator, &way.follow, &mut self.spans);
        }
        count.reachable += 1;
        if let Some(hit) = hit {
            let slice = self.slice.unwrap_or_default();
            let (first, others) = self.others.split_at(1);
            let runs = &[Run { from: 0, to: 1 }];
            hit(&Hits { slice, row: self.row, runs, first, others });
        }
    }

    /// Decides the poses of a window of some of the sheet's rows.
    pub fn decide(
        &mut self,
        mut rows: Range<u64>,
        window: Run,
        found: &mut Count,
        hit: &mut Option<&mut dyn FnMut(&Hits<'_>)>,
    ) {
        let sweep = self.sweep;
        if sweep.grid.sections() == Sections::Upper {
            self.take_slice(found, hit);
            return;
        }
        let axes = sweep.grid.axes();
        let planar = sweep.grid.lower() > 1;
        if hit.is_some() && self.window != window {
            self.window = window;
            self.values.clear();
            self.values.extend((window.from..window.to).map(|pose| axes[0].value(pose)));
        }
        self.cut(&rows, window);
        let mut reachable = 0;
        // Nobody has to know which poses these are.
        let counted = self.plain && hit.is_none() && self.limit.is_none();
        if counted {
            reachable = self.cuts[0].total();
            if !self.cuts[0].unsure() {
                rows.end = rows.start;
            }
        }
        for (i, row) in rows.enumerate() {
            if counted && self.cuts[0].is_counted(i) {
                continue;
            }
            if planar {
                self.others[0] = axes[1].value(row);
            }
            let doubt = self.in_doubt(i);
            let mut count = self.decide_row(i, window, doubt);
            if count > 0 && self.limit.is_some() {
                count = self.limit_row(hit.is_none(), found);
            } else if count > 0 {
                self.settle(i, doubt, found);
            }
            if count == 0 {
                continue;
            }
            reachable += count;
            if let Some(hit) = hit {
                self.hits.clear();
                for &Run { from, to } in &self.runs {
                    let [from, to] = [from, to].map(|pose| (pose - window.from) as usize);
                    self.hits.extend_from_slice(&self.values[from..to]);
                }
                let slice = self.slice.unwrap_or_default();
                let (runs, first, others) = (&self.runs[..], &self.hits[..], &self.others[..]);
                hit(&Hits { slice, row: self.row + row, runs, first, others });
            }
        }
        if counted && reachable > 0 {
            for way in self.legs.iter_mut().flatten() {
                if std::mem::take(&mut way.pending) {
                    found.used(sweep.manipulator, &way.follow, &mut self.spans);
                }
            }
        }
        found.reachable += reachable;
    }

    /// Cuts a window of some rows from what are regions of the plane.
    fn cut(&mut self, rows: &Range<u64>, window: Run) {
        let here = Some((self.sheet, rows.clone(), window, self.plain));
        if self.begun_at != here {
            self.begun_at = here;
            // To within the rounding that the cuts allow for.
            let (first, count) = (self.row_step * rows.start as f64, rows.end - rows.start);
            self.rows = Rows::new(first, self.row_step, count as usize, window);
            let alike =
                self.legs.iter().flatten().filter(|way| self.plain && way.follow.is_alike());
            let (regions, rows, common) = (alike.filter_map(Way::cut), &self.rows, &mut self.begun);
            self.arch.dispatch(Begin { regions, rows, common });
        }
        let ways = self.legs.iter().map(Vec::len).sum();
        self.cuts.resize_with(ways, Cuts::new);
        self.followed.resize_with(ways, Vec::new);
        let (all, rows, begun) = (self.legs.iter().flatten(), &self.rows, &self.begun);
        if self.plain {
            let regions = all.clone().filter(|way| !way.follow.is_alike()).filter_map(Way::cut);
            let (holes, cuts) = (all.filter_map(Way::cut), &mut self.cuts[0]);
            self.arch.dispatch(Cut { rows, begun, regions, holes, cuts });
        } else {
            for (cuts, way) in self.cuts.iter_mut().zip(all) {
                let cut = way.cut().into_iter();
                self.arch.dispatch(Cut { rows, begun, regions: cut.clone(), holes: cut, cuts });
            }
        }
    }

    /// Anything that was cut is too close to call in row number `i`.
    fn in_doubt(&self, i: usize) -> bool {
        let cuts = if self.plain { &self.cuts[..1] } else { &self.cuts[..] };
        cuts.iter().any(|cuts| cuts.in_doubt(i))
    }

    /// The reachable poses of row number `i`, in `runs`; returns how many they are. Legs of which all
    /// ways are cut come first, where the row is not in doubt, and leave the others fewer poses to ask
    /// for.
    fn decide_row(&mut self, i: usize, window: Run, doubt: bool) -> u64 {
        self.runs.clear();
        if self.plain && !doubt {
            self.runs.extend(self.cuts[0].runs(i));
            return self.runs.iter().map(|run| run.to - run.from).sum();
        }
        self.runs.push(window);
        let mut first = 0;
        for leg in 0..self.legs.len() {
            let ways = self.legs[leg].len();
            if !doubt && is_cut(&self.legs[leg]) {
                let all = self.cuts[first..first + ways].iter().flat_map(|cuts| cuts.runs(i));
                runs::union(all, &mut self.union);
                self.keep_union();
            }
            first += ways;
        }
        first = 0;
        for leg in 0..self.legs.len() {
            let ways = self.legs[leg].len();
            if (doubt || !is_cut(&self.legs[leg])) && !self.runs.is_empty() {
                for way in 0..ways {
                    self.follow_row(leg, way, window, first + way);
                }
                let all = self.followed[first..first + ways].iter().flatten();
                runs::union(all.copied(), &mut self.union);
                self.keep_union();
            }
            first += ways;
        }
        self.runs.iter().map(|run| run.to - run.from).sum()
    }

    fn keep_union(&mut self) {
        runs::intersection(&self.runs, &self.union, &mut self.next_runs);
        std::mem::swap(&mut self.runs, &mut self.next_runs);
    }

    /// Where in the present row one way follows, among the poses that are left.
    fn follow_row(&mut self, leg: usize, way: usize, window: Run, number: usize) {
        let sweep = self.sweep;
        let manipulator = sweep.manipulator;
        let lower = sweep.grid.lower();
        let axis = &sweep.grid.axes()[0];
        let Way { follow, breaks, .. } = &self.legs[leg][way];
        let others = &self.others[..lower - 1];
        self.changes.clear();
        // One pose is asked for.
        let several = window.to - window.from > 1;
        let breaks = several.then(|| breaks.get_or_init(|| manipulator.breaks(follow)).as_ref());
        match breaks.flatten() {
            Some(breaks) => {
                let step = self.step;
                let (from, to) = (axis.value(window.from) - step, axis.value(window.to - 1) + step);
                let span = Span { from, to, step };
                manipulator.changes((follow, breaks), others, &span, &mut |ends| {
                    self.changes.add(ends.map(|end| (end - axis.min) / step), self.extent);
                });
            }
            None => self.changes.add_all(window),
        }
        let mut pose = [0.0; 3];
        pose[1..lower].copy_from_slice(others);
        let follows = |i: u64| {
            pose[0] = axis.value(i);
            manipulator.follows(follow, &manipulator.task().lower(&pose[..lower]))
        };
        self.changes.decide(&self.runs, follows, &mut self.followed[number]);
    }

    /// Keeps those of the row's reachable poses that are conditioned well enough, and takes (`ranges`)
    /// the imaginary joints of the modes in which they are; returns how many are left.
    fn limit_row(&mut self, ranges: bool, found: &mut Count) -> u64 {
        let Some(limit) = &mut self.limit else { return 0 };
        let axis = &self.sweep.grid.axes()[0];
        self.pose[1..].copy_from_slice(&self.others);
        self.next_runs.clear();
        for number in runs::poses(&self.runs) {
            self.pose[0] = axis.value(number);
            let admitted = limit.any(&self.pose, self.sweep.modes, |solution| {
                if ranges {
                    let values = solution.imaginary().iter().enumerate();
                    values.for_each(|(imaginary, &value)| found.widen(imaginary, value));
                }
                ranges
            });
            if admitted {
                runs::push(&mut self.next_runs, number);
            }
        }
        std::mem::swap(&mut self.runs, &mut self.next_runs);
        self.runs.iter().map(|run| run.to - run.from).sum()
    }

    /// Takes the imaginary joints of the ways that reach any of the row's poses, which are in `runs`.
    fn settle(&mut self, i: usize, doubt: bool, found: &mut Count) {
        let mut number = 0;
        for ways in &mut self.legs {
            let (alone, cut) = (ways.len() == 1, !doubt && is_cut(ways));
            for way in ways {
                let reached = |run: Run| runs::meet(&self.runs, run);
                let used = way.pending
                    && (alone
                        || if cut {
                            self.cuts[number].runs(i).any(reached)
                        } else {
                            self.followed[number].iter().copied().any(reached)
                        });
                if used {
                    found.used(self.sweep.manipulator, &way.follow, &mut self.spans);
                    way.pending = false;
                }
                number += 1;
            }
        }
    }
}

/// All ways are regions of the plane.
fn is_cut(ways: &[Way]) -> bool {
    ways.iter().all(|way| way.fit.is_some())
}
