//! Chains of two prismatic joints in a plane.

use super::region::parallelogram;
use super::shape::Shape;
use super::surface::Surface;
use super::{Attempt, ChainError, ClosedForm, DEGENERATE};
use crate::chain::limits::Limits;
use crate::group::JointDisplacement;
use crate::numbers::{Joint, Over, Plane, PlaneOver, Truth};
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
        if Plane::cross(u, v).abs() <= DEGENERATE {
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
        let Attempt { displacements: [first, second, _], .. } =
            ClosedForm::<f64>::attempt(self, &target, 1.0);
        [first, second]
    }

    /// The translation of the outer link.
    pub fn forward(&self, displacements: &[JointDisplacement; 2]) -> Complex<f64> {
        self.slides[0] * displacements[0].value() + self.slides[1] * displacements[1].value()
    }
}

impl<T: Over<f64>> ClosedForm<T> for TranslationalChain {
    type Target = T::Plane;

    #[inline(always)]
    fn attempt(&self, target: &T::Plane, _: T::Sign) -> Attempt<T> {
        let [first, second] = self.slides;
        let [first, second] = target.along_constants(first, second);
        Attempt::decided([first, second, T::constant(0.0)].map(T::Joint::value), T::Truth::YES)
    }
}
