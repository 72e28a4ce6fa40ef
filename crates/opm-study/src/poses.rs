//! Sources of the poses of a workspace: a sweep, or the files of its shards.

#[cfg(feature = "recording")]
mod shards;

#[cfg(feature = "recording")]
pub use shards::ShardPoses;
#[cfg(feature = "recording")]
pub(crate) use shards::runs_of;

use crate::error::StudyError;
use opm_workspace::{Grid, Hits, Poses, Progress, Sweep};

/// A source of the reachable poses of a grid, in order. It can be read several times.
#[non_exhaustive]
pub enum PoseSource<'a> {
    /// A sweep of the grid.
    Sweep(Sweep<'a>),
    /// The files of all shards.
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
