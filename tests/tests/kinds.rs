//! Kinds of workspace: sections are compared with the whole, visits with one inverse-kinematics
//! call per pose.

use fastrand::Rng;
use nalgebra::{Matrix3, Vector3};
use opm_core::Section;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::reach::LegBranch;
use opm_core::task::{TaskCoordinate, euler};
use opm_tests::by_inverse::by_inverse;
use opm_tests::height;
use opm_tests::random::{LEVEL, Options, PAIRS, mechanism};
use opm_workspace::{
    Axis, Components, ConditioningIndex, Grid, GridSet, Modes, Progress, Sections, Sweep, Visits,
};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;

fn shipped(name: &str) -> Manipulator {
    Manipulator::example(name).unwrap()
}

fn reached(sweep: &Sweep<'_>) -> GridSet {
    GridSet::reached(sweep, &Progress::default()).unwrap()
}

/// Every working mode.
fn all_modes(manipulator: &Manipulator) -> Vec<Mode> {
    let signs = |bits: u32| -> String {
        let sign = |choice| if bits >> choice & 1 == 0 { '+' } else { '-' };
        (0..manipulator.choices()).map(sign).collect()
    };
    let modes = (0..1 << manipulator.choices()).map(signs);
    modes.map(|signs| manipulator.parse_mode(&signs).unwrap()).collect()
}

/// Whether both sections alone reach a pose: the upper one `b` with some values of the imaginary
/// joints, and the lower one `v` with the same values.
fn sections_meet(manipulator: &Manipulator, pose: &[f64], mode: Option<Mode>) -> bool {
    let task = manipulator.task();
    if !manipulator.lifts_straight() {
        let raised = manipulator.reach().raised(task.rise(pose));
        return raised.is_some_and(|raised| sections_meet(&raised, pose, mode));
    }
    let (v, b) = (task.lower(pose), task.upper(&pose[task.lower_count..]));
    if !height::within(manipulator, Section::Lower, pose)
        || !height::within(manipulator, Section::Upper, &pose[task.lower_count..])
    {
        return false;
    }
    let (reach, mut ways) = (manipulator.reach(), Vec::<LegBranch>::new());
    if !reach.upper_closes(&b, mode, &mut ways) {
        return false;
    }
    // No two legs share an imaginary joint or a choice.
    (0..manipulator.legs()).all(|leg| {
        ways.clear();
        reach.leg_branches(leg, &b, mode, &mut ways);
        let mut taus: Vec<f64> =
            ways.iter().filter_map(LegBranch::intersection_displacement).collect();
        if taus.is_empty() {
            taus.push(0.0);
        }
        taus.into_iter().any(|tau| {
            ways.clear();
            reach.lower_leg_branches(leg, tau, mode, &mut ways);
            ways.iter().any(|way| reach.reaches(way, &v))
        })
    })
}

/// The paper's Discussion: the whole workspace is where its two sections agree on the imaginary
/// joints.
#[test]
fn the_whole_is_what_both_sections_reach() {
    let mut rng = Rng::with_seed(50);
    let (mut whole, mut poses, mut undecided, mut both) = (0, 0, 0, 0);
    for round in 0..40 {
        for &pair in LEVEL {
            let limited = if round % 2 == 0 { 0.0 } else { 0.3 };
            let options = Options { limited, balls: round % 3 != 0 };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let mut all = manipulator.all_modes();
            let mut solution = manipulator.solution();
            let modes = all_modes(&manipulator);
            for _ in 0..30 {
                let pose: Vec<f64> = (manipulator.task_coordinates().iter())
                    .map(|c| c.home + 1.2 * (rng.f64() - rng.f64()))
                    .collect();
                manipulator.inverse_all(&pose, &mut all).unwrap();
                let mut any = false;
                for &mode in &modes {
                    let reached = manipulator.solution_in_mode(&all, mode, &mut solution).is_some()
                        && solution.within_limits();
                    let meet = sections_meet(&manipulator, &pose, Some(mode));
                    any |= reached;
                    assert!(meet || !reached, "{pair:?} {pose:?} {mode:?}");
                    if manipulator.workspace_factorises() {
                        assert_eq!(meet, reached, "{pair:?} {pose:?} {mode:?}");
                    } else {
                        undecided += u32::from(meet && !reached);
                    }
                    whole += u32::from(reached);
                    both += u32::from(meet);
                    poses += 1;
                }
                let meet = sections_meet(&manipulator, &pose, None);
                if manipulator.workspace_factorises() {
                    assert_eq!(meet, any, "{pair:?} {pose:?}");
                } else {
                    assert!(meet || !any, "{pair:?} {pose:?}");
                }
            }
        }
    }
    println!("{whole} of {poses} reached, {both} in both sections, {undecided} in these alone");
    assert!(whole > 10_000 && both < poses / 2 && undecided > 100);
}

/// The lower section alone as a grid with its imaginary joints as axes, compared with each leg
/// alone.
#[test]
fn a_grid_of_the_lower_section_has_its_imaginary_joints_as_axes() {
    let mut rng = Rng::with_seed(51);
    let (mut poses, mut partly) = (0, 0);
    for round in 0..30 {
        for &pair in LEVEL {
            let options = Options { limited: 0.2, balls: round % 3 != 0 };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let lower = manipulator.task().lower_count;
            let coordinates = Sections::Lower.coordinates(&manipulator);
            let axes = coordinates.iter().enumerate().map(|(i, c)| {
                let (below, above) = (rng.f64() * 1.5, rng.f64() * 1.5);
                Axis::new(&*c.name, c.home - below, c.home + above, if i < lower { 7 } else { 2 })
            });
            let grid = Grid::of(Sections::Lower, &manipulator, axes.collect()).unwrap();
            let modes = match rng.u8(..2) {
                0 => Modes::Any,
                _ => Modes::One(manipulator.home_mode()),
            };
            let set = reached(&Sweep::new(&manipulator, &grid, modes));
            let cuts = manipulator.reach().intersection_joints();
            for number in 0..grid.poses() {
                let pose = grid.pose(number);
                let v = manipulator.task().lower(&pose);
                let admitted = height::within(&manipulator, Section::Lower, &pose);
                let rise = manipulator.task().rise_in(Section::Lower, &pose[..lower]);
                let raised = manipulator.reach().raised(rise.unwrap_or(0.0));
                let expected = admitted
                    && raised.as_ref().is_some_and(|manipulator| {
                        let reach = manipulator.reach();
                        (0..manipulator.legs()).all(|leg| {
                            let cut = cuts.iter().position(|cut| cut.leg == leg);
                            let tau = cut.map_or(0.0, |i| cuts[i].displacement(pose[lower + i]));
                            let mut ways = vec![];
                            reach.lower_leg_branches(leg, tau, modes.one(), &mut ways);
                            ways.iter().any(|way| reach.reaches(way, &v))
                        })
                    });
                assert_eq!(set.contains(number), expected, "{pair:?} {pose:?}");
            }
            poses += grid.poses();
            partly += u32::from(set.count() > 0 && set.count() < grid.poses());
        }
    }
    println!("{poses} poses, {partly} grids in part");
    assert!(partly > 200);
}

/// The upper section alone: its imaginary joints have the same ranges as in the whole, where the
/// lower section allows all of them.
#[test]
fn the_upper_section_of_the_paper_reaches_three_caps_less_than_all_orientations() {
    let manipulator = shipped("plano-spherical-5dof");
    let axes = vec![
        Axis::new("zeta", -PI, PI, 73),
        Axis::new("xi", 0.0, PI, 61),
        Axis::new("psi", -PI, PI, 73),
    ];
    let grid = Grid::of(Sections::Upper, &manipulator, axes).unwrap();
    let sweep = Sweep::new(&manipulator, &grid, Modes::Any);
    let set = reached(&sweep);
    assert_eq!(set.count(), sweep.count(&Progress::default()).unwrap().reachable);
    // A leg closes where its platform axis w is more than 30 degrees from -z (data/reference).
    let (mut ties, mut inside) = (0, 0);
    for number in 0..grid.poses() {
        let pose = grid.pose(number);
        let rotation: Matrix3<f64> = euler(pose[0], pose[1], pose[2]);
        let height = [0.0_f64, 120.0, 240.0].map(|eta| {
            let (s, c) = eta.to_radians().sin_cos();
            let tilt = 60_f64.to_radians().sin();
            -(rotation * Vector3::new(tilt * c, tilt * s, 0.5)).z
        });
        let highest = height.into_iter().fold(f64::MIN, f64::max) - 30_f64.to_radians().cos();
        if highest.abs() < 1e-9 {
            ties += 1;
            continue;
        }
        assert_eq!(set.contains(number), highest < 0.0, "{pose:?}");
        inside += u32::from(highest < 0.0);
    }
    println!("{inside} inside, {ties} ties");
    assert!(inside > 100_000 && ties < 20_000);
    // All orientations except three caps form one component.
    assert_eq!(Components::new(&set).sizes().len(), 1);
}

#[test]
fn visits_are_orientations_that_reach_a_place() {
    let mut rng = Rng::with_seed(52);
    let mut several = 0;
    for _ in 0..20 {
        for pair in PAIRS {
            let (mechanism, decomposition) =
                mechanism(&mut rng, pair, Options { limited: 0.1, balls: true });
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            // Lengths are the place where all legs move in one subspace; on a cylinder they come last.
            let places = manipulator.place_coordinates();
            let axes = manipulator.task_coordinates().iter().enumerate().map(|(i, c)| {
                let half = if places.contains(&i) { 1.0 } else { 0.3 };
                Axis::new(
                    c.name,
                    c.home - half,
                    c.home + half,
                    if places.contains(&i) { 8 } else { 3 },
                )
            });
            let grid = Grid::new(&manipulator, axes.collect()).unwrap();
            let modes = match rng.u8(..2) {
                0 => Modes::Any,
                _ => Modes::One(manipulator.home_mode()),
            };
            let mut expected: HashMap<Vec<u64>, u64> = HashMap::new();
            for pose in by_inverse(&manipulator, &grid, modes).0 {
                let place = pose[places.clone()].iter().map(|value| value.to_bits()).collect();
                *expected.entry(place).or_default() += 1;
            }
            let sweep = Sweep::new(&manipulator, &grid, modes);
            let count = || Visits::new(&sweep, &Progress::default()).unwrap();
            let threads = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
            let visits = threads(1).install(count);
            assert_eq!(visits, threads(5).install(count));
            let [reachable, dexterous] =
                [visits.reachable(), visits.dexterous()].map(Result::unwrap);
            for (place, &found) in visits.counts().iter().enumerate() {
                let at =
                    reachable.point(place as u64).iter().map(|value| value.to_bits()).collect();
                let expected = expected.get::<Vec<u64>>(&at).copied().unwrap_or(0);
                assert_eq!(found, expected, "{pair:?}");
                assert_eq!(reachable.contains(place as u64), expected > 0);
                assert_eq!(dexterous.contains(place as u64), expected == visits.orientations());
                several += u32::from(expected > 1 && expected < visits.orientations());
            }
            let orientations = manipulator.orientation_coordinates().len() as u32;
            assert_eq!(visits.orientations(), 3_u64.pow(orientations));
            let mut twice = visits.clone();
            twice.merge(&visits).unwrap();
            assert!(twice.counts().iter().zip(visits.counts()).all(|(two, one)| *two == 2 * one));
        }
    }
    assert!(several > 1000, "{several}");
}

/// Where all legs move in one subspace, lengths are the place and angles the orientation. Every kind is compared
/// with inverse kinematics of each pose.
#[test]
fn kinds_of_one_subspace_are_reductions_of_its_poses() {
    use opm_study::{PosePart, WorkspaceKind as Kind, WorkspaceRequest};
    let progress = Progress::default();
    let (mut partly, mut refused) = (0, 0);
    for (name, places) in
        [("planar-3rrr", 2), ("planar-3rpr", 2), ("agile-eye", 0), ("five-bar", 2)]
    {
        let m = Arc::new(shipped(name));
        let coordinates = m.task_coordinates();
        let axis = |(i, c): (usize, &TaskCoordinate)| {
            let (half, count) = if i < places { (0.09, 13) } else { (0.7, 8) };
            Axis::new(c.name, c.home - half, c.home + 0.8 * half, count)
        };
        let all: Vec<Axis> = coordinates.iter().enumerate().map(axis).collect();
        for modes in [Modes::Any, Modes::One(m.home_mode())] {
            let poses = by_inverse(&m, &Grid::new(&m, all.clone()).unwrap(), modes).0;
            let analyse = |kind, axes: &[Axis]| {
                let request =
                    axes.iter().cloned().fold(WorkspaceRequest::new(kind), WorkspaceRequest::axis);
                request.modes(modes).resolve(Arc::clone(&m), &progress)?.analyse(&progress)
            };
            let count = |set: &GridSet| (set.count(), set.points());
            for kind in [Kind::Reachable, Kind::Dexterous] {
                let Ok(found) = analyse(kind, &all) else {
                    refused += 1;
                    assert!(name == "agile-eye" || (name, kind) == ("five-bar", Kind::Dexterous));
                    continue;
                };
                let orientations: u64 = all[places..].iter().map(|axis| axis.count).product();
                let needed = if kind == Kind::Dexterous { orientations } else { 1 };
                let mut expected: HashMap<Vec<u64>, u64> = HashMap::new();
                for pose in &poses {
                    let place = pose[..places].iter().map(|value| value.to_bits()).collect();
                    *expected.entry(place).or_default() += 1;
                }
                let set = found.set.unwrap();
                assert_eq!(found.visits.unwrap().orientations(), orientations);
                for number in 0..set.points() {
                    let at: Vec<u64> = set.point(number).iter().map(|v| v.to_bits()).collect();
                    let visits = expected.get(&at).copied().unwrap_or(0);
                    assert_eq!(set.contains(number), visits >= needed, "{name} {kind} {at:?}");
                }
                partly += u32::from(set.count() > 0 && set.count() < set.points());
            }
            for kind in [Kind::ConstantOrientation, Kind::Orientation] {
                let held = |i: usize| (i < places) == (kind == Kind::Orientation);
                let third = |axis: &Axis| Axis::fixed(&*axis.name, axis.value(axis.count / 3));
                let axes: Vec<Axis> = all
                    .iter()
                    .enumerate()
                    .map(|(i, axis)| if held(i) { third(axis) } else { axis.clone() })
                    .collect();
                match analyse(kind, &axes) {
                    Ok(found) => {
                        let set = found.set.unwrap();
                        let grid = Grid::new(&m, axes).unwrap();
                        let expected = by_inverse(&m, &grid, modes).0.len() as u64;
                        assert_eq!(count(&set), (expected, grid.poses()), "{name} {kind}");
                        partly += u32::from(expected > 0 && expected < grid.poses());
                    }
                    Err(_) => {
                        refused += 1;
                        assert!(
                            name == "five-bar"
                                || (name, kind) == ("agile-eye", Kind::ConstantOrientation)
                        );
                    }
                }
            }
        }
        assert_eq!(
            Kind::Orientation.missing_part(&m),
            (name == "five-bar").then_some(PosePart::Orientation)
        );
    }
    // Of both modes: the Agile Eye has no place, and the five-bar's orientation follows from it.
    assert_eq!(refused, 2 * (3 + 3));
    assert!(partly > 12, "{partly}");
}

/// The global conditioning index is the mean of the values by one call per pose, with any number of
/// threads.
#[test]
fn the_global_index_is_the_mean_of_the_local_ones() {
    let manipulator = shipped("plano-spherical-5dof");
    let axes = vec![
        Axis::new("x", -0.1, 0.1, 5),
        Axis::new("y", -0.1, 0.1, 4),
        Axis::new("zeta", -0.3, 0.3, 3),
        Axis::new("xi", 0.0, 1.0, 3),
        Axis::fixed("psi", 0.2),
    ];
    let grid = Grid::new(&manipulator, axes).unwrap();
    let mode = manipulator.home_mode();
    let length = 0.07;
    let (mut solution, mut jacobians) = (manipulator.solution(), manipulator.jacobians());
    let (reached, _) = by_inverse(&manipulator, &grid, Modes::One(mode));
    let local: Vec<f64> = reached
        .iter()
        .map(|pose| {
            assert!(manipulator.inverse(pose, mode, &mut solution).unwrap().is_some());
            manipulator.differentiate(&solution, &mut jacobians).unwrap();
            manipulator.conditioning(&jacobians, length).condition.recip()
        })
        .collect();
    let sweep = Sweep::new(&manipulator, &grid, Modes::One(mode));
    let index = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| ConditioningIndex::of(&sweep, length, &Progress::default()).unwrap())
    };
    let found = index(1);
    assert_eq!(found, index(3));
    assert_eq!(found.poses, local.len() as u64);
    assert!(local.len() > 50);
    let mean = local.iter().sum::<f64>() / local.len() as f64;
    assert!((found.global().unwrap() - mean).abs() < 1e-14 * local.len() as f64);
    assert_eq!(found.min, local.iter().copied().fold(f64::MAX, f64::min));
    assert_eq!(found.max, local.iter().copied().fold(0.0, f64::max));
}
