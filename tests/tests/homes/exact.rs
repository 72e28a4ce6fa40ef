//! A home that is a parallel singularity refuses nothing that needs no regular home.

use super::{Z, drawn, five_bar, read, three_arms, typed_at, wrist};
use opm_check::{Options, closures};
use opm_core::decomposition::mobility::{HomeSingularity, mobility};
use opm_core::decomposition::{DecomposeError, check_actuators, decompose};
use opm_core::group::subspace::SubspaceClass;
use opm_core::manipulator::Manipulator;
use std::f64::consts::{PI, TAU};

/// The drawings, with the motions that are loose at home: a rotation about a point of the plane (the elbow, the middle),
/// or about an axis.
#[test]
fn a_parallel_singularity_at_home_is_told_once_and_refuses_nothing() {
    let homes = [
        (five_bar(0.0), 2, "rotation about (0, 0, 1) through (350, 50, 0) mm"),
        (three_arms(0.0), 3, "rotation about (0, 0, 1) through (0, 0, 0) mm"),
        (wrist(0.0), 3, "rotation about (0, 0, 1) through (0, 0, 0) mm"),
    ];
    for (text, freedoms, loose) in homes {
        let mechanism = read(&text);
        let report = mobility(&mechanism).unwrap();
        // Away from home the actuators control everything, and none of them is one too many.
        assert_eq!((report.mobility, report.controlled), (freedoms, freedoms), "{text}");
        assert!(report.loose.is_empty() && report.redundant.is_empty(), "{report:?}");
        assert_eq!(check_actuators(&report), Ok(()));
        let [HomeSingularity::Parallel { home: 1, nearby: 0, loose: motions }] =
            &report.singular[..]
        else {
            panic!("{report:?}")
        };
        assert!(matches!(motions[..], [SubspaceClass::Rotation { .. }]), "{motions:?}");
        let told = report.parallel_home().unwrap();
        assert!(told.contains(loose) && !told.contains(" m)"), "{told}");
        let manipulator = Manipulator::new(mechanism).unwrap();
        assert_eq!(manipulator.task_coordinates().len(), freedoms);
        let options = Options { samples: 50, seed: 3 };
        let found = closures(&manipulator, &options, &mut || true).unwrap();
        assert!(found.problem.is_none() && found.compared > 20, "{found:?}");
    }
}

/// The angles of a five-bar's motors at a place of the pen, by the law of cosines. A sign chooses the elbow's side.
fn motor(base: [f64; 2], lengths: [f64; 2], pen: [f64; 2], side: f64) -> f64 {
    let [dx, dy] = [pen[0] - base[0], pen[1] - base[1]];
    let reach = dx.hypot(dy);
    let [a, b] = lengths;
    let inner = ((a * a + reach * reach - b * b) / (2.0 * a * reach)).acos();
    dy.atan2(dx) + side * inner
}

#[test]
fn a_five_bar_drawn_flat_has_the_angles_of_the_law_of_cosines() {
    let manipulator = Manipulator::new(read(&five_bar(0.0))).unwrap();
    let arms = [[0.05_f64.hypot(0.05), 0.15], [0.05_f64.hypot(0.05), 0.15]];
    let bases = [[0.0, 0.0], [0.4, 0.0]];
    let drawn = [0.25 * PI, 0.75 * PI];
    for pen in [[0.195, 0.06], [0.2, 0.02], [0.205, -0.05]] {
        let mut expected = vec![];
        for left in [1.0, -1.0] {
            for right in [1.0, -1.0] {
                let angles =
                    [motor(bases[0], arms[0], pen, left), motor(bases[1], arms[1], pen, right)];
                expected
                    .push([0, 1].map(|leg| (angles[leg] - drawn[leg] + PI).rem_euclid(TAU) - PI));
            }
        }
        let mut got: Vec<[f64; 2]> = vec![];
        let mut at = manipulator.solution();
        for mode in manipulator.modes() {
            if let Some(solution) = manipulator.inverse(&pen, mode, &mut at).unwrap() {
                let joints = solution.joints();
                got.push([joints[0], joints[3]].map(|q| (q + PI).rem_euclid(TAU) - PI));
            }
        }
        let has = |one: &[f64; 2], all: &[[f64; 2]]| {
            all.iter().any(|other| (one[0] - other[0]).abs().max((one[1] - other[1]).abs()) < 1e-9)
        };
        assert!(expected.iter().all(|one| has(one, &got)), "{pen:?}: {expected:?}, {got:?}");
        assert!(got.iter().all(|one| has(one, &expected)), "{pen:?}: {expected:?}, {got:?}");
    }
}

/// The same robot, typed at home and at another pose: the joints differ by those of that pose.
#[test]
fn the_same_robot_typed_elsewhere_has_the_same_joint_differences() {
    let away = [
        (five_bar(0.0), vec![0.195, 0.06], vec![0.205, 0.03]),
        (three_arms(0.0), vec![0.01, -0.015, 0.2], vec![-0.012, 0.02, -0.15]),
        (wrist(0.0), vec![0.3, 0.25, -0.1], vec![-0.4, 0.2, 0.5]),
    ];
    for (text, first, second) in away {
        let manipulator = Manipulator::new(read(&text)).unwrap();
        let mode = manipulator.home_mode();
        let (mut one, mut other) = (manipulator.solution(), manipulator.solution());
        manipulator.inverse(&first, mode, &mut one).unwrap().expect("in reach");
        manipulator.inverse(&second, mode, &mut other).unwrap().expect("in reach");
        let [here, there] = [&one, &other].map(|s| s.displacement(&manipulator));
        let platform = here * manipulator.mechanism().platform;
        let typed =
            Manipulator::new(typed_at(manipulator.mechanism(), one.joints(), platform)).unwrap();
        let report = mobility(typed.mechanism()).unwrap();
        assert!(report.singular.is_empty(), "{report:?}");
        assert_eq!(report.mobility, manipulator.decomposition().mobility);
        let pose = typed.locate(&(there * here.inverse())).unwrap();
        let mut at = typed.solution();
        typed.inverse(&pose, typed.home_mode(), &mut at).unwrap().expect("in reach");
        let moved = one.joints().iter().zip(at.joints());
        for ((from, by), to) in moved.zip(other.joints()) {
            let off = (from + by - to + PI).rem_euclid(TAU) - PI;
            assert!(off.abs() < 1e-9, "{from} and {by} against {to}\n{text}");
        }
    }
}

/// Two motors on one leg of a five-bar control the other one nowhere.
#[test]
fn actuators_that_do_not_control_the_platform_anywhere_are_refused() {
    let flat = five_bar(0.0);
    let text = flat.replace(
        "point = [400.0, 0.0, 0.0], actuated = true",
        "point = [400.0, 0.0, 0.0], actuated = false",
    );
    let error = decompose(&read(&text)).unwrap_err();
    assert!(matches!(error, DecomposeError::Loose { actuators: 1, controlled: 1, .. }), "{error}");
    let error = error.to_string();
    assert!(error.contains("1 actuated freedom controls 1 of the 2 freedoms"), "{error}");
    assert!(error.ends_with("through (350, 50, 0) mm"), "{error}");
}

/// A third motor on a five-bar: any one of the three could be left out, at home as elsewhere. On a flat one, that at the
/// pen is of no use to the two others at home, and is one too many nearby.
#[test]
fn redundant_actuators_are_those_of_poses_nearby() {
    for off in [0.0, 0.6] {
        let text = five_bar(off).replacen(
            "point = [200.0, 50.0, 0.0], actuated = false",
            "point = [200.0, 50.0, 0.0], actuated = true",
            1,
        );
        let report = mobility(&read(&text)).unwrap();
        assert_eq!((report.actuators, report.controlled), (3, 2));
        assert_eq!(report.redundant.len(), 3, "{report:?}");
    }
}

/// Five legs whose upper axes are level at home, as people draw universal joints: they span no sphere there, but do in
/// every other pose. The same robot tilted is the same decomposition.
#[test]
fn upper_axes_in_one_plane_are_those_of_a_sphere() {
    let legs = (0..5).map(|leg| {
        let angle = f64::from(leg) * 1.2566 + 0.1;
        let at = |r: f64, a: f64| [r * (angle + a).cos(), r * (angle + a).sin(), 0.0];
        vec![
            (Z, at(300.0, 0.0)),
            (Z, at(230.0 + 10.0 * f64::from(leg), 0.5)),
            (Z, at(100.0, 0.2 * f64::from(leg))),
            (at(1.0, 0.3), [0.0; 3]),
            (at(1.0, 1.7 + 0.1 * f64::from(leg)), [0.0; 3]),
        ]
    });
    let manipulator = Manipulator::new(read(&drawn(&legs.collect::<Vec<_>>(), [0.0; 3]))).unwrap();
    let found = manipulator.decomposition();
    let sections = [found.lower.name(), found.upper.name(), found.intersection.name()];
    assert_eq!(sections, ["planar", "spherical", "rotation"]);
    assert_eq!((found.lambda, found.mobility), (5, 5));
    let options = Options { samples: 50, seed: 4 };
    let compared = closures(&manipulator, &options, &mut || true).unwrap();
    assert!(compared.problem.is_none() && compared.compared > 20, "{compared:?}");
}
