//! How many orientations reach each place, which gives the reachable and the dexterous workspace.

use crate::poses::Poses;
use crate::progress::Progress;
use crate::set::{GridSet, SetAxis, SetError, set_axes};
use crate::sweep::Run;

/// Most places, which take a GiB of memory.
const MOST: u64 = 1 << 27;

/// Visits are of two different grids, and cannot be added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("visits of two different grids")]
pub struct OtherGrid;

/// In how many slices of a grid each place is reached. A place is a point of the axes of the lower section's
/// coordinates. If the upper section is spherical, slices are orientations: the *reachable* workspace are the
/// places that any orientation reaches, the *dexterous* workspace those that every orientation reaches.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Axis, Grid, Modes, Progress, Sweep, Visits};
///
/// let grid = Grid::new(
///     &manipulator,
///     vec![
///         Axis::new("x", -0.3, 0.3, 31),
///         Axis::new("y", -0.3, 0.3, 31),
///         Axis::new("xi", 0.1, 0.5, 5), // five orientations
///     ],
/// )?;
/// let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
/// let visits = Visits::new(&sweep, &Progress::default())?;
/// assert_eq!((visits.slices(), visits.counts().len()), (5, 31 * 31));
/// assert!(visits.dexterous()?.count() <= visits.reachable()?.count());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Visits {
    axes: Vec<SetAxis>,
    slices: u64,
    counts: Vec<u64>,
}

impl Visits {
    /// The visits of all reachable poses of a source, for instance of a [`Sweep`](crate::Sweep) or of a shard
    /// of it. They take eight bytes of memory for each place.
    ///
    /// # Errors
    /// There are more places than fit in memory ([`SetError::Size`]), or the source's own errors.
    pub fn new<P: Poses>(poses: &P, progress: &Progress) -> Result<Self, P::Error> {
        let grid = poses.grid();
        let places = grid.poses() / grid.slices();
        if places > MOST {
            return Err(SetError::Size { what: "places", given: places, most: MOST }.into());
        }
        // Differences from place to place: a run adds one where it starts and subtracts it where it ends.
        let mut counts = vec![0_u64; places as usize + 1];
        poses.points(
            progress,
            |hits, made: &mut Vec<Run>| {
                let first = hits.slice * places;
                let place = |run: Run| Run { from: run.from - first, to: run.to - first };
                made.extend(hits.numbers(grid).map(place));
            },
            Vec::new,
            |made| {
                for Run { from, to } in made {
                    let (from, to) = (from as usize, to as usize);
                    counts[from] = counts[from].wrapping_add(1);
                    counts[to] = counts[to].wrapping_sub(1);
                }
                Ok(())
            },
        )?;
        let mut count = 0_u64;
        for place in &mut counts {
            count = count.wrapping_add(*place);
            *place = count;
        }
        counts.pop();
        Ok(Self { axes: set_axes(grid, 0..grid.lower()), slices: grid.slices(), counts })
    }

    /// Adds the visits of another part of the same grid.
    ///
    /// # Errors
    /// [`OtherGrid`] if those are visits of another grid; then nothing is added.
    pub fn merge(&mut self, other: &Self) -> Result<(), OtherGrid> {
        if self.axes != other.axes || self.slices != other.slices {
            return Err(OtherGrid);
        }
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
        Ok(())
    }

    /// The axes of the places, the fastest first.
    pub fn axes(&self) -> &[SetAxis] {
        &self.axes
    }

    /// The number of slices of the grid.
    pub fn slices(&self) -> u64 {
        self.slices
    }

    /// In how many slices each place is reached: one number for each place, the first axis fastest.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The share of the slices in which the place of this number is reached, from 0 to 1.
    ///
    /// # Panics
    /// There is no place of this number.
    pub fn share(&self, place: u64) -> f64 {
        self.counts[place as usize] as f64 / self.slices as f64
    }

    /// The reachable workspace: the places that are reached in any slice.
    ///
    /// # Errors
    /// The set does not fit in memory ([`SetError::Size`]).
    pub fn reachable(&self) -> Result<GridSet, SetError> {
        GridSet::of(self.axes.clone(), |place| self.counts[place as usize] > 0)
    }

    /// The dexterous workspace: the places that are reached in every slice.
    ///
    /// # Errors
    /// The set does not fit in memory ([`SetError::Size`]).
    pub fn dexterous(&self) -> Result<GridSet, SetError> {
        GridSet::of(self.axes.clone(), |place| self.counts[place as usize] == self.slices)
    }
}
