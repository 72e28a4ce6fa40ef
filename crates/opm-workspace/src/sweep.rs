//! The sweep: which poses of a grid are in reach and within the limits.
//!
//! The poses that share the upper section's coordinates are a slice. The upper section is solved once in
//! a slice, and leaves each leg one or several branches, each a set of poses. Where all of them are
//! regions of the plane, whole rows are clipped to them ([`clip`]). Other branches are asked for in pieces
//! of rows, between the places where their feasibility changes ([`asked`]). Where slices have few poses, or tell little of
//! them, poses are decided one after the other ([`together`]); where coordinates of the pose depend on each other, bounds over
//! boxes decide most of them first ([`boxes`]).

mod asked;
mod boxes;
mod clear;
mod clip;
mod known_range;
mod limited;
mod reach;
mod row;
pub(crate) mod runs;
mod shard;
mod sheet;
mod tile;
mod together;
mod worker;

pub use runs::Run;
pub use shard::{Shard, ShardError};

use crate::clearance::{ClearanceError, ClearanceLimit};
use crate::condition::{ConditionError, PoseLimit};
use crate::grid::Grid;
use crate::ordered::in_order;
use crate::progress::{Cancelled, Progress};
use clip::ROWS;
use known_range::KnownRanges;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::reach::LegBranch;
use rayon::prelude::*;
use sheet::SheetKind;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use worker::{Ranges, Visitor, Worker};

/// Poses of a block, which a thread takes at a time. Large grids have larger blocks.
const BLOCK: u64 = 1 << 15;

/// Blocks of a large grid, unless they would be too large. In rows of thousands of poses a block of [`BLOCK`] poses takes less
/// than a microsecond, and to count what is done takes as long.
const BLOCKS: u64 = 1 << 12;

/// Most poses of a block: a request to stop is heard after a block, which is a quarter of a second at a million poses a second.
const LARGEST: u64 = 1 << 18;

/// Most poses of a segment. Longer rows are divided into segments, which are decided one at a time; of shorter rows, many are
/// decided together, in a small part of the time.
const SEGMENT: u64 = BLOCK;

/// The working modes in which a pose counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modes {
    /// A pose counts where this mode reaches it within the limits.
    One(Mode),
    /// A pose counts where any mode reaches it within the limits.
    Any,
}

impl Modes {
    /// The mode, if it is a single one.
    pub fn one(self) -> Option<Mode> {
        match self {
            Self::One(mode) => Some(mode),
            Self::Any => None,
        }
    }
}

/// The result of a sweep, or of one shard of it. In a grid of one section alone a pose is a point of that
/// grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// The number of poses that were decided: those of the grid, or of the shard.
    pub poses: u64,
    /// The number of poses in reach and within all limits.
    pub reachable: u64,
    /// The lowest and highest value of every imaginary joint over the reachable poses, radians or metres,
    /// in the order of [`Manipulator::imaginary`]; `None` where there is no such pose.
    pub imaginary: Vec<Option<[f64; 2]>>,
}

impl Count {
    /// The count of no poses.
    pub fn nothing(manipulator: &Manipulator) -> Self {
        Self { poses: 0, reachable: 0, imaginary: vec![None; manipulator.imaginary().len()] }
    }

    /// The count of both together, which have no pose in common. This is exact: in whatever order
    /// shards are merged, the result is the same to the bit.
    #[must_use]
    pub fn merge(mut self, other: &Self) -> Self {
        self.poses += other.poses;
        self.reachable += other.reachable;
        for (number, range) in other.imaginary.iter().enumerate() {
            for &end in range.iter().flatten() {
                self.widen(number, end);
            }
        }
        self
    }

    /// Widens the range of an imaginary joint to its value in a leg branch, unless that lies between
    /// known values.
    fn used(&mut self, manipulator: &Manipulator, branch: &LegBranch, known: &mut KnownRanges) {
        if known.contain_or_widen(branch) {
            return;
        }
        if let Some((imaginary, value)) = manipulator.reach().imaginary_value(branch) {
            self.widen(imaginary, value);
        }
    }

    fn widen(&mut self, imaginary: usize, value: f64) {
        // This makes a negative zero positive: `min` may confuse the two.
        let value = value + 0.0;
        let range = self.imaginary[imaginary].get_or_insert([value; 2]);
        *range = [range[0].min(value), range[1].max(value)];
    }
}

/// The reachable poses of one segment of a row. They differ in the first coordinate alone.
#[derive(Clone, Copy, Debug)]
pub struct Hits<'a> {
    /// The number of the slice: see [`Grid::slices`].
    pub slice: u64,
    /// The number of the row: the number of any of its poses, divided by [`Grid::row`].
    pub row: u64,
    /// The numbers of the first coordinate's values, ascending and apart.
    pub runs: &'a [Run],
    /// The values of the first coordinate, radians or metres, ascending.
    pub first: &'a [f64],
    /// The other coordinates, radians or metres, in the order of the grid's axes.
    pub others: &'a [f64],
}

impl Hits<'_> {
    /// The numbers of the poses in the grid that was swept.
    pub fn numbers(&self, grid: &Grid) -> impl Iterator<Item = Run> {
        let first = self.row * grid.row();
        self.runs.iter().map(move |run| Run { from: first + run.from, to: first + run.to })
    }
}

/// A sweep of one grid: which of its poses a manipulator reaches within its limits.
///
/// A sweep is cheap to make and to copy. [`Sweep::count`] counts the reachable poses, and
/// [`Sweep::points`] gives each of them. Both work on all threads of the current rayon pool; their
/// results do not depend on how many these are.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Axis, Grid, Modes, Progress, Shard, Sweep};
///
/// let axes = vec![Axis::new("x", -0.3, 0.3, 61), Axis::new("y", -0.3, 0.3, 61)];
/// let grid = Grid::new(&manipulator, axes)?;
/// let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
/// let count = sweep.count(&Progress::default())?;
/// assert_eq!(count.poses, 61 * 61);
///
/// // The counts of shards, made anywhere, add up to that of the whole.
/// let half = |number| Ok::<_, Box<dyn std::error::Error>>(
///     sweep.clone().shard(Shard::new(number, 2)?).count(&Progress::default())?,
/// );
/// assert_eq!(half(1)?.merge(&half(2)?), count);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug)]
pub struct Sweep<'a> {
    manipulator: &'a Manipulator,
    grid: &'a Grid,
    modes: Modes,
    clearance: Option<(ClearanceLimit<'a>, Mode)>,
    limit: Option<PoseLimit>,
    shard: Shard,
    /// The number of segments in a row.
    segments: u64,
    /// The number of segments in a block.
    stride: u64,
    /// The number of rows in a sheet. They differ in the second coordinate alone, if that is one of the
    /// lower section's.
    side: u64,
    /// The number of sheets in a slice.
    sheets: u64,
}

impl<'a> Sweep<'a> {
    /// A sweep of `grid`, which has to be a grid of this manipulator or of one of its sections alone.
    pub fn new(manipulator: &'a Manipulator, grid: &'a Grid, modes: Modes) -> Self {
        let row = grid.row();
        let lower = grid.axes()[..grid.lower()].get(1..).unwrap_or_default();
        let side = lower.first().map_or(1, |axis| axis.count);
        let sheets = lower.iter().skip(1).map(|axis| axis.count).product();
        let segments = row.div_ceil(SEGMENT);
        let block = (grid.poses() / BLOCKS).clamp(BLOCK, LARGEST);
        // Small sheets are not divided: it takes some time to enter one.
        let (stride, sheet) = (block / row.min(SEGMENT), side * segments);
        let stride = if sheet <= stride { stride - stride % sheet } else { stride };
        let (limit, clearance, shard) = (None, None, Shard::WHOLE);
        Self { manipulator, grid, modes, limit, clearance, shard, segments, stride, side, sheets }
    }

    /// The grid that is swept.
    pub fn grid(&self) -> &'a Grid {
        self.grid
    }

    /// The manipulator whose workspace it is.
    pub fn manipulator(&self) -> &'a Manipulator {
        self.manipulator
    }

    /// The working modes in which poses count.
    pub fn modes(&self) -> Modes {
        self.modes
    }

    /// The limit on condition numbers and indices, if there is one.
    pub fn limit(&self) -> Option<&PoseLimit> {
        self.limit.as_ref()
    }

    /// The same sweep without a limit on condition numbers and indices.
    pub(crate) fn without_limit(self) -> Self {
        Self { limit: None, ..self }
    }

    /// The same sweep, but a pose counts only in a working mode in which its condition number is within
    /// `limit`. That is decided for each reachable pose, in a fraction of a microsecond for each mode.
    ///
    /// # Errors
    /// [`ConditionError::Section`] on a grid of one section alone: only the whole mechanism has a condition
    /// number. [`ConditionError::Length`] if the limit's characteristic length is not a positive number.
    pub fn with_limit(self, limit: PoseLimit) -> Result<Self, ConditionError> {
        limit.check(self.manipulator, self.grid)?;
        Ok(Self { limit: Some(limit), ..self })
    }

    /// The same sweep, but a pose counts only if all bodies keep a clearance there. That is decided by bounds over boxes of
    /// poses, and pose by pose only where these do not tell.
    ///
    /// # Errors
    /// [`ClearanceError`]: a grid of one section alone, several working modes, or a clearance that is not a length.
    pub fn with_clearance(self, clearance: ClearanceLimit<'a>) -> Result<Self, ClearanceError> {
        let mode = clearance.check(self.grid, self.modes)?;
        Ok(Self { clearance: Some((clearance, mode)), ..self })
    }

    /// The limit on the distance of bodies, if there is one.
    pub fn clearance(&self) -> Option<ClearanceLimit<'a>> {
        self.clearance.map(|(limit, _)| limit)
    }

    /// The same sweep of one shard of its grid alone. A shard is a number of whole blocks of rows; the
    /// shards' numbers of blocks differ by one at most. The shards' points, one shard after the other,
    /// are those of the whole sweep, and their counts [merge](Count::merge) to that of the whole. Some
    /// shards are empty if there are more of them than blocks.
    #[must_use]
    pub fn shard(self, shard: Shard) -> Self {
        Self { shard, ..self }
    }

    /// The number of poses of the grid, or of the shard.
    pub fn poses(&self) -> u64 {
        let Range { start, end } = self.range();
        end - start
    }

    /// The numbers of the poses of the grid, or of the shard.
    pub fn range(&self) -> Range<u64> {
        let Range { start, end } = self.blocks();
        self.poses_before(start)..self.poses_before(end)
    }

    /// Counts the reachable poses, and finds the ranges of the imaginary joints. Memory does not
    /// depend on the size of the grid.
    ///
    /// # Errors
    /// [`Cancelled`] if [`Progress::cancel`] was called.
    pub fn count(&self, progress: &Progress) -> Result<Count, Cancelled> {
        let nothing = || Count::nothing(self.manipulator);
        self.blocks()
            .into_par_iter()
            .map_init(
                || Worker::new(self, Ranges::Wanted),
                |worker, block| {
                    let mut count = nothing();
                    self.block(block, worker, &mut count, None);
                    progress.advance(count.poses)?;
                    Ok(count)
                },
            )
            .try_reduce(nothing, |a, b| Ok(a.merge(&b)))
    }

    /// As [`count`](Self::count), and gives the numbers of the reachable poses, in order, for [`replay`](crate::replay). It
    /// gives `None` for them if they are more than `most` runs, which bounds the memory.
    ///
    /// # Errors
    /// [`Cancelled`] if [`Progress::cancel`] was called.
    pub fn count_and_keep(
        &self,
        most: usize,
        progress: &Progress,
    ) -> Result<(Count, Option<Vec<Run>>), Cancelled> {
        let mut all = Count::nothing(self.manipulator);
        let mut kept = Vec::new();
        let too_many = AtomicBool::new(false);
        in_order(
            self.blocks().map(Ok),
            || Worker::new(self, Ranges::Wanted),
            |worker, block| {
                let (mut count, mut runs) = (Count::nothing(self.manipulator), Vec::new());
                let mut keep = |hits: &Hits<'_>| {
                    hits.numbers(self.grid).for_each(|run| runs::append(&mut runs, run));
                };
                let wanted = !too_many.load(Ordering::Relaxed);
                let keep: Visitor<'_> = if wanted { Some(&mut keep) } else { None };
                self.block(block, worker, &mut count, keep);
                progress.advance(count.poses)?;
                Ok((count, runs))
            },
            |(count, runs)| {
                all = std::mem::replace(&mut all, Count::nothing(self.manipulator)).merge(&count);
                if !too_many.load(Ordering::Relaxed) {
                    runs.into_iter().for_each(|run| runs::append(&mut kept, run));
                }
                if kept.len() > most {
                    too_many.store(true, Ordering::Relaxed);
                    kept = Vec::new();
                }
                Ok::<(), Cancelled>(())
            },
        )?;
        let kept = (!too_many.into_inner()).then_some(kept);
        Ok((all, kept))
    }

    /// Gives every reachable pose, in the order of their numbers. For every block of the grid, `empty`
    /// makes a value, and `make` adds the hits of each segment to it, on any thread. Then `visit`
    /// takes these values in the order of their blocks, on one thread, while the next are made. Memory does
    /// not depend on the size of the grid.
    ///
    /// # Errors
    /// The first error of `visit`, or [`Cancelled`] if [`Progress::cancel`] was called.
    ///
    /// ```
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// # use opm_core::Manipulator;
    /// # use opm_workspace::{Axis, Cancelled, Grid, Modes, Progress, Sweep};
    /// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// # let grid = Grid::new(&manipulator, vec![Axis::new("x", -0.3, 0.3, 61)])?;
    /// # let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
    /// // The first coordinates of all reachable poses.
    /// let mut x = Vec::new();
    /// sweep.points(
    ///     &Progress::default(),
    ///     |hits, made: &mut Vec<f64>| made.extend_from_slice(hits.first),
    ///     Vec::new,
    ///     |made| {
    ///         x.extend(made);
    ///         Ok::<(), Cancelled>(())
    ///     },
    /// )?;
    /// assert_eq!(x.len() as u64, sweep.count(&Progress::default())?.reachable);
    /// # Ok(())
    /// # }
    /// ```
    pub fn points<T: Send, E: From<Cancelled> + Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), E> + Send,
    ) -> Result<(), E> {
        in_order(
            self.blocks().map(Ok),
            || Worker::new(self, Ranges::Unused),
            |worker, block| {
                let mut made = empty();
                let mut count = Count::nothing(self.manipulator);
                let mut make = |hits: &Hits<'_>| make(hits, &mut made);
                self.block(block, worker, &mut count, Some(&mut make));
                progress.advance(count.poses)?;
                Ok(made)
            },
            visit,
        )
    }

    /// The number of blocks that the work is divided into. Further threads have nothing to do.
    pub fn pieces(&self) -> u64 {
        let Range { start, end } = self.blocks();
        end - start
    }

    /// The blocks of the shard.
    fn blocks(&self) -> Range<u64> {
        self.shard.of((self.rows() * self.segments).div_ceil(self.stride))
    }

    /// The number of poses of all blocks before one.
    fn poses_before(&self, block: u64) -> u64 {
        let along = self.grid.row();
        let segments = (block * self.stride).min(self.rows() * self.segments);
        segments / self.segments * along + segments % self.segments * SEGMENT
    }

    fn rows(&self) -> u64 {
        self.grid.poses() / self.grid.row()
    }

    /// Decides the poses of one block, adds them to `count`, and gives them to `hit`, if there is one.
    fn block(&self, block: u64, worker: &mut Worker<'_>, count: &mut Count, mut hit: Visitor<'_>) {
        let along = self.grid.row();
        let end = ((block + 1) * self.stride).min(self.rows() * self.segments);
        let mut next = block * self.stride;
        let poses = || self.poses_before(block)..self.poses_before(block + 1);
        if self.takes_boxes() {
            worker.boxes(poses(), count, &mut hit);
            return;
        }
        if self.takes_poses_together() {
            worker.together(poses(), count, &mut hit);
            return;
        }
        while next < end {
            let (row, part) = (next / self.segments, next % self.segments);
            let (sheet, start) = (row / self.side, row % self.side);
            let together = if self.segments == 1 {
                (self.side - start).min(end - next).min(ROWS as u64)
            } else {
                1
            };
            let from = part * SEGMENT;
            let window = Run { from, to: (from + SEGMENT).min(along) };
            count.poses += together * (window.to - window.from);
            next += together;
            worker.sheet.enter(sheet / self.sheets, sheet % self.sheets);
            if worker.sheet.kind != SheetKind::Unreachable {
                worker.decide(start..start + together, window, count, &mut hit);
            }
        }
    }
}
