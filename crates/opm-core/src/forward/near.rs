//! Forward kinematics near a pose, for any mechanism. Where the sections can be solved one after the other, and lead to an
//! assembly nearby, it is that one. Otherwise it is Newton's method on the platform's two displacements, with the Jacobian
//! of the actuated joints. Steps are twists, not changes of the task coordinates, so that a singularity of the Euler angles
//! does not stop them. Home is such a pose in many mechanisms.

use super::newton::{NearBuffer, Newton};
use super::{Assembly, ForwardError};
use crate::manipulator::{Manipulator, Mode, PoseError, Unreachable};
use std::fmt;

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
    pub why: NearStop,
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
pub enum NearStop {
    /// A leg is out of reach in the direction of the step, in this working mode.
    OutOfReach(Unreachable),
    /// The Jacobian is singular: at a serial singularity of a leg, or at a parallel singularity.
    Singular,
    /// No step reduces the distance of the joints from their values.
    Stalled,
    /// The largest number of steps was taken without convergence.
    Steps,
}

impl fmt::Display for NearStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfReach(unreachable) => {
                let Unreachable { leg, section, deficit } = unreachable;
                let (leg, excess, unit) = (leg + 1, deficit.excess, deficit.quantity.unit());
                write!(f, "leg number {leg} is out of reach")?;
                if let Some(section) = section {
                    write!(f, " in its {section} section")?;
                }
                write!(f, " by {excess:.3e} {unit}")
            }
            Self::Singular => f.write_str("the pose is singular"),
            Self::Stalled => f.write_str("no step reduces the error"),
            Self::Steps => f.write_str("no convergence"),
        }
    }
}

impl Manipulator {
    /// The assembly near a start pose, in one working mode: the nearest solution of each section in turn, where they are
    /// solved like that and move little; otherwise what Newton's method finds. At the assembly, the actuated joints have
    /// the given values, in the order of [`Manipulator::actuated`], radians and metres.
    /// Angles count modulo 2π, unless full revolutions matter.
    ///
    /// The convergence of Newton's method is quadratic near the solution. Steps that lead out of reach or away from the
    /// solution are shortened.
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
        let mut buffer = self.near_buffer();
        self.forward_near_into(actuated, start, mode, &mut buffer)?;
        Ok(buffer.assembly)
    }

    /// Does the same as [`Manipulator::forward_near`] with a buffer, which gets the assembly: for a control loop, where
    /// the last pose is the next start. Nothing is allocated where an assembly is found.
    ///
    /// # Errors
    /// As [`Manipulator::forward_near`].
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let (mode, mut solution) = (manipulator.home_mode(), manipulator.solution());
    /// let (mut buffer, mut last) = (manipulator.near_buffer(), manipulator.home_pose());
    /// for step in 0..10 {
    ///     // The platform moves along x, and the actuated joints are measured.
    ///     let pose = manipulator.pose([("x", 0.001 * f64::from(step)), ("xi", 0.2)])?;
    ///     let joints = manipulator.inverse(&pose, mode, &mut solution)?.expect("in reach").joints();
    ///     let measured: Vec<f64> = manipulator.actuated().iter().map(|&i| joints[i]).collect();
    ///     // Where is the platform? Near where it was.
    ///     let assembly = manipulator.forward_near_into(&measured, &last, mode, &mut buffer)?;
    ///     assert!(assembly.pose.iter().zip(&pose).all(|(found, q)| (found - q).abs() < 1e-9));
    ///     last.copy_from_slice(&assembly.pose);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn forward_near_into<'a>(
        &self,
        actuated: &[f64],
        start: &[f64],
        mode: Mode,
        buffer: &'a mut NearBuffer,
    ) -> Result<&'a Assembly, NearError> {
        self.write_displacements(actuated, &mut buffer.displacements)?;
        Newton { manipulator: self, wanted: actuated, mode }.run(start, buffer)?;
        Ok(&buffer.assembly)
    }
}
