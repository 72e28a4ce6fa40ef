//! Functions of one number, and the intervals in which they are too near to zero for their sign to be
//! certain.

use super::REACH_TOLERANCE;
use super::condition::VERGE;
use crate::group::JointDisplacement;
use crate::numeric::angle::atan2;
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

/// The zero of a function, as far as straight-line arithmetic finds it.
#[derive(Clone, Copy, Debug)]
pub struct AttemptedZero {
    /// The zero. It is valid only where `holds` is true.
    pub at: f64,
    /// Whether there is a zero, and the function is not the same everywhere.
    pub holds: bool,
    /// Whether there is certainly no zero. Where neither `holds` nor `beyond` is true, [`Equation::zero`] decides.
    pub beyond: bool,
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
    pub fn roots(&self) -> Vec<JointDisplacement> {
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
    pub fn zero(&self, sign: f64, unit: f64) -> Result<Option<f64>, f64> {
        let AttemptedZero { at, holds, .. } = self.attempt_zero(sign, unit);
        if holds {
            return Ok(Some(at));
        }
        let constant =
            |c0: f64| if c0.abs() <= REACH_TOLERANCE * unit { Ok(None) } else { Err(c0) };
        match *self {
            Self::Harmonic([c0, c1, c2]) => {
                let amplitude = amplitude(c1, c2);
                if amplitude <= VERGE * unit {
                    return constant(c0);
                }
                Err(c0 - amplitude.copysign(c0))
            }
            Self::Polynomial([c0, c1, c2]) => {
                if is_linear([c0, c1, c2], unit) {
                    return constant(c0);
                }
                Err(c0 - 0.25 * c1 * c1 / c2)
            }
            Self::Periodic(..) => {
                panic!("a function with a period of its own has more than two zeros")
            }
        }
    }

    /// The general case of [`Equation::zero`]. There are no branches: a loop over many functions is vectorised.
    #[inline(always)]
    pub fn attempt_zero(&self, sign: f64, unit: f64) -> AttemptedZero {
        match *self {
            Self::Harmonic([c0, c1, c2]) => {
                let amplitude = amplitude(c1, c2);
                // c₀ + r cos(t - phase) rises before its crest.
                let height = ((amplitude - c0) * (amplitude + c0)).max(0.0).sqrt();
                let at = atan2(c2, c1) - sign * atan2(height, -c0);
                let varies = amplitude > VERGE * unit;
                let most = amplitude + REACH_TOLERANCE * unit;
                AttemptedZero {
                    at,
                    holds: varies & (c0.abs() <= most),
                    beyond: varies & (c0.abs() > most),
                }
            }
            Self::Polynomial([c0, c1, c2]) => {
                let linear = is_linear([c0, c1, c2], unit);
                // The slope at a zero is the root of this, with the sign of the branch.
                let square = c1 * c1 - 4.0 * c2 * c0;
                let least = -REACH_TOLERANCE * unit * unit;
                let of_square = (sign * square.max(0.0).sqrt() - c1) / (2.0 * c2);
                let at = if linear { -c0 / c1 } else { of_square };
                let varies = c1.abs() > VERGE * unit;
                AttemptedZero {
                    at,
                    holds: (linear & varies) | (!linear & (square >= least)),
                    beyond: !linear & (square < least),
                }
            }
            Self::Periodic(..) => AttemptedZero { at: f64::NAN, holds: false, beyond: false },
        }
    }

    /// The three coefficients; the last one is zero for a line modulo a period.
    #[inline(always)]
    pub fn coefficients(&self) -> [f64; 3] {
        match *self {
            Self::Polynomial(c) | Self::Harmonic(c) => c,
            Self::Periodic([c0, c1], _) => [c0, c1, 0.0],
        }
    }

    /// A function of the same kind with other coefficients, and with the same period.
    #[inline(always)]
    pub fn with(&self, c: [f64; 3]) -> Self {
        match *self {
            Self::Polynomial(_) => Self::Polynomial(c),
            Self::Harmonic(_) => Self::Harmonic(c),
            Self::Periodic(_, period) => Self::Periodic([c[0], c[1]], period),
        }
    }

    /// Whether the absolute value of the function may be within `tolerance` anywhere. Where it is not, all of
    /// [`Equation::near_zeros`] is empty.
    #[inline(always)]
    pub fn may_be_zero(&self, tolerance: f64) -> bool {
        match *self {
            Self::Polynomial([c0, c1, c2]) => c1 * c1 - 4.0 * c2 * (c0 - tolerance) >= 0.0,
            Self::Harmonic([c0, c1, c2]) => c0.abs() <= (c1 * c1 + c2 * c2).sqrt() + tolerance,
            Self::Periodic(..) => true,
        }
    }

    /// The slope at `t`.
    pub fn slope_at(&self, t: f64) -> f64 {
        match *self {
            Self::Polynomial([_, c1, c2]) => c1 + 2.0 * c2 * t,
            Self::Periodic([_, c1], _) => c1,
            Self::Harmonic([_, c1, c2]) => {
                let (sin, cos) = t.sin_cos();
                c2 * cos - c1 * sin
            }
        }
    }

    /// At most two intervals outside of which the absolute value of the function is larger than `tolerance`; of a
    /// function that repeats itself ([`Equation::period`]), those of one period. An interval is empty where its second
    /// number is less than its first; an end that is NaN is beyond all numbers. There are no branches: a loop over many
    /// functions is vectorised.
    #[inline(always)]
    pub fn near_zeros(&self, tolerance: f64) -> [[f64; 2]; 2] {
        match *self {
            Self::Polynomial([c0, c1, 0.0]) => linear(c0, c1, tolerance),
            Self::Periodic([c0, c1], period) => {
                linear(c0 - period * (c0 / period).round_ties_even(), c1, tolerance)
            }
            Self::Polynomial([c0, c1, c2]) => {
                // c₂ ((t - middle)² - square)
                let middle = -0.5 * c1 / c2;
                let square = middle * middle - c0 / c2;
                let (apart, tolerance) = (square.max(0.0).sqrt(), tolerance / c2);
                // Where the zeros are apart, the slope is 2 · apart, and no less than half of it up to the ends.
                let half =
                    if square > tolerance { tolerance / apart } else { 3.0 * tolerance.sqrt() };
                let half = if square < -tolerance { -f64::INFINITY } else { half };
                around([middle - apart, middle + apart], half)
            }
            Self::Harmonic([c0, c1, c2]) => {
                // c₀ + r cos(t - phase); the square of the slope at the zeros.
                let r = (c1 * c1 + c2 * c2).sqrt();
                let square = (r - c0) * (r + c0);
                let slope = square.max(0.0).sqrt();
                let (phase, apart) = (atan2(c2, c1), atan2(slope, -c0));
                // |c₀ (1 - cos d) - slope · sin d|, by d off a zero, is over the tolerance from twice the quotient on.
                // Where the zeros meet, |c₀| and r differ by 4 tolerances at most, and r (1 - cos d) by 5.
                let parted = square > 4.0 * r * tolerance;
                let share = tolerance / if parted { slope } else { r };
                let half = if parted { 2.0 * share } else { 10.0 * share.sqrt() };
                let half = if c0.abs() > r + tolerance { -f64::INFINITY } else { half };
                around([phase - apart, phase + apart], half)
            }
        }
    }

    /// The change of `t` after which the function repeats itself; `None` where it does not, infinite where it is constant.
    #[inline(always)]
    pub fn period(&self) -> Option<f64> {
        match *self {
            Self::Polynomial(_) => None,
            Self::Harmonic(_) => Some(TAU),
            Self::Periodic([_, c1], period) => Some((period / c1).abs()),
        }
    }

    /// Calls `found` with intervals of a span, in any order, outside of which the absolute value of the function is larger
    /// than `tolerance`: there it keeps its sign.
    #[inline]
    pub fn zeros(&self, tolerance: f64, span: &Span, found: &mut impl FnMut([f64; 2])) {
        let period = self.period().unwrap_or(f64::INFINITY);
        for [from, to] in self.near_zeros(tolerance) {
            if to < from {
                continue;
            }
            if period.is_infinite() {
                span.give(from, to, found);
            } else if to - from < period && period > 2.0 * span.step {
                every(period, from, to, span, found);
            } else {
                found([span.from, span.to]);
            }
        }
    }
}

/// The amplitude of a harmonic function, without protection from overflow.
#[inline(always)]
fn amplitude(c1: f64, c2: f64) -> f64 {
    (c1 * c1 + c2 * c2).sqrt()
}

/// Whether a polynomial has the degree one at most, where values are in the unit `unit`.
#[inline(always)]
fn is_linear([_, c1, c2]: [f64; 3], unit: f64) -> bool {
    c2.abs() <= VERGE * c1.abs().max(unit)
}

/// The intervals of [`Equation::near_zeros`] of `c₀ + c₁ t`.
#[inline(always)]
fn linear(c0: f64, c1: f64, tolerance: f64) -> [[f64; 2]; 2] {
    let half = tolerance / c1.abs();
    let constant = if c0.abs() <= tolerance { f64::INFINITY } else { -f64::INFINITY };
    let [zero, half] = if c1 == 0.0 { [0.0, constant] } else { [-c0 / c1, half] };
    let [only, _] = around([zero; 2], half);
    [only, [f64::INFINITY, f64::NEG_INFINITY]]
}

/// The intervals of this half width about two numbers; nothing where it is negative.
#[inline(always)]
fn around(zeros: [f64; 2], half: f64) -> [[f64; 2]; 2] {
    let [a, b] = zeros;
    [[a - half, a + half], [b - half, b + half]]
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
