//! The values of all joints, from the displacements that the legs' closed forms give.

use super::revolutions::{Revolutions, write_ball_near};
use crate::group::{JointDisplacement, nearest};
use crate::manipulator::Manipulator;
use crate::manipulator::angles::Angles;
use crate::manipulator::leg::Section;
use crate::manipulator::section::{ChainCoordinate, CompiledSection};
use crate::manipulator::solution::Solution;
use pulp::{Simd, WithSimd};

impl Manipulator {
    /// Writes the values of all joints after [`Manipulator::close`], angles within half a revolution of home.
    pub(crate) fn write_closed(&self, out: &mut Solution) {
        self.arch.dispatch(WriteClosed { manipulator: self, out });
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
    pub(in crate::manipulator) fn write<'a>(
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
        if let Some(whole) = &leg.whole {
            if let Some(between) = &whole.between {
                let Solution { joints, legs, within_limits, .. } = out;
                let tau = legs[number].tau;
                *within_limits &= Self::write_joint(between, tau, joints, revolutions, angles);
            }
            return;
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
        if revolutions == Revolutions::NearHeld && section.is_ball() {
            *within_limits &= write_ball_near(section, displacements, joints);
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            let Some(joint) = coordinate else { continue };
            *within_limits &= Self::write_joint(joint, displacement, joints, revolutions, angles);
        }
    }

    /// Writes the value of a joint, or asks for its angle. Returns whether it is within its limits, as far as that is known.
    #[inline(always)]
    fn write_joint<'a>(
        joint: &'a ChainCoordinate,
        displacement: JointDisplacement,
        joints: &mut [f64],
        revolutions: Revolutions,
        angles: &mut Angles<AngleOf<'a>>,
    ) -> bool {
        match displacement {
            JointDisplacement::Value(value) => joints[joint.number] = joint.home + value,
            JointDisplacement::Direction(e) => angles.ask(AngleOf::Joint(joint), e),
        }
        // The angle nearest to what the buffer holds is tested when it is known.
        let known = matches!(displacement, JointDisplacement::Value(_));
        !(known || revolutions == Revolutions::NearHome) || joint.limits.admits(displacement)
    }

    /// Takes an angle that was asked for.
    #[inline(always)]
    pub(in crate::manipulator) fn take(
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

/// What an angle is that was asked for.
#[derive(Clone, Copy, Debug)]
pub(in crate::manipulator) enum AngleOf<'a> {
    /// A joint's displacement from home.
    Joint(&'a ChainCoordinate),
    /// The displacement along the intersection motion of the leg with this number.
    Leg(usize),
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
