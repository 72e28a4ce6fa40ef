//! The fastest timing along a path, compared with the package toppra and with closed forms.

use opm_core::Manipulator;
use opm_core::mechanism::examples;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file;
use opm_core::motion::{self, Ends, Instant, Path, PlatformMotion, Spline, TimingError};
use opm_core::trajectory::{Change, Gauge, Trajectory};

/// Agreement with toppra, whose grid and interpolation of the joints differ.
const SHARE: f64 = 1e-3;
/// Agreement with closed forms: one in the number of intervals, 4000, and some room.
const CLOSED: f64 = 5e-4;

/// A shipped mechanism with the same limits of all its actuated joints, SI.
fn limited(name: &str, max_rate: Option<f64>, max_acceleration: f64) -> Manipulator {
    let read = file::read(examples::find(name).unwrap().text).unwrap();
    let joints = read.mechanism.joints().filter(|joint| joint.actuated);
    let mut changes = Vec::new();
    if read.family.is_some() {
        // The sliders of the helical family; its other joints are passive.
        changes.push(("max_acceleration.S".to_owned(), max_acceleration));
        changes.extend(max_rate.map(|rate| ("max_rate.S".to_owned(), rate)));
    } else {
        for joint in joints {
            changes.push((format!("{}.max_acceleration", joint.name), max_acceleration));
            changes.extend(max_rate.map(|rate| (format!("{}.max_rate", joint.name), rate)));
        }
    }
    let changes =
        changes.iter().map(|(name, value)| (name.as_str(), ParameterValue::Number(*value)));
    Manipulator::new(read.with(changes).unwrap().mechanism).unwrap()
}

/// The motion along x through points at these times.
fn along_x(manipulator: &Manipulator, times: &[f64], x: &[f64], ends: Ends) -> PlatformMotion {
    let columns = manipulator.task_coordinates().iter().map(|c| match c.name {
        "x" => x.to_vec(),
        _ => vec![c.home; times.len()],
    });
    PlatformMotion {
        name: "along x".to_owned(),
        start: times[0],
        duration: times[times.len() - 1] - times[0],
        rate: None,
        mode: None,
        path: Path::Spline(Spline::new(times.to_vec(), columns.collect(), ends).unwrap()),
    }
}

fn fastest(motion: &PlatformMotion, manipulator: &Manipulator) -> PlatformMotion {
    motion.time_optimal(manipulator, manipulator.home_mode()).unwrap()
}

/// The motion starts and ends at rest where the given one does, keeps all limits of rates and accelerations, also
/// between samples, and its derivatives are those of its poses.
fn assert_kept(given: &PlatformMotion, timed: &PlatformMotion, manipulator: &Manipulator) {
    assert_eq!(timed.start, given.start);
    let mode = manipulator.home_mode();
    let rate = 211.3 / timed.duration;
    let mut trajectory = Trajectory::new(manipulator, timed, mode, rate).unwrap();
    assert!(trajectory.gauges().iter().any(|gauge| matches!(gauge, Gauge::Motion { .. })));
    while trajectory.advance().unwrap() {
        let motion = |change: &&Change| match change {
            Change::Begins(violation) | Change::Ends(violation) => {
                matches!(violation.gauge, Gauge::Motion { .. })
            }
        };
        assert_eq!(trajectory.changes().iter().find(motion), None, "{}", given.name);
    }
    let coordinates = manipulator.task_coordinates().len();
    let mut instants = [(); 3].map(|()| Instant::new(coordinates));
    let [at, other, _] = &mut instants;
    for (now, then) in [(timed.start, given.start), (timed.end(), given.end())] {
        timed.at(now, at);
        given.at(then, other);
        for i in 0..coordinates {
            assert!((at.pose[i] - other.pose[i]).abs() < 1e-12, "{}", given.name);
            assert!(at.velocity[i].abs() < 1e-9, "{}: {}", given.name, at.velocity[i]);
        }
    }
    let step = 1e-6 * timed.duration;
    for number in 1..200 {
        let t = timed.start + timed.duration * f64::from(number) / 200.3;
        for (instant, t) in instants.iter_mut().zip([t - step, t, t + step]) {
            timed.at(t, instant);
        }
        let [before, at, after] = &instants;
        for i in 0..coordinates {
            let difference = (after.pose[i] - before.pose[i]) / (2.0 * step);
            // The acceleration may jump within the step.
            let bound = step * 10.0 * (1.0 + at.acceleration[i].abs()) + 1e-8;
            assert!((difference - at.velocity[i]).abs() < bound, "{} at {t}", given.name);
        }
    }
}

#[test]
fn durations_are_those_of_toppra() {
    let folder = format!("{}/../data/reference/toppra", env!("CARGO_MANIFEST_DIR"));
    let table = std::fs::read_to_string(format!("{folder}/durations.csv")).unwrap();
    let mut count = 0;
    for line in table.lines().skip(1) {
        let [name, mechanism, rate, acceleration, duration] =
            line.split(',').collect::<Vec<_>>()[..]
        else {
            panic!("{line}")
        };
        let manipulator = limited(mechanism, rate.parse().ok(), acceleration.parse().unwrap());
        let text = std::fs::read_to_string(format!("{folder}/{name}.toml")).unwrap();
        let given = motion::file::read(&text, &manipulator).unwrap();
        let timed = fastest(&given, &manipulator);
        let duration: f64 = duration.parse().unwrap();
        assert!((timed.duration / duration - 1.0).abs() < SHARE, "{line}: {}", timed.duration);
        assert_kept(&given, &timed, &manipulator);
        count += 1;
    }
    assert_eq!(count, 7);
}

/// The trapezoid of speed, or the triangle if the way is too short for the largest rate.
#[test]
fn one_joint_from_rest_to_rest_takes_the_time_of_the_trapezoid() {
    let distance = 0.2;
    for (rate, acceleration) in [(None, 2.0), (Some(0.3), 2.0), (Some(5.0), 2.0), (Some(0.01), 9.0)]
    {
        let manipulator = limited("cartesian-wrist-6dof", rate, acceleration);
        let expected = match rate {
            Some(rate) if rate * rate / acceleration < distance => {
                distance / rate + rate / acceleration
            }
            _ => 2.0 * (distance / acceleration).sqrt(),
        };
        // However the given motion goes along the way, and however it starts and ends.
        for (times, x, ends) in [
            (&[0.0, 1.0][..], &[-0.1, 0.1][..], Ends::Natural),
            (&[0.0, 1.0], &[-0.1, 0.1], Ends::Rest),
            (&[2.0, 300.0], &[-0.1, 0.1], Ends::Rest),
            (&[0.0, 0.5, 1.2, 2.0], &[-0.1, -0.06, 0.03, 0.1], Ends::Rest),
        ] {
            let given = along_x(&manipulator, times, x, ends);
            let timed = fastest(&given, &manipulator);
            let found = timed.duration / expected - 1.0;
            assert!((-1e-9..CLOSED).contains(&found), "{rate:?} {times:?} {ends:?}: {found:e}");
            assert_kept(&given, &timed, &manipulator);
        }
    }
}

/// There and back: two triangles, joined at the largest acceleration, which does not stop where the joint turns.
#[test]
fn a_joint_turns_without_a_pause() {
    let manipulator = limited("cartesian-wrist-6dof", None, 2.0);
    let given = along_x(&manipulator, &[0.0, 1.0, 2.0], &[0.0, 0.1, 0.0], Ends::Rest);
    let timed = fastest(&given, &manipulator);
    // A quarter of each way at a time: t = 4 sqrt(0.1 / 2).
    let expected = 4.0 * (0.1_f64 / 2.0).sqrt();
    assert!((timed.duration / expected - 1.0).abs() < CLOSED, "{} {expected}", timed.duration);
    assert_kept(&given, &timed, &manipulator);
}

#[test]
fn a_symmetric_path_has_a_symmetric_timing() {
    let manipulator = limited("planar-3rrr", Some(1.0), 6.0);
    // The mechanism is not symmetric: there and back is.
    let given = along_x(&manipulator, &[0.0, 1.0, 2.0], &[-0.03, 0.03, -0.03], Ends::Rest);
    let timed = fastest(&given, &manipulator);
    // The largest speed of the platform is of this order, m/s.
    let speed = 1.0;
    let mut instants = [(); 2].map(|()| Instant::new(3));
    for number in 0..=100 {
        let after = timed.duration * f64::from(number) / 200.0;
        for (instant, t) in instants.iter_mut().zip([timed.start + after, timed.end() - after]) {
            timed.at(t, instant);
        }
        let [one, other] = &instants;
        assert!((one.pose[0] - other.pose[0]).abs() < CLOSED * 0.06, "{after}: {one:?} {other:?}");
        let share = CLOSED * speed;
        assert!((one.velocity[0] + other.velocity[0]).abs() < share, "{after}: {one:?} {other:?}");
    }
}

/// With the clock slower by k, rates are divided by k and accelerations by k².
#[test]
fn lower_limits_scale_the_time() {
    let duration = |rate: f64, acceleration: f64| {
        let manipulator = limited("planar-3rrr", Some(rate), acceleration);
        let given = along_x(&manipulator, &[0.0, 1.0, 1.5], &[-0.03, 0.03, 0.01], Ends::Natural);
        fastest(&given, &manipulator).duration
    };
    let whole = duration(1.0, 6.0);
    assert!((duration(0.5, 1.5) / whole - 2.0).abs() < CLOSED);
    assert!((duration(0.5_f64.sqrt(), 3.0) / whole - 2.0_f64.sqrt()).abs() < CLOSED);
    assert!(duration(0.5, 6.0) > whole && duration(1.0, 3.0) > whole);
}

#[test]
fn what_has_no_timing_is_refused() {
    let free = Manipulator::example("cartesian-wrist-6dof").unwrap();
    let mode = free.home_mode();
    let given = along_x(&free, &[0.0, 1.0], &[0.0, 0.1], Ends::Rest);
    let error = given.time_optimal(&free, mode).unwrap_err();
    assert!(
        error.to_string().starts_with("no max_acceleration of x1, motor1, y2, motor2, z3, motor3:"),
        "{error}"
    );
    let manipulator = limited("cartesian-wrist-6dof", None, 2.0);
    let still = along_x(&manipulator, &[0.0, 1.0], &[0.1, 0.1], Ends::Rest);
    assert_eq!(still.time_optimal(&manipulator, mode), Err(TimingError::Still));
    let manipulator = limited("planar-3rrr", None, 2.0);
    let far = along_x(&manipulator, &[0.0, 1.0], &[0.0, 1.0], Ends::Rest);
    let error = far.time_optimal(&manipulator, manipulator.home_mode()).unwrap_err();
    assert!(matches!(error, TimingError::OutOfReach { .. }), "{error}");
}

/// A five-bar with arms of 150 mm, whose motors have limits.
const PLOTTER: &str = r#"
format = 1
name = "plotter"
units = { length = "mm", angle = "deg" }
[platform]
point = [200, 180, 0]
[[leg]]
name = "L"
joints = [
  { name = "L", type = "revolute", axis = [0, 0, 1], point = [0, 0, 0], actuated = true, max_rate = 180, max_acceleration = 720 },
  { name = "LE", type = "revolute", axis = [0, 0, 1], point = [144.37410025544926, 40.69544416061194, 0] },
  { name = "pen", type = "revolute", axis = [0, 0, 1], point = [200, 180, 0] },
]
[[leg]]
name = "R"
joints = [
  { name = "R", type = "revolute", axis = [0, 0, 1], point = [400, 0, 0], actuated = true, max_rate = 180, max_acceleration = 720 },
  { name = "RE", type = "revolute", axis = [0, 0, 1], point = [255.62589974455074, 40.69544416061194, 0] },
]
"#;

/// A path through points at equal times, each coordinate of a pose a function of a share from 0 to 1, with noise.
fn noisy(
    manipulator: &Manipulator,
    (count, noise, seed): (usize, f64, u64),
    pose: &dyn Fn(f64) -> Vec<f64>,
) -> PlatformMotion {
    let mut rng = fastrand::Rng::with_seed(seed);
    let times: Vec<f64> = (0..count).map(|i| 0.01 * i as f64).collect();
    let mut columns = vec![Vec::new(); manipulator.task_coordinates().len()];
    for i in 0..count {
        let pose = pose(i as f64 / (count - 1) as f64);
        for (column, value) in columns.iter_mut().zip(pose) {
            column.push(value + noise * (2.0 * rng.f64() - 1.0));
        }
    }
    PlatformMotion {
        name: format!("noise {noise} of seed {seed}"),
        start: 0.0,
        duration: times[count - 1],
        rate: None,
        mode: None,
        path: Path::Spline(Spline::new(times, columns, Ends::Natural).unwrap()),
    }
}

/// What was recorded has noise, and splines have kinks: the fastest timing keeps the limits there too, as the search for
/// violations sees it.
#[test]
fn limits_are_kept_along_noisy_paths() {
    use std::f64::consts::TAU;
    let plotter = Manipulator::read(PLOTTER).unwrap();
    let circle = |share: f64| {
        let (sin, cos) = (TAU * share).sin_cos();
        vec![0.2 + 0.02 * cos, 0.15 + 0.02 * sin]
    };
    let corners = |share: f64| {
        // Around a square, with a kink at each corner.
        let (side, part) = ((4.0 * share) as usize % 4, (4.0 * share).fract());
        let ends = [[0.0, 0.0], [0.03, 0.0], [0.03, 0.03], [0.0, 0.03], [0.0, 0.0]];
        let [from, to] = [ends[side], ends[side + 1]];
        (0..2).map(|i| [0.185, 0.14][i] + from[i] + part * (to[i] - from[i])).collect()
    };
    for seed in 0..6 {
        for noise in [3e-5, 3e-4] {
            let given = noisy(&plotter, (401, noise, seed), &circle);
            assert_kept(&given, &fastest(&given, &plotter), &plotter);
        }
        let given = noisy(&plotter, (81, 1e-5 * seed as f64, seed), &corners);
        assert_kept(&given, &fastest(&given, &plotter), &plotter);
    }
    let spatial = limited("plano-spherical-5dof-joints", Some(0.5), 2.0);
    let helix = |share: f64| {
        let (sin, cos) = (2.0 * TAU * share).sin_cos();
        vec![0.02 * cos, 0.02 * sin, 0.1 * share, 0.15 + 0.05 * sin, 0.1 * cos]
    };
    for seed in 0..3 {
        let given = noisy(&spatial, (151, 1e-4, seed), &helix);
        assert_kept(&given, &fastest(&given, &spatial), &spatial);
    }
}
