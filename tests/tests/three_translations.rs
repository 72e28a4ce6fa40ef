//! Sections of three translations, compared with geometry that does not use the code under test: linear systems of
//! three equations, products of rigid displacements, volumes of parallelepipeds.

use fastrand::Rng;
use nalgebra::{
    Isometry3, Matrix3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3, vector,
};
use opm_core::Manipulator;
use opm_core::decomposition::decompose;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, TaskHints};
use opm_tests::random::direction;
use opm_workspace::measure::{CoordinateRange, Domain, Goal, measure};
use opm_workspace::{Axis, Grid, Modes, Progress, Sections, Sweep};

/// Rounding of a few dozen operations on numbers of about one.
const ROUNDING: f64 = 1e-12;

fn joint(name: &str, kind: JointKind, axis: Vector3<f64>, point: Point3<f64>) -> Joint {
    Joint::new(name, kind, Unit::new_normalize(axis), point)
}

/// Three sliders of leg number `leg`, the first of which is driven, with limits of -0.4 and 0.5 each.
fn sliders(leg: usize, axes: [Vector3<f64>; 3]) -> Vec<Joint> {
    let slider = |(i, axis): (usize, Vector3<f64>)| Joint {
        actuated: i == 0,
        ..joint(
            &format!("s{leg}{i}"),
            JointKind::Prismatic,
            axis,
            Point3::new(i as f64, leg as f64, 0.0),
        )
        .within(Some([-0.4, 0.5]))
    };
    axes.into_iter().enumerate().map(slider).collect()
}

fn mechanism(legs: Vec<Vec<Joint>>) -> Mechanism {
    let leg = |(i, joints): (usize, Vec<Joint>)| Leg::new(format!("leg{i}"), joints);
    Mechanism {
        name: "translations".into(),
        legs: legs.into_iter().enumerate().map(leg).collect(),
        platform: Point3::new(0.1, -0.2, 0.3),
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}

fn names(m: &Manipulator) -> Vec<&'static str> {
    m.task_coordinates().iter().map(|c| c.name).collect()
}

fn read(mechanism: Mechanism) -> Manipulator {
    Manipulator::new(mechanism).unwrap_or_else(|error| panic!("{error}"))
}

const AXES: [Vector3<f64>; 3] =
    [vector![1.0, 0.0, 0.0], vector![0.0, 1.0, 0.0], vector![0.0, 0.0, 1.0]];

/// Random directions that are well apart from one plane.
fn oblique(rng: &mut Rng) -> [Vector3<f64>; 3] {
    loop {
        let axes = [0; 3].map(|_| direction(rng).into_inner());
        if Matrix3::from_columns(&axes).determinant().abs() > 0.3 {
            return axes;
        }
    }
}

/// Legs of sliders along the base's directions: each slider moves by its coordinate, whatever the order and the sense
/// of the sliders, with legs that are equal and with legs that differ.
#[test]
fn orthogonal_sliders_are_the_coordinates() {
    let [x, y, z] = AXES;
    for legs in [
        [[x, y, z], [y, z, x], [z, x, y]],
        [[x, -y, z], [-y, z, x], [-z, -x, -y]],
        [[-x, -y, -z], [-y, -x, -z], [z, y, x]],
    ] {
        let axes = legs;
        let m = read(mechanism(axes.iter().enumerate().map(|(i, a)| sliders(i, *a)).collect()));
        assert_eq!(names(&m), ["x", "y", "z"]);
        assert_eq!(m.choices(), 0);
        let home = m.home_pose();
        assert_eq!(home, [0.1, -0.2, 0.3]);
        let moved = vector![0.25, -0.125, 0.375];
        let pose: Vec<f64> = home.iter().zip(&moved).map(|(q, d)| q + d).collect();
        let mut solution = m.solution();
        let found = m.inverse(&pose, m.home_mode(), &mut solution).unwrap().unwrap();
        let joints = found.joints().to_vec();
        for (value, axis) in joints.iter().zip(axes.iter().flatten()) {
            assert!((value - axis.dot(&moved)).abs() < ROUNDING, "{joints:?}");
        }
        let driven = [joints[0], joints[3], joints[6]];
        let assemblies = m.forward(&driven).unwrap().list;
        assert_eq!(assemblies.len(), 1);
        for (q, expected) in assemblies[0].pose.iter().zip(&pose) {
            assert!((q - expected).abs() < ROUNDING);
        }
    }
}

/// Oblique sliders solve a linear system; the poses in reach are those whose solutions are within the limits; rows and
/// bounds of the volume agree with that.
#[test]
fn oblique_sliders_solve_a_linear_system() {
    let mut rng = Rng::with_seed(3);
    for _ in 0..20 {
        let legs = [oblique(&mut rng), oblique(&mut rng), oblique(&mut rng)];
        let firsts = Matrix3::from_columns(&legs.map(|leg| leg[0]));
        if firsts.determinant().abs() < 0.1 {
            continue;
        }
        let m = read(mechanism(legs.iter().enumerate().map(|(i, a)| sliders(i, *a)).collect()));
        let solved = |pose: &[f64]| -> Vec<f64> {
            let moved = Vector3::from_row_slice(pose) - Vector3::from_row_slice(&m.home_pose());
            let of_leg = |axes: &[Vector3<f64>; 3]| {
                Matrix3::from_columns(axes).lu().solve(&moved).expect("they are independent")
            };
            legs.iter().flat_map(|axes| of_leg(axes).iter().copied().collect::<Vec<_>>()).collect()
        };
        let inside = |pose: &[f64]| solved(pose).iter().all(|q| (-0.4..=0.5).contains(q));
        let mut solution = m.solution();
        for _ in 0..200 {
            let pose: Vec<f64> = m.home_pose().iter().map(|q| q + rng.f64() - 0.5).collect();
            let reached = m.inverse(&pose, m.home_mode(), &mut solution).unwrap().is_some();
            assert!(reached, "the chains reach every place");
            assert_eq!(solution.within_limits(), inside(&pose), "{pose:?}");
            for (q, expected) in solution.joints().iter().zip(solved(&pose)) {
                assert!((q - expected).abs() < 100.0 * ROUNDING, "{q} {expected}");
            }
            let driven = [0, 3, 6].map(|i| solution.joints()[i]);
            let found = m.forward(&driven).unwrap().list;
            assert_eq!(found.len(), 1, "{pose:?}");
            for (q, expected) in found[0].pose.iter().zip(&pose) {
                assert!((q - expected).abs() < 1000.0 * ROUNDING);
            }
        }
        // Rows of a sweep.
        let axes: Vec<Axis> = m
            .task_coordinates()
            .iter()
            .map(|c| Axis::new(c.name, c.home - 1.01, c.home + 1.03, 24))
            .collect();
        let grid = Grid::new(&m, axes).unwrap();
        let count = Sweep::new(&m, &grid, Modes::Any).count(&Progress::default()).unwrap();
        let counted = (0..grid.poses()).filter(|&i| inside(&grid.pose(i))).count() as u64;
        assert_eq!(count.reachable, counted);
        assert!(counted > 20);
    }
}

/// One leg with limits on all of its sliders: the volume is that of a parallelepiped.
#[test]
fn the_volume_of_a_parallelepiped_is_in_the_bounds() {
    let mut rng = Rng::with_seed(4);
    for round in 0..6 {
        let axes = if round == 0 { AXES } else { oblique(&mut rng) };
        let volume = 0.9_f64.powi(3) * Matrix3::from_columns(&axes).determinant().abs();
        let mut legs: Vec<Vec<Joint>> = (0..3).map(|i| sliders(i, axes)).collect();
        // The three legs drive different sliders of equal ones.
        for (i, leg) in legs.iter_mut().enumerate() {
            for (j, joint) in leg.iter_mut().enumerate() {
                joint.actuated = i == j;
            }
        }
        let m = read(mechanism(legs));
        assert_eq!(names(&m), ["x", "y", "z"]);
        let over: Vec<CoordinateRange> = m
            .task_coordinates()
            .iter()
            .map(|c| CoordinateRange::new(c.name, c.home - 1.6, c.home + 1.7))
            .collect();
        let domain = Domain::new(&m, Sections::Whole, &over).unwrap();
        let goal = Goal { tolerance: 0.02, ..Goal::default() };
        let found = measure(&m, &domain, Modes::Any, &goal, &Progress::default());
        assert!(found.lower <= volume && volume <= found.upper, "{volume} {found:?}");
        assert!((found.upper - found.lower) / volume < 0.05, "{found:?}");
    }
}

/// The displacement of the platform at each pose is a product of translations and rotations.
#[test]
fn pairs_displace_as_their_names_say() {
    let mut rng = Rng::with_seed(5);
    let centre = Point3::new(0.2, 0.1, -0.3);
    let ball = |leg: usize| joint(&format!("b{leg}"), JointKind::Spherical, Vector3::z(), centre);
    let line = Unit::new_normalize(vector![0.1, -0.2, 1.0]);
    let turn = |leg: usize| joint(&format!("r{leg}"), JointKind::Revolute, *line, centre);
    let shaft = |leg: usize| joint(&format!("c{leg}"), JointKind::Cylindrical, *line, centre);
    let driven = |joint: Joint| Joint { actuated: true, ..joint };
    for _ in 0..10 {
        let axes = [oblique(&mut rng), oblique(&mut rng), oblique(&mut rng)];
        let all = |leg: usize| {
            let slider = sliders(leg, axes[leg]).into_iter();
            slider.map(|joint| Joint { actuated: true, ..joint.within(None) }).collect::<Vec<_>>()
        };
        let wrist = |leg: usize| -> Vec<Joint> {
            AXES.iter()
                .enumerate()
                .map(|(i, axis)| {
                    let turned = Rotation3::from_euler_angles(0.3, 0.2 * leg as f64, 0.5) * axis;
                    driven(joint(&format!("w{leg}{i}"), JointKind::Revolute, turned, centre))
                })
                .collect()
        };
        let about = |axis: Vector3<f64>, angle: f64, point: Point3<f64>| {
            let rotation = UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), angle);
            Translation3::from(point.coords)
                * Isometry3::from_parts(Translation3::identity(), rotation)
                * Translation3::from(-point.coords)
        };
        let q: Vec<f64> = (0..6).map(|_| rng.f64() - 0.5).collect();
        let shifted = |m: &Manipulator| -> Vec<f64> {
            m.home_pose().iter().zip(&q).map(|(home, q)| home + q).collect()
        };
        let euler = |[zeta, xi, psi]: [f64; 3]| {
            about(AXES[2], zeta, centre) * about(AXES[1], xi, centre) * about(AXES[2], psi, centre)
        };
        let check = |m: &Manipulator, expected: Isometry3<f64>, coordinates: &[&str]| {
            assert_eq!(names(m), coordinates);
            let found = m.displacement(&shifted(m)).unwrap();
            let off = (found.to_homogeneous() - expected.to_homogeneous()).amax();
            assert!(off < 10.0 * ROUNDING, "{coordinates:?} {off}");
            let located = m.locate(&expected).unwrap();
            let again = m.displacement(&located).unwrap();
            assert!((again.to_homogeneous() - expected.to_homogeneous()).amax() < 1e-9);
        };
        let way = Translation3::new(q[0], q[1], q[2]);

        // Balls on top: the centre of the sphere moves by x y z. The wrist has its motors.
        let m = read(mechanism(vec![
            [all(0), vec![ball(0)]].concat(),
            [all(1), vec![ball(1)]].concat(),
            [all(2), wrist(2)].concat(),
        ]));
        let expected = way * euler([q[3], q[4], q[5]]);
        check(&m, expected, &["x", "y", "z", "zeta", "xi", "psi"]);

        // The sphere below: its rotation carries the sliders.
        let m = read(mechanism(vec![
            [vec![ball(0)], all(0)].concat(),
            [vec![ball(1)], all(1)].concat(),
            [wrist(2), all(2)].concat(),
        ]));
        let expected = euler([q[0], q[1], q[2]]) * Translation3::new(q[3], q[4], q[5]);
        check(&m, expected, &["zeta", "xi", "psi", "x", "y", "z"]);

        // A cylinder above, which shares the translation along its axis. One leg has a splined shaft and two sliders.
        let m = read(mechanism(vec![
            [all(0), vec![driven(turn(0))]].concat(),
            [all(1), vec![turn(1)]].concat(),
            [all(2)[..2].to_vec(), vec![shaft(2)]].concat(),
        ]));
        let [first, second] = [m.task().lower.axes.column(0), m.task().lower.axes.column(1)];
        assert!((m.task().lower.axes.column(2) - *line).norm() < ROUNDING);
        let way = first * q[0] + second * q[1] + *line * q[2];
        let expected = Translation3::from(way) * about(*line, q[3], centre);
        check(&m, expected, &["x", "y", "z", "phi"]);

        // A cylinder below.
        let m = read(mechanism(vec![
            [vec![driven(turn(0))], all(0)].concat(),
            [vec![turn(1)], all(1)].concat(),
            [vec![shaft(2)], all(2)[..2].to_vec()].concat(),
        ]));
        let [first, second] = [m.task().upper.axes.column(0), m.task().upper.axes.column(1)];
        let across = Translation3::from(first * q[2] + second * q[3]);
        let expected = about(*line, q[0], centre) * Translation3::from(*line * q[1]) * across;
        check(&m, expected, &["theta", "z", "w", "h"]);
    }
}

/// A leg of two sliders keeps the platform in a plane, alone and below a sphere: one coordinate follows from the others.
#[test]
fn a_leg_of_two_sliders_keeps_the_plane() {
    let mut rng = Rng::with_seed(6);
    let centre = Point3::new(0.2, 0.1, -0.3);
    for round in 0..40 {
        let axes = [oblique(&mut rng), oblique(&mut rng), oblique(&mut rng)];
        let normal = axes[0][0].cross(&axes[0][1]);
        let mut legs: Vec<Vec<Joint>> = (0..3).map(|i| sliders(i, axes[i])).collect();
        legs[0].truncate(2);
        let below_a_sphere = round % 2 == 0;
        if below_a_sphere {
            for (i, leg) in legs.iter_mut().enumerate() {
                for (j, axis) in AXES.iter().enumerate() {
                    let axis = Rotation3::from_euler_angles(0.3, 0.4 * i as f64, 0.5) * axis;
                    let joint = joint(&format!("w{i}{j}"), JointKind::Revolute, axis, centre);
                    leg.push(Joint { actuated: i == 0, ..joint });
                }
            }
        }
        let m = read(mechanism(legs));
        let [dependent] = m.dependent_coordinates() else { panic!("one coordinate follows") };
        assert_eq!(m.task_coordinates().len(), if below_a_sphere { 5 } else { 2 });
        let (mut solution, mode) = (m.solution(), m.home_mode());
        for _ in 0..20 {
            let home = m.home_pose();
            let pose: Vec<f64> = home.iter().map(|q| q + 0.4 * (rng.f64() - 0.5)).collect();
            let follows = m.dependent_values(&pose, mode).unwrap().unwrap()[0];
            let mut moved = Vector3::zeros();
            let directions = ["x", "y", "z"];
            let place = |name: &str| directions.iter().position(|other| *other == name);
            moved[place(dependent.name).unwrap()] = follows - dependent.home;
            for (c, (q, home)) in m.task_coordinates().iter().zip(pose.iter().zip(&home)) {
                if let Some(i) = place(c.name) {
                    moved[i] = q - home;
                }
            }
            assert!(normal.dot(&moved).abs() < 10.0 * ROUNDING, "{moved}");
            if m.inverse(&pose, mode, &mut solution).unwrap().is_none() {
                continue;
            }
            // The sliders of the leg add up to the displacement of the place.
            let joints = solution.joints();
            let sum = axes[0][0] * joints[0] + axes[0][1] * joints[1];
            assert!((sum - moved).norm() < 10.0 * ROUNDING, "{sum} {moved}");
        }
    }
}

/// A leg of dependent sliders is refused, and named with its sliders.
#[test]
fn dependent_sliders_are_refused() {
    let [x, y, z] = AXES;
    let inclined = (x - y).normalize();
    for (axes, reason) in [
        ([x, x, z], "two sliders are parallel"),
        ([x, z, -x], "two sliders are parallel"),
        ([x, y, inclined], "three sliders are in one plane"),
    ] {
        let mut legs = vec![sliders(0, [x, y, z]), sliders(1, [y, z, x]), sliders(2, axes)];
        // The others control the platform.
        legs[0].iter_mut().for_each(|joint| joint.actuated = true);
        let error = Manipulator::new(mechanism(legs)).unwrap_err().to_string();
        assert!(error.contains("leg2") && error.contains("s20, s21, s22"), "{error}");
        assert!(error.contains(reason), "{error}");
    }
}

/// A mechanism whose legs all move in one Schoenflies group keeps that reading where it has closed forms: one slider of
/// each leg along the direction. With oblique sliders it is three translations and a cylinder.
#[test]
fn schoenflies_motion_keeps_its_own_closed_forms() {
    let [x, y, z] = AXES;
    let tops = |axes: [[Vector3<f64>; 3]; 3]| {
        let turn = |i: usize| Joint {
            actuated: i == 0,
            ..joint(&format!("r{i}"), JointKind::Revolute, z, Point3::new(0.3, 0.1, 0.0))
        };
        let shaft = joint("c2", JointKind::Cylindrical, z, Point3::new(0.3, 0.1, 0.0));
        let [one, two] = [0, 1].map(|i| [sliders(i, axes[i]), vec![turn(i)]].concat());
        let three = [sliders(2, axes[2])[..2].to_vec(), vec![shaft]].concat();
        mechanism(vec![one, two, three])
    };
    let straight = tops([[x, y, z], [z, x, y], [y, x, z]]);
    assert_eq!(decompose(&straight).unwrap()[0].lower.name(), "schoenflies");
    let one = Vector3::new(1.0, 0.2, 0.3);
    let oblique = tops([[one, y, z], [z, x, y], [y, x, z]]);
    let found = &decompose(&oblique).unwrap()[0];
    assert_eq!([found.lower.name(), found.upper.name()], ["translational space", "cylindrical"]);
    assert_eq!(names(&read(oblique)), ["x", "y", "z", "phi"]);
}
