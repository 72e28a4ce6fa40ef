//! The connected subgroups of SE(3), and which of them a set of screws generates.

use super::{Basis, Frame, TOLERANCE};
use crate::group::screw::Screw;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, Matrix3, Point3, Unit, Vector3, Vector6};
use std::fmt;

/// Class of a connected Lie subgroup of SE(3), with its geometry in base coordinates.
///
/// An axis or a normal points up ([`UP`]). The point of an axis is the one nearest to the base's
/// origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SubspaceClass {
    /// No motion.
    Identity,
    /// Rotation about a line.
    Rotation {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
        /// A point of the line, metres.
        point: Point3<f64>,
    },
    /// Translation along a line.
    Translation {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
    },
    /// Screw motion of one pitch about a line.
    Helical {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
        /// A point of the line, metres.
        point: Point3<f64>,
        /// Advance, metres a radian, right-handed where positive.
        pitch: f64,
    },
    /// Translations in a plane.
    TranslationalPlane {
        /// Normal of the plane.
        normal: Unit<Vector3<f64>>,
    },
    /// Rotation about a line and translation along it.
    Cylindrical {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
        /// A point of the line, metres.
        point: Point3<f64>,
    },
    /// All translations.
    TranslationalSpace,
    /// Translations in a plane and rotations about its normals.
    Planar {
        /// Normal of the plane.
        normal: Unit<Vector3<f64>>,
    },
    /// Rotations about a point.
    Spherical {
        /// The point, metres.
        centre: Point3<f64>,
    },
    /// Translations perpendicular to a direction and screw motions of one pitch about all its lines.
    PlanarHelical {
        /// The direction.
        axis: Unit<Vector3<f64>>,
        /// Advance, metres a radian, right-handed where positive.
        pitch: f64,
    },
    /// All translations and the rotations about all lines of one direction.
    Schoenflies {
        /// The direction.
        axis: Unit<Vector3<f64>>,
    },
    /// All displacements.
    Full,
}

impl SubspaceClass {
    /// Number of freedoms: 0, 1, 2, 3, 4 or 6.
    pub fn dimension(&self) -> usize {
        match self {
            Self::Identity => 0,
            Self::Rotation { .. } | Self::Translation { .. } | Self::Helical { .. } => 1,
            Self::TranslationalPlane { .. } | Self::Cylindrical { .. } => 2,
            Self::TranslationalSpace
            | Self::Planar { .. }
            | Self::Spherical { .. }
            | Self::PlanarHelical { .. } => 3,
            Self::Schoenflies { .. } => 4,
            Self::Full => 6,
        }
    }

    /// The field's word for it, lower case: `planar`, `spherical`, `translational plane`, ...
    pub fn name(&self) -> &'static str {
        match self {
            Self::Identity => "identity",
            Self::Rotation { .. } => "rotation",
            Self::Translation { .. } => "translation",
            Self::Helical { .. } => "helical",
            Self::TranslationalPlane { .. } => "translational plane",
            Self::Cylindrical { .. } => "cylindrical",
            Self::TranslationalSpace => "translational space",
            Self::Planar { .. } => "planar",
            Self::Spherical { .. } => "spherical",
            Self::PlanarHelical { .. } => "planar helical",
            Self::Schoenflies { .. } => "schoenflies",
            Self::Full => "full",
        }
    }

    /// As many independent screws as it has freedoms; they span its Lie algebra.
    pub fn screws(&self) -> Vec<Screw> {
        let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let origin = Point3::origin();
        match *self {
            Self::Identity => vec![],
            Self::Rotation { axis, point } => vec![Screw::rotation(axis, point)],
            Self::Translation { axis } => vec![Screw::translation(axis)],
            Self::Helical { axis, point, pitch } => vec![Screw::helical(axis, point, pitch)],
            Self::TranslationalPlane { normal } => across(normal).map(Screw::translation).to_vec(),
            Self::Cylindrical { axis, point } => {
                vec![Screw::rotation(axis, point), Screw::translation(axis)]
            }
            Self::TranslationalSpace => [x, y, z].map(Screw::translation).to_vec(),
            Self::Planar { normal } => Self::PlanarHelical { axis: normal, pitch: 0.0 }.screws(),
            Self::Spherical { centre } => [x, y, z].map(|a| Screw::rotation(a, centre)).to_vec(),
            Self::PlanarHelical { axis, pitch } => {
                let [u, v] = across(axis).map(Screw::translation);
                vec![Screw::helical(axis, origin, pitch), u, v]
            }
            Self::Schoenflies { axis } => {
                let [u, v, w] = [x, y, z].map(Screw::translation);
                vec![Screw::rotation(axis, origin), u, v, w]
            }
            Self::Full => [x, y, z]
                .iter()
                .flat_map(|&a| [Screw::rotation(a, origin), Screw::translation(a)])
                .collect(),
        }
    }

    /// A class found in a normalised frame, in base coordinates and metres, its axis pointing up.
    pub(crate) fn restored(&self, frame: &Frame) -> Self {
        let metres = |pitch: f64| pitch * frame.length;
        let place = |axis, point: &Point3<f64>| nearest_origin(axis, frame.restored_point(point));
        match *self {
            Self::Rotation { axis, point } => {
                Self::Rotation { axis: upward(axis), point: place(axis, &point) }
            }
            Self::Translation { axis } => Self::Translation { axis: upward(axis) },
            Self::Helical { axis, point, pitch } => Self::Helical {
                axis: upward(axis),
                point: place(axis, &point),
                pitch: metres(pitch),
            },
            Self::TranslationalPlane { normal } => {
                Self::TranslationalPlane { normal: upward(normal) }
            }
            Self::Cylindrical { axis, point } => {
                Self::Cylindrical { axis: upward(axis), point: place(axis, &point) }
            }
            Self::Planar { normal } => Self::Planar { normal: upward(normal) },
            Self::Spherical { centre } => Self::Spherical { centre: frame.restored_point(&centre) },
            Self::PlanarHelical { axis, pitch } => {
                Self::PlanarHelical { axis: upward(axis), pitch: metres(pitch) }
            }
            Self::Schoenflies { axis } => Self::Schoenflies { axis: upward(axis) },
            Self::Identity | Self::TranslationalSpace | Self::Full => *self,
        }
    }
}

impl SubspaceClass {
    /// The same one-parameter motion, its axis on the side of `hint`.
    pub(crate) fn towards(self, hint: &Vector3<f64>) -> Self {
        let turned = |axis: Unit<Vector3<f64>>| if axis.dot(hint) < 0.0 { -axis } else { axis };
        match self {
            Self::Rotation { axis, point } => Self::Rotation { axis: turned(axis), point },
            Self::Translation { axis } => Self::Translation { axis: turned(axis) },
            Self::Helical { axis, point, pitch } => {
                Self::Helical { axis: turned(axis), point, pitch }
            }
            other => other,
        }
    }
}

impl fmt::Display for SubspaceClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let triple = |v: &Vector3<f64>| {
            // Adding zero turns a rounded -0 into 0.
            let [x, y, z] = [v.x, v.y, v.z].map(|c| (c * 1e6).round() / 1e6 + 0.0);
            format!("({x}, {y}, {z})")
        };
        write!(f, "{}", self.name())?;
        match self {
            Self::Rotation { axis, point } | Self::Cylindrical { axis, point } => {
                write!(f, " about {} through {} m", triple(axis), triple(&point.coords))
            }
            Self::Translation { axis } => write!(f, " along {}", triple(axis)),
            Self::Helical { axis, point, pitch } => {
                let (axis, point) = (triple(axis), triple(&point.coords));
                write!(f, " about {axis} through {point} m, pitch {pitch:.6} m/rad")
            }
            Self::TranslationalPlane { normal } | Self::Planar { normal } => {
                write!(f, " with normal {}", triple(normal))
            }
            Self::Spherical { centre } => write!(f, " about {} m", triple(&centre.coords)),
            Self::PlanarHelical { axis, pitch } => {
                write!(f, " about {}, pitch {pitch:.6} m/rad", triple(axis))
            }
            Self::Schoenflies { axis } => write!(f, " about {}", triple(axis)),
            Self::Identity | Self::TranslationalSpace | Self::Full => Ok(()),
        }
    }
}

/// Two directions perpendicular to one and to each other.
fn across(axis: Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 2] {
    let thin = axis.iamin();
    let u = Unit::new_normalize(axis.cross(&Vector3::ith(thin, 1.0)));
    [u, Unit::new_normalize(axis.cross(&u))]
}

/// What decides which of two opposite directions points up: the one on this vector's side.
///
/// That is the one with positive z, of nearly level directions the one with positive y, and of those
/// nearly along x the one with positive x. "Nearly" so that a small turn of a mechanism turns none of
/// its directions round: along y they do 22 degrees below the level, along x 3 degrees, and level
/// ones 8 degrees from x. Of the directions of usual designs, with all angles multiples of 15 degrees,
/// none is nearer than 0.7 degrees to where that happens, and none in a coordinate plane nearer than
/// 2.8.
pub const UP: [f64; 3] = [0.055, 0.41, 1.0];

/// Whether a direction points up.
pub(crate) fn points_up(direction: &Vector3<f64>) -> bool {
    direction.dot(&Vector3::from(UP)) >= 0.0
}

/// The one of two opposite directions that points up.
pub(crate) fn upward(axis: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if points_up(&axis) { axis } else { -axis }
}

/// The point of a line nearest to the base's origin.
fn nearest_origin(axis: Unit<Vector3<f64>>, point: Point3<f64>) -> Point3<f64> {
    point - axis.into_inner() * axis.dot(&point.coords)
}

/// A group that screws generate, in the normalised frame of the screws.
#[derive(Clone, Debug)]
pub(crate) struct Fit {
    pub class: SubspaceClass,
    /// Of the group's Lie algebra.
    pub basis: Basis,
    /// Largest distance of one of the screws from it.
    pub deviation: f64,
}

/// Which way a set of screws turns.
enum Turning {
    Nowhere,
    About(Unit<Vector3<f64>>),
    Anywhere,
}

/// The group whose Lie algebra is the span of unit normalised screws; `None` if that is not closed.
///
/// Rank and directions of rotation leave one class to consider; its geometry is fitted to the given
/// screws by least squares, and the span is closed exactly if every screw then lies in the group's
/// algebra. (Brackets of a computed basis would tell the same of exact screws; of rounded ones they
/// enlarge the rounding by the inverse of the smallest angle between the screws.)
pub(crate) fn fit(screws: &[Vector6<f64>]) -> Option<Fit> {
    let angular: Vec<Vector3<f64>> = screws.iter().map(|s| s.fixed_rows::<3>(0).into()).collect();
    let linear: Vec<Vector3<f64>> = screws.iter().map(|s| s.fixed_rows::<3>(3).into()).collect();
    let class = match (Basis::span(screws).dimension(), turning(&angular)) {
        (0, _) => SubspaceClass::Identity,
        (1, Turning::Nowhere) => SubspaceClass::Translation { axis: principal(&linear, 0) },
        (2, Turning::Nowhere) => {
            SubspaceClass::TranslationalPlane { normal: principal(&linear, 2) }
        }
        (3, Turning::Nowhere) => SubspaceClass::TranslationalSpace,
        (1, Turning::About(axis)) => {
            let point = line_point(&angular, &linear);
            match pitch(&angular, &linear, axis) {
                0.0 => SubspaceClass::Rotation { axis, point },
                pitch => SubspaceClass::Helical { axis, point, pitch },
            }
        }
        (2, Turning::About(axis)) => {
            SubspaceClass::Cylindrical { axis, point: line_point(&angular, &linear) }
        }
        (3, Turning::About(axis)) => match pitch(&angular, &linear, axis) {
            0.0 => SubspaceClass::Planar { normal: axis },
            pitch => SubspaceClass::PlanarHelical { axis, pitch },
        },
        (4, Turning::About(axis)) => SubspaceClass::Schoenflies { axis },
        (3, Turning::Anywhere) => SubspaceClass::Spherical { centre: centre(&angular, &linear)? },
        (6, _) => SubspaceClass::Full,
        _ => return None,
    };
    let ideal: Vec<_> = class.screws().iter().map(|s| s.to_vector().normalize()).collect();
    let basis = Basis::span(&ideal);
    let deviation = screws.iter().map(|s| basis.residual(s).norm()).fold(0.0, f64::max);
    (deviation <= TOLERANCE).then_some(Fit { class, basis, deviation })
}

fn turning(angular: &[Vector3<f64>]) -> Turning {
    if angular.iter().all(|w| w.norm() <= TOLERANCE) {
        return Turning::Nowhere;
    }
    let axis = principal(angular, 0);
    if angular.iter().all(|w| w.cross(&axis).norm() <= TOLERANCE) {
        Turning::About(axis)
    } else {
        Turning::Anywhere
    }
}

/// Principal direction of a set of vectors: 0 along which they are longest, 2 shortest.
fn principal(vectors: &[Vector3<f64>], which: usize) -> Unit<Vector3<f64>> {
    let svd = Svd::new(DMatrix::from_fn(vectors.len(), 3, |i, j| vectors[i][j]));
    Unit::new_normalize(svd.right.fixed_view::<3, 1>(0, which).into_owned())
}

/// Point `p` nearest to the origin of the common axis of parallel rotations `(ω; p × ω + h ω)`.
fn line_point(angular: &[Vector3<f64>], linear: &[Vector3<f64>]) -> Point3<f64> {
    let weight: f64 = angular.iter().map(Vector3::norm_squared).sum();
    let moment: Vector3<f64> = angular.iter().zip(linear).map(|(w, v)| w.cross(v)).sum();
    Point3::from(moment / weight)
}

/// Common pitch along `axis`; exactly zero if it is within the tolerance.
fn pitch(angular: &[Vector3<f64>], linear: &[Vector3<f64>], axis: Unit<Vector3<f64>>) -> f64 {
    let (mut advance, mut weight) = (0.0, 0.0);
    for (w, v) in angular.iter().zip(linear) {
        advance += axis.dot(w) * axis.dot(v);
        weight += axis.dot(w).powi(2);
    }
    let pitch = advance / weight;
    if pitch.abs() <= TOLERANCE { 0.0 } else { pitch }
}

/// Point `p` that rotations `(ω; p × ω)` have in common.
fn centre(angular: &[Vector3<f64>], linear: &[Vector3<f64>]) -> Option<Point3<f64>> {
    let normal: Matrix3<f64> =
        angular.iter().map(|w| Matrix3::identity() * w.norm_squared() - w * w.transpose()).sum();
    let moment: Vector3<f64> = angular.iter().zip(linear).map(|(w, v)| w.cross(v)).sum();
    Some(Point3::from(normal.cholesky()?.solve(&moment)))
}
