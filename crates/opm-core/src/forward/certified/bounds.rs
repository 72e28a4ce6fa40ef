//! Displacements with bounds: numbers with what they may be wrong by, which every operation rounds outward.

use crate::boxes::Affine;
use nalgebra::{Quaternion, Vector3};

/// A number to within its `rounding`: affine arithmetic without coordinates is that of midpoints and radii.
pub type Bound = Affine<0>;

/// What a number of the file, rounded to binary and perhaps normalised, is wrong by, as a share of it.
const AS_READ: f64 = 1e-15;

/// A number to within `radius`, and its own rounding.
pub fn about(centre: f64, radius: f64) -> Bound {
    Bound { rounding: radius + AS_READ * centre.abs(), ..Bound::constant(centre) }
}

/// Three of them.
pub type Vector = [Bound; 3];

pub fn vector_about(v: &Vector3<f64>, radius: f64) -> Vector {
    [v.x, v.y, v.z].map(|part| about(part, radius))
}

pub fn sum(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i] + b[i])
}

pub fn difference(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i] - b[i])
}

pub fn times(a: &Vector, by: &Bound) -> Vector {
    std::array::from_fn(|i| a[i] * *by)
}

pub fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        Bound::products([[&a[j], &b[k]], [&-a[k], &b[j]]])
    })
}

/// The length.
pub fn length(a: &Vector) -> Bound {
    (a[0].square() + a[1].square() + a[2].square()).sqrt()
}

/// A matrix, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Matrix(pub [[Bound; 3]; 3]);

impl Matrix {
    fn of(part: impl Fn(usize, usize) -> Bound) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| part(i, j))))
    }

    pub fn identity() -> Self {
        Self::of(|i, j| Bound::constant(f64::from(u8::from(i == j))))
    }

    pub fn applied(&self, v: &Vector) -> Vector {
        self.0.map(|[x, y, z]| Bound::products([[&x, &v[0]], [&y, &v[1]], [&z, &v[2]]]))
    }

    pub fn followed(&self, next: &Self) -> Self {
        Self::of(|i, j| {
            let pair = |k: usize| [&self.0[i][k], &next.0[k][j]];
            Bound::products([pair(0), pair(1), pair(2)])
        })
    }

    pub fn trace(&self) -> Bound {
        self.0[0][0] + self.0[1][1] + self.0[2][2]
    }

    /// The vector of the skew part: the sine of a rotation's angle along its axis.
    pub fn sine(&self) -> Vector {
        std::array::from_fn(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            (self.0[k][j] - self.0[j][k]) * 0.5
        })
    }

    /// What takes `ω` to the rate of [`Matrix::sine`] of this matrix while it turns with `ω`: `(tr Q - Q)/2`.
    pub fn sine_rate(&self) -> Self {
        let trace = self.trace();
        Self::of(|i, j| if i == j { (trace - self.0[i][j]) * 0.5 } else { self.0[i][j] * -0.5 })
    }

    /// The rotation by an angle about a unit vector: `cos θ + sin θ [a] + (1 - cos θ) a aᵀ`.
    pub fn turned(axis: &Vector, angle: &Bound) -> Self {
        let unit = angle.unit_vector();
        let rest = -unit.re + 1.0;
        Self::of(|i, j| {
            let square = axis[i] * axis[j] * rest;
            match (3 + j - i) % 3 {
                0 => square + unit.re,
                1 => square - axis[3 - i - j] * unit.im,
                _ => square + axis[3 - i - j] * unit.im,
            }
        })
    }

    /// The rotation of a quaternion that is nearly of length one, to within `radius` in each part, and is scaled to it.
    pub fn of_quaternion(q: &Quaternion<f64>, radius: f64) -> Self {
        let [w, x, y, z] = [q.w, q.i, q.j, q.k].map(|part| about(part, radius));
        let scale = (w.square() + x.square() + y.square() + z.square()).recip() * 2.0;
        let diagonal = |a: &Bound, b: &Bound| -((a.square() + b.square()) * scale) + 1.0;
        let beside = |a: [&Bound; 2], b: [&Bound; 2]| Bound::products([a, b]) * scale;
        let [mx, my, mz] = [-x, -y, -z];
        Self([
            [diagonal(&y, &z), beside([&x, &y], [&w, &mz]), beside([&x, &z], [&w, &y])],
            [beside([&x, &y], [&w, &z]), diagonal(&x, &z), beside([&y, &z], [&w, &mx])],
            [beside([&x, &z], [&w, &my]), beside([&y, &z], [&w, &x]), diagonal(&x, &y)],
        ])
    }
}

/// A displacement; lengths are shares of the size.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub rotation: Matrix,
    pub translation: Vector,
}

impl Place {
    pub fn identity() -> Self {
        Self { rotation: Matrix::identity(), translation: [Bound::constant(0.0); 3] }
    }

    /// A rotation that keeps a point.
    pub fn about(point: &Vector, rotation: Matrix) -> Self {
        let translation = difference(point, &rotation.applied(point));
        Self { rotation, translation }
    }

    pub fn moved(&self, point: &Vector) -> Vector {
        sum(&self.rotation.applied(point), &self.translation)
    }

    pub fn followed(&self, next: &Self) -> Self {
        Self {
            rotation: self.rotation.followed(&next.rotation),
            translation: self.moved(&next.translation),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fastrand::Rng;
    use nalgebra::{Rotation3, Unit, UnitQuaternion};

    fn holds(bound: &Matrix, wanted: &nalgebra::Matrix3<f64>, slack: f64) {
        for i in 0..3 {
            for j in 0..3 {
                let (part, wanted) = (bound.0[i][j], wanted[(i, j)]);
                assert!((part.centre - wanted).abs() <= part.rounding + slack, "{part:?} {wanted}");
            }
        }
    }

    /// Rotations by angles within a bound, and their rates, against nalgebra and differences.
    #[test]
    fn rotations_are_within_their_bounds() {
        let mut rng = Rng::with_seed(70);
        let mut number = || 2.0 * rng.f64() - 1.0;
        for _ in 0..200 {
            let axis = Unit::new_normalize(Vector3::from_fn(|_, _| number()));
            let (angle, radius) = (3.0 * number(), 0.01 * number().abs());
            let bound = Matrix::turned(&vector_about(&axis, 0.0), &about(angle, radius));
            let inside = angle + radius * number();
            let rotation = Rotation3::from_axis_angle(&axis, inside);
            holds(&bound, rotation.matrix(), 1e-15);
            assert!(bound.0.iter().flatten().all(|part| part.rounding < 3.0 * radius + 1e-13));
            let q = UnitQuaternion::from_rotation_matrix(&rotation);
            holds(&Matrix::of_quaternion(&(q.into_inner() * 1.1), 0.0), rotation.matrix(), 1e-15);
            // d/dh of the sine of exp(h [ω]) Q.
            let rate = Vector3::from_fn(|_, _| number());
            let sine = |h: f64| {
                let m = *Rotation3::from_scaled_axis(rate * h).matrix() * rotation.matrix();
                Vector3::new(m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12) * 0.5
            };
            let differences = (sine(1e-6) - sine(-1e-6)) / 2e-6;
            let exact = Matrix::of_quaternion(&q, 0.0);
            let found = exact.sine_rate().applied(&vector_about(&rate, 0.0));
            for i in 0..3 {
                assert!((found[i].centre - differences[i]).abs() < 1e-9);
            }
        }
    }
}
