//! The aspects of a workspace: its connected parts without a singularity, and paths in them.

use super::Sweep;
use crate::arguments;
use crate::error::{failed, wrong};
use crate::interrupt;
use crate::parts::Parts;
use crate::pickle::pickled;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_core::manipulator::Mode;
use opm_workspace::{Aspects, NoPath, Progress, find_path};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroU64;
use std::sync::Arc;

/// A connected part of the poses in reach in one working mode that has no singularity.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Aspect {
    /// Number of the aspect, from 1 for the largest: its label in :meth:`Sweep.labels`.
    number: u32,
    /// 1 or -1, the sign of the parallel measure of the whole mechanism. Only whether two signs differ has a meaning.
    sign: i8,
    /// Number of its poses.
    count: u64,
    /// Lowest and highest value of each coordinate, radians and metres.
    extent: BTreeMap<String, (f64, f64)>,
}

pickled!(Aspect { number, sign, count, extent });

#[pymethods]
impl Aspect {
    fn __repr__(&self) -> String {
        let sign = if self.sign > 0 { "positive" } else { "negative" };
        format!("<Aspect {}: {sign}, {} poses>", self.number, self.count)
    }
}

#[pymethods]
impl Sweep {
    /// The aspects, the largest first: connected parts of the poses that have no singularity.
    ///
    /// :meth:`labels` gives the number of the aspect of each pose, 0 for one that is out of reach or singular.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`: for the sweep; the aspects are found here.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    ///
    /// Returns
    /// -------
    /// list of Aspect
    ///     Number 1 first.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The kind of the workspace is not ``"aspects"``.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn aspects<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Vec<Aspect>> {
        let aspects = Self::found(slf, Parts::new(executor, shards)?.as_ref())?;
        let names = aspects.axes().iter().map(|axis| axis.axis.name.clone());
        let names: Vec<String> = names.collect();
        let aspect = |(number, aspect): (usize, &opm_workspace::Aspect)| Aspect {
            number: number as u32 + 1,
            sign: if aspect.is_positive() { 1 } else { -1 },
            count: aspect.poses,
            extent: names.iter().cloned().zip(aspect.extent.iter().map(|&[a, b]| (a, b))).collect(),
        };
        Ok(aspects.list().iter().enumerate().map(aspect).collect())
    }

    /// A path of the platform between two poses that passes no singularity, in the working mode of the sweep.
    ///
    /// It is straight if that is possible, else it leads through the aspect that both poses are in, far from singularities.
    /// :func:`trajectory` follows it: ``opm.trajectory(m, path[:, 1:], times=path[:, 0])``.
    ///
    /// Parameters
    /// ----------
    /// start : sequence of float
    ///     The first pose, a value for each task coordinate.
    /// goal : sequence of float
    ///     The last pose; angles may end full turns from it.
    /// duration : float
    ///     Time that the path takes, seconds.
    ///
    /// Returns
    /// -------
    /// numpy.ndarray
    ///     (n, 1 + number of task coordinates): the time of each pose, seconds, and its coordinates. The motion through the
    ///     poses, at rest at both ends, has been watched between them for singularities, limits of joints and reach.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     There is no such path on this grid; the kind of the workspace is not ``"aspects"``; or a pose is out of reach,
    ///     beyond limits or singular.
    #[pyo3(signature = (start, goal, *, duration = 10.0))]
    fn path<'py>(
        slf: &Bound<'py, Self>,
        start: Vec<f64>,
        goal: Vec<f64>,
        duration: f64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if !(1e-6..=1e9).contains(&duration) {
            return Err(wrong(format!("duration is {duration:?}, expected 1e-6 to 1e9 seconds")));
        }
        let (py, aspects) = (slf.py(), Self::found(slf, None)?);
        let (this, mode) = (slf.get(), Self::mode_of(slf)?);
        let progress = Progress::default();
        let find = || {
            let manipulator = this.workspace.manipulator();
            find_path(manipulator, mode, &aspects, [&start, &goal], duration, &progress)
        };
        let found = interrupt::run(py, this.threads, find, || progress.cancel())?;
        let path = found.map_err(|error: NoPath| failed(&error))?;
        let rows = path.times.iter().zip(&path.poses);
        let values: Vec<f64> =
            rows.flat_map(|(time, pose)| std::iter::once(time).chain(pose).copied()).collect();
        let shape = [path.times.len(), values.len() / path.times.len()];
        values.into_pyarray(py).reshape(shape)
    }
}

impl Sweep {
    /// The aspects of a sweep of this kind, which are found once.
    pub fn found<'py>(
        slf: &Bound<'py, Self>,
        parts: Option<&Parts<'py>>,
    ) -> PyResult<Arc<Aspects>> {
        let (py, this) = (slf.py(), slf.get());
        if let Some(known) = this.aspects.get() {
            return Ok(Arc::clone(known));
        }
        let (mode, set) = (Self::mode_of(slf)?, Self::set(slf, parts)?);
        let progress = Progress::default();
        let work = || Aspects::new(this.workspace.manipulator(), mode, &set, &progress);
        let found = interrupt::run(py, this.threads, work, || progress.cancel())?;
        let found = Arc::new(found.map_err(|error| failed(&error))?);
        Ok(Arc::clone(this.aspects.get_or_init(|| found)))
    }

    fn mode_of(slf: &Bound<'_, Self>) -> PyResult<Mode> {
        let workspace = &slf.get().workspace;
        let kind = workspace.kind();
        let mode = workspace.modes().one().filter(|_| kind == opm_study::WorkspaceKind::Aspects);
        mode.ok_or_else(|| wrong(format!("the kind is {kind}; sweep with kind=\"aspects\"")))
    }
}
