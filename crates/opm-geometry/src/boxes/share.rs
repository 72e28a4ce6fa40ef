//! Lower and upper bounds of the share of a box that meets a condition.
//!
//! A condition is a range of a quantity that is linear up to an error. The share of a cube on one side of a
//! plane has a closed form, so that the share of a box that the boundary of the workspace crosses is known
//! up to the error.

use super::affine::Affine;

/// The least distance from the end of a range at which a quantity is certainly on one side of it, as a
/// fraction of the numbers: ten times the tolerance of joint limits and of the boundary of reach.
const MARGIN: f64 = 1e-11;

/// The rounding of the closed form of a share.
const ROUNDING: f64 = 1e-12;

/// Slopes smaller than this fraction of the second largest one are treated as errors.
const SMALL: f64 = 1.0 / 16.0;

/// The largest number of coordinates of a box.
pub const MOST: usize = 8;

/// Bounds of the share of a box that meets some conditions, and what causes their difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Share<const N: usize> {
    /// At least this share meets them.
    pub lower: f64,
    /// At most this share meets them.
    pub upper: f64,
    /// The errors of undecided conditions, by the coordinate that causes them.
    errors: [f64; N],
    /// The changes of undecided conditions by each coordinate.
    slopes: [f64; N],
    /// The number of undecided conditions.
    undecided: u32,
}

impl<const N: usize> Share<N> {
    /// The whole box.
    pub const ALL: Self = Self::between(1.0, 1.0);

    /// No part of the box.
    pub const NONE: Self = Self::between(0.0, 0.0);

    /// Some part of the box: nothing is known.
    pub const ANY: Self = Self::between(0.0, 1.0);

    const fn between(lower: f64, upper: f64) -> Self {
        Self { lower, upper, errors: [0.0; N], slopes: [0.0; N], undecided: 0 }
    }

    pub fn is_all(&self) -> bool {
        self.lower >= 1.0
    }

    pub fn is_none(&self) -> bool {
        self.upper <= 0.0
    }

    fn combined(self, other: &Self, lower: f64, upper: f64) -> Self {
        Self {
            lower,
            upper,
            errors: std::array::from_fn(|i| self.errors[i] + other.errors[i]),
            slopes: std::array::from_fn(|i| self.slopes[i] + other.slopes[i]),
            undecided: self.undecided + other.undecided,
        }
    }

    /// The share that meets both conditions (Bonferroni's inequalities).
    pub fn and(self, other: Self) -> Self {
        if self.is_none() || other.is_none() {
            return Self::NONE;
        }
        let lower = (self.lower + other.lower - 1.0).max(0.0);
        self.combined(&other, lower, self.upper.min(other.upper))
    }

    /// The share that meets at least one of two conditions.
    pub fn or(self, other: Self) -> Self {
        if self.is_all() || other.is_all() {
            return Self::ALL;
        }
        let upper = (self.upper + other.upper).min(1.0);
        self.combined(&other, self.lower.max(other.lower), upper)
    }

    /// The share that meets the condition that applies, where each point has one of two conditions and it is
    /// unknown which.
    pub fn either(self, other: Self) -> Self {
        let (lower, upper) = (self.and(other).lower, self.or(other).upper);
        self.combined(&other, lower, upper)
    }

    /// The contribution of each coordinate to the difference of the bounds. Where a single condition is
    /// undecided, only its error contributes; where several are, their overlap is unknown too.
    pub fn contributions(&self) -> [f64; N] {
        std::array::from_fn(|i| {
            self.errors[i] + if self.undecided > 1 { self.slopes[i] } else { 0.0 }
        })
    }

    /// The share for which `quantity` lies in a range, whose ends count as inside; an end may be infinite.
    /// `slack` is added to the margin at each end.
    #[inline(never)]
    pub fn within(quantity: &Affine<N>, [low, high]: [f64; 2], slack: f64) -> Self {
        let finite = |end: f64| if end.is_finite() { end.abs() } else { 0.0 };
        let (centre, radius) = (quantity.centre, quantity.radius());
        let size = finite(low) + finite(high) + centre.abs();
        let margin = slack + MARGIN * (size + radius);
        let (from, to) = (centre - radius, centre + radius);
        if from - margin >= low && to + margin <= high {
            return Self::ALL;
        }
        if to + margin < low || from - margin > high {
            return Self::NONE;
        }
        let error = quantity.total_error();
        let off = margin + error;
        if !(off.is_finite() && radius.is_finite()) {
            return Self::undecided(quantity, 0.0, 1.0);
        }
        // Bounds of the share that is below a number.
        let below = |number: f64| share_below(&quantity.slope, number - centre);
        let inside = below(high - off)[0] - below(low + off)[1];
        let outside = below(high + off)[1] - below(low - off)[0];
        Self::undecided(quantity, inside.clamp(0.0, 1.0), outside.clamp(0.0, 1.0))
    }

    /// The share for which `quantity`, known up to multiples of `period`, lies in a range narrower than that.
    pub fn within_turns(quantity: &Affine<N>, [low, high]: [f64; 2], period: f64) -> Self {
        let (from, to) = (quantity.low(), quantity.high());
        // Over a full period, everything is possible.
        if to - from >= period || !(to - from).is_finite() {
            return Self::undecided(quantity, 0.0, 1.0);
        }
        let first = ((from - high) / period).floor() as i64;
        let last = ((to - low) / period).ceil() as i64;
        (first..=last).fold(Self::NONE, |share, turn| {
            let shift = period * turn as f64;
            let part = Self::within(quantity, [low + shift, high + shift], 0.0);
            // The ranges are disjoint: their shares add up.
            let lower = (share.lower + part.lower).min(1.0);
            let upper = (share.upper + part.upper).min(1.0);
            if lower >= 1.0 { Self::ALL } else { share.combined(&part, lower, upper) }
        })
    }

    /// The share for which `quantity` does not lie in a range.
    pub fn outside(quantity: &Affine<N>, range: [f64; 2]) -> Self {
        let within = Self::within(quantity, range, 0.0);
        Self { lower: 1.0 - within.upper, upper: 1.0 - within.lower, ..within }
    }

    /// An undecided condition on `quantity`, with these bounds of the share that meets it.
    pub fn undecided(quantity: &Affine<N>, lower: f64, upper: f64) -> Self {
        let spread = quantity.spread();
        let (all, error) = (spread.iter().sum::<f64>(), quantity.total_error());
        let part = |of: f64, all: f64| if all > 0.0 { of / all } else { 0.0 };
        let crossed = upper.min(1.0 - lower);
        Self {
            lower,
            upper,
            errors: quantity.error.map(|e| (upper - lower) * part(e, error)),
            slopes: spread.map(|s| crossed * part(s, all)),
            undecided: 1,
        }
    }
}

/// Bounds of the share of the cube `[-1, 1]^N` in which `slope · δ <= number`.
///
/// With `a` the largest slope, it is `(H(number + a) - H(number - a)) / 2a`, where `H(t)` is the mean
/// of `max(t - X, 0)` and `X` the sum of the other slopes times their `δ`.
#[inline(never)]
fn share_below<const N: usize>(slope: &[f64; N], number: f64) -> [f64; 2] {
    let mut slopes = slope.map(f64::abs);
    slopes.sort_unstable_by(|a, b| b.total_cmp(a));
    let total: f64 = slopes.iter().sum();
    if number >= total {
        return [1.0, 1.0];
    }
    if number <= -total {
        return [0.0, 0.0];
    }
    let largest = slopes[0];
    let second = slopes.get(1).copied().unwrap_or(0.0);
    // Leaving out a slope c changes the share by at most c²/6 of the density's steepest slope, 1/(4 a b).
    let mut off = ROUNDING;
    let mut kept = 1;
    for &small in &slopes[1..] {
        if small > SMALL * second {
            kept += 1;
        } else if small > 0.0 {
            off += small * small / (24.0 * largest * second);
        }
    }
    let others = &slopes[1..kept];
    let share = (mean_above(others, number + largest) - mean_above(others, number - largest))
        / (2.0 * largest);
    [(share - off).max(0.0), (share + off).min(1.0)]
}

/// The mean of `max(t - X, 0)`, with `X` a sum of independent numbers, each evenly spread between a slope
/// and its opposite: `Σ ± max(t + Σ ± slope, 0)^(m+1) / ((m+1)! Π 2 slope)` over the cube's corners.
fn mean_above(slopes: &[f64], t: f64) -> f64 {
    let total: f64 = slopes.iter().sum();
    if t >= total {
        return t;
    }
    if t <= -total {
        return 0.0;
    }
    if t > 0.0 {
        // There is less cancellation on the other side.
        return t + mean_above(slopes, -t);
    }
    let power = slopes.len() as i32 + 1;
    let mut sum = 0.0;
    for corner in 0..1_u32 << slopes.len() {
        let (mut at, mut sign) = (t, 1.0);
        for (i, slope) in slopes.iter().enumerate() {
            if corner >> i & 1 == 1 {
                (at, sign) = (at - slope, -sign);
            } else {
                at += slope;
            }
        }
        if at > 0.0 {
            sum += sign * at.powi(power);
        }
    }
    let factorial: f64 = (1..=power).map(f64::from).product();
    sum / slopes.iter().fold(factorial, |product, slope| product * 2.0 * slope)
}
