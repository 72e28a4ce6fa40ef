//! The connected components of a workspace.

use super::Sweep;
use crate::arguments;
use crate::parts::Parts;
use numpy::{IntoPyArray, PyArray1};
use opm_workspace::components;
use pyo3::prelude::*;
use std::num::NonZeroU64;

#[pymethods]
impl Sweep {
    /// How many points each connected component has, the largest first.
    ///
    /// Points are neighbours where they differ by one step along one coordinate; an angle whose values come full circle has its
    /// last value next to the first.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn components<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let set = Self::set(slf, Parts::new(executor, shards)?.as_ref())?;
        Ok(slf.py().detach(|| components(&set)).into_pyarray(slf.py()))
    }
}
