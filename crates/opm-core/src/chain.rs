//! Closed forms of one chain of joints inside one motion subspace.
//!
//! A chain has exactly as many freedoms as its subspace has dimensions, so a displacement of that
//! subspace fixes its joints up to a sign. Every chain works in its subspace's own frame, on
//! displacements from home (`q = 0` is home, where the displacement is the identity), and finds
//! rotations as unit vectors: no trigonometry until somebody asks for an angle.
//!
//! What holds for all of them:
//! * `inverse` followed by `forward` returns the target.
//! * On the rim of reach, within [`RIM`], the two branches meet and both are given.
//! * An angle that the target leaves free is given as zero, its home value.
//! * A chain whose freedoms are dependent everywhere (a zero-length link between two revolutes, two
//!   parallel sliders) is refused when it is built.

pub mod cylindrical;
pub mod planar;
pub mod spherical;
pub mod translational;

use crate::joint::Quantity;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// How far beyond its reach a chain still answers, as a share of its size: rounding in a target
/// that lies on the rim is of the order of 1e-15 and must not decide, and a pose on the rim counts
/// as inside.
pub const RIM: f64 = 1e-12;

/// Shorter than this, as a share of the chain's size, a link or an angle between axes is zero.
const DEGENERATE: f64 = 1e-9;

/// One of the two solutions of a two-valued choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Branch {
    /// The solution with the plus sign.
    Plus,
    /// The solution with the minus sign.
    Minus,
}

impl Branch {
    /// Both, plus first.
    pub const BOTH: [Self; 2] = [Self::Plus, Self::Minus];

    /// `1.0` or `-1.0`.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

/// A joint's displacement from home, as a chain finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A rotation by the argument of this unit vector: an angle modulo a turn.
    Turn(Complex<f64>),
    /// A length, or an angle that counts whole turns.
    Value(f64),
}

impl Amount {
    /// The amount as a number; of a turn, the one in `(-π, π]`.
    #[inline]
    pub fn value(self) -> f64 {
        match self {
            Self::Turn(e) => e.im.atan2(e.re),
            Self::Value(value) => value,
        }
    }

    /// The amount as a number; of a turn, the one nearest to `reference`.
    #[inline]
    pub fn nearest(self, reference: f64) -> f64 {
        match self {
            Self::Turn(_) => {
                let value = self.value();
                value + TAU * ((reference - value) / TAU).round()
            }
            Self::Value(value) => value,
        }
    }

    /// The opposite displacement.
    #[inline]
    #[must_use]
    pub fn inverse(self) -> Self {
        match self {
            Self::Turn(e) => Self::Turn(e.conj()),
            Self::Value(value) => Self::Value(-value),
        }
    }

    /// The rotation as a unit vector, whichever way it is held.
    #[inline]
    pub fn turn(self) -> Complex<f64> {
        match self {
            Self::Turn(e) => e,
            Self::Value(value) => unit(value),
        }
    }
}

/// How far a target is out of a chain's reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// By how much, radians or metres; positive, not NaN, infinite where no number tells.
    pub excess: f64,
    /// What `excess` measures.
    pub quantity: Quantity,
}

impl Gap {
    fn length(excess: f64) -> Self {
        Self::new(excess, Quantity::Length)
    }

    fn angle(excess: f64) -> Self {
        Self::new(excess, Quantity::Angle)
    }

    fn new(excess: f64, quantity: Quantity) -> Self {
        let excess = if excess.is_nan() { f64::INFINITY } else { excess.max(f64::MIN_POSITIVE) };
        Self { excess, quantity }
    }
}

/// Why joints do not make a closed-form chain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// The freedoms are dependent in every configuration.
    #[error("{0}")]
    Dependent(&'static str),
    /// No closed form covers this order of joints.
    #[error("no closed form for {0}")]
    NotCovered(&'static str),
}

/// `e(angle)`, the unit vector at an angle.
#[inline]
pub(crate) fn unit(angle: f64) -> Complex<f64> {
    let (sin, cos) = angle.sin_cos();
    Complex::new(cos, sin)
}

/// The direction of `z`, or of one where `z` is zero against `size`.
#[inline]
fn direction(z: Complex<f64>, size: f64) -> Complex<f64> {
    let square = z.norm_sqr();
    // `z` is a product of two lengths: each may be as short as RIM.
    let shortest = RIM * RIM * size;
    if square > shortest * shortest { z * square.sqrt().recip() } else { Complex::new(1.0, 0.0) }
}
