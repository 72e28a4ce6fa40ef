//! How far a pose is from a singularity: condition number and manipulability.

use super::{Jacobians, SingularCause, SingularLeg};
use crate::manipulator::Manipulator;
use crate::numeric::Quantity;
use crate::numeric::svd::{Products, jacobi};
use nalgebra::SMatrix;

/// A singular value below this share of the largest counts as zero: the rounding of the few dozen operations
/// that lead to it.
const RANK: f64 = 1e-13;

/// Two columns are orthogonal if the cosine of their angle is at most this. The rest does not change any
/// digit of a singular value.
const ORTHOGONAL: f64 = 1e-12;

/// A matrix with room for so many freedoms; the first rows and columns are used.
type Square<const N: usize> = SMatrix<f64, N, N>;

/// The conditioning of the actuated joints' Jacobian by the platform's twist.
///
/// The velocity of the platform's reference point and the rates of sliders are divided by the
/// characteristic length. So both numbers have no unit. They do not depend on the coordinates that the
/// pose is written in, on where the mechanism stands, nor on how large it is.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (mut buffer, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
/// // Home, where the Euler angles are singular: the conditioning does not depend on them.
/// let pose = manipulator.pose([])?;
/// let at = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)?;
/// manipulator.differentiate(at.expect("home is in reach"), &mut jacobians)?;
/// let length = manipulator.characteristic_length();
/// let conditioning = manipulator.conditioning(&jacobians, length);
/// assert!(conditioning.condition >= 1.0 && conditioning.condition.is_finite());
/// assert!(conditioning.manipulability > 0.0 && conditioning.manipulability.is_finite());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditioning {
    /// The largest over the smallest singular value, which is at least one: how unevenly joint rates move
    /// the platform. It is infinite at a serial or parallel singularity, and if fewer joints are actuated
    /// than the platform has degrees of freedom. If there are more, all of them count.
    pub condition: f64,
    /// The inverse of the product of the singular values: the volume of the platform's twists for unit
    /// rates of the actuated joints (Yoshikawa's measure). Zero at a serial singularity, infinite at a
    /// parallel one.
    pub manipulability: f64,
}

impl Conditioning {
    /// The conditioning at a serial singularity.
    const SERIAL: Self = Self { condition: f64::INFINITY, manipulability: 0.0 };
    /// The conditioning at a parallel singularity.
    const PARALLEL: Self = Self { condition: f64::INFINITY, manipulability: f64::INFINITY };
}

impl Manipulator {
    /// How well conditioned the actuated joints' Jacobian is at the pose of `jacobians`. The
    /// characteristic `length`, metres, is usually [`Manipulator::characteristic_length`]. Nothing is
    /// allocated.
    ///
    /// # Panics
    /// If the length is not a positive number.
    pub fn conditioning(&self, jacobians: &Jacobians, length: f64) -> Conditioning {
        assert!(
            length > 0.0 && length.is_finite(),
            "the characteristic length is {length} m, expected a positive number"
        );
        // The rotation vector of a spherical joint is singular after a full revolution. That does not matter
        // to the platform unless the joint is actuated.
        let serial = |singular: &SingularLeg| {
            singular.cause == SingularCause::Serial
                || self.rateless(singular).any(|c| self.actuated().contains(&c))
        };
        if jacobians.singular.iter().any(serial) {
            return Conditioning::SERIAL;
        }
        // Platforms have five freedoms at most, but for those with a Schoenflies section, and room costs time.
        match jacobians.platform.ncols() {
            0..=5 => self.conditioning_in::<5>(jacobians, length),
            _ => self.conditioning_in::<6>(jacobians, length),
        }
    }

    /// The same in matrices with room for `N` freedoms, away from serial singularities.
    fn conditioning_in<const N: usize>(&self, jacobians: &Jacobians, length: f64) -> Conditioning {
        let n = jacobians.platform.ncols();
        // With the metric `L Lᵀ` of the platform's twist, components multiplied by `Lᵀ` are orthonormal.
        let scale = length.recip();
        let mut joints = Square::<N>::zeros();
        let actuated = self.actuated();
        let matrix = jacobians.joints.as_slice();
        let stride = jacobians.joints.nrows();
        for (row, &coordinate) in actuated.iter().enumerate() {
            let unit = match self.coordinates()[coordinate].quantity {
                Quantity::Angle => 1.0,
                Quantity::Length => scale,
            };
            let mut next = [0.0; N];
            for (column, value) in next[..n].iter_mut().enumerate() {
                *value = unit * matrix[coordinate + column * stride];
            }
            if row < N {
                (0..n).for_each(|column| joints[(row, column)] = next[column]);
            } else {
                // There are more rows than fit. Their triangular factor has the same singular values.
                if row == N {
                    joints = triangle(&joints, n);
                }
                push_row(&mut joints, next, n);
            }
        }
        let metric = metric::<N>(jacobians, scale);
        divide(&mut joints, &metric, n);
        let free = n - jacobians.locked.nrows();
        if free < n {
            project(&mut joints, jacobians, &metric, n);
        }
        let mut values = singular_values(joints, n);
        // The twists that constraining legs prevent have the value zero.
        values[..n].sort_by(|a, b| b.total_cmp(a));
        let (mut largest, mut smallest, mut product) = (0.0_f64, f64::INFINITY, 1.0);
        for &value in &values[..free] {
            largest = largest.max(value);
            smallest = smallest.min(value);
            product *= value;
        }
        // The pose is so far away that squares overflow.
        if !product.is_finite() || !largest.is_finite() {
            return Conditioning::SERIAL;
        }
        if smallest <= RANK * largest {
            return Conditioning::PARALLEL;
        }
        Conditioning { condition: largest / smallest, manipulability: 1.0 / product }
    }
}

/// Removes the twists of the platform that its constraining legs prevent from a matrix whose columns are
/// orthonormal components of the twist.
fn project<const N: usize>(
    matrix: &mut Square<N>,
    jacobians: &Jacobians,
    metric: &Square<N>,
    n: usize,
) {
    let mut rows = Square::<N>::zeros();
    let count = jacobians.locked.nrows();
    for i in 0..count {
        (0..n).for_each(|j| rows[(i, j)] = jacobians.locked[(i, j)]);
    }
    divide(&mut rows, metric, n);
    for i in 0..count {
        let mut row = rows.row(i).into_owned();
        for known in 0..i {
            let known = rows.row(known);
            row -= known * row.dot(&known);
        }
        let length = row.norm();
        if length > 0.0 {
            row /= length;
        }
        rows.set_row(i, &row);
        for j in 0..N {
            let along = matrix.row(j).dot(&row);
            let rest = matrix.row(j) - row * along;
            matrix.set_row(j, &rest);
        }
    }
}

/// The triangular factor `Lᵀ` of the metric of the platform's twist, by Cholesky's method. The columns are
/// far from dependent, so that squaring them loses few digits.
fn metric<const N: usize>(jacobians: &Jacobians, scale: f64) -> Square<N> {
    let n = jacobians.platform.ncols();
    let square = scale * scale;
    let mut r = Square::<N>::zeros();
    for i in 0..n {
        for j in i..n {
            let (a, b) = (jacobians.platform.column(i), jacobians.platform.column(j));
            let angular = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let linear = a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
            r[(i, j)] = angular + square * linear;
        }
    }
    for i in 0..n {
        for k in 0..i {
            for j in i..n {
                r[(i, j)] -= r[(k, i)] * r[(k, j)];
            }
        }
        let root = r[(i, i)].sqrt();
        for j in i..n {
            r[(i, j)] /= root;
        }
    }
    r
}

/// The triangular factor `R` of a matrix `Q R`.
fn triangle<const N: usize>(matrix: &Square<N>, n: usize) -> Square<N> {
    let mut r = Square::<N>::zeros();
    for row in matrix.row_iter() {
        push_row(&mut r, std::array::from_fn(|i| row[i]), n);
    }
    r
}

/// Adds a row to a triangular factor, by Givens rotations.
fn push_row<const N: usize>(r: &mut Square<N>, mut next: [f64; N], n: usize) {
    for i in 0..n {
        if next[i] == 0.0 {
            continue;
        }
        let length = r[(i, i)].hypot(next[i]);
        let (cos, sin) = (r[(i, i)] / length, next[i] / length);
        for (j, below) in next.iter_mut().enumerate().take(n).skip(i) {
            let above = r[(i, j)];
            r[(i, j)] = cos * above + sin * *below;
            *below = cos * *below - sin * above;
        }
    }
}

/// Computes `matrix · R⁻¹` in place, column by column.
fn divide<const N: usize>(matrix: &mut Square<N>, r: &Square<N>, n: usize) {
    for j in 0..n {
        for k in 0..j {
            let factor = r[(k, j)];
            for i in 0..N {
                matrix[(i, j)] -= matrix[(i, k)] * factor;
            }
        }
        let inverse = r[(j, j)].recip();
        for i in 0..N {
            matrix[(i, j)] *= inverse;
        }
    }
}

/// The singular values of the first `n` columns, by the rotations of [`crate::numeric::svd`]. Entries are
/// near one, so that squares do not overflow.
fn singular_values<const N: usize>(mut m: Square<N>, n: usize) -> [f64; N] {
    let orthogonal = |p: &Products| p.pq * p.pq <= ORTHOGONAL * ORTHOGONAL * p.pp * p.qq;
    let secant = |tan: f64| (1.0 + tan * tan).sqrt();
    jacobi(m.as_mut_slice(), [N, n], orthogonal, secant, |_, _, _| {});
    std::array::from_fn(|i| m.column(i).norm())
}
