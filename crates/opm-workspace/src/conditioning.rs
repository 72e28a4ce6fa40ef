//! How well a workspace is conditioned: the local index, one over the condition number, at every pose,
//! and their mean, the global index. C. Gosselin, J. Angeles, *A global performance index for the
//! kinematic optimization of robotic manipulators*, J. Mech. Des. 113, 1991.

use crate::condition::{ConditionError, Conditioned, PoseLimit};
use crate::progress::{Cancelled, Progress};
use crate::sweep::{Hits, Sweep};
use opm_core::reach::AT_ONCE;

/// Local indices are summed as whole numbers, in units of one over this: such a sum is the same in any order.
const UNIT: f64 = (1_u64 << 60) as f64;

/// The conditioning indices of the reachable poses of a grid, each in the first working mode that reaches
/// it within all limits. The indices of parts of one grid add up to those of the whole.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Axis, ConditioningIndex, Grid, Modes, Progress, Sweep};
///
/// let axes = vec![Axis::new("x", -0.2, 0.2, 9), Axis::new("y", -0.2, 0.2, 9)];
/// let grid = Grid::new(&manipulator, axes)?;
/// let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
/// let length = manipulator.characteristic_length();
/// let index = ConditioningIndex::of(&sweep, length, &Progress::default())?;
/// let global = index.global().ok_or("nothing is reachable")?;
/// assert!(index.min <= global && global <= index.max);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditioningIndex {
    /// The characteristic length of the condition numbers, metres.
    pub length: f64,
    /// The number of poses that have a local index.
    pub poses: u64,
    /// The least local index; infinite without poses.
    pub min: f64,
    /// The greatest local index, at most one; zero without poses.
    pub max: f64,
    /// The sum of the local indices, in units of 2⁻⁶⁰. As a whole number it does not depend on how a
    /// sweep is divided into parts.
    pub sum: u128,
}

impl ConditioningIndex {
    /// The index of no poses.
    pub fn nothing(length: f64) -> Self {
        Self { length, poses: 0, min: f64::INFINITY, max: 0.0, sum: 0 }
    }

    /// The indices of the poses that a sweep reaches, with a characteristic `length` in metres. This takes a
    /// fraction of a microsecond for each reachable pose.
    ///
    /// # Errors
    /// [`ConditionError`]: a grid of one section alone, a length that is not a positive number or not the
    /// one of the sweep's own limit, or a sweep that was cancelled.
    pub fn of(sweep: &Sweep<'_>, length: f64, progress: &Progress) -> Result<Self, ConditionError> {
        PoseLimit::none(length).check(sweep.manipulator(), sweep.grid())?;
        match sweep.limit() {
            Some(limit) if limit.length() != length => {
                Err(ConditionError::Lengths { index: length, limit: limit.length() })
            }
            _ => Ok(Self::of_checked(sweep, length, progress)?),
        }
    }

    fn of_checked(sweep: &Sweep<'_>, length: f64, progress: &Progress) -> Result<Self, Cancelled> {
        let mut all = Self::nothing(length);
        // What the sweep's limit admits is decided with the indices, once.
        sweep.clone().without_limit().points(
            progress,
            |hits, made: &mut Option<Indexing<'_>>| {
                made.get_or_insert_with(|| Indexing::new(sweep, length)).take(sweep, hits);
            },
            || None,
            |made| {
                if let Some(made) = made {
                    all.add(&made.finish(sweep));
                }
                Ok::<(), Cancelled>(())
            },
        )?;
        Ok(all)
    }

    /// The global conditioning index: the mean of the local ones over the grid's reachable poses, all of
    /// the same weight; `None` if no pose is reachable.
    pub fn global(&self) -> Option<f64> {
        (self.poses > 0).then(|| self.sum as f64 / UNIT / self.poses as f64)
    }

    /// Adds the indices of another part of the same grid, with the same characteristic length.
    pub fn add(&mut self, other: &Self) {
        self.poses += other.poses;
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.sum += other.sum;
    }

    /// Takes the local index of a pose; NaN where it has none.
    fn take(&mut self, local: f64) {
        if local.is_nan() {
            return;
        }
        self.poses += 1;
        self.min = self.min.min(local);
        self.max = self.max.max(local);
        self.sum += (local * UNIT).round() as u128;
    }
}

/// The indices of a block of a sweep, of which some poses are still to be decided.
struct Indexing<'a> {
    index: ConditioningIndex,
    conditioned: Conditioned<'a>,
    /// The poses, row after row.
    poses: Vec<f64>,
}

impl<'a> Indexing<'a> {
    fn new(sweep: &Sweep<'a>, length: f64) -> Self {
        let limit = sweep.limit().cloned().unwrap_or_else(|| PoseLimit::none(length));
        let conditioned = Conditioned::new(sweep.manipulator(), limit);
        Self { index: ConditioningIndex::nothing(length), conditioned, poses: Vec::new() }
    }

    /// Takes poses, as many together as are decided at once.
    fn take(&mut self, sweep: &Sweep<'_>, hits: &Hits<'_>) {
        let width = hits.others.len() + 1;
        for &first in hits.first {
            self.poses.push(first);
            self.poses.extend_from_slice(hits.others);
            if self.poses.len() == AT_ONCE * width {
                self.decide(sweep);
            }
        }
    }

    fn decide(&mut self, sweep: &Sweep<'_>) {
        let mut indices = [0.0; AT_ONCE];
        let indices = &mut indices[..self.poses.len() / sweep.grid().axes().len()];
        self.conditioned.local_indices(&self.poses, sweep.modes(), indices);
        indices.iter().for_each(|&local| self.index.take(local));
        self.poses.clear();
    }

    /// The indices of all poses.
    fn finish(mut self, sweep: &Sweep<'_>) -> ConditioningIndex {
        self.decide(sweep);
        self.index
    }
}
