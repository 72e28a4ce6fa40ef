//! Kinds whose points are places or orientations. How often a point is reached decides whether it is in the workspace.

use super::Sweep;
use super::shards::{shard, spread};
use crate::arguments;
use crate::error::{failed, wrong};
use crate::interrupt::{self, few};
use crate::parts::Parts;
use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use opm_workspace::{Progress, SetError, Shard};
use pyo3::prelude::*;
use std::num::NonZeroU64;
use std::sync::Arc;

#[pymethods]
impl Sweep {
    /// In how many :attr:`orientations` each place is reached, in the shape of the mask.
    ///
    /// Returns
    /// -------
    /// ndarray of uint64
    ///     One axis for each coordinate of a place.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The kind is neither ``"reachable"`` nor ``"dexterous"``.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn visits<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let this = slf.get();
        if !this.workspace.kind().is_of_places() {
            let kind = this.kind();
            return Err(wrong(format!("visits are of kind reachable or dexterous, not of {kind}")));
        }
        let tally = Self::tally(slf, Parts::new(executor, shards)?.as_ref())?;
        this.shaped(&PyArray1::from_slice(slf.py(), &tally))
    }

    /// How often one part of the grid reaches every point, for a kind whose points are not poses.
    fn _tally<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        of: u64,
    ) -> PyResult<Bound<'py, PyArray1<u64>>> {
        Ok(self.tallied(py, shard(number, of)?)?.into_pyarray(py))
    }
}

impl Sweep {
    /// The number of slices of a part of the grid in which each point is reached. It is empty for a kind whose
    /// points are points of the grid.
    fn tallied(&self, py: Python<'_>, shard: Shard) -> PyResult<Vec<u64>> {
        let (progress, sweep) = (Progress::default(), self.swept(shard));
        let work = || self.workspace.visits(&sweep, &progress);
        let done =
            interrupt::run(py, few(self.threads, sweep.pieces()), work, || progress.cancel())?;
        Ok(done.map_err(|error: SetError| failed(&error))?.unwrap_or_default())
    }

    /// The number of slices of the whole grid in which each point is reached. The result is kept.
    pub fn tally<'py>(
        slf: &Bound<'py, Self>,
        parts: Option<&Parts<'py>>,
    ) -> PyResult<Arc<Vec<u64>>> {
        let (py, this) = (slf.py(), slf.get());
        if let Some(known) = this.tally.get() {
            return Ok(Arc::clone(known));
        }
        let tally = match parts {
            None => this.tallied(py, Shard::WHOLE)?,
            Some(parts) => {
                // The parts are added in place, so that there is never more than one sum.
                let add = py.import("operator")?.getattr("iadd")?;
                let sum = spread(slf, parts, "_tally", Some(add))?;
                sum.cast_into::<PyArray1<u64>>()?.to_vec()?
            }
        };
        Ok(Arc::clone(this.tally.get_or_init(|| Arc::new(tally))))
    }
}
