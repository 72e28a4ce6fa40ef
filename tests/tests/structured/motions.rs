//! Motions through structured poses: standing still, whole and half turns, straight lines.

use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{examples, file};
use opm_core::motion::{Instant, Spline, table};
use std::f64::consts::PI;

/// A straight line is its own spline: constant, and as fast throughout.
#[test]
fn lines_stay_lines() {
    for times in [vec![0.0, 1.0, 2.0, 3.0], vec![-1.0, 0.0, 0.25, 8.0, 9.0]] {
        for (start, rate) in [(0.0, 0.0), (PI, 0.0), (0.0, PI), (-2.0 * PI, 1.0)] {
            let values = times.iter().map(|t| start + rate * t).collect();
            let spline = Spline::new(times.clone(), vec![values]).unwrap();
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
    let text = examples::find("plano-spherical-5dof").unwrap().text;
    let m = Manipulator::new(file::read(text).unwrap().mechanism).unwrap();
    for sign in [1.0, -1.0] {
        let lines: Vec<String> =
            (0..5).map(|i| format!("{i},{:?}", sign * f64::from(i) * PI)).collect();
        let motion = table::read(&format!("t,zeta\n{}\n", lines.join("\n")), "turns", &m).unwrap();
        let mut at = Instant::new(5);
        for step in 0..=40 {
            let t = 0.1 * f64::from(step);
            motion.at(t, &mut at);
            assert!((at.pose[2] - sign * t * PI).abs() < 1e-12, "{t}: {at:?}");
            assert!((at.velocity[2] - sign * PI).abs() < 1e-12, "{t}: {at:?}");
        }
    }
}
