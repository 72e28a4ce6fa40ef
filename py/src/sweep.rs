//! Sweeps of a grid of poses.

use crate::error::{failed, wrong};
use crate::html;
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::rows::no_memory;
use numpy::npyffi::NPY_ORDER;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use opm_cli::recording::{Attached, Shown, Swept, record_sweep};
use opm_core::manipulator as core;
use opm_workspace::{Axis, Cancelled, Count, Grid, Hits, Modes, Progress};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;

/// A grid of poses, swept.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Sweep {
    owner: Py<Manipulator>,
    manipulator: Arc<core::Manipulator>,
    grid: Grid,
    modes: Modes,
    mode: String,
    threads: Option<NonZeroUsize>,
    count: Count,
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

/// Sweeps a grid: `sweep(m, x=(min, max, count), y=value)`. A coordinate that is not given stays at
/// home.
#[pyfunction]
#[pyo3(signature = (manipulator, /, *, mode = "home", threads = None, **axes))]
pub fn sweep(
    py: Python<'_>,
    manipulator: &Bound<'_, Manipulator>,
    mode: &str,
    threads: Option<NonZeroUsize>,
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
    let owner = manipulator.clone().unbind();
    let manipulator = manipulator.get();
    let inner = Arc::clone(&manipulator.inner);
    let grid = Grid::new(&inner, axes.collect::<PyResult<_>>()?).map_err(|e| failed(&e))?;
    let modes = match mode {
        "any" => Modes::Any,
        mode => Modes::One(manipulator.mode(mode)?),
    };
    let progress = Progress::default();
    let swept = opm_workspace::Sweep::new(&inner, &grid, modes);
    let count = interrupt::run(py, threads, || swept.count(&progress), || progress.cancel())?;
    let count = count.map_err(|error| failed(&error))?;
    Ok(Sweep { owner, manipulator: inner, grid, modes, mode: mode.to_owned(), threads, count })
}

#[pymethods]
impl Sweep {
    /// Poses in reach and within all limits.
    #[getter]
    fn count(&self) -> u64 {
        self.count.reachable
    }

    /// Poses of the grid.
    #[getter]
    fn poses(&self) -> u64 {
        self.count.poses
    }

    /// `count / poses`.
    #[getter]
    fn fraction(&self) -> f64 {
        self.count.reachable as f64 / self.count.poses as f64
    }

    /// Lowest and highest value of every imaginary joint over the reachable poses, by name; `None`
    /// where there is no such pose.
    #[getter]
    fn imaginary_range<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (joint, range) in self.manipulator.imaginary().iter().zip(&self.count.imaginary) {
            dict.set_item(&joint.name, range.map(|[low, high]| (low, high)))?;
        }
        Ok(dict)
    }

    /// The values of every coordinate, by name, in the order of the mask's axes.
    #[getter]
    fn axes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for axis in self.grid.axes() {
            let values: Vec<f64> = (0..axis.count).map(|i| axis.value(i)).collect();
            dict.set_item(&axis.name, values.into_pyarray(py))?;
        }
        Ok(dict)
    }

    /// `m` or `rad` of every coordinate, by name.
    #[getter]
    fn units(&self) -> BTreeMap<&'static str, &'static str> {
        let coordinates = self.manipulator.task_coordinates().iter();
        coordinates.map(|c| (c.name, c.quantity.unit())).collect()
    }

    /// Which poses are reachable: an array of bools with an axis a task coordinate.
    fn mask<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let poses = usize::try_from(self.grid.poses()).map_err(|error| failed(&error))?;
        let mut mask = Vec::new();
        let short = |_| no_memory(format_args!("a mask of {poses} poses"));
        mask.try_reserve_exact(poses).map_err(short)?;
        mask.resize(poses, false);
        let row = self.grid.axes()[0].count;
        self.visit(
            py,
            |hits, made: &mut Vec<[usize; 2]>| {
                let first = hits.row * row;
                made.extend(
                    hits.runs.iter().map(|r| [first + r.from, first + r.to].map(|i| i as usize)),
                );
            },
            |made| made.into_iter().for_each(|[from, to]| mask[from..to].fill(true)),
        )?;
        // The first coordinate is the fastest: an array in Fortran's order, which numpy sees as such.
        let shape: Vec<usize> = self.grid.axes().iter().map(|axis| axis.count as usize).collect();
        let mask = mask.into_pyarray(py).reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)?;
        Ok(mask.into_any())
    }

    /// The reachable poses, `(count, d)`, in the order of the grid, the first coordinate fastest.
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.grid.axes().len();
        let count = usize::try_from(self.count.reachable).map_err(|error| failed(&error))?;
        let mut all = Vec::new();
        let short = |_| no_memory(format_args!("{count} points"));
        all.try_reserve_exact(count.saturating_mul(width)).map_err(short)?;
        self.visit(
            py,
            |hits, made: &mut Vec<f64>| {
                for &first in hits.first {
                    made.push(first);
                    made.extend(hits.others);
                }
            },
            |made| all.extend(made),
        )?;
        all.into_pyarray(py).reshape([count, width])
    }

    /// Records the points, as `opm workspace -o` does: the same bytes.
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None))]
    fn write_mcap(
        &self,
        py: Python<'_>,
        path: PathBuf,
        axes: Option<CloudAxes>,
        scalars: Option<Vec<String>>,
        color: Option<String>,
    ) -> PyResult<()> {
        let owner = self.owner.get();
        let name = owner.file_name();
        let swept = Swept {
            mechanism: Attached { name: &name, text: owner.text() },
            manipulator: &self.manipulator,
            grid: &self.grid,
            modes: self.modes,
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

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "sweep")
    }

    /// The working mode, `"any"` or `"home"`, as it was asked for.
    #[getter]
    fn mode(&self) -> &str {
        &self.mode
    }

    fn __repr__(&self) -> String {
        let axes: Vec<_> =
            self.grid.axes().iter().map(|a| format!("{} {}", a.name, a.count)).collect();
        format!(
            "<Sweep of {}: {} of {} poses reachable in mode {:?}, grid {}>",
            self.manipulator.mechanism().name,
            self.count.reachable,
            self.count.poses,
            self.mode,
            axes.join(" x ")
        )
    }
}

impl Sweep {
    /// Sweeps again, for the points: what `make` keeps of the hits goes to `take`, in their order.
    fn visit<T: Default + Send>(
        &self,
        py: Python<'_>,
        make: impl Fn(&Hits<'_>, &mut T) + Sync,
        mut take: impl FnMut(T) + Send,
    ) -> PyResult<()> {
        let progress = Progress::default();
        let sweep = opm_workspace::Sweep::new(&self.manipulator, &self.grid, self.modes);
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
