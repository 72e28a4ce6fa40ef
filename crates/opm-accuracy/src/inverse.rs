//! The pseudo-inverse of a matrix without full rank.
//!
//! The loops of overconstrained mechanisms give matrices with fewer independent rows than rows. Their rank is decided by
//! singular values.

use nalgebra::DMatrix;
use opm_core::numeric::svd::orthogonalise;
use opm_core::velocity::SINGULAR;

/// A matrix `A = Σ σₖ lₖ rₖᵀ`, decomposed.
pub struct PseudoInverse {
    /// The left singular vectors `lₖ`, a column for each row of the matrix.
    left: DMatrix<f64>,
    /// The vectors `σₖ rₖ`.
    image: DMatrix<f64>,
    /// The singular values `σₖ`.
    values: Vec<f64>,
    /// The largest singular value that counts as zero.
    zero: f64,
}

impl PseudoInverse {
    /// Decomposes a matrix. A singular value below [`SINGULAR`] times the largest counts as zero.
    pub fn new(matrix: &DMatrix<f64>) -> Self {
        let (mut image, mut left) =
            (matrix.transpose(), DMatrix::identity(matrix.nrows(), matrix.nrows()));
        orthogonalise(&mut image, Some(&mut left));
        let values: Vec<f64> = image.column_iter().map(|column| column.norm()).collect();
        let zero = SINGULAR * values.iter().copied().fold(0.0, f64::max);
        Self { left, image, values, zero }
    }

    /// The numbers of the singular values that are not zero.
    fn regular(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.values.len()).filter(|&k| self.values[k] > self.zero)
    }

    /// The shortest `x` for which `A x` is nearest to each column.
    pub fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let mut solved = DMatrix::zeros(self.image.nrows(), right.ncols());
        for k in self.regular() {
            let along = self.left.column(k).tr_mul(right) / self.values[k].powi(2);
            solved += self.image.column(k) * along;
        }
        solved
    }

    /// An orthonormal basis of the space that no `A x` has a component in.
    pub fn left_null_space(&self) -> DMatrix<f64> {
        let zeros: Vec<usize> =
            (0..self.values.len()).filter(|&k| self.values[k] <= self.zero).collect();
        self.left.select_columns(&zeros)
    }

    /// Whether `A x` determines a component of `x`.
    pub fn determines(&self, component: usize) -> bool {
        let along = |k: usize| (self.image[(component, k)] / self.values[k]).powi(2);
        1.0 - self.regular().map(along).sum::<f64>() < SINGULAR
    }
}
