//! The functions of numbers, of the standard library or of the crate `libm`: `core` has none of them.

// A mechanism may not need all of them.
#![allow(dead_code)]

use super::Real;

/// A constant of `f64` and of `f32`.
pub const fn by_type(double: f64, float: f64) -> Real {
    if size_of::<Real>() == size_of::<f32>() { float as Real } else { double as Real }
}

pub fn abs(x: Real) -> Real {
    if x < 0.0 { -x } else { x }
}

pub fn max(a: Real, b: Real) -> Real {
    if a > b { a } else { b }
}

pub fn min(a: Real, b: Real) -> Real {
    if a < b { a } else { b }
}

#[cfg(feature = "std")]
mod functions {
    extern crate std;
    use super::Real;

    pub fn sqrt(x: Real) -> Real {
        x.sqrt()
    }

    pub fn sin(x: Real) -> Real {
        x.sin()
    }

    pub fn cos(x: Real) -> Real {
        x.cos()
    }

    pub fn asin(x: Real) -> Real {
        x.asin()
    }

    pub fn acos(x: Real) -> Real {
        x.acos()
    }

    pub fn round(x: Real) -> Real {
        x.round()
    }

    pub fn ceil(x: Real) -> Real {
        x.ceil()
    }

    pub fn atan2(y: Real, x: Real) -> Real {
        y.atan2(x)
    }
}

#[cfg(not(feature = "std"))]
mod functions {
    use super::Real;

    /// Defines functions by those of `libm` for `f64` and for `f32`.
    macro_rules! of_libm {
        ($($name:ident, $float:ident, $($x:ident)+;)+) => {$(
            pub fn $name($($x: Real),+) -> Real {
                if size_of::<Real>() == size_of::<f32>() {
                    libm::$float($($x as f32),+) as Real
                } else {
                    libm::$name($($x as f64),+) as Real
                }
            }
        )+};
    }

    of_libm! {
        sqrt, sqrtf, x;
        sin, sinf, x;
        cos, cosf, x;
        asin, asinf, x;
        acos, acosf, x;
        round, roundf, x;
        ceil, ceilf, x;
        atan2, atan2f, y x;
    }
}

pub use functions::*;
