//! Kinds whose points are places or orientations: how often each is reached, which says whether it is in.

use super::Sweep;
use super::shards::{shard, spread};
use crate::arguments;
use crate::error::{failed, wrong};
use crate::interrupt;
use crate::parts::Parts;
use numpy::{IntoPyArray, PyArray1, PyArrayMethods};
use opm_cli::recording::Kind;
use opm_workspace::{GridSet, Progress, SetError, Shard, Visits};
use pyo3::prelude::*;
use std::num::NonZeroU64;
use std::sync::Arc;

#[pymethods]
impl Sweep {
    /// In how many :attr:`orientations` each place is reached, in the shape of the mask.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     Of another kind than ``"reachable"`` and ``"dexterous"``.
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
        if !matches!(this.asked.kind, Kind::Reachable | Kind::Dexterous) {
            let kind = this.kind();
            return Err(wrong(format!("visits are of kind reachable or dexterous, not of {kind}")));
        }
        let tally = Self::tally(slf, Parts::new(executor, shards)?.as_ref())?;
        this.shaped(&PyArray1::from_slice(slf.py(), &tally))
    }

    /// Of every point of a kind that is not of poses, how often one part reaches it.
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
    /// How often a point has to be reached to be in: of a kind whose points are no points of the grid.
    pub fn least(&self) -> Option<u64> {
        match self.asked.kind {
            Kind::Reachable | Kind::Imaginary => Some(1),
            Kind::Dexterous => Some(self.grid.slices()),
            _ => None,
        }
    }

    /// Of every point of a kind that has [`least`](Self::least), how often a part of the grid reaches it.
    fn tallied(&self, py: Python<'_>, shard: Shard) -> PyResult<Vec<u64>> {
        let (progress, sweep) = (Progress::default(), self.swept(shard));
        let work = || match self.asked.kind {
            Kind::Imaginary => {
                let set = GridSet::slices(&sweep, &progress)?;
                let mut tally = vec![0; set.points() as usize];
                set.numbers().for_each(|number| tally[number as usize] = 1);
                Ok(tally)
            }
            _ => Ok(Visits::new(&sweep, &progress)?.counts().to_vec()),
        };
        let done = interrupt::run(py, self.threads, work, || progress.cancel())?;
        done.map_err(|error: SetError| failed(&error))
    }

    /// The same of the whole grid, which is kept.
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
                // Parts add up: in place, so that there is never more than one sum.
                let add = py.import("operator")?.getattr("iadd")?;
                let sum = spread(slf, parts, "_tally", Some(add))?;
                sum.cast_into::<PyArray1<u64>>()?.to_vec()?
            }
        };
        Ok(Arc::clone(this.tally.get_or_init(|| Arc::new(tally))))
    }
}
