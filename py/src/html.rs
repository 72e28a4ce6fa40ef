//! What notebooks show: written in Python, by the package's `_html`.

use pyo3::prelude::*;

/// The HTML of an object, by the function of this name.
pub fn of<'py, T>(object: &Bound<'py, T>, function: &str) -> PyResult<Bound<'py, PyAny>> {
    object.py().import("opm_kinematics._html")?.call_method1(function, (object.as_any(),))
}
