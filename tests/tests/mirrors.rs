//! Symmetric platforms: Canfield's joint and Omni-Wrist III, against reflections in the mid-plane, written here.

use fastrand::Rng;
use nalgebra::{Isometry3, Matrix3, Point3, Rotation3, Unit, UnitQuaternion, Vector3};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, examples, file};
use std::f64::consts::{PI, TAU};

const HEIGHT: f64 = 0.18;

/// A mechanism of these legs, with the platform's point above the base's centre.
fn of_legs(legs: Vec<Leg>) -> Mechanism {
    let mut mechanism = file::read(examples::find("stewart").unwrap().text).unwrap().mechanism;
    mechanism.legs = legs;
    mechanism.platform = Point3::new(0.0, 0.0, HEIGHT);
    mechanism.task = Default::default();
    mechanism.bodies = Default::default();
    mechanism.shapes = Default::default();
    mechanism
}

fn revolute(name: String, axis: Vector3<f64>, point: Vector3<f64>) -> Joint {
    Joint::new(name, JointKind::Revolute, Unit::new_normalize(axis), point.into())
}

/// Three legs, each an arm, a ball in the mid-plane, and the arm's mirror image.
fn canfield() -> Mechanism {
    let leg = |i: usize| {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.2 + TAU * i as f64 / 3.0);
        let (axis, foot) = (turn * Vector3::y(), turn * Vector3::new(0.1, 0.0, 0.0));
        let elbow = Point3::from(turn * Vector3::new(0.16, 0.0, 0.5 * HEIGHT));
        let joints = vec![
            revolute(format!("a{i}"), axis, foot).actuated(),
            Joint::new(format!("s{i}"), JointKind::Spherical, Vector3::z_axis(), elbow),
            revolute(format!("c{i}"), axis, foot + Vector3::new(0.0, 0.0, HEIGHT)),
        ];
        Leg::new(format!("leg{i}"), joints)
    };
    of_legs((0..3).map(leg).collect())
}

/// Four legs of two axes through the base's centre, and their mirror images through the platform's.
fn omni_wrist() -> Mechanism {
    let leg = |i: usize| {
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.5 * PI * i as f64);
        let second = turn * Vector3::new(0.55, 0.7, 0.45);
        let (base, top) = (Vector3::zeros(), Vector3::new(0.0, 0.0, HEIGHT));
        let image = Vector3::new(second.x, second.y, -second.z);
        let first = revolute(format!("a{i}"), turn * Vector3::x(), base);
        let joints = vec![
            if i < 2 { first.actuated() } else { first },
            revolute(format!("b{i}"), second, base),
            revolute(format!("c{i}"), image, top),
            revolute(format!("d{i}"), turn * Vector3::x(), top),
        ];
        Leg::new(format!("leg{i}"), joints)
    };
    of_legs((0..4).map(leg).collect())
}

/// The reflection in `n · x = d`, after that in the mid-plane of home.
fn reflected(n: &Vector3<f64>, d: f64) -> Isometry3<f64> {
    let mirror = |n: &Vector3<f64>| Matrix3::identity() - n * n.transpose() * 2.0;
    let (z, e) = (Vector3::z(), 0.5 * HEIGHT);
    let turned = Rotation3::from_matrix_unchecked(mirror(n) * mirror(&z));
    let moved = mirror(n) * (z * (2.0 * e)) + n * (2.0 * d);
    Isometry3::from_parts(moved.into(), UnitQuaternion::from_rotation_matrix(&turned))
}

/// Roll, pitch and yaw of `Rz(yaw) Ry(pitch) Rx(roll)`.
fn angles(g: &Isometry3<f64>) -> [f64; 3] {
    let (roll, pitch, yaw) = g.rotation.euler_angles();
    [roll, pitch, yaw]
}

fn close(m: &Manipulator, g: &Isometry3<f64>, joints: &[f64]) {
    let mut rest = joints;
    for leg in &m.mechanism().legs {
        let (own, others) = rest.split_at(leg.coordinates().count());
        rest = others;
        let off = leg.displacement(own).unwrap().to_homogeneous() - g.to_homogeneous();
        assert!(off.norm() < 1e-10, "{}: {:e}", leg.name, off.norm());
    }
}

/// The pose that the mid-plane gives has the dependent coordinates, and every mode closes every leg.
fn agrees(m: &Manipulator, g: &Isometry3<f64>, three: bool) -> usize {
    let [roll, pitch, yaw] = angles(g);
    let at = g * Point3::new(0.0, 0.0, HEIGHT);
    let pose = if three { vec![at.z, roll, pitch] } else { vec![roll, pitch] };
    let followed = m.dependent_values(&pose, m.home_mode()).unwrap().expect("upright");
    let expected = if three { vec![at.x, at.y, yaw] } else { vec![at.x, at.y, at.z, yaw] };
    for (a, b) in followed.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-12, "{followed:?} {expected:?}");
    }
    let mut all = m.all_modes();
    let mut solution = m.solution();
    if m.inverse_all(&pose, &mut all).unwrap().is_none() {
        return 0;
    }
    let modes: Vec<_> = all.modes(m).collect();
    for &mode in &modes {
        assert!(m.solution_in_mode(&all, mode, &mut solution).is_some());
        close(m, g, solution.joints());
    }
    modes.len()
}

/// A mid-plane near home's: its normal, and its distance from the base's centre.
fn plane(rng: &mut Rng) -> (Vector3<f64>, f64) {
    let slope = |rng: &mut Rng| 0.8 * (rng.f64() - 0.5);
    let n = Vector3::new(slope(rng), slope(rng), 1.0).normalize();
    (n, 0.5 * HEIGHT * (0.8 + 0.4 * rng.f64()))
}

#[test]
fn canfield_s_joint() {
    let m = Manipulator::new(canfield()).unwrap();
    let names = |of: Vec<&str>| of.join(" ");
    assert_eq!(names(m.task_coordinates().iter().map(|c| c.name).collect()), "z roll pitch");
    let mut rng = Rng::with_seed(400);
    let mut solution = m.solution();
    let mut reached = 0;
    for _ in 0..200 {
        let (n, d) = plane(&mut rng);
        let g = reflected(&n, d);
        let found = agrees(&m, &g, true);
        reached += usize::from(found > 0);
        let [roll, pitch, _] = angles(&g);
        let pose = [(g * Point3::new(0.0, 0.0, HEIGHT)).z, roll, pitch];
        if m.inverse(&pose, m.home_mode(), &mut solution).unwrap().is_none() {
            continue;
        }
        // Every ball is in the mid-plane.
        for (i, leg) in m.mechanism().legs.iter().enumerate() {
            let first = solution.joints()[5 * i];
            let ball = leg.joints[0].displacement(&[first]).unwrap() * leg.joints[1].point;
            assert!((n.dot(&ball.coords) - d).abs() < 1e-12);
        }
    }
    assert!(reached > 50, "{reached}");
}

#[test]
fn omni_wrist_iii() {
    let m = Manipulator::new(omni_wrist()).unwrap();
    let mut rng = Rng::with_seed(401);
    let mut reached = 0;
    for _ in 0..100 {
        let (n, _) = plane(&mut rng);
        reached += usize::from(agrees(&m, &reflected(&n, 0.5 * HEIGHT), false) > 0);
    }
    assert!(reached > 50, "{reached}");
}

#[test]
fn rates_are_differences() {
    let mut rng = Rng::with_seed(402);
    for mechanism in [canfield(), omni_wrist()] {
        let m = Manipulator::new(mechanism).unwrap();
        let count = m.task_coordinates().len();
        let mut checked = 0;
        for _ in 0..40 {
            let mut pose = m.home_pose();
            pose[count - 2..].iter_mut().for_each(|angle| *angle = 0.6 * (rng.f64() - 0.5));
            let rates: Vec<f64> = (0..count).map(|_| rng.f64() - 0.5).collect();
            let mut at = m.solution();
            if m.inverse(&pose, m.home_mode(), &mut at).unwrap().is_none() {
                continue;
            }
            let step = 1e-5;
            let beside = |by: f64| {
                let moved: Vec<f64> = pose.iter().zip(&rates).map(|(q, r)| q + by * r).collect();
                let mut beside = at.clone();
                let found = m.inverse_near(&moved, m.home_mode(), &mut beside).unwrap().is_some();
                found.then(|| (beside.joints().to_vec(), beside.dependent().to_vec()))
            };
            let (Some(less), Some(more)) = (beside(-step), beside(step)) else { continue };
            let mut motion = m.joint_motion();
            let regular = m.velocity(&at, &rates, &vec![0.0; count], &mut motion).unwrap();
            assert!(regular, "{count} {pose:?} {:?} {:?}", motion.singular, motion.dependent_rates);
            let pairs = [
                (motion.joint_rates.to_vec(), less.0, more.0),
                (motion.dependent_rates.to_vec(), less.1, more.1),
            ];
            for (rates, less, more) in pairs {
                for ((rate, a), b) in rates.iter().zip(less).zip(more) {
                    let difference = (b - a) / (2.0 * step);
                    assert!(
                        (rate - difference).abs() < 1e-6 * (1.0 + rate.abs().powi(3)),
                        "{rate} {difference}"
                    );
                }
            }
            checked += 1;
        }
        assert!(checked > 10, "{checked}");
    }
}

/// In every mode: the platform's twist for each coordinate is that of differences of its displacements.
#[test]
fn twists_are_differences() {
    let mut rng = Rng::with_seed(403);
    for mechanism in [canfield(), omni_wrist()] {
        let m = Manipulator::new(mechanism).unwrap();
        let count = m.task_coordinates().len();
        let (mut all, mut at, mut jacobians) = (m.all_modes(), m.solution(), m.jacobians());
        let mut checked = 0;
        for _ in 0..30 {
            let mut pose = m.home_pose();
            pose[count - 2..].iter_mut().for_each(|angle| *angle = 1.6 * (rng.f64() - 0.5));
            if m.inverse_all(&pose, &mut all).unwrap().is_none() {
                continue;
            }
            let modes: Vec<_> = all.modes(&m).collect();
            for mode in modes {
                assert!(m.solution_in_mode(&all, mode, &mut at).is_some());
                if !m.differentiate(&at, &mut jacobians).unwrap() {
                    continue;
                }
                let found = m.twist_by_pose(&jacobians);
                for column in 0..count {
                    let step = 1e-6;
                    let [less, more] = [-step, step].map(|by| {
                        let mut moved = pose.clone();
                        moved[column] += by;
                        m.displacement_in(&moved, mode).unwrap()
                    });
                    let turned = (more.rotation * less.rotation.inverse()).scaled_axis();
                    let point = Point3::new(0.0, 0.0, HEIGHT);
                    let moved = more * point - less * point;
                    for i in 0..3 {
                        let pairs =
                            [(turned[i], found[(i, column)]), (moved[i], found[(i + 3, column)])];
                        for (difference, rate) in pairs {
                            let off = (difference / (2.0 * step) - rate).abs();
                            assert!(
                                off < 1e-6,
                                "{count} {pose:?} {}: {i} {column} {off:e}",
                                m.format_mode(mode)
                            );
                        }
                    }
                    checked += 1;
                }
            }
        }
        assert!(checked > 40, "{checked}");
    }
}
