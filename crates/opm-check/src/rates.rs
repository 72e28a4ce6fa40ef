//! Rates and accelerations compared with differences of inverse kinematics.

use crate::certificate::{Comparison, Options, PoseInMode};
use crate::differences::derivatives as differences;
use crate::poses::pose;
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Mode, Solution};

/// Tolerance relative to the largest derivative of the same order at the pose.
const RATE: f64 = 1e-8;
const ACCELERATION: f64 = 1e-6;

/// The largest step, in shares of the rates.
const STEP: f64 = 1e-2;

/// Rates and accelerations of all joints in one random mode of each pose. Differences are relative to the tolerance of
/// their order.
pub fn derivatives(
    manipulator: &Manipulator,
    options: &Options,
    go_on: &mut impl FnMut() -> bool,
) -> Option<Comparison> {
    let mut found = Comparison::new(
        "derivatives",
        "rates and accelerations of all joints, with differences of inverse kinematics (accelerations over 100)",
        Some(RATE),
    );
    let mut rng = options.rng(2);
    let (mut all, mut at) = (manipulator.all_modes(), manipulator.solution());
    let mut motion = manipulator.joint_motion();
    let size = manipulator.characteristic_length();
    for _ in 0..options.samples {
        if !go_on() {
            return None;
        }
        let pose = pose(&mut rng, manipulator);
        let mut random = || -> Vec<f64> {
            let coordinates = manipulator.task_coordinates().iter();
            coordinates
                .map(|c| {
                    let scale = if c.quantity == Quantity::Length { size } else { 1.0 };
                    scale * (2.0 * rng.f64() - 1.0)
                })
                .collect()
        };
        let (rates, accelerations) = (random(), random());
        if let Err(error) = manipulator.inverse_all(&pose, &mut all) {
            found.fail(|| error.to_string());
            continue;
        }
        let modes: Vec<Mode> = all.modes(manipulator).collect();
        if modes.is_empty() {
            found.leave_out("out of reach, or near its boundary");
            continue;
        }
        let mode = modes[rng.usize(..modes.len())];
        if manipulator.solution_in_mode(&all, mode, &mut at).is_none() {
            continue;
        }
        let along = |t: f64| {
            let each = pose.iter().zip(&rates).zip(&accelerations);
            let there: Vec<f64> = each.map(|((q, r), a)| q + t * (r + 0.5 * t * a)).collect();
            through(manipulator, &there, mode, &at)
        };
        let Some(known) = differences(STEP, along) else {
            found.leave_out("out of reach, or near its boundary");
            continue;
        };
        match manipulator.velocity(&at, &rates, &accelerations, &mut motion) {
            Ok(true) => {}
            Ok(false) => {
                found.leave_out("out of reach, or near its boundary");
                continue;
            }
            Err(error) => {
                found.fail(|| error.to_string());
                continue;
            }
        }
        let first = [&motion.joint_rates[..], &motion.imaginary_rates].concat();
        let second = [&motion.joint_accelerations[..], &motion.imaginary_accelerations].concat();
        for (order, (numbers, tolerance)) in
            [(first, RATE), (second, ACCELERATION)].into_iter().enumerate()
        {
            let known = known.iter().map(|each| each[order]);
            let most = known.clone().fold(1.0_f64, |most, d| most.max(d.value.abs()));
            if known.clone().any(|d| d.error > 0.1 * tolerance * most) {
                found.leave_out("out of reach, or near its boundary");
                continue;
            }
            let off = numbers.iter().zip(known).map(|(number, d)| (number - d.value).abs());
            let off = off.fold(0.0, |most: f64, off| if off <= most { most } else { off }) / most;
            found.note(off * RATE / tolerance, || {
                PoseInMode { manipulator, pose: &pose, mode }.to_string()
            });
        }
    }
    Some(found)
}

/// The joints, then the imaginary joints, of a pose near a solution.
fn through(manipulator: &Manipulator, pose: &[f64], mode: Mode, at: &Solution) -> Option<Vec<f64>> {
    let mut moved = at.clone();
    let reached = manipulator.inverse_near(pose, mode, &mut moved).ok()?.is_some();
    reached.then(|| [moved.joints(), moved.imaginary()].concat())
}
