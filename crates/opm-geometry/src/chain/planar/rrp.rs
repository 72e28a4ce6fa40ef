//! RRP: a link whose outer pivot carries a slider. In reverse order it is a PRR.

use super::{Branch, ChainError, Pivot, PlanarJoint, Prr, ReachDeficit};
use crate::chain::limits::Limits;
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm};
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// A link between two pivots, then a slider. Its branch `+` is the branch `+` of the reversed chain, a PRR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrp(Prr);

impl Rrp {
    pub(super) fn new(p1: Pivot, p2: Pivot, slide: Complex<f64>) -> Result<Self, ChainError> {
        Prr::new(slide, p2, p1).map(Self)
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        let [third, second, first] = self.0.joints();
        [first, second, third]
    }

    /// The shape in which the chain closes: that of the PRR, reversed.
    pub(super) fn shape(
        &self,
        branch: Branch,
        [low, high]: [f64; 2],
        [first, second]: [&Limits; 2],
    ) -> Shape {
        let [_, inner, outer] = self.0.joints().map(|joint| joint.is_reversed());
        // The displacements are the inverses.
        self.0.places(branch, [-high, -low], [(second, !inner), (first, !outer)]).backwards()
    }
}

impl ClosedForm for Rrp {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, branch: Branch) -> Attempt {
        self.0.attempt(&target.inverse(), branch).backwards()
    }

    #[cold]
    fn exception(
        &self,
        target: &PlanarDisplacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        self.0.exception(&target.inverse(), branch)
    }
}
