//! The two factors of a displacement of the platform `g = v · b`, in closed form.
//!
//! A point or a direction that `b` keeps fixed, or moves in a known way, is moved by `g` as by `v`. That
//! gives `v`, and then `b = v⁻¹ g`. No step takes the angle of a rotation in space, which is ambiguous at
//! 180 degrees.

use super::Task;
use super::displacement::{cylindrical, planar};
use crate::group::{Displacement, Subspace, SubspaceKind};
use crate::numeric::angle::{sin_cos, unit};
use nalgebra::{Complex, Isometry3, Matrix3, Vector3};

impl Task {
    /// Displacements `v` and `b` with `v · b = g`, where `g` is in the motion `A · B`. They are unique up to a
    /// displacement along the intersection motion. For any other `g`, the product of the two is not `g`.
    pub(crate) fn factors(&self, g: &Isometry3<f64>) -> [Displacement; 2] {
        let v = if self.intersection_point.is_some() {
            self.lower_factor_by_rotation(g)
        } else {
            self.lower_factor_by_translation(g)
        };
        let b = self.upper.local(&(self.lower.isometry(&v).inverse() * g));
        [v, b]
    }

    /// The factor `v` where the intersection motion is a rotation. The upper frame's origin is on its axis.
    fn lower_factor_by_rotation(&self, g: &Isometry3<f64>) -> Displacement {
        let (lower, point) = (&self.lower, &self.upper.origin);
        match lower.kind {
            // `b` moves that point along the axis of I, or in a plane across it.
            SubspaceKind::Planar | SubspaceKind::TranslationalPlane => {
                let moved = lower.direction(&(g * point - point));
                planar(Complex::new(1.0, 0.0), moved.x, moved.y)
            }
            SubspaceKind::Cylindrical => cylindrical(0.0, lower.direction(&(g * point - point)).z),
            SubspaceKind::Spherical => {
                let (before, after) = match self.upper.kind {
                    // `b` keeps the centre of the upper sphere fixed.
                    SubspaceKind::Spherical => (lower.point(point), lower.point(&(g * point))),
                    // `b` keeps the direction of the axis fixed.
                    SubspaceKind::Planar
                    | SubspaceKind::Cylindrical
                    | SubspaceKind::TranslationalPlane => {
                        let axis = self.direction.into_inner();
                        (lower.direction(&axis), lower.direction(&(g.rotation * axis)))
                    }
                };
                // At home it is along the third direction or opposite to it.
                let angles = super::pose::tilt_angles(&(after * before.z.signum()));
                Displacement::Spherical(super::displacement::tilt(angles.map(sin_cos)))
            }
        }
    }

    /// The factor `v` where the intersection motion is a translation: the rotation first, then the part of the
    /// displacement of the upper frame's origin that `b` does not make.
    fn lower_factor_by_translation(&self, g: &Isometry3<f64>) -> Displacement {
        let (lower, upper) = (&self.lower, &self.upper);
        let rotation = self.rotation_of_lower_factor(g);
        let turned = |p: &Vector3<f64>| {
            let z = rotation * Complex::new(p.x, p.y);
            Vector3::new(z.re, z.im, p.z)
        };
        let moved = lower.point(&(g * upper.origin)) - turned(&lower.point(&upper.origin));
        // The direction, other than that of the intersection motion, in which `b` moves it.
        let across = turned(&lower.direction(&upper.axes.column(1).into_owned()));
        let by_upper = match upper.kind {
            SubspaceKind::Planar | SubspaceKind::TranslationalPlane => {
                across * if across.z == 0.0 { 0.0 } else { moved.z / across.z }
            }
            SubspaceKind::Spherical | SubspaceKind::Cylindrical => Vector3::zeros(),
        };
        match lower.kind {
            SubspaceKind::Planar | SubspaceKind::Spherical => {
                planar(rotation, moved.x - by_upper.x, moved.y - by_upper.y)
            }
            // The plane of `b` holds the axis: across it, `b` alone moves.
            SubspaceKind::Cylindrical => cylindrical(rotation.arg(), moved.z),
            SubspaceKind::TranslationalPlane => Displacement::Translational(Complex::new(
                moved.x - by_upper.x,
                moved.y - by_upper.y,
            )),
        }
    }

    /// The rotation of `v` about the lower frame's third direction, where the intersection motion is a translation.
    fn rotation_of_lower_factor(&self, g: &Isometry3<f64>) -> Complex<f64> {
        use SubspaceKind::{Cylindrical, Planar, Spherical, TranslationalPlane};
        let (lower, upper) = (&self.lower, &self.upper);
        let (before, after) = match (lower.kind, upper.kind) {
            (TranslationalPlane, _) => return Complex::new(1.0, 0.0),
            (_, TranslationalPlane) => {
                return about_third(&lower.rotation(g));
            }
            // Parallel axes: the upper one moves on a circle about the lower one.
            (Cylindrical, Cylindrical) => {
                (lower.point(&upper.origin), lower.point(&(g * upper.origin)))
            }
            // The upper axis or normal keeps its direction in `b`.
            (Planar | Spherical | Cylindrical, Planar | Spherical | Cylindrical) => {
                let axis = upper.axes.column(2).into_owned();
                (lower.direction(&axis), lower.direction(&(g.rotation * axis)))
            }
        };
        normalised(Complex::new(after.x, after.y) * Complex::new(before.x, -before.y))
    }
}

impl Subspace {
    /// The matrix of a displacement's rotation in this frame.
    fn rotation(&self, g: &Isometry3<f64>) -> Matrix3<f64> {
        self.axes.tr_mul(&(g.rotation.to_rotation_matrix().into_inner() * self.axes))
    }

    /// A displacement of this subspace in its own frame, from base coordinates. Of any other displacement, it
    /// is the part that is in the subspace.
    fn local(&self, g: &Isometry3<f64>) -> Displacement {
        let rotation = self.rotation(g);
        let moved = self.point(&(g * self.origin));
        match self.kind {
            SubspaceKind::Planar => planar(about_third(&rotation), moved.x, moved.y),
            SubspaceKind::Spherical => Displacement::Spherical(rotation),
            SubspaceKind::Cylindrical => cylindrical(about_third(&rotation).arg(), moved.z),
            SubspaceKind::TranslationalPlane => {
                Displacement::Translational(Complex::new(moved.x, moved.y))
            }
        }
    }
}

/// The rotation about the third direction that is nearest to a rotation matrix.
fn about_third(r: &Matrix3<f64>) -> Complex<f64> {
    normalised(Complex::new(r[(0, 0)] + r[(1, 1)], r[(1, 0)] - r[(0, 1)]))
}

/// The unit vector in the direction of `z`; the identity rotation for zero.
fn normalised(z: Complex<f64>) -> Complex<f64> {
    let length = z.norm();
    if length > 0.0 { z / length } else { unit(0.0) }
}
