//! The acceleration radius: of a platform on two sliders by hand, and against what inverse dynamics says of each actuator.

use nalgebra::{DMatrix, DVector, Vector3};
use opm_analysis::{
    Dynamics, Gravity, Index, IndexError, Indices, Load, LoadAxes, LoadPoint, Loads, Setup,
    Statics, Wrench,
};
use opm_core::Manipulator;
use opm_core::mechanism::examples::{EXAMPLES, TEMPLATES};
use opm_core::mechanism::joint::Drive;
use opm_core::skeleton::Density;

/// Of a radius.
const CLOSE: f64 = 1e-8;

fn gravity() -> Gravity {
    Gravity { acceleration: Vector3::new(0.3, -0.5, -9.81), density: Density::default() }
}

/// The manipulator with rotors, friction, and a limit at each actuator that is many times its effort at home.
fn limited(name: &str) -> Option<Manipulator> {
    let mut mechanism = Manipulator::example(name).ok()?.mechanism().clone();
    let mut joints: Vec<_> = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints).collect();
    for (number, joint) in joints.iter_mut().enumerate() {
        for c in &mut joint.coordinates {
            c.drive = Drive {
                rotor_inertia: if joint.actuated { 1e-5 } else { 0.0 },
                gear: 20.0,
                viscous_friction: 0.1,
                coulomb_friction: 0.2,
            };
            c.max_effort = joint.actuated.then_some(300.0 + 10.0 * number as f64);
        }
    }
    Manipulator::new(mechanism).ok()
}

/// The least acceleration at which an actuator is at its limit: each effort is affine in the accelerations. `still` are the rows of
/// the platform's twist that stay zero.
fn by_inverse_dynamics(
    m: &Manipulator,
    dynamics: &mut Dynamics<'_>,
    twist: &DMatrix<f64>,
    still: usize,
) -> Option<f64> {
    let count = twist.ncols();
    let moving = twist.rows(3 - still, 3);
    let still = twist.rows(still, 3);
    let eigen = still.tr_mul(&still).symmetric_eigen();
    let largest = eigen.eigenvalues.max().max(1e-3);
    let kept: Vec<usize> = (0..count).filter(|&k| eigen.eigenvalues[k] < 1e-14 * largest).collect();
    if kept.is_empty() {
        return None;
    }
    let free = DMatrix::from_fn(count, kept.len(), |i, k| eigen.eigenvectors[(i, kept[k])]);
    let triangle = (moving * &free).qr().r();
    let directions = free * triangle.try_inverse()?;
    let rest = DVector::zeros(count);
    let holding = dynamics.inverse(&rest, &rest)?;
    let columns: Option<Vec<DVector<f64>>> = directions
        .column_iter()
        .map(|direction| Some(dynamics.inverse(&rest, &direction.into_owned())? - &holding))
        .collect();
    let rows = DMatrix::from_columns(&columns?);
    let left = |(row, &c): (usize, &usize)| {
        let most = m.coordinates()[c].max_effort.unwrap();
        (most - holding[row].abs()) / rows.row(row).norm()
    };
    Some(m.actuated().iter().enumerate().map(left).fold(f64::INFINITY, f64::min))
}

#[test]
fn an_actuator_is_at_its_limit_in_the_worst_direction() {
    let wrench = Wrench::from_components([3.0, -2.0, 5.0, 0.4, -0.3, 0.2]);
    let load = Load { wrench, axes: LoadAxes::Base, at: LoadPoint::Platform };
    let (mut linear, mut angular) = (0, 0);
    for example in EXAMPLES.iter().chain(TEMPLATES) {
        let Some(m) = limited(example.name) else { continue };
        if m.actuated().len() != m.task_coordinates().len() {
            continue;
        }
        let length = m.characteristic_length();
        let setup = Setup { gravity: Some(gravity()), load: Some(load), ..Setup::new(length) };
        let (mut statics, mut dynamics) = (Statics::new(&m, length), Dynamics::new(&m, &setup));
        let mut loads = Loads::new(&m, &setup).unwrap();
        for shift in [0.0, 0.03] {
            let mut pose = m.home_pose();
            for (value, c) in pose.iter_mut().zip(m.task_coordinates()) {
                let unit = if c.quantity == opm_core::Quantity::Length { length } else { 1.0 };
                *value += shift * unit;
            }
            let mut at = m.solution();
            let solved = m.inverse(&pose, m.home_mode(), &mut at);
            if !solved.is_ok_and(|found| found.is_some()) || !statics.update(&at).unwrap() {
                continue;
            }
            let found = loads.acceleration_radius(&statics, &at);
            let (Some(found), true) = (found, dynamics.update(&at).unwrap()) else { continue };
            let mut jacobians = m.jacobians();
            m.differentiate(&at, &mut jacobians).unwrap();
            let twist = m.twist_by_pose(&jacobians);
            let twist = DMatrix::from_fn(6, twist.ncols(), |i, j| twist[(i, j)]);
            // Where Euler angles are singular, coordinates do not give all accelerations.
            if dynamics
                .forward(&DVector::zeros(pose.len()), &DVector::zeros(m.actuated().len()))
                .is_none()
            {
                continue;
            }
            for (still, found, counted) in
                [(0, found.linear, &mut linear), (3, found.angular, &mut angular)]
            {
                let expected = by_inverse_dynamics(&m, &mut dynamics, &twist, still);
                assert_eq!(found.is_some(), expected.is_some(), "{}", example.name);
                let (Some(found), Some(expected)) = (found, expected) else { continue };
                let off = (found - expected).abs();
                assert!(off < CLOSE * expected.abs(), "{}: {found} {expected}", example.name);
                *counted += 1;
            }
        }
    }
    assert!(linear > 20 && angular > 10, "{linear} {angular}");
}

/// Two motors of 50 N lift 3 kg, and push down with the weight: upwards there is less left. Neither alone is a limit.
#[test]
fn redundant_motors_work_together() {
    let text =
        include_str!("lift.toml").replace("actuated = true", "actuated = true, max_effort = 50");
    let m = Manipulator::read(&text).unwrap();
    let setup = Setup::new(1.0);
    let mut indices = Indices::new(&m, &setup, [Index::Acceleration]).unwrap();
    let radius = indices.evaluate(&m.solution())[0];
    assert!((radius - (100.0 / 3.0 - 9.81)).abs() < 1e-9, "{radius}");
    // Without weight.
    let weightless = Gravity { acceleration: Vector3::zeros(), density: Density::default() };
    let setup = Setup { gravity: Some(weightless), ..setup };
    let mut indices = Indices::new(&m, &setup, [Index::Acceleration]).unwrap();
    assert!((indices.evaluate(&m.solution())[0] - 100.0 / 3.0).abs() < 1e-9);
    // Too weak to hold it.
    let weak = Manipulator::read(&text.replace("= 50", "= 10")).unwrap();
    let mut indices = Indices::new(&weak, &Setup::new(1.0), [Index::Acceleration]).unwrap();
    assert!((indices.evaluate(&weak.solution())[0] - (20.0 / 3.0 - 9.81)).abs() < 1e-9);

    let turns = Index::AngularAcceleration.check(&m, &Setup::new(1.0));
    assert!(matches!(turns, Err(IndexError::NoMotion { .. })), "{turns:?}");
    let free = Manipulator::read(include_str!("lift.toml")).unwrap();
    let none = Index::Acceleration.check(&free, &Setup::new(1.0));
    assert_eq!(none, Err(IndexError::NoLimits(Index::Acceleration)));
}
