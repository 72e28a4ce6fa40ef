//! Studies of overconstrained parallel manipulators: requests of workspaces and motions, their results, and
//! the contents of their recordings.
//!
//! This crate stands between the engines (`opm-core` computes poses, `opm-workspace` sweeps grids of them,
//! `opm-mcap` writes files) and the front ends (the command line, Python). It reads no flags and prints
//! nothing. Every front end takes the same steps:
//!
//! ```text
//! WorkspaceRequest -> check -> fit -> Workspace -> analyse -> Analysis -> WorkspaceRecording
//! ```
//!
//! # Example
//!
//! The dexterous workspace of a mechanism as a set, its boundary, and its recording:
//!
//! ```
//! use opm_core::Manipulator;
//! use opm_core::mechanism::examples;
//! use opm_study::recording::{Attachment, Findings, WorkspaceRecording};
//! use opm_study::{PointOptions, WorkspaceKind, WorkspaceRequest};
//! use opm_workspace::{Axis, Progress};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let example = examples::find("plano-spherical-5dof").ok_or("no such example")?;
//! let manipulator = Manipulator::read(example.text)?;
//!
//! let progress = Progress::default();
//! let workspace = WorkspaceRequest::new(WorkspaceKind::Dexterous)
//!     .axis(Axis::new("x", -0.1, 0.1, 41))
//!     .axis(Axis::new("y", -0.1, 0.1, 41))
//!     .axis(Axis::new("xi", -0.2, 0.2, 5))
//!     .resolve(manipulator, &progress)?;
//! let analysis = workspace.analyse(&progress)?;
//!
//! let set = analysis.set.as_ref().ok_or("no set")?;
//! let boundary = analysis.boundary().ok_or("no boundary")?;
//! assert_eq!(set.count(), analysis.count.reachable);
//! assert!(boundary[0].area() > 0.0);
//!
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("dexterous.mcap");
//! let points = PointOptions::default().choose(workspace.kind(), workspace.manipulator(), workspace.setup())?;
//! let recording = WorkspaceRecording::of_workspace(&path, &workspace, points)?;
//! let mechanism = Attachment { name: "plano-spherical-5dof.toml", text: example.text };
//! let poses = &workspace.poses();
//! let (workspace, analysis) = (&workspace, &analysis);
//! let findings = Findings { mechanism, workspace, poses, analysis, inscribed: None, rejections: None };
//! recording.write(&findings, &progress)?;
//! assert!(path.is_file());
//! # Ok(())
//! # }
//! ```
//!
//! # Modules
//!
//! | | |
//! |---|---|
//! | [`WorkspaceKind`] | kinds of workspace, and which points belong to each |
//! | [`WorkspaceRequest`] | a request; [`RequestError`] names the [`RequestOption`] that is wrong |
//! | [`Workspace`] | a request that is checked and complete |
//! | [`AccuracyRequest`], [`Drawing`] | errors of parts and actuators over the poses of a grid, and drawn at random |
//! | [`BoxRequest`] | the worst pose errors over a box of poses, with a guaranteed bound |
//! | [`Analysis`] | the results: counts, set, shape, conditioning |
//! | [`SetupOptions`] | what poses are judged by: load, gravity, springs |
//! | [`PointOptions`] | which values a recording stores of every point |
//! | [`MotionRequest`], [`LinkageRound`] | motions of a platform, rounds of a single loop |
//! | [`Tracker`] | forward kinematics of a series, each pose near the last |
//! | [`recording`] | recordings, tables and shards, in files: with the feature `recording`, which is on by default |
//!
//! Work runs on the current thread pool of rayon. [`opm_workspace::Progress`] reports how far it has come,
//! and can cancel it.

mod accuracy;
mod accuracy_box;
mod analysis;
mod columns;
mod error;
mod inscribed;
mod kind;
mod linkage;
mod measure;
mod motion;
mod names;
mod poses;
#[cfg(feature = "recording")]
pub mod recording;
mod request;
mod setup;
pub mod text;
mod tracker;
mod workspace;

pub use accuracy::{AccuracyField, AccuracyRequest, AccuracyRow, Drawing, MOST_SAMPLES};
pub use accuracy_box::{BOX_BUDGET, Bounded, BoxError, BoxErrors, BoxRequest};
pub use analysis::{Analysis, Shape};
pub use columns::{
    AxisScale, Column, NamedColumn, PointChoice, PointColumns, PointOptions,
    efforts as effort_names,
};
#[cfg(feature = "recording")]
pub use error::{MissingShards, ShardError, ShardProblem};
pub use error::{RequestError, RequestOption, SetPart, Spelling, StudyError};
pub use kind::{PosePart, UnknownKind, WorkspaceKind};
pub use linkage::{LinkageRound, RoundSummary, input_intervals};
pub use measure::{Measure, unit_product};
pub use motion::{
    Bearing, Contacts, CoordinateRanges, DEFAULT_RATE, Duty, MOST_LISTED, MotionRequest,
    MotionSummary, Range,
};
pub use names::{ASPECT, INVERSE_CONDITION, NO_AXIS, SHARE, TIP};
pub use poses::PoseSource;
#[cfg(feature = "recording")]
pub use poses::ShardPoses;
pub use request::{CheckedRequest, WorkspaceRequest, characteristic_length};
pub use setup::{
    SetupOptions, SpringOptions, fields as setup_fields, of_fields as setup_of_fields,
};
pub use tracker::Tracker;
pub use workspace::Workspace;

/// A shipped mechanism, for the tests.
#[cfg(test)]
fn example() -> opm_core::Manipulator {
    opm_core::Manipulator::example("plano-spherical-5dof").expect("a shipped example")
}
