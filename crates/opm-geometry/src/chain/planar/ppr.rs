//! PPR: two sliders that carry a pivot. In reverse order it is an RPP.

use super::{Branch, ChainError, Pivot, PlanarJoint, Rpp};
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm};
use crate::group::PlanarDisplacement;
use nalgebra::Complex;

/// Two sliders, then a pivot. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ppr(Rpp);

impl Ppr {
    pub(super) fn new(
        d1: Complex<f64>,
        d2: Complex<f64>,
        pivot: Pivot,
    ) -> Result<Self, ChainError> {
        Rpp::new(pivot, d2, d1).map(Self)
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        let [third, second, first] = self.0.joints();
        [first, second, third]
    }

    /// The shape in which the chain closes: that of the RPP, reversed.
    pub(super) fn shape(&self, [first, second]: [[f64; 2]; 2]) -> Shape {
        let backwards = |[low, high]: [f64; 2]| [-high, -low];
        self.0.shape([backwards(second), backwards(first)]).backwards()
    }
}

impl ClosedForm for Ppr {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, branch: Branch) -> Attempt {
        self.0.attempt(&target.inverse(), branch).backwards()
    }
}
