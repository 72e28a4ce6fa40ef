//! Closed forms of platforms that only translate: as many assemblies as three spheres or planes have points in common.

use fastrand::Rng;
use opm_core::Manipulator;
use opm_core::forward::{Completeness, ForwardMethod};

/// Inverse kinematics lead back, on random poses; the proofs, which know nothing of spheres, hold for every assembly.
#[test]
fn spheres_and_planes_have_closed_forms() {
    let mut rng = Rng::with_seed(78);
    for (name, count) in
        [("delta", 2), ("linear-delta", 2), ("orthoglide", 2), ("3-upu", 2), ("tripteron", 1)]
    {
        let m = Manipulator::example(name).unwrap();
        assert_eq!(m.forward_method(), Ok(ForwardMethod::ClosedForm), "{name}");
        let size = m.characteristic_length();
        let mut solution = m.solution();
        for _ in 0..20 {
            let shift =
                |c: &opm_core::task::TaskCoordinate| c.home + 0.1 * size * (2.0 * rng.f64() - 1.0);
            let pose: Vec<f64> = m.task_coordinates().iter().map(shift).collect();
            let Some(found) = m.inverse(&pose, m.home_mode(), &mut solution).unwrap() else {
                continue;
            };
            let actuated: Vec<f64> = m.actuated().iter().map(|&c| found.joints()[c]).collect();
            let found = m.forward(&actuated).unwrap();
            assert_eq!(found.completeness, Completeness::ClosedForm);
            assert_eq!(found.list.len(), count, "{name}");
            let same = |pose: &[f64], other: &[f64]| {
                pose.iter().zip(other).all(|(a, b)| (a - b).abs() < 1e-9 * size.max(1.0))
            };
            assert!(found.list.iter().any(|one| same(&one.pose, &pose)), "{name}");
            for certificate in m.certify(&found.list) {
                let proof = certificate.proof().expect("away from singularities");
                assert!(proof.distinct && proof.radius < 1e-8, "{name} {proof:?}");
            }
        }
    }
}

/// A platform that turns is solved by continuation.
#[test]
fn a_platform_that_turns_has_another_method() {
    for name in ["stewart", "quadrupteron", "tricept"] {
        let m = Manipulator::example(name).unwrap();
        assert_eq!(m.forward_method(), Ok(ForwardMethod::Continuation), "{name}");
    }
}

/// Rods that are too far apart have no point in common.
#[test]
fn spheres_that_do_not_meet_have_none() {
    let m = Manipulator::example("linear-delta").unwrap();
    let found = m.forward(&[2.0, -2.0, 2.0]).unwrap();
    assert!(found.list.is_empty() && !found.unmet.is_empty());
    assert_eq!(found.completeness, Completeness::ClosedForm);
}
