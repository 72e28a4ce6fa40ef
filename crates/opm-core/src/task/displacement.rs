//! The displacement of a section from its coordinates.

use crate::group::{
    CylindricalDisplacement, Displacement, IdentityDisplacement, MotionType, PlanarDisplacement,
    SubspaceKind,
};
use crate::mechanism::OrientationCoordinates;
use crate::numbers::{Plane, Real, Rotation, Space};
use crate::numeric::angle::unit;
use nalgebra::Matrix3;

/// What determines the coordinates of a section: its subspace, and the intersection motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Form {
    pub kind: SubspaceKind,
    /// `None` where the two subspaces share the identity alone.
    pub shared: Option<MotionType>,
    /// The angles of its orientation, if it has one.
    pub angles: OrientationCoordinates,
}

/// The values of a section's coordinates, and those at home; zeros beyond the last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SectionValues {
    pub at: [f64; 3],
    pub home: [f64; 3],
}

impl SectionValues {
    /// The coordinates less those at home.
    #[inline(always)]
    pub fn less_home(&self) -> [f64; 3] {
        let Self { at, home } = self;
        [at[0] - home[0], at[1] - home[1], at[2] - home[2]]
    }
}

/// The angles whose unit vectors [`lower_displacement`] needs; `None` where it needs none. Those of an
/// orientation are absolute, others are measured from home.
#[inline(always)]
pub(crate) fn lower_angles(form: Form, values: SectionValues) -> Option<[f64; 3]> {
    let SectionValues { at, home } = values;
    let q = |i: usize| at[i] - home[i];
    match (form.kind, form.shared) {
        (SubspaceKind::Planar, Some(MotionType::Translation) | None) => Some([q(2), 0.0, 0.0]),
        (SubspaceKind::Spherical, Some(_)) => Some([q(0), q(1), 0.0]),
        (SubspaceKind::Spherical, None) => Some(form.angles.to_factors(at)),
        (SubspaceKind::Planar, Some(MotionType::Rotation))
        | (
            SubspaceKind::Identity
            | SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace,
            _,
        ) => None,
    }
}

/// The angles whose unit vectors [`upper_displacement`] needs, in the same way.
#[inline(always)]
pub(crate) fn upper_angles(form: Form, values: SectionValues) -> Option<[f64; 3]> {
    let SectionValues { at, home } = values;
    let q = |i: usize| at[i] - home[i];
    match (form.kind, form.shared) {
        (SubspaceKind::Planar, Some(MotionType::Rotation) | None) => Some([q(2), 0.0, 0.0]),
        (SubspaceKind::Planar, Some(MotionType::Translation)) => Some([q(1), 0.0, 0.0]),
        (SubspaceKind::Spherical, _) => Some(form.angles.to_factors(at)),
        (
            SubspaceKind::Identity
            | SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace,
            _,
        ) => None,
    }
}

/// The displacement `v` from its coordinates less those at home, and from the unit vectors of [`lower_angles`]; of the angles
/// of an orientation, that orientation. Where `form` is a constant, this is straight-line arithmetic.
#[inline(always)]
pub(crate) fn lower_displacement<T: Real>(
    form: Form,
    q: [T; 3],
    units: [T::Plane; 3],
) -> Displacement<T> {
    let none = T::constant(0.0);
    match (form.kind, form.shared) {
        (SubspaceKind::Planar, Some(MotionType::Rotation)) => {
            planar(T::Plane::new(T::constant(1.0), none), q[0], q[1])
        }
        (SubspaceKind::Spherical, Some(_)) => {
            Displacement::Spherical(tilt::<T>([units[0], units[1]]))
        }
        (SubspaceKind::Cylindrical, Some(MotionType::Rotation)) => cylindrical(none, q[0]),
        (kind, _) => alone(Form { kind, ..form }, q, units),
    }
}

/// The displacement `b` from its coordinates less those at home, and from the unit vectors of [`upper_angles`]; of the angles
/// of an orientation, that orientation.
#[inline(always)]
pub(crate) fn upper_displacement<T: Real>(
    form: Form,
    q: [T; 3],
    units: [T::Plane; 3],
) -> Displacement<T> {
    let none = T::constant(0.0);
    match (form.kind, form.shared) {
        (SubspaceKind::Planar, Some(MotionType::Translation)) => planar(units[0], none, q[0]),
        (SubspaceKind::Cylindrical, Some(MotionType::Translation)) => cylindrical(q[0], none),
        (SubspaceKind::TranslationalPlane, Some(_)) => {
            Displacement::Translational(T::Plane::new(none, q[0]))
        }
        (SubspaceKind::TranslationalSpace, Some(_)) => {
            Displacement::Spatial(T::Space::new(q[0], q[1], none))
        }
        (kind, _) => alone(Form { kind, ..form }, q, units),
    }
}

/// The displacement of a section that has all coordinates of its subspace.
#[inline(always)]
fn alone<T: Real>(form: Form, q: [T; 3], units: [T::Plane; 3]) -> Displacement<T> {
    match form.kind {
        SubspaceKind::Identity => Displacement::Identity(IdentityDisplacement),
        SubspaceKind::Planar => planar(units[0], q[0], q[1]),
        SubspaceKind::Spherical => Displacement::Spherical(orientation_of::<T>(form.angles, units)),
        SubspaceKind::Cylindrical => cylindrical(q[0], q[1]),
        SubspaceKind::TranslationalPlane => Displacement::Translational(T::Plane::new(q[0], q[1])),
        SubspaceKind::TranslationalSpace => Displacement::Spatial(T::Space::new(q[0], q[1], q[2])),
    }
}

/// The rotation `Rx(mu) Ry(nu)`, from the angles' unit vectors.
#[inline(always)]
pub(super) fn tilt<T: Real>([mu, nu]: [T::Plane; 2]) -> T::Rotation {
    let (cm, sm, cn, sn) = (mu.re(), mu.im(), nu.re(), nu.im());
    let none = T::constant(0.0);
    T::Rotation::from_rows([[cn, none, sn], [sm * sn, cm, -sm * cn], [-cm * sn, sm, cm * cn]])
}

/// The orientation with these angles, from the unit vectors of its
/// [factors](OrientationCoordinates::to_factors).
#[inline(always)]
pub(crate) fn orientation_of<T: Real>(
    angles: OrientationCoordinates,
    factors: [T::Plane; 3],
) -> T::Rotation {
    match angles {
        OrientationCoordinates::EulerAngles | OrientationCoordinates::TiltTorsion => {
            euler_of::<T>(factors)
        }
        OrientationCoordinates::RollPitchYaw => yaw_pitch_roll_of::<T>(factors),
    }
}

/// The orientation with three angles of a kind.
pub(crate) fn orientation(angles: OrientationCoordinates, at: [f64; 3]) -> Matrix3<f64> {
    orientation_of::<f64>(angles, angles.to_factors(at).map(unit))
}

/// The rotation `Rz(zeta) Ry(xi) Rz(psi)`.
#[inline]
pub fn euler(zeta: f64, xi: f64, psi: f64) -> Matrix3<f64> {
    euler_of::<f64>([zeta, xi, psi].map(unit))
}

/// The rotation `Rz(zeta) Ry(xi) Rz(psi)`, from the angles' unit vectors.
#[inline(always)]
fn euler_of<T: Real>([zeta, xi, psi]: [T::Plane; 3]) -> T::Rotation {
    let ([cz, sz], [cx, sx]) = ([zeta.re(), zeta.im()], [xi.re(), xi.im()]);
    let [cp, sp] = [psi.re(), psi.im()];
    let (level, across) = (cz * cx, sz * cx);
    T::Rotation::from_rows([
        [T::products([level, cp], [-sz, sp]), T::products([-level, sp], [-sz, cp]), cz * sx],
        [T::products([across, cp], [cz, sp]), T::products([-across, sp], [cz, cp]), sz * sx],
        [-sx * cp, sx * sp, cx],
    ])
}

/// The rotation `Rz(yaw) Ry(pitch) Rx(roll)`, from the angles' unit vectors.
#[inline(always)]
fn yaw_pitch_roll_of<T: Real>([yaw, pitch, roll]: [T::Plane; 3]) -> T::Rotation {
    let ([cy, sy], [cp, sp]) = ([yaw.re(), yaw.im()], [pitch.re(), pitch.im()]);
    let [cr, sr] = [roll.re(), roll.im()];
    let (along, across) = (cy * sp, sy * sp);
    T::Rotation::from_rows([
        [cy * cp, T::products([along, sr], [-sy, cr]), T::products([along, cr], [sy, sr])],
        [sy * cp, T::products([across, sr], [cy, cr]), T::products([across, cr], [-cy, sr])],
        [-sp, cp * sr, cp * cr],
    ])
}

#[inline(always)]
pub(super) fn planar<T: Real>(rotation: T::Plane, x: T, y: T) -> Displacement<T> {
    Displacement::Planar(PlanarDisplacement { rotation, translation: T::Plane::new(x, y) })
}

#[inline(always)]
pub(super) fn cylindrical<T: Real>(angle: T, advance: T) -> Displacement<T> {
    Displacement::Cylindrical(CylindricalDisplacement { angle, advance })
}
