//! Roll, pitch and yaw: `R = Rz(yaw) Ry(pitch) Rx(roll)`. The rotation is that of nalgebra's `from_euler_angles`, and
//! everything else is compared with it, with differences, or with the same mechanism in Euler angles.

use fastrand::Rng;
use nalgebra::{Isometry3, Rotation3};
use opm_core::manipulator::{Manipulator, Mode, Solution};
use opm_core::mechanism::OrientationCoordinates::{EulerAngles, RollPitchYaw, TiltTorsion};
use opm_core::mechanism::{Mechanism, TaskHints, examples, file};
use opm_core::numeric::Quantity;
use opm_core::task::{CoordinateKind, TaskCoordinate};
use opm_tests::by_inverse::by_inverse;
use opm_workspace::measure::{CoordinateRange, Domain, Goal, measure};
use opm_workspace::{Axis, Grid, Modes, Progress, Sections, Sweep, default_grid};
use std::f64::consts::{FRAC_PI_2, PI};

/// Rounding of a product of rotations and of the closed forms behind it.
const ROUNDING: f64 = 1e-12;

fn mechanism(name: &str) -> Mechanism {
    file::read(examples::find(name).unwrap().text).unwrap().mechanism
}

/// The same mechanism with Euler angles, and with roll, pitch and yaw.
fn both(name: &str) -> [Manipulator; 2] {
    both_of(&mechanism(name)).map(Option::unwrap)
}

fn both_of(mechanism: &Mechanism) -> [Option<Manipulator>; 2] {
    [EulerAngles, RollPitchYaw].map(|coordinates| {
        let mut mechanism = mechanism.clone();
        mechanism.task = TaskHints { coordinates: Some(coordinates), ..mechanism.task };
        Manipulator::new(mechanism).ok()
    })
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

/// The number of a coordinate.
fn number(manipulator: &Manipulator, kind: CoordinateKind) -> usize {
    manipulator.task_coordinates().iter().position(|c| c.kind() == kind).unwrap()
}

/// The same pose in the coordinates of another manipulator.
fn written_for(one: &Manipulator, pose: &[f64], other: &Manipulator) -> Vec<f64> {
    other.locate_platform(&one.platform_pose(pose).unwrap()).unwrap()
}

/// A pose about home; angles are up to so far away, lengths 2 cm.
fn drawn(manipulator: &Manipulator, rng: &mut Rng, angle: f64) -> Vec<f64> {
    let coordinates = manipulator.task_coordinates().iter();
    let value = |c: &TaskCoordinate| {
        let most = if c.quantity == Quantity::Angle { angle } else { 0.02 };
        c.home + most * (2.0 * rng.f64() - 1.0)
    };
    coordinates.map(value).collect()
}

fn close(a: &[f64], b: &[f64], most: f64) -> bool {
    let size = a.iter().fold(1.0_f64, |size, a| size.max(a.abs()));
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < most * size)
}

#[test]
fn the_orientation_is_that_of_the_formula() {
    let [_, manipulator] = both("plano-spherical-5dof");
    let names: Vec<&str> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["x", "y", "roll", "pitch", "yaw"]);
    let mut rng = Rng::with_seed(1);
    for _ in 0..300 {
        let mut angle = || match rng.u32(..2) {
            0 => PI * (2.0 * rng.f64() - 1.0),
            _ => FRAC_PI_2 * f64::from(rng.i32(-2..=2)) + 1e-9 * f64::from(rng.i32(-1..=1)),
        };
        let [roll, pitch, yaw] = [angle(), angle(), angle()];
        let placed = manipulator.platform_pose(&[0.01, -0.02, roll, pitch, yaw]).unwrap();
        let expected = Rotation3::from_euler_angles(roll, pitch, yaw);
        let found = placed.rotation.to_rotation_matrix();
        assert!((found.matrix() - expected.matrix()).norm() < ROUNDING);
        let located = manipulator.locate_platform(&placed).unwrap();
        let again = manipulator.platform_pose(&located).unwrap();
        let apart = (again.translation.vector - placed.translation.vector).norm()
            + again.rotation.angle_to(&placed.rotation);
        assert!(apart < 1e-7, "{located:?} {roll} {pitch} {yaw}");
        // Regular angles are found again, or the other triple, which is nearer to home.
        if pitch.cos() > 1e-3 {
            let near = |a: f64| (a + PI).rem_euclid(2.0 * PI) - PI;
            let same = |[r, p, y]: [f64; 3]| {
                let found = [located[2] - r, located[3] - p, located[4] - y];
                found.into_iter().all(|apart| near(apart).abs() < 1e-9)
            };
            assert!(same([roll, pitch, yaw]) || same([roll + PI, PI - pitch, yaw + PI]));
        }
    }
}

#[test]
fn at_the_poles_roll_and_yaw_change_alike() {
    let [_, manipulator] = both("plano-spherical-5dof");
    for (pitch, roll, yaw) in [(FRAC_PI_2, 1.1, 0.3), (-FRAC_PI_2, 1.1, 0.3)] {
        let placed = manipulator.platform_pose(&[0.01, 0.02, roll, pitch, yaw]).unwrap();
        let located = manipulator.locate_platform(&placed).unwrap();
        let expected = if pitch > 0.0 { [0.4, pitch, -0.4] } else { [0.7, pitch, 0.7] };
        assert!(close(&located[2..], &expected, 1e-9), "{located:?}");
    }
}

#[test]
fn joints_are_those_of_the_same_pose_in_euler_angles() {
    for name in with_orientations() {
        let [euler, other] = both(name);
        let (mut one, mut two) = (euler.solution(), other.solution());
        let mut rng = Rng::with_seed(7);
        let mut reached = 0;
        for _ in 0..200 {
            let pose = drawn(&other, &mut rng, 0.6);
            let mode = euler.home_mode();
            let same = written_for(&other, &pose, &euler);
            let at = euler.inverse(&same, mode, &mut one).unwrap();
            let found = other.inverse(&pose, mode, &mut two).unwrap();
            assert_eq!(at.is_some(), found.is_some(), "{name}: {pose:?}");
            let (Some(at), Some(found)) = (at, found) else { continue };
            assert!(close(at.joints(), found.joints(), 1e-8), "{name}: {pose:?}");
            reached += 1;
        }
        assert!(reached > 10, "{name}");
    }
}

/// The joints at a pose, angles near those of another solution.
fn joints_near(manipulator: &Manipulator, pose: &[f64], at: &Solution, mode: Mode) -> Vec<f64> {
    let mut held = at.clone();
    let found = manipulator.inverse_near(pose, mode, &mut held).unwrap();
    found.expect("a pose nearby is in reach").joints().to_vec()
}

#[test]
fn rates_and_accelerations_are_differences() {
    // The step of central differences; their error is its square, and rounding over it.
    let step = 1e-4;
    for name in with_orientations() {
        let [_, manipulator] = both(name);
        let mut rng = Rng::with_seed(3);
        let (mut solution, mut motion) = (manipulator.solution(), manipulator.joint_motion());
        let (mut jacobians, mode) = (manipulator.jacobians(), manipulator.home_mode());
        let mut tested = 0;
        for _ in 0..60 {
            let pose = drawn(&manipulator, &mut rng, 0.4);
            let Some(at) = manipulator.inverse(&pose, mode, &mut solution).unwrap() else {
                continue;
            };
            let unit = |c: &TaskCoordinate, value: f64| {
                if c.quantity == Quantity::Length { 0.1 * value } else { value }
            };
            let coordinates = manipulator.task_coordinates();
            let rates: Vec<f64> =
                coordinates.iter().map(|c| unit(c, 2.0 * rng.f64() - 1.0)).collect();
            let still = vec![0.0; rates.len()];
            if !manipulator.velocity(at, &rates, &still, &mut motion).unwrap() {
                continue;
            }
            let moved = |by: f64| {
                let pose: Vec<f64> =
                    pose.iter().zip(&rates).map(|(q, rate)| q + by * rate).collect();
                joints_near(&manipulator, &pose, at, mode)
            };
            // Near a singularity differences are off: the rates tell how near it is.
            if motion.joint_accelerations.iter().any(|a| a.abs() > 30.0) {
                continue;
            }
            let (before, here, after) = (moved(-step), moved(0.0), moved(step));
            for (i, rate) in motion.joint_rates.iter().enumerate() {
                let difference = (after[i] - before[i]) / (2.0 * step);
                assert!((difference - rate).abs() < 1e-4, "{name}: {difference} {rate}");
                let second = (after[i] - 2.0 * here[i] + before[i]) / (step * step);
                let acceleration = motion.joint_accelerations[i];
                assert!((second - acceleration).abs() < 1e-2, "{name}: {second} {acceleration}");
            }
            manipulator.differentiate(at, &mut jacobians).unwrap();
            let by_pose = jacobians.joints_by_pose() * nalgebra::DVector::from_column_slice(&rates);
            assert!(close(&motion.joint_rates, by_pose.as_slice(), 1e-9), "{name}");
            tested += 1;
        }
        assert!(tested > 10, "{name}: {tested}");
    }
}

#[test]
fn the_coordinates_are_singular_at_the_poles_alone() {
    let [_, manipulator] = both("plano-spherical-5dof");
    let (mut solution, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
    let mut measured = manipulator.singularities();
    let mut tested = 0;
    for mode in manipulator.modes() {
        for pitch in [0.0, 0.4, -0.7, 1.2, FRAC_PI_2, -FRAC_PI_2] {
            let pose = manipulator.pose([("pitch", pitch), ("yaw", 0.1)]).unwrap();
            let Some(at) = manipulator.inverse(&pose, mode, &mut solution).unwrap() else {
                continue;
            };
            manipulator.differentiate(at, &mut jacobians).unwrap();
            manipulator.measure_singularities(&jacobians, &mut measured);
            assert!((measured.coordinates.abs() - pitch.cos()).abs() < ROUNDING, "{pitch}");
            tested += 1;
        }
    }
    assert!(tested > 20, "{tested}");
}

#[test]
fn forward_kinematics_gives_the_pose_back() {
    for name in with_orientations() {
        let [_, manipulator] = both(name);
        let mut rng = Rng::with_seed(11);
        let (mut solution, mode) = (manipulator.solution(), manipulator.home_mode());
        let mut tested = 0;
        for _ in 0..20 {
            let pose = drawn(&manipulator, &mut rng, 0.3);
            let Some(at) = manipulator.inverse(&pose, mode, &mut solution).unwrap() else {
                continue;
            };
            let actuated: Vec<f64> =
                manipulator.actuated().iter().map(|&joint| at.joints()[joint]).collect();
            let found = manipulator.forward(&actuated).unwrap();
            let same = |found: &[f64]| close(&pose, found, 1e-6);
            assert!(found.list.iter().any(|found| same(&found.pose)), "{name}: {pose:?}");
            tested += 1;
        }
        assert!(tested > 3, "{name}");
    }
}

#[test]
fn sweeps_agree_with_inverse_kinematics_pose_by_pose() {
    for name in with_orientations() {
        let [_, manipulator] = both(name);
        let angles = [CoordinateKind::Roll, CoordinateKind::Pitch, CoordinateKind::Yaw];
        let axes = manipulator.task_coordinates().iter().map(|c| {
            let (far, count) = if angles.contains(&c.kind()) { (0.9, 5) } else { (0.1, 7) };
            Axis::new(c.name, c.home - far, c.home + far, count)
        });
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let mode = manipulator.home_mode();
        let modes = Modes::One(mode);
        let found =
            Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap().reachable;
        assert_eq!(found, by_inverse(&manipulator, &grid, modes).1.reachable, "{name}");
        assert!(found > 0, "{name}");
    }
}

#[test]
fn the_default_grid_has_home_in_it() {
    let [_, manipulator] = both("agile-eye");
    let modes = Modes::One(manipulator.home_mode());
    let (_, extents) = default_grid(&manipulator, modes, &Progress::default()).unwrap();
    for (extent, c) in extents.iter().zip(manipulator.task_coordinates()) {
        assert!(extent.min <= c.home && c.home <= extent.max, "{extent:?}");
    }
    let pitch = &extents[number(&manipulator, CoordinateKind::Pitch)];
    assert!(pitch.min >= -FRAC_PI_2 && pitch.max <= FRAC_PI_2, "{pitch:?}");
}

#[test]
fn all_orientations_have_the_haar_measure() {
    let [euler, other] = both("plano-spherical-5dof");
    let share = |manipulator: &Manipulator, ranges: [(&str, f64, f64); 3]| {
        let over = ranges.map(|(name, min, max)| CoordinateRange { name: name.into(), min, max });
        let domain = Domain::new(manipulator, Sections::Upper, &over).unwrap();
        let goal = Goal { tolerance: 0.05, budget: 200_000 };
        let modes = Modes::One(manipulator.home_mode());
        measure(manipulator, &domain, modes, &goal, &Progress::default())
    };
    let one = share(&euler, [("zeta", -PI, PI), ("xi", 0.0, PI), ("psi", -PI, PI)]);
    let right = [("roll", -PI, PI), ("pitch", -FRAC_PI_2, FRAC_PI_2), ("yaw", -PI, PI)];
    let other = share(&other, right);
    assert!((one.whole - other.whole).abs() < 1e-9 && other.upper > 0.0);
    assert!((one.whole - 8.0 * PI * PI).abs() < 1e-9);
    assert!(one.lower <= other.upper && other.lower <= one.upper, "{one:?} {other:?}");
}

#[test]
fn a_measure_holds_what_is_counted() {
    let [_, manipulator] = both("agile-eye");
    let names = ["roll", "pitch", "yaw"];
    let over = names.map(|name| CoordinateRange { name: name.into(), min: -1.0, max: 1.2 });
    let domain = Domain::new(&manipulator, Sections::Whole, &over).unwrap();
    let modes = Modes::One(manipulator.home_mode());
    let goal = Goal { tolerance: 0.05, budget: 400_000 };
    let bounds = measure(&manipulator, &domain, modes, &goal, &Progress::default());
    let (mut rng, mut solution, mut hits) = (Rng::with_seed(5), manipulator.solution(), 0);
    let samples = 20_000;
    for _ in 0..samples {
        let pose = domain.pose(&[rng.f64(), rng.f64(), rng.f64()]).unwrap();
        let found = manipulator.inverse(&pose, manipulator.home_mode(), &mut solution).unwrap();
        hits += u32::from(found.is_some_and(Solution::within_limits));
    }
    let sampled = bounds.whole * f64::from(hits) / f64::from(samples);
    // Four standard deviations of a count.
    let slack = 4.0 * bounds.whole * 0.5 / f64::from(samples).sqrt();
    assert!(hits > 0 && bounds.lower > 0.0, "{bounds:?} {hits}");
    assert!(
        bounds.lower - slack < sampled && sampled < bounds.upper + slack,
        "{bounds:?} {sampled}"
    );
}

#[test]
fn an_orientation_at_home_is_given_in_either_way() {
    let mut joints = mechanism("plano-spherical-5dof-joints");
    let orientation = |m: &Manipulator| {
        let placed: Isometry3<f64> = m.platform_pose(&m.home_pose()).unwrap();
        placed.rotation.to_rotation_matrix().into_inner()
    };
    let given = |angles: [(&str, f64); 3]| angles.map(|(name, value)| (name.to_owned(), value));
    let expected = Rotation3::from_euler_angles(0.2, -0.3, 0.4).into_inner();
    joints.task.home = given([("roll", 0.2), ("pitch", -0.3), ("yaw", 0.4)]).into();
    for coordinates in [None, Some(EulerAngles), Some(TiltTorsion), Some(RollPitchYaw)] {
        joints.task.coordinates = coordinates;
        let m = Manipulator::new(joints.clone()).unwrap();
        assert!((orientation(&m) - expected).norm() < ROUNDING, "{coordinates:?}");
        let home = m.home_pose();
        assert!((m.displacement(&home).unwrap().rotation.angle()) < ROUNDING);
        if coordinates == Some(RollPitchYaw) {
            assert_eq!(home[2..], [0.2, -0.3, 0.4]);
        }
        // It is the same home in Euler angles.
        let mut again = joints.clone();
        let euler = both_of(&joints).map(Option::unwrap)[0].home_pose();
        again.task.home = given([("zeta", euler[2]), ("xi", euler[3]), ("psi", euler[4])]).into();
        let again = Manipulator::new(again).unwrap();
        assert!(close(&again.home_pose(), &home, ROUNDING), "{coordinates:?}");
    }
    joints.task.home.push(("xi".into(), 0.1));
    let error = Manipulator::new(joints).unwrap_err().to_string();
    assert!(error.contains("`xi`") && error.contains("`roll`"), "{error}");
}

#[test]
fn a_planar_mechanism_has_no_roll() {
    let mut planar = mechanism("planar-3rrr");
    planar.task.coordinates = Some(RollPitchYaw);
    let error = Manipulator::new(planar.clone()).unwrap_err().to_string();
    assert!(error.contains("is roll-pitch-yaw, but"), "{error}");
    planar.task.coordinates = None;
    planar.task.home.push(("roll".into(), 0.1));
    let error = Manipulator::new(planar).unwrap_err().to_string();
    assert!(error.contains("home gives `roll`"), "{error}");
}
