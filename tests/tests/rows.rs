//! Sweeps by intervals compared with the exact predicate, pose by pose: every pair of subspaces,
//! with limits on its sliders or on all joints, on many long rows, and with limits exactly at
//! poses.

use fastrand::Rng;
use opm_core::decomposition::Decomposition;
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::{Mechanism, examples, file};
use opm_core::reach::LegBranch;
use opm_core::{Quantity, Section};
use opm_tests::height;
use opm_tests::random::{LEVEL, Options, PAIRS, mechanism, order};
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep};
use rayon::prelude::*;
use std::f64::consts::FRAC_PI_2;

/// The number of poses that are decided both ways.
const POSES: u64 = 100_000_000;

/// How many poses of the grid are reachable for every leg.
fn by_predicate(manipulator: &Manipulator, grid: &Grid, modes: Modes) -> u64 {
    if !manipulator.lifts_straight() || !manipulator.dependent_coordinates().is_empty() {
        return by_solutions(manipulator, grid, modes);
    }
    let mode = match modes {
        Modes::One(mode) => Some(mode),
        Modes::Any => None,
    };
    let lower = grid.lower();
    let in_slice = grid.poses() / grid.slices();
    let mut count = 0;
    for slice in 0..grid.slices() {
        let reach = manipulator.reach();
        let b = manipulator.task().upper(&grid.pose(slice * in_slice)[lower..]);
        let legs: Vec<Vec<LegBranch>> = (0..manipulator.legs())
            .map(|leg| {
                let mut ways = Vec::new();
                reach.leg_branches(leg, &b, mode, &mut ways);
                ways
            })
            .collect();
        count += (0..in_slice)
            .into_par_iter()
            .filter(|i| {
                let pose = grid.pose(slice * in_slice + i);
                let v = manipulator.task().lower(&pose[..lower]);
                let within = |section, values: &[f64]| height::within(manipulator, section, values);
                within(Section::Lower, &pose[..lower])
                    && within(Section::Upper, &pose[lower..])
                    && legs.iter().all(|ways| ways.iter().any(|way| reach.reaches(way, &v)))
            })
            .count() as u64;
    }
    count
}

/// The same by the solutions of whole poses.
fn by_solutions(manipulator: &Manipulator, grid: &Grid, modes: Modes) -> u64 {
    let memory = || (manipulator.all_modes(), manipulator.solution());
    let poses = (0..grid.poses()).into_par_iter().map_init(memory, |(all, solution), number| {
        let pose = grid.pose(number);
        match modes {
            Modes::One(mode) => {
                let found = manipulator.inverse(&pose, mode, solution).unwrap();
                found.is_some_and(Solution::within_limits)
            }
            Modes::Any => {
                let found = manipulator.inverse_all(&pose, all).unwrap();
                found.is_some_and(|all| all.within_limits_in_any(manipulator, |_, _| {}))
            }
        }
    });
    poses.filter(|reached| *reached).count() as u64
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

/// Frees all upper joints. A leg with an imaginary joint is then independent of the slice, if its
/// upper joints always close.
fn with_free_upper_sections(mut mechanism: Mechanism, decomposition: &Decomposition) -> Mechanism {
    for (leg, split) in mechanism.legs.iter_mut().zip(&decomposition.legs) {
        for freedom in &split.upper {
            let joint = &mut leg.joints[freedom.joint];
            joint.actuated = false;
            joint.coordinates[freedom.index].limits = None;
        }
    }
    mechanism
}

#[test]
fn intervals_hold_the_poses_that_the_chains_reach() {
    let mut rng = Rng::with_seed(20);
    let (mut poses, mut reachable, mut partly, mut round) = (0, 0, 0, 0);
    while poses < POSES {
        let pair = LEVEL[round % LEVEL.len()];
        let options = Options { limited: [0.0, 0.3, 0.7, 1.0][rng.usize(..4)], balls: rng.bool() };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let mechanism = match rng.u8(..3) {
            0 => without_limits_on_angles(mechanism),
            1 => with_free_upper_sections(mechanism, &decomposition),
            _ => mechanism,
        };
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let counts = [50 + rng.u64(..1500), 20 + rng.u64(..200), 1, 1, 1, 1];
        let axes = manipulator.task_coordinates().iter().zip(counts).map(|(c, count)| {
            // Several revolutions for angles.
            let most = if rng.u8(..4) == 0 { 10.0 } else { 2.0 };
            let (below, above) = (rng.f64() * most, rng.f64() * most);
            match count {
                1 => Axis::fixed(c.name, c.home + (above - below) / most),
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

/// Rows so coarse that a hole, or all that is out of reach, lies between two poses. What a leg reaches may differ on both
/// sides, though none of its joints is at a limit in between.
#[test]
fn coarse_rows_are_no_exception() {
    let mut rng = Rng::with_seed(27);
    let mut partly = 0;
    for round in 0..3000 {
        let pair = LEVEL[round % LEVEL.len()];
        let options = Options { limited: rng.f64(), balls: false };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let counts = [2 + rng.u64(..8), 1 + rng.u64(..40), 1 + rng.u64(..4), 2, 1, 1];
        let axes = manipulator.task_coordinates().iter().zip(counts).map(|(c, count)| {
            let (below, above) = (3.0 * rng.f64(), 3.0 * rng.f64());
            match count {
                1 => Axis::fixed(c.name, c.home + 0.1 * (above - below)),
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
        partly += u32::from(count > 0 && count < grid.poses());
    }
    assert!(partly > 500, "{partly}");
}

/// The shipped mechanisms have round dimensions, so limits, boundaries and holes coincide with
/// poses.
#[test]
fn round_numbers_are_no_exception() {
    for example in examples::SPLIT {
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

/// Joints are exactly at their limits in poses of the grid. A value on a limit counts as inside,
/// whichever way it is decided.
#[test]
fn limits_that_lie_on_poses_are_no_exception() {
    let mut rng = Rng::with_seed(21);
    let mut met = 0;
    for round in 0..200 {
        let pair = LEVEL[round % LEVEL.len()];
        let options = Options { limited: 0.0, balls: false };
        let (mut mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let free = Manipulator::with_decomposition(mechanism.clone(), decomposition.clone());
        let free = free.unwrap();
        let axes = free.task_coordinates().iter().zip([41, 9, 3, 3, 3, 2]).map(|(c, count)| {
            Axis::new(c.name, c.home - rng.f64() - 0.1, c.home + rng.f64() + 0.1, count)
        });
        let axes: Vec<_> = axes.collect();
        let grid = Grid::new(&free, axes.clone()).unwrap();
        let mut solution = free.solution();
        let reached: Vec<Vec<f64>> = (0..200)
            .filter_map(|_| {
                let pose = grid.pose(rng.u64(..grid.poses()));
                let reached =
                    free.inverse(&pose, free.home_mode(), &mut solution).unwrap().is_some();
                reached.then(|| solution.joints().to_vec())
            })
            .take(2)
            .collect();
        let [one, other] = &reached[..] else { continue };
        let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
        for (i, coordinate) in joints.flat_map(|joint| &mut joint.coordinates).enumerate() {
            if rng.u8(..3) > 0 {
                coordinate.limits = Some([one[i].min(other[i]), one[i].max(other[i])]);
            }
        }
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let grid = Grid::new(&manipulator, axes).unwrap();
        for modes in [Modes::Any, Modes::One(manipulator.home_mode())] {
            let sweep = Sweep::new(&manipulator, &grid, modes);
            let count = sweep.count(&Progress::default()).unwrap();
            let expected = by_predicate(&manipulator, &grid, modes);
            assert_eq!(count.reachable, expected, "round {round}: {pair:?} {modes:?}");
            met += expected;
        }
    }
    println!("{met} poses");
    assert!(met > 10_000);
}

/// Rings whose holes overlap in a row: what both holes remove is removed once.
#[test]
fn holes_overlap() {
    let mut rng = Rng::with_seed(22);
    let (mut judged, mut reachable) = (0, 0);
    while judged < 150 {
        let pair = [PAIRS[0], PAIRS[3]][judged % 2];
        let (mechanism, decomposition) =
            mechanism(&mut rng, pair, Options { limited: 0.0, balls: false });
        let legs = mechanism.legs.iter().zip(&decomposition.legs);
        if !legs.into_iter().all(|(leg, split)| ["RRR", "RR"].contains(&&*order(leg, &split.lower)))
        {
            continue;
        }
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let axes = manipulator.task_coordinates().iter().zip([200, 50, 1, 1, 1]);
        let axes = axes.map(|(c, count)| match count {
            1 => Axis::fixed(c.name, c.home + rng.f64() - 0.5),
            _ => Axis::new(c.name, c.home - 1.5, c.home + 1.5, count),
        });
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let modes = Modes::One(manipulator.home_mode());
        let count = Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap();
        let expected = by_predicate(&manipulator, &grid, modes);
        assert_eq!(count.reachable, expected, "{judged}: {pair:?}");
        judged += 1;
        reachable += expected;
    }
    println!("{reachable} poses");
}

/// Legs that are independent of the slice, in one of two ways.
#[test]
fn legs_independent_of_the_slice_are_joined() {
    let mut rng = Rng::with_seed(25);
    let (mut judged, mut reachable) = (0, 0);
    while judged < 60 {
        let pair = PAIRS[0];
        let options = Options { limited: 0.7, balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let mechanism =
            without_limits_on_angles(with_free_upper_sections(mechanism, &decomposition));
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let home = manipulator.home_pose();
        let lower = manipulator.task().lower_count;
        let [v, b] =
            [manipulator.task().lower(&home[..lower]), manipulator.task().upper(&home[lower..])];
        let differ = (0..manipulator.legs()).any(|leg| {
            let mut ways = Vec::new();
            manipulator.reach().leg_branches(leg, &b, None, &mut ways);
            let regions: Vec<_> =
                ways.iter().filter_map(|way| manipulator.reach().region(way, &v, 1.0)).collect();
            ways[0].is_independent_of_slice() && regions.iter().any(|region| region != &regions[0])
        });
        if !differ {
            continue;
        }
        let axes = manipulator.task_coordinates().iter().zip([101, 51, 2, 2, 2]);
        let axes = axes.map(|(c, count)| Axis::new(c.name, c.home - 1.5, c.home + 1.5, count));
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let count =
            Sweep::new(&manipulator, &grid, Modes::Any).count(&Progress::default()).unwrap();
        let expected = by_predicate(&manipulator, &grid, Modes::Any);
        assert_eq!(count.reachable, expected, "{judged}");
        judged += 1;
        reachable += expected;
    }
    println!("{reachable} poses");
    assert!(reachable > 0);
}

/// Limits of a link that slides, in steps of an eighth of a turn: where the link is along or across its slide, and with
/// poses exactly there.
#[test]
fn limits_across_and_along_a_slide_are_no_exception() {
    let eighth = f64::to_radians(45.0);
    let mut partly = 0;
    for first_is_slider in [true, false] {
        for reversed in [false, true] {
            for (low, high) in (-8..8).flat_map(|low| (low..=low + 8).map(move |high| (low, high)))
            {
                for limited in 0..2 {
                    let axis = if reversed { -1 } else { 1 };
                    let limits = format!(
                        "limits = [{}, {}], home = {}",
                        f64::from(low) * 45.0,
                        f64::from(high) * 45.0,
                        f64::from(low + high) * 22.5
                    );
                    let limits = [&*limits, "home = 0"];
                    let revolute = |name: &str, x: f64, limits: &str| {
                        format!(
                            "{{ name = \"{name}\", type = \"revolute\", axis = [0, 0, {axis}], \
                             point = [{x}, 0, 0], {limits} }}"
                        )
                    };
                    let slider =
                        "{ name = \"s\", type = \"prismatic\", axis = [1, 0, 0], actuated = true }"
                            .to_owned();
                    // The link is along the slide at home.
                    let mut joints = vec![
                        revolute("a", 0.0, limits[limited]),
                        revolute("b", 0.5, limits[1 - limited]),
                    ];
                    joints.insert(if first_is_slider { 0 } else { 2 }, slider);
                    let manipulator = Manipulator::read(&format!(
                        "format = 1\nname = \"slide\"\nunits = {{ length = \"m\", angle = \"deg\" }}\n\
                         [platform]\npoint = [0.5, 0, 0]\n[[leg]]\nname = \"one\"\njoints = [\n{}\n]\n\
                         [[leg]]\nname = \"two\"\njoints = [\n\
                         {{ name = \"X2\", type = \"prismatic\", axis = [1, 0, 0], actuated = true }},\n\
                         {{ name = \"Y2\", type = \"prismatic\", axis = [0, 1, 0], actuated = true }},\n\
                         {{ name = \"R2\", type = \"revolute\", axis = [0, 0, 1], point = [0, 0, 0], \
                         actuated = true }},\n]\n",
                        joints.join(",\n")
                    ))
                    .unwrap();
                    let axes = vec![
                        Axis::new("x", -0.25, 1.25, 13),
                        Axis::new("y", -0.5, 0.5, 9),
                        Axis::new("theta", -4.0 * eighth, 4.0 * eighth, 9),
                    ];
                    let grid = Grid::new(&manipulator, axes).unwrap();
                    for mode in manipulator.modes().map(Modes::One).chain([Modes::Any]) {
                        let count = Sweep::new(&manipulator, &grid, mode)
                            .count(&Progress::default())
                            .unwrap()
                            .reachable;
                        let expected = by_predicate(&manipulator, &grid, mode);
                        assert_eq!(count, expected, "{low} {high} {limited} {reversed} {mode:?}");
                        partly += u32::from(0 < count && count < grid.poses());
                    }
                }
            }
        }
    }
    println!("{partly} grids in part");
    assert!(partly > 500);
}

/// Grids so fine that rounding decides about poses at the boundary: rows in doubt are decided by
/// the chains.
#[test]
fn fine_grids_are_no_exception() {
    const STEP: f64 = 1e-10;
    let mut rng = Rng::with_seed(23);
    let mut judged = 0;
    for round in 0..2000 {
        let pair = [PAIRS[0], PAIRS[3], PAIRS[7], PAIRS[8], PAIRS[10]][round % 5];
        let options = Options { limited: 0.3, balls: false };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let mechanism = without_limits_on_angles(mechanism);
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let modes = Modes::One(manipulator.home_mode());
        let mut pose = manipulator.home_pose();
        pose.iter_mut().for_each(|q| *q += rng.f64() - 0.5);
        let mut solution = manipulator.solution();
        let mut reached = |x: f64| {
            pose[0] = x;
            manipulator.inverse(&pose, manipulator.home_mode(), &mut solution).unwrap().is_some()
                && solution.within_limits()
        };
        let home = manipulator.task_coordinates()[0].home;
        let [mut within, mut out] = [home + rng.f64() - 0.5, home + 3.0 * (rng.f64() - 0.5)];
        if !reached(within) || reached(out) {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (within + out);
            *(if reached(middle) { &mut within } else { &mut out }) = middle;
        }
        pose[0] = within;
        let axes = manipulator.task_coordinates().iter().zip(&pose).enumerate();
        let axes = axes.map(|(i, (c, &at))| {
            let half = STEP * [10.0, 400.0, 0.0, 0.0, 0.0][i] * (1.0 + rng.f64());
            match i {
                0 => Axis::new(c.name, at - half, at + half, 21),
                1 => Axis::new(c.name, at - half, at + half, 801),
                _ => Axis::fixed(c.name, at),
            }
        });
        let grid = Grid::new(&manipulator, axes.collect()).unwrap();
        let count = Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap();
        let expected = by_predicate(&manipulator, &grid, modes);
        assert_eq!(count.reachable, expected, "round {round}: {pair:?}");
        judged += 1;
    }
    println!("{judged} grids");
    assert!(judged > 300);
}

/// Rows that touch the boundary of a ring in a pose, to the last digits: the root that gives the
/// row's ends is then only rounding, so the chains decide.
#[test]
fn rows_that_touch_a_boundary_are_no_exception() {
    const STEP: f64 = 1e-4;
    /// Rows on both sides of the boundary.
    const ROWS: f64 = 40.0;
    let mut rng = Rng::with_seed(24);
    let (mut judged, mut parted, mut independent) = (0, 0, 0);
    for round in 0..3000 {
        let pair = [PAIRS[0], PAIRS[3]][round % 2];
        let options = Options { limited: 0.0, balls: true };
        let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
        let mechanism = with_free_upper_sections(mechanism, &decomposition);
        let rings: Vec<usize> = (0..mechanism.legs.len())
            .filter(|&leg| {
                let split = &decomposition.legs[leg];
                ["RRR", "RR"].contains(&&*order(&mechanism.legs[leg], &split.lower))
            })
            .collect();
        let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
        let mode = manipulator.home_mode();
        let mut pose = manipulator.home_pose();
        pose.iter_mut().for_each(|q| *q += 0.2 * (rng.f64() - 0.5));
        let lower = manipulator.task().lower_count;
        let b = manipulator.task().upper(&pose[lower..]);
        for leg in rings {
            let mut ways = Vec::new();
            manipulator.reach().leg_branches(leg, &b, Some(mode), &mut ways);
            let [way] = &ways[..] else { continue };
            let closes = |[x, y]: [f64; 2]| -> bool {
                let mut v = pose[..lower].to_vec();
                [v[0], v[1]] = [x, y];
                manipulator.reach().reaches(way, &manipulator.task().lower(&v))
            };
            let Some([middle, high]) = top(closes, [pose[0], pose[1]]) else { continue };
            // At a pose above the centre, or beside it by less than a step.
            let beside = if rng.bool() { 0.0 } else { STEP * 10f64.powf(-4.0 * rng.f64()) };
            let x = middle + beside;
            let [_, y] = edge(closes, [x, high - NEAR], [x, high + NEAR]);
            let half = ROWS * f64::EPSILON * y.abs().max(0.1);
            let axes = manipulator.task_coordinates().iter().zip(&pose).enumerate();
            let axes = axes.map(|(i, (c, &at))| match i {
                0 => Axis::new(c.name, x - 10.0 * STEP, x + 10.0 * STEP, 21),
                1 => Axis::new(c.name, y - half, y + half, 2 * ROWS as u64 + 1),
                _ => Axis::fixed(c.name, at),
            });
            let grid = Grid::new(&manipulator, axes.collect()).unwrap();
            let modes = Modes::One(mode);
            let count = Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap();
            let expected = by_predicate(&manipulator, &grid, modes);
            assert_eq!(count.reachable, expected, "round {round}: {pair:?}, leg {leg}");
            judged += 1;
            let part = 0 < expected && expected < grid.poses();
            parted += u32::from(part);
            independent += u32::from(part && way.is_independent_of_slice());
        }
    }
    println!(
        "{judged} grids, {parted} of them in part, {independent} with legs independent of the slice"
    );
    assert!(parted > 400 && independent > 70, "{parted} and {independent} of {judged}");
}

/// How near the highest point of a disc is approximated before it is searched for.
const NEAR: f64 = 1e-6;

/// The last point inside, between a point inside and one outside.
fn edge(within: impl Fn([f64; 2]) -> bool, mut inner: [f64; 2], mut outer: [f64; 2]) -> [f64; 2] {
    for _ in 0..100 {
        let middle = [0.5 * (inner[0] + outer[0]), 0.5 * (inner[1] + outer[1])];
        *(if within(middle) { &mut inner } else { &mut outer }) = middle;
    }
    inner
}

/// The highest point of a disc that contains a point, from two of its chords; `None` if these do
/// not belong to one disc, for instance at a hole.
fn top(within: impl Fn([f64; 2]) -> bool, [x, y]: [f64; 2]) -> Option<[f64; 2]> {
    const BEYOND: f64 = 20.0;
    /// Between two chords.
    const APART: f64 = 0.05;
    let chord = |y: f64| {
        let ends = [-BEYOND, BEYOND].map(|to| edge(&within, [x, y], [x + to, y])[0]);
        within([x, y]).then_some([0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])])
    };
    let ([middle, half], [again, other]) = (chord(y)?, chord(y + APART)?);
    let up = (other * other - half * half + APART * APART) / (2.0 * APART);
    let top = y + up + half.hypot(up);
    let one_disc = (middle - again).abs() < 1e-9;
    let found = one_disc && within([middle, top - NEAR]) && !within([middle, top + NEAR]);
    found.then_some([middle, top])
}

/// Rows that run along the edge of a region, or nearly so: a slider of the shipped mechanism has
/// the direction of the rows, up to a small tilt.
#[test]
fn rows_along_an_edge_are_no_exception() {
    const STEP: f64 = 1e-4;
    const ROWS: f64 = 40.0;
    let mut rng = Rng::with_seed(25);
    let text = examples::find("plano-spherical-5dof").unwrap().text;
    let family = file::read(text).unwrap().family.unwrap();
    let (mut judged, mut parted) = (0, 0);
    for round in 0..400 {
        let tilt = if round % 4 == 0 { 0.0 } else { 10f64.powf(-5.0 - 8.0 * rng.f64()) };
        let alpha = ParameterValue::Number(FRAC_PI_2 + tilt);
        // A slider without limits sweeps a whole band, otherwise half a band with a blunt end.
        let ends =
            if rng.bool() { ParameterValue::None } else { ParameterValue::Pair([-0.3, 0.3]) };
        let family = family.with([("leg3.alpha", alpha), ("leg3.limits.S", ends)]).unwrap();
        let manipulator = Manipulator::new(family.assemble().unwrap()).unwrap();
        let mut pose = manipulator.home_pose();
        pose.iter_mut().for_each(|q| *q += 0.2 * (rng.f64() - 0.5));
        let modes = Modes::One(manipulator.home_mode());
        let b = manipulator.task().upper(&pose[2..]);
        let mut ways = Vec::new();
        manipulator.reach().leg_branches(2, &b, modes.one(), &mut ways);
        let [way] = &ways[..] else { continue };
        let within =
            |at: [f64; 2]| manipulator.reach().reaches(way, &manipulator.task().lower(&at));
        let [x, y] = [pose[0], pose[1]];
        for beyond in [y - 5.0, y + 5.0] {
            if !within([x, y]) || within([x, beyond]) {
                continue;
            }
            let [_, y] = edge(within, [x, y], [x, beyond]);
            let half = (ROWS * f64::EPSILON * 0.1).max(10.0 * STEP * tilt);
            let axes = manipulator.task_coordinates().iter().zip(&pose).enumerate();
            let axes = axes.map(|(i, (c, &at))| match i {
                0 => Axis::new(c.name, at - 10.0 * STEP, at + 10.0 * STEP, 21),
                1 => Axis::new(c.name, y - half, y + half, 2 * ROWS as u64 + 1),
                _ => Axis::fixed(c.name, at),
            });
            let grid = Grid::new(&manipulator, axes.collect()).unwrap();
            let count = Sweep::new(&manipulator, &grid, modes).count(&Progress::default()).unwrap();
            let expected = by_predicate(&manipulator, &grid, modes);
            assert_eq!(count.reachable, expected, "round {round}: tilt {tilt:e}");
            judged += 1;
            parted += u32::from(0 < expected && expected < grid.poses());
        }
    }
    println!("{judged} grids, {parted} of them in part");
    assert!(parted > 150, "{parted} of {judged}");
}
