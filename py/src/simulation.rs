//! Motion under efforts.

use crate::arguments;
use crate::error::{failed, wrong};
use crate::given::Columns;
use crate::manipulator::Manipulator;
use crate::rows::Rows;
use crate::setup;
use crate::velocity::characteristic_length;
use nalgebra::DVector;
use numpy::{PyArray1, PyArray2};
use opm_analysis::{Dynamics, Setup, SimulationError, State};
use pyo3::prelude::*;

/// The errors of a step that are allowed: below are rounding, above is no motion.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-13..=1e-2;

/// Why a motion ends early.
enum Ended {
    Simulation(SimulationError),
    Python(PyErr),
}

impl From<SimulationError> for Ended {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(error)
    }
}

#[pymethods]
impl Manipulator {
    /// The motion under efforts of the actuators: forward dynamics, integrated.
    ///
    /// The pair of orders 5 and 4 by Dormand and Prince chooses its steps by `tolerance`. Friction that holds a joint at rest is not
    /// modelled.
    ///
    /// Parameters
    /// ----------
    /// pose : (d,) array_like, or mapping
    ///     The pose at the first time, as for :meth:`inverse`.
    /// rates : (d,) array_like, or mapping
    ///     First derivatives of the task coordinates then, m/s and rad/s. By name, those that are not given are zero.
    /// times : (n,) array_like
    ///     Seconds, rising.
    /// efforts : (a,) or (n, a) array_like, mapping, or callable
    ///     The effort of every actuated joint, N and N m: the same all the time, or a row for each time, from it to the next. A
    ///     controller is called as ``efforts(t, pose, rates)`` at each time and returns the efforts until the next: `times` are those
    ///     of its cycle. By name, those that are not given are zero.
    /// gravity : (3,) array_like, optional
    ///     How a body falls, m/s², base directions; 9.81 m/s² along -z if not given.
    /// density : float, optional
    ///     Density of bodies whose masses the mechanism does not give, kg/m³, instead of the mechanism's.
    /// tolerance : float
    ///     The largest error of a step, of radians, rad/s and the characteristic length (and that over a second): 1e-13 to 0.01.
    /// mode : str
    ///     ``"home"``, or a sign for every two-valued choice.
    ///
    /// Returns
    /// -------
    /// poses : (n, d) ndarray
    ///     The pose at every time, m and rad. NaN after the mechanism has come out of reach, to a serial singularity, or to one of
    ///     its coordinates.
    /// rates : (n, d) ndarray
    ///     Likewise, m/s and rad/s.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     An argument is wrong, or the motion is so stiff that there is no end to its steps. What `efforts` raises is passed on.
    ///
    /// Examples
    /// --------
    /// >>> import numpy as np, opm_kinematics as opm
    /// >>> m = opm.examples.load("delta")
    /// >>> rest = np.zeros(3)
    /// >>> holding = m.inverse_dynamics(m.home, rest, rest)
    /// >>> stiff, damped = np.diag([400.0, 400.0, 400.0]), np.diag([20.0, 20.0, 20.0])
    /// >>> def controller(t, pose, rates):
    /// ...     wanted = -stiff @ (pose - m.home) - damped @ rates
    /// ...     return m.inverse_dynamics(pose, rates, wanted)
    /// >>> times = np.linspace(0, 1, 201)
    /// >>> poses, rates = m.simulate(np.add(m.home, [0.01, 0, 0]), rest, times, controller)
    /// >>> poses.shape, bool(abs(poses[-1] - m.home).max() < 1e-5)
    /// ((201, 3), True)
    #[pyo3(signature = (
        pose, rates, times, efforts, *, gravity = None, density = None, tolerance = 1e-9, mode = "home"
    ))]
    #[allow(clippy::too_many_arguments, clippy::type_complexity)]
    fn simulate<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        rates: &Bound<'py, PyAny>,
        times: &Bound<'py, PyAny>,
        efforts: &Bound<'py, PyAny>,
        gravity: Option<&Bound<'py, PyAny>>,
        density: Option<f64>,
        tolerance: f64,
        mode: &str,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
        let (mode, gravity) = (self.mode(mode)?, setup::gravity(gravity, density)?);
        let names = self.pose_names();
        let none = vec![0.0; names.len()];
        let of_task = Columns { names: &names, otherwise: Some(&none) };
        let start = State {
            pose: finite(self.pose(pose, "pose")?, "pose")?,
            rates: finite(arguments::row(rates, "rates", of_task)?, "rates")?,
        };
        let times = arguments::list(times, "times")?;
        if times.is_empty()
            || !times.iter().all(|t| t.is_finite())
            || !times.is_sorted_by(|a, b| a < b)
        {
            return Err(wrong(
                "times do not rise, expected one or more finite numbers, seconds, each above the one before",
            ));
        }
        if !TOLERANCES.contains(&tolerance) {
            let (least, most) = (TOLERANCES.start(), TOLERANCES.end());
            return Err(wrong(format!("tolerance is {tolerance}, expected {least} to {most}")));
        }
        let inputs = self.input_names();
        let unpowered = vec![0.0; inputs.len()];
        let of_motors = || Columns { names: &inputs, otherwise: Some(&unpowered) };
        let given = match efforts.is_callable() {
            true => None,
            false => Some(of_motors().read(efforts, "efforts")?),
        };
        let given = given.as_ref().map(Rows::new).transpose()?;
        if let Some(rows) = &given {
            if rows.count != 1 && rows.count != times.len() {
                let (found, count) = (rows.count, times.len());
                return Err(wrong(format!(
                    "{found} rows of efforts, expected {count} as of times, or one"
                )));
            }
            finite(rows.values().to_vec(), "efforts")?;
        }
        let setup = Setup {
            gravity: Some(gravity),
            ..Setup::new(characteristic_length(&self.inner, None)?)
        };
        let pushed = |number: usize, state: &State| -> Result<DVector<f64>, Ended> {
            py.check_signals().map_err(Ended::Python)?;
            if let Some(rows) = &given {
                return Ok(DVector::from_column_slice(rows.row(number.min(rows.count - 1))));
            }
            let array = |values: &DVector<f64>| PyArray1::from_slice(py, values.as_slice());
            let of_state = (times[number], array(&state.pose), array(&state.rates));
            let found = efforts.call1(of_state).map_err(Ended::Python)?;
            let what = format!("efforts(t = {} s)", times[number]);
            let found = arguments::row(&found, &what, of_motors()).map_err(Ended::Python)?;
            finite(found, &what).map_err(Ended::Python)
        };
        let mut dynamics = Dynamics::new(&self.inner, &setup);
        let (states, ended) = dynamics.simulate(start, mode, (&times, tolerance), pushed);
        match ended {
            Err(Ended::Python(error)) => return Err(error),
            Err(Ended::Simulation(error @ SimulationError::Steps { .. })) => {
                return Err(failed(&error));
            }
            // Out of reach is an answer.
            Ok(()) | Err(Ended::Simulation(_)) => {}
        }
        let table = |part: fn(&State) -> &DVector<f64>| {
            let rows = (0..times.len()).map(|row| match states.get(row) {
                Some(state) => part(state).as_slice().to_vec(),
                None => vec![f64::NAN; names.len()],
            });
            PyArray2::from_vec2(py, &rows.collect::<Vec<_>>()).map_err(|error| failed(&error))
        };
        Ok((table(|state| &state.pose)?, table(|state| &state.rates)?))
    }
}

/// Numbers that are all finite.
fn finite(values: Vec<f64>, what: &str) -> PyResult<DVector<f64>> {
    match values.iter().find(|value| !value.is_finite()) {
        Some(odd) => Err(wrong(format!("{odd} is among {what}, expected finite numbers"))),
        None => Ok(DVector::from_vec(values)),
    }
}
