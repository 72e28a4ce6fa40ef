//! Sweeps with a clearance, against a distance at every pose.

use nalgebra::{Unit, Vector3};
use opm_core::Manipulator;
use opm_core::mechanism::examples::{self, EXAMPLES};
use opm_core::mechanism::joint::Quantity;
use opm_core::mechanism::{Obstacle, ObstacleShape, file};
use opm_core::skeleton::Skeleton;
use opm_interference::{Distances, Interference};
use opm_workspace::{
    Axis, ClearanceError, ClearanceLimit, Count, Grid, Modes, PoseLimit, Progress, Run, Shard,
    Sweep,
};

/// A mechanism with thin rods, and obstacles of every kind around it.
fn with_obstacles(text: &str) -> Manipulator {
    let mut mechanism = file::read(text).unwrap().mechanism;
    let size = Skeleton::new(&mechanism, None).size();
    let at = |x: f64, y: f64, z: f64| mechanism.platform + Vector3::new(x, y, z) * size;
    let shapes = [
        ObstacleShape::Box {
            centre: at(0.5, 0.5, 0.0),
            size: Vector3::repeat(0.3 * size),
            edges: ObstacleShape::level(),
        },
        ObstacleShape::Capsule {
            ends: [at(-0.3, 0.5, -1.0), at(-0.4, 0.5, 1.0)],
            radius: 0.02 * size,
        },
        ObstacleShape::HalfSpace {
            point: at(1.1, 0.0, 0.0),
            normal: Unit::new_normalize(Vector3::new(-1.0, 0.1, 0.0)),
        },
    ];
    let named = |(number, shape)| Obstacle { name: format!("obstacle{number}"), shape };
    mechanism.shapes.obstacles = shapes.into_iter().enumerate().map(named).collect();
    mechanism.shapes.radius = Some(0.004 * size);
    Manipulator::new(mechanism).unwrap()
}

/// The count of a sweep by a distance at every pose, and the numbers of the poses that count.
fn plain(manipulator: &Manipulator, grid: &Grid, limit: ClearanceLimit<'_>) -> (Count, Vec<u64>) {
    let mut distances = Distances::new(limit.interference);
    let mut solution = manipulator.solution();
    let mut count = Count::nothing(manipulator);
    count.poses = grid.poses();
    let mut numbers = Vec::new();
    let mut pose = vec![0.0; grid.axes().len()];
    for number in 0..grid.poses() {
        grid.pose_into(number, &mut pose);
        let found = manipulator.inverse(&pose, manipulator.home_mode(), &mut solution).unwrap();
        let Some(found) = found.filter(|found| found.within_limits()) else { continue };
        distances.place(manipulator, found);
        if distances.nearest().is_some_and(|nearest| nearest.distance < limit.least) {
            continue;
        }
        numbers.push(number);
        for (range, &value) in count.imaginary.iter_mut().zip(found.imaginary()) {
            let [low, high] = range.unwrap_or([value; 2]);
            *range = Some([low.min(value), high.max(value)]);
        }
    }
    count.reachable = numbers.len() as u64;
    (count, numbers)
}

/// The poses of a sweep that count.
fn points(sweep: &Sweep<'_>, grid: &Grid) -> Vec<u64> {
    let mut all = Vec::new();
    sweep
        .points(
            &Progress::default(),
            |hits, made: &mut Vec<Run>| made.extend(hits.numbers(grid)),
            Vec::new,
            |made| {
                all.extend(made.into_iter().flat_map(|run| run.from..run.to));
                Ok::<(), opm_workspace::Cancelled>(())
            },
        )
        .unwrap();
    all
}

/// Grids about home: fine in the first two coordinates, and with few places but several orientations, or many of them.
fn grids(manipulator: &Manipulator) -> Vec<Grid> {
    let size = manipulator.characteristic_length();
    let axes = |counts: &dyn Fn(usize) -> u64| {
        let coordinates = manipulator.task_coordinates().iter().enumerate();
        let all = coordinates.map(|(number, c)| {
            let half = if c.quantity == Quantity::Length { 0.8 * size } else { 0.6 };
            match counts(number) {
                1 => Axis::new(c.name, c.home + 0.1 * half, c.home + 0.1 * half, 1),
                count => Axis::new(c.name, c.home - half, c.home + 0.9 * half, count),
            }
        });
        Grid::new(manipulator, all.collect()).unwrap()
    };
    let lower = manipulator.lower_coordinates();
    vec![
        axes(&|number| [29, 23, 1, 2, 1, 1][number]),
        axes(&|number| if number < lower { 1 } else { 4 }),
        axes(&|number| [1, 1, 13, 1, 11, 2][number]),
    ]
}

#[test]
fn counts_are_those_of_a_distance_at_every_pose() {
    let (mut mechanisms, mut clear, mut near) = (0, 0, 0);
    for example in EXAMPLES {
        if Manipulator::example(example.name).is_err() {
            continue;
        }
        let manipulator = with_obstacles(example.text);
        let interference = Interference::new(manipulator.mechanism());
        let mode = Modes::One(manipulator.home_mode());
        mechanisms += 1;
        for grid in grids(&manipulator) {
            let sweep = Sweep::new(&manipulator, &grid, mode);
            let all = sweep.count(&Progress::default()).unwrap();
            for least in [0.0, 0.02 * manipulator.characteristic_length()] {
                let limit = ClearanceLimit { interference: &interference, least };
                let sweep = sweep.clone().with_clearance(limit).unwrap();
                let (expected, numbers) = plain(&manipulator, &grid, limit);
                let found = sweep.count(&Progress::default()).unwrap();
                assert_eq!(found.reachable, expected.reachable, "{}, {least}", example.name);
                assert_eq!(points(&sweep, &grid), numbers, "{}", example.name);
                for (found, expected) in found.imaginary.iter().zip(&expected.imaginary) {
                    assert_eq!(found.is_some(), expected.is_some());
                    let ends = found.iter().flatten().zip(expected.iter().flatten());
                    for (found, expected) in ends {
                        assert!((found - expected).abs() < 1e-9, "{}", example.name);
                    }
                }
                clear += expected.reachable;
                near += all.reachable - expected.reachable;
            }
        }
    }
    assert!(mechanisms >= 15 && clear > 2000 && near > 2000, "{mechanisms}, {clear}, {near}");
}

/// Orientations at one place, more than a block has, so that blocks end within rows of tiles.
#[test]
fn tiles_of_orientations_may_be_cut() {
    let manipulator = with_obstacles(examples::find("plano-spherical-5dof").unwrap().text);
    let interference = Interference::new(manipulator.mechanism());
    let axes = [("zeta", 41), ("xi", 31), ("psi", 29)];
    let axes = axes.map(|(name, count)| Axis::new(name, 0.05, 0.5, count));
    let grid = Grid::new(&manipulator, axes.to_vec()).unwrap();
    let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
    assert!(sweep.pieces() > 1 && sweep.clone().shard(Shard::new(1, 2).unwrap()).poses() % 41 > 0);
    let limit = ClearanceLimit { interference: &interference, least: 0.002 };
    let (expected, numbers) = plain(&manipulator, &grid, limit);
    let swept = sweep.with_clearance(limit).unwrap();
    let found = swept.count(&Progress::default()).unwrap();
    assert_eq!((found.poses, found.reachable), (grid.poses(), expected.reachable));
    assert_eq!(points(&swept, &grid), numbers);
    assert!(0 < expected.reachable && expected.reachable < grid.poses());
}

#[test]
fn a_clearance_and_a_condition_number_hold_together() {
    let mut told = 0;
    for name in ["plano-spherical-5dof", "planar-3rrr", "five-bar", "planar-planar-5dof"] {
        let manipulator = with_obstacles(examples::find(name).unwrap().text);
        let interference = Interference::new(manipulator.mechanism());
        let mode = Modes::One(manipulator.home_mode());
        let clearance = ClearanceLimit { interference: &interference, least: 0.0 };
        let length = manipulator.characteristic_length();
        for grid in &grids(&manipulator) {
            let of = |most: Option<f64>, clear: bool| {
                let mut sweep = Sweep::new(&manipulator, grid, mode);
                if let Some(most) = most {
                    sweep = sweep.with_limit(PoseLimit::none(length).with_condition(most)).unwrap();
                }
                if clear {
                    sweep = sweep.with_clearance(clearance).unwrap();
                }
                points(&sweep, grid)
            };
            let clear = of(None, true);
            for most in [2.0, 3.0, 5.0, 8.0, 13.0, 21.0] {
                let conditioned = of(Some(most), false);
                let both = conditioned.iter().copied().filter(|n| clear.binary_search(n).is_ok());
                let both: Vec<u64> = both.collect();
                assert_eq!(of(Some(most), true), both, "{name}, {most}");
                told += usize::from(both.len() < conditioned.len() && both.len() < clear.len());
            }
        }
    }
    assert!(told > 0, "each limit alone must reject poses that the other one admits");
}

#[test]
fn what_has_no_clearance_is_refused() {
    let manipulator = with_obstacles(examples::find("planar-3rrr").unwrap().text);
    let interference = Interference::new(manipulator.mechanism());
    let grid = &grids(&manipulator)[0];
    let with = |modes: Modes, least: f64| {
        let limit = ClearanceLimit { interference: &interference, least };
        Sweep::new(&manipulator, grid, modes).with_clearance(limit).err()
    };
    let home = Modes::One(manipulator.home_mode());
    assert_eq!(with(Modes::Any, 0.0), Some(ClearanceError::Modes));
    assert_eq!(with(home, -1.0), Some(ClearanceError::Length(-1.0)));
    assert!(with(home, f64::NAN).is_some());
    assert_eq!(with(home, 0.0), None);
}
