//! Chains of two prismatic joints in a plane.

use super::planar::{along, cross};
use super::region::parallelogram;
use super::shape::Shape;
use super::surface::Surface;
use super::{Attempt, Branch, ChainError, ClosedForm, DEGENERATE};
use crate::chain::limits::Limits;
use crate::group::JointDisplacement;
use nalgebra::Complex;

/// Two sliders in a plane. A target has one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslationalChain {
    slides: [Complex<f64>; 2],
}

impl TranslationalChain {
    /// The closed form of two sliders along these unit directions.
    ///
    /// # Errors
    /// The sliders are parallel.
    pub fn new(slides: [Complex<f64>; 2]) -> Result<Self, ChainError> {
        let [u, v] = slides;
        if cross(u, v).abs() <= DEGENERATE {
            return Err(ChainError::Dependent("two sliders are parallel"));
        }
        Ok(Self { slides })
    }

    /// The sliders' unit directions, base first.
    pub fn slides(&self) -> &[Complex<f64>; 2] {
        &self.slides
    }

    /// The translations at which the sliders are in their ranges.
    #[doc(hidden)]
    pub fn shape(&self, limits: [&Limits; 3]) -> Shape {
        let ranges = [0, 1].map(|slider| limits[slider].range().into());
        Shape::of_places(parallelogram(self.slides, Complex::ZERO, ranges), Complex::ZERO)
    }

    /// The targets at which slider number `joint` is held at `displacement`, measured across the other slider.
    pub(super) fn held(&self, joint: usize, displacement: JointDisplacement) -> Surface {
        let across = self.slides[1 - joint] * Complex::i();
        let slide = self.slides[joint];
        Surface::Band { across, at: displacement.value() * (across.conj() * slide).re }
    }

    /// The sliders' displacements that translate the outer link by `target`, metres.
    #[inline(always)]
    pub fn inverse(&self, target: Complex<f64>) -> [JointDisplacement; 2] {
        let (first, second) = along(self.slides[0], self.slides[1], target);
        [JointDisplacement::Value(first), JointDisplacement::Value(second)]
    }

    /// The translation of the outer link.
    pub fn forward(&self, displacements: &[JointDisplacement; 2]) -> Complex<f64> {
        self.slides[0] * displacements[0].value() + self.slides[1] * displacements[1].value()
    }
}

impl ClosedForm for TranslationalChain {
    type Target = Complex<f64>;

    #[inline(always)]
    fn attempt(&self, target: &Complex<f64>, _: Branch) -> Attempt {
        let [first, second] = self.inverse(*target);
        Attempt::decided([first, second, JointDisplacement::Value(0.0)], true)
    }
}
