//! Which legs get an imaginary joint: the upper section as a mechanism of its own.

use crate::subspace::{Basis, TOLERANCE};
use crate::svd::Svd;
use nalgebra::{DMatrix, DVector, Vector6};

/// The upper parts of all legs between the lower section and the platform, in normalised screws.
pub(super) struct UpperSection<'a> {
    /// Of the subgroup that it moves in.
    pub basis: &'a Basis,
    /// Upper screws, leg by leg.
    pub legs: &'a [&'a [Vector6<f64>]],
    /// The screw of the intersection motion, along which imaginary joints lie.
    pub intersection: Vector6<f64>,
}

/// A set of legs with an imaginary joint.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Choice {
    /// Indices of the legs, `S`, ascending.
    pub legs: Vec<usize>,
    /// Mobility of the upper section with an imaginary joint in each of them, `F(S)`.
    pub mobility: usize,
    /// The same without any, `F0`.
    pub without: usize,
}

impl UpperSection<'_> {
    /// The largest set `S` of candidates with `F(S) − F0 = |S|` and `0 ≤ N − F(S) ≤ dim A`; every
    /// candidate where there is no such set. Of sets of one size, the one with the legs lowest in
    /// `order`.
    ///
    /// An imaginary joint adds a column to the closure of the upper section. `|S|` of them add
    /// `|S|` to its mobility exactly if they add nothing to its rank, that is if every single one of
    /// these columns depends on the section's own. So the legs that may be in `S` are found one by
    /// one, and no subsets need to be tried.
    pub fn imaginary_joints(&self, n: usize, dim_a: usize, order: &[impl Ord]) -> Choice {
        let candidates: Vec<usize> = (0..self.legs.len()).filter(|&i| self.candidate(i)).collect();
        let own = Svd::new(self.closure(&[]));
        let rank = own.rank(TOLERANCE);
        let without = own.values.len() - rank;

        let mut free: Vec<usize> =
            candidates.iter().copied().filter(|&i| self.depends(i, &own, rank)).collect();
        free.sort_by_key(|&i| &order[i]);
        free.truncate(n.saturating_sub(without));
        free.sort_unstable();
        let mobility = without + free.len();
        let all = self.mobility(&candidates);
        // No imaginary joint at all is right only if they could not move even all together.
        let qualifies = n.saturating_sub(mobility) <= dim_a && (!free.is_empty() || all == without);
        if qualifies {
            Choice { legs: free, mobility, without }
        } else {
            Choice { legs: candidates, mobility: all, without }
        }
    }

    /// Whether the intersection motion is none that the leg's upper part makes by itself.
    fn candidate(&self, leg: usize) -> bool {
        let own = self.legs[leg];
        let with: Vec<_> = own.iter().copied().chain([self.intersection]).collect();
        Basis::span(&with).dimension() == own.len() + 1
    }

    /// Whether an imaginary joint in a leg is among what the closure's columns span already.
    fn depends(&self, leg: usize, own: &Svd, rank: usize) -> bool {
        let mut column = DVector::zeros(own.image.nrows());
        self.insert(leg, &mut column);
        let span = own.image.columns(0, rank);
        let mut residual = column;
        for (direction, length) in span.column_iter().zip(&own.values) {
            let along = direction.dot(&residual) / (length * length);
            residual.axpy(-along, &direction, 1.0);
        }
        residual.norm() <= TOLERANCE
    }

    fn insert(&self, leg: usize, column: &mut DVector<f64>) {
        for (i, b) in self.basis.vectors().iter().enumerate() {
            column[leg * self.basis.dimension() + i] = b.dot(&self.intersection);
        }
    }

    fn mobility(&self, imaginary: &[usize]) -> usize {
        let closure = self.closure(imaginary);
        closure.ncols() - Svd::new(closure).rank(TOLERANCE)
    }

    /// The closure of the section within its subgroup: as many rows a leg as that has dimensions, a
    /// column a screw, one an imaginary joint, and as many as dimensions for the platform.
    fn closure(&self, imaginary: &[usize]) -> DMatrix<f64> {
        let rows = self.basis.dimension();
        let mut columns = vec![];
        for (k, leg) in self.legs.iter().enumerate() {
            for screw in *leg {
                columns.push((k, *screw));
            }
        }
        columns.extend(imaginary.iter().map(|&k| (k, self.intersection)));
        let joints = columns.len();
        DMatrix::from_fn(rows * self.legs.len(), joints + rows, |i, j| {
            let (leg, row) = (i / rows, i % rows);
            match columns.get(j) {
                Some((k, screw)) if *k == leg => self.basis.vectors()[row].dot(screw),
                Some(_) => 0.0,
                None => f64::from(u8::from(j - joints == row)),
            }
        })
    }
}
