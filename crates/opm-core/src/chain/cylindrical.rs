//! Chains of two coaxial joints: revolute, prismatic or helical. Linear, and counting whole turns,
//! since a helical joint does. A revolute joint does not: its displacement is a turn like any other.

use super::surface::Surface;
use super::{Attempt, Branch, ChainError, ClosedForm, DEGENERATE, ReachDeficit};
use crate::group::{CylindricalDisplacement, JointDisplacement};
use crate::numeric::angle::{MOST_REDUCED, sin_cos_reduced};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A joint on the axis: what one unit of its coordinate turns and advances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoaxialJoint {
    /// Radians a unit: ±1 revolute or helical, 0 prismatic.
    pub turn: f64,
    /// Metres a unit: 0 revolute, ±1 prismatic, ± the pitch helical.
    pub advance: f64,
}

impl CoaxialJoint {
    fn is_revolute(&self) -> bool {
        self.turn != 0.0 && self.advance == 0.0
    }
}

/// Two coaxial joints: one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CylindricalChain {
    joints: [CoaxialJoint; 2],
    determinant: f64,
}

impl CylindricalChain {
    /// The closed form of two joints on one axis.
    ///
    /// # Errors
    /// Two of one kind, or two helical joints of one pitch.
    pub fn new(joints: [CoaxialJoint; 2]) -> Result<Self, ChainError> {
        let [p, q] = joints;
        let determinant = p.turn * q.advance - q.turn * p.advance;
        let size = p.advance.abs().max(q.advance.abs());
        if determinant.abs() <= DEGENERATE * size {
            return Err(ChainError::Dependent("two coaxial joints of one pitch"));
        }
        Ok(Self { joints, determinant })
    }

    /// The joints, base first.
    pub fn joints(&self) -> &[CoaxialJoint; 2] {
        &self.joints
    }

    /// Whether targets whole turns apart differ: no revolute joint makes up for a turn.
    pub fn counts_turns(&self) -> bool {
        !self.joints.iter().any(CoaxialJoint::is_revolute)
    }

    /// Which joint does not count whole turns; two do not, or the chain is none.
    #[inline]
    pub(crate) fn revolute(&self) -> Option<usize> {
        self.joints.iter().position(CoaxialJoint::is_revolute)
    }

    /// Whether an displacement of a joint is a turn.
    pub(super) fn is_rotation(&self, joint: usize) -> bool {
        self.joints[joint].is_revolute()
    }

    /// The targets with joint number `joint` at `displacement`: those of [`CylindricalChain::inverse`].
    pub(super) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let [p, q] = self.joints;
        let (turn, advance) = if joint == 0 { (q.advance, -q.turn) } else { (-p.advance, p.turn) };
        let period = self.is_rotation(joint).then_some(TAU * self.determinant);
        Surface::Coaxial { turn, advance, at: displacement.value() * self.determinant, period }
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

    /// The joints' coordinates, those of revolute joints too with whole turns.
    #[inline(always)]
    fn coordinates(&self, target: &CylindricalDisplacement) -> [f64; 2] {
        let [p, q] = self.joints;
        let first = (target.angle * q.advance - q.turn * target.advance) / self.determinant;
        let second = (p.turn * target.advance - target.angle * p.advance) / self.determinant;
        [first, second]
    }

    /// The displacement of the outer link; its whole turns are those that the displacements hold.
    pub fn forward(&self, displacements: &[JointDisplacement; 2]) -> CylindricalDisplacement {
        let [p, q] = self.joints;
        let [a, b] = displacements.map(JointDisplacement::value);
        CylindricalDisplacement {
            angle: p.turn * a + q.turn * b,
            advance: p.advance * a + q.advance * b,
        }
    }
}

/// The closed form with the revolute joint's number as a constant, past the last one where none is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WithRevolute<const NUMBER: usize>(pub CylindricalChain);

impl<const NUMBER: usize> ClosedForm for WithRevolute<NUMBER> {
    type Target = CylindricalDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &CylindricalDisplacement, _: Branch) -> Attempt {
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
    fn exception(
        &self,
        target: &CylindricalDisplacement,
        _: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let [first, second] = self.0.inverse(target);
        Ok([first, second, JointDisplacement::Value(0.0)])
    }
}
