//! PRP: a pivot between two sliders. The target's rotation is the pivot's.

use super::{Amount, Gap, Pivot, PlanarDisplacement, PlanarJoint, along, cross};
use crate::chain::region::{Region, parallelogram};
use crate::chain::{DEGENERATE, RIM};
use nalgebra::Complex;

/// A slider, a pivot and a slider: one solution, none where the two slides come to be parallel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prp {
    slides: [Complex<f64>; 2],
    pivot: Pivot,
}

impl Prp {
    pub(super) fn new(d1: Complex<f64>, pivot: Pivot, d3: Complex<f64>) -> Self {
        Self { slides: [d1, d3], pivot }
    }

    pub(super) fn joints(&self) -> [PlanarJoint; 3] {
        let [first, second] = self.slides.map(|along| PlanarJoint::Prismatic { along });
        [first, self.pivot.joint(), second]
    }

    /// A parallelogram; `None` where the slides come to be all but parallel.
    pub(super) fn region(&self, rotation: Complex<f64>, ranges: [[f64; 2]; 2]) -> Option<Region> {
        let slides = [self.slides[0], rotation * self.slides[1]];
        let offset = rotation * self.pivot.at - self.pivot.at;
        let crossing = cross(slides[0], slides[1]).abs() > DEGENERATE;
        crossing.then(|| parallelogram(slides, offset, ranges))
    }

    /// The pivot's amount for a target that is turned by `rotation`.
    pub(super) fn turn(&self, rotation: Complex<f64>) -> Amount {
        self.pivot.amount(rotation)
    }

    #[inline]
    pub(super) fn inverse(&self, target: &PlanarDisplacement) -> Result<[Amount; 3], Gap> {
        let turned = target.rotation * self.slides[1];
        let moved = target.apply(self.pivot.at) - self.pivot.at;
        // With the slides parallel only one line is in reach, and on it the sliders are free: they
        // are then given as the inner one alone.
        if cross(self.slides[0], turned).abs() <= RIM {
            let aside = cross(self.slides[0], moved).abs();
            if aside.is_nan() || aside > RIM * moved.norm() {
                return Err(Gap::length(aside));
            }
            let along = (moved * self.slides[0].conj()).re;
            let values = [Amount::Value(along), Amount::Value(0.0)];
            return Ok([values[0], self.pivot.amount(target.rotation), values[1]]);
        }
        let (s1, s3) = along(self.slides[0], turned, moved);
        Ok([Amount::Value(s1), self.pivot.amount(target.rotation), Amount::Value(s3)])
    }
}
