//! Displacements in base coordinates, over any numbers.

use super::{CylindricalDisplacement, Displacement, PlanarDisplacement, Subspace};
use crate::numbers::{Plane, Real, Rotation, Space};
use nalgebra::{Matrix3, Vector3};

/// A displacement in base coordinates: a point goes to its image by the rotation, and then by the translation.
#[derive(Clone, Copy, Debug)]
pub struct Placed<T: Real> {
    /// The rotation about the origin; `None` where nothing rotates.
    pub rotation: Option<T::Rotation>,
    /// The translation, metres.
    pub translation: T::Space,
}

/// A vector of the mechanism.
#[inline(always)]
fn constant<T: Real>(v: &Vector3<f64>) -> T::Space {
    T::Space::new(T::constant(v.x), T::constant(v.y), T::constant(v.z))
}

/// A combination of numbers; one of them where that is all.
#[inline(always)]
fn combined<T: Real>(by: [f64; 3], of: [T; 3]) -> T {
    match by {
        [1.0, 0.0, 0.0] => of[0],
        [0.0, 1.0, 0.0] => of[1],
        [0.0, 0.0, 1.0] => of[2],
        [a, b, c] => of[0] * a + of[1] * b + of[2] * c,
    }
}

#[inline(always)]
fn turned<T: Real>(axes: &Matrix3<f64>, v: [T; 3]) -> [T; 3] {
    let part = |i: usize| combined([axes[(i, 0)], axes[(i, 1)], axes[(i, 2)]], v);
    [part(0), part(1), part(2)]
}

impl Subspace {
    /// A displacement of this subspace in base coordinates.
    #[inline(always)]
    pub fn placed<T: Real>(&self, g: &Displacement<T>) -> Placed<T> {
        let (none, one) = (T::constant(0.0), T::constant(1.0));
        let about =
            |e: T::Plane| [[e.re(), -e.im(), none], [e.im(), e.re(), none], [none, none, one]];
        let (rows, along) = match g {
            Displacement::Identity(_) => (None, [none; 3]),
            Displacement::Planar(PlanarDisplacement { rotation, translation }) => {
                (Some(about(*rotation)), [translation.re(), translation.im(), none])
            }
            Displacement::Spherical(rotation) => (Some(rotation.rows()), [none; 3]),
            Displacement::Cylindrical(CylindricalDisplacement { angle, advance }) => {
                (Some(about(angle.unit())), [none, none, *advance])
            }
            Displacement::Translational(by) => (None, [by.re(), by.im(), none]),
            Displacement::Spatial(by) => (None, by.parts()),
        };
        let [x, y, z] = turned(&self.axes, along);
        let translation = T::Space::new(x, y, z);
        let Some(rows) = rows else { return Placed { rotation: None, translation } };
        // F R Fᵀ, column by column and row by row.
        let [a, b, c] = rows;
        let [a, b, c] = [turned(&self.axes, a), turned(&self.axes, b), turned(&self.axes, c)];
        let column = |j: usize| turned(&self.axes, [a[j], b[j], c[j]]);
        let rotation = T::Rotation::from_rows([column(0), column(1), column(2)]).inverse();
        let origin = constant::<T>(&self.origin.coords);
        let off = origin.plus(T::constant(-1.0), rotation.image(origin));
        Placed { rotation: Some(rotation), translation: translation.plus(one, off) }
    }
}

impl<T: Real> Placed<T> {
    /// The product: the other displacement is applied to points first.
    #[inline(always)]
    #[must_use]
    pub fn after(self, other: Self) -> Self {
        let one = T::constant(1.0);
        let Some(by) = self.rotation else {
            let translation = self.translation.plus(one, other.translation);
            return Self { translation, ..other };
        };
        let translation = self.translation.plus(one, by.image(other.translation));
        let columns = other.rotation.map(|rotation| rotation.inverse().rows());
        let rotation = columns.map_or(by, |columns| {
            let [one, two, three] = columns;
            let column = |[x, y, z]: [T; 3]| by.image(T::Space::new(x, y, z)).parts();
            T::Rotation::from_rows([column(one), column(two), column(three)]).inverse()
        });
        Self { rotation: Some(rotation), translation }
    }

    /// The translation by so many metres along a direction.
    #[inline(always)]
    pub fn slid(along: &Vector3<f64>, by: T) -> Self {
        let translation = T::Space::new(by * along.x, by * along.y, by * along.z);
        Self { rotation: None, translation }
    }

    /// The rotation, that of home where nothing rotates, and the translation.
    #[inline(always)]
    pub fn parts(self) -> (T::Rotation, T::Space) {
        let (none, one) = (T::constant(0.0), T::constant(1.0));
        let identity =
            || T::Rotation::from_rows([[one, none, none], [none, one, none], [none, none, one]]);
        (self.rotation.unwrap_or_else(identity), self.translation)
    }
}
