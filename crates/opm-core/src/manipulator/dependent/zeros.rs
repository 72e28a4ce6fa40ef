//! A condition as a function of one coordinate: three of its values determine it.

use crate::chain::equation::Equation;
use crate::numeric::angle::near;
use std::f64::consts::FRAC_PI_2;

/// The value of a condition as a function of one coordinate `t = home + step · u`, with a step of one radian for a
/// harmonic function.
#[derive(Clone, Copy, Debug)]
pub(super) struct Function {
    home: f64,
    step: f64,
    /// The function of `u`.
    equation: Equation,
    /// The unit of its values.
    unit: f64,
}

impl Function {
    /// The harmonic function of an angle with these values.
    pub fn harmonic(home: f64, unit: f64, value: &mut impl FnMut(f64) -> f64) -> Self {
        let [at, quarter, half] = [0.0, FRAC_PI_2, 2.0 * FRAC_PI_2].map(|t| value(home + t));
        let middle = 0.5 * (at + half);
        let equation = Equation::Harmonic([middle, 0.5 * (at - half), quarter - middle]);
        Self { home, step: 1.0, equation, unit }
    }

    /// The polynomial of degree two at most with these values, `step` apart.
    pub fn polynomial(home: f64, step: f64, unit: f64, value: &mut impl FnMut(f64) -> f64) -> Self {
        let [before, at, after] = [-1.0, 0.0, 1.0].map(|u| value(home + u * step));
        let (slope, bend) = (0.5 * (after - before), 0.5 * (after + before) - at);
        Self { home, step, equation: Equation::Polynomial([at, slope, bend]), unit }
    }

    /// The slope at home.
    pub fn slope(&self) -> f64 {
        self.equation.slope_at_zero() / self.step
    }

    /// The zero at which the function rises (`sign` is positive) or falls; the only zero if there is one. An
    /// angle is that nearest to `held`, which is also given where the function is zero everywhere.
    ///
    /// # Errors
    /// The value nearest to zero, if there is no zero.
    pub fn zero(&self, sign: f64, held: f64) -> Result<f64, f64> {
        let Some(u) = self.equation.zero(sign, self.unit)? else { return Ok(held) };
        let found = self.home + self.step * u;
        Ok(match self.equation {
            Equation::Harmonic(_) => near(found, held),
            Equation::Polynomial(_) | Equation::Periodic(..) => found,
        })
    }
}
