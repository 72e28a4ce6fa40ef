//! The reachable poses of a grid once more, from the numbers that a sweep stored.

use crate::grid::{Grid, fill};
use crate::ordered::in_order;
use crate::progress::{Cancelled, Progress};
use crate::sweep::{Hits, Run};
use std::slice;

/// The number of poses that are made into points together.
const BLOCK: u64 = 1 << 13;

/// Values of the first axis are computed together for so many places of a row, and stay there for the next rows.
const WINDOW: u64 = 1 << 10;

/// Gives poses of a grid as [`Sweep::points`](crate::Sweep::points) does, from `runs` of their numbers,
/// which ascend and lie apart. Only the division of rows into segments may differ from a sweep's.
///
/// # Errors
/// The first error among the runs or of `visit`, or [`Cancelled`] if [`Progress::cancel`] was called.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Axis, Cancelled, Grid, Progress, Run, replay};
///
/// let grid = Grid::new(&manipulator, vec![Axis::new("x", 0.0, 0.4, 5)])?;
/// let stored = [Run { from: 0, to: 1 }, Run { from: 3, to: 5 }];
/// let mut x = Vec::new();
/// replay(
///     &grid,
///     stored.into_iter().map(Ok::<_, Cancelled>),
///     &Progress::default(),
///     |hits, made: &mut Vec<f64>| made.extend_from_slice(hits.first),
///     Vec::new,
///     |made| {
///         x.extend(made);
///         Ok(())
///     },
/// )?;
/// assert_eq!(x.len(), 3);
/// assert_eq!((x[0], x[2]), (0.0, 0.4));
/// # Ok(())
/// # }
/// ```
pub fn replay<T: Send, E: From<Cancelled> + Send>(
    grid: &Grid,
    runs: impl Iterator<Item = Result<Run, E>> + Send,
    progress: &Progress,
    make: impl Fn(&Hits<'_>, &mut T) + Sync,
    empty: impl Fn() -> T + Sync,
    visit: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let row = grid.row();
    // One more than the last pose of the blocks so far.
    let mut reached = 0;
    let blocks = Blocks { runs, rest: None }.map(|block| {
        block.map(|block| {
            let end = block.last().map_or(reached, |run| run.to);
            (block, end - std::mem::replace(&mut reached, end))
        })
    });
    in_order(
        blocks,
        || ReplayedRow::new(grid),
        |scratch, (block, poses): (Vec<Run>, u64)| {
            let mut made = empty();
            for run in block {
                let mut from = run.from;
                while from < run.to {
                    let to = run.to.min((from / row + 1) * row);
                    make(&scratch.hits(Run { from, to }), &mut made);
                    from = to;
                }
            }
            progress.advance(poses)?;
            Ok(made)
        },
        visit,
    )
}

/// Runs, divided into blocks of a number of poses of which many blocks fit into memory.
struct Blocks<I> {
    runs: I,
    /// The part of a run that did not fit into the block before.
    rest: Option<Run>,
}

impl<E, I: Iterator<Item = Result<Run, E>>> Iterator for Blocks<I> {
    type Item = Result<Vec<Run>, E>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut block = Vec::new();
        let mut room = BLOCK;
        while room > 0 {
            let run = match self.rest.take().map(Ok).or_else(|| self.runs.next()) {
                Some(Ok(run)) => run,
                Some(Err(error)) => return Some(Err(error)),
                None => break,
            };
            let to = run.to.min(run.from + room);
            if to < run.to {
                self.rest = Some(Run { from: to, to: run.to });
            }
            room -= to - run.from;
            block.push(Run { from: run.from, to });
        }
        (!block.is_empty()).then_some(Ok(block))
    }
}

/// The row that poses are in, with working memory for their coordinates.
struct ReplayedRow<'a> {
    grid: &'a Grid,
    number: Option<u64>,
    /// The number of rows in a slice.
    slice: u64,
    /// The poses that were found, by their numbers in the row.
    run: Run,
    /// The places on the first axis whose values are in `values`.
    window: Run,
    values: Vec<f64>,
    others: Vec<f64>,
}

impl<'a> ReplayedRow<'a> {
    fn new(grid: &'a Grid) -> Self {
        let others = vec![0.0; grid.axes().len() - 1];
        let slice = grid.poses() / grid.row() / grid.slices();
        let none = Run { from: 0, to: 0 };
        Self { grid, number: None, slice, run: none, window: none, values: Vec::new(), others }
    }

    /// The poses of a run of numbers in one row.
    fn hits(&mut self, run: Run) -> Hits<'_> {
        let (axes, length) = (self.grid.axes(), self.grid.row());
        let row = run.from / length;
        if self.number != Some(row) {
            self.number = Some(row);
            fill(&axes[1..], run.from / axes[0].count, &mut self.others);
        }
        let place = run.from % axes[0].count;
        let places = Run { from: place, to: place + (run.to - run.from) };
        if places.from < self.window.from || self.window.to < places.to {
            let from = places.from / WINDOW * WINDOW;
            let to = places.to.next_multiple_of(WINDOW).min(axes[0].count);
            self.window = Run { from, to };
            self.values.clear();
            self.values.extend((from..to).map(|place| axes[0].value(place)));
        }
        let [from, to] = [places.from, places.to].map(|place| (place - self.window.from) as usize);
        let start = row * length;
        self.run = Run { from: run.from - start, to: run.to - start };
        let (slice, runs) = (row / self.slice, slice::from_ref(&self.run));
        Hits { slice, row, runs, first: &self.values[from..to], others: &self.others }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Axis;
    use opm_core::Manipulator;

    /// Rows shorter and longer than a window and than a block; runs that lie apart, end with a row, go over its end, and over
    /// several rows. What a number means is told by [`Grid::pose`].
    #[test]
    fn poses_are_those_of_their_numbers() {
        let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
        for count in [1, 7, WINDOW, WINDOW + 1, 3 * WINDOW - 1, 3 * BLOCK + 5] {
            let x =
                if count == 1 { Axis::fixed("x", 0.1) } else { Axis::new("x", -0.3, 0.2, count) };
            let axes = vec![x, Axis::new("y", -0.1, 0.3, 3), Axis::new("xi", 0.0, 0.4, 2)];
            let grid = Grid::new(&manipulator, axes).unwrap();
            let last = grid.poses();
            let ends =
                [0, 1, 2, count / 3, count / 2, count - 1, count, 2 * count, 5 * count, last];
            let mut ends: Vec<u64> = ends.into_iter().filter(|&end| end <= last).collect();
            ends.sort_unstable();
            ends.dedup();
            let apart = ends.chunks_exact(2).map(|ends| Run { from: ends[0], to: ends[1] });
            for runs in [apart.collect(), vec![Run { from: 0, to: last }]] {
                let mut poses: Vec<Vec<f64>> = Vec::new();
                let replayed: Result<(), Cancelled> = replay(
                    &grid,
                    runs.iter().copied().map(Ok),
                    &Progress::default(),
                    |hits, made: &mut Vec<Vec<f64>>| {
                        assert_eq!(hits.runs.len(), 1);
                        let numbers = hits.numbers(&grid).flat_map(|run| run.from..run.to);
                        assert_eq!(numbers.count(), hits.first.len());
                        let pose = |&first: &f64| [&[first], hits.others].concat();
                        made.extend(hits.first.iter().map(pose));
                    },
                    Vec::new,
                    |made| {
                        poses.extend(made);
                        Ok(())
                    },
                );
                assert!(replayed.is_ok());
                let numbers = runs.iter().flat_map(|run| run.from..run.to);
                assert!(poses.into_iter().eq(numbers.map(|number| grid.pose(number))), "{count}");
            }
        }
    }
}
