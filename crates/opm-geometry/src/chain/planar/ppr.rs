//! PPR: two sliders that carry a pivot. In reverse order it is an RPP.

use super::{Attempt, ClosedForm, Closes, Exception, Over, Pivot, PlanarJoint, Plane, Rpp};
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use nalgebra::Complex;

/// Two sliders, then a pivot. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ppr<Z: Plane = Complex<f64>>(Rpp<Z>);

impl<Z: Plane> Ppr<Z> {
    pub(super) fn new(d1: Z, d2: Z, pivot: Pivot<Z>) -> Self {
        Self(Rpp::new(pivot, d2, d1))
    }

    pub(super) fn joints(&self) -> [PlanarJoint<Z>; 3] {
        let [third, second, first] = self.0.joints();
        [first, second, third]
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        self.0.regular()
    }
}

impl Ppr {
    /// The shape in which the chain closes: that of the RPP, reversed.
    pub(super) fn shape(&self, [first, second]: [[f64; 2]; 2]) -> Shape {
        let backwards = |[low, high]: [f64; 2]| [-high, -low];
        self.0.shape([backwards(second), backwards(first)]).backwards()
    }
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Ppr<Z> {
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
