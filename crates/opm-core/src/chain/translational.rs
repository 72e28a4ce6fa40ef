//! Chains of two prismatic joints in a plane.

use super::{Amount, ChainError, DEGENERATE};
use nalgebra::Complex;

/// Two sliders, each a unit direction of the plane: one solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TranslationalChain {
    slides: [Complex<f64>; 2],
    /// The rows of the inverse of the matrix whose columns are the slides.
    rows: [Complex<f64>; 2],
}

impl TranslationalChain {
    /// The closed form of two sliders.
    ///
    /// # Errors
    /// Where they are parallel.
    pub fn new(slides: [Complex<f64>; 2]) -> Result<Self, ChainError> {
        let [u, v] = slides;
        let area = u.re * v.im - u.im * v.re;
        if area.abs() <= DEGENERATE {
            return Err(ChainError::Dependent("two sliders are parallel"));
        }
        let rows = [Complex::new(v.im, -v.re) / area, Complex::new(-u.im, u.re) / area];
        Ok(Self { slides, rows })
    }

    /// The sliders' amounts that translate the outer link by `target`.
    #[inline]
    pub fn inverse(&self, target: Complex<f64>) -> [Amount; 2] {
        self.rows.map(|row| Amount::Value(row.re * target.re + row.im * target.im))
    }

    /// The translation of the outer link.
    pub fn forward(&self, amounts: &[Amount; 2]) -> Complex<f64> {
        self.slides[0] * amounts[0].value() + self.slides[1] * amounts[1].value()
    }
}
