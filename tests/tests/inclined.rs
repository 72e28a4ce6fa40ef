//! A Schoenflies section beside a cylinder whose axis is inclined to its direction, compared with displacements that are
//! multiplied here, and with the products of exponentials of the undecomposed legs.

use fastrand::Rng;
use nalgebra::{
    Isometry3, Point3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3, point, vector,
};
use opm_core::Manipulator;
use opm_core::forward::NoClosedForm;
use opm_core::manipulator::Solution;
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, TaskHints};
use opm_study::{WorkspaceKind, WorkspaceRequest};
use opm_tests::random::{Meet, Options, RandomSubspace, mechanism};
use opm_tests::structured::gap;
use opm_workspace::measure::{Domain, DomainError};
use opm_workspace::{Axis, Grid, GridError, Modes, Progress, Sections, Sweep};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Rounding of a few dozen operations on numbers of about one.
const ROUNDING: f64 = 1e-12;

/// The largest closure error of a leg: rounding, times the numbers by which random sliders are nearly parallel.
const CLOSURE: f64 = 1e-9;

const ORDERS: [[RandomSubspace; 2]; 2] = [
    [RandomSubspace::Inclined, RandomSubspace::Cylindrical(Meet::Translation)],
    [RandomSubspace::Cylindrical(Meet::Translation), RandomSubspace::Inclined],
];

const REVOLUTE: JointKind = JointKind::Revolute;
const SLIDER: JointKind = JointKind::Prismatic;
const UP: Vector3<f64> = vector![0.0, 0.0, 1.0];

/// A point of the cylinder's axis, which is the platform's reference point.
const ON_AXIS: Point3<f64> = point![0.4, 0.3, 0.5];

fn joint(name: &str, kind: JointKind, axis: Vector3<f64>, point: Point3<f64>) -> Joint {
    Joint::new(name, kind, Unit::new_normalize(axis), point)
}

fn read(legs: Vec<Vec<Joint>>) -> Manipulator {
    Manipulator::new(described(legs)).unwrap_or_else(|error| panic!("{error}"))
}

fn described(legs: Vec<Vec<Joint>>) -> Mechanism {
    let leg = |(i, joints): (usize, Vec<Joint>)| Leg::new(format!("leg{i}"), joints);
    Mechanism {
        name: "inclined".into(),
        legs: legs.into_iter().enumerate().map(leg).collect(),
        platform: ON_AXIS,
        differences: Vec::new(),
        task: TaskHints::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    }
}

/// The cylinder's axis at an angle to the direction of the Schoenflies section, towards x.
fn axis(angle: f64) -> Vector3<f64> {
    vector![angle.sin(), 0.0, angle.cos()]
}

/// Two revolute joints and a lift, or three and a lift, from pivots of a leg.
fn arm(leg: usize, pivots: &[[f64; 2]], lift: usize) -> Vec<Joint> {
    let revolute = |(i, [x, y]): (usize, &[f64; 2])| {
        let name = format!("{}{leg}", ["a", "b", "c"][i]);
        joint(&name, REVOLUTE, UP, point![*x, *y, 0.1 * i as f64])
    };
    let mut joints: Vec<Joint> = pivots.iter().enumerate().map(revolute).collect();
    joints.insert(lift, joint(&format!("lift{leg}"), SLIDER, UP, point![0.0, 0.0, 0.0]));
    joints
}

/// The joints of three legs with the arms below and the cylinder's joints above: a revolute, a screw and a sleeve.
fn legs(angle: f64) -> Vec<Vec<Joint>> {
    let along = axis(angle);
    let on_axis = |name: &str, kind| joint(name, kind, along, ON_AXIS + along * 0.2);
    let mut first = arm(1, &[[0.0, 0.0], [0.5, 0.1], [0.4, 0.6]], 3);
    first.push(on_axis("d1", REVOLUTE));
    let mut second = arm(2, &[[1.0, 0.0], [1.1, 0.5], [0.6, 0.5]], 0);
    second.push(on_axis("d2", JointKind::Helical { pitch: 0.15 }));
    let mut third = arm(3, &[[0.2, 1.1], [0.7, 0.9]], 1);
    third.push(on_axis("d3", JointKind::Cylindrical));
    drive(vec![first, second, third], &["a1", "b1", "c1", "lift1", "d2"])
}

/// Legs with these joints driven, and no others.
fn drive(mut legs: Vec<Vec<Joint>>, names: &[&str]) -> Vec<Vec<Joint>> {
    for joint in legs.iter_mut().flatten() {
        joint.actuated = names.contains(&joint.name.as_str());
    }
    legs
}

/// The solutions in all modes at a pose.
fn solutions(m: &Manipulator, pose: &[f64]) -> Vec<Solution> {
    let mut all = m.all_modes();
    m.inverse_all(pose, &mut all).unwrap();
    let in_mode = |mode| {
        let mut solution = m.solution();
        assert!(m.solution_in_mode(&all, mode, &mut solution).is_some());
        solution
    };
    all.modes(m).map(in_mode).collect()
}

fn about(axis: Vector3<f64>, point: Point3<f64>, angle: f64) -> Isometry3<f64> {
    let turn = UnitQuaternion::from_axis_angle(&Unit::new_normalize(axis), angle);
    Translation3::from(point.coords) * turn * Translation3::from(-point.coords)
}

/// The platform's displacement for `x y z theta phi` from home: a rotation about the direction and a translation, after
/// a rotation about the cylinder's axis.
fn displaced(angle: f64, [x, y, z, theta, phi]: [f64; 5]) -> [Isometry3<f64>; 2] {
    let below = Translation3::new(x, y, z) * about(UP, ON_AXIS, theta);
    [below, below * about(axis(angle), ON_AXIS, phi)]
}

/// Legs close at poses with half turns, at angles of 45 and 135 degrees, and where the axis is nearly along the
/// direction or nearly perpendicular to it. The imaginary joint is the slider along the axis that would have to be
/// between the sections, and the lift has its height.
#[test]
fn imaginary_joints_have_a_part_in_the_height() {
    let mut rng = Rng::with_seed(1);
    for degrees in [45.0_f64, 135.0, 20.0, 89.0, 5.0] {
        let angle = degrees.to_radians();
        let m = read(legs(angle));
        let names: Vec<_> = m.task_coordinates().iter().map(|c| c.name).collect();
        assert_eq!(names, ["x", "y", "z", "theta", "phi"]);
        // An axis points up.
        let along = axis(angle) * axis(angle).z.signum();
        let sense = axis(angle).z.signum();
        let mut closed = 0;
        for round in 0..60 {
            let near = |size: f64, rng: &mut Rng| size * (2.0 * rng.f64() - 1.0);
            let turn = |rng: &mut Rng| match round % 3 {
                0 => PI,
                1 => PI / 2.0,
                _ => near(3.0, rng),
            };
            let moved = [
                near(0.1, &mut rng),
                near(0.1, &mut rng),
                near(0.2, &mut rng),
                if round % 2 == 0 { near(0.3, &mut rng) } else { turn(&mut rng) },
                turn(&mut rng),
            ];
            let pose: Vec<f64> = m.home_pose().iter().zip(moved).map(|(q, d)| q + d).collect();
            let [below, target] =
                displaced(angle, [moved[0], moved[1], moved[2], moved[3], sense * moved[4]]);
            assert!(
                (m.displacement(&pose).unwrap().to_homogeneous() - target.to_homogeneous()).amax()
                    < ROUNDING
            );
            let located = m.locate(&target).unwrap();
            let again = m.displacement(&located).unwrap();
            assert!((again.to_homogeneous() - target.to_homogeneous()).amax() < ROUNDING);
            for solution in solutions(&m, &pose) {
                closed += 1;
                assert!(
                    gap(&m, solution.joints(), &target) < 100.0 * ROUNDING,
                    "{degrees} {pose:?}"
                );
                // The revolute joint of leg 1 does not move along the axis, and the screw of leg 2 does.
                let [first, second] = [0, 1].map(|i| solution.imaginary()[i]);
                let screwed = -0.15 * moved[4];
                assert!(first.abs() < ROUNDING, "{first}");
                assert!((second - screwed).abs() < ROUNDING, "{second} {screwed}");
                // What reaches the end of the lower section is displaced by that joint.
                for (leg, tau) in [(0, first), (1, second)] {
                    let joints = &m.mechanism().legs[leg].joints[..4];
                    let values = &solution.joints()[5 * leg..5 * leg + 4];
                    let lower = Leg::new("lower", joints.to_vec()).displacement(values).unwrap();
                    let expected = below * Translation3::from(along * tau);
                    let off = (lower.to_homogeneous() - expected.to_homogeneous()).amax();
                    assert!(off < 100.0 * ROUNDING, "{degrees} {pose:?}: {off:e}");
                }
                let lift = solution.joints()[5];
                assert!((lift - moved[2] - along.z * second).abs() < ROUNDING);
            }
        }
        println!("{degrees} degrees: {closed} solutions");
        assert!(closed > 100, "{degrees}: {closed}");
    }
}

/// A thousand random mechanisms of each order close in every mode, and their platforms are located.
#[test]
fn random_mechanisms_close_and_are_located() {
    let mut rng = Rng::with_seed(2);
    for pair in ORDERS {
        let (mut solved, mut worst, mut leaning) = (0, 0.0_f64, 0);
        for round in 0..1000 {
            let options = Options { limited: 0.0, balls: round % 2 == 0 };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let m = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            leaning += usize::from(m.leaning_joints().next().is_some());
            for _ in 0..4 {
                let near = |home: f64, rng: &mut Rng| home + 1.2 * (rng.f64() - rng.f64());
                let pose: Vec<f64> = m.home_pose().iter().map(|q| near(*q, &mut rng)).collect();
                let target = m.displacement(&pose).unwrap();
                let located = m.locate(&target).unwrap();
                let apart = located.iter().zip(&pose).map(|(a, b)| (a - b).abs());
                assert!(apart.fold(0.0, f64::max) < 1e-9, "{pair:?} {located:?} {pose:?}");
                for solution in solutions(&m, &pose) {
                    let size = solution.joints().iter().fold(1.0, |s: f64, q| s.max(q.abs()));
                    worst = worst.max(gap(&m, solution.joints(), &target) / size);
                    solved += 1;
                }
            }
        }
        println!("{pair:?}: {solved} solutions, worst {worst:.1e}, {leaning} with lifts that lean");
        assert!(solved > 2000 && leaning > 100);
        assert!(worst < CLOSURE, "{worst:e}");
    }
}

/// Mechanisms are read without their decomposition: it is found, and its axes are those of the joints.
#[test]
fn both_orders_are_read() {
    let m = read(legs(PI / 4.0));
    assert_eq!(
        (m.decomposition().lower.name(), m.decomposition().upper.name()),
        ("schoenflies", "cylindrical")
    );
    // The same mechanism upside down: base and platform exchanged.
    let turned = legs(PI / 4.0).into_iter().map(|leg| leg.into_iter().rev().collect());
    let m = read(turned.collect());
    assert_eq!(
        (m.decomposition().lower.name(), m.decomposition().upper.name()),
        ("cylindrical", "schoenflies")
    );
    let names: Vec<_> = m.task_coordinates().iter().map(|c| c.name).collect();
    assert_eq!(names, ["theta", "z", "w", "h", "phi"]);
    // Upside down, a leg's joints do the inverse displacement in the opposite order.
    let straight = read(legs(PI / 4.0));
    let mut rng = Rng::with_seed(4);
    let mut closed = 0;
    for _ in 0..40 {
        let pose: Vec<f64> = m.home_pose().iter().map(|q| q + 0.3 * (rng.f64() - 0.5)).collect();
        let target = m.displacement(&pose).unwrap();
        let other = straight.locate(&target.inverse()).unwrap();
        let [here, there] = [(&m, &pose), (&straight, &other)].map(|(m, pose)| solutions(m, pose));
        assert_eq!(here.len(), there.len());
        for solution in &here {
            closed += 1;
            assert!(gap(&m, solution.joints(), &target) < 100.0 * ROUNDING);
            let reversed = |other: &&Solution| {
                let mut first = 0;
                m.mechanism().legs.iter().all(|leg| {
                    let own = first..first + leg.coordinates().count();
                    first = own.end;
                    let same = |(a, b): (f64, &f64)| {
                        ((a - b) / TAU - ((a - b) / TAU).round()).abs() < 1e-9
                    };
                    // A sleeve is one joint with two values.
                    let mut back: Vec<f64> = Vec::new();
                    let mut at = own.end;
                    for joint in &leg.joints {
                        at -= joint.freedoms();
                        back.extend(&other.joints()[at..at + joint.freedoms()]);
                    }
                    let back = back.into_iter().map(|q| -q);
                    back.zip(&solution.joints()[own]).all(same)
                })
            };
            assert!(there.iter().any(|other| reversed(&other)));
        }
    }
    assert!(closed > 100, "{closed}");
}

/// With one driven lift, the projected problem gives the imaginary joints, and these the height; with several, Newton's
/// method finds the pose.
#[test]
fn forward_kinematics_give_the_pose_back() {
    let mut rng = Rng::with_seed(5);
    // A passive screw carries the height of leg 2.
    let mut screwed = legs(PI / 4.0);
    screwed[1][0] = joint("lift2", JointKind::Helical { pitch: 0.3 }, UP, point![0.8, 0.2, 0.0]);
    for (legs, names, closed) in [
        (legs(PI / 4.0), ["a1", "b1", "c1", "lift1", "d2"], true),
        (legs(PI / 4.0), ["a1", "b1", "c1", "a2", "lift2"], true),
        (legs(PI / 4.0), ["a1", "b1", "c1", "a2", "lift3"], true),
        (screwed.clone(), ["a1", "b1", "c1", "lift1", "d2"], true),
        (screwed.clone(), ["a1", "b1", "c1", "d2", "lift2"], true),
        // A joint of the leg with the screw, whose chain depends on the height that is looked for.
        (screwed, ["a1", "b1", "c1", "lift1", "a2"], false),
        // The second lift is the only one that knows of phi.
        (legs(PI / 4.0), ["a1", "b1", "c1", "lift1", "lift2"], false),
    ] {
        let m = read(drive(legs, &names));
        let expected = if closed { Ok(()) } else { Err(NoClosedForm::Inclined) };
        assert_eq!(m.forward_closed_form(), expected, "{names:?}");
        for _ in 0..40 {
            let pose: Vec<f64> =
                m.home_pose().iter().map(|q| q + 0.2 * (rng.f64() - 0.5)).collect();
            let mut solution = m.solution();
            let solved = m.inverse(&pose, m.home_mode(), &mut solution).unwrap();
            let joints = solved.expect("it is near home").joints();
            let values: Vec<f64> = m.actuated().iter().map(|&i| joints[i]).collect();
            let same = |found: &[f64]| found.iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-7);
            if closed {
                let found = m.forward(&values).unwrap();
                assert!(found.list.iter().any(|one| same(&one.pose)), "{names:?} {found:?}");
            }
            let near = m.forward_near(&values, &m.home_pose(), m.home_mode()).unwrap();
            assert!(same(&near.pose), "{names:?} {:?} {pose:?}", near.pose);
        }
    }
}

/// Leg 1 holds a pivot of the platform's lower part, `C`, and its height. A driven lift of leg 3, whose arm has two
/// pivots, `A` at the base and `B`, then holds the imaginary joint. What is left is a four-bar linkage: it is singular
/// where `A`, `B` and `C` are on one line.
#[test]
fn a_lift_that_holds_the_imaginary_joint_is_singular_where_the_linkage_is() {
    let m = read(drive(legs(PI / 4.0), &["a1", "b1", "lift1", "d1", "lift3"]));
    let (mut jacobians, mut measured) = (m.jacobians(), m.singularities());
    let mut senses = [0; 2];
    let mut constant: Option<f64> = None;
    for step in -300..=300 {
        // The platform's lower part turns about C, as it is at home.
        let turn = 0.01 * f64::from(step);
        let place = about(UP, point![0.4, 0.6, 0.0], turn) * ON_AXIS;
        for at in solutions(&m, &[place.x, place.y, place.z, turn, 0.1]) {
            m.differentiate(&at, &mut jacobians).unwrap();
            m.measure_singularities(&jacobians, &mut measured);
            // The first joint of leg 3 comes after the five of each other leg.
            let arm = Rotation3::from_axis_angle(&Vector3::z_axis(), at.joints()[10]);
            let (a, c) = (vector![0.2, 1.1, 0.0], vector![0.4, 0.6, 0.0]);
            let b = a + arm * (vector![0.7, 0.9, 0.0] - a);
            let across = (b - a).cross(&(c - a)).z;
            if across.abs() < 1e-3 {
                continue;
            }
            let ratio = measured.whole.parallel.unwrap() / across;
            let constant = *constant.get_or_insert(ratio);
            assert!((ratio / constant - 1.0).abs() < 1e-9, "{turn}: {ratio} {constant}");
            senses[usize::from(across > 0.0)] += 1;
        }
    }
    assert!(senses[0] > 10 && senses[1] > 10, "{senses:?}");
}

/// Sweeps agree with inverse kinematics of each pose, with limits on a lift too: what it admits is not a height.
#[test]
fn sweeps_count_what_lifts_admit() {
    let mut legs = legs(PI / 4.0);
    let lift = legs[1].iter_mut().find(|joint| joint.name == "lift2").unwrap();
    *lift = lift.clone().within(Some([-0.1, 0.1]));
    let m = read(legs);
    let home = m.home_pose();
    let axis = |i: usize, half: f64, count| {
        Axis::new(m.task_coordinates()[i].name, home[i] - half, home[i] + half, count)
    };
    let axes =
        vec![axis(0, 0.1, 5), axis(1, 0.1, 5), axis(2, 0.2, 9), axis(3, 0.2, 3), axis(4, 1.5, 9)];
    let grid = Grid::new(&m, axes).unwrap();
    let (mut expected, mut reached) = (0, 0);
    for number in 0..grid.poses() {
        let pose = grid.pose(number);
        let mut solution = m.solution();
        if m.inverse(&pose, m.home_mode(), &mut solution).unwrap().is_none() {
            continue;
        }
        // The lift's own height, from the screw of leg 2.
        let rise = pose[2] - home[2] - (PI / 4.0).cos() * 0.15 * (pose[4] - home[4]);
        reached += 1;
        expected += u64::from(rise.abs() <= 0.1 + 1e-9);
    }
    let modes = Modes::One(m.home_mode());
    let sweep = Sweep::new(&m, &grid, modes);
    let found = sweep.count(&Progress::default()).unwrap().reachable;
    assert_eq!(found, expected);
    assert!(expected > 100 && expected < reached, "{expected} of {reached}");
}

/// What has no closed form, bounds or sections alone is refused with the reason.
#[test]
fn what_is_not_covered_is_named() {
    let told = |change: &dyn Fn(&mut Vec<Vec<Joint>>)| {
        let mut legs = legs(PI / 4.0);
        change(&mut legs);
        Manipulator::new(described(legs)).unwrap_err().to_string()
    };
    // Leg 3 has its imaginary joint beside the lift.
    let screw = |leg: usize, at: usize| {
        move |legs: &mut Vec<Vec<Joint>>| {
            let name = legs[leg][at].name.clone();
            legs[leg][at] =
                joint(&name, JointKind::Helical { pitch: 0.2 }, UP, point![0.1, 0.0, 0.0]);
        }
    };
    let found = told(&screw(2, 1));
    assert!(
        found.contains("leg2") && found.contains("lift3") && found.contains("imaginary"),
        "{found}"
    );
    // In the other legs a screw carries the height.
    let mut legs = legs(PI / 4.0);
    screw(1, 0)(&mut legs);
    let m = read(legs);
    assert_eq!(m.leaning_joints().collect::<Vec<_>>(), ["lift2"]);
    assert_eq!(
        Domain::new(&read(self::legs(1.0)), Sections::Whole, &[]).unwrap_err(),
        DomainError::Inclined
    );
    assert_eq!(Grid::of(Sections::Lower, &m, vec![]).unwrap_err(), GridError::NotAlone);
    let m = read(self::legs(1.0));
    assert_eq!(Grid::of(Sections::Lower, &m, vec![]).unwrap_err(), GridError::NotAlone);
    let request = WorkspaceRequest::new(WorkspaceKind::Lower).check(Arc::new(m));
    let found = request.unwrap_err().to_string();
    assert!(found.contains("inclined"), "{found}");
    // Three pivots, and no lift: a joint about the cylinder's axis comes before the one along it.
    let without_lift = |legs: &mut Vec<Vec<Joint>>| {
        legs[2] = arm(3, &[[0.2, 1.1], [0.7, 0.9], [0.3, 0.4]], 3);
        legs[2][3] = joint("d3", REVOLUTE, axis(PI / 4.0), ON_AXIS);
        legs[2].push(joint("e3", JointKind::Helical { pitch: 0.1 }, axis(PI / 4.0), ON_AXIS));
    };
    let found = told(&without_lift);
    assert!(found.contains("leg2: ") && found.contains("no joint changes it"), "{found}");
}

/// A slider along the cylinder's axis, next to three pivots, carries the height of its leg: it is an inclined lift.
#[test]
fn a_slider_along_the_axis_carries_the_height() {
    let mut legs = legs(PI / 4.0);
    legs[2] = arm(3, &[[0.2, 1.1], [0.7, 0.9], [0.3, 0.4]], 3);
    legs[2][3] = joint("d3", JointKind::Cylindrical, axis(PI / 4.0), ON_AXIS);
    let m = read(legs);
    assert_eq!(m.leaning_joints().collect::<Vec<_>>(), ["d3.slide"]);
    let mut rng = Rng::with_seed(6);
    let mut closed = 0;
    for _ in 0..50 {
        let pose: Vec<f64> = m.home_pose().iter().map(|q| q + 0.3 * (rng.f64() - 0.5)).collect();
        for solution in solutions(&m, &pose) {
            closed += 1;
            assert!(gap(&m, solution.joints(), &m.displacement(&pose).unwrap()) < 100.0 * ROUNDING);
            // It alone changes the height.
            let slide = solution.joints().last().unwrap();
            assert!((slide * (PI / 4.0).cos() - (pose[2] - m.home_pose()[2])).abs() < ROUNDING);
        }
    }
    assert!(closed > 100, "{closed}");
}
