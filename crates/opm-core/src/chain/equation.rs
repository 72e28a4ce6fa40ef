//! Functions of one number, and the intervals in which they are too near to zero for their sign to be
//! certain.

use super::REACH_TOLERANCE;
use super::condition::VERGE;
use crate::group::JointDisplacement;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// A coefficient of `t` or of its cosine and sine below this counts as zero, as a fraction of the function's
/// largest coefficient.
const CONSTANT: f64 = 1e-12;

/// A function of `t` that has its zeros in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Equation {
    /// `c₀ + c₁ t + c₂ t²`; `c₂` is not negative where all its zeros are asked for ([`Equation::zeros`]).
    Polynomial([f64; 3]),
    /// `c₀ + c₁ cos t + c₂ sin t`.
    Harmonic([f64; 3]),
    /// `c₀ + c₁ t` modulo the period that is the second field.
    Periodic([f64; 2], f64),
}

/// The values of `t` in which zeros are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The lowest value.
    pub from: f64,
    /// The highest value.
    pub to: f64,
    /// The least distance between the values that matter: zeros that are closer need not be separated.
    pub step: f64,
}

impl Span {
    /// The largest absolute value in the span.
    pub(crate) fn reach(&self) -> f64 {
        self.from.abs().max(self.to.abs())
    }

    fn give(&self, from: f64, to: f64, found: &mut impl FnMut([f64; 2])) {
        // An end that is NaN is replaced by that of the span.
        if !(to < self.from || from > self.to) {
            found([from.max(self.from), to.min(self.to)]);
        }
    }
}

impl Equation {
    /// The zeros, at most two: numbers, or directions of unit length where the function has the period 2π.
    /// A constant has none.
    ///
    /// # Panics
    /// If the function has another period.
    pub(crate) fn roots(&self) -> Vec<JointDisplacement> {
        let value = JointDisplacement::Value;
        match *self {
            Self::Polynomial([c0, c1, 0.0]) => {
                let slope = c1.abs() > CONSTANT * c0.abs().max(1.0);
                if slope { vec![value(-c0 / c1)] } else { Vec::new() }
            }
            Self::Polynomial([c0, c1, c2]) => {
                let middle = -0.5 * c1 / c2;
                let square = middle * middle - c0 / c2;
                let roots =
                    (square >= 0.0).then(|| [middle - square.sqrt(), middle + square.sqrt()]);
                roots.into_iter().flatten().map(value).collect()
            }
            Self::Harmonic([c0, c1, c2]) => {
                let axis = Complex::new(c1, c2);
                let square = axis.norm_sqr();
                let length = square.sqrt();
                let below = (length - c0) * (length + c0);
                if below < 0.0 || length <= CONSTANT * c0.abs() || length == 0.0 {
                    return Vec::new();
                }
                let root = below.sqrt();
                let at = |root: f64| axis * Complex::new(-c0, root) / square;
                [root, -root].map(|root| JointDisplacement::Direction(at(root))).to_vec()
            }
            Self::Periodic(..) => {
                panic!("a function with a period of its own has no list of zeros")
            }
        }
    }

    /// The zero at which the function rises (`sign` is `1.0`) or falls (`-1.0`), the only zero if there is one, and
    /// `None` where it is zero everywhere. Its values count as zero below [`REACH_TOLERANCE`] times `unit`: there the
    /// two zeros meet.
    ///
    /// # Errors
    /// The value nearest to zero, if there is no zero.
    ///
    /// # Panics
    /// If the function has a period other than 2π.
    pub(crate) fn zero(&self, sign: f64, unit: f64) -> Result<Option<f64>, f64> {
        let constant =
            |c0: f64| if c0.abs() <= REACH_TOLERANCE * unit { Ok(None) } else { Err(c0) };
        match *self {
            Self::Harmonic([c0, c1, c2]) => {
                let amplitude = c1.hypot(c2);
                if amplitude <= VERGE * unit {
                    return constant(c0);
                }
                if c0.abs() > amplitude + REACH_TOLERANCE * unit {
                    return Err(c0 - amplitude.copysign(c0));
                }
                // c₀ + r cos(t - phase) rises before its crest.
                let phase = c2.atan2(c1);
                let height = ((amplitude - c0) * (amplitude + c0)).max(0.0).sqrt();
                Ok(Some(phase - sign * height.atan2(-c0)))
            }
            Self::Polynomial([c0, c1, c2]) if c2.abs() <= VERGE * c1.abs().max(unit) => {
                if c1.abs() <= VERGE * unit { constant(c0) } else { Ok(Some(-c0 / c1)) }
            }
            Self::Polynomial([c0, c1, c2]) => {
                // The slope at a zero is the root of this, with the sign of the branch.
                let square = c1 * c1 - 4.0 * c2 * c0;
                if square < -REACH_TOLERANCE * unit * unit {
                    return Err(c0 - 0.25 * c1 * c1 / c2);
                }
                Ok(Some((sign * square.max(0.0).sqrt() - c1) / (2.0 * c2)))
            }
            Self::Periodic(..) => {
                panic!("a function with a period of its own has more than two zeros")
            }
        }
    }

    /// The slope at `t = 0`.
    pub(crate) fn slope_at_zero(&self) -> f64 {
        match *self {
            Self::Polynomial([_, c1, _]) | Self::Periodic([_, c1], _) => c1,
            Self::Harmonic([_, _, c2]) => c2,
        }
    }

    /// Calls `found` with the intervals of a span in which the absolute value of the function is at most
    /// `tolerance`, in any order. Between them the function keeps its sign.
    #[inline]
    pub fn zeros(&self, tolerance: f64, span: &Span, found: &mut impl FnMut([f64; 2])) {
        match *self {
            Self::Polynomial([c0, c1, 0.0]) => linear(c0, c1, tolerance, span, found),
            Self::Polynomial([c0, c1, c2]) => {
                let middle = -0.5 * c1 / c2;
                let square = middle * middle - c0 / c2;
                let [inner, outer] = [square - tolerance / c2, square + tolerance / c2];
                if outer < 0.0 {
                    return;
                }
                let outer = outer.sqrt();
                if inner > 0.0 {
                    let inner = inner.sqrt();
                    span.give(middle - outer, middle - inner, found);
                    span.give(middle + inner, middle + outer, found);
                } else {
                    span.give(middle - outer, middle + outer, found);
                }
            }
            Self::Harmonic([c0, c1, c2]) => {
                // c₀ + r cos (t - phase)
                let r = c1.hypot(c2);
                let [high, low] = [tolerance - c0, -tolerance - c0];
                if high < -r || low > r {
                    return;
                }
                let phase = c2.atan2(c1);
                let near = if high >= r { 0.0 } else { (high / r).acos() };
                let far = if low <= -r { TAU / 2.0 } else { (low / r).acos() };
                for [from, to] in [[near, far], [-far, -near]] {
                    every(TAU, phase + from, phase + to, span, found);
                }
            }
            Self::Periodic([c0, c1], period) => {
                let repeat = (period / c1).abs();
                if !repeat.is_finite() {
                    let rest = c0 - period * (c0 / period).round();
                    linear(rest, 0.0, tolerance, span, found);
                } else if repeat > 2.0 * span.step {
                    let (zero, half) = (-c0 / c1, tolerance / c1.abs());
                    every(repeat, zero - half, zero + half, span, found);
                } else {
                    found([span.from, span.to]);
                }
            }
        }
    }
}

fn linear(c0: f64, c1: f64, tolerance: f64, span: &Span, found: &mut impl FnMut([f64; 2])) {
    if c1 != 0.0 {
        let (zero, half) = (-c0 / c1, tolerance / c1.abs());
        span.give(zero - half, zero + half, found);
    } else if c0.abs() <= tolerance {
        found([span.from, span.to]);
    }
}

/// Calls `found` with the interval shifted by every whole number of periods that meets the span.
fn every(period: f64, from: f64, to: f64, span: &Span, found: &mut impl FnMut([f64; 2])) {
    let mut count = ((span.from - to) / period).ceil();
    let last = ((span.to - from) / period).floor();
    while count <= last {
        span.give(from + count * period, to + count * period, found);
        count += 1.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding, where a double root loses half of the digits.
    const ROUNDING: f64 = 1e-7;

    fn at(equation: &Equation, t: f64) -> f64 {
        match *equation {
            Equation::Polynomial([c0, c1, c2]) => c0 + t * (c1 + t * c2),
            Equation::Harmonic([c0, c1, c2]) => c0 + c1 * t.cos() + c2 * t.sin(),
            Equation::Periodic([c0, c1], _) => c0 + c1 * t,
        }
    }

    proptest! {
        /// Roots are zeros, and between two of them, or without any, the function keeps its sign.
        #[test]
        fn roots_are_all_zeros(c0 in -2.0..2.0_f64, c1 in -2.0..2.0_f64, c2 in 0.01..2.0_f64) {
            let equations = [
                Equation::Polynomial([c0, c1, c2]),
                Equation::Polynomial([c0, c1, 0.0]),
                Equation::Harmonic([c0, c1, c2]),
            ];
            for equation in equations {
                let mut roots: Vec<f64> = equation.roots().iter().map(|root| root.value()).collect();
                roots.sort_by(f64::total_cmp);
                for root in &roots {
                    prop_assert!(at(&equation, *root).abs() < ROUNDING * (1.0 + root * root));
                }
                let mut sign = 0.0;
                for i in 0..200 {
                    let t = -std::f64::consts::PI + TAU * f64::from(i) / 200.0;
                    let value = at(&equation, t);
                    let crossed = roots.iter().any(|root| (root - t).abs() <= TAU / 200.0);
                    prop_assert!(crossed || sign * value >= 0.0, "{equation:?} at {t}");
                    sign = value.signum();
                }
            }
        }
    }

    /// On its branch the function rises or falls through zero; beyond its range, the nearest value is told.
    #[test]
    fn the_sign_of_the_slope_tells_two_zeros_apart() {
        for equation in [
            Equation::Polynomial([-1.0, 0.5, 2.0]),
            Equation::Polynomial([1.0, 0.5, -2.0]),
            Equation::Harmonic([0.3, -1.0, 0.4]),
        ] {
            for sign in [1.0, -1.0] {
                let zero = equation.zero(sign, 1.0).unwrap().unwrap();
                assert!(at(&equation, zero).abs() < 1e-15, "{equation:?}: {zero}");
                assert!(sign * (at(&equation, zero + 1e-3) - at(&equation, zero - 1e-3)) > 0.0);
            }
        }
        let touching = Equation::Harmonic([-1.0, 1.0, 0.0]);
        assert_eq!(touching.zero(1.0, 1.0), touching.zero(-1.0, 1.0));
        assert_eq!(Equation::Harmonic([1.5, 1.0, 0.0]).zero(1.0, 1.0), Err(0.5));
        assert_eq!(Equation::Polynomial([2.0, 2.0, 1.0]).zero(1.0, 1.0), Err(1.0));
        assert_eq!(Equation::Polynomial([3.0, -2.0, 0.0]).zero(-1.0, 1.0), Ok(Some(1.5)));
        assert_eq!(Equation::Polynomial([0.0; 3]).zero(1.0, 1.0), Ok(None));
        assert_eq!(Equation::Harmonic([0.2, 0.0, 0.0]).zero(1.0, 1.0), Err(0.2));
    }

    /// A joint that a dead point does not depend on gives a constant, up to rounding.
    #[test]
    fn a_constant_has_no_roots() {
        for equation in [
            Equation::Polynomial([0.3, 0.0, 0.0]),
            Equation::Polynomial([0.3, 1e-17, 0.0]),
            Equation::Harmonic([0.3, 1e-17, -1e-17]),
            Equation::Harmonic([0.0, 0.0, 0.0]),
        ] {
            assert!(equation.roots().is_empty(), "{equation:?}");
        }
        assert_eq!(Equation::Polynomial([1.0, -2.0, 1.0]).roots().len(), 2);
    }
}
