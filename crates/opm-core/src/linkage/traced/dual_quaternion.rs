//! Complex dual quaternions: displacements, joints and their products as polynomials (Study 1891; Husty, Pfurner and Schröcker,
//! "A new and efficient algorithm for the inverse kinematics of a general serial 6R manipulator", Mech. Mach. Theory 42, 2007).

use nalgebra::{Complex, Vector3};
use std::ops::{Add, Mul};

pub type C = Complex<f64>;
pub type V = Vector3<C>;

/// `real + ε dual`, each with its scalar first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualQuaternion {
    pub real: [C; 4],
    pub dual: [C; 4],
}

fn product(a: &[C; 4], b: &[C; 4]) -> [C; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

fn conjugate(a: &[C; 4]) -> [C; 4] {
    [a[0], -a[1], -a[2], -a[3]]
}

impl DualQuaternion {
    pub const ONE: Self = Self { real: [C::ONE, C::ZERO, C::ZERO, C::ZERO], dual: [C::ZERO; 4] };

    /// Two vectors, without scalars: a line by its direction and moment.
    pub fn vectors(direction: &V, moment: &V) -> Self {
        let pure = |v: &V| [C::ZERO, v.x, v.y, v.z];
        Self { real: pure(direction), dual: pure(moment) }
    }

    /// The displacement by a quaternion, then by a translation: `q + ½ ε t q`.
    pub fn displacement(q: [C; 4], translation: &V) -> Self {
        let t = translation * C::new(0.5, 0.0);
        Self { real: q, dual: product(&[C::ZERO, t.x, t.y, t.z], &q) }
    }

    /// The quaternion and translation of a displacement.
    pub fn parts(&self) -> ([C; 4], V) {
        let square: C = self.real.iter().map(|c| c * c).sum();
        let t = product(&self.dual, &conjugate(&self.real)).map(|c| c * 2.0 / square);
        (self.real, V::new(t[1], t[2], t[3]))
    }

    /// The inverse of a displacement, up to a factor.
    pub fn reversed(&self) -> Self {
        Self { real: conjugate(&self.real), dual: conjugate(&self.dual) }
    }

    /// What has to vanish where the displacement is the identity. (Its dual scalar then vanishes, too.)
    pub fn open(&self) -> [C; 6] {
        let ([_, a, b, c], [_, d, e, f]) = (self.real, self.dual);
        [a, b, c, d, e, f]
    }
}

impl Mul for DualQuaternion {
    type Output = Self;

    fn mul(self, b: Self) -> Self {
        let (one, two) = (product(&self.real, &b.dual), product(&self.dual, &b.real));
        Self { real: product(&self.real, &b.real), dual: std::array::from_fn(|i| one[i] + two[i]) }
    }
}

impl Mul<C> for DualQuaternion {
    type Output = Self;

    fn mul(self, factor: C) -> Self {
        Self { real: self.real.map(|c| c * factor), dual: self.dual.map(|c| c * factor) }
    }
}

impl Add for DualQuaternion {
    type Output = Self;

    fn add(self, b: Self) -> Self {
        let sum = |a: [C; 4], b: [C; 4]| std::array::from_fn(|i| a[i] + b[i]);
        Self { real: sum(self.real, b.real), dual: sum(self.dual, b.dual) }
    }
}
