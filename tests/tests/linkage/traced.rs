//! Loops that are traced: against sections, where a loop has both; against published closure equations and plain geometry; and
//! against the numeric solver on loops of other joints.

use super::numeric::{Closure, SAME};
use super::random::{PATTERNS, direction, displacement, linkage};
use super::{open, shipped};
use fastrand::Rng;
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use opm_core::linkage::{Input, InputRange, Linkage, LinkageError, Position, Stuck};
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, TaskHints};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The bound on closure, metres: the loops measure a few metres.
const CLOSURE: f64 = 1e-9;

/// A loop of these legs; the platform is at the origin at home.
fn of_legs(legs: [Vec<Joint>; 2]) -> Mechanism {
    let [one, two] = legs;
    let mut mechanism = shipped("bennett-double-spherical-6r");
    mechanism.legs = vec![Leg::new("one", one), Leg::new("two", two)];
    mechanism.task = TaskHints::default();
    mechanism
}

/// A link in Hartenberg and Denavit's notation: `Rz(θ) Tz(d) Tx(a) Rx(α)`, and θ at home.
#[derive(Clone, Copy)]
struct Link {
    a: f64,
    alpha: f64,
    d: f64,
    theta: f64,
}

/// A loop of revolutes by its links, which close at home. The first half of the joints is the first leg; the axes of the second
/// one point back, so that every displacement is that of its θ.
fn of_links(links: &[Link]) -> Mechanism {
    let mut frames = vec![Isometry3::identity()];
    for Link { a, alpha, d, theta } in links {
        let turn = |axis: Vector3<f64>, angle: f64| {
            Isometry3::from_parts(
                Translation3::identity(),
                UnitQuaternion::from_scaled_axis(axis * angle),
            )
        };
        let last = frames[frames.len() - 1];
        frames.push(
            last * turn(Vector3::z(), *theta)
                * Translation3::new(*a, 0.0, *d)
                * turn(Vector3::x(), *alpha),
        );
    }
    let end = frames[links.len()];
    assert!((end.to_homogeneous() - nalgebra::Matrix4::identity()).norm() < 1e-9, "{end}");
    let joint = |i: usize, sign: f64| {
        let axis = nalgebra::Unit::new_normalize(frames[i].rotation * Vector3::z() * sign);
        let name = format!("r{}", i + 1);
        let joint =
            Joint::new(name, JointKind::Revolute, axis, frames[i].translation.vector.into());
        if i == 0 { joint.actuated() } else { joint }
    };
    let half = links.len() / 2;
    let one = (0..half).map(|i| joint(i, 1.0)).collect();
    let two = (half..links.len()).rev().map(|i| joint(i, -1.0)).collect();
    of_legs([one, two])
}

/// The values of θ at a position, in the order of the loop.
fn thetas(links: &[Link], position: &Position) -> Vec<f64> {
    let half = links.len() / 2;
    let (one, two) = position.joints.split_at(half);
    let all = one.iter().chain(two.iter().rev());
    all.zip(links).map(|(q, link)| link.theta + q).collect()
}

fn traced(mechanism: &Mechanism) -> Linkage {
    let linkage = Linkage::traced(mechanism).unwrap_or_else(|error| panic!("{error}"));
    assert!(linkage.is_traced());
    linkage
}

/// Two loops of two sections have the same positions and ranges, in closed form and traced.
#[test]
fn sections_have_the_same_positions() {
    let mut rng = Rng::with_seed(300);
    let mut compared = 0;
    for pattern in PATTERNS {
        let mechanism = linkage(&mut rng, pattern);
        let (sections, traced) = (Linkage::new(&mechanism).unwrap(), traced(&mechanism));
        assert!(!sections.is_traced());
        for (number, c) in sections.coordinates().iter().enumerate() {
            let [one, two] = [&sections, &traced].map(|linkage| linkage.input(&c.name).unwrap());
            let closure = Closure::new(&mechanism, number);
            same_ranges(&one, &two);
            for _ in 0..6 {
                let value = c.home + (rng.f64() * 2.0 - 1.0) * PI;
                let [one, two] = [&one, &two].map(|input| input.solve(value));
                assert_eq!(one.len(), two.len(), "{pattern:?} {} = {value}", c.name);
                for position in &one {
                    let near = |other: &&Position| {
                        closure.distance(&position.joints, &other.joints) < 1e-7
                    };
                    assert_eq!(two.iter().filter(near).count(), 1, "{pattern:?}");
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} positions");
    assert!(compared > 300, "{compared}");
}

fn same_ranges(one: &Input<'_>, two: &Input<'_>) {
    match (one.range(), two.range()) {
        (InputRange::FullTurn, InputRange::FullTurn) => {}
        (
            InputRange::Intervals { intervals: one, period: first },
            InputRange::Intervals { intervals: two, period: second },
        ) => {
            assert_eq!((one.len(), first), (two.len(), second), "{one:?} {two:?}");
            for (a, b) in one.as_flattened().iter().zip(two.as_flattened()) {
                assert!((a - b).abs() < 1e-8, "{one:?} {two:?}");
            }
        }
        (one, two) => panic!("{one:?} {two:?}"),
    }
}

/// `tan(θ₁/2) tan(θ₂/2) = sin((β + α)/2) / sin((β − α)/2)` (Bennett 1903), with `a / sin α = b / sin β`.
#[test]
fn bennett() {
    for (alpha, beta) in [(0.5, 1.2), (0.9, 2.0), (FRAC_PI_2, 1.0)] {
        let product = f64::sin(0.5 * (beta + alpha)) / f64::sin(0.5 * (beta - alpha));
        let other = |theta: f64| 2.0 * (product / f64::tan(0.5 * theta)).atan();
        let home = 1.1;
        let links: Vec<Link> = (0..4)
            .map(|i| {
                let twist = if i % 2 == 0 { alpha } else { beta };
                let theta = [home, other(home), -home, -other(home)][i];
                Link { a: 0.7 * twist.sin(), alpha: twist, d: 0.0, theta }
            })
            .collect();
        let linkage = traced(&of_links(&links));
        let input = linkage.input("r1").unwrap();
        assert!(input.range().is_full_turn());
        for step in 0..40 {
            let value = 0.05 + 0.157 * f64::from(step);
            let found = input.solve(value);
            let theta = home + value;
            let expected = [theta, other(theta), -theta, -other(theta)];
            let there = found.iter().any(|position| {
                let all = thetas(&links, position);
                all.iter().zip(expected).all(|(a, b)| (0.5 * (a - b)).sin().abs() < 1e-9)
            });
            assert!(there, "{alpha} {beta} {theta}");
        }
    }
}

/// Goldberg's 5R (1943): two of Bennett's linkages on one link, with the links beside it joined, and the common link taken out. With
/// the joined links at the angle φ of one, the other joints turn as in the two.
#[test]
fn goldberg() {
    let (alpha, sides) = (0.5_f64, [1.2_f64, 2.0]);
    let other = |beta: f64, theta: f64| {
        let product = f64::sin(0.5 * (beta + alpha)) / f64::sin(0.5 * (beta - alpha));
        2.0 * (product / f64::tan(0.5 * theta)).atan()
    };
    let homes = [1.1, 1.7];
    // The axes B C D of each, seen from the common link: A B C D are the axes of a loop, and the common link is A B.
    let axes = |number: usize| -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let (beta, home) = (sides[number], homes[number]);
        let across = other(beta, home);
        let links = [(alpha, home), (beta, across), (alpha, -home), (beta, -across)];
        let mut frame = Isometry3::identity();
        let mut frames = Vec::new();
        for (twist, theta) in links {
            frames.push(frame);
            let turn =
                |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle);
            frame = frame
                * turn(Vector3::z(), theta)
                * Translation3::new(0.7 * twist.sin(), 0.0, 0.0)
                * turn(Vector3::x(), twist);
        }
        // Turned back by the first joint, the common link stands still.
        let back = UnitQuaternion::from_scaled_axis(Vector3::z() * -homes[number]);
        let axis = |frame: &Isometry3<f64>| {
            let seen = back * frame;
            (seen.rotation * Vector3::z(), seen.translation.vector)
        };
        frames.iter().map(axis).collect()
    };
    let [one, two] = [axes(0), axes(1)];
    assert!((one[1].1 - two[1].1).norm() < 1e-12, "the common link is one");
    let joint = |name: &str, (axis, at): &(Vector3<f64>, Vector3<f64>), sign: f64| {
        let axis = nalgebra::Unit::new_normalize(axis * sign);
        Joint::new(name, JointKind::Revolute, axis, Point3::from(*at))
    };
    // From the joined links: D C B of the first linkage, and D C of the second one.
    let first = vec![
        joint("d1", &one[3], 1.0).actuated(),
        joint("c1", &one[2], 1.0),
        joint("b", &one[1], 1.0),
    ];
    let second = vec![joint("d2", &two[3], 1.0), joint("c2", &two[2], 1.0)];
    let linkage = traced(&of_legs([first, second]));
    let input = linkage.input("d1").unwrap();
    let (mut position, mut moved) = (input.home(), 0);
    for step in -20..=20 {
        // Both angles at A change by the same.
        let by = 0.04 * f64::from(step);
        let [a, b] = [0, 1].map(|i| {
            let (beta, home) = (sides[i], homes[i]);
            other(beta, home + by) - other(beta, home)
        });
        // Opposite joints turn alike: at C as at A, at D as at B.
        if !input.position(a, input.home_branch(), &mut position) {
            continue;
        }
        let turned = |i: usize| position.joints[i].abs();
        let expected = [a.abs(), by.abs(), (a - b).abs(), b.abs(), by.abs()];
        let off = expected.iter().enumerate().map(|(i, e)| (turned(i) - e).abs());
        assert!(off.fold(0.0, f64::max) < 1e-8, "{by}: {:?} {expected:?}", position.joints);
        moved += 1;
    }
    assert!(moved > 30, "{moved}");
}

/// `cos²α + sin²α (cos θ + cos φ) + (1 + cos²α) cos θ cos φ − 2 cos α sin θ sin φ = 0` for alternating angles (Chen, You and Tarnai,
/// "Threefold-symmetric Bricard linkages for deployable structures", Int. J. Solids and Structures 42, 2005).
#[test]
fn threefold_symmetric_bricard() {
    for alpha in [1.2, FRAC_PI_2, 2.0] {
        let (sin, cos) = f64::sin_cos(alpha);
        let open = |theta: f64, phi: f64| {
            cos * cos
                + sin * sin * (theta.cos() + phi.cos())
                + (1.0 + cos * cos) * theta.cos() * phi.cos()
                - 2.0 * cos * theta.sin() * phi.sin()
        };
        // Away from where the paths of such a linkage cross.
        let theta = 0.8;
        let mut phi = 2.2;
        for _ in 0..50 {
            phi -= open(theta, phi) / ((open(theta, phi + 1e-6) - open(theta, phi - 1e-6)) / 2e-6);
        }
        let links: Vec<Link> = (0..6)
            .map(|i| {
                let even = i % 2 == 0;
                let (alpha, theta) = if even { (alpha, theta) } else { (-alpha, phi) };
                Link { a: 0.5, alpha, d: 0.0, theta }
            })
            .collect();
        let linkage = traced(&of_links(&links));
        let input = linkage.input("r1").unwrap();
        let mut home = 0;
        for step in 0..60 {
            let value = 0.011 + TAU * f64::from(step) / 60.0;
            let mut position = input.home();
            if input.position(value, input.home_branch(), &mut position) {
                let all = thetas(&links, &position);
                assert!(open(all[0], all[1]).abs() < 1e-8, "{alpha} {all:?}");
                home += 1;
            }
        }
        assert!(home > 10, "{alpha}: {home}");
    }
}

/// Hooke's joint: `tan φ = tan θ cos β` between shafts at an angle β, where the first pin is across both at home.
#[test]
fn hookes_joint() {
    let beta: f64 = 0.6;
    let shaft = Vector3::new(beta.sin(), 0.0, beta.cos());
    let about = |name: &str, axis: Vector3<f64>| {
        Joint::new(name, JointKind::Revolute, nalgebra::Unit::new_normalize(axis), Point3::origin())
    };
    // At home the first fork's pin is along y, across both shafts; the second fork's along its crossing.
    let one = vec![about("in", Vector3::z()).actuated(), about("pin", Vector3::y())];
    let cross = shaft.cross(&Vector3::y());
    let two = vec![about("out", shaft), about("pin2", cross)];
    let linkage = traced(&of_legs([one, two]));
    let input = linkage.input("in").unwrap();
    assert!(input.range().is_full_turn());
    for step in 0..50 {
        let theta = 0.03 + 0.12 * f64::from(step);
        let out = input.solve(theta).iter().map(|p| p.joints[2]).collect::<Vec<_>>();
        assert!(!out.is_empty());
        for phi in out {
            let off = (phi.tan() - theta.tan() * beta.cos()).abs();
            assert!(off < 1e-8 * (1.0 + theta.tan().powi(2)), "{theta} {phi}");
        }
    }
}

/// A crank and a rocker with a rod between two balls: `|A(θ) − B(φ)|` is the rod's length, at most two φ for each θ.
#[test]
fn cranks_with_a_rod_between_two_balls() {
    let mut rng = Rng::with_seed(301);
    let (mut closed, mut open_there) = (0, 0);
    for _ in 0..12 {
        let point = |rng: &mut Rng| Point3::from(displacement(rng).translation.vector);
        let [p, a, b, r] = [0; 4].map(|_| point(&mut rng));
        let [u, w] = [direction(&mut rng), direction(&mut rng)];
        let ball = |name: &str, at| Joint::new(name, JointKind::Spherical, Vector3::z_axis(), at);
        let crank = Joint::new("in", JointKind::Revolute, u, p).actuated();
        let rocker = Joint::new("out", JointKind::Revolute, w, r);
        // The rod is the platform, or a link of one leg.
        let mechanism = if rng.bool() {
            of_legs([vec![crank, ball("one", a)], vec![rocker, ball("two", b)]])
        } else {
            of_legs([vec![crank], vec![rocker, ball("two", b), ball("one", a)]])
        };
        let linkage = traced(&mechanism);
        let input = linkage.input("in").unwrap();
        let out = linkage.coordinates().iter().position(|c| c.name == "out").unwrap();
        for _ in 0..30 {
            let theta = (2.0 * rng.f64() - 1.0) * PI;
            let tip = p + Rotation3::from_axis_angle(&u, theta) * (a - p);
            // B(φ) = r + k (k·c) + (c − k (k·c)) cos φ + k × c sin φ.
            let (k, c) = (w.into_inner(), b - r);
            let (along, across) = (k * k.dot(&c), k.cross(&c));
            let from = r + along - tip;
            let (x, y) = (2.0 * from.dot(&(c - along)), 2.0 * from.dot(&across));
            let z = from.norm_squared() + (c - along).norm_squared() - (a - b).norm_squared();
            let far = (x * x + y * y).sqrt();
            let mut expected = Vec::new();
            if z.abs() <= far {
                let (middle, half) = (y.atan2(x), (-z / far).acos());
                expected = vec![middle + half, middle - half];
                closed += 1;
            } else {
                open_there += 1;
            }
            let found = input.solve(theta);
            assert_eq!(found.len(), expected.len(), "{theta}: {expected:?}");
            for phi in expected {
                let near = |p: &&Position| (0.5 * (p.joints[out] - phi)).sin().abs() < 1e-7;
                assert_eq!(found.iter().filter(near).count(), 1, "{theta} {phi}");
            }
            found.iter().for_each(|p| assert!(open(&mechanism, p) < CLOSURE));
        }
    }
    assert!(closed > 50 && open_there > 20, "{closed} {open_there}");
}

/// Loops of seven joints in general position, with and without sliders, cylinders and a universal joint: as many positions as the
/// numeric solver finds, and closed.
#[test]
fn the_numeric_solver_finds_no_other_position() {
    let mut rng = Rng::with_seed(302);
    let mut total = [0, 0];
    for kinds in ["RRR RRRR", "RRR RPRR", "RPR RPRR", "RCR RRR", "RUR RC", "RCC C", "RUS R"] {
        let mechanism = random(&mut rng, kinds);
        let linkage = traced(&mechanism);
        let input = linkage.input("j0").unwrap();
        let closure = Closure::new(&mechanism, 0);
        for _ in 0..2 {
            let value = 0.6 * (2.0 * rng.f64() - 1.0);
            let positions = input.solve(value);
            for position in &positions {
                assert!(open(&mechanism, position) < CLOSURE * 10.0, "{kinds}");
                assert!(closure.solve(value, &position.joints).is_some());
            }
            if kinds.contains('S') {
                continue; // Rotation vectors are not compared by their coordinates.
            }
            for found in closure.all(value, 60, &mut rng) {
                let far = found.iter().zip(linkage.coordinates());
                if far
                    .clone()
                    .any(|(q, c)| c.quantity == opm_core::Quantity::Length && q.abs() > 100.0)
                {
                    continue;
                }
                let near = |p: &&Position| closure.distance(&p.joints, &found) < SAME;
                assert_eq!(positions.iter().filter(near).count(), 1, "{kinds} {value} {found:?}");
                total[0] += 1;
            }
            total[1] += positions.len();
        }
    }
    println!("{total:?}");
    assert!(total[0] > 20, "{total:?}");
}

/// A loop of joints in general position.
fn random(rng: &mut Rng, kinds: &str) -> Mechanism {
    let mut number = 0;
    let mut leg = |kinds: &str| -> Vec<Joint> {
        kinds
            .chars()
            .map(|kind| {
                let axis = direction(rng);
                let kind = match kind {
                    'R' => JointKind::Revolute,
                    'P' => JointKind::Prismatic,
                    'C' => JointKind::Cylindrical,
                    'U' => {
                        let second = axis.cross(&direction(rng));
                        JointKind::Universal { second: nalgebra::Unit::new_normalize(second) }
                    }
                    'S' => JointKind::Spherical,
                    _ => unreachable!(),
                };
                let at = Point3::from(displacement(rng).translation.vector);
                let joint = Joint::new(format!("j{number}"), kind, axis, at);
                number += 1;
                if number == 1 { joint.actuated() } else { joint }
            })
            .collect()
    };
    let (one, two) = kinds.split_once(' ').unwrap();
    of_legs([leg(one), leg(two)])
}

/// Along a cycle every joint goes on by small steps, the loop stays closed, and ends where it began; rates are differences.
#[test]
fn a_cycle_comes_home_and_rates_are_differences() {
    let mut rng = Rng::with_seed(303);
    let mut rated = 0;
    for kinds in ["RRR RRRR", "RRR RRRR", "RUS R", "RUR RRR", "RCR RRR"] {
        let mechanism = random(&mut rng, kinds);
        let linkage = traced(&mechanism);
        let input = linkage.input("j0").unwrap();
        let Ok(cycle) = input.cycle() else { continue };
        let mut position = input.home();
        let count = 4_000;
        for number in 0..=count {
            let before = position.clone();
            let (value, branch) = cycle.at(f64::from(number) / f64::from(count));
            assert!(input.position_near(value, branch, &mut position), "{kinds} {number}");
            assert!(open(&mechanism, &position) < CLOSURE * 10.0, "{kinds}");
            let step = before.joints.iter().zip(&position.joints).map(|(a, b)| (a - b).abs());
            assert!(kinds.contains('S') || step.fold(0.0, f64::max) < 0.5, "{kinds} {number}");
            let step = 1e-6;
            let [mut less, mut more] = [position.clone(), position.clone()];
            if number % 200 == 100
                && input.position_near(value - step, branch, &mut less)
                && input.position_near(value + step, branch, &mut more)
                && let Some(rates) = input.rates(&position)
            {
                // Near a fold, differences are not rates.
                if rates.joints.iter().any(|rate| rate.abs() > 5.0) {
                    continue;
                }
                for ((rate, a), b) in rates.joints.iter().zip(&less.joints).zip(&more.joints) {
                    let difference = (b - a) / (2.0 * step);
                    let off = (rate - difference).abs() / (1.0 + rate.powi(2));
                    assert!(off < 1e-5, "{kinds} {number}: {rate} {difference}");
                }
                rated += 1;
            }
        }
        for (c, q) in linkage.coordinates().iter().zip(&position.joints) {
            let off = if c.quantity == opm_core::Quantity::Angle && !c.name.contains('.') {
                (0.5 * (q - c.home)).sin().abs()
            } else {
                (q - c.home).abs()
            };
            assert!(off < 1e-6, "{kinds} {}: {q}", c.name);
        }
    }
    assert!(rated > 30, "{rated}");
}

#[test]
fn loops_that_one_joint_does_not_move_are_refused() {
    let mut rng = Rng::with_seed(304);
    let stuck = |mechanism: &Mechanism| match Linkage::traced(mechanism) {
        Err(LinkageError::Stuck(why)) => why,
        other => panic!("{other:?}"),
    };
    assert_eq!(stuck(&random(&mut rng, "RRR RRR")), Stuck::Rigid);
    assert_eq!(stuck(&random(&mut rng, "RRR RRRRR")), Stuck::Several(2));
    // Three parallel axes in a plane: a flat triangle moves at first order only.
    let at = |name: &str, x| {
        Joint::new(name, JointKind::Revolute, Vector3::z_axis(), Point3::new(x, 0.0, 0.0))
    };
    let flat = of_legs([vec![at("a", 0.0).actuated(), at("b", 1.0)], vec![at("c", 3.0)]]);
    assert_eq!(stuck(&flat), Stuck::FirstOrder);
}
