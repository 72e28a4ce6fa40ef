//! Inverse kinematics on random mechanisms of every pair of subspaces, held against the legs as they
//! are: each leg's product of exponentials must bring the platform to the pose.

use fastrand::Rng;
use opm_core::joint::JointKind;
use opm_core::manipulator::Manipulator;
use opm_tests::random::{Options, PAIRS, mechanism};

/// The bound on closure, as a share of the size of the mechanism and its joint values.
const CLOSURE: f64 = 1e-10;
const OPTIONS: Options = Options { limited: 0.2, balls: true };

/// A pose at random distance from home.
fn pose(rng: &mut Rng, manipulator: &Manipulator) -> Vec<f64> {
    let reach = 2.0 * rng.f64() * rng.f64();
    let home = manipulator.task().home();
    home.iter().map(|h| h + reach * (rng.f64() * 2.0 - 1.0)).collect()
}

#[test]
fn every_branch_closes_every_original_leg() {
    let mut rng = Rng::with_seed(1);
    for pair in PAIRS {
        let (mut poses, mut reached, mut solutions, mut worst) = (0, 0, 0, 0.0_f64);
        for _ in 0..150 {
            let (mechanism, decomposition) = mechanism(&mut rng, pair, OPTIONS);
            let manipulator = match Manipulator::with_decomposition(mechanism, decomposition) {
                Ok(manipulator) => manipulator,
                Err(error) => panic!("{pair:?}: {error}"),
            };
            let mut all = manipulator.all_modes();
            let mut solution = manipulator.solution();
            let mut same = manipulator.solution();
            let mut drives = manipulator.drives();
            for _ in 0..20 {
                let pose = pose(&mut rng, &manipulator);
                poses += 1;
                let any = manipulator.inverse_all(&pose, &mut all).unwrap();
                assert_eq!(any, all.modes(&manipulator).next().is_some());
                reached += usize::from(any);
                let target = manipulator.task().displacement(&pose);
                for mode in all.modes(&manipulator) {
                    solutions += 1;
                    assert!(manipulator.pick(&all, mode, &mut solution));
                    let mut joints = &solution.joints[..];
                    for leg in &manipulator.mechanism().legs {
                        let (own, rest) = joints.split_at(leg.coordinates().count());
                        joints = rest;
                        let moved = leg.displacement(own);
                        let size = own.iter().fold(10.0, |size: f64, q| size.max(q.abs()));
                        let off = (moved.to_homogeneous() - target.to_homogeneous()).norm() / size;
                        worst = worst.max(off);
                        assert!(off < CLOSURE, "{pair:?} {}: off by {off:e}", leg.name);
                    }
                    assert!(manipulator.inverse(&pose, mode, &mut same).unwrap());
                    assert_eq!(solution, same);
                    assert!(manipulator.inverse_drives(&pose, mode, &mut drives).unwrap());
                    for (&coordinate, drive) in manipulator.actuated().iter().zip(&drives.actuated)
                    {
                        assert!((solution.joints[coordinate] - drive).abs() < 1e-12);
                    }
                    assert_eq!(solution.imaginary, drives.imaginary);
                    assert_eq!(solution.within_limits, drives.within_limits);
                    let within =
                        manipulator.coordinates().iter().zip(&solution.joints).all(|(c, q)| {
                            c.limits
                                .is_none_or(|[low, high]| (low - 1e-9..=high + 1e-9).contains(q))
                        });
                    assert_eq!(solution.within_limits, within, "{pair:?}");
                }
            }
        }
        println!("{pair:?}: {reached} of {poses} poses, {solutions} solutions, worst {worst:.1e}");
        assert!(reached > poses / 20, "{pair:?}: hardly any pose was in reach");
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
            let home = manipulator.task().home();
            let reached =
                manipulator.inverse(&home, manipulator.home_mode(), &mut solution).unwrap();
            assert!(reached, "{pair:?}: {:?}", solution.unreachable);
            assert!(solution.within_limits);
            for (coordinate, q) in manipulator.coordinates().iter().zip(&solution.joints) {
                // A home near the rim of a chain's reach loses half of the digits.
                let off = (coordinate.home - q).abs();
                assert!(off < 1e-6, "{pair:?} {}: off by {off:e}", coordinate.name);
            }
        }
    }
}

/// Along a smooth path no angle jumps: every step is as short as the path's own speed makes it.
#[test]
fn angles_stay_on_their_branch_along_a_path() {
    let mut rng = Rng::with_seed(3);
    let mut turned = 0;
    for pair in PAIRS {
        for _ in 0..50 {
            let options = Options { limited: 0.0, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            // A screw may run away near a singularity, and a revolute on its axis with it.
            let screws: Vec<_> = (manipulator.mechanism().legs.iter())
                .filter(|leg| {
                    leg.joints.iter().any(|j| matches!(j.kind, JointKind::Helical { .. }))
                })
                .flat_map(|leg| leg.coordinates().map(|c| c.name.as_str()))
                .collect();
            let mode = manipulator.home_mode();
            let mut solution = manipulator.solution();
            let mut pose = manipulator.task().home();
            let direction: Vec<f64> = pose.iter().map(|_| rng.f64() * 2.0 - 1.0).collect();
            assert!(manipulator.inverse(&pose, mode, &mut solution).unwrap());
            for _ in 0..4_000 {
                let before = solution.joints.clone();
                pose.iter_mut().zip(&direction).for_each(|(q, d)| *q += 0.002 * d);
                if !manipulator.inverse_near(&pose, mode, &mut solution).unwrap() {
                    break;
                }
                let pairs = solution.joints.iter().zip(&before);
                for ((after, before), c) in pairs.zip(manipulator.coordinates()) {
                    let angle = c.quantity.unit() == "rad" && !screws.contains(&c.name.as_str());
                    assert!(
                        !angle || (after - before).abs() < std::f64::consts::PI + 1e-9,
                        "{pair:?} {} {before} {after}",
                        c.name
                    );
                }
                turned += usize::from(solution.joints.iter().zip(manipulator.coordinates()).any(
                    |(q, c)| {
                        (q - c.home).abs() > std::f64::consts::PI && c.quantity.unit() == "rad"
                    },
                ));
            }
        }
    }
    assert!(turned > 100, "no path went further than half a turn from home");
}
