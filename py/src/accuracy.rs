//! Errors of parts and actuators for arrays of poses.

mod over;
mod samples;
mod sizes;

pub use over::AccuracyBounds;
pub use samples::AccuracySamples;

use crate::arguments;
use crate::columns::tabled;
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use crate::rows::{Rows, Tables};
use numpy::{IntoPyArray, PyArray1, PyArrayDyn, PyUntypedArrayMethods};
use opm_accuracy::{Allocation, Budget};
use pyo3::prelude::*;
use sizes::{ErrorArguments, pair};
use std::num::{NonZeroU64, NonZeroUsize};

/// Poses that a thread works on between two checks whether it should stop: each takes milliseconds.
const BLOCK: usize = 16;

/// Errors of the platform and of the joints at many poses; NaN where a pose is out of reach, and where a number is not known.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Accuracy {
    /// (..., d), metres and radians: the worst case of every task coordinate.
    pose_error: Py<PyArrayDyn<f64>>,
    /// (...), metres: the longest displacement of the platform's reference point.
    worst_length: Py<PyArrayDyn<f64>>,
    /// (...), radians: the largest rotation of the platform.
    worst_angle: Py<PyArrayDyn<f64>>,
    /// (..., p, d): the change of every task coordinate for a unit of every error, one metre or one radian, to first order.
    sensitivity: Py<PyArrayDyn<f64>>,
    /// (..., j), metres: the largest play of each joint, as the displacement of its point.
    misfit_length: Py<PyArrayDyn<f64>>,
    /// (..., j), radians: the largest play of each joint, as a rotation.
    misfit_angle: Py<PyArrayDyn<f64>>,
    /// (..., p), metres and radians: the tolerance of each error with which no joint needs more than its clearance, if it is the
    /// only error. Infinite where it needs no play; NaN for errors of actuators and parameters. None without `clearance`.
    permitted_alone: Option<Py<PyArrayDyn<f64>>>,
    /// (..., p), metres and radians: the same if all errors come together, and each may use an equal part of the clearance of every
    /// joint that it reaches. None without `clearance`.
    permitted_share: Option<Py<PyArrayDyn<f64>>>,
    /// (..., 2), metres and radians: one tolerance for the places and one for the directions of all axes together. Infinite
    /// where no error needs play. None without `clearance`.
    permitted_uniform: Option<Py<PyArrayDyn<f64>>>,
    /// Mechanisms with errors that are drawn at random. None without `samples`.
    samples: Option<Py<AccuracySamples>>,
    /// (p,), metres and radians: the size of each error.
    sizes: Py<PyArray1<f64>>,
    /// Names of the errors: actuated joints, parameters of the family, axes.
    parameters: Vec<String>,
    /// Names of the joints, leg by leg.
    joints: Vec<String>,
    /// (...): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArrayDyn<bool>>,
    /// (...): whether the actuators hold the platform, so that its error is known.
    held: Py<PyArrayDyn<bool>>,
    /// Names of the task coordinates.
    pose_names: Vec<String>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(Accuracy);

pickled!(Accuracy {
    pose_error,
    worst_length,
    worst_angle,
    sensitivity,
    misfit_length,
    misfit_angle,
    permitted_alone,
    permitted_share,
    permitted_uniform,
    samples,
    sizes,
    parameters,
    joints,
    reachable,
    held,
    pose_names,
    index
});

#[pymethods]
impl Accuracy {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let reachable: usize = self.reachable.bind(py).call_method0("sum")?.extract()?;
        let (poses, errors) = (self.reachable.bind(py).len(), self.parameters.len());
        Ok(format!("<Accuracy at {poses} poses, {reachable} reachable: {errors} errors>"))
    }
}

#[pymethods]
impl Manipulator {
    /// Accuracy at many poses: pose errors, sensitivities, and the play that joints need for errors that no motion takes up.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like
    ///     One row for each pose, one column for each task coordinate; metres and radians.
    /// actuators : (length, angle), optional
    ///     Errors of actuated joints: of sliders in metres, of others in radians. Either may be None.
    /// tolerances : dict or path, optional
    ///     Errors of parts, as in a file of tolerances: ``"length"`` and ``"angle"`` of all axes, ``"joint"`` with those of
    ///     single joints, ``"parameter"`` with single errors by their names; metres and radians. Or such a file.
    /// errors : str
    ///     What errors of axes are: ``"axes"``, of the numbers in the file, so that joints fit at home; ``"links"``, of parts,
    ///     whose errors act everywhere.
    /// clearance : (length, angle), optional
    ///     The play that joints have, metres and radians: asks for the tolerances that keep within it. Either may be None.
    /// samples : int, optional
    ///     Draws so many mechanisms at each pose, whose errors are uniform within their sizes, and assembles them beyond first
    ///     order: Monte Carlo. Each takes about a millisecond.
    /// seed : int
    ///     Of what is drawn: equal seeds draw equal mechanisms.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// length : float, optional
    ///     Characteristic length, by which lengths and angles are compared, metres. The spread of the joint axes if not given.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Accuracy
    ///     Arrays. Each error is between minus and plus its size; worst cases are to first order.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     The columns are not the task coordinates, a number is not finite, or a name is unknown.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("plano-spherical-5dof")
    /// >>> found = m.accuracy([m.home], tolerances={"length": 50e-6, "angle": 350e-6}, errors="links")
    /// >>> bool(found.worst_length[0] > 50e-6), bool(found.misfit_length.max() > 1e-6)
    /// (True, True)
    #[pyo3(signature = (
        poses, *, actuators = None, tolerances = None, errors = "axes", clearance = None, samples = None, seed = 1,
        mode = "home", length = None, threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn accuracy<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        actuators: Option<&Bound<'py, PyAny>>,
        tolerances: Option<&Bound<'py, PyAny>>,
        errors: &str,
        clearance: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = arguments::samples)] samples: Option<NonZeroU64>,
        #[pyo3(from_py_with = arguments::seed)] seed: u64,
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Accuracy> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let inner = &*self.inner;
        let given = ErrorArguments { actuators, tolerances, errors, length };
        let (model, sizes) = given.read(self)?;
        let (sources, length) = (model.sources(), model.length());
        let clearance = clearance.map(|given| pair(given, "clearance")).transpose()?;
        let coordinates = inner.task_coordinates().len();
        let joints: Vec<String> = inner.mechanism().joints().map(|j| j.name.clone()).collect();
        let count = sources.len();
        let asked = if clearance.is_some() { count } else { 0 };
        let uniform = if clearance.is_some() { 2 } else { 0 };
        let (j, d) = (joints.len(), coordinates);
        let widths = [d, 1, 1, count * d, j, j, asked, asked, uniform];
        let mut tables = Tables::fill_in_blocks(
            py,
            (poses.count, BLOCK),
            widths,
            threads,
            || inner.solution(),
            |solution, row, [error, long, wide, rates, lengths, angles, alone, share, uniform]| {
                if !self.solve(&poses, row, mode, solution)? {
                    return Ok([false; 2]);
                }
                let response = model.at(solution).map_err(|e| format!("pose {row}: {e}"))?;
                let budget = Budget::new(&response, &sizes);
                for (out, spread) in error.iter_mut().zip(&budget.coordinates) {
                    *out = spread.worst;
                }
                (long[0], wide[0]) = (budget.length.worst, budget.angle.worst);
                // Column by column: a row of the array for each error.
                rates.copy_from_slice(response.coordinates.as_slice());
                for ((length, angle), play) in lengths.iter_mut().zip(angles).zip(&budget.misfit) {
                    (*length, *angle) = (play.length.worst, play.angle.worst);
                }
                if let Some(clearance) = clearance {
                    let mut allocation = Allocation::new(clearance, length, count);
                    allocation.add(&response, sources);
                    for (k, permitted) in allocation.permitted().iter().enumerate() {
                        if sources[k].joint.is_some() {
                            (alone[k], share[k]) = (permitted.alone, permitted.share);
                        }
                    }
                    uniform.copy_from_slice(&allocation.uniform());
                }
                Ok([true, response.held])
            },
        )?;
        let [reachable, held] =
            std::mem::take(&mut tables.answers).map(|answers| answers.into_pyarray(py));
        let take = |number: usize, row: &[usize]| poses.frozen(&tables.table(number), row);
        let asked = |number: usize, width: usize| -> PyResult<Option<Py<PyArrayDyn<f64>>>> {
            clearance.map(|_| take(number, &[width])).transpose()
        };
        let samples = samples.map(|count| {
            let drawn = samples::draw(py, &model, (&poses, mode), (count, seed), &sizes, threads)?;
            Py::new(py, drawn)
        });
        let samples = samples.transpose()?;
        Ok(Accuracy {
            samples,
            pose_error: take(0, &[d])?,
            worst_length: take(1, &[])?,
            worst_angle: take(2, &[])?,
            sensitivity: take(3, &[count, d])?,
            misfit_length: take(4, &[j])?,
            misfit_angle: take(5, &[j])?,
            permitted_alone: asked(6, count)?,
            permitted_share: asked(7, count)?,
            permitted_uniform: asked(8, 2)?,
            parameters: sources.iter().map(|source| source.name.clone()).collect(),
            sizes: frozen(sizes.into_pyarray(py))?,
            joints,
            reachable: poses.frozen(&reachable, &[])?,
            held: poses.frozen(&held, &[])?,
            pose_names: self.pose_names().into_iter().map(str::to_owned).collect(),
            index: poses.index(py),
        })
    }
}
