//! The displacement of a joint with one degree of freedom.

use crate::numeric::angle::{self, unit};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// The angle plus full revolutions that is nearest to `reference`.
#[inline]
pub fn nearest(angle: f64, reference: f64) -> f64 {
    let revolutions = (reference - angle) / TAU;
    if revolutions.abs() <= 0.5 { angle } else { angle + TAU * revolutions.round() }
}

/// The square of a length that is one to within this is corrected to first order.
const NEARLY_UNIT: f64 = 1e-8;

/// A joint's displacement from home, in the form in which a chain's closed form gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointDisplacement {
    /// An angle modulo 2π, as a complex number that points in its direction. The number is *not
    /// normalised*: it may have any length. Zero stands for an angle that is free; its value is zero.
    Direction(Complex<f64>),
    /// A number: a length in metres, or an angle in radians that counts full revolutions.
    Value(f64),
}

impl JointDisplacement {
    /// The displacement as a number, in radians or metres. A direction gives the angle in `(-π, π]`.
    #[inline(always)]
    pub fn value(self) -> f64 {
        match self {
            Self::Direction(e) => angle::atan2(e.im, e.re),
            Self::Value(value) => value,
        }
    }

    /// The displacement as a number, in radians or metres. A direction gives the angle nearest to
    /// `reference`; a number stays as it is.
    #[inline]
    pub fn nearest(self, reference: f64) -> f64 {
        match self {
            Self::Direction(_) => nearest(self.value(), reference),
            Self::Value(value) => value,
        }
    }

    /// The sum of two displacements of one joint.
    #[inline]
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Value(a), Self::Value(b)) => Self::Value(a + b),
            (Self::Direction(_), _) | (_, Self::Direction(_)) => {
                Self::Direction(self.unit_direction() * other.unit_direction())
            }
        }
    }

    /// The opposite displacement.
    #[inline(always)]
    #[must_use]
    pub fn inverse(self) -> Self {
        match self {
            Self::Direction(e) => Self::Direction(e.conj()),
            Self::Value(value) => Self::Value(-value),
        }
    }

    /// The unit complex number in the direction of the angle, for either form.
    #[inline(always)]
    pub fn unit_direction(self) -> Complex<f64> {
        match self {
            Self::Direction(e) => {
                let square = e.norm_sqr();
                // Most closed forms give a unit vector, up to rounding: one step of Newton's method for the inverse root
                // corrects its length, to less than rounding. A root and a division take longer than the rest of a chain.
                if (square - 1.0).abs() <= NEARLY_UNIT {
                    return e * (1.5 - 0.5 * square);
                }
                let over = 1.0 / if square > 0.0 { square.sqrt() } else { 1.0 };
                let [re, im] = if square > 0.0 { [e.re, e.im] } else { [1.0, 0.0] };
                Complex::new(re * over, im * over)
            }
            Self::Value(value) => unit(value),
        }
    }
}
