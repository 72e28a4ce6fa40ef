//! Many rows of a sweep at once, for one branch of a leg: near which poses its feasibility may change, and whether it
//! reaches some poses of theirs.
//!
//! In a row all coordinates except the first are fixed. Feasibility changes only on the surfaces of
//! [`Transitions`](super::Transitions), each of which a row meets in at most two places of a period. Between
//! two of them one pose answers for all.

mod arcs;
mod ends;
mod scale;

pub use arcs::RowArcs;
pub use ends::RowEnds;

use super::{LegBranch, Reach};
use crate::group::{Displacement, PlanarDisplacement};
use crate::manipulator::Manipulator;
use crate::manipulator::batch::lanes::{LANES, Lane, Lanes, vectors};
use crate::manipulator::batch::section::{self, FirstOfRows, OfSheet, Side, Step};
use crate::manipulator::batch::{Batch, Block, FEW, Status, columns_of};
use crate::mechanism::leg::Section;
use crate::numeric::angle::MOST_REDUCED;
use pulp::{Simd, WithSimd};
use scale::RowScale;

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
    /// are at most [`AT_ONCE`](super::AT_ONCE).
    pub second: &'a [f64],
    /// The other coordinates of the lower section, radians or metres.
    pub others: &'a [f64],
}

impl Reach<'_> {
    /// Whether a leg reaches poses within its limits, on a branch: [`Reach::reaches`] for each of at most
    /// [`AT_ONCE`](super::AT_ONCE) poses. Their first and their second coordinates are given, and those of the lower section that
    /// they share, radians or metres.
    pub fn reaches_many(
        self,
        branch: &LegBranch,
        [first, second]: [&[f64]; 2],
        others: &[f64],
        batch: &mut Batch,
        reached: &mut [bool],
    ) {
        let (manipulator, task) = (self.manipulator, self.manipulator.task());
        let mut pose = [0.0; 4];
        pose[2..2 + others.len()].copy_from_slice(others);
        let mut one = |lane: usize| {
            [pose[0], pose[1]] = [first[lane], second[lane]];
            self.reaches(branch, &task.lower(&pose[..task.lower_count.max(2)]))
        };
        let large = |value: &f64| value.abs() > 0.5 * MOST_REDUCED;
        let leg = &manipulator.legs[branch.leg];
        let raised = [&leg.lower, &leg.upper].iter().any(|section| section.offset.is_some());
        let large = first.iter().chain(second).chain(others).any(large);
        if reached.len() < FEW || branch.with_upper.is_some() && raised || large {
            for (lane, reached) in reached.iter_mut().enumerate() {
                *reached = one(lane);
            }
            return;
        }
        let Batch { arch, block, .. } = batch;
        block.take_rows(task.lower_count, first, second, others);
        match &branch.with_upper {
            Some(b) => {
                block.displace_only(manipulator, Section::Lower, *arch);
                (0..LANES).for_each(|lane| section::store(b, &mut block.b, lane));
                block.reach(manipulator, branch.leg, branch.branches, *arch);
            }
            None => {
                arch.dispatch(ReachLower { manipulator, branch, count: reached.len(), block });
            }
        }
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

/// Solves the lower section of a branch for a block of poses, with the instructions of the processor at hand.
struct ReachLower<'a> {
    manipulator: &'a Manipulator,
    branch: &'a LegBranch,
    /// The number of poses.
    count: usize,
    block: &'a mut Block,
}

impl WithSimd for ReachLower<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, branch, count, block } = self;
        let lanes = vectors(count);
        block.status = Status::UNKNOWN;
        let leg = &manipulator.legs[branch.leg];
        block.aim(manipulator, branch, Shared::AllButTwo, lanes);
        let Block { shifted, lower, status, .. } = &mut *block;
        let branches = &[branch.branches.lower; LANES];
        section::solve_chain(&leg.lower.chain, branches, shifted, lower, lanes);
        status.note(lower);
        block.admit(manipulator, leg, Section::Lower, lanes);
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
        let home = manipulator.task().coordinates[0].home;
        let firsts = &Lanes::all(home)[..rows.second.len()];
        self.take_rows(manipulator.task().lower_count, firsts, rows.second, rows.others);
        self.aim(manipulator, branch, Shared::AllButSecond, vectors(rows.second.len()));
        // Along a row the first coordinate is a displacement from home.
        RowScale::new(rows, rows.first - home)
    }

    /// Takes poses of a section of so many coordinates: the first and second ones, and those that they share. The remaining
    /// lanes are filled with the last pose.
    fn take_rows(&mut self, width: usize, first: &[f64], second: &[f64], others: &[f64]) {
        self.lanes = LANES;
        for (column, values) in self.pose[..width].iter_mut().zip([first, second]) {
            column[..values.len()].copy_from_slice(values);
            column[values.len()..].fill(values.last().copied().unwrap_or_default());
        }
        for (column, &other) in self.pose[..width].iter_mut().skip(2).zip(others) {
            *column = Lanes::all(other);
        }
    }

    /// Computes the targets of a branch's lower chain, into `shifted`, of so many poses of the block.
    #[inline(always)]
    fn aim(&mut self, manipulator: &Manipulator, branch: &LegBranch, shared: Shared, lanes: usize) {
        let task = manipulator.task();
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
