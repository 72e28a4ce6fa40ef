//! Trigonometric polynomials of degree up to four, and all of their real roots.

mod brackets;
mod interval;
mod tables;

use crate::numeric::four_wide::FourWide;
use brackets::InBrackets;
use interval::{Bracket, Interval};
use nalgebra::Complex;
use pulp::{Simd, WithSimd};
use tables::{POWERS, QUARTERS, Table};

/// The highest degree: that of the polynomial of three conditions in a planar or a spherical section.
const DEGREE: usize = 4;
/// The degree of the polynomial in the tangent of the half angle.
const HALF: usize = 2 * DEGREE;
/// The number of its coefficients.
const COEFFICIENTS: usize = HALF + 1;
/// The number of intervals, and of roots, that are computed together.
const LANES: usize = 4;

/// A polynomial is zero where it is below this share of the terms that it was computed from: the rounding
/// after some twenty products and sums.
pub const NOISE: f64 = 1e-14;

/// The shortest interval of the half angle's tangent that is divided further. Two roots in a shorter one are
/// nearer to each other than the error of a double root, which is the square root of [`NOISE`].
const SHORTEST: f64 = 1e-8;

/// Roots nearer to each other than this are doubtful: near four of them a polynomial is lost in its
/// rounding.
const NEAR: f64 = 1e-3;

/// The polynomial `f(θ) = Re c₀ + Σ 2 Re(c_k exp(i k θ))`: `c₋ₖ` is the conjugate of `c_k`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trigonometric {
    coefficients: [Complex<f64>; DEGREE + 1],
    degree: usize,
}

/// A polynomial of degree two: `c₀` and the real and imaginary parts of `c₁` and `c₂`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quadratic {
    constant: f64,
    first: Complex<f64>,
    second: Complex<f64>,
}

impl Quadratic {
    /// The product of two polynomials `a + b cos θ + c sin θ`.
    #[inline(always)]
    pub fn product([a, b, c]: &[f64; 3], [p, q, r]: &[f64; 3]) -> Self {
        Self {
            constant: a * p + 0.5 * (b * q + c * r),
            first: Complex::new(0.5 * (a * q + b * p), -0.5 * (a * r + c * p)),
            second: Complex::new(0.25 * (b * q - c * r), -0.25 * (b * r + c * q)),
        }
    }

    /// The difference `self − other`.
    #[inline(always)]
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        Self {
            constant: self.constant - other.constant,
            first: self.first - other.first,
            second: self.second - other.second,
        }
    }

    /// The square.
    #[inline(always)]
    #[must_use]
    pub fn square(&self) -> Trigonometric {
        let Self { constant, first, second } = *self;
        let norms = first.norm_sqr() + second.norm_sqr();
        let coefficients = [
            Complex::new(constant * constant + 2.0 * norms, 0.0),
            (first * constant + first.conj() * second) * 2.0,
            second * (2.0 * constant) + first * first,
            first * second * 2.0,
            second * second,
        ];
        Trigonometric { coefficients, degree: 4 }
    }
}

/// The real roots of a polynomial, as unit complex numbers `e(θ)`, counter-clockwise from −π/2.
#[derive(Clone, Debug, PartialEq)]
pub enum Roots {
    /// Finitely many roots.
    At {
        /// The roots, unit complex numbers.
        roots: Vec<Complex<f64>>,
        /// Whether some roots are so near to each other, or nearly double, that rounding affects their number
        /// and their values.
        doubtful: bool,
    },
    /// The polynomial is zero everywhere.
    Everywhere,
}

impl Trigonometric {
    /// The polynomial `a + b cos θ + c sin θ`.
    #[inline(always)]
    pub fn linear([a, b, c]: [f64; 3]) -> Self {
        let mut coefficients = [Complex::new(0.0, 0.0); DEGREE + 1];
        coefficients[0].re = a;
        coefficients[1] = Complex::new(0.5 * b, -0.5 * c);
        Self { coefficients, degree: 1 }
    }

    /// The value at the angle of a unit complex number.
    #[inline]
    pub fn value(&self, e: Complex<f64>) -> f64 {
        let mut value = self.coefficients[0].re;
        let mut power = e;
        for c in &self.coefficients[1..=self.degree] {
            value += 2.0 * (c.re * power.re - c.im * power.im);
            power *= e;
        }
        value
    }

    /// The product. The degrees must add up to at most four. Where they are known to the compiler, so are all
    /// ranges: hence it is always inlined.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, other: &Self) -> Self {
        let (n, m) = (self.degree, other.degree);
        let (a, b) = (&self.coefficients, &other.coefficients);
        let mut coefficients = [Complex::new(0.0, 0.0); DEGREE + 1];
        coefficients[0].re = a[0].re * b[0].re;
        for k in 1..=n.min(m) {
            coefficients[0].re += 2.0 * (a[k].re * b[k].re + a[k].im * b[k].im);
        }
        // Σ a_j b_(k−j), where one index or none is negative.
        for k in 1..=n + m {
            let mut sum = Complex::new(0.0, 0.0);
            for j in k.saturating_sub(m)..=n.min(k) {
                sum += a[j] * b[k - j];
            }
            for j in 1..=m.min(n.saturating_sub(k)) {
                sum += a[k + j] * b[j].conj();
            }
            for j in 1..=n.min(m.saturating_sub(k)) {
                sum += a[j].conj() * b[k + j];
            }
            coefficients[k] = sum;
        }
        Self { coefficients, degree: n + m }
    }

    /// The difference `self − other`.
    #[inline(always)]
    #[must_use]
    pub fn minus(&self, other: &Self) -> Self {
        let mut difference = *self;
        difference.degree = self.degree.max(other.degree);
        for (c, o) in difference.coefficients.iter_mut().zip(&other.coefficients) {
            *c -= o;
        }
        difference
    }

    /// The sum.
    #[inline(always)]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let mut sum = *self;
        sum.degree = self.degree.max(other.degree);
        for (c, o) in sum.coefficients.iter_mut().zip(&other.coefficients) {
            *c += o;
        }
        sum
    }

    /// A bound on the absolute values of the polynomial.
    #[inline]
    pub fn size(&self) -> f64 {
        let higher = self.coefficients[1..=self.degree].iter();
        self.coefficients[0].re.abs() + 2.0 * higher.map(|c| c.re.abs() + c.im.abs()).sum::<f64>()
    }

    /// Every real root of a polynomial that was computed from terms of size `scale`: where it changes
    /// sign, and where it touches zero to within [`NOISE`]. Roots nearer to each other than some 1e-7 may
    /// be given as one, and a double root as two or three.
    ///
    /// With `t = tan(θ/2)`, `(1 + t²)⁴ f` is a polynomial of degree eight in `t`. One half of the circle is
    /// `|t| ≤ 1`, and so is the other half after a rotation by π. In Bernstein's basis the coefficients
    /// bound the polynomial, and their signs count its roots: first on the four quarters of each half, which all
    /// are computed together. An interval that they do not decide is halved (de Casteljau's algorithm).
    pub fn roots(&self, scale: f64) -> Roots {
        if self.size() <= NOISE * scale || !self.size().is_finite() {
            return Roots::Everywhere;
        }
        // The factor (1 + t²)⁴ is at most 16, at the ends.
        let noise = 16.0 * NOISE * scale;
        let mut brackets: Vec<Bracket> = Vec::with_capacity(HALF);
        let arch = FourWide::new();
        for (half, on_half) in [1.0, -1.0].into_iter().zip(arch.dispatch(OnQuarters(self))) {
            for (quarter, low) in [-1.0, -0.5, 0.0, 0.5].into_iter().enumerate() {
                let bernstein = on_half.map(|of_quarters| of_quarters[quarter]);
                Interval { bernstein, half, low, width: 0.5 }.isolate(noise, &mut brackets);
            }
        }
        let powers = self.expanded(&POWERS);
        let mut roots: Vec<Complex<f64>> = Vec::with_capacity(brackets.len());
        let mut doubtful = false;
        for together in brackets.chunks(LANES) {
            let found = arch.dispatch(InBrackets { powers: &powers, brackets: together });
            for (bracket, t) in together.iter().zip(found) {
                let square = t * t;
                let e = Complex::new(1.0 - square, 2.0 * t) * bracket.half / (1.0 + square);
                doubtful |= !bracket.simple
                    || roots.last().is_some_and(|r| (r - e).norm_sqr() < NEAR * NEAR);
                roots.push(e);
            }
        }
        Roots::At { roots, doubtful }
    }

    /// The coefficients of `(1 + t²)⁴ f` in the bases of a table, those of the terms of even and of odd degree.
    #[inline(always)]
    fn expanded<const N: usize>(&self, table: &Table<N>) -> [[[f64; N]; COEFFICIENTS]; 2] {
        let mut sums = [[[0.0; N]; COEFFICIENTS]; 2];
        for (k, (c, row)) in self.coefficients[..=self.degree].iter().zip(table).enumerate() {
            let sums = &mut sums[k % 2];
            for i in 0..COEFFICIENTS {
                let [re, im] = &row[i];
                for lane in 0..N {
                    sums[i][lane] += c.re * re[lane] - c.im * im[lane];
                }
            }
        }
        sums
    }
}

/// The sums of the terms of even and of odd degree, on some half of the circle each: a rotation by π changes the sign of
/// the odd ones.
#[inline(always)]
fn summed<const N: usize>(
    [even, odd]: &[[[f64; N]; COEFFICIENTS]; 2],
    halves: [f64; LANES],
) -> [[f64; LANES]; COEFFICIENTS] {
    let at = |numbers: &[f64; N], lane: usize| numbers[lane % N];
    std::array::from_fn(|i| {
        std::array::from_fn(|lane| at(&even[i], lane) + halves[lane] * at(&odd[i], lane))
    })
}

/// Bernstein coefficients on the four quarters of both halves of the circle, with the instructions of the processor at hand.
struct OnQuarters<'a>(&'a Trigonometric);

impl WithSimd for OnQuarters<'_> {
    type Output = [[[f64; LANES]; COEFFICIENTS]; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let sums = self.0.expanded(&QUARTERS);
        [summed(&sums, [1.0; LANES]), summed(&sums, [-1.0; LANES])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::angle::unit;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    /// The product of `sin((θ − r) / 2)` over eight angles `r`: a polynomial of degree four with these roots.
    fn with_roots(roots: &[f64]) -> Trigonometric {
        // sin((θ−r)/2) sin((θ−s)/2) = (cos((r−s)/2) − cos(θ − (r+s)/2)) / 2
        let pair = |r: f64, s: f64| {
            let (sin, cos) = (0.5 * (r + s)).sin_cos();
            Trigonometric::linear([0.5 * (0.5 * (r - s)).cos(), -0.5 * cos, -0.5 * sin])
        };
        roots.chunks(2).map(|p| pair(p[0], p[1])).reduce(|f, g| f.times(&g)).unwrap()
    }

    fn angles(found: &Roots) -> Vec<f64> {
        let Roots::At { roots: found, .. } = found else { panic!("everywhere") };
        found.iter().map(|e| e.arg()).collect()
    }

    fn apart(a: f64, b: f64) -> f64 {
        (unit(a) - unit(b)).norm()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        /// Eight roots that are at least a hundredth apart are all found, each once.
        #[test]
        fn roots_that_are_apart_are_found_once(start in 0.0..TAU, distances in proptest::array::uniform8(0.01..1.0_f64)) {
            let whole: f64 = distances.iter().sum();
            let mut at = start;
            let roots = distances.map(|distance| { at += distance.max(0.01 * whole) * TAU / (1.1 * whole); at });
            let f = with_roots(&roots);
            let found = angles(&f.roots(f.size()));
            prop_assert_eq!(found.len(), 8);
            for r in roots {
                let nearest = found.iter().map(|s| apart(r, *s)).fold(1.0, f64::min);
                // The neighbours' factors divide the rounding.
                prop_assert!(nearest < 1e-6, "{} {:e}", r, nearest);
            }
        }

        /// A double root is found, although rounding may lift the polynomial off zero there.
        #[test]
        fn double_roots_are_found(at in -4.0..4.0_f64, others in proptest::array::uniform6(0.3..1.0_f64), lift in -1.0..1.0_f64) {
            let mut next = at;
            let others = others.map(|distance| { next += 0.8 * distance; next });
            let mut roots = vec![at, at];
            roots.extend(others);
            let f = with_roots(&roots);
            let size = f.size();
            let lifted = f.plus(&Trigonometric::linear([0.1 * NOISE * size * lift, 0.0, 0.0]));
            let found = angles(&lifted.roots(size));
            let near = found.iter().filter(|r| apart(at, **r) < 1e-5).count();
            prop_assert!((1..=3).contains(&near), "{} near {}, {:?}", near, at, found);
            prop_assert!(found.len() - near == 6, "{:?}", found);
        }

        /// The roots are those that a scan finds: sign changes between 10,000 points of the circle.
        #[test]
        fn as_many_as_a_scan_finds(c in proptest::array::uniform9(-1.0..1.0_f64)) {
            let f = Trigonometric {
                coefficients: [
                    Complex::new(c[0], 0.0), Complex::new(c[1], c[2]), Complex::new(c[3], c[4]),
                    Complex::new(c[5], c[6]), Complex::new(c[7], c[8]),
                ],
                degree: 4,
            };
            let count = 10_000;
            let at = |i: usize| {
                let theta = TAU * i as f64 / count as f64;
                // This is the definition.
                (1..=4).fold(c[0], |sum, k| {
                    let (sin, cos) = (k as f64 * theta).sin_cos();
                    sum + 2.0 * (c[2 * k - 1] * cos - c[2 * k] * sin)
                })
            };
            let changes = (0..count).filter(|&i| (at(i) > 0.0) != (at(i + 1) > 0.0)).count();
            let found = angles(&f.roots(f.size()));
            let close = found.iter().enumerate().any(|(i, r)| {
                found[..i].iter().any(|s| apart(*r, *s) < 2e-3)
            });
            prop_assert!(found.len() == changes || close, "{} {}", found.len(), changes);
            for r in &found {
                prop_assert!(f.value(unit(*r)).abs() < 1e-12, "{:e}", f.value(unit(*r)));
            }
        }
    }

    #[test]
    fn nothing_is_zero_everywhere() {
        let zero = Trigonometric::linear([0.0; 3]);
        assert_eq!(zero.roots(1.0), Roots::Everywhere);
        let cosine = Trigonometric::linear([0.0, 1.0, 0.0]);
        let found = angles(&cosine.roots(1.0));
        assert_eq!(found.len(), 2, "the ends of the two halves are roots once: {found:?}");
        assert_eq!(angles(&Trigonometric::linear([2.0, 1.0, 0.0]).roots(3.0)), [0.0; 0]);
    }
}
