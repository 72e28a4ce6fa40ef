//! What goes wrong, as Python exceptions with the program's messages.

use opm_study::{RequestError, RequestOption, StudyError};
use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use std::error::Error;

pyo3::create_exception!(
    opm_kinematics,
    OpmError,
    PyValueError,
    "A mechanism, a pose or an option that cannot be computed with."
);

/// An error and its causes, on one line.
pub fn failed(error: &dyn Error) -> PyErr {
    let mut message = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        let text = inner.to_string();
        if !message.contains(&text) {
            message = format!("{message}: {text}");
        }
        cause = inner.source();
    }
    OpmError::new_err(message)
}

/// A study that ended early.
pub fn study(error: StudyError) -> PyErr {
    match error {
        StudyError::Request(error) => request(&error),
        error => failed(&error),
    }
}

/// A request that cannot be met, by the names of the arguments.
pub fn request(error: &RequestError) -> PyErr {
    let problem = error.problem(argument);
    let argument = argument(error.option());
    wrong(match error {
        RequestError::MaxCondition(_) => format!("{argument} is {problem}"),
        RequestError::Length(length) => {
            format!("{argument} is {length:?}, expected a positive one, 1e-75 to 1e75")
        }
        // These name what they are about: an axis, a file.
        RequestError::Grid(_) => problem,
        error if error.option() == RequestOption::Output => problem,
        _ => format!("{argument}: {problem}"),
    })
}

/// The argument that an option of a request is.
fn argument(option: RequestOption) -> &'static str {
    match option {
        RequestOption::Kind => "kind",
        RequestOption::Grid => "grid",
        RequestOption::Mode => "mode",
        RequestOption::MaxCondition => "max_condition",
        RequestOption::Length => "length",
        RequestOption::Conditioning => "conditioning",
        RequestOption::Axes => "axes",
        RequestOption::Scalars => "scalars",
        RequestOption::Color => "color",
        RequestOption::Output => "path",
        other => other.name(),
    }
}

/// A message of our own.
pub fn wrong(message: impl Into<String>) -> PyErr {
    OpmError::new_err(message.into())
}
