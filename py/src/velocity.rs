//! Jacobians, rates and accelerations, and measures of singularity, for arrays of poses.

use crate::arguments;
use crate::columns::tabled;
use crate::error::request;
use crate::given::{Columns, together};
use crate::html;
use crate::manipulator::Manipulator;
use crate::one::{lend, plain};
use crate::pickle::pickled;
use crate::rows::{Rows, Tables};
use numpy::{IntoPyArray, PyArray2, PyArrayDyn, PyArrayMethods};
use opm_core::manipulator::{self as core, Mode, Solution};
use opm_core::velocity::Jacobians;
use pyo3::prelude::*;
use std::num::NonZeroUsize;

/// Rates and accelerations of every joint at many poses; NaN where a joint has none.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Motion {
    /// (..., k), rad/s and m/s.
    joint_rates: Py<PyArrayDyn<f64>>,
    /// (..., k), rad/s² and m/s².
    joint_accelerations: Py<PyArrayDyn<f64>>,
    /// (..., j), rad/s and m/s.
    imaginary_rates: Py<PyArrayDyn<f64>>,
    /// (..., j), rad/s² and m/s².
    imaginary_accelerations: Py<PyArrayDyn<f64>>,
    /// (...): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArrayDyn<bool>>,
    /// (...): whether the pose is in reach and every joint has a rate.
    regular: Py<PyArrayDyn<bool>>,
    /// Names along the last axis of what is of joints.
    joint_names: Vec<String>,
    /// Names along the last axis of what is of imaginary joints.
    imaginary_names: Vec<String>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

/// How near many poses are to a singularity: signed measures without unit, (...) each, that vanish at a singularity.
///
/// They are NaN where a pose is out of reach. Parallel measures are NaN, too, where the inputs are too few to hold the section.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Singularity {
    /// (...), no unit: a measure of the upper section that is zero where the chain of a leg is singular.
    upper_serial: Py<PyArrayDyn<f64>>,
    /// (...), no unit: a measure of the upper section that is zero where its inputs do not hold it.
    upper_parallel: Py<PyArrayDyn<f64>>,
    /// (...), no unit: a measure of the lower section that is zero where the chain of a leg is singular.
    lower_serial: Py<PyArrayDyn<f64>>,
    /// (...), no unit: a measure of the lower section that is zero where its inputs do not hold it.
    lower_parallel: Py<PyArrayDyn<f64>>,
    /// (...), no unit: the measure of this kind for the whole mechanism.
    serial: Py<PyArrayDyn<f64>>,
    /// (...), no unit: the measure of this kind for the whole mechanism.
    parallel: Py<PyArrayDyn<f64>>,
    /// (...), no unit: condition number of the actuated joints' Jacobian with respect to the platform's twist;
    /// infinite at a singularity.
    condition: Py<PyArrayDyn<f64>>,
    /// (...), no unit: volume of the twists that unit rates of the actuated joints span, with lengths divided by the
    /// characteristic length.
    manipulability: Py<PyArrayDyn<f64>>,
    /// (...), no unit: zero where the coordinates of the pose are singular; this is not a singularity of the mechanism.
    coordinates: Py<PyArrayDyn<f64>>,
    /// (...): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArrayDyn<bool>>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(Motion);
tabled!(Singularity);

pickled!(Motion {
    joint_rates,
    joint_accelerations,
    imaginary_rates,
    imaginary_accelerations,
    reachable,
    regular,
    joint_names,
    imaginary_names,
    index,
});
pickled!(Singularity {
    upper_serial,
    upper_parallel,
    lower_serial,
    lower_parallel,
    serial,
    parallel,
    condition,
    manipulability,
    coordinates,
    reachable,
    index,
});

#[pymethods]
impl Motion {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (poses, [reachable, regular]) = counted(py, [&self.reachable, &self.regular])?;
        Ok(format!("<Motion at {poses} poses: {reachable} reachable, {regular} regular>"))
    }
}

#[pymethods]
impl Singularity {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (poses, [reachable]) = counted(py, [&self.reachable])?;
        Ok(format!("<Singularity of {poses} poses: {reachable} reachable>"))
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "singularity")
    }
}

/// The number of poses, and the number of poses for which each flag is true.
fn counted<const N: usize>(
    py: Python<'_>,
    answers: [&Py<PyArrayDyn<bool>>; N],
) -> PyResult<(usize, [usize; N])> {
    let mut counts = [0; N];
    for (count, answers) in counts.iter_mut().zip(answers) {
        *count = answers.bind(py).call_method0("sum")?.extract()?;
    }
    Ok((answers[0].bind(py).getattr("size")?.extract()?, counts))
}

#[pymethods]
impl Manipulator {
    /// The matrix J that maps rates of the task coordinates to rates of joints: joint rates = J · pose rates.
    ///
    /// It is the inverse of the Jacobian of serial robots, which maps joint rates to those of the tool. :meth:`twist_jacobian` maps
    /// rates of the task coordinates to the platform's twist.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// joints : str
    ///     Which joints the ``a`` rows are: ``"actuated"``, or ``"all"`` for every joint coordinate.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    /// out : (..., a, d) ndarray, optional
    ///     Where to write the result, which is returned: float64 in C order. A loop over single poses is faster with it.
    ///
    /// Returns
    /// -------
    /// (..., a, d) ndarray
    ///     Ratios of metres and radians. NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> out = np.empty((3, 3))
    /// >>> m.jacobian(np.array(m.home), out=out) is out
    /// True
    #[pyo3(signature = (poses, *, mode = "home", joints = "actuated", threads = None, out = None))]
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        mode: &str,
        joints: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let mode = self.mode(mode)?;
        let rows = self.columns(joints)?;
        let columns = self.inner.task_coordinates().len();
        if let Some(pose) = plain(poses, columns) {
            let shape = [rows.len(), columns];
            let made = match out {
                Some(out) => out.clone(),
                None => PyArray2::<f64>::zeros(py, shape, false).into_any(),
            };
            lend(&made, &shape, |out| self.jacobian_one(&pose, (mode, &rows), out))?;
            return Ok(made);
        }
        let poses = self.poses(poses)?;
        let poses = Rows::new(&poses)?;
        let tables = Tables::fill(
            py,
            poses.count,
            [rows.len() * columns],
            threads,
            || (self.inner.solution(), self.inner.jacobians()),
            |(at, jacobians), row, [out]| {
                if !self.solve(&poses, row, mode, at)? {
                    return Ok([false; 2]);
                }
                Ok([true, self.joint_rows(at, jacobians, &rows, out)?])
            },
        )?;
        let found = poses.shaped::<f64>(&tables.table(0), &[rows.len(), columns])?.into_any();
        let Some(out) = out else { return Ok(found) };
        let shape = [poses.lead, &[rows.len(), columns]].concat();
        lend(out, &shape, |out| {
            let found = found.cast::<PyArrayDyn<f64>>()?.readonly();
            out.copy_from_slice(found.as_slice()?);
            Ok(())
        })?;
        Ok(out.clone())
    }

    /// The platform's twist for unit rates of the task coordinates.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// (..., 6, d) ndarray
    ///     The rows are the angular velocity, then the velocity of the platform's reference point, both along the axes of the
    ///     base, rad/s and m/s. NaN where the pose is out of reach.
    #[pyo3(signature = (poses, *, mode = "home", threads = None))]
    fn twist_jacobian<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let columns = self.inner.task_coordinates().len();
        let tables = Tables::fill(
            py,
            poses.count,
            [6 * columns],
            threads,
            || (self.inner.solution(), self.inner.jacobians()),
            |(at, jacobians), row, [out]| {
                if !self.solve(&poses, row, mode, at)? {
                    return Ok([false; 2]);
                }
                let regular = self.inner.differentiate(at, jacobians).map_err(|e| e.to_string())?;
                // Row by row, as NumPy has it.
                out.copy_from_slice(self.inner.twist_by_pose(jacobians).transpose().as_slice());
                Ok([true, regular])
            },
        )?;
        poses.shaped(&tables.table(0), &[6, columns])
    }

    /// Rates and accelerations of every joint.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// rates : (..., d) array_like, or mapping
    ///     First derivatives of the task coordinates by time, m/s and rad/s; one row is for all poses. By name, those that are
    ///     not given are zero.
    /// accelerations : (..., d) array_like, or mapping, optional
    ///     Second derivatives, m/s² and rad/s²; zero if not given.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Motion
    ///     NaN where the pose is out of reach, or the joint has no rate at a serial singularity.
    #[pyo3(signature = (poses, rates, accelerations = None, *, mode = "home", threads = None))]
    fn velocity<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        accelerations: Option<&Bound<'py, PyAny>>,
        mode: &str,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Motion> {
        let mode = self.mode(mode)?;
        let names = self.pose_names();
        let none = vec![0.0; names.len()];
        let columns = Columns { names: &names, otherwise: Some(&none) };
        let (mut poses, mut rates) = (self.poses(poses)?, columns.read(rates, "rates")?);
        let mut accelerations =
            accelerations.map(|given| columns.read(given, "accelerations")).transpose()?;
        together(
            (&mut poses, "poses"),
            &mut [(Some(&mut rates), "rates"), (accelerations.as_mut(), "accelerations")],
        )?;
        let (poses, rates) = (Rows::new(&poses)?, Rows::new(&rates)?);
        let accelerations = accelerations.as_ref().map(Rows::new).transpose()?;
        let (joints, imaginary) = (self.inner.coordinates().len(), self.inner.imaginary().len());
        let mut tables = Tables::fill(
            py,
            poses.count,
            [joints, joints, imaginary, imaginary],
            threads,
            || (self.inner.solution(), self.inner.joint_motion()),
            |(at, motion), row, out| {
                if !self.solve(&poses, row, mode, at)? {
                    return Ok([false; 2]);
                }
                let of = |rows: &Rows<'_>| row.min(rows.count - 1);
                let rates = rates.row(of(&rates));
                let accelerations = accelerations.as_ref().map_or(&none[..], |a| a.row(of(a)));
                let regular = self.inner.velocity(at, rates, accelerations, motion);
                let regular = regular.map_err(|error| error.to_string())?;
                let found = [
                    &motion.joint_rates,
                    &motion.joint_accelerations,
                    &motion.imaginary_rates,
                    &motion.imaginary_accelerations,
                ];
                let [joint_rates, joint_accelerations, imaginary_rates, imaginary_accelerations] =
                    out;
                let mut out =
                    [joint_rates, joint_accelerations, imaginary_rates, imaginary_accelerations];
                for (out, found) in out.iter_mut().zip(found) {
                    out.copy_from_slice(found);
                }
                for singular in &motion.singular {
                    for joint in self.inner.rateless(singular) {
                        (out[0][joint], out[1][joint]) = (f64::NAN, f64::NAN);
                    }
                    if let Some(joint) = self.inner.rateless_imaginary(singular) {
                        (out[2][joint], out[3][joint]) = (f64::NAN, f64::NAN);
                    }
                }
                Ok([true, regular])
            },
        )?;
        let [reachable, regular] =
            std::mem::take(&mut tables.answers).map(|answers| answers.into_pyarray(py));
        Ok(Motion {
            joint_rates: poses.frozen(&tables.table(0), &[joints])?,
            joint_accelerations: poses.frozen(&tables.table(1), &[joints])?,
            imaginary_rates: poses.frozen(&tables.table(2), &[imaginary])?,
            imaginary_accelerations: poses.frozen(&tables.table(3), &[imaginary])?,
            reachable: poses.frozen(&reachable, &[])?,
            regular: poses.frozen(&regular, &[])?,
            joint_names: self.joint_names(),
            imaginary_names: self.imaginary_names(),
            index: poses.index(py),
        })
    }

    /// How near each pose is to a singularity, by section.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// length : float, optional
    ///     Characteristic length of `condition` and `manipulability`, metres. The spread of the joint axes if not given.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Singularity
    ///     One number for each pose and measure, NaN where the pose is out of reach.
    #[pyo3(signature = (poses, *, mode = "home", length = None, threads = None))]
    fn singularity<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Singularity> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let length = characteristic_length(&self.inner, length)?;
        let mut tables = Tables::fill(
            py,
            poses.count,
            [1; 9],
            threads,
            || (self.inner.solution(), self.inner.jacobians(), self.inner.singularities()),
            |(at, jacobians, measured), row, out| {
                if !self.solve(&poses, row, mode, at)? {
                    return Ok([false; 2]);
                }
                let regular = self.inner.differentiate(at, jacobians).map_err(|e| e.to_string())?;
                self.inner.measure_singularities(jacobians, measured);
                let conditioning = self.inner.conditioning(jacobians, length);
                let parallel = |measure: Option<f64>| measure.unwrap_or(f64::NAN);
                let found = [
                    measured.upper.serial,
                    parallel(measured.upper.parallel),
                    measured.lower.serial,
                    parallel(measured.lower.parallel),
                    measured.whole.serial,
                    parallel(measured.whole.parallel),
                    conditioning.condition,
                    conditioning.manipulability,
                    measured.coordinates,
                ];
                for (out, found) in out.into_iter().zip(found) {
                    out[0] = found;
                }
                Ok([true, regular])
            },
        )?;
        let [reachable, _] =
            std::mem::take(&mut tables.answers).map(|answers| answers.into_pyarray(py));
        let take = |number: usize| poses.frozen(&tables.table(number), &[]);
        Ok(Singularity {
            upper_serial: take(0)?,
            upper_parallel: take(1)?,
            lower_serial: take(2)?,
            lower_parallel: take(3)?,
            serial: take(4)?,
            parallel: take(5)?,
            condition: take(6)?,
            manipulability: take(7)?,
            coordinates: take(8)?,
            reachable: poses.frozen(&reachable, &[])?,
            index: poses.index(py),
        })
    }
}

/// The length that is given, checked, or the mechanism's own.
pub fn characteristic_length(inner: &core::Manipulator, given: Option<f64>) -> PyResult<f64> {
    opm_study::characteristic_length(given, inner).map_err(|error| request(&error))
}

impl Manipulator {
    /// The rows of these joints of the Jacobian of a solved pose, NaN where a joint has no rate; whether all have one.
    pub fn joint_rows(
        &self,
        at: &Solution,
        jacobians: &mut Jacobians,
        rows: &[usize],
        out: &mut [f64],
    ) -> Result<bool, String> {
        let columns = self.inner.task_coordinates().len();
        let regular = self.inner.differentiate(at, jacobians).map_err(|e| e.to_string())?;
        let whole = jacobians.joints_by_pose();
        for (out, &joint) in out.chunks_exact_mut(columns).zip(rows) {
            out.iter_mut().zip(whole.row(joint).iter()).for_each(|(out, &rate)| *out = rate);
        }
        for singular in &jacobians.singular {
            for rateless in self.inner.rateless(singular) {
                let Some(row) = rows.iter().position(|&joint| joint == rateless) else {
                    continue;
                };
                out[row * columns..][..columns].fill(f64::NAN);
            }
        }
        Ok(regular)
    }

    /// Solves the pose of one row; `false` where it is out of reach.
    pub fn solve(
        &self,
        poses: &Rows<'_>,
        row: usize,
        mode: Mode,
        at: &mut Solution,
    ) -> Result<bool, String> {
        if poses.missing(row) {
            return Ok(false);
        }
        let found = self.inner.inverse(poses.row(row), mode, at);
        Ok(found.map_err(|error| format!("pose {row}: {error}"))?.is_some())
    }
}
