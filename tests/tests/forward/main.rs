//! Forward kinematics: what inverse kinematics made of a pose leads back to it, every assembly that is
//! found is one, and none is missing.

use fastrand::Rng;
use opm_core::forward::{Assembly, RESIDUAL};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::{examples, file};
use std::f64::consts::TAU;

pub fn example(name: &str) -> Manipulator {
    let text = examples::find(name).unwrap().text;
    Manipulator::new(file::read(text).unwrap().mechanism).unwrap()
}

/// A pose that is in reach in a random mode, and what inverse kinematics make of it.
pub fn reached(
    rng: &mut Rng,
    m: &Manipulator,
    reach: f64,
    size: f64,
) -> (Vec<f64>, Mode, Vec<f64>) {
    let mut all = m.all_modes();
    let mut solution = m.solution();
    loop {
        let pose: Vec<f64> = m
            .task_coordinates()
            .iter()
            .map(|c| {
                let scale = if c.quantity.unit() == "m" { size } else { 1.0 };
                c.home + reach * scale * (2.0 * rng.f64() - 1.0)
            })
            .collect();
        if !m.inverse_all(&pose, &mut all).unwrap() {
            continue;
        }
        let modes: Vec<Mode> = all.modes(m).collect();
        let mode = modes[rng.usize(..modes.len())];
        assert!(m.pick(&all, mode, &mut solution));
        let actuated = m.actuated().iter().map(|&i| solution.joints[i]).collect();
        return (pose, mode, actuated);
    }
}

pub fn apart(m: &Manipulator, a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (m.task().displacement(a), m.task().displacement(b));
    let p = m.mechanism().platform;
    a.rotation.angle_to(&b.rotation) + (a * p - b * p).norm()
}

pub fn turn(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(TAU);
    d.min(TAU - d)
}

/// The assembly is one: inverse kinematics at its pose in its mode give the joints.
pub fn check(m: &Manipulator, actuated: &[f64], a: &Assembly, tolerance: f64) {
    assert!(a.residual <= RESIDUAL, "{a:?}");
    let mut solution = m.solution();
    assert!(m.inverse(&a.pose, a.mode, &mut solution).unwrap());
    for (&i, &given) in m.actuated().iter().zip(actuated) {
        let off = match m.coordinates()[i].quantity.unit() {
            "rad" => turn(solution.joints[i], given),
            _ => (solution.joints[i] - given).abs(),
        };
        assert!(off < tolerance, "{} off by {off:e}", m.coordinates()[i].name);
    }
    for (i, (a, b)) in a.joints.iter().zip(&solution.joints).enumerate() {
        assert!((a - b).abs() < 1e-5, "{} {a} {b}", m.coordinates()[i].name);
    }
}

#[test]
fn explore() {
    let mut rng = Rng::with_seed(1);
    for example_ in examples::EXAMPLES {
        let name = example_.name;
        let Ok(m) = Manipulator::new(file::read(example_.text).unwrap().mechanism) else {
            continue;
        };
        println!("{name}: {:?}", m.forward_closed_form());
        if m.forward_closed_form().is_err() {
            continue;
        }
        let mut counts = std::collections::BTreeMap::new();
        let mut lost = 0;
        let mut worst = 0.0_f64;
        let start = std::time::Instant::now();
        let mut time = 0.0;
        for _ in 0..2000 {
            let (pose, mode, actuated) = reached(&mut rng, &m, 0.6, 0.15);
            let start = std::time::Instant::now();
            let found = m.forward(&actuated).unwrap();
            time += start.elapsed().as_secs_f64();
            let contains =
                found.list.iter().any(|a| a.mode == mode && apart(&m, &a.pose, &pose) < 1e-7);
            if !contains && found.loose.is_empty() {
                lost += 1;
                if lost < 4 {
                    println!(
                        "  lost {pose:?} {} {:?} {:?}",
                        m.format_mode(mode),
                        found.unmet,
                        found.loose
                    );
                    for a in &found.list {
                        println!("     {:?} {} {:e}", a.pose, m.format_mode(a.mode), a.residual);
                    }
                }
            }
            *counts.entry(found.list.len()).or_insert(0) += 1;
            for a in &found.list {
                worst = worst.max(a.residual);
                check(&m, &actuated, a, 1e-7);
            }
        }
        println!(
            "  lost {lost}, worst {worst:e}, counts {counts:?}, {:.1} us, {:?}",
            time * 5e2,
            start.elapsed()
        );
    }
}
