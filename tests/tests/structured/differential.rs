//! Rates and accelerations at structured poses, against differences of inverse kinematics.

use fastrand::Rng;
use opm_core::manipulator::{Manipulator, Mode};
use opm_tests::differences::derivatives;
use opm_tests::structured::{manipulators, pose, quarter_turns};

/// Relative to the largest of the order.
const OFF: [f64; 2] = [1e-7, 1e-5];

/// Compares the two where differences are sure of themselves, and counts these.
fn compare(m: &Manipulator, pose: &[f64], mode: Mode, rates: &[f64]) -> usize {
    let mut at = m.solution();
    if m.inverse(pose, mode, &mut at).unwrap().is_none() {
        return 0;
    }
    let through = |t: f64| {
        let mut moved = at.clone();
        let there: Vec<f64> = pose.iter().zip(rates).map(|(q, r)| q + t * r).collect();
        let reached = m.inverse_near(&there, mode, &mut moved).unwrap().is_some();
        reached.then(|| [moved.joints(), moved.imaginary()].concat())
    };
    let Some(differences) = derivatives(1e-2, through) else { return 0 };
    let mut motion = m.joint_motion();
    // At a singularity there is nothing to compare, and it says so.
    if !m.velocity(&at, rates, &vec![0.0; rates.len()], &mut motion).unwrap() {
        return 0;
    }
    let found = [
        [&motion.joint_rates[..], &motion.imaginary_rates].concat(),
        [&motion.joint_accelerations[..], &motion.imaginary_accelerations].concat(),
    ];
    let mut compared = 0;
    for (order, found) in found.iter().enumerate() {
        let size = differences.iter().fold(1.0_f64, |size, d| size.max(d[order].value.abs()));
        if differences.iter().any(|d| d[order].error > 0.1 * OFF[order] * size) {
            continue;
        }
        compared += 1;
        for ((found, known), c) in found.iter().zip(&differences).zip(m.coordinates()) {
            let off = (found - known[order].value).abs() / size;
            let name = &m.mechanism().name;
            assert!(off < OFF[order], "{name} {} {pose:?} {order}: {found} {known:?}", c.name);
        }
    }
    compared
}

#[test]
fn rates_and_accelerations_are_derivatives() {
    let mut rng = Rng::with_seed(30);
    for m in manipulators() {
        let modes: Vec<Mode> = m.modes().collect();
        let coordinates = m.task_coordinates().len();
        let mut compared = 0;
        for round in 0..250 {
            let pose =
                if round % 3 == 0 { quarter_turns(&mut rng, &m) } else { pose(&mut rng, &m) };
            let mode = if rng.bool() { m.home_mode() } else { modes[rng.usize(..modes.len())] };
            // One coordinate alone, or all alike.
            let alone = rng.usize(..=coordinates);
            let rate = |i: usize| if alone == coordinates || alone == i { 1.0 } else { 0.0 };
            let rates: Vec<f64> = (0..coordinates).map(rate).collect();
            compared += compare(&m, &pose, mode, &rates);
        }
        println!("{}: {compared}", m.mechanism().name);
        assert!(compared > 20, "{}: {compared}", m.mechanism().name);
    }
}
