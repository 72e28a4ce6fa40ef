//! Singular values by one-sided Jacobi rotations.
//!
//! Every decision on rank in this crate rests on singular values, and every fitted axis on a singular
//! vector. The matrices are rank deficient as a rule: coaxial joints are equal columns. For such matrices
//! nalgebra's decomposition returns wrong values together with vectors (its issue 1172; with 0.35.0,
//! in 0.7 percent of random small matrices with equal columns), and no kernel where there are more
//! columns than rows. One-sided Jacobi finds both to full accuracy, always terminates, and is quick
//! enough for the sizes met here, a few dozen columns. Demmel and Veselić, "Jacobi's method is more
//! accurate than QR", SIAM J. Matrix Anal. Appl. 13 (1992).

use nalgebra::{DMatrix, DVector};

/// The largest number of sweeps over all pairs of columns. Regular matrices need about eight.
const MAX_SWEEPS: usize = 40;

/// The decomposition `A V = U Σ` of an m × n matrix. Every column has a singular value, so that some are
/// zero if n > m.
pub struct Svd {
    /// The n singular values, largest first.
    pub values: Vec<f64>,
    /// The orthogonal n × n matrix `V`, whose last columns span the kernel.
    pub right: DMatrix<f64>,
    /// The m × n matrix `U Σ`, whose columns are orthogonal and have the lengths in `values`.
    pub image: DMatrix<f64>,
}

impl Svd {
    /// Decomposes a matrix of finite numbers; an empty one has no singular values.
    pub fn new(matrix: DMatrix<f64>) -> Self {
        let n = matrix.ncols();
        let (mut image, mut right) = (matrix, DMatrix::identity(n, n));
        orthogonalise(&mut image, Some(&mut right));
        let lengths: Vec<f64> = image.column_iter().map(|column| column.norm()).collect();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&i, &j| lengths[j].total_cmp(&lengths[i]));
        Self {
            values: order.iter().map(|&i| lengths[i]).collect(),
            right: right.select_columns(&order),
            image: image.select_columns(&order),
        }
    }

    /// The rank: the number of singular values above `tolerance` times the largest.
    pub fn rank(&self, tolerance: f64) -> usize {
        count_above(&self.values, tolerance)
    }

    /// The shortest vector that the matrix maps nearest to `wanted`. Singular values that do not count for the rank, within
    /// `tolerance`, are zero.
    pub fn solve(&self, wanted: &DVector<f64>, tolerance: f64) -> DVector<f64> {
        let mut solution = DVector::zeros(self.right.nrows());
        for i in 0..self.rank(tolerance) {
            let share = self.image.column(i).dot(wanted) / (self.values[i] * self.values[i]);
            solution += self.right.column(i) * share;
        }
        solution
    }

    /// Orthonormal columns that the matrix maps to zero, within `tolerance` (as for the rank).
    pub fn kernel(&self, tolerance: f64) -> DMatrix<f64> {
        let rank = self.rank(tolerance);
        self.right.columns(rank, self.right.ncols() - rank).into_owned()
    }
}

/// The singular values alone, in no particular order, and only as many as the smaller of the matrix's two
/// sizes. This is quicker than [`Svd::new`], because the rows of a triangular factor with pivots are nearly
/// orthogonal already (Z. Drmač and K. Veselić, "New fast and accurate Jacobi SVD algorithm", SIAM J. Matrix
/// Anal. Appl. 29, 2008).
pub fn singular_values(matrix: DMatrix<f64>) -> Vec<f64> {
    if matrix.is_empty() {
        return vec![];
    }
    let mut image = matrix.col_piv_qr().r().transpose();
    orthogonalise(&mut image, None);
    image.column_iter().map(|column| column.norm()).collect()
}

/// The rank of a matrix: the number of singular values above `tolerance` times the largest.
pub fn rank(matrix: DMatrix<f64>, tolerance: f64) -> usize {
    count_above(&singular_values(matrix), tolerance)
}

fn count_above(values: &[f64], tolerance: f64) -> usize {
    let largest = values.iter().copied().fold(0.0, f64::max);
    values.iter().filter(|&&value| value > tolerance * largest).count()
}

/// Rotates the columns of a matrix of any scale until they are orthogonal, pair by pair, and those of `right` with them.
/// Nothing is allocated.
pub fn orthogonalise(image: &mut DMatrix<f64>, mut right: Option<&mut DMatrix<f64>>) {
    let negligible = (f64::EPSILON * image.norm()).powi(2);
    let [rows, columns] = [image.nrows(), image.ncols()];
    let image = image.as_mut_slice();
    for _ in 0..MAX_SWEEPS {
        let mut settled = true;
        for p in 0..columns {
            for q in p + 1..columns {
                let [pp, qq, pq] = products(image, rows, p, q);
                if pp.min(qq) <= negligible || pq.abs() <= f64::EPSILON * (pp * qq).sqrt() {
                    continue;
                }
                settled = false;
                // Both columns are above `negligible`, so that `zeta` is at most 1/(2 ε²), and its square does not overflow.
                let zeta = (qq - pp) / (2.0 * pq);
                let tan = zeta.signum() / (zeta.abs() + (1.0 + zeta * zeta).sqrt());
                let cos = 1.0 / (1.0 + tan * tan).sqrt();
                let rotation = Rotation { cos, sin: cos * tan };
                rotation.apply(image, rows, p, q);
                if let Some(right) = &mut right {
                    rotation.apply(right.as_mut_slice(), columns, p, q);
                }
            }
        }
        if settled {
            break;
        }
    }
}

/// The inner products `p · p`, `q · q` and `p · q` of two columns.
fn products(matrix: &mut [f64], rows: usize, p: usize, q: usize) -> [f64; 3] {
    let [mut pp, mut qq, mut pq] = [0.0; 3];
    let (p, q) = pair(matrix, rows, p, q);
    for (&mut x, &mut y) in p.iter_mut().zip(q) {
        pp += x * x;
        qq += y * y;
        pq += x * y;
    }
    [pp, qq, pq]
}

/// The rotation that makes two columns orthogonal.
#[derive(Clone, Copy)]
struct Rotation {
    cos: f64,
    sin: f64,
}

impl Rotation {
    /// Rotates columns `p < q` of a matrix with `rows` rows, which is stored by columns.
    fn apply(self, matrix: &mut [f64], rows: usize, p: usize, q: usize) {
        let Self { cos, sin } = self;
        let (p, q) = pair(matrix, rows, p, q);
        for (x, y) in p.iter_mut().zip(q) {
            (*x, *y) = (cos * *x - sin * *y, sin * *x + cos * *y);
        }
    }
}

/// Two columns `p < q` of a matrix that is stored by columns, as slices.
fn pair(matrix: &mut [f64], rows: usize, p: usize, q: usize) -> (&mut [f64], &mut [f64]) {
    let (before, after) = matrix.split_at_mut(q * rows);
    (&mut before[p * rows..][..rows], &mut after[..rows])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Rounding of a dozen rotations over matrices with entries up to one.
    const ROUNDING: f64 = 1e-13;

    fn matrix() -> impl Strategy<Value = DMatrix<f64>> {
        (1..9_usize, 1..9_usize).prop_flat_map(|(m, n)| {
            prop::collection::vec(-1.0..1.0, m * n)
                .prop_map(move |entries| DMatrix::from_vec(m, n, entries))
        })
    }

    proptest! {
        #[test]
        fn factors_are_orthogonal_and_give_the_matrix_back(a in matrix()) {
            let svd = Svd::new(a.clone());
            let n = a.ncols();
            prop_assert!((svd.right.tr_mul(&svd.right) - DMatrix::identity(n, n)).amax() < ROUNDING);
            prop_assert!((&svd.image * svd.right.transpose() - &a).amax() < ROUNDING);
            let gram = svd.image.tr_mul(&svd.image);
            for i in 0..n {
                for j in 0..n {
                    let expected = if i == j { svd.values[i].powi(2) } else { 0.0 };
                    prop_assert!((gram[(i, j)] - expected).abs() < ROUNDING);
                }
            }
            prop_assert!(svd.values.is_sorted_by(|x, y| x >= y));
            let mut alone = singular_values(a.clone());
            alone.sort_by(|x, y| y.total_cmp(x));
            alone.resize(n, 0.0);
            prop_assert!(alone.iter().zip(&svd.values).all(|(x, y)| (x - y).abs() < ROUNDING));
        }

        /// The rest is across all columns, and the solution across the kernel, so that none is shorter.
        #[test]
        fn a_solution_is_the_nearest_and_the_shortest(a in matrix(), all in prop::collection::vec(-1.0..1.0, 8)) {
            let wanted = DVector::from_column_slice(&all[..a.nrows()]);
            let svd = Svd::new(a.clone());
            let smallest = svd.values[svd.rank(1e-9) - 1];
            prop_assume!(smallest > 1e-2);
            let solution = svd.solve(&wanted, 1e-9);
            prop_assert!(a.tr_mul(&(&a * &solution - &wanted)).amax() < 1e-10);
            prop_assert!(svd.kernel(1e-9).tr_mul(&solution).amax() < 1e-10 || a.ncols() == svd.rank(1e-9));
        }

        #[test]
        fn a_product_has_the_rank_of_its_inner_dimension(
            left in prop::collection::vec(-1.0..1.0, 7 * 2),
            right in prop::collection::vec(-1.0..1.0, 2 * 5),
        ) {
            let (left, right) = (DMatrix::from_vec(7, 2, left), DMatrix::from_vec(2, 5, right));
            prop_assume!(Svd::new(left.clone()).values[1] > 1e-2);
            prop_assume!(Svd::new(right.clone()).values[1] > 1e-2);
            let product = left * right;
            let svd = Svd::new(product.clone());
            prop_assert_eq!(svd.rank(1e-9), 2);
            prop_assert_eq!(rank(product.clone(), 1e-9), 2);
            let kernel = svd.kernel(1e-9);
            prop_assert_eq!(kernel.ncols(), 3);
            prop_assert!((product * kernel).amax() < ROUNDING);
        }
    }

    /// With singular vectors, nalgebra 0.35.0 gives a singular value of 4.54 here instead of sqrt(15).
    #[test]
    fn equal_columns_are_decomposed() {
        for (m, n) in [(3, 5), (5, 3), (6, 21), (24, 26)] {
            let svd = Svd::new(DMatrix::from_element(m, n, 1.0));
            assert!((svd.values[0] - ((m * n) as f64).sqrt()).abs() < 1e-12);
            assert!(svd.values[1..].iter().all(|value| *value < 1e-12));
            assert_eq!(svd.kernel(1e-9).ncols(), n - 1);
        }
    }

    /// Matrices of small integers with many zeros and with equal or opposite columns, with and without
    /// singular vectors.
    #[test]
    fn structured_matrices_are_decomposed() {
        let mut seed = 7_u64;
        let mut draw = |below: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % below
        };
        for _ in 0..20_000 {
            let (m, n) = (1 + draw(6), 1 + draw(9));
            let entries = [0.0, 0.0, 0.0, 1.0, -1.0, 0.5_f64.sqrt(), 1e-9];
            let mut a = DMatrix::from_fn(m, n, |_, _| entries[draw(7)]);
            let (from, to) = (draw(n), draw(n));
            let copy = a.column(from) * [1.0, -1.0, 0.0][draw(3)];
            a.set_column(to, &copy);
            let svd = Svd::new(a.clone());
            assert!((svd.right.tr_mul(&svd.right) - DMatrix::identity(n, n)).amax() < ROUNDING);
            assert!((&svd.image * svd.right.transpose() - &a).amax() < ROUNDING, "{a}");
            let gram = svd.image.tr_mul(&svd.image);
            let expected = |i: usize, j: usize| if i == j { svd.values[i].powi(2) } else { 0.0 };
            assert!((gram - DMatrix::from_fn(n, n, expected)).amax() < ROUNDING, "{a}");
            let mut alone = singular_values(a.clone());
            alone.sort_by(|x, y| y.total_cmp(x));
            alone.resize(n, 0.0);
            let worst = alone.iter().zip(&svd.values).map(|(x, y)| (x - y).abs());
            assert!(worst.fold(0.0, f64::max) < ROUNDING, "{a}{alone:?} {:?}", svd.values);
        }
    }

    #[test]
    fn an_empty_matrix_has_rank_zero() {
        assert_eq!(rank(DMatrix::zeros(6, 0), 1e-9), 0);
        assert_eq!(rank(DMatrix::zeros(0, 3), 1e-9), 0);
        assert_eq!(Svd::new(DMatrix::zeros(0, 3)).kernel(1e-9).ncols(), 3);
    }
}
