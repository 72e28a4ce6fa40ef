//! Timings within caps of the tool's speed and acceleration, against closed forms and against differences of poses.

use nalgebra::{Isometry3, Vector3};
use opm_core::Manipulator;
use opm_core::motion::{
    Ends, Harmonics, Instant, Path, PathLimits, PlatformMotion, Sinusoid, Spline, TimingError,
    ToolLimits,
};
use std::f64::consts::{FRAC_PI_2, TAU};

/// One in the number of intervals, 4000, and some room.
const CLOSED: f64 = 5e-4;
/// How much of a cap the polygon uses in the worst direction, and what differences across a jump leave.
const USED: f64 = 0.99;

/// The motion with the fastest timing within the caps.
fn timed(
    m: &Manipulator,
    motion: &PlatformMotion,
    tool: ToolLimits,
) -> Result<PlatformMotion, TimingError> {
    motion.time_optimal_within(m, m.home_mode(), PathLimits { tool, efforts: None })
}

/// A motion from rest to rest through poses, each coordinate by its name and its values beside home; the others stay at home.
fn through(m: &Manipulator, moves: &[(&str, &[f64])]) -> PlatformMotion {
    for (name, _) in moves {
        assert!(m.task_coordinates().iter().any(|c| c.name == *name), "{name}");
    }
    let count = moves[0].1.len();
    let times: Vec<f64> = (0..count).map(|i| i as f64).collect();
    let columns = m.task_coordinates().iter().map(|c| {
        let moved = moves.iter().find(|(name, _)| *name == c.name);
        let beside = moved.map_or_else(|| vec![0.0; count], |(_, values)| values.to_vec());
        beside.into_iter().map(|value| c.home + value).collect()
    });
    let path = Path::Spline(Spline::new(times, columns.collect(), Ends::Rest).unwrap());
    motion((count - 1) as f64, path)
}

fn motion(duration: f64, path: Path) -> PlatformMotion {
    PlatformMotion { name: "test".to_owned(), start: 0.0, duration, rate: None, mode: None, path }
}

/// The time of a trapezoid of the speed, or of a triangle.
fn trapezoid(way: f64, speed: Option<f64>, acceleration: f64) -> f64 {
    match speed {
        Some(speed) if speed * speed / acceleration < way => way / speed + speed / acceleration,
        _ => 2.0 * (way / acceleration).sqrt(),
    }
}

#[test]
fn a_straight_way_and_a_turn_take_the_time_of_the_trapezoid() {
    let delta = Manipulator::example("delta").unwrap();
    let stewart = Manipulator::example("stewart").unwrap();
    let straight = through(&delta, &[("x", &[-0.05, -0.02, 0.05])]);
    let turn = through(&stewart, &[("yaw", &[-0.1, 0.02, 0.1])]);
    for (speed, acceleration) in
        [(None, 2.0), (Some(0.2), 2.0), (Some(9.0), 2.0), (Some(0.05), 0.5)]
    {
        let linear = ToolLimits { speed, acceleration: Some(acceleration), ..Default::default() };
        // What does not turn, and what does not go anywhere, is not slowed by the other caps.
        let angular = ToolLimits {
            acceleration: Some(0.1),
            angular_speed: speed,
            angular_acceleration: Some(acceleration),
            ..Default::default()
        };
        for (m, motion, tool, way) in
            [(&delta, &straight, linear, 0.1), (&stewart, &turn, angular, 0.2)]
        {
            let expected = trapezoid(way, speed, acceleration);
            let found = timed(m, motion, tool).unwrap().duration / expected - 1.0;
            assert!((-1e-9..CLOSED).contains(&found), "{speed:?} {acceleration}: {found:e}");
        }
    }
}

/// On a circle of radius `r`, the speed is at most the root of `a r`.
#[test]
fn a_circle_is_passed_at_the_speed_of_its_acceleration() {
    let m = Manipulator::example("delta").unwrap();
    let (radius, acceleration) = (0.04, 1.0);
    let home = m.home_pose();
    let mut path: Vec<_> = home.iter().map(|&home| Harmonics::constant(home)).collect();
    for (column, phase) in [FRAC_PI_2, 0.0].into_iter().enumerate() {
        path[column].sinusoids.push(Sinusoid { amplitude: radius, frequency: 1.0, phase });
    }
    let tool = ToolLimits { acceleration: Some(acceleration), ..Default::default() };
    let timed = timed(&m, &motion(3.0, Path::Harmonics(path)), tool).unwrap();
    let mut instant = Instant::new(3);
    timed.at(0.5 * timed.duration, &mut instant);
    let speed = instant.velocity[0].hypot(instant.velocity[1]);
    assert!((speed / (acceleration * radius).sqrt() - 1.0).abs() < 1e-5, "{speed}");
    assert!(timed.duration > 3.0 * TAU * radius / speed);
}

/// The largest shares of the caps at samples, by differences of the platform's places.
fn shares(m: &Manipulator, timed: &PlatformMotion, tool: ToolLimits) -> Vec<[f64; 4]> {
    let mut instant = Instant::new(m.task_coordinates().len());
    let mut place = |time: f64| -> Isometry3<f64> {
        timed.at(time, &mut instant);
        m.platform_at(&m.displacement_in(&instant.pose, m.home_mode()).unwrap())
    };
    let turn = |from: &Isometry3<f64>, to: &Isometry3<f64>| -> Vector3<f64> {
        (to.rotation * from.rotation.inverse()).scaled_axis()
    };
    let step = timed.duration * 1e-4;
    let samples = (1..2000).map(|number| {
        let time = timed.duration * f64::from(number) / 2000.0;
        let [before, here, after] = [time - step, time, time + step].map(&mut place);
        let [p, q, r] = [&before, &here, &after].map(|place| place.translation.vector);
        let (first, second) = (turn(&before, &here), turn(&here, &after));
        let found = [
            (r - p).norm() / (2.0 * step),
            (r - 2.0 * q + p).norm() / (step * step),
            (first + second).norm() / (2.0 * step),
            (second - first).norm() / (step * step),
        ];
        let caps = [tool.speed, tool.acceleration, tool.angular_speed, tool.angular_acceleration];
        std::array::from_fn(|i| found[i] / caps[i].unwrap_or(f64::INFINITY))
    });
    samples.collect()
}

/// Of every kind of mechanism: the caps hold, and nearly always one of them is used up.
#[test]
fn caps_hold_and_are_used() {
    let all = ToolLimits {
        speed: Some(0.1),
        acceleration: Some(0.8),
        angular_speed: Some(0.4),
        angular_acceleration: Some(2.5),
    };
    let linear = ToolLimits { angular_speed: None, angular_acceleration: None, ..all };
    let angular = ToolLimits { speed: None, acceleration: None, ..all };
    type Moves<'a> = &'a [(&'a str, &'a [f64])];
    let cases: [(&str, ToolLimits, Moves<'_>); 7] = [
        (
            "delta",
            linear,
            &[("x", &[0.0, 0.04, 0.0, -0.04, 0.0]), ("y", &[-0.04, 0.0, 0.04, 0.0, -0.03])],
        ),
        (
            "stewart",
            all,
            &[("x", &[0.0, 0.02, 0.03]), ("roll", &[0.0, 0.1, -0.1]), ("z", &[0.0, 0.01, -0.01])],
        ),
        (
            "agile-eye",
            angular,
            &[("zeta", &[0.0, 0.2, 0.1]), ("xi", &[0.2, 0.3, 0.25]), ("psi", &[0.0, 0.1, 0.3])],
        ),
        (
            "planar-3rrr",
            all,
            &[("x", &[0.0, 0.02, 0.0]), ("y", &[-0.02, 0.0, 0.02]), ("theta", &[0.0, 0.2, 0.1])],
        ),
        ("five-bar", linear, &[("x", &[0.0, 0.03, 0.05]), ("y", &[0.0, 0.01, -0.02])]),
        (
            "plano-spherical-5dof",
            all,
            &[("x", &[0.0, 0.02, 0.03]), ("xi", &[0.1, 0.2, 0.3]), ("psi", &[0.0, 0.2, 0.0])],
        ),
        ("tricept", all, &[("x", &[0.0, 0.03, 0.0]), ("y", &[0.0, 0.0, 0.04])]),
    ];
    for (name, tool, moves) in cases {
        let m = Manipulator::example(name).unwrap();
        let timed = timed(&m, &through(&m, moves), tool).unwrap_or_else(|e| panic!("{name}: {e}"));
        let shares = shares(&m, &timed, tool);
        let largest = |one: &[f64; 4]| one.iter().copied().fold(0.0, f64::max);
        let most = shares.iter().map(largest).fold(0.0, f64::max);
        assert!(most < 1.0 + 1e-4, "{name}: {most}");
        let used = shares.iter().filter(|one| largest(one) > USED).count();
        assert!(used as f64 > 0.97 * shares.len() as f64, "{name}: {used}");
    }
}

/// Caps beside limits of joints: both hold, and the slower decides.
#[test]
fn the_slower_limit_decides() {
    let mut mechanism = Manipulator::example("tripteron").unwrap().mechanism().clone();
    let joints = mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints);
    for c in joints.filter(|joint| joint.actuated).flat_map(|joint| &mut joint.coordinates) {
        c.motion_limits.max_rate = Some(0.3);
        c.motion_limits.max_acceleration = Some(2.0);
    }
    let m = Manipulator::new(mechanism).unwrap();
    let given = through(&m, &[("x", &[0.0, 0.2])]);
    for (speed, acceleration, expected) in [
        (None, None, trapezoid(0.2, Some(0.3), 2.0)),
        (Some(0.1), None, trapezoid(0.2, Some(0.1), 2.0)),
        (Some(0.5), Some(1.0), trapezoid(0.2, Some(0.3), 1.0)),
        (Some(0.5), Some(5.0), trapezoid(0.2, Some(0.3), 2.0)),
    ] {
        let tool = ToolLimits { speed, acceleration, ..Default::default() };
        let found = timed(&m, &given, tool).unwrap().duration / expected - 1.0;
        assert!(found.abs() < CLOSED, "{speed:?} {acceleration:?}: {found:e}");
    }
}

#[test]
fn what_has_no_timing_is_refused() {
    let m = Manipulator::example("stewart").unwrap();
    let given = through(&m, &[("x", &[0.0, 0.02])]);
    let linear = ToolLimits { acceleration: Some(1.0), ..Default::default() };
    let error = timed(&m, &given, linear).unwrap_err();
    assert!(matches!(error, TimingError::NoLimits { .. }), "{error}");
    assert!(error.to_string().contains("angular acceleration where it turns"), "{error}");
    for cap in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let tool = ToolLimits { angular_speed: Some(cap), ..linear };
        let error = timed(&m, &given, tool).unwrap_err();
        assert!(error.to_string().contains("largest angular speed of the tool is"), "{error}");
    }
}
