//! Two groups that share one dimension only if they are placed so: a cylinder whose axis lies in a
//! plane or is its normal, two cylinders with parallel axes, a cylinder whose axis passes through the
//! centre of a sphere.

use super::guides::Guides;
use crate::group::subspace::SubspaceClass;
use nalgebra::{Point3, Unit, Vector3};

/// Both fitted groups can be off by the tolerance.
pub(super) const BOTH: f64 = 2.0;

/// The groups of both sections, placed exactly as they nearly are. The group with fewer elements is the
/// one that is moved; `counts` has the numbers of elements.
pub(super) fn related(
    groups: [SubspaceClass; 2],
    counts: [usize; 2],
    length: f64,
    tolerance: f64,
) -> [SubspaceClass; 2] {
    let [lower, upper] = groups;
    let near = BOTH * tolerance;
    let through = |group: SubspaceClass, other: SubspaceClass| match group {
        SubspaceClass::Cylindrical { axis, point } => {
            let centre = Guides::of(&other).centre;
            let passes = |c: &Point3<f64>| (c - point).cross(&axis).norm() <= near * length;
            let point = centre.filter(passes).unwrap_or(point);
            SubspaceClass::Cylindrical { axis, point }
        }
        SubspaceClass::Identity
        | SubspaceClass::Rotation { .. }
        | SubspaceClass::Translation { .. }
        | SubspaceClass::Helical { .. }
        | SubspaceClass::TranslationalPlane { .. }
        | SubspaceClass::TranslationalSpace
        | SubspaceClass::Planar { .. }
        | SubspaceClass::Spherical { .. }
        | SubspaceClass::PlanarHelical { .. }
        | SubspaceClass::Schoenflies { .. }
        | SubspaceClass::Full => group,
    };
    let is_cylinder = |group: &SubspaceClass| matches!(group, SubspaceClass::Cylindrical { .. });
    match (direction(&lower), direction(&upper)) {
        (Some(a), Some(b)) if groups.iter().any(is_cylinder) => {
            if counts[0] < counts[1] {
                [with_direction(lower, aligned(a, b, near)), upper]
            } else {
                [lower, with_direction(upper, aligned(b, a, near))]
            }
        }
        _ => [through(lower, upper), through(upper, lower)],
    }
}

/// The axis of a cylinder, or the normal of a plane.
fn direction(group: &SubspaceClass) -> Option<Unit<Vector3<f64>>> {
    let guides = Guides::of(group);
    guides.line.and(guides.slide).or(guides.normal)
}

/// A direction, made parallel or perpendicular to another one if it nearly is.
fn aligned(
    direction: Unit<Vector3<f64>>,
    to: Unit<Vector3<f64>>,
    tolerance: f64,
) -> Unit<Vector3<f64>> {
    let along = direction.dot(&to);
    if direction.cross(&to).norm() <= tolerance {
        if along < 0.0 { -to } else { to }
    } else if along.abs() <= tolerance {
        Unit::new_normalize(direction.into_inner() - to.into_inner() * along)
    } else {
        direction
    }
}

/// A group with another direction of its axis or normal.
fn with_direction(group: SubspaceClass, direction: Unit<Vector3<f64>>) -> SubspaceClass {
    use SubspaceClass as Class;
    match group {
        Class::Planar { .. } => Class::Planar { normal: direction },
        Class::TranslationalPlane { .. } => Class::TranslationalPlane { normal: direction },
        Class::Cylindrical { point, .. } => Class::Cylindrical { axis: direction, point },
        Class::Identity
        | Class::Rotation { .. }
        | Class::Translation { .. }
        | Class::Helical { .. }
        | Class::TranslationalSpace
        | Class::Spherical { .. }
        | Class::PlanarHelical { .. }
        | Class::Schoenflies { .. }
        | Class::Full => group,
    }
}
