//! Conditions on a displacement over a box: see [`Condition`].

use super::affine::{Affine, Plane};
use super::target::{Target, dot};
use crate::chain::condition::Condition;
use nalgebra::Complex;

/// The difference of the equation's two sides over a box: see [`Condition::value`].
pub fn value<const N: usize>(condition: &Condition, g: &Target<N>) -> Affine<N> {
    match *condition {
        Condition::Circle { point, centre, radius } => {
            (g.planar().apply(point) - centre).norm_sqr() - radius * radius
        }
        Condition::Line { point, normal, offset } => {
            along(normal, g.planar().apply(point)) - offset
        }
        Condition::CarriedLine { point, normal, offset } => {
            along(normal, g.planar().inverse().apply(point)) - offset
        }
        Condition::Heading { rotation } => (g.planar().rotation * rotation.conj()).im,
        Condition::Cone { fixed, carried, cosine } => {
            dot(&fixed, &g.spherical().apply(&carried)) - cosine
        }
        Condition::Flat { normal, value } => dot(&normal, &g.sum()) - value,
    }
}

/// The scalar product of a vector of the plane with one over a box.
pub fn along<const N: usize>(direction: Complex<f64>, z: Plane<N>) -> Affine<N> {
    z.re * direction.re + z.im * direction.im
}
