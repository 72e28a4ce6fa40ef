//! Random mechanisms of every pair of subspaces, with random actuated joints: in closed form if
//! there is one, otherwise with Newton's method.

use super::{Reached, apart, check, check_all, unlimited};
use fastrand::Rng;
use opm_core::decomposition::mobility::mobility;
use opm_core::forward::{NearError, NoClosedForm};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::joint::JointKind;
use opm_tests::random::{Meet, Options, PAIRS, RandomSubspace, mechanism};

/// A mechanism whose actuators control it, as many as it has freedoms: as many as possible in one
/// leg and the first joint of the others, or any joints.
fn driven(rng: &mut Rng, pair: [RandomSubspace; 2]) -> Manipulator {
    loop {
        let options = Options { limited: 0.0, balls: rng.bool() };
        let (mechanism, decomposition) = mechanism(rng, pair, options);
        let mut mechanism = unlimited(mechanism);
        let freedoms = decomposition.lambda;
        let mut choices: Vec<(usize, usize)> = Vec::new();
        for (leg, joints) in mechanism.legs.iter_mut().enumerate() {
            for (number, joint) in joints.joints.iter_mut().enumerate() {
                joint.actuated = false;
                if joint.freedoms() == 1 {
                    choices.push((leg, number));
                }
            }
        }
        if rng.bool() {
            rng.shuffle(&mut choices);
        } else {
            // The lower joints of the last leg, then the first joint of each leg, then the second
            // ones.
            let anchor = mechanism.legs.len() - 1;
            let lower = decomposition.legs[anchor].lower.len();
            choices.sort_by_key(|&(leg, number)| match leg == anchor && number < lower {
                true => 0,
                false => 1 + number,
            });
        }
        for &(leg, number) in choices.iter().take(freedoms) {
            mechanism.legs[leg].joints[number].actuated = true;
        }
        let report = mobility(&mechanism).unwrap();
        let controls = report.controlled == freedoms && report.loose.is_empty();
        if controls && report.actuators == freedoms && report.singular.is_empty() {
            return Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        }
    }
}

/// Whether a screw's revolutions are lost: revolutes of the other subspace pass them on to it.
fn loses_turns(m: &Manipulator, pair: [RandomSubspace; 2]) -> bool {
    pair.contains(&RandomSubspace::Cylindrical(Meet::Rotation))
        && m.mechanism().joints().any(|j| matches!(j.kind, JointKind::Helical { .. }))
}

#[test]
fn random_mechanisms_of_every_pair() {
    mechanisms_of_every_pair(31);
}

/// Among these, some have a level joint beside an inclined plane that does not fix an imaginary joint.
#[test]
fn other_mechanisms_of_every_pair() {
    mechanisms_of_every_pair(32);
}

fn mechanisms_of_every_pair(seed: u64) {
    let mut rng = Rng::with_seed(seed);
    for pair in PAIRS {
        let (mut closed, mut poses, mut assemblies, mut numeric) = (0, 0, 0, [0, 0]);
        let mut open = std::collections::BTreeMap::new();
        for _ in 0..60 {
            let m = driven(&mut rng, pair);
            match m.forward_closed_form() {
                Ok(()) => {
                    closed += 1;
                    for _ in 0..10 {
                        let reached = Reached::random(&mut rng, &m, [1.0, 0.5]);
                        let found = m.forward(&reached.actuated).unwrap();
                        check_all(&m, &reached.actuated, &found.list);
                        poses += 1;
                        assemblies += found.list.len();
                        if loses_turns(&m, pair) {
                            let none = found.list.is_empty() && found.loose.is_empty();
                            assert!(!none, "{pair:?} {:?} {:?}", reached.pose, found.unmet);
                            continue;
                        }
                        let pose = || format!("{:?} {}", reached.pose, m.format_mode(reached.mode));
                        assert!(
                            reached.is_in(&m, &found.list),
                            "{pair:?} {}: {:?} {:?}",
                            pose(),
                            found.unmet,
                            found.loose
                        );
                    }
                }
                Err(why) => {
                    *open.entry(format!("{why:?}")).or_insert(0) += 1;
                    assert_ne!(why, NoClosedForm::Ball, "no ball is actuated here");
                }
            }
            // Newton's method does not need an order of sections.
            let reached = Reached::random(&mut rng, &m, [0.3, 0.2]);
            let start: Vec<f64> =
                reached.pose.iter().map(|q| q + 0.01 * (2.0 * rng.f64() - 1.0)).collect();
            if Reached::at(&m, start.clone(), reached.mode).is_some() {
                numeric[1] += 1;
                match m.forward_near(&reached.actuated, &start, reached.mode) {
                    Ok(assembly) => {
                        check(&m, &reached.actuated, &assembly);
                        numeric[0] += usize::from(
                            apart(&m, reached.mode, [&assembly.pose, &reached.pose]) < 1e-6,
                        );
                    }
                    Err(NearError::NotFound(not_found)) => assert!(not_found.off.is_finite()),
                    Err(other) => panic!("{other}"),
                }
            }
        }
        println!(
            "{pair:?}: {closed} of 60 in closed form ({open:?}), {poses} poses, {assemblies} assemblies; \
             Newton {} of {}",
            numeric[0], numeric[1]
        );
        assert!(closed > 3, "{pair:?} {closed}");
        assert!(10 * numeric[0] > 8 * numeric[1], "{pair:?} {numeric:?}");
    }
}
