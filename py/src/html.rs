//! HTML for notebooks, made by the package's Python module `_html`.

use pyo3::prelude::*;

/// The number of digits shown; the object itself has all of them.
const DIGITS: usize = 7;

/// A number with at most seven digits, as Python writes it.
pub fn digits(number: f64) -> String {
    if !number.is_finite() || number == 0.0 {
        return format!("{:?}", number + 0.0);
    }
    let rounded: f64 = format!("{number:.*e}", DIGITS - 1).parse().unwrap_or(number);
    format!("{rounded:?}")
}

/// The HTML of an object, by the function with this name.
pub fn of<'py, T>(object: &Bound<'py, T>, function: &str) -> PyResult<Bound<'py, PyAny>> {
    object.py().import("opm_kinematics._html")?.call_method1(function, (object.as_any(),))
}
