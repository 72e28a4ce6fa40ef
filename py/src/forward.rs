//! Forward kinematics: the poses at given joint values.

use crate::arguments;
use crate::error::wrong;
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use crate::rows::Rows;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_core::forward::{self as core, ForwardError, NearError, Stop};
use opm_core::manipulator::Mode;
use opm_study::Tracker;
use pyo3::prelude::*;
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

/// So many rows are computed before threads would have started.
const FEW: usize = 16;

/// One way in which a mechanism can be assembled for given actuated joints.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Assembly {
    /// (d,): task coordinates, metres and radians.
    pose: Py<PyArray1<f64>>,
    /// The working mode of the assembly.
    mode: String,
    /// (k,): every joint coordinate, metres and radians.
    joints: Py<PyArray1<f64>>,
    /// (j,): every imaginary joint, metres and radians.
    imaginary: Py<PyArray1<f64>>,
    /// Whether all joints are within their limits.
    within_limits: bool,
    /// Closure error of the legs: radians, and lengths divided by the mechanism's size.
    residual: f64,
}

pickled!(Assembly { pose, mode, joints, imaginary, within_limits, residual });

#[pymethods]
impl Assembly {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let pose = self.pose.bind(py).repr()?;
        Ok(format!("<Assembly in mode {:?} at {pose}>", self.mode))
    }
}

impl Assembly {
    fn new(py: Python<'_>, manipulator: &Manipulator, found: core::Assembly) -> PyResult<Self> {
        let array = |numbers: Vec<f64>| frozen(numbers.into_pyarray(py));
        Ok(Self {
            pose: array(found.pose)?,
            mode: manipulator.inner.format_mode(found.mode),
            joints: array(found.joints)?,
            imaginary: array(found.imaginary)?,
            within_limits: found.within_limits,
            residual: found.residual,
        })
    }
}

/// Where Newton's method begins, and in which working mode.
struct Near<'a> {
    starts: Rows<'a>,
    mode: Mode,
}

#[pymethods]
impl Manipulator {
    /// Every assembly for each row of actuated joint values; or, near a pose, the one that Newton's method finds.
    ///
    /// Parameters
    /// ----------
    /// joints : (n, a) array_like
    ///     Each row has the values of the actuated joints, in the order of `actuated`; metres and radians.
    /// near : (d,) or (n, d) array_like, optional
    ///     The pose from which Newton's method begins, metres and radians; one row is used for all. Newton's method works for
    ///     every mechanism, the closed form only for some.
    /// mode : str, optional
    ///     Only assemblies in this working mode, ``"home"`` or a sign for every two-valued choice. Newton's method
    ///     stays in this mode, or in the home mode if not given.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// list of list of Assembly
    ///     One list for each row, the assembly nearest to home first: empty where there is no assembly, or where Newton's
    ///     method does not converge.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism's forward kinematics have no closed form, and `near` is not given; or `near` is out of reach.
    #[pyo3(signature = (joints, *, near = None, mode = None, threads = None))]
    fn forward(
        &self,
        py: Python<'_>,
        joints: &Bound<'_, PyAny>,
        near: Option<&Bound<'_, PyAny>>,
        mode: Option<&str>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Vec<Vec<Assembly>>> {
        let coordinates = self.inner.coordinates();
        let names: Vec<_> =
            self.inner.actuated().iter().map(|&i| coordinates[i].name.as_str()).collect();
        let joints = arguments::rows(joints, "joints", &names)?;
        let joints = Rows::new(&joints)?;
        let mode = mode.map(|mode| self.mode(mode)).transpose()?;
        let starts = near.map(|near| arguments::one_or_rows(near, "near", &self.pose_names()));
        let starts = starts.transpose()?;
        let near = match &starts {
            Some(starts) => {
                let starts = Rows::new(starts)?;
                if starts.count != joints.count && starts.count != 1 {
                    let (given, rows) = (starts.count, joints.count);
                    return Err(wrong(format!("{given} rows of near, expected {rows}, or one")));
                }
                Some(Near { starts, mode: mode.unwrap_or_else(|| self.inner.home_mode()) })
            }
            None => {
                self.inner.forward_closed_form().map_err(|why| {
                    wrong(format!("{why}; near= says from where Newton's method begins"))
                })?;
                None
            }
        };
        let stop = AtomicBool::new(false);
        let solve = |row: usize| -> Result<Vec<core::Assembly>, String> {
            if stop.load(Ordering::Relaxed) {
                return Ok(Vec::new());
            }
            let found = self.assemblies(joints.row(row), row, near.as_ref());
            let mut found = found.map_err(|problem| format!("row {row}: {problem}"))?;
            found.retain(|assembly| mode.is_none_or(|mode| assembly.mode == mode));
            Ok(found)
        };
        let found: Vec<_> = if joints.count <= FEW {
            (0..joints.count).map(solve).collect()
        } else {
            let all = || (0..joints.count).into_par_iter().map(solve).collect();
            interrupt::run(py, threads, all, || stop.store(true, Ordering::Relaxed))?
        };
        let rows = found.into_iter().map(|found| {
            let list = found.map_err(wrong)?.into_iter();
            list.map(|assembly| Assembly::new(py, self, assembly)).collect()
        });
        rows.collect()
    }

    /// The pose for each row of actuated joint values, near the pose of the row before it, in one working mode.
    ///
    /// Newton's method starts at the last pose that was found. Where it ends without an assembly, the closed form finds
    /// the nearest one in this mode, for mechanisms that have one.
    ///
    /// Parameters
    /// ----------
    /// joints : (n, a) array_like
    ///     Each row has the values of the actuated joints, in the order of `actuated`; metres and radians.
    /// near : (d,) array_like, optional
    ///     The pose before the first row; home if not given.
    /// mode : str, optional
    ///     ``"home"``, or a sign for every two-valued choice.
    ///
    /// Returns
    /// -------
    /// (n, d) ndarray
    ///     Task coordinates, metres and radians; NaN in the rows for which no assembly was found.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A value is not a finite number.
    #[pyo3(signature = (joints, *, near = None, mode = "home"))]
    fn forward_track<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        near: Option<&Bound<'py, PyAny>>,
        mode: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let coordinates = self.inner.coordinates();
        let names: Vec<_> =
            self.inner.actuated().iter().map(|&i| coordinates[i].name.as_str()).collect();
        let joints = arguments::rows(joints, "joints", &names)?;
        let joints = Rows::new(&joints)?;
        let mode = self.mode(mode)?;
        let start = match near {
            None => self.inner.home_pose(),
            Some(near) => {
                let rows = arguments::one_or_rows(near, "near", &self.pose_names())?;
                let rows = Rows::new(&rows)?;
                if rows.count != 1 {
                    return Err(wrong(format!("{} rows of near, expected one pose", rows.count)));
                }
                rows.row(0).to_vec()
            }
        };
        let width = start.len();
        let stop = AtomicBool::new(false);
        let work = || -> Result<Vec<f64>, String> {
            let mut tracker = Tracker::new(&self.inner, &start, mode);
            let mut poses = Vec::with_capacity(joints.count * width);
            for row in 0..joints.count {
                if stop.load(Ordering::Relaxed) {
                    break;
                }
                let found = tracker.step(joints.row(row)).map_err(|error| match error {
                    NearError::Start(error) => format!("near: {error}"),
                    error => format!("row {row}: {error}"),
                })?;
                match found {
                    Some(assembly) => poses.extend_from_slice(&assembly.pose),
                    None => poses.extend(std::iter::repeat_n(f64::NAN, width)),
                }
            }
            Ok(poses)
        };
        let stopped = || stop.store(true, Ordering::Relaxed);
        let poses = interrupt::run(py, NonZeroUsize::new(1), work, stopped)?.map_err(wrong)?;
        poses.into_pyarray(py).reshape([joints.count, width])
    }
}

impl Manipulator {
    /// The assemblies with these joints, which are row `row` of the input. There is none if Newton's method
    /// does not converge.
    fn assemblies(
        &self,
        joints: &[f64],
        row: usize,
        near: Option<&Near<'_>>,
    ) -> Result<Vec<core::Assembly>, String> {
        let Some(Near { starts, mode }) = near else {
            let found = self.inner.forward(joints);
            let mut list = found.map_err(|error: ForwardError| error.to_string())?.list;
            let home = self.inner.platform_pose(&self.inner.home_pose());
            self.inner.sort_assemblies(&mut list, &home.map_err(|error| error.to_string())?);
            return Ok(list);
        };
        let start = starts.row(row.min(starts.count - 1));
        match self.inner.forward_near(joints, start, *mode) {
            Ok(assembly) => Ok(vec![assembly]),
            Err(NearError::NotFound(end)) => match end.why {
                Stop::OutOfReach(_) if end.steps == 0 => {
                    let mode = self.inner.format_mode(*mode);
                    Err(format!("near is out of reach in mode {mode:?}: {}", end.why))
                }
                _ => Ok(Vec::new()),
            },
            Err(error) => Err(error.to_string()),
        }
    }
}
