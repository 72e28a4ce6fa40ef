//! Two groups that share one dimension only if they are placed so: a cylinder whose axis lies in a
//! plane or is its normal, two cylinders with parallel axes, a cylinder whose axis passes through the
//! centre of a sphere.

use crate::group::subspace::SubspaceClass;
use nalgebra::{Unit, Vector3};

/// Both fitted groups can be off by the tolerance.
const BOTH: f64 = 2.0;

/// The groups of both sections, placed exactly as they nearly are. The group with fewer elements is the
/// one that is moved; `counts` has the numbers of elements.
pub(super) fn related(
    groups: [SubspaceClass; 2],
    counts: [usize; 2],
    length: f64,
    tolerance: f64,
) -> [SubspaceClass; 2] {
    use SubspaceClass as Class;
    let [lower, upper] = groups;
    let (angle, distance) = (BOTH * tolerance, BOTH * tolerance * length);
    let lower_moves = counts[0] < counts[1];
    match (lower, upper) {
        (Class::Planar { normal: a }, Class::Cylindrical { axis: b, .. })
        | (Class::Cylindrical { axis: a, .. }, Class::Planar { normal: b })
        | (Class::TranslationalPlane { normal: a }, Class::Cylindrical { axis: b, .. })
        | (Class::Cylindrical { axis: a, .. }, Class::TranslationalPlane { normal: b })
        | (Class::Cylindrical { axis: a, .. }, Class::Cylindrical { axis: b, .. }) => {
            let [a, b] = if lower_moves { [aligned(a, b, angle), b] } else { [a, aligned(b, a, angle)] };
            [with_direction(lower, a), with_direction(upper, b)]
        }
        (Class::Cylindrical { axis, point }, Class::Spherical { centre }) => {
            let near = (centre - point).cross(&axis).norm() <= distance;
            [Class::Cylindrical { axis, point: if near { centre } else { point } }, upper]
        }
        (Class::Spherical { centre }, Class::Cylindrical { axis, point }) => {
            let near = (centre - point).cross(&axis).norm() <= distance;
            [lower, Class::Cylindrical { axis, point: if near { centre } else { point } }]
        }
        _ => groups,
    }
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
