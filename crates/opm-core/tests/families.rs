//! Families of assemblies against geometry: parallelogram motions of congruent platforms, and double poses, which are none.

use opm_core::Manipulator;
use opm_core::forward::{Certificate, Family};

const HEAD: &str = "format = 1\nname = \"congruent\"\nunits = { length = \"m\", angle = \"rad\" }\n[platform]\npoint = [0, 0, 0]\n";

/// Points of the base; those of the platform are above them by `up` at home.
fn planar(base: &[[f64; 2]; 3], up: f64) -> Manipulator {
    let mut text = HEAD.to_owned();
    for (i, [x, y]) in base.iter().enumerate() {
        let top = y + up;
        text += &format!(
            "[[leg]]\nname = \"leg{i}\"\njoints = [\n\
             {{ name = \"r{i}\", type = \"revolute\", axis = [0, 0, 1], point = [{x}, {y}, 0] }},\n\
             {{ name = \"p{i}\", type = \"prismatic\", axis = [0, 1, 0], actuated = true }},\n\
             {{ name = \"s{i}\", type = \"revolute\", axis = [0, 0, 1], point = [{x}, {top}, 0] }},\n]\n"
        );
    }
    Manipulator::read(&text).unwrap()
}

fn hexapod(base: &[[f64; 3]; 6], up: f64) -> Manipulator {
    let mut text = HEAD.to_owned();
    for (i, [x, y, z]) in base.iter().enumerate() {
        let top = z + up;
        text += &format!(
            "[[leg]]\nname = \"leg{i}\"\njoints = [\n\
             {{ name = \"u{i}\", type = \"universal\", axis = [1, 0, 0], axis2 = [0, 1, 0], point = [{x}, {y}, {z}] }},\n\
             {{ name = \"p{i}\", type = \"prismatic\", axis = [0, 0, 1], actuated = true }},\n\
             {{ name = \"s{i}\", type = \"spherical\", point = [{x}, {y}, {top}] }},\n]\n"
        );
    }
    Manipulator::read(&text).unwrap()
}

fn families(m: &Manipulator, actuated: &[f64]) -> Vec<Family> {
    let found = m.forward(actuated).unwrap();
    m.families(actuated, &found, &m.certify(&found.list))
}

/// With equal lengths a congruent platform moves along a circle without turning; with other lengths it does not move.
#[test]
fn congruent_triangles_with_equal_legs_move_along_a_circle() {
    let m = planar(&[[0.0, 0.0], [1.0, 0.0], [0.4, 0.7]], 0.3);
    for slide in [0.0, 0.1] {
        let found = families(&m, &[slide; 3]);
        let [family] = &found[..] else { panic!("{found:?}") };
        assert_eq!((family.dimension, family.platform, family.closed), (1, 1, Some(true)));
        let moved = family.place.translation.vector;
        assert!(family.place.rotation.angle() < 1e-8, "{family:?}");
        assert!((moved.x.hypot(0.3 + moved.y) - 0.3 - slide).abs() < 1e-8, "{family:?}");
    }
    assert!(families(&m, &[0.01, 0.0, 0.0]).is_empty());
}

/// In space it moves over a sphere.
#[test]
fn congruent_hexapods_with_equal_legs_move_over_a_sphere() {
    let base = [
        [0.3, 0.0, 0.02],
        [0.2, 0.25, -0.05],
        [-0.15, 0.3, 0.08],
        [-0.3, -0.05, 0.0],
        [-0.1, -0.25, -0.04],
        [0.2, -0.2, 0.06],
    ];
    let m = hexapod(&base, 0.4);
    let found = families(&m, &[0.05; 6]);
    let [family] = &found[..] else { panic!("{found:?}") };
    // The legs stay parallel, so that a rotation about their direction is in the kernel all along.
    assert_eq!((family.dimension, family.platform, family.multiple), (2, 2, true));
    let moved = family.place.translation.vector;
    assert!(family.place.rotation.angle() < 1e-4, "{family:?}");
    assert!(((moved + nalgebra::Vector3::z() * 0.4).norm() - 0.45).abs() < 1e-7, "{family:?}");
    assert!(families(&m, &[0.05, 0.0, 0.0, 0.01, 0.02, -0.03]).is_empty());
}

/// Where two assemblies meet there is no family.
#[test]
fn a_double_pose_is_no_family() {
    let m = Manipulator::example("linear-delta").unwrap();
    let size = m.characteristic_length();
    let at = |way: f64| [way * size, 0.0, 0.0];
    let (mut low, mut high) = (0.0, 4.0);
    assert!(m.forward(&at(high)).unwrap().list.is_empty());
    for _ in 0..52 {
        let middle = 0.5 * (low + high);
        match m.forward(&at(middle)).unwrap().list.is_empty() {
            true => high = middle,
            false => low = middle,
        }
    }
    let found = m.forward(&at(low)).unwrap();
    let certificates = m.certify(&found.list);
    assert!(certificates.contains(&Certificate::DoubleSuspected), "{certificates:?}");
    assert!(m.families(&at(low), &found, &certificates).is_empty());
}
