//! Roots of equations in one joint: the general case, which has no branch, and what is rare.

use super::CLOSURE;
use super::equation::{Invariant, Roots};
use crate::chain::ReachDeficit;
use crate::chain::kernel::Row;
use crate::numbers::{Plane, REACH, Real};
use nalgebra::Complex;

/// The roots of the general case. What is wrong with them adds to doubts: they are valid where these are at most the square of
/// [`CLOSURE`].
pub(crate) struct General<T> {
    /// Coefficients that are zero but for rounding.
    pub free: T,
    /// Vectors that should be one unit long.
    pub off: T,
    /// Twice what is negative under a root, as a share of its scale.
    pub negative: T,
    pub size: f64,
}

/// What a root of a coefficient that is zero but for rounding adds to the doubt, as a multiple of it.
const FREE: f64 = CLOSURE * CLOSURE * REACH.share * REACH.share;

/// What an equation's coefficients are compared with.
pub(crate) fn scale<T>(of: &Invariant<T>, size: f64) -> f64 {
    match of {
        Invariant::Distance(_) => size * size,
        Invariant::Height => size,
        Invariant::Angle(_) => 1.0,
    }
}

impl<T: Real> General<T> {
    #[inline(always)]
    pub fn new(size: f64) -> Self {
        let zero = T::constant(0.0);
        Self { free: zero, off: zero, negative: zero, size }
    }

    /// All doubts.
    #[inline(always)]
    pub fn doubt(&self) -> T {
        self.free + self.off + self.negative
    }

    /// Doubts what is over the square of a coefficient.
    #[inline(always)]
    fn free(&mut self, over: T) {
        self.free = self.free + over;
    }

    /// Doubts a number that is negative.
    #[inline(always)]
    fn negative(&mut self, number: T) {
        self.negative = self.negative + (number.absolute() - number);
    }

    /// A vector that is one unit long but for rounding.
    #[inline(always)]
    fn unit(&mut self, vector: T::Plane) -> T::Plane {
        let off = vector.norm_sqr() - 1.0;
        self.off = self.off + off.square();
        // One step of Newton's method corrects the length to less than rounding.
        vector.scaled(off * -0.5 + 1.0)
    }
}

impl<T: Real> Roots<T> for General<T> {
    #[inline(always)]
    fn twofold(&mut self, row: Row<T>, of: Invariant<T>, sign: T::Sign) -> T::Plane {
        let per = 1.0 / scale(&of, self.size);
        let row =
            Row { cosine: row.cosine * per, sine: row.sine * per, constant: row.constant * per };
        let axis = T::Plane::new(row.cosine, row.sine);
        let over = T::constant(1.0).over(axis.norm_sqr());
        let square = axis.norm_sqr() - row.constant.square();
        self.negative(square);
        self.free(over * FREE);
        let slope = square.root() * sign;
        (axis * T::Plane::new(row.constant, -slope)).scaled(over)
    }

    #[inline(always)]
    fn double(&mut self, row: Row<T>, of: Invariant<T>) -> T::Plane {
        let axis = T::Plane::new(row.cosine, row.sine);
        let over = T::constant(1.0).over(axis.norm_sqr());
        let scale = scale(&of, self.size);
        self.free(over * (FREE * scale * scale));
        self.unit(axis.scaled(row.constant * over))
    }

    #[inline(always)]
    fn pair(&mut self, [one, two]: [Row<T>; 2]) -> T::Plane {
        self.unit(one.common(&two))
    }

    #[inline(always)]
    fn turned(&mut self, vector: T::Plane, square: T, scale: f64) -> T::Plane {
        let over = T::constant(1.0).over(square);
        self.free(over * (FREE * scale * scale));
        self.unit(vector.scaled(over))
    }

    #[inline(always)]
    fn linear(&mut self, rate: T, constant: T) -> T {
        constant.over(rate)
    }

    #[inline(always)]
    fn quadratic(&mut self, half: T, constant: T, _: T, sign: T::Sign) -> T {
        let square = half.square() - constant;
        self.negative(square * (1.0 / (self.size * self.size)));
        square.root() * sign - half
    }
}

/// The roots of the special cases too.
pub(super) struct Careful {
    pub size: f64,
    /// Bits of the roots to take where two equations have become one.
    pub picks: u32,
    /// How many such roots there were.
    pub picked: u32,
    /// By how much the first joint without a root has none.
    pub deficit: Option<ReachDeficit>,
}

impl Careful {
    fn miss(&mut self, deficit: ReachDeficit) {
        self.deficit.get_or_insert(deficit);
    }

    /// The root of a row where it rises or falls; home where the angle is free.
    fn root(&mut self, row: Row<f64>, of: Invariant<f64>, sign: f64) -> Complex<f64> {
        let scale = scale(&of, self.size);
        let axis = Complex::new(row.cosine, row.sine);
        let length = axis.norm();
        let excess = row.constant.abs() - length;
        let reached = excess <= REACH.share * scale;
        if !reached {
            let deficit = match of {
                Invariant::Distance(square) => {
                    let distance = square.max(0.0).sqrt();
                    let nearest = square + 2.0 * row.constant.signum() * excess;
                    ReachDeficit::length((nearest.max(0.0).sqrt() - distance).abs())
                }
                Invariant::Height => ReachDeficit::length(excess),
                Invariant::Angle(cosine) => {
                    let level = cosine - row.constant;
                    let nearest = level + row.constant.signum() * length;
                    let angle = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
                    ReachDeficit::angle((angle(nearest) - angle(cosine)).abs())
                }
            };
            self.miss(deficit);
        }
        let fixed = length > REACH.share * scale;
        if !fixed {
            return Complex::new(1.0, 0.0);
        }
        let constant = (row.constant / length).clamp(-1.0, 1.0);
        let slope = (1.0 - constant * constant).max(0.0).sqrt() * sign;
        axis * Complex::new(constant, -slope) / length
    }

    /// A vector made one unit long; that of home where it has no length.
    fn unit(vector: Complex<f64>, shortest: f64) -> Complex<f64> {
        let length = vector.norm();
        if length > shortest { vector / length } else { Complex::new(1.0, 0.0) }
    }
}

/// Two rows whose directions enclose a smaller angle than this count as one.
const ONE_ROW: f64 = 1e-7;

impl Roots<f64> for Careful {
    fn twofold(&mut self, row: Row<f64>, of: Invariant<f64>, sign: f64) -> Complex<f64> {
        self.root(row, of, sign)
    }

    fn double(&mut self, row: Row<f64>, of: Invariant<f64>) -> Complex<f64> {
        let shortest = REACH.share * scale(&of, self.size);
        let axis = Complex::new(row.cosine, row.sine);
        Self::unit(axis * row.constant.signum(), shortest)
    }

    fn pair(&mut self, rows: [Row<f64>; 2]) -> Complex<f64> {
        let lengths = rows.map(|row| row.cosine.hypot(row.sine));
        let [one, two] = rows;
        let sine = (one.cosine * two.sine - one.sine * two.cosine) / (lengths[0] * lengths[1]);
        if sine.abs() > ONE_ROW {
            return Self::unit(one.common(&two), 0.0);
        }
        let sign = if self.picks & (1 << self.picked) == 0 { 1.0 } else { -1.0 };
        self.picked += 1;
        let row = if lengths[0] >= lengths[1] { one } else { two };
        let axis = Complex::new(row.cosine, row.sine);
        let length = axis.norm();
        let fixed = length > REACH.share * REACH.share;
        if !fixed {
            return Complex::new(1.0, 0.0);
        }
        let constant = (row.constant / length).clamp(-1.0, 1.0);
        let slope = (1.0 - constant * constant).max(0.0).sqrt() * sign;
        axis * Complex::new(constant, -slope) / length
    }

    fn turned(&mut self, vector: Complex<f64>, square: f64, scale: f64) -> Complex<f64> {
        let shortest = REACH.share * scale;
        if square > shortest * shortest {
            Self::unit(vector / square, 0.0)
        } else {
            Complex::new(1.0, 0.0)
        }
    }

    fn linear(&mut self, rate: f64, constant: f64) -> f64 {
        if rate.abs() > REACH.share { constant / rate } else { 0.0 }
    }

    fn quadratic(&mut self, half: f64, constant: f64, square: f64, sign: f64) -> f64 {
        let under = half * half - constant;
        let real = under >= 0.0;
        if !real {
            let excess = (square - under).max(0.0).sqrt() - square.max(0.0).sqrt();
            let reached = excess <= REACH.share * self.size;
            if !reached {
                self.miss(ReachDeficit::length(excess));
            }
        }
        under.max(0.0).sqrt() * sign - half
    }
}
