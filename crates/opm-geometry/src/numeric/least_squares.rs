//! Small systems of linear equations, solved by least squares without allocation.

/// The largest number of unknowns.
pub const MOST: usize = 6;

/// The decomposition `A P = Q R` of a matrix with at most [`MOST`] columns and at least as many rows, by
/// Gram-Schmidt's modified method with the longest remaining column first. With the right side treated like
/// another column, that is as accurate as Householder's method: Å. Björck, "Solving linear least squares problems
/// by Gram-Schmidt orthogonalization", BIT 7 (1967).
#[derive(Clone, Debug)]
pub struct LeastSquares {
    rows: usize,
    columns: usize,
    /// The matrix, and after the decomposition `Q`, column by column.
    entries: Vec<f64>,
    upper: [[f64; MOST]; MOST],
    /// One over the diagonal of `upper`.
    inverse: [f64; MOST],
    order: [usize; MOST],
}

impl LeastSquares {
    /// A buffer for matrices of this size.
    #[inline]
    pub fn new(rows: usize, columns: usize) -> Self {
        let entries = vec![0.0; rows * columns];
        let (upper, inverse, order) = ([[0.0; MOST]; MOST], [0.0; MOST], [0; MOST]);
        Self { rows, columns, entries, upper, inverse, order }
    }

    /// The entries of a column of the matrix, to be written.
    #[inline(always)]
    pub fn column_mut(&mut self, column: usize) -> &mut [f64] {
        &mut self.entries[column * self.rows..(column + 1) * self.rows]
    }

    /// Decomposes the matrix whose rows were written. Returns `false` if a column is a combination of the others: what
    /// is left of it is not longer than `tolerance` times the longest column.
    #[inline(always)]
    pub fn decompose(&mut self, tolerance: f64) -> bool {
        self.order = std::array::from_fn(|j| j);
        let mut longest = 0.0;
        for k in 0..self.columns {
            let (mut pivot, mut square) = (k, f64::NEG_INFINITY);
            for j in k..self.columns {
                let next = dot(self.column(j), self.column(j));
                if next > square {
                    (pivot, square) = (j, next);
                }
            }
            self.swap(k, pivot);
            let length = square.sqrt();
            if k == 0 {
                longest = length;
            }
            if length.is_nan() || length <= tolerance * longest {
                return false;
            }
            self.upper[k][k] = length;
            let (done, rest) = self.entries.split_at_mut((k + 1) * self.rows);
            let unit = &mut done[k * self.rows..];
            let inverse = length.recip();
            self.inverse[k] = inverse;
            for x in &mut *unit {
                *x *= inverse;
            }
            for (column, j) in rest.chunks_exact_mut(self.rows).zip(k + 1..) {
                self.upper[k][j] = dot(unit, column);
                subtract(column, self.upper[k][j], unit);
            }
        }
        true
    }

    /// The unknowns for a right side, zeros beyond the last. What they leave of it is left in `right`.
    pub fn solve(&self, right: &mut [f64]) -> [f64; MOST] {
        let n = self.columns;
        let mut found = [0.0; MOST];
        for (k, found) in found[..n].iter_mut().enumerate() {
            *found = dot(self.column(k), right);
            subtract(right, *found, self.column(k));
        }
        for k in (0..n).rev() {
            let known: f64 = (k + 1..n).map(|j| self.upper[k][j] * found[j]).sum();
            found[k] = (found[k] - known) * self.inverse[k];
        }
        let mut ordered = [0.0; MOST];
        for (&column, value) in self.order[..n].iter().zip(found) {
            ordered[column] = value;
        }
        ordered
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.entries[j * self.rows..(j + 1) * self.rows]
    }

    /// Swaps two columns that are not decomposed yet, the first one before the second or the same.
    fn swap(&mut self, first: usize, second: usize) {
        if first == second {
            return;
        }
        let (before, after) = self.entries.split_at_mut(second * self.rows);
        before[first * self.rows..(first + 1) * self.rows].swap_with_slice(&mut after[..self.rows]);
        self.order.swap(first, second);
        self.upper[..first].iter_mut().for_each(|row| row.swap(first, second));
    }
}

#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (a, b) in a.iter().zip(b) {
        sum += a * b;
    }
    sum
}

#[inline(always)]
fn subtract(from: &mut [f64], share: f64, of: &[f64]) {
    for (x, y) in from.iter_mut().zip(of) {
        *x -= share * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::svd::Svd;
    use nalgebra::{DMatrix, DVector};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2_000))]

        /// The solution of the normal equations, which nalgebra solves; where the matrix is regular.
        #[test]
        fn solutions_are_those_of_the_normal_equations(
            n in 1..=6_usize, more in 0..4_usize,
            entries in prop::collection::vec(-1.0..1.0_f64, 54), right in prop::collection::vec(-1.0..1.0_f64, 9),
        ) {
            let rows = n + more;
            let matrix = DMatrix::from_fn(rows, n, |i, j| entries[6 * i + j]);
            let values = Svd::new(matrix.clone()).values;
            prop_assume!(values[n - 1] > 1e-2 * values[0]);
            let right = DVector::from_column_slice(&right[..rows]);
            let expected = (matrix.tr_mul(&matrix)).lu().solve(&matrix.tr_mul(&right)).unwrap();
            let mut system = of(&matrix);
            prop_assert!(system.decompose(1e-9));
            let mut rest = right.clone();
            let found = system.solve(rest.as_mut_slice());
            for (found, expected) in found.iter().zip(&expected) {
                prop_assert!((found - expected).abs() < 1e-9, "{found} {expected}");
            }
            prop_assert!((&matrix * expected + rest - right).amax() < 1e-9);
        }

        /// A matrix whose columns are combinations of fewer, with and without zeros among them.
        #[test]
        fn dependent_columns_are_noticed(
            entries in prop::collection::vec(-1.0..1.0_f64, 30), shares in prop::collection::vec(-1.0..1.0_f64, 4),
            equal in any::<bool>(),
        ) {
            let mut matrix = DMatrix::from_fn(6, 5, |i, j| entries[5 * i + j]);
            let last = match equal {
                true => matrix.column(1) * shares[0],
                false => matrix.columns(0, 4) * DVector::from_column_slice(&shares),
            };
            matrix.set_column(4, &last);
            prop_assert!(!of(&matrix).decompose(1e-9));
        }
    }

    #[test]
    fn zeros_and_numbers_that_are_none_have_no_rank() {
        assert!(!of(&DMatrix::zeros(3, 2)).decompose(1e-9));
        assert!(!of(&DMatrix::from_element(3, 2, f64::NAN)).decompose(1e-9));
        assert!(of(&DMatrix::zeros(3, 0)).decompose(1e-9), "nothing is unknown");
    }

    fn of(matrix: &DMatrix<f64>) -> LeastSquares {
        let mut system = LeastSquares::new(matrix.nrows(), matrix.ncols());
        for (number, column) in matrix.column_iter().enumerate() {
            system.column_mut(number).copy_from_slice(column.as_slice());
        }
        system
    }
}
