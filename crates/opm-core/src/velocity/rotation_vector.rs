//! Derivatives of a rotation vector, which is the coordinate of a spherical joint.
//!
//! With `r` the vector, `θ = |r|`, and `ω` the angular velocity of `exp(r)` in the fixed frame,
//! `ṙ = ω − ½ r × ω + c(θ) r × (r × ω)`, `c = (1 − (θ/2) cot(θ/2)) / θ²` (Bullo and Murray,
//! "Proportional derivative control on the Euclidean group", ECC 1995). At a full
//! revolution, `θ = 2π`, there is no such derivative, because a rotation by 2π about any axis is the same.

use super::SINGULAR;
use crate::group::LocalTwist;
use nalgebra::Matrix3;

/// A rotation vector, with the coefficients of its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RotationVector {
    /// The rotation vector `r`.
    vector: LocalTwist,
    /// The coefficient `c(θ)`.
    second: f64,
    /// The coefficient `c′(θ) / θ`.
    slope: f64,
    /// Whether the rotation is by full revolutions.
    singular: bool,
}

/// Below this angle the series is exact to double precision. Above it the closed form loses less than three
/// digits to cancellation.
const SMALL: f64 = 0.5;

impl RotationVector {
    pub fn new(vector: LocalTwist) -> Self {
        let square = vector.norm_squared();
        let angle = square.sqrt();
        if angle < SMALL {
            return Self {
                vector,
                second: series(&SECOND, square),
                slope: series(&SLOPE, square),
                singular: false,
            };
        }
        let (sin, cos) = (0.5 * angle).sin_cos();
        if sin.abs() < SINGULAR {
            return Self { vector, second: 0.0, slope: 0.0, singular: true };
        }
        let half = 0.5 * angle * cos / sin;
        let second = (1.0 - half) / square;
        let slope = ((half - 2.0) / square + 0.25 / (sin * sin)) / square;
        Self { vector, second, slope, singular: false }
    }

    /// Whether the rotation is by full revolutions, where the vector has no derivative.
    pub fn is_singular(&self) -> bool {
        self.singular
    }

    /// The matrix that maps `ω` to `ṙ`.
    pub fn angular_velocity_to_rates(&self) -> Matrix3<f64> {
        let r = &self.vector;
        // r × (r × ω) = r (r · ω) − θ² ω.
        let (along, across) = (r * self.second, 1.0 - self.second * r.norm_squared());
        let h = r * 0.5;
        Matrix3::new(
            across + along.x * r.x,
            along.x * r.y + h.z,
            along.x * r.z - h.y,
            along.y * r.x - h.z,
            across + along.y * r.y,
            along.y * r.z + h.x,
            along.z * r.x + h.y,
            along.z * r.y - h.x,
            across + along.z * r.z,
        )
    }

    /// `r̈` at constant `ω`: the derivative of that matrix, multiplied by `ω`. `rates` is `ṙ`.
    pub fn bias(&self, rates: &LocalTwist, omega: &LocalTwist) -> LocalTwist {
        let r = &self.vector;
        let crossed = r.cross(omega);
        let squared = rates.cross(&crossed) + r.cross(&rates.cross(omega));
        r.cross(&crossed) * (self.slope * r.dot(rates)) + squared * self.second
            - rates.cross(omega) * 0.5
    }
}

/// The series of `c` in powers of `θ²`, which follows from that of `x cot x` with Bernoulli numbers.
const SECOND: [f64; 7] = [
    1.0 / 12.0,
    1.0 / 720.0,
    1.0 / 30_240.0,
    1.0 / 1_209_600.0,
    1.0 / 47_900_160.0,
    691.0 / 1_307_674_368_000.0,
    1.0 / 74_724_249_600.0,
];

/// The series of `c′ / θ` in powers of `θ²`, from the derivative of that series.
const SLOPE: [f64; 6] = [
    2.0 / 720.0,
    4.0 / 30_240.0,
    6.0 / 1_209_600.0,
    8.0 / 47_900_160.0,
    10.0 * 691.0 / 1_307_674_368_000.0,
    12.0 / 74_724_249_600.0,
];

/// The value of a power series in `x`, with the lowest coefficient first.
fn series(coefficients: &[f64], x: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::PI;

    proptest! {
        /// The series and the closed form agree near the angle at which one takes over from the other.
        #[test]
        fn series_and_closed_form_agree(angle in 0.45..0.5_f64) {
            let (sin, cos) = (0.5 * angle).sin_cos();
            let half = 0.5 * angle * cos / sin;
            let square = angle * angle;
            let second = (1.0 - half) / square;
            let slope = ((half - 2.0) / square + 0.25 / (sin * sin)) / square;
            prop_assert!((series(&SECOND, square) - second).abs() < 1e-14);
            prop_assert!((series(&SLOPE, square) - slope).abs() < 1e-13);
        }
    }

    #[test]
    fn a_full_revolution_has_no_derivative_but_half_of_one_has() {
        assert!(RotationVector::new(LocalTwist::z() * (2.0 * PI)).is_singular());
        assert!(!RotationVector::new(LocalTwist::z() * PI).is_singular());
        assert!(!RotationVector::new(LocalTwist::zeros()).is_singular());
    }
}
