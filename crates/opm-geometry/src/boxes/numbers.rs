//! Numbers over a box of poses, as closed forms take them: their bounds hold for those poses at which the chain closes.

use super::affine::{Affine, Plane, WIDE};
use super::opening;
use super::target::{Enclosed, Rotation};
use crate::numbers::{self, Over, PlaneOver, Real, RotationOver, SpaceOver, Tolerance, Truth};
use nalgebra::{Complex, Matrix3, Vector3};
use std::f64::consts::{PI, TAU};
use std::ops::{Neg, Not};

/// Whether something holds: over a box it is not asked.
#[derive(Clone, Copy, Debug)]
pub struct Unasked;

impl Not for Unasked {
    type Output = Self;

    fn not(self) -> Self {
        self
    }
}

impl Truth for Unasked {
    const YES: Self = Self;
    const NO: Self = Self;
}

impl<const N: usize> Real for Affine<N> {
    type Plane = Plane<N>;
    type Space = [Affine<N>; 3];
    type Rotation = Rotation<N>;
    type Joint = Enclosed<N>;
    type Truth = Unasked;
    type Sign = f64;

    fn constant(value: f64) -> Self {
        Self::constant(value)
    }

    fn known(self) -> Option<f64> {
        None
    }

    fn square(self) -> Self {
        Self::square(&self)
    }

    fn over(self, by: Self) -> Self {
        self * by.recip()
    }

    fn products([a, b]: [Self; 2], [c, d]: [Self; 2]) -> Self {
        Self::products([[&a, &b], [&c, &d]])
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn absolute(self) -> Self {
        if self.low() >= 0.0 {
            self
        } else if self.high() <= 0.0 {
            -self
        } else {
            let half = 0.5 * self.furthest();
            Self::unknown(half, half, &self.spread())
        }
    }

    fn larger(self, other: Self) -> Self {
        (self + other + (self - other).absolute()) * 0.5
    }

    fn unit(self) -> Plane<N> {
        self.unit_vector()
    }

    fn reduced(self) -> Self {
        self - TAU * (self.centre / TAU).round()
    }

    fn side(self) -> Option<f64> {
        if self.low() > 0.0 { Some(1.0) } else { (self.high() < 0.0).then_some(-1.0) }
    }

    fn any_angle(self) -> Self {
        Self::unknown(0.0, PI, &self.spread())
    }

    /// A root of what is left of it up to one is bounded all the same.
    fn at_most_one(self) -> Self {
        self
    }

    fn share(self, tolerance: Tolerance, times: f64) -> Self {
        self * (times * tolerance.share)
    }

    fn at_least(self, _: Self) -> Unasked {
        Unasked
    }

    fn within(self, _: f64, _: Tolerance) -> Unasked {
        Unasked
    }

    fn exceeds(self, _: Tolerance) -> Unasked {
        Unasked
    }

    #[inline(never)]
    fn compute<R>(something: impl FnOnce() -> R) -> R {
        something()
    }
}

impl<const N: usize> Neg for Plane<N> {
    type Output = Self;

    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl<const N: usize> numbers::Plane for Plane<N> {
    type Real = Affine<N>;
    type Sense = bool;

    fn new(re: Affine<N>, im: Affine<N>) -> Self {
        Self { re, im }
    }

    fn re(self) -> Affine<N> {
        self.re
    }

    fn im(self) -> Affine<N> {
        self.im
    }

    fn conj(self) -> Self {
        self.conj()
    }

    fn scaled(self, by: Affine<N>) -> Self {
        self.scaled(by)
    }

    fn per(self, by: Affine<N>) -> Self {
        self.scaled(by.recip())
    }

    fn norm_sqr(self) -> Affine<N> {
        self.norm_sqr()
    }

    fn length(self) -> Affine<N> {
        self.norm_sqr().sqrt()
    }

    fn cross(self, other: Self) -> Affine<N> {
        self.cross(other)
    }

    fn inner(self, other: Self) -> Affine<N> {
        Affine::products([[&self.re, &other.re], [&self.im, &other.im]])
    }

    fn normalised(self) -> Self {
        Self::direction(self)
    }

    fn argument(self) -> Affine<N> {
        Self::argument(&self)
    }

    fn along(self, first: Self, second: Self) -> [Affine<N>; 2] {
        let inverse = first.cross(second).recip();
        [self.cross(second) * inverse, first.cross(self) * inverse]
    }

    fn direction(self, _: Affine<N>) -> Self {
        self
    }
}

impl<const N: usize> numbers::Joint for Enclosed<N> {
    type Real = Affine<N>;

    fn direction(vector: Plane<N>) -> Self {
        Self::Direction(vector)
    }

    fn angle(angle: Affine<N>) -> Self {
        Self::Angle(angle)
    }

    fn value(value: Affine<N>) -> Self {
        Self::Value(value)
    }

    fn inverse(self) -> Self {
        self.inverse()
    }

    fn unit(self) -> Plane<N> {
        self.unit_vector()
    }

    fn number(self) -> Affine<N> {
        self.number()
    }
}

impl<const N: usize> numbers::Rotation for Rotation<N> {
    type Real = Affine<N>;

    fn from_rows(rows: [[Affine<N>; 3]; 3]) -> Self {
        Self(rows)
    }

    fn rows(self) -> [[Affine<N>; 3]; 3] {
        self.0
    }
}

impl<const N: usize> RotationOver<f64> for Rotation<N> {
    fn apply(self, constant: Vector3<f64>) -> [Affine<N>; 3] {
        Self::apply(&self, &constant)
    }

    fn apply_back(self, constant: Vector3<f64>) -> [Affine<N>; 3] {
        Self::apply_back(&self, &constant)
    }

    fn after(self, constant: Matrix3<f64>) -> Self {
        Self::after(&self, &constant)
    }
}

impl<const N: usize> RotationOver<Affine<N>> for Rotation<N> {
    fn apply(self, v: [Affine<N>; 3]) -> [Affine<N>; 3] {
        self.0.map(|row| row.against(v))
    }

    fn apply_back(self, v: [Affine<N>; 3]) -> [Affine<N>; 3] {
        numbers::Rotation::inverse(self).0.map(|row| row.against(v))
    }

    fn after(self, other: Self) -> Self {
        let columns = numbers::Rotation::inverse(other).0;
        Self(self.0.map(|row| columns.map(|column| row.against(column))))
    }
}

/// With a mechanism's numbers that are constant.
impl<const N: usize> Over<f64> for Affine<N> {
    fn from_constant(constant: f64) -> Self {
        Self::constant(constant)
    }

    fn per(self, by: f64) -> Self {
        self * (1.0 / by)
    }

    fn in_sense(self, reversed: bool) -> Self {
        if reversed { -self } else { self }
    }

    /// Where the angle in the triangle has a bounded second derivative, and that of the reach is known well.
    fn swing(reach: Plane<N>, [first, second]: [Complex<f64>; 2], sign: f64) -> Option<Self> {
        let squares = [first, second].map(|link| link.norm_sqr());
        let opening = opening::planar(reach.norm_sqr(), squares)?;
        let angle = reach.argument() - opening * sign - first.arg();
        (angle.radius() <= WIDE).then_some(angle)
    }
}

/// With those that depend on the box, in a leg whose lift leans.
impl<const N: usize> Over<Self> for Affine<N> {
    fn from_constant(constant: Self) -> Self {
        constant
    }

    fn per(self, by: Self) -> Self {
        by.recip() * self
    }

    fn in_sense(self, reversed: bool) -> Self {
        if reversed { -self } else { self }
    }
}

impl<const N: usize> PlaneOver<Complex<f64>> for Plane<N> {
    fn from_constant(constant: Complex<f64>) -> Self {
        Self::constant(constant)
    }

    fn in_sense(self, reversed: bool) -> Self {
        if reversed { self.conj() } else { self }
    }

    fn dot(self, constant: Complex<f64>) -> Affine<N> {
        self.re * constant.re + self.im * constant.im
    }

    fn along_constants(self, first: Complex<f64>, second: Complex<f64>) -> [Affine<N>; 2] {
        let over = 1.0 / numbers::Plane::cross(first, second);
        let [first, second] = [first, second].map(Self::constant);
        [self.cross(second) * over, first.cross(self) * over]
    }
}

impl<const N: usize> PlaneOver<Self> for Plane<N> {
    fn from_constant(constant: Self) -> Self {
        constant
    }

    fn in_sense(self, reversed: bool) -> Self {
        if reversed { self.conj() } else { self }
    }
}
