//! Certificates of shipped mechanisms, and of mechanisms that are not what their closed forms were made for.

use fastrand::Rng;
use nalgebra::{Rotation3, Unit, Vector3};
use opm_check::{Certificate, Options, check};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{examples, file};

fn certificate(manipulator: &Manipulator, samples: u32, seed: u64) -> Certificate {
    check(manipulator, &Options { samples, seed }, |_| true).unwrap()
}

#[test]
fn shipped_mechanisms_hold() {
    let mut compared = [0; 5];
    for example in examples::EXAMPLES {
        let mechanism = file::read(example.text).unwrap().mechanism;
        let Ok(manipulator) = Manipulator::new(mechanism) else { continue };
        let found = certificate(&manipulator, 30, 3);
        for (sum, one) in compared.iter_mut().zip(&found.comparisons) {
            assert!(one.holds(), "{}: {one:?}", example.name);
            *sum += one.compared;
            println!(
                "{} {}: {} / {} {:?}",
                example.name, one.name, one.compared, one.left_out, one.worst
            );
        }
        assert!(found.comparisons[0].compared > 0 && found.comparisons[3].compared > 0);
    }
    assert!(compared.iter().all(|&count| count > 300), "{compared:?}");
}

/// One pose has two sets of angles here, each in modes of its own.
#[test]
fn places_are_compared_and_not_coordinates() {
    let charts = [
        include_str!("../../../data/reference/forward/sph4-1.toml"),
        include_str!("../../../data/reference/forward/sph4-x.toml"),
        include_str!("../../../data/reference/forward/sph4-y.toml"),
        include_str!("../../../data/reference/forward/spherical-5R-symmetric-orthogonal.toml"),
        include_str!("../../../data/reference/forward/2UPR-RPU.toml"),
    ];
    for text in charts {
        let manipulator = Manipulator::new(file::read(text).unwrap().mechanism).unwrap();
        for seed in 1..4 {
            let found = certificate(&manipulator, 60, seed);
            let forward = &found.comparisons[4];
            assert!(found.holds(), "{}: {found:?}", found.name);
            assert!(forward.compared > 20, "{}: {forward:?}", found.name);
        }
    }
}

/// Axes and points in single precision, and with six digits: legs miss by that, and what is compared holds within it.
#[test]
fn rounded_joints_hold_within_their_misfit() {
    let single = |c: f64| f64::from(c as f32);
    let six_digits = |c: f64| format!("{c:.5e}").parse().unwrap();
    let (mut mechanisms, mut branches) = (0, 0);
    for example in examples::SPLIT {
        let exact = file::read(example.text).unwrap().mechanism;
        if Manipulator::new(exact.clone()).is_err() {
            continue;
        }
        for round in [single as fn(f64) -> f64, six_digits] {
            let mut mechanism = exact.clone();
            for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
                joint.axis = Unit::new_normalize(joint.axis.map(|c| round(0.7 * c)));
                joint.point = joint.point.map(round);
            }
            let manipulator = Manipulator::new(mechanism).unwrap();
            let found = certificate(&manipulator, 20, 2);
            assert_eq!(found.misfit, manipulator.decomposition().deviation);
            assert!(found.holds(), "{}, misfit {:e}: {found:?}", found.name, found.misfit);
            mechanisms += usize::from(found.misfit > 1e-10);
            branches += found.comparisons[1].compared;
        }
    }
    println!("{mechanisms} mechanisms, {branches} legs");
    // In a plane whose axes stand along a base axis, rounded joints still fit.
    assert!(mechanisms >= 4 && branches > 500, "{mechanisms} {branches}");
}

/// One axis is tilted after the decomposition was found: every comparison with what does not use it fails.
#[test]
fn a_joint_that_is_off_is_found() {
    let manipulator = Manipulator::example("plano-spherical-5dof").unwrap();
    for off in [1e-3, 1e-6] {
        let mut mechanism = manipulator.mechanism().clone();
        let joint = &mut mechanism.legs[0].joints[1];
        let tilt = Rotation3::from_axis_angle(&Vector3::x_axis(), off);
        joint.axis = Unit::new_normalize(tilt * joint.axis.into_inner());
        let decomposition = manipulator.decomposition().clone();
        let tilted = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let found = certificate(&tilted, 10, 1);
        assert!(!found.holds());
        let closure = &found.comparisons[0];
        let problem = closure.problem.as_deref().unwrap();
        assert!(problem.starts_with("off by ") && problem.contains("mode \""), "{problem}");
        let worst = closure.worst.unwrap();
        assert!(worst > 0.1 * off && worst < 10.0 * off, "{worst}");
    }
}

#[test]
fn the_seed_decides_the_certificate_and_it_can_be_cancelled() {
    let manipulator = Manipulator::example("planar-3rrr").unwrap();
    assert_eq!(certificate(&manipulator, 10, 5), certificate(&manipulator, 10, 5));
    assert_ne!(certificate(&manipulator, 10, 5), certificate(&manipulator, 10, 6));
    let options = Options { samples: 10, seed: 1 };
    let mut steps = 0;
    assert!(
        check(&manipulator, &options, |done| {
            steps = done;
            true
        })
        .is_some()
    );
    assert_eq!(steps, options.steps());
    let stop = Rng::with_seed(1).u64(1..steps);
    assert!(check(&manipulator, &options, |done| done < stop).is_none());
}
