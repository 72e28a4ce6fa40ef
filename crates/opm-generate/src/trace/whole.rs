//! Roots of legs that are solved whole, as code.

use super::closed_forms::declared;
use super::{Handle, Number, Real, Truth, abs, acos, give, max, sqrt, when};
use crate::library::{Complex, ONE_ROW, REACH, clamp, complex_of, normal};
use opm_core::chain::kernel::Row;
use opm_core::chain::whole::{Invariant, Roots};
use opm_core::numbers::{Plane, Real as _};

/// Roots that tell by how much the first joint without one has none, and return.
pub struct RootsOfCode {
    /// Where that is written.
    pub missed: Real,
    /// What is returned.
    pub status: i32,
    /// A length of the leg, metres.
    pub size: f64,
}

impl RootsOfCode {
    fn scale(&self, of: &Invariant<Real>) -> f64 {
        match of {
            Invariant::Distance(_) => self.size * self.size,
            Invariant::Height => self.size,
            Invariant::Angle(_) => 1.0,
        }
    }

    /// Returns where a joint has no root, with by how much.
    fn miss(&self, reached: Truth, deficit: impl FnOnce() -> Real) {
        when(!reached, || {
            self.missed.set(deficit());
            give(self.status);
        });
    }
}

/// What counts as rounding of a number of a scale.
fn rounding(scale: f64) -> Real {
    REACH * scale
}

fn sense(of: Real) -> Real {
    of.lt(0.0).choose(-1.0, 1.0)
}

/// A vector made one unit long; that of home where it is too short.
fn unit(vector: Complex, is_long: Truth) -> Complex {
    is_long.choose(normal(vector), complex_of(1.0, 0.0)).named("turn")
}

/// The root of a row where it rises or falls, if it is not free.
fn root(row: Row<Real>, length: Real, sign: Real, is_fixed: Truth) -> Complex {
    let constant = clamp(row.constant / length, -1.0, 1.0).named("cosine");
    let slope = (sqrt(max(1.0 - constant * constant, 0.0)) * sign).named("sine");
    let axis = complex_of(row.cosine, row.sine);
    unit(axis * complex_of(constant, -slope), is_fixed)
}

fn with_names(row: Row<Real>) -> Row<Real> {
    let Row { cosine, sine, constant } = row;
    Row { cosine: cosine.named("a"), sine: sine.named("b"), constant: constant.named("c") }
}

fn length(row: &Row<Real>) -> Real {
    sqrt(row.cosine * row.cosine + row.sine * row.sine).named("length")
}

impl Roots<Real> for RootsOfCode {
    fn twofold(&mut self, row: Row<Real>, of: Invariant<Real>, sign: Real) -> Complex {
        let (row, scale) = (with_names(row), self.scale(&of));
        let length = length(&row);
        let excess = (abs(row.constant) - length).named("excess");
        self.miss(excess.le(rounding(scale)), || match of {
            Invariant::Distance(square) => {
                let sense = sense(row.constant).named("sense");
                let nearest = square + 2.0 * sense * excess;
                abs(sqrt(max(nearest, 0.0)) - sqrt(max(square, 0.0)))
            }
            Invariant::Height => excess,
            Invariant::Angle(cosine) => {
                let sense = sense(row.constant).named("sense");
                let nearest = cosine - row.constant + sense * length;
                abs(acos(clamp(nearest, -1.0, 1.0)) - acos(clamp(cosine, -1.0, 1.0)))
            }
        });
        root(row, length, sign, length.gt(rounding(scale)))
    }

    fn double(&mut self, row: Row<Real>, of: Invariant<Real>) -> Complex {
        let (row, scale) = (with_names(row), self.scale(&of));
        let length = length(&row);
        let axis = complex_of(row.cosine, row.sine) * sense(row.constant).named("sense");
        unit(axis, length.gt(rounding(scale)))
    }

    fn pair(&mut self, [one, two]: [Row<Real>; 2]) -> Complex {
        let (one, two) = (with_names(one), with_names(two));
        let (first, second) = (length(&one), length(&two));
        let cross = (one.cosine * two.sine - one.sine * two.cosine).named("cross");
        let apart = abs(cross).gt(ONE_ROW * first * second);
        // Over the determinant, of which the sign alone matters.
        let both = complex_of(
            one.constant * two.sine - two.constant * one.sine,
            one.cosine * two.constant - two.cosine * one.constant,
        ) * sense(cross).named("sense");
        let is_first = declared("is_first", first.ge(second));
        let pick = |a: Real, b: Real, name| is_first.choose(a, b).named(name);
        let row = Row {
            cosine: pick(one.cosine, two.cosine, "a"),
            sine: pick(one.sine, two.sine, "b"),
            constant: pick(one.constant, two.constant, "c"),
        };
        let longer = pick(first, second, "length");
        let single = root(row, longer, Real::from(1.0), longer.gt(REACH * REACH));
        apart.choose(normal(both), single).named("turn")
    }

    fn turned(&mut self, vector: Complex, square: Real, scale: f64) -> Complex {
        unit(vector, square.gt(rounding(scale) * rounding(scale)))
    }

    fn linear(&mut self, rate: Real, constant: Real) -> Real {
        let rate = rate.named("rate");
        abs(rate).gt(REACH).choose(constant / rate, 0.0).named("shift")
    }

    fn quadratic(&mut self, half: Real, constant: Real, square: Real, sign: Real) -> Real {
        let half = half.named("half");
        let under = (half * half - constant).named("under");
        let excess = || sqrt(max(square - under, 0.0)) - sqrt(max(square, 0.0));
        self.miss(under.ge(0.0) | excess().le(rounding(self.size)), excess);
        (sqrt(max(under, 0.0)) * sign - half).named("shift")
    }
}
