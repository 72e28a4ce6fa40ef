//! Sweeps of the paper's 5-DoF manipulator, compared with other ways to count the same poses, and
//! with the most that the machine could do.
//!
//! `PEERS_PYTHON` names a Python with NumPy, numba and `opm_kinematics`, for the comparisons in
//! `benches/peers/sweep.py`. Without it, the table does not contain them.

use opm_benches::peers::Peers;
use opm_benches::{
    Contender, Timing, compare, denser, example, square_roots, sweep_grid, with_limits_on_links,
    with_limits_on_passive_angles,
};
use opm_core::chain::region::{Convex, Region};
use opm_core::manipulator::{ActuatedJoints, Manipulator};
use opm_core::mechanism::examples::EXAMPLES;
use opm_core::reach::LegBranch;
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep, default_grid};
use rayon::ThreadPool;
use std::time::{Duration, Instant};

/// The names in the tables, and what the script does.
const PEERS: &[(&str, &str)] = &[
    ("opm from Python, one thread", "opm-1"),
    ("opm from Python, two threads", "opm-2"),
    ("numba, factorised", "numba-factorised"),
    ("NumPy, factorised", "numpy-factorised"),
    ("NumPy, pose by pose", "numpy-per-pose"),
];

/// The least time of a sweep of a denser grid, with which starting threads does not matter.
const LONG: Duration = Duration::from_millis(50);

fn main() {
    let pools = [1, 2].map(|threads| {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a thread pool")
    });
    let manipulator = example("plano-spherical-5dof");
    let peers = Peers::start("peers/sweep.py");
    let sizes = [[64, 64, 13], [256, 256, 5]];
    for size in sizes {
        table(&manipulator, size, &pools, peers.as_ref());
    }
    table_of_threads(&manipulator, &pools);
    if peers.is_none() {
        println!("PEERS_PYTHON names no Python with NumPy and numba to compare with.");
    }
    let limited = with_limits_on_links(&manipulator);
    table_of_limits(
        "the pivots of links that slide",
        &limited,
        [65, 129, 15],
        &pools,
        peers.as_ref(),
    );
    let limited = with_limits_on_passive_angles(&manipulator);
    for size in sizes {
        table_of_limits("passive angles", &limited, size, &pools, None);
    }
    table_of_mechanisms(&pools);
}

/// Every shipped mechanism with a workspace, on the grid that is fitted to it and on a denser one; and orientations at one
/// place of the first one, each a slice of its own.
fn table_of_mechanisms(pools: &[ThreadPool; 2]) {
    println!(
        "| fitted grid | poses | poses a row | million a second, one thread | denser grid, million poses | \
         million a second, one thread | two threads for one |"
    );
    println!("|---|---:|---:|---:|---:|---:|---:|");
    for name in EXAMPLES.iter().map(|example| example.name) {
        let Ok(manipulator) = Manipulator::example(name) else { continue };
        let modes = Modes::One(manipulator.home_mode());
        let fitted = default_grid(&manipulator, modes, &Progress::default());
        row_of_mechanism(name, &manipulator, &fitted.expect("not cancelled").0, pools);
    }
    let manipulator = example("plano-spherical-5dof");
    let angle = |name: &str| Axis::new(name, -0.8, 0.8, 101);
    let grid = Grid::new(&manipulator, ["zeta", "xi", "psi"].map(angle).into()).expect("a grid");
    row_of_mechanism("plano-spherical-5dof, at one place", &manipulator, &grid, pools);
}

fn row_of_mechanism(name: &str, manipulator: &Manipulator, grid: &Grid, pools: &[ThreadPool; 2]) {
    let timings = |grid: &Grid, pools: &[ThreadPool]| {
        let expected = by_rows(manipulator, grid, &pools[0]);
        let each = pools.iter().map(|pool| {
            contender("rows", grid, expected, move || by_rows(manipulator, grid, pool))
        });
        compare(each.collect())
    };
    let fitted = timings(grid, &pools[..1]);
    let denser = denser(grid.axes(), |axes| {
        let grid = Grid::new(manipulator, axes.to_vec()).expect("a grid");
        let start = Instant::now();
        by_rows(manipulator, &grid, &pools[0]);
        start.elapsed() >= LONG
    });
    let denser = Grid::new(manipulator, denser).expect("a grid");
    let of_denser = timings(&denser, pools);
    println!(
        "| {name} | {} | {} | {:.1} | {:.0} | {:.1} | {:.2} |",
        grid.poses(),
        grid.row(),
        1e-6 / fitted[0].seconds,
        1e-6 * denser.poses() as f64,
        1e-6 / of_denser[0].seconds,
        of_denser[1].ratio.recip(),
    );
}

fn by_rows(manipulator: &Manipulator, grid: &Grid, pool: &ThreadPool) -> u64 {
    let sweep = Sweep::new(manipulator, grid, Modes::One(manipulator.home_mode()));
    pool.install(|| sweep.count(&Progress::default()).expect("not cancelled").reachable)
}

fn per_pose(manipulator: &Manipulator, grid: &Grid) -> u64 {
    let (mode, mut drives) = (manipulator.home_mode(), manipulator.actuated_joints());
    let mut pose = [0.0; 5];
    let reached = (0..grid.poses()).filter(|&index| {
        grid.pose_into(index, &mut pose);
        let reached = manipulator.inverse_actuated(&pose, mode, &mut drives);
        reached.expect("a finite pose").is_some_and(ActuatedJoints::within_limits)
    });
    reached.count() as u64
}

/// The upper section once per orientation, then pose by pose.
fn factorised(manipulator: &Manipulator, grid: &Grid) -> u64 {
    let (task, in_slice) = (manipulator.task(), grid.poses() / grid.slices());
    let mut pose = [0.0; 5];
    let mut count = 0;
    for slice in 0..grid.slices() {
        let Some(ways) = ways(manipulator, grid, slice) else { continue };
        for index in slice * in_slice..(slice + 1) * in_slice {
            grid.pose_into(index, &mut pose);
            let v = task.lower(&pose[..grid.lower()]);
            count += u64::from(ways.iter().all(|way| manipulator.reach().reaches(way, &v)));
        }
    }
    count
}

/// How each leg depends on the slice, in the home mode; `None` if a leg has no such dependence.
fn ways(manipulator: &Manipulator, grid: &Grid, slice: u64) -> Option<Vec<LegBranch>> {
    let mut pose = [0.0; 5];
    grid.pose_into(slice * (grid.poses() / grid.slices()), &mut pose);
    let b = manipulator.task().upper(&pose[grid.lower()..]);
    let mut ways = Vec::new();
    for leg in 0..manipulator.legs() {
        manipulator.reach().leg_branches(leg, &b, Some(manipulator.home_mode()), &mut ways);
    }
    (ways.len() == manipulator.legs()).then_some(ways)
}

/// A way to count a grid; the count is compared with the expected one.
fn contender<'a>(
    name: &'static str,
    grid: &Grid,
    expected: u64,
    count: impl Fn() -> u64 + 'a,
) -> Contender<'a> {
    let run = move || assert_eq!(count(), expected, "{name}: all count the same poses");
    Contender::new(name, grid.poses(), run)
}

fn by_opm<'a>(
    manipulator: &'a Manipulator,
    grid: &'a Grid,
    expected: u64,
    [one, two]: [&'a ThreadPool; 2],
) -> Vec<Contender<'a>> {
    vec![
        contender("opm, rows, one thread", grid, expected, move || by_rows(manipulator, grid, one)),
        contender("opm, rows, two threads", grid, expected, move || {
            by_rows(manipulator, grid, two)
        }),
        contender("opm, factorised, pose by pose", grid, expected, || {
            factorised(manipulator, grid)
        }),
    ]
}

/// All ways to count one grid, and how far the rows are from what the machine can do.
fn table(
    manipulator: &Manipulator,
    size: [u64; 3],
    [one, two]: &[ThreadPool; 2],
    peers: Option<&Peers>,
) {
    let grid = &sweep_grid(manipulator, size);
    let points = size[0];
    let expected = by_rows(manipulator, grid, one);
    let mut contenders = by_opm(manipulator, grid, expected, [one, two]);
    contenders.push(contender("opm, inverse kinematics per pose", grid, expected, || {
        per_pose(manipulator, grid)
    }));
    if let Some(peers) = peers {
        for (name, short) in PEERS {
            contenders.push(asked(name, short, grid, size, expected, peers));
        }
    }
    contenders.push(Contender::new("", square_roots::EACH, square_roots::take));
    let mut timings = compare(contenders);
    let roots = timings.pop().expect("the machine's own rate").seconds.recip();
    print_table(&format!("sweep, {points} poses a row"), &timings);
    let rows = 1.0 / (timings[0].seconds * points as f64);
    let each = roots_a_row(manipulator, grid);
    println!(
        "Each counts the same {expected} of {} poses. The machine's limit: a row takes {each} square roots, \
         and one more for each hole that it can meet; {:.1} million rows a second take at least {:.0} \
         million. One thread that does nothing else takes {:.0} million a second (vectorised for {}): \
         {:.0} % of the limit.",
        grid.poses(),
        rows * 1e-6,
        rows * 1e-6 * each as f64,
        roots * 1e-6,
        square_roots::instructions(),
        100.0 * rows * each as f64 / roots,
    );
}

/// The gain by a second thread for sweeps of some tenths of a second, longer than threads take to
/// start and than a shared machine takes a processor away. It is compared with the gain for work
/// that needs only the processor.
fn table_of_threads(manipulator: &Manipulator, [one, two]: &[ThreadPool; 2]) {
    println!("| two threads for one | poses | times as fast |");
    println!("|---|---:|---:|");
    for size in [[64, 64, 61], [256, 256, 41]] {
        let grid = &sweep_grid(manipulator, size);
        let expected = by_rows(manipulator, grid, one);
        let timings = compare(
            [("one", one), ("two", two)]
                .map(|(name, pool)| {
                    contender(name, grid, expected, move || by_rows(manipulator, grid, pool))
                })
                .into(),
        );
        println!(
            "| opm, {} poses a row | {} | {:.2} |",
            size[0],
            grid.poses(),
            timings[1].ratio.recip()
        );
    }
    let roots = [(1, one), (2, two)].map(|(threads, pool)| {
        Contender::new("", threads * square_roots::EACH, move || {
            pool.broadcast(|_| square_roots::take());
        })
    });
    let timings = compare(roots.into());
    println!("| nothing but square roots | | {:.2} |", timings[1].ratio.recip());
}

/// A way to count a grid in Python.
fn asked<'a>(
    name: &'static str,
    short: &str,
    grid: &Grid,
    [points, rows, orientations]: [u64; 3],
    expected: u64,
    peers: &'a Peers,
) -> Contender<'a> {
    let question = format!("{short} {points} {rows} {orientations}");
    contender(name, grid, expected, move || peers.ask(&question))
}

/// With limits on angles.
fn table_of_limits(
    limited: &str,
    manipulator: &Manipulator,
    size: [u64; 3],
    [one, two]: &[ThreadPool; 2],
    peers: Option<&Peers>,
) {
    let grid = &sweep_grid(manipulator, size);
    let expected = by_rows(manipulator, grid, one);
    let free = example("plano-spherical-5dof");
    let free = &free;
    let without = by_rows(free, grid, one);
    let mut contenders = by_opm(manipulator, grid, expected, [one, two]);
    contenders.push(contender("opm, rows without these limits, one thread", grid, without, || {
        by_rows(free, grid, one)
    }));
    if let Some(peers) = peers {
        contenders.push(asked("numba, factorised", "numba-within", grid, size, expected, peers));
    }
    print_table(&format!("limits on {limited}, {} poses a row", size[0]), &compare(contenders));
    println!("{expected} of {} poses are reachable.", grid.poses());
}

fn print_table(title: &str, timings: &[Timing]) {
    println!("| {title} | million poses a second | rows are faster by |");
    println!("|---|---:|---:|");
    for t in timings {
        println!("| {} | {:.1} | {:.2} |", t.name, 1e-6 / t.seconds, t.ratio);
    }
}

/// The number of square roots for the intervals of every row, from the shapes that the legs leave
/// in a slice.
fn roots_a_row(manipulator: &Manipulator, grid: &Grid) -> usize {
    let of = |set: &Convex| match set {
        Convex::Bands(_) => 0,
        Convex::Disc(_) | Convex::Capsule(_) => 1,
    };
    let ways = ways(manipulator, grid, grid.slices() / 2).expect("the middle is in reach");
    let v = manipulator.task().lower(&manipulator.home_pose()[..grid.lower()]);
    let regions = ways.iter().map(|way| {
        let region = manipulator.reach().region(way, &v, 1.0);
        region.expect("only sliders are limited")
    });
    regions.map(|Region { whole, .. }| of(&whole)).sum()
}
