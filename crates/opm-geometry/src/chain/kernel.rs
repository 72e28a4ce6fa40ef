//! Equations in one joint alone, and their roots: what a leg in space is solved by, one joint after the other.
//!
//! Two objects that the joints beside a joint leave alone have an invariant: the distance of two points, the height of a point
//! over a plane, the angle of two directions. Where the joint moves one of them, that is an equation in the joint's
//! displacement `q`. For a revolute joint it is `A cos q + B sin q = C` ([`Row`]).

use crate::numbers::{Plane, Real, Space};

/// The axis of a revolute joint: a point of it, metres, and its unit direction.
#[derive(Clone, Copy, Debug)]
pub struct Axis<T: Real> {
    /// A point of the axis.
    pub point: T::Space,
    /// The unit direction.
    pub direction: T::Space,
}

/// The equation `cosine · cos q + sine · sin q = constant`.
#[derive(Clone, Copy, Debug)]
pub struct Row<T> {
    /// The coefficient of the cosine.
    pub cosine: T,
    /// The coefficient of the sine.
    pub sine: T,
    /// The right side.
    pub constant: T,
}

impl<T: Real> Axis<T> {
    /// A vector from the axis, split: its component along the axis, the part across it, and that part turned by a right
    /// angle.
    #[inline(always)]
    fn split(&self, vector: T::Space) -> (T, T::Space, T::Space) {
        let along = self.direction.inner(vector).named("along");
        let across = vector.plus(-along, self.direction).named("across");
        (along, across, self.direction.crossed(vector))
    }

    /// The vector from the axis' point.
    #[inline(always)]
    fn to(&self, point: T::Space) -> T::Space {
        point.plus(T::constant(-1.0), self.point)
    }

    /// A point that the joint moves is at a distance, of which the square is given, from a fixed one.
    #[inline(always)]
    pub fn distance(&self, moved: T::Space, fixed: T::Space, square: T) -> Row<T> {
        let (y, w) = (self.to(moved).named("arm"), self.to(fixed).named("fixed"));
        let (along, across, turned) = self.split(y);
        let sum = y.inner(y) + w.inner(w) - square;
        let constant = sum * 0.5 - along * self.direction.inner(w);
        Row { cosine: across.inner(w), sine: turned.inner(w), constant }
    }

    /// A point that the joint moves has a height along a fixed normal.
    #[inline(always)]
    pub fn height(&self, moved: T::Space, normal: T::Space, height: T) -> Row<T> {
        let (along, across, turned) = self.split(self.to(moved).named("arm"));
        let level = self.point.plus(along, self.direction).inner(normal);
        Row { cosine: across.inner(normal), sine: turned.inner(normal), constant: height - level }
    }

    /// A direction that the joint moves has a cosine with a fixed one.
    #[inline(always)]
    pub fn angle(&self, moved: T::Space, fixed: T::Space, cosine: T) -> Row<T> {
        let (along, across, turned) = self.split(moved);
        let constant = cosine - along * self.direction.inner(fixed);
        Row { cosine: across.inner(fixed), sine: turned.inner(fixed), constant }
    }

    /// A vector turned by the joint.
    #[inline(always)]
    pub fn turned(&self, vector: T::Space, q: T::Plane) -> T::Space {
        let (along, across, turned) = self.split(vector);
        across.scaled(q.re()).plus(q.im(), turned).plus(along, self.direction)
    }

    /// A point moved by the joint.
    #[inline(always)]
    pub fn moved(&self, point: T::Space, q: T::Plane) -> T::Space {
        self.turned(self.to(point).named("arm"), q).plus(T::constant(1.0), self.point)
    }
}

impl<T: Real> Row<T> {
    /// The square of half the distance of its two roots: they are real where it is not negative.
    #[inline(always)]
    pub fn square(&self) -> T {
        T::products([self.cosine, self.cosine], [self.sine, self.sine]) - self.constant.square()
    }

    /// The root at which the left side rises (`sign` is 1) or falls, as a unit vector.
    #[inline(always)]
    pub fn root(&self, sign: T::Sign) -> T::Plane {
        let axis = T::Plane::new(self.cosine, self.sine);
        let slope = self.square().root() * sign;
        (axis * T::Plane::new(self.constant, -slope)).per(axis.norm_sqr())
    }

    /// The root of this equation and another one, as a unit vector: they are linear in the cosine and the sine.
    #[inline(always)]
    pub fn common(&self, other: &Self) -> T::Plane {
        let [one, two] = [self, other].map(|row| T::Plane::new(row.cosine, row.sine));
        let determinant = one.cross(two);
        let re = T::products([self.constant, two.im()], [-other.constant, one.im()]);
        let im = T::products([one.re(), other.constant], [-two.re(), self.constant]);
        T::Plane::new(re, im).per(determinant)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Complex, Vector3};
    use proptest::prelude::*;

    fn vector() -> impl Strategy<Value = Vector3<f64>> {
        [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0].prop_map(Vector3::from)
    }

    proptest! {
        /// Of a joint that is displaced by a known angle, each invariant has that angle as one of its roots, and two of them
        /// have no other one.
        #[test]
        fn the_displacement_is_found(
            point in vector(), direction in vector(), moved in vector(), fixed in vector(), normal in vector(),
            q in -3.0..3.0_f64,
        ) {
            prop_assume!(direction.norm() > 0.1);
            let axis = Axis::<f64> { point, direction: direction.normalize() };
            let q = Complex::new(q.cos(), q.sin());
            let at = axis.moved(moved, q);
            let by_nalgebra = nalgebra::Rotation3::from_axis_angle(
                &nalgebra::Unit::new_unchecked(axis.direction), q.arg(),
            ) * (moved - point) + point;
            prop_assert!((at - by_nalgebra).norm() < 1e-13);
            let turned = axis.turned(moved, q);
            let rows = [
                axis.distance(moved, fixed, (at - fixed).norm_squared()),
                axis.height(moved, normal, at.dot(&normal)),
                axis.angle(moved, fixed, turned.dot(&fixed)),
            ];
            for row in &rows {
                let slope = row.sine * q.re - row.cosine * q.im;
                prop_assume!(slope.abs() > 1e-3);
                prop_assert!((row.root(slope.signum()) - q).norm() < 1e-9);
            }
            let determinant = rows[0].cosine * rows[1].sine - rows[0].sine * rows[1].cosine;
            prop_assume!(determinant.abs() > 1e-2);
            prop_assert!((rows[0].common(&rows[1]) - q).norm() < 1e-10);
        }
    }
}
