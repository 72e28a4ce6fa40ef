//! PPR: two sliders that carry a pivot. Seen from its end it is an RPP.

use super::{Amount, ChainError, Pivot, PlanarDisplacement, PlanarJoint, Rpp};
use crate::chain::region::Region;
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

    /// `(E₁E₂E₃)⁻¹ = E₃⁻¹E₂⁻¹E₁⁻¹`: the joints backwards, each amount with the other sign.
    #[inline]
    pub(super) fn inverse(&self, target: &PlanarDisplacement) -> [Amount; 3] {
        let [a3, a2, a1] = self.0.inverse(&target.inverse());
        [a1.inverse(), a2.inverse(), a3.inverse()]
    }
}
