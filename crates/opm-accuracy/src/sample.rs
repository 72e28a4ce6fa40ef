//! Monte Carlo: errors drawn at random.

use crate::response::Response;
use nalgebra::{DMatrix, Matrix6xX};

/// What random errors do, each uniform between minus and plus its size and independent of all others.
#[derive(Clone, Debug, PartialEq)]
pub struct Samples {
    /// How many times all errors were drawn.
    pub count: u32,
    /// The standard deviation of each task coordinate, radians and metres; NaN where it is not determined.
    pub deviations: Vec<f64>,
    /// What 95 % of the displacements of the platform's reference point do not exceed, metres.
    pub length: f64,
    /// What 95 % of the platform's rotations do not exceed, radians.
    pub angle: f64,
    /// The same for the play of each joint, leg by leg: a length, metres, and an angle, radians.
    pub misfit: Vec<[f64; 2]>,
}

/// The share of samples that is within the reported lengths and angles.
const SHARE: f64 = 0.95;

/// Draws errors from generator number `seed`. The same seed gives the same samples.
///
/// # Panics
/// If there is not one error for each source, or the count is zero.
pub fn sample(response: &Response, errors: &[f64], count: u32, seed: u64) -> Samples {
    assert_eq!(response.twists.ncols(), errors.len(), "one error for each source");
    assert!(count > 0, "the number of samples is 0, expected at least 1");
    let mut rng = fastrand::Rng::with_seed(seed);
    // One matrix for everything: rows are components, columns sources.
    let rows = response.coordinates.nrows();
    let mut all: Vec<&Matrix6xX<f64>> = vec![&response.twists];
    all.extend(&response.plays);
    let mut by_error = DMatrix::zeros(rows + 6 * all.len(), errors.len());
    by_error.rows_mut(0, rows).copy_from(&response.coordinates);
    for (number, twists) in all.iter().enumerate() {
        by_error.rows_mut(rows + 6 * number, 6).copy_from(twists);
    }
    let mut squares = vec![0.0; rows];
    let mut sizes = vec![Vec::with_capacity(count as usize); 2 * all.len()];
    let mut drawn = nalgebra::DVector::zeros(errors.len());
    for _ in 0..count {
        for (drawn, size) in drawn.iter_mut().zip(errors) {
            *drawn = size * (2.0 * rng.f64() - 1.0);
        }
        let moved = &by_error * &drawn;
        for (square, value) in squares.iter_mut().zip(moved.iter()) {
            *square += value * value;
        }
        for (number, sizes) in sizes.iter_mut().enumerate() {
            sizes.push(moved.rows(rows + 3 * number, 3).norm());
        }
    }
    let within: Vec<f64> = sizes.into_iter().map(quantile).collect();
    let root = |square: f64| (square / f64::from(count)).sqrt();
    Samples {
        count,
        deviations: squares.into_iter().map(root).collect(),
        angle: within[0],
        length: within[1],
        misfit: within[2..].chunks(2).map(|pair| [pair[1], pair[0]]).collect(),
    }
}

/// What the share of the values does not exceed.
fn quantile(mut values: Vec<f64>) -> f64 {
    let place = (SHARE * values.len() as f64).ceil() as usize;
    values.sort_by(f64::total_cmp);
    values[place.clamp(1, values.len()) - 1]
}
