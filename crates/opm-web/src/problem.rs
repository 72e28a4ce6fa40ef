//! What is wrong with a file, a change or a request, as the page shows it.

use opm_core::manipulator::CompileError;
use opm_core::mechanism::family::ParameterErrors;
use opm_core::mechanism::file::{FileErrors, MechanismFile};
use opm_study::text::chain;
use serde::Serialize;
use std::error::Error;

/// One problem.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Problem {
    /// Line and column in the mechanism file, from 1, if the problem has a place there.
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
        Self { problems: vec![Problem { place: None, message: message.into() }] }
    }

    /// An error and its causes.
    pub fn of(error: &(dyn Error + 'static)) -> Self {
        Self::one(chain(error))
    }

    /// Why a mechanism cannot be compiled, at the place of its file.
    pub fn of_compile(error: &CompileError, file: &MechanismFile) -> Self {
        let place = error.location(file);
        Self { problems: vec![Problem { place, message: chain(error) }] }
    }
}

impl From<FileErrors> for Problems {
    fn from(errors: FileErrors) -> Self {
        let problem = |p: opm_core::mechanism::file::Problem| Problem {
            place: Some((p.line, p.column)),
            message: p.message,
        };
        Self { problems: errors.problems.into_iter().map(problem).collect() }
    }
}

impl From<ParameterErrors> for Problems {
    fn from(errors: ParameterErrors) -> Self {
        let problem = |message| Problem { place: None, message };
        Self { problems: errors.problems.into_iter().map(problem).collect() }
    }
}
