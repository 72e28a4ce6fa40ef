//! How a command ends when it does not end well.

use opm_study::text::located;
use opm_study::{RequestError, RequestOption, ShardError, ShardProblem, StudyError};
use std::error::Error;
use std::fmt::Display;
use std::io::{self, ErrorKind, Write as _};

/// Why a command ends early. Messages have one line a problem.
#[derive(Debug, PartialEq, Eq)]
pub enum Failure {
    /// Wrong usage, which names the flag.
    Usage(String),
    /// The work failed: where and why.
    Work(String),
    /// Somebody pressed Ctrl-C.
    Interrupted(String),
    /// Whoever read standard output has gone: nothing more to say.
    Closed,
}

impl Failure {
    /// The work failed at `place`, for instance a file. An error that names it itself says it once.
    pub fn at(place: impl Display, error: &(dyn Error + '_)) -> Self {
        Self::Work(located(place, error))
    }

    /// A flag was given what it cannot take.
    pub fn flag(flag: &str, problem: impl Display) -> Self {
        Self::Usage(format!("{flag}: {problem}"))
    }

    /// Writing to standard output failed.
    pub fn stdout(error: &io::Error) -> Self {
        match error.kind() {
            ErrorKind::BrokenPipe => Self::Closed,
            _ => Self::at("standard output", error),
        }
    }

    /// Says what went wrong on standard error, and with which status to exit.
    pub fn report(&self) -> u8 {
        let (message, code) = match self {
            Self::Usage(message) => (message, 2),
            Self::Work(message) => (message, 1),
            Self::Interrupted(message) => (message, 130),
            Self::Closed => return 0,
        };
        talk(message);
        code
    }
}

/// Writes lines to standard error as this program's; if nobody can read them, so be it.
pub fn talk(message: &str) {
    let mut stderr = io::stderr().lock();
    for line in message.lines() {
        let _ = writeln!(stderr, "opm: {line}");
    }
}

impl From<StudyError> for Failure {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Request(error) => error.into(),
            StudyError::Cancelled
            | StudyError::CancelledRecording { .. }
            | StudyError::CancelledShard { .. } => Self::Interrupted(error.to_string()),
            StudyError::Shard(error) => error.into(),
            StudyError::Closed => Self::Closed,
            _ => Self::Work(error.to_string()),
        }
    }
}

impl From<RequestError> for Failure {
    fn from(error: RequestError) -> Self {
        Self::flag(flag(error.option()), error.problem(flag))
    }
}

impl From<ShardError> for Failure {
    fn from(error: ShardError) -> Self {
        match error {
            ShardError { file, problem: ShardProblem::NoShard } => {
                Self::Work(format!("{file}: no shard of `opm workspace --shard`"))
            }
            error => Self::Work(error.to_string()),
        }
    }
}

/// The flag that an option of a request is.
fn flag(option: RequestOption) -> &'static str {
    match option {
        RequestOption::Kind => "--kind",
        RequestOption::Grid => "--grid",
        RequestOption::Mode => "--mode",
        RequestOption::MaxCondition => "--max-condition",
        RequestOption::Length => "--length",
        RequestOption::Conditioning => "--conditioning",
        RequestOption::Axes => "--axes",
        RequestOption::Scalars => "--scalars",
        RequestOption::Color => "--color",
        RequestOption::Output => "--output",
        other => other.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_closed_pipe_is_not_worth_a_word() {
        assert_eq!(Failure::stdout(&ErrorKind::BrokenPipe.into()), Failure::Closed);
        let full = Failure::stdout(&ErrorKind::StorageFull.into());
        assert!(matches!(full, Failure::Work(text) if text.starts_with("standard output: ")));
    }
}
