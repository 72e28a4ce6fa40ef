//! What goes wrong, as Python exceptions with the program's messages.

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

/// A message of our own.
pub fn wrong(message: impl Into<String>) -> PyErr {
    OpmError::new_err(message.into())
}
