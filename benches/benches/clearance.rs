//! Sweeps of planar and spatial mechanisms whose bodies keep a clearance, compared with a distance at every pose.

use opm_benches::{Contender, compare, example};
use opm_core::manipulator::{Manipulator, Solution};
use opm_interference::{Distances, Interference};
use opm_workspace::{Axis, ClearanceLimit, Grid, Modes, Progress, Sweep};

/// The least distance of bodies, metres.
const LEAST: f64 = 0.002;

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread pool");
    println!(
        "| bodies at least 2 mm apart, one thread | million poses a second | a distance at every pose | times as fast |"
    );
    println!("|---|---:|---:|---:|");
    for (name, counts) in [
        ("planar-3rrr", [401, 401, 5]),
        ("planar-3rrr", [201, 201, 21]),
        ("planar-3rrr", [101, 101, 21]),
        ("plano-spherical-5dof", [101, 101, 5]),
    ] {
        let manipulator = example(name);
        let grid = grid(&manipulator, counts);
        let interference = Interference::new(manipulator.mechanism());
        let limit = ClearanceLimit { interference: &interference, least: LEAST };
        let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
        let sweep = sweep.with_clearance(limit).expect("one working mode");
        let clear = by_distance(&manipulator, &grid, &interference);
        let timings = compare(vec![
            Contender::new("a sweep", grid.poses(), || {
                let count = pool.install(|| sweep.count(&Progress::default()));
                assert_eq!(count.expect("not cancelled").reachable, clear);
            }),
            Contender::new("a distance at every pose", grid.poses(), || {
                assert_eq!(by_distance(&manipulator, &grid, &interference), clear);
            }),
        ]);
        let [a, b, c] = counts;
        let [sweep, plain] = [&timings[0], &timings[1]].map(|t| 1e-6 / t.seconds);
        println!("| {name}, {a} x {b} x {c} | {sweep:.2} | {plain:.2} | {:.1} |", timings[1].ratio);
    }
}

/// Places about home, and values of the first orientation.
fn grid(manipulator: &Manipulator, counts: [u64; 3]) -> Grid {
    let ends = [[-0.19, 0.19], [-0.17, 0.21], [-0.5, 0.5]];
    let coordinates = manipulator.task_coordinates().iter().zip(ends).zip(counts);
    let axes = coordinates.map(|((c, [from, to]), count)| Axis::new(c.name, from, to, count));
    Grid::new(manipulator, axes.collect()).expect("coordinates of the mechanism")
}

/// Counts the poses in reach and within all limits whose bodies keep the clearance.
fn by_distance(manipulator: &Manipulator, grid: &Grid, interference: &Interference) -> u64 {
    let (mode, mut solution) = (manipulator.home_mode(), manipulator.solution());
    let mut distances = Distances::new(interference);
    let mut pose = vec![0.0; grid.axes().len()];
    let clear = (0..grid.poses()).filter(|&index| {
        grid.pose_into(index, &mut pose);
        let found = manipulator.inverse(&pose, mode, &mut solution).expect("a finite pose");
        found.filter(|found: &&Solution| found.within_limits()).is_some_and(|found| {
            distances.place(manipulator, found);
            distances.nearest().is_none_or(|nearest| nearest.distance >= LEAST)
        })
    });
    clear.count() as u64
}
