//! How well a workspace is conditioned: the local index, one over the condition number, at every pose,
//! and their mean, the global index. C. Gosselin, J. Angeles, *A global performance index for the
//! kinematic optimization of robotic manipulators*, J. Mech. Des. 113, 1991.

use crate::condition::{ConditionError, ConditionLimit, Conditioned};
use crate::progress::{Cancelled, Progress};
use crate::sweep::Sweep;

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
    /// few microseconds for each reachable pose.
    ///
    /// # Errors
    /// [`ConditionError`]: a grid of one section alone, a length that is not a positive number or not the
    /// one of the sweep's own limit, or a sweep that was cancelled.
    pub fn of(sweep: &Sweep<'_>, length: f64, progress: &Progress) -> Result<Self, ConditionError> {
        ConditionLimit::none(length).check(sweep.grid())?;
        match sweep.limit() {
            Some(limit) if limit.length != length => {
                Err(ConditionError::Lengths { index: length, limit: limit.length })
            }
            _ => Ok(Self::of_checked(sweep, length, progress)?),
        }
    }

    fn of_checked(sweep: &Sweep<'_>, length: f64, progress: &Progress) -> Result<Self, Cancelled> {
        let nothing = Self::nothing(length);
        let limit = sweep.limit().unwrap_or(ConditionLimit::none(length));
        let mut all = nothing;
        sweep.points(
            progress,
            |hits, (index, conditioned): &mut (Self, Option<Conditioned<'_>>)| {
                let conditioned =
                    conditioned.get_or_insert_with(|| Conditioned::new(sweep.manipulator(), limit));
                let mut pose = vec![0.0; hits.others.len() + 1];
                pose[1..].copy_from_slice(hits.others);
                for &first in hits.first {
                    pose[0] = first;
                    if let Some(local) = conditioned.local_index(&pose, sweep.modes()) {
                        index.take(local);
                    }
                }
            },
            || (nothing, None),
            |(index, _)| {
                all.add(&index);
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

    fn take(&mut self, local: f64) {
        self.poses += 1;
        self.min = self.min.min(local);
        self.max = self.max.max(local);
        self.sum += (local * UNIT).round() as u128;
    }
}
