//! PRP: a pivot between two sliders. The pivot's rotation is that of the target.

use super::{
    Attempt, ClosedForm, Closes, Exception, Joint, Over, Pivot, PlanarJoint, Plane, REACH, Truth,
};
use crate::chain::DEGENERATE;
use crate::chain::region::{Region, parallelogram};
use crate::chain::shape::Shape;
use crate::group::PlanarDisplacement;
use crate::numbers::PlaneOver;
use nalgebra::Complex;

/// A slider, a pivot and a slider. A target has one solution; where the two sliders become parallel, it has
/// none or infinitely many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prp<Z: Plane = Complex<f64>> {
    slides: [Z; 2],
    pivot: Pivot<Z>,
}

impl<Z: Plane> Prp<Z> {
    pub(super) fn new(d1: Z, pivot: Pivot<Z>, d3: Z) -> Self {
        Self { slides: [d1, d3], pivot }
    }

    /// The joints, from base to platform.
    pub fn joints(&self) -> [PlanarJoint<Z>; 3] {
        let [first, second] = self.slides.map(|along| PlanarJoint::Prismatic { along });
        [first, self.pivot.joint(), second]
    }

    pub(super) fn regular(&self) -> [Closes<Z::Real>; 2] {
        [Closes::Always; 2]
    }

    /// The displacement of the outer link's point at the pivot, which the sliders have to make, and their directions.
    #[inline(always)]
    fn parts<T: Over<Z::Real>>(&self, target: &PlanarDisplacement<T::Plane>) -> [T::Plane; 3] {
        let moved = (target.apply(self.pivot.at) - self.pivot.at).named("moved");
        let [d1, d3] = self.slides;
        [moved, T::Plane::from_constant(d1), (target.rotation * d3).named("turned")]
    }
}

impl Prp {
    /// The shape in which the chain closes: a parallelogram of which one side rotates with the target.
    pub(super) fn shape(&self, ranges: [[f64; 2]; 2]) -> Shape {
        Shape::sheared(*self, ranges)
    }

    /// The parallelogram for a rotation of the target; `None` where the sliders become nearly parallel.
    pub(in crate::chain) fn region(
        &self,
        rotation: Complex<f64>,
        ranges: [[f64; 2]; 2],
    ) -> Option<Region> {
        let slides = [self.slides[0], rotation * self.slides[1]];
        let offset = rotation * self.pivot.at - self.pivot.at;
        let crossing = slides[0].cross(slides[1]).abs() > DEGENERATE;
        crossing.then(|| parallelogram(slides, offset, ranges))
    }
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for Prp<Z> {
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, _: T::Sign) -> Attempt<T> {
        let [moved, first, second] = self.parts::<T>(target);
        let holds = first.cross(second).exceeds(REACH).checked();
        let [s1, s3] = moved.along(first, second);
        let rotation = self.pivot.displacement::<T>(target.rotation);
        let displacements = [T::Joint::value(s1), rotation, T::Joint::value(s3)];
        Attempt { displacements, holds, beyond: T::Truth::NO }
    }

    /// With the sliders parallel, only targets on one line are in reach, and the two displacements are known
    /// only by their sum: the inner slider is then given all of it.
    #[cold]
    fn exception(&self, target: &Self::Target, _: T::Sign) -> Exception<T> {
        let [moved, first, _] = self.parts::<T>(target);
        let aside = first.cross(moved).absolute().named("aside");
        let on_the_line = moved.length().share(REACH, 1.0).at_least(aside);
        let rotation = self.pivot.displacement::<T>(target.rotation);
        let along = T::Joint::value(moved.inner(first));
        let displacements = [along, rotation, T::Joint::value(T::constant(0.0))];
        Exception { special: Some((on_the_line, displacements)), ..Exception::length(aside) }
    }

    /// Everywhere except where the sliders become parallel.
    fn closes(&self, target: &Self::Target) -> Closes<T> {
        let [_, first, second] = self.parts::<T>(target);
        Closes::Exceeds(first.cross(second), REACH)
    }
}
