//! Forward kinematics: the poses at given joint values.

mod assemblies;

use crate::arguments;
use crate::error::{failed, wrong};
use crate::given::{Columns, together};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use crate::rows::Rows;
pub use assemblies::Assemblies;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_core::forward::{
    self as core, Certificate, Completeness, ForwardError, LeastChange, NearError, NearStop,
};
use opm_core::manipulator::Mode;
use opm_study::Tracker;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

/// The assemblies of a row.
#[derive(Default)]
pub struct Found {
    list: Vec<core::Assembly>,
    /// For each what is proven, if that was asked for.
    proofs: Vec<Certificate>,
    /// Whether there are no others.
    complete: bool,
}

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
    /// Within this is one exact assembly, and no other one: radians, plus lengths divided by the mechanism's size. None where
    /// that is not proven, or was not asked for.
    radius: Option<f64>,
}

pickled!(Assembly { pose, mode, joints, imaginary, within_limits, residual, radius });

#[pymethods]
impl Assembly {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let pose = self.pose.bind(py).repr()?;
        Ok(format!("<Assembly in mode {:?} at {pose}>", self.mode))
    }
}

#[pymethods]
impl Manipulator {
    /// Every assembly for actuated joint values; or the one near a pose that Newton's method finds.
    ///
    /// Most mechanisms have a closed form. Where the legs are equations without an order, as of a hexapod, all solutions are found by
    /// continuation, complex ones too: with probability one that is every isolated assembly, in some milliseconds. The first ones take
    /// some tenths of a second. `complete` tells where solutions are missing, because they are far away, or where assemblies meet, or
    /// where the platform can move with its actuated joints held. Of the joints that a leg can have at one of these poses with the same
    /// actuated ones, those within limits are given, and else those in home's mode.
    ///
    /// In a mechanism with screws, full revolutions can matter: each of them is another assembly, one advance of the screw
    /// away, and there are infinitely many. Of these, the one is given whose actuated joints have the full revolutions that
    /// `joints` has, and whose passive joints are within π of home.
    ///
    /// Parameters
    /// ----------
    /// joints : (..., a) array_like, or mapping
    ///     Values of the actuated joints, in the order of `actuated`, or by name; metres and radians. One row gives arrays
    ///     without the first axis. There is no assembly for a row with NaN.
    /// near : (..., d) array_like, or mapping, optional
    ///     The pose from which assemblies are sorted, the nearest first, and from which Newton's method begins; metres and
    ///     radians; one pose is used for all rows. Home if not given.
    /// mode : str, optional
    ///     Only assemblies in this working mode, ``"home"`` or a sign for every two-valued choice. Newton's method
    ///     stays in this mode, or in the home mode if not given.
    /// method : str, optional
    ///     ``"every"``: all assemblies. ``"newton"``: one, near `near`, for every mechanism. If not given, ``"newton"`` where `near`
    ///     is given and there is no closed form, otherwise ``"every"``.
    /// certify : bool, optional
    ///     Whether to prove that one exact assembly, which is none of the others, is near each: `radii` says within what. Where two
    ///     assemblies nearly meet, or a body can move with the joints held, there is no proof. It takes a tenth of a millisecond for
    ///     each assembly, or more.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Assemblies
    ///     Arrays, and a list of :class:`Assembly` for each row: empty where there is no assembly, or where Newton's method
    ///     does not converge.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     All assemblies cannot be found, and `near` is not given; or `near` is out of reach.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("planar-3rrr")
    /// >>> found = m.forward(m.inverse(m.home, joints="actuated").joints)
    /// >>> int(found.counts), found.poses.shape, bool(abs(found.poses[0] - m.home).max() < 1e-9)
    /// (2, (2, 3), True)
    /// >>> bool((m.forward(m.inverse(m.home, joints="actuated").joints, certify=True).radii < 1e-9).all())
    /// True
    #[pyo3(signature = (joints, *, near = None, mode = None, method = None, certify = false, threads = None))]
    #[allow(clippy::too_many_arguments)]
    fn forward(
        &self,
        py: Python<'_>,
        joints: &Bound<'_, PyAny>,
        near: Option<&Bound<'_, PyAny>>,
        mode: Option<&str>,
        method: Option<&str>,
        certify: bool,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Assemblies> {
        let mode = mode.map(|mode| self.mode(mode)).transpose()?;
        let mut joints = self.inputs(joints)?;
        let mut starts = near.map(|near| self.poses_of(near, "near")).transpose()?;
        together((&mut joints, "joints"), &mut [(starts.as_mut(), "near")])?;
        let joints = Rows::new(&joints)?;
        let starts = starts.as_ref().map(Rows::new).transpose()?;
        let newton = match method {
            Some("newton") => true,
            None if starts.is_some() && self.inner.forward_closed_form().is_err() => true,
            Some("every") | None => {
                py.detach(|| self.inner.forward_method()).map_err(|why| {
                    wrong(format!("{why}; near= says from where Newton's method begins"))
                })?;
                false
            }
            Some(other) => {
                let expected = "expected \"every\" or \"newton\"";
                return Err(wrong(format!("method is {other:?}, {expected}")));
            }
        };
        let home = self.inner.home_pose();
        let start = |row: usize| {
            starts.as_ref().map_or(&*home, |starts| starts.row(row.min(starts.count - 1)))
        };
        let stop = AtomicBool::new(false);
        let solve = |row: usize| -> Result<Found, String> {
            if stop.load(Ordering::Relaxed) || joints.missing(row) {
                return Ok(Found::default());
            }
            let (values, start) = (joints.row(row), start(row));
            let found = if newton {
                self.nearest_assembly(values, start, mode)
            } else {
                self.every_assembly(values, start, mode)
            };
            let mut found = found.map_err(|problem| format!("row {row}: {problem}"))?;
            if certify {
                found.proofs = self.inner.certify(&found.list);
            }
            Ok(found)
        };
        let found: Vec<_> = if joints.count <= FEW {
            (0..joints.count).map(solve).collect()
        } else {
            let all = || (0..joints.count).into_par_iter().map(solve).collect();
            interrupt::run(py, threads, all, || stop.store(true, Ordering::Relaxed))?
        };
        let found = found.into_iter().collect::<Result<Vec<_>, _>>().map_err(wrong)?;
        Assemblies::new(py, self, &joints, &found)
    }

    /// The least change of the actuated joints with which the mechanism can be assembled, where it cannot with given values.
    ///
    /// The joints then have no pose, and :meth:`forward` finds no assembly. They reach the nearest values that have one where
    /// the platform is at a parallel singularity.
    ///
    /// Parameters
    /// ----------
    /// joints : (a,) array_like, or mapping
    ///     Values of the actuated joints, in the order of `actuated`, or by name; metres and radians.
    ///
    /// Returns
    /// -------
    /// dict, or None
    ///     ``"together"``, (a,): the changes of all joints whose sum of squares is least, with a length over the mechanism's size.
    ///     ``"alone"``, (a,): the least change of each joint, with the others as they are given; NaN where none was found. None
    ///     where there is an assembly, or where no answer was found that holds.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The mechanism's forward kinematics have no closed form, or a value is not a number.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("planar-3rpr")
    /// >>> change = m.least_change([0.01, 0.01, 0.5])
    /// >>> bool(change["alone"][2] < change["together"][2] < 0), m.least_change([0.01, 0.01, 0.01]) is None
    /// (True, True)
    fn least_change<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let joints = arguments::row(joints, "joints", Columns::all(&self.input_names()))?;
        let found = py.detach(|| self.inner.least_change(&joints));
        let Some(LeastChange { together, alone }) = found.map_err(|error| failed(&error))? else {
            return Ok(None);
        };
        let dict = PyDict::new(py);
        dict.set_item("together", together.into_pyarray(py))?;
        let alone: Vec<f64> = alone.into_iter().map(|change| change.unwrap_or(f64::NAN)).collect();
        dict.set_item("alone", alone.into_pyarray(py))?;
        Ok(Some(dict))
    }

    /// The pose for each row of actuated joint values, near the pose of the row before it, in one working mode.
    ///
    /// Newton's method starts at the last pose that was found. Where it ends without an assembly, the nearest of all
    /// assemblies in this mode is taken, if these can be found.
    ///
    /// Parameters
    /// ----------
    /// joints : (..., a) array_like, or mapping
    ///     Each row has the values of the actuated joints, in the order of `actuated`, or by name; metres and radians. A row
    ///     with NaN is passed over.
    /// near : (d,) array_like, or mapping, optional
    ///     The pose before the first row; home if not given.
    /// mode : str, optional
    ///     ``"home"``, or a sign for every two-valued choice.
    ///
    /// Returns
    /// -------
    /// (..., d) ndarray
    ///     Task coordinates, metres and radians; NaN in the rows for which no assembly was found.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     A value is infinite.
    #[pyo3(signature = (joints, *, near = None, mode = "home"))]
    fn forward_track<'py>(
        &self,
        py: Python<'py>,
        joints: &Bound<'py, PyAny>,
        near: Option<&Bound<'py, PyAny>>,
        mode: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let joints = self.inputs(joints)?.in_order("joints", &self.input_names())?;
        let joints = Rows::new(&joints)?;
        let mode = self.mode(mode)?;
        let start = match near {
            None => self.inner.home_pose(),
            Some(near) => self.pose(near, "near")?,
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
                let step = match joints.missing(row) {
                    true => Ok(None),
                    false => tracker.step(joints.row(row)),
                };
                let found = step.map_err(|error| match error {
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
    /// Every assembly with these values of the actuated joints, in one mode if that is given, those nearest to a pose first.
    fn every_assembly(
        &self,
        joints: &[f64],
        near: &[f64],
        mode: Option<Mode>,
    ) -> Result<Found, String> {
        let found = self.inner.forward(joints);
        let core::Assemblies { mut list, completeness, loose, .. } =
            found.map_err(|error: ForwardError| error.to_string())?;
        let complete = match completeness {
            Completeness::ClosedForm => loose.is_empty(),
            Completeness::Continuation { found, of } => found == of,
        };
        if let Some(mode) = mode {
            self.inner.keep_assemblies_in(&mut list, mode);
        }
        let near = self.inner.displacement_in(near, mode.unwrap_or(self.inner.home_mode()));
        let near = self.inner.platform_at(&near.map_err(|error| format!("near: {error}"))?);
        self.inner.sort_assemblies(&mut list, &near);
        Ok(Found { list, complete, ..Default::default() })
    }

    /// The assembly that Newton's method finds from a pose; none if it does not converge.
    fn nearest_assembly(
        &self,
        joints: &[f64],
        near: &[f64],
        mode: Option<Mode>,
    ) -> Result<Found, String> {
        let mode = mode.unwrap_or_else(|| self.inner.home_mode());
        match self.inner.forward_near(joints, near, mode) {
            Ok(assembly) => Ok(Found { list: vec![assembly], ..Default::default() }),
            Err(NearError::NotFound(end)) => match end.why {
                NearStop::OutOfReach(_) if end.steps == 0 => {
                    let mode = self.inner.format_mode(mode);
                    Err(format!("near is out of reach in mode {mode:?}: {}", end.why))
                }
                _ => Ok(Found::default()),
            },
            Err(error) => Err(error.to_string()),
        }
    }
}
