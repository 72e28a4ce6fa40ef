//! RPP: a pivot that carries two sliders. The pivot's rotation is that of the target.

use super::{Attempt, ClosedForm, Closes, Joint, Over, Pivot, PlanarJoint, Plane, Truth};
use crate::chain::region::parallelogram;
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use crate::numbers::{DEGENERATE, PlaneOver};
use nalgebra::Complex;

/// A pivot, then two sliders. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpp<Z: Plane = Complex<f64>> {
    pivot: Pivot<Z>,
    slides: [Z; 2],
}

impl<Z: Plane> Rpp<Z> {
    pub(super) fn new(pivot: Pivot<Z>, d2: Z, d3: Z) -> Self {
        Self { pivot, slides: [d2, d3] }
    }

    pub(super) fn joints(&self) -> [PlanarJoint<Z>; 3] {
        let [first, second] = self.slides.map(|along| PlanarJoint::Prismatic { along });
        [self.pivot.joint(), first, second]
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        let [d2, d3] = self.slides;
        [Closes::Exceeds(d2.cross(d3), DEGENERATE), Closes::Always]
    }
}

impl Rpp {
    /// The shape in which the chain closes: a parallelogram that rotates with the target. See
    /// [`Shape::backwards`].
    pub(super) fn shape(&self, ranges: [[f64; 2]; 2]) -> Shape {
        // The places of the pivot for the reversed chain: minus the sliders' translation.
        let places = parallelogram(self.slides, self.pivot.at, ranges).turned((-1.0).into());
        Shape::of_places(places, self.pivot.at).backwards()
    }
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Rpp<Z> {
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, _: T::Sign) -> Attempt<T> {
        // The displacement of the outer link's point at the pivot, rotated back to home.
        let moved = target.apply(self.pivot.at) - self.pivot.at;
        let [d2, d3] = self.slides;
        let [s2, s3] = (moved * target.rotation.conj()).along_constants(d2, d3);
        let rotation = self.pivot.displacement::<T>(target.rotation);
        Attempt::decided([rotation, T::Joint::value(s2), T::Joint::value(s3)], T::Truth::YES)
    }
}
