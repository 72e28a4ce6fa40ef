//! Forward kinematics near a pose, for any mechanism: Newton's method on the platform's two displacements,
//! with the Jacobian of the actuated joints. Steps are twists, not changes of the task coordinates, so that
//! a singularity of the Euler angles does not stop them. Home is such a pose in many mechanisms.

use super::{Assembly, ForwardError};
use crate::group::LocalTwist;
use crate::manipulator::{Manipulator, Mode, PoseError, Solution, Unreachable};
use crate::mechanism::joint::JointKind;
use crate::numeric::Quantity;
use crate::numeric::svd::Svd;
use crate::velocity::Jacobians;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;
use std::fmt;

/// The largest number of steps. Newton's method takes about six from a good start.
const STEPS: u32 = 60;

/// The longest step, in radians or shares of the size. The linear terms are not useful further away.
const LONGEST: f64 = 0.5;

/// How often a step is halved that leads out of reach or away from the solution.
const HALVINGS: u32 = 20;

/// The joints have their values to within this, in radians and shares of the size. From there on, steps are
/// taken only as long as they reduce the error.
const ARRIVED: f64 = 1e-11;

/// A singular value of the Jacobian below this share of the largest counts as zero. Lengths are over the
/// size.
const SINGULAR: f64 = 1e-9;

/// Why no assembly was found near a pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NearError {
    /// The joint values cannot be computed with.
    #[error(transparent)]
    Joints(#[from] ForwardError),
    /// The pose to start from cannot be computed with.
    #[error(transparent)]
    Start(#[from] PoseError),
    /// Newton's method did not reach an assembly.
    #[error(transparent)]
    NotFound(#[from] NotFound),
}

/// Where Newton's method ended without an assembly.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "no assembly found from this start: {why} at step {steps}, where an actuated joint differs from its \
     value by {off:.3e} (in radians, or shares of the mechanism's size)"
)]
pub struct NotFound {
    /// What stopped the steps.
    pub why: Stop,
    /// The number of steps that were taken.
    pub steps: u32,
    /// The largest distance of an actuated joint from its value, in radians or shares of the mechanism's
    /// size; infinite if the start is out of reach.
    pub off: f64,
    /// The last pose: task coordinates, metres and radians.
    pub pose: Vec<f64>,
}

/// What stopped the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// A leg is out of reach in the direction of the step, in this working mode.
    OutOfReach(Unreachable),
    /// The Jacobian is singular: at a serial singularity of a leg, or at a parallel singularity.
    Singular,
    /// No step reduces the distance of the joints from their values.
    Stalled,
    /// The largest number of steps was taken without convergence.
    Steps,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach(unreachable) => {
                let Unreachable { leg, section, deficit } = unreachable;
                let (leg, excess, unit) = (leg + 1, deficit.excess, deficit.quantity.unit());
                write!(
                    f,
                    "leg number {leg} is out of reach in its {section} section by {excess:.3e} {unit}"
                )
            }
            Self::Singular => f.write_str("the pose is singular"),
            Self::Stalled => f.write_str("no step reduces the error"),
            Self::Steps => f.write_str("no convergence"),
        }
    }
}

impl Manipulator {
    /// The assembly that Newton's method finds from a start pose, in one working mode. At the assembly, the
    /// actuated joints have the given values, in the order of [`Manipulator::actuated`], radians and metres.
    /// Angles count modulo 2π, unless full revolutions matter.
    ///
    /// Convergence is quadratic near the solution. Steps that lead out of reach or away from the solution
    /// are shortened.
    ///
    /// # Errors
    /// If the joint values or the start cannot be computed with, or if the steps end without an assembly;
    /// [`NotFound`] says where and why.
    pub fn forward_near(
        &self,
        actuated: &[f64],
        start: &[f64],
        mode: Mode,
    ) -> Result<Assembly, NearError> {
        let displacements = self.actuated_displacements(actuated)?;
        let mut newton = Newton {
            manipulator: self,
            wanted: actuated,
            modulo: self.modulo_revolutions(),
            mode,
            pose: start.to_vec(),
            solution: self.solution(),
        };
        let mut jacobians = self.jacobians();
        if self.inverse(start, mode, &mut newton.solution)?.is_none() {
            let why = Stop::OutOfReach(newton.solution.unreachable[0]);
            return Err(newton.ended(why, 0, f64::INFINITY).into());
        }
        let mut error = newton.error();
        for steps in 0..STEPS {
            match newton.step(&mut jacobians, &mut error) {
                Ok(()) => {}
                Err(_) if error.amax() <= ARRIVED => break,
                Err(why) => return Err(newton.ended(why, steps, error.amax()).into()),
            }
        }
        if error.amax() > ARRIVED {
            return Err(newton.ended(Stop::Steps, STEPS, error.amax()).into());
        }
        let (v, b) = (newton.solution.solved.v, newton.solution.solved.b);
        let pose = self.independent_of(&self.task().pose(&v, &b, newton.rise()));
        self.inverse(&pose, mode, &mut newton.solution)?;
        let target = newton.solution.displacement(self);
        let mut solution = newton.solution.clone();
        let assembly = self.assembly(&pose, mode, &displacements, &mut solution, &target);
        if assembly.residual > self.largest_residual() {
            return Err(newton.ended(Stop::Stalled, STEPS, assembly.residual).into());
        }
        Ok(assembly)
    }

    /// For every actuated coordinate, whether it is an angle modulo 2π.
    fn modulo_revolutions(&self) -> Vec<bool> {
        let rotates = |kind: JointKind| match kind {
            JointKind::Revolute | JointKind::Universal { .. } | JointKind::Cylindrical => true,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Spherical => false,
        };
        let joints = self.mechanism().joints().filter(|joint| joint.actuated);
        joints
            .flat_map(|joint| {
                let rotates = rotates(joint.kind);
                joint.coordinates.iter().map(move |c| rotates && c.quantity == Quantity::Angle)
            })
            .collect()
    }
}

/// The state of Newton's method.
struct Newton<'a> {
    manipulator: &'a Manipulator,
    /// The values that the actuated joints should have, radians and metres.
    wanted: &'a [f64],
    /// For every actuated coordinate, whether it is an angle modulo 2π.
    modulo: Vec<bool>,
    mode: Mode,
    /// The present pose, task coordinates.
    pose: Vec<f64>,
    /// The solution at the present pose.
    solution: Solution,
}

impl Newton<'_> {
    /// The report of a run without an assembly.
    fn ended(self, why: Stop, steps: u32, off: f64) -> NotFound {
        NotFound { why, steps, off, pose: self.pose }
    }

    /// The actuated joints' wanted values minus their present ones, in radians and shares of the size.
    fn error(&self) -> DVector<f64> {
        let m = self.manipulator;
        let joints = m.actuated().iter().zip(self.wanted).zip(&self.modulo);
        DVector::from_iterator(
            self.wanted.len(),
            joints.map(|((&coordinate, wanted), modulo)| {
                let error = wanted - self.solution.joints[coordinate];
                match m.coordinates()[coordinate].quantity {
                    Quantity::Angle if *modulo => error - TAU * (error / TAU).round(),
                    Quantity::Angle => error,
                    Quantity::Length => error / m.closure.size,
                }
            }),
        )
    }

    /// The height above home, metres.
    fn rise(&self) -> f64 {
        self.manipulator.task().rise(&self.solution.solved.pose)
    }

    /// Takes one step, shortened until it reduces the error.
    fn step(&mut self, jacobians: &mut Jacobians, error: &mut DVector<f64>) -> Result<(), Stop> {
        let m = self.manipulator;
        let size = m.closure.size;
        if !m.differentiate(&self.solution, jacobians).unwrap_or(false) {
            return Err(Stop::Singular);
        }
        let directions = jacobians.directions();
        let raised = m.task().height.is_some();
        // In rows and columns, lengths are divided by the size.
        let (lower, upper) = (m.task().lower.kind, m.task().upper.kind);
        let columns: Vec<f64> = (directions.iter())
            .map(
                |[u, l]| {
                    if upper.is_translation(u) || lower.is_translation(l) { size } else { 1.0 }
                },
            )
            .chain(raised.then_some(size))
            .collect();
        let row = |i: usize| match m.coordinates()[m.actuated()[i]].quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => 1.0 / size,
        };
        // Locked joints stay where they are.
        let (actuated, locked) = (self.wanted.len(), jacobians.locked.nrows());
        let matrix = DMatrix::from_fn(actuated + locked, columns.len(), |i, j| {
            let rate = match i.checked_sub(actuated) {
                None => jacobians.joints[(m.actuated()[i], j)] * row(i),
                Some(locked) => jacobians.locked[(locked, j)],
            };
            rate * columns[j]
        });
        let svd = Svd::new(matrix);
        if svd.rank(SINGULAR) < columns.len() {
            return Err(Stop::Singular);
        }
        let mut step = DVector::zeros(columns.len());
        for (k, value) in svd.values.iter().enumerate() {
            let image = svd.image.column(k);
            let along = image.rows(0, actuated).dot(error);
            step += svd.right.column(k) * (along / (value * value));
        }
        let share = (LONGEST / step.amax()).min(1.0);
        let (v, b) = (self.solution.solved.v, self.solution.solved.b);
        let mut tried = self.solution.clone();
        let mut stop = Stop::Stalled;
        for halving in 0..HALVINGS {
            let scale = share * 0.5_f64.powi(halving as i32);
            let [mut upper_twist, mut lower_twist] = [LocalTwist::zeros(); 2];
            for ((component, column), [u, l]) in step.iter().zip(&columns).zip(&directions) {
                upper_twist += u * (component * column * scale);
                lower_twist += l * (component * column * scale);
            }
            // The twists are ḃ b⁻¹ and v⁻¹ v̇.
            let moved_b = upper.first_order(&upper_twist).after(&b);
            let moved_v = v.after(&lower.first_order(&lower_twist));
            let along = if raised { step[directions.len()] * size * scale } else { 0.0 };
            let all = m.task().pose(&moved_v, &moved_b, self.rise() + along);
            let pose = m.independent_of(&all);
            match m.inverse(&pose, self.mode, &mut tried) {
                Ok(Some(_)) => {
                    std::mem::swap(&mut self.solution, &mut tried);
                    let after = self.error();
                    if after.norm() < error.norm() {
                        *error = after;
                        self.pose = pose;
                        return Ok(());
                    }
                    std::mem::swap(&mut self.solution, &mut tried);
                    stop = Stop::Stalled;
                }
                Ok(None) => stop = Stop::OutOfReach(tried.unreachable[0]),
                Err(_) => stop = Stop::Stalled,
            }
            if error.amax() <= ARRIVED {
                break;
            }
        }
        Err(stop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each step leaves the square of the error before it, times a constant of the mechanism.
    #[test]
    fn convergence_is_quadratic() {
        let mut squared = 0;
        for name in ["plano-spherical-5dof", "translational-planar-4dof", "planar-planar-5dof"] {
            let m = Manipulator::example(name).unwrap();
            let home = m.task().home();
            for sign in [-1.0, 1.0] {
                let aim: Vec<f64> = home.iter().map(|q| q + 0.02 * sign).collect();
                let mut solution = m.solution();
                assert!(m.inverse(&aim, m.home_mode(), &mut solution).unwrap().is_some());
                let wanted: Vec<f64> = m.actuated().iter().map(|&i| solution.joints[i]).collect();
                assert!(m.inverse(&home, m.home_mode(), &mut solution).unwrap().is_some());
                let mut newton = Newton {
                    manipulator: &m,
                    wanted: &wanted,
                    modulo: m.modulo_revolutions(),
                    mode: m.home_mode(),
                    pose: home.clone(),
                    solution,
                };
                let (mut jacobians, mut error) = (m.jacobians(), newton.error());
                let mut before = error.amax();
                while before > 1e-12 {
                    newton.step(&mut jacobians, &mut error).unwrap();
                    let after = error.amax();
                    assert!(
                        after < 20.0 * before * before + 1e-14,
                        "{name}: {before:e}, {after:e}"
                    );
                    squared += usize::from(after > 1e-13);
                    before = after;
                }
            }
        }
        assert!(squared > 6, "{squared} steps above rounding");
    }
}
