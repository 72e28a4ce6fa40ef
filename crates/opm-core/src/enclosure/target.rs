//! Displacements over a box of poses, and steps along the intersection motion.

use super::affine::{Affine, Plane};
use crate::group::{
    CylindricalMotion, IntersectionMotion, PlanarDisplacement, PlanarMotion, SpatialMotion,
    SphericalMotion, SubspaceKind, TranslationalMotion, mismatch,
};
use nalgebra::{Complex, Matrix3, Vector3};

/// A displacement of the plane over a box.
pub type PlanarTarget<const N: usize> = PlanarDisplacement<Plane<N>>;

/// A rotation over a box, row by row.
#[derive(Clone, Copy, Debug)]
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

/// A [`Displacement`](crate::group::Displacement) over a box.
#[derive(Clone, Copy, Debug)]
pub enum Target<const N: usize> {
    Identity,
    Planar(PlanarTarget<N>),
    Spherical(Rotation<N>),
    /// The angle and the advance about and along an axis.
    Cylindrical(Affine<N>, Affine<N>),
    Translational(Plane<N>),
    /// A translation in space.
    Spatial([Affine<N>; 3]),
}

impl<const N: usize> Target<N> {
    fn kind(&self) -> SubspaceKind {
        match self {
            Self::Identity => SubspaceKind::Identity,
            Self::Planar(_) => SubspaceKind::Planar,
            Self::Spherical(_) => SubspaceKind::Spherical,
            Self::Cylindrical(..) => SubspaceKind::Cylindrical,
            Self::Translational(_) => SubspaceKind::TranslationalPlane,
            Self::Spatial(_) => SubspaceKind::TranslationalSpace,
        }
    }

    /// The target, which must be a displacement of a plane.
    pub fn planar(&self) -> &PlanarTarget<N> {
        match self {
            Self::Planar(g) => g,
            Self::Identity
            | Self::Spherical(_)
            | Self::Cylindrical(..)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(SubspaceKind::Planar, self.kind()),
        }
    }

    /// The target, which must be a rotation about a centre.
    pub fn spherical(&self) -> &Rotation<N> {
        match self {
            Self::Spherical(r) => r,
            Self::Identity
            | Self::Planar(_)
            | Self::Cylindrical(..)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(SubspaceKind::Spherical, self.kind()),
        }
    }

    /// The angle and the advance of the target, which must be a displacement about and along an axis.
    pub fn cylindrical(&self) -> [Affine<N>; 2] {
        match *self {
            Self::Cylindrical(angle, advance) => [angle, advance],
            Self::Identity
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => mismatch(SubspaceKind::Cylindrical, self.kind()),
        }
    }

    /// The target, which must be a translation in a plane.
    pub fn translational(&self) -> &Plane<N> {
        match self {
            Self::Translational(t) => t,
            Self::Identity
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(..)
            | Self::Spatial(_) => mismatch(SubspaceKind::TranslationalPlane, self.kind()),
        }
    }

    /// The target, which must be a translation in space.
    pub fn spatial(&self) -> &[Affine<N>; 3] {
        match self {
            Self::Spatial(t) => t,
            Self::Identity
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(..)
            | Self::Translational(_) => mismatch(SubspaceKind::TranslationalSpace, self.kind()),
        }
    }
}

impl<const N: usize> Target<N> {
    /// The target's logarithm, where displacements commute: see [`Displacement::sum`](crate::group::Displacement).
    pub fn sum(&self) -> [Affine<N>; 3] {
        let none = Affine::constant(0.0);
        match *self {
            Self::Identity => [none; 3],
            Self::Cylindrical(angle, advance) => [angle, advance, none],
            Self::Translational(t) => [t.re, t.im, none],
            Self::Spatial(t) => t,
            Self::Planar(_) | Self::Spherical(_) => {
                mismatch(SubspaceKind::TranslationalSpace, self.kind())
            }
        }
    }

    /// The identity of a subspace.
    pub fn identity(kind: SubspaceKind) -> Self {
        let (none, one) = (Affine::constant(0.0), Affine::constant(1.0));
        let still = Plane::constant(Complex::ZERO);
        match kind {
            SubspaceKind::Identity => Self::Identity,
            SubspaceKind::Planar => {
                let rotation = Plane::constant(Complex::ONE);
                Self::Planar(PlanarTarget { rotation, translation: still })
            }
            SubspaceKind::Spherical => {
                Self::Spherical(Rotation([[one, none, none], [none, one, none], [none, none, one]]))
            }
            SubspaceKind::Cylindrical => Self::Cylindrical(none, none),
            SubspaceKind::TranslationalPlane => Self::Translational(still),
            SubspaceKind::TranslationalSpace => Self::Spatial([none; 3]),
        }
    }
}

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

/// The product `v · exp(I τ)`: see [`IntersectionMotion::after`].
pub fn after<const N: usize>(
    motion: IntersectionMotion,
    v: &Target<N>,
    tau: Enclosed<N>,
) -> Target<N> {
    match motion {
        IntersectionMotion::None(_) => *v,
        IntersectionMotion::Planar(PlanarMotion::Rotation) => {
            let v = v.planar();
            Target::Planar(PlanarTarget { rotation: v.rotation * tau.unit_vector(), ..*v })
        }
        IntersectionMotion::Planar(PlanarMotion::Translation(along)) => {
            let v = v.planar();
            let step = (v.rotation * along).scaled(tau.number());
            Target::Planar(PlanarTarget { translation: v.translation + step, ..*v })
        }
        IntersectionMotion::Spherical(SphericalMotion::Rotation) => {
            let e = tau.unit_vector();
            Target::Spherical(Rotation(v.spherical().0.map(|[x, y, z]| {
                let first = Affine::products([[&x, &e.re], [&y, &e.im]]);
                [first, Affine::products([[&y, &e.re], [&-x, &e.im]]), z]
            })))
        }
        IntersectionMotion::Cylindrical(motion) => {
            let [angle, advance] = v.cylindrical();
            match motion {
                CylindricalMotion::Rotation => Target::Cylindrical(angle + tau.number(), advance),
                CylindricalMotion::Translation => {
                    Target::Cylindrical(angle, advance + tau.number())
                }
            }
        }
        IntersectionMotion::Translational(TranslationalMotion::Translation(along)) => {
            let step = Plane::constant(along).scaled(tau.number());
            Target::Translational(*v.translational() + step)
        }
        IntersectionMotion::Spatial(SpatialMotion::Translation) => {
            let [x, y, z] = *v.spatial();
            Target::Spatial([x, y, z + tau.number()])
        }
    }
}

/// The product `exp(I τ) · b`: see [`IntersectionMotion::before`].
pub fn before<const N: usize>(
    motion: IntersectionMotion,
    b: &Target<N>,
    tau: Enclosed<N>,
) -> Target<N> {
    match motion {
        IntersectionMotion::Planar(PlanarMotion::Rotation) => {
            let (b, e) = (b.planar(), tau.unit_vector());
            Target::Planar(PlanarTarget {
                rotation: e * b.rotation,
                translation: e * b.translation,
            })
        }
        IntersectionMotion::Planar(PlanarMotion::Translation(along)) => {
            let b = b.planar();
            let step = Plane::constant(along).scaled(tau.number());
            Target::Planar(PlanarTarget { translation: b.translation + step, ..*b })
        }
        IntersectionMotion::Spherical(SphericalMotion::Rotation) => {
            let (e, [x, y, z]) = (tau.unit_vector(), b.spherical().0);
            let row = |f: &dyn Fn(usize) -> Affine<N>| [f(0), f(1), f(2)];
            Target::Spherical(Rotation([
                row(&|i| Affine::products([[&x[i], &e.re], [&-y[i], &e.im]])),
                row(&|i| Affine::products([[&x[i], &e.im], [&y[i], &e.re]])),
                z,
            ]))
        }
        // There is no motion, or displacements commute.
        IntersectionMotion::None(_)
        | IntersectionMotion::Cylindrical(_)
        | IntersectionMotion::Translational(_)
        | IntersectionMotion::Spatial(_) => after(motion, b, tau),
    }
}

/// One coordinate of a box of poses.
#[derive(Clone, Copy, Debug)]
pub enum Coordinate<const N: usize> {
    /// A coordinate that is linear in the box.
    Linear(Affine<N>),
    /// An angle that the box replaces by its cosine or sine, as a unit vector at `xi`, or at `nu` minus its
    /// value at home.
    Polar(Plane<N>),
}

impl<const N: usize> Coordinate<N> {
    /// The coordinate minus `home`, for a length or a linear angle.
    pub fn minus(self, home: f64) -> Affine<N> {
        match self {
            Self::Linear(value) => value - home,
            Self::Polar(_) => {
                unreachable!("a coordinate that tilts an axis is an angle, not a length")
            }
        }
    }

    /// Whether it is at most this far from its value in the middle of the box, radians or metres.
    pub fn is_within(&self, most: f64) -> bool {
        match self {
            Self::Linear(value) => value.radius() <= most,
            Self::Polar(_) => true,
        }
    }

    /// Its largest change by each coordinate of the box.
    pub fn spread(&self) -> [f64; N] {
        match self {
            Self::Linear(value) => value.spread(),
            Self::Polar(e) => e.spread(),
        }
    }

    /// The unit vector at the angle minus `home`.
    fn unit_vector(self, home: f64) -> Plane<N> {
        match self {
            Self::Linear(value) => (value - home).unit_vector(),
            Self::Polar(e) => e,
        }
    }
}

/// The displacements that [`Task`](crate::task::Task) computes from coordinates, over a box of them.
pub mod task {
    use super::{Affine, Coordinate, PlanarTarget, Plane, Rotation, Target};
    use crate::group::{
        CylindricalMotion, IntersectionMotion, PlanarMotion, SphericalMotion, SubspaceKind,
    };
    use crate::mechanism::OrientationCoordinates;
    use crate::mechanism::leg::Section;
    use crate::task::Task;
    use nalgebra::Complex;

    /// The coordinates of a section other than a height, and their values at home; zeros beyond the last. `pose` begins
    /// with the section's first coordinate.
    fn in_plane<const N: usize>(
        task: &Task,
        section: Section,
        pose: &[Coordinate<N>],
    ) -> ([Coordinate<N>; 3], [f64; 3]) {
        let mut at = [Coordinate::Linear(Affine::constant(0.0)); 3];
        let mut home = [0.0; 3];
        let of_section = pose.iter().zip(&task.coordinates[task.range(section)]);
        for (place, (value, c)) in task.in_plane(section, of_section).enumerate() {
            (at[place], home[place]) = (*value, c.home);
        }
        (at, home)
    }

    /// The displacement `v` for the first coordinates of a box: see [`Task::lower`].
    pub fn lower<const N: usize>(task: &Task, pose: &[Coordinate<N>]) -> Target<N> {
        let (pose, home) = in_plane(task, Section::Lower, pose);
        let q = |i: usize| pose[i].minus(home[i]);
        match task.lower_intersection {
            IntersectionMotion::None(kind) => alone(task, kind, &pose, &home),
            IntersectionMotion::Planar(motion) => Target::Planar(PlanarTarget {
                rotation: match motion {
                    PlanarMotion::Rotation => Plane::constant(Complex::new(1.0, 0.0)),
                    PlanarMotion::Translation(_) => pose[2].unit_vector(home[2]),
                },
                translation: Plane { re: q(0), im: q(1) },
            }),
            IntersectionMotion::Spherical(SphericalMotion::Rotation) => {
                Target::Spherical(tilt(pose[0].unit_vector(home[0]), pose[1].unit_vector(home[1])))
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => {
                Target::Cylindrical(Affine::constant(0.0), q(0))
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => {
                Target::Cylindrical(q(0), q(1))
            }
            IntersectionMotion::Translational(_) => {
                Target::Translational(Plane { re: q(0), im: q(1) })
            }
            IntersectionMotion::Spatial(_) => Target::Spatial([q(0), q(1), q(2)]),
        }
    }

    /// The displacement `b` for the remaining coordinates of a box: see [`Task::upper`].
    pub fn upper<const N: usize>(task: &Task, pose: &[Coordinate<N>]) -> Target<N> {
        let (pose, home) = in_plane(task, Section::Upper, pose);
        let q = |i: usize| pose[i].minus(home[i]);
        let planar = |rotation, re, im| {
            Target::Planar(PlanarTarget { rotation, translation: Plane { re, im } })
        };
        let none = Affine::constant(0.0);
        match task.upper_intersection {
            IntersectionMotion::None(kind) => alone(task, kind, &pose, &home),
            IntersectionMotion::Spherical(SphericalMotion::Rotation) => orientation(task, &pose),
            IntersectionMotion::Planar(PlanarMotion::Rotation) => {
                planar(pose[2].unit_vector(home[2]), q(0), q(1))
            }
            IntersectionMotion::Planar(PlanarMotion::Translation(_)) => {
                planar(pose[1].unit_vector(home[1]), none, q(0))
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Rotation) => {
                Target::Cylindrical(q(0), q(1))
            }
            IntersectionMotion::Cylindrical(CylindricalMotion::Translation) => {
                Target::Cylindrical(q(0), none)
            }
            IntersectionMotion::Translational(_) => {
                Target::Translational(Plane { re: none, im: q(0) })
            }
            IntersectionMotion::Spatial(_) => Target::Spatial([q(0), q(1), none]),
        }
    }

    /// The displacement `b` as a rotation along the intersection motion, radians, and then another displacement. A leg's
    /// displacement along that motion is the rotation plus what the other displacement makes, so it is exactly linear in the
    /// coordinate that rotates. `None` where there is no such coordinate.
    pub fn upper_turned<const N: usize>(
        task: &Task,
        pose: &[Coordinate<N>],
    ) -> Option<(Affine<N>, Target<N>)> {
        let (mut pose, _) = in_plane(task, Section::Upper, pose);
        match (task.upper_intersection, pose[0]) {
            (
                IntersectionMotion::Spherical(SphericalMotion::Rotation),
                Coordinate::Linear(turn),
            ) => {
                pose = euler_angles(task, &pose);
                pose[0] = Coordinate::Linear(Affine::constant(0.0));
                Some((turn, of_euler_angles(task, &pose)))
            }
            _ => None,
        }
    }

    /// The displacement of a section that shares no motion with the other one. Its coordinates are those of its
    /// whole subspace, given by their place, with their values at home.
    fn alone<const N: usize>(
        task: &Task,
        kind: SubspaceKind,
        pose: &[Coordinate<N>; 3],
        home: &[f64; 3],
    ) -> Target<N> {
        let q = |i: usize| pose[i].minus(home[i]);
        match kind {
            SubspaceKind::Identity => Target::Identity,
            SubspaceKind::Planar => Target::Planar(PlanarTarget {
                rotation: pose[2].unit_vector(home[2]),
                translation: Plane { re: q(0), im: q(1) },
            }),
            SubspaceKind::Spherical => orientation(task, pose),
            SubspaceKind::Cylindrical => Target::Cylindrical(q(0), q(1)),
            SubspaceKind::TranslationalPlane => Target::Translational(Plane { re: q(0), im: q(1) }),
            SubspaceKind::TranslationalSpace => Target::Spatial([q(0), q(1), q(2)]),
        }
    }

    /// The Euler angles of an orientation's coordinates, of which the second alone may be polar.
    fn euler_angles<const N: usize>(task: &Task, pose: &[Coordinate<N>; 3]) -> [Coordinate<N>; 3] {
        match (task.angles, pose) {
            (
                OrientationCoordinates::TiltTorsion,
                &[Coordinate::Linear(azimuth), tilt, Coordinate::Linear(torsion)],
            ) => [pose[0], tilt, Coordinate::Linear(torsion - azimuth)],
            _ => *pose,
        }
    }

    /// The rotation from home for the coordinates of an orientation.
    fn orientation<const N: usize>(task: &Task, pose: &[Coordinate<N>; 3]) -> Target<N> {
        of_euler_angles(task, &euler_angles(task, pose))
    }

    fn of_euler_angles<const N: usize>(task: &Task, angles: &[Coordinate<N>; 3]) -> Target<N> {
        let [zeta, xi, psi] = angles.map(|angle| angle.unit_vector(0.0));
        let absolute = euler(zeta, xi, psi);
        Target::Spherical(match task.home_orientation_inverse() {
            Some(inverse) => absolute.after(inverse),
            None => absolute,
        })
    }

    /// The rotation `Rx(mu) Ry(nu)`.
    fn tilt<const N: usize>(mu: Plane<N>, nu: Plane<N>) -> Rotation<N> {
        let (none, cm, sm, cn, sn) = (Affine::constant(0.0), mu.re, mu.im, nu.re, nu.im);
        Rotation([[cn, none, sn], [sm * sn, cm, -(sm * cn)], [-(cm * sn), sm, cm * cn]])
    }

    /// The rotation `Rz(zeta) Ry(xi) Rz(psi)`.
    fn euler<const N: usize>(zeta: Plane<N>, xi: Plane<N>, psi: Plane<N>) -> Rotation<N> {
        let (cx, sx) = (xi.re, xi.im);
        // Ry(xi) Rz(psi), its first two rows then rotated about z.
        let first = [cx * psi.re, -(cx * psi.im), sx];
        let second = [psi.im, psi.re, Affine::constant(0.0)];
        Rotation([
            [0, 1, 2].map(|j| Affine::products([[&zeta.re, &first[j]], [&-zeta.im, &second[j]]])),
            [0, 1, 2].map(|j| Affine::products([[&zeta.im, &first[j]], [&zeta.re, &second[j]]])),
            [-(sx * psi.re), sx * psi.im, cx],
        ])
    }
}
