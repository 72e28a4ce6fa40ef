//! What rejects the poses of a grid: the legs that do not reach them, and the joints that are past a limit there.

mod causes;

use self::causes::{CauseRole, Causes, PoseCauses};
use crate::grid::Grid;
use crate::ordered::in_order;
use crate::progress::{Cancelled, Progress};
use crate::sweep::Modes;
use opm_core::manipulator::{Manipulator, Section};
use rayon::prelude::*;
use std::ops::Range;

/// Poses between two looks at whether the work was cancelled.
const CHUNK: u64 = 1024;

/// What rejects a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// A section of the leg does not close; `None` for a leg that is solved whole.
    Reach(Option<Section>),
    /// A joint coordinate, by its number in [`Manipulator::coordinates`], is below its lowest value.
    Lowest(usize),
    /// A joint coordinate is above its highest value.
    Highest(usize),
    /// A joint is beyond its cone, by the number of its first coordinate.
    Cone(usize),
    /// A difference of joints, by its number in [`Manipulator::differences`], is beyond its limits.
    Difference(usize),
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
        let of_chunk = |(mut found, mut tally): (PoseCauses, Tally), chunk: u64| {
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

/// A point of a set that is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RejectedPoint {
    /// Its number among the points of the set.
    pub point: u64,
    /// The number of the first of its poses in the grid.
    pub pose: u64,
    /// The number of its poses that are reached.
    pub reached: u64,
    /// What rejects most of the others: its number in [`Rejections::rejections`], or `None` where most of them have several
    /// causes.
    pub cause: Option<usize>,
}

/// A set of points, each of which stands for the poses of a grid that have the same coordinates there.
#[derive(Clone, Debug)]
pub struct PointsOf<'a> {
    /// The grid.
    pub grid: &'a Grid,
    /// The axes whose coordinates the points have.
    pub axes: Range<usize>,
    /// The number of poses that have to be reached for a point to be in the set.
    pub required: u64,
}

impl PointsOf<'_> {
    fn counts(&self, axes: Range<usize>) -> u64 {
        self.grid.axes()[axes].iter().map(|axis| axis.count).product()
    }

    /// The number of points.
    pub fn points(&self) -> u64 {
        self.counts(self.axes.clone())
    }

    /// The numbers of a point's poses.
    fn poses(&self, point: u64) -> impl Iterator<Item = u64> + use<> {
        let (before, points) = (self.counts(0..self.axes.start), self.points());
        let after = self.counts(self.axes.end..self.grid.axes().len());
        (0..after).flat_map(move |slow| {
            (0..before).map(move |fast| fast + before * (point + points * slow))
        })
    }
}

impl Rejections {
    /// Visits each point of a set that is rejected, in the order of their numbers. The poses are solved once more.
    ///
    /// # Errors
    /// The first error of `visit`, or the work was cancelled.
    pub fn points<E: From<Cancelled> + Send>(
        &self,
        manipulator: &Manipulator,
        modes: Modes,
        set: &PointsOf<'_>,
        progress: &Progress,
        visit: impl FnMut(RejectedPoint) -> Result<(), E> + Send,
    ) -> Result<(), E> {
        let causes = Causes::new(manipulator, modes);
        let row = |&(leg, cause): &(usize, Cause)| {
            self.rejections.iter().position(|known| (known.leg, known.cause) == (leg, cause))
        };
        let rows: Vec<Option<usize>> = causes.all().iter().map(row).collect();
        let (points, each) = (set.points(), set.grid.poses() / set.points().max(1));
        let together = (CHUNK / each.max(1)).max(1);
        let chunks = (0..points.div_ceil(together)).map(Ok);
        let made = || (causes.none(), vec![0.0; set.grid.axes().len()]);
        let make = |(found, pose): &mut (PoseCauses, Vec<f64>), chunk: u64| {
            let (first, last) = (chunk * together, ((chunk + 1) * together).min(points));
            let mut rejected = Vec::new();
            for point in first..last {
                // The poses with several causes, then those with each cause alone.
                let (mut reached, mut votes) = (0, vec![0_u64; 1 + self.rejections.len()]);
                for number in set.poses(point) {
                    set.grid.pose_into(number, pose);
                    causes.find(pose, found);
                    match only(found) {
                        None => reached += 1,
                        Some(cause) => {
                            votes[cause.and_then(|i| rows[i]).map_or(0, |row| 1 + row)] += 1;
                        }
                    }
                }
                if reached >= set.required {
                    continue;
                }
                let most = votes.iter().copied().max().unwrap_or_default();
                let cause = votes.iter().position(|&count| count == most).unwrap_or_default();
                let pose = set.poses(point).next().unwrap_or_default();
                rejected.push(RejectedPoint { point, pose, reached, cause: cause.checked_sub(1) });
            }
            progress.advance((last - first) * each)?;
            Ok(rejected)
        };
        let mut visit = visit;
        in_order(chunks, made, make, |rejected: Vec<RejectedPoint>| {
            rejected.into_iter().try_for_each(&mut visit)
        })
    }
}

/// The only cause of a pose, or `None` within where it has several; `None` where it is reached.
fn only(found: &PoseCauses) -> Option<Option<usize>> {
    let mut causes = found.causes();
    let (first, _) = causes.next()?;
    Some(causes.next().is_none().then_some(first))
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

    fn add(&mut self, found: &PoseCauses) {
        self.reachable += u64::from(found.causes().next().is_none());
        for (cause, part) in found.causes() {
            self.counts[cause][usize::from(part == CauseRole::WithOthers)] += 1;
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
