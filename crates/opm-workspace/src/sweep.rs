//! The sweep: which poses of a grid are in reach and within the limits.

use crate::grid::{Grid, fill};
use crate::progress::{Cancelled, Progress};
use opm_core::manipulator::{Follow, Manipulator, Mark, Mode, Row};
use rayon::prelude::*;

/// Poses of a row that are decided together: long enough to vectorise, short enough for the cache.
const SEGMENT: u64 = 1024;

/// Poses of a block, the unit of work: some 0.1 ms, so that threads share evenly and a request to
/// stop is heard at once.
const BLOCK: u64 = 1 << 15;

/// Blocks that are decided together between two visits of points (more only where there are more
/// threads): bounds the memory that points wait in.
const BATCH: u64 = 16;

/// Which working modes count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Modes {
    /// One.
    One(Mode),
    /// A pose counts where any mode reaches it within the limits.
    Any,
}

/// What a sweep found.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    /// Poses of the grid.
    pub poses: u64,
    /// Poses in reach and within all limits.
    pub reachable: u64,
    /// Lowest and highest value of every imaginary joint over the reachable poses; `None` where
    /// there is no such pose.
    pub imaginary: Vec<Option<[f64; 2]>>,
}

/// The reachable poses of one segment of a row: they differ in the first coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Hits<'a> {
    /// Number of the slice: see [`Grid::slices`].
    pub slice: u64,
    /// Values of the first coordinate, ascending.
    pub first: &'a [f64],
    /// The other coordinates.
    pub others: &'a [f64],
}

/// A sweep of one grid.
#[derive(Clone, Copy, Debug)]
pub struct Sweep<'a> {
    manipulator: &'a Manipulator,
    grid: &'a Grid,
    modes: Modes,
    /// Segments a row.
    segments: u64,
    /// Segments a block.
    stride: u64,
}

impl<'a> Sweep<'a> {
    /// Sweeps `grid`, a grid of this manipulator, in one working mode or in any.
    pub fn new(manipulator: &'a Manipulator, grid: &'a Grid, modes: Modes) -> Self {
        let row = grid.axes()[0].count;
        let stride = (BLOCK / row.min(SEGMENT)).max(1);
        Self { manipulator, grid, modes, segments: row.div_ceil(SEGMENT), stride }
    }

    /// Counts the reachable poses, and finds the ranges of the imaginary joints. Memory does not
    /// depend on the size of the grid.
    ///
    /// # Errors
    /// When told to stop.
    pub fn count(&self, progress: &Progress) -> Result<Count, Cancelled> {
        let nothing = || Tally::new(self.manipulator);
        let tally = (0..self.blocks())
            .into_par_iter()
            .map_init(
                || Scratch::new(self.manipulator),
                |scratch, block| {
                    let mut tally = nothing();
                    let poses = self.block(block, scratch, &mut tally, |_| {});
                    progress.advance(poses)?;
                    Ok(tally)
                },
            )
            .try_reduce(nothing, |a, b| Ok(a.merge(b)))?;
        Ok(Count {
            poses: self.grid.poses(),
            reachable: tally.reachable,
            imaginary: tally.imaginary,
        })
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
        mut visit: impl FnMut(T) -> Result<(), E> + Send,
    ) -> Result<(), E> {
        let ahead = BATCH.max(rayon::current_num_threads() as u64);
        let batch = |start: u64| -> Result<Vec<T>, Cancelled> {
            (start..(start + ahead).min(self.blocks()))
                .collect::<Vec<_>>()
                .into_par_iter()
                .map_init(
                    || Scratch::new(self.manipulator),
                    |scratch, block| {
                        let mut made = empty();
                        let mut tally = Tally::new(self.manipulator);
                        let poses =
                            self.block(block, scratch, &mut tally, |hits| make(hits, &mut made));
                        progress.advance(poses)?;
                        Ok(made)
                    },
                )
                .collect()
        };
        let mut next = batch(0)?;
        let mut start = ahead;
        while !next.is_empty() {
            let (visited, following) = rayon::join(
                || next.into_iter().try_for_each(&mut visit),
                || batch(start.min(self.blocks())),
            );
            visited?;
            next = following?;
            start += ahead;
        }
        Ok(())
    }

    fn blocks(&self) -> u64 {
        (self.rows() * self.segments).div_ceil(self.stride)
    }

    fn rows(&self) -> u64 {
        self.grid.poses() / self.grid.axes()[0].count
    }

    /// Decides the poses of one block and returns how many they are.
    fn block(
        &self,
        block: u64,
        scratch: &mut Scratch,
        tally: &mut Tally,
        mut hit: impl FnMut(&Hits<'_>),
    ) -> u64 {
        let axes = self.grid.axes();
        let lower = self.grid.lower();
        let row_slices: u64 = axes[1..lower].iter().map(|axis| axis.count).product();
        let end = ((block + 1) * self.stride).min(self.rows() * self.segments);
        let mut poses = 0;
        for segment in block * self.stride..end {
            let (row, part) = (segment / self.segments, segment % self.segments);
            let (slice, in_slice) = (row / row_slices, row % row_slices);
            scratch.enter_slice(self, slice);
            let from = part * SEGMENT;
            let to = (from + SEGMENT).min(axes[0].count);
            poses += to - from;
            if !scratch.alive {
                continue;
            }
            scratch.enter_segment(&axes[0], from, to);
            let (lower_others, upper) = scratch.others.split_at_mut(lower - 1);
            fill(&axes[1..lower], in_slice, lower_others);
            debug_assert_eq!(upper.len(), axes.len() - lower);
            let count = scratch.decide(self.manipulator, lower, tally);
            tally.reachable += count;
            if count > 0 {
                scratch.hits.clear();
                let reached = scratch.first.iter().zip(&scratch.mask);
                scratch.hits.extend(reached.filter_map(|(&x, &hit)| (hit == 1).then_some(x)));
                hit(&Hits { slice, first: &scratch.hits, others: &scratch.others });
            }
        }
        poses
    }
}

/// A sum that does not depend on the order of its terms.
#[derive(Clone, Debug)]
struct Tally {
    reachable: u64,
    imaginary: Vec<Option<[f64; 2]>>,
}

impl Tally {
    fn new(manipulator: &Manipulator) -> Self {
        Self { reachable: 0, imaginary: vec![None; manipulator.imaginary().len()] }
    }

    fn merge(mut self, other: Self) -> Self {
        self.reachable += other.reachable;
        for (number, range) in other.imaginary.into_iter().enumerate() {
            if let Some([low, high]) = range {
                self.widen(number, low);
                self.widen(number, high);
            }
        }
        self
    }

    fn widen(&mut self, imaginary: usize, value: f64) {
        let range = self.imaginary[imaginary].get_or_insert([value; 2]);
        *range = [range[0].min(value), range[1].max(value)];
    }
}

/// One way of a leg in the present slice.
#[derive(Clone, Debug)]
struct Way {
    follow: Follow,
    /// Its imaginary joint, until a reachable pose has used it.
    pending: Option<(usize, f64)>,
}

/// A thread's working memory.
struct Scratch {
    slice: Option<u64>,
    /// Every leg's upper section closes in this slice.
    alive: bool,
    legs: Vec<Vec<Way>>,
    found: Vec<Follow>,
    /// Bounds of the segment whose values `first` holds.
    segment: [u64; 2],
    first: Vec<f64>,
    others: Vec<f64>,
    mask: Vec<Mark>,
    leg_mask: Vec<Mark>,
    hits: Vec<f64>,
}

impl Scratch {
    fn new(manipulator: &Manipulator) -> Self {
        Self {
            slice: None,
            alive: false,
            legs: vec![Vec::new(); manipulator.legs()],
            found: Vec::new(),
            segment: [0; 2],
            first: Vec::new(),
            others: vec![0.0; manipulator.task_coordinates().len() - 1],
            mask: Vec::new(),
            leg_mask: Vec::new(),
            hits: Vec::new(),
        }
    }

    /// Solves the upper section for a slice, unless it is the present one.
    fn enter_slice(&mut self, sweep: &Sweep<'_>, slice: u64) {
        if self.slice == Some(slice) {
            return;
        }
        self.slice = Some(slice);
        let lower = sweep.grid.lower();
        let upper = &mut self.others[lower - 1..];
        fill(&sweep.grid.axes()[lower..], slice, upper);
        let manipulator = sweep.manipulator;
        let b = manipulator.task().upper(upper);
        let mode = match sweep.modes {
            Modes::One(mode) => Some(mode),
            Modes::Any => None,
        };
        self.alive = true;
        for (leg, ways) in self.legs.iter_mut().enumerate() {
            self.found.clear();
            manipulator.follow(leg, &b, mode, &mut self.found);
            ways.clear();
            ways.extend(
                self.found
                    .iter()
                    .map(|&follow| Way { follow, pending: manipulator.imaginary_value(&follow) }),
            );
            self.alive &= !ways.is_empty();
        }
    }

    fn enter_segment(&mut self, axis: &crate::Axis, from: u64, to: u64) {
        if self.segment != [from, to] {
            self.segment = [from, to];
            self.first.clear();
            self.first.extend((from..to).map(|i| axis.value(i)));
            self.mask.resize(self.first.len(), 0);
            self.leg_mask.resize(self.first.len(), 0);
        }
    }

    /// Marks the segment's reachable poses and counts them.
    fn decide(&mut self, manipulator: &Manipulator, lower: usize, tally: &mut Tally) -> u64 {
        let row = Row { first: &self.first, others: &self.others[..lower - 1] };
        self.mask.fill(1);
        let mut count = 0;
        for ways in &self.legs {
            self.leg_mask.fill(0);
            for way in ways {
                manipulator.mark(&way.follow, &row, &mut self.leg_mask);
            }
            count = 0;
            for (mask, leg) in self.mask.iter_mut().zip(&self.leg_mask) {
                *mask &= leg;
                count += *mask;
            }
            if count == 0 {
                return 0;
            }
        }
        for ways in &mut self.legs {
            let alone = ways.len() == 1;
            for way in ways {
                let Some((imaginary, value)) = way.pending else { continue };
                let used = alone || {
                    self.leg_mask.fill(0);
                    manipulator.mark(&way.follow, &row, &mut self.leg_mask);
                    self.leg_mask.iter().zip(&self.mask).any(|(leg, all)| leg & all == 1)
                };
                if used {
                    tally.widen(imaginary, value);
                    way.pending = None;
                }
            }
        }
        count
    }
}
