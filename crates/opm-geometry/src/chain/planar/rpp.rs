//! RPP: a pivot that carries two sliders. The pivot's rotation is that of the target.

use super::{Branch, ChainError, Pivot, PlanarJoint, along, cross};
use crate::chain::region::parallelogram;
use crate::chain::shape::Shape;
use crate::chain::{Attempt, ClosedForm, DEGENERATE};
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// A pivot, then two sliders. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpp {
    pivot: Pivot,
    slides: [Complex<f64>; 2],
}

impl Rpp {
    pub(super) fn new(
        pivot: Pivot,
        d2: Complex<f64>,
        d3: Complex<f64>,
    ) -> Result<Self, ChainError> {
        if cross(d2, d3).abs() <= DEGENERATE {
            return Err(ChainError::Dependent("two sliders are parallel"));
        }
        Ok(Self { pivot, slides: [d2, d3] })
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        let [first, second] = self.slides.map(|along| PlanarJoint::Prismatic { along });
        [self.pivot.joint(), first, second]
    }

    /// The shape in which the chain closes: a parallelogram that rotates with the target. See
    /// [`Shape::backwards`].
    pub(super) fn shape(&self, ranges: [[f64; 2]; 2]) -> Shape {
        // The places of the pivot for the reversed chain: minus the sliders' translation.
        let places = parallelogram(self.slides, self.pivot.at, ranges).turned((-1.0).into());
        Shape::of_places(places, self.pivot.at).backwards()
    }
}

impl ClosedForm for Rpp {
    type Target = PlanarDisplacement;

    #[inline(always)]
    fn attempt(&self, target: &PlanarDisplacement, _: Branch) -> Attempt {
        // The displacement of the outer link's point at the pivot, rotated back to home.
        let moved = target.apply(self.pivot.at) - self.pivot.at;
        let (s2, s3) = along(self.slides[0], self.slides[1], moved * target.rotation.conj());
        let rotation = self.pivot.displacement(target.rotation);
        Attempt::decided(
            [rotation, JointDisplacement::Value(s2), JointDisplacement::Value(s3)],
            true,
        )
    }
}
