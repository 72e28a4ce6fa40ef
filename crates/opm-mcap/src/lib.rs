//! MCAP recordings of what a manipulator does: writing them, and reading them back.
//!
//! A recording opens in Foxglove, Lichtblick, Rerun and PlotJuggler. There are three kinds: of a workspace
//! (point clouds), of a motion (joints, bodies, violations), and of a shard of a sweep (numbers of poses).
//! This crate takes plain numbers and names; it knows no manipulators.
//!
//! ```
//! use opm_mcap::{
//!     CloudLayout, Metadata, ReadError, SliceAxis, Slices, Workspace, WorkspaceRecorder, read,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("square.mcap");
//! // Three points in two slices, x y xi, coloured by xi.
//! let layout = CloudLayout {
//!     axes: ["x", "y", "xi"].map(String::from),
//!     scalars: vec![],
//!     color: "xi".into(),
//!     color_range: [0.0, 0.5],
//!     frame_id: "base".into(),
//!     scale: [1.0; 3],
//!     units: ["m", "m", "rad"],
//! };
//! let xi = SliceAxis { name: "xi".into(), unit: "rad", ends: [0.0, 0.5], count: 2 };
//! let workspace = Workspace {
//!     layout,
//!     mechanism_name: "square.toml",
//!     mechanism: b"name = \"square\"",
//!     run: Metadata::new(),
//!     points: 3,
//!     slices: Slices { axes: vec![xi], point_area: 0.1 },
//! };
//! let mut recorder = WorkspaceRecorder::create(&path, &workspace)?;
//! recorder.overview(&[0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.5])?;
//! recorder.push(0, &[0.0, 0.0, 0.0, 0.1, 0.0, 0.0])?;
//! recorder.push(1, &[0.0, 0.0, 0.5])?;
//! recorder.finish(&Metadata::new())?;
//!
//! let mut clouds = 0;
//! let recording = read::<ReadError>(&path, |message| {
//!     clouds += usize::from(message.cloud()?.is_some());
//!     Ok(())
//! })?;
//! assert!(recording.complete);
//! assert_eq!(clouds, 3); // the overview and two slices
//! assert_eq!(recording.topic("/workspace/slices").and_then(|topic| topic.points), Some(3));
//! # Ok(())
//! # }
//! ```
//!
//! # Where to find what
//!
//! | module | content |
//! |---|---|
//! | [`workspace`] | the recording of a workspace: an overview, and every point slice by slice |
//! | [`trajectory`] | the recording of a motion: joints, rates, bodies, violations |
//! | [`slices`] | what the slices of a workspace are |
//! | [`shard`] | the reachable poses of a part of a sweep, by their numbers |
//! | [`table`] | points as NPY for NumPy and PLY for mesh tools |
//! | [`input`] | files of users, read within limits |
//! | [`csv`] | plain numbers as CSV, read and written a row at a time |
//! | [`cloud`] | the layout of the points of a cloud, and how they are packed |
//! | [`scene`] | bodies made of simple solids |
//! | [`rejected`] | points that are not in a workspace, coloured by what rejects them |
//! | [`joints`] | messages that consist of named numbers |
//! | [`layout`] | what a viewer shows of a recording |
//!
//! [`read`] reads every kind. Recordings go to a [`Sink`], usually a [`PartialFile`].
//!
//! # What holds for every recording
//!
//! * Numbers are SI and radians.
//! * Messages are of well-known schemas (`foxglove.PointCloud`), or flat ones that carry their own
//!   ([`joints`]). They are in chunks of 1 MiB, those of points in chunks of 4 MiB, which zstd compresses
//!   on one thread.
//! * No clock is read: the same calls write the same bytes.
//! * A recording is written as `NAME.partial` and gets its name when it is whole. Any error is final, and a
//!   recording that was cut short never looks finished; [`read`] reads what of it reached the disk.

pub mod cloud;
pub mod csv;
mod decode;
mod error;
mod file;
mod flat;
pub mod input;
pub mod joints;
pub mod layout;
mod log;
mod reader;
mod recover;
pub mod rejected;
pub mod scene;
pub mod shard;
pub mod slices;
pub mod table;
pub mod trajectory;
pub mod workspace;

pub use cloud::{CloudLayout, Packer};
pub use decode::{Cloud, Column};
pub use error::{ReadError, RecordError};
pub use file::{PartialFile, Sink, unfinished};
pub use flat::Flat;
pub use layout::{Layout, LayoutError};
#[doc(hidden)]
pub use log::COMPRESSION_LEVEL;
pub use log::Metadata;
pub use reader::{AttachmentInfo, Extent, Message, Recording, TopicInfo, read};
pub use recover::{RECOVERED, RecoverError, Recovered, recover};
pub use rejected::{RejectedCause, RejectedPoints};
pub use scene::{Body, ClosedLine, Shape, Solid};
pub use shard::{Shard, ShardRecorder};
pub use slices::{SliceAxis, SliceReader, Slices};
pub use table::{TableFormat, TableRecorder, table_columns};
pub use trajectory::{
    Coordinate, Frame, Posture, Rates, Role, Sample, Trajectory, TrajectoryRecorder,
};
pub use workspace::{MAX_SLICES, Workspace, WorkspaceRecorder};
