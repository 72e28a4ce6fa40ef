//! Closures and branches at random poses.

use crate::branches::{Alone, Branches};
use crate::certificate::{Comparison, Options, PoseInMode};
use crate::closure::gap;
use fastrand::Rng;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;

/// The largest closure error where joints are exactly in their subspaces: radians, and lengths over the size. The
/// errors of random mechanisms are below 1e-13 nearly everywhere, and lose digits near singularities.
const CLOSED: f64 = 1e-10;

/// Legs whose joints miss their subspaces close to some multiple of that: what six joints add up to, with a margin.
pub(crate) const DEVIATIONS: f64 = 20.0;

/// The share of the mechanism's size, and the angle in radians, that poses are from home at most.
const FARTHEST: [f64; 2] = [0.8, 1.2];

/// A random pose; half of them are rather near home, where most are in reach.
pub(crate) fn pose(rng: &mut Rng, manipulator: &Manipulator) -> Vec<f64> {
    let share = rng.f64() * rng.f64();
    let size = manipulator.characteristic_length();
    let coordinates = manipulator.task_coordinates().iter();
    coordinates
        .map(|c| {
            let most = match c.quantity {
                Quantity::Length => FARTHEST[0] * size,
                Quantity::Angle => FARTHEST[1],
            };
            c.home + most * share * (2.0 * rng.f64() - 1.0)
        })
        .collect()
}

/// What a mechanism's own deviation adds to a tolerance.
pub(crate) fn tolerance(manipulator: &Manipulator, rounding: f64) -> f64 {
    rounding.max(DEVIATIONS * manipulator.decomposition().deviation)
}

/// Closure of the undecomposed legs in every mode.
pub fn closures(
    manipulator: &Manipulator,
    options: &Options,
    go_on: &mut impl FnMut() -> bool,
) -> Option<Comparison> {
    let mut found = Comparison::new(
        "closure",
        "joint values of inverse kinematics in every mode, with the ends of the undecomposed legs",
        Some(tolerance(manipulator, CLOSED)),
    );
    let mut rng = options.rng(0);
    let (mut all, mut solution) = (manipulator.all_modes(), manipulator.solution());
    for sample in 0..options.samples {
        if !go_on() {
            return None;
        }
        // The first one is home.
        let pose = if sample == 0 { manipulator.home_pose() } else { pose(&mut rng, manipulator) };
        if let Err(error) = manipulator.inverse_all(&pose, &mut all) {
            found.fail(|| error.to_string());
            continue;
        }
        let modes: Vec<_> = all.modes(manipulator).collect();
        if modes.is_empty() {
            found.leave_out("out of reach");
        }
        for mode in modes {
            let place = || PoseInMode { manipulator, pose: &pose, mode }.to_string();
            let Some(solution) = manipulator.solution_in_mode(&all, mode, &mut solution) else {
                found.fail(|| format!("no solution in a mode that reaches the pose: {}", place()));
                continue;
            };
            let target = solution.displacement(manipulator);
            found.note(gap(manipulator, solution.joints(), &target), place);
        }
    }
    Some(found)
}

/// The coordinates of a pose for a leg alone, which has no dependent ones; `None` where the pose is out of reach, or where
/// the leg has coordinates of its own.
fn pose_of_leg(alone: &Manipulator, manipulator: &Manipulator, pose: &[f64]) -> Option<Vec<f64>> {
    let free = |m: &Manipulator| m.dependent_coordinates().is_empty();
    if manipulator.is_whole() && !free(manipulator) {
        // A leg that is solved whole has all coordinates.
        let displacement = manipulator.displacement(pose).ok()?;
        return alone.locate(&displacement).ok();
    }
    let same = alone.task_coordinates().len() == manipulator.task_coordinates().len();
    (free(alone) && free(manipulator) && same).then(|| pose.to_vec())
}

/// The branches of every leg, counted by a numeric solver.
pub fn branches(
    manipulator: &Manipulator,
    options: &Options,
    go_on: &mut impl FnMut() -> bool,
) -> Option<Comparison> {
    let what = "the solutions of every leg, with those that a numeric solver finds";
    let mut found = Comparison::new("branches", what, None);
    let mut rng = options.rng(1);
    let (mechanism, decomposition) = (manipulator.mechanism(), manipulator.decomposition());
    let size = manipulator.characteristic_length();
    let legs: Vec<_> = (0..manipulator.legs())
        .map(|number| (number, Alone::new(mechanism, decomposition, number, size)))
        .collect();
    for _ in 0..options.samples {
        if !go_on() {
            return None;
        }
        let pose = pose(&mut rng, manipulator);
        for (number, alone) in &legs {
            let name = &mechanism.legs[*number].name;
            let of_leg = alone.as_ref().ok().and_then(|alone| {
                Some((alone, pose_of_leg(alone.manipulator(), manipulator, &pose)?))
            });
            let Some((alone, own)) = of_leg else {
                found.leave_out("a leg that constrains the platform");
                continue;
            };
            match alone.compare(&own, &mut rng) {
                Ok(Branches::Same(_)) => found.compared += 1,
                Ok(Branches::Fold) => found.leave_out("two solutions nearly meet"),
                Ok(Branches::Different { branches, distinct, solutions, either }) => {
                    found.compared += 1;
                    let mode = manipulator.home_mode();
                    found.fail(|| {
                        let place = PoseInMode { manipulator, pose: &pose, mode };
                        format!(
                            "{name} has {branches} branches, {distinct} of them different, and a numeric solver \
                             finds {solutions}, together {either}: {place}"
                        )
                    });
                }
                Err(error) => found.fail(|| format!("{name}: {error}")),
            }
        }
    }
    Some(found)
}
