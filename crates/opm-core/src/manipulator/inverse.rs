//! Inverse kinematics in one working mode: of all joints, or of the actuated ones alone.
//!
//! Every function here has the same convention. It takes a pose and a buffer that a method of
//! [`Manipulator`] made, and returns what it wrote to the buffer: `Ok(Some(solution))`. For a pose out of
//! reach it returns `Ok(None)`, and the buffer tells which legs do not reach it. An error means that the
//! pose is not valid. Nothing allocates.

use super::angles::Angles;
use super::leg::{LegSolution, Section};
use super::pose::PoseError;
use super::section::{ChainCoordinate, CompiledSection};
use super::solution::{ActuatedJoints, Solution, Unreachable};
use super::{Manipulator, Mode};
use crate::chain::Chain;
use crate::group::{Displacement, JointDisplacement, nearest};
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};
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
        if let Some(dependent) = &self.dependent {
            let all = &mut buffer.all;
            if dependent.complete_from_home(self, mode, pose, all).is_err() {
                return Ok(None);
            }
        }
        let reached = self.arch.dispatch(SolveActuated { manipulator: self, pose, mode, buffer });
        Ok(reached.then_some(buffer))
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
                let (leg, mut found) = (&self.legs[number], LegSolution::HOME);
                if leg.solve_actuated(&self.task, pose, rise, branches, &mut found).is_ok() {
                    rise = self.task.rise_of_leg(rise, found.tau);
                }
            }
            let (value, within) = self.lifted(lift, rise);
            out.within_limits &= within;
            if let Some(actuated) = lift.coordinate.actuated {
                out.actuated[actuated] = value;
            }
        }
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

    /// Writes the values of all joints after [`Manipulator::close`], angles within half a revolution of home.
    pub(crate) fn write_closed(&self, out: &mut Solution) {
        self.arch.dispatch(WriteClosed { manipulator: self, out });
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

    /// Writes the values of a section's actuated joints, or asks for their angles.
    #[inline(always)]
    fn write_actuated<'a>(
        section: &'a CompiledSection,
        displacements: &[JointDisplacement; 3],
        out: &mut ActuatedJoints,
        angles: &mut Angles<AngleOf<'a>>,
    ) {
        out.within_limits &= section.admits(displacements);
        if !section.driven {
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            if let Some(joint @ ChainCoordinate { actuated: Some(actuated), .. }) = coordinate {
                match displacement {
                    JointDisplacement::Value(value) => {
                        out.actuated[*actuated] = joint.home + value;
                    }
                    JointDisplacement::Direction(e) => angles.ask(AngleOf::Joint(joint), e),
                }
            }
        }
    }

    /// Takes an angle that was asked for.
    #[inline(always)]
    fn take_actuated(&self, of: AngleOf<'_>, angle: f64, out: &mut ActuatedJoints) {
        match of {
            AngleOf::Joint(joint) => {
                if let Some(actuated) = joint.actuated {
                    out.actuated[actuated] = joint.home + joint.limits.report_angle(angle);
                }
            }
            AngleOf::Leg(leg) => {
                if let Some(imaginary) = self.legs[leg].imaginary {
                    let joint = &self.imaginary[imaginary];
                    out.imaginary[imaginary] = joint.home + joint.sign * angle;
                }
            }
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
                unreachable.push(Unreachable { leg: number, section, deficit });
            }
        }
    }

    /// Writes the joints of all legs, whose solutions `out` holds, with angles within π of home.
    #[inline(always)]
    fn write_legs(&self, out: &mut Solution) {
        let mut angles = Angles::new(AngleOf::Leg(0));
        for number in 0..self.legs.len() {
            self.write(number, out, Revolutions::NearHome, &mut angles);
        }
        angles.answer(|of, angle| self.take(of, angle, out, Revolutions::NearHome));
    }

    /// Does the same where the values of every leg's lower joints are known.
    #[inline(always)]
    pub(crate) fn write_upper_sections<'a>(
        &self,
        lower: impl Iterator<Item = &'a LowerValues>,
        out: &mut Solution,
    ) {
        let home = Revolutions::NearHome;
        let mut angles = Angles::new(AngleOf::Leg(0));
        for ((number, leg), known) in self.legs.iter().enumerate().zip(lower) {
            angles.make_room(|of, angle| self.take(of, angle, out, home));
            for (coordinate, value) in leg.lower.coordinates.iter().zip(known.joints) {
                if let Some(joint) = coordinate {
                    out.joints[joint.number] = value;
                }
            }
            out.within_limits &= known.within_limits;
            self.take_tau(number, known.tau, out);
            Self::write_section(&leg.upper, (number, Section::Upper), out, home, &mut angles);
        }
        angles.answer(|of, angle| self.take(of, angle, out, home));
    }

    /// The values of a leg's lower joints with these displacements, and of τ, with angles within π of home.
    pub(crate) fn lower_values(
        &self,
        number: usize,
        lower: &[JointDisplacement; 3],
        tau: JointDisplacement,
    ) -> LowerValues {
        let mut values = LowerValues { joints: [0.0; 3], tau: tau.value(), within_limits: true };
        let section = &self.legs[number].lower;
        for (i, joint) in section.coordinates.iter().enumerate() {
            let Some(joint) = joint else { continue };
            values.joints[i] = joint.home
                + match lower[i] {
                    JointDisplacement::Value(value) => value,
                    angle @ JointDisplacement::Direction(_) => {
                        joint.limits.report_angle(angle.value())
                    }
                };
            values.within_limits &= joint.limits.admits(lower[i]);
        }
        values
    }

    /// Takes a leg's displacement along the intersection motion as a number.
    #[inline(always)]
    fn take_tau(&self, leg: usize, tau: f64, out: &mut Solution) {
        out.taus[leg] = tau;
        if let Some(imaginary) = self.legs[leg].imaginary {
            let joint = &self.imaginary[imaginary];
            out.imaginary[imaginary] = joint.home + joint.sign * tau;
        }
    }

    /// Writes the joints of a leg whose solution `out` holds, but for the angles of directions, which it asks for.
    #[inline(always)]
    pub(super) fn write<'a>(
        &'a self,
        number: usize,
        out: &mut Solution,
        revolutions: Revolutions,
        angles: &mut Angles<AngleOf<'a>>,
    ) {
        angles.make_room(|of, angle| self.take(of, angle, out, revolutions));
        let leg = &self.legs[number];
        for section in [Section::Lower, Section::Upper] {
            Self::write_section(leg.section(section), (number, section), out, revolutions, angles);
        }
        match out.legs[number].tau {
            JointDisplacement::Direction(e) => angles.ask(AngleOf::Leg(number), e),
            JointDisplacement::Value(value) => self.take_tau(number, value, out),
        }
    }

    #[inline(always)]
    fn write_section<'a>(
        section: &'a CompiledSection,
        (leg, of_leg): (usize, Section),
        out: &mut Solution,
        revolutions: Revolutions,
        angles: &mut Angles<AngleOf<'a>>,
    ) {
        let Solution { joints, legs, within_limits, .. } = out;
        let displacements = legs[leg].section(of_leg);
        // Otherwise the rotation vector, at most π long, is the one nearest to zero already.
        if matches!(section.chain, Chain::Ball(_)) && revolutions == Revolutions::NearHeld {
            *within_limits &= write_ball_near(section, displacements, joints);
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            let Some(joint) = coordinate else { continue };
            match displacement {
                JointDisplacement::Value(value) => joints[joint.number] = joint.home + value,
                JointDisplacement::Direction(e) => angles.ask(AngleOf::Joint(joint), e),
            }
            // The angle nearest to what the buffer holds is tested when it is known.
            let known = matches!(displacement, JointDisplacement::Value(_));
            if known || revolutions == Revolutions::NearHome {
                *within_limits &= joint.limits.admits(displacement);
            }
        }
    }

    /// Takes an angle that was asked for.
    #[inline(always)]
    pub(super) fn take(
        &self,
        of: AngleOf<'_>,
        angle: f64,
        out: &mut Solution,
        revolutions: Revolutions,
    ) {
        match of {
            AngleOf::Joint(joint) => {
                let value = match revolutions {
                    Revolutions::NearHome => joint.limits.report_angle(angle),
                    Revolutions::NearHeld => {
                        let value = nearest(angle, out.joints[joint.number] - joint.home);
                        out.within_limits &= joint.limits.admits(JointDisplacement::Value(value));
                        value
                    }
                };
                out.joints[joint.number] = joint.home + value;
            }
            AngleOf::Leg(leg) => {
                out.taus[leg] = revolutions.place(angle, out.taus[leg]);
                if let Some(imaginary) = self.legs[leg].imaginary {
                    let joint = &self.imaginary[imaginary];
                    let held = joint.displacement(out.imaginary[imaginary]);
                    let value = revolutions.place(angle, held);
                    out.imaginary[imaginary] = joint.home + joint.sign * value;
                }
            }
        }
    }
}

/// The values of a leg's lower joints, radians and metres; zero for what is no joint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LowerValues {
    joints: [f64; 3],
    /// The leg's displacement along the intersection motion.
    tau: f64,
    within_limits: bool,
}

/// What an angle is that was asked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum AngleOf<'a> {
    /// A joint's displacement from home.
    Joint(&'a ChainCoordinate),
    /// The displacement along the intersection motion of the leg with this number.
    Leg(usize),
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

/// The joints of legs that are closed, with the instructions of the processor at hand.
struct WriteClosed<'a> {
    manipulator: &'a Manipulator,
    out: &'a mut Solution,
}

impl WithSimd for WriteClosed<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.manipulator.write_legs(self.out);
    }
}

/// The actuated and the imaginary joints at a pose, with the instructions of the processor at hand. Where coordinates of
/// the pose are dependent, the buffer has all of them. The output is whether the pose is in reach.
struct SolveActuated<'a> {
    manipulator: &'a Manipulator,
    pose: &'a [f64],
    mode: Mode,
    buffer: &'a mut ActuatedJoints,
}

impl WithSimd for SolveActuated<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { manipulator, pose, mode, buffer: out } = self;
        let task = &manipulator.task;
        let pose = if manipulator.dependent.is_none() { pose } else { &out.all };
        let ((v, b), rise) = (task.sections(pose), task.rise(pose));
        out.within_limits = true;
        let mut angles = Angles::new(AngleOf::Leg(0));
        for (number, leg) in manipulator.legs.iter().enumerate() {
            angles.make_room(|of, angle| manipulator.take_actuated(of, angle, out));
            let branches = manipulator.modes.branches(mode, number);
            let mut found = LegSolution::HOME;
            if leg.upper_constrains {
                if leg.solve_in(task, [&v, &b], rise, branches, 0.0, &mut found).is_err() {
                    return false;
                }
                Manipulator::write_actuated(&leg.upper, &found.upper, out, &mut angles);
            } else if leg.solve_actuated(task, [&v, &b], rise, branches, &mut found).is_err() {
                return false;
            }
            Manipulator::write_actuated(&leg.lower, &found.lower, out, &mut angles);
            if let Some(imaginary) = leg.imaginary {
                match found.tau {
                    JointDisplacement::Direction(e) => angles.ask(AngleOf::Leg(number), e),
                    JointDisplacement::Value(value) => {
                        let joint = &manipulator.imaginary[imaginary];
                        out.imaginary[imaginary] = joint.home + joint.sign * value;
                    }
                }
            }
        }
        angles.answer(|of, angle| manipulator.take_actuated(of, angle, out));
        if task.height.is_some() {
            manipulator.write_actuated_lifts(mode, [&v, &b], rise, out);
        }
        true
    }
}

/// Writes the rotation vector of a spherical joint that is nearest to the values that are there. Returns whether it is
/// within its limits.
fn write_ball_near(
    section: &CompiledSection,
    displacements: &[JointDisplacement; 3],
    joints: &mut [f64],
) -> bool {
    let [Some(x), Some(y), Some(z)] = &section.coordinates else { return true };
    let own = [x, y, z];
    let near = Vector3::from_fn(|i, _| joints[own[i].number] - own[i].home);
    let vector = nearest_rotation(Vector3::from_fn(|i, _| displacements[i].value()), &near);
    let mut within = true;
    for (joint, &value) in own.into_iter().zip(&vector) {
        within &= joint.limits.admits(JointDisplacement::Value(value));
        joints[joint.number] = joint.home + value;
    }
    within
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
    #[inline(always)]
    fn near(self, held: f64, home: f64) -> f64 {
        match self {
            Self::NearHome => home,
            Self::NearHeld => held,
        }
    }

    /// An angle within π of home, or the same one nearest to the displacement that the buffer holds.
    #[inline(always)]
    fn place(self, angle: f64, held: f64) -> f64 {
        match self {
            Self::NearHome => angle,
            Self::NearHeld => nearest(angle, held),
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
