//! What goes wrong, as Python exceptions with the program's messages.

use opm_core::text;
use opm_study::{RequestError, RequestOption, StudyError};
use pyo3::PyErr;
use pyo3::exceptions::PyValueError;
use std::error::Error;

pyo3::create_exception!(
    opm_kinematics,
    OpmError,
    PyValueError,
    "A mechanism, a pose or an option with which opm cannot compute."
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
    wrong(message)
}

/// The exception for an analysis that ended early.
pub fn study(error: StudyError) -> PyErr {
    match error {
        StudyError::Request(error) => request(&error),
        error => failed(&error),
    }
}

/// The exception for a request that cannot be met. It uses the names of the arguments.
pub fn request(error: &RequestError) -> PyErr {
    let problem = error.problem(argument);
    let argument = argument(error.option());
    wrong(match error {
        RequestError::MaxCondition(_) => format!("{argument} is {problem}"),
        RequestError::Length(length) => {
            format!("{argument} is {length:?}, expected a positive one, 1e-75 to 1e75")
        }
        // These messages name an axis or a file already.
        RequestError::Grid(_) => problem,
        error if error.option() == RequestOption::Output => problem,
        _ => format!("{argument}: {problem}"),
    })
}

/// The name of the argument that stands for an option of a request.
fn argument(option: RequestOption) -> &'static str {
    match option {
        RequestOption::Kind => "kind",
        RequestOption::Grid => "grid",
        RequestOption::Mode => "mode",
        RequestOption::MaxCondition => "max_condition",
        RequestOption::Clearance => "clearance",
        RequestOption::Limit => "limits",
        RequestOption::Length => "length",
        RequestOption::Conditioning => "conditioning",
        RequestOption::Axes => "axes",
        RequestOption::Scalars => "scalars",
        RequestOption::Color => "color",
        RequestOption::Output => "path",
        RequestOption::Wrench => "wrench",
        RequestOption::Gravity => "gravity",
        RequestOption::Stiffness => "link_stiffness",
        RequestOption::JointStiffness => "joint_stiffness",
        RequestOption::Explain => "rejections",
        RequestOption::Inscribed => "inscribed",
        other => other.name(),
    }
}

/// An `OpmError` with a message of this module.
pub fn wrong(message: impl Into<String>) -> PyErr {
    OpmError::new_err(text::message(&message.into()).into_owned())
}
