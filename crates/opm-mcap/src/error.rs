//! The errors of writing and reading recordings, with what was found and what was expected.

use std::path::PathBuf;

/// Why a recording could not be written. Every error is final: the recorder that returned it refuses all
/// further work, and nothing appears under the name of the recording.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The file could not be opened for writing.
    #[error("cannot create {}", path.display())]
    Create {
        /// The `.partial` file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// A directory or a device already has the name of the recording.
    #[error("{} exists and is not a regular file", path.display())]
    NotAFile {
        /// The name of the recording.
        path: PathBuf,
    },
    /// Another process writes a recording of the same name.
    #[error("{} is being written by another process", path.display())]
    Busy {
        /// The `.partial` file.
        path: PathBuf,
    },
    /// Writing failed: a full disk, a vanished mount.
    #[error("cannot write the recording")]
    Io(#[source] std::io::Error),
    /// The MCAP file could not be put together.
    #[error("cannot assemble the recording")]
    Mcap(#[source] mcap::McapError),
    /// An earlier error ended this recording.
    #[error("the recording was given up after an earlier error")]
    AfterFailure,
    /// The cloud's description contradicts itself.
    #[error("cloud layout: {0}")]
    Layout(String),
    /// A row does not have the layout's number of values.
    #[error("{values} values are not a whole number of rows of {columns}")]
    Row {
        /// The number of values that were given.
        values: usize,
        /// The number of values in a row.
        columns: usize,
    },
    /// Messages came out of order.
    #[error("a message at {time} ns after one at {last} ns")]
    Time {
        /// The time of the message, nanoseconds.
        time: u64,
        /// The time of the message before it, nanoseconds.
        last: u64,
    },
    /// A value that a float32 cannot hold as a finite number.
    #[error("{column} of point {point} is {value}, expected a finite float32")]
    NonFinite {
        /// The name of the column.
        column: String,
        /// The number of the point in its message.
        point: usize,
        /// The value.
        value: f64,
    },
    /// Slices came out of order, or past the last one.
    #[error("slice {slice} is not in {first}..{end}")]
    Slice {
        /// The number of the slice that was given.
        slice: u64,
        /// The number of the first slice that may still get points.
        first: u64,
        /// One past the last slice.
        end: u64,
    },
    /// More slices than a recording may have.
    #[error("{slices} slices, expected at most {limit}")]
    TooManySlices {
        /// The number of slices that was announced.
        slices: u64,
        /// The largest number, [`crate::MAX_SLICES`].
        limit: u64,
    },
    /// A slice has more points than its 100 ms have room for messages.
    #[error("slice {slice} needs more than {limit} messages")]
    SliceTooLarge {
        /// The number of the slice.
        slice: u64,
        /// The number of messages that fit in the time of one slice.
        limit: u64,
    },
    /// The number of points is not the one that was announced.
    #[error("{what}: {found} points, expected {expected}")]
    Count {
        /// What has the wrong number of points: `overview`, `slices` or `table`.
        what: &'static str,
        /// The number of points that were given.
        found: u64,
        /// The number of points that follows from the announced total.
        expected: u64,
    },
    /// A run of poses is out of order, or empty.
    #[error("poses {from}..{to}, expected some from {end} on")]
    Run {
        /// The number of the first pose.
        from: u64,
        /// One more than the number of the last pose.
        to: u64,
        /// The number of the first pose that may still be given.
        end: u64,
    },
    /// Points of the overview came after the first slice.
    #[error("overview points after the first slice")]
    OverviewClosed,
}

impl From<mcap::McapError> for RecordError {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(source) => Self::Io(source),
            // A failed write of a chunk's header: nothing is parsed while writing.
            mcap::McapError::Parse(reason) => Self::Io(std::io::Error::other(reason.to_string())),
            other => Self::Mcap(other),
        }
    }
}

/// Why a recording could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be opened or read.
    #[error("cannot read {}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// The file does not begin as an MCAP file does.
    #[error("{} is not an MCAP file", path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// The file is damaged. (A file that was only cut short is read up to there.)
    #[error("{} is damaged near byte {offset}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// The number of bytes that had been read.
        offset: u64,
        /// The MCAP reader's reason.
        source: mcap::McapError,
    },
    /// A record or message cannot be decoded as what it claims to be.
    #[error("{what}: {reason}")]
    Malformed {
        /// The record or topic.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
}
