//! Points and directions of a plane, as complex numbers.

use super::*;

functions! {
    #[inline]
    fn complex_of(re: Real, im: Real) -> Complex {
        Complex::made(re, im)
    }

    #[inline]
    fn plus(a: Complex, b: Complex) -> Complex {
        complex_of(a.re + b.re, a.im + b.im)
    }

    #[inline]
    fn minus(a: Complex, b: Complex) -> Complex {
        complex_of(a.re - b.re, a.im - b.im)
    }

    #[inline]
    fn times(a: Complex, b: Complex) -> Complex {
        complex_of(a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re)
    }

    #[inline]
    fn conjugate(z: Complex) -> Complex {
        complex_of(z.re, -z.im)
    }

    #[inline]
    fn scaled(z: Complex, s: Real) -> Complex {
        complex_of(z.re * s, z.im * s)
    }

    /// a . b
    #[inline]
    fn inner(a: Complex, b: Complex) -> Real {
        a.re * b.re + a.im * b.im
    }

    /// a x b
    #[inline]
    fn across(a: Complex, b: Complex) -> Real {
        a.re * b.im - a.im * b.re
    }

    /// The unit vector in the direction of an angle.
    #[inline]
    fn unit(angle: Real) -> Complex {
        complex_of(cos(angle), sin(angle))
    }

    /// The unit vector in the direction of z; that of the angle zero where z is zero.
    #[inline]
    fn normal(z: Complex) -> Complex {
        name!(square = inner(z, z));
        square.gt(0.0).choose(z * (1.0 / sqrt(square)), complex_of(1.0, 0.0))
    }

    /// z as a direction; where it is zero compared to size, so that its angle is free, that of the angle zero.
    #[inline]
    fn direction(z: Complex, size: Real) -> Complex {
        name!(shortest = REACH * REACH * size);
        inner(z, z).gt(shortest * shortest).choose(z, complex_of(1.0, 0.0))
    }

    /// The angle of a direction, within half a revolution of zero.
    fn angle(z: Complex) -> Real {
        atan2(z.im, z.re)
    }

    /// A rotation as the angle of a pivot, by its sense.
    #[inline]
    fn turn(rotation: Complex, sense: Real) -> Complex {
        complex_of(rotation.re, rotation.im * sense)
    }
}

/// Operators that call the functions.
macro_rules! operators {
    ($($op:ident $method:ident $other:ty: $function:ident;)+) => {$(
        impl std::ops::$op<$other> for Complex {
            type Output = Self;
            fn $method(self, other: $other) -> Self {
                $function(self, other)
            }
        }
    )+};
}

operators! {
    Add add Complex: plus;
    Sub sub Complex: minus;
    Mul mul Complex: times;
    Mul mul Real: scaled;
    Mul mul f64: scaled;
}

impl std::ops::Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        scaled(self, -1.0)
    }
}
