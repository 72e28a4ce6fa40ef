//! What rejects the poses of a grid: the legs that do not reach them, and the joints that are past a limit there.

use crate::grid::Grid;
use crate::progress::{Cancelled, Progress};
use opm_core::group::JointDisplacement;
use opm_core::manipulator::{Manipulator, Mode, Section, Solution};
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
    /// Poses that nothing else rejects.
    pub alone: u64,
    /// Poses that other causes reject too.
    pub with_others: u64,
}

/// What rejects the poses of a grid in one working mode.
///
/// Of a leg that is out of reach, the joints have no values, so that its limits reject nothing there.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// use opm_workspace::opm_core::Manipulator;
/// use opm_workspace::{Axis, Grid, Progress, Rejections};
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let axes = vec![Axis::new("x", -0.3, 0.3, 31), Axis::new("y", -0.3, 0.3, 31)];
/// let grid = Grid::new(&manipulator, axes)?;
/// let found = Rejections::new(&manipulator, &grid, manipulator.home_mode(), &Progress::default())?;
/// let alone: u64 = found.rejections.iter().map(|rejection| rejection.alone).sum();
/// assert!(found.reachable + alone <= found.poses);
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
        mode: Mode,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let causes = Causes::new(manipulator);
        let chunks = grid.poses().div_ceil(CHUNK);
        let none = || Tally::none(&causes);
        let of_chunk = |(solution, mut tally): (Solution, Tally), chunk: u64| {
            let first = chunk * CHUNK;
            let last = (first + CHUNK).min(grid.poses());
            let (mut pose, mut found) = (vec![0.0; grid.axes().len()], Vec::new());
            let mut solution = solution;
            for number in first..last {
                grid.pose_into(number, &mut pose);
                causes.find(manipulator, &pose, mode, &mut solution, &mut found);
                tally.add(&found);
            }
            progress.advance(last - first)?;
            Ok((solution, tally))
        };
        let tally = (0..chunks)
            .into_par_iter()
            .try_fold(|| (manipulator.solution(), none()), of_chunk)
            .map(|part| part.map(|(_, tally)| tally))
            .try_reduce(none, |a, b| Ok(a.merge(&b)))?;
        let rejections = causes.all.iter().zip(&tally.counts);
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

/// Every cause that there may be, with its leg.
struct Causes {
    all: Vec<(usize, Cause)>,
    /// The leg of each joint coordinate.
    legs: Vec<usize>,
}

impl Causes {
    fn new(manipulator: &Manipulator) -> Self {
        let legs = manipulator.mechanism().legs.iter().enumerate();
        let legs: Vec<usize> = legs
            .flat_map(|(number, leg)| {
                let coordinates = leg.joints.iter().map(|joint| joint.coordinates.len()).sum();
                std::iter::repeat_n(number, coordinates)
            })
            .collect();
        let mut all = Vec::new();
        for leg in 0..manipulator.mechanism().legs.len() {
            all.extend(
                [Section::Lower, Section::Upper].map(|section| (leg, Cause::Reach(section))),
            );
            for joint in (0..legs.len()).filter(|&joint| legs[joint] == leg) {
                all.extend([(leg, Cause::Lowest(joint)), (leg, Cause::Highest(joint))]);
            }
        }
        Self { all, legs }
    }

    /// Finds the numbers of the causes that reject a pose.
    fn find(
        &self,
        manipulator: &Manipulator,
        pose: &[f64],
        mode: Mode,
        solution: &mut Solution,
        found: &mut Vec<usize>,
    ) {
        found.clear();
        let number = |leg: usize, cause: Cause| {
            self.all.iter().position(|known| *known == (leg, cause)).unwrap_or_default()
        };
        let reached = manipulator.inverse(pose, mode, solution).expect("a pose of the grid");
        if reached.is_some_and(Solution::within_limits) {
            return;
        }
        for missed in solution.unreachable() {
            found.push(number(missed.leg, Cause::Reach(missed.section)));
        }
        let tied = !manipulator.dependent_coordinates().is_empty() && !found.is_empty();
        if tied && !matches!(manipulator.dependent_values(pose, mode), Ok(Some(_))) {
            // Without its dependent coordinates, the pose says nothing of the joints.
            return;
        }
        let closed = |leg: usize| solution.unreachable().iter().all(|missed| missed.leg != leg);
        let mut nearest = (f64::INFINITY, None);
        for (joint, limits) in manipulator.limits().iter().enumerate() {
            let leg = self.legs[joint];
            let value = solution.joints()[joint] - manipulator.coordinates()[joint].home;
            let (low, high) = limits.range();
            if !closed(leg) {
                continue;
            }
            let past = [(low - value, Cause::Lowest(joint)), (value - high, Cause::Highest(joint))];
            let (by, cause) = if past[0].0 > past[1].0 { past[0] } else { past[1] };
            if !limits.admits(JointDisplacement::Value(value)) {
                found.push(number(leg, cause));
            } else if by.abs() < nearest.0 {
                nearest = (by.abs(), Some(number(leg, cause)));
            }
        }
        if found.is_empty() {
            // It is past a limit by rounding of an angle alone.
            found.extend(nearest.1);
        }
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
    fn none(causes: &Causes) -> Self {
        Self { reachable: 0, counts: vec![[0; 2]; causes.all.len()] }
    }

    fn add(&mut self, found: &[usize]) {
        match found {
            [] => self.reachable += 1,
            [only] => self.counts[*only][0] += 1,
            several => several.iter().for_each(|&cause| self.counts[cause][1] += 1),
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
