//! Rotation matrices from the user: the rotation that is nearest to a rounded matrix.
//!
//! nalgebra's `Rotation3::from_matrix` is an iteration that stalls at rotations by π. Here the matrix must be
//! a rotation to about six digits. Then two steps of Newton and Schulz' iteration for the polar decomposition,
//! `X ← X (3 − XᵀX) / 2`, give the nearest rotation to full precision: each step squares the error (N. J. Higham,
//! "Functions of Matrices", SIAM 2008, section 8.3). The angle of the rotation does not matter.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

/// The largest entry of `RRᵀ − 1` that a rotation matrix may have: the error of one printed with six digits.
pub const WRITTEN: f64 = 1e-5;

/// Why a matrix is not a rotation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotRotation {
    /// An entry is infinite or not a number.
    #[error("row {row}, column {column} is {value:?}, expected a finite number")]
    NotFinite {
        /// The row of the entry, counted from zero.
        row: usize,
        /// The column of the entry, counted from zero.
        column: usize,
        /// The entry.
        value: f64,
    },
    /// The columns do not have unit length, or are not perpendicular.
    #[error(
        "not a rotation: R Rᵀ differs from the identity by {off:.3e}, expected at most {WRITTEN:e}"
    )]
    NotOrthogonal {
        /// The largest entry of `RRᵀ − 1`.
        off: f64,
    },
    /// The columns are a left-handed frame.
    #[error("a reflection, not a rotation: the determinant is {determinant:.6}, expected 1")]
    Reflection {
        /// The determinant of the matrix, which is about −1.
        determinant: f64,
    },
}

/// The rotation that is nearest to a matrix, which must be a rotation up to rounding.
///
/// ```
/// # extern crate opm_geometry as opm_core;
/// use nalgebra::Matrix3;
/// use opm_core::numeric::rotation::nearest;
///
/// let half_revolution = nearest(&Matrix3::from_diagonal(&[-1.0, 1.0, -1.0].into()))?;
/// assert_eq!(half_revolution.coords.as_slice(), [0.0, 1.0, 0.0, 0.0]); // x y z, then the scalar
/// # Ok::<(), opm_core::numeric::rotation::NotRotation>(())
/// ```
///
/// # Errors
/// If the matrix differs from a rotation by more than [`WRITTEN`], is a reflection, or has an entry that is
/// infinite or not a number.
pub fn nearest(matrix: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, NotRotation> {
    for row in 0..3 {
        for column in 0..3 {
            let value = matrix[(row, column)];
            if !value.is_finite() {
                return Err(NotRotation::NotFinite { row, column, value });
            }
        }
    }
    let off = (matrix * matrix.transpose() - Matrix3::identity()).abs();
    // Entries near the largest number overflow to NaN, which `f64::max` would ignore.
    let off = off.iter().fold(0.0, |most: f64, &o| if o <= most { most } else { o });
    if off.is_nan() || off > WRITTEN {
        let off = if off.is_nan() { f64::INFINITY } else { off };
        return Err(NotRotation::NotOrthogonal { off });
    }
    let determinant = matrix.determinant();
    if determinant < 0.0 {
        return Err(NotRotation::Reflection { determinant });
    }
    let polar = nearer(&nearer(matrix));
    // The conversion starts from the largest component of the quaternion, which is never near zero.
    let quaternion = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(polar));
    Ok(UnitQuaternion::new_normalize(quaternion.into_inner()))
}

/// One step towards the polar factor, which reduces an error of `e` to about `e²`.
fn nearer(x: &Matrix3<f64>) -> Matrix3<f64> {
    let error = x.tr_mul(x) - Matrix3::identity();
    x - x * error * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Quaternion, Vector3};

    /// Rounding of a few dozen operations on numbers up to one.
    const ROUNDING: f64 = 2e-15;

    /// The matrix of a unit quaternion, by the textbook formula.
    fn matrix([w, x, y, z]: [f64; 4]) -> Matrix3<f64> {
        Matrix3::new(
            1.0 - 2.0 * (y * y + z * z),
            2.0 * (x * y - w * z),
            2.0 * (x * z + w * y),
            2.0 * (x * y + w * z),
            1.0 - 2.0 * (x * x + z * z),
            2.0 * (y * z - w * x),
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        )
    }

    fn check(given: &Matrix3<f64>, expected: [f64; 4], tolerance: f64) {
        let found = nearest(given).unwrap();
        let q = Quaternion::new(expected[0], expected[1], expected[2], expected[3]);
        // A quaternion and its opposite are one rotation.
        let apart = (found.into_inner() - q).norm().min((found.into_inner() + q).norm());
        assert!(apart < tolerance, "{given}{found} {expected:?}: {apart:e}");
    }

    /// Every quaternion with components from a set of special numbers, normalised: rotations by π, π/2 and,
    /// about diagonals, 2π/3; rotations close to 0, to π and to 2π; axes close to the coordinate axes. These
    /// are some three million matrices, exact and with errors.
    #[test]
    fn structured_rotations_come_back() {
        let parts: Vec<f64> = [0.0, 1.0, 1e-300, 1e-17, 1e-16, 1e-12, 1e-8, 1e-4, 0.5, 0.6, 0.8]
            .into_iter()
            .chain([0.5_f64.sqrt(), 3.0_f64.sqrt(), 2.0])
            .flat_map(|part| [part, -part])
            .collect();
        let mut rng = 1_u64;
        let mut error = |size: f64| {
            rng =
                rng.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            size * ((rng >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
        };
        let mut count = 0;
        for &w in &parts {
            for &x in &parts {
                for &y in &parts {
                    for &z in &parts {
                        let length = (w * w + x * x + y * y + z * z).sqrt();
                        if length < 1e-290 {
                            continue;
                        }
                        let q = [w, x, y, z].map(|part| part / length);
                        let exact = matrix(q);
                        check(&exact, q, ROUNDING);
                        check(&(exact + Matrix3::from_fn(|_, _| error(1e-7))), q, 3e-7);
                        count += 2;
                    }
                }
            }
        }
        assert!(count > 1_200_000, "{count}");
    }

    /// The polar factor of `R (1 + S)`, with `S` symmetric and small, is `R`.
    #[test]
    fn the_stretch_of_a_matrix_is_removed() {
        let half = 0.5_f64.sqrt();
        for q in [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, half, half, 0.0],
            [half, 0.0, 0.0, -half],
            [0.5, 0.5, -0.5, 0.5],
            [0.0, 0.6, 0.0, -0.8],
        ] {
            for s in [
                Matrix3::identity() * 4e-6,
                Matrix3::from_diagonal(&Vector3::new(-4e-6, 0.0, 3e-6)),
                Matrix3::new(0.0, 3e-6, 0.0, 3e-6, 0.0, -3e-6, 0.0, -3e-6, 1e-6),
            ] {
                check(&(matrix(q) * (Matrix3::identity() + s)), q, ROUNDING);
            }
        }
    }

    #[test]
    fn signed_permutations_are_exact() {
        let mut rotations = 0;
        for order in [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]] {
            for signs in 0..8 {
                let sign = |row: usize| if signs & (1 << row) == 0 { 1.0 } else { -1.0 };
                let given = Matrix3::from_fn(|i, j| if order[i] == j { sign(i) } else { 0.0 });
                let even = order[1] == (order[0] + 1) % 3;
                if even == (sign(0) * sign(1) * sign(2) > 0.0) {
                    let found = nearest(&given).unwrap().to_rotation_matrix().into_inner();
                    assert!((found - given).amax() < 3e-16, "{given}{found}");
                    rotations += 1;
                } else {
                    let reflection = NotRotation::Reflection { determinant: -1.0 };
                    assert_eq!(nearest(&given), Err(reflection));
                }
            }
        }
        assert_eq!(rotations, 24);
    }

    #[test]
    fn a_matrix_that_is_not_a_rotation_is_reported() {
        let message = |matrix: Matrix3<f64>| nearest(&matrix).unwrap_err().to_string();
        assert_eq!(
            message(Matrix3::identity() * 1.001),
            "not a rotation: R Rᵀ differs from the identity by 2.001e-3, expected at most 1e-5"
        );
        assert_eq!(
            message(Matrix3::zeros()),
            "not a rotation: R Rᵀ differs from the identity by 1.000e0, expected at most 1e-5"
        );
        assert_eq!(
            message(-Matrix3::identity()),
            "a reflection, not a rotation: the determinant is -1.000000, expected 1"
        );
        let mut given = Matrix3::identity();
        given[(1, 2)] = f64::NAN;
        assert_eq!(message(given), "row 1, column 2 is NaN, expected a finite number");
        given[(1, 2)] = f64::MAX;
        given[(1, 1)] = -f64::MAX;
        assert!(message(given).contains("from the identity by inf"), "{}", message(given));
        given[(1, 2)] = f64::INFINITY;
        assert_eq!(message(given), "row 1, column 2 is inf, expected a finite number");
    }
}
