//! Sets of points of a grid, stored as runs, row by row.

use crate::grid::{Axis, Grid};
use crate::poses::Poses;
use crate::progress::{Cancelled, Progress};
use crate::sweep::Run;
use std::ops::Range;

/// Most rows and most runs of a set, which take some GiB of memory.
pub(crate) const MOST: u64 = 1 << 27;

/// One axis of a set.
#[derive(Clone, Debug, PartialEq)]
pub struct SetAxis {
    /// The values of the axis.
    pub axis: Axis,
    /// Whether it is an angle whose values come full circle, so that the last and the first are neighbours.
    pub circle: bool,
}

/// Why a set or visits cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SetError {
    /// The set does not fit in memory.
    #[error(
        "{what} of a set: {given}, expected at most {most}; sweep a coarser grid or a part of it"
    )]
    Size {
        /// What there are too many of: `rows`, `runs` or `places`.
        what: &'static str,
        /// The number of them, at least.
        given: u64,
        /// The largest number that is possible.
        most: u64,
    },
    /// The sweep was cancelled.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A set of points of a grid. The points are numbered from 0 on, with the first axis fastest. The points of a
/// row differ in the first axis that has several values.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Axis, Components, Grid, GridSet, Modes, Progress, Sweep, boundary};
///
/// let axes = vec![Axis::new("x", -0.3, 0.3, 121), Axis::new("y", -0.3, 0.3, 121)];
/// let grid = Grid::new(&manipulator, axes)?;
/// let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
/// let set = GridSet::reached(&sweep, &Progress::default())?;
/// assert_eq!(set.count(), sweep.count(&Progress::default())?.reachable);
/// assert!(set.numbers().all(|number| set.contains(number)));
///
/// let parts = Components::new(&set).sizes().len();
/// let outline = &boundary(&set).ok_or("not a plane set")?[0];
/// assert!(outline.rings.len() >= parts);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct GridSet {
    axes: Vec<SetAxis>,
    /// The number of points in a row.
    row: u64,
    /// Where the runs of each row end among all runs.
    ends: Vec<usize>,
    /// The points of each row as runs of their numbers in it, ascending and apart.
    runs: Vec<Run>,
}

impl GridSet {
    /// The set of all reachable poses of a source, for instance of a [`Sweep`](crate::Sweep).
    ///
    /// # Errors
    /// The set does not fit in memory ([`SetError::Size`]), or the source's own errors.
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

    /// The slices of a grid in which any pose is reachable, as points of the axes that the slices differ
    /// in. If the upper section is spherical, these are the orientations that are reached anywhere.
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

    /// The set of those points of a grid with these axes whose numbers `holds` accepts.
    ///
    /// # Errors
    /// The set does not fit in memory ([`SetError::Size`]).
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

    /// The numbers of the axes that have several values, ascending.
    pub fn varying(&self) -> Vec<usize> {
        (0..self.axes.len()).filter(|&i| self.axes[i].axis.count > 1).collect()
    }

    /// The number of points of the grid.
    pub fn points(&self) -> u64 {
        self.axes.iter().map(|a| a.axis.count).product()
    }

    /// The number of points of the set.
    pub fn count(&self) -> u64 {
        self.runs.iter().map(|run| run.to - run.from).sum()
    }

    /// The number of points of the grid in a row.
    pub fn row(&self) -> u64 {
        self.row
    }

    /// The points of row number `row` as runs of their numbers in it, ascending and apart.
    ///
    /// # Panics
    /// There is no row of this number.
    pub fn runs(&self, row: usize) -> &[Run] {
        &self.runs[self.span(row)]
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.ends.len()
    }

    /// Where the runs of a row are among all runs.
    pub(crate) fn span(&self, row: usize) -> Range<usize> {
        let start = if row == 0 { 0 } else { self.ends[row - 1] };
        start..self.ends[row]
    }

    /// Whether the set has the point of this number. A number beyond the grid is not in the set.
    pub fn contains(&self, number: u64) -> bool {
        let place = number % self.row;
        let row = usize::try_from(number / self.row).unwrap_or(usize::MAX);
        if row >= self.rows() {
            return false;
        }
        let runs = self.runs(row);
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

    /// The coordinates of the point of this number, radians and metres, one for each axis.
    pub fn point(&self, number: u64) -> Vec<f64> {
        point(&self.axes, number)
    }
}

/// The coordinates of the point of this number on these axes.
pub(crate) fn point(axes: &[SetAxis], mut number: u64) -> Vec<f64> {
    let value = |SetAxis { axis, .. }: &SetAxis| {
        let value = axis.value(number % axis.count);
        number /= axis.count;
        value
    };
    axes.iter().map(value).collect()
}

/// Some axes of a grid, as axes of a set.
pub(crate) fn set_axes(grid: &Grid, axes: Range<usize>) -> Vec<SetAxis> {
    axes.map(|i| SetAxis { axis: grid.axes()[i].clone(), circle: grid.is_circle(i) }).collect()
}

/// Makes a set of points that come in the order of their numbers.
pub(crate) struct SetBuilder {
    set: GridSet,
    /// The number of points of the grid.
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

    /// Adds points behind all that the set has.
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
