//! Inverse kinematics, velocities, forward kinematics near a pose and the positions of a linkage do
//! not allocate: all of them may run in a control loop.

use allocation_counter::measure;
use fastrand::Rng;
use opm_core::linkage::{Linkage, LinkageBranch, SectionSigns};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{examples, file};
use opm_tests::random::{Options, PAIRS, RandomSubspace, constrained, mechanism};

/// A mechanism of a pair: one without constraining legs, and one with each kind of them.
fn manipulators(rng: &mut Rng, pair: [RandomSubspace; 2], options: Options) -> Vec<Manipulator> {
    let free = std::iter::once(mechanism(rng, pair, options)).collect::<Vec<_>>();
    let lacks = [[1, 0], [0, 1], [2, 0], [0, 2], [1, 1]];
    let tied = lacks.into_iter().filter_map(|lacks| constrained(rng, pair, lacks, false, options));
    let all = free.into_iter().chain(tied.collect::<Vec<_>>());
    all.map(|(mechanism, d)| Manipulator::with_decomposition(mechanism, d).unwrap()).collect()
}

#[test]
fn inverse_kinematics_does_not_allocate() {
    let mut rng = Rng::with_seed(30);
    let seen = measure(|| drop(std::hint::black_box(vec![0_u8; 16])));
    assert_eq!(seen.count_total, 1, "the counter counts");
    let mut reached = 0;
    for pair in PAIRS {
        for limited in [0.0, 0.5] {
            let options = Options { limited, balls: true };
            for manipulator in manipulators(&mut rng, pair, options) {
                let mut solution = manipulator.solution();
                let mut drives = manipulator.actuated_joints();
                let mut all = manipulator.all_modes();
                let mode = manipulator.home_mode();
                for _ in 0..50 {
                    let mut pose = manipulator.home_pose();
                    pose.iter_mut().for_each(|q| *q += 0.5 * (rng.f64() - 0.5));
                    let info = measure(|| {
                        reached += u32::from(
                            manipulator.inverse(&pose, mode, &mut solution).unwrap().is_some(),
                        );
                        manipulator.inverse_near(&pose, mode, &mut solution).unwrap();
                        manipulator.inverse_actuated(&pose, mode, &mut drives).unwrap();
                        manipulator.inverse_all(&pose, &mut all).unwrap();
                        for mode in all.modes(&manipulator) {
                            manipulator.solution_in_mode(&all, mode, &mut solution);
                        }
                    });
                    assert_eq!(info.count_total, 0, "{pair:?}");
                }
            }
        }
    }
    assert!(reached > 500, "{reached} poses in reach");
}

#[test]
fn velocities_do_not_allocate() {
    let mut rng = Rng::with_seed(31);
    let mut moved = 0;
    for pair in PAIRS {
        for balls in [false, true] {
            let options = Options { limited: 0.0, balls };
            for manipulator in manipulators(&mut rng, pair, options) {
                let mode = manipulator.home_mode();
                let (mut solution, mut motion) =
                    (manipulator.solution(), manipulator.joint_motion());
                let (mut jacobians, length) =
                    (manipulator.jacobians(), manipulator.characteristic_length());
                let mut singularities = manipulator.singularities();
                let rates: Vec<f64> = manipulator.home_pose().iter().map(|_| rng.f64()).collect();
                for _ in 0..50 {
                    let mut pose = manipulator.home_pose();
                    pose.iter_mut().for_each(|q| *q += 0.5 * (rng.f64() - 0.5));
                    let info = measure(|| {
                        if manipulator.inverse(&pose, mode, &mut solution).unwrap().is_some() {
                            manipulator.velocity(&solution, &rates, &rates, &mut motion).unwrap();
                            manipulator.differentiate(&solution, &mut jacobians).unwrap();
                            manipulator.conditioning(&jacobians, length);
                            manipulator.measure_singularities(&jacobians, &mut singularities);
                            moved += 1;
                        }
                    });
                    assert_eq!(info.count_total, 0, "{pair:?}");
                }
            }
        }
    }
    assert!(moved > 500, "{moved} poses in reach");
}

/// The platform moves in small steps, and is found again near where it was from the actuated joints.
#[test]
fn forward_kinematics_near_a_pose_do_not_allocate() {
    let mut rng = Rng::with_seed(32);
    let mut found = 0;
    for pair in PAIRS {
        for balls in [false, true] {
            let options = Options { limited: 0.0, balls };
            for manipulator in manipulators(&mut rng, pair, options) {
                let mode = manipulator.home_mode();
                let (mut solution, mut buffer) =
                    (manipulator.solution(), manipulator.near_buffer());
                let mut actuated = vec![0.0; manipulator.actuated().len()];
                let mut pose = manipulator.home_pose();
                let mut last = pose.clone();
                for _ in 0..20 {
                    pose.iter_mut().for_each(|q| *q += 0.01 * (rng.f64() - 0.5));
                    let Some(at) = manipulator.inverse(&pose, mode, &mut solution).unwrap() else {
                        break;
                    };
                    let joints = manipulator.actuated().iter().map(|&i| at.joints()[i]);
                    actuated.iter_mut().zip(joints).for_each(|(value, joint)| *value = joint);
                    let mut closes = false;
                    let info = measure(|| {
                        let near =
                            manipulator.forward_near_into(&actuated, &last, mode, &mut buffer);
                        if let Ok(assembly) = near {
                            closes = true;
                            last.copy_from_slice(&assembly.pose);
                        }
                    });
                    if !closes {
                        // A singular pose: the error holds the last one.
                        break;
                    }
                    assert_eq!(info.count_total, 0, "{pair:?}");
                    found += 1;
                }
            }
        }
    }
    assert!(found > 1_000, "{found} assemblies");
}

#[test]
fn positions_of_a_linkage_do_not_allocate() {
    let text = examples::find("bennett-double-spherical-6r").unwrap().text;
    let linkage = Linkage::new(&file::read(text).unwrap().mechanism).unwrap();
    let mut reached = 0;
    for name in ["a1", "b2"] {
        let input = linkage.input(name).unwrap();
        let mut position = input.home();
        for i in 0..100 {
            let value = 0.1 * f64::from(i);
            let info = measure(|| {
                for branch in SectionSigns::ALL.map(LinkageBranch::Signs) {
                    reached += u32::from(input.position(value, branch, &mut position));
                    reached += u32::from(input.position_near(value, branch, &mut position));
                }
            });
            assert_eq!(info.count_total, 0, "{name} {value}");
        }
    }
    assert!(reached >= 800, "{reached} positions");
}
