//! Affine arithmetic: a function over a box as a linear function with a bound of its error.
//!
//! A quantity is `centre + slope · δ` with `δ` in the cube `[-1, 1]^N`, one component for each coordinate of
//! the box, to within the sum of `error`. Errors are quadratic in the size of the box: for boxes of half the
//! size they are a quarter (L. H. de Figueiredo and J. Stolfi, *Affine arithmetic: concepts and
//! applications*, Numerical Algorithms 37, 2004). They are recorded by the coordinate that
//! they come from, which tells which side of a box to bisect.
//!
//! Operations are functions of references, and are not inlined: the numbers are too large for registers. Inlined, the code
//! would be several times as long, and no faster.

mod plane;

pub use plane::Plane;

use std::ops::{Add, Mul, Neg, Sub};

/// The rounding of one operation, as a fraction of the largest number in it: about nine times the unit
/// roundoff, for the dozen roundings in it.
const ROUNDING: f64 = 1e-15;

/// Stands for an unbounded error: it is too large for anything to be decided, and products of three of them
/// are still finite.
const UNBOUNDED: f64 = 1e90;

/// The largest half width of an angle's range, radians, for which its sine and cosine are bounded.
pub const WIDE: f64 = 1.2;

/// The largest `(1 - cos θ)/2` for which a rotation vector is bounded: beyond it, θ is too near to π.
const NEAR_HALF_TURN: f64 = 0.999;

/// The largest second derivative of the arctangent, `3√3/8`.
const ARCTANGENT_BEND: f64 = 0.65;

/// A linear function on the cube `[-1, 1]^N`, to within an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<const N: usize> {
    /// The value in the middle of the box.
    pub centre: f64,
    /// The change by each coordinate from the middle to its end.
    pub slope: [f64; N],
    /// By how much the function may differ from the linear one, by coordinate.
    pub error: [f64; N],
    /// The additional error by rounding.
    pub rounding: f64,
}

impl<const N: usize> Affine<N> {
    /// A number that is the same over the box.
    pub fn constant(centre: f64) -> Self {
        Self { centre, slope: [0.0; N], error: [0.0; N], rounding: 0.0 }
    }

    /// Coordinate number `i`, from `centre - half` to `centre + half`.
    pub fn coordinate(centre: f64, half: f64, i: usize) -> Self {
        let mut slope = [0.0; N];
        slope[i] = half;
        Self { centre, slope, ..Self::constant(centre) }.rounded(centre.abs() + half)
    }

    /// The largest change by each coordinate from the middle to an end.
    pub fn spread(&self) -> [f64; N] {
        std::array::from_fn(|i| self.slope[i].abs() + self.error[i])
    }

    /// The largest distance from `centre`.
    pub fn radius(&self) -> f64 {
        self.spread().iter().sum::<f64>() + self.rounding
    }

    /// The least value.
    pub fn low(&self) -> f64 {
        self.centre - self.radius()
    }

    /// The largest value.
    pub fn high(&self) -> f64 {
        self.centre + self.radius()
    }

    /// The largest absolute value.
    pub fn furthest(&self) -> f64 {
        self.centre.abs() + self.radius()
    }

    /// The largest distance from the linear function.
    pub fn total_error(&self) -> f64 {
        self.error.iter().sum::<f64>() + self.rounding
    }

    /// Adds the rounding of one operation on numbers up to `size`.
    fn rounded(mut self, size: f64) -> Self {
        self.rounding += ROUNDING * size;
        self
    }

    fn size(&self) -> f64 {
        self.centre.abs() + self.radius()
    }

    /// A quantity of which only is known that it is within `bound` of `centre`. The error is attributed to the
    /// coordinates in proportion to these spreads, which were too large.
    pub fn unknown(centre: f64, bound: f64, spread: &[f64; N]) -> Self {
        let total: f64 = spread.iter().sum();
        if total > 0.0 && total.is_finite() {
            let error = spread.map(|s| bound * s / total);
            Self { error, ..Self::constant(centre) }
        } else {
            Self { rounding: bound, ..Self::constant(centre) }
        }
    }

    #[inline(never)]
    pub fn square(&self) -> Self {
        let spread = self.spread();
        let all: f64 = spread.iter().sum();
        // The square of the deviation from the centre lies between zero and this.
        let bend = 0.5 * all * all;
        let error = |i: usize| 2.0 * self.centre.abs() * self.error[i] + 0.5 * all * spread[i];
        let off = self.rounding * (2.0 * (self.centre.abs() + all) + self.rounding);
        let size = self.size();
        Self {
            centre: self.centre * self.centre + bend,
            slope: self.slope.map(|s| 2.0 * self.centre * s),
            error: std::array::from_fn(error),
            rounding: off,
        }
        .rounded(size * size)
    }

    /// A convex (`bend` 1) or concave (-1) function with its derivative, on those values that are at
    /// least `least`: it lies on one side of a tangent, farthest from it at an end.
    fn curved(&self, least: f64, bend: f64, f: impl Fn(f64) -> [f64; 2]) -> Self {
        let (low, high) = (self.low().max(least), self.high());
        let at = if self.low() < least { 0.5 * (low + high) } else { self.centre };
        let [value, slope] = f(at);
        let tangent = |x: f64| value + slope * (x - at);
        let off = |x: f64| (bend * (f(x)[0] - tangent(x))).max(0.0);
        let most = off(low).max(off(high));
        let spread = self.spread();
        let all: f64 = spread.iter().sum();
        let share = if all > 0.0 { 0.5 * most / all } else { 0.0 };
        let size = value.abs() + slope.abs() * self.size() + most;
        Self {
            centre: tangent(self.centre) + 0.5 * bend * most,
            slope: self.slope.map(|s| slope * s),
            error: std::array::from_fn(|i| slope.abs() * self.error[i] + share * spread[i]),
            rounding: slope.abs() * self.rounding + if all > 0.0 { 0.0 } else { 0.5 * most },
        }
        .rounded(4.0 * size)
    }

    /// The root. The bounds hold for those values that are not negative.
    #[inline(never)]
    pub fn sqrt(&self) -> Self {
        let high = self.high();
        if high <= 0.0 {
            return Self::constant(0.0);
        }
        self.curved(0.0, -1.0, |x| [x.sqrt(), 0.5 / x.sqrt()])
    }

    #[inline(never)]
    pub fn recip(&self) -> Self {
        if self.low() > 0.0 {
            self.curved(0.0, 1.0, |x| [1.0 / x, -1.0 / (x * x)])
        } else if self.high() < 0.0 {
            -(-*self).recip()
        } else {
            Self::unknown(0.0, UNBOUNDED, &self.spread())
        }
    }

    /// The inverse of the root of a number that is not negative.
    #[inline(never)]
    fn recip_sqrt(&self) -> Self {
        if self.low() > 0.0 {
            self.curved(0.0, 1.0, |x| [1.0 / x.sqrt(), -0.5 / (x * x.sqrt())])
        } else {
            Self::unknown(0.0, UNBOUNDED, &self.spread())
        }
    }

    /// `θ / sin θ` for the cosine of an angle from zero to π: `Σ aₙ yⁿ` with `y = (1 - cos θ)/2`
    /// and `aₙ₊₁ = aₙ (2n + 2)/(2n + 3)`, so that it is convex.
    #[inline(never)]
    pub fn angle_over_sine(&self) -> Self {
        let y = (-*self + 1.0) * 0.5;
        if y.high() > NEAR_HALF_TURN {
            return Self::unknown(0.0, UNBOUNDED, &self.spread());
        }
        y.curved(0.0, 1.0, |y| {
            if y < 0.01 {
                let mut term = 1.0;
                let (mut value, mut slope) = (0.0, 0.0);
                for n in 0..10 {
                    let n = f64::from(n);
                    value += term;
                    term *= (2.0 * n + 2.0) / (2.0 * n + 3.0);
                    slope += (n + 1.0) * term;
                    term *= y;
                }
                return [value, slope];
            }
            let sine_square = 4.0 * y * (1.0 - y);
            let value = 2.0 * y.sqrt().asin() / sine_square.sqrt();
            // The derivative by the cosine is (cos θ · value - 1) / sin² θ, and the cosine 1 - 2y.
            [value, 2.0 * (1.0 - (1.0 - 2.0 * y) * value) / sine_square]
        })
    }

    /// The unit vector at this angle.
    #[inline(never)]
    pub fn unit_vector(&self) -> Plane<N> {
        let radius = self.radius();
        let spread = self.spread();
        if radius > WIDE || radius.is_nan() {
            return Plane::anywhere(&spread);
        }
        let (sin, cos) = self.centre.sin_cos();
        let along = |value: f64, slope: f64| {
            self.bent(
                [value, slope],
                [-value - radius, -value + radius].map(|b| b.clamp(-1.0, 1.0)),
            )
        };
        Plane { re: along(cos, -sin), im: along(sin, cos) }
    }

    #[inline(never)]
    fn atan(&self) -> Self {
        let slope = 1.0 / (1.0 + self.centre * self.centre);
        let bend = -2.0 * self.centre * slope * slope;
        // The third derivative is at most 2.
        let off = 2.0 * self.radius();
        let bends = [bend - off, bend + off].map(|b| b.clamp(-ARCTANGENT_BEND, ARCTANGENT_BEND));
        self.bent([self.centre.atan(), slope], bends)
    }

    /// A function with its value and derivative in the middle, whose second derivative lies between two
    /// bounds.
    #[inline(never)]
    pub fn bent(&self, [value, slope]: [f64; 2], bends: [f64; 2]) -> Self {
        let radius = self.radius();
        let [least, most] = [bends[0].min(0.0), bends[1].max(0.0)].map(|b| 0.5 * b * radius);
        let (spread, share) = (self.spread(), 0.5 * (most - least));
        Self {
            centre: value + 0.5 * (least + most) * radius,
            slope: self.slope.map(|s| slope * s),
            error: std::array::from_fn(|i| slope.abs() * self.error[i] + share * spread[i]),
            rounding: (slope.abs() + share) * self.rounding,
        }
        .rounded(4.0 * (1.0 + value.abs() + slope.abs() * self.size()))
    }

    /// The sum with another one times 1 or -1.
    #[inline(never)]
    fn sum(&self, other: &Self, sign: f64) -> Self {
        Self {
            centre: self.centre + sign * other.centre,
            slope: std::array::from_fn(|i| self.slope[i] + sign * other.slope[i]),
            error: std::array::from_fn(|i| self.error[i] + other.error[i]),
            rounding: self.rounding + other.rounding,
        }
        .rounded(self.size() + other.size())
    }

    /// The sum with a number.
    #[inline(never)]
    fn moved(&self, by: f64) -> Self {
        let size = self.size() + by.abs();
        Self { centre: self.centre + by, ..*self }.rounded(size)
    }

    /// The product with a number.
    #[inline(never)]
    fn scaled(&self, by: f64) -> Self {
        let size = self.size() * by.abs();
        Self {
            centre: self.centre * by,
            slope: self.slope.map(|s| s * by),
            error: self.error.map(|e| e * by.abs()),
            rounding: self.rounding * by.abs(),
        }
        .rounded(size)
    }

    /// A sum of products. The quadratic terms are summed before their signs are dropped.
    #[inline(never)]
    pub fn products<const K: usize>(pairs: [[&Self; 2]; K]) -> Self {
        let mut result = Self::constant(0.0);
        // The coefficients of the products of two coordinates, below the diagonal.
        let mut bends = [[0.0; N]; N];
        let mut size = 0.0;
        for [x, y] in pairs {
            let (a, b) = (x.centre, y.centre);
            let sum = |of: [f64; N]| of.iter().sum::<f64>();
            let (p, q) = (x.slope.map(f64::abs), y.slope.map(f64::abs));
            let (all_p, all_q) = (sum(p), sum(q));
            let (e, f) = (sum(x.error), sum(y.error));
            result.centre += a * b;
            for i in 0..N {
                result.slope[i] += a * y.slope[i] + b * x.slope[i];
                // The products of errors and deviations, attributed in halves to the coordinates of either.
                result.error[i] += a.abs() * y.error[i]
                    + b.abs() * x.error[i]
                    + 0.5 * (x.error[i] * (all_q + f) + p[i] * f)
                    + 0.5 * (y.error[i] * (all_p + e) + q[i] * e);
                for (j, bend) in bends[i][..i].iter_mut().enumerate() {
                    *bend += x.slope[i] * y.slope[j] + x.slope[j] * y.slope[i];
                }
                bends[i][i] += x.slope[i] * y.slope[i];
            }
            let (r, s) = (x.rounding, y.rounding);
            result.rounding += (a.abs() + all_p + e) * s + (b.abs() + all_q + f + s) * r;
            size += (a.abs() + all_p + e + r) * (b.abs() + all_q + f + s);
        }
        for (i, bends) in bends.iter().enumerate() {
            // The square of a coordinate lies between zero and one.
            result.centre += 0.5 * bends[i];
            result.error[i] += 0.5 * bends[i].abs();
            for (j, bend) in bends[..i].iter().enumerate() {
                result.error[i] += 0.5 * bend.abs();
                result.error[j] += 0.5 * bend.abs();
            }
        }
        // One term for each coordinate and each pair.
        result.rounded(4.0 * size)
    }
}

impl<const N: usize> Add for Affine<N> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.sum(&other, 1.0)
    }
}

impl<const N: usize> Sub for Affine<N> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self.sum(&other, -1.0)
    }
}

impl<const N: usize> Neg for Affine<N> {
    type Output = Self;

    fn neg(self) -> Self {
        Self { centre: -self.centre, slope: self.slope.map(|s| -s), ..self }
    }
}

impl<const N: usize> Add<f64> for Affine<N> {
    type Output = Self;

    #[inline]
    fn add(self, number: f64) -> Self {
        self.moved(number)
    }
}

impl<const N: usize> Sub<f64> for Affine<N> {
    type Output = Self;

    fn sub(self, number: f64) -> Self {
        self.moved(-number)
    }
}

impl<const N: usize> Mul<f64> for Affine<N> {
    type Output = Self;

    #[inline]
    fn mul(self, number: f64) -> Self {
        self.scaled(number)
    }
}

impl<const N: usize> Mul for Affine<N> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::products([[&self, &other]])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::Real;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// A number over a box of two coordinates, a place in the box, and a value there that is within the
    /// number's error of the linear function.
    fn number(from: f64, to: f64) -> impl Strategy<Value = (Affine<2>, f64)> {
        let part = || -1.0..1.0_f64;
        let scale = prop_oneof![Just(0.0), Just(1e-3), Just(0.1), Just(1.0)];
        let error = prop_oneof![Just([0.0; 2]), [0.0..0.3, 0.0..0.3_f64]];
        (from..to, [part(), part()], error, scale, part()).prop_map(
            |(centre, slope, error, scale, off)| {
                let [slope, error] = [slope, error].map(|parts| parts.map(|part| part * scale));
                let number = Affine { slope, error, ..Affine::constant(centre) };
                (number.rounded(number.size()), off * number.total_error())
            },
        )
    }

    /// A place in the box, often in a corner.
    fn place() -> impl Strategy<Value = [f64; 2]> {
        let along = || prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0_f64];
        [along(), along()]
    }

    fn linear(number: &Affine<2>, at: [f64; 2]) -> f64 {
        number.centre + number.slope[0] * at[0] + number.slope[1] * at[1]
    }

    /// The affine number holds this value at a place.
    fn holds(number: &Affine<2>, at: [f64; 2], value: f64) -> bool {
        (value - linear(number, at)).abs() <= number.total_error() + 1e-15
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn operations_hold_what_numbers_give(
            (x, x_off) in number(-2.0, 2.0), (y, y_off) in number(-2.0, 2.0), at in place(),
        ) {
            let (a, b) = (linear(&x, at) + x_off, linear(&y, at) + y_off);
            prop_assert!(holds(&x.square(), at, a * a));
            prop_assert!(holds(&(x * y), at, a * b));
            prop_assert!(holds(&Affine::products([[&x, &y], [&y, &-x], [&x, &x]]), at, a * a));
            prop_assert!(holds(&(x * 3.0 - y + 0.5), at, a * 3.0 - b + 0.5));
            prop_assert!(holds(&Real::absolute(x), at, a.abs()));
            prop_assert!(holds(&Real::larger(x, y), at, a.max(b)));
            prop_assert!(a < 0.0 || holds(&x.sqrt(), at, a.sqrt()));
            prop_assert!(holds(&x.recip(), at, 1.0 / a));
            prop_assert!(a < 0.0 || holds(&x.recip_sqrt(), at, 1.0 / a.sqrt()));
            prop_assert!(holds(&x.atan(), at, a.atan()));
            let turn = (x * 2.0).unit_vector();
            prop_assert!(holds(&turn.re, at, (2.0 * a).cos()));
            prop_assert!(holds(&turn.im, at, (2.0 * a).sin()));
            let z = Plane { re: x, im: y };
            let (angle, length) = (b.atan2(a), a.hypot(b));
            let argument = z.argument();
            let turns = ((linear(&argument, at) - angle) / TAU).round();
            prop_assert!(holds(&argument, at, angle + TAU * turns));
            let direction = z.direction();
            prop_assert!(holds(&direction.re, at, a / length));
            prop_assert!(holds(&direction.im, at, b / length));
        }

        #[test]
        fn angles_over_sines_hold((x, off) in number(-1.0, 1.0), at in place()) {
            let cosine = linear(&x, at) + off;
            // Near the ends this check is too inaccurate.
            let inside = cosine.abs() < 1.0 - 1e-9;
            let angle = cosine.acos();
            prop_assert!(!inside || holds(&x.angle_over_sine(), at, angle / angle.sin()));
        }
    }
}
