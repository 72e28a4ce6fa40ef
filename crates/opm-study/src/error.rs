//! Why a study ends early.

mod request;
#[cfg(feature = "recording")]
mod shard;

pub use request::{RequestError, RequestOption, SetPart, Spelling};
#[cfg(feature = "recording")]
pub use shard::{MissingShards, ShardError, ShardProblem};

use opm_core::trajectory::TrajectoryError;
use opm_workspace::{Cancelled, ConditionError, SetError};

#[cfg(feature = "recording")]
use crate::text::located;
#[cfg(feature = "recording")]
use opm_mcap::{ReadError, RecordError};
#[cfg(feature = "recording")]
use std::path::PathBuf;

/// Why a study ends early.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A request that cannot be met.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// It was told to stop.
    #[error("interrupted")]
    Cancelled,
    /// A set that does not fit in memory.
    #[error("{0}")]
    Set(SetError),
    /// A motion that cannot be followed.
    #[error("{}", crate::text::located(motion, error))]
    Trajectory {
        /// The name of the motion.
        motion: String,
        /// Why not.
        error: TrajectoryError,
    },
    /// A linkage whose loop does not close at a value that its input should have.
    #[error("{joint} = {value}: the loop does not close in {branch}")]
    OpenLoop {
        /// The joint that moves the linkage.
        joint: String,
        /// Its value, radians.
        value: f64,
        /// The branch.
        branch: String,
    },
    /// A motion that lasts longer than the clock of a recording can tell.
    #[error("{motion}: lasts {duration:e} s, expected at most {most:e} s")]
    LongMotion {
        /// The name of the motion.
        motion: String,
        /// How long it lasts, seconds.
        duration: f64,
        /// How long it may last, seconds.
        most: f64,
    },
    /// It was told to stop while a recording was written; what there is of it can be read.
    #[cfg(feature = "recording")]
    #[error("interrupted; what was recorded is in {}", partial.display())]
    CancelledRecording {
        /// The unfinished file.
        partial: PathBuf,
    },
    /// A file that cannot be written, or a value that cannot be stored.
    #[cfg(feature = "recording")]
    #[error("{}", located(place, error))]
    Record {
        /// The file.
        place: String,
        /// Why not.
        error: RecordError,
    },
    /// A file that cannot be read.
    #[cfg(feature = "recording")]
    #[error("{}", located(place, error))]
    Read {
        /// The file.
        place: String,
        /// Why not.
        error: ReadError,
    },
    /// A pose that the sweep counts, and inverse kinematics does not reach.
    #[error("the sweep counts the pose {pose:?}, but inverse kinematics does not reach it")]
    LostPose {
        /// The task coordinates.
        pose: Vec<f64>,
    },
    /// A file that is not the shard it should be.
    #[cfg(feature = "recording")]
    #[error(transparent)]
    Shard(#[from] ShardError),
    /// It was told to stop while a shard was written; what there is of it is of no use.
    #[cfg(feature = "recording")]
    #[error("interrupted; {} is no whole shard: sweep it again", partial.display())]
    CancelledShard {
        /// The unfinished file.
        partial: PathBuf,
    },
    /// A condition number that is asked for where there is none.
    #[error(transparent)]
    Condition(ConditionError),
    /// No shards at all.
    #[error("there are no shards to join")]
    NoShards,
    /// A recording of a set, of which the points are not known.
    #[error("there is no set to record: its points have to be analysed first")]
    NoSet,
    /// Shards that are missing.
    #[cfg(feature = "recording")]
    #[error(transparent)]
    MissingShards(#[from] MissingShards),
    /// Whoever takes what is read has gone.
    #[error("nobody takes what is read")]
    Closed,
}

#[cfg(feature = "recording")]
impl StudyError {
    /// A file that cannot be written.
    pub(crate) fn record(place: impl std::fmt::Display, error: RecordError) -> Self {
        Self::Record { place: place.to_string(), error }
    }
}

impl From<Cancelled> for StudyError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<ConditionError> for StudyError {
    fn from(error: ConditionError) -> Self {
        match error {
            ConditionError::Cancelled(_) => Self::Cancelled,
            other => Self::Condition(other),
        }
    }
}

impl From<SetError> for StudyError {
    fn from(error: SetError) -> Self {
        match error {
            SetError::Cancelled(_) => Self::Cancelled,
            other => Self::Set(other),
        }
    }
}
