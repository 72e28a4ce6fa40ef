//! Legs with parallelograms, against plain geometry and against the same legs with hinges that do not hold each other.

use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Rotation3, Vector3};
use opm_core::Manipulator;
use opm_core::decomposition::PlatformSet;
use opm_core::decomposition::mobility::mobility;
use opm_core::linkage::Linkage;
use opm_core::mechanism::file;

/// The dimensions of the Delta, metres: base, platform, crank, rod.
const DELTA: [f64; 4] = [0.2, 0.045, 0.25, 0.52];

/// A Delta as it is built: each rod is a parallelogram, and the cranks hang by 20 degrees.
const DELTA_FILE: &str = r#"
format = 1
name = "delta"
units = { length = "mm", angle = "deg" }
[parameters]
x = "200 + 250*cos(20)"
z = "-250*sin(20)"
below = "z - sqrt(520^2 - (x - 45)^2)"
[platform]
point = [0, 0, "below"]
[[leg]]
name = "leg{i}"
pattern = { count = 3, axis = [0, 0, 1] }
joints = [
  { name = "m{i}", type = "revolute", axis = [0, 1, 0], point = [200, 0, 0], actuated = true, home = 20 },
  { name = "e{i}", type = "revolute", axis = [0, 1, 0], point = ["x", 0, "z"] },
  { name = "p{i}", type = "parallelogram", axis = ["z - below", 0, "45 - x"], point = ["x", 0, "z"], point2 = [45, 0, "below"] },
  { name = "w{i}", type = "revolute", axis = [0, 1, 0], point = [45, 0, "below"] },
]
"#;

/// Two sliders on one rail, each with a parallelogram: the platform moves in the plane and does not turn.
const RAIL_FILE: &str = include_str!("parallelograms/rail.toml");

/// Legs in one plane whose platform turns behind the parallelogram.
const TURNING_FILE: &str = r#"
format = 1
name = "turning"
units = { length = "mm", angle = "deg" }
platform = { point = [0, 0, 0] }
[[leg]]
name = "leg{i}"
pattern = { count = 3, axis = [0, 0, 1] }
joints = [
  { name = "a{i}", type = "revolute", axis = [0, 0, 1], point = [300, 0, 0], actuated = true },
  { name = "p{i}", type = "parallelogram", axis = [0, 0, 1], point = [250, 150, 0], point2 = [100, 0, 0] },
  { name = "b{i}", type = "revolute", axis = [0, 0, 1], point = [90, 20, 0] },
]
"#;

/// Legs of the Delta, each with a hinge about the vertical at its end, turned by these angles: translations and rotations about
/// the vertical. Nothing but the parallelograms keeps the links behind them from turning.
fn schoenflies() -> String {
    let vertical = r#"{ name = "v{i}", type = "revolute", axis = [0, 0, 1], point = [45, 0, "below"] },
]"#;
    let pattern = "pattern = { angles = [0, 95, 180, 250], axis = [0, 0, 1] }";
    DELTA_FILE
        .replace("pattern = { count = 3, axis = [0, 0, 1] }", pattern)
        .replace("\n]\n", &format!("\n  {vertical}\n"))
}

fn made(text: &str) -> Manipulator {
    Manipulator::new(file::read(text).unwrap().mechanism).unwrap()
}

/// The values of joints whose names start with a letter, leg by leg.
fn named(manipulator: &Manipulator, joints: &[f64], letter: char, suffix: &str) -> Vec<f64> {
    let each = manipulator.coordinates().iter().zip(joints);
    each.filter(|(c, _)| c.name.starts_with(letter) && c.name[2..] == *suffix)
        .map(|(_, value)| *value)
        .collect()
}

/// Angles that are equal but for full turns.
fn same_angle(a: f64, b: f64) -> bool {
    ((a - b) * 0.5).sin().abs() < 1e-9
}

/// The angles of a Delta's crank, downwards from the plane of the base, at which its end is a rod away from the platform: a
/// circle about the base's axis meets a sphere.
fn cranks(number: usize, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
    let [base, platform, crank, rod] = DELTA;
    let turned =
        Rotation3::from_axis_angle(&Vector3::z_axis(), -120_f64.to_radians() * number as f64);
    let end = turned * Vector3::new(x, y, z) + Vector3::new(platform - base, 0.0, 0.0);
    // |end - crank (cos t, 0, -sin t)| = rod.
    let (a, b) = (end.x, -end.z);
    let c = (end.norm_squared() + crank * crank - rod * rod) / (2.0 * crank);
    let (middle, half) = (b.atan2(a), c / a.hypot(b));
    (half.abs() <= 1.0).then(|| [middle + half.acos(), middle - half.acos()])
}

#[test]
fn cranks_of_a_delta_are_where_circles_meet_spheres() {
    let m = made(DELTA_FILE);
    assert_eq!(m.decomposition().platform(), PlatformSet::Subgroup);
    assert_eq!((m.decomposition().mobility, m.task_coordinates().len()), (3, 3));
    let mut rng = Rng::with_seed(1);
    let mut at = m.solution();
    let (mut reached, mut missed) = (0, 0);
    for _ in 0..300 {
        let pose = [0.5 * rng.f64() - 0.25, 0.5 * rng.f64() - 0.25, -0.15 - 0.6 * rng.f64()];
        let expected: Option<Vec<[f64; 2]>> = (0..3).map(|leg| cranks(leg, pose)).collect();
        for mode in m.modes() {
            let solved = m.inverse(&pose, mode, &mut at).unwrap();
            assert_eq!(solved.is_some(), expected.is_some(), "{pose:?}");
            let (Some(solution), Some(expected)) = (solved, &expected) else {
                missed += 1;
                continue;
            };
            reached += 1;
            let joints = solution.joints();
            for (found, both) in named(&m, joints, 'm', "").into_iter().zip(expected) {
                assert!(both.iter().any(|&angle| same_angle(found, angle)), "{found} {both:?}");
            }
            let (turned, back) = (named(&m, joints, 'p', ""), named(&m, joints, 'p', ".end"));
            assert_eq!(turned.len(), 3);
            assert!(turned.iter().zip(&back).all(|(a, b)| same_angle(*a, -b)));
        }
    }
    assert!(reached > 1000 && missed > 1000, "{reached} {missed}");
}

#[test]
fn sliders_on_a_rail_are_where_circles_meet_a_line() {
    let m = made(RAIL_FILE);
    assert_eq!(m.decomposition().mobility, 2);
    let mut at = m.solution();
    let at_home = m.inverse(&m.home_pose(), m.home_mode(), &mut at).unwrap().unwrap();
    assert!(at_home.joints().iter().all(|value| value.abs() < 1e-12));
    // From the end of its bar, 0.36 m long, each slider is on its own side.
    let bar = 0.2_f64.hypot(0.3);
    let mut rng = Rng::with_seed(2);
    for _ in 0..100 {
        let target = Isometry3::translation(0.6 * rng.f64() - 0.3, 0.0, 0.4 * rng.f64() - 0.2);
        let moved = target.translation.vector;
        let down = 0.3 - moved.z;
        let pose = m.locate(&target).unwrap();
        let solved = m.inverse(&pose, m.home_mode(), &mut at).unwrap();
        assert_eq!(solved.is_some(), down.abs() <= bar, "{moved:?}");
        let Some(solution) = solved else { continue };
        let out = (bar * bar - down * down).sqrt();
        let sliders = named(&m, solution.joints(), 's', "");
        assert!((sliders[0] - (moved.x - 0.05 - out + 0.25)).abs() < 1e-12);
        assert!((sliders[1] - (moved.x + 0.05 + out - 0.25)).abs() < 1e-12);
    }
}

/// Without what holds the hinges, the same rail has one more freedom: the platform turns.
#[test]
fn hinges_that_turn_back_take_a_freedom() {
    let mut mechanism = file::read(RAIL_FILE).unwrap().mechanism;
    assert_eq!(mobility(&mechanism).unwrap().mobility, 2);
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        joint.turns_back = false;
    }
    assert_eq!(mobility(&mechanism).unwrap().mobility, 3);
}

#[test]
fn rates_of_the_two_hinges_are_opposite() {
    for text in [DELTA_FILE, RAIL_FILE] {
        let m = made(text);
        let (mut at, mut motion) = (m.solution(), m.joint_motion());
        m.inverse(&m.home_pose(), m.home_mode(), &mut at).unwrap().unwrap();
        let rates: Vec<f64> =
            (0..m.task_coordinates().len()).map(|i| 0.3 - 0.2 * i as f64).collect();
        assert!(m.velocity(&at, &rates, &rates, &mut motion).unwrap());
        let joints = motion.joint_rates;
        let (turned, back) = (named(&m, &joints, 'p', ""), named(&m, &joints, 'p', ".end"));
        assert!(!turned.is_empty() && turned.iter().any(|rate| rate.abs() > 0.01));
        assert!(
            turned.iter().zip(&back).all(|(a, b)| (a + b).abs() < 1e-12),
            "{turned:?} {back:?}"
        );
    }
}

/// Two parallelograms in a row between hinges about the vertical, in two such legs: the Schoenflies Motion Generator.
const GENERATOR_FILE: &str = include_str!("parallelograms/generator.toml");

/// The platform turns behind a parallelogram. The joints are held to the legs' products of exponentials, in every mode, and
/// joints from which a pose was made are among those that are found.
#[test]
fn platforms_turn_behind_parallelograms() {
    let generator = GENERATOR_FILE.to_owned();
    let files = [(TURNING_FILE.to_owned(), 3), (schoenflies(), 4), (generator, 4), (seven(), 4)];
    for (text, freedoms) in files {
        let m = made(&text);
        assert_eq!(m.decomposition().mobility, freedoms, "{text}");
        let (mut at, mut rng) = (m.solution(), Rng::with_seed(3));
        let mechanism = m.mechanism();
        let (mut closed, mut back) = (0, 0);
        for _ in 0..60 {
            let size = m.characteristic_length();
            let near = |c: &opm_core::task::TaskCoordinate, share: f64| {
                let unit = if c.quantity == opm_core::Quantity::Length { 0.2 * size } else { 0.6 };
                c.home + unit * (2.0 * share - 1.0)
            };
            let pose: Vec<f64> = m.task_coordinates().iter().map(|c| near(c, rng.f64())).collect();
            for mode in m.modes() {
                let target = opm_tests::displacement(&m, &pose, mode);
                let Some(solution) = m.inverse(&pose, mode, &mut at).unwrap() else { continue };
                closed += 1;
                let mut joints = solution.joints();
                for leg in &mechanism.legs {
                    let (own, rest) = joints.split_at(leg.coordinates().count());
                    joints = rest;
                    let off = target.inverse() * leg.displacement(own).unwrap();
                    assert!(off.rotation.angle() < 1e-9, "{text}");
                    assert!((off * mechanism.platform - mechanism.platform).norm() < 1e-9 * size);
                    for (number, turns_back) in leg.turn_back().into_iter().enumerate() {
                        if turns_back {
                            assert!(same_angle(own[number], -own[number - 1]));
                            back += 1;
                        }
                    }
                }
            }
        }
        assert!(closed > 100 && back >= closed, "{closed} {back}");
    }
}

/// Rates and accelerations against differences of inverse kinematics.
#[test]
fn rates_are_the_derivatives_of_the_joints() {
    for text in
        [DELTA_FILE.to_owned(), TURNING_FILE.to_owned(), schoenflies(), GENERATOR_FILE.to_owned()]
    {
        let m = made(&text);
        let (mut at, mut other, mut motion) = (m.solution(), m.solution(), m.joint_motion());
        let home = m.home_pose();
        let pose: Vec<f64> =
            home.iter().enumerate().map(|(i, q)| q + 0.01 * (i as f64 + 1.0)).collect();
        let rates: Vec<f64> = (0..pose.len()).map(|i| 0.3 - 0.2 * i as f64).collect();
        let second: Vec<f64> = (0..pose.len()).map(|i| 0.1 * i as f64 - 0.2).collect();
        m.inverse(&pose, m.home_mode(), &mut at).unwrap().unwrap();
        assert!(m.velocity(&at, &rates, &second, &mut motion).unwrap());
        let step = 1e-4;
        let mut joints = |t: f64| {
            let moved: Vec<f64> =
                (0..pose.len()).map(|i| pose[i] + t * rates[i] + 0.5 * t * t * second[i]).collect();
            other.clone_from(&at);
            let found = m.inverse_near(&moved, m.home_mode(), &mut other).unwrap().unwrap();
            found.joints().to_vec()
        };
        let (before, here, after) = (joints(-step), joints(0.0), joints(step));
        for i in 0..here.len() {
            let rate = (after[i] - before[i]) / (2.0 * step);
            let acceleration = (after[i] - 2.0 * here[i] + before[i]) / (step * step);
            let scale = 1.0 + rate.abs();
            assert!((motion.joint_rates[i] - rate).abs() < 1e-6 * scale, "{text}");
            assert!(
                (motion.joint_accelerations[i] - acceleration).abs() < 1e-4 * scale * scale,
                "{text}"
            );
        }
    }
}

/// Forward kinematics finds the pose that the motors came from.
#[test]
fn the_pose_that_motors_came_from_is_found() {
    for text in [
        DELTA_FILE.to_owned(),
        RAIL_FILE.to_owned(),
        TURNING_FILE.to_owned(),
        schoenflies(),
        GENERATOR_FILE.to_owned(),
    ] {
        let m = made(&text);
        let mut at = m.solution();
        let pose: Vec<f64> = m.home_pose().iter().map(|q| q + 0.02).collect();
        let solution = m.inverse(&pose, m.home_mode(), &mut at).unwrap().unwrap();
        let actuated: Vec<f64> = m.actuated().iter().map(|&i| solution.joints()[i]).collect();
        // Home may be a parallel singularity.
        let start: Vec<f64> = pose.iter().map(|q| q + 0.03).collect();
        let found = m.forward_near(&actuated, &start, m.home_mode()).unwrap();
        for (a, b) in found.pose.iter().zip(&pose) {
            assert!((a - b).abs() < 1e-9, "{text}: {:?} {pose:?}", found.pose);
        }
    }
}

/// The generator with another hinge at the end of each leg, which the platform does not turn: legs of seven freedoms.
fn seven() -> String {
    let hinge = r#"  { name = "t{i}", type = "revolute", axis = [1, 0, 0], point = [60, 0, 110] },
]"#;
    let pattern = "pattern = { angles = [0, 90], axis = [0, 0, 1] }";
    GENERATOR_FILE
        .replace("pattern = { count = 2, axis = [0, 0, 1] }", pattern)
        .replace("\n]\n", &format!("\n{hinge}\n"))
}

/// A loop is traced where the other joints hold a parallelogram together, and refused by name where they do not.
#[test]
fn loops_are_traced_where_they_hold_a_parallelogram() {
    let of = |second: &str| {
        let at = RAIL_FILE.rfind("[[leg]]").unwrap();
        let text = format!("{}[[leg]]\njoints = [{second}]\n", &RAIL_FILE[..at]);
        Linkage::new(&file::read(&text).unwrap().mechanism)
    };
    // The platform goes up and down: the slider follows as far as the bar is long.
    let lift = of(r#"{ name = "lift", type = "prismatic", axis = [0, 0, 1], point = [0, 0, 0] }"#)
        .unwrap();
    let bar = 0.2_f64.hypot(0.3);
    let range = lift.input("lift").unwrap().range();
    let opm_core::linkage::InputRange::Intervals { intervals, .. } = range else { panic!() };
    let [[low, high]] = intervals[..] else { panic!("{intervals:?}") };
    assert!((low - 0.3 + bar).abs() < 1e-9 && (high - 0.3 - bar).abs() < 1e-9, "{low} {high}");
    // The other leg would turn the platform.
    let turns = r#"{ name = "a", type = "revolute", axis = [0, 1, 0], point = [200, 0, 0] },
        { name = "b", type = "revolute", axis = [0, 1, 0], point = [100, 0, -200] }"#;
    let refused = of(turns).unwrap_err().to_string();
    assert!(refused.contains("the two hinges of its parallelogram"), "{refused}");
}

/// The screw of both hinges together is a translation across the bar.
#[test]
fn one_screw_stands_for_both_hinges() {
    let mechanism = file::read(RAIL_FILE).unwrap().mechanism;
    let screws = mechanism.legs[0].independent_screws();
    assert_eq!((screws.len(), mechanism.legs[0].screws().len()), (2, 3));
    let bar = Point3::new(-0.05, 0.0, -0.3) - Point3::new(-0.25, 0.0, 0.0);
    assert!(screws[1].angular.norm() < 1e-15);
    assert!((screws[1].linear - Vector3::y().cross(&bar)).norm() < 1e-15);
}

/// The assembly that joints came from is proven: both hinges of a parallelogram are one unknown.
#[test]
fn assemblies_are_proven() {
    for text in [DELTA_FILE, TURNING_FILE] {
        let m = made(text);
        let mut at = m.solution();
        let pose: Vec<f64> =
            m.home_pose().iter().zip(1..).map(|(q, i)| q + 0.02 * f64::from(i)).collect();
        let solution = m.inverse(&pose, m.home_mode(), &mut at).unwrap().unwrap();
        let actuated: Vec<f64> = m.actuated().iter().map(|&i| solution.joints()[i]).collect();
        let list = m.forward(&actuated).unwrap().list;
        let is_pose = |found: &[f64]| found.iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-6);
        let number = list.iter().position(|assembly| is_pose(&assembly.pose)).unwrap();
        let certificates = m.certify(&list);
        let proof = certificates[number].proof().unwrap_or_else(|| panic!("not proven: {text}"));
        assert!(proof.radius < 1e-8 && proof.distinct, "{proof:?}");
    }
}
