//! The sweep: which poses of a grid are in reach and within the limits.
//!
//! The poses that share the upper section's coordinates are a slice: it is solved once, and leaves
//! each leg a set of poses. Where that is a region of the plane, it is cut by whole rows at a time
//! ([`cuts`]), else it is asked for in pieces of rows ([`pieces`]).

mod cuts;
mod pieces;
pub(crate) mod runs;
mod scratch;
mod shard;
mod spans;

pub use runs::Run;
pub use shard::{Shard, ShardError};

use crate::condition::ConditionLimit;
use crate::grid::{Grid, Sections};
use crate::ordered::in_order;
use crate::progress::{Cancelled, Progress};
use cuts::ROWS;
use opm_core::manipulator::{Follow, Manipulator, Mode};
use rayon::prelude::*;
use scratch::Scratch;
use spans::Spans;
use std::ops::Range;

/// Poses of a row that are decided together, of which a block has room for several.
const SEGMENT: u64 = 1024;

/// Poses of a block, the unit of work: some 0.1 ms, so that threads share evenly and a request to
/// stop is heard at once.
const BLOCK: u64 = 1 << 15;

/// Which working modes count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modes {
    /// One.
    One(Mode),
    /// A pose counts where any mode reaches it within the limits.
    Any,
}

impl Modes {
    /// The one, if there is just one.
    pub fn one(self) -> Option<Mode> {
        match self {
            Self::One(mode) => Some(mode),
            Self::Any => None,
        }
    }
}

/// What a sweep found, or a shard of it. Of a grid of one section alone, what is said of poses is said of its points.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// Poses that were decided: of the grid, or of the shard.
    pub poses: u64,
    /// Poses in reach and within all limits.
    pub reachable: u64,
    /// Lowest and highest value of every imaginary joint over the reachable poses; `None` where
    /// there is no such pose.
    pub imaginary: Vec<Option<[f64; 2]>>,
}

impl Count {
    /// Of no poses.
    pub fn nothing(manipulator: &Manipulator) -> Self {
        Self { poses: 0, reachable: 0, imaginary: vec![None; manipulator.imaginary().len()] }
    }

    /// Of both together, which have no pose in common. Exact: in whatever order and however
    /// bracketed shards are merged, the result is the same to the bit.
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

    /// Takes the imaginary joint of a leg that follows in this way, unless it lies between others.
    fn used(&mut self, manipulator: &Manipulator, way: &Follow, spans: &mut Spans) {
        if spans.hold(way) {
            return;
        }
        if let Some((imaginary, value)) = manipulator.imaginary_value(way) {
            self.widen(imaginary, value);
        }
    }

    fn widen(&mut self, imaginary: usize, value: f64) {
        // Of zeros of two signs, which `min` may confuse, there is but one then.
        let value = value + 0.0;
        let range = self.imaginary[imaginary].get_or_insert([value; 2]);
        *range = [range[0].min(value), range[1].max(value)];
    }
}

/// The reachable poses of one segment of a row: they differ in the first coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Hits<'a> {
    /// Number of the slice: see [`Grid::slices`].
    pub slice: u64,
    /// Number of the row: that of its poses over [`Grid::row`].
    pub row: u64,
    /// Numbers of the values of the first coordinate.
    pub runs: &'a [Run],
    /// Values of the first coordinate, ascending.
    pub first: &'a [f64],
    /// The other coordinates.
    pub others: &'a [f64],
}

impl Hits<'_> {
    /// The numbers of the poses in a grid, which has to be the one that was swept.
    pub fn numbers(&self, grid: &Grid) -> impl Iterator<Item = Run> {
        let first = self.row * grid.row();
        self.runs.iter().map(move |run| Run { from: first + run.from, to: first + run.to })
    }
}

/// A sweep of one grid.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a> {
    manipulator: &'a Manipulator,
    grid: &'a Grid,
    modes: Modes,
    limit: Option<ConditionLimit>,
    shard: Shard,
    /// Segments a row.
    segments: u64,
    /// Segments a block.
    stride: u64,
    /// Rows a sheet: they differ in the second coordinate alone, where that is the lower section's.
    side: u64,
    /// Sheets a slice.
    sheets: u64,
}

impl<'a> Sweep<'a> {
    /// Sweeps `grid`, a grid of this manipulator or of one of its sections alone, in one working mode or
    /// in any.
    pub fn new(manipulator: &'a Manipulator, grid: &'a Grid, modes: Modes) -> Self {
        let row = grid.row();
        let stride = (BLOCK / row.min(SEGMENT)).max(1);
        let lower = grid.axes()[..grid.lower()].get(1..).unwrap_or_default();
        let side = lower.first().map_or(1, |axis| axis.count);
        let sheets = lower.iter().skip(1).map(|axis| axis.count).product();
        let segments = row.div_ceil(SEGMENT);
        let (limit, shard) = (None, Shard::WHOLE);
        Self { manipulator, grid, modes, limit, shard, segments, stride, side, sheets }
    }

    /// What is swept.
    pub fn grid(&self) -> &'a Grid {
        self.grid
    }

    /// Whose workspace it is.
    pub fn manipulator(&self) -> &'a Manipulator {
        self.manipulator
    }

    /// In which working modes.
    pub fn modes(&self) -> Modes {
        self.modes
    }

    /// The limit on the condition number, if there is one.
    pub fn limit(&self) -> Option<ConditionLimit> {
        self.limit
    }

    /// The same sweep, but a pose counts only in a working mode in which it is conditioned well
    /// enough. That is decided pose by pose, a few microseconds each and mode.
    ///
    /// # Panics
    /// On a grid of one section alone: only the whole mechanism has a condition number.
    #[must_use]
    pub fn limited(self, limit: Option<ConditionLimit>) -> Self {
        let whole = self.grid.sections() == Sections::Whole;
        assert!(whole || limit.is_none(), "a section alone has no condition number");
        Self { limit, ..self }
    }

    /// The same sweep, of one shard of its grid alone: whole blocks of rows, of which every shard
    /// has as many as any other, or one more. Together the shards' points are those of the whole
    /// sweep, one after the other, and their counts [merge](Count::merge) to that of the whole,
    /// however many they are. A shard is empty where there are more of them than blocks.
    #[must_use]
    pub fn shard(self, shard: Shard) -> Self {
        Self { shard, ..self }
    }

    /// Number of poses of the grid, or of the shard of it.
    pub fn poses(&self) -> u64 {
        let Range { start, end } = self.range();
        end - start
    }

    /// The numbers of these poses.
    pub fn range(&self) -> Range<u64> {
        let Range { start, end } = self.blocks();
        self.poses_before(start)..self.poses_before(end)
    }

    /// Counts the reachable poses, and finds the ranges of the imaginary joints. Memory does not
    /// depend on the size of the grid.
    ///
    /// # Errors
    /// When told to stop.
    pub fn count(&self, progress: &Progress) -> Result<Count, Cancelled> {
        let nothing = || Count::nothing(self.manipulator);
        self.blocks()
            .into_par_iter()
            .map_init(
                || Scratch::new(self),
                |scratch, block| {
                    let mut count = nothing();
                    self.block(block, scratch, &mut count, None);
                    progress.advance(count.poses)?;
                    Ok(count)
                },
            )
            .try_reduce(nothing, |a, b| Ok(a.merge(&b)))
    }

    /// Gives every reachable pose, in the order of their numbers: `make` turns the hits of a
    /// segment into something to keep, on any thread, and `visit` takes these in order while the
    /// next are made. Memory does not depend on the size of the grid.
    ///
    /// # Errors
    /// The first one that `visit` gives, or when told to stop.
    pub fn points<T: Send, E: From<Cancelled> + Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), E> + Send,
    ) -> Result<(), E> {
        in_order(
            self.blocks().map(Ok),
            || Scratch::new(self),
            |scratch, block| {
                let mut made = empty();
                let mut count = Count::nothing(self.manipulator);
                let mut make = |hits: &Hits<'_>| make(hits, &mut made);
                self.block(block, scratch, &mut count, Some(&mut make));
                progress.advance(count.poses)?;
                Ok(made)
            },
            visit,
        )
    }

    /// Pieces that the work comes in: more threads than these have nothing to do.
    pub fn pieces(&self) -> u64 {
        let Range { start, end } = self.blocks();
        end - start
    }

    /// The blocks of the shard.
    fn blocks(&self) -> Range<u64> {
        self.shard.of((self.rows() * self.segments).div_ceil(self.stride))
    }

    /// Poses of all blocks before one.
    fn poses_before(&self, block: u64) -> u64 {
        let along = self.grid.row();
        let segments = (block * self.stride).min(self.rows() * self.segments);
        segments / self.segments * along + segments % self.segments * SEGMENT
    }

    fn rows(&self) -> u64 {
        self.grid.poses() / self.grid.row()
    }

    /// Decides the poses of one block and adds them to `count`, which is all without anybody to `hit`.
    fn block(
        &self,
        block: u64,
        scratch: &mut Scratch<'_>,
        count: &mut Count,
        mut hit: Option<&mut dyn FnMut(&Hits<'_>)>,
    ) {
        let along = self.grid.row();
        let end = ((block + 1) * self.stride).min(self.rows() * self.segments);
        let mut next = block * self.stride;
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
            scratch.enter_sheet(sheet / self.sheets, sheet % self.sheets);
            if scratch.alive {
                scratch.decide(start..start + together, window, count, &mut hit);
            }
        }
    }
}
