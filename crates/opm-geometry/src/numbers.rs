//! Numbers over which closed forms are written once.
//!
//! A closed form says what is done with points, directions and angles. What these are made of says what comes out:
//!
//! | [`Real`] | what comes out |
//! |---|---|
//! | `f64` | the joints at one pose; in a loop without branches, at many |
//! | numbers over a box (`enclosure`) | bounds of the joints at all poses of a box |
//! | names (`opm-generate`) | source code |
//!
//! The operations are those of reals, of complex numbers as vectors of the plane, and of vectors of space, not of their
//! components alone: source code stays readable, and a box knows more of a length than of two squares.
//!
//! A mechanism's own numbers may be of a simpler type `C` than those of the target, `T`: over a box of poses they are
//! mostly constant. [`Over<C>`] is a number `T` that can be combined with them. Dual and complex numbers have all that
//! [`Real`] asks for, too.

mod joint;

pub use joint::JointDisplacement;
#[doc(hidden)]
pub use joint::nearest;

use crate::numeric::angle::unit;
use nalgebra::Complex;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, Mul, Neg, Not, Sub};

/// A share of a size below which numbers count as rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Its name in source code.
    pub name: &'static str,
    /// What it is, for a comment there.
    pub meaning: &'static str,
    /// The share.
    pub share: f64,
    /// The share where numbers have single precision.
    pub single: f64,
}

/// How far beyond its reach a chain still closes, as a share of its size. A pose on the boundary of reach counts as inside;
/// the rounding of such a pose is of the order of 1e-15 and must not decide.
pub const REACH: Tolerance = Tolerance {
    name: "REACH",
    meaning: "How far beyond its reach a chain still closes, as a share of its size: rounding must not decide there.",
    share: 1e-12,
    single: 2e-6,
};

/// A link length, as a share of the chain's size, or an angle between axes, radians, below this counts as zero.
pub const DEGENERATE: Tolerance = Tolerance {
    name: "DEGENERATE",
    meaning: "A length or a sine below this share counts as zero.",
    share: 1e-9,
    single: 1e-6,
};

/// A real number.
pub trait Real:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Mul<Self::Sign, Output = Self>
{
    /// A vector of the plane, as a complex number.
    type Plane: Plane<Real = Self>;
    /// What a joint is displaced by.
    type Joint: Joint<Real = Self>;
    /// Whether something holds. Over a box nothing is asked: there, bounds are of those poses at which it does.
    type Truth: Truth;
    /// The sign of a branch, 1 or -1.
    type Sign: Copy + Neg<Output = Self::Sign>;

    /// A number that is the same everywhere.
    fn constant(value: f64) -> Self;
    /// The number, if it is the same everywhere.
    fn known(self) -> Option<f64>;
    /// The square.
    fn square(self) -> Self;
    /// The quotient.
    fn over(self, by: Self) -> Self;
    /// The root of a number that is not negative but for rounding, which counts as zero.
    fn root(self) -> Self;
    /// The number without its sign.
    fn absolute(self) -> Self;
    /// The larger one.
    fn larger(self, other: Self) -> Self;
    /// The unit vector at this angle.
    fn unit(self) -> Self::Plane;
    /// A cosine or a sine, without what rounding makes of it beyond one.
    fn at_most_one(self) -> Self;
    /// `times` times the tolerance of this size.
    fn share(self, tolerance: Tolerance, times: f64) -> Self;
    /// Whether it is at least as large as another number; false where either is not a number.
    fn at_least(self, other: Self) -> Self::Truth;
    /// Whether it is at most `size` and a tolerance away from zero; false where it is not a number.
    fn within(self, size: f64, tolerance: Tolerance) -> Self::Truth;
    /// Whether it is further from zero than a tolerance; false where it is not a number.
    fn exceeds(self, tolerance: Tolerance) -> Self::Truth;
    /// The same, with a name in source code.
    #[inline(always)]
    #[must_use]
    fn named(self, _: &'static str) -> Self {
        self
    }
}

/// A vector of the plane, as a complex number.
pub trait Plane:
    Copy
    + Debug
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
{
    /// Its components.
    type Real: Real<Plane = Self>;
    /// Whether a pivot turns clockwise.
    type Sense: Copy + Debug + PartialEq;

    /// The vector with these components.
    fn new(re: Self::Real, im: Self::Real) -> Self;
    /// The component along the first axis.
    fn re(self) -> Self::Real;
    /// The component along the second axis.
    fn im(self) -> Self::Real;
    /// The complex conjugate.
    #[must_use]
    fn conj(self) -> Self;
    /// The product with a real number.
    #[must_use]
    fn scaled(self, by: Self::Real) -> Self;
    /// The quotient by a real number.
    #[must_use]
    fn per(self, by: Self::Real) -> Self;
    /// The square of its length.
    fn norm_sqr(self) -> Self::Real;
    /// Its length.
    fn length(self) -> Self::Real;
    /// The third component of the cross product.
    fn cross(self, other: Self) -> Self::Real;
    /// The scalar product.
    fn inner(self, other: Self) -> Self::Real;
    /// The coordinates along two directions that are not parallel.
    fn along(self, first: Self, second: Self) -> [Self::Real; 2];
    /// The same as a direction; where it is zero compared to a size, so that its angle is free, that of the angle zero. It
    /// is a product of two lengths, and so is the size: each may be as short as [`REACH`].
    #[must_use]
    fn direction(self, size: Self::Real) -> Self;
    /// The same, with a name in source code.
    #[inline(always)]
    #[must_use]
    fn named(self, _: &'static str) -> Self {
        self
    }
}

/// A joint's displacement from home.
pub trait Joint: Copy {
    /// The numbers that it consists of.
    type Real: Real<Joint = Self>;

    /// A rotation by the angle of a vector of any length.
    fn direction(vector: <Self::Real as Real>::Plane) -> Self;
    /// A rotation by an angle, which does not count revolutions.
    fn angle(angle: Self::Real) -> Self;
    /// A length, or an angle that counts revolutions.
    fn value(value: Self::Real) -> Self;
    /// The opposite displacement.
    #[must_use]
    fn inverse(self) -> Self;
}

/// Whether something holds.
pub trait Truth: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// What always holds.
    const YES: Self;
    /// What never does.
    const NO: Self;
}

/// A number of the target, which can be combined with those of the mechanism.
pub trait Over<C: Real>:
    Real<Plane: PlaneOver<C::Plane>>
    + Add<C, Output = Self>
    + Sub<C, Output = Self>
    + Mul<C, Output = Self>
{
    /// The mechanism's number as one of the target.
    fn from_constant(constant: C) -> Self;
    /// The quotient by a number of the mechanism.
    fn per(self, by: C) -> Self;
    /// An angle counter-clockwise as that of a pivot in its sense.
    #[must_use]
    fn in_sense(self, sense: <C::Plane as Plane>::Sense) -> Self;
    /// The angle by which the first of two links turns whose outer end is at `reach` from its pivot, as the sum of the
    /// angles of the reach and in the triangle; `None` where that says no more than the vector does.
    #[inline(always)]
    fn swing(_reach: Self::Plane, _links: [C::Plane; 2], _sign: Self::Sign) -> Option<Self> {
        None
    }
}

/// A vector of the target, which can be combined with those of the mechanism.
pub trait PlaneOver<Z: Plane>:
    Plane + Add<Z, Output = Self> + Sub<Z, Output = Self> + Mul<Z, Output = Self>
{
    /// The mechanism's vector as one of the target.
    fn from_constant(constant: Z) -> Self;
    /// A rotation counter-clockwise as that of a pivot in its sense.
    #[must_use]
    fn in_sense(self, sense: Z::Sense) -> Self;
    /// The coordinates along two directions of the mechanism that are not parallel.
    #[inline(always)]
    fn along_constants(self, first: Z, second: Z) -> [Self::Real; 2] {
        self.along(Self::from_constant(first), Self::from_constant(second))
    }
}

impl Real for f64 {
    type Plane = Complex<f64>;
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
