//! How well a workspace is conditioned: the local index, one over the condition number, at every pose,
//! and their mean, the global one. C. Gosselin, J. Angeles, *A global performance index for the kinematic
//! optimization of robotic manipulators*, J. Mech. Des. 113, 1991.

use crate::condition::{ConditionLimit, Conditioned};
use crate::progress::{Cancelled, Progress};
use crate::sweep::Sweep;

/// Local indices are summed as whole numbers of this part of one: such a sum is the same in any order.
const UNIT: f64 = (1_u64 << 60) as f64;

/// Local conditioning indices of the reachable poses of a grid, each in the first working mode that
/// reaches it within all limits. Those of parts of one grid add up to those of the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConditioningIndex {
    /// The characteristic length of the condition numbers, metres.
    pub length: f64,
    /// Poses that have one.
    pub poses: u64,
    /// The least.
    pub min: f64,
    /// The greatest, one at most.
    pub max: f64,
    /// Of all, in units of 2⁻⁶⁰: a whole number, so that however a sweep is cut, the parts add up to it.
    pub sum: u128,
}

impl ConditioningIndex {
    /// Of no poses.
    pub fn nothing(length: f64) -> Self {
        Self { length, poses: 0, min: f64::INFINITY, max: 0.0, sum: 0 }
    }

    /// Sweeps a grid of poses, a few microseconds a reachable pose. Where the sweep has a limit on the
    /// condition number, that has to be meant with the same length.
    ///
    /// # Panics
    /// On a grid of one section alone, and on a length that is not positive.
    ///
    /// # Errors
    /// When told to stop.
    pub fn new(sweep: &Sweep<'_>, length: f64, progress: &Progress) -> Result<Self, Cancelled> {
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

    /// The global conditioning index: the mean of the local ones over the grid's reachable poses, each
    /// of the same weight; `None` where there is none.
    pub fn global(&self) -> Option<f64> {
        (self.poses > 0).then(|| self.sum as f64 / UNIT / self.poses as f64)
    }

    /// Adds those of another part of the same grid.
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
