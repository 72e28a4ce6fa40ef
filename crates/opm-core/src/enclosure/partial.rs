//! The closed forms of sections with fewer freedoms than their subspace has dimensions, over a box of targets that satisfy
//! their constraints: see [`PartialChain`].

use super::affine::{Affine, Plane};
use super::condition::along;
use super::target::{Enclosed, PlanarTarget, Target, dot};
use crate::chain::partial::PartialChain;
use crate::group::{LocalTwist, linear, quarter};
use nalgebra::Complex;

/// The joints' displacements; zeros of locked joints.
pub fn displacements<const N: usize>(
    partial: &PartialChain,
    target: &Target<N>,
) -> [Enclosed<N>; 3] {
    let mut found = [Enclosed::Value(Affine::constant(0.0)); 3];
    let screws = partial.screws();
    match partial.free() {
        (Some(a), Some(b)) => {
            [found[a], found[b]] = two(&screws[a], &screws[b], target);
        }
        (Some(a), None) => found[a] = one(&screws[a], target),
        (None, _) => {}
    }
    found
}

/// The displacement of the only joint that moves: see [`PartialChain::one`].
fn one<const N: usize>(s: &LocalTwist, g: &Target<N>) -> Enclosed<N> {
    match g {
        Target::Identity => Enclosed::Value(Affine::constant(0.0)),
        Target::Planar(g) if s.x != 0.0 => turned(s, g.rotation),
        Target::Planar(g) => Enclosed::Value(along(linear(s), g.translation)),
        Target::Spherical(r) => {
            let m = &r.0;
            let axial = [m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]];
            let cosine = m[0][0] + m[1][1] + m[2][2] - 1.0;
            Enclosed::Direction(Plane { re: cosine, im: dot(s, &axial) })
        }
        &Target::Cylindrical(_, advance) if s.x == 0.0 => Enclosed::Value(advance * (1.0 / s.y)),
        &Target::Cylindrical(angle, _) if s.y == 0.0 => Enclosed::Angle(angle * s.x),
        // The angle of a helical joint counts full revolutions.
        &Target::Cylindrical(angle, _) => Enclosed::Value(angle * s.x),
        Target::Translational(t) => Enclosed::Value(along(Complex::new(s.x, s.y), *t)),
        Target::Spatial(t) => Enclosed::Value(dot(s, t)),
    }
}

/// The displacements of the two joints that move: see [`PartialChain::two`].
fn two<const N: usize>(s: &LocalTwist, t: &LocalTwist, g: &Target<N>) -> [Enclosed<N>; 2] {
    match g {
        Target::Planar(g) => planar(s, t, g),
        Target::Spherical(r) => {
            // With R = exp(s p) exp(t q), `R t` is `t` turned by the first joint, and `Rᵀ s` is `s` turned back by the second.
            let first = about(s, t, &r.apply(t));
            [first, about(t, s, &r.apply_back(s)).inverse()]
        }
        Target::Spatial(g) => {
            let normal = s.cross(t);
            let square = normal.norm_squared();
            [t.cross(&normal), normal.cross(s)].map(|v| Enclosed::Value(dot(&(v / square), g)))
        }
        Target::Identity | Target::Cylindrical(..) | Target::Translational(_) => {
            unreachable!("two joints are a whole chain in these subspaces")
        }
    }
}

fn planar<const N: usize>(s: &LocalTwist, t: &LocalTwist, g: &PlanarTarget<N>) -> [Enclosed<N>; 2] {
    let pivot = |s: &LocalTwist| quarter(linear(s)) * s.x;
    let slide = |s: &LocalTwist, z: Plane<N>| Enclosed::Value(along(linear(s), z));
    match (s.x != 0.0, t.x != 0.0) {
        (true, true) => {
            // The first joint moves the second one's axis.
            let (x, y) = (pivot(s), pivot(t));
            let first = ((g.apply(y) - x) * (y - x).conj()).direction();
            [turned(s, first), turned(t, g.rotation * first.conj())]
        }
        (false, true) => {
            let y = pivot(t);
            [slide(s, g.apply(y) - y), turned(t, g.rotation)]
        }
        (true, false) => {
            let rest = PlanarTarget::about(pivot(s), g.rotation).inverse().after(g);
            [turned(s, g.rotation), slide(t, rest.translation)]
        }
        (false, false) => {
            let (u, v, z) = (linear(s), linear(t), g.translation);
            let area = u.re * v.im - u.im * v.re;
            let [m, n] = [z.cross(Plane::constant(v)), Plane::constant(u).cross(z)];
            [m, n].map(|part| Enclosed::Value(part * (1.0 / area)))
        }
    }
}

/// The displacement of a revolute joint in a plane, for a rotation counter-clockwise in the plane's frame.
fn turned<const N: usize>(s: &LocalTwist, rotation: Plane<N>) -> Enclosed<N> {
    Enclosed::Direction(if s.x < 0.0 { rotation.conj() } else { rotation })
}

/// The angle about `axis` that takes one vector to another, as a direction.
fn about<const N: usize>(axis: &LocalTwist, from: &LocalTwist, to: &[Affine<N>; 3]) -> Enclosed<N> {
    let across = from - axis * axis.dot(from);
    Enclosed::Direction(Plane { re: dot(&across, to), im: dot(&axis.cross(&across), to) })
}
