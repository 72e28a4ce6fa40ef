//! A sheet of the grid: what the upper section leaves each leg there.

use super::Sweep;
use super::clip::ClipPlan;
use crate::grid::{Axis, Sections, fill};
use opm_core::Section;
use opm_core::chain::region::Region;
use opm_core::manipulator::{LegBranch, Transitions};
use std::cell::OnceCell;

/// One branch of a leg in the present sheet: one way in which it can follow.
#[derive(Clone, Debug)]
pub struct SliceBranch {
    pub follow: LegBranch,
    /// The poses that it reaches, if they are a region of the plane.
    region: Option<Region>,
    /// How rows are clipped to the region, if they can be.
    plan: Option<ClipPlan>,
    /// Where along rows its feasibility changes, if that has a closed form; found when first needed.
    pub transitions: OnceCell<Option<Transitions>>,
    /// No reachable pose has used it yet.
    pub unused: bool,
}

impl SliceBranch {
    fn new(follow: LegBranch) -> Self {
        Self { follow, region: None, plan: None, transitions: OnceCell::new(), unused: true }
    }

    /// The region that rows are clipped to, if they can be.
    pub fn clipped_to(&self) -> Option<(&Region, &ClipPlan)> {
        self.region.as_ref().zip(self.plan.as_ref())
    }

    /// Whether rows can be clipped to its region.
    pub fn is_clippable(&self) -> bool {
        self.plan.is_some()
    }
}

/// How the rows of a sheet are decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetKind {
    /// The upper section of some leg does not close: no pose is reachable.
    Unreachable,
    /// Every leg has one branch, and that is a region: rows are clipped to all regions together.
    Regions,
    /// Some leg has several branches, or one that is no region: branches are decided one by one.
    Branches,
    /// Some task coordinates follow from those of the grid, or chains depend on the height: poses are decided one by
    /// one.
    Single,
}

/// The lengths of rows, in the units in which they are clipped.
#[derive(Clone, Copy, Debug)]
pub struct RowScale {
    /// The distance between neighbouring poses of a row, in the unit of the first coordinate.
    pub step: f64,
    /// The largest coordinate in the plane of the grid, in steps.
    pub extent: f64,
    /// The distance between neighbouring rows, in steps.
    pub row_step: f64,
}

impl RowScale {
    fn new(axes: &[Axis], planar: bool) -> Self {
        let reach = |i: usize| axes[i].min.abs().max(axes[i].max.abs());
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
        Self { step, extent: plane / step, row_step: row_step / step }
    }
}

/// The sheet that a thread is in: a set of poses that share all coordinates but the lower section's first
/// two. A slice consists of sheets.
pub struct Sheet<'a> {
    sweep: &'a Sweep<'a>,
    /// The number of the slice, once there is one.
    slice: Option<u64>,
    /// The number of the sheet in its slice.
    pub number: u64,
    /// The number of the sheet's first row.
    pub first_row: u64,
    pub kind: SheetKind,
    /// Whether every leg has a branch in the slice, so that a sheet of it may have reachable poses.
    open: bool,
    /// The branches of every leg.
    pub legs: Vec<Vec<SliceBranch>>,
    /// All coordinates but the first.
    pub others: Vec<f64>,
    pub scale: RowScale,
    /// The number, in any slice, of the sheet for which regions were found that are the same in every slice.
    fixed_regions_of: Option<u64>,
    /// Working memory for branches.
    found: Vec<LegBranch>,
}

impl<'a> Sheet<'a> {
    pub fn new(sweep: &'a Sweep<'a>) -> Self {
        let grid = sweep.grid;
        let legs = sweep.manipulator.legs();
        Self {
            sweep,
            slice: None,
            number: 0,
            first_row: 0,
            kind: SheetKind::Unreachable,
            open: false,
            legs: vec![Vec::new(); legs],
            // A row of the upper section alone has no first coordinate that could differ.
            others: vec![0.0; grid.axes().len() - usize::from(grid.lower() > 0)],
            scale: RowScale::new(grid.axes(), grid.lower() > 1),
            fixed_regions_of: None,
            found: Vec::new(),
        }
    }

    /// The number of the slice.
    pub fn slice(&self) -> u64 {
        self.slice.unwrap_or_default()
    }

    /// The branches of all legs, one after the other.
    pub fn branches(&self) -> impl Iterator<Item = &SliceBranch> + Clone {
        self.legs.iter().flatten()
    }

    /// Goes to a sheet of a slice: solves the upper section where the slice is another one, and finds what it
    /// leaves the legs in the sheet.
    pub fn enter(&mut self, slice: u64, number: u64) {
        let sweep = self.sweep;
        if self.slice != Some(slice) {
            self.slice = Some(slice);
            self.enter_slice(slice);
        } else if self.number == number {
            return;
        }
        self.number = number;
        self.first_row = (slice * sweep.sheets + number) * sweep.side;
        let alone = sweep.grid.sections() == Sections::Upper;
        if self.open && !alone {
            self.find_regions();
        }
    }

    /// Finds the branches of all legs in a slice.
    fn enter_slice(&mut self, slice: u64) {
        let sweep = self.sweep;
        let lower = sweep.grid.lower();
        let first = lower.saturating_sub(1);
        let upper = &mut self.others[first..];
        fill(&sweep.grid.axes()[lower..], slice, upper);
        let manipulator = sweep.manipulator;
        self.open = true;
        if !manipulator.dependent_coordinates().is_empty()
            || !manipulator.lifts_straight()
            || manipulator.shares_height()
        {
            self.kind = SheetKind::Single;
            return;
        }
        let mode = sweep.modes.one();
        let b = match sweep.grid.sections() {
            Sections::Lower => None,
            Sections::Whole | Sections::Upper => Some(manipulator.task().upper(upper)),
        };
        self.kind = SheetKind::Branches;
        for (leg, branches) in self.legs.iter_mut().enumerate() {
            if branches.first().is_some_and(|branch| branch.follow.is_independent_of_slice()) {
                continue;
            }
            self.found.clear();
            match &b {
                Some(b) => manipulator.leg_branches(leg, b, mode, &mut self.found),
                None => {
                    let tau = sweep.grid.cut(leg, upper);
                    manipulator.lower_leg_branches(leg, tau, mode, &mut self.found);
                }
            }
            branches.clear();
            branches.extend(self.found.iter().copied().map(SliceBranch::new));
            self.open &= !branches.is_empty();
        }
        if sweep.grid.sections() != Sections::Lower {
            self.open &= manipulator.height_admitted(Section::Upper, &self.others[first..]);
        }
        if !self.open {
            self.kind = SheetKind::Unreachable;
        }
    }

    /// Finds the regions that the branches reach in this sheet.
    fn find_regions(&mut self) {
        let sweep = self.sweep;
        let axes = &sweep.grid.axes()[..sweep.grid.lower()];
        // The sheet's first pose, which its regions are seen from.
        let mut first = [0.0; 4];
        for (value, axis) in first.iter_mut().zip(&axes[..axes.len().min(2)]) {
            *value = axis.min;
        }
        if axes.len() > 2 {
            fill(&axes[2..], self.number, &mut first[2..axes.len()]);
            self.others[1..axes.len() - 1].copy_from_slice(&first[2..axes.len()]);
        }
        if self.kind == SheetKind::Single {
            return;
        }
        if !sweep.manipulator.height_admitted(Section::Lower, &first[..axes.len()]) {
            self.kind = SheetKind::Unreachable;
            return;
        }
        let v = sweep.manipulator.task().lower(&first[..axes.len()]);
        let (scale, last) = (self.scale.step.recip(), (axes[0].count - 1) as f64);
        let fixed_are_known = self.fixed_regions_of == Some(self.number);
        self.fixed_regions_of = Some(self.number);
        self.kind = SheetKind::Regions;
        for branches in &mut self.legs {
            for branch in branches.iter_mut() {
                if !(fixed_are_known && branch.follow.is_independent_of_slice()) {
                    branch.region = sweep.manipulator.region(&branch.follow, &v, scale);
                    // Steps may be too small to count in.
                    let region = branch.region.as_ref().filter(|_| scale.is_finite());
                    branch.plan =
                        region.and_then(|region| ClipPlan::new(region, last, self.scale.extent));
                }
                if branch.plan.is_none() {
                    self.kind = SheetKind::Branches;
                }
            }
            if branches.len() != 1 {
                self.kind = SheetKind::Branches;
            }
        }
    }
}
