//! Shards of a sweep: together they are the whole sweep, whatever their number.

use fastrand::Rng;
use opm_core::manipulator::{Manipulator, Mode};
use opm_tests::random::{Options, PAIRS, mechanism};
use opm_workspace::{
    Axis, Cancelled, Count, Grid, Hits, Modes, PoseLimit, Progress, Run, Shard, Sweep, replay,
};

/// The runs of a sweep with their rows, in the order in which they are reported.
fn runs(sweep: &Sweep<'_>) -> Vec<(u64, Run)> {
    let mut all = Vec::new();
    sweep
        .points(
            &Progress::default(),
            |hits, made: &mut Vec<_>| made.extend(hits.runs.iter().map(|&run| (hits.row, run))),
            Vec::new,
            |made| {
                all.extend(made);
                Ok::<(), Cancelled>(())
            },
        )
        .unwrap();
    all
}

fn grid(manipulator: &Manipulator, counts: [u64; 6]) -> Grid {
    let coordinates = manipulator.task_coordinates().iter().zip(counts);
    let axes = coordinates.map(|(c, count)| match count {
        1 => Axis::fixed(c.name, c.home),
        _ => Axis::new(c.name, c.home - 1.0, c.home + 1.3, count),
    });
    Grid::new(manipulator, axes.collect()).unwrap()
}

#[test]
fn shards_are_the_whole_one_after_the_other() {
    let mut rng = Rng::with_seed(40);
    let mut shared = 0;
    for (number, pair) in PAIRS.into_iter().enumerate() {
        let options = Options { limited: 0.1, balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        // Rows with several segments, or segments with several rows.
        for counts in [[40_000, 2, 2, 2, 1, 1], [40, 30, 4, 5, 5, 5]] {
            let grid = grid(&manipulator, counts);
            let modes = [Modes::Any, Modes::One(Mode::default())][number % 2];
            let whole = Sweep::new(&manipulator, &grid, modes);
            let (count, all) = (whole.count(&Progress::default()).unwrap(), runs(&whole));
            for of in [1, 2, 3, 8, 1000] {
                let shards: Vec<Sweep<'_>> =
                    (1..=of).map(|i| whole.clone().shard(Shard::new(i, of).unwrap())).collect();
                let parts: Vec<Count> =
                    shards.iter().map(|shard| shard.count(&Progress::default()).unwrap()).collect();
                for (shard, part) in shards.iter().zip(&parts) {
                    assert_eq!(shard.poses(), part.poses);
                }
                let nothing = || Count::nothing(&manipulator);
                let forth = parts.iter().fold(nothing(), Count::merge);
                let back = parts.iter().rev().fold(nothing(), Count::merge);
                assert_eq!([&forth, &back], [&count; 2], "{pair:?} {of}");
                let together: Vec<_> = shards.iter().flat_map(runs).collect();
                assert!(together == all, "{pair:?} {of}");
                shared += u32::from(parts.iter().filter(|part| part.reachable > 0).count() > 1);
            }
        }
    }
    assert!(shared > 60, "{shared} sweeps had points in several shards");
}

/// The first coordinate of a pose, the numbers of its slice and row, and its other coordinates.
type Pose = (f64, (u64, u64, Vec<f64>));

/// The results of a sweep, from the numbers of its poses alone, also where a run continues over
/// many rows.
#[test]
fn a_replay_gives_what_the_sweep_gave() {
    let mut rng = Rng::with_seed(41);
    for pair in PAIRS {
        let options = Options { limited: 0.1, balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        for counts in [[5_000, 3, 3, 2, 2, 2], [40, 30, 4, 5, 5, 5], [1, 30, 30, 1, 1, 1]] {
            let grid = grid(&manipulator, counts);
            let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
            let make = |hits: &Hits<'_>, made: &mut Vec<_>| {
                let row = (hits.slice, hits.row, hits.others.to_vec());
                made.extend(hits.first.iter().map(|&first| (first, row.clone())));
            };
            let progress = Progress::default();
            let take = |all: &mut Vec<Pose>, made| {
                all.extend::<Vec<_>>(made);
                Ok::<(), Cancelled>(())
            };
            let mut all = Vec::new();
            sweep.points(&progress, make, Vec::new, |made| take(&mut all, made)).unwrap();
            let row = grid.axes()[0].count;
            let numbers = runs(&sweep).into_iter().map(|(number, run)| Run {
                from: number * row + run.from,
                to: number * row + run.to,
            });
            // Intervals that touch are one run.
            let mut joined: Vec<Run> = Vec::new();
            for run in numbers {
                match joined.last_mut() {
                    Some(last) if last.to == run.from => last.to = run.to,
                    _ => joined.push(run),
                }
            }
            let mut again = Vec::new();
            let runs = joined.iter().copied().map(Ok);
            replay(&grid, runs, &progress, make, Vec::new, |made| take(&mut again, made)).unwrap();
            assert!(again == all, "{pair:?}");

            // The sweep keeps these runs itself, unless they are too many, and counts as ever.
            let (count, kept) = sweep.count_and_keep(joined.len(), &progress).unwrap();
            assert_eq!(count, sweep.count(&progress).unwrap(), "{pair:?}");
            assert!(kept.as_ref() == Some(&joined), "{pair:?}");
            if let Some(fewer) = joined.len().checked_sub(1) {
                assert_eq!(sweep.count_and_keep(fewer, &progress).unwrap(), (count, None));
            }

            // With a limit on the condition number, too.
            let length = manipulator.characteristic_length();
            if length > 0.0 && length.is_finite() {
                let limited =
                    sweep.with_limit(PoseLimit::none(length).with_condition(8.0)).unwrap();
                let (count, kept) = limited.count_and_keep(usize::MAX, &progress).unwrap();
                assert_eq!(count, limited.count(&progress).unwrap(), "{pair:?}");
                let kept = kept.unwrap().iter().map(|run| run.to - run.from).sum::<u64>();
                assert_eq!(kept, count.reachable, "{pair:?}");
            }
        }
    }
}

/// For zeros too: the sign of a range's end must not depend on the order.
#[test]
fn counts_merge_in_any_order() {
    let count = |low: f64, high: f64| Count {
        poses: 1,
        reachable: 1,
        imaginary: vec![Some([low, high]), None],
    };
    let nothing = || Count { poses: 0, reachable: 0, imaginary: vec![None; 2] };
    let parts = [count(-0.0, 0.5), count(0.0, 0.25), nothing(), count(0.0, -0.0)];
    for order in [[0, 1, 2, 3], [3, 2, 1, 0], [1, 3, 0, 2], [2, 0, 3, 1]] {
        let merged = order.into_iter().fold(nothing(), |all, i| all.merge(&parts[i]));
        assert_eq!((merged.poses, merged.reachable), (3, 3));
        let [low, high] = merged.imaginary[0].unwrap();
        assert_eq!([low.to_bits(), high.to_bits()], [0.0_f64.to_bits(), 0.5_f64.to_bits()]);
        assert_eq!(merged.imaginary[1], None);
    }
}

#[test]
fn a_shard_is_written_as_its_number_of_so_many() {
    let shard: Shard = "3/8".parse().unwrap();
    assert_eq!((shard.number(), shard.count(), shard.to_string()), (3, 8, "3/8".to_owned()));
    for wrong in ["", "3", "0/8", "9/8", "3/0", "-1/8", "3/8/2", "a/b", "1.0/2", "/"] {
        let error = wrong.parse::<Shard>().unwrap_err().to_string();
        assert!(error.contains(&format!("{wrong:?}")), "{error}");
    }
}
