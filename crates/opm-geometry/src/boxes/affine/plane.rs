//! Points of the plane, and complex numbers, over a box.

use super::Affine;
use nalgebra::Complex;
use std::ops::{Add, Mul, Sub};

/// The largest distance from a point, as a share of that point's distance from the origin, at which a logarithm is nearly
/// linear.
const NEAR: f64 = 0.3;

/// A point of the plane, or a complex number, over a box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<const N: usize> {
    pub re: Affine<N>,
    pub im: Affine<N>,
}

impl<const N: usize> Plane<N> {
    pub fn constant(z: Complex<f64>) -> Self {
        Self { re: Affine::constant(z.re), im: Affine::constant(z.im) }
    }

    /// An unknown unit vector.
    pub(super) fn anywhere(spread: &[f64; N]) -> Self {
        let any = Affine::unknown(0.0, 1.0, spread);
        Self { re: any, im: any }
    }

    pub fn conj(self) -> Self {
        Self { im: -self.im, ..self }
    }

    /// The sum with another one times 1 or -1.
    #[inline(never)]
    fn sum(&self, other: &Self, sign: f64) -> Self {
        Self { re: self.re.sum(&other.re, sign), im: self.im.sum(&other.im, sign) }
    }

    #[inline(never)]
    fn product(&self, other: &Self) -> Self {
        Self {
            re: Affine::products([[&self.re, &other.re], [&-self.im, &other.im]]),
            im: Affine::products([[&self.re, &other.im], [&self.im, &other.re]]),
        }
    }

    /// The product with a complex number.
    #[inline(never)]
    fn turned(&self, z: Complex<f64>) -> Self {
        Self { re: self.re * z.re - self.im * z.im, im: self.re * z.im + self.im * z.re }
    }

    pub fn scaled(self, factor: Affine<N>) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }

    pub fn norm_sqr(self) -> Affine<N> {
        self.re.square() + self.im.square()
    }

    /// The third component of the cross product `self × other`.
    pub fn cross(self, other: Self) -> Affine<N> {
        Affine::products([[&self.re, &other.im], [&-self.im, &other.re]])
    }

    pub fn spread(&self) -> [f64; N] {
        let (re, im) = (self.re.spread(), self.im.spread());
        std::array::from_fn(|i| re[i] + im[i])
    }

    /// The unit vector in its direction.
    pub fn direction(self) -> Self {
        self.divided(self.norm_sqr().recip_sqrt())
    }

    /// The unit vector that results from multiplying by `factor`.
    #[inline(never)]
    pub fn divided(&self, factor: Affine<N>) -> Self {
        let unit = self.scaled(factor);
        // The bounds are wider than the set of unit vectors, which is then the better bound.
        let wide = |x: &Affine<N>| x.radius() > 1.0 || x.radius().is_nan();
        if wide(&unit.re) && wide(&unit.im) {
            return Self::anywhere(&unit.spread());
        }
        unit
    }

    /// The argument, in `(-π, π]` in the middle of the box and continuous over the box.
    #[inline(never)]
    pub fn argument(&self) -> Affine<N> {
        let middle = Complex::new(self.re.centre, self.im.centre);
        let angle = middle.im.atan2(middle.re);
        let length = middle.norm();
        let unknown = || Affine::unknown(angle, std::f64::consts::TAU, &self.spread());
        if length == 0.0 || !length.is_finite() {
            return unknown();
        }
        // Of `log(1 + z)`, the imaginary part: `|log(1 + z) - z + z²/2| <= |z|³/3 / (1 - |z|)`, and that of `z²/2` is the
        // product of both components.
        let z = *self * (middle.conj() / (length * length)) - Complex::ONE;
        let [re, im] = [z.re.furthest(), z.im.furthest()];
        let size = re.hypot(im);
        if size < NEAR {
            let bound = re * im + size.powi(3) / (3.0 * (1.0 - size));
            return z.im + angle + Affine::unknown(0.0, bound, &z.spread());
        }
        let ahead = *self * (middle.conj() / length);
        if ahead.re.low() > 0.0 { (ahead.im * ahead.re.recip()).atan() + angle } else { unknown() }
    }
}

impl<const N: usize> Add for Plane<N> {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        self.sum(&other, 1.0)
    }
}

impl<const N: usize> Sub for Plane<N> {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        self.sum(&other, -1.0)
    }
}

impl<const N: usize> Mul for Plane<N> {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        self.product(&other)
    }
}

impl<const N: usize> Add<Complex<f64>> for Plane<N> {
    type Output = Self;

    #[inline]
    fn add(self, z: Complex<f64>) -> Self {
        Self { re: self.re + z.re, im: self.im + z.im }
    }
}

impl<const N: usize> Sub<Complex<f64>> for Plane<N> {
    type Output = Self;

    fn sub(self, z: Complex<f64>) -> Self {
        self + -z
    }
}

impl<const N: usize> Mul<Complex<f64>> for Plane<N> {
    type Output = Self;

    #[inline]
    fn mul(self, z: Complex<f64>) -> Self {
        self.turned(z)
    }
}
