//! Sweeps of a grid of poses.

use crate::arguments;
use crate::error::{failed, wrong};
use crate::html;
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::measure::{self, Measure, goal};
use crate::parts::{Parts, Pickled};
use crate::rows::no_memory;
use crate::velocity::characteristic_length;
use numpy::npyffi::NPY_ORDER;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_cli::recording::{Attached, Kind, Shown, Swept, check, record_sweep};
use opm_core::manipulator as core;
use opm_workspace::measure::Over;
use opm_workspace::{
    Axis, Cancelled, ConditionLimit, Count, Grid, GridSet, Hits, Modes, Progress, Run, SetAxis,
    SetError, Shard, Visits, default_grid,
};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::ffi::CString;
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

/// Poses of a part at least: fewer are not worth the way to another process.
const LEAST_PART: u64 = 1 << 15;

/// A grid, swept: a workspace of some kind, of which a point is a pose, a place or an orientation.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Sweep {
    of: Py<Manipulator>,
    pub manipulator: Arc<core::Manipulator>,
    /// The values of every coordinate of the grid; of places and orientations, the others as well.
    pub grid: Grid,
    pub modes: Modes,
    asked: Asked,
    pub threads: Option<NonZeroUsize>,
    /// Points of the workspace: of poses, those in reach and within all limits.
    count: Count,
    tally: OnceLock<Arc<Vec<u64>>>,
}

/// What is asked of a grid.
#[derive(Clone, Debug)]
struct Asked {
    kind: Kind,
    mode: String,
    most: Option<f64>,
    length: f64,
}

/// Values of one coordinate: a number, or lowest, highest and how many.
#[derive(FromPyObject)]
enum Range {
    Fixed(f64),
    Several((f64, f64, u64)),
}

/// What x, y and z of a cloud are: three task coordinates, or `tip`.
#[derive(FromPyObject)]
enum CloudAxes {
    One(String),
    Several(Vec<String>),
}

/// Poses, reachable ones, and ranges of the imaginary joints: a [`Count`] as it crosses processes.
type Counted = (u64, u64, Vec<Option<[f64; 2]>>);

/// Find which poses of a grid are reachable and within all limits, or another kind of workspace.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
/// kind : str
///     What the workspace is of, in Merlet's terms; orientations are the coordinates of the upper section, places those of the
///     lower one.
///
///     * ``"grid"``: poses.
///     * ``"constant-orientation"``, ``"orientation"``: poses, with each coordinate of the upper or of the lower section held
///       at one value.
///     * ``"reachable"``, ``"dexterous"``: places that are reached in any, or in every orientation of the grid.
///     * ``"imaginary"``: orientations in which any place of the grid is reached: those that the imaginary joints follow from.
///     * ``"upper"``: the upper section alone, by its task coordinates, with the ranges of the imaginary joints that it needs.
///     * ``"lower"``: the lower section alone, by its task coordinates and the imaginary joints.
/// mode : str
///     ``"home"``, ``"any"``, or a sign for every two-valued choice.
/// max_condition : float, optional
///     Only poses with a condition number of at most this count, in a mode in which they have it.
/// length : float, optional
///     Characteristic length of condition numbers, metres. The spread of the joint axes if not given.
/// threads : int, optional
///     1 to 1024, here or in each worker; the result does not depend on it. A processor each if not given.
/// executor : concurrent.futures.Executor or callable, optional
///     Who does the work: a ``ProcessPoolExecutor``, a Dask cluster's ``client.get_executor(pure=False)``, one of
///     ``mpi4py.futures``. What is sent is the manipulator, the grid and the number of a shard; the result is that of one
///     process, to the bit. The shard of a lost worker runs again, three times at most. A process pool that has lost a worker
///     takes no more work: give a function that makes one, and the shards that are missing go to a new one.
/// shards : int, optional
///     How many parts the executor gets: 64 if not given, fewer for small grids.
/// **axes
///     Of each coordinate one value, or ``(min, max, count)`` with both ends on the grid; metres and radians. One that
///     is not given stays at home. Where none is given, the grid is fitted to the workspace, with a warning where that goes
///     on beyond it.
///
/// Raises
/// ------
/// OpmError
///     An axis that is none, ends that are not numbers or reversed, an unknown kind or mode, a grid that the kind is not of;
///     more places or orientations than fit in memory; shards that were lost again and again.
///
/// Examples
/// --------
/// >>> import opm_kinematics as opm
/// >>> m = opm.examples.load("plano-spherical-5dof")
/// >>> tilt = (-0.2, 0.2, 5)
/// >>> opm.sweep(m, kind="dexterous", x=(-0.1, 0.1, 41), y=(-0.1, 0.1, 41), zeta=tilt, xi=tilt, psi=tilt)
#[pyfunction]
#[pyo3(signature = (
    manipulator, /, *, kind = "grid", mode = "home", max_condition = None, length = None, threads = None,
    executor = None, shards = None, **axes
))]
#[allow(clippy::too_many_arguments)]
pub fn sweep(
    py: Python<'_>,
    manipulator: Py<Manipulator>,
    kind: &str,
    mode: &str,
    max_condition: Option<f64>,
    length: Option<f64>,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    executor: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    axes: Option<BTreeMap<String, Bound<'_, PyAny>>>,
) -> PyResult<Sweep> {
    let axes =
        axes.unwrap_or_default().into_iter().map(|(name, range)| match range.extract::<Range>() {
            Ok(Range::Fixed(value)) => Ok(Axis::fixed(name, value)),
            Ok(Range::Several((min, max, count))) => Ok(Axis::new(name, min, max, count)),
            Err(_) => Err(wrong(format!(
                "{name} is {}, expected a number or (min, max, count)",
                range.repr()?
            ))),
        });
    let mut axes = axes.collect::<PyResult<Vec<_>>>()?;
    let inner = &manipulator.get().inner;
    let asked = Asked {
        kind: named(kind)?,
        mode: mode.to_owned(),
        most: max_condition.map(condition_number).transpose()?,
        length: characteristic_length(inner, length)?,
    };
    let parts = Parts::new(executor, shards)?;
    if axes.is_empty() {
        axes = fitted(py, inner, asked.kind, modes(manipulator.get(), mode)?, threads)?;
    }
    let planned = Sweep::planned(manipulator, axes, asked, threads)?;
    let plan = Bound::new(py, planned)?;
    let mut count = match &parts {
        None => plan.get().counted(py, Shard::WHOLE)?,
        Some(parts) => {
            let counted: Vec<Counted> = spread(&plan, parts, "_count", None)?.extract()?;
            let nothing = Count::nothing(&plan.get().manipulator);
            counted.into_iter().fold(nothing, |all, part| all.merge(&count_of(part)))
        }
    };
    if let Some(least) = plan.get().least() {
        let tally = Sweep::tally(&plan, parts.as_ref())?;
        count.poses = tally.len() as u64;
        count.reachable = tally.iter().filter(|&&visits| visits >= least).count() as u64;
    }
    Ok(Sweep { count, ..plan.get().clone(py) })
}

/// The axes of a grid that suits the workspace, with a warning where that has no end.
fn fitted(
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
fn named(word: &str) -> PyResult<Kind> {
    let words = || Kind::all().iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
    Kind::named(word).ok_or_else(|| wrong(format!("kind is {word:?}, expected one of {}", words())))
}

/// A limit on condition numbers, checked.
fn condition_number(most: f64) -> PyResult<f64> {
    match most {
        1.0.. if most.is_finite() => Ok(most),
        _ => Err(wrong(format!("max_condition is {most:?}, expected a number of at least 1"))),
    }
}

/// What `task` of a sweep gives for each of its parts, in their order; or what they `fold` to.
pub fn spread<'py>(
    plan: &Bound<'py, Sweep>,
    parts: &Parts<'py>,
    task: &str,
    fold: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let count = parts.count(plan.get().grid.poses(), LEAST_PART);
    let numbers: Vec<(u64, u64)> = (1..=count).map(|number| (number, count)).collect();
    parts.session(plan.py(), |workers| workers.call_method1("run", (plan, task, numbers, fold)))
}

fn count_of((poses, reachable, imaginary): Counted) -> Count {
    Count { poses, reachable, imaginary }
}

#[pymethods]
impl Sweep {
    /// What the workspace is of, as it was asked for.
    #[getter]
    fn kind(&self) -> String {
        self.asked.kind.name()
    }

    /// The largest condition number at which a pose counts, if there is one.
    #[getter]
    fn max_condition(&self) -> Option<f64> {
        self.asked.most
    }

    /// Characteristic length of condition numbers, metres.
    #[getter]
    pub fn length(&self) -> f64 {
        self.asked.length
    }

    /// Orientations of the grid: values of the upper section's coordinates together.
    #[getter]
    fn orientations(&self) -> u64 {
        self.grid.slices()
    }

    /// Points of the workspace: of poses, those in reach and within all limits.
    #[getter]
    fn count(&self) -> u64 {
        self.count.reachable
    }

    /// Points of the grid that could be in: poses, places of the grid, or orientations of it.
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
        for (joint, range) in self.manipulator.imaginary().iter().zip(&self.count.imaginary) {
            dict.set_item(&joint.name, range.map(|[low, high]| (low, high)))?;
        }
        Ok(dict)
    }

    /// The values of every coordinate of the points, in the order of the mask's axes.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        values(py, &self.grid.axes()[self.span()])
    }

    /// The values of every coordinate of the grid; of places and orientations, the others as well.
    #[getter]
    fn grid<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        values(py, self.grid.axes())
    }

    /// ``"m"`` or ``"rad"`` of every coordinate of the grid, by name.
    #[getter]
    fn units(&self) -> BTreeMap<&str, &'static str> {
        self.grid.coordinates().iter().map(|c| (&*c.name, c.quantity.unit())).collect()
    }

    /// Which points are in: an axis a coordinate of :attr:`axes`, as many values as the grid has.
    ///
    /// `executor` and `shards` are those of :func:`sweep`, here and in all other methods; places and orientations are known
    /// already, and nobody is asked again.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn mask<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mask = Self::flat_mask(slf, Parts::new(executor, shards)?.as_ref())?;
        slf.get().shaped(&mask)
    }

    /// (count, d): the points in the order of the grid, the first coordinate fastest; columns as :attr:`axes`.
    ///
    /// Parameters
    /// ----------
    /// executor : concurrent.futures.Executor or callable, optional
    ///     As for :func:`sweep`.
    /// shards : int, optional
    ///     As for :func:`sweep`.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn points<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this, parts) = (slf.py(), slf.get(), Parts::new(executor, shards)?);
        match (this.least(), parts) {
            (Some(_), parts) => {
                let set = Self::set(slf, parts.as_ref())?;
                let points: Vec<f64> =
                    py.detach(|| set.numbers().flat_map(|number| set.point(number)).collect());
                let shape = [set.count() as usize, set.axes().len()];
                Ok(points.into_pyarray(py).reshape(shape)?.into_any())
            }
            (None, None) => {
                this.pointed(py, Shard::WHOLE, this.count.reachable).map(Bound::into_any)
            }
            (None, Some(parts)) => {
                let parts = spread(slf, &parts, "_points", None)?;
                py.import("numpy")?.call_method1("concatenate", (parts,))
            }
        }
    }

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

    /// How much of the box that the grid covers is in reach: :func:`measure` over it.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The points are places or orientations, or there is a `max_condition`, of which a measure knows nothing.
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
        if self.least().is_some() {
            let (kind, points) = (self.kind(), self.asked.kind.points());
            return Err(wrong(format!(
                "a measure is of poses or of one section, not of {kind} {points}"
            )));
        }
        if self.asked.most.is_some() {
            return Err(wrong("a measure knows no max_condition: sweep without it"));
        }
        let axes = self.grid.axes().iter();
        let over: Vec<_> = axes.map(|a| Over::new(a.name.as_str(), a.min, a.max)).collect();
        let (of, sections) = (self.of.clone_ref(py), self.grid.sections());
        let asked = measure::Asked { of, sections, modes: self.modes, threads: self.threads };
        asked.measured(py, &over, goal(tolerance, budget)?, Parts::new(executor, shards)?)
    }

    /// Pickling: with the manipulator, not with what the grid holds.
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Pickled<'py, (Py<Manipulator>, Spec, Counted)>> {
        let this = slf.get();
        let axes = this.grid.axes().iter().map(|a| (a.name.clone(), a.min, a.max, a.count));
        let Count { poses, reachable, imaginary } = this.count.clone();
        let Asked { kind, mode, most, length } = this.asked.clone();
        let spec = (axes.collect(), kind.name(), mode, most, length, this.threads);
        let of = this.of.clone_ref(slf.py());
        Ok((slf.get_type().getattr("_restored")?, (of, spec, (poses, reachable, imaginary))))
    }

    #[staticmethod]
    fn _restored(manipulator: Py<Manipulator>, spec: Spec, count: Counted) -> PyResult<Self> {
        let (axes, kind, mode, most, length, threads) = spec;
        let axes = axes.into_iter().map(|(name, min, max, count)| Axis::new(name, min, max, count));
        let asked = Asked { kind: named(&kind)?, mode, most, length };
        let planned = Self::planned(manipulator, axes.collect(), asked, threads)?;
        Ok(Self { count: count_of(count), ..planned })
    }

    /// The count of one part, number `number` of `of`.
    fn _count(&self, py: Python<'_>, number: u64, of: u64) -> PyResult<Counted> {
        let Count { poses, reachable, imaginary } = self.counted(py, shard(number, of)?)?;
        Ok((poses, reachable, imaginary))
    }

    /// Of every pose of one part, in their order, whether it is reachable.
    fn _mask<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        of: u64,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        self.masked(py, shard(number, of)?)
    }

    /// The reachable poses of one part.
    fn _points<'py>(
        &self,
        py: Python<'py>,
        number: u64,
        of: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.pointed(py, shard(number, of)?, 0)
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

    /// Record the points as ``opm workspace -o`` does, byte for byte.
    ///
    /// With the boundary, but for kind ``"grid"``. Points that are no poses are written as MCAP only.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     Ends in ``.mcap`` (Foxglove, Lichtblick, Rerun), ``.npy`` (NumPy) or ``.ply`` (mesh tools). The file appears
    ///     when it is whole.
    /// axes : sequence of three str, or "tip", optional
    ///     The coordinates that are x, y and z of the cloud (of kind ``"imaginary"`` imaginary joints), or the platform's point.
    /// scalars : sequence of str, optional
    ///     Values stored with every point: task coordinates, imaginary joints, actuated joints, ``inverse_condition``; of places
    ///     the ``share`` of orientations in which they are reached.
    /// color : str, optional
    ///     The one of them that the colour shows.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A name that is none, a file that cannot be written.
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None))]
    fn write(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        axes: Option<CloudAxes>,
        #[pyo3(from_py_with = arguments::scalars)] scalars: Option<Vec<String>>,
        color: Option<String>,
    ) -> PyResult<()> {
        let of = self.of.get();
        let name = of.file_name();
        let swept = Swept {
            mechanism: Attached { name: &name, text: of.text() },
            manipulator: &self.manipulator,
            kind: self.asked.kind,
            grid: &self.grid,
            modes: self.modes,
            limit: self.limit(),
            length: self.asked.length,
            found: &self.count,
        };
        let axes = match axes {
            None => Vec::new(),
            Some(CloudAxes::One(name)) => vec![name],
            Some(CloudAxes::Several(names)) => names,
        };
        let shown = Shown { axes, scalars, color };
        let progress = Progress::default();
        let work = || record_sweep(&swept, shown, &path, &progress);
        interrupt::run(py, self.threads, work, || progress.cancel())?.map_err(wrong)
    }

    /// :meth:`write`, of a name that ends in ``.mcap``.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     The file appears when it is whole.
    /// axes : sequence of three str, or "tip", optional
    ///     As for :meth:`write`.
    /// scalars : sequence of str, optional
    ///     As for :meth:`write`.
    /// color : str, optional
    ///     As for :meth:`write`.
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None))]
    fn write_mcap(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = arguments::path)] path: PathBuf,
        axes: Option<CloudAxes>,
        #[pyo3(from_py_with = arguments::scalars)] scalars: Option<Vec<String>>,
        color: Option<String>,
    ) -> PyResult<()> {
        if !path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) {
            let path = path.display();
            return Err(wrong(format!("{path}, expected a name that ends in .mcap")));
        }
        self.write(py, path, axes, scalars, color)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "sweep")
    }

    /// The working mode, as it was asked for.
    #[getter]
    fn mode(&self) -> &str {
        &self.asked.mode
    }

    fn __repr__(&self) -> String {
        let axes: Vec<_> =
            self.grid.axes().iter().map(|a| format!("{} {}", a.name, a.count)).collect();
        let Asked { kind, mode, most, .. } = &self.asked;
        let limit = most.map_or(String::new(), |most| format!(", condition at most {most}"));
        format!(
            "<Sweep of {}: {} of {} {} {} in mode {mode:?}{limit}, grid {}>",
            self.manipulator.mechanism().name,
            self.count.reachable,
            self.count.poses,
            kind.points(),
            kind.reached(),
            axes.join(" x ")
        )
    }
}

/// A sweep that is still to be done, as it crosses processes: axes, kind, mode, largest condition number,
/// characteristic length, threads.
type Spec = (Vec<(String, f64, f64, u64)>, String, String, Option<f64>, f64, Option<NonZeroUsize>);

/// The values of axes, by name.
fn values<'py>(py: Python<'py>, axes: &[Axis]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for axis in axes {
        let values: Vec<f64> = (0..axis.count).map(|i| axis.value(i)).collect();
        dict.set_item(&axis.name, values.into_pyarray(py))?;
    }
    Ok(dict)
}

/// The working modes that count: one, or any.
pub fn modes(manipulator: &Manipulator, mode: &str) -> PyResult<Modes> {
    match mode {
        "any" => Ok(Modes::Any),
        mode => manipulator.mode(mode).map(Modes::One),
    }
}

pub fn shard(number: u64, of: u64) -> PyResult<Shard> {
    Shard::new(number, of).map_err(|error| failed(&error))
}

impl Sweep {
    /// A sweep that is still to be done.
    fn planned(
        of: Py<Manipulator>,
        axes: Vec<Axis>,
        asked: Asked,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Self> {
        let manipulator = Arc::clone(&of.get().inner);
        let grid = Grid::of(asked.kind.sections(), &manipulator, axes).map_err(|e| failed(&e))?;
        let modes = modes(of.get(), &asked.mode)?;
        let (count, tally) = (Count::nothing(&manipulator), OnceLock::new());
        let planned = Self { of, manipulator, grid, modes, asked, threads, count, tally };
        let kind = planned.asked.kind;
        check(kind, &planned.manipulator, &planned.grid, modes, planned.limit()).map_err(wrong)?;
        Ok(planned)
    }

    fn clone(&self, py: Python<'_>) -> Self {
        Self {
            of: self.of.clone_ref(py),
            manipulator: Arc::clone(&self.manipulator),
            grid: self.grid.clone(),
            asked: self.asked.clone(),
            count: self.count.clone(),
            tally: self.tally.clone(),
            ..*self
        }
    }

    pub fn limit(&self) -> Option<ConditionLimit> {
        self.asked.most.map(|most| ConditionLimit { most, length: self.asked.length })
    }

    pub fn asked_kind(&self) -> Kind {
        self.asked.kind
    }

    /// The numbers of the axes that its points have.
    fn span(&self) -> std::ops::Range<usize> {
        self.asked.kind.axes(&self.grid)
    }

    /// How often a point has to be reached to be in: of a kind whose points are no points of the grid.
    fn least(&self) -> Option<u64> {
        match self.asked.kind {
            Kind::Reachable | Kind::Imaginary => Some(1),
            Kind::Dexterous => Some(self.grid.slices()),
            _ => None,
        }
    }

    pub fn swept(&self, shard: Shard) -> opm_workspace::Sweep<'_> {
        let sweep = opm_workspace::Sweep::new(&self.manipulator, &self.grid, self.modes);
        sweep.limited(self.limit()).shard(shard)
    }

    fn counted(&self, py: Python<'_>, shard: Shard) -> PyResult<Count> {
        let progress = Progress::default();
        let sweep = self.swept(shard);
        let count =
            interrupt::run(py, self.threads, || sweep.count(&progress), || progress.cancel())?;
        count.map_err(|error| failed(&error))
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
    fn tally<'py>(slf: &Bound<'py, Self>, parts: Option<&Parts<'py>>) -> PyResult<Arc<Vec<u64>>> {
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

    /// Of every point, whether it is in.
    pub fn flat_mask<'py>(
        slf: &Bound<'py, Self>,
        parts: Option<&Parts<'py>>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let (py, this) = (slf.py(), slf.get());
        match (this.least(), parts) {
            (Some(least), parts) => {
                let tally = Self::tally(slf, parts)?;
                Ok(PyArray1::from_iter(py, tally.iter().map(|&visits| visits >= least)))
            }
            (None, None) => this.masked(py, Shard::WHOLE),
            (None, Some(parts)) => {
                let parts = spread(slf, parts, "_mask", None)?;
                Ok(py.import("numpy")?.call_method1("concatenate", (parts,))?.cast_into()?)
            }
        }
    }

    /// Its points.
    pub fn set<'py>(slf: &Bound<'py, Self>, parts: Option<&Parts<'py>>) -> PyResult<GridSet> {
        let (py, this) = (slf.py(), slf.get());
        let axes = || {
            let axis = |i: usize| SetAxis {
                axis: this.grid.axes()[i].clone(),
                circle: this.grid.is_circle(i),
            };
            this.span().map(axis).collect()
        };
        let set = match (this.least(), parts) {
            (Some(least), parts) => {
                let tally = Self::tally(slf, parts)?;
                py.detach(|| GridSet::of(axes(), |number| tally[number as usize] >= least))
            }
            (None, None) => {
                let (progress, sweep) = (Progress::default(), this.swept(Shard::WHOLE));
                let work = || GridSet::reached(&sweep, &progress);
                interrupt::run(py, this.threads, work, || progress.cancel())?
            }
            (None, Some(parts)) => {
                let mask = Self::flat_mask(slf, Some(parts))?.readonly();
                let mask = mask.as_slice()?;
                py.detach(|| GridSet::of(axes(), |number| mask[number as usize]))
            }
        };
        set.map_err(|error| failed(&error))
    }

    /// Values of all points in the shape of the grid.
    pub fn shaped<'py, T: numpy::Element>(
        &self,
        flat: &Bound<'py, PyArray1<T>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let axes = &self.grid.axes()[self.span()];
        let shape: Vec<usize> = axes.iter().map(|axis| axis.count as usize).collect();
        // The first coordinate is the fastest: an array in Fortran's order, which numpy sees as such.
        Ok(flat.reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)?.into_any())
    }

    fn masked<'py>(&self, py: Python<'py>, shard: Shard) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let sweep = self.swept(shard);
        let poses = usize::try_from(sweep.poses()).map_err(|error| failed(&error))?;
        let before = sweep.range().start;
        let mut mask = Vec::new();
        let short = |_| no_memory(format_args!("a mask of {poses} poses"));
        mask.try_reserve_exact(poses).map_err(short)?;
        mask.resize(poses, false);
        self.visit(
            py,
            shard,
            |hits, made: &mut Vec<Run>| made.extend(hits.numbers(&self.grid)),
            |made| {
                for Run { from, to } in made {
                    mask[(from - before) as usize..(to - before) as usize].fill(true);
                }
            },
        )?;
        Ok(mask.into_pyarray(py))
    }

    fn pointed<'py>(
        &self,
        py: Python<'py>,
        shard: Shard,
        expected: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.grid.axes().len();
        let expected = usize::try_from(expected).map_err(|error| failed(&error))?;
        let mut all = Vec::new();
        let short = |_| no_memory(format_args!("{expected} points"));
        all.try_reserve_exact(expected.saturating_mul(width)).map_err(short)?;
        self.visit(
            py,
            shard,
            |hits, made: &mut Vec<f64>| {
                for &first in hits.first {
                    made.push(first);
                    made.extend(hits.others);
                }
            },
            |made| all.extend(made),
        )?;
        let count = all.len() / width;
        all.into_pyarray(py).reshape([count, width])
    }

    /// Sweeps again, for the points: what `make` keeps of the hits goes to `take`, in their order.
    pub fn visit<T: Default + Send>(
        &self,
        py: Python<'_>,
        shard: Shard,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        mut take: impl FnMut(T) + Send,
    ) -> PyResult<()> {
        let progress = Progress::default();
        let sweep = self.swept(shard);
        let work = || {
            sweep.points(&progress, &make, T::default, |made| {
                take(made);
                Ok::<(), Cancelled>(())
            })
        };
        let done = interrupt::run(py, self.threads, work, || progress.cancel())?;
        done.map_err(|error| failed(&error))
    }
}
