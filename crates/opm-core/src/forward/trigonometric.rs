//! Trigonometric polynomials of degree up to four, and all of their real roots.

use nalgebra::Complex;

/// The highest degree: that of the polynomial of three conditions in a planar or a spherical section.
const DEGREE: usize = 4;
/// The degree of the polynomial in the tangent of the half angle.
const HALF: usize = 2 * DEGREE;
/// The number of its coefficients.
const COEFFICIENTS: usize = HALF + 1;

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
    /// bound the polynomial, and their signs count its roots. An interval that they do not decide is halved
    /// (de Casteljau's algorithm).
    pub fn roots(&self, scale: f64) -> Roots {
        if self.size() <= NOISE * scale || !self.size().is_finite() {
            return Roots::Everywhere;
        }
        // The factor (1 + t²)⁴ is at most 16, at the ends.
        let noise = 16.0 * NOISE * scale;
        let mut roots: Vec<Complex<f64>> = Vec::with_capacity(HALF);
        let mut doubtful = false;
        let (powers, bernstein) = (self.expanded(&POWERS), self.expanded(&BERNSTEIN));
        for half in [1.0, -1.0] {
            let on_half = |[even, odd]: &[[f64; COEFFICIENTS]; 2]| {
                std::array::from_fn(|i| even[i] + half * odd[i])
            };
            let polynomial = Polynomial { powers: on_half(&powers), noise };
            let whole = Interval { bernstein: on_half(&bernstein), low: -1.0, width: 2.0 };
            polynomial.isolate(&whole, &mut |t, simple| {
                let square = t * t;
                let e = Complex::new(1.0 - square, 2.0 * t) * half / (1.0 + square);
                doubtful |=
                    !simple || roots.last().is_some_and(|r| (r - e).norm_sqr() < NEAR * NEAR);
                roots.push(e);
            });
        }
        Roots::At { roots, doubtful }
    }

    /// The coefficients of `(1 + t²)⁴ f` in the basis of a table, those of the terms of even and of odd degree.
    /// A rotation by π changes the sign of the odd ones.
    fn expanded(&self, table: &Table) -> [[f64; COEFFICIENTS]; 2] {
        let mut sums = [[0.0; COEFFICIENTS]; 2];
        for (k, (c, row)) in self.coefficients[..=self.degree].iter().zip(table).enumerate() {
            let [re, im] = row;
            for (i, sum) in sums[k % 2].iter_mut().enumerate() {
                *sum += c.re * re[i] - c.im * im[i];
            }
        }
        sums
    }
}

/// Real and imaginary parts of `(1 + i t)^(4+k) (1 − i t)^(4−k)`, which is `(1 + t²)⁴ exp(i k θ)`: their
/// coefficients in some basis, for each `k`. Those for `k > 0` are doubled, because `−k` adds as much.
type Table = [[[f64; COEFFICIENTS]; 2]; DEGREE + 1];

/// The table for the powers of `t`.
const POWERS: Table = table([[1, 0], [0, 1]], false);
/// The table for Bernstein's basis on `-1 ≤ t ≤ 1`, where the factor `1 + i t` runs from `1 − i` to `1 + i`.
const BERNSTEIN: Table = table([[1, -1], [1, 1]], true);

/// The products of eight linear factors `1 + i t` or `1 − i t`, in Gaussian integers. `factor` has the
/// coefficients of `1 + i t` in the basis. For Bernstein's basis the products are divided by binomial
/// coefficients.
const fn table(factor: [[i64; 2]; 2], over_binomials: bool) -> Table {
    let mut table = [[[0.0; COEFFICIENTS]; 2]; DEGREE + 1];
    let mut k = 0;
    while k <= DEGREE {
        let mut product = [[0_i64; 2]; COEFFICIENTS];
        product[0] = [1, 0];
        let mut n = 0;
        while n < HALF {
            let sign = if n < DEGREE + k { 1 } else { -1 };
            let mut next = [[0_i64; 2]; COEFFICIENTS];
            let mut j = 0;
            while j <= n {
                let [a, b] = product[j];
                let mut step = 0;
                while step < 2 {
                    let [c, d] = [factor[step][0], sign * factor[step][1]];
                    next[j + step][0] += a * c - b * d;
                    next[j + step][1] += a * d + b * c;
                    step += 1;
                }
                j += 1;
            }
            product = next;
            n += 1;
        }
        let mut j = 0;
        let mut binomial = 1;
        while j <= HALF {
            let over = if over_binomials { binomial } else { 1 };
            let twice = if k > 0 { 2.0 } else { 1.0 };
            table[k][0][j] = twice * product[j][0] as f64 / over as f64;
            table[k][1][j] = twice * product[j][1] as f64 / over as f64;
            binomial = binomial * (HALF - j) as i64 / (j + 1) as i64;
            j += 1;
        }
        k += 1;
    }
    table
}

/// A polynomial on an interval.
struct Interval {
    /// The Bernstein coefficients on the interval.
    bernstein: [f64; COEFFICIENTS],
    /// The low end of the interval.
    low: f64,
    /// The width of the interval.
    width: f64,
}

/// A polynomial in the half angle's tangent.
struct Polynomial {
    /// Its coefficients by rising powers.
    powers: [f64; COEFFICIENTS],
    /// Where it is below this, it is zero.
    noise: f64,
}

impl Polynomial {
    /// Finds the roots on an interval, in ascending order. `found` is called with each root, and with whether it is
    /// certainly simple.
    fn isolate(&self, interval: &Interval, found: &mut impl FnMut(f64, bool)) {
        let Interval { bernstein: ref b, low, width } = *interval;
        let noise = self.noise;
        let (least, most) =
            b.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), &x| (l.min(x), m.max(x)));
        if least > noise || most < -noise {
            return;
        }
        if changes_sign_once(b, noise) {
            return found(self.root(interval), true);
        }
        let rising = b.windows(2).all(|pair| pair[1] > pair[0]);
        if rising || b.windows(2).all(|pair| pair[1] < pair[0]) {
            // A root at the common end of two intervals belongs to the right one.
            let (first, last) = (b[0], b[HALF]);
            let crosses =
                if rising { first <= 0.0 && last > 0.0 } else { first >= 0.0 && last < 0.0 };
            if crosses {
                found(self.root(interval), true);
            }
            return;
        }
        // The polynomial is below the rounding here. Unless it is convex or concave, in which case halving
        // leads to its turning point, nothing more can be found.
        let flat = least.abs().max(most.abs()) <= noise && !is_convex_or_concave(b);
        if width <= SHORTEST || flat {
            return found(low + 0.5 * width, false);
        }
        for half in interval.halves() {
            self.isolate(&half, found);
        }
    }

    /// The root on an interval at whose ends the polynomial has opposite signs, by Newton's method from where the
    /// polygon of the coefficients changes its sign. Steps that leave the interval, or that do not become shorter,
    /// are replaced by halving it.
    fn root(&self, interval: &Interval) -> f64 {
        /// Every second step halves the interval or the step at least: this number reaches the last bit.
        const STEPS: usize = 128;
        /// After a step that is shorter, the next one is below rounding: Newton's method squares the error.
        const CLOSE: f64 = 1e-9;
        let (mut low, mut high) = (interval.low, interval.low + interval.width);
        let rising = interval.bernstein[HALF] > 0.0;
        let (mut t, mut last) = (interval.polygon_root(rising), interval.width);
        for _ in 0..STEPS {
            let (mut value, mut slope) = (0.0, 0.0);
            for c in self.powers.iter().rev() {
                slope = slope * t + value;
                value = value * t + c;
            }
            if (value > 0.0) == rising {
                high = t;
            } else {
                low = t;
            }
            let newton = t - value / slope;
            let step = (newton - t).abs();
            if step <= CLOSE && newton >= low - CLOSE && newton <= high + CLOSE {
                return newton.clamp(interval.low, interval.low + interval.width);
            }
            let inside = newton > low && newton < high;
            let next = if inside && step <= 0.5 * last { newton } else { 0.5 * (low + high) };
            last = (next - t).abs();
            if last <= 4.0 * f64::EPSILON {
                return next;
            }
            t = next;
        }
        t
    }
}

/// Whether the coefficients change their sign exactly once, whatever the rounding. Then there is exactly one
/// root, by Descartes' rule of signs in Bernstein's basis.
fn changes_sign_once(b: &[f64; COEFFICIENTS], noise: f64) -> bool {
    let sign = if b[HALF] > 0.0 { 1.0 } else { -1.0 };
    let before = b.iter().take_while(|&&x| sign * x < -noise).count();
    let after = b.iter().rev().take_while(|&&x| sign * x > noise).count();
    // Of two neighbours without a certain sign, each could have that of the other's side.
    before > 0 && after > 0 && before + after >= HALF
}

/// Whether the second derivative keeps its sign on the interval.
fn is_convex_or_concave(b: &[f64; COEFFICIENTS]) -> bool {
    let second = |w: &[f64]| w[0] - 2.0 * w[1] + w[2];
    b.windows(3).all(|w| second(w) > 0.0) || b.windows(3).all(|w| second(w) < 0.0)
}

impl Interval {
    /// The two halves, by de Casteljau's algorithm.
    fn halves(&self) -> [Self; 2] {
        let (mut left, mut right) = ([0.0; COEFFICIENTS], self.bernstein);
        for (i, left) in left.iter_mut().enumerate() {
            *left = right[0];
            for j in 0..HALF - i {
                right[j] = 0.5 * (right[j] + right[j + 1]);
            }
        }
        let width = 0.5 * self.width;
        [
            Self { bernstein: left, low: self.low, width },
            Self { bernstein: right, low: self.low + width, width },
        ]
    }

    /// Where the polygon of the coefficients changes its sign for the first time.
    fn polygon_root(&self, rising: bool) -> f64 {
        let b = &self.bernstein;
        let side = b.iter().take_while(|&&x| (x > 0.0) != rising).count().clamp(1, HALF);
        let (before, after) = (b[side - 1], b[side]);
        let share = (side as f64 - 1.0 + before / (before - after)) / HALF as f64;
        self.low + self.width * share.clamp(0.0, 1.0)
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
