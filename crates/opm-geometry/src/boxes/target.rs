//! Displacements over a box of poses, and what joints are displaced by.

use super::affine::{Affine, Plane};
use crate::group::{Displacement, PlanarDisplacement};
use nalgebra::{Matrix3, Vector3};

/// A displacement of the plane over a box.
pub type PlanarTarget<const N: usize> = PlanarDisplacement<Plane<N>>;

/// A rotation over a box, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation<const N: usize>(pub [[Affine<N>; 3]; 3]);

impl<const N: usize> Rotation<N> {
    /// The product `R v`.
    pub fn apply(&self, v: &Vector3<f64>) -> [Affine<N>; 3] {
        self.0.map(|row| row[0] * v.x + row[1] * v.y + row[2] * v.z)
    }

    /// The product `Rᵀ v`.
    pub fn apply_back(&self, v: &Vector3<f64>) -> [Affine<N>; 3] {
        let rows = &self.0;
        [0, 1, 2].map(|i| rows[0][i] * v.x + rows[1][i] * v.y + rows[2][i] * v.z)
    }

    /// The product `R M`.
    pub fn after(&self, m: &Matrix3<f64>) -> Self {
        Self(self.0.map(|row| {
            [0, 1, 2].map(|j| row[0] * m[(0, j)] + row[1] * m[(1, j)] + row[2] * m[(2, j)])
        }))
    }
}

/// The product `a · v`.
pub fn dot<const N: usize>(a: &Vector3<f64>, v: &[Affine<N>; 3]) -> Affine<N> {
    v[0] * a.x + v[1] * a.y + v[2] * a.z
}

/// A displacement of a section over a box.
pub type Target<const N: usize> = Displacement<Affine<N>>;

/// A joint's displacement from home over a box: a [`JointDisplacement`](crate::group::JointDisplacement).
#[derive(Clone, Copy, Debug)]
pub enum Enclosed<const N: usize> {
    /// A rotation by the angle of this unit vector.
    UnitDirection(Plane<N>),
    /// A rotation by the angle of this vector, which need not have unit length.
    Direction(Plane<N>),
    /// An angle modulo a revolution.
    Angle(Affine<N>),
    /// A length, or an angle that counts revolutions.
    Value(Affine<N>),
}

impl<const N: usize> Enclosed<N> {
    /// The opposite displacement.
    pub fn inverse(self) -> Self {
        match self {
            Self::UnitDirection(e) => Self::UnitDirection(e.conj()),
            Self::Direction(e) => Self::Direction(e.conj()),
            Self::Angle(angle) => Self::Angle(-angle),
            Self::Value(value) => Self::Value(-value),
        }
    }

    /// The rotation as a unit vector.
    pub fn unit_vector(self) -> Plane<N> {
        match self {
            Self::UnitDirection(e) => e,
            Self::Direction(e) => e.direction(),
            Self::Angle(angle) | Self::Value(angle) => angle.unit_vector(),
        }
    }

    /// The rotation followed by one more, radians.
    pub fn turned(self, by: Affine<N>) -> Self {
        match self {
            Self::UnitDirection(e) => Self::UnitDirection(e * by.unit_vector()),
            Self::Direction(e) => Self::Direction(e * by.unit_vector()),
            Self::Angle(angle) => Self::Angle(angle + by),
            Self::Value(value) => Self::Value(value + by),
        }
    }

    /// The displacement as a number; a rotation up to full revolutions.
    pub fn number(self) -> Affine<N> {
        match self {
            Self::UnitDirection(e) | Self::Direction(e) => e.argument(),
            Self::Angle(number) | Self::Value(number) => number,
        }
    }
}
