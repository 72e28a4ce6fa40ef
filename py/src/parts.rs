//! Work in other processes: the executor, and the number of parts.

use crate::error::wrong;
use pyo3::prelude::*;
use std::num::NonZeroU64;

/// A pickled object: the function that restores it, and its arguments.
pub type Pickled<'py, T> = (Bound<'py, PyAny>, T);

/// An executor, and the number of parts if it is given.
pub struct Parts<'py> {
    executor: Bound<'py, PyAny>,
    shards: Option<NonZeroU64>,
}

impl<'py> Parts<'py> {
    /// The given executor and shards; `None` without an executor.
    pub fn new(
        executor: Option<Bound<'py, PyAny>>,
        shards: Option<NonZeroU64>,
    ) -> PyResult<Option<Self>> {
        match (executor, shards) {
            (Some(executor), shards) => Ok(Some(Self { executor, shards })),
            (None, None) => Ok(None),
            (None, Some(_)) => Err(wrong("shards are given, but no executor that they are for")),
        }
    }

    /// The number of parts for this much work and these workers: each has at least `least`, and there is at
    /// least one.
    pub fn count(&self, workers: &Bound<'py, PyAny>, work: u64, least: u64) -> PyResult<u64> {
        let most = work.div_ceil(least);
        if most <= 1 {
            return Ok(1);
        }
        let shards = match self.shards {
            Some(shards) => shards.get(),
            None => workers.call_method0("shards")?.extract()?,
        };
        Ok(shards.min(most))
    }

    /// The result of `work`, which gives its parts to the method `run` of the workers.
    pub fn session<T>(
        &self,
        py: Python<'py>,
        work: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<T> {
        let module = py.import("opm_kinematics._executor")?;
        let workers = module.call_method1("Workers", (&self.executor,))?;
        let done = work(&workers);
        workers.call_method0("close")?;
        done
    }
}
