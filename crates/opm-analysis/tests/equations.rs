//! The equations of motion: the mass matrix against kinetic energy, forward against inverse dynamics, and the energy of what moves
//! freely.

mod bodies;

use bodies::Bodies;
use fastrand::Rng;
use nalgebra::{DMatrix, DVector, Vector3};
use opm_analysis::{Dynamics, Gravity, Setup};
use opm_core::mechanism::examples::{EXAMPLES, TEMPLATES};
use opm_core::mechanism::joint::Drive;
use opm_core::skeleton::Density;
use opm_core::task::TaskCoordinate;
use opm_core::{Manipulator, Quantity};
use opm_tests::structured;

/// The inverse of a matrix of a condition number of 1e5 keeps eleven digits.
const CLOSE: f64 = 1e-10;

fn gravity() -> Gravity {
    Gravity { acceleration: Vector3::new(0.3, -0.5, -9.81), density: Density::default() }
}

fn setup(manipulator: &Manipulator) -> Setup {
    Setup { gravity: Some(gravity()), ..Setup::new(manipulator.characteristic_length()) }
}

/// Numbers that suit the task coordinates, up to a size.
fn any(rng: &mut Rng, m: &Manipulator, size: f64) -> DVector<f64> {
    let length = m.characteristic_length();
    let number = |c: &TaskCoordinate| {
        let unit = if c.quantity == Quantity::Length { length } else { 1.0 };
        size * unit * (2.0 * rng.f64() - 1.0)
    };
    DVector::from_iterator(m.task_coordinates().len(), m.task_coordinates().iter().map(number))
}

/// A mechanism with rotors and friction at its joints.
fn driven(m: &Manipulator) -> Manipulator {
    let mut mechanism = m.mechanism().clone();
    let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    for (i, c) in joints.flat_map(|joint| &mut joint.coordinates).enumerate() {
        c.drive = Drive {
            rotor_inertia: 1e-5 * (1 + i % 3) as f64,
            gear: 30.0,
            viscous_friction: 0.3,
            coulomb_friction: 0.2,
        };
    }
    Manipulator::new(mechanism).expect("the same mechanism")
}

fn shipped() -> impl Iterator<Item = (&'static str, Manipulator)> {
    let all = EXAMPLES.iter().chain(TEMPLATES);
    all.filter_map(|example| Some((example.name, Manipulator::example(example.name).ok()?)))
}

#[test]
fn the_mass_matrix_is_that_of_the_kinetic_energy() {
    let mut rng = Rng::with_seed(51);
    for (name, m) in shipped() {
        let bodies = Bodies::new(&m, &gravity());
        let mut dynamics = Dynamics::new(&m, &setup(&m));
        let n = dynamics.freedoms();
        let mut compared = 0;
        for _ in 0..4 {
            let x = DVector::from_vec(m.home_pose()) + any(&mut rng, &m, 0.05);
            let Some(at) = bodies.solved(x.as_slice()) else { continue };
            if !dynamics.update(&at).unwrap() {
                continue;
            }
            let mass = dynamics.mass_matrix().expect("a regular pose");
            let scale = mass.amax();
            assert!((&mass - mass.transpose()).amax() < 1e-13 * scale, "{name}: {mass}");
            assert!(mass.clone().cholesky().is_some(), "{name}: {mass}");
            let unit = |i: usize| DVector::from_fn(n, |k, _| f64::from(u8::from(k == i)));
            for i in 0..n {
                for j in 0..n {
                    let [sum, less] =
                        [1.0, -1.0].map(|sign| bodies.kinetic(&x, &(unit(i) + unit(j) * sign)));
                    let (Some(sum), Some(less)) = (sum, less) else { continue };
                    let expected = 0.5 * (sum - less);
                    let found = mass[(i, j)];
                    // The differences are those of positions, whose rounding is 1e-11 of a rate.
                    assert!((found - expected).abs() < 1e-6 * scale, "{name}: {found} {expected}");
                    compared += 1;
                }
            }
        }
        assert!(compared >= n * n, "{name}");
    }
}

/// Efforts for a state: those of inverse dynamics or, where actuators are redundant, some that have the same effect.
fn efforts(
    dynamics: &mut Dynamics<'_>,
    v: &DVector<f64>,
    a: &DVector<f64>,
) -> Option<DVector<f64>> {
    let whole = dynamics.mass_matrix()? * a
        + dynamics.bias(v)?
        + dynamics.gravity()?
        + dynamics.friction(v)?;
    let by_pose: DMatrix<f64> = dynamics.actuated_by_pose().transpose();
    match dynamics.inverse(v, a) {
        Some(efforts) => {
            let off = (&by_pose * &efforts - &whole).amax();
            assert!(off < CLOSE * (by_pose.abs() * efforts.abs()).amax().max(1.0), "{off} {whole}");
            Some(efforts)
        }
        None if by_pose.ncols() > by_pose.nrows() => {
            by_pose.svd(true, true).solve(&whole, 1e-9).ok()
        }
        None => None,
    }
}

#[test]
fn forward_dynamics_undoes_inverse_dynamics() {
    let mut rng = Rng::with_seed(52);
    for (name, m) in shipped() {
        for m in [driven(&m), m] {
            let mut dynamics = Dynamics::new(&m, &setup(&m));
            let mut at = m.solution();
            let mut compared = 0;
            for round in 0..24 {
                let generic = round % 3 == 0;
                let x = match generic {
                    true => {
                        (DVector::from_vec(m.home_pose()) + any(&mut rng, &m, 0.05)).data.into()
                    }
                    false => structured::pose(&mut rng, &m),
                };
                let Ok(Some(_)) = m.inverse(&x, m.home_mode(), &mut at) else { continue };
                if !dynamics.update(&at).unwrap() {
                    continue;
                }
                let (v, a) = (any(&mut rng, &m, 1.5), any(&mut rng, &m, 4.0));
                let Some(efforts) = efforts(&mut dynamics, &v, &a) else { continue };
                let Some(found) = dynamics.forward(&v, &efforts) else { continue };
                let mass = dynamics.mass_matrix().unwrap();
                // Near parallel singularities large efforts cancel.
                let forces = dynamics.actuated_by_pose().abs().tr_mul(&efforts.abs());
                let off = (&mass * (&found - &a)).amax();
                assert!(off < CLOSE * forces.amax().max(1.0), "{name} {x:?}: {found} {a}");
                if generic {
                    assert!((&found - &a).amax() < 1e-7 * a.amax(), "{name} {x:?}: {found} {a}");
                    compared += 1;
                }
            }
            assert!(compared > 0, "{name}");
        }
    }
}

/// Where an Euler angle is zero two coordinates turn about one axis, and no acceleration follows.
#[test]
fn singular_coordinates_have_no_accelerations() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    let mut dynamics = Dynamics::new(&m, &setup(&m));
    assert!(dynamics.update(&m.solution()).unwrap());
    let rest = DVector::zeros(5);
    assert!(dynamics.mass_matrix().is_some());
    assert_eq!(dynamics.forward(&rest, &rest), None);
}

#[test]
fn free_motion_keeps_its_energy() {
    const STEP: f64 = 5e-4;
    let mut rng = Rng::with_seed(53);
    for name in ["five-bar", "delta", "stewart", "plano-spherical-5dof", "3-rps"] {
        let m = Manipulator::example(name).unwrap();
        let mut mechanism = m.mechanism().clone();
        let mut inertias = Vec::new();
        for c in mechanism
            .legs
            .iter_mut()
            .flat_map(|leg| &mut leg.joints)
            .flat_map(|j| &mut j.coordinates)
        {
            c.drive = Drive { rotor_inertia: 1e-5, gear: 20.0, ..Drive::default() };
            inertias.push(c.drive.inertia());
        }
        let m = Manipulator::new(mechanism).unwrap();
        // Also in the plane of a planar mechanism.
        let gravity = Gravity { acceleration: Vector3::new(2.0, -7.0, -6.0), ..gravity() };
        let bodies = Bodies::new(&m, &gravity);
        let setup = Setup { gravity: Some(gravity), ..setup(&m) };
        let mut dynamics = Dynamics::new(&m, &setup);
        let none = DVector::zeros(m.actuated().len());
        let mut x = DVector::from_vec(m.home_pose()) + any(&mut rng, &m, 0.08);
        let mut v = any(&mut rng, &m, 0.4);
        let energy = |x: &DVector<f64>, v: &DVector<f64>| {
            let mut jacobians = m.jacobians();
            m.differentiate(&bodies.solved(x.as_slice()).unwrap(), &mut jacobians).unwrap();
            let rates = jacobians.joints_by_pose() * v;
            let rotors: f64 = rates.iter().zip(&inertias).map(|(q, i)| 0.5 * i * q * q).sum();
            [bodies.kinetic(x, v).unwrap() + rotors, bodies.potential(x).unwrap()]
        };
        let mut falls = |x: &DVector<f64>, v: &DVector<f64>| {
            assert!(dynamics.update(&bodies.solved(x.as_slice()).expect("in reach")).unwrap());
            dynamics.forward(v, &none).expect("accelerations")
        };
        let [start_kinetic, start_potential] = energy(&x, &v);
        let mut moved = 0.0_f64;
        for _ in 0..120 {
            // Runge and Kutta's fourth order.
            let a1 = falls(&x, &v);
            let (x2, v2) = (&x + &v * (0.5 * STEP), &v + &a1 * (0.5 * STEP));
            let a2 = falls(&x2, &v2);
            let (x3, v3) = (&x + &v2 * (0.5 * STEP), &v + &a2 * (0.5 * STEP));
            let a3 = falls(&x3, &v3);
            let (x4, v4) = (&x + &v3 * STEP, &v + &a3 * STEP);
            let a4 = falls(&x4, &v4);
            x += (&v + (&v2 + &v3) * 2.0 + &v4) * (STEP / 6.0);
            v += (a1 + (a2 + a3) * 2.0 + a4) * (STEP / 6.0);
            let [kinetic, potential] = energy(&x, &v);
            let off = kinetic + potential - start_kinetic - start_potential;
            moved = moved.max((kinetic - start_kinetic).abs());
            // That of the differences.
            assert!(off.abs() < 1e-6 * kinetic.max(start_kinetic), "{name}: {off} of {kinetic}");
        }
        assert!(moved > 0.1 * start_kinetic, "{name}: {moved} {start_kinetic}");
    }
}
