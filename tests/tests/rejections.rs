//! What rejects poses, compared with inverse kinematics pose by pose.

use opm_core::manipulator::{Mode, Section, Solution};
use opm_core::{Manipulator, Quantity};
use opm_workspace::{Axis, Cause, Grid, Modes, Progress, Rejections, Sweep};
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

/// Farther past a limit than rounding.
const PAST: f64 = 1e-9;

/// The causes of a pose, from the values of the joints and the limits of the file.
fn causes(
    manipulator: &Manipulator,
    pose: &[f64],
    mode: Mode,
    solution: &mut Solution,
) -> Vec<(usize, String)> {
    let found = manipulator.inverse(pose, mode, solution).unwrap();
    let missed: Vec<usize> = match found {
        Some(_) => vec![],
        None => solution.unreachable().iter().map(|missed| missed.leg).collect(),
    };
    let mut causes: Vec<(usize, String)> = solution
        .unreachable()
        .iter()
        .map(|u| (u.leg, format!("{} {:?}", u.leg, u.section)))
        .collect();
    let legs = &manipulator.mechanism().legs;
    let of_legs = legs.iter().enumerate().flat_map(|(number, leg)| {
        leg.joints.iter().flat_map(move |joint| joint.coordinates.iter().map(move |c| (number, c)))
    });
    for ((leg, coordinate), &value) in of_legs.zip(solution.joints()) {
        let Some([low, high]) = coordinate.limits.filter(|_| !missed.contains(&leg)) else {
            continue;
        };
        let turns = match coordinate.quantity {
            Quantity::Angle => vec![-TAU, 0.0, TAU],
            Quantity::Length => vec![0.0],
        };
        let past = |at: f64| (low - at).max(at - high);
        let least = turns.iter().map(|turn| past(value + turn)).fold(f64::INFINITY, f64::min);
        if least > PAST {
            // Past the end that the reported value is past.
            let end = if low - value > value - high { "lowest" } else { "highest" };
            causes.push((leg, format!("{} {end}", coordinate.name)));
        }
    }
    causes
}

fn name(manipulator: &Manipulator, leg: usize, cause: Cause) -> String {
    let joint = |joint: usize| &manipulator.coordinates()[joint].name;
    match cause {
        Cause::Reach(section) => format!("{leg} {section:?}"),
        Cause::Lowest(number) => format!("{} lowest", joint(number)),
        Cause::Highest(number) => format!("{} highest", joint(number)),
        Cause::Cone(number) => format!("{} cone", joint(number)),
        Cause::Difference(number) => manipulator.differences()[number].name.clone(),
    }
}

/// Poses around home, at odd shares of lengths and turns, so that none is exactly on a limit.
fn grid(manipulator: &Manipulator) -> Grid {
    let axes = manipulator.task_coordinates().iter().enumerate().map(|(i, c)| {
        let (half, count) = match c.quantity {
            Quantity::Length => (0.3137, if i < 2 { 13 } else { 1 }),
            Quantity::Angle => (PI * 0.4319, 5),
        };
        match count {
            1 => Axis::fixed(c.name, c.home),
            _ => Axis::new(c.name, c.home - half, c.home + half, count),
        }
    });
    Grid::new(manipulator, axes.collect()).unwrap()
}

/// The poses that each cause rejects alone, and with others.
fn counted(manipulator: &Manipulator, found: &Rejections) -> BTreeMap<String, [u64; 2]> {
    let rejections = found.rejections.iter().map(|rejection| {
        let name = name(manipulator, rejection.leg, rejection.cause);
        (name, [rejection.alone, rejection.with_others])
    });
    rejections.collect()
}

#[test]
fn counts_are_those_of_inverse_kinematics() {
    for example in ["plano-spherical-5dof", "planar-3rrr", "agile-eye", "five-bar"] {
        let manipulator = Manipulator::example(example).unwrap();
        let grid = grid(&manipulator);
        let progress = Progress::default();
        let mode = manipulator.home_mode();
        let found = Rejections::new(&manipulator, &grid, Modes::One(mode), &progress).unwrap();
        let sweep = Sweep::new(&manipulator, &grid, Modes::One(mode));
        assert_eq!(found.reachable, sweep.count(&progress).unwrap().reachable, "{example}");

        let mut expected: BTreeMap<String, [u64; 2]> = BTreeMap::new();
        let mut solution = manipulator.solution();
        for number in 0..grid.poses() {
            let of_pose = causes(&manipulator, &grid.pose(number), mode, &mut solution);
            let with_others = usize::from(of_pose.len() > 1);
            for (_, cause) in of_pose {
                expected.entry(cause).or_default()[with_others] += 1;
            }
        }
        let counted = counted(&manipulator, &found);
        if manipulator.dependent_coordinates().is_empty() {
            assert_eq!(counted, expected, "{example}");
        } else {
            // Without the dependent coordinates, no joint has a value.
            let lower = format!("{:?}", Some(Section::Lower));
            assert!(counted.keys().any(|name| name.ends_with(&lower)), "{example}");
        }
    }
}

#[test]
fn causes_in_any_mode_are_those_of_all_of_them() {
    let shipped = |name: &str| Manipulator::example(name).unwrap();
    let narrow = |name: &str| {
        let mut mechanism = shipped(name).mechanism().clone();
        for leg in &mut mechanism.legs {
            for c in leg.joints.iter_mut().flat_map(|joint| &mut joint.coordinates) {
                c.limits = Some([c.home - 0.9, c.home + 0.7]);
            }
        }
        Manipulator::new(mechanism).unwrap()
    };
    // Limits leave a leg some of its modes only.
    for manipulator in [shipped("plano-spherical-5dof"), narrow("planar-3rrr"), narrow("agile-eye")]
    {
        let name = &manipulator.mechanism().name.clone();
        let grid = grid(&manipulator);
        let progress = Progress::default();
        let found = Rejections::new(&manipulator, &grid, Modes::Any, &progress).unwrap();
        let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
        assert_eq!(found.reachable, sweep.count(&progress).unwrap().reachable, "{name}");

        let legs = manipulator.mechanism().legs.len();
        let mut expected: BTreeMap<String, [u64; 2]> = BTreeMap::new();
        let mut solution = manipulator.solution();
        for number in 0..grid.poses() {
            let pose = grid.pose(number);
            let in_modes =
                manipulator.modes().map(|m| causes(&manipulator, &pose, m, &mut solution));
            let in_modes: Vec<_> = in_modes.collect();
            if in_modes.iter().any(Vec::is_empty) {
                continue;
            }
            let of_leg = |leg: usize, causes: &[(usize, String)]| causes.iter().any(|c| c.0 == leg);
            let closed = |leg: usize| in_modes.iter().all(|causes| of_leg(leg, causes));
            let closed: Vec<bool> = (0..legs).map(closed).collect();
            let mut alone = BTreeMap::new();
            for causes in &in_modes {
                for (_, cause) in causes.iter().filter(|cause| closed[cause.0]) {
                    *alone.entry(cause).or_insert(false) |= causes.len() == 1;
                }
            }
            for (cause, alone) in alone {
                expected.entry(cause.clone()).or_default()[usize::from(!alone)] += 1;
            }
        }
        assert!(expected.values().any(|[alone, _]| *alone > 0), "{name}");
        assert_eq!(counted(&manipulator, &found), expected, "{name}");
    }
}
