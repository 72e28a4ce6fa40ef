//! Motions through structured poses: standing still, whole and half turns, straight lines.

use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{examples, file};
use opm_core::motion::{
    Ends, Harmonics, Instant, Path, PlatformMotion, Spline, file as motion_file, table,
};
use opm_core::trajectory::Trajectory;
use std::f64::consts::PI;

/// A straight line is its own spline: constant, and as fast throughout.
#[test]
fn lines_stay_lines() {
    for times in [vec![0.0, 1.0, 2.0, 3.0], vec![-1.0, 0.0, 0.25, 8.0, 9.0]] {
        for (start, rate) in [(0.0, 0.0), (PI, 0.0), (0.0, PI), (-2.0 * PI, 1.0)] {
            let values = times.iter().map(|t| start + rate * t).collect();
            let spline = Spline::new(times.clone(), vec![values], Ends::Natural).unwrap();
            let mut at = Instant::new(1);
            for step in 0..=90 {
                let t = times[0] + f64::from(step) / 90.0 * (times[times.len() - 1] - times[0]);
                spline.at(t, &mut at);
                assert!((at.pose[0] - start - rate * t).abs() < 1e-13, "{t}: {at:?}");
                assert!((at.velocity[0] - rate).abs() < 1e-12, "{t}: {at:?}");
                assert!(at.acceleration[0].abs() < 1e-11, "{t}: {at:?}");
            }
        }
    }
}

/// Half a turn from line to line goes on the way that the lines say.
#[test]
fn half_turns_go_on() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    for sign in [1.0, -1.0] {
        let lines: Vec<String> =
            (0..5).map(|i| format!("{i},{:?}", sign * f64::from(i) * PI)).collect();
        let text = format!("t,zeta\n{}\n", lines.join("\n"));
        let options = table::TableOptions { ends: Ends::Natural, ..Default::default() };
        let motion = table::read(&text, "turns", &m, &options).unwrap().motion;
        let mut at = Instant::new(5);
        for step in 0..=40 {
            let t = 0.1 * f64::from(step);
            motion.at(t, &mut at);
            assert!((at.pose[2] - sign * t * PI).abs() < 1e-12, "{t}: {at:?}");
            assert!((at.velocity[2] - sign * PI).abs() < 1e-12, "{t}: {at:?}");
        }
    }
}

/// Standing still at home: nothing moves, nothing is violated, and every joint is at its home value.
#[test]
fn standing_at_home_nothing_moves() {
    let mut followed = 0;
    for example in examples::EXAMPLES {
        let mechanism = file::read(example.text).unwrap().mechanism;
        // Linkages are moved by one joint.
        let Ok(m) = Manipulator::new(mechanism) else { continue };
        let constants = m.task_coordinates().iter().map(|c| Harmonics::constant(c.home)).collect();
        let motion = PlatformMotion {
            name: "still".to_owned(),
            start: 0.0,
            duration: 1.0,
            rate: None,
            mode: None,
            path: Path::Harmonics(constants),
        };
        let mut trajectory = Trajectory::new(&m, &motion, m.home_mode(), 10.0).unwrap();
        while trajectory.advance().unwrap() {
            let sample = trajectory.sample();
            assert!(sample.valid() && sample.regular && trajectory.changes().is_empty());
            for (coordinate, q) in m.coordinates().iter().zip(sample.solution.joints()) {
                assert!((q - coordinate.home).abs() < 1e-9, "{} {}", example.name, coordinate.name);
            }
            let rates = sample.motion.joint_rates.iter().chain(&sample.motion.joint_accelerations);
            assert!(rates.copied().all(|rate| rate == 0.0), "{}", example.name);
        }
        followed += 1;
    }
    assert_eq!(
        followed,
        examples::EXAMPLES.len() - 2,
        "every mechanism but Bennett's two linkages"
    );
}

/// Exact half and quarter turns, zeros and whole turns of a motion file arrive as they are written.
#[test]
fn motion_files_keep_structured_numbers() {
    let m = Manipulator::example("plano-spherical-5dof").unwrap();
    for quarters in -8..=8 {
        let degrees = 90 * quarters;
        let text = format!(
            "format = 1\nname = \"turn\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\nrate = 10\n\
             [coordinates]\nx = 0\nzeta = {degrees}\n\
             psi = {{ amplitude = {degrees}, frequency = 1, phase = {degrees} }}\n"
        );
        let motion = motion_file::read(&text, &m).unwrap_or_else(|error| panic!("{error}"));
        let turn = f64::from(quarters) * (PI / 2.0);
        let mut at = Instant::new(5);
        for eighth in 0..=8 {
            let t = f64::from(eighth) / 8.0;
            motion.at(t, &mut at);
            assert_eq!(at.pose[0], 0.0);
            assert!((at.pose[2] - turn).abs() < 1e-14, "{degrees} deg: {at:?}");
            let psi = turn * (2.0 * PI * t + turn).sin();
            assert!((at.pose[4] - psi).abs() < 1e-12, "{degrees} deg at {t}: {at:?}");
        }
    }
}
