//! Which legs get an imaginary joint. The upper section is treated as a mechanism of its own.

use crate::group::subspace::{Basis, TOLERANCE};
use crate::numeric::svd::{self, Svd};
use nalgebra::{DMatrix, DVector, Vector6};

/// The upper section: the upper parts of all legs, between the lower section and the platform, as
/// normalised screws at a pose near home: at home itself, imaginary joints may depend that do not
/// elsewhere.
pub(super) struct UpperSection<'a> {
    /// Basis of the algebra of the group in which the section moves.
    pub basis: &'a Basis,
    /// The screws of the upper parts, leg by leg.
    pub legs: &'a [&'a [Vector6<f64>]],
    /// The screw of each leg's intersection motion, along which its imaginary joint lies; `None` where the two groups
    /// share the identity alone, so that no leg has one.
    pub intersection: Option<&'a [Vector6<f64>]>,
}

/// The chosen legs with an imaginary joint.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Choice {
    /// Indices of the legs, ascending: the set `S`.
    pub legs: Vec<usize>,
    /// Mobility of the upper section with these imaginary joints, `F(S)`.
    pub mobility: usize,
    /// Mobility of the upper section without imaginary joints, `F0`.
    pub without: usize,
}

impl UpperSection<'_> {
    /// Chooses the largest set `S` of candidates with `F(S) − F0 = |S|` and `0 ≤ N − F(S) ≤ dim A`.
    /// If there is no such set, every candidate is chosen. Among sets of equal size, the one whose
    /// legs are lowest in `order` is chosen.
    ///
    /// An imaginary joint adds a column to the closure matrix of the upper section. `|S|` of them
    /// increase its mobility by `|S|` exactly if they do not increase its rank, that is, if each of
    /// these columns depends on the section's own columns. So the legs that may be in `S` are found
    /// one by one, without trying subsets.
    ///
    /// The set must also give the section all motions within itself that all candidates together
    /// give (at most as many as the mechanism has). Only then can the imaginary joints that are not
    /// in `S` be taken as constant.
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
        // Equal rates in all candidates move the section as a whole, but nothing within it.
        let common = usize::from(!candidates.is_empty());
        let complete = mobility >= n.min(all.saturating_sub(common));
        let qualifies = complete && (mobility..=mobility + dim_a).contains(&n);
        if qualifies {
            Choice { legs: free, mobility, without }
        } else {
            Choice { legs: candidates, mobility: all, without }
        }
    }

    /// Whether the leg's upper part cannot make the intersection motion with its own joints.
    fn candidate(&self, leg: usize) -> bool {
        let own = self.legs[leg];
        let Some(intersection) = self.intersection else { return false };
        let with: Vec<_> = own.iter().copied().chain([intersection[leg]]).collect();
        Basis::span(&with).dimension() == own.len() + 1
    }

    /// Whether the column of a leg's imaginary joint is in the span of the closure's own columns.
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
        let Some(intersection) = self.intersection else { return };
        for (i, b) in self.basis.vectors().iter().enumerate() {
            column[leg * self.basis.dimension() + i] = b.dot(&intersection[leg]);
        }
    }

    fn mobility(&self, imaginary: &[usize]) -> usize {
        let closure = self.closure(imaginary);
        closure.ncols() - svd::rank(closure, TOLERANCE)
    }

    /// The closure matrix of the section within its group. It has `dim B` rows per leg, one column
    /// per screw, one per imaginary joint, and `dim B` columns for the platform.
    fn closure(&self, imaginary: &[usize]) -> DMatrix<f64> {
        let rows = self.basis.dimension();
        let mut columns = vec![];
        for (k, leg) in self.legs.iter().enumerate() {
            for screw in *leg {
                columns.push((k, *screw));
            }
        }
        columns.extend(imaginary.iter().filter_map(|&k| Some((k, self.intersection?[k]))));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::decomposition::samples::Numbers;
    use crate::group::screw::Screw;
    use crate::group::subspace::SubspaceClass;
    use nalgebra::{Point3, Vector3};
    use proptest::prelude::*;

    proptest! {
        /// The choice, made leg by leg, is as large as the largest of all subsets that satisfy the
        /// conditions: in a planar section with the intersection motion along x, and in a spherical
        /// one with the intersection motion about z.
        #[test]
        fn no_subset_is_larger(
            spherical: bool,
            freedoms in prop::collection::vec(0..4_usize, 2..6),
            coaxial in prop::collection::vec(any::<bool>(), 6),
            n in 0..7_usize,
            dim_a in 1..5_usize,
            seed: u64,
        ) {
            let mut numbers = Numbers::new(seed);
            let (class, intersection) = if spherical {
                let centre = Point3::origin();
                (SubspaceClass::Spherical { centre }, Screw::rotation(Vector3::z_axis(), centre))
            } else {
                let normal = Vector3::z_axis();
                (SubspaceClass::Planar { normal }, Screw::translation(Vector3::x_axis()))
            };
            let basis: Vec<_> = class.screws().iter().map(|s| s.to_vector()).collect();
            let shared: Vector6<f64> = basis.iter().map(|b| b * numbers.next()).sum();
            // Some legs begin with a common screw, so that some sections move on their own.
            let legs: Vec<Vec<Vector6<f64>>> = freedoms
                .iter()
                .zip(&coaxial)
                .map(|(&count, &coaxial)| {
                    let any = |_| basis.iter().map(|b| b * numbers.next()).sum::<Vector6<f64>>();
                    let mut leg: Vec<_> = (0..count).map(any).collect();
                    if let (Some(first), true) = (leg.first_mut(), coaxial) {
                        *first = shared;
                    }
                    leg.iter().map(Vector6::normalize).collect()
                })
                .collect();
            let parts: Vec<&[Vector6<f64>]> = legs.iter().map(Vec::as_slice).collect();
            let basis = Basis::span(&basis);
            let intersections = vec![intersection.to_vector(); legs.len()];
            let section =
                UpperSection { basis: &basis, legs: &parts, intersection: Some(&intersections) };
            let order: Vec<usize> = (0..legs.len()).collect();
            let choice = section.imaginary_joints(n, dim_a, &order);

            let f0 = section.mobility(&[]);
            let candidates: Vec<usize> = (0..legs.len()).filter(|&i| section.candidate(i)).collect();
            let subsets: Vec<Vec<usize>> = (0..1_usize << candidates.len())
                .map(|bits| {
                    let chosen = candidates.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1);
                    chosen.map(|(_, &leg)| leg).collect()
                })
                .collect();
            // A random section may be nearly singular; its ranks then depend on the tolerance.
            let clear = |s: &Vec<usize>| {
                Svd::new(section.closure(s)).values.iter().all(|v| *v < 1e-12 || *v > 1e-3)
            };
            prop_assume!(subsets.iter().all(clear));
            prop_assert_eq!(choice.without, f0);
            prop_assert_eq!(choice.mobility, section.mobility(&choice.legs));
            let largest = subsets
                .iter()
                .filter(|s| {
                    let f = section.mobility(s);
                    f == f0 + s.len() && f <= n && n <= f + dim_a
                })
                .map(Vec::len)
                .max();
            if choice.legs != candidates {
                prop_assert_eq!(Some(choice.legs.len()), largest);
            } else if let Some(largest) = largest {
                // Every candidate is chosen: that many, or more because fewer would miss motions.
                let all = section.mobility(&candidates);
                let misses = f0 + largest < n.min(all.saturating_sub(1));
                prop_assert!(largest == candidates.len() || misses);
            }
        }
    }
}
