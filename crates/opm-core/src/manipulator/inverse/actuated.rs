//! Inverse kinematics of the actuated and the imaginary joints alone.

use super::values::AngleOf;
use crate::group::{Displacement, JointDisplacement};
use crate::manipulator::angles::Angles;
use crate::manipulator::leg::LegSolution;
use crate::manipulator::pose::PoseError;
use crate::manipulator::section::{ChainCoordinate, CompiledSection};
use crate::manipulator::solution::ActuatedJoints;
use crate::manipulator::{Manipulator, Mode};
use pulp::{Simd, WithSimd};

impl Manipulator {
    /// The actuated and the imaginary joints alone at a pose in one working mode; `None`
    /// where the pose is out of reach. Angles are within half a revolution of home. Where differences of joints have limits, all
    /// joints are computed, which allocates.
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
        if !self.differences.is_empty() {
            let mut solution = self.solution();
            let Some(found) = self.inverse(pose, mode, &mut solution)? else { return Ok(None) };
            let of_actuated = buffer.actuated.iter_mut().zip(&self.actuated);
            of_actuated.for_each(|(value, &number)| *value = found.joints()[number]);
            buffer.imaginary.copy_from_slice(found.imaginary());
            buffer.within_limits = found.within_limits();
            return Ok(Some(buffer));
        }
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
            if let Some(joint) = coordinate {
                Self::write_actuated_joint(joint, displacement, out, angles);
            }
        }
    }

    /// Writes the value of a joint if it is actuated, or asks for its angle.
    #[inline(always)]
    fn write_actuated_joint<'a>(
        joint: &'a ChainCoordinate,
        displacement: JointDisplacement,
        out: &mut ActuatedJoints,
        angles: &mut Angles<AngleOf<'a>>,
    ) {
        let Some(actuated) = joint.actuated else { return };
        match displacement {
            JointDisplacement::Value(value) => out.actuated[actuated] = joint.home + value,
            JointDisplacement::Direction(e) => angles.ask(AngleOf::Joint(joint), e),
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
            if let Some(between) = leg.whole.as_ref().and_then(|whole| whole.between.as_ref()) {
                out.within_limits &= between.limits.admits(found.tau);
                Manipulator::write_actuated_joint(between, found.tau, out, &mut angles);
            }
            out.within_limits &= leg.within_cones(&found);
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
