//! Sweeps by intervals against the exact predicate, pose by pose: every planar lower section, with
//! the limits of its sliders or of all its joints, on many long rows, and rows that end exactly on a
//! pose.

use fastrand::Rng;
use opm_core::joint::Quantity;
use opm_core::manipulator::{Follow, Manipulator};
use opm_core::mechanism::{Mechanism, examples, file};
use opm_tests::random::{Kind, Options, PAIRS, mechanism};
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep};
use rayon::prelude::*;

/// Poses that are decided both ways.
const POSES: u64 = 100_000_000;

/// How many poses of the grid every leg follows to.
fn by_predicate(manipulator: &Manipulator, grid: &Grid, modes: Modes) -> u64 {
    let mode = match modes {
        Modes::One(mode) => Some(mode),
        Modes::Any => None,
    };
    let lower = grid.lower();
    let in_slice = grid.poses() / grid.slices();
    let mut count = 0;
    for slice in 0..grid.slices() {
        let b = manipulator.task().upper(&grid.pose(slice * in_slice)[lower..]);
        let legs: Vec<Vec<Follow>> = (0..manipulator.legs())
            .map(|leg| {
                let mut ways = Vec::new();
                manipulator.follow(leg, &b, mode, &mut ways);
                ways
            })
            .collect();
        count += (0..in_slice)
            .into_par_iter()
            .filter(|i| {
                let v = manipulator.task().lower(&grid.pose(slice * in_slice + i)[..lower]);
                legs.iter().all(|ways| ways.iter().any(|way| manipulator.follows(way, &v)))
            })
            .count() as u64;
    }
    count
}

fn without_limits_on_angles(mut mechanism: Mechanism) -> Mechanism {
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        for coordinate in &mut joint.coordinates {
            if coordinate.quantity == Quantity::Angle {
                coordinate.limits = None;
            }
        }
    }
    mechanism
}

#[test]
fn intervals_hold_the_poses_that_the_chains_reach() {
    let mut rng = Rng::with_seed(20);
    let planar: Vec<_> = PAIRS
        .into_iter()
        .filter(|[lower, _]| matches!(lower, Kind::Planar(_) | Kind::TranslationalPlane))
        .collect();
    let (mut poses, mut reachable, mut partly, mut round) = (0, 0, 0, 0);
    while poses < POSES {
        let pair = planar[round % planar.len()];
        let options = Options { limited: [0.0, 0.3, 0.7][rng.usize(..3)], balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let mechanism = match round % 4 {
            0 => mechanism,
            _ => without_limits_on_angles(mechanism),
        };
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let counts = [50 + rng.u64(..1500), 20 + rng.u64(..200), 1, 1, 1];
        let axes = manipulator.task_coordinates().iter().zip(counts).map(|(c, count)| {
            let (below, above) = (rng.f64() * 2.0, rng.f64() * 2.0);
            match count {
                1 => Axis::fixed(c.name, c.home + 0.5 * (above - below)),
                _ => Axis::new(c.name, c.home - below, c.home + above, count),
            }
        });
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let modes = match rng.u8(..3) {
            0 => Modes::Any,
            _ => Modes::One(manipulator.home_mode()),
        };
        let sweep = Sweep::new(&manipulator, &grid, modes);
        let count = sweep.count(&Progress::default()).unwrap().reachable;
        let expected = by_predicate(&manipulator, &grid, modes);
        assert_eq!(count, expected, "round {round}: {pair:?} {modes:?}");
        poses += grid.poses();
        reachable += count;
        partly += u32::from(count > 0 && count < grid.poses());
        round += 1;
    }
    println!("{reachable} of {poses} poses; {partly} of {round} grids in part");
    assert!(partly > 100);
}

/// The shipped mechanisms have round dimensions: limits, rims and holes that fall on poses.
#[test]
fn round_numbers_are_no_exception() {
    for example in examples::EXAMPLES {
        let Ok(manipulator) = Manipulator::new(file::read(example.text).unwrap().mechanism) else {
            continue;
        };
        for (step, count) in [(0.01, 81), (0.0125, 65), (0.05, 17), (0.1, 9)] {
            let axes = manipulator.task_coordinates().iter().enumerate().map(|(i, c)| {
                let half = step * (count - 1) as f64 / 2.0;
                match (i, c.quantity) {
                    (0 | 1, Quantity::Length) => Axis::new(c.name, -half, half, count),
                    (_, Quantity::Length) => Axis::new(c.name, c.home - 0.05, c.home + 0.05, 3),
                    (_, Quantity::Angle) => Axis::new(c.name, c.home - 0.5, c.home + 0.5, 3),
                }
            });
            let grid = Grid::new(&manipulator, axes.collect()).unwrap();
            for modes in [Modes::Any, Modes::One(manipulator.home_mode())] {
                let sweep = Sweep::new(&manipulator, &grid, modes);
                let count = sweep.count(&Progress::default()).unwrap().reachable;
                let expected = by_predicate(&manipulator, &grid, modes);
                assert_eq!(count, expected, "{} {modes:?} {step}", example.name);
            }
        }
    }
}
