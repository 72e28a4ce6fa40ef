//! Functions of one number, and where they are too near to zero for their sign to be told.

use std::f64::consts::TAU;

/// A function of `t` that has its zeros in closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Equation {
    /// `c₀ + c₁ t + c₂ t²`, `c₂` not negative.
    Polynomial([f64; 3]),
    /// `c₀ + c₁ cos t + c₂ sin t`.
    Harmonic([f64; 3]),
    /// `c₀ + c₁ t`, zero also wherever that is a whole number of periods.
    Periodic([f64; 2], f64),
}

/// The values of `t` that are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The lowest.
    pub from: f64,
    /// The highest.
    pub to: f64,
    /// How far apart two of them are at least: zeros that are closer need not be told apart.
    pub step: f64,
}

impl Span {
    /// The largest absolute value.
    pub(crate) fn reach(&self) -> f64 {
        self.from.abs().max(self.to.abs())
    }

    fn give(&self, from: f64, to: f64, found: &mut impl FnMut([f64; 2])) {
        // An end that is not a number, of an interval that has none, is that of the span.
        if !(to < self.from || from > self.to) {
            found([from.max(self.from), to.min(self.to)]);
        }
    }
}

impl Equation {
    /// Gives the intervals of a span in which the function is no farther than `tolerance` from zero, in
    /// any order: between them it keeps its sign.
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
                let turn = (period / c1).abs();
                if !turn.is_finite() {
                    let rest = c0 - period * (c0 / period).round();
                    linear(rest, 0.0, tolerance, span, found);
                } else if turn > 2.0 * span.step {
                    let (zero, half) = (-c0 / c1, tolerance / c1.abs());
                    every(turn, zero - half, zero + half, span, found);
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

/// Gives an interval, moved by any whole number of periods.
fn every(period: f64, from: f64, to: f64, span: &Span, found: &mut impl FnMut([f64; 2])) {
    let mut turns = ((span.from - to) / period).ceil();
    let last = ((span.to - from) / period).floor();
    while turns <= last {
        span.give(from + turns * period, to + turns * period, found);
        turns += 1.0;
    }
}
