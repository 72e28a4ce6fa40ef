//! The coefficients of `(1 + t²)⁴ exp(i k θ)` with `t = tan(θ/2)` in several bases.

use super::interval::halves_of;
use super::{COEFFICIENTS, DEGREE, HALF, LANES};

/// Real and imaginary parts of `(1 + i t)^(4+k) (1 − i t)^(4−k)`, which is `(1 + t²)⁴ exp(i k θ)`: for each `k`, their
/// coefficients in `N` bases. Those for `k > 0` are doubled, because `−k` adds as much.
pub(super) type Table<const N: usize> = [[[[f64; N]; 2]; COEFFICIENTS]; DEGREE + 1];

/// The table for the powers of `t`.
pub(super) const POWERS: Table<1> = in_order([table([[1, 0], [0, 1]], false)]);
/// The table for Bernstein's bases on the four quarters of `-1 ≤ t ≤ 1`, where the factor `1 + i t` runs from `1 − i` to
/// `1 + i`.
pub(super) const QUARTERS: Table<LANES> = {
    let [left, right] = halves_of_all(&table([[1, -1], [1, 1]], true));
    let ([first, second], [third, fourth]) = (halves_of_all(&left), halves_of_all(&right));
    in_order([first, second, third, fourth])
};

/// The table for one basis: for each `k`, the coefficients of the real part and of the imaginary one.
type OneBasis = [[[f64; COEFFICIENTS]; 2]; DEGREE + 1];

/// The tables for several bases, side by side.
const fn in_order<const N: usize>(bases: [OneBasis; N]) -> Table<N> {
    let mut table = [[[[0.0; N]; 2]; COEFFICIENTS]; DEGREE + 1];
    let mut at = 0;
    while at < N * 2 * COEFFICIENTS * (DEGREE + 1) {
        let (n, part, i, k) =
            (at % N, at / N % 2, at / N / 2 % COEFFICIENTS, at / N / 2 / COEFFICIENTS);
        table[k][i][part][n] = bases[n][k][part][i];
        at += 1;
    }
    table
}

/// The tables for Bernstein's bases on the halves of an interval.
const fn halves_of_all(whole: &OneBasis) -> [OneBasis; 2] {
    let mut halves = [*whole; 2];
    let mut at = 0;
    while at < 2 * (DEGREE + 1) {
        let (part, k) = (at % 2, at / 2);
        let [left, right] = halves_of(&whole[k][part]);
        halves[0][k][part] = left;
        halves[1][k][part] = right;
        at += 1;
    }
    halves
}

/// The products of eight linear factors `1 + i t` or `1 − i t`, in Gaussian integers. `factor` has the
/// coefficients of `1 + i t` in the basis. For Bernstein's basis the products are divided by binomial
/// coefficients.
const fn table(factor: [[i64; 2]; 2], over_binomials: bool) -> OneBasis {
    let mut table = [[[0.0; COEFFICIENTS]; 2]; DEGREE + 1];
    let mut k = 0;
    while k <= DEGREE {
        let mut product = [[0_i64; 2]; COEFFICIENTS];
        product[0] = [1, 0];
        let mut n = 0;
        while n < HALF {
            let sign = if n < DEGREE + k { 1 } else { -1 };
            let mut next = [[0_i64; 2]; COEFFICIENTS];
            let mut j = 0;
            while j <= n {
                let [a, b] = product[j];
                let mut step = 0;
                while step < 2 {
                    let [c, d] = [factor[step][0], sign * factor[step][1]];
                    next[j + step][0] += a * c - b * d;
                    next[j + step][1] += a * d + b * c;
                    step += 1;
                }
                j += 1;
            }
            product = next;
            n += 1;
        }
        let mut j = 0;
        let mut binomial = 1;
        while j <= HALF {
            let over = if over_binomials { binomial } else { 1 };
            let twice = if k > 0 { 2.0 } else { 1.0 };
            table[k][0][j] = twice * product[j][0] as f64 / over as f64;
            table[k][1][j] = twice * product[j][1] as f64 / over as f64;
            binomial = binomial * (HALF - j) as i64 / (j + 1) as i64;
            j += 1;
        }
        k += 1;
    }
    table
}
