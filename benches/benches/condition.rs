//! Condition numbers of the poses of a sweep of the paper's 5-DoF manipulator, compared with inverse kinematics pose by
//! pose.

use opm_benches::{Contender, compare, example, sweep_grid};
use opm_core::manipulator::{Manipulator, Solution};
use opm_workspace::{Conditioned, ConditioningIndex, Grid, Modes, PoseLimit, Progress, Sweep};

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread pool");
    let manipulator = example("plano-spherical-5dof");
    let length = manipulator.characteristic_length();
    let modes = Modes::One(manipulator.home_mode());
    for size in [[64, 64, 4], [256, 256, 2]] {
        let grid = sweep_grid(&manipulator, size);
        let sweep = Sweep::new(&manipulator, &grid, modes);
        let reachable = pool.install(|| sweep.count(&Progress::default())).expect("not cancelled");
        let reachable = reachable.reachable;
        // A limit that some half of the poses keep.
        let limit = PoseLimit::none(length).with_condition(20.0);
        let limited = sweep.clone().with_limit(limit.clone()).expect("a grid of poses");
        let admitted = by_pose(&manipulator, &grid, modes, limit.clone());
        let timings = compare(vec![
            Contender::new("inverse kinematics, all joints, pose by pose", grid.poses(), || {
                assert_eq!(by_inverse(&manipulator, &grid), reachable);
            }),
            Contender::new("a limit on the condition number, pose by pose", grid.poses(), || {
                assert_eq!(by_pose(&manipulator, &grid, modes, limit.clone()), admitted);
            }),
            Contender::new("a sweep with this limit", grid.poses(), || {
                let count = pool.install(|| limited.count(&Progress::default()));
                assert_eq!(count.expect("not cancelled").reachable, admitted);
            }),
            Contender::new("a sweep and the index of every pose", grid.poses(), || {
                let index =
                    pool.install(|| ConditioningIndex::of(&sweep, length, &Progress::default()));
                assert_eq!(index.expect("a grid of poses").poses, reachable);
            }),
        ]);
        let inverse = timings[0].seconds;
        println!(
            "| conditioning, {} poses a row, one thread | million poses a second | of inverse kinematics' rate |",
            size[0]
        );
        println!("|---|---:|---:|");
        for t in timings {
            println!("| {} | {:.2} | {:.2} |", t.name, 1e-6 / t.seconds, inverse / t.seconds);
        }
        println!(
            "{reachable} of {} poses are reachable, {admitted} of them admitted.",
            grid.poses()
        );
    }
}

/// Counts the poses in reach within all limits.
fn by_inverse(manipulator: &Manipulator, grid: &Grid) -> u64 {
    let (mode, mut solution) = (manipulator.home_mode(), manipulator.solution());
    let mut pose = [0.0; 5];
    let reached = (0..grid.poses()).filter(|&index| {
        grid.pose_into(index, &mut pose);
        let reached = manipulator.inverse(&pose, mode, &mut solution).expect("a finite pose");
        reached.is_some_and(Solution::within_limits)
    });
    reached.count() as u64
}

/// Counts the poses that a limit admits.
fn by_pose(manipulator: &Manipulator, grid: &Grid, modes: Modes, limit: PoseLimit) -> u64 {
    let mut conditioned = Conditioned::new(manipulator, limit);
    let mut pose = [0.0; 5];
    let admitted = (0..grid.poses()).filter(|&index| {
        grid.pose_into(index, &mut pose);
        conditioned.first(&pose, modes).is_some()
    });
    admitted.count() as u64
}
