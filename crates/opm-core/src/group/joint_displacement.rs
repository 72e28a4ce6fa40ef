//! The displacement of one joint of one degree of freedom.

use crate::numeric::angle::{self, unit};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A joint's displacement from home, as a chain finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointDisplacement {
    /// A rotation, as a vector that points at its angle: an angle modulo a whole turn. The vector is *not
    /// normalised*, and may have any length. The zero vector stands for an angle that is free; its value
    /// is zero.
    Direction(Complex<f64>),
    /// A number: a length in metres, or an angle in radians that counts whole turns.
    Value(f64),
}

impl JointDisplacement {
    /// As a number; of a direction, the angle in `(-π, π]`.
    #[inline(always)]
    pub fn value(self) -> f64 {
        match self {
            Self::Direction(e) => angle::atan2(e.im, e.re),
            Self::Value(value) => value,
        }
    }

    /// As a number; of a direction, the angle nearest to `reference`.
    #[inline]
    pub fn nearest(self, reference: f64) -> f64 {
        match self {
            Self::Direction(_) => {
                let value = self.value();
                let turns = (reference - value) / TAU;
                if turns.abs() <= 0.5 { value } else { value + TAU * turns.round() }
            }
            Self::Value(value) => value,
        }
    }

    /// One after the other.
    #[inline]
    #[must_use]
    pub(crate) fn plus(self, other: Self) -> Self {
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

    /// The rotation as a unit vector, whichever way it is held.
    #[inline(always)]
    pub fn unit_direction(self) -> Complex<f64> {
        match self {
            Self::Direction(e) => {
                let square = e.norm_sqr();
                let length = if square > 0.0 { square.sqrt() } else { 1.0 };
                let [re, im] = if square > 0.0 { [e.re, e.im] } else { [1.0, 0.0] };
                Complex::new(re / length, im / length)
            }
            Self::Value(value) => unit(value),
        }
    }
}
