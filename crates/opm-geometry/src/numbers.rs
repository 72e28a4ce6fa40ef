//! Numbers over which closed forms are written once.
//!
//! A closed form says what is done with points, directions and angles. What these are made of says what comes out:
//!
//! | [`Real`] | what comes out |
//! |---|---|
//! | `f64` | the joints at one pose; in a loop without branches, at many |
//! | numbers of eight poses (`pack`) | the joints at all of them |
//! | numbers over a box (`opm_geometry::boxes`) | bounds of the joints at all poses of a box |
//! | handles of expressions (`opm-generate`) | source code |
//!
//! The operations are those of reals, of complex numbers as vectors of the plane, and of vectors of space, not of their
//! components alone: source code stays readable, and a box knows more of a length than of two squares.
//!
//! A mechanism's own numbers may be of a simpler type `C` than those of the target, `T`: over a box of poses they are
//! mostly constant. [`Over<C>`] is a number `T` that can be combined with them.

mod joint;
#[doc(hidden)]
pub mod pack;
mod pose;

pub use joint::JointDisplacement;
#[doc(hidden)]
pub use joint::nearest;

use nalgebra::Vector3;
use std::fmt::Debug;
use std::ops::{Add, Mul, Neg, Not, Sub};

/// A share of a size below which numbers count as rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Its name in source code.
    pub name: &'static str,
    /// The share.
    pub share: f64,
    /// The share where numbers have single precision.
    pub single: f64,
}

/// How far beyond its reach a chain still closes, as a share of its size. A pose on the boundary of reach counts as inside;
/// the rounding of such a pose is of the order of 1e-15 and must not decide.
pub const REACH: Tolerance = Tolerance { name: "REACH", share: 1e-12, single: 2e-6 };

/// A link length, as a share of the chain's size, or an angle between axes, radians, below this counts as zero.
pub const DEGENERATE: Tolerance = Tolerance { name: "DEGENERATE", share: 1e-9, single: 1e-6 };

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
    /// A vector of space.
    type Space: Space<Real = Self>;
    /// A rotation of space.
    type Rotation: Rotation<Real = Self>;
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
    /// `a b + c d`
    fn products(ab: [Self; 2], cd: [Self; 2]) -> Self;
    /// The root of a number that is not negative but for rounding, which counts as zero.
    fn root(self) -> Self;
    /// The number without its sign.
    fn absolute(self) -> Self;
    /// The larger one.
    fn larger(self, other: Self) -> Self;
    /// The unit vector at this angle.
    fn unit(self) -> Self::Plane;
    /// An angle less full revolutions, within half of one.
    fn reduced(self) -> Self;
    /// Its sign, positive for zero; `None` where it is not the same everywhere.
    fn side(self) -> Option<Self::Sign>;
    /// An angle of which nothing is known, but that it depends on this number.
    #[must_use]
    #[inline(always)]
    fn any_angle(self) -> Self {
        self
    }
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
    /// Computes something, which is part of what is around it. Numbers whose operations are calls keep it apart: there is one copy
    /// of its code for all places that it is part of.
    #[inline(always)]
    fn compute<R>(something: impl FnOnce() -> R) -> R {
        something()
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
    /// The unit vector in its direction.
    #[must_use]
    fn normalised(self) -> Self;
    /// Its angle, within half a revolution of zero.
    fn argument(self) -> Self::Real;
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

/// A vector of space.
pub trait Space: Copy + Debug + PartialEq {
    /// Its components.
    type Real: Real<Space = Self>;

    /// The vector with these components.
    fn new(x: Self::Real, y: Self::Real, z: Self::Real) -> Self;
    /// Its components.
    fn parts(self) -> [Self::Real; 3];
    /// The cross product.
    #[must_use]
    #[inline(always)]
    fn crossed(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.parts(), other.parts());
        let minor = |a: Self::Real, z: Self::Real, c: Self::Real, y: Self::Real| {
            Real::products([a, z], [-c, y])
        };
        Self::new(minor(b, z, c, y), minor(c, x, a, z), minor(a, y, b, x))
    }
    /// The sum of this vector and a multiple of another one.
    #[must_use]
    #[inline(always)]
    fn plus(self, by: Self::Real, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.parts(), other.parts());
        Self::new(a + x * by, b + y * by, c + z * by)
    }
    /// The product with a number.
    #[must_use]
    #[inline(always)]
    fn scaled(self, by: Self::Real) -> Self {
        let [x, y, z] = self.parts();
        Self::new(x * by, y * by, z * by)
    }
    /// The scalar product.
    #[inline(always)]
    fn inner(self, other: Self) -> Self::Real {
        let ([a, b, c], [x, y, z]) = (self.parts(), other.parts());
        Real::products([a, x], [b, y]) + c * z
    }
    /// The same, with a name in source code.
    #[inline(always)]
    #[must_use]
    fn named(self, _: &'static str) -> Self {
        self
    }
}

/// Numbers that have no vectors of their own have three of them.
impl<T: Real<Space = Self>> Space for [T; 3] {
    type Real = T;

    fn new(x: T, y: T, z: T) -> Self {
        [x, y, z]
    }

    fn parts(self) -> Self {
        self
    }
}

/// A rotation of space.
pub trait Rotation: Copy + Debug + PartialEq {
    /// Its components.
    type Real: Real<Rotation = Self>;

    /// The rotation with these rows.
    fn from_rows(rows: [[Self::Real; 3]; 3]) -> Self;
    /// Its rows.
    fn rows(self) -> [[Self::Real; 3]; 3];
    /// The inverse.
    #[must_use]
    #[inline(always)]
    fn inverse(self) -> Self {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.rows();
        Self::from_rows([[a, d, g], [b, e, h], [c, f, i]])
    }
    /// The image of a vector.
    #[inline(always)]
    fn image(self, v: <Self::Real as Real>::Space) -> <Self::Real as Real>::Space {
        let ([[a, b, c], [d, e, f], [g, h, i]], [x, y, z]) = (self.rows(), v.parts());
        Space::new(
            Real::products([a, x], [b, y]) + c * z,
            Real::products([d, x], [e, y]) + f * z,
            Real::products([g, x], [h, y]) + i * z,
        )
    }
    /// The product of this one, on the left, and a rotation about the third direction: the first two columns rotate.
    #[must_use]
    #[inline(always)]
    fn after_turn(self, e: <Self::Real as Real>::Plane) -> Self {
        let (re, im) = (e.re(), e.im());
        Self::from_rows(self.rows().map(|[x, y, z]| {
            [Real::products([x, re], [y, im]), Real::products([y, re], [-x, im]), z]
        }))
    }
    /// The product of a rotation about the third direction, on the left, and this one: the first two rows rotate.
    #[must_use]
    #[inline(always)]
    fn before_turn(self, e: <Self::Real as Real>::Plane) -> Self {
        let (re, im) = (e.re(), e.im());
        let [[a, b, c], [d, e, f], third] = self.rows();
        let first = |x: Self::Real, y: Self::Real| Real::products([x, re], [-y, im]);
        let second = |x: Self::Real, y: Self::Real| Real::products([x, im], [y, re]);
        Self::from_rows([
            [first(a, d), first(b, e), first(c, f)],
            [second(a, d), second(b, e), second(c, f)],
            third,
        ])
    }
}

/// A joint's displacement from home.
pub trait Joint: Copy + Debug {
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
    /// The unit vector in the direction of its angle.
    fn unit(self) -> <Self::Real as Real>::Plane;
    /// The displacement as a number.
    fn number(self) -> Self::Real;
}

/// Whether something holds.
pub trait Truth: Copy + Not<Output = Self> {
    /// What always holds.
    const YES: Self;
    /// What never does.
    const NO: Self;
    /// The same. What a closed form computes from here on is of use only where this holds: source code returns otherwise.
    #[must_use]
    #[inline(always)]
    fn checked(self) -> Self {
        self
    }
}

/// A number of the target, which can be combined with those of the mechanism.
pub trait Over<C: Real>:
    Real<Plane: PlaneOver<C::Plane>, Space: SpaceOver<C::Space>, Rotation: RotationOver<C>>
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
    /// The scalar product with a vector of the mechanism.
    #[inline(always)]
    fn dot(self, constant: Z) -> Self::Real {
        self.inner(Self::from_constant(constant))
    }
    /// The coordinates along two directions of the mechanism that are not parallel.
    #[inline(always)]
    fn along_constants(self, first: Z, second: Z) -> [Self::Real; 2] {
        self.along(Self::from_constant(first), Self::from_constant(second))
    }
}

/// A vector of space of the target, which can be combined with those of the mechanism.
pub trait SpaceOver<V: Space>: Space {
    /// The scalar product with a vector of the mechanism.
    fn against(self, constant: V) -> Self::Real;
}

impl<T: Real<Space = Self>> SpaceOver<Vector3<f64>> for [T; 3] {
    fn against(self, constant: Vector3<f64>) -> T {
        let [x, y, z] = self;
        x * constant.x + y * constant.y + z * constant.z
    }
}

impl<T: Real<Space = Self>> SpaceOver<Self> for [T; 3] {
    fn against(self, [u, v, w]: Self) -> T {
        let [x, y, z] = self;
        T::products([x, u], [y, v]) + z * w
    }
}

/// A rotation of the target, which can be combined with the numbers of the mechanism.
pub trait RotationOver<C: Real>: Rotation {
    /// The image of a vector of the mechanism.
    fn apply(self, constant: C::Space) -> <Self::Real as Real>::Space;
    /// What is rotated to a vector of the mechanism.
    fn apply_back(self, constant: C::Space) -> <Self::Real as Real>::Space;
    /// The product of this one, on the left, and a rotation of the mechanism.
    #[must_use]
    fn after(self, constant: C::Rotation) -> Self;
}
