//! How a command ends when it does not end well.

use std::error::Error;
use std::fmt::{Display, Write as _};
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
        let (place, text) = (place.to_string(), chain(error));
        if text.split([' ', ':']).any(|word| word == place) {
            return Self::Work(text);
        }
        Self::Work(format!("{place}: {text}"))
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

/// An error and what caused it, on one line.
pub fn chain(error: &(dyn Error + '_)) -> String {
    let mut text = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        let _ = write!(text, ": {cause}");
        source = cause.source();
    }
    text
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
