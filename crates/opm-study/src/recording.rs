//! Recordings: the data that are stored for a workspace, a motion, a linkage or a shard, and the files that
//! hold them.
//!
//! The same study gives the same bytes from every front end.

mod describe;
mod judged;
mod linkage;
mod motion;
mod points;
mod rejected;
mod scale;
mod scene;
mod set;
mod shard;
mod shards;
mod slices;
mod table;
mod workspace;

pub use describe::inscribed_of;
pub use linkage::record_linkage;
pub use motion::{MotionRecorder, violation_fields};
pub use rejected::class_color;
pub use shard::{ShardCount, ShardFindings, ShardRecording, StoredShard};
pub use shards::Shards;
pub use slices::slices_together;
pub use table::{TableOptions, is_motion_table, write_motion_csv, write_motion_table};
pub use workspace::{Findings, WorkspaceRecording};

use crate::error::{RequestError, StudyError};
use opm_mcap::{Metadata, PartialFile};
use std::path::{Path, PathBuf};

/// The program that writes the files.
pub(crate) const PROGRAM: &str = concat!("opm ", env!("CARGO_PKG_VERSION"));

/// A file that is attached to a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attachment<'a> {
    /// The file name, without folders.
    pub name: &'a str,
    /// The text of the file.
    pub text: &'a str,
}

/// The name of a file until it is complete.
pub fn partial(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

/// Where an unfinished recording is recovered to if nothing is said: `NAME.mcap.partial` to `NAME.recovered.mcap`.
pub fn recovered_name(path: &Path) -> PathBuf {
    let name = path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let stem = name.strip_suffix(".partial").unwrap_or(&name);
    let stem = stem.strip_suffix(".mcap").unwrap_or(stem);
    path.with_file_name(format!("{stem}.recovered.mcap"))
}

/// Checks that a name ends in `.mcap`, for content that is written as MCAP only.
///
/// # Errors
/// [`RequestError::ContentIsMcap`], or [`RequestError::StandardOutput`]
pub fn expect_mcap(path: &Path, content: &'static str) -> Result<(), RequestError> {
    check_mcap(path, || RequestError::ContentIsMcap { path: path.to_owned(), content })
}

fn check_mcap(path: &Path, wrong: impl FnOnce() -> RequestError) -> Result<(), RequestError> {
    refuse_standard_output(path)?;
    let is_mcap = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap"));
    if is_mcap { Ok(()) } else { Err(wrong()) }
}

/// Refuses standard output: a recording has a temporary name until it is complete.
fn refuse_standard_output(path: &Path) -> Result<(), RequestError> {
    if path == Path::new("-") { Err(RequestError::StandardOutput) } else { Ok(()) }
}

/// Opens a file before the work starts, so that a wrong path costs no time.
fn create(path: &Path) -> Result<PartialFile, StudyError> {
    refuse_standard_output(path)?;
    PartialFile::create(path).map_err(|error| StudyError::record(path.display(), error))
}

/// A metadata record.
fn record<const N: usize>(pairs: [(&str, String); N]) -> Metadata {
    pairs.map(|(key, value)| (key.to_owned(), value)).into()
}
