//! Forces and transmission for arrays of poses.

use crate::arguments;
use crate::error::wrong;
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use crate::rows::{Rows, Tables};
use crate::velocity::characteristic_length;
use nalgebra::Vector3;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use opm_analysis::{Balance, Index, Indices, Load, LoadAxes, LoadPoint, Statics, Wrench};
use pyo3::prelude::*;
use std::num::NonZeroUsize;

/// The components of a wrench.
const WRENCH: [&str; 6] = ["FX", "FY", "FZ", "MX", "MY", "MZ"];

/// Forces and transmission at many poses; NaN where a pose is out of reach, and where a number is not known.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Analysis {
    /// (n, a), N and N m: the effort of every actuated joint that balances the load. NaN where the load does not determine it,
    /// where it is not balanced, and at a serial singularity.
    efforts: Py<PyArray2<f64>>,
    /// (n, j), N and N m: the effort of every imaginary joint, which the lower section exerts on the upper one.
    imaginary_efforts: Py<PyArray2<f64>>,
    /// (n, a, 6): the efforts for a unit force along x, y and z of the base, and a unit moment about these axes, at the
    /// platform's reference point.
    effort_jacobian: Py<PyArray3<f64>>,
    /// (n,), no unit: input transmission index, the least of all inputs.
    iti: Py<PyArray1<f64>>,
    /// (n,), no unit: output transmission index, the least of all inputs.
    oti: Py<PyArray1<f64>>,
    /// (n,), no unit: local transmission index, the least of both.
    lti: Py<PyArray1<f64>>,
    /// (n,), no unit: largest effort of an actuator for a unit force in the worst direction, torques over the characteristic
    /// length.
    effort_per_force: Py<PyArray1<f64>>,
    /// (n,), no unit: largest effort of an actuator for a unit moment in the worst direction, forces times the characteristic
    /// length.
    effort_per_moment: Py<PyArray1<f64>>,
    /// (n,), N: largest force that the actuators bear in every direction, within their ``max_effort``.
    payload: Py<PyArray1<f64>>,
    /// (n,): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArray1<bool>>,
    /// (n,): whether the actuators balance the load.
    balanced: Py<PyArray1<bool>>,
}

pickled!(Analysis {
    efforts,
    imaginary_efforts,
    effort_jacobian,
    iti,
    oti,
    lti,
    effort_per_force,
    effort_per_moment,
    payload,
    reachable,
    balanced,
});

#[pymethods]
impl Analysis {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let count = |answers: &Py<PyArray1<bool>>| -> PyResult<usize> {
            answers.bind(py).call_method0("sum")?.extract()
        };
        let poses = self.reachable.bind(py).len()?;
        let (reachable, balanced) = (count(&self.reachable)?, count(&self.balanced)?);
        Ok(format!("<Analysis of {poses} poses: {reachable} reachable, {balanced} balanced>"))
    }
}

/// Where a force acts, as Python gives it.
fn load_point(given: &Bound<'_, PyAny>) -> PyResult<LoadPoint> {
    if let Ok(name) = given.extract::<String>() {
        match &*name {
            "platform" => return Ok(LoadPoint::Platform),
            "base" => return Ok(LoadPoint::Base),
            _ => {}
        }
    } else {
        let [x, y, z] = arguments::row(given, "at", &["x", "y", "z"])?[..] else {
            return Err(wrong("at is not three numbers"));
        };
        return Ok(LoadPoint::From(Vector3::new(x, y, z)));
    }
    let found = given.repr()?;
    Err(wrong(format!("at is {found}, expected \"platform\", \"base\" or a point (x, y, z)")))
}

#[pymethods]
impl Manipulator {
    /// Forces and transmission at many poses: efforts of the actuators, transmission indices, payload.
    ///
    /// Parameters
    /// ----------
    /// poses : (n, d) array_like
    ///     One row for each pose, one column for each task coordinate; metres and radians.
    /// wrench : (6,) or (n, 6) array_like, optional
    ///     The load on the platform, a force and a moment: FX, FY, FZ in N, MX, MY, MZ in N m. No load if not given.
    /// at : str or (3,) array_like
    ///     Where the force acts: ``"platform"``, its reference point; ``"base"``, the base's origin; or a point of the platform,
    ///     metres from the reference point along the axes of `frame`.
    /// frame : str
    ///     The axes of `wrench` and `at`: ``"base"``, or ``"platform"`` for those that the platform carries.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    /// length : float, optional
    ///     Characteristic length, by which forces and torques are compared, metres. The spread of the joint axes if not given.
    /// threads : int, optional
    ///     1 to 1024; the result does not depend on it. One for each processor if not given.
    ///
    /// Returns
    /// -------
    /// Analysis
    ///     Arrays. The effort of a joint is what its actuator exerts along its coordinate so that the mechanism stays at rest
    ///     under the load.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> m = opm.examples.load("planar-3rrr")
    /// >>> found = m.analyze([m.home], wrench=[0, 0, 0, 0, 0, 1])
    /// >>> found.efforts.round(3).tolist(), found.lti.round(3).tolist()
    /// ([[0.515, 0.515, 0.515]], [0.697])
    #[pyo3(signature = (
        poses, *, wrench = None, at = None, frame = "base", mode = "home", length = None, threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn analyze<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        wrench: Option<&Bound<'py, PyAny>>,
        at: Option<&Bound<'py, PyAny>>,
        frame: &str,
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Analysis> {
        let (poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let poses = Rows::new(&poses)?;
        let length = characteristic_length(&self.inner, length)?;
        let Some(axes) = LoadAxes::from_name(frame) else {
            return Err(wrong(format!("frame is {frame:?}, expected \"base\" or \"platform\"")));
        };
        let at = at.map(load_point).transpose()?.unwrap_or_default();
        let given = wrench.map(|given| arguments::one_or_rows(given, "wrench", &WRENCH));
        let given = given.transpose()?;
        let given = given.as_ref().map(Rows::new).transpose()?;
        if let Some(rows) = &given {
            if rows.count != poses.count && rows.count != 1 {
                let (count, expected) = (rows.count, poses.count);
                return Err(wrong(format!("{count} rows of wrench, expected {expected}, or one")));
            }
            if let Some(odd) = rows.values().iter().find(|value| !value.is_finite()) {
                return Err(wrong(format!("{odd} is among wrench, expected finite numbers")));
            }
        }
        let inner = &self.inner;
        let (actuated, imaginary) = (inner.actuated().len(), inner.imaginary().len());
        let known: Vec<Index> =
            Index::ALL.into_iter().filter(|index| index.check(inner).is_ok()).collect();
        let one = Index::ALL.map(|_| 1);
        let [a, b, c, d, e, f] = one;
        let mut tables = Tables::fill(
            py,
            poses.count,
            [actuated, imaginary, 6 * actuated, a, b, c, d, e, f],
            threads,
            || {
                let indices = Indices::new(inner, length, known.iter().copied());
                (inner.solution(), Statics::new(inner, length), indices.ok())
            },
            |(solution, statics, indices), row, [efforts, between, units, numbers @ ..]| {
                let found = inner.inverse(poses.row(row), mode, solution);
                if found.map_err(|error| error.to_string())?.is_none() {
                    return Ok([false; 2]);
                }
                statics.update(solution).map_err(|error| error.to_string())?;
                let wrench = given.as_ref().map_or(Wrench::default(), |rows| {
                    let row = rows.row(row.min(rows.count - 1));
                    Wrench::from_components(std::array::from_fn(|i| row[i]))
                });
                let platform = inner.platform_at(&solution.displacement(inner));
                let found = statics.efforts(&Load { wrench, at, axes }.on(&platform));
                let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
                for (out, found) in [(efforts, &found.actuated), (between, &found.imaginary)] {
                    out.iter_mut().zip(found).for_each(|(out, &found)| *out = number(found));
                }
                for (joint, out) in units.chunks_exact_mut(6).enumerate() {
                    if let Some(row) = statics.per_wrench(joint) {
                        out.copy_from_slice(&row);
                    }
                }
                if let Some(indices) = indices {
                    indices.evaluate(solution);
                    for (out, index) in numbers.into_iter().zip(Index::ALL) {
                        out[0] = number(indices.value(index));
                    }
                }
                Ok([true, found.balance == Balance::Balanced])
            },
        )?;
        let [reachable, balanced] =
            std::mem::take(&mut tables.answers).map(|answers| answers.into_pyarray(py));
        let index = |index: Index| frozen(tables.table(3 + index as usize).reshape([poses.count])?);
        Ok(Analysis {
            efforts: frozen(tables.table(0))?,
            imaginary_efforts: frozen(tables.table(1))?,
            effort_jacobian: frozen(tables.table(2).reshape([poses.count, actuated, 6])?)?,
            iti: index(Index::Iti)?,
            oti: index(Index::Oti)?,
            lti: index(Index::Lti)?,
            effort_per_force: index(Index::EffortPerForce)?,
            effort_per_moment: index(Index::EffortPerMoment)?,
            payload: index(Index::Payload)?,
            reachable: frozen(reachable)?,
            balanced: frozen(balanced)?,
        })
    }
}
