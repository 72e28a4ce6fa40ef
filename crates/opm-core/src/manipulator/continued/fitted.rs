//! Equations that samples have in common, those of the lowest degree in the joints first.
//!
//! An equation is a sum of terms times what the joints give: `1, cos q, sin q` of a rotation, `1, q, q²` of a slider, and products of
//! these for several joints. `(x - q) q = 0` holds wherever `x - q = 0` does, and says less: multiples of an equation are left out.

use crate::numeric::Quantity;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, DVector};
use std::iter::Product;

/// An equation holds, or follows from others, to within this, relative to its scale.
pub const HOLDS: f64 = 1e-9;
/// Samples beyond the number of coefficients.
pub const SPARE: usize = 24;

/// The terms at a sample, and what each joint gives there.
pub struct FitSample {
    pub values: Vec<f64>,
    pub factors: Vec<[f64; 3]>,
}

/// An equation.
pub struct Equation {
    /// Its degree in the joints.
    pub degree: usize,
    /// The factors of all terms, for one product of what the joints give after the other.
    pub coefficients: DVector<f64>,
}

/// The product with this number of what joints give: its digits to the base of three say what of each.
pub fn product_of<T: Copy + Product>(factors: &[[T; 3]], number: usize) -> T {
    factors.iter().zip(digits(number)).map(|(factor, digit)| factor[digit]).product()
}

fn digits(number: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(Some(number), |rest| Some(rest / 3)).map(|rest| rest % 3)
}

/// The degree of a product in the joints.
fn degree(number: usize, joints: &[Quantity]) -> usize {
    let of = |(quantity, digit): (&Quantity, usize)| match quantity {
        Quantity::Angle => digit.min(1),
        Quantity::Length => digit,
    };
    joints.iter().zip(digits(number)).map(of).sum()
}

/// The number of the product of two products, if it is among them.
fn times(one: usize, other: usize, joints: &[Quantity]) -> Option<usize> {
    let mut place = 1;
    joints.iter().zip(digits(one).zip(digits(other))).try_fold(0, |number, (quantity, (a, b))| {
        let there = match quantity {
            Quantity::Angle => a == 0 || b == 0,
            Quantity::Length => a + b < 3,
        };
        let number = number + place * (a + b);
        place *= 3;
        there.then_some(number)
    })
}

/// The equations of all samples, which are more than an equation has coefficients.
pub fn equations(samples: &[FitSample], joints: &[Quantity]) -> Vec<Equation> {
    let (terms, products) = (samples[0].values.len(), 3_usize.pow(joints.len() as u32));
    let most = (0..products).map(|number| degree(number, joints)).max().unwrap_or(0);
    let mut found: Vec<Equation> = Vec::new();
    for highest in 0..=most {
        let used: Vec<usize> = (0..products).filter(|&i| degree(i, joints) <= highest).collect();
        let rows = (used.len() * terms + SPARE).min(samples.len());
        let matrix = DMatrix::from_fn(rows, used.len() * terms, |row, column| {
            let FitSample { values, factors } = &samples[row];
            values[column % terms] * product_of(factors, used[column / terms])
        });
        let kernel = kernel(matrix);
        let mut all = DMatrix::zeros(products * terms, kernel.ncols());
        for (place, number) in used.iter().enumerate() {
            all.rows_mut(number * terms, terms).copy_from(&kernel.rows(place * terms, terms));
        }
        let known: Vec<DVector<f64>> = found
            .iter()
            .flat_map(|equation| used.iter().map(move |&by| (equation, by)))
            .filter(|(equation, by)| equation.degree + degree(*by, joints) <= highest)
            .filter_map(|(equation, by)| multiple(&equation.coefficients, by, terms, joints))
            .collect();
        for coefficients in beside(all, &known) {
            found.push(Equation { degree: highest, coefficients });
        }
    }
    found
}

/// An equation times a product, if that has such coefficients.
fn multiple(
    equation: &DVector<f64>,
    by: usize,
    terms: usize,
    joints: &[Quantity],
) -> Option<DVector<f64>> {
    let mut found = DVector::zeros(equation.len());
    for number in 0..equation.len() / terms {
        let part = equation.rows(number * terms, terms);
        if part.amax() > HOLDS {
            found.rows_mut(times(number, by, joints)? * terms, terms).copy_from(&part);
        }
    }
    Some(found)
}

/// Orthonormal columns that a matrix maps to zero. Rows are more than columns. With its some hundred columns, a triangular factor
/// is much quicker than [`Svd::kernel`].
fn kernel(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let columns = matrix.ncols();
    let qr = matrix.col_piv_qr();
    let r = qr.r();
    let largest = r[(0, 0)].abs();
    let rank = (0..columns).take_while(|&i| r[(i, i)].abs() > HOLDS * largest).count();
    let mut vectors = DMatrix::zeros(columns, columns - rank);
    if rank == columns {
        return vectors;
    }
    let square = r.view((0, 0), (rank, rank));
    let mut rest = -r.view((0, rank), (rank, columns - rank)).into_owned();
    square.solve_upper_triangular_mut(&mut rest);
    vectors.view_mut((0, 0), (rank, columns - rank)).copy_from(&rest);
    vectors.view_mut((rank, 0), (columns - rank, columns - rank)).fill_with_identity();
    qr.p().inv_permute_rows(&mut vectors);
    vectors.qr().q()
}

/// Orthonormal vectors of a kernel beside some of its vectors.
fn beside(kernel: DMatrix<f64>, known: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let mut rest = kernel;
    if !known.is_empty() {
        let svd = Svd::new(DMatrix::from_columns(known));
        for i in 0..svd.rank(HOLDS) {
            let unit = svd.image.column(i).normalize();
            let along = rest.tr_mul(&unit);
            rest -= &unit * along.transpose();
        }
    }
    // Both are of the kernel, so that what is left of a vector of length one is nearly all or nothing.
    let svd = Svd::new(rest);
    let kept = svd.values.iter().take_while(|value| **value > 0.5).count();
    svd.image.columns(0, kept).column_iter().map(|column| column.normalize()).collect()
}
