//! RRP: a link whose outer pivot carries a slider. In reverse order it is a PRR.

use super::{Attempt, Branch, ClosedForm, Closes, Exception, Over, Pivot, PlanarJoint, Plane, Prr};
use crate::chain::limits::Limits;
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use nalgebra::Complex;

/// A link between two pivots, then a slider. Its branch `+` is the branch `+` of the reversed chain, a PRR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrp<Z: Plane = Complex<f64>>(Prr<Z>);

impl<Z: Plane> Rrp<Z> {
    pub(super) fn new(p1: Pivot<Z>, p2: Pivot<Z>, slide: Z) -> Self {
        Self(Prr::new(slide, p2, p1))
    }

    pub(super) fn joints(&self) -> [PlanarJoint<Z>; 3] {
        let [third, second, first] = self.0.joints();
        [first, second, third]
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        self.0.regular()
    }
}

impl Rrp {
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

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Rrp<Z> {
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, sign: T::Sign) -> Attempt<T> {
        ClosedForm::<T>::attempt(&self.0, &target.inverse(), sign).backwards()
    }

    #[cold]
    fn exception(&self, target: &Self::Target, sign: T::Sign) -> Exception<T> {
        ClosedForm::<T>::exception(&self.0, &target.inverse(), sign).backwards()
    }

    fn closes(&self, target: &Self::Target) -> Closes<T> {
        ClosedForm::<T>::closes(&self.0, &target.inverse())
    }
}
