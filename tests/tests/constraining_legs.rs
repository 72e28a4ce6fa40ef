//! Legs with too few freedoms, which tie the coordinates of the pose together, compared with the undecomposed
//! legs: at every pose and in every mode the product of exponentials of each leg brings the platform to the same
//! place, and every displacement that the constraining leg makes is found.

mod charts;

use fastrand::Rng;
use nalgebra::{DVector, Isometry3};
use opm_core::decomposition::mobility::mobility;
use opm_core::decomposition::{Decomposition, check_actuators};
use opm_core::forward::RESIDUAL;
use opm_core::manipulator::{CompileError, Manipulator, Mode, Solution};
use opm_core::mechanism::joint::{JointKind, Quantity};
use opm_core::mechanism::{Mechanism, OrientationCoordinates};
use opm_tests::by_inverse::by_inverse;
use opm_tests::differences::derivatives;
use opm_tests::random::{LACKS, Options, PAIRS, RandomSubspace, constrained};
use opm_tests::structured::gap;
use opm_workspace::{Axis, Cancelled, Count, Grid, Modes, Progress, Sweep};
use std::f64::consts::{PI, TAU};

/// The bound on closure, as a share of the size of the mechanism and of its joint values: rounding.
const CLOSURE: f64 = 1e-11;

fn options(round: usize) -> Options {
    Options { limited: 0.0, balls: round % 2 == 1 }
}

/// Compiles a mechanism; every third one has tilt and torsion in place of its Euler angles, if it has these, and every third
/// one roll, pitch and yaw.
fn compiled(
    mut mechanism: Mechanism,
    decomposition: Decomposition,
    round: usize,
) -> Result<Manipulator, CompileError> {
    let other = match round % 3 {
        0 => None,
        1 => Some(OrientationCoordinates::TiltTorsion),
        _ => Some(OrientationCoordinates::RollPitchYaw),
    };
    if let Some(other) = other {
        let plain = mechanism.task.coordinates.replace(other);
        match Manipulator::with_decomposition(mechanism.clone(), decomposition.clone()) {
            Err(error) if error.to_string().contains(other.name()) => {}
            other => return other,
        }
        mechanism.task.coordinates = plain;
    }
    Manipulator::with_decomposition(mechanism, decomposition)
}

#[test]
fn every_mode_closes_every_original_leg() {
    let mut rng = Rng::with_seed(140);
    for pair in PAIRS {
        for lacks in LACKS {
            let (mut made, mut poses, mut reached, mut solutions) = (0, 0, 0, 0);
            let mut worst = 0.0_f64;
            for round in 0..40 {
                let Some((mechanism, decomposition)) =
                    constrained(&mut rng, pair, lacks, round % 4 == 3, options(round))
                else {
                    continue;
                };
                let manipulator = match compiled(mechanism, decomposition, round) {
                    Ok(manipulator) => manipulator,
                    Err(error) => panic!("{pair:?} {lacks:?}: {error}"),
                };
                made += 1;
                assert!(!manipulator.dependent_coordinates().is_empty());
                let (mut all, mut solution) = (manipulator.all_modes(), manipulator.solution());
                let mut same = manipulator.solution();
                for _ in 0..20 {
                    let spread = 1.5 * rng.f64() * rng.f64();
                    let pose: Vec<f64> = (manipulator.task_coordinates().iter())
                        .map(|c| c.home + spread * (2.0 * rng.f64() - 1.0))
                        .collect();
                    poses += 1;
                    let any = manipulator.inverse_all(&pose, &mut all).unwrap().is_some();
                    assert_eq!(any, all.modes(&manipulator).next().is_some());
                    reached += usize::from(any);
                    for mode in all.modes(&manipulator) {
                        solutions += 1;
                        assert!(manipulator.solution_in_mode(&all, mode, &mut solution).is_some());
                        assert_eq!(solution.pose(), pose);
                        let target = solution.displacement(&manipulator);
                        let joints = solution.joints();
                        let size = joints.iter().fold(1.0, |size: f64, q| size.max(q.abs()));
                        let off = gap(&manipulator, joints, &target) / size;
                        worst = worst.max(off);
                        assert!(
                            off < CLOSURE,
                            "{pair:?} {lacks:?}: off by {off:e}\n{:?}",
                            manipulator.mechanism()
                        );
                        assert!(manipulator.inverse(&pose, mode, &mut same).unwrap().is_some());
                        assert_eq!(solution, same);
                    }
                }
            }
            println!(
                "{pair:?} {lacks:?}: {made} mechanisms, {reached} of {poses} poses, {solutions} solutions, \
                 worst {worst:.1e}"
            );
            assert!(reached >= poses / 4, "{pair:?} {lacks:?}: hardly any pose was in reach");
            let [lower, upper] = pair.map(RandomSubspace::dimension);
            // Either kind of leg has enough joints to lack some.
            let enough = lower > lacks[0] + 1 && upper > lacks[1] + 1;
            assert!(made > 15 || !enough, "{pair:?} {lacks:?}: {made} mechanisms");
        }
    }
}

/// The platform displaced by the constraining leg itself, with random joint values, is at a pose of some mode.
#[test]
fn every_displacement_of_the_leg_is_found() {
    let mut rng = Rng::with_seed(141);
    let mut tried = 0;
    for pair in PAIRS {
        for lacks in LACKS {
            for round in 0..30 {
                let Some((mechanism, decomposition)) =
                    constrained(&mut rng, pair, lacks, false, options(round))
                else {
                    continue;
                };
                let Ok(manipulator) = compiled(mechanism, decomposition, round) else {
                    continue;
                };
                let leg = &manipulator.mechanism().legs[0];
                for _ in 0..20 {
                    let joints: Vec<f64> =
                        leg.coordinates().map(|c| c.home + 2.0 * rng.f64() - 1.0).collect();
                    let displacement = leg.displacement(&joints).unwrap();
                    tried += 1;
                    if let Err(outside) = manipulator.locate(&displacement) {
                        panic!("{pair:?} {lacks:?}: {outside}\n{:?}", manipulator.mechanism());
                    }
                }
            }
        }
    }
    println!("{tried} displacements");
    assert!(tried > 30_000);
}

/// A random mechanism with a constraining leg, with as many joints actuated as it has degrees of freedom, so that
/// they control it. `None` if there is none.
fn actuated(
    rng: &mut Rng,
    pair: [RandomSubspace; 2],
    lacks: [usize; 2],
    round: usize,
) -> Option<Manipulator> {
    let (mut mechanism, decomposition) =
        constrained(rng, pair, lacks, round % 4 == 3, options(round))?;
    let single: Vec<[usize; 2]> = (mechanism.legs.iter().enumerate())
        .flat_map(|(leg, l)| l.joints.iter().enumerate().map(move |(joint, j)| (leg, joint, j)))
        .filter(|(.., joint)| joint.freedoms() == 1)
        .map(|(leg, joint, _)| [leg, joint])
        .collect();
    for _ in 0..200 {
        let mut chosen = single.clone();
        rng.shuffle(&mut chosen);
        chosen.truncate(decomposition.mobility);
        mechanism.legs.iter_mut().flat_map(|l| &mut l.joints).for_each(|j| j.actuated = false);
        chosen.iter().for_each(|&[leg, joint]| mechanism.legs[leg].joints[joint].actuated = true);
        let report = mobility(&mechanism).unwrap();
        if check_actuators(&report).is_ok() && report.singular.is_empty() {
            return compiled(mechanism, decomposition, round).ok();
        }
    }
    None
}

/// A random pose not far from home, and every solution there.
fn solutions(rng: &mut Rng, m: &Manipulator) -> Vec<(Vec<f64>, Mode, Solution)> {
    let spread = 1.2 * rng.f64();
    let pose: Vec<f64> =
        (m.task_coordinates().iter()).map(|c| c.home + spread * (2.0 * rng.f64() - 1.0)).collect();
    let mut all = m.all_modes();
    m.inverse_all(&pose, &mut all).unwrap();
    let modes: Vec<Mode> = all.modes(m).collect();
    let each = modes.into_iter().map(|mode| {
        let mut solution = m.solution();
        assert!(m.solution_in_mode(&all, mode, &mut solution).is_some());
        (pose.clone(), mode, solution)
    });
    each.collect()
}

/// Joint rates, and those of the dependent coordinates, are the derivatives of the inverse kinematics; the
/// Jacobian by the pose gives the same.
#[test]
fn rates_are_derivatives() {
    let mut rng = Rng::with_seed(142);
    let (mut compared, mut unsure, mut worst) = (0, 0, [0.0_f64; 2]);
    for pair in PAIRS {
        for lacks in LACKS {
            for round in 0..4 {
                let Some(m) = actuated(&mut rng, pair, lacks, round) else { continue };
                let (mut motion, mut jacobians) = (m.joint_motion(), m.jacobians());
                for (pose, mode, at) in solutions(&mut rng, &m).into_iter().take(6) {
                    let mut any =
                        || -> Vec<f64> { pose.iter().map(|_| 2.0 * rng.f64() - 1.0).collect() };
                    let (rates, accelerations) = (any(), any());
                    let differences = derivatives(1e-2, |t| {
                        let moved: Vec<f64> = (pose.iter().zip(&rates).zip(&accelerations))
                            .map(|((q, r), a)| q + t * (r + 0.5 * t * a))
                            .collect();
                        let mut near = at.clone();
                        let reached = m.inverse_near(&moved, mode, &mut near).unwrap().is_some();
                        reached
                            .then(|| [near.joints(), near.imaginary(), near.dependent()].concat())
                    });
                    let Some(differences) = differences else {
                        unsure += 1;
                        continue;
                    };
                    if !m.velocity(&at, &rates, &accelerations, &mut motion).unwrap() {
                        unsure += 1;
                        continue;
                    }
                    let orders = [
                        [&motion.joint_rates[..], &motion.imaginary_rates, &motion.dependent_rates]
                            .concat(),
                        [
                            &motion.joint_accelerations[..],
                            &motion.imaginary_accelerations,
                            &motion.dependent_accelerations,
                        ]
                        .concat(),
                    ];
                    for (order, (found, tolerance)) in orders.iter().zip([1e-8, 1e-6]).enumerate() {
                        let known: Vec<_> = differences.iter().map(|d| d[order]).collect();
                        let size = known.iter().fold(1.0_f64, |size, d| size.max(d.value.abs()));
                        if known.iter().any(|d| d.error > 0.1 * tolerance * size) {
                            unsure += 1;
                            continue;
                        }
                        for (found, known) in found.iter().zip(&known) {
                            let off = (found - known.value).abs() / size;
                            worst[order] = worst[order].max(off);
                            assert!(
                                off < tolerance,
                                "{pair:?} {lacks:?} order {order}: {found} {known:?}\n{:?}",
                                m.mechanism()
                            );
                        }
                        compared += 1;
                    }
                    assert!(m.differentiate(&at, &mut jacobians).unwrap());
                    let by_pose = jacobians.joints_by_pose() * DVector::from_row_slice(&rates);
                    let size = by_pose.amax().max(1.0);
                    for (a, b) in by_pose.iter().zip(&motion.joint_rates) {
                        assert!((a - b).abs() < 1e-9 * size, "{pair:?} {lacks:?}: {a} {b}");
                    }
                }
            }
        }
    }
    println!("{compared} compared, {unsure} not, worst {:.1e} {:.1e}", worst[0], worst[1]);
    assert!(compared > 1_500 && unsure < compared / 5, "{compared} compared, {unsure} not");
}

/// The actuated joints of a pose lead back to it, and all assemblies close.
#[test]
fn joints_of_a_pose_lead_back_to_it() {
    let mut rng = Rng::with_seed(143);
    let (mut poses, mut open, mut loose, mut near, mut turns) = (0, 0, 0, 0, 0);
    for pair in PAIRS {
        for lacks in LACKS {
            for round in 0..8 {
                let Some(m) = actuated(&mut rng, pair, lacks, round) else { continue };
                for (pose, mode, at) in solutions(&mut rng, &m).into_iter().take(6) {
                    let actuated: Vec<f64> = m.actuated().iter().map(|&i| at.joints()[i]).collect();
                    let here = at.displacement(&m);
                    if let Ok(found) = m.forward_near(&actuated, &pose, mode) {
                        near += 1;
                        assert!(found.residual < RESIDUAL);
                    }
                    if m.forward_closed_form().is_err() {
                        open += 1;
                        continue;
                    }
                    let found = m.forward(&actuated).unwrap();
                    if !found.loose.is_empty() {
                        loose += 1;
                        continue;
                    }
                    poses += 1;
                    let mut solution = m.solution();
                    let mut back = false;
                    for assembly in &found.list {
                        assert!(assembly.residual < RESIDUAL);
                        let there = m.inverse(&assembly.pose, assembly.mode, &mut solution);
                        let there = there.unwrap().expect("an assembly is in reach");
                        for (wanted, &i) in actuated.iter().zip(m.actuated()) {
                            let off = there.joints()[i] - wanted;
                            let turns = match m.coordinates()[i].quantity {
                                Quantity::Angle => (off / TAU).round(),
                                Quantity::Length => 0.0,
                            };
                            let off = (off - TAU * turns).abs();
                            assert!(
                                off < 1e-6,
                                "{pair:?} {lacks:?}: {} is off by {off:e}\n{:?} {:?}\n{assembly:?}\n{there:?}",
                                m.coordinates()[i].name,
                                m.mechanism(),
                                m.task_coordinates()
                            );
                        }
                        let apart = there.displacement(&m).to_homogeneous() - here.to_homogeneous();
                        back |= apart.amax() < 1e-6;
                    }
                    // Revolutions of a screw that no actuated joint counts are other assemblies.
                    let screws = m.mechanism().joints();
                    let counts =
                        screws.into_iter().any(|j| matches!(j.kind, JointKind::Helical { .. }));
                    turns += usize::from(!back && counts);
                    assert!(
                        back || counts,
                        "{pair:?} {lacks:?}: {pose:?} is not among {:?}, unmet {:?}\n{:?}",
                        found.list,
                        found.unmet,
                        m.mechanism()
                    );
                }
            }
        }
    }
    println!(
        "{poses} poses, {turns} other turns of a screw, {open} without closed form, {loose} loose, {near} by \
         Newton's method"
    );
    assert!(poses > 500 && turns < poses / 10, "{poses}");
    assert!(near > 9 * (poses + open + loose) / 10, "{near}");
}

/// A sweep counts the same poses, and finds the same ranges of the imaginary joints, as one call of the inverse
/// kinematics for each pose.
#[test]
fn sweeps_agree_with_the_inverse() {
    let mut rng = Rng::with_seed(144);
    let (mut poses, mut reached) = (0, 0);
    for pair in PAIRS {
        for lacks in LACKS {
            for round in 0..3 {
                let limited = Options { limited: 0.3, balls: round == 1 };
                let Some((mechanism, decomposition)) =
                    constrained(&mut rng, pair, lacks, false, limited)
                else {
                    continue;
                };
                let m = compiled(mechanism, decomposition, round).unwrap();
                let axes = m.task_coordinates().iter().map(|c| {
                    let (below, above) = (rng.f64(), rng.f64());
                    Axis::new(c.name, c.home - below, c.home + above, 5)
                });
                let grid = Grid::new(&m, axes.collect()).unwrap();
                for modes in [Modes::Any, Modes::One(m.home_mode())] {
                    let (expected, count) = by_inverse(&m, &grid, modes);
                    let sweep = Sweep::new(&m, &grid, modes);
                    let found = sweep.count(&Progress::default()).unwrap();
                    assert_eq!(found, count, "{pair:?} {lacks:?} {modes:?}");
                    let mut points: Vec<Vec<f64>> = Vec::new();
                    sweep
                        .points(
                            &Progress::default(),
                            |hits, made: &mut Vec<Vec<f64>>| {
                                let each = hits.first.iter();
                                made.extend(each.map(|x| [&[*x], hits.others].concat()));
                            },
                            Vec::new,
                            |made| {
                                points.extend(made);
                                Ok::<(), Cancelled>(())
                            },
                        )
                        .unwrap();
                    assert_eq!(points, expected, "{pair:?} {lacks:?} {modes:?}");
                    poses += found.poses;
                    reached += found.reachable;
                }
            }
        }
    }
    println!("{reached} of {poses} poses");
    assert!(reached > poses / 20);
}

/// The same counts on long rows and on many of them, which poses of one inverse kinematics each are compared with: limits on
/// all joints, all modes, and angles of several revolutions.
#[test]
fn large_sweeps_agree_with_the_inverse() {
    let mut rng = Rng::with_seed(146);
    let (mut poses, mut reached, mut partly) = (0, 0, 0);
    for round in 0.. {
        if poses > 4_000_000 {
            break;
        }
        let (pair, lacks) = (PAIRS[round % PAIRS.len()], LACKS[rng.usize(..LACKS.len())]);
        let options = Options { limited: [0.0, 0.3, 1.0][rng.usize(..3)], balls: rng.bool() };
        let repeated = rng.u8(..4) == 0;
        let Some((mechanism, decomposition)) =
            constrained(&mut rng, pair, lacks, repeated, options)
        else {
            continue;
        };
        let m = compiled(mechanism, decomposition, round).unwrap();
        let counts = match rng.u8(..3) {
            0 => [1, 1, 40, 40],
            1 => [3000, 3, 2, 1],
            _ => [70, 30, 3, 3],
        };
        let counts = counts.into_iter().chain(std::iter::repeat(1));
        let axes = m.task_coordinates().iter().zip(counts).map(|(c, count)| {
            let most = if rng.u8(..6) == 0 { 7.0 } else { 1.5 };
            let (below, above) = (rng.f64() * most, rng.f64() * most);
            match count {
                1 => Axis::fixed(c.name, c.home + 0.1 * (above - below)),
                _ => Axis::new(c.name, c.home - below, c.home + above, count),
            }
        });
        let grid = Grid::new(&m, axes.collect()).unwrap();
        let (mut all, mut solution) = (m.all_modes(), m.solution());
        for modes in [Modes::Any, Modes::One(m.home_mode())] {
            let mut expected = Count::nothing(&m);
            let mut numbers = Vec::new();
            for number in 0..grid.poses() {
                let pose = grid.pose(number);
                let mut used = vec![];
                let within = match modes {
                    Modes::One(mode) => {
                        let found = m.inverse(&pose, mode, &mut solution).unwrap();
                        let found = found.filter(|found| found.within_limits());
                        used.extend(found.iter().flat_map(|found| found.imaginary()));
                        found.is_some()
                    }
                    Modes::Any => {
                        let found = m.inverse_all(&pose, &mut all).unwrap();
                        let mut values = vec![vec![]; m.imaginary().len()];
                        let mut note = |number: usize, value: f64| values[number].push(value);
                        let within =
                            found.is_some_and(|all| all.within_limits_in_any(&m, &mut note));
                        let count = values.iter().map(Vec::len).max().unwrap_or(0);
                        // As many rows of values as the joint with the most has.
                        for row in 0..count {
                            used.extend(values.iter().map(|of| of[row.min(of.len() - 1)]));
                        }
                        within
                    }
                };
                expected.poses += 1;
                if within {
                    expected.reachable += 1;
                    numbers.push(number);
                    for values in used.chunks(m.imaginary().len().max(1)) {
                        let one = values.iter().map(|&value| Some([value; 2])).collect();
                        let one = Count { poses: 0, reachable: 0, imaginary: one };
                        expected = expected.merge(&one);
                    }
                }
            }
            let sweep = Sweep::new(&m, &grid, modes);
            let (found, runs) = sweep.count_and_keep(usize::MAX, &Progress::default()).unwrap();
            let name = format!("round {round}: {pair:?} {lacks:?} {modes:?}");
            assert_eq!(found, expected, "{name}");
            assert_eq!(sweep.count(&Progress::default()).unwrap(), expected, "{name}");
            let runs = runs.unwrap();
            assert!(runs.iter().flat_map(|run| run.from..run.to).eq(numbers), "{name}");
            let expected = expected.reachable;
            poses += grid.poses();
            reached += expected;
            partly += u32::from(expected > 0 && expected < grid.poses());
        }
    }
    println!("{reached} of {poses} poses; {partly} grids in part");
    assert!(partly > 50, "{partly}");
}

/// Home is home: joints and platform stay where the file puts them, and the platform's place there is located. In
/// spheres the Euler angles are singular at home.
#[test]
fn home_is_where_the_joints_are() {
    let mut rng = Rng::with_seed(145);
    let mut homes = 0;
    for pair in PAIRS {
        for lacks in LACKS {
            for round in 0..6 {
                let Some((mechanism, decomposition)) =
                    constrained(&mut rng, pair, lacks, false, options(round))
                else {
                    continue;
                };
                let m = compiled(mechanism, decomposition, round).unwrap();
                let mut solution = m.solution();
                let home = m.home_pose();
                let at = m.inverse(&home, m.home_mode(), &mut solution).unwrap();
                let at = at.unwrap_or_else(|| panic!("{pair:?} {lacks:?}: home is out of reach"));
                for (c, q) in m.coordinates().iter().zip(at.joints()) {
                    assert!((c.home - q).abs() < 1e-6, "{pair:?} {lacks:?} {}: {q}", c.name);
                }
                for (c, q) in m.dependent_coordinates().iter().zip(at.dependent()) {
                    assert!((c.home - q).abs() < 1e-9, "{pair:?} {lacks:?} {}: {q}", c.name);
                }
                let identity = Isometry3::identity();
                let off = at.displacement(&m).to_homogeneous() - identity.to_homogeneous();
                assert!(off.amax() < 1e-9, "{pair:?} {lacks:?}: {off}");
                let found = m.locate(&identity);
                assert!(found.is_ok(), "{pair:?} {lacks:?}: {found:?}");
                homes += 1;
            }
        }
    }
    assert!(homes > 400, "{homes}");
}

/// One revolute joint that is level: the tilt is its angle, up to half a turn to either side, where the Euler angles
/// are singular again.
#[test]
fn a_level_axis_turns_by_half_a_turn() {
    let axis = |name: &str, axis: [f64; 3]| {
        format!(
            "{{ name = \"{name}\", type = \"revolute\", axis = {axis:?}, point = [0, 0, 0] }},\n"
        )
    };
    let text = format!(
        "format = 1\nname = \"level\"\nunits = {{ length = \"m\", angle = \"rad\" }}\n\
         [platform]\npoint = [0, 0, 0]\n[[leg]]\nname = \"one\"\njoints = [\n{}]\n\
         [[leg]]\nname = \"three\"\njoints = [\n{}{}{}]\n",
        axis("A", [1.0, 0.0, 0.0]).replace(" },", ", actuated = true },"),
        axis("B", [0.0, 0.0, 1.0]),
        axis("C", [0.0, 1.0, 0.0]),
        axis("D", [1.0, 0.0, 0.0]),
    );
    let m = Manipulator::read(&text).unwrap();
    assert_eq!(m.task_coordinates()[0].name, "xi");
    let mut solution = m.solution();
    for step in -8..=8 {
        for nearly in [0.0, 1e-9, -1e-9, 1e-8] {
            let xi = PI * f64::from(step) / 8.0 + nearly;
            if xi.abs() > PI {
                continue;
            }
            let mut all = m.all_modes();
            m.inverse_all(&[xi], &mut all).unwrap();
            for mode in all.modes(&m) {
                let at = m.solution_in_mode(&all, mode, &mut solution).unwrap();
                assert!((at.joints()[0].abs() - xi.abs()).abs() < 1e-6, "{xi}: {:?}", at.joints());
                let target = at.displacement(&m).to_homogeneous();
                let mut joints = at.joints();
                for leg in &m.mechanism().legs {
                    let (own, rest) = joints.split_at(leg.coordinates().count());
                    joints = rest;
                    let off = leg.displacement(own).unwrap().to_homogeneous() - target;
                    assert!(off.amax() < 1e-7, "{xi} {}: {off}", leg.name);
                }
            }
            // The joint's own displacement is always found.
            let leg = &m.mechanism().legs[0];
            assert!(m.locate(&leg.displacement(&[xi]).unwrap()).is_ok(), "{xi}");
        }
    }
}
