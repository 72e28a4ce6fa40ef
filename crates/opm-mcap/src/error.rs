//! What can go wrong with a recording, with what was measured and what was expected.

use std::path::PathBuf;

/// Why a recording could not be written. Every one of them is final: the recorder that returned it
/// refuses all further work, and nothing appears under the name that was asked for.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The file could not be opened for writing.
    #[error("cannot create {}", path.display())]
    Create {
        /// The `.partial` file.
        path: PathBuf,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// A directory or a device has the name that the recording should get.
    #[error("{} exists and is not a regular file", path.display())]
    NotAFile {
        /// The name that was asked for.
        path: PathBuf,
    },
    /// Another recording to the same name is under way.
    #[error("{} is being written by another process", path.display())]
    Busy {
        /// The `.partial` file.
        path: PathBuf,
    },
    /// Writing failed: a full disk, a vanished mount.
    #[error("cannot write the recording")]
    Io(#[source] std::io::Error),
    /// The recording could not be put together as an MCAP file.
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
        /// Values handed over.
        values: usize,
        /// Values a row has.
        columns: usize,
    },
    /// Messages came out of order.
    #[error("a message at {time} ns after one at {last} ns")]
    Time {
        /// Time of the message.
        time: u64,
        /// Time of the one before it.
        last: u64,
    },
    /// A value that a float32 cannot hold as a finite number.
    #[error("{column} of point {point} is {value}, expected a finite float32")]
    NonFinite {
        /// Name of the column.
        column: String,
        /// The point's number in the message that it was bound for.
        point: usize,
        /// The value.
        value: f64,
    },
    /// Slices came out of order, or past the last one.
    #[error("slice {slice} is not in {first}..{end}")]
    Slice {
        /// The slice that was pushed.
        slice: u64,
        /// The slice that is open: the earliest that may still be pushed to.
        first: u64,
        /// One past the last slice.
        end: u64,
    },
    /// More slices than a recording may have.
    #[error("{slices} slices, expected at most {limit}")]
    TooManySlices {
        /// Slices announced.
        slices: u64,
        /// [`crate::MAX_SLICES`].
        limit: u64,
    },
    /// A slice has more points than its 100 ms have room for messages.
    #[error("slice {slice} needs more than {limit} messages")]
    SliceTooLarge {
        /// The slice.
        slice: u64,
        /// Messages that fit in one slice's time.
        limit: u64,
    },
    /// The number of points is not the one that was announced.
    #[error("{what}: {found} points, expected {expected}")]
    Count {
        /// `overview` or `slices`.
        what: &'static str,
        /// Points pushed.
        found: u64,
        /// Points that the announced total asks for.
        expected: u64,
    },
    /// Runs of poses came out of order, or empty.
    #[error("poses {from}..{to}, expected some from {end} on")]
    Run {
        /// The first pose.
        from: u64,
        /// One more than the last.
        to: u64,
        /// The earliest that may still be pushed.
        end: u64,
    },
    /// Overview points came after the first slice.
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
    /// The file is damaged: not merely cut short, but wrong.
    #[error("{} is damaged near byte {offset}", path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Bytes read when it was noticed.
        offset: u64,
        /// What the MCAP reader found.
        source: mcap::McapError,
    },
    /// A record or message does not decode as what it claims to be.
    #[error("{what}: {reason}")]
    Malformed {
        /// Which record or topic.
        what: String,
        /// What is wrong with it.
        reason: String,
    },
}
