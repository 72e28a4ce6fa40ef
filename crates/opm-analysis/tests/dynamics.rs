//! Inverse dynamics, against Lagrange's equations of what moves: energies come from where bodies are, and their derivatives are
//! differences.

mod bodies;

use bodies::Bodies;
use fastrand::Rng;
use nalgebra::{DVector, Vector3};
use opm_analysis::{Gravity, JointMotion, Loads, Setup, Statics};
use opm_core::Manipulator;
use opm_core::mechanism::examples::{EXAMPLES, TEMPLATES};
use opm_core::skeleton::Density;

/// The generalised forces that a motion needs: `d/dt ∂T/∂v - ∂T/∂x + ∂U/∂x`.
fn lagrange(
    bodies: &Bodies<'_>,
    x: &DVector<f64>,
    v: &DVector<f64>,
    a: &DVector<f64>,
) -> Option<DVector<f64>> {
    const STEP: f64 = 1e-3;
    let unit = |j: usize| DVector::from_fn(x.len(), |i, _| f64::from(u8::from(i == j)));
    let mut forces = DVector::zeros(x.len());
    for j in 0..x.len() {
        // Quadratic in the rates: this difference is exact.
        let momentum = |t: f64| {
            let (x, v) = (x + v * t + a * (0.5 * t * t), v + a * t);
            Some(
                0.5 * (bodies.kinetic(&x, &(&v + unit(j)))?
                    - bodies.kinetic(&x, &(&v - unit(j)))?),
            )
        };
        let fourth = |f: &dyn Fn(f64) -> Option<f64>| {
            let [one, two] = [1.0, 2.0].map(|k| Some(f(k * STEP)? - f(-k * STEP)?));
            Some((8.0 * one? - two?) / (12.0 * STEP))
        };
        let along = |t: f64| {
            let moved = x + unit(j) * t;
            Some(bodies.kinetic(&moved, v)? - bodies.potential(&moved)?)
        };
        forces[j] = fourth(&momentum)? - fourth(&along)?;
    }
    Some(forces)
}

#[test]
fn efforts_are_those_of_lagranges_equations() {
    let mut rng = Rng::with_seed(50);
    let mut compared = 0;
    let mut left_out = Vec::new();
    for example in EXAMPLES.iter().chain(TEMPLATES) {
        let Ok(m) = Manipulator::example(example.name) else { continue };
        let length = m.characteristic_length();
        let gravity =
            Gravity { acceleration: Vector3::new(0.3, -0.5, -9.81), density: Density::default() };
        let setup = Setup { gravity: Some(gravity), ..Setup::new(length) };
        let mut loads = Loads::new(&m, &setup).unwrap();
        let mut statics = Statics::new(&m, length);
        let bodies = Bodies::new(&m, &gravity);
        let compared_before = compared;
        for _ in 0..3 {
            let mut any = |size: f64| -> DVector<f64> {
                let number = |c: &opm_core::task::TaskCoordinate| {
                    let unit = if c.quantity == opm_core::Quantity::Length { length } else { 1.0 };
                    size * unit * (2.0 * rng.f64() - 1.0)
                };
                DVector::from_iterator(
                    m.task_coordinates().len(),
                    m.task_coordinates().iter().map(number),
                )
            };
            let x = DVector::from_vec(m.home_pose()) + any(0.05);
            let (v, a) = (any(1.5), any(4.0));
            let Some(at) = bodies.solved(x.as_slice()) else { continue };
            let mut jacobians = m.jacobians();
            if !m.differentiate(&at, &mut jacobians).unwrap() || !statics.update(&at).unwrap() {
                continue;
            }
            // The accelerations of joints by differences of their rates.
            let rates_at = |t: f64| -> Option<DVector<f64>> {
                let (x, v) = (&x + &v * t + &a * (0.5 * t * t), &v + &a * t);
                let at = bodies.solved(x.as_slice())?;
                let mut jacobians = m.jacobians();
                m.differentiate(&at, &mut jacobians).ok()?;
                Some(jacobians.joints_by_pose() * v)
            };
            let h = 1e-4;
            let Some(rates) = rates_at(0.0) else { continue };
            let (Some(after), Some(before)) = (rates_at(h), rates_at(-h)) else { continue };
            let accelerations = (after - before) / (2.0 * h);
            let motion =
                JointMotion { rates: rates.as_slice(), accelerations: accelerations.as_slice() };
            let efforts = loads.efforts_in(&statics, &at, Some(motion));
            let known: Option<Vec<f64>> = efforts.actuated.iter().copied().collect();
            let (Some(efforts), Some(expected)) = (known, lagrange(&bodies, &x, &v, &a)) else {
                continue;
            };
            let by_pose = jacobians.joints_by_pose();
            let found = DVector::from_fn(x.len(), |j, _| {
                let each = m.actuated().iter().zip(&efforts);
                each.map(|(&i, effort)| by_pose[(i, j)] * effort).sum::<f64>()
            });
            let off = (&found - &expected).amax();
            let scale = expected.amax().max(1e-3);
            assert!(off < 2e-5 * scale, "{}: {found} {expected}", example.name);
            compared += 1;
        }
        if compared == compared_before {
            left_out.push(example.name);
        }
    }
    assert!(left_out.is_empty(), "no state compared: {left_out:?}");
    assert!(compared > 60, "{compared}");
}

/// A mass that hangs from a slider needs m (g + a), and one that a crank turns about its centre needs I α.
#[test]
fn a_weight_on_a_slider_needs_newtons_second_law() {
    let text = include_str!("lift.toml");
    let m = Manipulator::read(text).unwrap();
    let gravity = Gravity { acceleration: -9.81 * Vector3::z(), density: Density::default() };
    let setup = Setup { gravity: Some(gravity), ..Setup::new(1.0) };
    let mut loads = Loads::new(&m, &setup).unwrap();
    let mut statics = Statics::new(&m, 1.0);
    let at = m.solution();
    statics.update(&at).unwrap();
    let motion = JointMotion { rates: &[5.0, 5.0], accelerations: &[2.0, 2.0] };
    let work = loads.work_in(&statics, &at, Some(motion)).unwrap();
    assert!((work[0].abs() - 3.0 * (9.81 + 2.0)).abs() < 1e-9, "{work:?}");

    // A rotor of 1e-4 kg m² that turns 200 rad per metre is as heavy as 4 kg; friction is against the motion.
    let drive = "actuated = true, rotor_inertia = 1e-4, gear = 200, viscous_friction = 0.7, coulomb_friction = 11";
    let m = Manipulator::read(&text.replace("actuated = true", drive)).unwrap();
    let mut loads = Loads::new(&m, &setup).unwrap();
    let mut statics = Statics::new(&m, 1.0);
    let at = m.solution();
    statics.update(&at).unwrap();
    let work = loads.work_in(&statics, &at, Some(motion)).unwrap();
    // Both legs have such a motor.
    let expected = 3.0 * (9.81 + 2.0) + 2.0 * (4.0 * 2.0 + 0.7 * 5.0 + 11.0);
    assert!((work[0].abs() - expected).abs() < 1e-9, "{work:?} {expected}");
    assert!((loads.work(&statics, &at).unwrap()[0].abs() - 3.0 * 9.81).abs() < 1e-9);
}
