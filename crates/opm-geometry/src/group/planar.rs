//! The planar subgroup, `SE(2)`: displacements of a plane, as complex numbers. A displacement takes the point
//! `z` to `r z + t`, with `|r| = 1`. A twist is `(ω, vx, vy)`, where `(vx, vy)` is the velocity of the point
//! at the origin.

use super::path::{Path, PlanarPath};
use super::subgroup::{LocalTwist, Subgroup};
use super::{JointDisplacement, MotionType, SubspaceKind};
use crate::numbers::{Joint, Over, Plane, PlaneOver};
use crate::numeric::angle::{sinc, unit};
use nalgebra::{Complex, Rotation3, Vector3};

/// The planar subgroup.
pub struct Planar;

/// A displacement of the plane: `z ↦ rotation · z + translation`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarDisplacement<T = Complex<f64>> {
    /// The rotation, a unit complex number `e(angle)`.
    pub rotation: T,
    /// The translation, metres.
    pub translation: T,
}

impl<T: Plane> PlanarDisplacement<T> {
    /// The rotation about a point, in metres, by a unit complex number `e(angle)`.
    #[inline]
    pub fn about<Z: Plane>(point: Z, rotation: T) -> Self
    where
        T: PlaneOver<Z>,
    {
        Self { rotation, translation: T::from_constant(point) - rotation * point }
    }

    /// The image of the point `z`, in metres.
    #[inline]
    pub fn apply<Z: Plane>(&self, z: Z) -> T
    where
        T: PlaneOver<Z>,
    {
        self.rotation * z + self.translation
    }

    /// The product `self · other`: `other` is applied to points first.
    #[inline]
    #[must_use]
    pub fn after(&self, other: &Self) -> Self {
        Self {
            rotation: self.rotation * other.rotation,
            translation: self.rotation * other.translation + self.translation,
        }
    }

    /// The inverse displacement.
    #[inline]
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conj();
        Self { rotation, translation: -(rotation * self.translation) }
    }
}

/// A one-parameter planar motion that another subspace may share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarMotion<Z = Complex<f64>> {
    /// Rotation about the frame's origin.
    Rotation,
    /// Translation in the plane, by this vector for a unit of displacement. It is a unit complex number, or a shorter one
    /// if the motion also has a part along the plane's normal, which is a height.
    Translation(Z),
}

impl<Z: Plane> PlanarMotion<Z> {
    /// The product `v · exp(I τ)`.
    #[inline(always)]
    pub fn after<T: Over<Z::Real>>(
        &self,
        v: &PlanarDisplacement<T::Plane>,
        tau: T::Joint,
    ) -> PlanarDisplacement<T::Plane> {
        let &PlanarDisplacement { rotation, translation } = v;
        match *self {
            Self::Rotation => PlanarDisplacement { rotation: rotation * tau.unit(), translation },
            Self::Translation(along) => PlanarDisplacement {
                rotation,
                translation: translation + (rotation * along).scaled(tau.number()),
            },
        }
    }

    /// The product `exp(I τ) · b`.
    #[inline(always)]
    pub fn before<T: Over<Z::Real>>(
        &self,
        b: &PlanarDisplacement<T::Plane>,
        tau: T::Joint,
    ) -> PlanarDisplacement<T::Plane> {
        let &PlanarDisplacement { rotation, translation } = b;
        match *self {
            Self::Rotation => {
                let e = tau.unit();
                PlanarDisplacement { rotation: e * rotation, translation: e * translation }
            }
            Self::Translation(along) => {
                let along = T::Plane::from_constant(along);
                let translation = translation + along.scaled(tau.number());
                PlanarDisplacement { rotation, translation }
            }
        }
    }
}

impl PlanarDisplacement {
    /// The displacement that leaves every point where it is.
    pub const IDENTITY: Self =
        Self { rotation: Complex::new(1.0, 0.0), translation: Complex::new(0.0, 0.0) };

    /// The translation by a vector, in metres.
    #[inline]
    pub fn translation(translation: Complex<f64>) -> Self {
        Self { rotation: Complex::new(1.0, 0.0), translation }
    }

    /// The displacement along a joint's screw at home, which is a rotation of angular velocity ±1 or a unit
    /// translation.
    #[inline]
    pub fn along_screw(screw: &LocalTwist, displacement: JointDisplacement) -> Self {
        if screw.x == 0.0 {
            return Self::along_slider(screw, displacement);
        }
        Self::along_rotation(screw, displacement.unit_direction())
    }

    /// The displacement along a slider's screw at home, which is a unit translation.
    #[inline(always)]
    pub fn along_slider(screw: &LocalTwist, displacement: JointDisplacement) -> Self {
        Self::translation(linear(screw) * displacement.value())
    }

    /// The displacement along a joint's screw at home that is a rotation of angular velocity ±1, by a unit complex number.
    #[inline(always)]
    pub fn along_rotation(screw: &LocalTwist, rotation: Complex<f64>) -> Self {
        // v = -i ω p, with ω = ±1.
        let point = quarter(linear(screw)) * screw.x;
        Self::about(point, if screw.x < 0.0 { rotation.conj() } else { rotation })
    }
}

/// The linear part `(vx, vy)` of a planar twist.
#[inline]
pub fn linear(twist: &LocalTwist) -> Complex<f64> {
    Complex::new(twist.y, twist.z)
}

/// The planar twist with these angular and linear parts.
#[inline]
pub fn angular_and_linear(omega: f64, v: Complex<f64>) -> LocalTwist {
    LocalTwist::new(omega, v.re, v.im)
}

/// A vector of the plane rotated by +π/2.
#[inline]
pub fn quarter(z: Complex<f64>) -> Complex<f64> {
    Complex::new(-z.im, z.re)
}

/// The translation of the exponential of `(ω, v)` is this factor times `v`: `(e(ω) - 1) / (i ω)`.
fn translation_factor(omega: f64) -> Complex<f64> {
    let half = sinc(0.5 * omega);
    Complex::new(sinc(omega), 0.5 * omega * half * half)
}

impl Subgroup for Planar {
    type Displacement = PlanarDisplacement;
    type Intersection = PlanarMotion;

    const KIND: SubspaceKind = SubspaceKind::Planar;
    const DIMENSION: usize = 3;
    const COMMUTES: bool = false;

    #[inline]
    fn product(first: &PlanarDisplacement, second: &PlanarDisplacement) -> PlanarDisplacement {
        first.after(second)
    }

    #[inline]
    fn inverse(g: &PlanarDisplacement) -> PlanarDisplacement {
        g.inverse()
    }

    fn exponential(twist: &LocalTwist) -> PlanarDisplacement {
        let translation = translation_factor(twist.x) * linear(twist);
        PlanarDisplacement { rotation: unit(twist.x), translation }
    }

    fn logarithm(g: &PlanarDisplacement) -> LocalTwist {
        let omega = g.rotation.arg();
        angular_and_linear(omega, g.translation / translation_factor(omega))
    }

    fn first_order(twist: &LocalTwist) -> PlanarDisplacement {
        PlanarDisplacement { rotation: unit(twist.x), translation: linear(twist) }
    }

    #[inline]
    fn adjoint(g: &PlanarDisplacement, twist: &LocalTwist) -> LocalTwist {
        let v = g.rotation * linear(twist) - quarter(g.translation) * twist.x;
        angular_and_linear(twist.x, v)
    }

    #[inline]
    fn adjoint_of_inverse(g: &PlanarDisplacement, twist: &LocalTwist) -> LocalTwist {
        Self::adjoint(&g.inverse(), twist)
    }

    #[inline]
    fn bracket(a: &LocalTwist, b: &LocalTwist) -> LocalTwist {
        angular_and_linear(0.0, quarter(linear(b)) * a.x - quarter(linear(a)) * b.x)
    }

    #[inline]
    fn act(g: &PlanarDisplacement, point: &Vector3<f64>) -> Vector3<f64> {
        let z = g.apply(Complex::new(point.x, point.y));
        Vector3::new(z.re, z.im, point.z)
    }

    fn rotation_and_translation(g: &PlanarDisplacement) -> (Rotation3<f64>, Vector3<f64>) {
        let rotation = Rotation3::from_axis_angle(&Vector3::z_axis(), g.rotation.arg());
        (rotation, Vector3::new(g.translation.re, g.translation.im, 0.0))
    }

    fn embed(twist: &LocalTwist) -> [Vector3<f64>; 2] {
        [Vector3::z() * twist.x, Vector3::new(twist.y, twist.z, 0.0)]
    }

    fn is_translation(twist: &LocalTwist) -> bool {
        twist.x == 0.0
    }

    fn size(g: &PlanarDisplacement) -> f64 {
        g.translation.norm()
    }

    fn motion(direction: &Vector3<f64>, motion: MotionType) -> PlanarMotion {
        match motion {
            MotionType::Rotation => PlanarMotion::Rotation,
            MotionType::Translation => {
                PlanarMotion::Translation(Complex::new(direction.x, direction.y))
            }
        }
    }

    #[inline]
    fn unit_twist(motion: &PlanarMotion) -> LocalTwist {
        match motion {
            PlanarMotion::Rotation => LocalTwist::x(),
            PlanarMotion::Translation(along) => angular_and_linear(0.0, *along),
        }
    }

    fn complement(motion: &PlanarMotion) -> Vec<LocalTwist> {
        match motion {
            PlanarMotion::Rotation => vec![LocalTwist::y(), LocalTwist::z()],
            PlanarMotion::Translation(along) => {
                vec![LocalTwist::x(), angular_and_linear(0.0, quarter(*along) / along.norm())]
            }
        }
    }

    fn path(motion: &PlanarMotion, b: &PlanarDisplacement) -> Path {
        Path::Planar(match motion {
            PlanarMotion::Rotation => PlanarPath::Rotation { start: *b },
            PlanarMotion::Translation(along) => PlanarPath::Translation { start: *b, rate: *along },
        })
    }
}
