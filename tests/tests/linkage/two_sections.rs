//! Random linkages of every pair of subspaces and every kind of loop.

use super::numeric::Closure;
use super::open;
use super::sections::{COMBINATIONS, Section, Shared, linkage, near};
use super::{first, signs};
use fastrand::Rng;
use opm_core::chain::Branch;
use opm_core::linkage::{Input, InputRange, Linkage, Position};
use opm_core::mechanism::joint::Quantity;
use std::f64::consts::PI;

/// The bound on closure: rounding, in proportion to the largest joint value.
const CLOSURE: f64 = 1e-12;

fn closure(linkage: &Linkage, position: &Position) -> f64 {
    let far = position.joints.iter().fold(1.0_f64, |far, q| far.max(q.abs()));
    open(linkage.mechanism(), position) / (far * far)
}

fn random_input<'a>(rng: &mut Rng, linkage: &'a Linkage) -> (usize, Input<'a>) {
    let number = rng.usize(..linkage.coordinates().len());
    (number, linkage.input(&linkage.coordinates()[number].name).unwrap())
}

#[test]
fn every_branch_closes_the_original_loop() {
    let mut rng = Rng::with_seed(110);
    for combination in COMBINATIONS {
        let (mut closed, mut worst, mut branches) = (0, 0.0_f64, [0; 5]);
        for _ in 0..1_000 {
            let linkage = linkage(&mut rng, combination);
            let (number, input) = random_input(&mut rng, &linkage);
            for _ in 0..5 {
                let value = near(&mut rng, input.coordinate().home);
                let positions = input.solve(value);
                let inside = input.range().contains(value);
                assert_eq!(!positions.is_empty(), inside, "{combination:?} {value}");
                branches[positions.len()] += 1;
                for position in positions {
                    closed += 1;
                    assert_eq!(position.joints[number], value);
                    let off = closure(&linkage, &position);
                    worst = worst.max(off);
                    assert!(off < CLOSURE, "{combination:?} {number}: {off:e} {position:?}");
                }
            }
        }
        println!("{combination:?}: {closed} positions, worst {worst:.1e}, counts {branches:?}");
        assert!(closed > 1_000, "{combination:?} {closed}");
    }
}

/// Joints of sections on an axis follow from the imaginary joint, up to its revolutions: they are left
/// out where solutions are compared.
fn is_coaxial(linkage: &Linkage, section: usize) -> bool {
    let decomposition = linkage.decomposition().unwrap();
    [&decomposition.lower, &decomposition.upper][section].name() == "cylindrical"
}

/// Whether each joint coordinate is in a section that is not coaxial.
fn compared(linkage: &Linkage) -> Vec<bool> {
    let splits = &linkage.decomposition().unwrap().legs;
    let of = |split: &opm_core::decomposition::LegSplit| {
        let lower = vec![!is_coaxial(linkage, 0); split.lower.len()];
        [lower, vec![!is_coaxial(linkage, 1); split.upper.len()]].concat()
    };
    splits.iter().flat_map(of).collect()
}

#[test]
fn there_are_as_many_branches_as_a_numeric_solver_finds() {
    let mut rng = Rng::with_seed(111);
    let mut counts = [0; 5];
    for combination in COMBINATIONS {
        if combination.1 == [Section::Cylindrical; 2] {
            continue;
        }
        for _ in 0..12 {
            let linkage = linkage(&mut rng, combination);
            let (number, input) = random_input(&mut rng, &linkage);
            let solver = Closure::new(linkage.mechanism(), number);
            let compared = compared(&linkage);
            if !compared[number] && combination.0 == Shared::Translation {
                // With another number of revolutions, the joints on the axis push the other section
                // to another place: there are positions without end.
                continue;
            }
            let kept = |joints: &[f64]| -> Vec<f64> {
                joints.iter().zip(&compared).map(|(q, yes)| if *yes { *q } else { 0.0 }).collect()
            };
            let value = input.coordinate().home + 0.6 * (rng.f64() * 2.0 - 1.0);
            let positions = input.solve(value);
            // A slider far away is not found from starts near home.
            let far = |p: &Position| p.joints.iter().any(|q| q.abs() > 8.0);
            if positions.iter().any(far) {
                continue;
            }
            counts[positions.len()] += 1;
            let mut found: Vec<Vec<f64>> = Vec::new();
            for round in 0..20 {
                for solution in solver.all(value, 100, &mut rng) {
                    let solution = kept(&solution);
                    if found.iter().all(|known| solver.distance(known, &solution) > 1e-5) {
                        found.push(solution);
                    }
                }
                if round > 1 && found.len() >= positions.len() {
                    break;
                }
            }
            assert_eq!(found.len(), positions.len(), "{combination:?} {number} at {value}");
            for solution in found {
                let near = |p: &&Position| solver.distance(&kept(&p.joints), &solution) < 1e-6;
                assert_eq!(positions.iter().filter(near).count(), 1, "{combination:?}");
            }
        }
    }
    println!("inputs by number of positions: {counts:?}");
    assert!(counts[1] > 10 && counts[2] > 20 && counts[4] > 5, "{counts:?}");
}

/// Every value of the input on a fine grid is in the range exactly if there is a position.
#[test]
fn the_range_is_where_there_are_positions() {
    const SAMPLES: i32 = 400;
    let mut rng = Rng::with_seed(112);
    let (mut ends, mut poles, mut endless) = (0, 0, 0);
    for combination in COMBINATIONS {
        for _ in 0..40 {
            let linkage = linkage(&mut rng, combination);
            for coordinate in linkage.coordinates() {
                let input = linkage.input(&coordinate.name).unwrap();
                let range = input.range();
                assert!(range.contains(coordinate.home), "{combination:?} {range:?}");
                for branch in Branch::BOTH {
                    let range = input.branch_range(first(branch));
                    for i in -SAMPLES..=SAMPLES {
                        let value = coordinate.home + 4.0 * f64::from(i) / f64::from(SAMPLES);
                        let found = input.solve(value);
                        let here = found.iter().any(|p| signs(p).first == branch);
                        assert_eq!(
                            here,
                            range.contains(value),
                            "{combination:?} {value} {range:?}"
                        );
                    }
                }
                let InputRange::Intervals { intervals, .. } = range else { continue };
                // Intervals may meet where a slider is at infinity.
                assert!(intervals.is_sorted_by(|a, b| a[1] < b[0] + 1e-12), "{intervals:?}");
                for [low, high] in intervals {
                    if low.is_infinite() && high.is_infinite() {
                        endless += 1;
                        continue;
                    }
                    for (end, outwards) in [(low, -1.0), (high, 1.0)] {
                        if end.is_infinite() || high - low < 1e-3 {
                            continue;
                        }
                        let (inside, outside) = (
                            input.solve(end - outwards * 1e-7),
                            input.solve(end + outwards * 1e-7),
                        );
                        assert!(!inside.is_empty(), "{combination:?} {end}");
                        let far = |p: &Position| p.joints.iter().any(|q| q.abs() > 1e4);
                        if inside.iter().any(far) {
                            poles += 1;
                        } else if outside.is_empty() {
                            ends += 1;
                            assert!(!input.solve(end).is_empty(), "the end is inside");
                        }
                    }
                }
            }
        }
    }
    println!("{ends} ends, {poles} ends at infinity, {endless} without end");
    assert!(ends > 1_000 && poles > 10 && endless > 100, "{ends} {poles} {endless}");
}

#[test]
fn home_is_where_the_joints_are() {
    let mut rng = Rng::with_seed(113);
    for combination in COMBINATIONS {
        for _ in 0..100 {
            let linkage = linkage(&mut rng, combination);
            for coordinate in linkage.coordinates() {
                let input = linkage.input(&coordinate.name).unwrap();
                let found = input.solve(coordinate.home);
                let same = found.iter().find(|p| p.branch == input.home_branch()).unwrap();
                for (c, q) in linkage.coordinates().iter().zip(&same.joints) {
                    assert!((c.home - q).abs() < 1e-8, "{combination:?} {} {q}", c.name);
                }
                assert!((linkage.imaginary()[0].home - same.imaginary.unwrap()).abs() < 1e-8);
            }
        }
    }
}

/// The rates of all joints are what central differences give.
#[test]
fn rates_are_the_derivatives() {
    const STEP: f64 = 1e-6;
    let mut rng = Rng::with_seed(114);
    let mut compared = 0;
    for combination in COMBINATIONS {
        for _ in 0..150 {
            let linkage = linkage(&mut rng, combination);
            let (_, input) = random_input(&mut rng, &linkage);
            for position in input.solve(near(&mut rng, input.coordinate().home)) {
                let number = linkage
                    .coordinates()
                    .iter()
                    .position(|c| c.name == input.coordinate().name)
                    .unwrap();
                let value = position.joints[number];
                let rates = input.rates(&position).unwrap();
                let fastest = rates.joints.iter().fold(1.0_f64, |fast, rate| fast.max(rate.abs()));
                // Near a dead point, differences lose their digits.
                if fastest > 30.0 {
                    continue;
                }
                let side = |step: f64| {
                    let mut moved = position.clone();
                    assert!(input.position_near(value + step, position.branch, &mut moved));
                    moved
                };
                let (after, before) = (side(STEP), side(-STEP));
                let pairs = after.joints.iter().zip(&before.joints).zip(&rates.joints);
                let last = (
                    (after.imaginary.as_ref().unwrap(), before.imaginary.as_ref().unwrap()),
                    rates.imaginary.as_ref().unwrap(),
                );
                for ((after, before), rate) in pairs.chain([last]) {
                    let off = ((after - before) / (2.0 * STEP) - rate).abs();
                    assert!(off < 1e-6 * fastest.powi(3), "{combination:?} {off:e} {rates:?}");
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} rates");
    assert!(compared > 10_000);
}

/// The cycle closes the loop everywhere, never jumps, and comes home; without one, a joint goes to
/// infinity.
#[test]
fn a_cycle_is_one_motion() {
    const SAMPLES: u32 = 2000;
    let mut rng = Rng::with_seed(115);
    let (mut turns, mut returns, mut none) = (0, 0, 0);
    for combination in COMBINATIONS {
        for _ in 0..20 {
            let linkage = linkage(&mut rng, combination);
            let (number, input) = random_input(&mut rng, &linkage);
            let Ok(cycle) = input.cycle() else {
                none += 1;
                continue;
            };
            let home = input.home();
            let mut position = home.clone();
            let mut length = 0.0;
            let mut longest = 0.0_f64;
            for i in 0..=SAMPLES {
                let before = position.clone();
                let (value, branch) = cycle.at(f64::from(i) / f64::from(SAMPLES));
                let found = input.position_near(value, branch, &mut position);
                assert!(found, "{combination:?} {i} {value} {branch} {cycle:?}");
                assert!(closure(&linkage, &position) < 1e-10, "{combination:?} {cycle:?}");
                let pairs = position.joints.iter().zip(&before.joints);
                let step = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                length += step;
                longest = longest.max(step);
            }
            // No step is a large part of the way: joints that jump by half a revolution would be.
            assert!(longest < 0.2_f64.max(0.15 * length), "{combination:?} {longest} {length}");
            assert_eq!(position.branch, home.branch);
            if cycle.is_revolution() {
                turns += 1;
                let (from, to) = (cycle.at(0.0).0, cycle.at(1.0).0);
                assert!(to > from && input.coordinate().home == from);
            } else {
                returns += 1;
                let pairs = position.joints.iter().zip(&home.joints);
                let compared = compared(&linkage);
                for (((q, home), c), yes) in pairs.zip(linkage.coordinates()).zip(compared) {
                    // Revolutions of the imaginary joint move a screw on its axis on.
                    if !yes && combination.0 == Shared::Rotation {
                        continue;
                    }
                    let off = q - home;
                    let off = match c.quantity {
                        Quantity::Angle => off - (off / (2.0 * PI)).round() * 2.0 * PI,
                        Quantity::Length => off,
                    };
                    assert!(off.abs() < 1e-7, "{combination:?} {number} {off}");
                }
            }
        }
    }
    println!("{turns} turns, {returns} returns, {none} without a cycle");
    assert!(turns > 10 && returns > 50 && none > 10, "{turns} {returns} {none}");
}
