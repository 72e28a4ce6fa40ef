//! Arguments from Python. An error message has the name of the argument, what was given and what was
//! expected.

use crate::error::{failed, wrong};
use crate::given::{Columns, Given, unmasked};
use numpy::{AllowTypeChange, PyArray2, PyArrayLike2, PyUntypedArray, PyUntypedArrayMethods};
use opm_core::mechanism::examples;
use opm_core::skeleton::{Density, OutOfRange};
use opm_export::MjcfOptions;
use opm_mcap::input::{self, Expected, InputError, Pipes};
use opm_workspace::MOST_THREADS;
use pyo3::exceptions::{PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;
use std::num::{NonZeroU64, NonZeroUsize};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

/// Rows of numbers.
pub type Array<'py> = PyArrayLike2<'py, f64, AllowTypeChange>;

/// The number of characters of a value that a message shows.
const SHOWN: usize = 60;

/// The given value, as a message shows it.
pub fn shown(given: &Bound<'_, PyAny>) -> String {
    let text = given.repr().map_or_else(|_| "?".to_owned(), |text| text.to_string());
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// A whole number in a range.
fn whole(given: &Bound<'_, PyAny>, what: &str, range: &RangeInclusive<u64>) -> PyResult<u64> {
    let number = given.extract().ok().filter(|number| range.contains(number));
    number.ok_or_else(|| {
        let (given, least, most) = (shown(given), range.start(), range.end());
        wrong(match *most {
            u64::MAX => format!("{what} is {given}, expected a whole number of at least {least}"),
            _ => format!("{what} is {given}, expected a whole number from {least} to {most}"),
        })
    })
}

/// The argument `threads`, in the range that the command line allows.
pub fn threads(given: &Bound<'_, PyAny>) -> PyResult<Option<NonZeroUsize>> {
    if given.is_none() {
        return Ok(None);
    }
    let number = whole(given, "threads", &(1..=u64::from(MOST_THREADS)))?;
    Ok(NonZeroUsize::new(number as usize))
}

/// The arguments `density` and `time_step`.
pub fn mjcf_options(density: Option<f64>, time_step: f64) -> PyResult<MjcfOptions> {
    let density = self::density(density)?;
    MjcfOptions::new(density, time_step).map_err(out_of_range)
}

/// The argument `density`.
pub fn density(given: Option<f64>) -> PyResult<Density> {
    Density::new(given).map_err(out_of_range)
}

fn out_of_range(error: OutOfRange) -> PyErr {
    wrong(format!("{} is {error}", error.option))
}

/// The argument `shards`.
pub fn shards(given: &Bound<'_, PyAny>) -> PyResult<Option<NonZeroU64>> {
    if given.is_none() {
        return Ok(None);
    }
    Ok(NonZeroU64::new(whole(given, "shards", &(1..=u64::MAX))?))
}

/// The argument `budget`.
pub fn budget(given: &Bound<'_, PyAny>) -> PyResult<Option<u64>> {
    if given.is_none() {
        return Ok(None);
    }
    whole(given, "budget", &(1..=u64::MAX)).map(Some)
}

/// The argument `samples`, in the range that the command line allows.
pub fn samples(given: &Bound<'_, PyAny>) -> PyResult<Option<NonZeroU64>> {
    if given.is_none() {
        return Ok(None);
    }
    Ok(NonZeroU64::new(whole(given, "samples", &(1..=opm_study::MOST_SAMPLES))?))
}

/// The argument `seed`.
pub fn seed(given: &Bound<'_, PyAny>) -> PyResult<u64> {
    whole(given, "seed", &(0..=u64::MAX))
}

/// The argument `scalars`: a sequence of names. A single string is not taken for one.
pub fn scalars(given: &Bound<'_, PyAny>) -> PyResult<Option<Vec<String>>> {
    if given.is_none() {
        return Ok(None);
    }
    let names = given.extract().ok().filter(|_| !given.is_instance_of::<PyString>());
    let unsuitable = || wrong(format!("scalars is {}, expected a sequence of names", shown(given)));
    names.map(Some).ok_or_else(unsuitable)
}

/// The argument `axes` of a cloud: three names, or the name of a point.
pub fn cloud_axes(given: &Bound<'_, PyAny>) -> PyResult<Option<Vec<String>>> {
    if given.is_none() {
        return Ok(None);
    }
    let names = given.extract().map(|name| vec![name]).or_else(|_| given.extract());
    let unsuitable =
        |_: PyErr| wrong(format!("axes is {}, expected three names or \"tip\"", shown(given)));
    names.map(Some).map_err(unsuitable)
}

/// A path, as Python's own functions take it.
pub fn path(given: &Bound<'_, PyAny>) -> PyResult<PathBuf> {
    given.py().import("os")?.call_method1("fsdecode", (given,))?.extract()
}

/// The text of a file, or Python's exception for the system's error, with the file's name. If there is no such file, `hint`
/// follows the message. Pipes are refused: Python could not be interrupted while it waits for one.
pub fn text(py: Python<'_>, path: &Path, expected: Expected, hint: &str) -> PyResult<String> {
    py.detach(|| input::text(path, expected, Pipes::Refuse)).map_err(|error| {
        let missing = error.is_missing();
        let error = match error {
            InputError::Io(error) => error,
            error => {
                let label = path.display().to_string();
                return wrong(format!("{}: {error}", error.place(&label)));
            }
        };
        let Some(number) = error.raw_os_error() else { return error.into() };
        let message =
            py.import("os").and_then(|os| os.call_method1("strerror", (number,))?.extract());
        let message: String = message.unwrap_or_else(|_| error.to_string());
        let message = if missing { message + hint } else { message };
        // Python chooses the class by the number: FileNotFoundError, IsADirectoryError, ...
        PyOSError::new_err((number, message, path.as_os_str().to_owned()))
    })
}

/// The text of a mechanism file, and its name in messages. If there is no such file but a shipped one of this
/// name, the message says that `shipped` reads it in Python.
pub fn mechanism(py: Python<'_>, path: &Path, shipped: &str) -> PyResult<(String, String)> {
    let label = path.display().to_string();
    let hint = match examples::find(&label) {
        Some(_) => format!("; the shipped example is {shipped}({label:?})"),
        None => String::new(),
    };
    Ok((text(py, path, Expected::MECHANISM, &hint)?, label))
}

/// The argument as an array of numbers of any shape; entries that are masked or missing are NaN.
pub fn numbers<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
    expected: &dyn Fn() -> String,
) -> PyResult<Bound<'py, PyUntypedArray>> {
    let py = given.py();
    let unsuitable = |error: PyErr| {
        let known =
            error.is_instance_of::<PyTypeError>(py) || error.is_instance_of::<PyValueError>(py);
        if !known {
            return error;
        }
        wrong(format!("{what} is {}, expected {}", shown(given), expected()))
    };
    let numpy = py.import("numpy")?;
    let plain = unmasked(given).map_err(unsuitable)?;
    let mut array = numpy.call_method1("asarray", (plain,)).map_err(unsuitable)?;
    if array.getattr("ndim")?.extract::<usize>()? == 0 {
        return Err(wrong(format!("{what} is {}, expected {}", shown(given), expected())));
    }
    let kind: char = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if kind == 'O' {
        // Objects such as fractions.
        array = array.call_method1("astype", ("float64",)).map_err(unsuitable)?;
    } else if !"biuf".contains(kind) {
        let entries = array.getattr("dtype")?.str()?;
        return Err(wrong(format!("{what} has entries of {entries}, expected {}", expected())));
    }
    Ok(array.cast_into()?)
}

/// One value for each of `columns`.
pub fn row(given: &Bound<'_, PyAny>, what: &str, columns: Columns<'_>) -> PyResult<Vec<f64>> {
    let Given { array, lead, .. } = columns.read(given, what)?;
    if !lead.is_empty() {
        let names = columns.names;
        return Err(wrong(format!(
            "{what} has {} rows, expected ({},): {}",
            array.shape()[0],
            names.len(),
            names.join(", ")
        )));
    }
    array.as_any().call_method0("ravel")?.call_method0("tolist")?.extract()
}

/// One number, or an array of any shape, as a column.
pub fn column<'py>(given: &Bound<'py, PyAny>, what: &str) -> PyResult<Given<'py>> {
    let py = given.py();
    if let Ok(number) = given.extract::<f64>() {
        let array = PyArray2::from_vec2(py, &[vec![number]]).map_err(|error| failed(&error))?;
        return Ok(Given { array: array.as_any().extract()?, lead: Vec::new(), index: None });
    }
    Given::new(&numbers(given, what, &|| "a number or an array of numbers".to_owned())?, 0)
}

/// All numbers of a one-dimensional array.
pub fn list(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
    let expected = || "(n,) numbers".to_owned();
    let array = numbers(given, what, &expected)?;
    if array.ndim() != 1 {
        let shape = array.getattr("shape")?;
        return Err(wrong(format!("{what} has shape {shape}, expected {}", expected())));
    }
    array.call_method0("tolist")?.extract()
}
