//! Intervals of the half angle's tangent that have one root each, by the signs of coefficients in Bernstein's basis.

use super::{COEFFICIENTS, HALF, SHORTEST};

/// The widest interval that is about one double root: such a root is known to the square root of [`super::NOISE`].
const TOGETHER: f64 = 1e-5;

/// A polynomial on an interval.
pub(super) struct Interval {
    /// The Bernstein coefficients on the interval.
    pub bernstein: [f64; COEFFICIENTS],
    /// The sign of the half of the circle: negative after a rotation by π.
    pub half: f64,
    /// The low end of the interval.
    pub low: f64,
    /// The width of the interval.
    pub width: f64,
}

/// Where a root is.
pub(super) struct Bracket {
    /// The sign of the half of the circle.
    pub half: f64,
    /// The ends of the interval. At those of a simple root the polynomial has opposite signs.
    pub low: f64,
    pub high: f64,
    /// Where the search for a simple root starts; otherwise the root.
    pub start: f64,
    /// Whether the polynomial rises there.
    pub rising: bool,
    /// Whether the root is certainly simple.
    pub simple: bool,
}

impl Interval {
    /// Finds the roots, in ascending order. Where the polynomial is below `noise`, it is zero.
    pub fn isolate(&self, noise: f64, found: &mut Vec<Bracket>) {
        let Self { bernstein: ref b, half, low, width } = *self;
        let (least, most) =
            b.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), &x| (l.min(x), m.max(x)));
        if least > noise || most < -noise {
            return;
        }
        let bracket = |rising| {
            let start = self.polygon_root(rising);
            Bracket { half, low, high: low + width, start, rising, simple: true }
        };
        if changes_sign_once(b, noise) {
            return found.push(bracket(b[HALF] > 0.0));
        }
        // Where it ends flat at zero, its neighbour may have the other part of a multiple root, or rounding may.
        let vanishes = |i: usize, j: usize| b[i].abs() <= noise && b[j].abs() <= noise;
        let certain = !vanishes(0, 1) && !vanishes(HALF - 1, HALF);
        let rising = b.windows(2).all(|pair| pair[1] > pair[0]);
        let monotonic = rising || b.windows(2).all(|pair| pair[1] < pair[0]);
        if certain && monotonic {
            // A root at the common end of two intervals belongs to the right one.
            let (first, last) = (b[0], b[HALF]);
            let crosses =
                if rising { first <= 0.0 && last > 0.0 } else { first >= 0.0 && last < 0.0 };
            if crosses {
                found.push(bracket(rising));
            }
            return;
        }
        // The polynomial is below the rounding here. Unless it is convex or concave and turns, in which case halving
        // leads to its turning point, nothing more can be found.
        let turns = !monotonic && is_convex_or_concave(b);
        let flat = least.abs().max(most.abs()) <= noise && !turns;
        if width <= SHORTEST || flat {
            let high = low + width;
            // Short intervals in a row are about one double root. Long ones may be about one of fourth order, of which each
            // is a start.
            if let Some(last) = found.last_mut()
                && !last.simple
                && last.half == half
                && last.high == low
                && high - last.low <= TOGETHER
            {
                last.high = high;
                last.start = 0.5 * (last.low + high);
                return;
            }
            let start = 0.5 * (low + high);
            return found.push(Bracket { half, low, high, start, rising: true, simple: false });
        }
        for half in self.halves() {
            half.isolate(noise, found);
        }
    }
}

/// Whether the coefficients change their sign exactly once, whatever the rounding. Then there is exactly one
/// root, by Descartes' rule of signs in Bernstein's basis.
fn changes_sign_once(b: &[f64; COEFFICIENTS], noise: f64) -> bool {
    let sign = if b[HALF] > 0.0 { 1.0 } else { -1.0 };
    let before = b.iter().take_while(|&&x| sign * x < -noise).count();
    let after = b.iter().rev().take_while(|&&x| sign * x > noise).count();
    // Of two neighbours without a certain sign, each could have that of the other's side.
    before > 0 && after > 0 && before + after >= HALF
}

/// Whether the second derivative keeps its sign on the interval.
fn is_convex_or_concave(b: &[f64; COEFFICIENTS]) -> bool {
    let second = |w: &[f64]| w[0] - 2.0 * w[1] + w[2];
    b.windows(3).all(|w| second(w) > 0.0) || b.windows(3).all(|w| second(w) < 0.0)
}

/// Bernstein coefficients on the halves of an interval, by de Casteljau's algorithm.
pub(super) const fn halves_of(whole: &[f64; COEFFICIENTS]) -> [[f64; COEFFICIENTS]; 2] {
    let (mut left, mut right) = ([0.0; COEFFICIENTS], *whole);
    let mut i = 0;
    while i <= HALF {
        left[i] = right[0];
        let mut j = 0;
        while j < HALF - i {
            right[j] = 0.5 * (right[j] + right[j + 1]);
            j += 1;
        }
        i += 1;
    }
    [left, right]
}

impl Interval {
    /// The two halves.
    fn halves(&self) -> [Self; 2] {
        let ([left, right], half, width) =
            (halves_of(&self.bernstein), self.half, 0.5 * self.width);
        [
            Self { bernstein: left, half, low: self.low, width },
            Self { bernstein: right, half, low: self.low + width, width },
        ]
    }

    /// Where the polygon of the coefficients changes its sign for the first time.
    fn polygon_root(&self, rising: bool) -> f64 {
        let b = &self.bernstein;
        let side = b.iter().take_while(|&&x| (x > 0.0) != rising).count().clamp(1, HALF);
        let (before, after) = (b[side - 1], b[side]);
        let share = (side as f64 - 1.0 + before / (before - after)) / HALF as f64;
        self.low + self.width * share.clamp(0.0, 1.0)
    }
}
