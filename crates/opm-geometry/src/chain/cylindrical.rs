//! Chains of two coaxial joints: revolute, prismatic or helical. The closed form is linear. Targets count
//! full revolutions, since a helical joint does; a revolute joint does not, and its displacement is a
//! direction.

use super::surface::Surface;
use super::{Attempt, ChainError, ClosedForm, DEGENERATE, Exception};
use crate::group::{CylindricalDisplacement, JointDisplacement};
use crate::numbers::{Over, Real};
use crate::numeric::angle::{MOST_REDUCED, sin_cos_reduced};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A joint on the axis: the rotation and the advance that one unit of its coordinate makes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoaxialJoint<C = f64> {
    /// The rotation, radians per unit: ±1 for a revolute or helical joint, 0 for a prismatic one.
    pub rotation: C,
    /// The advance, metres per unit: 0 for a revolute joint, ±1 for a prismatic one, ± the pitch for a helical
    /// one.
    pub advance: C,
}

impl CoaxialJoint {
    fn is_revolute(&self) -> bool {
        self.rotation != 0.0 && self.advance == 0.0
    }
}

/// Two coaxial joints. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylindricalChain<C = f64> {
    joints: [CoaxialJoint<C>; 2],
    determinant: C,
}

impl<C: Real> CylindricalChain<C> {
    /// The closed form of two joints on one axis that are independent.
    pub fn of(joints: [CoaxialJoint<C>; 2]) -> Self {
        let [p, q] = joints;
        Self { joints, determinant: p.rotation * q.advance - q.rotation * p.advance }
    }

    /// The joints' coordinates; those of revolute joints count revolutions too.
    #[inline(always)]
    pub fn coordinates<T: Over<C>>(&self, target: &CylindricalDisplacement<T>) -> [T; 2] {
        let ([p, q], CylindricalDisplacement { angle, advance }) = (self.joints, *target);
        let first = (angle * q.advance - advance * q.rotation).per(self.determinant);
        [first, (advance * p.rotation - angle * p.advance).per(self.determinant)]
    }
}

impl CylindricalChain {
    /// The closed form of two joints on one axis.
    ///
    /// # Errors
    /// The joints are two revolute joints, two prismatic joints, or two helical joints of the same pitch.
    pub fn new(joints: [CoaxialJoint; 2]) -> Result<Self, ChainError> {
        let chain = Self::of(joints);
        let [p, q] = joints.map(|joint| joint.advance.abs());
        if chain.determinant.abs() <= DEGENERATE * p.max(q) {
            return Err(ChainError::Dependent("two coaxial joints have the same pitch"));
        }
        Ok(chain)
    }

    /// The joints, base first.
    pub fn joints(&self) -> &[CoaxialJoint; 2] {
        &self.joints
    }

    /// Whether targets that are full revolutions apart differ: no revolute joint makes up for a revolution.
    pub fn counts_turns(&self) -> bool {
        !self.joints.iter().any(CoaxialJoint::is_revolute)
    }

    /// The number of the revolute joint, which does not count revolutions. At most one of the two is revolute,
    /// or the chain would be dependent.
    #[inline]
    pub fn revolute(&self) -> Option<usize> {
        self.joints.iter().position(CoaxialJoint::is_revolute)
    }

    /// Whether a joint's displacement is a rotation.
    pub(super) fn is_rotation(&self, joint: usize) -> bool {
        self.joints[joint].is_revolute()
    }

    /// The targets for which [`CylindricalChain::inverse`] gives `displacement` for joint number `joint`.
    pub(super) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let [p, q] = self.joints;
        let (rotation, advance) =
            if joint == 0 { (q.advance, -q.rotation) } else { (-p.advance, p.rotation) };
        let period = self.is_rotation(joint).then_some(TAU * self.determinant);
        Surface::Coaxial { rotation, advance, at: displacement.value() * self.determinant, period }
    }

    /// The joints' displacements that displace the outer link by `target`.
    #[inline]
    pub fn inverse(&self, target: &CylindricalDisplacement) -> [JointDisplacement; 2] {
        let mut displacements = self.coordinates(target).map(JointDisplacement::Value);
        if let Some(revolute) = self.revolute() {
            displacements[revolute] =
                JointDisplacement::Direction(displacements[revolute].unit_direction());
        }
        displacements
    }

    /// The displacement of the outer link, with the revolutions that the joints' displacements count.
    pub fn forward(&self, displacements: &[JointDisplacement; 2]) -> CylindricalDisplacement {
        let [p, q] = self.joints;
        let [a, b] = displacements.map(JointDisplacement::value);
        CylindricalDisplacement {
            angle: p.rotation * a + q.rotation * b,
            advance: p.advance * a + q.advance * b,
        }
    }
}

/// The closed form with the revolute joint's number as a constant; 2 where neither joint is revolute.
#[derive(Clone, Copy, Debug)]
pub struct WithRevolute<const NUMBER: usize>(pub CylindricalChain);

impl<const NUMBER: usize> ClosedForm for WithRevolute<NUMBER> {
    type Target = CylindricalDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &CylindricalDisplacement, _: f64) -> Attempt {
        let [first, second] = self.0.coordinates(target);
        let mut displacements = [first, second, 0.0].map(JointDisplacement::Value);
        let mut reduced = true;
        if NUMBER < 2 {
            let angle = if NUMBER == 0 { first } else { second };
            let (sin, cos) = sin_cos_reduced(angle);
            displacements[NUMBER] = JointDisplacement::Direction(Complex::new(cos, sin));
            reduced = angle.abs() <= MOST_REDUCED;
        }
        Attempt { displacements, holds: reduced, beyond: false }
    }

    #[cold]
    fn exception(&self, target: &CylindricalDisplacement, _: f64) -> Exception {
        let [first, second] = self.0.inverse(target);
        let all = [first, second, JointDisplacement::Value(0.0)];
        Exception { special: Some((true, all)), ..Exception::length(0.0) }
    }
}
