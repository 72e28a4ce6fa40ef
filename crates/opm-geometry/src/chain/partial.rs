//! Closed forms of a section with fewer freedoms than its subspace has dimensions. It closes only at the
//! displacements that satisfy its constraints ([`Condition`](super::condition::Condition)), and there it has one
//! solution.
//!
//! Such a section is completed to a chain by *locked* joints, which never move. They have screws that are as
//! independent of the others at home as can be. The equation of a chain with one joint held is then the
//! constraint. The solution here does not involve the locked joints: a pose at which these would be singular
//! is like any other.

use super::ChainJoint;
use super::condition::{dot, length};
use crate::group::{
    Displacement, JointDisplacement, LocalTwist, PlanarDisplacement, Subspace, SubspaceKind,
    linear, quarter, rotation_about,
};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Matrix3, Unit, Vector3};

/// A locked joint in a plane is a slider where the angular part of its screw is less than this share.
const SLIDES: f64 = 0.3;

/// The joints of a section that move, one or two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialChain {
    kind: SubspaceKind,
    /// The screws of the completed chain's joints at home: see [`screws`](super::screws).
    screws: [LocalTwist; 3],
    /// Which joints of the completed chain are locked.
    locked: [bool; 3],
}

impl PartialChain {
    pub fn new(kind: SubspaceKind, screws: [LocalTwist; 3], locked: [bool; 3]) -> Self {
        Self { kind, screws, locked }
    }

    /// The screws of the completed chain's joints at home.
    pub fn screws(&self) -> &[LocalTwist; 3] {
        &self.screws
    }

    /// Which joints of the completed chain are locked.
    pub fn locked(&self) -> [bool; 3] {
        self.locked
    }

    /// The numbers of the locked joints in the completed chain.
    pub fn locked_joints(&self) -> impl Iterator<Item = usize> + use<> {
        let locked = self.locked;
        (0..3).filter(move |&joint| locked[joint])
    }

    /// The numbers of the joints that move, in their order: the first, and the second if there is one.
    pub fn free(&self) -> (Option<usize>, Option<usize>) {
        let mut free = (0..self.kind.dimension()).filter(|&joint| !self.locked[joint]);
        (free.next(), free.next())
    }

    /// The displacements of the completed chain's joints that move the outer link by `target`, which satisfies
    /// the section's constraints. Locked joints have zeros.
    pub fn inverse(&self, target: &Displacement) -> [JointDisplacement; 3] {
        let mut found = [JointDisplacement::Value(0.0); 3];
        match self.free() {
            (Some(a), Some(b)) => [found[a], found[b]] = self.two([a, b], target),
            (Some(a), None) => found[a] = self.one(a, target),
            (None, _) => {}
        }
        found
    }

    /// Replaces the screws of the locked joints by some that are perpendicular to the others, with lengths over
    /// `length`. The determinant of all, over the unit that is returned, is then a measure of how independent the
    /// joints are that move.
    pub fn complete(&self, screws: &mut [LocalTwist; 3], length: f64) -> f64 {
        let unit = units(self.kind, length);
        let mut basis: [Option<Vector3<f64>>; 3] = [None; 3];
        for joint in (0..3).filter(|&joint| !self.locked[joint]) {
            let rest = outside(&basis, screws[joint].component_div(&unit));
            basis[joint] = rest.try_normalize(0.0);
        }
        for joint in self.locked_joints() {
            let rest = farthest(&basis, self.kind.dimension()).normalize();
            basis[joint] = Some(rest);
            screws[joint] = rest.component_mul(&unit);
        }
        unit.iter().product()
    }

    /// The displacement of the only joint that moves: `exp(s q) = g`.
    #[inline(always)]
    pub fn one(&self, joint: usize, g: &Displacement) -> JointDisplacement {
        let s = &self.screws[joint];
        match g {
            Displacement::Identity(_) => JointDisplacement::Value(0.0),
            Displacement::Planar(g) if s.x != 0.0 => turned(s, g.rotation),
            Displacement::Planar(g) => JointDisplacement::Value(dot(linear(s), g.translation)),
            Displacement::Spherical(r) => {
                // The trace is 1 + 2 cos q, and the axial vector s sin q.
                let axial = Vector3::new(
                    r[(2, 1)] - r[(1, 2)],
                    r[(0, 2)] - r[(2, 0)],
                    r[(1, 0)] - r[(0, 1)],
                );
                let (cos, sin) = (r.trace() - 1.0, s.dot(&axial));
                JointDisplacement::Direction(normalised(Complex::new(cos, sin)))
            }
            Displacement::Cylindrical(g) if s.x == 0.0 => JointDisplacement::Value(g.advance / s.y),
            Displacement::Cylindrical(g) if s.y == 0.0 => {
                JointDisplacement::Direction(unit(g.angle * s.x))
            }
            // The angle of a helical joint counts full revolutions.
            Displacement::Cylindrical(g) => JointDisplacement::Value(g.angle * s.x),
            Displacement::Translational(t) => JointDisplacement::Value(dot(linear_of(s), *t)),
            Displacement::Spatial(t) => JointDisplacement::Value(s.dot(t)),
        }
    }

    /// The displacements of the two joints that move, in a subspace of three dimensions: `exp(s p) exp(t q) = g`.
    #[inline(always)]
    pub fn two(&self, joints: [usize; 2], g: &Displacement) -> [JointDisplacement; 2] {
        let [s, t] = joints.map(|joint| &self.screws[joint]);
        match g {
            Displacement::Planar(g) => planar(s, t, g),
            Displacement::Spherical(r) => spherical(s, t, r),
            Displacement::Spatial(g) => spatial(s, t, g),
            Displacement::Identity(_)
            | Displacement::Cylindrical(_)
            | Displacement::Translational(_) => {
                unreachable!("two joints are a whole chain in these subspaces")
            }
        }
    }
}

#[inline(always)]
fn planar(s: &LocalTwist, t: &LocalTwist, g: &PlanarDisplacement) -> [JointDisplacement; 2] {
    let pivot = |s: &LocalTwist| quarter(linear(s)) * s.x;
    let slide = |s: &LocalTwist, z: Complex<f64>| JointDisplacement::Value(dot(linear(s), z));
    match (s.x != 0.0, t.x != 0.0) {
        (true, true) => {
            // The first joint moves the second one's axis.
            let (x, y) = (pivot(s), pivot(t));
            let first = normalised((g.apply(y) - x) * (y - x).conj());
            [turned(s, first), turned(t, g.rotation * first.conj())]
        }
        (false, true) => {
            let y = pivot(t);
            [slide(s, g.apply(y) - y), turned(t, g.rotation)]
        }
        (true, false) => {
            let rest = PlanarDisplacement::about(pivot(s), g.rotation).inverse().after(g);
            [turned(s, g.rotation), slide(t, rest.translation)]
        }
        (false, false) => {
            let (u, v, z) = (linear(s), linear(t), g.translation);
            let cross = |a: Complex<f64>, b: Complex<f64>| a.re * b.im - a.im * b.re;
            let area = cross(u, v);
            [cross(z, v), cross(u, z)].map(|part| JointDisplacement::Value(part / area))
        }
    }
}

fn spherical(s: &LocalTwist, t: &LocalTwist, r: &Matrix3<f64>) -> [JointDisplacement; 2] {
    // The first joint moves the second one's axis.
    let first = about(s, t, &(r * t));
    let rest = rotation_about(s, first).tr_mul(r);
    [first, about(t, s, &(rest * s))].map(JointDisplacement::Direction)
}

/// The displacements of two sliders, in the plane that they span: `s p + t q = g`.
fn spatial(s: &LocalTwist, t: &LocalTwist, g: &Vector3<f64>) -> [JointDisplacement; 2] {
    let normal = s.cross(t);
    let square = normal.norm_squared();
    [g.cross(t), s.cross(g)].map(|part| JointDisplacement::Value(part.dot(&normal) / square))
}

/// The direction of the angle about `axis` that takes one vector to another.
fn about(axis: &Vector3<f64>, from: &Vector3<f64>, to: &Vector3<f64>) -> Complex<f64> {
    let across = |v: &Vector3<f64>| v - axis * axis.dot(v);
    let (from, to) = (across(from), across(to));
    let z = Complex::new(from.dot(&to), axis.dot(&from.cross(&to)));
    if z.norm_sqr() > 0.0 { normalised(z) } else { Complex::new(1.0, 0.0) }
}

/// The unit vector in the direction of `z`.
#[inline(always)]
fn normalised(z: Complex<f64>) -> Complex<f64> {
    z / length(z)
}

/// The displacement of a revolute joint in a plane, for a rotation counter-clockwise in the plane's frame.
#[inline(always)]
fn turned(s: &LocalTwist, rotation: Complex<f64>) -> JointDisplacement {
    JointDisplacement::Direction(if s.x < 0.0 { rotation.conj() } else { rotation })
}

/// The direction of a slider in a translational plane.
fn linear_of(s: &LocalTwist) -> Complex<f64> {
    Complex::new(s.x, s.y)
}

/// Joints that complete those with the screws `free` to a chain of the subspace. Lengths are compared with
/// `size`, metres.
pub fn completion(subspace: &Subspace, free: &[LocalTwist], size: f64) -> Vec<ChainJoint> {
    let dimension = subspace.dimension();
    let unit = units(subspace.kind, size);
    // Orthonormal vectors: the screws that are there, then those that are missing.
    let mut basis: [Option<Vector3<f64>>; 3] = [None; 3];
    for (number, screw) in free.iter().enumerate() {
        // Joints that are dependent are refused by the chain.
        basis[number] = outside(&basis, screw.component_div(&unit)).try_normalize(0.0);
    }
    (free.len()..dimension)
        .map(|number| {
            let rest = farthest(&basis, dimension).normalize();
            basis[number] = Some(rest);
            joint(subspace, &rest, size)
        })
        .collect()
}

/// The units of the components of a screw: one for an angle, `size` for a length where there are angles too.
fn units(kind: SubspaceKind, size: f64) -> Vector3<f64> {
    match kind {
        SubspaceKind::Planar => Vector3::new(1.0, size, size),
        SubspaceKind::Cylindrical => Vector3::new(1.0, size, 1.0),
        SubspaceKind::Identity
        | SubspaceKind::Spherical
        | SubspaceKind::TranslationalPlane
        | SubspaceKind::TranslationalSpace => Vector3::repeat(1.0),
    }
}

/// The part of a vector that is perpendicular to all vectors of an orthonormal basis.
fn outside(basis: &[Option<Vector3<f64>>; 3], v: Vector3<f64>) -> Vector3<f64> {
    basis.iter().flatten().fold(v, |v, known| v - known * known.dot(&v))
}

/// The part of that direction that is farthest from the span of an orthonormal basis.
fn farthest(basis: &[Option<Vector3<f64>>; 3], dimension: usize) -> Vector3<f64> {
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let rests = axes[..dimension].iter().map(|&axis| outside(basis, axis));
    let farthest = rests.max_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    farthest.unwrap_or_else(Vector3::x)
}

/// The joint in base coordinates with a screw, whose lengths are over `size`. In a plane and on a cylinder it
/// is the nearest revolute joint or slider.
fn joint(subspace: &Subspace, s: &Vector3<f64>, size: f64) -> ChainJoint {
    let base = |v: Vector3<f64>| Unit::new_normalize(subspace.axes * v);
    let third = base(Vector3::z());
    let revolute = |axis, point| ChainJoint::Screw { axis, point, pitch: 0.0 };
    match subspace.kind {
        SubspaceKind::Planar if s.x.abs() > SLIDES => {
            let at = quarter(Complex::new(s.y, s.z)) * (size / s.x);
            revolute(third, subspace.restored(&Vector3::new(at.re, at.im, 0.0)))
        }
        SubspaceKind::Planar => ChainJoint::Slide { axis: base(Vector3::new(s.y, s.z, 0.0)) },
        SubspaceKind::Spherical => revolute(base(*s), subspace.origin),
        SubspaceKind::Cylindrical if s.x.abs() > s.y.abs() => revolute(third, subspace.origin),
        SubspaceKind::Cylindrical => ChainJoint::Slide { axis: third },
        SubspaceKind::Identity | SubspaceKind::TranslationalPlane => {
            ChainJoint::Slide { axis: base(Vector3::new(s.x, s.y, 0.0)) }
        }
        SubspaceKind::TranslationalSpace => ChainJoint::Slide { axis: base(*s) },
    }
}
