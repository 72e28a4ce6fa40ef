//! Closed forms of a section with fewer freedoms than its subspace has dimensions. It closes only at the
//! displacements that satisfy its constraints ([`Condition`](super::condition::Condition)), and there it has one
//! solution.
//!
//! Such a section is completed to a chain by *locked* joints, which never move. They have screws that are as
//! independent of the others at home as can be. The equation of a chain with one joint held is then the
//! constraint. The solution here does not involve the locked joints: a pose at which these would be singular
//! is like any other.

use super::ChainJoint;
use super::planar::PlanarJoint;
use crate::group::{
    Displacement, LocalTwist, PlanarDisplacement, Subspace, SubspaceKind, linear, quarter,
};
use crate::numbers::{
    Joint, Over, Plane, PlaneOver, Real, Rotation, RotationOver, Space, SpaceOver,
};
use nalgebra::{Complex, Unit, Vector3};

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
    pub fn inverse<T: Over<f64>>(&self, target: &Displacement<T>) -> [T::Joint; 3] {
        let mut found = [T::Joint::value(T::constant(0.0)); 3];
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
    pub fn one<T: Over<f64>>(&self, joint: usize, g: &Displacement<T>) -> T::Joint {
        let s = &self.screws[joint];
        match *g {
            Displacement::Identity(_) => T::Joint::value(T::constant(0.0)),
            Displacement::Planar(ref g) => one_in_plane::<T, _>(planar_joint(s), g),
            Displacement::Spherical(r) => one_about_point::<T, f64>(*s, r),
            Displacement::Cylindrical(g) if s.x == 0.0 => T::Joint::value(g.advance.per(s.y)),
            Displacement::Cylindrical(g) if s.y == 0.0 => T::Joint::angle(g.angle * s.x),
            // The angle of a helical joint counts full revolutions.
            Displacement::Cylindrical(g) => T::Joint::value(g.angle * s.x),
            Displacement::Translational(t) => T::Joint::value(t.dot(linear_of(s))),
            Displacement::Spatial(t) => T::Joint::value(t.against(*s)),
        }
    }

    /// The displacements of the two joints that move, in a subspace of three dimensions: `exp(s p) exp(t q) = g`.
    #[inline(always)]
    pub fn two<T: Over<f64>>(&self, joints: [usize; 2], g: &Displacement<T>) -> [T::Joint; 2] {
        let [s, t] = joints.map(|joint| &self.screws[joint]);
        match *g {
            Displacement::Planar(ref g) => {
                two_in_plane::<T, _>([planar_joint(s), planar_joint(t)], g)
            }
            Displacement::Spherical(r) => two_about_point::<T, f64>([*s, *t], r),
            Displacement::Spatial(g) => two_in_space::<T, f64>([*s, *t], g),
            Displacement::Identity(_)
            | Displacement::Cylindrical(_)
            | Displacement::Translational(_) => {
                unreachable!("two joints are a whole chain in these subspaces")
            }
        }
    }
}

/// The joint of a plane with a screw.
#[inline(always)]
fn planar_joint(s: &LocalTwist) -> PlanarJoint {
    if s.x == 0.0 {
        PlanarJoint::Prismatic { along: linear(s) }
    } else {
        PlanarJoint::Revolute { at: quarter(linear(s)) * s.x, reversed: s.x < 0.0 }
    }
}

/// The displacement of a joint of a plane that makes the displacement `g`.
#[inline(always)]
pub fn one_in_plane<T: Over<Z::Real>, Z: Plane>(
    joint: PlanarJoint<Z>,
    g: &PlanarDisplacement<T::Plane>,
) -> T::Joint {
    match joint {
        PlanarJoint::Revolute { reversed, .. } => {
            T::Joint::direction(g.rotation.in_sense(reversed))
        }
        PlanarJoint::Prismatic { along } => T::Joint::value(g.translation.dot(along)),
    }
}

/// The displacements of two joints of a plane that together make the displacement `g`.
#[inline(always)]
pub fn two_in_plane<T: Over<Z::Real>, Z: Plane>(
    [first, second]: [PlanarJoint<Z>; 2],
    g: &PlanarDisplacement<T::Plane>,
) -> [T::Joint; 2] {
    use PlanarJoint::{Prismatic, Revolute};
    let turn = |r: T::Plane, reversed| T::Joint::direction(r.in_sense(reversed));
    match [first, second] {
        [Revolute { at: x, reversed: r1 }, Revolute { at: y, reversed: r2 }] => {
            // The first joint moves the second one's axis.
            let first = ((g.apply(y) - x) * (y - x).conj()).normalised().named("first");
            [turn(first, r1), turn(g.rotation * first.conj(), r2)]
        }
        [Prismatic { along }, Revolute { at, reversed }] => {
            let moved = g.apply(at) - at;
            [T::Joint::value(moved.dot(along)), turn(g.rotation, reversed)]
        }
        [Revolute { at, reversed }, Prismatic { along }] => {
            let moved = (g.apply(at) - at) * g.rotation.conj();
            [turn(g.rotation, reversed), T::Joint::value(moved.dot(along))]
        }
        [Prismatic { along: u }, Prismatic { along: v }] => {
            g.translation.along_constants(u, v).map(T::Joint::value)
        }
    }
}

/// The angle of a joint with a unit axis that makes the rotation `r`: the trace is 1 + 2 cos q, the axial vector the axis
/// times 2 sin q.
#[inline(always)]
pub fn one_about_point<T: Over<C>, C: Real>(axis: C::Space, r: T::Rotation) -> T::Joint {
    let [[a, b, c], [d, e, f], [g, h, i]] = r.rows();
    let axial = T::Space::new(h - f, c - g, d - b);
    T::Joint::direction(T::Plane::new(a + e + i - 1.0, axial.against(axis)))
}

/// The angles of two joints with unit axes that together make the rotation `r`: it turns the second axis as the first joint
/// does, and its inverse the first one as that of the second joint.
#[inline(always)]
pub fn two_about_point<T: Over<C>, C: Real>(
    [s, t]: [C::Space; 2],
    r: T::Rotation,
) -> [T::Joint; 2] {
    let about = |axis: C::Space, from: C::Space, to: T::Space| {
        let across = from.plus(-axis.inner(from), axis);
        let (cosine, sine) = (to.against(across), to.against(axis.crossed(across)));
        T::Joint::direction(T::Plane::new(cosine, sine))
    };
    [about(s, t, r.apply(t)), about(t, s, r.apply_back(s)).inverse()]
}

/// The displacements of two sliders that together make a translation in the plane that they span: `s p + t q = g`.
#[inline(always)]
pub fn two_in_space<T: Over<C>, C: Real>([s, t]: [C::Space; 2], g: T::Space) -> [T::Joint; 2] {
    let normal = s.crossed(t);
    let square = normal.inner(normal);
    [t.crossed(normal), normal.crossed(s)].map(|v| T::Joint::value(g.against(v).per(square)))
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
