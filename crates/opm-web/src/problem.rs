//! What is wrong with a file, a change or a request, as the page shows it.

use opm_core::manipulator::CompileError;
use opm_core::mechanism::family::ParameterErrors;
use opm_core::mechanism::file::{FileErrors, MechanismFile};
use opm_study::text::chain;
use serde::Serialize;
use std::error::Error;

/// What a page has to tell apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ProblemKind {
    /// The mechanism has no working mode of this name.
    Mode,
}

/// One problem.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// What the page has to do something about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<ProblemKind>,
    /// The name of the file with the place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Line and column in that file, from 1, if the problem has a place there.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place: Option<(usize, usize)>,
    /// What was found, and what was expected.
    pub message: String,
}

/// Why there is no answer: all problems, at least one.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Problems {
    /// The problems.
    pub problems: Vec<Problem>,
}

impl Problems {
    /// A single problem.
    pub fn one(message: impl Into<String>) -> Self {
        Self { problems: vec![Problem { message: message.into(), ..Problem::default() }] }
    }

    /// The same, of one kind.
    pub fn of_kind(mut self, kind: ProblemKind) -> Self {
        self.problems.iter_mut().for_each(|problem| problem.kind = Some(kind));
        self
    }

    /// The same, in the file of this name where they have a place.
    pub fn in_file(mut self, name: &str) -> Self {
        let placed = self.problems.iter_mut().filter(|problem| problem.place.is_some());
        placed.for_each(|problem| problem.file = Some(name.to_owned()));
        self
    }

    /// An error and its causes.
    pub fn of(error: &(dyn Error + 'static)) -> Self {
        Self::one(chain(error))
    }

    /// Why a mechanism cannot be compiled, at the place of its file.
    pub fn of_compile(error: &CompileError, file: &MechanismFile) -> Self {
        let place = error.location(file);
        Self { problems: vec![Problem { place, message: chain(error), ..Problem::default() }] }
    }
}

impl From<FileErrors> for Problems {
    fn from(errors: FileErrors) -> Self {
        let problem = |p: opm_core::mechanism::file::Problem| Problem {
            place: Some((p.line, p.column)),
            message: p.message,
            ..Problem::default()
        };
        Self { problems: errors.problems.into_iter().map(problem).collect() }
    }
}

impl From<ParameterErrors> for Problems {
    fn from(errors: ParameterErrors) -> Self {
        let problem = |message| Problem { message, ..Problem::default() };
        Self { problems: errors.problems.into_iter().map(problem).collect() }
    }
}
