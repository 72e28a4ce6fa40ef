//! Errors of parts and actuators for arrays of poses.

use crate::arguments;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use crate::rows::{Rows, Tables};
use crate::velocity::characteristic_length;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use opm_accuracy::{Allocation, Both, Budget, ErrorModel, Model, Source, Tolerances};
use opm_core::Quantity;
use opm_core::mechanism::file::hint::expected_one_of;
use pyo3::prelude::*;
use pyo3::types::PyMapping;
use std::num::NonZeroUsize;

/// Poses that a thread works on between two checks whether it should stop: each takes milliseconds.
const BLOCK: usize = 16;

/// Errors of the platform and of the joints at many poses; NaN where a pose is out of reach, and where a number is not known.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Accuracy {
    /// (n, d), metres and radians: the worst case of every task coordinate.
    pose_error: Py<PyArray2<f64>>,
    /// (n,), metres: the longest displacement of the platform's reference point.
    worst_length: Py<PyArray1<f64>>,
    /// (n,), radians: the largest rotation of the platform.
    worst_angle: Py<PyArray1<f64>>,
    /// (n, p, d): the change of every task coordinate for a unit of every error, one metre or one radian, to first order.
    sensitivity: Py<PyArray3<f64>>,
    /// (n, j), metres: the largest play of each joint, as the displacement of its point.
    misfit_length: Py<PyArray2<f64>>,
    /// (n, j), radians: the largest play of each joint, as a rotation.
    misfit_angle: Py<PyArray2<f64>>,
    /// (n, p), metres and radians: the tolerance of each error with which no joint needs more than its clearance, if it is the
    /// only error. Infinite where it needs no play; NaN for errors of actuators and parameters. None without `clearance`.
    permitted_alone: Option<Py<PyArray2<f64>>>,
    /// (n, p), metres and radians: the same if all errors come together, and each may use an equal part of the clearance of every
    /// joint that it reaches. None without `clearance`.
    permitted_share: Option<Py<PyArray2<f64>>>,
    /// (n, 2), metres and radians: one tolerance for the places and one for the directions of all axes together. None without
    /// `clearance`.
    permitted_uniform: Option<Py<PyArray2<f64>>>,
    /// (p,), metres and radians: the size of each error.
    sizes: Py<PyArray1<f64>>,
    /// Names of the errors: actuated joints, parameters of the family, axes.
    parameters: Vec<String>,
    /// Names of the joints, leg by leg.
    joints: Vec<String>,
    /// (n,): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArray1<bool>>,
    /// (n,): whether the actuators hold the platform, so that its error is known.
    held: Py<PyArray1<bool>>,
}

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
    sizes,
    parameters,
    joints,
    reachable,
    held,
});

#[pymethods]
impl Accuracy {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let reachable: usize = self.reachable.bind(py).call_method0("sum")?.extract()?;
        let (poses, errors) = (self.reachable.bind(py).len()?, self.parameters.len());
        Ok(format!("<Accuracy at {poses} poses, {reachable} reachable: {errors} errors>"))
    }
}

/// A size that is not negative.
fn size(given: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
    let number = given.extract().ok().filter(|number: &f64| number.is_finite() && *number >= 0.0);
    number.ok_or_else(|| {
        let shown = arguments::shown(given);
        wrong(format!("{what} is {shown}, expected a number of at least 0"))
    })
}

/// A pair of sizes, a length and an angle. Either may be None.
fn pair(given: &Bound<'_, PyAny>, what: &str) -> PyResult<Both> {
    let Ok([length, angle]) = given.extract::<[Bound<'_, PyAny>; 2]>() else {
        let shown = arguments::shown(given);
        return Err(wrong(format!("{what} is {shown}, expected two numbers: (metres, radians)")));
    };
    let of = |part: &Bound<'_, PyAny>| match part.is_none() {
        true => Ok(None),
        false => size(part, what).map(Some),
    };
    Ok(Both { length: of(&length)?, angle: of(&angle)? })
}

/// The entries of a mapping, by name.
fn entries<'py>(
    given: &Bound<'py, PyAny>,
    what: &str,
) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    let unsuitable = || {
        let shown = arguments::shown(given);
        wrong(format!("{what} is {shown}, expected a dict"))
    };
    let mapping = given.cast::<PyMapping>().map_err(|_| unsuitable())?;
    mapping.items()?.iter().map(|item| item.extract().map_err(|_| unsuitable())).collect()
}

/// The name, if it is among those that are known.
fn known(name: &str, what: &str, names: &[&str]) -> PyResult<()> {
    if names.contains(&name) {
        return Ok(());
    }
    Err(wrong(format!("tolerances: {name:?} is not {what}; {}", expected_one_of(name, names))))
}

/// The argument `tolerances`: a file, or a dict with the same keys in metres and radians.
fn tolerances(given: &Bound<'_, PyAny>, sources: &[Source]) -> PyResult<Tolerances> {
    let py = given.py();
    let mut found = Tolerances::default();
    if given.cast::<PyMapping>().is_err() {
        let path = arguments::path(given)?;
        let text = arguments::text(py, &path, "file of tolerances", "")?;
        let read = Tolerances::read(&text, sources);
        return read.map_err(|errors| wrong(errors.in_file(path.display())));
    }
    let both = |given: &Bound<'_, PyAny>, what: &str| -> PyResult<Both> {
        let mut both = Both::default();
        for (name, value) in entries(given, what)? {
            known(&name, "a tolerance", &["length", "angle"])?;
            let place = if name == "length" { &mut both.length } else { &mut both.angle };
            *place = Some(size(&value, &format!("{what}[{name:?}]"))?);
        }
        Ok(both)
    };
    for (name, value) in entries(given, "tolerances")? {
        known(&name, "a key", &["length", "angle", "actuators", "joint", "parameter"])?;
        let what = format!("tolerances[{name:?}]");
        match &*name {
            "length" => found.axes.length = Some(size(&value, &what)?),
            "angle" => found.axes.angle = Some(size(&value, &what)?),
            "actuators" => found.actuators = both(&value, &what)?,
            "joint" => {
                for (joint, value) in entries(&value, &what)? {
                    known(&joint, "a joint", &Tolerances::joint_names(sources))?;
                    let sizes = both(&value, &format!("{what}[{joint:?}]"))?;
                    found.joints.insert(joint, sizes);
                }
            }
            _ => {
                for (single, value) in entries(&value, &what)? {
                    known(&single, "an error", &Tolerances::single_names(sources))?;
                    let size = size(&value, &format!("{what}[{single:?}]"))?;
                    found.single.insert(single, size);
                }
            }
        }
    }
    Ok(found)
}

#[pymethods]
impl Manipulator {
    /// Accuracy at many poses: pose errors, sensitivities, and the play that joints need for errors that no motion takes up.
    ///
    /// Parameters
    /// ----------
    /// poses : (n, d) array_like
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
        poses, *, actuators = None, tolerances = None, errors = "axes", clearance = None, mode = "home", length = None,
        threads = None
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
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Accuracy> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let inner = &*self.inner;
        let length = characteristic_length(inner, length)?;
        let Some(errors) = ErrorModel::from_name(errors) else {
            return Err(wrong(format!("errors is {errors:?}, expected \"axes\" or \"links\"")));
        };
        let model = Model::new(inner, self.family.as_ref(), errors).with_length(length);
        let sources = model.sources();
        let mut sizes = match tolerances {
            Some(given) => self::tolerances(given, sources)?,
            None => Tolerances::default(),
        };
        if let Some(given) = actuators {
            sizes.actuators = pair(given, "actuators")?;
            let lacks = |s: &&Source| s.is_actuator() && sizes.actuators.of(s.quantity).is_none();
            if let Some(source) = sources.iter().find(lacks) {
                let what = match source.quantity {
                    Quantity::Length => "a length",
                    Quantity::Angle => "an angle",
                };
                let name = &source.name;
                return Err(wrong(format!(
                    "actuators: {name} is {what}, and no size is given for it"
                )));
            }
        }
        let sizes = sizes.of(sources);
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
                let found = inner.inverse(poses.row(row), mode, solution);
                let found = found.map_err(|error| format!("pose {row}: {error}"))?;
                let Some(solution) = found else { return Ok([false; 2]) };
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
        let flat = |number: usize| frozen(tables.table(number).reshape([poses.count])?);
        let asked = |number: usize| -> PyResult<Option<Py<PyArray2<f64>>>> {
            clearance.map(|_| frozen(tables.table(number))).transpose()
        };
        Ok(Accuracy {
            pose_error: frozen(tables.table(0))?,
            worst_length: flat(1)?,
            worst_angle: flat(2)?,
            sensitivity: frozen(tables.table(3).reshape([poses.count, count, d])?)?,
            misfit_length: frozen(tables.table(4))?,
            misfit_angle: frozen(tables.table(5))?,
            permitted_alone: asked(6)?,
            permitted_share: asked(7)?,
            permitted_uniform: asked(8)?,
            parameters: sources.iter().map(|source| source.name.clone()).collect(),
            sizes: frozen(sizes.into_pyarray(py))?,
            joints,
            reachable: frozen(reachable)?,
            held: frozen(held)?,
        })
    }
}
