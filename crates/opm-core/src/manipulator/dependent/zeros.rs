//! A condition as a function of one coordinate: three of its values determine it.

use super::near;
use crate::chain::REACH_TOLERANCE;
use crate::chain::condition::VERGE;
use std::f64::consts::FRAC_PI_2;

/// The value of a condition as a function of one coordinate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Function {
    form: Form,
    /// `c₀ c₁ c₂`.
    coefficients: [f64; 3],
    /// The unit of its values.
    unit: f64,
}

#[derive(Clone, Copy, Debug)]
enum Form {
    /// `c₀ + c₁ cos t + c₂ sin t`, of the angle from `home`.
    Wave { home: f64 },
    /// `c₀ + c₁ u + c₂ u²`, with `t = home + step · u`.
    Polynomial { home: f64, step: f64 },
}

impl Function {
    /// The function of an angle with these values.
    pub fn wave(home: f64, unit: f64, value: &mut impl FnMut(f64) -> f64) -> Self {
        let [at, quarter, half] = [0.0, FRAC_PI_2, 2.0 * FRAC_PI_2].map(|t| value(home + t));
        let middle = 0.5 * (at + half);
        let coefficients = [middle, 0.5 * (at - half), quarter - middle];
        Self { form: Form::Wave { home }, coefficients, unit }
    }

    /// The polynomial of degree two at most with these values, `step` apart.
    pub fn polynomial(home: f64, step: f64, unit: f64, value: &mut impl FnMut(f64) -> f64) -> Self {
        let [before, at, after] = [-1.0, 0.0, 1.0].map(|u| value(home + u * step));
        let coefficients = [at, 0.5 * (after - before), 0.5 * (after + before) - at];
        Self { form: Form::Polynomial { home, step }, coefficients, unit }
    }

    /// The slope at `t`.
    pub fn slope(&self, t: f64) -> f64 {
        let [_, c1, c2] = self.coefficients;
        match self.form {
            Form::Wave { home } => {
                let (sin, cos) = (t - home).sin_cos();
                c2 * cos - c1 * sin
            }
            Form::Polynomial { home, step } => (c1 + 2.0 * c2 * (t - home) / step) / step,
        }
    }

    /// The zero at which the function rises (`sign` is positive) or falls; the only zero if there is one. An
    /// angle is that nearest to `held`, which is also given where the function is zero everywhere.
    ///
    /// # Errors
    /// The value nearest to zero, if there is no zero.
    pub fn zero(&self, sign: f64, held: f64) -> Result<f64, f64> {
        let [c0, c1, c2] = self.coefficients;
        let constant = || if c0.abs() <= REACH_TOLERANCE * self.unit { Ok(held) } else { Err(c0) };
        match self.form {
            Form::Wave { home } => {
                let amplitude = c1.hypot(c2);
                if amplitude <= VERGE * self.unit {
                    return constant();
                }
                if c0.abs() > amplitude + REACH_TOLERANCE * self.unit {
                    return Err(c0 - amplitude.copysign(c0));
                }
                // c₀ + r cos(t - phase), which rises before its crest.
                let phase = c2.atan2(c1);
                let height = ((amplitude - c0) * (amplitude + c0)).max(0.0).sqrt();
                let from_crest = height.atan2(-c0);
                Ok(near(home + phase - sign * from_crest, held))
            }
            Form::Polynomial { home, step } => {
                let u = if c2.abs() <= VERGE * c1.abs().max(self.unit) {
                    if c1.abs() <= VERGE * self.unit {
                        return constant();
                    }
                    -c0 / c1
                } else {
                    // The slope at a zero is the root of this, with the sign of the branch.
                    let square = c1 * c1 - 4.0 * c2 * c0;
                    if square < -REACH_TOLERANCE * self.unit * self.unit {
                        return Err(c0 - 0.25 * c1 * c1 / c2);
                    }
                    (sign * square.max(0.0).sqrt() - c1) / (2.0 * c2)
                };
                Ok(home + step * u)
            }
        }
    }
}
