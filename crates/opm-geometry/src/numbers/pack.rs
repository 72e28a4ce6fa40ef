//! The numbers of several poses at once: one loop over each operation, which compilers turn into vectors.

use super::{Joint, Plane, REACH, Real, Rotation, Tolerance, Truth};
use crate::numeric::angle::{atan2, near, unit};
use std::ops::{Add, Mul, Neg, Not, Sub};

/// A number for each of some poses.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Pack(pub [f64; Pack::POSES]);

/// A vector of the plane for each of some poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackPlane {
    /// Its first component.
    pub re: Pack,
    /// Its second component.
    pub im: Pack,
}

/// A rotation for each of some poses, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackRotation(pub [[Pack; 3]; 3]);

/// What a joint is displaced by at each of some poses.
#[derive(Clone, Copy, Debug)]
pub enum PackJoint {
    /// An angle, as a vector in its direction.
    Direction(PackPlane),
    /// A number.
    Value(Pack),
}

/// Whether something holds at each of some poses.
#[derive(Clone, Copy, Debug)]
pub struct PackTruth(pub [bool; Pack::POSES]);

impl Pack {
    /// How many poses there are.
    pub const POSES: usize = 8;

    // Loops, since what the standard library does with arrays is not inlined everywhere.
    #[inline(always)]
    fn each(mut self, f: impl Fn(f64) -> f64) -> Self {
        for of in &mut self.0 {
            *of = f(*of);
        }
        self
    }

    #[inline(always)]
    fn with(mut self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        for i in 0..Self::POSES {
            self.0[i] = f(self.0[i], other.0[i]);
        }
        self
    }

    #[inline(always)]
    fn test(self, f: impl Fn(f64) -> bool) -> PackTruth {
        let mut truth = [false; Self::POSES];
        for (truth, value) in truth.iter_mut().zip(self.0) {
            *truth = f(value);
        }
        PackTruth(truth)
    }
}

macro_rules! operators {
    ($($trait:ident $method:ident $op:tt),+) => {$(
        impl $trait for Pack {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(other, |a, b| a $op b)
            }
        }
        impl $trait<f64> for Pack {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                self.each(|a| a $op other)
            }
        }
    )+};
}

operators!(Add add +, Sub sub -, Mul mul *);

impl Neg for Pack {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|a| -a)
    }
}

impl Not for PackTruth {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(self.0.map(|of| !of))
    }
}

impl Truth for PackTruth {
    const YES: Self = Self([true; Pack::POSES]);
    const NO: Self = Self([false; Pack::POSES]);
}

impl Real for Pack {
    type Plane = PackPlane;
    type Space = [Pack; 3];
    type Rotation = PackRotation;
    type Joint = PackJoint;
    type Truth = PackTruth;
    type Sign = f64;

    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self([value; Pack::POSES])
    }

    #[inline(always)]
    fn known(self) -> Option<f64> {
        None
    }

    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }

    #[inline(always)]
    fn over(self, by: Self) -> Self {
        self.with(by, |a, b| a / b)
    }

    #[inline(always)]
    fn products([a, b]: [Self; 2], [c, d]: [Self; 2]) -> Self {
        a * b + c * d
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.each(|a| a.max(0.0).sqrt())
    }

    #[inline(always)]
    fn absolute(self) -> Self {
        self.each(f64::abs)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.with(other, f64::max)
    }

    #[inline(always)]
    fn unit(self) -> PackPlane {
        let units = self.0.map(unit);
        let [re, im] = [units.map(|e| e.re), units.map(|e| e.im)].map(Pack);
        PackPlane { re, im }
    }

    #[inline(always)]
    fn reduced(self) -> Self {
        self.each(|a| near(a, 0.0))
    }

    /// It is not the same for all.
    fn side(self) -> Option<f64> {
        None
    }

    #[inline(always)]
    fn at_most_one(self) -> Self {
        self.each(|a| a.clamp(-1.0, 1.0))
    }

    #[inline(always)]
    fn share(self, tolerance: Tolerance, times: f64) -> Self {
        self * (times * tolerance.share)
    }

    #[inline(always)]
    fn at_least(self, other: Self) -> PackTruth {
        (self - other).test(|a| a >= 0.0)
    }

    #[inline(always)]
    fn within(self, size: f64, tolerance: Tolerance) -> PackTruth {
        self.test(|a| a.abs() <= size + tolerance.share)
    }

    #[inline(always)]
    fn exceeds(self, tolerance: Tolerance) -> PackTruth {
        self.test(|a| a.abs() > tolerance.share)
    }
}

impl Add for PackPlane {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for PackPlane {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul for PackPlane {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            re: self.re * other.re - self.im * other.im,
            im: self.re * other.im + self.im * other.re,
        }
    }
}

impl Neg for PackPlane {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl Plane for PackPlane {
    type Real = Pack;
    type Sense = bool;

    #[inline(always)]
    fn new(re: Pack, im: Pack) -> Self {
        Self { re, im }
    }

    #[inline(always)]
    fn re(self) -> Pack {
        self.re
    }

    #[inline(always)]
    fn im(self) -> Pack {
        self.im
    }

    #[inline(always)]
    fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    #[inline(always)]
    fn scaled(self, by: Pack) -> Self {
        Self { re: self.re * by, im: self.im * by }
    }

    #[inline(always)]
    fn per(self, by: Pack) -> Self {
        Self { re: self.re.over(by), im: self.im.over(by) }
    }

    #[inline(always)]
    fn norm_sqr(self) -> Pack {
        self.inner(self)
    }

    #[inline(always)]
    fn length(self) -> Pack {
        self.norm_sqr().root()
    }

    #[inline(always)]
    fn cross(self, other: Self) -> Pack {
        self.re * other.im - self.im * other.re
    }

    #[inline(always)]
    fn inner(self, other: Self) -> Pack {
        self.re * other.re + self.im * other.im
    }

    #[inline(always)]
    fn normalised(self) -> Self {
        self.per(self.length())
    }

    #[inline(always)]
    fn argument(self) -> Pack {
        self.im.with(self.re, atan2)
    }

    #[inline(always)]
    fn along(self, first: Self, second: Self) -> [Pack; 2] {
        let n = first.cross(self).over(first.cross(second));
        [(self - second.scaled(n)).inner(first), n]
    }

    #[inline(always)]
    fn direction(self, size: Pack) -> Self {
        let shortest = (size * (REACH.share * REACH.share)).square();
        let square = self.norm_sqr();
        let long = |i: usize| square.0[i] > shortest.0[i];
        let or = |part: Pack, else_: f64| {
            Pack(std::array::from_fn(|i| if long(i) { part.0[i] } else { else_ }))
        };
        Self { re: or(self.re, 1.0), im: or(self.im, 0.0) }
    }
}

impl Rotation for PackRotation {
    type Real = Pack;

    #[inline(always)]
    fn from_rows(rows: [[Pack; 3]; 3]) -> Self {
        Self(rows)
    }

    #[inline(always)]
    fn rows(self) -> [[Pack; 3]; 3] {
        self.0
    }
}

impl Joint for PackJoint {
    type Real = Pack;

    #[inline(always)]
    fn direction(vector: PackPlane) -> Self {
        Self::Direction(vector)
    }

    #[inline(always)]
    fn angle(angle: Pack) -> Self {
        Self::Direction(angle.unit())
    }

    #[inline(always)]
    fn value(value: Pack) -> Self {
        Self::Value(value)
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        match self {
            Self::Direction(e) => Self::Direction(e.conj()),
            Self::Value(value) => Self::Value(-value),
        }
    }

    #[inline(always)]
    fn unit(self) -> PackPlane {
        match self {
            Self::Direction(e) => e.normalised(),
            Self::Value(value) => value.unit(),
        }
    }

    #[inline(always)]
    fn number(self) -> Pack {
        match self {
            Self::Direction(e) => e.argument(),
            Self::Value(value) => value,
        }
    }
}
