//! How many orientations reach each place: what the reachable and the dexterous workspace are made of.

use crate::poses::Poses;
use crate::progress::Progress;
use crate::set::{GridSet, SetAxis, SetError, set_axes};
use crate::sweep::Run;

/// Most places: a GiB of memory.
const MOST: u64 = 1 << 27;

/// For every place of a grid, a value for each of the lower section's coordinates, in how many of the
/// grid's slices it is reached. Visits of parts of one grid add up to those of the whole.
#[derive(Clone, Debug, PartialEq)]
pub struct Visits {
    axes: Vec<SetAxis>,
    slices: u64,
    counts: Vec<u64>,
}

impl Visits {
    /// Those that a sweep makes, or a shard of it. Memory is that of a number a place.
    ///
    /// # Errors
    /// More places than fit in memory, or poses that cannot be had.
    pub fn new<P: Poses>(poses: &P, progress: &Progress) -> Result<Self, P::Error> {
        let grid = poses.grid();
        let places = grid.poses() / grid.slices();
        if places > MOST {
            return Err(SetError::Size { what: "places", given: places, most: MOST }.into());
        }
        // Differences from place to place: a run adds one where it starts and takes it where it ends.
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
    /// # Panics
    /// On visits of another grid.
    pub fn add(&mut self, other: &Self) {
        assert!(self.axes == other.axes && self.slices == other.slices, "visits of two grids");
        self.counts.iter_mut().zip(&other.counts).for_each(|(sum, count)| *sum += count);
    }

    /// The axes of the places, the fastest first.
    pub fn axes(&self) -> &[SetAxis] {
        &self.axes
    }

    /// Slices of the grid: orientations, where the upper section is spherical.
    pub fn slices(&self) -> u64 {
        self.slices
    }

    /// In how many slices each place is reached, the first axis fastest.
    pub fn counts(&self) -> &[u64] {
        &self.counts
    }

    /// The share of the slices in which the place of this number is reached.
    pub fn share(&self, place: u64) -> f64 {
        self.counts[place as usize] as f64 / self.slices as f64
    }

    /// The reachable workspace: places that are reached in any slice.
    ///
    /// # Errors
    /// A set that does not fit in memory.
    pub fn reachable(&self) -> Result<GridSet, SetError> {
        GridSet::of(self.axes.clone(), |place| self.counts[place as usize] > 0)
    }

    /// The dexterous workspace: places that are reached in every slice.
    ///
    /// # Errors
    /// A set that does not fit in memory.
    pub fn dexterous(&self) -> Result<GridSet, SetError> {
        GridSet::of(self.axes.clone(), |place| self.counts[place as usize] == self.slices)
    }
}
