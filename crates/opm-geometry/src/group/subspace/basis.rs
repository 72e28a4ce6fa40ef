//! Orthonormal bases for sets of normalised screws.

use super::TOLERANCE;
use crate::group::screw::Screw;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, Vector6};

/// A set of at most six orthonormal six-vectors, stored on the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Basis {
    vectors: [Vector6<f64>; 6],
    dimension: usize,
}

impl Basis {
    /// The basis of the zero subspace.
    pub const EMPTY: Self =
        Self { vectors: [Vector6::new(0., 0., 0., 0., 0., 0.); 6], dimension: 0 };

    /// The span of some vectors. Its rank is decided by singular values.
    pub fn span(vectors: &[Vector6<f64>]) -> Self {
        let rows = DMatrix::from_fn(vectors.len(), 6, |i, j| vectors[i][j]);
        let svd = Svd::new(rows);
        let mut basis = Self::EMPTY;
        basis.dimension = svd.rank(TOLERANCE);
        for (i, vector) in basis.vectors.iter_mut().enumerate().take(basis.dimension) {
            vector.copy_from(&svd.right.column(i));
        }
        basis
    }

    /// The orthonormal vectors, as many as the dimension.
    pub fn vectors(&self) -> &[Vector6<f64>] {
        &self.vectors[..self.dimension]
    }

    /// The number of vectors, 0 to 6.
    pub fn dimension(&self) -> usize {
        self.dimension
    }

    /// The component of a vector orthogonal to the span. It is projected twice, because one
    /// Gram-Schmidt pass loses digits.
    pub fn residual(&self, vector: &Vector6<f64>) -> Vector6<f64> {
        let project = |v: Vector6<f64>| self.vectors().iter().fold(v, |v, b| v - b * b.dot(&v));
        project(project(*vector))
    }

    /// Adds a direction if the vector's component outside the span is longer than `tolerance`.
    /// Returns whether it did.
    pub fn grow(&mut self, vector: &Vector6<f64>, tolerance: f64) -> bool {
        let residual = self.residual(vector);
        let length = residual.norm();
        let grows = self.dimension < 6 && length > tolerance;
        if grows {
            self.vectors[self.dimension] = residual / length;
            self.dimension += 1;
        }
        grows
    }

    /// How far the span is from closed under the Lie bracket: the largest distance from the span of a
    /// bracket of two basis vectors.
    pub fn bracket_excess(&self) -> f64 {
        self.brackets().map(|v| self.residual(&v).norm()).fold(0.0, f64::max)
    }

    /// The Lie brackets of all pairs of basis vectors.
    fn brackets(&self) -> impl Iterator<Item = Vector6<f64>> {
        let screws = self.vectors().iter().map(Screw::from_vector);
        screws.clone().enumerate().flat_map(move |(i, a)| {
            screws.clone().skip(i + 1).map(move |b| a.bracket(&b).to_vector())
        })
    }

    /// The smallest subspace that contains this one and its brackets; bracket components up to
    /// `tolerance` are ignored.
    pub fn closure(mut self, tolerance: f64) -> Self {
        loop {
            let before = self;
            for bracket in before.brackets() {
                self.grow(&bracket, tolerance);
            }
            if self.dimension == before.dimension {
                return self;
            }
        }
    }

    /// The intersection of two subspaces.
    pub fn intersection(&self, other: &Self) -> Self {
        let (own, theirs) = (self.vectors(), other.vectors());
        if own.is_empty() || theirs.is_empty() {
            return Self::EMPTY;
        }
        let columns: Vec<_> = own.iter().copied().chain(theirs.iter().map(|v| -v)).collect();
        let svd = Svd::new(DMatrix::from_fn(6, columns.len(), |i, j| columns[j][i]));
        // A kernel vector (x, y) means A x = B y: the mean of the two lies in both.
        let common: Vec<_> = svd
            .kernel(TOLERANCE)
            .column_iter()
            .map(|k| {
                (0..columns.len()).fold(Vector6::zeros(), |sum, i| {
                    let sign = if i < own.len() { 1.0 } else { -1.0 };
                    sum + columns[i] * (sign * k[i])
                })
            })
            .collect();
        Self::span(&common)
    }
}
