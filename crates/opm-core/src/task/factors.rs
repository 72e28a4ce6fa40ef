//! From a displacement of the platform to its two factors `g = v · b`, in closed form.
//!
//! A point or a direction that `b` leaves where it is, or moves in a known way, is moved by `g` as by `v`:
//! that gives `v`, and `b = v⁻¹ g`. No step takes the angle of a rotation in space, which half turns make
//! ambiguous.

use super::Task;
use super::displacement::{cylindrical, planar};
use crate::group::{Displacement, Subspace, SubspaceKind};
use crate::numeric::angle::{sin_cos, unit};
use nalgebra::{Complex, Isometry3, Matrix3, Vector3};

impl Task {
    /// `v` and `b` with `v · b = g`, up to a share of the intersection motion, where `g` is in the motion.
    /// Elsewhere two displacements whose product is not `g`.
    pub(crate) fn factors(&self, g: &Isometry3<f64>) -> [Displacement; 2] {
        let v = if self.intersection_point.is_some() {
            self.beside_turn(g)
        } else {
            self.beside_slide(g)
        };
        let b = self.upper.local(&(self.lower.isometry(&v).inverse() * g));
        [v, b]
    }

    /// `v` where the intersection motion is a rotation. The upper frame's origin is on its axis.
    fn beside_turn(&self, g: &Isometry3<f64>) -> Displacement {
        let (lower, point) = (&self.lower, &self.upper.origin);
        match lower.kind {
            // `b` moves that point along the axis, or, a plane's, across it.
            SubspaceKind::Planar | SubspaceKind::TranslationalPlane => {
                let moved = lower.direction(&(g * point - point));
                planar(Complex::new(1.0, 0.0), moved.x, moved.y)
            }
            SubspaceKind::Cylindrical => cylindrical(0.0, lower.direction(&(g * point - point)).z),
            SubspaceKind::Spherical => {
                let (before, after) = match self.upper.kind {
                    // Another sphere's centre stays in it.
                    SubspaceKind::Spherical => (lower.point(point), lower.point(&(g * point))),
                    // The axis's direction does.
                    SubspaceKind::Planar
                    | SubspaceKind::Cylindrical
                    | SubspaceKind::TranslationalPlane => {
                        let axis = self.direction.into_inner();
                        (lower.direction(&axis), lower.direction(&(g.rotation * axis)))
                    }
                };
                // Before, it is on the third direction, on either side.
                let angles = super::pose::tilt_angles(&(after * before.z.signum()));
                Displacement::Spherical(super::displacement::tilt(angles.map(sin_cos)))
            }
        }
    }

    /// `v` where the intersection motion is a translation: the rotation first, then what of the upper
    /// frame's origin's way is not `b`'s.
    fn beside_slide(&self, g: &Isometry3<f64>) -> Displacement {
        let (lower, upper) = (&self.lower, &self.upper);
        let turn = self.turn_beside_slide(g);
        let turned = |p: &Vector3<f64>| {
            let z = turn * Complex::new(p.x, p.y);
            Vector3::new(z.re, z.im, p.z)
        };
        let moved = lower.point(&(g * upper.origin)) - turned(&lower.point(&upper.origin));
        // The one direction that `b` moves it in beside the intersection motion's.
        let across = turned(&lower.direction(&upper.axes.column(1).into_owned()));
        let by_upper = match upper.kind {
            SubspaceKind::Planar | SubspaceKind::TranslationalPlane => {
                across * if across.z == 0.0 { 0.0 } else { moved.z / across.z }
            }
            SubspaceKind::Spherical | SubspaceKind::Cylindrical => Vector3::zeros(),
        };
        match lower.kind {
            SubspaceKind::Planar | SubspaceKind::Spherical => {
                planar(turn, moved.x - by_upper.x, moved.y - by_upper.y)
            }
            // The plane of `b` holds the axis: across it, `b` alone moves.
            SubspaceKind::Cylindrical => cylindrical(turn.arg(), moved.z),
            SubspaceKind::TranslationalPlane => Displacement::Translational(Complex::new(
                moved.x - by_upper.x,
                moved.y - by_upper.y,
            )),
        }
    }

    /// The rotation of `v` about the lower frame's third direction, where the intersection motion is a translation.
    fn turn_beside_slide(&self, g: &Isometry3<f64>) -> Complex<f64> {
        use SubspaceKind::{Cylindrical, Planar, Spherical, TranslationalPlane};
        let (lower, upper) = (&self.lower, &self.upper);
        let (before, after) = match (lower.kind, upper.kind) {
            (TranslationalPlane, _) => return Complex::new(1.0, 0.0),
            (_, TranslationalPlane) => {
                return about_third(&lower.rotation(g));
            }
            // Parallel axes: the upper one goes round the lower one.
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

    /// A displacement of this subspace in its own frame, from base coordinates; of any other one what of it
    /// the subspace holds.
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

/// The rotation about the third direction that is nearest to another one.
fn about_third(r: &Matrix3<f64>) -> Complex<f64> {
    normalised(Complex::new(r[(0, 0)] + r[(1, 1)], r[(1, 0)] - r[(0, 1)]))
}

/// With length one; of zero, no rotation.
fn normalised(z: Complex<f64>) -> Complex<f64> {
    let length = z.norm();
    if length > 0.0 { z / length } else { unit(0.0) }
}
