//! The correction of a mechanism: every joint is moved as little as it takes to be exactly in the group
//! of its section.

use super::guides::Guides;
use super::miss::misses_of;
use super::search::{NearSplit, Parts};
use super::{EXACT, JointMiss, Snapped};
use crate::decomposition::Freedom;
use crate::decomposition::element::Element;
use crate::group::subspace::SubspaceClass;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::{Leg, Section};
use crate::mechanism::{FrameHints, Mechanism};
use nalgebra::{Matrix3, Point3, Unit, Vector3};

/// An eigenvalue of a sum of projectors below this one is zero.
const FREE: f64 = 1e-9;

/// The corrected mechanism; `None` if a joint misses by more than the tolerance (radians and
/// characteristic lengths).
pub(super) fn snapped(
    mechanism: &Mechanism,
    split: &NearSplit,
    length: f64,
    tolerance: f64,
) -> Option<Snapped> {
    let mut snapped = mechanism.clone();
    let mut misses: Vec<JointMiss> = vec![];
    let legs = mechanism.legs.iter().zip(&split.legs).zip(&mut snapped.legs);
    for ((leg, parts), corrected) in legs {
        for Constrained { joint, groups, miss } in constraints(leg, parts, split, length, tolerance)
        {
            if miss.relative(length) > tolerance {
                return None;
            }
            if miss.relative(length) > EXACT {
                corrected.joints[joint] = moved(&leg.joints[joint], &groups, length);
                misses.push(miss.in_units(mechanism.units));
            }
        }
    }
    snapped.task.lower = directed(&mechanism.task.lower, split.lower, split.upper, tolerance);
    snapped.task.upper = directed(&mechanism.task.upper, split.upper, split.lower, tolerance);
    misses.sort_by(|a, b| b.relative(length).total_cmp(&a.relative(length)));
    Some(Snapped { mechanism: snapped, joints: misses })
}

/// A joint, the groups in which its freedoms (by their indices) have to move, and how far it is from
/// them.
struct Constrained {
    joint: usize,
    groups: Vec<(usize, SubspaceClass)>,
    miss: JointMiss,
}

/// The groups in which each joint's freedoms have to move, and how far the joint is from them.
///
/// A joint at the split that nearly makes the intersection motion may be in either section. It is put
/// into both groups, so that it can be in either section afterwards.
fn constraints(
    leg: &Leg,
    parts: &Parts,
    split: &NearSplit,
    length: f64,
    tolerance: f64,
) -> Vec<Constrained> {
    let near = |freedom: &Freedom, group: &SubspaceClass| {
        let element = Element::of(&leg.joints[freedom.joint], freedom.index);
        let offset = element.and_then(|element| element.offset(group));
        offset.is_some_and(|offset| offset.relative(length) <= tolerance)
    };
    let mut freedoms: Vec<(Freedom, SubspaceClass)> = vec![];
    let (mut lower, mut upper) = (parts.lower.clone(), parts.upper.clone());
    freedoms.extend(parts.lower.iter().map(|f| (*f, split.lower)));
    freedoms.extend(parts.upper.iter().map(|f| (*f, split.upper)));
    if let Some(last) = parts.lower.last().filter(|last| near(last, &split.upper)) {
        freedoms.push((*last, split.upper));
        upper.push(*last);
    }
    if let Some(first) = parts.upper.first().filter(|first| near(first, &split.lower)) {
        freedoms.push((*first, split.lower));
        lower.push(*first);
    }
    let mut misses = misses_of(leg, &lower, Section::Lower, split.lower);
    misses.extend(misses_of(leg, &upper, Section::Upper, split.upper));
    let of_joint = |joint: usize| {
        let own = freedoms.iter().filter(|(freedom, _)| freedom.joint == joint);
        let groups = own.map(|(freedom, group)| (freedom.index, *group)).collect();
        let worst = misses
            .iter()
            .filter(|(number, _)| *number == joint)
            .max_by(|(_, a), (_, b)| a.relative(length).total_cmp(&b.relative(length)));
        Some(Constrained { joint, groups, miss: worst?.1.clone() })
    };
    (0..leg.joints.len()).filter_map(of_joint).collect()
}

/// A joint, moved so that its freedoms are in given groups: first its directions, then its point.
fn moved(joint: &Joint, constraints: &[(usize, SubspaceClass)], length: f64) -> Joint {
    let mut moved = joint.clone();
    // A fixed direction after one that is only perpendicular: it has the last word.
    for fixed in [false, true] {
        for (index, group) in constraints {
            let Some(element) = Element::of(&moved, *index) else { continue };
            let Some(direction) = direction(&element, group, fixed) else { continue };
            *axis_of(&mut moved, *index) = direction;
        }
    }
    let places: Vec<(usize, PointPlace)> = constraints
        .iter()
        .filter_map(|(index, group)| Some((*index, place(&Element::of(&moved, *index)?, group)?)))
        .collect();
    moved.point = placed(joint.point, &places);
    // Two axes through two centres need not meet in a point; they are then aimed at it.
    for (index, place) in &places {
        let from = moved.point - place.point;
        let through_centre = place.centre && moved.kind != JointKind::Spherical;
        let axis = axis_of(&mut moved, *index);
        let passes = from.cross(axis).norm();
        if through_centre && passes > EXACT * length && from.norm() > passes {
            let aimed = Unit::new_normalize(from);
            *axis = if aimed.dot(axis) < 0.0 { -aimed } else { aimed };
        }
    }
    moved
}

/// The direction of one freedom of a joint.
fn axis_of(joint: &mut Joint, index: usize) -> &mut Unit<Vector3<f64>> {
    match &mut joint.kind {
        JointKind::Universal { second } if index == 1 => second,
        JointKind::Universal { .. }
        | JointKind::Revolute
        | JointKind::Prismatic
        | JointKind::Helical { .. }
        | JointKind::Cylindrical
        | JointKind::Spherical => &mut joint.axis,
    }
}

/// The direction of an element that is in a group; `None` if the group leaves it free. Either those
/// that the group fixes, or those that it only puts into a plane.
fn direction(element: &Element, group: &SubspaceClass, fixed: bool) -> Option<Unit<Vector3<f64>>> {
    let guides = Guides::of(group);
    let (axis, along, normal) = match *element {
        Element::Line { axis, .. } | Element::Helix { axis, .. } => (axis, guides.axis, None),
        Element::Slide { axis } => (axis, guides.slide, guides.normal),
        Element::Ball { .. } => return None,
    };
    if fixed {
        along.map(|to| if axis.dot(&to) < 0.0 { -to } else { to })
    } else {
        normal.map(|n| Unit::new_normalize(axis.into_inner() - n.into_inner() * n.dot(&axis)))
    }
}

/// Where a joint's point has to be: at a point, up to motions that a projector leaves free.
struct PointPlace {
    point: Point3<f64>,
    projector: Matrix3<f64>,
    /// Whether the point is a centre that the axis passes through.
    centre: bool,
}

/// Where the point of an element in a group has to be; `None` if anywhere.
fn place(element: &Element, group: &SubspaceClass) -> Option<PointPlace> {
    let across =
        |axis: Unit<Vector3<f64>>| Matrix3::identity() - axis.into_inner() * axis.transpose();
    let Guides { line, centre, .. } = Guides::of(group);
    let at_centre = |projector| centre.map(|point| PointPlace { point, projector, centre: true });
    match *element {
        Element::Slide { .. } => None,
        Element::Ball { .. } => at_centre(Matrix3::identity()),
        Element::Line { axis, .. } | Element::Helix { axis, .. } => match line {
            Some((axis, point)) => {
                Some(PointPlace { point, projector: across(axis), centre: false })
            }
            None => at_centre(across(axis)),
        },
    }
}

/// A point, moved as little as possible to where it has to be; by least squares if it cannot be
/// everywhere at once.
fn placed(point: Point3<f64>, places: &[(usize, PointPlace)]) -> Point3<f64> {
    let sum: Matrix3<f64> = places.iter().map(|(_, place)| place.projector).sum();
    let offset: Vector3<f64> =
        places.iter().map(|(_, place)| place.projector * (place.point - point)).sum();
    let eigen = sum.symmetric_eigen();
    let along = |i: usize| {
        let direction = eigen.eigenvectors.column(i);
        direction * (direction.dot(&offset) / eigen.eigenvalues[i])
    };
    let step = (0..3).filter(|&i| eigen.eigenvalues[i] > FREE).map(along);
    point + step.sum::<Vector3<f64>>()
}

/// The directions of a section's hints, corrected with its group.
fn directed(
    hints: &FrameHints,
    own: SubspaceClass,
    other: SubspaceClass,
    tolerance: f64,
) -> FrameHints {
    let [own, other] = [own, other].map(|group| Guides::of(&group).normal);
    // Directions that hints name: the normals, the line where two planes meet, and across that line.
    let line = own.zip(other).and_then(|(a, b)| Unit::try_new(a.cross(&b), FREE));
    let across = own.zip(line).map(|(a, b)| Unit::new_normalize(a.cross(&b)));
    let known: Vec<_> = [own, other, line, across].into_iter().flatten().collect();
    let corrected = |given: Vector3<f64>| {
        let unit = given.normalize();
        let along = known.iter().find(|d| unit.cross(d).norm() <= tolerance);
        let across = [own, other].into_iter().flatten().find(|d| unit.dot(d).abs() <= tolerance);
        match (along, across) {
            (Some(d), _) => d.into_inner() * unit.dot(d).signum(),
            (None, Some(d)) => unit - d.into_inner() * unit.dot(&d),
            (None, None) => given,
        }
    };
    FrameHints {
        x: hints.x.map(corrected),
        axis: hints.axis.map(corrected),
        w: hints.w.map(corrected),
        normal: hints.normal.map(corrected),
        origin: hints.origin,
    }
}
