//! Forces and transmission for arrays of poses.

use crate::arguments;
use crate::columns::tabled;
use crate::error::request;
use crate::error::wrong;
use crate::given::{Columns, together};
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use crate::rows::{Rows, Tables};
use crate::setup::{Given, WRENCH};
use numpy::{IntoPyArray, PyArrayDyn};
use opm_analysis::{Balance, Compliant, Index, Indices, Load, Loads, Setup, Statics, Wrench};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

/// Forces and transmission at many poses; NaN where a pose is out of reach, and where a number is not known.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Analysis {
    /// (..., a), N and N m: the effort of every actuated joint that balances the load. NaN where the load does not determine it,
    /// where it is not balanced, and at a serial singularity.
    efforts: Py<PyArrayDyn<f64>>,
    /// (..., j), N and N m: the effort of every imaginary joint, which the lower section exerts on the upper one.
    imaginary_efforts: Py<PyArrayDyn<f64>>,
    /// (..., a, 6): the efforts for a unit force along x, y and z of the base, and a unit moment about these axes, at the
    /// platform's reference point.
    effort_jacobian: Py<PyArrayDyn<f64>>,
    /// (...), no unit: input transmission index, the least of all inputs.
    iti: Py<PyArrayDyn<f64>>,
    /// (...), no unit: output transmission index, the least of all inputs.
    oti: Py<PyArrayDyn<f64>>,
    /// (...), no unit: local transmission index, the least of both.
    lti: Py<PyArrayDyn<f64>>,
    /// (...), no unit: output constraint index, of legs that constrain the platform.
    oci: Py<PyArrayDyn<f64>>,
    /// (...), no unit: largest effort of an actuator for a unit force in the worst direction, torques over the characteristic
    /// length.
    effort_per_force: Py<PyArrayDyn<f64>>,
    /// (...), no unit: largest effort of an actuator for a unit moment in the worst direction, forces times the characteristic
    /// length.
    effort_per_moment: Py<PyArrayDyn<f64>>,
    /// (...), N: largest effort of an actuator under the load, torques over the characteristic length.
    effort: Py<PyArrayDyn<f64>>,
    /// (...), no unit: largest share of its ``max_effort`` that an actuator needs under the load.
    effort_share: Py<PyArrayDyn<f64>>,
    /// (...), N: largest force that the actuators bear in every direction on top of the load, within their ``max_effort``.
    payload: Py<PyArrayDyn<f64>>,
    /// (...), N m: largest moment that they bear about every axis, likewise.
    payload_moment: Py<PyArrayDyn<f64>>,
    /// (...), N m: radius of the largest ball in the wrench polytope around the load, a force with the characteristic length as
    /// its lever.
    payload_ball: Py<PyArrayDyn<f64>>,
    /// (...), m/s²: largest acceleration that the actuators give the platform in every direction from rest, without turning it,
    /// within their ``max_effort`` and on top of weight and load.
    acceleration: Py<PyArrayDyn<f64>>,
    /// (...), rad/s²: largest angular acceleration about every axis through its reference point, likewise.
    angular_acceleration: Py<PyArrayDyn<f64>>,
    /// (...), N/m: least force that displaces the platform by a unit of length along it.
    stiffness: Py<PyArrayDyn<f64>>,
    /// (...), N m/rad: least moment that turns the platform by a unit of angle about its axis.
    rotational_stiffness: Py<PyArrayDyn<f64>>,
    /// (...), Hz: lowest natural frequency, with the springs of links and actuators.
    natural_frequency: Py<PyArrayDyn<f64>>,
    /// (...), m: distance of the nearest two bodies; negative where they overlap.
    clearance: Py<PyArrayDyn<f64>>,
    /// (..., 6, 6): force and moment on the platform at its reference point, by its translations along x, y and z of the base and
    /// its rotations about them; None without stiffnesses.
    stiffness_matrix: Option<Py<PyArrayDyn<f64>>>,
    /// (..., legs, 6, 6): the same for each leg, whose sum it is: what a leg carries is this times the platform's displacement.
    leg_stiffness: Option<Py<PyArrayDyn<f64>>>,
    /// (..., 6), Hz: all natural frequencies of the platform on its springs, rising; None without stiffnesses.
    natural_frequencies: Option<Py<PyArrayDyn<f64>>>,
    /// (..., 6, 6): a row for each of them, how the platform moves: translation of its reference point along x, y and z of the base, m,
    /// and its rotation vector, rad.
    vibration_shapes: Option<Py<PyArrayDyn<f64>>>,
    /// (...): whether the pose is in reach, joint limits not considered.
    reachable: Py<PyArrayDyn<bool>>,
    /// (...): whether the actuators balance the load.
    balanced: Py<PyArrayDyn<bool>>,
    /// Names along the last axis of `efforts`.
    joint_names: Vec<String>,
    /// Names along the last axis of `imaginary_efforts`.
    imaginary_names: Vec<String>,
    /// The labels of the rows of poses, if they were given as a data frame of pandas; None otherwise.
    index: Option<Py<PyAny>>,
}

tabled!(Analysis);

pickled!(Analysis {
    efforts,
    imaginary_efforts,
    effort_jacobian,
    iti,
    oti,
    lti,
    effort_per_force,
    effort_per_moment,
    oci,
    effort,
    effort_share,
    payload,
    payload_moment,
    payload_ball,
    acceleration,
    angular_acceleration,
    stiffness,
    rotational_stiffness,
    natural_frequency,
    clearance,
    stiffness_matrix,
    leg_stiffness,
    natural_frequencies,
    vibration_shapes,
    reachable,
    balanced,
    joint_names,
    imaginary_names,
    index
});

#[pymethods]
impl Analysis {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let count = |answers: &Py<PyArrayDyn<bool>>| -> PyResult<usize> {
            answers.bind(py).call_method0("sum")?.extract()
        };
        let poses = self.reachable.bind(py).getattr("size")?.extract::<usize>()?;
        let (reachable, balanced) = (count(&self.reachable)?, count(&self.balanced)?);
        Ok(format!("<Analysis of {poses} poses: {reachable} reachable, {balanced} balanced>"))
    }
}

/// The number of tables before those of the indices.
const TABLES: usize = 7;

/// What a thread computes with.
struct Buffers<'a> {
    solution: opm_core::manipulator::Solution,
    statics: Statics<'a>,
    loads: Option<Loads<'a>>,
    indices: Option<Indices<'a>>,
    compliant: Option<Compliant<'a>>,
}

#[pymethods]
impl Manipulator {
    /// Forces and transmission at many poses: efforts of the actuators, payload, transmission indices, stiffness, clearance.
    ///
    /// Parameters
    /// ----------
    /// poses : (..., d) array_like, or mapping
    ///     As for :meth:`inverse`.
    /// wrench : (..., 6) array_like, or mapping, optional
    ///     The load on the platform, a force and a moment: FX, FY, FZ in N, MX, MY, MZ in N m. No load if not given.
    /// at : str or (3,) array_like
    ///     Where the force acts: ``"platform"``, its reference point; ``"base"``, the base's origin; or a point of the platform,
    ///     metres from the reference point along the axes of `frame`.
    /// frame : str
    ///     The axes of `wrench` and `at`: ``"base"``, or ``"platform"`` for those that the platform carries.
    /// gravity : (3,) array_like, optional
    ///     How a body falls, m/s², base directions: the weight of links and platform acts, whose masses are those of
    ///     :meth:`to_mjcf`.
    /// density : float, optional
    ///     Density of bodies whose masses the mechanism does not give, kg/m³, instead of the mechanism's.
    /// link_stiffness : (float, float), optional
    ///     Stiffness of each link against translations of its end, N/m, and against rotations, N m/rad.
    /// joint_stiffness : dict of str to float, optional
    ///     Stiffness of actuated joints, N/m and N m/rad; others are rigid.
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
        poses, *, wrench = None, at = None, frame = "base", gravity = None, density = None,
        link_stiffness = None, joint_stiffness = None, mode = "home", length = None, threads = None
    ))]
    #[allow(clippy::too_many_arguments)]
    fn analyze<'py>(
        &self,
        py: Python<'py>,
        poses: &Bound<'py, PyAny>,
        wrench: Option<&Bound<'py, PyAny>>,
        at: Option<&Bound<'py, PyAny>>,
        frame: &str,
        gravity: Option<&Bound<'py, PyAny>>,
        density: Option<f64>,
        link_stiffness: Option<[f64; 2]>,
        joint_stiffness: Option<BTreeMap<String, f64>>,
        mode: &str,
        length: Option<f64>,
        #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    ) -> PyResult<Analysis> {
        let (mut poses, mode) = (self.poses(poses)?, self.mode(mode)?);
        let columns = Columns { names: &WRENCH, otherwise: Some(&[0.0; 6]) };
        let mut given = wrench.map(|given| columns.read(given, "wrench")).transpose()?;
        together((&mut poses, "poses"), &mut [(given.as_mut(), "wrench")])?;
        let poses = Rows::new(&poses)?;
        let given = given.as_ref().map(Rows::new).transpose()?;
        if let Some(rows) = &given
            && let Some(odd) = rows.values().iter().find(|value| !value.is_finite())
        {
            return Err(wrong(format!("{odd} is among wrench, expected finite numbers")));
        }
        let inner = &self.inner;
        let springs = link_stiffness.is_some();
        let options = Given {
            wrench: None,
            at,
            frame,
            gravity,
            density,
            link_stiffness,
            joint_stiffness,
            length,
        };
        // Without a load, that of no force is balanced by no effort.
        let options = options.options_with(Some(Wrench::default()))?;
        let setup = options.check(inner).map_err(|error| request(&error))?;
        let loaded = setup.gravity.is_some() || given.is_some();
        let judged = match loaded {
            true => setup.clone(),
            false => Setup { load: None, ..setup.clone() },
        };
        let load = setup.load.unwrap_or_default();
        let (actuated, imaginary) = (inner.actuated().len(), inner.imaginary().len());
        let known = Index::known(inner, &judged);
        let legs = inner.mechanism().legs.len();
        let (six, square) = if springs { (6, 36) } else { (0, 0) };
        // Masses alone: what weights do to each leg is not asked for.
        let masses = setup.gravity.unwrap_or_default();
        let mut widths = [1; TABLES + Index::ALL.len()];
        widths[..TABLES].copy_from_slice(&[
            actuated,
            imaginary,
            6 * actuated,
            square,
            square * legs,
            six,
            square,
        ]);
        let mut tables = Tables::fill(
            py,
            poses.count,
            widths,
            threads,
            || Buffers {
                solution: inner.solution(),
                statics: Statics::new(inner, setup.length),
                loads: Loads::new(inner, &setup),
                indices: Indices::new(inner, &judged, known.iter().copied()).ok(),
                compliant: setup
                    .springs
                    .clone()
                    .and_then(|of| Some(Compliant::new(inner, of).ok()?.with_gravity(&masses))),
            },
            |buffers,
             row,
             [efforts, between, units, matrix, of_legs, hertz, shapes, numbers @ ..]| {
                let Buffers { solution, statics, loads, indices, compliant } = buffers;
                if !self.solve(&poses, row, mode, solution)? {
                    return Ok([false; 2]);
                }
                statics.update(solution).map_err(|error| error.to_string())?;
                if let Some(rows) = &given {
                    let row = rows.row(row.min(rows.count - 1));
                    let wrench = Wrench::from_components(std::array::from_fn(|i| row[i]));
                    let load = Load { wrench, ..load };
                    loads.iter_mut().for_each(|loads| loads.set_load(load));
                    indices.iter_mut().for_each(|indices| indices.set_load(load));
                }
                let Some(loads) = loads else { return Ok([true, false]) };
                let found = loads.efforts(statics, solution);
                let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
                for (out, found) in [(efforts, &found.actuated), (between, &found.imaginary)] {
                    out.iter_mut().zip(found).for_each(|(out, &found)| *out = number(found));
                }
                for (joint, out) in units.chunks_exact_mut(6).enumerate() {
                    if let Some(row) = statics.per_wrench(joint) {
                        out.copy_from_slice(&row);
                    }
                }
                if let Some(found) = compliant.as_mut().and_then(|own| own.stiffness(solution)) {
                    // The matrices are symmetric.
                    matrix.copy_from_slice(found.platform.as_slice());
                    for (out, leg) in of_legs.chunks_exact_mut(36).zip(&found.legs) {
                        out.copy_from_slice(leg.as_slice());
                    }
                    let vibrations =
                        compliant.as_ref().and_then(|compliant| compliant.vibrations(&found));
                    for (i, found) in vibrations.iter().flatten().enumerate() {
                        hertz[i] = found.frequency;
                        shapes[6 * i..][..6].copy_from_slice(found.shape.as_slice());
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
        let index = |index: Index| poses.frozen(&tables.table(TABLES + index as usize), &[]);
        Ok(Analysis {
            efforts: poses.frozen(&tables.table(0), &[actuated])?,
            imaginary_efforts: poses.frozen(&tables.table(1), &[imaginary])?,
            effort_jacobian: poses.frozen(&tables.table(2), &[actuated, 6])?,
            iti: index(Index::Iti)?,
            oti: index(Index::Oti)?,
            lti: index(Index::Lti)?,
            effort_per_force: index(Index::EffortPerForce)?,
            effort_per_moment: index(Index::EffortPerMoment)?,
            oci: index(Index::Oci)?,
            effort: index(Index::Effort)?,
            effort_share: index(Index::EffortShare)?,
            payload: index(Index::Payload)?,
            payload_moment: index(Index::PayloadMoment)?,
            payload_ball: index(Index::PayloadBall)?,
            acceleration: index(Index::Acceleration)?,
            angular_acceleration: index(Index::AngularAcceleration)?,
            stiffness: index(Index::Stiffness)?,
            rotational_stiffness: index(Index::RotationalStiffness)?,
            natural_frequency: index(Index::NaturalFrequency)?,
            clearance: index(Index::Clearance)?,
            stiffness_matrix: match springs {
                true => Some(poses.frozen(&tables.table(3), &[6, 6])?),
                false => None,
            },
            leg_stiffness: match springs {
                true => Some(poses.frozen(&tables.table(4), &[legs, 6, 6])?),
                false => None,
            },
            natural_frequencies: match springs {
                true => Some(poses.frozen(&tables.table(5), &[6])?),
                false => None,
            },
            vibration_shapes: match springs {
                true => Some(poses.frozen(&tables.table(6), &[6, 6])?),
                false => None,
            },
            reachable: poses.frozen(&reachable, &[])?,
            balanced: poses.frozen(&balanced, &[])?,
            joint_names: self.input_names().into_iter().map(str::to_owned).collect(),
            imaginary_names: self.imaginary_names(),
            index: poses.index(py),
        })
    }
}
