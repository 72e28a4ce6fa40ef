//! Forward kinematics at home, at singularities, at the boundary of reach, beyond it, and with
//! invalid values.

use super::{Reached, apart, check_all, example, unlimited};
use fastrand::Rng;
use nalgebra::DMatrix;
use opm_core::forward::{ForwardError, RESIDUAL, Unmet};
use opm_core::manipulator::{Manipulator, Section};
use opm_core::mechanism::joint::{Joint, JointKind};
use opm_core::mechanism::leg::Leg;
use opm_core::mechanism::{Mechanism, examples, file};
use std::f64::consts::FRAC_PI_4;

/// A double root is known to about the square root of rounding, and so is everything that depends
/// on it.
const DOUBLE: f64 = 1e-5;

#[test]
fn home_is_an_assembly() {
    for name in
        ["plano-spherical-5dof", "planar-planar-5dof", "double-spherical-5dof", "schoenflies-4dof"]
    {
        let m = example(name);
        let home: Vec<f64> = m.actuated().iter().map(|&i| m.coordinates()[i].home).collect();
        let found = m.forward(&home).unwrap();
        check_all(&m, &home, &found.list);
        // The coordinates agree too, not just the displacement: at the singularity of the Euler
        // angles they are home's.
        let at_home = found.list.iter().find(|a| {
            a.mode == m.home_mode() && {
                let off = a.pose.iter().zip(m.home_pose()).map(|(q, h)| (q - h).abs());
                off.fold(0.0, f64::max) < 1e-9
            }
        });
        assert!(at_home.is_some(), "{name}");
    }
}

/// With its motors at these multiples of 45 degrees, assemblies of the Agile Eye are roots of fourth order, which a
/// polynomial tells to the fourth root of rounding. They are found there, and at every distance from there.
#[test]
fn roots_of_fourth_order_are_found() {
    let m = example("agile-eye");
    let home: Vec<f64> = m.actuated().iter().map(|&i| m.coordinates()[i].home).collect();
    for signs in [[-1.0, 1.0, 1.0], [-1.0, -1.0, -1.0], [1.0, 1.0, -1.0]] {
        for distance in [0.0, 1e-12, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
            for aside in [[-0.21, 0.37, 1.0], [1.0, -0.4, 0.1], [0.3, 0.3, -1.0]] {
                let motor = |i: usize| home[i] + signs[i] * FRAC_PI_4 + distance * aside[i];
                let motors = [motor(0), motor(1), motor(2)];
                let found = m.forward(&motors).unwrap().list;
                assert!(found.len() >= 4, "{motors:?}: {}", found.len());
                assert!(found.iter().all(|assembly| assembly.residual <= RESIDUAL));
            }
        }
    }
}

/// The determinant of the actuated joints' rates by the section twist, in the home mode; `None` out
/// of reach.
fn determinant(m: &Manipulator, pose: &[f64]) -> Option<f64> {
    let mut solution = m.solution();
    m.inverse(pose, m.home_mode(), &mut solution).unwrap()?;
    let mut jacobians = m.jacobians();
    m.differentiate(&solution, &mut jacobians).unwrap().then(|| {
        let n = m.actuated().len();
        DMatrix::from_fn(n, n, |i, j| jacobians.joints[(m.actuated()[i], j)]).determinant()
    })
}

fn between(a: &[f64], b: &[f64], t: f64) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + t * (b - a)).collect()
}

/// Where the platform can move with the actuators held, two assemblies coincide. This one is found,
/// and near it both of them are.
#[test]
fn parallel_singularities_are_found() {
    let mut rng = Rng::with_seed(11);
    let (mut met, mut pairs) = (0, 0);
    for name in ["plano-spherical-5dof", "double-spherical-5dof"] {
        let m = example(name);
        let home = m.home_pose();
        for _ in 0..4_000 {
            let aim: Vec<f64> = home
                .iter()
                .enumerate()
                .map(|(i, h)| {
                    h + if i < m.task().lower_count { 0.03 } else { 1.5 } * (2.0 * rng.f64() - 1.0)
                })
                .collect();
            // The determinant of the inverse Jacobian is zero at parallel singularities and
            // infinite at serial ones.
            let at = |t: f64| determinant(&m, &between(&home, &aim, t));
            let steps: Vec<Option<f64>> = (1..=40).map(|i| at(f64::from(i) / 40.0)).collect();
            let crossing = steps.windows(2).position(
                |w| matches!(w, [Some(a), Some(b)] if a * b < 0.0 && a.abs().max(b.abs()) < 1.0),
            );
            let Some(crossing) = crossing else { continue };
            let (mut low, mut high) = ((crossing + 1) as f64 / 40.0, (crossing + 2) as f64 / 40.0);
            let Some(sign) = at(low).map(f64::signum) else { continue };
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if at(middle).is_some_and(|d| d.signum() == sign) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            if at(low).is_none_or(|d| d.abs() > 1e-6) {
                continue;
            }
            met += 1;
            let singular = Reached::at(&m, between(&home, &aim, low), m.home_mode()).unwrap();
            let found = m.forward(&singular.actuated).unwrap();
            let near = |pose: &[f64]| apart(&m, m.home_mode(), [pose, &singular.pose]);
            let nearest = found.list.iter().map(|a| near(&a.pose)).fold(1.0, f64::min);
            assert!(nearest < DOUBLE, "{name} {:?}: {nearest:e}", singular.pose);
            for a in &found.list {
                assert!(a.residual <= opm_core::forward::RESIDUAL);
            }
            // Near the singularity, each of the two assemblies is found.
            let aside = Reached::at(&m, between(&home, &aim, low - 1e-4), m.home_mode()).unwrap();
            let found = m.forward(&aside.actuated).unwrap();
            check_all(&m, &aside.actuated, &found.list);
            let close =
                found.list.iter().filter(|a| apart(&m, a.mode, [&a.pose, &aside.pose]) < 0.02);
            let modes = close.filter(|a| a.mode == aside.mode).count();
            assert!(
                found.list.iter().any(|a| apart(&m, a.mode, [&a.pose, &aside.pose]) < 1e-6),
                "{name}"
            );
            pairs += usize::from(modes == 2);
            if met % 40 == 0 {
                break;
            }
        }
    }
    println!("{met} singular poses, {pairs} pairs beside them");
    assert!(met >= 40 && 10 * pairs > 7 * met, "{met} {pairs}");
}

/// At the boundary of a leg's reach two working modes coincide, and rounding does not lose the
/// pose.
#[test]
fn the_boundary_of_reach_is_inside() {
    let mut rng = Rng::with_seed(12);
    let m = example("plano-spherical-5dof");
    let home = m.home_pose();
    let mut tried = 0;
    while tried < 200 {
        let aim: Vec<f64> = home
            .iter()
            .enumerate()
            .map(|(i, h)| h + if i < 2 { 0.6 } else { 2.0 } * (2.0 * rng.f64() - 1.0))
            .collect();
        if Reached::at(&m, aim.clone(), m.home_mode()).is_some() {
            continue;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if Reached::at(&m, between(&home, &aim, middle), m.home_mode()).is_some() {
                low = middle;
            } else {
                high = middle;
            }
        }
        tried += 1;
        let edge = Reached::at(&m, between(&home, &aim, low), m.home_mode()).unwrap();
        let found = m.forward(&edge.actuated).unwrap();
        let nearest =
            found.list.iter().map(|a| apart(&m, a.mode, [&a.pose, &edge.pose])).fold(1.0, f64::min);
        assert!(nearest < DOUBLE, "{:?}: {nearest:e}", edge.pose);
        assert!(found.list.iter().all(|a| a.residual <= opm_core::forward::RESIDUAL));
    }
}

/// The first leg's link and its carrier span a1 + a2 = 260 mm from the slider to P.
#[test]
fn out_of_reach_says_by_how_much() {
    let m = example("plano-spherical-5dof");
    let mut joints: Vec<f64> = m.actuated().iter().map(|&i| m.coordinates()[i].home).collect();
    joints[0] = 0.9;
    let found = m.forward(&joints).unwrap();
    assert!(found.list.is_empty() && found.loose.is_empty());
    // P = 0; the slider is at h e(30°) + S n(30°) with h = 120 mm.
    let expected = 0.12_f64.hypot(0.9) - 0.26;
    let [Unmet::Leg(unreachable)] = &found.unmet[..] else { panic!("{:?}", found.unmet) };
    assert_eq!((unreachable.leg, unreachable.section), (0, Some(Section::Lower)));
    assert!(
        (unreachable.deficit.excess - expected).abs() < 1e-12,
        "{}",
        unreachable.deficit.excess
    );
}

#[test]
fn values_that_make_no_sense_are_refused() {
    let m = example("plano-spherical-5dof");
    assert_eq!(m.forward(&[0.0; 4]), Err(ForwardError::Length { given: 4, expected: 5 }));
    for value in [f64::NAN, f64::INFINITY, 1e300] {
        let error = m.forward(&[0.1, value, 0.1, 0.1, 0.1]).unwrap_err();
        assert!(matches!(&error, ForwardError::NotFinite { name, .. } if name == "S2"), "{error}");
    }
    // Large values have an answer: there is no assembly.
    for value in [1e3, 1e20, 1e70] {
        let found = m.forward(&[0.1, value, 0.1, 0.1, 0.1]).unwrap();
        assert!(found.list.is_empty() && !found.unmet.is_empty(), "{value}");
    }
}

/// Two equal rods side by side constrain no more than one does.
#[test]
fn rods_side_by_side_leave_the_platform_loose() {
    let m = example("planar-planar-5dof");
    // In this mode the rods of legs 1 and 3, hinged to the platform on one axis, are side by side.
    let mode = m.parse_mode("+- -- +- ++").unwrap();
    let reached = Reached::at(&m, m.home_pose(), mode).unwrap();
    let found = m.forward(&reached.actuated).unwrap();
    assert_eq!(found.loose, [Section::Upper]);
}

/// There is one actuator more than freedoms: consistent values have their assemblies, others
/// contradict each other.
#[test]
fn more_motors_than_freedoms() {
    let text = examples::find("plano-spherical-5dof").unwrap().text;
    let mut mechanism = unlimited(file::read(text).unwrap().mechanism);
    mechanism.legs[0].joints[1].actuated = true;
    let m = Manipulator::new(mechanism).unwrap();
    let mut rng = Rng::with_seed(13);
    for _ in 0..200 {
        let reached = Reached::random(&mut rng, &m, [0.8, 0.1]);
        let found = m.forward(&reached.actuated).unwrap();
        check_all(&m, &reached.actuated, &found.list);
        assert!(reached.is_in(&m, &found.list));
        // The first leg's slider and link are unchanged; moving the link alone is a contradiction.
        let mut wrong = reached.actuated.clone();
        wrong[1] += 0.1;
        let found = m.forward(&wrong).unwrap();
        assert!(found.list.is_empty(), "{:?}", found.list);
        assert!(found.unmet.contains(&Unmet::Contradiction), "{:?}", found.unmet);
    }
}

/// A planar 3-RPR with a turntable on top and actuated telescopes. The conditions of lower sections
/// with one imaginary joint are circles, or lines if the first joint is actuated instead.
#[test]
fn planar_platforms_have_at_most_six_assemblies() {
    let mut rng = Rng::with_seed(14);
    let (mut most, mut solved) = (0, 0);
    for _ in 0..200 {
        let Some(m) = turntable(&mut rng) else { continue };
        assert_eq!(m.forward_closed_form(), Ok(()));
        for _ in 0..5 {
            let reached = Reached::random(&mut rng, &m, [1.0, 0.1]);
            let found = m.forward(&reached.actuated).unwrap();
            assert!(found.loose.is_empty());
            check_all(&m, &reached.actuated, &found.list);
            assert!(reached.is_in(&m, &found.list), "{:?}", reached.pose);
            // For x, y and theta, the screw has two ways to follow.
            let mut places: Vec<&[f64]> = Vec::new();
            for a in &found.list {
                let apart = |p: &&[f64]| p.iter().zip(&a.pose).any(|(p, q)| (p - q).abs() > 1e-6);
                if places.iter().all(apart) {
                    places.push(&a.pose[..3]);
                }
            }
            most = most.max(places.len());
            solved += 1;
        }
    }
    println!("{solved} solved, at most {most} places of the platform");
    assert!(solved > 500 && (3..=6).contains(&most), "{solved} {most}");
}

/// Planar legs with a slider across the plane at their ends, all with the same direction and
/// attached to the platform. Three of them hold the plane, the fourth one has a screw.
fn turntable(rng: &mut Rng) -> Option<Manipulator> {
    use nalgebra::{Point3, Unit, Vector3};
    let z = Vector3::z_axis();
    let x = Vector3::x_axis();
    let mut legs = Vec::new();
    for number in 1..=4 {
        let angle = 1.5 * f64::from(number) + 0.4 * rng.f64();
        let foot = Point3::new(0.4 * angle.cos(), 0.4 * angle.sin(), 0.0);
        let hip = Point3::new(0.1 * rng.f64() - 0.05, 0.1 * rng.f64() - 0.05, 0.0);
        let knee = Point3::from(
            (foot.coords + hip.coords) / 2.0 + Vector3::new(0.1 * rng.f64(), 0.1, 0.0),
        );
        let axis = Unit::new_normalize(hip - foot);
        let name = |part: &str| format!("{part}{number}");
        let revolute =
            |part: &str, at: Point3<f64>| Joint::new(name(part), JointKind::Revolute, z, at);
        // A leg has a telescope or two links; of two links, the first or the second joint is
        // actuated.
        let mut joints = match rng.usize(..3) {
            0 => vec![
                revolute("a", foot),
                Joint::new(name("b"), JointKind::Prismatic, axis, foot).actuated(),
                revolute("c", hip),
            ],
            1 => vec![revolute("a", foot).actuated(), revolute("b", knee), revolute("c", hip)],
            _ => vec![
                Joint::new(name("a"), JointKind::Prismatic, axis, foot).actuated(),
                revolute("b", knee),
                revolute("c", hip),
            ],
        };
        // A shaft along x, with bearings and one thread.
        let kind =
            if number == 4 { JointKind::Helical { pitch: 0.02 } } else { JointKind::Revolute };
        joints.push(Joint::new(name("d"), kind, x, Point3::origin()));
        legs.push(Leg::new(name("leg"), joints));
    }
    let mechanism = Mechanism {
        name: "turntable".to_owned(),
        legs,
        platform: Point3::origin(),
        differences: Vec::new(),
        task: Default::default(),
        bodies: Default::default(),
        shapes: Default::default(),
        units: Default::default(),
    };
    Manipulator::new(mechanism).ok()
}
