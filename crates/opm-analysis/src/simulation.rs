//! Motion under given efforts, and the linear model at a pose.
//!
//! The state is `(x, ẋ)`, and `ẍ` is that of [`Dynamics::forward`]. It is integrated by the pair of orders 5 and 4 of J. Dormand and
//! P. Prince (*A family of embedded Runge-Kutta formulae*, J. Computational and Applied Mathematics 6, 1980), whose difference
//! chooses the step.

use crate::dynamics::{DryFriction, Dynamics};
use nalgebra::{DMatrix, DVector};
use opm_core::manipulator::{Mode, PoseError, Solution};

/// Where the pair evaluates, and by what: the rows before the last are those of `c` and `a`, the last is of order 5.
const STAGES: [(f64, [f64; 6]); 7] = [
    (0.0, [0.0; 6]),
    (0.2, [0.2, 0.0, 0.0, 0.0, 0.0, 0.0]),
    (0.3, [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0]),
    (0.8, [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0]),
    (8.0 / 9.0, [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0]),
    (1.0, [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0]),
    (1.0, [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0]),
];

/// The difference of both orders.
const DIFFERENCE: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// The most steps between two times.
const MOST_STEPS: usize = 100_000;

/// The step of differences, of the characteristic length and of a radian.
const STEP: f64 = 1e-4;

/// A state of a mechanism: the task coordinates, m and rad, and their rates.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// The pose.
    pub pose: DVector<f64>,
    /// Its first derivative by time.
    pub rates: DVector<f64>,
}

/// Why a motion ends before its last time.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SimulationError {
    /// No acceleration is known.
    #[error(
        "after t = {time:.6} s the mechanism comes out of reach, to a serial singularity, or to one of its coordinates; expected a motion without"
    )]
    Stopped {
        /// The last time with accelerations, seconds.
        time: f64,
    },
    /// The motion is too stiff, or too fast.
    #[error(
        "after t = {time:.6} s more than {MOST_STEPS} steps are needed to the next time; expected less friction or a larger tolerance"
    )]
    Steps {
        /// The last time that was reached, seconds.
        time: f64,
    },
}

/// The linear model `d/dt (δx, δẋ) = A (δx, δẋ) + B δτ` of a mechanism at a state.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearModel {
    /// Twice as many rows and columns as there are task coordinates.
    pub a: DMatrix<f64>,
    /// A column for each actuator.
    pub b: DMatrix<f64>,
    /// The accelerations at the state.
    pub accelerations: DVector<f64>,
}

impl Dynamics<'_> {
    /// The accelerations at a state in a working mode; `None` where [`Dynamics::forward`] has none, and out of reach.
    fn accelerations(
        &mut self,
        at: &mut Solution,
        mode: Mode,
        (pose, rates): (&DVector<f64>, &DVector<f64>),
        (efforts, dry): (&DVector<f64>, DryFriction),
    ) -> Option<DVector<f64>> {
        self.manipulator().inverse(pose.as_slice(), mode, at).ok()??;
        self.update(at).ok()?.then(|| self.forward_with(rates, efforts, dry))?
    }

    /// The states of a motion at some times, seconds and rising, from a state at the first of them. `efforts` gives those of the
    /// actuators from each time to the next, by the number and the state of the time; its own error ends the motion. Each step has an
    /// error of at most `tolerance`, of radians, rad/s and the characteristic length; 1e-9 keeps energy to some 1e-8.
    ///
    /// # Errors
    /// [`SimulationError`], or that of `efforts`, with the states before.
    pub fn simulate<E: From<SimulationError>>(
        &mut self,
        start: State,
        mode: Mode,
        (times, tolerance): (&[f64], f64),
        mut efforts: impl FnMut(usize, &State) -> Result<DVector<f64>, E>,
    ) -> (Vec<State>, Result<(), E>) {
        let mut states = vec![start];
        let mut at = self.manipulator().solution();
        let mut step = f64::INFINITY;
        for (number, pair) in times.windows(2).enumerate() {
            let mut state = states[number].clone();
            let pushed = match efforts(number, &state) {
                Ok(pushed) => pushed,
                Err(error) => return (states, Err(error)),
            };
            let (mut time, mut count) = (pair[0], 0);
            while time < pair[1] {
                let left = pair[1] - time;
                let tried = step.min(left);
                let found = self.step(&mut at, mode, &state, &pushed, tried);
                let error = found.as_ref().map_or(f64::INFINITY, |(_, error)| error / tolerance);
                count += 1;
                if let Some((next, _)) = found.filter(|_| error <= 1.0) {
                    state = next;
                    time = if tried == left { pair[1] } else { time + tried };
                }
                // The usual choice, with room, and never more than five times as long.
                let factor = 0.9 * error.max(1e-10).powf(-0.2);
                let next = tried * factor.clamp(0.1, 5.0);
                step = if tried == left && error <= 1.0 { step.max(next) } else { next };
                if step < 1e-12 * (pair[1] - times[0]) {
                    return (states, Err(SimulationError::Stopped { time }.into()));
                }
                if count == MOST_STEPS {
                    return (states, Err(SimulationError::Steps { time }.into()));
                }
            }
            states.push(state);
        }
        (states, Ok(()))
    }

    /// The state after a step, and its error.
    fn step(
        &mut self,
        at: &mut Solution,
        mode: Mode,
        from: &State,
        efforts: &DVector<f64>,
        step: f64,
    ) -> Option<(State, f64)> {
        let mut slopes: Vec<State> = Vec::with_capacity(STAGES.len());
        let mut next = from.clone();
        for (_, weights) in STAGES {
            next = from.clone();
            for (slope, weight) in slopes.iter().zip(weights) {
                next.pose.axpy(step * weight, &slope.pose, 1.0);
                next.rates.axpy(step * weight, &slope.rates, 1.0);
            }
            let of = (&next.pose, &next.rates);
            let found = self.accelerations(at, mode, of, (efforts, DryFriction::Counts))?;
            slopes.push(State { pose: next.rates.clone(), rates: found });
        }
        let mut error = 0.0_f64;
        let units = self.units();
        let parts: [fn(&State) -> &DVector<f64>; 2] = [|state| &state.pose, |state| &state.rates];
        for (i, unit) in units.iter().enumerate() {
            for part in parts {
                let each = slopes.iter().zip(DIFFERENCE);
                let off: f64 = each.map(|(slope, weight)| weight * part(slope)[i]).sum();
                error = error.max((step * off / unit).abs());
            }
        }
        Some((next, error))
    }

    /// The linear model at a state, under efforts. Dry friction is left out of it. The derivatives by the pose and the rates are
    /// differences of fourth order, exact to some 1e-8 of their size; those by efforts are `M⁻¹ Jᵀ`. `None` where a pose next to it
    /// has no accelerations.
    ///
    /// # Errors
    /// The pose cannot be computed with.
    pub fn linear_model(
        &mut self,
        state: &State,
        mode: Mode,
        efforts: &DVector<f64>,
    ) -> Result<Option<LinearModel>, PoseError> {
        let mut at = self.manipulator().solution();
        self.manipulator().inverse(state.pose.as_slice(), mode, &mut at)?;
        Ok(self.linear_model_at(&mut at, state, mode, efforts))
    }

    fn linear_model_at(
        &mut self,
        at: &mut Solution,
        state: &State,
        mode: Mode,
        efforts: &DVector<f64>,
    ) -> Option<LinearModel> {
        let n = self.freedoms();
        let (mut a, mut b) = (DMatrix::zeros(2 * n, 2 * n), DMatrix::zeros(2 * n, efforts.len()));
        let units = self.units();
        let pushed = (efforts, DryFriction::LeftOut);
        for j in 0..n {
            a[(j, n + j)] = 1.0;
            for rated in [false, true] {
                let mut moved = |steps: f64| {
                    let mut moved = state.clone();
                    let of = if rated { &mut moved.rates } else { &mut moved.pose };
                    of[j] += steps * STEP * units[j];
                    self.accelerations(at, mode, (&moved.pose, &moved.rates), pushed)
                };
                let (one, two) = (moved(1.0)? - moved(-1.0)?, moved(2.0)? - moved(-2.0)?);
                let slope = (one * 8.0 - two) / (12.0 * STEP * units[j]);
                let column = if rated { n + j } else { j };
                a.view_mut((n, column), (n, 1)).copy_from(&slope);
            }
        }
        let accelerations = self.accelerations(at, mode, (&state.pose, &state.rates), pushed)?;
        for i in 0..efforts.len() {
            let mut more = efforts.clone();
            more[i] += 1.0;
            let changed = self.forward_with(&state.rates, &more, DryFriction::LeftOut)?;
            b.view_mut((n, i), (n, 1)).copy_from(&(changed - &accelerations));
        }
        Some(LinearModel { a, b, accelerations })
    }
}
