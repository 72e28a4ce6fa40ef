//! Many rows of a sweep at once, for one branch of a leg: near which poses its feasibility may change, and whether it
//! reaches some poses of theirs.
//!
//! In a row all coordinates except the first are fixed. Feasibility changes only on the surfaces of
//! [`transitions`](crate::manipulator::transitions), each of which a row meets in at most two places of a period. Between
//! two of them one pose answers for all.

use super::lanes::{Column, Displacements, LANES, Lane};
use super::section::{self, FirstOfRows, OfSheet, Side, Step};
use super::{Batch, Block, Status, columns_of};
use crate::chain::shell::{self, ArcHole, Shell};
use crate::chain::surface::{Surface, Uncertainty};
use crate::group::{Displacement, Path, PlanarDisplacement, PlanarPath, SubspaceKind};
use crate::manipulator::{LegBranch, Manipulator, Transitions};
use crate::mechanism::leg::Section;
use crate::numeric::angle::MOST_REDUCED;
use pulp::{Simd, WithSimd};
use std::f64::consts::TAU;

/// How near to the end of what a leg reaches a pose may be, in steps, and still be decided by another pose.
const TIE: f64 = 1e-6;

/// Rows that differ in the second coordinate alone, of poses that differ in the first one alone, evenly spaced.
#[derive(Clone, Copy, Debug)]
pub struct SheetRows<'a> {
    /// The first coordinate of the first pose of every row, radians or metres.
    pub first: f64,
    /// The distance between neighbouring poses of a row, radians or metres; not zero.
    pub step: f64,
    /// The number of poses of a row.
    pub count: u64,
    /// The largest number that the coordinates are computed from, in steps.
    pub extent: f64,
    /// The second coordinate of each row, radians or metres; not used where the lower section has one coordinate alone. These
    /// are at most [`Manipulator::DECIDED`].
    pub second: &'a [f64],
    /// The other coordinates of the lower section, radians or metres.
    pub others: &'a [f64],
}

/// For each of some rows, the numbers of poses near which a leg's feasibility may change: from the first one up to, not
/// including, the other one. Where the two are equal, that is between this pose and the one before.
#[derive(Clone, Debug)]
pub struct RowEnds {
    first: Numbers,
    after: Numbers,
}

/// One number of a pose for each row.
type Numbers = [i32; LANES];

/// A number of a pose plus this has the number in its last bits.
const WHOLE: f64 = 4503599627370496.0;

impl RowEnds {
    const NONE: Self = Self { first: [0; LANES], after: [0; LANES] };

    /// All of so many poses of every row.
    pub fn everything(count: u64) -> Self {
        Self { first: [0; LANES], after: [count as i32; LANES] }
    }

    #[inline(always)]
    fn set(&mut self, row: usize, [first, after]: [f64; 2]) {
        self.first[row] = (first + WHOLE).to_bits() as i32;
        self.after[row] = (after + WHOLE).to_bits() as i32;
    }

    /// The numbers of a row.
    #[inline(always)]
    pub fn of(&self, row: usize) -> [i32; 2] {
        [self.first[row], self.after[row]]
    }

    /// Marks the rows of which they cut what is left: the poses `from` up to, not including, `to` of each row.
    #[inline]
    pub fn meet(&self, from: &Numbers, to: &Numbers, marks: &mut Numbers) {
        for row in 0..LANES {
            let cuts = (self.first[row] < to[row]) & (self.after[row] > from[row]);
            marks[row] |= i32::from(cuts);
        }
    }
}

/// What a leg does not reach of some rows of a sphere.
#[derive(Clone, Debug)]
pub struct RowArcs {
    holes: Vec<RowHoles>,
    doubtful: Numbers,
}

/// One hole of each row.
#[derive(Clone, Debug)]
struct RowHoles {
    /// The poses that are certainly out of reach.
    certain: RowEnds,
    /// Those, and poses that rounding could move out of reach.
    possible: RowEnds,
}

impl RowArcs {
    /// Nothing.
    #[expect(clippy::new_without_default, reason = "it is working memory")]
    pub fn new() -> Self {
        Self { holes: Vec::new(), doubtful: [0; LANES] }
    }

    /// The poses of a row that are or may be out of reach, as ranges, in any order. Where a range is empty, that is between its
    /// pose and the one before, and something between them may be out of reach.
    pub fn holes(&self, row: usize) -> impl Iterator<Item = [i32; 2]> + Clone {
        self.holes.iter().map(move |hole| hole.possible.of(row))
    }

    /// Those of them that may be in reach, in any order.
    pub fn doubtful(&self, row: usize) -> impl Iterator<Item = i32> {
        let holes = self.holes.iter().filter(move |_| self.doubtful[row] != 0);
        let possible = holes.flat_map(move |hole| {
            let ([from, to], [first, after]) = (hole.possible.of(row), hole.certain.of(row));
            // Where nothing is certain, both parts meet.
            let (first, after) = if first < after { (first, after) } else { (to, to) };
            (from..first).chain(after..to)
        });
        let is_in = |pose: i32, [from, to]: [i32; 2]| from <= pose && pose < to;
        possible
            .filter(move |&pose| !self.holes.iter().any(|hole| is_in(pose, hole.certain.of(row))))
    }
}

impl Manipulator {
    /// Finds what a leg whose lower section moves in a sphere does not reach of some rows on a branch, whatever its limits of
    /// the first and the last joint. Returns whether the leg is one of which that is known.
    #[doc(hidden)]
    pub fn row_arcs(
        &self,
        branch: &LegBranch,
        rows: &SheetRows<'_>,
        batch: &mut Batch,
        arcs: &mut RowArcs,
    ) -> bool {
        let Some(shell) = self.legs[branch.leg].shell(branch.branches.lower) else { return false };
        let Batch { arch, block, .. } = batch;
        arcs.holes.clear();
        arcs.doubtful = [0; LANES];
        arch.dispatch(FindArcs { manipulator: self, branch, shell, rows, block, arcs });
        true
    }

    /// Finds the poses of some rows near which a leg's feasibility may change. Between them,
    /// [`Manipulator::reaches`] is the same for all poses of a row. With `outer` being false, that is so only among poses
    /// of a convex set of the plane in which the leg closes but for a hole, be it within its limits or not, or of one of
    /// the intervals that [`RowArcs`] leave of a row on a sphere.
    #[doc(hidden)]
    pub fn row_ends(
        &self,
        branch: &LegBranch,
        transitions: &Transitions,
        rows: &SheetRows<'_>,
        outer: bool,
        batch: &mut Batch,
        ends: &mut Vec<RowEnds>,
    ) {
        let Batch { arch, block, .. } = batch;
        ends.clear();
        arch.dispatch(FindEnds {
            manipulator: self,
            branch,
            transitions,
            rows,
            outer,
            block,
            ends,
        });
    }

    /// Whether a leg reaches poses within its limits, on a branch: [`Manipulator::reaches`] for each of at most
    /// [`Manipulator::DECIDED`] poses. Their first and their second coordinates are given, and those of the lower section that
    /// they share, radians or metres.
    #[doc(hidden)]
    pub fn reaches_many(
        &self,
        branch: &LegBranch,
        [first, second]: [&[f64]; 2],
        others: &[f64],
        batch: &mut Batch,
        reached: &mut [bool],
    ) {
        let mut pose = [0.0; 4];
        pose[2..2 + others.len()].copy_from_slice(others);
        let mut one = |lane: usize| {
            [pose[0], pose[1]] = [first[lane], second[lane]];
            self.reaches(branch, &self.task.lower(&pose[..self.task.lower_count.max(2)]))
        };
        let large = |value: &f64| value.abs() > 0.5 * MOST_REDUCED;
        let leg = &self.legs[branch.leg];
        let raised = [&leg.lower, &leg.upper].iter().any(|section| section.offset.is_some());
        let large = first.iter().chain(second).chain(others).any(large);
        if reached.len() < FEW || branch.with_upper.is_some() && raised || large {
            for (lane, reached) in reached.iter_mut().enumerate() {
                *reached = one(lane);
            }
            return;
        }
        let Batch { arch, block, .. } = batch;
        block.take_rows(self.task.lower_count, first, second, others);
        arch.dispatch(Reach { manipulator: self, branch, count: reached.len(), block });
        let Status { beyond, open, within_limits } = &block.status;
        for (lane, reached) in reached.iter_mut().enumerate() {
            *reached = if beyond[lane] == 0 && open[lane] != 0 {
                one(lane)
            } else {
                beyond[lane] == 0 && within_limits[lane] != 0
            };
        }
    }
}

/// Which coordinates of the lower section some poses share.
#[derive(Clone, Copy)]
enum Shared {
    AllButSecond,
    AllButTwo,
}

/// So many lanes, and some more, so that they are whole vectors of every processor.
#[inline(always)]
fn vectors(lanes: usize) -> usize {
    lanes.next_multiple_of(8).min(LANES)
}

/// Fewer poses than this are asked for one by one: it takes longer to begin a block.
const FEW: usize = 6;

/// Solves a branch for a block of poses.
struct Reach<'a> {
    manipulator: &'a Manipulator,
    branch: &'a LegBranch,
    /// The number of poses.
    count: usize,
    block: &'a mut Block,
}

impl WithSimd for Reach<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, branch, count, block } = self;
        let lanes = vectors(count);
        block.status = Status { beyond: [0; LANES], open: [0; LANES], within_limits: [1; LANES] };
        let leg = &manipulator.legs[branch.leg];
        match &branch.with_upper {
            Some(b) => {
                block.displace_section(manipulator, Section::Lower, LANES);
                for lane in 0..LANES {
                    b.store(&mut block.b, lane);
                }
                block.solve_leg(manipulator, branch.branches, branch.leg);
                block.admit(manipulator, leg, Section::Upper, LANES);
            }
            None => {
                block.aim(manipulator, branch, Shared::AllButTwo, lanes);
                let Block { shifted, lower, status, .. } = block;
                let branch = branch.branches.lower;
                section::solve(&leg.lower.chain, branch, shifted, lower, lanes);
                status.note(lower);
            }
        }
        block.admit(manipulator, leg, Section::Lower, lanes);
    }
}

/// Finds the ends of rows.
struct FindEnds<'a> {
    manipulator: &'a Manipulator,
    branch: &'a LegBranch,
    transitions: &'a Transitions,
    rows: &'a SheetRows<'a>,
    outer: bool,
    block: &'a mut Block,
    ends: &'a mut Vec<RowEnds>,
}

/// Finds the arcs of rows.
struct FindArcs<'a> {
    manipulator: &'a Manipulator,
    branch: &'a LegBranch,
    shell: &'a Shell,
    rows: &'a SheetRows<'a>,
    block: &'a mut Block,
    arcs: &'a mut RowArcs,
}

impl WithSimd for FindArcs<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, branch, shell, rows, block, arcs } = self;
        let scale = block.start_rows(manipulator, branch, rows);
        let Path::Spherical { axis, .. } =
            manipulator.task.row(&SubspaceKind::Spherical.identity())
        else {
            return;
        };
        let (tolerance, margin) = (shell.tolerance(), scale.tie / scale.per_step);
        let lanes = vectors(rows.second.len());
        for cone in shell.cones() {
            let Surface::Cone { fixed, carried, cosine } = cone else { return };
            // The coefficients of a function of each row that is positive where the last axis is in the cone.
            let mut along = [[0.0; LANES]; 3];
            let mut any = 0;
            for lane in 0..lanes {
                let path = Path::Spherical { start: Lane::load(&block.shifted, lane), axis };
                let function = Surface::Cone { fixed, carried, cosine }.along(&path).coefficients();
                any |= u64::from(shell::may_have_hole(function, tolerance));
                for (column, coefficient) in along.iter_mut().zip(function) {
                    column[lane] = coefficient;
                }
            }
            if any != 0 {
                let mut found = HoleColumns { inner: [[0.0; LANES]; 2], outer: [[0.0; LANES]; 2] };
                for lane in 0..lanes {
                    let function = along.each_ref().map(|column| column[lane]);
                    found.set(lane, shell::hole(function, tolerance, margin), scale.first);
                }
                arcs.take(&found, &scale, lanes);
            }
        }
    }
}

impl RowArcs {
    /// Takes one hole of each row.
    #[inline(always)]
    fn take(&mut self, found: &HoleColumns, scale: &RowScale, lanes: usize) {
        let HoleColumns { inner, outer } = found;
        // A hole is shorter than a revolution.
        let copies = (scale.length / TAU) as usize + 2;
        for copy in 0..copies {
            let later = copy as f64 * TAU;
            let mut holes = RowHoles { certain: RowEnds::NONE, possible: RowEnds::NONE };
            let mut any = 0;
            for lane in 0..lanes {
                let is_hole = outer[0][lane] <= outer[1][lane];
                let certain = scale.inside([inner[0][lane] + later, inner[1][lane] + later]);
                let possible = scale.inside([outer[0][lane] + later, outer[1][lane] + later]);
                let possible = [
                    if is_hole { possible[0] } else { 0.0 },
                    if is_hole { possible[1] } else { 0.0 },
                ];
                holes.certain.set(lane, certain);
                holes.possible.set(lane, possible);
                let same = (certain[0] == possible[0]) & (certain[1] == possible[1]);
                let empty = possible[1] <= possible[0];
                self.doubtful[lane] |= i32::from(!(same | empty));
                any |= i32::from((possible[0] < scale.count) & (possible[1] > 0.0));
            }
            if any != 0 {
                self.holes.push(holes);
            }
        }
    }
}

/// One hole of each row.
struct HoleColumns {
    inner: [Column; 2],
    outer: [Column; 2],
}

impl HoleColumns {
    /// Stores a hole with the revolutions added that bring its end into the first one after `first`.
    #[inline(always)]
    fn set(&mut self, row: usize, ArcHole { inner, outer }: ArcHole, first: f64) {
        let by = -TAU * ((outer[1] - first) * TAU.recip()).floor();
        (self.inner[0][row], self.inner[1][row]) = (inner[0] + by, inner[1] + by);
        (self.outer[0][row], self.outer[1][row]) = (outer[0] + by, outer[1] + by);
    }
}

impl WithSimd for FindEnds<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, branch, transitions, rows, outer, block, ends } = self;
        let scale = block.start_rows(manipulator, branch, rows);
        let starts = &block.shifted;
        let kind = manipulator.task.form(Section::Lower).kind;
        let path = |lane| manipulator.task.row(&load(kind, starts, lane));
        let reach = scale.first.abs().max((scale.first + scale.length).abs()) + rows.step;
        // The size is a convex function of the second coordinate.
        let size = [0, rows.second.len().saturating_sub(1)].map(|row| path(row).size(reach));
        let size = size[0].max(size[1]);
        let lanes = vectors(rows.second.len());
        let finder = Finder { path: path(0), starts, lanes, scale };
        if !transitions.are_complete(size) {
            return ends.push(RowEnds::everything(rows.count));
        }
        for (surface, blur) in transitions.surfaces(outer) {
            let uncertainty = Uncertainty { size: transitions.size() + size, blur };
            finder.find(surface, surface.tolerance(uncertainty), ends);
        }
    }
}

/// Finds the ends of rows that differ in where their paths start.
struct Finder<'a> {
    /// The path of any of the rows.
    path: Path,
    starts: &'a Displacements,
    /// The number of rows, or more.
    lanes: usize,
    scale: RowScale,
}

/// How the poses of a row follow from the displacement along it.
#[derive(Clone, Copy)]
struct RowScale {
    /// The displacement at the first pose, radians or metres.
    first: f64,
    /// The number of poses in a unit of it.
    per_step: f64,
    /// The displacement from the first to the last pose.
    length: f64,
    /// The number of poses.
    count: f64,
    /// How far an end may be off, in steps.
    tie: f64,
}

impl Finder<'_> {
    /// Finds where the rows meet a surface.
    #[inline(always)]
    fn find(&self, surface: &Surface, tolerance: f64, ends: &mut Vec<RowEnds>) {
        // With a constant kind of path and of surface, the loop over the rows has no branches.
        macro_rules! each {
            ($start:ident => $path:expr, $surface:expr) => {{
                let surface = $surface;
                let function = |$start| surface.along(&$path);
                // It is the same for all rows.
                let first = function(Lane::load(self.starts, 0));
                let Some(repeats) = self.scale.repeats(first.period()) else {
                    return ends.push(RowEnds::everything(self.scale.count as u64));
                };
                let lanes = self.lanes.min(LANES);
                let mut along = [[0.0; LANES]; 3];
                let mut any = 0;
                for lane in 0..lanes {
                    let $start = Lane::load(self.starts, lane);
                    let function = surface.along(&$path);
                    any |= u64::from(function.may_be_zero(tolerance));
                    for (column, coefficient) in along.iter_mut().zip(function.coefficients()) {
                        column[lane] = coefficient;
                    }
                }
                if any == 0 {
                    return;
                }
                for copy in 0..repeats.copies {
                    let (mut near, mut far) = (RowEnds::NONE, RowEnds::NONE);
                    let shift = repeats.shift(copy);
                    for lane in 0..lanes {
                        let function = first.with(along.each_ref().map(|column| column[lane]));
                        let [first, second] = function.near_zeros(tolerance);
                        near.set(lane, self.scale.poses(shift.of(first)));
                        far.set(lane, self.scale.poses(shift.of(second)));
                    }
                    ends.extend([near, far]);
                }
            }};
        }
        match (self.path, *surface) {
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Circle { point, centre, square },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Circle { point, centre, square }
            ),
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Line { point, across, at },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Line { point, across, at }
            ),
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Carried { point, across, at },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Carried { point, across, at }
            ),
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Rotation { rotation },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Rotation { rotation }
            ),
            (Path::Spherical { axis, .. }, Surface::Cone { fixed, carried, cosine }) => each!(
                start => Path::Spherical { start, axis },
                Surface::Cone { fixed, carried, cosine }
            ),
            (
                Path::Cylindrical { rate, .. },
                Surface::Coaxial { rotation, advance, at, period: None },
            ) => each!(
                start => Path::Cylindrical { start, rate },
                Surface::Coaxial { rotation, advance, at, period: None }
            ),
            (
                Path::Cylindrical { rate, .. },
                Surface::Coaxial { rotation, advance, at, period: Some(period) },
            ) => each!(
                start => Path::Cylindrical { start, rate },
                Surface::Coaxial { rotation, advance, at, period: Some(period) }
            ),
            (Path::Translational { rate, .. }, Surface::Band { across, at }) => {
                each!(start => Path::Translational { start, rate }, Surface::Band { across, at });
            }
            (Path::Spatial { rate, .. }, Surface::Slab { across, at }) => {
                each!(start => Path::Spatial { start, rate }, Surface::Slab { across, at });
            }
            (path, surface) => panic!("no rows along {path:?} meet {surface:?}"),
        }
    }
}

/// The share of a period before a row's first pose in which an interval that reaches into the row may begin.
const SLACK: f64 = 0.25;

/// How often the zeros of a function are repeated in a row.
#[derive(Clone, Copy)]
struct Repeats {
    /// How many repetitions of an interval there can be.
    copies: usize,
    /// The period; `None` where nothing is repeated.
    period: Option<f64>,
    /// Where the first one begins at the earliest.
    from: f64,
}

/// What brings an interval to a place in a row.
#[derive(Clone, Copy)]
struct Shift {
    repeats: Repeats,
    /// The number of repetitions after the first.
    copy: f64,
    /// The number of periods in a unit.
    per_period: f64,
}

impl RowScale {
    /// How often a function with this period is repeated; `None` where that is within two poses.
    fn repeats(&self, period: Option<f64>) -> Option<Repeats> {
        let Some(period) = period.filter(|period| period.is_finite()) else {
            return Some(Repeats { copies: 1, period: None, from: 0.0 });
        };
        let copies = (self.length / period + SLACK) as usize + 1;
        let repeats = Repeats { copies, period: Some(period), from: self.first - SLACK * period };
        (period * self.per_step > 2.0).then_some(repeats)
    }

    /// The numbers of the poses in an interval.
    #[inline(always)]
    fn inside(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let first = ((from - self.first) * self.per_step).ceil();
        let after = ((to - self.first) * self.per_step).floor() + 1.0;
        let first = if first > 0.0 { first } else { 0.0 };
        let first = if first < self.count { first } else { self.count };
        let after = if after < self.count { after } else { self.count };
        [first, if after > first { after } else { first }]
    }

    /// The numbers of the poses near an interval.
    #[inline(always)]
    fn poses(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let first = ((from - self.first) * self.per_step - self.tie).ceil();
        let after = ((to - self.first) * self.per_step + self.tie).floor() + 1.0;
        // What is not a number is beyond all poses.
        let first = if first > 0.0 { first } else { 0.0 };
        let first = if first < self.count { first } else { self.count };
        let after = if after < self.count { after } else { self.count };
        let after = if after > first { after } else { first };
        let empty = to < from;
        [if empty { 0.0 } else { first }, if empty { 0.0 } else { after }]
    }
}

impl Repeats {
    fn shift(self, copy: usize) -> Shift {
        let per_period = self.period.unwrap_or(f64::INFINITY).recip();
        Shift { repeats: self, copy: copy as f64, per_period }
    }
}

impl Shift {
    /// The interval shifted by whole periods. One that is longer than the slack becomes everything, and an empty one stays
    /// so.
    #[inline(always)]
    fn of(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let Some(period) = self.repeats.period else { return [from, to] };
        let by = period * (self.copy - ((from - self.repeats.from) * self.per_period).floor());
        let fits = to - from <= SLACK * period;
        let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
        let shifted = [if fits { from + by } else { least }, if fits { to + by } else { most }];
        let empty = to < from;
        [if empty { most } else { shifted[0] }, if empty { least } else { shifted[1] }]
    }
}

impl Block {
    /// Computes where the paths of a branch's target along rows start, into `shifted`.
    #[inline(always)]
    fn start_rows(
        &mut self,
        manipulator: &Manipulator,
        branch: &LegBranch,
        rows: &SheetRows<'_>,
    ) -> RowScale {
        let home = manipulator.task.coordinates[0].home;
        let firsts = &[home; LANES][..rows.second.len()];
        self.take_rows(manipulator.task.lower_count, firsts, rows.second, rows.others);
        self.aim(manipulator, branch, Shared::AllButSecond, vectors(rows.second.len()));
        RowScale {
            // Along a row the first coordinate is a displacement from home.
            first: rows.first - home,
            per_step: rows.step.recip(),
            length: rows.step * (rows.count - 1) as f64,
            count: rows.count as f64,
            tie: TIE.max(rows.extent * 1e-12),
        }
    }

    /// Takes poses of a section of so many coordinates: the first and second ones, and those that they share. The remaining
    /// lanes are filled with the last pose.
    fn take_rows(&mut self, width: usize, first: &[f64], second: &[f64], others: &[f64]) {
        self.upper_lanes = LANES;
        for (column, values) in self.pose[..width].iter_mut().zip([first, second]) {
            column[..values.len()].copy_from_slice(values);
            column[values.len()..].fill(values.last().copied().unwrap_or_default());
        }
        for (column, &other) in self.pose[..width].iter_mut().skip(2).zip(others) {
            *column = [other; LANES];
        }
    }

    /// Computes the targets of a branch's lower chain, into `shifted`, of so many poses of the block.
    #[inline(always)]
    fn aim(&mut self, manipulator: &Manipulator, branch: &LegBranch, shared: Shared, lanes: usize) {
        let Manipulator { task, .. } = manipulator;
        let Self { pose, v, shifted, .. } = self;
        let ([first, second, third], home) = columns_of(task, Section::Lower, pose);
        // A height comes after the first two coordinates.
        debug_assert!(task.height_in(Section::Lower).is_none_or(|place| place >= 2));
        let third = third[0];
        match shared {
            Shared::AllButSecond => {
                let poses = FirstOfRows { first: first[0], second, third };
                section::displace(task, Section::Lower, &poses, home, v, lanes);
            }
            Shared::AllButTwo => {
                let poses = OfSheet { first, second, third };
                section::displace(task, Section::Lower, &poses, home, v, lanes);
            }
        }
        match branch.tau {
            Some(tau) => {
                let step = Step { motion: task.lower_intersection, side: Side::After };
                section::shift(step, v, &tau, shifted, lanes);
            }
            None => shifted.clone_from(v),
        }
        if let Some(Displacement::Planar(offset)) = manipulator.legs[branch.leg].lower.offset {
            for lane in 0..lanes.min(LANES) {
                PlanarDisplacement::load(shifted, lane).after(&offset).store(shifted, lane);
            }
        }
    }
}

/// The displacement of pose number `lane`, in a subspace of this kind.
fn load(kind: SubspaceKind, from: &Displacements, lane: usize) -> Displacement {
    match kind {
        SubspaceKind::Identity => kind.identity(),
        SubspaceKind::Planar => Displacement::Planar(Lane::load(from, lane)),
        SubspaceKind::Spherical => Displacement::Spherical(Lane::load(from, lane)),
        SubspaceKind::Cylindrical => Displacement::Cylindrical(Lane::load(from, lane)),
        SubspaceKind::TranslationalPlane => Displacement::Translational(Lane::load(from, lane)),
        SubspaceKind::TranslationalSpace => Displacement::Spatial(Lane::load(from, lane)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::equation::Equation;
    use proptest::prelude::*;

    const TOLERANCE: f64 = 1e-10;

    fn value(equation: &Equation, t: f64) -> f64 {
        match *equation {
            Equation::Polynomial([c0, c1, c2]) => c0 + t * (c1 + t * c2),
            Equation::Harmonic([c0, c1, c2]) => c0 + c1 * t.cos() + c2 * t.sin(),
            Equation::Periodic([c0, c1], period) => {
                let value = c0 + c1 * t;
                value - period * (value / period).round()
            }
        }
    }

    /// The poses of a row near the zeros of a function.
    fn ends(equation: &Equation, scale: &RowScale) -> Vec<[f64; 2]> {
        let Some(repeats) = scale.repeats(equation.period()) else {
            return vec![[0.0, scale.count]];
        };
        let zeros = equation.near_zeros(TOLERANCE);
        let copies = (0..repeats.copies).map(|copy| repeats.shift(copy));
        copies.flat_map(|shift| zeros.map(|zero| scale.poses(shift.of(zero)))).collect()
    }

    fn row(first: f64, length: f64, count: u32) -> RowScale {
        let step = length / f64::from(count - 1);
        let count = f64::from(count);
        RowScale { first, per_step: step.recip(), length, count, tie: TIE }
    }

    /// Between two ends a function keeps its sign, and only poses at its zeros are near an end.
    fn check(equation: &Equation, scale: &RowScale) {
        let ends = ends(equation, scale);
        let near = |pose: f64| ends.iter().any(|&[first, after]| first <= pose && pose < after);
        let cut = |pose: f64| ends.iter().any(|&[first, after]| first == pose || after == pose);
        let at = |pose: f64| value(equation, scale.first + pose / scale.per_step);
        let mut alone = 0;
        for number in 0..scale.count as u32 {
            let pose = f64::from(number);
            if near(pose) {
                alone += 1;
            } else if number > 0 && !near(pose - 1.0) && !cut(pose) {
                // A periodic line jumps where it is farthest from its zeros.
                let jumps = matches!(equation, Equation::Periodic(_, period)
                    if (at(pose) - at(pose - 1.0)).abs() > 0.5 * period);
                assert!(jumps || at(pose) * at(pose - 1.0) > 0.0, "{equation:?} at {pose}");
            }
        }
        assert!(alone <= 4, "{alone} poses of {equation:?} are asked for one by one: {ends:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn ends_are_where_signs_change(
            c in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0], first in -7.0..7.0_f64,
            length in 0.1..7.0_f64, count in 2..70_u32,
        ) {
            let scale = row(first, length, count);
            for equation in [
                Equation::Polynomial([c[0], c[1], c[2].abs() + 0.1]),
                Equation::Polynomial([c[0], c[1], 0.0]),
                Equation::Harmonic(c),
                Equation::Periodic([c[0], c[1]], 20.0),
            ] {
                check(&equation, &scale);
            }
        }
    }

    /// What has no zeros cuts nothing, not even a row of a full revolution; what is zero everywhere is asked for.
    #[test]
    fn constants_cut_nothing_or_everything() {
        let scale = row(-TAU / 2.0, TAU, 33);
        for c0 in [-1.1, -0.1, 0.1, 1.1] {
            for equation in [
                Equation::Polynomial([c0, 0.0, 0.0]),
                Equation::Polynomial([1.0, c0, 1.0]),
                Equation::Harmonic([c0, 0.0, 0.0]),
                Equation::Harmonic([c0 * 11.0, 0.6, -0.8]),
                Equation::Periodic([c0, 0.0], 3.0),
            ] {
                assert!(ends(&equation, &scale).iter().all(|end| end[0] == end[1]), "{equation:?}");
            }
        }
        for equation in [
            Equation::Polynomial([0.0; 3]),
            Equation::Harmonic([0.0; 3]),
            Equation::Periodic([3.0, 0.0], 3.0),
        ] {
            assert!(ends(&equation, &scale).contains(&[0.0, 33.0]), "{equation:?}");
        }
    }

    /// Zeros on poses, and two zeros that meet on one.
    #[test]
    fn a_pose_at_a_zero_is_asked_for() {
        let scale = row(-1.0, 2.0, 9);
        for (equation, pose) in [
            (Equation::Polynomial([0.0, 1.0, 0.0]), 4.0),
            (Equation::Polynomial([0.25, 1.0, 1.0]), 2.0),
            (Equation::Polynomial([-0.25, 0.0, 1.0]), 6.0),
            (Equation::Harmonic([-1.0, 1.0, 0.0]), 4.0),
            (Equation::Harmonic([0.0, 0.0, 1.0]), 4.0),
            (Equation::Periodic([5.5, 1.0], 5.0), 2.0),
        ] {
            let ends = ends(&equation, &scale);
            assert!(
                ends.iter().any(|end| end[0] <= pose && pose < end[1]),
                "{equation:?}: {ends:?}"
            );
        }
    }
}
