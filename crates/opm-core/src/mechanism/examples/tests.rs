use super::*;
use crate::group::screw::Screw;
use crate::mechanism::Mechanism;
use crate::mechanism::file::{self, Digits};
use crate::mechanism::joint::Joint;
use crate::mechanism::leg::Leg;
use nalgebra::{DMatrix, Point3, Vector3};

/// Tolerance: numbers in the joint lists have 12 decimals, in millimetres and degrees; unit vectors
/// have 14.
const WRITTEN: f64 = 1e-13;

fn read(name: &str) -> file::MechanismFile {
    let text = find(name).unwrap_or_else(|| panic!("{name}")).text;
    file::read(text).unwrap_or_else(|errors| panic!("{}", errors.in_file(name)))
}

#[test]
fn every_example_can_be_read_under_its_own_name() {
    for example in EXAMPLES {
        assert_eq!(read(example.name).mechanism.name, example.name);
        assert!(!example.description.contains('\n'));
    }
    assert_eq!(find("plano-spherical"), None);
}

/// The shipped joint list of a family is what the family assembles to. If it is not, the message is
/// the text that the file should have below its comment.
#[test]
fn joint_lists_are_the_assembled_families() {
    for name in ["plano-spherical-5dof", "translational-helical-3dof", "planar-planar-5dof"] {
        let (family, list) = (read(name), read(&format!("{name}-joints")));
        let mut expected = family.mechanism;
        expected.name.push_str("-joints");
        let text = file::write(&expected, family.units, Digits::Sure);
        assert!(same(&expected, &list.mechanism), "{text}");
        assert_eq!(list.units, family.units);
        assert_eq!((list.family, list.mode), (None, None));
    }
}

fn same(a: &Mechanism, b: &Mechanism) -> bool {
    let joint = |(a, b): (&Joint, &Joint)| {
        let coordinates = a.coordinates.iter().zip(&b.coordinates).all(|(a, b)| {
            a.name == b.name && a.limits == b.limits && (a.home - b.home).abs() < WRITTEN
        });
        (&a.name, a.kind, a.actuated) == (&b.name, b.kind, b.actuated)
            && (a.axis.into_inner() - b.axis.into_inner()).norm() < WRITTEN
            && (a.point - b.point).norm() < WRITTEN
            && coordinates
    };
    a.name == b.name
        && (a.platform - b.platform).norm() < WRITTEN
        && a.task.axis.zip(b.task.axis).is_some_and(|(a, b)| (a - b).norm() < WRITTEN)
        && a.legs.len() == b.legs.len()
        && a.legs.iter().zip(&b.legs).all(|(a, b)| {
            let joints = a.joints.iter().zip(&b.joints);
            a.name == b.name && a.joints.len() == b.joints.len() && joints.into_iter().all(joint)
        })
}

#[test]
fn bennett_s_linkage_has_the_arcs_that_its_file_says() {
    let mechanism = read("bennett-double-spherical-6r").mechanism;
    let axis = |name: &str| {
        let joint = mechanism.joints().find(|joint| joint.name == name).unwrap();
        let centre = if name.starts_with('a') { 0.0 } else { 0.2 };
        assert_eq!(joint.point, Point3::new(centre, 0.0, 0.0), "{name}");
        joint.axis.into_inner()
    };
    let along = Vector3::x();
    for (one, other, degrees) in [
        (axis("a1"), along, 30.0),
        (along, axis("a3"), 75.0),
        (axis("a3"), axis("a2"), 60.0),
        (axis("a2"), axis("a1"), 70.0),
        (axis("b3"), -along, 35.0),
        (-along, axis("b1"), 70.0),
        (axis("b1"), axis("b2"), 65.0),
        (axis("b2"), axis("b3"), 80.0),
    ] {
        assert!((one.dot(&other) - f64::to_radians(degrees).cos()).abs() < WRITTEN, "{degrees}");
    }
}

#[test]
fn bennett_s_linkage_is_a_regular_single_loop_of_one_freedom() {
    let mechanism = read("bennett-double-spherical-6r").mechanism;
    let screws: Vec<Screw> = mechanism.legs.iter().flat_map(Leg::screws).collect();
    assert_eq!(screws.len(), 6);
    // Lengths are in units of the distance between the centres, so that both halves of a screw have
    // equal weight.
    let columns: Vec<_> =
        screws.iter().map(|s| Screw { linear: s.linear / 0.2, ..*s }.to_vector()).collect();
    let mut singular: Vec<f64> = DMatrix::from_fn(6, 6, |row, column| columns[column][row])
        .singular_values()
        .iter()
        .copied()
        .collect();
    singular.sort_by(f64::total_cmp);
    assert!(singular[0] < WRITTEN, "one freedom: {singular:?}");
    assert!(singular[1] > 0.05, "and not more: {singular:?}");
}
