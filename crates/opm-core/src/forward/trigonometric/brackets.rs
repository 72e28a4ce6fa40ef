//! The roots in several brackets, found together.

use super::interval::Bracket;
use super::{COEFFICIENTS, LANES, summed};
use pulp::{Simd, WithSimd};

/// [`roots_of_brackets`], with the instructions of the processor at hand.
pub(super) struct InBrackets<'a> {
    pub powers: &'a [[[f64; 1]; COEFFICIENTS]; 2],
    pub brackets: &'a [Bracket],
}

impl WithSimd for InBrackets<'_> {
    type Output = [f64; LANES];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        roots_of_brackets(self.powers, self.brackets)
    }
}

/// The roots in up to [`LANES`] brackets, by Newton's method on all of them together. Steps that leave the bracket, or that
/// do not become shorter, are replaced by halving it. `powers` has the coefficients by rising powers, those of the terms of
/// even and of odd degree.
#[inline(always)]
fn roots_of_brackets(powers: &[[[f64; 1]; COEFFICIENTS]; 2], brackets: &[Bracket]) -> [f64; LANES] {
    /// Every second step halves the interval or the step at least: this number reaches the last bit.
    const STEPS: usize = 128;
    /// After a step that is shorter, the next one is below rounding: Newton's method squares the error.
    const CLOSE: f64 = 1e-9;
    let of_each = |number: fn(&Bracket) -> f64| -> [f64; LANES] {
        std::array::from_fn(|i| brackets.get(i).map_or(0.0, number))
    };
    let coefficients = summed(powers, of_each(|bracket| bracket.half));
    let [mut low, mut high, mut t, mut last] = [
        of_each(|bracket| bracket.low),
        of_each(|bracket| bracket.high),
        of_each(|bracket| bracket.start),
        of_each(|bracket| bracket.high - bracket.low),
    ];
    let mut open: [bool; LANES] =
        std::array::from_fn(|i| brackets.get(i).is_some_and(|bracket| bracket.simple));
    for _ in 0..STEPS {
        if open == [false; LANES] {
            break;
        }
        let (mut value, mut slope) = ([0.0; LANES], [0.0; LANES]);
        for c in coefficients.iter().rev() {
            for i in 0..LANES {
                slope[i] = slope[i] * t[i] + value[i];
                value[i] = value[i] * t[i] + c[i];
            }
        }
        let mut newton = t;
        for i in 0..LANES {
            newton[i] = t[i] - value[i] / slope[i];
        }
        for (i, bracket) in brackets.iter().enumerate() {
            if !open[i] {
                continue;
            }
            let end = if (value[i] > 0.0) == bracket.rising { &mut high } else { &mut low };
            end[i] = t[i];
            let (low, high, newton) = (low[i], high[i], newton[i]);
            let step = (newton - t[i]).abs();
            if step <= CLOSE && newton >= low - CLOSE && newton <= high + CLOSE {
                (t[i], open[i]) = (newton.clamp(bracket.low, bracket.high), false);
                continue;
            }
            let inside = newton > low && newton < high;
            let next = if inside && step <= 0.5 * last[i] { newton } else { 0.5 * (low + high) };
            last[i] = (next - t[i]).abs();
            t[i] = next;
            open[i] = last[i] > 4.0 * f64::EPSILON;
        }
    }
    t
}
