//! PPR: two sliders that carry a pivot. Seen from its end it is an RPP.

use super::{Branch, ChainError, Pivot, PlanarDisplacement, PlanarJoint, Rpp};
use crate::chain::region::Region;
use crate::chain::{Attempt, ClosedForm};
use nalgebra::Complex;

/// Two sliders, then a pivot: one solution.
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

    /// The region of the RPP, for targets backwards: `t ↦ -conj(r) t`.
    pub(super) fn region(&self, rotation: Complex<f64>, [first, second]: [[f64; 2]; 2]) -> Region {
        let backwards = |[low, high]: [f64; 2]| [-high, -low];
        let region = self.0.region(rotation.conj(), [backwards(second), backwards(first)]);
        region.turned(-rotation)
    }
}

impl ClosedForm for Ppr {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, branch: Branch) -> Attempt {
        self.0.attempt(&target.inverse(), branch).backwards()
    }
}
