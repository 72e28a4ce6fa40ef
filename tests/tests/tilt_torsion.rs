//! Tilt and torsion (I. A. Bonev): `R = Rz(azimuth) Ry(tilt) Rz(torsion - azimuth)`. The rotation is written here from
//! the formula by nalgebra's rotations, and everything else is compared with it or with Euler angles.

use fastrand::Rng;
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::OrientationCoordinates::TiltTorsion;
use opm_core::mechanism::{Mechanism, TaskHints, examples, file};
use opm_core::task::{CoordinateKind, TaskCoordinate};
use opm_tests::by_inverse::by_inverse;
use opm_workspace::measure::{CoordinateRange, Domain, Goal, measure};
use opm_workspace::{Axis, Grid, Modes, Progress, Sections, Sweep, Visits};
use std::f64::consts::{PI, TAU};

/// Rounding of a product of rotations and of the closed forms behind it.
const ROUNDING: f64 = 1e-12;

fn rotation(azimuth: f64, tilt: f64, torsion: f64) -> Rotation3<f64> {
    let about = |axis, angle| Rotation3::from_axis_angle(&axis, angle);
    about(Vector3::z_axis(), azimuth)
        * about(Vector3::y_axis(), tilt)
        * about(Vector3::z_axis(), torsion - azimuth)
}

fn mechanism(name: &str) -> Mechanism {
    file::read(examples::find(name).unwrap().text).unwrap().mechanism
}

/// The same mechanism with Euler angles, and with tilt and torsion.
fn both(name: &str) -> [Manipulator; 2] {
    let euler = mechanism(name);
    let mut tilted = euler.clone();
    tilted.task = TaskHints { coordinates: Some(TiltTorsion), ..tilted.task };
    [euler, tilted].map(|mechanism| Manipulator::new(mechanism).unwrap())
}

/// The shipped mechanisms whose pose has three Euler angles, all of them independent.
fn with_orientations() -> Vec<&'static str> {
    let suits = |name: &&str| {
        Manipulator::example(name).is_ok_and(|manipulator| {
            let kinds = manipulator.task_coordinates().iter().map(TaskCoordinate::kind);
            let euler = [CoordinateKind::Zeta, CoordinateKind::Xi, CoordinateKind::Psi];
            kinds.filter(|kind| euler.contains(kind)).count() == 3
        })
    };
    let found: Vec<_> = examples::EXAMPLES.iter().map(|e| e.name).filter(suits).collect();
    assert!(found.len() >= 3, "{found:?}");
    found
}

/// The number of the azimuth, after which the tilt and the torsion come.
fn first(manipulator: &Manipulator) -> usize {
    let kinds = manipulator.task_coordinates().iter().map(TaskCoordinate::kind);
    kinds.into_iter().position(|kind| kind == CoordinateKind::Azimuth).unwrap()
}

#[test]
fn the_orientation_is_that_of_the_formula() {
    let [_, manipulator] = both("plano-spherical-5dof");
    let mut rng = Rng::with_seed(1);
    for _ in 0..200 {
        let mut angle = |most: f64| most * (2.0 * rng.f64() - 1.0);
        let [azimuth, tilt, torsion] = [angle(PI), angle(PI).abs(), angle(PI)];
        let pose = [0.01, -0.02, azimuth, tilt, torsion];
        let placed = manipulator.platform_pose(&pose).unwrap();
        let expected = rotation(azimuth, tilt, torsion);
        assert!(
            (placed.rotation.to_rotation_matrix().matrix() - expected.matrix()).norm() < ROUNDING
        );
        let located = manipulator.locate_platform(&placed).unwrap();
        let apart = |i: usize| (located[i] - pose[i] + PI).rem_euclid(TAU) - PI;
        assert!((0..5).all(|i| apart(i).abs() < 1e-9), "{located:?} {pose:?}");
        assert!((0.0..=PI).contains(&located[3]));
    }
}

#[test]
fn at_the_poles_the_azimuth_is_that_at_home() {
    let [_, manipulator] = both("plano-spherical-5dof");
    let home = manipulator.home_pose();
    for (tilt, azimuth, torsion) in [(0.0, 1.1, 0.7), (PI, 1.1, 0.7), (0.0, -2.5, -2.9)] {
        let turned = UnitQuaternion::from_rotation_matrix(&rotation(azimuth, tilt, torsion));
        let at = Isometry3::from_parts(Translation3::new(0.01, 0.02, 0.0), turned);
        let reference = manipulator.platform_pose(&home).unwrap();
        let at = Isometry3::from_parts(
            Translation3::from(at.translation.vector + Vector3::z() * reference.translation.z),
            at.rotation,
        );
        let located = manipulator.locate_platform(&at).unwrap();
        assert!((located[2] - home[2]).abs() < ROUNDING, "{located:?}");
        assert!((located[3] - tilt).abs() < ROUNDING, "{located:?}");
        let found = rotation(located[2], located[3], located[4]);
        assert!((found.matrix() - rotation(azimuth, tilt, torsion).matrix()).norm() < 1e-9);
    }
}

#[test]
fn joints_rates_and_accelerations_are_those_of_euler_angles() {
    for name in with_orientations() {
        let [euler, tilted] = both(name);
        let first = first(&tilted);
        let (mut one, mut other) = (euler.solution(), tilted.solution());
        let mut rng = Rng::with_seed(7);
        let mut reached = 0;
        for _ in 0..200 {
            let mut pose = tilted.home_pose();
            for (i, value) in pose.iter_mut().enumerate() {
                let most = if (first..first + 3).contains(&i) { 0.6 } else { 0.02 };
                *value += most * (2.0 * rng.f64() - 1.0);
            }
            let same = |values: &[f64]| {
                let mut values = values.to_vec();
                values[first + 2] -= values[first];
                values
            };
            let mode = euler.home_mode();
            let at = euler.inverse(&same(&pose), mode, &mut one).unwrap();
            let found = tilted.inverse(&pose, mode, &mut other).unwrap();
            assert_eq!(at.is_some(), found.is_some(), "{name}: {pose:?}");
            let (Some(at), Some(found)) = (at, found) else { continue };
            let close = |a: &[f64], b: &[f64], most: f64| {
                let size = a.iter().fold(1.0_f64, |size, a| size.max(a.abs()));
                a.iter().zip(b).all(|(a, b)| (a - b).abs() < most * size)
            };
            assert!(close(at.joints(), found.joints(), 1e-9), "{name}: {pose:?}");
            let rates: Vec<f64> = pose.iter().map(|_| rng.f64() - 0.5).collect();
            let accelerations: Vec<f64> = pose.iter().map(|_| rng.f64() - 0.5).collect();
            let (mut a, mut b) = (euler.joint_motion(), tilted.joint_motion());
            let of_euler = euler.velocity(at, &same(&rates), &same(&accelerations), &mut a);
            let of_tilted = tilted.velocity(found, &rates, &accelerations, &mut b);
            if of_euler.unwrap() && of_tilted.unwrap() {
                assert!(close(&a.joint_rates, &b.joint_rates, 1e-7), "{name}: {pose:?}");
                assert!(close(&a.joint_accelerations, &b.joint_accelerations, 1e-6), "{name}");
            }
            reached += 1;
        }
        assert!(reached > 10, "{name}");
    }
}

#[test]
fn sweeps_agree_with_inverse_kinematics_pose_by_pose() {
    for name in with_orientations() {
        let [_, tilted] = both(name);
        let first = first(&tilted);
        let axes =
            tilted.task_coordinates().iter().enumerate().map(|(i, c)| match i.checked_sub(first) {
                Some(0) => Axis::new(c.name, c.home - 3.0, c.home + 3.0, 9),
                Some(1) => Axis::new(c.name, 0.0, 1.2, 5),
                Some(2) => Axis::new(c.name, c.home - 0.5, c.home + 0.5, 3),
                _ => Axis::new(c.name, c.home - 0.1, c.home + 0.1, 7),
            });
        let grid = Grid::new(&tilted, axes.collect()).unwrap();
        let mode = tilted.home_mode();
        let modes = Modes::One(mode);
        let found =
            Sweep::new(&tilted, &grid, modes).count(&Progress::default()).unwrap().reachable;
        assert_eq!(found, by_inverse(&tilted, &grid, modes).1.reachable, "{name}");
        assert!(found > 0, "{name}");
    }
}

#[test]
fn twenty_degrees_in_all_directions_without_torsion_are_a_grid() {
    let [euler, tilted] = both("plano-spherical-5dof");
    let (cells, turns) = (41, 36);
    let axes = vec![
        Axis::new("x", -0.2, 0.2, cells),
        Axis::new("y", -0.2, 0.2, cells),
        Axis::new("azimuth", -PI, PI - TAU / turns as f64, turns),
        Axis::fixed("tilt", 20_f64.to_radians()),
    ];
    let grid = Grid::new(&tilted, axes).unwrap();
    let mode = tilted.home_mode();
    let sweep = Sweep::new(&tilted, &grid, Modes::One(mode));
    let found = Visits::new(&sweep, &Progress::default()).unwrap().dexterous().unwrap();
    // Pose by pose, by Euler angles.
    let mut solution = euler.solution();
    let mut expected = 0;
    for place in 0..cells * cells {
        let value = |number: u64| -0.2 + 0.4 * number as f64 / (cells - 1) as f64;
        let (x, y) = (value(place % cells), value(place / cells));
        let all = (0..turns).all(|turn| {
            let azimuth = -PI + TAU * turn as f64 / turns as f64;
            let pose = [x, y, azimuth, 20_f64.to_radians(), -azimuth];
            let reached = euler.inverse(&pose, mode, &mut solution).unwrap();
            reached.is_some_and(Solution::within_limits)
        });
        expected += u64::from(all);
    }
    assert_eq!(found.count(), expected);
    // By 118,098 inverse kinematics (81 x 81 places, 18 azimuths), the area is about 64,100 mm²; a coarser grid is off
    // by a part of the boundary's length times the step.
    let area = found.count() as f64 * (0.4 / (cells - 1) as f64).powi(2);
    assert!((area - 0.0641).abs() < 0.0025, "{area}");
}

#[test]
fn all_orientations_have_the_haar_measure() {
    let [euler, tilted] = both("plano-spherical-5dof");
    let share = |manipulator: &Manipulator, names: [&str; 3]| {
        let range =
            |name: &str, min: f64, max: f64| CoordinateRange { name: name.into(), min, max };
        let over = [range(names[0], -PI, PI), range(names[1], 0.0, 1.0), range(names[2], -PI, PI)];
        let domain = Domain::new(manipulator, Sections::Upper, &over).unwrap();
        let goal = Goal { tolerance: 0.05, budget: 200_000 };
        let modes = Modes::One(manipulator.home_mode());
        measure(manipulator, &domain, modes, &goal, &Progress::default())
    };
    let one = share(&euler, ["zeta", "xi", "psi"]);
    let other = share(&tilted, ["azimuth", "tilt", "torsion"]);
    // Full turns of azimuth and torsion give each orientation once, as those of zeta and psi do.
    assert!((one.whole - other.whole).abs() < 1e-9 && other.upper > 0.0);
    assert!(one.lower <= other.upper && other.lower <= one.upper, "{one:?} {other:?}");
}

#[test]
fn a_planar_mechanism_has_no_tilt() {
    let mut planar = mechanism("planar-3rrr");
    planar.task.coordinates = Some(TiltTorsion);
    let error = Manipulator::new(planar).unwrap_err().to_string();
    assert!(!error.is_empty());
}
