//! Sweeps compared with one inverse-kinematics call per pose: the same poses and the same ranges,
//! with one thread or several.

use fastrand::Rng;
use opm_core::manipulator::{Manipulator, Solution};
use opm_tests::by_inverse::{by_inverse, by_predicate};
use opm_tests::random::{Options, PAIRS, mechanism};
use opm_workspace::{Axis, Cancelled, Count, Grid, Modes, PoseLimit, Progress, Sweep};

/// A grid about home with more values along the coordinates of the lower section, or with few of them, so that slices
/// have few poses.
fn grid(rng: &mut Rng, manipulator: &Manipulator) -> Grid {
    let lower = manipulator.task().lower_count;
    let few = rng.u8(..3) == 0;
    let axes = manipulator.task_coordinates().iter().enumerate().map(|(number, c)| {
        let (below, above) = (rng.f64() * 1.5, rng.f64() * 1.5);
        let count = match (number < lower, few) {
            (true, false) => 2 + rng.u64(..9),
            (true, true) => 1 + rng.u64(..2),
            (false, false) => 1 + rng.u64(..3),
            (false, true) => 2 + rng.u64(..5),
        };
        if count == 1 {
            Axis::fixed(c.name, c.home + below - above)
        } else {
            Axis::new(c.name, c.home - below, c.home + above, count)
        }
    });
    Grid::new(manipulator, axes.collect()).unwrap()
}

fn points(sweep: &Sweep<'_>) -> Vec<Vec<f64>> {
    let mut reached = Vec::new();
    let make = |hits: &opm_workspace::Hits<'_>, made: &mut Vec<Vec<f64>>| {
        made.extend(hits.first.iter().map(|&x| {
            let mut pose = vec![x];
            pose.extend_from_slice(hits.others);
            pose
        }));
    };
    sweep
        .points(&Progress::default(), make, Vec::new, |made| {
            reached.extend(made);
            Ok::<(), Cancelled>(())
        })
        .unwrap();
    reached
}

#[test]
fn a_sweep_finds_what_inverse_kinematics_finds() {
    let mut rng = Rng::with_seed(10);
    let (mut poses, mut reachable, mut partly) = (0, 0, 0);
    for round in 0..60 {
        for pair in PAIRS {
            let limited = if round % 2 == 0 { 0.0 } else { 0.4 };
            let options = Options { limited, balls: round % 3 != 0 };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let grid = grid(&mut rng, &manipulator);
            let modes = match rng.u8(..3) {
                0 => Modes::Any,
                1 => Modes::One(manipulator.home_mode()),
                _ => Modes::One(Default::default()),
            };
            let (reached, expected) = by_inverse(&manipulator, &grid, modes);
            let sweep = Sweep::new(&manipulator, &grid, modes);
            let count = sweep.count(&Progress::default()).unwrap();
            assert_eq!(count, expected, "{pair:?} {modes:?}");
            assert_eq!(points(&sweep), reached, "{pair:?} {modes:?}");
            poses += count.poses;
            reachable += count.reachable;
            partly += u32::from(count.reachable > 0 && count.reachable < count.poses);
        }
    }
    println!("{reachable} of {poses} poses; {partly} grids in part");
    assert!(partly > 300, "{partly} grids were reached in part");
}

/// Rows of thousands of poses, several of which are decided at once.
#[test]
fn long_rows_are_no_exception() {
    let mut rng = Rng::with_seed(14);
    let mut partly = 0;
    for round in 0..4 {
        for pair in PAIRS {
            let limited = if round % 2 == 0 { 0.0 } else { 0.4 };
            let (mechanism, decomposition) =
                mechanism(&mut rng, pair, Options { limited, balls: round < 2 });
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let axes = manipulator.task_coordinates().iter().enumerate().map(|(number, c)| {
                let (below, above) = (rng.f64() * 1.5, rng.f64() * 1.5);
                let count = match number {
                    0 => 1_000 + rng.u64(..4_000),
                    1 | 2 => 3,
                    _ => return Axis::fixed(c.name, c.home + 0.5 * (above - below)),
                };
                Axis::new(c.name, c.home - below, c.home + above, count)
            });
            let grid = Grid::new(&manipulator, axes.collect()).unwrap();
            let modes = Modes::One(manipulator.home_mode());
            let (reached, expected) = by_inverse(&manipulator, &grid, modes);
            let sweep = Sweep::new(&manipulator, &grid, modes);
            assert_eq!(sweep.count(&Progress::default()), Ok(expected.clone()), "{pair:?}");
            assert_eq!(points(&sweep), reached, "{pair:?}");
            partly += u32::from(expected.reachable > 0 && expected.reachable < expected.poses);
        }
    }
    assert!(partly > 20, "{partly} grids were reached in part");
}

/// A grid of a thousand million poses, whose blocks are larger, counts what its slices count, each swept by itself.
#[test]
fn large_grids_are_the_sum_of_their_slices() {
    for (name, counts) in [
        ("planar-3rrr", &[2_100, 2_100, 250][..]),
        ("agile-eye", &[1_500, 1_500, 500]),
        ("plano-spherical-5dof", &[300, 300, 24, 21, 25]),
    ] {
        let manipulator = Manipulator::example(name).unwrap();
        let modes = Modes::One(manipulator.home_mode());
        let axis = |(c, &count): (&opm_core::TaskCoordinate, &u64)| {
            Axis::new(c.name, c.home - 0.4, c.home + 0.3, count)
        };
        let coordinates = manipulator.task_coordinates().iter().zip(counts);
        let axes: Vec<Axis> = coordinates.map(axis).collect();
        let count = |axes: Vec<Axis>| {
            let grid = Grid::new(&manipulator, axes).unwrap();
            Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap()
        };
        let whole = count(axes.clone());
        let (last, others) = axes.split_last().unwrap();
        let slices = (0..last.count).map(|number| {
            let at = Axis::fixed(last.name.clone(), last.value(number));
            count([others, &[at]].concat())
        });
        let sum = slices.fold(Count::nothing(&manipulator), |sum, slice| sum.merge(&slice));
        assert_eq!(whole, sum, "{name}");
        assert!(sum.poses > 1_000_000_000 && sum.reachable > 1_000_000, "{name}: {sum:?}");
    }
}

/// A sweep with a limit on the condition number finds exactly the poses that one call per pose
/// admits, in the modes in which they are admitted.
#[test]
fn a_limited_sweep_finds_what_is_conditioned_well_enough() {
    let mut rng = Rng::with_seed(13);
    let (mut admitted, mut partly) = (0, 0);
    for round in 0..12 {
        for pair in PAIRS {
            let limited = if round % 2 == 0 { 0.0 } else { 0.2 };
            let options = Options { limited, balls: round % 3 != 0 };
            let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
            // There must be enough actuators for some pose to have a condition number.
            mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints).for_each(|joint| {
                joint.actuated = true;
            });
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let grid = grid(&mut rng, &manipulator);
            let modes = match rng.u8(..3) {
                0 => Modes::Any,
                1 => Modes::One(manipulator.home_mode()),
                _ => Modes::One(Default::default()),
            };
            let length = manipulator.characteristic_length() * (0.5 + rng.f64());
            let mut jacobians = manipulator.jacobians();
            let mut conditions = Vec::new();
            let mut condition = |solution: &Solution| {
                manipulator.differentiate(solution, &mut jacobians).unwrap();
                manipulator.conditioning(&jacobians, length).condition
            };
            let (_, all) = by_predicate(&manipulator, &grid, modes, |solution| {
                conditions.push(condition(solution));
                true
            });
            // The median admits half of the solutions.
            conditions.sort_by(f64::total_cmp);
            let most = conditions.get(conditions.len() / 2).copied().unwrap_or(1.0);
            let (reached, expected) =
                by_predicate(&manipulator, &grid, modes, |solution| condition(solution) <= most);
            let limit = PoseLimit::none(length).with_condition(most);
            let sweep = Sweep::new(&manipulator, &grid, modes).with_limit(limit).unwrap();
            let count = sweep.count(&Progress::default()).unwrap();
            assert_eq!(count, expected, "{pair:?} {modes:?}");
            assert_eq!(points(&sweep), reached, "{pair:?} {modes:?}");
            admitted += count.reachable;
            partly += u32::from(count.reachable > 0 && count.reachable < all.reachable);
        }
    }
    println!("{admitted} poses admitted; {partly} grids in part");
    assert!(partly > 60, "{partly} grids were admitted in part");
}

#[test]
fn threads_do_not_matter() {
    let mut rng = Rng::with_seed(11);
    for pair in PAIRS {
        let options = Options { limited: 0.1, balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let axes = manipulator.task_coordinates().iter().enumerate().map(|(number, c)| {
            // The first row is longer than a segment.
            let count = if number == 0 { 40_000 } else { 2 };
            Axis::new(c.name, c.home - 1.0, c.home + 1.3, count)
        });
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| (sweep.count(&Progress::default()).unwrap(), points(&sweep)))
        };
        let one = with(1);
        assert_eq!(one.0.reachable, one.1.len() as u64);
        assert!(one == with(2) && one == with(7), "{pair:?}");
    }
}

#[test]
fn a_cancelled_sweep_stops() {
    let mut rng = Rng::with_seed(12);
    let (mechanism, decomposition) =
        mechanism(&mut rng, PAIRS[0], Options { limited: 0.0, balls: true });
    let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
    let axes = manipulator.task_coordinates().iter();
    let axes = axes.map(|c| Axis::new(c.name, c.home - 1.0, c.home + 1.0, 1_000));
    let grid = Grid::new(&manipulator, axes.collect()).unwrap();
    let progress = Progress::default();
    let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
    let counted = std::thread::scope(|scope| {
        let sweeping = scope.spawn(|| sweep.count(&progress));
        while progress.done() < 100_000 {
            std::thread::yield_now();
        }
        progress.cancel();
        sweeping.join().unwrap()
    });
    assert_eq!(counted, Err(Cancelled));
    assert!(progress.done() < grid.poses() / 1_000);
}
