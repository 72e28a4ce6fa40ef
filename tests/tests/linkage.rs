//! Linkages, compared with the loop as it stands in the mechanism: the product of exponentials along both
//! legs, and a numeric solver that knows nothing else.

mod numeric;
mod random;
mod sections;
mod traced;
mod two_sections;

use fastrand::Rng;
use nalgebra::{Isometry3, Vector3};
use numeric::{Closure, distance};
use opm_core::chain::Branch;
use opm_core::linkage::{
    Input, InputRange, Linkage, LinkageBranch, LinkageError, Position, SectionSigns,
};
use opm_core::mechanism::{Mechanism, examples, file};
use random::{PATTERNS, linkage};
use std::f64::consts::{PI, TAU};

/// The bound on closure: the joints rotate about centres within a few metres.
const CLOSURE: f64 = 1e-10;

fn shipped(name: &str) -> Mechanism {
    file::read(examples::find(name).unwrap().text).unwrap().mechanism
}

fn compiled(mechanism: &Mechanism) -> Linkage {
    Linkage::new(mechanism).unwrap_or_else(|error| panic!("{error}"))
}

/// The linkage driven by each of its six joint coordinates.
fn inputs(linkage: &Linkage) -> impl Iterator<Item = (usize, Input<'_>)> {
    let input = |(i, c): (usize, &opm_core::mechanism::joint::JointCoordinate)| {
        (i, linkage.input(&c.name).expect("every coordinate is one"))
    };
    linkage.coordinates().iter().enumerate().map(input)
}

/// The signs of a position of two sections.
fn signs(position: &Position) -> SectionSigns {
    let LinkageBranch::Signs(signs) = position.branch else { panic!("{:?}", position.branch) };
    signs
}

/// Any branch with this first sign.
fn first(sign: Branch) -> LinkageBranch {
    LinkageBranch::Signs(SectionSigns { first: sign, second: Branch::Plus })
}

/// The difference between the platform's displacements by the two legs.
fn open(mechanism: &Mechanism, position: &Position) -> f64 {
    let (one, two) = position.joints.split_at(mechanism.legs[0].coordinates().count());
    let [one, two] =
        [(0, one), (1, two)].map(|(leg, q)| mechanism.legs[leg].displacement(q).unwrap());
    (one.to_homogeneous() - two.to_homogeneous()).norm()
}

/// The imaginary joint's value from the lower parts of the legs: `L₁ = L₂ exp(I τ)`, with `τ` in
/// the leg that has the joint.
fn imaginary(linkage: &Linkage, position: &Position) -> f64 {
    let mut joints = &position.joints[..];
    let decomposition = linkage.decomposition().unwrap();
    let lower: Vec<Isometry3<f64>> = (linkage.mechanism().legs.iter().zip(&decomposition.legs))
        .map(|(leg, split)| {
            let (own, rest) = joints.split_at(leg.coordinates().count());
            joints = rest;
            // With the upper part at home, only the lower part's displacement is left.
            let home: Vec<f64> = leg.coordinates().map(|c| c.home).collect();
            let values = [&own[..split.lower.len()], &home[split.lower.len()..]].concat();
            leg.displacement(&values).unwrap()
        })
        .collect();
    let owner = linkage.imaginary()[0].leg;
    let turn = lower[1 - owner].inverse() * lower[owner];
    let label = linkage.mechanism().legs[owner].imaginary.as_ref();
    let class = &decomposition.intersection;
    let opm_core::group::subspace::SubspaceClass::Rotation { axis, .. } = class else {
        panic!("{class:?}");
    };
    // Without a label, the direction that points up is positive.
    let up = |v: &Vector3<f64>| v.dot(&Vector3::from(opm_core::group::subspace::UP));
    let positive = match label {
        Some(label) => label.positive.dot(axis).signum(),
        None => up(&axis.into_inner()).signum(),
    };
    let vector = turn.rotation.scaled_axis();
    assert!(vector.cross(axis).norm() < CLOSURE, "the imaginary joint is on the axis");
    label.map_or(0.0, |label| label.home) + positive * vector.dot(axis)
}

#[test]
fn every_position_closes_the_original_loop() {
    let mut rng = Rng::with_seed(100);
    let (mut closed, mut worst) = (0, 0.0_f64);
    for round in 0..50 {
        for pattern in PATTERNS {
            let linkage = compiled(&linkage(&mut rng, pattern));
            for (number, input) in inputs(&linkage) {
                for _ in 0..10 {
                    let value = (rng.f64() * 2.0 - 1.0) * 4.0;
                    let positions = input.solve(value);
                    assert_eq!(!positions.is_empty(), input.range().contains(value), "{pattern:?}");
                    for position in positions {
                        closed += 1;
                        assert_eq!(position.joints[number], value);
                        let off = open(linkage.mechanism(), &position);
                        worst = worst.max(off);
                        assert!(off < CLOSURE, "{round} {pattern:?} {number}: {off:e}");
                        let tau = imaginary(&linkage, &position);
                        assert!(
                            distance(&[tau], position.imaginary.as_slice()) < 1e-9,
                            "{pattern:?}"
                        );
                        for (c, q) in linkage.coordinates().iter().zip(&position.joints) {
                            assert!(*q == value || (q - c.home).abs() <= PI + 1e-9);
                        }
                    }
                }
            }
        }
    }
    println!("{closed} positions, worst {worst:.1e}");
    assert!(closed > 40_000, "{closed}");
}

#[test]
fn there_are_as_many_branches_as_a_numeric_solver_finds() {
    let mut rng = Rng::with_seed(101);
    let mut counts = [0; 5];
    for _ in 0..6 {
        for pattern in PATTERNS {
            let linkage = compiled(&linkage(&mut rng, pattern));
            let mechanism = linkage.mechanism();
            let (number, input) = inputs(&linkage).nth(rng.usize(..6)).unwrap();
            let closure = Closure::new(mechanism, number);
            let value = input.coordinate().home + (rng.f64() * 2.0 - 1.0) * PI;
            let positions = input.solve(value);
            counts[positions.len()] += 1;
            // As many starts as are needed to find all solutions, then half as many again to look
            // for more.
            let mut found = closure.all(value, 200, &mut rng);
            for _ in 0..20 {
                if found.len() >= positions.len() {
                    break;
                }
                found.extend(closure.all(value, 200, &mut rng));
                found = distinct(found);
            }
            found.extend(closure.all(value, 100, &mut rng));
            let found = distinct(found);
            assert_eq!(found.len(), positions.len(), "{pattern:?}, {number} at {value}");
            for solution in found {
                let near = |p: &Position| distance(&p.joints, &solution) < 1e-6;
                assert_eq!(positions.iter().filter(|p| near(p)).count(), 1, "{pattern:?}");
            }
        }
    }
    println!("inputs by number of positions: {counts:?}");
    assert!(counts[0] > 5 && counts[2] > 5 && counts[4] > 5, "{counts:?}");
}

fn distinct(solutions: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    let mut kept: Vec<Vec<f64>> = Vec::new();
    for solution in solutions {
        if kept.iter().all(|known| distance(known, &solution) > numeric::SAME) {
            kept.push(solution);
        }
    }
    kept
}

/// Whether two positions meet that differ in the choice of the second four-bar.
fn second_folds(positions: &[Position]) -> bool {
    let meet = |a: &Position, b: &Position| {
        signs(a).first == signs(b).first && distance(&a.joints, &b.joints) < 1e-3
    };
    positions.iter().enumerate().any(|(i, a)| positions[..i].iter().any(|b| meet(a, b)))
}

/// From inside each end of the range, a numeric solver follows the linkage outwards until it finds
/// no solution.
#[test]
fn the_range_ends_where_a_numeric_solver_ends() {
    const REACH: f64 = 1e-2;
    let mut rng = Rng::with_seed(102);
    let (mut ends, mut by_the_other, mut inner) = (0, 0, 0);
    for _ in 0..3 {
        for pattern in PATTERNS {
            let linkage = compiled(&linkage(&mut rng, pattern));
            let (number, input) = inputs(&linkage).nth(rng.usize(..6)).unwrap();
            let InputRange::Intervals { intervals, .. } = input.range() else { continue };
            inner += usize::from(intervals.len() > 1);
            let closure = Closure::new(linkage.mechanism(), number);
            for (i, [low, high]) in intervals.iter().copied().enumerate() {
                for (end, outwards) in [(low, -1.0), (high, 1.0)] {
                    // There must be room on both sides, or the search would leave the interval or
                    // enter another one.
                    let clear = intervals.iter().enumerate().all(|(k, other)| {
                        k == i || other.iter().all(|o| distance(&[*o], &[end]) > 2.0 * REACH)
                    });
                    if high - low < REACH || !clear {
                        continue;
                    }
                    let starts: Vec<_> =
                        input.solve(end - 1e-3 * outwards).into_iter().map(|p| p.joints).collect();
                    assert!(!starts.is_empty());
                    by_the_other += usize::from(second_folds(&input.solve(end)));
                    let closes = |value: f64, rng: &mut Rng| {
                        let known =
                            starts.iter().any(|start| closure.solve(value, start).is_some());
                        known || !closure.all(value, 10, rng).is_empty()
                    };
                    let (mut inside, mut outside) = (-REACH * 0.5, REACH);
                    assert!(closes(end + inside * outwards, &mut rng), "{pattern:?}");
                    assert!(!closes(end + outside * outwards, &mut rng), "{pattern:?}");
                    while outside - inside > 1e-7 {
                        let middle = 0.5 * (inside + outside);
                        if closes(end + middle * outwards, &mut rng) {
                            inside = middle;
                        } else {
                            outside = middle;
                        }
                    }
                    assert!(inside.abs() < 1e-6, "{pattern:?} {number}: off by {inside:e}");
                    ends += 1;
                }
            }
        }
    }
    println!("{ends} ends, {by_the_other} by the second four-bar, {inner} ranges in pieces");
    assert!(ends > 60 && by_the_other > 20 && inner > 10, "{ends} {by_the_other} {inner}");
}

/// Every value of the input on a fine grid is in the range exactly if there is a position.
#[test]
fn the_range_is_where_there_are_positions() {
    let mut rng = Rng::with_seed(103);
    for _ in 0..20 {
        for pattern in PATTERNS {
            let linkage = compiled(&linkage(&mut rng, pattern));
            for (_, input) in inputs(&linkage) {
                let range = input.range();
                if let InputRange::Intervals { intervals, .. } = &range {
                    assert!(intervals.is_sorted_by(|a, b| a[1] < b[0]), "{intervals:?}");
                    assert!(range.contains(input.coordinate().home));
                    for [low, high] in intervals {
                        assert!(high > low && high - low < TAU);
                        let away = (0.5 * (low + high) - input.coordinate().home).abs();
                        let home = (*low..=*high).contains(&input.coordinate().home);
                        assert!(home || away <= PI + 1e-9, "{intervals:?}");
                        for end in [low, high] {
                            assert!(!input.solve(*end).is_empty(), "the end is inside");
                        }
                    }
                }
                for branch in Branch::BOTH {
                    let range = input.branch_range(first(branch));
                    for i in 0..180 {
                        let value = f64::from(i) * TAU / 180.0;
                        let found = input.solve(value);
                        let here = found.iter().any(|p| signs(p).first == branch);
                        assert_eq!(here, range.contains(value), "{pattern:?} {value}");
                    }
                }
            }
        }
    }
}

#[test]
fn home_is_where_the_joints_are() {
    let mut rng = Rng::with_seed(104);
    for _ in 0..100 {
        for pattern in PATTERNS {
            let linkage = compiled(&linkage(&mut rng, pattern));
            for (_, input) in inputs(&linkage) {
                let home = input.home();
                let found = input.solve(input.coordinate().home);
                let same = found.iter().find(|p| p.branch == input.home_branch()).unwrap();
                assert!(distance(&home.joints, &same.joints) < 1e-9);
                assert!((home.imaginary.unwrap() - same.imaginary.unwrap()).abs() < 1e-9);
                let others = found.iter().filter(|p| p.branch != input.home_branch());
                for other in others {
                    assert!(distance(&home.joints, &other.joints) > 1e-3);
                }
            }
        }
    }
}

/// The cycle closes the loop everywhere, never jumps, and comes home.
#[test]
fn a_cycle_is_one_motion() {
    const SAMPLES: u32 = 4000;
    let mut rng = Rng::with_seed(105);
    let (mut turns, mut returns, mut longest) = (0, 0, 0.0_f64);
    for _ in 0..10 {
        for pattern in PATTERNS {
            let linkage = compiled(&linkage(&mut rng, pattern));
            for (_, input) in inputs(&linkage) {
                let cycle = input.cycle().unwrap();
                let home = input.home();
                let mut position = home.clone();
                for i in 0..=SAMPLES {
                    let before = position.clone();
                    let (value, branch) = cycle.at(f64::from(i) / f64::from(SAMPLES));
                    let found = input.position_near(value, branch, &mut position);
                    assert!(found, "{pattern:?} {i} {value} {branch} {cycle:?}");
                    assert!(open(linkage.mechanism(), &position) < CLOSURE);
                    let pairs = position.joints.iter().zip(&before.joints);
                    let step = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                    let step =
                        step.max((position.imaginary.unwrap() - before.imaginary.unwrap()).abs());
                    longest = longest.max(step);
                    assert!(step < 0.5, "{pattern:?} {i}: {step} {cycle:?}");
                }
                assert!(distance(&position.joints, &home.joints) < 1e-9);
                assert_eq!(position.branch, home.branch);
                let turned = position.joints.iter().zip(&home.joints);
                let turned = turned.filter(|(a, b)| (*a - *b).abs() > PI).count();
                if cycle.is_revolution() {
                    turns += 1;
                    assert!(turned > 0);
                    assert!((cycle.at(1.0).0 - cycle.at(0.0).0 - TAU).abs() < 1e-12);
                } else {
                    returns += 1;
                    assert_eq!(cycle.at(1.0).0, cycle.at(0.0).0);
                }
            }
        }
    }
    println!("{turns} turns, {returns} returns, longest step {longest:.3}");
    assert!(turns > 50 && returns > 50, "{turns} {returns}");
}

#[test]
fn the_shipped_linkage_is_driven_by_a_crank() {
    let linkage = compiled(&shipped("bennett-double-spherical-6r"));
    let crank = linkage.input("a1").unwrap();
    assert!(crank.range().is_full_turn());
    assert!(crank.cycle().unwrap().is_revolution());
    assert!(linkage.input("b3").is_some() && linkage.input("j1").is_none());
    assert_eq!(linkage.imaginary()[0].name, "tau.leg1");
    for i in 0..360 {
        assert_eq!(crank.solve(f64::from(i).to_radians()).len(), 4);
    }
    for value in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        assert!(crank.solve(value).is_empty());
        assert!(!crank.range().contains(value));
    }
}

#[test]
fn limits_choose_the_turn_and_are_reported() {
    let mut mechanism = shipped("bennett-double-spherical-6r");
    let joint = mechanism.legs[0].joints[1].clone().within(Some([3.5, 3.5 + TAU]));
    mechanism.legs[0].joints[1] = joint;
    let crank = mechanism.legs[0].joints[0].clone().within(Some([-1.0, 1.0]));
    mechanism.legs[0].joints[0] = crank;
    let linkage = compiled(&mechanism);
    let input = linkage.input("a1").unwrap();
    for position in input.solve(0.5) {
        assert!(position.within_limits && position.joints[1] >= 3.5);
    }
    assert!(input.solve(1.5).iter().all(|p| !p.within_limits));
    assert!(input.solve(1.5).len() == 4);
}

#[test]
fn other_mechanisms_are_refused_with_what_a_linkage_is() {
    for (name, legs) in [("plano-spherical-5dof", 4), ("translational-helical-3dof", 3)] {
        let error = Linkage::new(&shipped(name)).unwrap_err();
        assert_eq!(error, LinkageError::Legs(legs));
        assert!(error.to_string().contains("expected two"), "{error}");
    }
    // The actuator left out, and one leg left out.
    let mut mechanism = shipped("bennett-double-spherical-6r");
    mechanism.legs[0].joints[0].actuated = false;
    let error = Linkage::new(&mechanism).unwrap_err();
    assert!(matches!(error, LinkageError::Decompose(_)), "{error}");
}

#[test]
fn branches_are_named_by_their_signs() {
    let names: Vec<_> = SectionSigns::ALL.iter().map(ToString::to_string).collect();
    assert_eq!(names, ["+ +", "+ -", "- +", "- -"]);
}
