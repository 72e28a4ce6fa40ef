//! The positions of the axis of the intersection motion that a leg allows when all of its lower joints
//! except one are held, and the intersections of two such tracks: two circles or lines in the plane, or two
//! cones about a centre.

use super::condition::{Condition, QUARTER, VERGE, dot};
use crate::chain::Chain;
use crate::chain::planar::PlanarJoint;
use crate::group::{
    Displacement, JointDisplacement, PlanarDisplacement, SubspaceKind, mismatch, rotation_about,
};
use nalgebra::{Complex, Matrix3, Vector3};

/// The possible positions of the axis of a rotation that two subspaces share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Track {
    /// The axis meets the plane at a given distance from a point.
    Circle { centre: Complex<f64>, radius: f64 },
    /// The axis meets the plane on the line `normal · z = offset`.
    Line { normal: Complex<f64>, offset: f64 },
    /// The axis makes a given angle with a direction.
    Cone { axis: Vector3<f64>, cosine: f64 },
}

impl Track {
    /// The track from a condition on `g` that does not change when the intersection motion is applied first;
    /// `None` for other conditions.
    pub fn of_condition(condition: &Condition) -> Option<Self> {
        match *condition {
            Condition::Circle { centre, radius, .. } => Some(Self::Circle { centre, radius }),
            Condition::Line { normal, offset, .. } => Some(Self::Line { normal, offset }),
            Condition::Cone { fixed, cosine, .. } => Some(Self::Cone { axis: fixed, cosine }),
            Condition::CarriedLine { .. } | Condition::Heading { .. } | Condition::Flat { .. } => {
                None
            }
        }
    }

    /// The track of a chain with every joint held except joint number `free`; `None` for chains that have no
    /// such track. `foot` is where the axis meets the plane while the chain is at home, metres.
    pub fn of_chain(
        chain: &Chain,
        free: usize,
        displacements: &[JointDisplacement; 3],
        foot: Complex<f64>,
    ) -> Option<Self> {
        match chain {
            Chain::Rigid | Chain::Part(_) => None,
            Chain::Planar(chain) => {
                let joints = chain.joints();
                let held = |range: std::ops::Range<usize>| {
                    range.fold(PlanarDisplacement::IDENTITY, |g, i| {
                        g.after(&joints[i].displacement(displacements[i]))
                    })
                };
                let (before, after) = (held(0..free), held(free + 1..3));
                let foot = after.apply(foot);
                Some(match joints[free] {
                    PlanarJoint::Revolute { at, .. } => {
                        Self::Circle { centre: before.apply(at), radius: (foot - at).norm() }
                    }
                    PlanarJoint::Prismatic { along } => {
                        let normal = QUARTER * before.rotation * along;
                        Self::Line { normal, offset: dot(normal, before.apply(foot)) }
                    }
                })
            }
            Chain::Spherical(chain) => {
                let axes = chain.axes();
                let held = |range: std::ops::Range<usize>| {
                    range.fold(Matrix3::identity(), |g, i| {
                        g * rotation_about(&axes[i], displacements[i].unit_direction())
                    })
                };
                let axis = held(free + 1..3) * Vector3::z();
                let cosine = axes[free].dot(&axis);
                Some(Self::Cone { axis: held(0..free) * axes[free], cosine })
            }
            Chain::Ball(_)
            | Chain::Cylindrical(_)
            | Chain::Translational(_)
            | Chain::Spatial(_) => None,
        }
    }

    /// The displacements, at most two, that bring the axis to an intersection of two tracks. `None` where the
    /// tracks are concentric or parallel.
    pub fn meetings(&self, other: &Self, size: f64) -> Option<[Option<Displacement>; 2]> {
        match (self, other) {
            (Self::Circle { centre: c, radius: a }, Self::Circle { centre: d, radius: b }) => {
                // On the radical axis, which is perpendicular to the line of the centres.
                let apart = d - c;
                let square = apart.norm_sqr();
                if square <= VERGE * VERGE * size * size {
                    return None;
                }
                let share = 0.5 * (1.0 + (a * a - b * b) / square);
                Some(on_line(c + apart * share, QUARTER * apart / square.sqrt(), *c, *a, size))
            }
            (Self::Circle { centre, radius }, Self::Line { normal, offset })
            | (Self::Line { normal, offset }, Self::Circle { centre, radius }) => {
                let foot = centre + normal * (offset - dot(*normal, *centre));
                Some(on_line(foot, QUARTER * normal, *centre, *radius, size))
            }
            (Self::Line { normal: n, offset: p }, Self::Line { normal: m, offset: q }) => {
                let determinant = n.re * m.im - n.im * m.re;
                if determinant.abs() <= VERGE {
                    return None;
                }
                let z = Complex::new(p * m.im - q * n.im, n.re * q - m.re * p) / determinant;
                Some([Some(translation(z)), None])
            }
            (Self::Cone { axis: a, cosine: p }, Self::Cone { axis: b, cosine: q }) => {
                let (across, cosine) = (a.cross(b), a.dot(b));
                let square = across.norm_squared();
                if square <= VERGE {
                    return None;
                }
                let middle = (a * (p - cosine * q) + b * (q - cosine * p)) / square;
                let left = 1.0 - middle.norm_squared();
                if left < -2.0 * VERGE {
                    return Some([None; 2]);
                }
                let aside = across * (left.max(0.0) / square).sqrt();
                let second = (left > 0.0).then(|| pointing(&(middle - aside)));
                Some([Some(pointing(&(middle + aside))), second])
            }
            (Self::Cone { .. }, Self::Circle { .. } | Self::Line { .. })
            | (Self::Circle { .. } | Self::Line { .. }, Self::Cone { .. }) => {
                mismatch(SubspaceKind::Planar, SubspaceKind::Spherical)
            }
        }
    }
}

/// The translations to the points of a line whose distance from `centre` is `radius`. `foot` is the point
/// of the line nearest to `centre`, and `along` its direction.
fn on_line(
    foot: Complex<f64>,
    along: Complex<f64>,
    centre: Complex<f64>,
    radius: f64,
    size: f64,
) -> [Option<Displacement>; 2] {
    let square = radius * radius - (foot - centre).norm_sqr();
    if square < -2.0 * VERGE * size * size {
        return [None; 2];
    }
    let step = along * square.max(0.0).sqrt();
    let second = (square > 0.0).then(|| translation(foot - step));
    [Some(translation(foot + step)), second]
}

fn translation(z: Complex<f64>) -> Displacement {
    PlanarDisplacement::translation(z).into()
}

/// A rotation that takes the third direction to the direction of `u`.
fn pointing(u: &Vector3<f64>) -> Displacement {
    let u = u.normalize();
    let beside = if u.x.abs() < 0.9 { Vector3::x() } else { Vector3::y() };
    let first = (beside - u * u.dot(&beside)).normalize();
    Displacement::Spherical(Matrix3::from_columns(&[first, u.cross(&first), u]))
}
