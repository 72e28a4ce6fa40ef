//! The query of a sweep as Python gives it: kind, working modes and axes.

use crate::arguments;
use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use opm_study::{CheckedRequest, Workspace, WorkspaceKind};
use opm_workspace::{Axis, Modes, Progress};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyList;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::num::NonZeroUsize;

/// Values of one coordinate: a number, or the lowest value, the highest value and their count.
#[derive(FromPyObject)]
enum Range {
    Fixed(f64),
    Several((f64, f64, u64)),
}

/// How far listed values may be from even steps, as a share of their range: what single precision leaves of them.
const EVEN: f64 = 1e-6;

/// What an axis can be.
const EXPECTED: &str = "expected a number, (min, max, count), or evenly spaced values";

/// The axes with these names.
pub fn axes(given: BTreeMap<String, Bound<'_, PyAny>>) -> PyResult<Vec<Axis>> {
    let axis = |(name, range): (String, Bound<'_, PyAny>)| {
        if range.is_instance_of::<PyList>() || range.getattr_opt("__array__")?.is_some() {
            return listed(name, &range);
        }
        match range.extract::<Range>() {
            Ok(Range::Fixed(value)) => Ok(Axis::fixed(name, value)),
            Ok(Range::Several((min, max, count))) => Ok(Axis::new(name, min, max, count)),
            Err(_) => Err(wrong(format!("{name} is {}, {EXPECTED}", arguments::shown(&range)))),
        }
    };
    given.into_iter().map(axis).collect()
}

/// The axis that has these values, which are those of `linspace`.
fn listed(name: String, given: &Bound<'_, PyAny>) -> PyResult<Axis> {
    if given.getattr_opt("ndim")?.is_some_and(|ndim| ndim.extract().is_ok_and(|n: usize| n == 0)) {
        return Ok(Axis::fixed(name, given.extract()?));
    }
    let values = arguments::list(given, &name)?;
    let [first, .., last] = values[..] else {
        return match values.first() {
            Some(&value) => Ok(Axis::fixed(name, value)),
            None => Err(wrong(format!("{name} has no values, {EXPECTED}"))),
        };
    };
    let steps = (values.len() - 1) as f64;
    let even = |number: usize| first + (last - first) * (number as f64 / steps);
    let off = |(number, value): (usize, &f64)| {
        let off = (value - even(number)).abs();
        off.is_nan() || off > EVEN * (last - first).abs()
    };
    if let Some((number, value)) = values.iter().enumerate().find(|&entry| off(entry)) {
        let expected = even(number);
        return Err(wrong(format!(
            "{name}[{number}] is {value:?}, expected {expected:?} for even steps from {first:?} to {last:?}"
        )));
    }
    Ok(Axis::new(name, first, last, values.len() as u64))
}

/// The workspace of a request. If no grid is given, one is fitted, with a warning if the workspace continues
/// beyond it.
pub fn fitted(
    py: Python<'_>,
    request: CheckedRequest,
    threads: Option<NonZeroUsize>,
) -> PyResult<Workspace> {
    let progress = Progress::default();
    if request.grid().is_some() {
        return request.fit(&progress).map_err(|error| failed(&error));
    }
    let fit = || request.fit(&progress);
    let workspace = interrupt::run(py, threads, fit, || progress.cancel())?;
    let workspace = workspace.map_err(|error| failed(&error))?;
    for name in workspace.unbounded().unwrap_or_default() {
        let message = format!(
            "the workspace continues beyond this grid along {name}; limit a joint, or give {name}"
        );
        let category = py.get_type::<PyUserWarning>();
        PyErr::warn(py, &category, &CString::new(message)?, 1)?;
    }
    Ok(workspace)
}

/// The kind with this name.
pub fn named(word: &str) -> PyResult<WorkspaceKind> {
    let names = || WorkspaceKind::ALL.map(WorkspaceKind::name).join(", ");
    word.parse().map_err(|_| wrong(format!("kind is {word:?}, expected one of {}", names())))
}

/// The working modes that count: one, or any.
pub fn modes(manipulator: &Manipulator, mode: &str) -> PyResult<Modes> {
    match mode {
        "any" => Ok(Modes::Any),
        mode => manipulator.mode(mode).map(Modes::One),
    }
}
