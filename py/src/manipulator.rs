//! Manipulators: from files, their decomposition, and inverse kinematics of arrays of poses.

use crate::error::{failed, wrong};
use crate::interrupt;
use crate::solutions::Solutions;
use numpy::{AllowTypeChange, PyArrayLike2};
use opm_core::joint::Quantity;
use opm_core::manipulator::{self as core, Mode, PoseError};
use opm_core::mechanism::{examples as shipped, file};
use opm_core::subspace::SubspaceClass;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Poses that a thread solves between two looks at whether it is to stop.
const BLOCK: usize = 1024;

/// A mechanism, decomposed and compiled for closed-form inverse kinematics. Immutable.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Manipulator {
    pub inner: Arc<core::Manipulator>,
    /// The text that it was read from, and what its file is called: what pickling keeps.
    text: String,
    label: String,
}

/// One coordinate of the pose.
#[pyclass(frozen, get_all, eq, module = "opm_kinematics")]
#[derive(Clone, PartialEq)]
pub struct TaskCoordinate {
    name: String,
    home: f64,
    unit: String,
}

#[pymethods]
impl TaskCoordinate {
    fn __repr__(&self) -> String {
        format!("TaskCoordinate({:?}, home={:?}, unit={:?})", self.name, self.home, self.unit)
    }
}

/// Names of the mechanisms that come with the package.
#[pyfunction]
pub fn examples() -> Vec<&'static str> {
    shipped::EXAMPLES.iter().map(|example| example.name).collect()
}

/// The text of one of them.
#[pyfunction]
pub fn example(name: &str) -> PyResult<&'static str> {
    let known = || examples().join(", ");
    let found = shipped::find(name).map(|example| example.text);
    found.ok_or_else(|| wrong(format!("{name}: no such example; there are {}", known())))
}

#[pymethods]
impl Manipulator {
    /// Reads a mechanism file.
    #[staticmethod]
    fn load(path: PathBuf) -> PyResult<Self> {
        let text = std::fs::read_to_string(&path)?;
        Self::parse(text, Some(path.display().to_string()))
    }

    /// Reads the text of a mechanism file; messages call it `label`.
    #[staticmethod]
    #[pyo3(signature = (text, label = None))]
    fn parse(text: String, label: Option<String>) -> PyResult<Self> {
        let label = label.unwrap_or_else(|| "mechanism".to_owned());
        let read = file::read(&text).map_err(|errors| wrong(errors.in_file(&label)))?;
        let inner = core::Manipulator::new(read.mechanism).map_err(|e| failed(&e))?;
        Ok(Self { inner: Arc::new(inner), text, label })
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String, String))> {
        let this = slf.get();
        Ok((slf.get_type().getattr("parse")?, (this.text.clone(), this.label.clone())))
    }

    /// The mechanism's name.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.mechanism().name
    }

    /// The mechanism file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The coordinates of the pose, in order.
    #[getter]
    fn task_coordinates(&self) -> Vec<TaskCoordinate> {
        let coordinates = self.inner.task_coordinates().iter();
        let unit = |quantity: Quantity| quantity.unit().to_owned();
        coordinates
            .map(|c| TaskCoordinate { name: c.name.into(), home: c.home, unit: unit(c.quantity) })
            .collect()
    }

    /// Names of all joint coordinates, in the order of the columns of joint values.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.inner.coordinates().iter().map(|c| c.name.clone()).collect()
    }

    /// Columns of the actuated joints.
    #[getter]
    fn actuated(&self) -> Vec<usize> {
        self.inner.actuated().to_vec()
    }

    /// Names of the imaginary joints.
    #[getter]
    fn imaginary(&self) -> Vec<String> {
        self.inner.imaginary().iter().map(|joint| joint.name.clone()).collect()
    }

    /// The pose at home.
    #[getter]
    fn home(&self) -> Vec<f64> {
        self.inner.task().home()
    }

    /// The working mode that the mechanism is assembled in.
    #[getter]
    fn home_mode(&self) -> String {
        self.inner.format_mode(self.inner.home_mode())
    }

    /// Number of two-valued choices; there are `2**choices` working modes.
    #[getter]
    fn choices(&self) -> u32 {
        self.inner.choices()
    }

    /// How the mechanism was decomposed, as `opm decompose --format json` has it.
    #[getter]
    fn decomposition<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let (decomposition, mechanism) = (self.inner.decomposition(), self.inner.mechanism());
        let subspace = |class: &SubspaceClass| {
            let dict = PyDict::new(py);
            dict.set_item("subspace", class.name()).map(|()| dict)
        };
        let legs = PyList::empty(py);
        for (leg, split) in mechanism.legs.iter().zip(&decomposition.legs) {
            let names = |freedoms: &[opm_core::decomposition::Freedom]| {
                let mut names: Vec<_> =
                    freedoms.iter().map(|f| leg.joints[f.joint].name.clone()).collect();
                names.dedup();
                names
            };
            let dict = PyDict::new(py);
            dict.set_item("name", &leg.name)?;
            dict.set_item("lower", names(&split.lower))?;
            dict.set_item("upper", names(&split.upper))?;
            dict.set_item("imaginary", split.imaginary.then(|| leg.imaginary_name()))?;
            legs.append(dict)?;
        }
        let dict = PyDict::new(py);
        dict.set_item("lambda", decomposition.lambda)?;
        dict.set_item("mobility", decomposition.mobility)?;
        dict.set_item("imaginary_joints", decomposition.imaginary_joints)?;
        dict.set_item("first_section_motions", decomposition.first_section_motions)?;
        dict.set_item("lower", subspace(&decomposition.lower)?)?;
        dict.set_item("upper", subspace(&decomposition.upper)?)?;
        dict.set_item("legs", legs)?;
        Ok(dict)
    }

    /// Inverse kinematics of many poses in one working mode.
    #[pyo3(signature = (poses, *, mode = "home", threads = None))]
    fn inverse<'py>(
        &self,
        py: Python<'py>,
        poses: PyArrayLike2<'py, f64, AllowTypeChange>,
        mode: &str,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Solutions> {
        let mode = self.mode(mode)?;
        let poses = poses.as_array();
        let width = self.inner.task_coordinates().len();
        if poses.ncols() != width {
            let names: Vec<_> = self.inner.task_coordinates().iter().map(|c| c.name).collect();
            let (given, names) = (poses.ncols(), names.join(", "));
            return Err(wrong(format!("{given} columns of poses, expected {width}: {names}")));
        }
        // Not contiguous in memory, it is copied.
        let poses = poses.as_standard_layout();
        let flat = poses.as_slice().unwrap_or_default();
        let mut out = Numbers::new(&self.inner, poses.nrows());
        if poses.nrows() <= BLOCK {
            let solved = out.blocks().try_for_each(|block| block.solve(&self.inner, flat, mode));
            solved.map_err(|error| failed(&error))?;
        } else {
            let stop = AtomicBool::new(false);
            let (out, manipulator) = (&mut out, &*self.inner);
            let work = || {
                let blocks: Vec<_> = out.blocks().collect();
                blocks.into_par_iter().try_for_each(|block| match stop.load(Ordering::Relaxed) {
                    true => Ok(()),
                    false => block.solve(manipulator, flat, mode),
                })
            };
            let solved = interrupt::run(py, threads, work, || stop.store(true, Ordering::Relaxed))?;
            solved.map_err(|error| failed(&error))?;
        }
        out.into_solutions(py, &self.inner, mode)
    }

    fn __repr__(&self) -> String {
        let coordinates: Vec<_> = self.inner.task_coordinates().iter().map(|c| c.name).collect();
        let decomposition = self.inner.decomposition();
        format!(
            "<Manipulator {}: {} + {}, {} degrees of freedom: {}>",
            self.inner.mechanism().name,
            decomposition.lower.name(),
            decomposition.upper.name(),
            decomposition.mobility,
            coordinates.join(" ")
        )
    }
}

impl Manipulator {
    /// The working mode that `mode` names.
    pub fn mode(&self, mode: &str) -> PyResult<Mode> {
        match mode {
            "home" => Ok(self.inner.home_mode()),
            signs => self.inner.parse_mode(signs).map_err(|error| failed(&error)),
        }
    }
}

/// Joint values of many poses, row by row; NaN where a pose is out of reach.
struct Numbers {
    joints: Vec<f64>,
    imaginary: Vec<f64>,
    reachable: Vec<bool>,
    within_limits: Vec<bool>,
    widths: [usize; 2],
}

/// Some rows of them.
struct Block<'a> {
    first: usize,
    joints: &'a mut [f64],
    imaginary: &'a mut [f64],
    reachable: &'a mut [bool],
    within_limits: &'a mut [bool],
}

impl Numbers {
    fn new(manipulator: &core::Manipulator, poses: usize) -> Self {
        let widths = [manipulator.coordinates().len(), manipulator.imaginary().len()];
        Self {
            joints: vec![f64::NAN; poses * widths[0]],
            imaginary: vec![f64::NAN; poses * widths[1]],
            reachable: vec![false; poses],
            within_limits: vec![false; poses],
            widths,
        }
    }

    fn blocks(&mut self) -> impl Iterator<Item = Block<'_>> {
        let [joints, imaginary] = self.widths;
        // A width of zero has no rows to give out.
        let mut imaginary_rows = self.imaginary.chunks_mut(BLOCK * imaginary.max(1));
        self.joints
            .chunks_mut(BLOCK * joints)
            .zip(self.reachable.chunks_mut(BLOCK))
            .zip(self.within_limits.chunks_mut(BLOCK))
            .enumerate()
            .map(move |(number, ((joints, reachable), within_limits))| Block {
                first: number * BLOCK,
                joints,
                imaginary: imaginary_rows.next().unwrap_or_default(),
                reachable,
                within_limits,
            })
    }

    fn into_solutions(
        self,
        py: Python<'_>,
        manipulator: &core::Manipulator,
        mode: Mode,
    ) -> PyResult<Solutions> {
        let Self { joints, imaginary, reachable, within_limits, widths } = self;
        let rows = reachable.len();
        let joints = Solutions::table(py, joints, [rows, widths[0]])?;
        let imaginary = Solutions::table(py, imaginary, [rows, widths[1]])?;
        Solutions::new(py, manipulator, mode, (joints, imaginary), (reachable, within_limits))
    }
}

impl Block<'_> {
    fn solve(
        self,
        manipulator: &core::Manipulator,
        poses: &[f64],
        mode: Mode,
    ) -> Result<(), PoseError> {
        let width = manipulator.task_coordinates().len();
        let mut solution = manipulator.solution();
        let (joints, imaginary) = (solution.joints.len(), solution.imaginary.len());
        for row in 0..self.reachable.len() {
            let pose = &poses[(self.first + row) * width..][..width];
            if manipulator.inverse(pose, mode, &mut solution)? {
                self.joints[row * joints..][..joints].copy_from_slice(&solution.joints);
                self.imaginary[row * imaginary..][..imaginary].copy_from_slice(&solution.imaginary);
                self.reachable[row] = true;
                self.within_limits[row] = solution.within_limits;
            }
        }
        Ok(())
    }
}
