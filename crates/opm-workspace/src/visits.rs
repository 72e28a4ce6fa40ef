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

/// At how many orientations of a grid each place is reached. A place is a point of the axes of
/// [`Grid::places`](crate::Grid::places), an orientation one of the other axes. The *reachable* workspace are the
/// places that are reached at any orientation, the *dexterous* workspace those that are reached at every one.
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
/// assert_eq!((visits.orientations(), visits.counts().len()), (5, 31 * 31));
/// assert!(visits.dexterous()?.count() <= visits.reachable()?.count());
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Visits {
    axes: Vec<SetAxis>,
    orientations: u64,
    counts: Vec<u64>,
}

/// Places that one run of poses reaches, each this many times.
struct Added {
    places: Run,
    times: u64,
}

impl Visits {
    /// The visits of all reachable poses of a source, for instance of a [`Sweep`](crate::Sweep) or of a shard
    /// of it. They take eight bytes of memory for each place.
    ///
    /// # Errors
    /// There are more places than fit in memory ([`SetError::Size`]), or the source's own errors.
    pub fn new<P: Poses>(poses: &P, progress: &Progress) -> Result<Self, P::Error> {
        let grid = poses.grid();
        let places = grid.points_of(grid.places());
        // Poses from one place to the next, and whether those of a row differ in their places.
        let stride = grid.points_of(0..grid.places().start);
        let row_of_places = grid.places().contains(&0);
        if places > MOST {
            return Err(SetError::Size { what: "places", given: places, most: MOST }.into());
        }
        // Differences from place to place: a run adds to the count where it starts and subtracts where it ends.
        let mut counts = vec![0_u64; places as usize + 1];
        poses.points(
            progress,
            |hits, made: &mut Vec<Added>| {
                made.extend(hits.numbers(grid).map(|Run { from, to }| {
                    let first = from / stride % places;
                    let (number, times) =
                        if row_of_places { (to - from, 1) } else { (1, to - from) };
                    Added { places: Run { from: first, to: first + number }, times }
                }));
            },
            Vec::new,
            |made| {
                for Added { places: Run { from, to }, times } in made {
                    let (from, to) = (from as usize, to as usize);
                    counts[from] = counts[from].wrapping_add(times);
                    counts[to] = counts[to].wrapping_sub(times);
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
        let (axes, orientations) = (set_axes(grid, grid.places()), grid.orientation_count());
        Ok(Self { axes, orientations, counts })
    }

    /// Adds the visits of another part of the same grid.
    ///
    /// # Errors
    /// [`OtherGrid`] if those are visits of another grid; then nothing is added.
    pub fn merge(&mut self, other: &Self) -> Result<(), OtherGrid> {
        if self.axes != other.axes || self.orientations != other.orientations {
            return Err(OtherGrid);
        }
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
        Ok(())
    }

    /// The axes of the places, the fastest first.
    pub fn axes(&self) -> &[SetAxis] {
        &self.axes
    }

    /// The number of orientations of the grid.
    pub fn orientations(&self) -> u64 {
        self.orientations
    }

    /// At how many orientations each place is reached: one number for each place, the first axis fastest.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The share of the orientations at which the place of this number is reached, from 0 to 1.
    ///
    /// # Panics
    /// There is no place of this number.
    pub fn share(&self, place: u64) -> f64 {
        self.counts[place as usize] as f64 / self.orientations as f64
    }

    /// The reachable workspace: the places that are reached at any orientation.
    ///
    /// # Errors
    /// The set does not fit in memory ([`SetError::Size`]).
    pub fn reachable(&self) -> Result<GridSet, SetError> {
        GridSet::of(self.axes.clone(), |place| self.counts[place as usize] > 0)
    }

    /// The dexterous workspace: the places that are reached at every orientation.
    ///
    /// # Errors
    /// The set does not fit in memory ([`SetError::Size`]).
    pub fn dexterous(&self) -> Result<GridSet, SetError> {
        GridSet::of(self.axes.clone(), |place| self.counts[place as usize] == self.orientations)
    }
}
