//! The fastest timing within efforts: closed forms for single sliders, and the inverse dynamics along curves.

use nalgebra::DVector;
use opm_analysis::{Dynamics, Setup, time_optimal};
use opm_core::Manipulator;
use opm_core::mechanism::examples;
use opm_core::mechanism::joint::Drive;
use opm_core::motion::{Ends, Instant, Path, PlatformMotion, Spline, TimingError};

/// One in the number of intervals of the grid, 4000, and some room.
const CLOSED: f64 = 5e-4;
const MASS: f64 = 5.0;
const FALL: f64 = 9.81;

/// A Tripteron without masses but its platform's, whose sliders have these largest efforts.
fn tripteron(efforts: [f64; 3]) -> Manipulator {
    let text = examples::find("tripteron").unwrap().text;
    let text = format!("{text}\n[bodies]\ndensity = 0.001\nmasses = {{ platform = {MASS} }}\n");
    with_efforts(&Manipulator::read(&text).unwrap(), &efforts, Drive::default())
}

/// The same mechanism with largest efforts, and a drive, at the actuated joints, without other limits of these.
fn with_efforts(m: &Manipulator, efforts: &[f64], drive: Drive) -> Manipulator {
    let mut mechanism = m.mechanism().clone();
    let actuated = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    let actuated = actuated.filter(|joint| joint.actuated).flat_map(|j| &mut j.coordinates);
    for (c, &effort) in actuated.zip(efforts.iter().cycle()) {
        (c.max_effort, c.drive) = (Some(effort), drive);
    }
    Manipulator::new(mechanism).unwrap()
}

/// A motion through home and points beside it, metres or radians.
fn through(m: &Manipulator, points: &[&[f64]]) -> PlatformMotion {
    let times: Vec<f64> = (0..points.len()).map(|i| i as f64).collect();
    let columns = m.home_pose().into_iter().enumerate();
    let columns = columns.map(|(j, home)| points.iter().map(|point| home + point[j]).collect());
    let duration = times[times.len() - 1];
    let path = Path::Spline(Spline::new(times, columns.collect(), Ends::Rest).unwrap());
    PlatformMotion { name: "test".to_owned(), start: 0.0, duration, rate: None, mode: None, path }
}

fn fastest(m: &Manipulator, motion: &PlatformMotion) -> Result<PlatformMotion, TimingError> {
    time_optimal(motion, m, m.home_mode(), &Setup::new(m.characteristic_length()))
}

#[test]
fn sliders_move_as_fast_as_they_can_push() {
    let (push, way) = (80.0, 0.1);
    let m = tripteron([push; 3]);
    let along = |j: usize, sign: f64| {
        let end: Vec<f64> = (0..3).map(|k| if k == j { sign * way } else { 0.0 }).collect();
        fastest(&m, &through(&m, &[&[0.0; 3], &end])).unwrap().duration
    };
    for (j, sign) in [(0, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let weight = if j == 2 { sign * MASS * FALL } else { 0.0 };
        // Speeding up and slowing down.
        let each = [push - weight, push + weight].map(|force| MASS / force);
        let expected = (2.0 * way * (each[0] + each[1])).sqrt();
        let found = along(j, sign);
        assert!((found / expected - 1.0).abs() < 2.0 * CLOSED, "{j} {sign}: {found} {expected}");
    }
}

/// Friction of both kinds on one slider: `m a = F - c - d v`, then `m a = -F - c - d v`.
#[test]
fn friction_slows_a_slider() {
    let (push, way, d, c) = (80.0, 0.3, 60.0, 10.0);
    let drive = Drive { viscous_friction: d, coulomb_friction: c, ..Drive::default() };
    let m = with_efforts(&tripteron([push; 3]), &[push], drive);
    let end = [way, 0.0, 0.0];
    let found = fastest(&m, &through(&m, &[&[0.0; 3], &end])).unwrap().duration;
    // Small steps of both phases, by the speed at which they meet.
    let run = |speed: f64, force: f64| {
        let steps = 20_000;
        let (mut time, mut length) = (0.0, 0.0);
        for i in 0..steps {
            let v = speed * (f64::from(i) + 0.5) / f64::from(steps);
            let dt = MASS * speed / f64::from(steps) / force_at(force, c, d, v);
            (time, length) = (time + dt, length + v * dt);
        }
        (time, length)
    };
    let (mut low, mut high) = (0.0, (push - c) / d * 0.9999);
    for _ in 0..60 {
        let speed = 0.5 * (low + high);
        let reached = run(speed, push).1 + run(speed, -push).1;
        (low, high) = if reached < way { (speed, high) } else { (low, speed) };
    }
    let expected = run(low, push).0 + run(low, -push).0;
    // Braking counts on less friction than there is.
    let ratio = found / expected;
    assert!(ratio > 1.0 - CLOSED && ratio < 1.03, "{found} {expected}");
}

fn force_at(force: f64, c: f64, d: f64, v: f64) -> f64 {
    if force > 0.0 { force - c - d * v } else { -force + c + d * v }
}

#[test]
fn timed_motions_keep_the_efforts_of_inverse_dynamics() {
    let drive =
        Drive { rotor_inertia: 1e-6, gear: 10.0, viscous_friction: 0.01, coulomb_friction: 0.02 };
    for (name, points, effort, drive) in [
        ("delta", &[[0.0; 3], [0.05, 0.03, 0.02], [-0.03, 0.06, 0.0]][..], 60.0, Drive::default()),
        ("delta", &[[0.0; 3], [0.05, 0.03, 0.02], [-0.03, 0.06, 0.0]][..], 60.0, drive),
        ("planar-3rrr", &[[0.0; 3], [0.03, -0.02, 0.3], [-0.02, 0.03, -0.1]][..], 0.5, drive),
        ("orthoglide", &[[0.0; 3], [0.04, 0.02, -0.03]][..], 400.0, Drive::default()),
    ] {
        let m = with_efforts(&Manipulator::example(name).unwrap(), &[effort], drive);
        let points: Vec<&[f64]> = points.iter().map(|point| &point[..]).collect();
        let timed = fastest(&m, &through(&m, &points)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let setup = Setup::new(m.characteristic_length());
        let mut dynamics = Dynamics::new(&m, &setup);
        let mut at = m.solution();
        let mut instant = Instant::new(3);
        let (mut largest, mut full) = (0.0_f64, 0);
        let count = 3001;
        // At rest, at both ends, dry friction has no direction.
        for i in 1..count - 1 {
            timed.at(
                timed.start + timed.duration * f64::from(i) / f64::from(count - 1),
                &mut instant,
            );
            m.inverse(&instant.pose, m.home_mode(), &mut at).unwrap().expect("in reach");
            assert!(dynamics.update(&at).unwrap());
            let [v, a] =
                [&instant.velocity, &instant.acceleration].map(|of| DVector::from_column_slice(of));
            let share = dynamics.inverse(&v, &a).expect("efforts").amax() / effort;
            largest = largest.max(share);
            full += i32::from(share > 0.97);
        }
        assert!(largest < 1.0 + 1e-6, "{name}: {largest}");
        // One of them works as hard as it can nearly all the time.
        assert!(f64::from(full) > 0.9 * f64::from(count), "{name}: {full}");
    }
}

#[test]
fn what_is_too_heavy_is_said() {
    let m = tripteron([30.0; 3]);
    let error = fastest(&m, &through(&m, &[&[0.0; 3], &[0.1, 0.0, 0.0]])).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, TimingError::Effort { .. }), "{text}");
    assert!(
        text.contains("needs 49.05") && text.contains("more than its max_effort of 30 N"),
        "{text}"
    );
    // Redundant actuators that have largest efforts.
    let m = Manipulator::example("planar-3rrr").unwrap();
    let mut mechanism = m.mechanism().clone();
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        joint.actuated = true;
        joint.coordinates[0].max_effort = Some(1e3);
    }
    if let Ok(m) = Manipulator::new(mechanism) {
        let error = fastest(&m, &through(&m, &[&[0.0; 3], &[0.02, 0.0, 0.0]])).unwrap_err();
        assert!(matches!(error, TimingError::NoEffort { .. }), "{error}");
    }
}

/// Limits of rates and accelerations alone, and beside efforts that are never reached.
#[test]
fn rates_and_accelerations_are_kept_as_before() {
    let (rate, acceleration, way) = (0.4, 3.0, 0.1);
    let limited = |effort: Option<f64>| {
        let mut mechanism = tripteron([1.0; 3]).mechanism().clone();
        let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
        for c in joints.filter(|joint| joint.actuated).flat_map(|j| &mut j.coordinates) {
            c.max_effort = effort;
            c.motion_limits.max_rate = Some(rate);
            c.motion_limits.max_acceleration = Some(acceleration);
        }
        let m = Manipulator::new(mechanism).unwrap();
        let motion = through(&m, &[&[0.0; 3], &[way, 0.0, 0.0]]);
        let alone = motion.time_optimal(&m, m.home_mode()).unwrap();
        (alone.duration, fastest(&m, &motion).unwrap().duration)
    };
    // A trapezoid.
    let expected = way / rate + rate / acceleration;
    let (alone, same) = limited(None);
    assert!((alone / expected - 1.0).abs() < CLOSED, "{alone} {expected}");
    assert_eq!(alone.to_bits(), same.to_bits());
    let (_, beside) = limited(Some(1e4));
    assert_eq!(alone.to_bits(), beside.to_bits());
}
