//! PRP: a pivot between two sliders. The pivot's rotation is that of the target.

use super::{Branch, Pivot, PlanarJoint, ReachDeficit, along, cross};
use crate::chain::region::{Region, parallelogram};
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm, DEGENERATE, REACH_TOLERANCE};
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// A slider, a pivot and a slider. A target has one solution; where the two sliders become parallel, it has
/// none or infinitely many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prp {
    slides: [Complex<f64>; 2],
    pivot: Pivot,
}

impl Prp {
    pub(super) fn new(d1: Complex<f64>, pivot: Pivot, d3: Complex<f64>) -> Self {
        Self { slides: [d1, d3], pivot }
    }

    /// The joints, from base to platform.
    pub fn joints(&self) -> [PlanarJoint; 3] {
        let [first, second] = self.slides.map(|along| PlanarJoint::Prismatic { along });
        [first, self.pivot.joint(), second]
    }

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
        let crossing = cross(slides[0], slides[1]).abs() > DEGENERATE;
        crossing.then(|| parallelogram(slides, offset, ranges))
    }

    /// The displacement of the outer link's point at the pivot, which the sliders have to make.
    #[inline(always)]
    fn moved(&self, target: &PlanarDisplacement) -> Complex<f64> {
        target.apply(self.pivot.at) - self.pivot.at
    }
}

impl ClosedForm for Prp {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, _: Branch) -> Attempt {
        let turned = target.rotation * self.slides[1];
        let (s1, s3) = along(self.slides[0], turned, self.moved(target));
        let rotation = self.pivot.displacement(target.rotation);
        let crossing = cross(self.slides[0], turned).abs() > REACH_TOLERANCE;
        let displacements = [JointDisplacement::Value(s1), rotation, JointDisplacement::Value(s3)];
        Attempt { displacements, holds: crossing, beyond: false }
    }

    /// With the sliders parallel, only targets on one line are in reach, and the two displacements are known
    /// only by their sum: the inner slider is then given all of it.
    #[cold]
    fn exception(
        &self,
        target: &PlanarDisplacement,
        _: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let moved = self.moved(target);
        let aside = cross(self.slides[0], moved).abs();
        if aside.is_nan() || aside > REACH_TOLERANCE * moved.norm() {
            return Err(ReachDeficit::length(aside));
        }
        let along = JointDisplacement::Value((moved * self.slides[0].conj()).re);
        Ok([along, self.pivot.displacement(target.rotation), JointDisplacement::Value(0.0)])
    }
}
