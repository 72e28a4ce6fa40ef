//! Sweeps of a grid of poses.

use crate::error::{failed, wrong};
use crate::html;
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::measure::{Asked, Measure, goal};
use crate::parts::Parts;
use crate::rows::no_memory;
use numpy::npyffi::NPY_ORDER;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_cli::recording::{Attached, Shown, Swept, record_sweep};
use opm_core::manipulator as core;
use opm_workspace::measure::Over;
use opm_workspace::{Axis, Cancelled, Count, Grid, Hits, Modes, Progress, Run, Sections, Shard};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::num::{NonZeroU64, NonZeroUsize};
use std::path::PathBuf;
use std::sync::Arc;

/// Poses of a part at least: fewer are not worth the way to another process.
const LEAST_PART: u64 = 1 << 15;

/// What a sweep is of.
const SECTIONS: [(Sections, &str); 3] =
    [(Sections::Whole, "whole"), (Sections::Upper, "upper"), (Sections::Lower, "lower")];

/// A grid of poses, swept.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Sweep {
    of: Py<Manipulator>,
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

/// Poses, reachable ones, and ranges of the imaginary joints: a [`Count`] as it crosses processes.
type Counted = (u64, u64, Vec<Option<[f64; 2]>>);

/// Sweeps a grid: `sweep(m, x=(min, max, count), y=value)`. A coordinate that is not given stays at
/// home.
#[pyfunction]
#[pyo3(signature = (
    manipulator, /, *, mode = "home", section = "whole", threads = None, executor = None, shards = None, **axes
))]
#[allow(clippy::too_many_arguments)]
pub fn sweep(
    py: Python<'_>,
    manipulator: Py<Manipulator>,
    mode: &str,
    section: &str,
    threads: Option<NonZeroUsize>,
    executor: Option<Bound<'_, PyAny>>,
    shards: Option<NonZeroU64>,
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
    let axes = axes.collect::<PyResult<_>>()?;
    let sweep = Sweep::planned(manipulator, axes, [mode, section], threads)?;
    let parts = Parts::new(executor, shards)?;
    let count = match &parts {
        None => sweep.counted(py, Shard::WHOLE)?,
        Some(parts) => {
            let plan = Py::new(py, sweep.clone(py))?;
            let counted: Vec<Counted> = spread(plan.bind(py), parts, "_count")?.extract()?;
            let nothing = Count::nothing(&sweep.manipulator);
            counted.into_iter().fold(nothing, |all, part| all.merge(&count_of(part)))
        }
    };
    Ok(Sweep { count, ..sweep })
}

/// What `task` of a sweep gives for each of its parts, in their order.
fn spread<'py>(
    plan: &Bound<'py, Sweep>,
    parts: &Parts<'py>,
    task: &str,
) -> PyResult<Bound<'py, PyAny>> {
    let count = parts.count(plan.get().grid.poses(), LEAST_PART);
    let numbers: Vec<(u64, u64)> = (1..=count).map(|number| (number, count)).collect();
    parts.session(plan.py(), |workers| workers.call_method1("run", (plan, task, numbers)))
}

fn count_of((poses, reachable, imaginary): Counted) -> Count {
    Count { poses, reachable, imaginary }
}

#[pymethods]
impl Sweep {
    /// What was swept: `"whole"`, `"upper"` or `"lower"`.
    #[getter]
    fn section(&self) -> &'static str {
        word(self.grid.sections())
    }

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
    fn units(&self) -> BTreeMap<&str, &'static str> {
        self.grid.coordinates().iter().map(|c| (&*c.name, c.quantity.unit())).collect()
    }

    /// Which poses are reachable: an array of bools with an axis a task coordinate.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn mask<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        let mask = match Parts::new(executor, shards)? {
            None => this.masked(py, Shard::WHOLE)?,
            Some(parts) => {
                let parts = spread(slf, &parts, "_mask")?;
                py.import("numpy")?.call_method1("concatenate", (parts,))?.cast_into()?
            }
        };
        // The first coordinate is the fastest: an array in Fortran's order, which numpy sees as such.
        let shape: Vec<usize> = this.grid.axes().iter().map(|axis| axis.count as usize).collect();
        Ok(mask.reshape_with_order(shape, NPY_ORDER::NPY_FORTRANORDER)?.into_any())
    }

    /// The reachable poses, `(count, d)`, in the order of the grid, the first coordinate fastest.
    #[pyo3(signature = (*, executor = None, shards = None))]
    fn points<'py>(
        slf: &Bound<'py, Self>,
        executor: Option<Bound<'py, PyAny>>,
        shards: Option<NonZeroU64>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (py, this) = (slf.py(), slf.get());
        match Parts::new(executor, shards)? {
            None => this.pointed(py, Shard::WHOLE, this.count.reachable).map(Bound::into_any),
            Some(parts) => {
                let parts = spread(slf, &parts, "_points")?;
                py.import("numpy")?.call_method1("concatenate", (parts,))
            }
        }
    }

    /// How much of the box that the grid covers is in reach, between guaranteed bounds.
    #[pyo3(signature = (*, tolerance = None, budget = None, executor = None, shards = None))]
    fn measure(
        &self,
        py: Python<'_>,
        tolerance: Option<f64>,
        budget: Option<u64>,
        executor: Option<Bound<'_, PyAny>>,
        shards: Option<NonZeroU64>,
    ) -> PyResult<Measure> {
        let axes = self.grid.axes().iter();
        let over: Vec<_> = axes.map(|a| Over::new(a.name.as_str(), a.min, a.max)).collect();
        let (of, sections) = (self.of.clone_ref(py), self.grid.sections());
        let asked = Asked { of, sections, modes: self.modes, threads: self.threads };
        asked.measured(py, &over, goal(tolerance, budget)?, Parts::new(executor, shards)?)
    }

    /// Pickling: with the manipulator, not with what the grid holds.
    #[allow(clippy::type_complexity)]
    fn __reduce__<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<(
        Bound<'py, PyAny>,
        (Py<Manipulator>, Vec<(String, f64, f64, u64)>, [String; 2], Option<NonZeroUsize>, Counted),
    )> {
        let this = slf.get();
        let axes = this.grid.axes().iter().map(|a| (a.name.clone(), a.min, a.max, a.count));
        let Count { poses, reachable, imaginary } = this.count.clone();
        let count = (poses, reachable, imaginary);
        let of = this.of.clone_ref(slf.py());
        let words = [this.mode.clone(), this.section().to_owned()];
        let spec = (of, axes.collect(), words, this.threads, count);
        Ok((slf.get_type().getattr("_restored")?, spec))
    }

    #[staticmethod]
    fn _restored(
        manipulator: Py<Manipulator>,
        axes: Vec<(String, f64, f64, u64)>,
        words: [String; 2],
        threads: Option<NonZeroUsize>,
        count: Counted,
    ) -> PyResult<Self> {
        let axes = axes.into_iter().map(|(name, min, max, count)| Axis::new(name, min, max, count));
        let words = words.each_ref().map(String::as_str);
        let planned = Self::planned(manipulator, axes.collect(), words, threads)?;
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

    /// Records the points, as `opm workspace -o` does: the same bytes.
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None))]
    fn write(
        &self,
        py: Python<'_>,
        path: PathBuf,
        axes: Option<CloudAxes>,
        scalars: Option<Vec<String>>,
        color: Option<String>,
    ) -> PyResult<()> {
        let of = self.of.get();
        let name = of.file_name();
        let swept = Swept {
            mechanism: Attached { name: &name, text: of.text() },
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

    /// [`Self::write`], of MCAP alone.
    #[pyo3(signature = (path, *, axes = None, scalars = None, color = None))]
    fn write_mcap(
        &self,
        py: Python<'_>,
        path: PathBuf,
        axes: Option<CloudAxes>,
        scalars: Option<Vec<String>>,
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

/// The section of this name, or both.
pub fn sections(word: &str) -> PyResult<Sections> {
    let known = SECTIONS.iter().find(|(_, known)| *known == word);
    let words = || SECTIONS.map(|(_, word)| word).join(", ");
    let told = || wrong(format!("section is {word:?}, expected one of {}", words()));
    known.map(|(sections, _)| *sections).ok_or_else(told)
}

/// What sections are called.
pub fn word(sections: Sections) -> &'static str {
    let word = SECTIONS.iter().find(|(known, _)| *known == sections);
    word.map_or("", |(_, word)| word)
}

/// The working modes that count: one, or any.
pub fn modes(manipulator: &Manipulator, mode: &str) -> PyResult<Modes> {
    match mode {
        "any" => Ok(Modes::Any),
        mode => manipulator.mode(mode).map(Modes::One),
    }
}

fn shard(number: u64, of: u64) -> PyResult<Shard> {
    Shard::new(number, of).map_err(|error| failed(&error))
}

impl Sweep {
    /// A sweep that is still to be done, in a mode and of a section.
    fn planned(
        of: Py<Manipulator>,
        axes: Vec<Axis>,
        [mode, section]: [&str; 2],
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Self> {
        let manipulator = Arc::clone(&of.get().inner);
        let grid = Grid::of(sections(section)?, &manipulator, axes).map_err(|e| failed(&e))?;
        let modes = modes(of.get(), mode)?;
        let count = Count::nothing(&manipulator);
        Ok(Self { of, manipulator, grid, modes, mode: mode.to_owned(), threads, count })
    }

    fn clone(&self, py: Python<'_>) -> Self {
        Self {
            of: self.of.clone_ref(py),
            manipulator: Arc::clone(&self.manipulator),
            grid: self.grid.clone(),
            mode: self.mode.clone(),
            count: self.count.clone(),
            ..*self
        }
    }

    fn swept(&self, shard: Shard) -> opm_workspace::Sweep<'_> {
        opm_workspace::Sweep::new(&self.manipulator, &self.grid, self.modes).shard(shard)
    }

    fn counted(&self, py: Python<'_>, shard: Shard) -> PyResult<Count> {
        let progress = Progress::default();
        let sweep = self.swept(shard);
        let count =
            interrupt::run(py, self.threads, || sweep.count(&progress), || progress.cancel())?;
        count.map_err(|error| failed(&error))
    }

    fn masked<'py>(&self, py: Python<'py>, shard: Shard) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let sweep = self.swept(shard);
        let poses = usize::try_from(sweep.poses()).map_err(|error| failed(&error))?;
        let before = (1..shard.number()).map(|number| Shard::new(number, shard.count()));
        let before = before.map(|shard| shard.map_or(0, |shard| self.swept(shard).poses()));
        let before: u64 = before.sum();
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
    fn visit<T: Default + Send>(
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
