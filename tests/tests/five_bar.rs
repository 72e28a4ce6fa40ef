//! Five-bars in a plane and on a sphere: both legs count alike. The local transmission index is the least of the sines of
//! both elbows and of the angle between the forearms (X.-J. Liu, J. Wang, G. Pritschow, *Performance atlases and optimum
//! design of planar 5R symmetrical parallel mechanisms*, Mechanism and Machine Theory 41, 2006; of a slider, the cosine of the
//! angle between it and its rod), and condition numbers are those of the velocity of the hand.

use fastrand::Rng;
use nalgebra::{Matrix2, UnitQuaternion, Vector2, Vector3};
use opm_analysis::Transmissions;
use opm_core::manipulator::Solution;
use opm_core::mechanism::joint::JointKind;
use opm_core::{Leg, Manipulator};
use opm_workspace::{Conditioned, Modes, PoseLimit};

/// Rounding of a closed form and a few dozen operations; near stretched legs its square root.
const CLOSE: f64 = 1e-7;

/// Arms of 150 mm on shoulders 400 mm apart, as of a plotter; the platform is the right forearm.
const PLOTTER: [(&str, &str); 2] = [
    (
        "L",
        r#"
  { name = "L", type = "revolute", axis = [0, 0, 1], point = [0, 0, 0], actuated = true },
  { name = "LE", type = "revolute", axis = [0, 0, 1], point = [144.37410025544926, 40.69544416061194, 0] },
  { name = "pen", type = "revolute", axis = [0, 0, 1], point = [200, 180, 0] },"#,
    ),
    (
        "R",
        r#"
  { name = "R", type = "revolute", axis = [0, 0, 1], point = [400, 0, 0], actuated = true },
  { name = "RE", type = "revolute", axis = [0, 0, 1], point = [255.62589974455074, 40.69544416061194, 0] },"#,
    ),
];

/// Two sliders with rods that hold one hinge (X.-J. Liu, J. Wang, *Some new parallel mechanisms containing the planar
/// four-bar parallelogram*, Int. J. Robotics Research 22, 2003, has such ones).
const SLIDERS: [(&str, &str); 2] = [
    (
        "1",
        r#"
  { name = "p1", type = "prismatic", axis = [0, 1, 0], point = [-150, 0, 0], actuated = true },
  { name = "r1", type = "revolute", axis = [0, 0, 1], point = [-150, 0, 0] },"#,
    ),
    (
        "2",
        r#"
  { name = "p2", type = "prismatic", axis = [0, 1, 0], point = [150, 0, 0], actuated = true },
  { name = "r2", type = "revolute", axis = [0, 0, 1], point = [150, 20, 0] },
  { name = "hand", type = "revolute", axis = [0, 0, 1], point = [10, 200, 0] },"#,
    ),
];

fn mechanism(point: &str, legs: &[(&str, &str)]) -> Manipulator {
    let mut text = format!(
        "format = 1\nname = \"five-bar\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n[platform]\npoint = {point}\n"
    );
    for (name, joints) in legs {
        text += &format!("[[leg]]\nname = \"{name}\"\njoints = [{joints}\n]\n");
    }
    Manipulator::read(&text).unwrap()
}

/// The moved points and axes of the joints of a leg, from base to platform.
fn moved(leg: &Leg, mut values: &[f64]) -> Vec<[Vector3<f64>; 2]> {
    let mut g = nalgebra::Isometry3::identity();
    let each = leg.joints.iter().map(|joint| {
        let found = [(g * joint.point).coords, g.rotation * joint.axis.into_inner()];
        let (own, rest) = values.split_at(joint.coordinates.len());
        values = rest;
        g *= joint.displacement(own).unwrap();
        found
    });
    each.collect()
}

/// One arm: its motor, the elbow, and the forearm to the hand.
struct Arm {
    slides: bool,
    /// The slider's direction, or the upper arm.
    first: Vector2<f64>,
    forearm: Vector2<f64>,
    elbow: Vector2<f64>,
}

/// Both arms of a planar five-bar, and the hand.
fn arms(manipulator: &Manipulator, at: &Solution) -> ([Arm; 2], Vector2<f64>) {
    let legs = &manipulator.mechanism().legs;
    let count = legs[0].coordinates().count();
    let (one, other) = at.joints().split_at(count);
    let moved = [moved(&legs[0], one), moved(&legs[1], other)];
    let full = moved.iter().find(|joints| joints.len() == 3).unwrap();
    let hand = full[2][0].xy();
    let arm = |leg: usize| {
        let slides = legs[leg].joints[0].kind == JointKind::Prismatic;
        let elbow = moved[leg][1][0].xy();
        let first = if slides { moved[leg][0][1].xy() } else { elbow - moved[leg][0][0].xy() };
        Arm { slides, first, forearm: hand - elbow, elbow }
    };
    ([arm(0), arm(1)], hand)
}

fn sine(a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    (a.perp(&b) / (a.norm() * b.norm())).abs()
}

impl Arm {
    /// The pressure angle's cosine at the elbow.
    fn input(&self) -> f64 {
        let sine = sine(self.first, self.forearm);
        if self.slides { (1.0 - sine * sine).sqrt() } else { sine }
    }

    /// The rate of the motor for velocities of the hand: the forearm keeps its length.
    fn rates(&self) -> Vector2<f64> {
        let velocity = match self.slides {
            true => self.first,
            false => Vector2::new(-self.first.y, self.first.x),
        };
        self.forearm / self.forearm.dot(&velocity)
    }
}

/// Solved poses in all working modes.
fn each_pose(
    manipulator: &Manipulator,
    seed: u64,
    spread: f64,
    mut see: impl FnMut(&Manipulator, &[f64], opm_core::Mode, &Solution),
) {
    let (mut rng, mut at, mut seen) = (Rng::with_seed(seed), manipulator.solution(), 0);
    for _ in 0..300 {
        let home = manipulator.home_pose();
        let pose: Vec<f64> = home.iter().map(|h| h + spread * (rng.f64() - 0.5)).collect();
        for mode in manipulator.modes() {
            if manipulator.inverse(&pose, mode, &mut at).unwrap().is_some() {
                see(manipulator, &pose, mode, &at);
                seen += 1;
            }
        }
    }
    assert!(seen > 200, "{seen} poses");
}

/// The condition number of a pose alone, and among others, which is computed in blocks.
fn conditions(manipulator: &Manipulator, pose: &[f64], mode: opm_core::Mode, at: &Solution) -> f64 {
    let mut jacobians = manipulator.jacobians();
    manipulator.differentiate(at, &mut jacobians).unwrap();
    let length = manipulator.characteristic_length();
    let alone = manipulator.conditioning(&jacobians, length).condition;
    let mut conditioned = Conditioned::new(manipulator, PoseLimit::none(length));
    let many: Vec<f64> = pose.iter().copied().cycle().take(20 * pose.len()).collect();
    let mut indices = [0.0; 20];
    conditioned.local_indices(&many, Modes::One(mode), &mut indices);
    assert!(indices.iter().all(|&index| index == alone.recip()), "{indices:?} {alone}");
    alone
}

fn condition(rates: Matrix2<f64>) -> f64 {
    let values = rates.svd(false, false).singular_values;
    values[0] / values[1]
}

#[test]
fn a_planar_five_bar_has_the_sines_of_its_angles() {
    let shipped = Manipulator::example("five-bar").unwrap();
    // The platform may be either forearm.
    let mirrored = [PLOTTER[1], PLOTTER[0]];
    for (manipulator, spread) in [
        (mechanism("[200, 180, 0]", &PLOTTER), 0.3),
        (mechanism("[200, 180, 0]", &mirrored), 0.3),
        (mechanism("[10, 200, 0]", &SLIDERS), 0.4),
        (shipped, 0.5),
    ] {
        let mut transmissions = Transmissions::new(&manipulator).unwrap();
        each_pose(&manipulator, 1, spread, |manipulator, pose, mode, at| {
            let (arms, hand) = arms(manipulator, at);
            assert!((hand - Vector2::new(pose[0], pose[1])).norm() < 1e-9);
            transmissions.update(at);
            let output = sine(arms[0].forearm, arms[1].forearm);
            assert_eq!(transmissions.inputs().len(), 2);
            for found in transmissions.inputs() {
                assert!((found.input - arms[found.leg].input()).abs() < CLOSE, "{found:?}");
                assert!((found.output - output).abs() < CLOSE, "{found:?} {output}");
            }
            let expected = arms[0].input().min(arms[1].input()).min(output);
            assert!((transmissions.whole().local() - expected).abs() < CLOSE);
            if expected > 1e-3 {
                let [a, b] = arms.map(|arm| arm.rates());
                let expected = condition(Matrix2::from_rows(&[a.transpose(), b.transpose()]));
                let found = conditions(manipulator, pose, mode, at);
                assert!((found / expected - 1.0).abs() < CLOSE, "{found} {expected}");
            }
        });
    }
}

/// A pose, and its mirror image in the working mode in which the elbows are mirrored.
#[test]
fn mirrored_poses_have_the_same_numbers() {
    let manipulator = mechanism("[200, 180, 0]", &PLOTTER);
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    let mirror = |p: Vector2<f64>| Vector2::new(0.4 - p.x, p.y);
    let mut other = manipulator.solution();
    each_pose(&manipulator, 2, 0.3, |manipulator, pose, mode, at| {
        let ([left, right], _) = arms(manipulator, at);
        let image = [0.4 - pose[0], pose[1]];
        let same = manipulator.modes().find(|&mode| {
            let reached = manipulator.inverse(&image, mode, &mut other).unwrap().is_some();
            let close = |a: Vector2<f64>, b: Vector2<f64>| (a - mirror(b)).norm() < 1e-9;
            reached && {
                let ([one, two], _) = arms(manipulator, &other);
                close(one.elbow, right.elbow) && close(two.elbow, left.elbow)
            }
        });
        let image_mode = same.expect("the mirrored pose is in reach");
        let mut of = |at: &Solution| {
            transmissions.update(at);
            transmissions.whole()
        };
        let (a, b) = (of(at), of(&other));
        assert!((a.input - b.input).abs() < CLOSE && (a.output - b.output).abs() < CLOSE);
        if a.local() > 1e-3 {
            let here = conditions(manipulator, pose, mode, at);
            let there = conditions(manipulator, &image, image_mode, &other);
            assert!((here / there - 1.0).abs() < CLOSE, "{here} {there}");
        }
    });
}

#[test]
fn a_stretched_arm_transmits_nothing() {
    let manipulator = mechanism("[200, 180, 0]", &PLOTTER);
    let mut transmissions = Transmissions::new(&manipulator).unwrap();
    let mut at = manipulator.solution();
    for (shoulder, towards) in [(0.0, 1.0), (0.4, -1.0)] {
        for angle in [0.8_f64, 1.0, 1.2] {
            let reach = 0.3 * (1.0 - 1e-13);
            let pose = [shoulder + towards * reach * angle.cos(), reach * angle.sin()];
            for mode in manipulator.modes() {
                if manipulator.inverse(&pose, mode, &mut at).unwrap().is_some() {
                    transmissions.update(&at);
                    let found = transmissions.whole().local();
                    assert!(found < 1e-5, "{pose:?}: {found}");
                }
            }
        }
    }
}

/// On a sphere arcs stand for links: dihedral angles at the elbows, and that between the planes of the second arcs at the
/// joint that joins them.
#[test]
fn a_spherical_five_bar_has_the_sines_of_its_dihedral_angles() {
    let revolute = |name: &str, axis: &str, motor: bool| {
        format!(
            r#"{{ name = "{name}", type = "revolute", axis = {axis}, point = [0, 0, 0], actuated = {motor} }},"#
        )
    };
    let legs = [
        revolute("a1", "[1, 0, 0]", true) + &revolute("a2", "[0, 0.3, 1]", false),
        revolute("b1", "[0, 1, 0]", true)
            + &revolute("b2", "[0.75, 0.125, 1]", false)
            + &revolute("b3", "[0.2, -1, 1.2]", false),
    ];
    let dihedral = |at: Vector3<f64>, a: Vector3<f64>, b: Vector3<f64>| {
        let [a, b] = [a, b].map(|c| (c - at * at.dot(&c)).normalize());
        a.cross(&b).norm()
    };
    for order in [[0, 1], [1, 0]] {
        let named = order.map(|leg| (["a", "b"][leg], legs[leg].as_str()));
        let manipulator = mechanism("[0, 0, 100]", &named);
        let mut transmissions = Transmissions::new(&manipulator).unwrap();
        each_pose(&manipulator, 3, 1.0, |manipulator, pose, mode, at| {
            let (one, other) =
                at.joints().split_at(manipulator.mechanism().legs[0].coordinates().count());
            let legs = &manipulator.mechanism().legs;
            let moved = [moved(&legs[0], one), moved(&legs[1], other)];
            let hand = moved.iter().find(|leg| leg.len() == 3).unwrap()[2][1];
            let output = dihedral(hand, moved[0][1][1], moved[1][1][1]);
            transmissions.update(at);
            let mut least = output;
            for found in transmissions.inputs() {
                let [motor, elbow] = [0, 1].map(|joint| moved[found.leg][joint][1]);
                let input = dihedral(elbow, motor, hand);
                assert!((found.input - input).abs() < CLOSE, "{found:?} {input}");
                assert!((found.output - output).abs() < CLOSE, "{found:?} {output}");
                least = least.min(input);
            }
            assert!((transmissions.whole().local() - least).abs() < CLOSE);
            if least > 1e-2 {
                // The arc from elbow to hand is rigid: e · ṗ + q̇ (s × e) · p = 0, with the hand's velocity in its plane.
                let turn =
                    UnitQuaternion::rotation_between(&Vector3::z(), &hand).unwrap_or_else(|| {
                        UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
                    });
                let [x, y] = [Vector3::x(), Vector3::y()].map(|axis| turn * axis);
                let rates = |leg: usize| {
                    let [s, e] = [0, 1].map(|joint| moved[leg][joint][1]);
                    nalgebra::RowVector2::new(e.dot(&x), e.dot(&y)) / s.cross(&e).dot(&hand)
                };
                let expected = condition(Matrix2::from_rows(&[rates(0), rates(1)]));
                let found = conditions(manipulator, pose, mode, at);
                assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
            }
        });
    }
}
