//! A condition as a function of one coordinate: three of its values determine it.

use crate::chain::equation::{AttemptedZero, Equation};
use crate::numeric::angle::near;
use std::f64::consts::FRAC_PI_2;

/// How a condition depends on one coordinate `t = home + step · u`, with a step of one radian for a harmonic function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Function {
    pub home: f64,
    pub step: f64,
    /// Whether it is a harmonic function of `u`; otherwise it is a polynomial of degree two at most.
    pub harmonic: bool,
    /// The unit of its values.
    pub unit: f64,
}

impl Function {
    /// A harmonic function of an angle.
    pub fn harmonic(home: f64, unit: f64) -> Self {
        Self { home, step: 1.0, harmonic: true, unit }
    }

    /// A polynomial of degree two at most, to be known by values that are `step` apart.
    pub fn polynomial(home: f64, step: f64, unit: f64) -> Self {
        Self { home, step, harmonic: false, unit }
    }

    /// The values of the coordinate at which the function has to be known.
    #[inline(always)]
    pub fn places(&self) -> [f64; 3] {
        let steps =
            if self.harmonic { [0.0, FRAC_PI_2, 2.0 * FRAC_PI_2] } else { [-1.0, 0.0, 1.0] };
        steps.map(|u| self.home + u * self.step)
    }

    /// The function of `u` with these values at its places.
    #[inline(always)]
    fn through(&self, [first, second, third]: [f64; 3]) -> Equation {
        if self.harmonic {
            let middle = 0.5 * (first + third);
            Equation::Harmonic([middle, 0.5 * (first - third), second - middle])
        } else {
            let (slope, bend) = (0.5 * (third - first), 0.5 * (third + first) - second);
            Equation::Polynomial([second, slope, bend])
        }
    }

    /// The amplitude of the harmonic function with these values.
    pub fn amplitude(&self, [first, second, third]: [f64; 3]) -> f64 {
        (0.5 * (first - third)).hypot(second - 0.5 * (first + third))
    }

    /// The slope at home of the function with these values.
    pub fn slope(&self, values: [f64; 3]) -> f64 {
        self.through(values).slope_at(0.0) / self.step
    }

    /// The slope at a value of the coordinate of the function with these values.
    pub fn slope_at(&self, values: [f64; 3], coordinate: f64) -> f64 {
        self.through(values).slope_at((coordinate - self.home) / self.step) / self.step
    }

    /// The zero at which the function with these values rises (`sign` is positive) or falls; the only zero if there is
    /// one. An angle is that nearest to `held`, which is also given where the function is zero everywhere.
    ///
    /// # Errors
    /// The value nearest to zero, if there is no zero.
    pub fn zero(&self, values: [f64; 3], sign: f64, held: f64) -> Result<f64, f64> {
        let zero = self.through(values).zero(sign, self.unit)?;
        Ok(zero.map_or(held, |u| self.coordinate(u, held)))
    }

    /// The general case of [`Function::zero`]. There are no branches: a loop over many poses is vectorised.
    #[inline(always)]
    pub fn attempt_zero(&self, values: [f64; 3], sign: f64, held: f64) -> AttemptedZero {
        let zero = self.through(values).attempt_zero(sign, self.unit);
        AttemptedZero { at: self.coordinate(zero.at, held), ..zero }
    }

    #[inline(always)]
    fn coordinate(&self, u: f64, held: f64) -> f64 {
        let found = self.home + self.step * u;
        if self.harmonic { near(found, held) } else { found }
    }
}
