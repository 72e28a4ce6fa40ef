//! Where the poses of a workspace come from: a sweep, or the files in which sweeps of its shards left them.

#[cfg(feature = "recording")]
mod shards;

#[cfg(feature = "recording")]
pub use shards::ShardPoses;
#[cfg(feature = "recording")]
pub(crate) use shards::runs_of;

use crate::error::StudyError;
use opm_workspace::{Grid, Hits, Poses, Progress, Sweep};

/// Gives the reachable poses of a grid, in order, as often as asked for.
#[non_exhaustive]
pub enum PoseSource<'a> {
    /// By sweeping.
    Sweep(Sweep<'a>),
    /// From the files of all shards.
    #[cfg(feature = "recording")]
    Shards(ShardPoses<'a>),
}

impl Poses for PoseSource<'_> {
    type Error = StudyError;

    fn grid(&self) -> &Grid {
        match self {
            Self::Sweep(sweep) => sweep.grid(),
            #[cfg(feature = "recording")]
            Self::Shards(shards) => shards.grid(),
        }
    }

    fn points<T: Send>(
        &self,
        progress: &Progress,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        empty: impl Fn() -> T + Sync,
        visit: impl FnMut(T) -> Result<(), StudyError> + Send,
    ) -> Result<(), StudyError> {
        match self {
            Self::Sweep(sweep) => sweep.points(progress, make, empty, visit),
            #[cfg(feature = "recording")]
            Self::Shards(shards) => shards.points(progress, make, empty, visit),
        }
    }
}
