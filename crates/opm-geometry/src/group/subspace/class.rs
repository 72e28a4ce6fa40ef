//! The connected subgroups of SE(3), and which of them a set of screws generates.

use super::{Basis, Frame, TOLERANCE};
use crate::group::screw::Screw;
use crate::numeric::svd::Svd;
use nalgebra::{DMatrix, Matrix3, Point3, Unit, Vector3, Vector6};
use std::fmt;

/// A connected Lie subgroup of SE(3), with its geometry in base coordinates.
///
/// An axis or a normal points up (see [`UP`]). The point of an axis is its point nearest to the
/// base's origin.
///
/// ```
/// # extern crate opm_geometry as opm_core;
/// use nalgebra::{Point3, Vector3};
/// use opm_core::group::subspace::SubspaceClass;
///
/// // SE(2) and SO(3) have three dimensions each.
/// let plane = SubspaceClass::Planar { normal: Vector3::z_axis() };
/// let sphere = SubspaceClass::Spherical { centre: Point3::new(0.1, 0.0, 0.2) };
/// assert_eq!((plane.dimension(), plane.name()), (3, "planar"));
/// assert_eq!((sphere.dimension(), sphere.name()), (3, "spherical"));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SubspaceClass {
    /// The trivial group: no motion.
    Identity,
    /// Rotation about a line.
    Rotation {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
        /// The point of the line nearest to the base's origin, metres.
        point: Point3<f64>,
    },
    /// Translation along a line.
    Translation {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
    },
    /// Screw motion of one given pitch about a line.
    Helical {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
        /// The point of the line nearest to the base's origin, metres.
        point: Point3<f64>,
        /// Advance in metres per radian; positive for a right-handed screw.
        pitch: f64,
    },
    /// Translations in all directions of a plane.
    TranslationalPlane {
        /// Normal of the plane.
        normal: Unit<Vector3<f64>>,
    },
    /// Rotation about a line and translation along it.
    Cylindrical {
        /// Direction of the line.
        axis: Unit<Vector3<f64>>,
        /// The point of the line nearest to the base's origin, metres.
        point: Point3<f64>,
    },
    /// All translations of space.
    TranslationalSpace,
    /// Planar motion: translations in a plane and rotations about its normals.
    Planar {
        /// Normal of the plane.
        normal: Unit<Vector3<f64>>,
    },
    /// Spherical motion: all rotations about one point.
    Spherical {
        /// The common point of all axes, metres.
        centre: Point3<f64>,
    },
    /// Translations perpendicular to a direction, and screw motions of one pitch about all lines
    /// along it.
    PlanarHelical {
        /// The direction of the screw axes.
        axis: Unit<Vector3<f64>>,
        /// Advance in metres per radian; positive for a right-handed screw.
        pitch: f64,
    },
    /// Schoenflies motion: all translations, and rotations about all lines of one direction.
    Schoenflies {
        /// The direction of the rotation axes.
        axis: Unit<Vector3<f64>>,
    },
    /// All displacements: SE(3) itself.
    Full,
}

impl SubspaceClass {
    /// The dimension of the group: 0, 1, 2, 3, 4 or 6.
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

    /// The standard name of the group in lower case: `planar`, `spherical`, `translational plane`,
    /// ...
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

    /// Independent screws that span the group's Lie algebra, one per dimension.
    pub fn screws(&self) -> Vec<Screw> {
        let [x, y, z] = [Vector3::x_axis(), Vector3::y_axis(), Vector3::z_axis()];
        let origin = Point3::origin();
        match *self {
            Self::Identity => vec![],
            Self::Rotation { axis, point } => vec![Screw::rotation(axis, point)],
            Self::Translation { axis } => vec![Screw::translation(axis)],
            Self::Helical { axis, point, pitch } => vec![Screw::helical(axis, point, pitch)],
            Self::TranslationalPlane { normal } => {
                perpendiculars(normal).map(Screw::translation).to_vec()
            }
            Self::Cylindrical { axis, point } => {
                vec![Screw::rotation(axis, point), Screw::translation(axis)]
            }
            Self::TranslationalSpace => [x, y, z].map(Screw::translation).to_vec(),
            Self::Planar { normal } => Self::PlanarHelical { axis: normal, pitch: 0.0 }.screws(),
            Self::Spherical { centre } => [x, y, z].map(|a| Screw::rotation(a, centre)).to_vec(),
            Self::PlanarHelical { axis, pitch } => {
                let [u, v] = perpendiculars(axis).map(Screw::translation);
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

    /// Converts a class found in a normalised frame to base coordinates and metres, with its axis
    /// pointing up.
    pub fn restored(&self, frame: &Frame) -> Self {
        let metres = |pitch: f64| pitch * frame.length;
        let on_axis = |axis, point: &Point3<f64>| nearest_origin(axis, frame.restored_point(point));
        match *self {
            Self::Rotation { axis, point } => {
                Self::Rotation { axis: upward(axis), point: on_axis(axis, &point) }
            }
            Self::Translation { axis } => Self::Translation { axis: upward(axis) },
            Self::Helical { axis, point, pitch } => Self::Helical {
                axis: upward(axis),
                point: on_axis(axis, &point),
                pitch: metres(pitch),
            },
            Self::TranslationalPlane { normal } => {
                Self::TranslationalPlane { normal: upward(normal) }
            }
            Self::Cylindrical { axis, point } => {
                Self::Cylindrical { axis: upward(axis), point: on_axis(axis, &point) }
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
    /// The same one-parameter motion, with its axis reversed if it points away from `hint`.
    pub fn towards(self, hint: &Vector3<f64>) -> Self {
        let oriented = |axis: Unit<Vector3<f64>>| if axis.dot(hint) < 0.0 { -axis } else { axis };
        match self {
            Self::Rotation { axis, point } => Self::Rotation { axis: oriented(axis), point },
            Self::Translation { axis } => Self::Translation { axis: oriented(axis) },
            Self::Helical { axis, point, pitch } => {
                Self::Helical { axis: oriented(axis), point, pitch }
            }
            other => other,
        }
    }
}

impl SubspaceClass {
    /// The group in words, with lengths in a unit: its size in metres, and its symbol.
    pub fn in_unit(&self, size: f64, unit: &str) -> String {
        let triple = |v: &Vector3<f64>| {
            // Adding zero turns a rounded -0 into 0.
            let [x, y, z] = [v.x, v.y, v.z].map(|c| (c * 1e6).round() / 1e6 + 0.0);
            format!("({x}, {y}, {z})")
        };
        let place = |point: &Point3<f64>| format!("{} {unit}", triple(&(point.coords / size)));
        let advance = |pitch: &f64| format!("pitch {:.6} {unit}/rad", pitch / size);
        let geometry = match self {
            Self::Rotation { axis, point } | Self::Cylindrical { axis, point } => {
                format!(" about {} through {}", triple(axis), place(point))
            }
            Self::Translation { axis } => format!(" along {}", triple(axis)),
            Self::Helical { axis, point, pitch } => {
                format!(" about {} through {}, {}", triple(axis), place(point), advance(pitch))
            }
            Self::TranslationalPlane { normal } | Self::Planar { normal } => {
                format!(" with normal {}", triple(normal))
            }
            Self::Spherical { centre } => format!(" about {}", place(centre)),
            Self::PlanarHelical { axis, pitch } => {
                format!(" about {}, {}", triple(axis), advance(pitch))
            }
            Self::Schoenflies { axis } => format!(" about {}", triple(axis)),
            Self::Identity | Self::TranslationalSpace | Self::Full => String::new(),
        };
        self.name().to_owned() + &geometry
    }
}

impl fmt::Display for SubspaceClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_unit(1.0, "m"))
    }
}

/// Two unit vectors perpendicular to an axis and to each other.
fn perpendiculars(axis: Unit<Vector3<f64>>) -> [Unit<Vector3<f64>>; 2] {
    let smallest = axis.iamin();
    let u = Unit::new_normalize(axis.cross(&Vector3::ith(smallest, 1.0)));
    [u, Unit::new_normalize(axis.cross(&u))]
}

/// The vector that decides which of two opposite directions points up: the one with a positive component
/// along it.
///
/// That is the direction with positive z; among nearly horizontal directions, the one with positive
/// y; among those nearly along x, the one with positive x. "Nearly" keeps small rotations of a
/// mechanism from reversing its directions. A direction along y is reversed when it points 22
/// degrees below the horizontal, one along x at 3 degrees, and a horizontal one at 8 degrees from
/// x. If all angles of a design are multiples of 15 degrees, no direction is nearer than 0.7
/// degrees to such a reversal, and none in a coordinate plane is nearer than 2.8 degrees.
pub const UP: [f64; 3] = [0.055, 0.41, 1.0];

/// Whether a direction points up (see [`UP`]).
pub fn points_up(direction: &Vector3<f64>) -> bool {
    direction.dot(&Vector3::from(UP)) >= 0.0
}

/// The one of two opposite directions that points up.
pub fn upward(axis: Unit<Vector3<f64>>) -> Unit<Vector3<f64>> {
    if points_up(&axis) { axis } else { -axis }
}

/// The point of a line nearest to the base's origin.
fn nearest_origin(axis: Unit<Vector3<f64>>, point: Point3<f64>) -> Point3<f64> {
    point - axis.into_inner() * axis.dot(&point.coords)
}

/// A group fitted to screws, in the normalised frame of the screws.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The group, with lengths over the characteristic length.
    pub class: SubspaceClass,
    /// Orthonormal basis of the group's Lie algebra.
    pub basis: Basis,
    /// The largest distance of one of the screws from the algebra.
    pub deviation: f64,
}

/// The rotation axes of a set of screws.
enum RotationAxes {
    /// The screws are translations only.
    None,
    /// All axes have this direction.
    Parallel(Unit<Vector3<f64>>),
    /// The axes have several directions.
    Several,
}

/// The group whose Lie algebra is the span of unit normalised screws; `None` if the span is not
/// closed under the bracket.
///
/// The rank and the directions of rotation leave only one candidate class. Its geometry is fitted
/// to the given screws by least squares. The span is closed exactly if every screw then lies in the
/// group's algebra. (Brackets of a computed basis would decide the same for exact screws. For
/// rounded screws they would amplify the rounding by the inverse of the smallest angle between the
/// screws.)
pub fn fit(screws: &[Vector6<f64>]) -> Option<Fit> {
    let angular: Vec<Vector3<f64>> = screws.iter().map(|s| s.fixed_rows::<3>(0).into()).collect();
    let linear: Vec<Vector3<f64>> = screws.iter().map(|s| s.fixed_rows::<3>(3).into()).collect();
    let class = match (Basis::span(screws).dimension(), rotation_axes(&angular)) {
        (0, _) => SubspaceClass::Identity,
        (1, RotationAxes::None) => SubspaceClass::Translation { axis: principal(&linear, 0) },
        (2, RotationAxes::None) => {
            SubspaceClass::TranslationalPlane { normal: principal(&linear, 2) }
        }
        (3, RotationAxes::None) => SubspaceClass::TranslationalSpace,
        (1, RotationAxes::Parallel(axis)) => {
            let point = line_point(&angular, &linear);
            match pitch(&angular, &linear, axis) {
                0.0 => SubspaceClass::Rotation { axis, point },
                pitch => SubspaceClass::Helical { axis, point, pitch },
            }
        }
        (2, RotationAxes::Parallel(axis)) => {
            SubspaceClass::Cylindrical { axis, point: line_point(&angular, &linear) }
        }
        (3, RotationAxes::Parallel(axis)) => match pitch(&angular, &linear, axis) {
            0.0 => SubspaceClass::Planar { normal: axis },
            pitch => SubspaceClass::PlanarHelical { axis, pitch },
        },
        (4, RotationAxes::Parallel(axis)) => SubspaceClass::Schoenflies { axis },
        (3, RotationAxes::Several) => {
            SubspaceClass::Spherical { centre: centre(&angular, &linear)? }
        }
        (6, _) => SubspaceClass::Full,
        _ => return None,
    };
    let ideal: Vec<_> = class.screws().iter().map(|s| s.to_vector().normalize()).collect();
    let basis = Basis::span(&ideal);
    let deviation = screws.iter().map(|s| basis.residual(s).norm()).fold(0.0, f64::max);
    (deviation <= TOLERANCE).then_some(Fit { class, basis, deviation })
}

/// Whether unit normalised screws with these angular parts are translations, or rotate about axes of one
/// or of several directions.
fn rotation_axes(angular: &[Vector3<f64>]) -> RotationAxes {
    if angular.iter().all(|w| w.norm() <= TOLERANCE) {
        return RotationAxes::None;
    }
    let axis = principal(angular, 0);
    if angular.iter().all(|w| w.cross(&axis).norm() <= TOLERANCE) {
        RotationAxes::Parallel(axis)
    } else {
        RotationAxes::Several
    }
}

/// A principal direction of a set of vectors, by its number: 0 is the direction of the largest extent, 2
/// that of the smallest.
fn principal(vectors: &[Vector3<f64>], which: usize) -> Unit<Vector3<f64>> {
    let svd = Svd::new(DMatrix::from_fn(vectors.len(), 3, |i, j| vectors[i][j]));
    Unit::new_normalize(svd.right.fixed_view::<3, 1>(0, which).into_owned())
}

/// The point `p`, nearest to the origin, on the common axis of parallel rotations `(ω; p × ω + h ω)`.
fn line_point(angular: &[Vector3<f64>], linear: &[Vector3<f64>]) -> Point3<f64> {
    let weight: f64 = angular.iter().map(Vector3::norm_squared).sum();
    let moment: Vector3<f64> = angular.iter().zip(linear).map(|(w, v)| w.cross(v)).sum();
    Point3::from(moment / weight)
}

/// The common pitch along `axis`; exactly zero if it is within the tolerance.
fn pitch(angular: &[Vector3<f64>], linear: &[Vector3<f64>], axis: Unit<Vector3<f64>>) -> f64 {
    let (mut advance, mut weight) = (0.0, 0.0);
    for (w, v) in angular.iter().zip(linear) {
        advance += axis.dot(w) * axis.dot(v);
        weight += axis.dot(w).powi(2);
    }
    let pitch = advance / weight;
    if pitch.abs() <= TOLERANCE { 0.0 } else { pitch }
}

/// The common point `p` of rotations `(ω; p × ω)`, by least squares; `None` if their axes are parallel.
fn centre(angular: &[Vector3<f64>], linear: &[Vector3<f64>]) -> Option<Point3<f64>> {
    let normal: Matrix3<f64> =
        angular.iter().map(|w| Matrix3::identity() * w.norm_squared() - w * w.transpose()).sum();
    let moment: Vector3<f64> = angular.iter().zip(linear).map(|(w, v)| w.cross(v)).sum();
    Some(Point3::from(normal.cholesky()?.solve(&moment)))
}
