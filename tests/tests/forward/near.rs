//! Newton's method from a given pose: for mechanisms without closed-form forward kinematics, and
//! for all others.

use super::{Reached, apart, check, example};
use fastrand::Rng;
use opm_core::Quantity;
use opm_core::forward::{NearError, NearStop};
use opm_core::manipulator::Manipulator;

/// The percentage of regular poses for which the joint values lead back to the pose, in its own
/// mode, from a start nearby.
fn returns(rng: &mut Rng, m: &Manipulator, reach: [f64; 2], count: usize) -> usize {
    let (mut found, mut singular) = (0, 0);
    for _ in 0..count {
        let reached = Reached::random(rng, m, reach);
        if m.forward(&reached.actuated).is_ok_and(|found| !found.loose.is_empty()) {
            singular += 1;
            continue;
        }
        let start: Vec<f64> = (reached.pose.iter().zip(m.task_coordinates()))
            .map(|(q, c)| {
                let aside = if c.quantity == Quantity::Length { 0.003 } else { 0.03 };
                q + aside * (2.0 * rng.f64() - 1.0)
            })
            .collect();
        if Reached::at(m, start.clone(), reached.mode).is_none() {
            continue;
        }
        match m.forward_near(&reached.actuated, &start, reached.mode) {
            Ok(assembly) => {
                check(m, &reached.actuated, &assembly);
                assert_eq!(assembly.mode, reached.mode);
                found +=
                    usize::from(apart(m, assembly.mode, [&assembly.pose, &reached.pose]) < 1e-6);
            }
            Err(NearError::NotFound(not_found)) => {
                // Some modes are singular everywhere: two rods side by side act as one.
                singular +=
                    usize::from(not_found.why == NearStop::Singular && not_found.steps == 0);
                assert!(not_found.off.is_finite() && not_found.pose.len() == start.len());
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(10 * singular < 9 * count);
    100 * found / (count - singular)
}

#[test]
fn poses_are_found_from_nearby() {
    let mut rng = Rng::with_seed(21);
    for name in [
        "plano-spherical-5dof",
        "translational-helical-3dof",
        "planar-planar-5dof",
        "double-spherical-5dof",
        "plano-cylindrical-4dof",
        "schoenflies-4dof",
        "translational-planar-4dof",
    ] {
        let m = example(name);
        let found = returns(&mut rng, &m, [0.3, 0.05], 300);
        // The others are near a singularity, where another assembly may be as near.
        println!("{name}: {found} %");
        assert!(found > 80, "{name} {found}");
    }
}

/// From home, where the Euler angles of this mechanism are singular.
#[test]
fn home_is_a_start() {
    let m = example("plano-spherical-5dof");
    let home = m.home_pose();
    let pose = vec![0.01, -0.02, 0.2, 0.15, -0.1];
    let reached = Reached::at(&m, pose, m.home_mode()).unwrap();
    let assembly = m.forward_near(&reached.actuated, &home, m.home_mode()).unwrap();
    assert!(apart(&m, assembly.mode, [&assembly.pose, &reached.pose]) < 1e-10);
}

/// An angle is taken modulo 2π, a screw's is not.
#[test]
fn turns_of_the_arm_do_not_matter() {
    let m = example("plano-spherical-5dof");
    let reached = Reached::at(&m, vec![0.01, -0.02, 0.1, 0.15, -0.1], m.home_mode()).unwrap();
    let mut turned = reached.actuated.clone();
    turned[3] += std::f64::consts::TAU;
    turned[4] -= 2.0 * std::f64::consts::TAU;
    let assembly = m.forward_near(&turned, &m.home_pose(), m.home_mode()).unwrap();
    assert!(apart(&m, assembly.mode, [&assembly.pose, &reached.pose]) < 1e-10);
    let all = m.forward(&turned).unwrap();
    assert!(reached.is_in(&m, &all.list));
}

#[test]
fn a_failure_says_why() {
    let m = example("translational-planar-4dof");
    let home = m.home_pose();
    // The first slider is a metre from the others, which no rod spans.
    let error = m.forward_near(&[1.0, 0.0, 0.0, 0.0], &home, m.home_mode());
    let error = error.expect_err("an assembly");
    let NearError::NotFound(not_found) = error else { panic!("{error}") };
    assert!(
        matches!(not_found.why, NearStop::OutOfReach(_) | NearStop::Stalled | NearStop::Steps),
        "{not_found}"
    );
    assert!(not_found.off > 0.01 && not_found.off.is_finite(), "{not_found}");
    // A start that is out of reach.
    let mut far = home.clone();
    far[2] += 1.0;
    let error = m.forward_near(&[0.0; 4], &far, m.home_mode()).unwrap_err();
    assert!(
        matches!(&error, NearError::NotFound(n) if n.steps == 0 && matches!(n.why, NearStop::OutOfReach(_))),
        "{error}"
    );
    // Values with which nothing can be computed.
    let error = m.forward_near(&[f64::NAN, 0.0, 0.0, 0.0], &home, m.home_mode()).unwrap_err();
    assert!(matches!(error, NearError::Joints(_)), "{error}");
    let error = m.forward_near(&[0.0; 4], &home[1..], m.home_mode()).unwrap_err();
    assert!(matches!(error, NearError::Start(_)), "{error}");
}
