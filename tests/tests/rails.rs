//! Balls that slide on a line: of the base and of the platform, as in a 3-PSP, or on a circle of the platform, as in a 2PUR-PSR. Both
//! against plain geometry.

use fastrand::Rng;
use nalgebra::{Isometry3, Vector3};
use opm_core::Manipulator;
use opm_core::decomposition::PlatformSet;
use opm_core::mechanism::file;

/// A 2PUR-PSR (Y. Xu and others, 2017), with dimensions of no particular machine.
const FILE: &str = include_str!("rails/2pur-psr.toml");

/// The same with its universal joints at the platform: the point stays on a line as it is seen from above.
const AT_PLATFORM: &str = include_str!("rails/2pru-psr.toml");

/// The same with base and platform exchanged: its last leg has the hinge at the base.
const EXCHANGED: &str = r#"
format = 1
name = "2RUP-RSP"
units = { length = "mm", angle = "deg" }
platform = { point = [0, 0, 300] }
[[leg]]
name = "left"
joints = [
  { name = "r1", type = "revolute", axis = [0, 1, 0], point = [100, 0, 0] },
  { name = "u1", type = "universal", axis = [0, 1, 0], axis2 = [1, 0, 0], point = [250, 0, 300] },
  { name = "p1", type = "prismatic", axis = [1, 0, 0], point = [250, 0, 300], actuated = true },
]
[[leg]]
name = "right"
joints = [
  { name = "r2", type = "revolute", axis = [0, 1, 0], point = [-100, 0, 0] },
  { name = "u2", type = "universal", axis = [0, 1, 0], axis2 = [1, 0, 0], point = [-250, 0, 300] },
  { name = "p2", type = "prismatic", axis = [1, 0, 0], point = [-250, 0, 300], actuated = true },
]
[[leg]]
name = "front"
joints = [
  { name = "r3", type = "revolute", axis = [1, 0, 0], point = [0, 100, 0] },
  { name = "s3", type = "spherical", point = [0, 250, 300] },
  { name = "p3", type = "prismatic", axis = [0, 1, 0], point = [0, 250, 300], actuated = true },
]
"#;

fn made(text: &str) -> Manipulator {
    Manipulator::new(file::read(text).unwrap().mechanism).unwrap()
}

fn value(m: &Manipulator, joints: &[f64], name: &str) -> f64 {
    joints[m.coordinates().iter().position(|c| *c.name == *name).unwrap()]
}

/// By how much the ends of the legs, by products of exponentials, miss the platform.
fn closure(m: &Manipulator, mut joints: &[f64], g: &Isometry3<f64>) -> f64 {
    let mechanism = m.mechanism();
    let ends = mechanism.legs.iter().map(|leg| {
        let (own, rest) = joints.split_at(leg.coordinates().count());
        joints = rest;
        let off = g.inverse() * leg.displacement(own).unwrap();
        off.rotation.angle().max((off * mechanism.platform - mechanism.platform).norm())
    });
    ends.fold(0.0, f64::max)
}

/// Where the ball of the last leg of a 2PUR-PSR slides at a pose by `y` of the platform's point, in every way: the first two
/// legs keep the point in their plane about the first axis, and the ball is in the plane of its circle, a rod away.
#[test]
fn a_2pur_psr_by_geometry() {
    let m = made(FILE);
    assert_eq!((m.decomposition().mobility, m.task_coordinates().len()), (3, 3));
    let names: Vec<&str> = m.dependent_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["x", "y", "yaw"]);
    let rod = 0.15_f64.hypot(0.3);
    let (mut rng, mut all, mut at) = (Rng::with_seed(5), m.all_modes(), m.solution());
    let (mut solved, mut most) = (0, 0);
    for sample in 0..150 {
        let tilt = if sample % 10 == 0 { 0.0 } else { 0.9 };
        let mut angle = || tilt * (rng.f64() - 0.5);
        let (roll, pitch) = (angle(), angle());
        let pose = [0.25 + 0.08 * rng.f64(), roll, pitch];
        let Some(found) = m.inverse_all(&pose, &mut all).unwrap() else { continue };
        let modes: Vec<_> = found.modes(&m).collect();
        let mut places: Vec<[f64; 4]> = Vec::new();
        for mode in modes {
            let g = m.displacement_in(&pose, mode).unwrap();
            let (p, turn) = ((g * m.mechanism().platform).coords, g.rotation.to_rotation_matrix());
            let joints = m.solution_in_mode(&all, mode, &mut at).unwrap().joints();
            // The universal joints' first axis stays across the platform's second direction.
            assert!(turn[(0, 1)].abs() < 1e-12, "{pose:?}");
            assert!(turn.matrix().column(1).dot(&p).abs() < 1e-12, "{pose:?}");
            let slid = value(&m, joints, "p3");
            let away = Vector3::new(0.0, 0.25 + slid, 0.0) - p - turn * Vector3::new(0.0, 0.1, 0.0);
            assert!(turn.matrix().column(0).dot(&away).abs() < 1e-11, "{pose:?} {away:?}");
            assert!((away.norm() - rod).abs() < 1e-11, "{pose:?} {away:?}");
            for (name, side) in [("p1", 1.0), ("p2", -1.0)] {
                let foot = Vector3::new(0.25 * side + value(&m, joints, name), 0.0, 0.0);
                let away = foot - p - turn * Vector3::new(0.1 * side, 0.0, 0.0);
                assert!((away.norm() - rod).abs() < 1e-11, "{pose:?}");
            }
            assert!(closure(&m, joints, &g) < 1e-11, "{pose:?}");
            places.push([slid, value(&m, joints, "p1"), value(&m, joints, "p2"), turn[(0, 0)]]);
            solved += 1;
        }
        most = most.max(places.len());
        // No assembly twice, at a roll and a pitch of zero, too, where the ball slides to two places at one pose.
        for (i, one) in places.iter().enumerate() {
            let same = |other: &[f64; 4]| one.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-9);
            assert!(!places[i + 1..].iter().any(same), "{pose:?} {places:?}");
        }
    }
    // Two ways to turn, two places of the ball, two of each of the other sliders.
    assert!(solved > 1000 && most == 16, "{solved} {most}");
}

/// The pose from which joints came is found again, and rates agree with differences.
#[test]
fn a_sliding_ball_at_either_end() {
    for text in [FILE, AT_PLATFORM, EXCHANGED] {
        let m = made(text);
        let mut rng = Rng::with_seed(7);
        let (mut at, mut motion) = (m.solution(), m.joint_motion());
        let (mut solved, mut compared) = (0, 0);
        // At home the ball has two places, and home's mode has it in its own; nowhere else are two modes one assembly.
        let at_home = m.inverse(&m.home_pose(), m.home_mode(), &mut at).unwrap().unwrap();
        assert!(at_home.joints().iter().all(|value| value.abs() < 1e-12), "{at_home:?}");
        let actuated = vec![0.0; m.actuated().len()];
        let found = m.forward(&actuated).unwrap().list;
        let home = m.displacement_in(&m.home_pose(), m.home_mode()).unwrap();
        assert!(found.iter().any(|assembly| {
            assembly.mode == m.home_mode()
                && m.platform_distance(&m.displacement_of(assembly), &home) < 1e-9
        }));
        for _ in 0..40 {
            let mut pose = m.home_pose();
            pose[0] += 0.05 * (rng.f64() - 0.5);
            pose[1] += 0.5 * (rng.f64() - 0.5);
            pose[2] += 0.5 * (rng.f64() - 0.5);
            let rates = [0.1, -0.3, 0.2];
            for mode in m.modes() {
                let Some(solution) = m.inverse(&pose, mode, &mut at).unwrap() else { continue };
                let joints = solution.joints().to_vec();
                let g = m.displacement_in(&pose, mode).unwrap();
                assert!(closure(&m, &joints, &g) < 1e-10, "{pose:?}");
                solved += 1;
                if !m.velocity(&at, &rates, &[0.0; 3], &mut motion).unwrap() {
                    continue;
                }
                let step = 1e-6;
                let mut moved = |by: f64| {
                    let pose: Vec<f64> =
                        pose.iter().zip(rates).map(|(q, rate)| q + by * rate).collect();
                    Some(m.inverse(&pose, mode, &mut at).unwrap()?.joints().to_vec())
                };
                let (Some(after), Some(before)) = (moved(step), moved(-step)) else { continue };
                let largest = motion.joint_rates.iter().fold(1.0, |a: f64, b| a.max(b.abs()));
                for ((after, before), rate) in after.iter().zip(&before).zip(&motion.joint_rates) {
                    let change = (after - before) / (2.0 * step);
                    assert!((change - rate).abs() < 1e-6 * largest.powi(3), "{change} {rate}");
                }
                compared += 1;
            }
        }
        assert!(solved > 250 && compared > 200, "{solved} {compared}");
    }
}

/// Several such legs leave one unknown more each: the second one is named.
#[test]
fn one_ball_slides() {
    let text = r#"
format = 1
name = "3-PSR"
units = { length = "mm", angle = "deg" }
platform = { point = [0, 0, 300] }
[[leg]]
name = "leg{i}"
pattern = { count = 3, axis = [0, 0, 1] }
joints = [
  { name = "p{i}", type = "prismatic", axis = [1, 0, 0], point = [250, 0, 0], actuated = true },
  { name = "s{i}", type = "spherical", point = [250, 0, 0] },
  { name = "r{i}", type = "revolute", axis = [0, 1, 0], point = [100, 0, 300] },
]
"#;
    let refused = Manipulator::read(text).err().unwrap().to_string();
    assert!(refused.contains("leg2 constrains the platform in another way"), "{refused}");
}

/// The balls of a 3-PSP run on upright lines of the base, and on lines of the platform: each line of the platform meets its own.
#[test]
fn a_3psp_by_geometry() {
    // The lines of the platform are level in the first case, and neither level nor through one point in the second one.
    for [along, across, up] in [[1.0, 0.0, 0.0], [1.0, 0.2, 0.1]] {
        let text = format!(
            r#"
format = 1
name = "3-PSP"
units = {{ length = "mm", angle = "deg" }}
platform = {{ point = [0, 0, 300] }}
[[leg]]
name = "leg{{i}}"
pattern = {{ count = 3, axis = [0, 0, 1] }}
joints = [
  {{ name = "p{{i}}", type = "prismatic", axis = [0, 0, 1], point = [200, 0, 0], actuated = true }},
  {{ name = "s{{i}}", type = "spherical", point = [200, 0, 300] }},
  {{ name = "r{{i}}", type = "prismatic", axis = [{along}, {across}, {up}], point = [200, 0, 300] }},
]
"#
        );
        let m = made(&text);
        let names: Vec<&str> = m.dependent_coordinates().iter().map(|c| c.name).collect();
        assert_eq!(names, ["x", "y", "yaw"]);
        let (mut rng, mut at, mut solved) = (Rng::with_seed(11), m.solution(), 0);
        for _ in 0..60 {
            let pose = [0.3 + 0.1 * rng.f64(), 0.8 * rng.f64() - 0.4, 0.8 * rng.f64() - 0.4];
            for mode in m.modes() {
                let Some(solution) = m.inverse(&pose, mode, &mut at).unwrap() else { continue };
                let joints = solution.joints();
                let g = m.displacement_in(&pose, mode).unwrap();
                let (p, turn) =
                    ((g * m.mechanism().platform).coords, g.rotation.to_rotation_matrix());
                for leg in 0..3 {
                    let third = std::f64::consts::TAU / 3.0 * leg as f64;
                    let about = nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), third);
                    let foot = about * Vector3::new(0.2, 0.0, 0.0);
                    let slid = value(&m, joints, &format!("p{}", leg + 1));
                    let ball = foot + Vector3::z() * (0.3 + slid);
                    // The ball is on the line of the platform.
                    let away = turn.inverse() * (ball - p) - foot;
                    let line = about * Vector3::new(along, across, up);
                    assert!(away.cross(&line).norm() < 1e-11, "{pose:?} {away:?}");
                }
                assert!(closure(&m, joints, &g) < 1e-11, "{pose:?}");
                solved += 1;
            }
        }
        assert!(solved > 60, "{solved}");
    }
}

/// The legs of a 3-RPS on the edges of a cube (Z. Huang and others, 1995): at home the lines of its constraint forces meet, and it moves
/// as about a point, but no farther.
#[test]
fn a_3rps_on_a_cube() {
    let legs: String = (0..3)
        .map(|i| {
            let turned = |v: [i32; 3]| [v[(3 - i) % 3], v[(4 - i) % 3], v[(5 - i) % 3]];
            let (foot, ball) = (turned([200, 0, 0]), turned([200, 200, 0]));
            format!(
                r#"
[[leg]]
name = "leg{i}"
joints = [
  {{ name = "r{i}", type = "revolute", axis = {:?}, point = {foot:?} }},
  {{ name = "p{i}", type = "prismatic", axis = {:?}, point = {foot:?}, actuated = true }},
  {{ name = "s{i}", type = "spherical", point = {ball:?} }},
]
"#,
                turned([0, 0, 1]),
                turned([0, 1, 0])
            )
        })
        .collect();
    let head = "format = 1\nname = \"3-RPS\"\nunits = { length = \"mm\", angle = \"deg\" }\nplatform = { point = [0, 0, 0] }\n";
    let m = made(&format!("{head}{legs}"));
    assert_eq!(m.decomposition().platform(), PlatformSet::Constrained);
    let (mut rng, mut at, mut solved) = (Rng::with_seed(12), m.solution(), 0);
    for _ in 0..60 {
        let away = |c: &opm_core::task::TaskCoordinate, by: f64| {
            let unit = if c.quantity == opm_core::Quantity::Length { 0.05 } else { 0.3 };
            c.home + unit * (2.0 * by - 1.0)
        };
        let independent = m.home_pose().len();
        let pose: Vec<f64> =
            m.task_coordinates()[..independent].iter().map(|c| away(c, rng.f64())).collect();
        for mode in m.modes() {
            let Some(solution) = m.inverse(&pose, mode, &mut at).unwrap() else { continue };
            let g = m.displacement_in(&pose, mode).unwrap();
            assert!(closure(&m, solution.joints(), &g) < 1e-11, "{pose:?}");
            // Each ball stays in the plane of its leg.
            for i in 0..3 {
                let turned = |v: [f64; 3]| {
                    nalgebra::Point3::new(v[(3 - i) % 3], v[(4 - i) % 3], v[(5 - i) % 3])
                };
                let ball = g * turned([0.2, 0.2, 0.0]);
                assert!(ball.coords.dot(&turned([0.0, 0.0, 1.0]).coords).abs() < 1e-11);
            }
            solved += 1;
        }
    }
    assert!(solved > 100, "{solved}");
}
