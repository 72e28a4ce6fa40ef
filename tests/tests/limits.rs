//! Limits and full revolutions, on random mechanisms of every pair of subspaces.

use fastrand::Rng;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::JointKind;
use opm_tests::random::{Options, PAIRS, mechanism};
use std::f64::consts::{PI, TAU};

/// Joints that are locked at home, each at zero: home is within the limits.
#[test]
fn home_is_inside_limits_that_leave_nothing_else() {
    let mut rng = Rng::with_seed(4);
    for pair in PAIRS {
        for _ in 0..50 {
            let (mut mechanism, decomposition) =
                mechanism(&mut rng, pair, Options { limited: 0.0, balls: true });
            let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
            for coordinate in joints.flat_map(|joint| &mut joint.coordinates) {
                (coordinate.home, coordinate.limits) = (0.0, Some([0.0, 0.0]));
            }
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            let home = manipulator.home_pose();
            assert!(
                manipulator
                    .inverse(&home, manipulator.home_mode(), &mut solution)
                    .unwrap()
                    .is_some()
            );
            assert!(solution.within_limits(), "{pair:?} {:?}", solution.joints());
        }
    }
}

/// A revolution more or less does not change the displacement of a revolute joint. Its value is
/// reported within π of home or within its limits, and it is outside its limits only if no number
/// of revolutions is inside.
#[test]
fn revolute_joints_know_no_whole_turns() {
    let mut rng = Rng::with_seed(5);
    for pair in PAIRS {
        let (mut judged, mut outside) = (0, 0);
        for _ in 0..100 {
            let (mechanism, decomposition) =
                mechanism(&mut rng, pair, Options { limited: 0.3, balls: true });
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            // The first coordinate of these rotates about the axis, whatever the second one does.
            let kinds = manipulator.mechanism().joints().flat_map(|joint| {
                let turns = |i| match joint.kind {
                    JointKind::Revolute | JointKind::Universal { .. } => true,
                    JointKind::Cylindrical => i == 0,
                    _ => false,
                };
                (0..joint.freedoms()).map(turns).collect::<Vec<_>>()
            });
            let turning: Vec<bool> = kinds.collect();
            for _ in 0..10 {
                let home = manipulator.home_pose();
                let pose: Vec<f64> =
                    home.iter().map(|h| h + (rng.f64() * 2.0 - 1.0) * 7.0).collect();
                if manipulator
                    .inverse(&pose, manipulator.home_mode(), &mut solution)
                    .unwrap()
                    .is_none()
                {
                    continue;
                }
                let mut within = true;
                for ((c, &q), &turning) in
                    manipulator.coordinates().iter().zip(solution.joints()).zip(&turning)
                {
                    let [low, high] = c.limits.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
                    let inside = (low..=high).contains(&q);
                    if turning && c.limits.is_some() {
                        let possible = (q - low).rem_euclid(TAU) <= high - low;
                        assert_eq!(inside, possible, "{pair:?} {} {q} {:?}", c.name, c.limits);
                        judged += 1;
                        outside += usize::from(!inside);
                    } else if turning {
                        assert!((q - c.home).abs() <= PI + 1e-9, "{pair:?} {} is {q}", c.name);
                    }
                    within &= inside;
                }
                assert_eq!(solution.within_limits(), within, "{pair:?}");
            }
        }
        println!("{pair:?}: {outside} of {judged} limited angles outside");
    }
}
