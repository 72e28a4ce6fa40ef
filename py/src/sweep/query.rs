//! The query of a sweep as Python gives it: kind, working modes and axes.

use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use opm_study::{CheckedRequest, Workspace, WorkspaceKind};
use opm_workspace::{Axis, Modes, Progress};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::num::NonZeroUsize;

/// Values of one coordinate: a number, or the lowest value, the highest value and their count.
#[derive(FromPyObject)]
enum Range {
    Fixed(f64),
    Several((f64, f64, u64)),
}

/// The axes with these names.
pub fn axes(given: BTreeMap<String, Bound<'_, PyAny>>) -> PyResult<Vec<Axis>> {
    let axis = |(name, range): (String, Bound<'_, PyAny>)| match range.extract::<Range>() {
        Ok(Range::Fixed(value)) => Ok(Axis::fixed(name, value)),
        Ok(Range::Several((min, max, count))) => Ok(Axis::new(name, min, max, count)),
        Err(_) => {
            let found = range.repr()?;
            Err(wrong(format!("{name} is {found}, expected a number or (min, max, count)")))
        }
    };
    given.into_iter().map(axis).collect()
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
