//! What rejects the poses of a grid: the legs that do not reach them, and the joints that are past a limit there.

mod causes;

use self::causes::{Causes, Found, Part};
use crate::grid::Grid;
use crate::progress::{Cancelled, Progress};
use crate::sweep::Modes;
use opm_core::manipulator::{Manipulator, Section};
use rayon::prelude::*;

/// Poses between two looks at whether the work was cancelled.
const CHUNK: u64 = 1024;

/// What rejects a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A section of the leg does not close.
    Reach(Section),
    /// A joint coordinate, by its number in [`Manipulator::coordinates`], is below its lowest value.
    Lowest(usize),
    /// A joint coordinate is above its highest value.
    Highest(usize),
}

/// The number of poses that one cause rejects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rejection {
    /// The number of the leg.
    pub leg: usize,
    /// The cause.
    pub cause: Cause,
    /// Poses that would be reached without it. In any working mode, a pose may have several such causes.
    pub alone: u64,
    /// Other poses in whose rejection it takes part.
    pub with_others: u64,
}

/// What rejects the poses of a grid, in one working mode or in every one.
///
/// Of a leg that is out of reach, the joints have no values, so that its limits reject nothing there. Where every working
/// mode counts, a cause takes part if it rejects the pose in one of them, and its leg reaches the pose in none; with
/// dependent coordinates, in none that gives them the same values.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use opm_workspace::opm_core::Manipulator;
/// use opm_workspace::{Axis, Grid, Modes, Progress, Rejections};
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let axes = vec![Axis::new("x", -0.3, 0.3, 31), Axis::new("y", -0.3, 0.3, 31)];
/// let grid = Grid::new(&manipulator, axes)?;
/// let home = Modes::One(manipulator.home_mode());
/// let found = Rejections::new(&manipulator, &grid, home, &Progress::default())?;
/// let alone: u64 = found.rejections.iter().map(|rejection| rejection.alone).sum();
/// assert!(found.reachable + alone <= found.poses);
/// let any = Rejections::new(&manipulator, &grid, Modes::Any, &Progress::default())?;
/// assert!(any.reachable >= found.reachable);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejections {
    /// The number of poses.
    pub poses: u64,
    /// The number of poses that nothing rejects.
    pub reachable: u64,
    /// The causes that reject any pose, leg by leg: reach first, then the limits in the order of the joints.
    pub rejections: Vec<Rejection>,
}

impl Rejections {
    /// Solves every pose of a grid of whole poses.
    ///
    /// # Errors
    /// The work was cancelled.
    ///
    /// # Panics
    /// If the grid is not one of this manipulator's poses.
    pub fn new(
        manipulator: &Manipulator,
        grid: &Grid,
        modes: Modes,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let causes = Causes::new(manipulator, modes);
        let chunks = grid.poses().div_ceil(CHUNK);
        let none = || Tally::none(&causes);
        let of_chunk = |(mut found, mut tally): (Found, Tally), chunk: u64| {
            let first = chunk * CHUNK;
            let last = (first + CHUNK).min(grid.poses());
            let mut pose = vec![0.0; grid.axes().len()];
            for number in first..last {
                grid.pose_into(number, &mut pose);
                causes.find(&pose, &mut found);
                tally.add(&found);
            }
            progress.advance(last - first)?;
            Ok((found, tally))
        };
        let tally = (0..chunks)
            .into_par_iter()
            .try_fold(|| (causes.none(), none()), of_chunk)
            .map(|part| part.map(|(_, tally)| tally))
            .try_reduce(none, |a, b| Ok(a.merge(&b)))?;
        let rejections = causes.all().iter().zip(&tally.counts);
        let rejections = rejections.map(|(&(leg, cause), &[alone, with_others])| Rejection {
            leg,
            cause,
            alone,
            with_others,
        });
        Ok(Self {
            poses: grid.poses(),
            reachable: tally.reachable,
            rejections: rejections.filter(|r| r.alone + r.with_others > 0).collect(),
        })
    }
}

/// Sums over poses.
#[derive(Clone)]
struct Tally {
    reachable: u64,
    /// For each cause, the poses that it rejects alone, and with others.
    counts: Vec<[u64; 2]>,
}

impl Tally {
    fn none(causes: &Causes<'_>) -> Self {
        Self { reachable: 0, counts: vec![[0; 2]; causes.all().len()] }
    }

    fn add(&mut self, found: &Found) {
        self.reachable += u64::from(found.causes().next().is_none());
        for (cause, part) in found.causes() {
            self.counts[cause][usize::from(part == Part::WithOthers)] += 1;
        }
    }

    fn merge(mut self, other: &Self) -> Self {
        self.reachable += other.reachable;
        for (count, other) in self.counts.iter_mut().zip(&other.counts) {
            (count[0], count[1]) = (count[0] + other[0], count[1] + other[1]);
        }
        self
    }
}
