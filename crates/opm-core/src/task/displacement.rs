//! The displacement of a section from its coordinates.

use crate::group::{
    CylindricalDisplacement, Displacement, IdentityDisplacement, MotionType, PlanarDisplacement,
    SubspaceKind,
};
use crate::mechanism::OrientationCoordinates;
use crate::numeric::angle::sin_cos;
use nalgebra::{Complex, Matrix3, Vector3};

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

/// The angles whose sines and cosines [`lower_displacement`] needs; `None` where it needs none. Euler angles are
/// absolute, others are measured from home.
#[inline(always)]
pub(crate) fn lower_angles(form: Form, values: SectionValues) -> Option<[f64; 3]> {
    let SectionValues { at, home } = values;
    let q = |i: usize| at[i] - home[i];
    match (form.kind, form.shared) {
        (SubspaceKind::Planar, Some(MotionType::Translation) | None) => Some([q(2), 0.0, 0.0]),
        (SubspaceKind::Spherical, Some(_)) => Some([q(0), q(1), 0.0]),
        (SubspaceKind::Spherical, None) => Some(form.angles.to_euler(at)),
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

/// The angles whose sines and cosines [`upper_displacement`] needs, in the same way.
#[inline(always)]
pub(crate) fn upper_angles(form: Form, values: SectionValues) -> Option<[f64; 3]> {
    let SectionValues { at, home } = values;
    let q = |i: usize| at[i] - home[i];
    match (form.kind, form.shared) {
        (SubspaceKind::Planar, Some(MotionType::Rotation) | None) => Some([q(2), 0.0, 0.0]),
        (SubspaceKind::Planar, Some(MotionType::Translation)) => Some([q(1), 0.0, 0.0]),
        (SubspaceKind::Spherical, _) => Some(form.angles.to_euler(at)),
        (
            SubspaceKind::Identity
            | SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace,
            _,
        ) => None,
    }
}

/// The displacement `v` from its coordinates, and from the sines and cosines of [`lower_angles`]; of Euler angles, the
/// orientation. Where `form` is a constant, this is straight-line arithmetic.
#[inline(always)]
pub(crate) fn lower_displacement(
    form: Form,
    values: SectionValues,
    sines: [(f64, f64); 3],
) -> Displacement {
    let SectionValues { at, home } = values;
    let q = |i: usize| at[i] - home[i];
    match (form.kind, form.shared) {
        (SubspaceKind::Identity, _) => Displacement::Identity(IdentityDisplacement),
        (SubspaceKind::Planar, Some(MotionType::Rotation)) => {
            planar(Complex::new(1.0, 0.0), q(0), q(1))
        }
        (SubspaceKind::Planar, Some(MotionType::Translation) | None) => {
            planar(unit_of(sines[0]), q(0), q(1))
        }
        (SubspaceKind::Spherical, Some(_)) => Displacement::Spherical(tilt([sines[0], sines[1]])),
        (SubspaceKind::Spherical, None) => Displacement::Spherical(euler_of(sines)),
        (SubspaceKind::Cylindrical, Some(MotionType::Rotation)) => cylindrical(0.0, q(0)),
        (SubspaceKind::Cylindrical, Some(MotionType::Translation) | None) => {
            cylindrical(q(0), q(1))
        }
        (SubspaceKind::TranslationalPlane, _) => {
            Displacement::Translational(Complex::new(q(0), q(1)))
        }
        (SubspaceKind::TranslationalSpace, _) => {
            Displacement::Spatial(Vector3::new(q(0), q(1), q(2)))
        }
    }
}

/// The displacement `b` from its coordinates, and from the sines and cosines of [`upper_angles`]; of Euler angles, the
/// orientation.
#[inline(always)]
pub(crate) fn upper_displacement(
    form: Form,
    values: SectionValues,
    sines: [(f64, f64); 3],
) -> Displacement {
    let SectionValues { at, home } = values;
    let q = |i: usize| at[i] - home[i];
    match (form.kind, form.shared) {
        (SubspaceKind::Identity, _) => Displacement::Identity(IdentityDisplacement),
        (SubspaceKind::Spherical, _) => Displacement::Spherical(euler_of(sines)),
        (SubspaceKind::Planar, Some(MotionType::Rotation) | None) => {
            planar(unit_of(sines[0]), q(0), q(1))
        }
        (SubspaceKind::Planar, Some(MotionType::Translation)) => {
            planar(unit_of(sines[0]), 0.0, q(0))
        }
        (SubspaceKind::Cylindrical, Some(MotionType::Rotation) | None) => cylindrical(q(0), q(1)),
        (SubspaceKind::Cylindrical, Some(MotionType::Translation)) => cylindrical(q(0), 0.0),
        (SubspaceKind::TranslationalPlane, Some(_)) => {
            Displacement::Translational(Complex::new(0.0, q(0)))
        }
        (SubspaceKind::TranslationalPlane, None) => {
            Displacement::Translational(Complex::new(q(0), q(1)))
        }
        (SubspaceKind::TranslationalSpace, Some(_)) => {
            Displacement::Spatial(Vector3::new(q(0), q(1), 0.0))
        }
        (SubspaceKind::TranslationalSpace, None) => {
            Displacement::Spatial(Vector3::new(q(0), q(1), q(2)))
        }
    }
}

#[inline(always)]
fn unit_of((sin, cos): (f64, f64)) -> Complex<f64> {
    Complex::new(cos, sin)
}

/// The rotation `Rx(mu) Ry(nu)`, from the angles' sines and cosines.
#[inline(always)]
pub(super) fn tilt([(sm, cm), (sn, cn)]: [(f64, f64); 2]) -> Matrix3<f64> {
    Matrix3::new(cn, 0.0, sn, sm * sn, cm, -sm * cn, -cm * sn, sm, cm * cn)
}

/// The rotation `Rz(zeta) Ry(xi) Rz(psi)`.
#[inline]
pub fn euler(zeta: f64, xi: f64, psi: f64) -> Matrix3<f64> {
    euler_of([zeta, xi, psi].map(sin_cos))
}

/// The rotation `Rz(zeta) Ry(xi) Rz(psi)`, from the angles' sines and cosines.
#[inline(always)]
fn euler_of([(sz, cz), (sx, cx), (sp, cp)]: [(f64, f64); 3]) -> Matrix3<f64> {
    Matrix3::new(
        cz * cx * cp - sz * sp,
        -cz * cx * sp - sz * cp,
        cz * sx,
        sz * cx * cp + cz * sp,
        -sz * cx * sp + cz * cp,
        sz * sx,
        -sx * cp,
        sx * sp,
        cx,
    )
}

#[inline]
pub(super) fn planar(rotation: Complex<f64>, x: f64, y: f64) -> Displacement {
    Displacement::Planar(PlanarDisplacement { rotation, translation: Complex::new(x, y) })
}

#[inline]
pub(super) fn cylindrical(angle: f64, advance: f64) -> Displacement {
    Displacement::Cylindrical(CylindricalDisplacement { angle, advance })
}
