//! The error of the platform and the misfit of the joints for given errors of all sources.

use crate::response::Response;
use crate::zonotope::farthest;
use nalgebra::{Matrix6xX, Vector3};

/// What errors of given sizes do together, each between minus and plus its size.
#[derive(Clone, Debug, PartialEq)]
pub struct Budget {
    /// The change of each task coordinate; NaN where it is not determined.
    pub coordinates: Vec<Spread>,
    /// The displacement of the platform's reference point, metres.
    pub length: Spread,
    /// The displacement that is the worst case, along the axes of the base, metres.
    pub worst_displacement: Vector3<f64>,
    /// The rotation of the platform, radians.
    pub angle: Spread,
    /// The rotation that is the worst case, as a rotation vector along the axes of the base, radians.
    pub worst_rotation: Vector3<f64>,
    /// The play of each joint, leg by leg.
    pub misfit: Vec<Play>,
}

/// How large a number or the length of a vector becomes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The largest, whatever the errors are within their sizes: for a coordinate the sum of all contributions' absolute
    /// values, for a vector the longest sum of contributions with free signs.
    pub worst: f64,
    /// The root of the sum of the squares of all contributions. If the errors are independent and their sizes are one
    /// standard deviation, it is one standard deviation (of a vector, the root mean square of its length).
    pub root_sum_square: f64,
}

/// The play that a joint needs: the displacement of its point, metres, and a rotation, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Play {
    /// The displacement.
    pub length: Spread,
    /// The rotation.
    pub angle: Spread,
}

impl Budget {
    /// Adds up the errors of all sources, radians and metres.
    ///
    /// # Panics
    /// If there is not one error for each source.
    pub fn new(response: &Response, errors: &[f64]) -> Self {
        assert_eq!(response.twists.ncols(), errors.len(), "one error for each source");
        let coordinate = |i: usize| {
            let parts = response.coordinates.row(i).into_owned();
            let parts = parts.iter().zip(errors).map(|(by, error)| by * error);
            let add =
                |(sum, squares): (f64, f64), part: f64| (sum + part.abs(), squares + part * part);
            let (worst, squares) = parts.fold((0.0, 0.0), add);
            Spread { worst, root_sum_square: squares.sqrt() }
        };
        let (angle, worst_rotation) = vectors(&response.twists, 0, errors);
        let (length, worst_displacement) = vectors(&response.twists, 3, errors);
        let play = |plays: &Matrix6xX<f64>| Play {
            length: vectors(plays, 3, errors).0,
            angle: vectors(plays, 0, errors).0,
        };
        Self {
            coordinates: (0..response.coordinates.nrows()).map(coordinate).collect(),
            length,
            worst_displacement,
            angle,
            worst_rotation,
            misfit: response.plays.iter().map(play).collect(),
        }
    }
}

/// The spread of three rows of twists, and the longest vector.
fn vectors(twists: &Matrix6xX<f64>, row: usize, errors: &[f64]) -> (Spread, Vector3<f64>) {
    let part = |(k, error): (usize, &f64)| twists.fixed_view::<3, 1>(row, k) * *error;
    let parts: Vec<Vector3<f64>> = errors.iter().enumerate().map(part).collect();
    if parts.iter().any(|part| part.iter().any(|number| number.is_nan())) {
        let unknown = Spread { worst: f64::NAN, root_sum_square: f64::NAN };
        return (unknown, Vector3::repeat(f64::NAN));
    }
    let longest = farthest(&parts);
    let squares: f64 = parts.iter().map(Vector3::norm_squared).sum();
    (Spread { worst: longest.norm(), root_sum_square: squares.sqrt() }, longest)
}
