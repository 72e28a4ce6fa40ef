//! A sheet of the grid: what the upper section leaves each leg there.

use super::Sweep;
use super::clip::ClipPlan;
use crate::grid::{Axis, Sections, fill};
use opm_core::Section;
use opm_core::chain::region::Region;
use opm_core::group::Displacement;
use opm_core::manipulator::Manipulator;
use opm_core::reach::{LegBranch, Reach, Transitions};
use std::cell::OnceCell;

/// One branch of a leg in the present sheet: one way in which it can follow.
#[derive(Clone, Debug)]
pub struct SliceBranch {
    pub follow: LegBranch,
    /// The poses that it reaches at most, if they are a region of the plane and meet `links`.
    region: Option<Region>,
    /// Whether its lower section moves in a sphere, and its middle joint limits what it reaches to arcs of rows.
    arcs: bool,
    /// Whether nothing else limits what it reaches.
    decided: bool,
    /// How rows are clipped to the region, if they can be.
    plan: Option<ClipPlan>,
    /// The regions that limits on a link leave, and how rows are clipped to them.
    links: Vec<(Region, ClipPlan)>,
    /// Where along rows its feasibility changes, if that has a closed form; found when first needed.
    pub transitions: OnceCell<Option<Transitions>>,
    /// No reachable pose has used it yet.
    pub unused: bool,
}

impl SliceBranch {
    fn new(follow: LegBranch) -> Self {
        Self {
            follow,
            region: None,
            arcs: false,
            decided: false,
            plan: None,
            links: vec![],
            transitions: OnceCell::new(),
            unused: true,
        }
    }

    /// The region that rows are clipped to, if they can be, without those of links.
    pub fn clipped_to(&self) -> Option<(&Region, &ClipPlan)> {
        self.region.as_ref().zip(self.plan.as_ref())
    }

    /// The regions of links that rows are clipped to as well.
    pub fn links(&self) -> &[(Region, ClipPlan)] {
        &self.links
    }

    /// Whether rows can be clipped to its regions.
    pub fn is_clippable(&self) -> bool {
        self.plan.is_some()
    }

    /// Whether what it reaches of rows is limited by arcs.
    pub fn has_arcs(&self) -> bool {
        self.arcs
    }

    /// Whether rows that are clipped to its regions are what it reaches.
    pub fn is_decided(&self) -> bool {
        self.plan.is_some() && self.decided
    }

    /// Whether what its arcs leave of rows is what it reaches.
    pub fn is_decided_by_arcs(&self) -> bool {
        self.arcs && self.decided
    }

    /// Finds its regions in a sheet whose first pose has the displacement `v`.
    #[inline(always)]
    fn find_regions(&mut self, reach: Reach<'_>, v: &Displacement, scale: &RowScale, last: f64) {
        let per_unit = scale.step.recip();
        self.region = reach.region(&self.follow, v, per_unit);
        self.decided = reach.regions_decide(&self.follow);
        self.arcs = reach.has_arcs(&self.follow);
        // Steps may be too small to count in.
        let region = self.region.as_ref().filter(|_| per_unit.is_finite());
        self.plan = region.and_then(|region| ClipPlan::new(region, last, scale.extent));
        self.links.clear();
        let Self { follow, plan, links, .. } = self;
        reach.link_regions(follow, v, per_unit, |region| {
            match ClipPlan::new(&region, last, scale.extent) {
                Some(of_link) => links.push((region, of_link)),
                None => *plan = None,
            }
        });
        if plan.is_none() {
            links.clear();
        }
    }
}

/// How the rows of a sheet are decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SheetKind {
    /// The upper section of some leg does not close: no pose is reachable.
    Unreachable,
    /// Every leg has one branch, and that is what regions have in common: rows are clipped to all regions together.
    Regions,
    /// Every leg has one branch, and its regions contain what that reaches: rows are clipped to all regions together, and
    /// legs are asked for what is left.
    Bounds,
    /// Some leg has several branches, or one without regions: branches are decided one by one.
    Branches,
}

impl SheetKind {
    /// Whether rows are clipped to the regions of all legs together.
    pub fn clips_together(self) -> bool {
        matches!(self, Self::Regions | Self::Bounds)
    }
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
    /// The manipulator at the sheet's height, and that height, metres, where lifts lean.
    raised: Option<(f64, Manipulator)>,
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
    /// The regions of links of all legs, in a sheet whose rows are clipped to all regions together.
    pub links: Vec<(Region, ClipPlan)>,
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
            raised: None,
            slice: None,
            number: 0,
            first_row: 0,
            kind: SheetKind::Unreachable,
            open: false,
            legs: vec![Vec::new(); legs],
            // A row of the upper section alone has no first coordinate that could differ.
            others: vec![0.0; grid.axes().len() - usize::from(grid.lower() > 0)],
            scale: RowScale::new(grid.axes(), grid.lower() > 1),
            links: Vec::new(),
            fixed_regions_of: None,
            found: Vec::new(),
        }
    }

    /// The number of the slice.
    pub fn slice(&self) -> u64 {
        self.slice.unwrap_or_default()
    }

    /// What the manipulator is asked, at the sheet's height where lifts lean.
    pub fn reach(&self) -> Reach<'_> {
        reach_at(self.sweep, &self.raised)
    }

    /// Goes to a height above home, metres, if the section has one. Returns whether the lifts admit it, and the legs have
    /// closed forms there.
    fn rise_to(&mut self, rise: Option<f64>) -> bool {
        let Some(rise) = rise else { return true };
        let manipulator = self.sweep.manipulator;
        if !manipulator.reach().lifts_admit(rise) {
            return false;
        }
        let known = |(at, _): &(f64, Manipulator)| *at == rise;
        if manipulator.lifts_straight() || self.raised.as_ref().is_some_and(known) {
            return true;
        }
        self.raised = manipulator.reach().raised(rise).map(|raised| (rise, raised));
        // Places where feasibility changes belong to the chains of one height.
        for branch in self.legs.iter_mut().flatten() {
            branch.transitions.take();
        }
        self.raised.is_some()
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
        fill(&sweep.grid.axes()[lower..], slice, &mut self.others[first..]);
        self.open = true;
        let task = sweep.manipulator.task();
        let whole = sweep.grid.sections() != Sections::Lower;
        if whole && !self.rise_to(task.rise_in(Section::Upper, &self.others[first..])) {
            self.open = false;
            self.kind = SheetKind::Unreachable;
            return;
        }
        let reach = reach_at(sweep, &self.raised);
        let mode = sweep.modes.one();
        let upper = &self.others[first..];
        let b = whole.then(|| task.upper(upper));
        self.kind = SheetKind::Branches;
        for (leg, branches) in self.legs.iter_mut().enumerate() {
            if branches.first().is_some_and(|branch| branch.follow.is_independent_of_slice()) {
                continue;
            }
            self.found.clear();
            match &b {
                Some(b) => reach.leg_branches(leg, b, mode, &mut self.found),
                None => {
                    let tau = sweep.grid.cut(leg, upper);
                    reach.lower_leg_branches(leg, tau, mode, &mut self.found);
                }
            }
            branches.clear();
            branches.extend(self.found.iter().copied().map(SliceBranch::new));
            self.open &= !branches.is_empty();
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
        let task = sweep.manipulator.task();
        if !self.rise_to(task.rise_in(Section::Lower, &first[..axes.len()])) {
            self.kind = SheetKind::Unreachable;
            return;
        }
        let reach = reach_at(sweep, &self.raised);
        let v = task.lower(&first[..axes.len()]);
        let last = (axes[0].count - 1) as f64;
        let fixed_are_known = self.fixed_regions_of == Some(self.number);
        self.fixed_regions_of = Some(self.number);
        self.kind = SheetKind::Regions;
        for branches in &mut self.legs {
            for branch in branches.iter_mut() {
                if !(fixed_are_known && branch.follow.is_independent_of_slice()) {
                    branch.find_regions(reach, &v, &self.scale, last);
                }
                if !branch.is_clippable() {
                    self.kind = SheetKind::Branches;
                } else if !branch.is_decided() && self.kind == SheetKind::Regions {
                    self.kind = SheetKind::Bounds;
                }
            }
            if branches.len() != 1 {
                self.kind = SheetKind::Branches;
            }
        }
        self.links.clear();
        if self.kind.clips_together() {
            for branch in self.legs.iter().flatten().filter(|branch| !branch.links.is_empty()) {
                self.links.extend_from_slice(&branch.links);
            }
        }
    }
}

/// What the manipulator of a sweep is asked, as it is at a height where lifts lean.
fn reach_at<'m>(sweep: &Sweep<'m>, raised: &'m Option<(f64, Manipulator)>) -> Reach<'m> {
    raised.as_ref().map_or(sweep.manipulator, |(_, raised)| raised).reach()
}
