//! The freedoms of joints as lines, slides and balls, how far each one is from a group, and the group
//! that fits several of them best.
//!
//! Distances are metres and angles radians, so that a miss can be told to a person. The
//! [subspaces](crate::group::subspace) decide exact mechanisms; this module measures those that are
//! only nearly exact.

use crate::group::subspace::{SubspaceClass, upward};
use crate::mechanism::joint::{Joint, JointKind};
use nalgebra::{Matrix3, Point3, Unit, Vector3};

/// One freedom of a joint, or all three of a spherical joint, in base coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Element {
    /// A rotation about a line.
    Line { axis: Unit<Vector3<f64>>, point: Point3<f64> },
    /// A screw motion about a line, with a pitch in metres per radian.
    Helix { axis: Unit<Vector3<f64>>, point: Point3<f64>, pitch: f64 },
    /// A translation.
    Slide { axis: Unit<Vector3<f64>> },
    /// All rotations about a point.
    Ball { point: Point3<f64> },
}

/// How far an element is from a group.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Offset {
    /// Between the element's axis and the direction that it should have, radians.
    pub angle: f64,
    /// Between the element's axis and the point or line that it should pass through, metres; or
    /// between two pitches, metres per radian.
    pub distance: f64,
}

impl Offset {
    /// The larger one of both, in characteristic lengths.
    pub fn relative(self, length: f64) -> f64 {
        self.angle.max(self.distance / length)
    }
}

impl Element {
    /// The elements of some freedoms of a joint, given by their indices. A spherical joint is never
    /// divided: its first freedom stands for all of them.
    pub fn of(joint: &Joint, index: usize) -> Option<Self> {
        let (axis, point) = (joint.axis, joint.point);
        match (joint.kind, index) {
            (JointKind::Revolute, _)
            | (JointKind::Universal { .. } | JointKind::Cylindrical, 0) => {
                Some(Self::Line { axis, point })
            }
            (JointKind::Universal { second }, _) => Some(Self::Line { axis: second, point }),
            (JointKind::Prismatic | JointKind::Cylindrical, _) => Some(Self::Slide { axis }),
            (JointKind::Helical { pitch }, _) => Some(Self::Helix { axis, point, pitch }),
            (JointKind::Spherical, 0) => Some(Self::Ball { point }),
            (JointKind::Spherical, _) => None,
        }
    }

    /// How far the element is from a group; `None` if the group has no motion of this kind, or only
    /// with another pitch than zero.
    pub fn offset(&self, group: &SubspaceClass) -> Option<Offset> {
        use SubspaceClass as Class;
        let pitch = match self {
            Self::Helix { pitch, .. } => *pitch,
            Self::Line { .. } | Self::Slide { .. } | Self::Ball { .. } => 0.0,
        };
        match (*self, group) {
            (_, Class::Full) => Some(Offset::default()),
            (_, Class::Identity) => None,

            (Self::Ball { point }, Class::Spherical { centre }) => {
                Some(Offset { angle: 0.0, distance: (point - centre).norm() })
            }
            (
                Self::Ball { .. },
                Class::Rotation { .. }
                | Class::Translation { .. }
                | Class::Helical { .. }
                | Class::TranslationalPlane { .. }
                | Class::Cylindrical { .. }
                | Class::TranslationalSpace
                | Class::Planar { .. }
                | Class::PlanarHelical { .. }
                | Class::Schoenflies { .. },
            ) => None,

            (
                Self::Slide { .. },
                Class::Rotation { .. } | Class::Helical { .. } | Class::Spherical { .. },
            ) => None,
            (Self::Slide { .. }, Class::TranslationalSpace | Class::Schoenflies { .. }) => {
                Some(Offset::default())
            }
            (
                Self::Slide { axis },
                Class::Translation { axis: along } | Class::Cylindrical { axis: along, .. },
            ) => Some(Offset { angle: between(axis, *along), distance: 0.0 }),
            (
                Self::Slide { axis },
                Class::TranslationalPlane { normal }
                | Class::Planar { normal }
                | Class::PlanarHelical { axis: normal, .. },
            ) => Some(Offset { angle: axis.dot(normal).abs().min(1.0).asin(), distance: 0.0 }),

            (
                Self::Line { .. } | Self::Helix { .. },
                Class::Translation { .. }
                | Class::TranslationalPlane { .. }
                | Class::TranslationalSpace,
            ) => None,
            (
                Self::Helix { .. },
                Class::Rotation { .. } | Class::Planar { .. } | Class::Spherical { .. },
            ) => None,
            (Self::Line { .. }, Class::Helical { .. } | Class::PlanarHelical { .. }) => None,
            (Self::Line { axis, point }, Class::Spherical { centre }) => {
                Some(Offset { angle: 0.0, distance: (centre - point).cross(&axis).norm() })
            }
            (Self::Line { axis, .. }, Class::Planar { normal }) => {
                Some(Offset { angle: between(axis, *normal), distance: 0.0 })
            }
            (
                Self::Line { axis, .. } | Self::Helix { axis, .. },
                Class::Schoenflies { axis: along },
            ) => Some(Offset { angle: between(axis, *along), distance: 0.0 }),
            (
                Self::Line { axis, point } | Self::Helix { axis, point, .. },
                Class::Rotation { axis: along, point: on }
                | Class::Cylindrical { axis: along, point: on },
            ) => Some(Offset {
                angle: between(axis, *along),
                distance: (point - on).cross(along).norm(),
            }),
            (
                Self::Helix { axis, point, .. },
                Class::Helical { axis: along, point: on, pitch: common },
            ) => Some(Offset {
                angle: between(axis, *along),
                distance: (point - on).cross(along).norm().max((pitch - common).abs()),
            }),
            (Self::Helix { axis, .. }, Class::PlanarHelical { axis: along, pitch: common }) => {
                Some(Offset { angle: between(axis, *along), distance: (pitch - common).abs() })
            }
        }
    }

    /// The direction of the element's axis; `None` for a ball.
    fn axis(&self) -> Option<Unit<Vector3<f64>>> {
        match *self {
            Self::Line { axis, .. } | Self::Helix { axis, .. } | Self::Slide { axis } => Some(axis),
            Self::Ball { .. } => None,
        }
    }

    /// A point of the element's axis, or the ball's; `None` for a slide.
    fn point(&self) -> Option<Point3<f64>> {
        match *self {
            Self::Line { point, .. } | Self::Helix { point, .. } | Self::Ball { point } => {
                Some(point)
            }
            Self::Slide { .. } => None,
        }
    }
}

/// The angle between two lines, 0 to a right angle.
fn between(a: Unit<Vector3<f64>>, b: Unit<Vector3<f64>>) -> f64 {
    a.cross(&b).norm().atan2(a.dot(&b).abs())
}

/// The kinds of groups that are fitted, smallest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum GroupKind {
    Rotation,
    Translation,
    Helical,
    Cylindrical,
    TranslationalPlane,
    Planar,
    Spherical,
    PlanarHelical,
    TranslationalSpace,
    Schoenflies,
}

const KINDS: [GroupKind; 10] = [
    GroupKind::Rotation,
    GroupKind::Translation,
    GroupKind::Helical,
    GroupKind::Cylindrical,
    GroupKind::TranslationalPlane,
    GroupKind::Planar,
    GroupKind::Spherical,
    GroupKind::PlanarHelical,
    GroupKind::TranslationalSpace,
    GroupKind::Schoenflies,
];

/// The smallest group from which no element is farther than `tolerance`: radians, and shares of the
/// characteristic length. For exact elements this is the group that they generate.
pub(super) fn generated(elements: &[Element], length: f64, tolerance: f64) -> SubspaceClass {
    if elements.is_empty() {
        return SubspaceClass::Identity;
    }
    let weights = vec![1.0; elements.len()];
    let fits = |group: &SubspaceClass| worst(elements, group, length) <= tolerance;
    let groups = KINDS.iter().filter_map(|kind| fitted(*kind, elements, &weights));
    groups.into_iter().find(fits).unwrap_or(SubspaceClass::Full)
}

/// The largest offset of an element from a group, in characteristic lengths; infinite where the
/// group has no such motion.
pub(super) fn worst(elements: &[Element], group: &SubspaceClass, length: f64) -> f64 {
    let offset = |e: &Element| e.offset(group).map_or(f64::INFINITY, |o| o.relative(length));
    elements.iter().map(offset).fold(0.0, f64::max)
}

/// Rounds of [`robust`]; the offset below which all elements weigh the same falls by this factor in
/// each.
const ROUNDS: i32 = 40;
const SHARPER: f64 = 0.5;
/// The offset below which all elements weigh the same at first, in characteristic lengths.
const BLUNT: f64 = 1e-2;

/// The group of the same kind as `group` for which the sum of the offsets is smallest. One element
/// that is off, among several that agree, hardly moves it; a least-squares fit would follow it.
///
/// Iteratively reweighted least squares, each element weighted by one over its offset.
pub(super) fn robust(group: SubspaceClass, elements: &[Element], length: f64) -> SubspaceClass {
    let Some(kind) = GroupKind::of(&group) else { return group };
    let mut best = group;
    for round in 0..ROUNDS {
        let blunt = BLUNT * SHARPER.powi(round);
        let weight = |element: &Element| {
            let offset = element.offset(&best).map_or(1.0, |o| o.relative(length));
            1.0 / offset.max(blunt)
        };
        let weights: Vec<f64> = elements.iter().map(weight).collect();
        match fitted(kind, elements, &weights) {
            Some(next) => best = next,
            None => return best,
        }
    }
    best
}

impl GroupKind {
    /// The kind of a group with a geometry to fit.
    fn of(group: &SubspaceClass) -> Option<Self> {
        match group {
            SubspaceClass::Rotation { .. } => Some(Self::Rotation),
            SubspaceClass::Translation { .. } => Some(Self::Translation),
            SubspaceClass::Helical { .. } => Some(Self::Helical),
            SubspaceClass::TranslationalPlane { .. } => Some(Self::TranslationalPlane),
            SubspaceClass::Cylindrical { .. } => Some(Self::Cylindrical),
            SubspaceClass::Planar { .. } => Some(Self::Planar),
            SubspaceClass::Spherical { .. } => Some(Self::Spherical),
            SubspaceClass::PlanarHelical { .. } => Some(Self::PlanarHelical),
            SubspaceClass::Schoenflies { .. } => Some(Self::Schoenflies),
            SubspaceClass::Identity | SubspaceClass::TranslationalSpace | SubspaceClass::Full => {
                None
            }
        }
    }
}

/// The group of a kind that is nearest to weighted elements, by least squares; `None` if an element
/// has no place in such a group, or if the elements do not determine it.
fn fitted(kind: GroupKind, elements: &[Element], weights: &[f64]) -> Option<SubspaceClass> {
    let all = || elements.iter().zip(weights.iter().copied());
    let rotates = |e: &Element| !matches!(e, Element::Slide { .. });
    // Directions along the axis, or perpendicular to the normal.
    let along = |keep: fn(&Element) -> bool| -> Matrix3<f64> {
        let axes = all().filter(|(e, _)| keep(e)).filter_map(|(e, w)| Some((e.axis()?, w)));
        axes.map(|(axis, w)| axis.into_inner() * axis.transpose() * w).sum()
    };
    let slides = |e: &Element| matches!(e, Element::Slide { .. });
    let lines = |e: &Element| matches!(e, Element::Line { .. } | Element::Helix { .. });
    // The direction that is along all rotations and perpendicular to all slides.
    let normal = || eigenvector(&(along(slides) - along(lines)), Order::Smallest);
    let common_axis = || eigenvector(&along(|_| true), Order::Largest);
    let on_axis = |axis: Unit<Vector3<f64>>| {
        let points = || all().filter_map(|(e, w)| Some((e.point()?.coords, w)));
        let weight: f64 = points().map(|(_, w)| w).sum();
        let mean = points().map(|(p, w)| p * w).sum::<Vector3<f64>>() / weight;
        Point3::from(mean - axis.into_inner() * axis.dot(&mean))
    };
    let pitch = || {
        let pitches = || {
            all().filter_map(|(e, w)| match e {
                Element::Helix { pitch, .. } => Some((*pitch, w)),
                Element::Line { .. } | Element::Slide { .. } | Element::Ball { .. } => None,
            })
        };
        let weight: f64 = pitches().map(|(_, w)| w).sum();
        (weight > 0.0).then(|| pitches().map(|(p, w)| p * w).sum::<f64>() / weight)
    };
    let group = match kind {
        GroupKind::Rotation => {
            let axis = common_axis();
            SubspaceClass::Rotation { axis, point: on_axis(axis) }
        }
        GroupKind::Translation => SubspaceClass::Translation { axis: common_axis() },
        GroupKind::Helical => {
            let axis = common_axis();
            SubspaceClass::Helical { axis, point: on_axis(axis), pitch: pitch()? }
        }
        GroupKind::Cylindrical if elements.iter().any(rotates) => {
            let axis = common_axis();
            SubspaceClass::Cylindrical { axis, point: on_axis(axis) }
        }
        GroupKind::Cylindrical => return None,
        GroupKind::TranslationalPlane => SubspaceClass::TranslationalPlane { normal: normal() },
        GroupKind::Planar if elements.iter().any(rotates) => {
            SubspaceClass::Planar { normal: normal() }
        }
        GroupKind::Planar => return None,
        GroupKind::Spherical => SubspaceClass::Spherical { centre: centre(all())? },
        GroupKind::PlanarHelical => {
            SubspaceClass::PlanarHelical { axis: normal(), pitch: pitch()? }
        }
        GroupKind::TranslationalSpace => SubspaceClass::TranslationalSpace,
        GroupKind::Schoenflies if elements.iter().any(rotates) => {
            SubspaceClass::Schoenflies { axis: eigenvector(&along(lines), Order::Largest) }
        }
        GroupKind::Schoenflies => return None,
    };
    elements.iter().all(|e| e.offset(&group).is_some()).then_some(group)
}

#[derive(Clone, Copy)]
enum Order {
    Smallest,
    Largest,
}

/// The eigenvector of a symmetric matrix with its smallest or its largest eigenvalue, pointing up.
fn eigenvector(matrix: &Matrix3<f64>, order: Order) -> Unit<Vector3<f64>> {
    let eigen = matrix.symmetric_eigen();
    let number = match order {
        Order::Smallest => eigen.eigenvalues.imin(),
        Order::Largest => eigen.eigenvalues.imax(),
    };
    upward(Unit::new_normalize(eigen.eigenvectors.column(number).into_owned()))
}

/// The point nearest to all lines and balls; `None` if the lines are parallel.
fn centre<'a>(elements: impl Iterator<Item = (&'a Element, f64)>) -> Option<Point3<f64>> {
    let (mut normal, mut moment) = (Matrix3::zeros(), Vector3::zeros());
    let mut weight = 0.0;
    for (element, w) in elements {
        let projector = match element {
            Element::Line { axis, .. } => {
                Matrix3::identity() - axis.into_inner() * axis.transpose()
            }
            Element::Ball { .. } => Matrix3::identity(),
            Element::Helix { .. } | Element::Slide { .. } => return None,
        };
        normal += projector * w;
        moment += projector * element.point()?.coords * w;
        weight += w;
    }
    let eigen = normal.symmetric_eigen();
    if eigen.eigenvalues.min() <= PARALLEL * weight {
        return None;
    }
    let inverse = eigen.eigenvectors
        * Matrix3::from_diagonal(&eigen.eigenvalues.map(|value| 1.0 / value))
        * eigen.eigenvectors.transpose();
    Some(Point3::from(inverse * moment))
}

/// The square of the angle between lines, as a share of one, below which they have no common point
/// that could be computed.
const PARALLEL: f64 = 1e-12;
