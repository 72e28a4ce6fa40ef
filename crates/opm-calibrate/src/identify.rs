//! What data can tell: the space of parameters that they determine, and what they leave open.

use crate::parameter::Parameter;
use nalgebra::{DMatrix, DVector};
use opm_core::Quantity;
use opm_core::velocity::SINGULAR;

/// A combination of parameters that the data do not tell: it keeps its value of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Combination {
    /// The names of the parameters and by how much each changes, metres and radians; the first by one unit. Changes of all in
    /// these proportions leave what was measured as it is, or nearly so.
    pub terms: Vec<(String, f64)>,
}

/// The determined and the open directions of the parameters, in units of one radian and of the characteristic length.
pub struct Identified {
    /// Singular values of the weighted derivatives, the largest first: one over the standard error of a direction.
    pub singular_values: Vec<f64>,
    /// An orthonormal basis of the determined directions.
    pub determined: DMatrix<f64>,
    /// One of the open directions.
    pub open: DMatrix<f64>,
}

/// A component of an open direction below this is rounding, in the derivatives of a family's parameters the most: these are
/// differences.
const COMPONENT: f64 = 1e-4;

impl Identified {
    /// Decomposes derivatives, a column for each parameter. A direction is open if its singular value is below `SINGULAR` times
    /// the largest, or below `least`.
    pub fn new(derivatives: &DMatrix<f64>, least: f64) -> Self {
        let n = derivatives.ncols();
        // The eigenvectors of a square matrix are all there, also where there are fewer rows than columns.
        let rows = derivatives.nrows().max(n);
        let mut padded = DMatrix::zeros(rows, n);
        padded.rows_mut(0, derivatives.nrows()).copy_from(derivatives);
        let svd = padded.svd(false, true);
        let right = svd.v_t.expect("they were asked for").transpose();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| svd.singular_values[b].total_cmp(&svd.singular_values[a]));
        let singular_values: Vec<f64> = order.iter().map(|&k| svd.singular_values[k]).collect();
        let largest = singular_values.first().copied().unwrap_or(0.0);
        let zero = (SINGULAR * largest).max(least);
        let (some, none): (Vec<usize>, Vec<usize>) =
            order.iter().copied().partition(|&k| svd.singular_values[k] > zero);
        let determined = right.select_columns(&some);
        let open = right.select_columns(&none);
        Self { singular_values, determined, open }
    }

    /// The number of determined directions.
    pub fn rank(&self) -> usize {
        self.determined.ncols()
    }

    /// Whether the data determine a parameter.
    pub fn identifiable(&self, parameter: usize) -> bool {
        self.open.row(parameter).norm() < COMPONENT
    }

    /// The open directions, each with as few parameters as elimination leaves.
    pub fn combinations(&self, parameters: &[Parameter], length: f64) -> Vec<Combination> {
        let mut rows = self.open.transpose();
        let mut leading = Vec::new();
        for row in 0..rows.nrows() {
            // The largest entry of what is left leads.
            let place = (row..rows.nrows())
                .flat_map(|i| (0..rows.ncols()).map(move |j| (i, j)))
                .filter(|(_, j)| !leading.contains(j))
                .max_by(|&a, &b| rows[a].abs().total_cmp(&rows[b].abs()));
            let Some((from, column)) = place else { break };
            rows.swap_rows(row, from);
            let pivot = rows[(row, column)];
            rows.row_mut(row).unscale_mut(pivot);
            for other in (0..rows.nrows()).filter(|&other| other != row) {
                let factor = rows[(other, column)];
                let own = rows.row(row) * factor;
                let mut changed = rows.row_mut(other);
                changed -= own;
            }
            leading.push(column);
        }
        let unit = |k: usize| match parameters[k].quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => length,
        };
        let named = leading.iter().enumerate().map(|(row, &first)| {
            let size = rows.row(row).amax();
            let others = (0..rows.ncols()).filter(|&k| k != first);
            let terms = std::iter::once(first).chain(others).filter_map(|k| {
                let part = rows[(row, k)];
                let of = part * unit(k) / unit(first);
                (part.abs() > COMPONENT * size).then(|| (parameters[k].name.clone(), of))
            });
            Combination { terms: terms.collect() }
        });
        named.collect()
    }
}

/// An orthonormal basis of the range of a matrix whose columns have comparable units.
pub fn range(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    if matrix.is_empty() {
        return DMatrix::zeros(matrix.nrows(), 0);
    }
    let svd = matrix.clone().svd(true, false);
    let zero = SINGULAR * svd.singular_values.max();
    let some: Vec<usize> =
        (0..svd.singular_values.len()).filter(|&k| svd.singular_values[k] > zero).collect();
    svd.u.expect("it was asked for").select_columns(&some)
}

/// What is left of columns without their parts in the range of an orthonormal basis.
pub fn without(basis: &DMatrix<f64>, columns: &DMatrix<f64>) -> DMatrix<f64> {
    columns - basis * basis.tr_mul(columns)
}

/// The same of one vector.
pub fn vector_without(basis: &DMatrix<f64>, vector: &DVector<f64>) -> DVector<f64> {
    vector - basis * basis.tr_mul(vector)
}
