//! Sources of the poses of a workspace: a sweep, or the files of its shards.

#[cfg(feature = "recording")]
mod shards;

#[cfg(feature = "recording")]
pub use shards::ShardPoses;
#[cfg(feature = "recording")]
pub(crate) use shards::runs_of;

use crate::error::StudyError;
use opm_workspace::{Grid, Hits, Poses, Progress, Run, Sweep, replay};

/// A source of the reachable poses of a grid, in order. It can be read several times.
#[non_exhaustive]
pub enum PoseSource<'a> {
    /// A sweep of the grid.
    Sweep(Box<Sweep<'a>>),
    /// The numbers of the poses, which a sweep of the grid found.
    Kept(&'a Grid, Vec<Run>),
    /// The files of all shards.
    #[cfg(feature = "recording")]
    Shards(ShardPoses<'a>),
}

impl PoseSource<'_> {
    /// Whether the numbers of the poses are in memory, so that reading them again takes little time.
    pub fn are_kept(&self) -> bool {
        matches!(self, Self::Kept(..))
    }
}

impl Poses for PoseSource<'_> {
    type Error = StudyError;

    fn grid(&self) -> &Grid {
        match self {
            Self::Sweep(sweep) => sweep.grid(),
            Self::Kept(grid, _) => grid,
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
            Self::Kept(grid, runs) => {
                replay(grid, runs.iter().copied().map(Ok), progress, make, empty, visit)
            }
            #[cfg(feature = "recording")]
            Self::Shards(shards) => shards.points(progress, make, empty, visit),
        }
    }
}
