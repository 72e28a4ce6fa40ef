//! The measure of the box that a grid covers.

use super::Sweep;
use crate::arguments;
use crate::error::wrong;
use crate::measure::{Measure, Query, goal};
use crate::parts::Parts;
use opm_workspace::measure::CoordinateRange;
use pyo3::prelude::*;
use std::num::NonZeroU64;

#[pymethods]
impl Sweep {
    /// How much of the box that the grid covers is in reach: :func:`measure` over it.
    ///
    /// Returns
    /// -------
    /// Measure
    ///     With guaranteed bounds.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The points are places or orientations, or there is a `max_condition`, which a measure does not support.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float, optional
    ///     As for :func:`measure`.
    /// budget : int, optional
    ///     As for :func:`measure`.
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, tolerance = None, budget = None, executor = None, shards = None))]
    fn measure(
        &self,
        py: Python<'_>,
        tolerance: Option<f64>,
        #[pyo3(from_py_with = arguments::budget)] budget: Option<u64>,
        executor: Option<Bound<'_, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Measure> {
        if self.workspace.required_visits().is_some() {
            let (kind, points) = (self.kind(), self.workspace.kind().point_name());
            return Err(wrong(format!(
                "a measure is of poses or of one section, not of {kind} {points}"
            )));
        }
        if self.workspace.limit().is_some() {
            return Err(wrong("a measure knows no max_condition: sweep without it"));
        }
        let axes = self.workspace.grid().axes().iter();
        let over: Vec<_> =
            axes.map(|a| CoordinateRange::new(a.name.as_str(), a.min, a.max)).collect();
        let (of, sections) = (self.of.clone_ref(py), self.workspace.grid().sections());
        let query = Query { of, sections, modes: self.workspace.modes(), threads: self.threads };
        query.measured(py, &over, goal(tolerance, budget)?, Parts::new(executor, shards)?)
    }
}
