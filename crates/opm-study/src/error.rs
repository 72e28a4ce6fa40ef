//! Why a study ends early.

mod request;
#[cfg(feature = "recording")]
mod shard;

pub use request::{RequestError, RequestOption, SetPart, Spelling};
#[cfg(feature = "recording")]
pub use shard::{MissingShards, ShardError, ShardProblem};

use opm_core::linkage::NoCycle;
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
    /// The request cannot be met.
    #[error(transparent)]
    Request(#[from] RequestError),
    /// The work was cancelled.
    #[error("interrupted")]
    Cancelled,
    /// A set does not fit in memory.
    #[error("{0}")]
    Set(SetError),
    /// A motion cannot be followed.
    #[error("{}", crate::text::located(motion, error))]
    Trajectory {
        /// The name of the motion.
        motion: String,
        /// The cause.
        error: TrajectoryError,
    },
    /// The loop of a linkage does not close at a value within the range of its input.
    #[error("{joint} = {value}: the loop does not close in {branch}")]
    OpenLoop {
        /// The joint that moves the linkage.
        joint: String,
        /// Its value, radians or metres.
        value: f64,
        /// The branch.
        branch: String,
    },
    /// A linkage does not come back to home.
    #[error(transparent)]
    NoCycle(#[from] NoCycle),
    /// A motion lasts longer than the clock of a recording can count.
    #[error("{motion}: lasts {duration:e} s, expected at most {most:e} s")]
    LongMotion {
        /// The name of the motion.
        motion: String,
        /// How long it lasts, seconds.
        duration: f64,
        /// How long it may last, seconds.
        most: f64,
    },
    /// The work was cancelled while a recording was written. The unfinished file can be read.
    #[cfg(feature = "recording")]
    #[error("interrupted; what was recorded is in {}", partial.display())]
    CancelledRecording {
        /// The unfinished file.
        partial: PathBuf,
    },
    /// A file cannot be written, or a value cannot be stored.
    #[cfg(feature = "recording")]
    #[error("{}", located(place, error))]
    Record {
        /// The file.
        place: String,
        /// The cause.
        error: RecordError,
    },
    /// A file cannot be read.
    #[cfg(feature = "recording")]
    #[error("{}", located(place, error))]
    Read {
        /// The file.
        place: String,
        /// The cause.
        error: ReadError,
    },
    /// A pose is counted by the sweep, but inverse kinematics does not reach it.
    #[error("the sweep counts the pose {pose:?}, but inverse kinematics does not reach it")]
    LostPose {
        /// The task coordinates.
        pose: Vec<f64>,
    },
    /// A file is not the expected shard.
    #[cfg(feature = "recording")]
    #[error(transparent)]
    Shard(#[from] ShardError),
    /// The work was cancelled while a shard was written. The unfinished file is of no use.
    #[cfg(feature = "recording")]
    #[error("interrupted; {} is not a complete shard: sweep that shard again", partial.display())]
    CancelledShard {
        /// The unfinished file.
        partial: PathBuf,
    },
    /// A condition number is requested, but not defined.
    #[error(transparent)]
    Condition(ConditionError),
    /// There are no shards.
    #[error("there are no shards to join")]
    NoShards,
    /// A set is to be recorded, but its points are not known.
    #[error("there is no set to record: analyse the workspace first")]
    NoSet,
    /// Shards are missing.
    #[cfg(feature = "recording")]
    #[error(transparent)]
    MissingShards(#[from] MissingShards),
    /// The receiver of the data has stopped.
    #[error("the receiver of the data has stopped")]
    Closed,
}

#[cfg(feature = "recording")]
impl StudyError {
    /// The error for a file that cannot be written.
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
