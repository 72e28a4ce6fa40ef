//! The numbers of one pose.

use super::{
    Joint, JointDisplacement, Over, Plane, PlaneOver, REACH, Real, Rotation, RotationOver, Space,
    SpaceOver, Tolerance, Truth,
};
use crate::numeric::angle::{atan2, near, unit};
use nalgebra::{Complex, Matrix3, Vector3};

impl Real for f64 {
    type Plane = Complex<f64>;
    type Space = Vector3<f64>;
    type Rotation = Matrix3<f64>;
    type Joint = JointDisplacement;
    type Truth = bool;
    type Sign = f64;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn known(self) -> Option<f64> {
        Some(self)
    }

    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }

    #[inline(always)]
    fn over(self, by: Self) -> Self {
        self / by
    }

    #[inline(always)]
    fn products([a, b]: [Self; 2], [c, d]: [Self; 2]) -> Self {
        a * b + c * d
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.max(0.0).sqrt()
    }

    #[inline(always)]
    fn absolute(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }

    #[inline(always)]
    fn unit(self) -> Complex<f64> {
        unit(self)
    }

    #[inline(always)]
    fn reduced(self) -> Self {
        near(self, 0.0)
    }

    #[inline(always)]
    fn side(self) -> Option<Self> {
        Some(if self < 0.0 { -1.0 } else { 1.0 })
    }

    #[inline(always)]
    fn at_most_one(self) -> Self {
        self.clamp(-1.0, 1.0)
    }

    #[inline(always)]
    fn share(self, tolerance: Tolerance, times: f64) -> Self {
        times * tolerance.share * self
    }

    #[inline(always)]
    fn at_least(self, other: Self) -> bool {
        self >= other
    }

    #[inline(always)]
    fn within(self, size: f64, tolerance: Tolerance) -> bool {
        self.abs() <= size + tolerance.share
    }

    #[inline(always)]
    fn exceeds(self, tolerance: Tolerance) -> bool {
        self.abs() > tolerance.share
    }
}

impl Truth for bool {
    const YES: Self = true;
    const NO: Self = false;
}

impl Plane for Complex<f64> {
    type Real = f64;
    type Sense = bool;

    #[inline(always)]
    fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    #[inline(always)]
    fn re(self) -> f64 {
        self.re
    }

    #[inline(always)]
    fn im(self) -> f64 {
        self.im
    }

    #[inline(always)]
    fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    #[inline(always)]
    fn scaled(self, by: f64) -> Self {
        self * by
    }

    #[inline(always)]
    fn per(self, by: f64) -> Self {
        self / by
    }

    #[inline(always)]
    fn norm_sqr(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// With protection from overflow.
    #[inline(always)]
    fn length(self) -> f64 {
        self.norm()
    }

    #[inline(always)]
    fn cross(self, other: Self) -> f64 {
        self.re * other.im - self.im * other.re
    }

    #[inline(always)]
    fn inner(self, other: Self) -> f64 {
        self.re * other.re + self.im * other.im
    }

    #[inline(always)]
    fn argument(self) -> f64 {
        atan2(self.im, self.re)
    }

    #[inline(always)]
    fn normalised(self) -> Self {
        self / self.norm_sqr().sqrt()
    }

    /// The first is computed from the rounded second one, so that their sum is the vector even where the directions are
    /// nearly parallel.
    #[inline(always)]
    fn along(self, first: Self, second: Self) -> [f64; 2] {
        let n = Plane::cross(first, self) / Plane::cross(first, second);
        let rest = self - second * n;
        [rest.re * first.re + rest.im * first.im, n]
    }

    #[inline(always)]
    fn direction(self, size: f64) -> Self {
        let shortest = REACH.share * REACH.share * size;
        let long = self.norm_sqr() > shortest * shortest;
        Self { re: if long { self.re } else { 1.0 }, im: if long { self.im } else { 0.0 } }
    }
}

impl Joint for JointDisplacement {
    type Real = f64;

    #[inline(always)]
    fn direction(vector: Complex<f64>) -> Self {
        Self::Direction(vector)
    }

    #[inline(always)]
    fn angle(angle: f64) -> Self {
        Self::Direction(unit(angle))
    }

    #[inline(always)]
    fn value(value: f64) -> Self {
        Self::Value(value)
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        JointDisplacement::inverse(self)
    }

    #[inline(always)]
    fn unit(self) -> Complex<f64> {
        self.unit_direction()
    }

    #[inline(always)]
    fn number(self) -> f64 {
        self.value()
    }
}

impl Over<f64> for f64 {
    #[inline(always)]
    fn from_constant(constant: f64) -> Self {
        constant
    }

    #[inline(always)]
    fn per(self, by: f64) -> Self {
        self / by
    }

    #[inline(always)]
    fn in_sense(self, reversed: bool) -> Self {
        if reversed { -self } else { self }
    }
}

impl PlaneOver<Complex<f64>> for Complex<f64> {
    #[inline(always)]
    fn from_constant(constant: Complex<f64>) -> Self {
        constant
    }

    #[inline(always)]
    fn in_sense(self, reversed: bool) -> Self {
        Self { re: self.re, im: if reversed { -self.im } else { self.im } }
    }
}

impl Space for Vector3<f64> {
    type Real = f64;

    #[inline(always)]
    fn new(x: f64, y: f64, z: f64) -> Self {
        Self::new(x, y, z)
    }

    #[inline(always)]
    fn parts(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }
}

impl Rotation for Matrix3<f64> {
    type Real = f64;

    #[inline(always)]
    fn from_rows([[a, b, c], [d, e, f], [g, h, i]]: [[f64; 3]; 3]) -> Self {
        Self::new(a, b, c, d, e, f, g, h, i)
    }

    #[inline(always)]
    fn rows(self) -> [[f64; 3]; 3] {
        let row = |i| [self[(i, 0)], self[(i, 1)], self[(i, 2)]];
        [row(0), row(1), row(2)]
    }
}

impl SpaceOver<Vector3<f64>> for Vector3<f64> {
    #[inline(always)]
    fn against(self, constant: Vector3<f64>) -> f64 {
        constant.x * self.x + constant.y * self.y + constant.z * self.z
    }
}

impl RotationOver<f64> for Matrix3<f64> {
    #[inline(always)]
    fn apply(self, constant: Vector3<f64>) -> Vector3<f64> {
        self * constant
    }

    #[inline(always)]
    fn apply_back(self, constant: Vector3<f64>) -> Vector3<f64> {
        self.tr_mul(&constant)
    }

    #[inline(always)]
    fn after(self, constant: Matrix3<f64>) -> Self {
        self * constant
    }
}
