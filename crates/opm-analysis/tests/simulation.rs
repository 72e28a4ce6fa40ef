//! Motion under efforts: energy, decay by friction, and the linear model.

mod bodies;

use bodies::Bodies;
use nalgebra::{DVector, Vector3};
use opm_analysis::{Dynamics, Gravity, Setup, SimulationError, State};
use opm_core::Manipulator;
use opm_core::mechanism::joint::Drive;
use opm_core::skeleton::Density;

fn gravity() -> Gravity {
    Gravity { acceleration: Vector3::new(1.0, -2.0, -9.81), density: Density::default() }
}

fn setup(m: &Manipulator) -> Setup {
    Setup { gravity: Some(gravity()), ..Setup::new(m.characteristic_length()) }
}

fn numbers(count: usize, of: impl Fn(usize) -> f64) -> DVector<f64> {
    DVector::from_fn(count, |i, _| of(i))
}

/// A state near home.
/// Efforts without an error.
fn free(efforts: DVector<f64>) -> Result<DVector<f64>, SimulationError> {
    Ok(efforts)
}

fn start(m: &Manipulator) -> State {
    let home = m.home_pose();
    State {
        pose: numbers(home.len(), |i| home[i] + 0.02 + 0.004 * i as f64),
        rates: numbers(home.len(), |i| 0.1 - 0.05 * i as f64),
    }
}

#[test]
fn energy_is_kept() {
    for name in ["delta", "stewart", "plano-spherical-5dof", "five-bar", "3-rps"] {
        let m = Manipulator::example(name).unwrap();
        let bodies = Bodies::new(&m, &gravity());
        let mut dynamics = Dynamics::new(&m, &setup(&m));
        let none = DVector::zeros(m.actuated().len());
        let times: Vec<f64> = (0..=6).map(|i| 0.01 * f64::from(i)).collect();
        let pushed = |_: usize, _: &State| free(none.clone());
        let run = dynamics.simulate(start(&m), m.home_mode(), (&times, 1e-10), pushed);
        let (states, Ok(())) = run else { panic!("{name}") };
        let energy = |s: &State| {
            [bodies.kinetic(&s.pose, &s.rates).unwrap(), bodies.potential(&s.pose).unwrap()]
        };
        let [kinetic, potential] = energy(&states[0]);
        let last = energy(&states[6]);
        // That of the differences.
        let off = (last[0] + last[1] - kinetic - potential).abs();
        assert!(off < 1e-7 * last[0].max(kinetic), "{name}: {off} {last:?}");
        assert!((last[0] - kinetic).abs() > 1e-2 * kinetic, "{name}");
    }
}

/// A slider with viscous friction: its speed decays by `exp(-d t / m)`.
#[test]
fn friction_brakes() {
    let drive = "actuated = true, viscous_friction = 3";
    let text = include_str!("lift.toml").replace("actuated = true", drive);
    let m = Manipulator::read(&text).unwrap();
    let weightless = Gravity { acceleration: Vector3::zeros(), ..Gravity::default() };
    let mut dynamics = Dynamics::new(&m, &Setup { gravity: Some(weightless), ..setup(&m) });
    let state = State { pose: numbers(1, |_| 0.0), rates: numbers(1, |_| 2.0) };
    let pushed = |_: usize, _: &State| free(DVector::zeros(2));
    let (states, ended) = dynamics.simulate(state, m.home_mode(), (&[0.0, 0.5], 1e-10), pushed);
    ended.unwrap();
    let decay = (-2.0 * 3.0 * 0.5 / 3.0_f64).exp();
    assert!((states[1].rates[0] - 2.0 * decay).abs() < 1e-8, "{states:?}");
    assert!((states[1].pose[0] - 2.0 * 0.5 * (1.0 - decay)).abs() < 1e-8, "{states:?}");
}

/// What is pushed a little differs as the exponential of the linear model says.
#[test]
fn small_motions_are_those_of_the_linear_model() {
    const TIME: f64 = 0.02;
    const SMALL: f64 = 1e-6;
    for name in ["delta", "stewart", "plano-spherical-5dof", "five-bar", "tricept"] {
        let m = Manipulator::example(name).unwrap();
        let mut mechanism = m.mechanism().clone();
        for c in
            mechanism.legs.iter_mut().flat_map(|l| &mut l.joints).flat_map(|j| &mut j.coordinates)
        {
            c.drive = Drive {
                rotor_inertia: 1e-5,
                gear: 20.0,
                viscous_friction: 0.2,
                coulomb_friction: 0.0,
            };
        }
        let m = Manipulator::new(mechanism).unwrap();
        let mut dynamics = Dynamics::new(&m, &setup(&m));
        let (n, actuators) = (dynamics.freedoms(), m.actuated().len());
        let State { pose, .. } = start(&m);
        let rest = State { pose, rates: DVector::zeros(n) };
        let mut at = m.solution();
        m.inverse(rest.pose.as_slice(), m.home_mode(), &mut at).unwrap().expect("in reach");
        assert!(dynamics.update(&at).unwrap());
        let Some(holding) = dynamics.inverse(&rest.rates, &rest.rates) else { panic!("{name}") };
        let model = dynamics.linear_model(&rest, m.home_mode(), &holding).unwrap().unwrap();
        assert!(model.accelerations.amax() < 1e-8, "{name}: {}", model.accelerations);
        // From a state beside it, with other efforts.
        let off = numbers(2 * n, |i| SMALL * [1.0, -0.7, 0.4][i % 3]);
        let more = numbers(actuators, |i| 100.0 * SMALL * [1.0, -0.5][i % 2]);
        let size = 2 * n + 1;
        let mut whole = nalgebra::DMatrix::zeros(size, size);
        whole.view_mut((0, 0), (2 * n, 2 * n)).copy_from(&model.a);
        whole.view_mut((0, 2 * n), (2 * n, 1)).copy_from(&(&model.b * &more));
        let flow = (whole * TIME).exp();
        let expected = flow.view((0, 0), (2 * n, 2 * n)) * &off + flow.view((0, 2 * n), (2 * n, 1));
        let moved =
            State { pose: &rest.pose + off.rows(0, n), rates: &rest.rates + off.rows(n, n) };
        let pushed = |_: usize, _: &State| free(&holding + &more);
        let run = dynamics.simulate(moved, m.home_mode(), (&[0.0, TIME], 1e-13), pushed);
        let (states, Ok(())) = run else { panic!("{name}") };
        for i in 0..n {
            for (found, expected) in [
                (states[1].pose[i] - rest.pose[i], expected[i]),
                (states[1].rates[i], expected[n + i]),
            ] {
                let scale = off.amax().max(expected.abs());
                assert!((found - expected).abs() < 2e-3 * scale, "{name}: {found} {expected}");
            }
        }
    }
}

#[test]
fn a_motion_ends_where_the_mechanism_does() {
    let m = Manipulator::example("delta").unwrap();
    let mut dynamics = Dynamics::new(&m, &setup(&m));
    let times: Vec<f64> = (0..=40).map(|i| 0.05 * f64::from(i)).collect();
    let pushed = |_: usize, _: &State| free(DVector::zeros(3));
    let run = dynamics.simulate(start(&m), m.home_mode(), (&times, 1e-8), pushed);
    let (states, Err(error)) = run else { panic!("it falls for ever") };
    assert!(
        matches!(error, SimulationError::Stopped { time } if time > 0.0 && time < 2.0),
        "{error}"
    );
    assert!(states.len() > 1 && states.len() < times.len());
}
