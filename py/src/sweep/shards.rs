//! A sweep in parts. Each part is pickled for another process with the number of its shard.

use super::Sweep;
use super::query::named;
use crate::error::{failed, wrong};
use crate::interrupt::{self, few};
use crate::manipulator::Manipulator;
use crate::parts::{Parts, Pickled};
use opm_study::{WorkspaceRequest, setup_fields, setup_of_fields};
use opm_workspace::{Axis, Count, Progress, Shard};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

/// The least number of poses in a part. Fewer are not worth sending to another process.
const LEAST_PART: u64 = 1 << 15;

/// A pickled [`Count`]: the number of poses, the number of reachable ones, ranges of the imaginary joints.
pub type Counted = (u64, u64, Vec<Option<[f64; 2]>>);

/// A sweep before it is done, as it is pickled: axes, kind, mode, limits, setup, threads.
type Spec = (Vec<(String, f64, f64, u64)>, String, String, Limits, Judged, Option<NonZeroUsize>);

/// The largest condition number, the worst values of indices by name, and the least distance of bodies.
type Limits = (Option<f64>, BTreeMap<String, f64>, Option<f64>);

/// The characteristic length, and what else poses are judged by, as words.
type Judged = (f64, BTreeMap<String, String>);

/// The result of `task` for each part of a sweep, in their order; or their combination by `fold`.
pub fn spread<'py>(
    plan: &Bound<'py, Sweep>,
    parts: &Parts<'py>,
    task: &str,
    fold: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    parts.session(plan.py(), |workers| {
        let count = parts.count(workers, plan.get().workspace.grid().poses(), LEAST_PART)?;
        let numbers: Vec<(u64, u64)> = (1..=count).map(|number| (number, count)).collect();
        workers.call_method1("run", (plan, task, numbers, fold))
    })
}

pub fn count_of((poses, reachable, imaginary): Counted) -> Count {
    Count { poses, reachable, imaginary }
}

pub fn shard(number: u64, of: u64) -> PyResult<Shard> {
    Shard::new(number, of).map_err(|error| failed(&error))
}

#[pymethods]
impl Sweep {
    /// Pickles the manipulator, the query and the counts, not the points of the workspace.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Pickled<'py, (Py<Manipulator>, Spec, Counted)>> {
        let this = slf.get();
        let axes = this.workspace.grid().axes().iter();
        let axes = axes.map(|a| (a.name.clone(), a.min, a.max, a.count)).collect();
        let Count { poses, reachable, imaginary } = this.count.clone();
        let (kind, mode) = (this.kind().to_owned(), this.mode.clone());
        let limits = (this.max_condition(), this.limits(), this.clearance());
        let setup = setup_fields(this.workspace.setup(), this.workspace.manipulator());
        let setup = setup.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
        let spec = (axes, kind, mode, limits, (this.length(), setup), this.threads);
        let of = this.of.clone_ref(slf.py());
        Ok((slf.get_type().getattr("_restored")?, (of, spec, (poses, reachable, imaginary))))
    }

    #[staticmethod]
    fn _restored(
        py: Python<'_>,
        manipulator: Py<Manipulator>,
        spec: Spec,
        count: Counted,
    ) -> PyResult<Self> {
        let (axes, kind, mode, (most, limits, clearance), (length, setup), threads) = spec;
        let axes = axes.into_iter().map(|(name, min, max, count)| Axis::new(name, min, max, count));
        let mut query = WorkspaceRequest::new(named(&kind)?);
        query.axes = axes.collect();
        (query.max_condition, query.clearance) = (most, clearance);
        let field = |name: &str| setup.get(name).map(|value| &**value);
        query.setup =
            setup_of_fields(field, length).ok_or_else(|| wrong("a pickle of another version"))?;
        query.limits = limits.into_iter().collect();
        let planned = Self::planned(py, manipulator, query, mode, threads)?;
        Ok(Self { count: count_of(count), ..planned })
    }

    /// The count of one part, number `number` of `of`.
    fn _count(&self, py: Python<'_>, number: u64, of: u64) -> PyResult<Counted> {
        let Count { poses, reachable, imaginary } = self.counted(py, shard(number, of)?)?;
        Ok((poses, reachable, imaginary))
    }
}

impl Sweep {
    pub fn counted(&self, py: Python<'_>, shard: Shard) -> PyResult<Count> {
        let progress = Progress::default();
        let sweep = self.swept(shard);
        let threads = few(self.threads, sweep.pieces());
        let count = interrupt::run(py, threads, || sweep.count(&progress), || progress.cancel())?;
        count.map_err(|error| failed(&error))
    }
}
