//! The two factors of a displacement of the platform `g = v · b`, in closed form.
//!
//! A point or a direction that `b` keeps fixed, or moves in a known way, is moved by `g` as by `v`. That
//! gives `v`, and then `b = v⁻¹ g`. No step takes the angle of a rotation in space, which is ambiguous at
//! 180 degrees.

use super::displacement::{cylindrical, planar};
use super::{Height, Task};
use crate::group::{Displacement, MotionType, Subspace, SubspaceKind};
use crate::mechanism::leg::Section;
use crate::numeric::angle::unit;
use nalgebra::{Complex, Isometry3, Matrix3, Vector3};

impl Task {
    /// Displacements `v` and `b` with `v · b = g`, where `g` is in the motion `A · B`. They are unique up to a
    /// displacement along the intersection motion. For any other `g`, the product of the two is not `g`.
    ///
    /// With a Schoenflies section, it is `g` that is raised by the height above home that is also given, metres.
    pub(crate) fn factors(&self, g: &Isometry3<f64>) -> ([Displacement; 2], f64) {
        let rise = self.rise_of(g);
        let g = &self.raised(-rise, *g);
        let v = match self.shared() {
            Some(MotionType::Rotation) => self.lower_factor_by_rotation(g),
            Some(MotionType::Translation) => self.lower_factor_by_translation(g),
            None => lower_factor_alone(&self.lower, &self.upper, g),
        };
        let b = local(&self.upper, &(self.lower.isometry(&v).inverse() * g));
        ([v, b], rise)
    }

    /// The height of `g` above home, where the other section does not move a point of its own: the centre of a sphere, or
    /// a point of a cylinder's axis, with which [`Task::factors`] leaves the translation along it to this section.
    fn rise_of(&self, g: &Isometry3<f64>) -> f64 {
        match &self.height {
            None => 0.0,
            Some(Height { section: Section::Lower, up, .. }) => {
                up.dot(&(g * self.upper.origin - self.upper.origin))
            }
            Some(Height { section: Section::Upper, up, .. }) => {
                up.dot(&(self.lower.origin - g.inverse() * self.lower.origin))
            }
        }
    }

    /// The factor `v` where the intersection motion is a rotation. The upper frame's origin is on its axis.
    fn lower_factor_by_rotation(&self, g: &Isometry3<f64>) -> Displacement {
        let (lower, upper, point) = (&self.lower, &self.upper, &self.upper.origin);
        match lower.kind {
            // `b` moves that point along the axis of I, or in a plane across it.
            SubspaceKind::Planar | SubspaceKind::TranslationalPlane => {
                let moved = lower.direction(&(g * point - point));
                planar(Complex::new(1.0, 0.0), moved.x, moved.y)
            }
            SubspaceKind::Cylindrical => cylindrical(0.0, lower.direction(&(g * point - point)).z),
            // They contain no rotation.
            SubspaceKind::Identity | SubspaceKind::TranslationalSpace => lower.kind.identity(),
            SubspaceKind::Spherical => {
                let (before, after) = match upper.kind {
                    // `b` keeps the centre of the upper sphere fixed.
                    SubspaceKind::Spherical => (lower.point(point), lower.point(&(g * point))),
                    // `b` keeps the direction of the axis fixed.
                    SubspaceKind::Identity
                    | SubspaceKind::Planar
                    | SubspaceKind::Cylindrical
                    | SubspaceKind::TranslationalPlane
                    | SubspaceKind::TranslationalSpace => {
                        let axis = upper.axes.column(2).into_owned();
                        (lower.direction(&axis), lower.direction(&(g.rotation * axis)))
                    }
                };
                // At home it is along the third direction or opposite to it.
                let angles = super::pose::tilt_angles(&(after * before.z.signum()));
                Displacement::Spherical(super::displacement::tilt::<f64>(angles.map(unit)))
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
            SubspaceKind::Identity
            | SubspaceKind::Spherical
            | SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalSpace => Vector3::zeros(),
        };
        match lower.kind {
            SubspaceKind::Identity => SubspaceKind::Identity.identity(),
            SubspaceKind::Planar | SubspaceKind::Spherical => {
                planar(rotation, moved.x - by_upper.x, moved.y - by_upper.y)
            }
            // `b` makes every translation along the axis.
            SubspaceKind::Cylindrical => cylindrical(rotation.arg(), 0.0),
            SubspaceKind::TranslationalPlane => Displacement::Translational(Complex::new(
                moved.x - by_upper.x,
                moved.y - by_upper.y,
            )),
            SubspaceKind::TranslationalSpace => Displacement::Spatial(moved - by_upper),
        }
    }

    /// The rotation of `v` about the lower frame's third direction, where the intersection motion is a translation.
    fn rotation_of_lower_factor(&self, g: &Isometry3<f64>) -> Complex<f64> {
        use SubspaceKind::{
            Cylindrical, Identity, Planar, Spherical, TranslationalPlane, TranslationalSpace,
        };
        let (lower, upper) = (&self.lower, &self.upper);
        let (before, after) = match (lower.kind, upper.kind) {
            (Identity | TranslationalPlane | TranslationalSpace, _) => {
                return Complex::new(1.0, 0.0);
            }
            (_, Identity | TranslationalPlane | TranslationalSpace) => {
                return about_third(&rotation(lower, g));
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
        about_the_third(&before, &after)
    }
}

/// The matrix of a displacement's rotation in the frame of a subspace.
fn rotation(frame: &Subspace, g: &Isometry3<f64>) -> Matrix3<f64> {
    frame.axes.tr_mul(&(g.rotation.to_rotation_matrix().into_inner() * frame.axes))
}

/// A displacement of a subspace in its own frame, from base coordinates. Of any other displacement, it is the part
/// that is in the subspace.
fn local(subspace: &Subspace, g: &Isometry3<f64>) -> Displacement {
    let rotation = rotation(subspace, g);
    let moved = subspace.point(&(g * subspace.origin));
    match subspace.kind {
        SubspaceKind::Identity => SubspaceKind::Identity.identity(),
        SubspaceKind::Planar => planar(about_third(&rotation), moved.x, moved.y),
        SubspaceKind::Spherical => Displacement::Spherical(rotation),
        SubspaceKind::Cylindrical => cylindrical(about_third(&rotation).arg(), moved.z),
        SubspaceKind::TranslationalPlane => {
            Displacement::Translational(Complex::new(moved.x, moved.y))
        }
        SubspaceKind::TranslationalSpace => Displacement::Spatial(moved),
    }
}

/// The factor `v` of `g = v · b` in two subspaces that share the identity alone: first the rotation that `b`
/// cannot make, then the part of the displacement of the upper frame's origin that `b` cannot make.
fn lower_factor_alone(lower: &Subspace, upper: &Subspace, g: &Isometry3<f64>) -> Displacement {
    use SubspaceKind::{
        Cylindrical, Identity, Planar, Spherical, TranslationalPlane, TranslationalSpace,
    };
    let by_inverse = || {
        // g⁻¹ = b⁻¹ · v⁻¹: the same problem, with the subspaces exchanged.
        let inverse = g.inverse();
        let b = upper.isometry(&lower_factor_alone(upper, lower, &inverse));
        local(lower, &(b.inverse() * inverse)).inverse()
    };
    let third = |frame: &Subspace| frame.axes.column(2).into_owned();
    let moved = g * upper.origin;
    match (lower.kind, upper.kind) {
        (Identity, _) => SubspaceKind::Identity.identity(),
        // `b` makes no displacement, or no rotation.
        (_, Identity) | (Spherical, TranslationalPlane | TranslationalSpace) => local(lower, g),
        // `b` keeps the centre of the upper sphere.
        (TranslationalPlane, Spherical) => {
            let t = lower.direction(&(moved - upper.origin));
            Displacement::Translational(Complex::new(t.x, t.y))
        }
        (TranslationalSpace, Spherical) => {
            Displacement::Spatial(lower.direction(&(moved - upper.origin)))
        }
        (Cylindrical, Spherical) => {
            let (before, after) = (lower.point(&upper.origin), lower.point(&moved));
            let rotation = about_the_third(&before, &after);
            cylindrical(rotation.arg(), after.z - before.z)
        }
        // `b` moves the upper axis along itself, by a distance that the lower plane cannot make.
        (Planar | TranslationalPlane, Cylindrical) => {
            let axis = third(upper);
            let rotation = if lower.kind == Planar {
                let turned = lower.direction(&(g.rotation * axis));
                about_the_third(&lower.direction(&axis), &turned)
            } else {
                Complex::new(1.0, 0.0)
            };
            let rotated = |p: Vector3<f64>| {
                let z = rotation * Complex::new(p.x, p.y);
                Vector3::new(z.re, z.im, p.z)
            };
            let rest = lower.point(&moved) - rotated(lower.point(&upper.origin));
            let along = rotated(lower.direction(&axis));
            let translation = rest - along * (rest.z / along.z);
            match lower.kind {
                Planar => planar(rotation, translation.x, translation.y),
                _ => Displacement::Translational(Complex::new(translation.x, translation.y)),
            }
        }
        // The upper axis is rotated about the lower one; of its displacement, `b` makes the part along itself.
        (Cylindrical, Cylindrical) => {
            let axis = third(upper);
            let along = lower.direction(&(g.rotation * axis));
            let rotation = about_the_third(&lower.direction(&axis), &along);
            let before = lower.point(&upper.origin);
            let z = rotation * Complex::new(before.x, before.y);
            let rest = lower.point(&moved) - Vector3::new(z.re, z.im, before.z);
            // rest = advance · z + s · along: the component perpendicular to `along` gives the advance.
            let across = Vector3::z() - along * along.z;
            cylindrical(rotation.arg(), rest.dot(&across) / across.norm_squared())
        }
        (Spherical, Cylindrical) | (Cylindrical, Planar | TranslationalPlane) => by_inverse(),
        (Spherical, Planar | Spherical)
        | (Planar, Planar | Spherical | TranslationalPlane | TranslationalSpace)
        | (TranslationalPlane, Planar | TranslationalPlane | TranslationalSpace)
        | (TranslationalSpace, Planar | Cylindrical | TranslationalPlane | TranslationalSpace)
        | (Cylindrical, TranslationalSpace) => {
            unreachable!("these two subspaces always share a motion")
        }
    }
}

/// The rotation about the third direction that takes one vector to another.
fn about_the_third(before: &Vector3<f64>, after: &Vector3<f64>) -> Complex<f64> {
    normalised(Complex::new(after.x, after.y) * Complex::new(before.x, -before.y))
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
