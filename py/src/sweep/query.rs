//! What is asked of a sweep, as it comes from Python: kind, working modes, limit and axes.

use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use opm_cli::recording::Kind;
use opm_core::manipulator as core;
use opm_workspace::{Axis, Modes, Progress, default_grid};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::num::NonZeroUsize;

/// What is asked of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Asked {
    pub kind: Kind,
    pub mode: String,
    pub most: Option<f64>,
    pub length: f64,
}

/// Values of one coordinate: a number, or lowest, highest and how many.
#[derive(FromPyObject)]
enum Range {
    Fixed(f64),
    Several((f64, f64, u64)),
}

/// The axes of these names.
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

/// The axes of a grid that suits the workspace, with a warning where that has no end.
pub fn fitted(
    py: Python<'_>,
    manipulator: &core::Manipulator,
    kind: Kind,
    modes: Modes,
    threads: Option<NonZeroUsize>,
) -> PyResult<Vec<Axis>> {
    let progress = Progress::default();
    let find = || default_grid(manipulator, modes, &progress);
    let found = interrupt::run(py, threads, find, || progress.cancel())?;
    let (grid, extents) = found.map_err(|error| failed(&error))?;
    let grid = kind.fit(manipulator, grid);
    for extent in extents.iter().filter(|extent| extent.unbounded && kind.asks(extent, &grid)) {
        let name = extent.name;
        let message = format!(
            "the workspace goes on beyond this grid along {name}; limit a joint, or give {name}"
        );
        let category = py.get_type::<PyUserWarning>();
        PyErr::warn(py, &category, &CString::new(message)?, 1)?;
    }
    Ok(grid.axes().to_vec())
}

/// The kind of this name.
pub fn named(word: &str) -> PyResult<Kind> {
    let words = || Kind::all().iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
    Kind::named(word).ok_or_else(|| wrong(format!("kind is {word:?}, expected one of {}", words())))
}

/// A limit on condition numbers, checked.
pub fn condition_number(most: f64) -> PyResult<f64> {
    match most {
        1.0.. if most.is_finite() => Ok(most),
        _ => Err(wrong(format!("max_condition is {most:?}, expected a number of at least 1"))),
    }
}

/// The working modes that count: one, or any.
pub fn modes(manipulator: &Manipulator, mode: &str) -> PyResult<Modes> {
    match mode {
        "any" => Ok(Modes::Any),
        mode => manipulator.mode(mode).map(Modes::One),
    }
}
