//! Forward kinematics near a pose, for any mechanism: Newton's steps on the platform's two displacements
//! with the Jacobian of the actuated joints. They are taken as twists, not in the coordinates of the pose,
//! so that Euler angles on their pole (home, of many mechanisms) do not stop them.

use super::{Assembly, ForwardError, RESIDUAL};
use crate::group::LocalTwist;
use crate::manipulator::{Manipulator, Mode, PoseError, Solution, Unreachable};
use crate::mechanism::joint::JointKind;
use crate::numeric::Quantity;
use crate::numeric::svd::Svd;
use crate::velocity::Jacobians;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;
use std::fmt;

/// Steps at most. From a start that Newton's method is made for it takes about six.
const STEPS: u32 = 60;

/// The longest step, radians or sizes: linear terms say little further away.
const LONGEST: f64 = 0.5;

/// Halvings of a step that leads out of reach or away from the solution.
const HALVINGS: u32 = 20;

/// Off by less, in radians and sizes, the joints are where they should be, and steps go on only while they
/// improve on it.
const ARRIVED: f64 = 1e-11;

/// A singular value of the Jacobian this small beside the largest, lengths over the size, is none.
const SINGULAR: f64 = 1e-9;

/// Why there is no assembly near a pose.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NearError {
    /// Joint values that cannot be computed with.
    #[error(transparent)]
    Joints(#[from] ForwardError),
    /// A start that cannot be computed with.
    #[error(transparent)]
    Start(#[from] PoseError),
    /// The steps ended elsewhere.
    #[error(transparent)]
    NotFound(#[from] NotFound),
}

/// Where Newton's steps ended without an assembly.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "no assembly found from this start: {why} after {steps} steps, where the actuated joints are off by \
     {off:.3e} (radians and shares of the mechanism's size)"
)]
pub struct NotFound {
    /// What stopped them.
    pub why: Stop,
    /// Steps that were taken.
    pub steps: u32,
    /// How far the actuated joints are from their values, radians and shares of the mechanism's size;
    /// infinite where the start is out of reach.
    pub off: f64,
    /// The last pose.
    pub pose: Vec<f64>,
}

/// What stopped the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stop {
    /// A leg does not reach any further that way, in this working mode.
    OutOfReach(Unreachable),
    /// The Jacobian is singular: a leg has no rates, or the platform moves with the actuators held.
    Singular,
    /// No step brings the joints nearer to their values.
    Stalled,
    /// They were still on their way.
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
            Self::Singular => f.write_str("a singular pose"),
            Self::Stalled => f.write_str("no further approach"),
            Self::Steps => f.write_str("no convergence"),
        }
    }
}

impl Manipulator {
    /// The assembly that Newton's method finds from a pose, in one working mode: the pose at which the
    /// actuated joints have these values (in the order of [`Manipulator::actuated`], radians and metres,
    /// angles modulo a turn where turns do not count). Quadratic near the solution; steps that lead out
    /// of reach or away are shortened.
    ///
    /// # Errors
    /// Values or a start that cannot be computed with; or where and why the steps ended.
    pub fn forward_near(
        &self,
        actuated: &[f64],
        start: &[f64],
        mode: Mode,
    ) -> Result<Assembly, NearError> {
        let amounts = self.held_amounts(actuated)?;
        let mut newton = Newton {
            manipulator: self,
            wanted: actuated,
            wrapped: self.wrapped(),
            mode,
            pose: start.to_vec(),
            solution: self.solution(),
        };
        let mut jacobians = self.jacobians();
        if self.inverse(start, mode, &mut newton.solution)?.is_none() {
            let why = Stop::OutOfReach(newton.solution.unreachable[0]);
            return Err(newton.ended(why, 0, f64::INFINITY).into());
        }
        let mut off = newton.off();
        for steps in 0..STEPS {
            match newton.step(&mut jacobians, &mut off) {
                Ok(()) => {}
                Err(_) if off.amax() <= ARRIVED => break,
                Err(why) => return Err(newton.ended(why, steps, off.amax()).into()),
            }
        }
        if off.amax() > ARRIVED {
            return Err(newton.ended(Stop::Steps, STEPS, off.amax()).into());
        }
        let (v, b) = self.displacements(&newton.pose)?;
        let pose = self.task().pose(&v, &b);
        self.inverse(&pose, mode, &mut newton.solution)?;
        let target = self.task().displacement(&pose);
        let mut solution = newton.solution.clone();
        let assembly = self.assembly(&pose, mode, &amounts, (&mut solution, &target));
        if assembly.residual > RESIDUAL {
            return Err(newton.ended(Stop::Stalled, STEPS, assembly.residual).into());
        }
        Ok(assembly)
    }

    /// Of every actuated coordinate, whether it is an angle modulo a turn.
    fn wrapped(&self) -> Vec<bool> {
        let turns = |kind: JointKind| match kind {
            JointKind::Revolute | JointKind::Universal { .. } | JointKind::Cylindrical => true,
            JointKind::Prismatic | JointKind::Helical { .. } | JointKind::Spherical => false,
        };
        let joints = self.mechanism().joints().filter(|joint| joint.actuated);
        joints
            .flat_map(|joint| {
                let turns = turns(joint.kind);
                joint.coordinates.iter().map(move |c| turns && c.quantity == Quantity::Angle)
            })
            .collect()
    }
}

struct Newton<'a> {
    manipulator: &'a Manipulator,
    wanted: &'a [f64],
    wrapped: Vec<bool>,
    mode: Mode,
    pose: Vec<f64>,
    solution: Solution,
}

impl Newton<'_> {
    fn ended(self, why: Stop, steps: u32, off: f64) -> NotFound {
        NotFound { why, steps, off, pose: self.pose }
    }

    /// From where the actuated joints are to where they should be, radians and sizes.
    fn off(&self) -> DVector<f64> {
        let m = self.manipulator;
        let joints = m.actuated().iter().zip(self.wanted).zip(&self.wrapped);
        DVector::from_iterator(
            self.wanted.len(),
            joints.map(|((&coordinate, wanted), wrapped)| {
                let off = wanted - self.solution.joints[coordinate];
                match m.coordinates()[coordinate].quantity {
                    Quantity::Angle if *wrapped => off - TAU * (off / TAU).round(),
                    Quantity::Angle => off,
                    Quantity::Length => off / m.closure.size,
                }
            }),
        )
    }

    /// One step, as far as it brings the joints nearer.
    fn step(&mut self, jacobians: &mut Jacobians, off: &mut DVector<f64>) -> Result<(), Stop> {
        let m = self.manipulator;
        let size = m.closure.size;
        if !m.differentiate(&self.solution, jacobians).unwrap_or(false) {
            return Err(Stop::Singular);
        }
        let directions = jacobians.directions();
        // Lengths over the size, in rows and columns.
        let (lower, upper) = (m.task().lower.kind, m.task().upper.kind);
        let columns: Vec<f64> = (directions.iter())
            .map(
                |[u, l]| {
                    if upper.is_translation(u) || lower.is_translation(l) { size } else { 1.0 }
                },
            )
            .collect();
        let row = |i: usize| match m.coordinates()[m.actuated()[i]].quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => 1.0 / size,
        };
        let matrix = DMatrix::from_fn(self.wanted.len(), columns.len(), |i, j| {
            jacobians.joints[(m.actuated()[i], j)] * row(i) * columns[j]
        });
        let svd = Svd::new(matrix);
        if svd.rank(SINGULAR) < columns.len() {
            return Err(Stop::Singular);
        }
        let mut step = DVector::zeros(columns.len());
        for (k, value) in svd.values.iter().enumerate() {
            step += svd.right.column(k) * (svd.image.column(k).dot(off) / (value * value));
        }
        let share = (LONGEST / step.amax()).min(1.0);
        let Ok((v, b)) = m.displacements(&self.pose) else { return Err(Stop::Stalled) };
        let mut tried = self.solution.clone();
        let mut stop = Stop::Stalled;
        for halving in 0..HALVINGS {
            let scale = share * 0.5_f64.powi(halving as i32);
            let [mut up, mut low] = [LocalTwist::zeros(); 2];
            for ((component, column), [u, l]) in step.iter().zip(&columns).zip(&directions) {
                up += u * (component * column * scale);
                low += l * (component * column * scale);
            }
            // ḃ b⁻¹ and v⁻¹ v̇
            let moved_b = upper.first_order(&up).after(&b);
            let moved_v = v.after(&lower.first_order(&low));
            let pose = m.task().pose(&moved_v, &moved_b);
            match m.inverse(&pose, self.mode, &mut tried) {
                Ok(Some(_)) => {
                    std::mem::swap(&mut self.solution, &mut tried);
                    let after = self.off();
                    if after.norm() < off.norm() {
                        *off = after;
                        self.pose = pose;
                        return Ok(());
                    }
                    std::mem::swap(&mut self.solution, &mut tried);
                    stop = Stop::Stalled;
                }
                Ok(None) => stop = Stop::OutOfReach(tried.unreachable[0]),
                Err(_) => stop = Stop::Stalled,
            }
            if off.amax() <= ARRIVED {
                break;
            }
        }
        Err(stop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{examples, file};

    /// What is left after each step is the square of what was, times a constant of the mechanism's.
    #[test]
    fn convergence_is_quadratic() {
        let mut squared = 0;
        for name in ["plano-spherical-5dof", "translational-planar-4dof", "planar-planar-5dof"] {
            let text = examples::find(name).unwrap().text;
            let m = Manipulator::new(file::read(text).unwrap().mechanism).unwrap();
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
                    wrapped: m.wrapped(),
                    mode: m.home_mode(),
                    pose: home.clone(),
                    solution,
                };
                let (mut jacobians, mut off) = (m.jacobians(), newton.off());
                let mut before = off.amax();
                while before > 1e-12 {
                    newton.step(&mut jacobians, &mut off).unwrap();
                    let after = off.amax();
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
