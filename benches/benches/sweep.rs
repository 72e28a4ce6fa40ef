//! Sweeps of the paper's 5-DoF manipulator against one inverse-kinematics call per pose.

use opm_benches::{Contender, compare, example};
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep};
use std::hint::black_box;

fn main() {
    let manipulator = example("plano-spherical-5dof");
    let mode = manipulator.home_mode();
    let grid = |n: u64, orientations: u64| {
        let axes = vec![
            Axis::new("x", -0.15, 0.15, n),
            Axis::new("y", -0.15, 0.15, n),
            Axis::new("zeta", -0.4, 0.4, orientations),
            Axis::new("xi", -0.4, 0.4, orientations),
            Axis::new("psi", -0.4, 0.4, orientations),
        ];
        Grid::new(&manipulator, axes).expect("a grid")
    };
    let (small, large, long) = (grid(64, 5), grid(64, 25), grid(256, 12));
    let pool = |threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool")
    };
    let (one, two) = (pool(1), pool(2));
    let mut drives = manipulator.drives();
    let count = |grid: &Grid, pool: &rayon::ThreadPool| {
        let sweep = Sweep::new(&manipulator, grid, Modes::One(mode));
        pool.install(|| sweep.count(&Progress::default()).expect("not cancelled").reachable)
    };
    let mut per_pose = || {
        let mut reachable = 0;
        for index in 0..small.poses() {
            let pose = small.pose(index);
            let reached = manipulator.inverse_drives(&pose, mode, &mut drives);
            reachable += u64::from(reached.expect("a finite pose") && drives.within_limits);
        }
        reachable
    };
    let expected = per_pose();
    assert_eq!(expected, count(&small, &one), "the sweep counts what inverse kinematics counts");
    assert_eq!(count(&large, &one), count(&large, &two), "threads do not matter");
    println!("{} of {} poses reachable", expected, small.poses());
    let timings = compare(vec![
        Contender::new("inverse kinematics per pose, one thread", small.poses(), || {
            black_box(per_pose());
        }),
        Contender::new("sweep, 64 poses a row, one thread", large.poses(), || {
            black_box(count(&large, &one));
        }),
        Contender::new("sweep, 64 poses a row, two threads", large.poses(), || {
            black_box(count(&large, &two));
        }),
        Contender::new("sweep, 256 poses a row, one thread", long.poses(), || {
            black_box(count(&long, &one));
        }),
    ]);
    println!("| sweep, 5 DoF | million poses a second | times inverse kinematics per pose |");
    println!("|---|---:|---:|");
    for t in &timings {
        println!("| {} | {:.1} | {:.1} |", t.name, 1e-6 / t.seconds, 1.0 / t.ratio);
    }
    println!("two threads: {:.2} times one", timings[1].seconds / timings[2].seconds);
}
