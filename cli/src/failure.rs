//! Failures of commands, with their exit status.

use crate::output::Shown;
use opm_mcap::RecordError;
use opm_study::recording::partial;
use opm_study::text::located;
use opm_study::{RequestError, RequestOption, ShardError, ShardProblem, StudyError};
use std::error::Error;
use std::fmt::{self, Display};
use std::io::{self, ErrorKind, Write as _};
use std::path::Path;

/// Why a command ends early.
#[derive(Debug)]
pub enum Failure {
    /// Wrong usage; the message names the flag.
    Usage(Message),
    /// The work failed; the message says where and why.
    Work(Message),
    /// Ctrl-C interrupted the work.
    Interrupted(Message),
    /// The reader of standard output has closed it; nothing more is printed.
    Closed,
}

/// The message of a failure, one line for each problem, and the error that caused it.
#[derive(Debug)]
pub struct Message {
    text: String,
    cause: Option<Box<dyn Error + Send + Sync>>,
}

impl Message {
    /// The same failure with another message, made from the present one.
    #[must_use]
    pub fn reworded(self, words: impl FnOnce(&str) -> String) -> Self {
        Self { text: words(&self.text), ..self }
    }

    fn of(text: String, cause: impl Error + Send + Sync + 'static) -> Self {
        Self { text, cause: Some(Box::new(cause)) }
    }
}

impl Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<T: Into<String>> From<T> for Message {
    fn from(text: T) -> Self {
        Self { text: text.into(), cause: None }
    }
}

impl Failure {
    /// The work failed at `place`, for instance a file. If the error names the place, it is not repeated.
    pub fn at(place: impl Display, error: impl Error + Send + Sync + 'static) -> Self {
        Self::Work(Message::of(located(place, &error), error))
    }

    /// The work failed, with this message.
    pub fn work(text: impl Into<String>) -> Self {
        Self::Work(Message::from(text))
    }

    /// The work was interrupted, with this message.
    pub fn interrupted(text: impl Into<String>) -> Self {
        Self::Interrupted(Message::from(text))
    }

    /// The work failed for this reason, with another message than that of the error.
    pub fn because(text: impl Into<String>, error: impl Error + Send + Sync + 'static) -> Self {
        Self::Work(Message::of(text.into(), error))
    }

    /// A flag has an invalid value.
    pub fn flag(flag: &str, problem: impl Display) -> Self {
        Self::Usage(format!("{flag}: {problem}").into())
    }

    /// Writing to standard output failed.
    pub fn stdout(error: io::Error) -> Self {
        match error.kind() {
            ErrorKind::BrokenPipe => Self::Closed,
            _ => Self::at("standard output", error),
        }
    }

    /// Prints the failure on standard error, and returns the exit status.
    pub fn report(&self) -> u8 {
        let (message, code) = match self {
            Self::Usage(message) => (message, 2),
            Self::Work(message) => (message, 1),
            Self::Interrupted(message) => (message, 130),
            Self::Closed => return 0,
        };
        talk(MessageKind::Error, &message.text);
        code
    }
}

impl Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Usage(message) | Self::Work(message) | Self::Interrupted(message) => {
                message.fmt(f)
            }
            Self::Closed => f.write_str("standard output is closed"),
        }
    }
}

impl Error for Failure {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Usage(message) | Self::Work(message) | Self::Interrupted(message) => {
                message.cause.as_deref().map(|cause| cause as _)
            }
            Self::Closed => None,
        }
    }
}

/// The kind of a line on standard error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
    Note,
    Warning,
    Error,
}

/// Writes lines to standard error, each with the name of this program and its kind. An indented line goes on with the
/// one before. Failures to write are ignored.
pub fn talk(kind: MessageKind, message: &str) {
    let kind = match kind {
        MessageKind::Note => "note",
        MessageKind::Warning => "warning",
        MessageKind::Error => "error",
    };
    let mut stderr = io::stderr().lock();
    for line in opm_core::text::message(message).lines() {
        let _ = match line.starts_with(' ') {
            true => writeln!(stderr, "opm: {line}"),
            false => writeln!(stderr, "opm: {kind}: {line}"),
        };
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Request(error) => error.into(),
            StudyError::Cancelled
            | StudyError::CancelledRecording { .. }
            | StudyError::CancelledShard { .. } => {
                Self::Interrupted(Message::of(error.to_string(), error))
            }
            StudyError::Shard(error) => error.into(),
            StudyError::Closed => Self::Closed,
            // What was written before the disk was full, for instance.
            StudyError::Record { ref place, error: RecordError::Io(_) }
                if partial(Path::new(place)).is_file() =>
            {
                let kept = partial(Path::new(place));
                let text = format!("{error}; what was written so far is in {}", kept.shown());
                Self::because(text, error)
            }
            _ => Self::because(error.to_string(), error),
        }
    }
}

impl From<RequestError> for Failure {
    fn from(error: RequestError) -> Self {
        let option = flag(error.option());
        Self::Usage(Message::of(format!("{option}: {}", error.problem(flag)), error))
    }
}

impl From<ShardError> for Failure {
    fn from(error: ShardError) -> Self {
        let text = match &error {
            ShardError { file, problem: ShardProblem::NoShard } => {
                format!("{file}: no shard of `opm workspace --shard`")
            }
            error => error.to_string(),
        };
        Self::because(text, error)
    }
}

/// The flag for an option of a request.
fn flag(option: RequestOption) -> &'static str {
    match option {
        RequestOption::Kind => "--kind",
        RequestOption::Grid => "--grid",
        RequestOption::Mode => "--mode",
        RequestOption::MaxCondition => "--max-condition",
        RequestOption::Clearance => "--clearance",
        RequestOption::Limit => "--limit",
        RequestOption::Length => "--length",
        RequestOption::Conditioning => "--conditioning",
        RequestOption::Axes => "--axes",
        RequestOption::Scalars => "--scalars",
        RequestOption::Color => "--color",
        RequestOption::Output => "--output",
        RequestOption::Wrench => "--wrench",
        RequestOption::Gravity => "--gravity",
        RequestOption::Stiffness => "--link-stiffness",
        RequestOption::JointStiffness => "--joint-stiffness",
        RequestOption::Explain => "--explain",
        RequestOption::Inscribed => "--inscribed",
        other => other.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_pipe_is_not_worth_a_word() {
        assert!(matches!(Failure::stdout(ErrorKind::BrokenPipe.into()), Failure::Closed));
        let full = Failure::stdout(ErrorKind::StorageFull.into());
        assert!(full.to_string().starts_with("standard output: "));
    }

    /// Callers of this library can inspect the cause, without parsing the message.
    #[test]
    fn a_failure_keeps_its_cause() {
        let full = Failure::at("a.mcap", io::Error::from(ErrorKind::StorageFull));
        let cause = full.source().and_then(|cause| cause.downcast_ref::<io::Error>());
        assert_eq!(cause.map(io::Error::kind), Some(ErrorKind::StorageFull));
        let request = Failure::from(RequestError::UnusedLength);
        let cause = request.source().and_then(|cause| cause.downcast_ref::<RequestError>());
        assert!(matches!(cause, Some(RequestError::UnusedLength)));
        assert!(request.to_string().starts_with("--length: "));
    }
}
