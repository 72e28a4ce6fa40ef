//! Sweeps of a grid of poses. Each kind of result of a sweep has a file.

mod aspects;
mod boundary;
mod components;
mod conditioning;
mod measure;
mod places;
mod points;
mod query;
mod questions;
mod recording;
mod shards;

pub use aspects::Aspect;
pub use boundary::Outline;
pub use conditioning::Conditioning;
pub use query::modes;
pub use questions::{Inscribed, Rejection};

use crate::arguments;
use crate::columns::table;
use crate::error::request;
use crate::html;
use crate::manipulator::Manipulator;
use crate::parts::Parts;
use crate::setup::Given;
use numpy::IntoPyArray;
use opm_study::{Workspace, WorkspaceRequest};
use opm_workspace::{Aspects, Axis, Count, Shard};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use query::{fitted, named};
use shards::{Counted, count_of, spread};
use std::collections::BTreeMap;
use std::num::{NonZeroU64, NonZeroUsize};
use std::sync::{Arc, OnceLock};

/// A swept grid: a workspace of some kind, whose points are poses, places or orientations.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Sweep {
    of: Py<Manipulator>,
    workspace: Workspace,
    /// The working mode, as it was given.
    mode: String,
    threads: Option<NonZeroUsize>,
    /// Number of points of the workspace. A pose counts if it is in reach and within all limits.
    count: Count,
    tally: OnceLock<Arc<Vec<u64>>>,
    aspects: OnceLock<Arc<Aspects>>,
}

/// Find which poses of a grid are reachable and within all limits, or another kind of workspace.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
/// kind : str
///     Kind of the workspace, in Merlet's terms; orientations are the coordinates of the upper section, places those of the
///     lower one. In one subspace, orientations are its angles, places its lengths.
///
///     * ``"grid"``: poses.
///     * ``"constant-orientation"``, ``"orientation"``: poses, with each coordinate of the orientation or of the place held at
///       one value.
///     * ``"aspects"``: poses in one working mode, divided into connected parts without a singularity (:meth:`Sweep.aspects`).
///     * ``"reachable"``, ``"dexterous"``: places that are reached in any, or in every orientation of the grid.
///     * ``"imaginary"``: orientations in which any place of the grid is reached: those that the imaginary joints follow from.
///     * ``"upper"``: the upper section alone, by its task coordinates, with the ranges of the imaginary joints that it needs.
///     * ``"lower"``: the lower section alone, by its task coordinates and the imaginary joints.
/// mode : str
///     ``"home"``, ``"any"``, or a sign for every two-valued choice.
/// max_condition : float, optional
///     Only poses whose condition number is at most this count, in a mode in which it is.
/// limits : dict of str to float, optional
///     Only poses whose indices are as good as these values, in a mode in which they are: ``{"lti": 0.7}``. The names are
///     those of :class:`Analysis`.
/// clearance : float, optional
///     Only poses count at which all bodies are at least this far apart, metres (:meth:`Manipulator.clearance`), in one working
///     mode.
/// wrench, at, frame, gravity, density, link_stiffness, joint_stiffness : optional
///     What indices are computed with, as for :meth:`Manipulator.analyze`, with one wrench for all poses: for `limits` and for
///     the values of a recording, such as ``"effort.S1"``.
/// length : float, optional
///     Characteristic length of condition numbers, metres. The spread of the joint axes if not given.
/// threads : int, optional
///     1 to 1024, here or in each worker; the result does not depend on it. One for each processor if not given.
/// executor : concurrent.futures.Executor or callable, optional
///     Where the work is done: a ``ProcessPoolExecutor``, a Dask cluster's ``client.get_executor(pure=False)``, one of
///     ``mpi4py.futures``. What is sent is the manipulator, the grid and the number of a shard; the result is that of one
///     process, to the bit. The shard of a lost worker runs again, three times at most. A process pool that has lost a worker
///     takes no more work: give a function that makes one, and the shards that are missing go to a new one.
/// shards : int, optional
///     How many parts the executor gets: 8 for each worker if not given, 64 if it does not say how many it has; fewer for
///     small grids.
/// **axes
///     For each coordinate one value, or ``(min, max, count)`` with both ends on the grid, or a list or an array of evenly
///     spaced values, such as ``numpy.linspace`` gives; metres and radians. A coordinate that is not given stays at home. If
///     none is given, the grid is fitted to the workspace, with a warning if the workspace continues beyond it.
///
/// Returns
/// -------
/// Sweep
///     The points as they are asked for: :meth:`Sweep.mask`, :meth:`Sweep.points` and others.
///
/// Raises
/// ------
/// OpmError
///     An axis is not a coordinate; its ends are reversed or not numbers; the kind or mode is unknown; the grid does not suit
///     the kind; the places or orientations do not fit in memory; or shards were lost repeatedly.
///
/// Examples
/// --------
/// >>> import opm_kinematics as opm
/// >>> m = opm.examples.load("plano-spherical-5dof")
/// >>> tilt = (-0.2, 0.2, 5)
/// >>> opm.sweep(m, kind="dexterous", x=(-0.1, 0.1, 41), y=(-0.1, 0.1, 41), zeta=tilt, xi=tilt, psi=tilt)
#[pyfunction]
#[pyo3(signature = (
    manipulator, /, *, kind = "grid", mode = "home", max_condition = None, limits = None, clearance = None,
    wrench = None, at = None, frame = "base", gravity = None, density = None, link_stiffness = None,
    joint_stiffness = None, length = None, threads = None, executor = None, shards = None, **axes
))]
#[allow(clippy::too_many_arguments)]
pub fn sweep(
    py: Python<'_>,
    manipulator: Py<Manipulator>,
    kind: &str,
    mode: &str,
    max_condition: Option<f64>,
    limits: Option<BTreeMap<String, f64>>,
    clearance: Option<f64>,
    wrench: Option<Bound<'_, PyAny>>,
    at: Option<Bound<'_, PyAny>>,
    frame: &str,
    gravity: Option<Bound<'_, PyAny>>,
    density: Option<f64>,
    link_stiffness: Option<[f64; 2]>,
    joint_stiffness: Option<BTreeMap<String, f64>>,
    length: Option<f64>,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    executor: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    axes: Option<BTreeMap<String, Bound<'_, PyAny>>>,
) -> PyResult<Sweep> {
    let mut query = WorkspaceRequest::new(named(kind)?);
    query.axes = query::axes(axes.unwrap_or_default())?;
    query.max_condition = max_condition;
    query.clearance = clearance;
    let (wrench, at, gravity) = (wrench.as_ref(), at.as_ref(), gravity.as_ref());
    let given =
        Given { wrench, at, frame, gravity, density, link_stiffness, joint_stiffness, length };
    query.setup = given.options()?;
    query.limits = limits.unwrap_or_default().into_iter().collect();
    let parts = Parts::new(executor, shards)?;
    let planned = Sweep::planned(py, manipulator, query, mode.to_owned(), threads)?;
    let plan = Bound::new(py, planned)?;
    let mut count = match &parts {
        None => plan.get().counted(py, Shard::WHOLE)?,
        Some(parts) => {
            let counted: Vec<Counted> = spread(&plan, parts, "_count", None)?.extract()?;
            let nothing = Count::nothing(plan.get().workspace.manipulator());
            counted.into_iter().fold(nothing, |all, part| all.merge(&count_of(part)))
        }
    };
    if let Some(required) = plan.get().workspace.required_visits() {
        let tally = Sweep::tally(&plan, parts.as_ref())?;
        count.poses = tally.len() as u64;
        count.reachable = tally.iter().filter(|&&visits| visits >= required).count() as u64;
    }
    Ok(Sweep { count, ..plan.get().clone(py) })
}

#[pymethods]
impl Sweep {
    /// The kind of the workspace, as it was given.
    #[getter]
    fn kind(&self) -> &'static str {
        self.workspace.kind().name()
    }

    /// The largest condition number at which a pose counts, if it is limited.
    #[getter]
    fn max_condition(&self) -> Option<f64> {
        self.workspace.limit().and_then(opm_workspace::PoseLimit::max_condition)
    }

    /// The worst values of indices at which a pose counts, by name.
    #[getter]
    fn limits(&self) -> BTreeMap<String, f64> {
        let limit = self.workspace.limit();
        let each = limit.iter().flat_map(|limit| limit.indices.iter());
        each.map(|(index, bound)| (index.name().to_owned(), bound)).collect()
    }

    /// The least distance of bodies at which a pose counts, metres, if it is limited.
    #[getter]
    fn clearance(&self) -> Option<f64> {
        self.workspace.clearance().map(|clearance| clearance.least)
    }

    /// Characteristic length of condition numbers, metres.
    #[getter]
    fn length(&self) -> f64 {
        self.workspace.length()
    }

    /// Number of orientations of the grid: combinations of values of its coordinates.
    #[getter]
    fn orientations(&self) -> u64 {
        self.workspace.grid().orientation_count()
    }

    /// Number of points of the workspace. A pose counts if it is in reach and within all limits.
    #[getter]
    fn count(&self) -> u64 {
        self.count.reachable
    }

    /// Number of points of the grid: its poses, places or orientations.
    #[getter]
    fn poses(&self) -> u64 {
        self.count.poses
    }

    /// ``count / poses``.
    #[getter]
    fn fraction(&self) -> f64 {
        self.count.reachable as f64 / self.count.poses as f64
    }

    /// Lowest and highest value of every imaginary joint over the reachable poses of the grid.
    #[getter]
    fn imaginary_range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (joint, range) in
            self.workspace.manipulator().imaginary().iter().zip(&self.count.imaginary)
        {
            dict.set_item(&joint.name, range.map(|[low, high]| (low, high)))?;
        }
        Ok(dict)
    }

    /// The values of every coordinate of the points, in the order of the mask's axes.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        values(py, &self.workspace.grid().axes()[self.span()])
    }

    /// The values of every coordinate of the grid, including those that places or orientations do not have.
    #[getter]
    fn grid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        values(py, self.workspace.grid().axes())
    }

    /// ``"m"`` or ``"rad"`` of every coordinate of the grid, by name.
    #[getter]
    fn units(&self) -> BTreeMap<&str, &'static str> {
        self.workspace.grid().coordinates().iter().map(|c| (&*c.name, c.quantity.unit())).collect()
    }

    /// Sweeps are equal if their mechanisms and queries are equal, on any number of threads.
    fn __eq__(&self, other: &Self) -> bool {
        self.of.get() == other.of.get()
            && self.mode == other.mode
            && self.workspace.has_request_of(&other.workspace)
    }

    /// The points as a table of pandas, with a column for each coordinate.
    ///
    /// Returns
    /// -------
    /// pandas.DataFrame
    ///     SI units and radians.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        table(slf.as_any(), "sweep_to_pandas")
    }

    /// The mask as an array of xarray, with the values of each coordinate along its axes.
    ///
    /// Returns
    /// -------
    /// xarray.DataArray
    ///     SI units and radians along the axes.
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        table(slf.as_any(), "sweep_to_xarray")
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "sweep")
    }

    /// The working mode, as it was given.
    #[getter]
    fn mode(&self) -> &str {
        &self.mode
    }

    fn __repr__(&self) -> String {
        let axes: Vec<_> = self
            .workspace
            .grid()
            .axes()
            .iter()
            .map(|a| format!("{} {}", a.name, a.count))
            .collect();
        let (kind, mode) = (self.workspace.kind(), &self.mode);
        let limit = self
            .max_condition()
            .map_or(String::new(), |most| format!(", condition at most {most}"));
        format!(
            "<Sweep of {}: {} of {} {} {} in mode {mode:?}{limit}, grid {}>",
            self.workspace.manipulator().mechanism().name,
            self.count.reachable,
            self.count.poses,
            kind.point_name(),
            kind.member_name(),
            axes.join(" x ")
        )
    }
}

/// The values of each axis, by its name.
fn values<'py>(py: Python<'py>, axes: &[Axis]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for axis in axes {
        let values: Vec<f64> = (0..axis.count).map(|i| axis.value(i)).collect();
        dict.set_item(&axis.name, values.into_pyarray(py))?;
    }
    Ok(dict)
}

impl Sweep {
    /// A sweep before it is done. If no axis is given, the grid is fitted to the workspace.
    fn planned(
        py: Python<'_>,
        of: Py<Manipulator>,
        mut query: WorkspaceRequest,
        mode: String,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Self> {
        query.modes = Some(modes(of.get(), &mode)?);
        let manipulator = Arc::clone(&of.get().inner);
        let count = Count::nothing(&manipulator);
        let checked = query.check(manipulator).map_err(|error| request(&error))?;
        let workspace = fitted(py, checked, threads)?;
        Ok(Self {
            of,
            workspace,
            mode,
            threads,
            count,
            tally: OnceLock::new(),
            aspects: OnceLock::new(),
        })
    }

    fn clone(&self, py: Python<'_>) -> Self {
        Self {
            of: self.of.clone_ref(py),
            workspace: self.workspace.clone(),
            mode: self.mode.clone(),
            count: self.count.clone(),
            tally: self.tally.clone(),
            aspects: self.aspects.clone(),
            ..*self
        }
    }

    /// The numbers of the axes that its points have.
    fn span(&self) -> std::ops::Range<usize> {
        self.workspace.kind().axes(self.workspace.grid())
    }

    fn swept(&self, shard: Shard) -> opm_workspace::Sweep<'_> {
        self.workspace.sweep().shard(shard)
    }
}
