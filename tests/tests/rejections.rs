//! What rejects poses, compared with inverse kinematics pose by pose.

use opm_core::manipulator::Section;
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
    solution: &mut opm_core::manipulator::Solution,
) -> Vec<String> {
    let found = manipulator.inverse(pose, manipulator.home_mode(), solution).unwrap();
    let missed: Vec<usize> = match found {
        Some(_) => vec![],
        None => solution.unreachable().iter().map(|missed| missed.leg).collect(),
    };
    let mut causes: Vec<String> =
        solution.unreachable().iter().map(|u| format!("{} {}", u.leg, u.section)).collect();
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
            causes.push(format!("{} {end}", coordinate.name));
        }
    }
    causes
}

fn name(manipulator: &Manipulator, leg: usize, cause: Cause) -> String {
    let joint = |joint: usize| &manipulator.coordinates()[joint].name;
    match cause {
        Cause::Reach(section) => format!("{leg} {section}"),
        Cause::Lowest(number) => format!("{} lowest", joint(number)),
        Cause::Highest(number) => format!("{} highest", joint(number)),
    }
}

#[test]
fn counts_are_those_of_inverse_kinematics() {
    for example in ["plano-spherical-5dof", "planar-3rrr", "agile-eye", "five-bar"] {
        let Ok(manipulator) = Manipulator::example(example) else {
            panic!("{example} is not shipped");
        };
        let axes = manipulator.task_coordinates().iter().enumerate().map(|(i, c)| {
            let (half, count) = match c.quantity {
                // Odd shares: no pose is exactly on a limit.
                Quantity::Length => (0.3137, if i < 2 { 13 } else { 1 }),
                Quantity::Angle => (PI * 0.4319, 5),
            };
            match count {
                1 => Axis::fixed(c.name, c.home),
                _ => Axis::new(c.name, c.home - half, c.home + half, count),
            }
        });
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let progress = Progress::default();
        let mode = manipulator.home_mode();
        let found = Rejections::new(&manipulator, &grid, mode, &progress).unwrap();
        let sweep = Sweep::new(&manipulator, &grid, Modes::One(mode));
        assert_eq!(found.reachable, sweep.count(&progress).unwrap().reachable, "{example}");

        let mut expected: BTreeMap<String, [u64; 2]> = BTreeMap::new();
        let mut solution = manipulator.solution();
        for number in 0..grid.poses() {
            let of_pose = causes(&manipulator, &grid.pose(number), &mut solution);
            let with_others = usize::from(of_pose.len() > 1);
            for cause in of_pose {
                expected.entry(cause).or_default()[with_others] += 1;
            }
        }
        let counted = found.rejections.iter().map(|rejection| {
            let name = name(&manipulator, rejection.leg, rejection.cause);
            (name, [rejection.alone, rejection.with_others])
        });
        if manipulator.dependent_coordinates().is_empty() {
            assert_eq!(counted.collect::<BTreeMap<_, _>>(), expected, "{example}");
        } else {
            // Without the dependent coordinates, no joint has a value.
            let legs = counted.filter(|(name, _)| name.ends_with(&Section::Lower.to_string()));
            assert!(legs.count() > 0, "{example}");
        }
    }
}
