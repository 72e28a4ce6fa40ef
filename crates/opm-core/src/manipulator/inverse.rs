//! Inverse kinematics in one working mode: of all joints, or of the actuated ones alone.
//!
//! Every function here has the same convention. It takes a pose and a buffer that a method of
//! [`Manipulator`] made, and returns what it wrote to the buffer: `Ok(Some(solution))`. For a pose out of
//! reach it returns `Ok(None)`, and the buffer tells which legs do not reach it. An error means that the
//! pose is not valid. Nothing allocates.

mod actuated;
mod revolutions;
mod values;

use super::angles::Angles;
use super::pose::PoseError;
use super::solution::{Solution, Unreachable};
use super::{Manipulator, Mode};
use pulp::{Simd, WithSimd};
pub(super) use revolutions::Revolutions;
pub(super) use values::AngleOf;

impl Manipulator {
    /// Every joint at a pose in one working mode, angles within half a revolution of home; `None` where
    /// the pose is out of reach in that mode ([`Solution::unreachable`] of the buffer lists the legs).
    ///
    /// # Errors
    /// The pose has the wrong length, or a coordinate that is not a finite number.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let mut buffer = manipulator.solution();
    /// let pose = [0.01, 0.0, 0.0, 0.26, 0.0]; // x y zeta xi psi
    /// match manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)? {
    ///     Some(solution) => assert!(solution.within_limits()),
    ///     None => println!("out of reach: {:?}", buffer.unreachable()),
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn inverse<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Result<Option<&'a Solution>, PoseError> {
        self.solve(pose, mode, buffer, Revolutions::NearHome)?;
        Ok(buffer.reached())
    }

    /// Does the same as [`Manipulator::inverse`], but each angle is the one nearest to what the buffer held before:
    /// along a trajectory no joint jumps by a revolution, not even to stay within its limits, and
    /// [`Solution::within_limits`] refers to that angle. Where the pose is out of reach, the buffer keeps the
    /// last values that were in reach.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    pub fn inverse_near<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Result<Option<&'a Solution>, PoseError> {
        self.solve(pose, mode, buffer, Revolutions::NearHeld)?;
        Ok(buffer.reached())
    }

    /// Solves the legs and the lifts at a pose in one working mode, without the values of the other joints, which
    /// [`Manipulator::write_closed`] writes. Returns whether the pose is in reach.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    pub(crate) fn close(
        &self,
        pose: &[f64],
        mode: Mode,
        out: &mut Solution,
    ) -> Result<bool, PoseError> {
        self.check_pose(pose)?;
        let revolutions = Revolutions::NearHome;
        if self.dependent.is_some() && !self.displace_dependent(pose, mode, out, revolutions) {
            return Ok(false);
        }
        Ok(Close { manipulator: self, pose: Some(pose), mode, out }.run())
    }

    /// Solves the legs and the lifts as [`Manipulator::close`] does, for the displacements `v` and `b` and the height that
    /// `out` holds, whatever the other coordinates are that it holds.
    pub(crate) fn close_displaced(&self, mode: Mode, out: &mut Solution) -> bool {
        Close { manipulator: self, pose: None, mode, out }.run()
    }

    /// Takes a pose and its displacements. Where coordinates are dependent, `out` has all of them already.
    #[inline(always)]
    fn displace(&self, pose: &[f64], out: &mut Solution) {
        if self.dependent.is_none() {
            out.solved.pose.copy_from_slice(pose);
            (out.solved.v, out.solved.b) = self.task.sections(pose);
        }
    }

    /// Solves a pose, or returns an error if it is not valid.
    fn solve(
        &self,
        pose: &[f64],
        mode: Mode,
        out: &mut Solution,
        revolutions: Revolutions,
    ) -> Result<(), PoseError> {
        self.check_pose(pose)?;
        if self.dependent.is_some() && !self.displace_dependent(pose, mode, out, revolutions) {
            return Ok(());
        }
        self.arch.dispatch(Solve { manipulator: self, pose, mode, out, revolutions });
        Ok(())
    }

    /// Solves every leg at the displacements that `out` holds.
    #[inline(always)]
    fn close_legs(&self, mode: Mode, out: &mut Solution, revolutions: Revolutions) {
        let task = &self.task;
        out.unreachable.clear();
        out.within_limits = true;
        let Solution { solved, taus, legs, unreachable, .. } = &mut *out;
        let rise = task.rise(&solved.pose);
        for (number, (leg, found)) in self.legs.iter().zip(legs).enumerate() {
            let branches = self.modes.branches(mode, number);
            let near = revolutions.near(taus[number], 0.0);
            let pose = [&solved.v, &solved.b];
            if let Err((section, deficit)) = leg.solve_in(task, pose, rise, branches, near, found) {
                let section = leg.named(section);
                unreachable.push(Unreachable { leg: number, section, deficit });
            }
        }
    }
}

/// All joints at a pose, with the instructions of the processor at hand.
struct Solve<'a> {
    manipulator: &'a Manipulator,
    pose: &'a [f64],
    mode: Mode,
    out: &'a mut Solution,
    revolutions: Revolutions,
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, pose, mode, out, revolutions } = self;
        manipulator.displace(pose, out);
        manipulator.close_legs(mode, out, revolutions);
        let mut angles = Angles::new(AngleOf::Leg(0));
        for number in 0..manipulator.legs.len() {
            if out.unreachable.iter().all(|missed| missed.leg != number) {
                manipulator.write(number, out, revolutions, &mut angles);
            }
        }
        angles.answer(|of, angle| manipulator.take(of, angle, out, revolutions));
        if manipulator.task.height.is_some() {
            manipulator.write_lifts(out);
        }
        manipulator.test_shared_limits(out);
    }
}

/// The legs and the lifts at a pose, or at the displacements that the solution holds, with the instructions of the
/// processor at hand.
struct Close<'a> {
    manipulator: &'a Manipulator,
    pose: Option<&'a [f64]>,
    mode: Mode,
    out: &'a mut Solution,
}

impl Close<'_> {
    /// Returns whether the pose is in reach.
    #[inline(never)]
    fn run(self) -> bool {
        self.manipulator.arch.dispatch(self)
    }
}

impl WithSimd for Close<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { manipulator, pose, mode, out } = self;
        if let Some(pose) = pose {
            manipulator.displace(pose, out);
        }
        manipulator.close_legs(mode, out, Revolutions::NearHome);
        if manipulator.task.height.is_some() {
            manipulator.write_lifts(out);
        }
        out.unreachable.is_empty()
    }
}
