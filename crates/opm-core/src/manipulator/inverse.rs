//! Inverse kinematics in one working mode: of all joints, or of the actuated ones alone.
//!
//! Every function here has the same convention. It takes a pose and a buffer that a method of
//! [`Manipulator`] made, and returns what it wrote to the buffer: `Ok(Some(solution))`. For a pose out of
//! reach it returns `Ok(None)`, and the buffer tells which legs do not reach it. An error means that the
//! pose is not valid. Nothing allocates.

use super::leg::LegSolution;
use super::pose::PoseError;
use super::section::{ChainCoordinate, CompiledSection};
use super::solution::{ActuatedJoints, Solution, SolvedPose, Unreachable};
use super::{Manipulator, Mode};
use crate::chain::Chain;
use crate::group::{Displacement, JointDisplacement};
use nalgebra::Vector3;
use std::f64::consts::TAU;

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
    #[inline]
    pub fn inverse<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Result<Option<&'a Solution>, PoseError> {
        if self.displace(pose, mode, buffer, Revolutions::NearHome)? {
            self.solve_legs(mode, buffer, Revolutions::NearHome);
        }
        Ok(buffer.reached())
    }

    /// Does the same as [`Manipulator::inverse`], but each angle is the one nearest to what the buffer held before:
    /// along a trajectory no joint jumps by a revolution, not even to stay within its limits, and
    /// [`Solution::within_limits`] refers to that angle. Where the pose is out of reach, the buffer keeps the
    /// last values that were in reach.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    #[inline]
    pub fn inverse_near<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Result<Option<&'a Solution>, PoseError> {
        if self.displace(pose, mode, buffer, Revolutions::NearHeld)? {
            self.solve_legs(mode, buffer, Revolutions::NearHeld);
        }
        Ok(buffer.reached())
    }

    /// The actuated and the imaginary joints alone at a pose in one working mode; `None`
    /// where the pose is out of reach. Angles are within half a revolution of home.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    pub fn inverse_actuated<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut ActuatedJoints,
    ) -> Result<Option<&'a ActuatedJoints>, PoseError> {
        self.check_pose(pose)?;
        let ((v, b), rise) = match &self.dependent {
            None => (self.task.sections(pose), self.task.rise(pose)),
            Some(dependent) => {
                let all = &mut buffer.all;
                if dependent.complete_from_home(self, mode, pose, all).is_err() {
                    return Ok(None);
                }
                (self.task.sections(all), self.task.rise(all))
            }
        };
        buffer.within_limits = true;
        for (number, leg) in self.legs.iter().enumerate() {
            let branches = self.modes.branches(mode, number);
            let tau = if leg.upper_constrains {
                let Ok(solution) = leg.solve(&self.task, [&v, &b], rise, branches, 0.0) else {
                    return Ok(None);
                };
                self.write_actuated(&leg.upper, &solution.upper, buffer);
                self.write_actuated(&leg.lower, &solution.lower, buffer);
                solution.tau
            } else {
                let Ok((lower, tau)) = leg.solve_actuated(&self.task, [&v, &b], rise, branches)
                else {
                    return Ok(None);
                };
                self.write_actuated(&leg.lower, &lower, buffer);
                tau
            };
            if let Some(imaginary) = leg.imaginary {
                let joint = &self.imaginary[imaginary];
                buffer.imaginary[imaginary] = joint.value(tau, joint.home);
            }
        }
        if self.task.height.is_some() {
            self.write_actuated_lifts(mode, [&v, &b], rise, buffer);
        }
        Ok(Some(buffer))
    }

    /// Writes the values of the lifts at a pose that is in reach, with the Schoenflies section at `rise`.
    #[inline(never)]
    fn write_actuated_lifts(
        &self,
        mode: Mode,
        pose: [&Displacement; 2],
        rise: f64,
        out: &mut ActuatedJoints,
    ) {
        for (number, lift) in self.lifts_of_legs() {
            let mut rise = rise;
            if lift.slope != 0.0 {
                let branches = self.modes.branches(mode, number);
                let solved = self.legs[number].solve_actuated(&self.task, pose, rise, branches);
                rise = solved.map_or(rise, |(_, tau)| self.task.rise_of_leg(rise, tau));
            }
            let (value, within) = self.lifted(lift, rise);
            out.within_limits &= within;
            if let Some(actuated) = lift.coordinate.actuated {
                out.actuated[actuated] = value;
            }
        }
    }

    /// Stores a pose and its displacements, or returns an error if the pose is not valid. Returns `false` where
    /// the dependent coordinates have no solution.
    #[inline]
    fn displace(
        &self,
        pose: &[f64],
        mode: Mode,
        out: &mut Solution,
        revolutions: Revolutions,
    ) -> Result<bool, PoseError> {
        self.check_pose(pose)?;
        if self.dependent.is_some() {
            return Ok(self.displace_dependent(pose, mode, out, revolutions));
        }
        out.solved.pose.copy_from_slice(pose);
        (out.solved.v, out.solved.b) = self.task.sections(pose);
        Ok(true)
    }

    #[inline]
    fn write_actuated(
        &self,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
        out: &mut ActuatedJoints,
    ) {
        out.within_limits &= section.admits(&self.limits, displacements);
        if !section.driven {
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            if let Some(ChainCoordinate { number, actuated: Some(actuated) }) = *coordinate {
                let home = self.coordinates[number].home;
                out.actuated[actuated] = home + self.limits[number].report(displacement);
            }
        }
    }

    fn solve_legs(&self, mode: Mode, out: &mut Solution, revolutions: Revolutions) {
        let SolvedPose { v, b, .. } = out.solved;
        out.unreachable.clear();
        out.within_limits = true;
        let rise = self.task.rise(&out.solved.pose);
        for (number, leg) in self.legs.iter().enumerate() {
            let branches = self.modes.branches(mode, number);
            let near = revolutions.near(out.taus[number], 0.0);
            match leg.solve(&self.task, [&v, &b], rise, branches, near) {
                Ok(solution) => self.write(number, &solution, out, revolutions),
                Err((section, deficit)) => {
                    out.unreachable.push(Unreachable { leg: number, section, deficit });
                }
            }
        }
        if self.task.height.is_some() {
            self.write_lifts(out);
        }
    }

    /// Writes the values of the lifts at the pose and the legs' solutions that `out` holds.
    #[inline(never)]
    pub(crate) fn write_lifts(&self, out: &mut Solution) {
        for (number, lift) in self.lifts_of_legs() {
            // The height of a leg that is out of reach is not known where it has one of its own.
            if lift.slope != 0.0 && out.unreachable.iter().any(|missed| missed.leg == number) {
                continue;
            }
            let (value, within) = self.lifted(lift, self.leg_rise(out, number));
            out.joints[lift.coordinate.number] = value;
            out.within_limits &= within;
        }
    }

    /// Writes a leg's solution to `out`, with angles within π of home.
    pub(crate) fn write_leg(&self, number: usize, solution: &LegSolution, out: &mut Solution) {
        self.write(number, solution, out, Revolutions::NearHome);
    }

    /// Writes a leg's solution to `out`.
    #[inline]
    pub(super) fn write(
        &self,
        number: usize,
        solution: &LegSolution,
        out: &mut Solution,
        revolutions: Revolutions,
    ) {
        let leg = &self.legs[number];
        out.legs[number] = *solution;
        self.write_section(&leg.lower, &solution.lower, out, revolutions);
        self.write_section(&leg.upper, &solution.upper, out, revolutions);
        out.taus[number] = solution.tau.nearest(revolutions.near(out.taus[number], 0.0));
        if let Some(imaginary) = leg.imaginary {
            let joint = &self.imaginary[imaginary];
            let near = revolutions.near(out.imaginary[imaginary], joint.home);
            out.imaginary[imaginary] = joint.value(solution.tau, near);
        }
    }

    #[inline]
    fn write_section(
        &self,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
        out: &mut Solution,
        revolutions: Revolutions,
    ) {
        let home = |number: usize| self.coordinates[number].home;
        // Otherwise the rotation vector, at most π long, is the one nearest to zero already.
        if matches!(section.chain, Chain::Ball(_)) && revolutions == Revolutions::NearHeld {
            let first = section.coordinates[0].map_or(0, |coordinate| coordinate.number);
            let near = Vector3::from_fn(|i, _| out.joints[first + i] - home(first + i));
            let vector = nearest_rotation(Vector3::from_fn(|i, _| displacements[i].value()), &near);
            for i in 0..3 {
                out.within_limits &=
                    self.limits[first + i].admits(JointDisplacement::Value(vector[i]));
                out.joints[first + i] = home(first + i) + vector[i];
            }
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            let Some(ChainCoordinate { number, .. }) = *coordinate else { continue };
            let home = home(number);
            let held = (revolutions == Revolutions::NearHeld).then(|| out.joints[number] - home);
            let (value, within) = self.limits[number].place(displacement, held);
            out.joints[number] = home + value;
            out.within_limits &= within;
        }
    }
}

/// How the number of full revolutions of a reported angle is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Revolutions {
    /// The angle is within π of home, or within the limits where that is possible.
    NearHome,
    /// The angle is the one nearest to the value that the buffer holds.
    NearHeld,
}

impl Revolutions {
    #[inline]
    fn near(self, held: f64, home: f64) -> f64 {
        match self {
            Self::NearHome => home,
            Self::NearHeld => held,
        }
    }
}

/// The rotation vector nearest to `reference` among those of the same rotation, which differ by full
/// revolutions.
fn nearest_rotation(vector: Vector3<f64>, reference: &Vector3<f64>) -> Vector3<f64> {
    /// A rotation by a smaller angle is the identity up to rounding, and its axis is arbitrary.
    const NONE: f64 = 1e-14;
    let angle = vector.norm();
    if angle < NONE {
        // Full revolutions about any axis are the identity: the nearest axis is that of the reference.
        let turns = (reference.norm() / TAU).round();
        return if turns == 0.0 { vector } else { reference.normalize() * (TAU * turns) };
    }
    let axis = vector / angle;
    let turns = (reference.dot(&axis) - angle) / TAU;
    // A rotation by π is as near as its opposite: it is not changed.
    if turns.abs() <= 0.5 { vector } else { axis * (angle + TAU * turns.round()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Limits are tested on the vector that the closed form gives, so that the reported one must be the same.
    #[test]
    fn a_rotation_by_pi_is_not_changed() {
        for half in [Vector3::z() * PI, Vector3::z() * -PI] {
            assert_eq!(nearest_rotation(half, &Vector3::zeros()), half);
            assert_eq!(nearest_rotation(half, &half), half);
        }
        let beyond = nearest_rotation(Vector3::z() * (0.1 - PI), &(Vector3::z() * PI));
        assert!((beyond - Vector3::z() * (0.1 + PI)).norm() < 1e-12);
    }

    /// A spherical joint that keeps rotating passes through a full revolution, where its rotation is the
    /// identity.
    #[test]
    fn a_full_revolution_does_not_jump_to_zero() {
        let round = Vector3::new(0.6, 0.0, -0.8) * TAU;
        for rounding in [Vector3::zeros(), Vector3::x() * 1e-16, Vector3::new(0.0, -3e-16, 1e-16)] {
            for before in [round * 0.999, round, round * 1.001, round * -2.0] {
                let turns = (before.dot(&round) / TAU / TAU).round();
                let found = nearest_rotation(rounding, &before);
                assert!((found - round * turns).norm() < 1e-14, "{rounding} {before}: {found}");
            }
            assert_eq!(nearest_rotation(rounding, &(round * 0.4)), rounding);
        }
    }
}
