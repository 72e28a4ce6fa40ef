//! The constraint index, and transmission beside a leg that constrains the platform, against geometry: with the inputs
//! locked and one wrench released, a planar platform turns about the point where the lines of the other wrenches meet, and a
//! spherical one about the axis that is perpendicular to the other moments.

use fastrand::Rng;
use nalgebra::{Vector2, Vector3};
use opm_analysis::{NoTransmission, Transmissions};
use opm_core::Manipulator;
use opm_core::manipulator::Solution;

const CLOSE: f64 = 1e-7;

/// Two legs with two links each, and a third one that constrains the platform.
fn planar(third: &str, motors: [bool; 2]) -> Manipulator {
    let [a, b] = motors;
    let text = format!(
        r#"
format = 1
name = "constrained"
units = {{ length = "mm", angle = "deg" }}
[platform]
point = [0, 0, 0]
[[leg]]
name = "a"
joints = [
  {{ name = "a1", type = "revolute", axis = [0, 0, 1], point = [-300, -200, 0], actuated = {a} }},
  {{ name = "a2", type = "revolute", axis = [0, 0, 1], point = [-250, 10, 0] }},
  {{ name = "a3", type = "revolute", axis = [0, 0, 1], point = [-60, 40, 0] }},
]
[[leg]]
name = "b"
joints = [
  {{ name = "b1", type = "revolute", axis = [0, 0, 1], point = [300, -200, 0], actuated = {b} }},
  {{ name = "b2", type = "revolute", axis = [0, 0, 1], point = [280, 30, 0] }},
  {{ name = "b3", type = "revolute", axis = [0, 0, 1], point = [60, 20, 0] }},
]
[[leg]]
name = "c"
joints = [{third}]
"#
    );
    Manipulator::read(&text).unwrap()
}

/// A slider along y that carries a joint.
const SLIDER: &str = r#"
  { name = "c1", type = "prismatic", axis = [0, 1, 0], point = [0, -40, 0] },
  { name = "c2", type = "revolute", axis = [0, 0, 1], point = [0, -40, 0] },
"#;
/// A link between two joints.
const LINK: &str = r#"
  { name = "c1", type = "revolute", axis = [0, 0, 1], point = [30, -240, 0] },
  { name = "c2", type = "revolute", axis = [0, 0, 1], point = [0, -40, 0] },
"#;

/// The moved points and axes of the joints of every leg, from base to platform.
fn joints(manipulator: &Manipulator, at: &Solution) -> Vec<Vec<[Vector3<f64>; 2]>> {
    let mut values = at.joints();
    let of = |leg: &opm_core::Leg| {
        let mut g = nalgebra::Isometry3::identity();
        let each = leg.joints.iter().map(|joint| {
            let found = [(g * joint.point).coords, g.rotation * joint.axis.into_inner()];
            let (own, rest) = values.split_at(joint.coordinates.len());
            values = rest;
            g *= joint.displacement(own).unwrap();
            found
        });
        each.collect()
    };
    manipulator.mechanism().legs.iter().map(of).collect()
}

/// Solved poses around home.
fn each_pose(manipulator: &Manipulator, seed: u64, spread: f64, mut see: impl FnMut(&Solution)) {
    let (mut rng, mut at) = (Rng::with_seed(seed), manipulator.solution());
    let mut seen = 0;
    for _ in 0..200 {
        let home = manipulator.home_pose();
        let pose: Vec<f64> = home.iter().map(|h| h + spread * (rng.f64() - 0.5)).collect();
        let mode = manipulator.home_mode();
        if manipulator.inverse(&pose, mode, &mut at).unwrap().is_some() {
            see(&at);
            seen += 1;
        }
    }
    assert!(seen > 50, "{seen} poses");
}

/// Where two lines meet, each by a point and a direction.
fn meet([p, u]: [Vector2<f64>; 2], [q, v]: [Vector2<f64>; 2]) -> Vector2<f64> {
    p + u * ((q - p).perp(&v) / u.perp(&v))
}

fn sine(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    (a.perp(&b) / (a.norm() * b.norm())).abs()
}

#[test]
fn a_planar_constraint_has_its_pressure_angle() {
    for (third, seed) in [(SLIDER, 1), (LINK, 2)] {
        let manipulator = planar(third, [true, true]);
        assert_eq!(manipulator.task_coordinates().len(), 2);
        let mut transmissions = Transmissions::new(&manipulator).unwrap();
        each_pose(&manipulator, seed, 0.05, |at| {
            transmissions.update(at);
            let legs = joints(&manipulator, at);
            let point = |leg: usize, i: usize| legs[leg][i][0].xy();
            let end = point(2, 1);
            // What the constraining leg bears: a force across the slider, or along the link.
            let borne = if third == SLIDER { Vector2::x() } else { end - point(2, 0) };
            let line = |leg: usize| match leg {
                2 => [end, borne],
                leg => [point(leg, 2), point(leg, 2) - point(leg, 1)],
            };
            let found: Vec<_> = transmissions.constraints().collect();
            let [found] = found[..] else { panic!("{} constraints", found.len()) };
            assert_eq!(found.legs, [2]);
            let turns_about = meet(line(0), line(1));
            let expected = sine(borne, end - turns_about);
            assert!((found.output.unwrap() - expected).abs() < CLOSE, "{found:?} {expected}");
            assert_eq!(transmissions.constraint(), found.output);
            for found in transmissions.inputs() {
                let (leg, other) = (found.leg, 1 - found.leg);
                let [_, link] = line(leg);
                let expected = sine(point(leg, 1) - point(leg, 0), link);
                assert!((found.input - expected).abs() < CLOSE, "{found:?} {expected}");
                let expected = sine(link, point(leg, 2) - meet(line(other), line(2)));
                assert!((found.output - expected).abs() < CLOSE, "{found:?} {expected}");
            }
        });
    }
}

/// A motor in the leg that constrains: with the motor of the other leg it makes a five-bar. The force of each motor passes
/// through the joint where both legs meet. While the motor is locked the platform turns about the end of its link.
#[test]
fn a_motor_in_a_constraining_leg_has_indices() {
    let third = LINK.replacen("point =", "actuated = true, point =", 1);
    let manipulator = planar(&third, [true, false]);
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    each_pose(&manipulator, 3, 0.05, |at| {
        transmissions.update(at);
        let legs = joints(&manipulator, at);
        let point = |leg: usize, i: usize| legs[leg][i][0].xy();
        let [a, c] = transmissions.inputs() else { panic!("{:?}", transmissions.inputs()) };
        let link = point(0, 2) - point(0, 1);
        assert!((a.input - sine(point(0, 1) - point(0, 0), link)).abs() < CLOSE);
        assert!((a.output - sine(link, point(0, 2) - point(2, 1))).abs() < CLOSE);
        let end = point(2, 1);
        let borne = end - point(2, 0);
        assert!((c.input - sine(borne, point(0, 2) - end)).abs() < CLOSE, "{c:?}");
        assert!((c.output - sine(link, point(0, 2) - end)).abs() < CLOSE, "{c:?}");
        // Released, the constraint lets the platform's joint move along the link: it turns about the point where the line of
        // the other leg's force meets the line of a force across the link at its end.
        let across = Vector2::new(-borne.y, borne.x);
        let expected = sine(borne, end - meet([point(0, 2), link], [end, across]));
        let found = transmissions.constraint().unwrap();
        assert!((found - expected).abs() < CLOSE, "{found} {expected}");
    });
}

#[test]
fn a_spherical_constraint_has_its_dihedral_angle() {
    let revolute = |name: &str, axis: &str, motor: bool| {
        format!(
            r#"{{ name = "{name}", type = "revolute", axis = {axis}, point = [0, 0, 0], actuated = {motor} }},"#
        )
    };
    let text = format!(
        r#"
format = 1
name = "wrist"
units = {{ length = "mm", angle = "deg" }}
[platform]
point = [0, 0, 100]
[[leg]]
name = "a"
joints = [{} {} {}]
[[leg]]
name = "b"
joints = [{} {} {}]
[[leg]]
name = "c"
joints = [{} {}]
"#,
        revolute("a1", "[1, 0, 0]", true),
        revolute("a2", "[0, 0.6, 0.8]", false),
        revolute("a3", "[0.3, 0.9, -0.2]", false),
        revolute("b1", "[0, 1, 0]", true),
        revolute("b2", "[0.8, 0, -0.6]", false),
        revolute("b3", "[-0.2, 0.4, 0.9]", false),
        revolute("c1", "[1, 0.2, 0.1]", false),
        revolute("c2", "[0.3, 0.9, 0.2]", false),
    );
    let manipulator = Manipulator::read(&text).unwrap();
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    each_pose(&manipulator, 4, 0.4, |at| {
        transmissions.update(at);
        let legs = joints(&manipulator, at);
        let axis = |leg: usize, i: usize| legs[leg][i][1];
        let moment = |leg: usize| axis(leg, 1).cross(&axis(leg, 2));
        let dihedral = |at: Vector3<f64>, a: Vector3<f64>, b: Vector3<f64>| {
            let [a, b] = [a, b].map(|c| (c - at * at.dot(&c)).normalize());
            a.cross(&b).norm()
        };
        let turns = moment(0).cross(&moment(1)).normalize();
        let expected = dihedral(axis(2, 1), axis(2, 0), turns);
        let found = transmissions.constraint().unwrap();
        assert!((found - expected).abs() < CLOSE, "{found} {expected}");
    });
}

#[test]
fn it_is_said_why_there_is_no_constraint_index() {
    for name in ["planar-3rrr", "plano-spherical-5dof", "orbita"] {
        let manipulator = Manipulator::example(name).unwrap();
        let transmissions = Transmissions::new(&manipulator).unwrap();
        assert_eq!(transmissions.has_constraints(), Err(NoTransmission::NoConstraint), "{name}");
        assert_eq!((transmissions.constraint(), transmissions.constraints().count()), (None, 0));
    }
}
