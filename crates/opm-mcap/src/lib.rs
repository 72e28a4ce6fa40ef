//! MCAP recordings of what a manipulator does, and reading them back.
//!
//! A recording opens in Foxglove, Lichtblick and Rerun. Its messages are of well-known schemas
//! (`foxglove.PointCloud`), or flat ones that carry their own ([`joints`]), in chunks of 1 MiB, of points 4 MiB,
//! compressed with zstd on one thread. What is in a recording is said in [`workspace`] and
//! [`trajectory`], what in a part of a sweep in [`shard`], and
//! as what else points can be written in [`table`].
//!
//! * Numbers are SI and radians.
//! * No clock is read: the same calls write the same bytes.
//! * A recording is written as `NAME.partial` and gets its name when it is whole. Any error is
//!   final, and a recording cut short never looks finished; what of it reached the disk can be read
//!   ([`read`]).

pub mod cloud;
mod decode;
mod error;
mod file;
mod flat;
pub mod joints;
mod log;
mod reader;
pub mod scene;
pub mod shard;
pub mod table;
pub mod trajectory;
pub mod workspace;

pub use cloud::{CloudLayout, Packer};
pub use decode::{Cloud, Column};
pub use error::{ReadError, RecordError};
pub use file::{PartialFile, Sink};
pub use flat::Flat;
pub use log::{COMPRESSION_LEVEL, Metadata};
pub use reader::{AttachmentInfo, Extent, Message, Recording, TopicInfo, read};
pub use scene::ClosedLine;
pub use shard::{Shard, ShardRecorder};
pub use table::{TableFormat, TableRecorder, table_columns};
pub use trajectory::{Trajectory, TrajectoryRecorder};
pub use workspace::{MAX_SLICES, Workspace, WorkspaceRecorder};
