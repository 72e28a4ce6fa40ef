//! The angle at the base of a triangle of which two sides are given, over a range of the third.
//!
//! It is a function of one number, so that its second derivative can be bounded. This is what the first joint of an arm of
//! two links turns by, beside the direction of the arm's end.

use super::affine::Affine;

/// Nearer to the boundary of reach than this fraction, the second derivative is too large for a useful bound.
const NEAR_BOUNDARY: f64 = 1e-3;

/// The end of a range without an end.
const INFINITE: f64 = f64::INFINITY;

/// A range of numbers.
type Range = [f64; 2];

/// In the plane: sides `a` and `b`, of which the squares are given, over a range of the square of the third. The angle is at
/// `a`, opposite to `b`; `None` near the boundary of reach.
///
/// With the square `x` of the third side, `cos ψ = (x + a² - b²) / (2 a √x)`.
pub fn planar<const N: usize>(square: Affine<N>, [a, b]: [f64; 2]) -> Option<Affine<N>> {
    let (middle, half) = (a + b, 2.0 * (a * b).sqrt());
    let ends = [square.low(), square.high()];
    // Sixteen times the square of the area: concave, with its largest value in the middle.
    let gram = |x: f64| (half - (x - middle)) * (half + (x - middle));
    let grams = concave(&gram, middle, ends);
    if !(ends[0] > NEAR_BOUNDARY * middle && grams[0] > NEAR_BOUNDARY * half * half) {
        return None;
    }
    // ψ' = -n / (2 x √g) and ψ'' = -(1 - n/x + n (x - m)/g) / (2 x √g), with n = x - (a² - b²).
    let numerators = ends.map(|x| x - (a - b));
    let first = times(numerators, over(ends));
    let second = times(times(numerators, ends.map(|x| x - middle)), over(grams));
    let sum = [1.0 - first[1] + second[0], 1.0 - first[0] + second[1]];
    let weight = over([0, 1].map(|i| -2.0 * ends[i] * grams[i].sqrt()));
    let x = square.centre;
    let root = gram(x).sqrt();
    let value = root.atan2(x + (a - b));
    let slope = -(x - (a - b)) / (2.0 * x * root);
    Some(square.bent([value, slope], times(sum, weight)))
}

/// In a sphere: arcs of which the cosines and sines are given, over a range of the cosine `z` of the third. The angle is at
/// the first arc, opposite to the second; `None` near the boundary of reach and the poles.
///
/// `cos ψ = (cos a₂₃ - z cos a₁₂) / (sin a₁₂ √(1 - z²))`.
pub fn spherical<const N: usize>(
    z: Affine<N>,
    [c12, c23]: [f64; 2],
    [s12, s23]: [f64; 2],
) -> Option<Affine<N>> {
    let (middle, half) = (c12 * c23, s12 * s23);
    let ends = [z.low(), z.high()];
    // Concave, with their largest values in the middle.
    let square = |z: f64| (1.0 - z) * (1.0 + z);
    let gram = |z: f64| (half - (z - middle)) * (half + (z - middle));
    let (squares, grams) = (concave(&square, 0.0, ends), concave(&gram, middle, ends));
    if !(squares[0] > NEAR_BOUNDARY && grams[0] > NEAR_BOUNDARY * half * half) {
        return None;
    }
    let numerator = |z: f64| c12 - c23 * z;
    let [p, q] = ends.map(numerator);
    let numerators = [p.min(q), p.max(q)];
    // ψ' = n / (s √g) and ψ'' = (-cos a₂₃ + 2 n z/s + n (z - m)/g) / (s √g).
    let first = times(times(numerators, ends), over(squares)).map(|x| 2.0 * x);
    let second = times(times(numerators, ends.map(|z| z - middle)), over(grams));
    let sum = [0, 1].map(|i| first[i] + second[i] - c23);
    let weight = over([0, 1].map(|i| squares[i] * grams[i].sqrt()));
    let root = gram(z.centre).sqrt();
    let value = root.atan2(c23 - c12 * z.centre);
    let slope = numerator(z.centre) / (square(z.centre) * root);
    Some(z.bent([value, slope], times(sum, weight)))
}

/// The range of a concave function that is largest at `top`.
fn concave(f: &dyn Fn(f64) -> f64, top: f64, ends: Range) -> Range {
    let [a, b] = ends.map(f);
    [a.min(b), f(top.clamp(ends[0], ends[1]))]
}

/// The range of a product.
fn times([a, b]: Range, [c, d]: Range) -> Range {
    let all = [a * c, a * d, b * c, b * d];
    [all.into_iter().fold(INFINITE, f64::min), all.into_iter().fold(-INFINITE, f64::max)]
}

/// The range of the inverse of a number that is not zero.
fn over([least, most]: Range) -> Range {
    [1.0 / most, 1.0 / least]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Halves of ranges, and places in them.
    fn half() -> impl Strategy<Value = f64> {
        prop_oneof![Just(1e-3), Just(1e-2), Just(0.1), Just(0.5)]
    }

    fn place() -> impl Strategy<Value = f64> {
        prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0_f64]
    }

    /// Where the angle is within its bounds, and how far it may be off at most.
    fn off(opening: &Affine<1>, at: f64, angle: f64) -> f64 {
        (opening.centre + opening.slope[0] * at - angle).abs() - opening.total_error()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(50_000))]

        #[test]
        fn spherical_openings_hold(
            arcs in [0.1..3.0_f64, 0.1..3.0_f64],
            share in -0.99..0.99_f64,
            half in half(),
            at in place(),
        ) {
            let [a, b] = arcs;
            // Where the triangle closes.
            let middle = a.cos() * b.cos() + share * a.sin() * b.sin();
            let z = Affine::<1>::coordinate(middle, half * (1.0 - share.abs()), 0);
            if let Some(opening) = spherical(z, arcs.map(f64::cos), arcs.map(f64::sin)) {
                let to = (z.centre + z.slope[0] * at).acos();
                let angle = ((b.cos() - a.cos() * to.cos()) / (a.sin() * to.sin())).acos();
                let off = off(&opening, at, angle);
                prop_assert!(off <= 1e-12, "{off} {opening:?}");
            }
        }

        /// By the law of cosines, and to second order: the error is a fourth for half the range.
        #[test]
        fn planar_openings_hold(
            sides in [0.1..3.0_f64, 0.1..3.0_f64],
            share in -0.99..0.99_f64,
            half in half(),
            at in place(),
        ) {
            let [a, b] = sides;
            let middle = a * a + b * b + 2.0 * share * a * b;
            let half = half * 2.0 * a * b * (1.0 - share.abs());
            let opening = |half: f64| {
                let x = Affine::<1>::coordinate(middle, half, 0);
                (x, planar(x, sides.map(|side| side * side)))
            };
            if let (x, Some(opening)) = opening(half) {
                let square = x.centre + x.slope[0] * at;
                let angle = ((square + a * a - b * b) / (2.0 * a * square.sqrt())).acos();
                let off = off(&opening, at, angle);
                prop_assert!(off <= 1e-12, "{off} {opening:?}");
            }
            if let [(_, Some(one)), (_, Some(other))] = [opening(1e-2 * half), opening(5e-3 * half)] {
                prop_assert!(other.total_error() < 0.3 * one.total_error() + 1e-12);
            }
        }
    }
}
