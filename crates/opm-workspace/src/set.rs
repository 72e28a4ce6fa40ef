//! Sets of points of a grid: which are in, row by row.

use crate::grid::{Axis, Grid};
use crate::poses::Poses;
use crate::progress::{Cancelled, Progress};
use crate::sweep::Run;
use std::ops::Range;

/// Most rows and most runs of a set: some GiB of memory.
const MOST: u64 = 1 << 27;

/// One axis of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct SetAxis {
    /// Its values.
    pub axis: Axis,
    /// An angle whose values come full circle: the last has the first for a neighbour.
    pub circle: bool,
}

/// Why there is no set.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetError {
    /// It does not fit in memory.
    #[error(
        "{what} of a set: {given}, expected at most {most}; sweep a coarser grid or a part of it"
    )]
    Size {
        /// Rows, or runs of points.
        what: &'static str,
        /// How many there are, at least.
        given: u64,
        /// How many may be.
        most: u64,
    },
    /// The sweep was told to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Points of a grid. They are numbered as the grid's poses are, with the first axis fastest; a row is
/// what differs in the first axis that has several values.
#[derive(Clone, Debug, PartialEq)]
pub struct GridSet {
    axes: Vec<SetAxis>,
    /// Points of a row.
    row: u64,
    /// Where the runs of each row end.
    ends: Vec<usize>,
    /// Points of each row, by their numbers in it, ascending and apart.
    runs: Vec<Run>,
}

impl GridSet {
    /// The set that a sweep reaches, of poses or of one section alone.
    ///
    /// # Errors
    /// A set that does not fit in memory, or poses that cannot be had.
    pub fn reached<P: Poses>(poses: &P, progress: &Progress) -> Result<Self, P::Error> {
        let grid = poses.grid();
        let mut set = SetBuilder::new(set_axes(grid, 0..grid.axes().len()))?;
        poses.points(
            progress,
            |hits, made: &mut Vec<Run>| made.extend(hits.numbers(grid)),
            Vec::new,
            |made| Ok(made.into_iter().try_for_each(|run| set.push(run))?),
        )?;
        Ok(set.finish())
    }

    /// The slices of a grid in which a sweep reaches any pose, as points of the axes that the slices
    /// differ in.
    ///
    /// # Errors
    /// As [`GridSet::reached`].
    pub fn slices<P: Poses>(poses: &P, progress: &Progress) -> Result<Self, P::Error> {
        let grid = poses.grid();
        let mut set = SetBuilder::new(set_axes(grid, grid.lower()..grid.axes().len()))?;
        let mut last = None;
        poses.points(
            progress,
            |hits, made: &mut Vec<u64>| {
                if made.last() != Some(&hits.slice) {
                    made.push(hits.slice);
                }
            },
            Vec::new,
            |made| {
                let mut new = made.into_iter().filter(|&slice| last.replace(slice) != Some(slice));
                Ok(new.try_for_each(|slice| set.push(Run { from: slice, to: slice + 1 }))?)
            },
        )?;
        Ok(set.finish())
    }

    /// The points of a grid with these axes that `holds` says are in.
    ///
    /// # Errors
    /// A set that does not fit in memory.
    pub fn of(axes: Vec<SetAxis>, holds: impl Fn(u64) -> bool) -> Result<Self, SetError> {
        let mut set = SetBuilder::new(axes)?;
        (0..set.points)
            .filter(|&number| holds(number))
            .try_for_each(|number| set.push(Run { from: number, to: number + 1 }))?;
        Ok(set.finish())
    }

    /// The axes, the fastest first.
    pub fn axes(&self) -> &[SetAxis] {
        &self.axes
    }

    /// Numbers of the axes that have several values.
    pub fn varying(&self) -> Vec<usize> {
        (0..self.axes.len()).filter(|&i| self.axes[i].axis.count > 1).collect()
    }

    /// Points of the grid.
    pub fn points(&self) -> u64 {
        self.axes.iter().map(|a| a.axis.count).product()
    }

    /// Points of the set.
    pub fn count(&self) -> u64 {
        self.runs.iter().map(|run| run.to - run.from).sum()
    }

    /// Points of a row.
    pub fn row(&self) -> u64 {
        self.row
    }

    /// The points of row number `row`, by their numbers in it, ascending and apart.
    pub fn runs(&self, row: usize) -> &[Run] {
        &self.runs[self.span(row)]
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.ends.len()
    }

    /// Where the runs of a row are among all runs.
    pub(crate) fn span(&self, row: usize) -> Range<usize> {
        let start = if row == 0 { 0 } else { self.ends[row - 1] };
        start..self.ends[row]
    }

    /// Whether the set has the point of this number.
    pub fn contains(&self, number: u64) -> bool {
        let place = number % self.row;
        let runs = self.runs((number / self.row) as usize);
        let after = runs.partition_point(|run| run.from <= place);
        after > 0 && place < runs[after - 1].to
    }

    /// The numbers of its points, ascending.
    pub fn numbers(&self) -> impl Iterator<Item = u64> + '_ {
        (0..self.rows()).flat_map(move |row| {
            let first = row as u64 * self.row;
            self.runs(row).iter().flat_map(move |run| first + run.from..first + run.to)
        })
    }

    /// The coordinates of the point of this number.
    pub fn point(&self, mut number: u64) -> Vec<f64> {
        let value = |SetAxis { axis, .. }: &SetAxis| {
            let value = axis.value(number % axis.count);
            number /= axis.count;
            value
        };
        self.axes.iter().map(value).collect()
    }
}

/// Some axes of a grid, as axes of a set.
pub(crate) fn set_axes(grid: &Grid, axes: Range<usize>) -> Vec<SetAxis> {
    axes.map(|i| SetAxis { axis: grid.axes()[i].clone(), circle: grid.is_circle(i) }).collect()
}

/// A set whose points come in the order of their numbers.
pub(crate) struct SetBuilder {
    set: GridSet,
    /// Of the grid.
    points: u64,
}

impl SetBuilder {
    pub fn new(axes: Vec<SetAxis>) -> Result<Self, SetError> {
        let row = axes.iter().map(|a| a.axis.count).find(|&count| count > 1).unwrap_or(1);
        let points = axes.iter().map(|a| a.axis.count).product::<u64>();
        let rows = points / row;
        if rows > MOST {
            return Err(SetError::Size { what: "rows", given: rows, most: MOST });
        }
        let set = GridSet { axes, row, ends: Vec::with_capacity(rows as usize), runs: vec![] };
        Ok(Self { set, points })
    }

    /// Adds points after all that are in.
    pub fn push(&mut self, points: Run) -> Result<(), SetError> {
        let Self { set: GridSet { row: length, ends, runs, .. }, .. } = self;
        let mut from = points.from;
        while from < points.to {
            let row = from / *length;
            let start = row * *length;
            let to = points.to.min(start + *length);
            ends.resize((ends.len()).max(row as usize), runs.len());
            let run = Run { from: from - start, to: to - start };
            let first = ends.last().copied().unwrap_or(0);
            let full = runs.len() as u64 == MOST;
            match runs[first..].last_mut() {
                Some(last) if last.to == run.from => last.to = run.to,
                _ if full => {
                    return Err(SetError::Size { what: "runs", given: MOST + 1, most: MOST });
                }
                _ => runs.push(run),
            }
            from = to;
        }
        Ok(())
    }

    pub fn finish(self) -> GridSet {
        let Self { mut set, points } = self;
        set.ends.resize((points / set.row) as usize, set.runs.len());
        set
    }
}
