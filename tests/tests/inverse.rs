//! Inverse kinematics on random mechanisms of every pair of subspaces, compared with the
//! undecomposed legs: each leg's product of exponentials must bring the platform to the pose.

use fastrand::Rng;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::{JointKind, Quantity};
use opm_core::mechanism::leg::Leg;
use opm_tests::random::{Meet, Options, PAIRS, mechanism, meet, order, orders};
use std::collections::BTreeSet;

/// The bound on closure, as a share of the size of the mechanism and of its joint values.
const CLOSURE: f64 = 1e-10;
const OPTIONS: Options = Options { limited: 0.2, balls: true };

/// A pose at a random distance from home.
fn pose(rng: &mut Rng, manipulator: &Manipulator) -> Vec<f64> {
    let reach = 2.0 * rng.f64() * rng.f64();
    let home = manipulator.home_pose();
    home.iter().map(|h| h + reach * (rng.f64() * 2.0 - 1.0)).collect()
}

#[test]
fn every_branch_closes_every_original_leg() {
    let mut rng = Rng::with_seed(1);
    for pair in PAIRS {
        let (mut poses, mut reached, mut solutions, mut worst) = (0, 0, 0, 0.0_f64);
        let mut patterns = BTreeSet::new();
        for _ in 0..150 {
            let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            let splits = mechanism.legs.iter().zip(&decomposition.legs);
            let found: Vec<_> = splits
                .map(|(leg, split)| {
                    (split.imaginary, order(leg, &split.lower), order(leg, &split.upper))
                })
                .collect();
            let manipulator = match Manipulator::with_decomposition(mechanism, decomposition) {
                Ok(manipulator) => manipulator,
                Err(error) => panic!("{pair:?}: {error}"),
            };
            let mut all = manipulator.all_modes();
            let mut solution = manipulator.solution();
            let mut same = manipulator.solution();
            let mut drives = manipulator.actuated_joints();
            for _ in 0..20 {
                let pose = pose(&mut rng, &manipulator);
                poses += 1;
                let any = manipulator.inverse_all(&pose, &mut all).unwrap().is_some();
                assert_eq!(any, all.modes(&manipulator).next().is_some());
                reached += usize::from(any);
                if any {
                    patterns.extend(found.iter().cloned());
                }
                let target = manipulator.task().displacement(&pose);
                for mode in all.modes(&manipulator) {
                    solutions += 1;
                    assert!(manipulator.solution_in_mode(&all, mode, &mut solution).is_some());
                    let mut joints = solution.joints();
                    for leg in &manipulator.mechanism().legs {
                        let (own, rest) = joints.split_at(leg.coordinates().count());
                        joints = rest;
                        let moved = leg.displacement(own).unwrap();
                        let size = own.iter().fold(10.0, |size: f64, q| size.max(q.abs()));
                        let off = (moved.to_homogeneous() - target.to_homogeneous()).norm() / size;
                        worst = worst.max(off);
                        assert!(off < CLOSURE, "{pair:?} {}: off by {off:e}", leg.name);
                    }
                    assert!(manipulator.inverse(&pose, mode, &mut same).unwrap().is_some());
                    assert_eq!(solution, same);
                    assert!(
                        manipulator.inverse_actuated(&pose, mode, &mut drives).unwrap().is_some()
                    );
                    for (&coordinate, drive) in manipulator.actuated().iter().zip(drives.actuated())
                    {
                        assert!((solution.joints()[coordinate] - drive).abs() < 1e-12);
                    }
                    assert_eq!(solution.imaginary(), drives.imaginary());
                    assert_eq!(solution.within_limits(), drives.within_limits());
                    let within =
                        manipulator.coordinates().iter().zip(solution.joints()).all(|(c, q)| {
                            c.limits
                                .is_none_or(|[low, high]| (low - 1e-9..=high + 1e-9).contains(q))
                        });
                    assert_eq!(solution.within_limits(), within, "{pair:?}");
                }
            }
        }
        println!("{pair:?}: {reached} of {poses} poses, {solutions} solutions, worst {worst:.1e}");
        assert!(reached > poses / 20, "{pair:?}: hardly any pose was in reach");
        // Every order of joints in either section, with the imaginary joint in the upper or in the
        // lower one.
        let cut = Some(meet(pair)).filter(|meet| *meet != Meet::Nothing);
        for above in [true, false].into_iter().filter(|above| cut.is_some() || !above) {
            let cuts = if above { [None, cut] } else { [cut, None] };
            for (section, (kind, cut)) in pair.into_iter().zip(cuts).enumerate() {
                for order in orders(kind, cut) {
                    let seen = patterns.iter().any(|(imaginary, lower, upper)| {
                        *imaginary == above && [lower, upper][section] == order
                    });
                    assert!(seen, "{pair:?}: no {order} in section {section}, cut above: {above}");
                }
            }
        }
    }
}

#[test]
fn home_is_where_the_joints_are() {
    let mut rng = Rng::with_seed(2);
    for pair in PAIRS {
        for _ in 0..100 {
            let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            let home = manipulator.home_pose();
            let reached = manipulator
                .inverse(&home, manipulator.home_mode(), &mut solution)
                .unwrap()
                .is_some();
            assert!(reached, "{pair:?}: {:?}", solution.unreachable());
            assert!(solution.within_limits());
            for (coordinate, q) in manipulator.coordinates().iter().zip(solution.joints()) {
                // A home near the boundary of a chain's reach loses half of the digits.
                let off = (coordinate.home - q).abs();
                assert!(off < 1e-6, "{pair:?} {}: off by {off:e}", coordinate.name);
            }
        }
    }
}

/// The joints of legs with a screw. They may be very large near a singularity, together with a
/// revolute joint on the screw's axis.
fn screws(manipulator: &Manipulator) -> Vec<&str> {
    let screw = |leg: &&Leg| leg.joints.iter().any(|j| matches!(j.kind, JointKind::Helical { .. }));
    let legs = manipulator.mechanism().legs.iter().filter(screw);
    legs.flat_map(|leg| leg.coordinates().map(|c| c.name.as_str())).collect()
}

/// Along a smooth path no angle jumps: every step is as short as the path's own speed allows.
#[test]
fn angles_stay_on_their_branch_along_a_path() {
    let mut rng = Rng::with_seed(3);
    let mut turned = 0;
    for pair in PAIRS {
        for _ in 0..50 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let screws = screws(&manipulator);
            let mode = manipulator.home_mode();
            let mut solution = manipulator.solution();
            let mut pose = manipulator.home_pose();
            let direction: Vec<f64> = pose.iter().map(|_| rng.f64() * 2.0 - 1.0).collect();
            assert!(manipulator.inverse(&pose, mode, &mut solution).unwrap().is_some());
            for _ in 0..4_000 {
                let before = solution.joints().to_vec();
                pose.iter_mut().zip(&direction).for_each(|(q, d)| *q += 0.002 * d);
                if manipulator.inverse_near(&pose, mode, &mut solution).unwrap().is_none() {
                    break;
                }
                let pairs = solution.joints().iter().zip(&before);
                for ((after, before), c) in pairs.zip(manipulator.coordinates()) {
                    let angle = c.quantity.unit() == "rad" && !screws.contains(&c.name.as_str());
                    assert!(
                        !angle || (after - before).abs() < std::f64::consts::PI + 1e-9,
                        "{pair:?} {} {before} {after}",
                        c.name
                    );
                }
                turned += usize::from(solution.joints().iter().zip(manipulator.coordinates()).any(
                    |(q, c)| {
                        (q - c.home).abs() > std::f64::consts::PI && c.quantity.unit() == "rad"
                    },
                ));
            }
        }
    }
    assert!(turned > 100, "no path went further than pi from home");
}

/// `inverse_all` and `inverse` agree on every mode, including the legs out of reach and their reach
/// deficits. A buffer that has seen no pose contains no mode.
#[test]
fn picked_modes_are_those_of_inverse() {
    let mut rng = Rng::with_seed(6);
    let (mut reached, mut missed) = (0, 0);
    for pair in PAIRS {
        for _ in 0..30 {
            let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut all = manipulator.all_modes();
            let (mut one, mut picked) = (manipulator.solution(), manipulator.solution());
            assert!(
                manipulator.solution_in_mode(&all, manipulator.home_mode(), &mut picked).is_none()
            );
            assert_eq!(all.modes(&manipulator).count(), 0);
            for _ in 0..10 {
                let pose = pose(&mut rng, &manipulator);
                manipulator.inverse_all(&pose, &mut all).unwrap();
                for signs in 0..1_u64 << manipulator.choices() {
                    let sign = |i| if signs >> i & 1 == 1 { '-' } else { '+' };
                    let text: String = (0..manipulator.choices()).map(sign).collect();
                    let mode = manipulator.parse_mode(&text).unwrap();
                    let inside = manipulator.inverse(&pose, mode, &mut one).unwrap().is_some();
                    assert_eq!(
                        manipulator.solution_in_mode(&all, mode, &mut picked).is_some(),
                        inside
                    );
                    assert_eq!(picked.unreachable(), one.unreachable(), "{pair:?} {text}");
                    if inside {
                        assert_eq!(picked, one);
                    }
                    reached += u32::from(inside);
                    missed += u32::from(!inside);
                }
            }
        }
    }
    assert!(reached > 5_000 && missed > 5_000, "{reached} in reach, {missed} out of it");
}

/// A new buffer holds home: along a path from home, no joint starts a revolution away from it.
#[test]
fn a_path_starts_at_home() {
    let mut rng = Rng::with_seed(7);
    for pair in PAIRS {
        for _ in 0..20 {
            let (mut mechanism, decomposition) =
                mechanism(&mut rng, pair, Options { limited: 0.0, balls: true });
            let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
            joints.flat_map(|joint| &mut joint.coordinates).for_each(|c| c.home += 20.0);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            let home = manipulator.home_pose();
            let mode = manipulator.home_mode();
            assert!(manipulator.inverse_near(&home, mode, &mut solution).unwrap().is_some());
            for (coordinate, q) in manipulator.coordinates().iter().zip(solution.joints()) {
                let off = (coordinate.home - q).abs();
                assert!(off < 1e-6, "{pair:?} {}: off by {off:e}", coordinate.name);
            }
        }
    }
}

/// The largest accepted poses still give numbers that close the legs, to rounding.
#[test]
fn enormous_poses_are_answered_or_refused() {
    let mut rng = Rng::with_seed(8);
    let mut answered = 0;
    for pair in PAIRS {
        for _ in 0..100 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut solution = manipulator.solution();
            for size in [1e20, 1e40, 1e74, 1e90, 1e160, f64::MAX] {
                let far = |c: &opm_core::task::TaskCoordinate| match c.quantity.unit() {
                    "m" => size * (rng.f64() - 0.5),
                    _ => rng.f64() - 0.5,
                };
                let pose: Vec<f64> = manipulator.task_coordinates().iter().map(far).collect();
                let mode = manipulator.home_mode();
                let Ok(Some(_)) = manipulator.inverse(&pose, mode, &mut solution) else { continue };
                answered += 1;
                let target = manipulator.task().displacement(&pose);
                let mut joints = solution.joints();
                for leg in &manipulator.mechanism().legs {
                    let (own, rest) = joints.split_at(leg.coordinates().count());
                    joints = rest;
                    // Only directions are compared: the legs' lengths are lost in the rounding of
                    // such large ones.
                    let turned = leg.displacement(own).unwrap().rotation.angle_to(&target.rotation);
                    let helical =
                        leg.joints.iter().any(|j| matches!(j.kind, JointKind::Helical { .. }));
                    assert!(helical || turned < 1e-6, "{pair:?} {}: {turned:e}", leg.name);
                }
            }
        }
    }
    assert!(answered > 1_000, "{answered}");
}

/// A joint that follows a path beyond its limits is reported outside them. It does not jump by a
/// revolution into them, and it comes back within them where it left them.
#[test]
fn a_path_beyond_limits_does_not_jump() {
    const STEP: f64 = 0.01;
    let mut rng = Rng::with_seed(9);
    let (mut inside, mut beyond) = (0, 0);
    for pair in PAIRS {
        for _ in 0..20 {
            let options = Options { limited: 0.0, balls: true };
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
            for c in joints.flat_map(|joint| &mut joint.coordinates) {
                // More than π to either side: both ends are, modulo 2π, inside the limits.
                c.limits = Some([c.home - 3.5, c.home + 3.5]);
            }
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mode = manipulator.home_mode();
            let mut solution = manipulator.solution();
            let mut pose = manipulator.home_pose();
            let direction: Vec<f64> = pose.iter().map(|_| rng.f64() * 2.0 - 1.0).collect();
            let screws = screws(&manipulator);
            for _ in 0..1_000 {
                let before = solution.joints().to_vec();
                pose.iter_mut().zip(&direction).for_each(|(q, d)| *q += STEP * d);
                if manipulator.inverse_near(&pose, mode, &mut solution).unwrap().is_none() {
                    break;
                }
                let mut within = true;
                for ((q, before), c) in
                    solution.joints().iter().zip(&before).zip(manipulator.coordinates())
                {
                    let [low, high] = c.limits.unwrap();
                    within &= (low - 1e-9..=high + 1e-9).contains(q);
                    let angle = c.quantity == Quantity::Angle && !screws.contains(&c.name.as_str());
                    let turn = angle && (q - before).abs() > 6.0;
                    assert!(!turn, "{pair:?} {} from {before} to {q}", c.name);
                }
                assert_eq!(solution.within_limits(), within, "{pair:?}");
                inside += u32::from(within);
                beyond += u32::from(!within);
            }
        }
    }
    assert!(inside > 10_000 && beyond > 10_000, "{inside} inside, {beyond} beyond");
}
