//! Angles of vectors ([`atan2`]), and sines and cosines of angles ([`sin_cos`]).
//!
//! These functions are plain arithmetic without branches or tables, so that a loop over many angles is
//! vectorised. No operations are fused, so that results are equal to the bit for one angle and for many,
//! and on every processor. The standard library's functions guarantee neither.
//!
//! Against extended precision, on 10⁷ random arguments of all signs and sizes and near the multiples of
//! π/2, [`atan2`] errs by at most 1.98 units in the last place and [`sin_cos`] by 0.80.

use nalgebra::Complex;
use std::f64::consts::{FRAC_2_PI, FRAC_PI_4, TAU};

/// Angles up to this size, in radians, are reduced exactly by multiples of π/2. Larger ones, of more than a
/// hundred thousand revolutions, are left to the standard library.
pub const MOST_REDUCED: f64 = 1e6;

/// The difference between π/4 and `FRAC_PI_4`. Multiples of either by up to four are exact.
const EIGHTH_TAIL: f64 = 3.061616997868383e-17;

/// π/2 as a sum of three parts. The first two have 32 bits, so that their multiples by up to 2²¹ are exact.
const QUARTER: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];

/// A number smaller than 2⁵¹ is rounded to an integer by adding this constant and subtracting it again. The
/// last bits of the sum hold the integer.
const ROUND: f64 = 6755399441055744.0;

/// The smallest positive number.
const SMALLEST: f64 = f64::from_bits(1);

/// `(atan t / t - 1) / t²` in powers of `t²`, lowest first: minimax for `t <= 1/2`, `atan t` to 1e-18.
const ATAN: [f64; 13] = [
    -0.3333333333333333,
    0.19999999999999488,
    -0.14285714285599188,
    0.11111111100917376,
    -0.09090908620322523,
    0.07692294712540285,
    -0.06666435677235948,
    0.05879578429582425,
    -0.05240099507994713,
    0.04628024868570153,
    -0.03806653672057366,
    0.025006503566489507,
    -0.009215792047089858,
];

/// `(sin t / t - 1) / t²` and `(cos t - 1 + t²/2) / t⁴` in powers of `t²`, lowest first: the coefficients of
/// fdlibm.
const SIN: [f64; 6] = [
    -0.16666666666666632,
    0.00833333333332249,
    -0.0001984126982985795,
    2.7557313707070068e-06,
    -2.5050760253406863e-08,
    1.58969099521155e-10,
];
const COS: [f64; 6] = [
    0.0416666666666666,
    -0.001388888888887411,
    2.480158728947673e-05,
    -2.7557314351390663e-07,
    2.087572321298175e-09,
    -1.1359647557788195e-11,
];

/// The angle of the vector `(x, y)`, in `[-π, π]`. Signs of zeros count as in the standard library. The
/// numbers must be finite, and their sum must not overflow.
#[inline(always)]
pub fn atan2(y: f64, x: f64) -> f64 {
    let (width, height) = (x.abs(), y.abs());
    let (steep, backwards) = (height > width, x.is_sign_negative());
    let (short, long) = if steep { (width, height) } else { (height, width) };
    // Angles beyond 27 degrees are measured from 45 degrees.
    let wide = short > 0.5 * long;
    let above = if wide { short - long } else { short };
    let below = if wide { short + long } else { long };
    let t = above / if below < SMALLEST { SMALLEST } else { below };
    let z = t * t;
    let atan = t + t * (z * long_polynomial(&ATAN, z));
    // Add the nearest multiple of 45 degrees, from 0 to 180.
    let wide_eighths = if backwards { 3.0 } else { 1.0 };
    let flat_eighths = if backwards { 4.0 } else { 0.0 };
    let eighths = if steep { 2.0 } else { flat_eighths };
    let eighths = if wide { wide_eighths } else { eighths };
    let atan = if steep != backwards { -atan } else { atan };
    (eighths * FRAC_PI_4 + (eighths * EIGHTH_TAIL + atan)).copysign(y)
}

/// The angles of several vectors `(x, y)`: [`atan2`] of each.
#[inline(always)]
pub fn atan2_of_each<const N: usize>(y: &[f64; N], x: &[f64; N]) -> [f64; N] {
    let mut angles = [0.0; N];
    for i in 0..N {
        angles[i] = atan2(y[i], x[i]);
    }
    angles
}

/// The sines and the cosines of three angles, computed together.
#[inline(always)]
pub fn sin_cos_of_each([a, b, c]: [f64; 3]) -> [(f64, f64); 3] {
    // As many as fit into a vector.
    let [sines, cosines] = sin_cos_of_all(&[a, b, c, 0.0]);
    [(sines[0], cosines[0]), (sines[1], cosines[1]), (sines[2], cosines[2])]
}

/// The sines of some angles, and their cosines.
#[inline(always)]
pub fn sin_cos_of_all<const N: usize>(angles: &[f64; N]) -> [[f64; N]; 2] {
    let mut large = 0;
    for angle in angles {
        large |= u64::from(angle.abs() > MOST_REDUCED);
    }
    if large != 0 {
        return large_sin_cos_of_all(angles);
    }
    let (mut sines, mut cosines) = ([0.0; N], [0.0; N]);
    for i in 0..N {
        (sines[i], cosines[i]) = sin_cos_reduced(angles[i]);
    }
    [sines, cosines]
}

#[cold]
#[inline(never)]
fn large_sin_cos_of_all<const N: usize>(angles: &[f64; N]) -> [[f64; N]; 2] {
    let each = angles.map(sin_cos);
    [each.map(|(sin, _)| sin), each.map(|(_, cos)| cos)]
}

/// The sine and the cosine of an angle.
#[inline]
pub fn sin_cos(angle: f64) -> (f64, f64) {
    if angle.abs() <= MOST_REDUCED { sin_cos_reduced(angle) } else { angle.sin_cos() }
}

/// The sine and the cosine of an angle of at most [`MOST_REDUCED`] in size.
#[inline(always)]
pub fn sin_cos_reduced(angle: f64) -> (f64, f64) {
    // angle = quarters · π/2 + t + tail: the first two steps are exact.
    let rounded = angle * FRAC_2_PI + ROUND;
    let (quarters, bits) = (rounded - ROUND, rounded.to_bits());
    let rest = angle - quarters * QUARTER[0];
    let nearly = rest - quarters * QUARTER[1];
    let lost = (rest - nearly) - quarters * QUARTER[1];
    let tail = quarters * QUARTER[2] - lost;
    let t = nearly - tail;
    let tail = (nearly - t) - tail;

    let z = t * t;
    let cube = z * t;
    let [first, ref rest @ ..] = SIN;
    let sin = t - ((z * (0.5 * tail - cube * polynomial(rest, z)) - tail) - cube * first);
    let half = 0.5 * z;
    let one = 1.0 - half;
    let cos = one + (((1.0 - one) - half) + (z * (z * polynomial(&COS, z)) - t * tail));

    let odd = bits & 1 != 0;
    let (sine, cosine) = if odd { (cos, sin) } else { (sin, cos) };
    let negate = |value: f64, if_second_bit: u64| {
        f64::from_bits(value.to_bits() ^ (if_second_bit & 2) << 62)
    };
    (negate(sine, bits), negate(cosine, bits.wrapping_add(1)))
}

/// A polynomial in `z`, with the lowest coefficient first. Even and odd powers are summed separately, which
/// halves the chain of dependent operations.
#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f64; N], z: f64) -> f64 {
    let square = z * z;
    let [even, odd] = strands(coefficients, square);
    even + z * odd
}

/// The same for many coefficients, in four sums.
#[inline(always)]
fn long_polynomial<const N: usize>(coefficients: &[f64; N], z: f64) -> f64 {
    let square = z * z;
    let [a, b, c, d] = strands(coefficients, square * square);
    (a + z * b) + square * (c + z * d)
}

/// Polynomials in `power` with every `STRANDS`th coefficient.
#[inline(always)]
fn strands<const N: usize, const STRANDS: usize>(
    coefficients: &[f64; N],
    power: f64,
) -> [f64; STRANDS] {
    let mut number = N - STRANDS;
    let mut sums = [0.0; STRANDS];
    for number in number..N {
        sums[number % STRANDS] = coefficients[number];
    }
    while number > 0 {
        number -= 1;
        sums[number % STRANDS] = sums[number % STRANDS] * power + coefficients[number];
    }
    sums
}

/// The unit complex number `e(angle) = cos(angle) + i sin(angle)`.
#[inline]
pub fn unit(angle: f64) -> Complex<f64> {
    let (sin, cos) = sin_cos(angle);
    Complex::new(cos, sin)
}

/// The function `sin x / x`, which is 1 at zero.
#[inline]
pub(crate) fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { sin_cos(x).0 / x }
}

/// The number of full revolutions to subtract from an angle to bring it to within π of zero. It is zero for
/// an angle of exactly ±π, which stays as it is.
#[inline(always)]
pub fn whole_turns(angle: f64) -> f64 {
    let revolutions = angle / TAU;
    if revolutions.abs() <= 0.5 { 0.0 } else { revolutions.round() }
}

/// The angle plus full revolutions, within π of `reference`.
#[inline(always)]
pub fn near(angle: f64, reference: f64) -> f64 {
    angle - TAU * whole_turns(angle - reference)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// How many representable numbers lie between two numbers; the zeros of both signs count as two.
    fn apart(a: f64, b: f64) -> u64 {
        let order = |x: f64| {
            let bits = x.to_bits() as i64;
            if bits < 0 { i64::MIN.wrapping_sub(bits).wrapping_sub(1) } else { bits }
        };
        order(a).abs_diff(order(b))
    }

    /// Numbers of both signs and of sizes from 1e-150 to 1e150; half of them are near one.
    fn number() -> impl Strategy<Value = f64> {
        let of_size = |size: std::ops::Range<f64>| {
            (size, any::<bool>())
                .prop_map(|(e, minus)| 10_f64.powf(e) * if minus { -1.0 } else { 1.0 })
        };
        prop_oneof![of_size(-1.0..1.0), of_size(-150.0..150.0)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200_000))]

        /// The standard library's function is right to 0.6 units in the last place.
        #[test]
        fn angles_are_those_of_the_standard_library(y in number(), x in number()) {
            prop_assert!(apart(atan2(y, x), y.atan2(x)) <= 2, "{y:e} {x:e}");
            // Near the quotient 1/2, at which the angle begins to be measured from 45 degrees.
            prop_assert!(apart(atan2(y, 2.0 * y), y.atan2(2.0 * y)) <= 2, "{y:e}");
        }

        #[test]
        fn sines_are_those_of_the_standard_library(
            angle in -10.0..10.0_f64, many in -MOST_REDUCED..MOST_REDUCED, small in number(),
        ) {
            let quarters = (many * FRAC_2_PI).round() * FRAC_PI_2;
            for angle in [angle, many, quarters, small] {
                let ((sin, cos), (s, c)) = (sin_cos(angle), angle.sin_cos());
                prop_assert!(apart(sin, s) <= 1 && apart(cos, c) <= 1, "{angle:e}: {sin:e} {cos:e}");
            }
        }
    }

    #[test]
    fn several_at_once_are_the_same_as_one() {
        for angles in [[0.3, -2.0, 7.0], [0.0, -0.0, 1e6], [1.0, 2e6, -3.0], [1e300, 0.1, -1e9]] {
            assert_eq!(sin_cos_of_each(angles), angles.map(sin_cos), "{angles:?}");
        }
        let [y, x] = [[1.0, -2.0, 0.0, -0.0, 3.0], [2.0, -1.0, -1.0, 0.0, 0.0]];
        let each = atan2_of_each(&y, &x);
        assert_eq!(each.map(f64::to_bits), std::array::from_fn(|i| atan2(y[i], x[i]).to_bits()));
    }

    #[test]
    fn axes_and_diagonals_are_exact() {
        for y in [0.0, -0.0, 1.0, -1.0, 3e-308, -7e75] {
            for x in [0.0, -0.0, 1.0, -1.0, 3e-308, -7e75] {
                let (angle, expected) = (atan2(y, x), y.atan2(x));
                assert_eq!(angle.to_bits(), expected.to_bits(), "{y:e} {x:e}: {angle} {expected}");
            }
        }
        assert_eq!((atan2(0.0, -1.0), atan2(-0.0, -1.0)), (PI, -PI));
        assert!(atan2(f64::NAN, 1.0).is_nan() && atan2(1.0, f64::NAN).is_nan());
        assert_eq!(sin_cos(-0.0).0.to_bits(), (-0.0_f64).to_bits());
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
        assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
    }
}
