//! The largest and the smallest singular value of small matrices, of many at once.
//!
//! Reflections bring a matrix to a bidiagonal `B` with the same singular values (G. Golub and W. Kahan,
//! "Calculating the singular values and pseudo-inverse of a matrix", SIAM J. Numer. Anal. 2, 1965). Its entries
//! `d₁, e₁, d₂, e₂ …` give the polynomial `det(λ − BᵀB)` by a recurrence that subtracts nothing but
//! products of `eₖ²` and `dₖ²`. So the polynomial is exact for a matrix whose entries differ from these by rounding,
//! each in proportion to itself, and so small singular values are as exact as large ones (J. Demmel and W. Kahan,
//! "Accurate singular values of bidiagonal matrices", SIAM J. Sci. Stat. Comput. 11, 1990). Laguerre's method goes to
//! the polynomial's first root from below all of them, and to the last one from above. From there it never leaps over
//! a root, and its convergence is cubic. Where rounding does lead across one, the signs of the recurrence tell.
//!
//! Every step is a loop over the lanes, with the same arithmetic for any number of them: the result for one matrix does
//! not depend on which others are beside it.

#![expect(clippy::needless_range_loop, reason = "a loop over the lanes is one for all columns")]

/// A matrix for each of `L` lanes, by columns: `matrices[column][row][lane]`. There is room for `N` columns and rows.
pub type Matrices<const N: usize, const L: usize> = [[[f64; L]; N]; N];

/// A step that is this small, relative to the root, is rounding.
const SETTLED: f64 = 4.0 * f64::EPSILON;

/// More steps than any polynomial needs. Where all roots differ there are some five. Near several equal ones a step leaves
/// 0.42 of the distance at most, until that is smaller than their difference or than rounding.
const MOST_STEPS: usize = 100;

/// Some of the singular values of the matrices.
pub struct Extremes<const L: usize> {
    /// The largest ones.
    pub largest: [f64; L],
    /// The smallest ones.
    pub smallest: [f64; L],
    /// The products of all.
    pub product: [f64; L],
}

/// The squares of the entries of bidiagonal matrices.
struct Squares<const N: usize, const L: usize> {
    diagonal: [[f64; L]; N],
    /// The entry to the right of each of the diagonal.
    above: [[f64; L]; N],
}

/// The end of the interval of all roots from which the first one is looked for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    Low,
    High,
}

/// The extreme singular values of the first rows and columns, of which there are at least as many rows. Where an entry
/// is not finite, or squares overflow, the largest value is not finite, either.
#[inline(always)]
pub fn extremes<const N: usize, const L: usize>(
    matrices: &mut Matrices<N, L>,
    [rows, columns]: [usize; 2],
) -> Extremes<L> {
    let mut squares = bidiagonal(matrices, [rows, columns]);
    let mut trace = [0.0; L];
    let mut product = [1.0; L];
    for k in 0..columns {
        for lane in 0..L {
            trace[lane] += squares.diagonal[k][lane] + squares.above[k][lane];
            product[lane] *= squares.diagonal[k][lane].sqrt();
        }
    }
    // In units of the sum of all roots, nothing overflows.
    for k in 0..columns {
        for lane in 0..L {
            let inverse = if trace[lane] > 0.0 { trace[lane].recip() } else { 0.0 };
            squares.diagonal[k][lane] *= inverse;
            squares.above[k][lane] *= inverse;
        }
    }
    let (mut largest, mut smallest) =
        (root(&squares, columns, End::High), root(&squares, columns, End::Low));
    for lane in 0..L {
        largest[lane] = (largest[lane] * trace[lane]).sqrt();
        smallest[lane] = (smallest[lane] * trace[lane]).sqrt();
    }
    Extremes { largest, smallest, product }
}

/// A reflection `1 − β v vᵀ`.
pub struct Reflection<const N: usize, const L: usize> {
    v: [[f64; L]; N],
    beta: [f64; L],
    /// The square of the one component that it leaves of the vector that it was made from.
    square: [f64; L],
}

impl<const N: usize, const L: usize> Reflection<N, L> {
    /// No reflection: it changes nothing.
    pub const NONE: Self = Self { v: [[0.0; L]; N], beta: [0.0; L], square: [0.0; L] };

    /// The reflection that leaves the first one of the components from `start` to `end`.
    #[inline(always)]
    pub fn new(mut v: [[f64; L]; N], start: usize, end: usize) -> Self {
        let mut square = [0.0; L];
        for component in &v[start..end] {
            for lane in 0..L {
                square[lane] += component[lane] * component[lane];
            }
        }
        let mut beta = [0.0; L];
        for lane in 0..L {
            let length = square[lane].sqrt();
            v[start][lane] += length.copysign(v[start][lane]);
            let half = length * v[start][lane].abs();
            beta[lane] = if half > 0.0 { half.recip() } else { 0.0 };
        }
        Self { v, beta, square }
    }

    /// Reflects components of a vector.
    #[inline(always)]
    pub fn apply(&self, x: &mut [[f64; L]; N], start: usize, end: usize) {
        let mut along = [0.0; L];
        for (v, x) in self.v[start..end].iter().zip(&x[start..end]) {
            for lane in 0..L {
                along[lane] += v[lane] * x[lane];
            }
        }
        for lane in 0..L {
            along[lane] *= self.beta[lane];
        }
        for (v, x) in self.v[start..end].iter().zip(&mut x[start..end]) {
            for lane in 0..L {
                x[lane] -= along[lane] * v[lane];
            }
        }
    }

    /// Reflects components of a row of matrices.
    #[inline(always)]
    pub fn apply_to_row(&self, m: &mut Matrices<N, L>, row: usize, start: usize, end: usize) {
        let mut x = [[0.0; L]; N];
        for column in start..end {
            x[column] = m[column][row];
        }
        self.apply(&mut x, start, end);
        for column in start..end {
            m[column][row] = x[column];
        }
    }
}

/// Brings matrices to bidiagonal form.
#[inline(always)]
fn bidiagonal<const N: usize, const L: usize>(
    m: &mut Matrices<N, L>,
    [rows, columns]: [usize; 2],
) -> Squares<N, L> {
    let mut squares = Squares { diagonal: [[0.0; L]; N], above: [[0.0; L]; N] };
    for k in 0..columns {
        let reflection = Reflection::new(m[k], k, rows);
        squares.diagonal[k] = reflection.square;
        for column in &mut m[k + 1..columns] {
            reflection.apply(column, k, rows);
        }
        if k + 1 < columns {
            let mut row = [[0.0; L]; N];
            for column in k + 1..columns {
                row[column] = m[column][k];
            }
            let reflection = Reflection::new(row, k + 1, columns);
            squares.above[k] = reflection.square;
            if k + 2 < columns {
                for row in k + 1..rows {
                    reflection.apply_to_row(m, row, k + 1, columns);
                }
            }
        }
    }
    squares
}

/// The first root from one end of `det(λ − BᵀB)`, for matrices whose roots have the sum one.
#[inline(always)]
fn root<const N: usize, const L: usize>(
    squares: &Squares<N, L>,
    columns: usize,
    end: End,
) -> [f64; L] {
    // The sense in which the root is approached, and the last numbers before it.
    let (inward, mut before) = match end {
        End::Low => (1.0, [0.0; L]),
        End::High => (-1.0, [1.0; L]),
    };
    let mut at = before;
    // How far to go back from a number behind the root, relative to it: the farther, the more often.
    let mut back = [0.0; L];
    let mut settled = [0_u64; L];
    let (mut steps, mut are_before) = ([0.0; L], [0_u64; L]);
    for _ in 0..MOST_STEPS {
        for lane in 0..L {
            (steps[lane], are_before[lane]) = laguerre(squares, columns, lane, at[lane], end);
        }
        let mut moves = 0;
        for lane in 0..L {
            let (here, last) = (at[lane], before[lane]);
            let is_before = are_before[lane] != 0;
            let last = if is_before { here } else { last };
            // Steps stop short of the root. Where roots are nearly equal, rounding may still lead across one.
            let (step, short) = if is_before { (steps[lane], SETTLED) } else { (0.0, back[lane]) };
            let next = (here - step) * (1.0 - inward * short);
            let halfway = 0.5 * (here + last);
            let next = if inward * (next - last) > 0.0 { next } else { halfway };
            let goes = u64::from(inward * (next - last) > SETTLED * next) & (settled[lane] ^ 1);
            back[lane] = 16.0 * short;
            before[lane] = last;
            settled[lane] = goes ^ 1;
            at[lane] = if goes != 0 { next } else { last };
            moves |= goes;
        }
        if moves == 0 {
            break;
        }
    }
    before
}

/// Laguerre's step `n p / (p′ ± √((n − 1) ((n − 1) p′² − n p p″)))` from a number before the first root from one end, and
/// whether the number is there. It is if the polynomials of the first one, two … columns are all positive, with the
/// signs with which they are at this end.
///
/// With `uₖ` the polynomial of the first `k` columns, `w` an auxiliary one, and `s` the sign of `λ` at the end,
/// `wₖ₊₁ = uₖ − s eₖ² wₖ` and `uₖ₊₁ = s (λ wₖ₊₁ − dₖ₊₁² uₖ)`.
#[inline(always)]
fn laguerre<const N: usize, const L: usize>(
    squares: &Squares<N, L>,
    columns: usize,
    lane: usize,
    at: f64,
    end: End,
) -> (f64, u64) {
    let s = match end {
        End::Low => -1.0,
        End::High => 1.0,
    };
    // Each with its first and its second derivative.
    let (mut u, mut w) = ([1.0, 0.0, 0.0], [0.0; 3]);
    let mut is_before = 1;
    for k in 0..columns {
        let e = if k > 0 { s * squares.above[k - 1][lane] } else { 0.0 };
        let d = s * squares.diagonal[k][lane];
        w = [u[0] - e * w[0], u[1] - e * w[1], u[2] - e * w[2]];
        u = [
            s * at * w[0] - d * u[0],
            s * w[0] + s * at * w[1] - d * u[1],
            2.0 * s * w[1] + s * at * w[2] - d * u[2],
        ];
        is_before &= u64::from(u[0] >= 0.0);
    }
    let n = columns as f64;
    let [p, first, second] = u;
    let square = (n - 1.0) * ((n - 1.0) * first * first - n * p * second);
    let root = square.max(0.0).sqrt();
    // At a root that is a multiple one, this would be zero over zero.
    let step = n * p / (first + root.copysign(first));
    (if p == 0.0 { 0.0 } else { step }, is_before)
}

#[cfg(test)]
mod tests;
