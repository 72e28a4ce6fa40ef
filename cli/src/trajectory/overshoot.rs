//! Splines that go beyond their points.

use crate::args::Output;
use crate::load::Loaded;
use crate::motion::LoadedMotion;
use crate::text::short;
use opm_core::manipulator::Manipulator;
use opm_core::motion::{Instant, Path, Spline};

/// The share of the range of its points by which a coordinate may go beyond it untold.
const UNTOLD: f64 = 0.01;

/// Tells by how much coordinates of a spline go below their lowest or above their highest point.
pub fn note(
    motion: &LoadedMotion,
    (loaded, manipulator): (&Loaded, &Manipulator),
    output: &Output,
) {
    let Path::Spline(spline) = &motion.motion.path else { return };
    let units = loaded.file.units;
    for (number, coordinate) in manipulator.task_coordinates().iter().enumerate() {
        let Some(Overshoot { value, time, by }) = overshoot(spline, number) else { continue };
        let (factor, unit) = (units.factor(coordinate.quantity), units.symbol(coordinate.quantity));
        let side = if by < 0.0 { "below its lowest point" } else { "above its highest point" };
        let (value, by) = (short(value / factor), short(by.abs() / factor));
        output.note(format_args!(
            "{}: {} goes to {value} {unit} at t = {} s, {by} {unit} {side}: a spline is smooth through its \
             points and overshoots; points closer together hold it, and moves are straight",
            motion.label,
            coordinate.name,
            short(time),
        ));
    }
}

/// How far a coordinate goes beyond its points, where it does so most.
struct Overshoot {
    value: f64,
    /// Seconds.
    time: f64,
    /// Beyond the lowest point if negative, beyond the highest if positive.
    by: f64,
}

fn overshoot(spline: &Spline, number: usize) -> Option<Overshoot> {
    let times = spline.times();
    let mut instant = Instant::new(spline.column_count());
    let mut at = |time: f64| {
        spline.at(time, &mut instant);
        [instant.pose[number], instant.velocity[number], instant.acceleration[number]]
    };
    let knots: Vec<[f64; 3]> = times.iter().map(|&time| at(time)).collect();
    let values = || knots.iter().map(|knot| knot[0]);
    let [low, high] = [values().fold(f64::MAX, f64::min), values().fold(f64::MIN, f64::max)];
    let mut most: Option<Overshoot> = None;
    for (knots, times) in knots.windows(2).zip(times.windows(2)) {
        let ([_, slope, bend], [_, _, next]) = (knots[0], knots[1]);
        let width = times[1] - times[0];
        // The slope at s is slope + bend s + half s²: the acceleration is continuous, and linear between knots.
        let half = 0.5 * (next - bend) / width;
        let root = bend * bend - 4.0 * half * slope;
        if root < 0.0 {
            continue;
        }
        // Both roots without cancellation.
        let q = -0.5 * (bend + root.sqrt().copysign(bend));
        for s in [q / half, slope / q].into_iter().filter(|s| *s > 0.0 && *s < width) {
            let time = times[0] + s;
            let [value, ..] = at(time);
            let by = (value - high).max(0.0) + (value - low).min(0.0);
            if by.abs() > most.as_ref().map_or(UNTOLD * (high - low), |most| most.by.abs()) {
                most = Some(Overshoot { value, time, by });
            }
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use opm_core::motion::Ends;

    /// Compared with ten thousand samples of the spline, and with points that it does not leave.
    #[test]
    fn the_largest_overshoot_is_found() {
        let times: Vec<f64> = vec![0.0, 0.4, 1.0, 1.7, 2.0, 3.1];
        for values in [
            vec![0.0, 0.0, -0.1, -0.1, 0.05, 0.0],
            vec![1.0, 1.0, 1.2, 1.2, 1.0, 1.0],
            vec![0.0, 1.0, 0.0, 1.0, 0.0, 3.0],
        ] {
            let low = values.iter().copied().fold(f64::MAX, f64::min);
            let high = values.iter().copied().fold(f64::MIN, f64::max);
            for ends in [Ends::Rest, Ends::Natural] {
                let spline = Spline::new(times.clone(), vec![values.clone()], ends).unwrap();
                let mut instant = Instant::new(1);
                let beyond = (0..=10_000).map(|i| {
                    spline.at(3.1 * f64::from(i) / 10_000.0, &mut instant);
                    let value = instant.pose[0];
                    (value - high).max(0.0) + (value - low).min(0.0)
                });
                let sampled = beyond.max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap();
                let found = overshoot(&spline, 0).map_or(0.0, |found| found.by);
                assert!((found - sampled).abs() < 1e-5, "{found} {sampled}");
                assert!(found != 0.0);
            }
        }
        let times: Vec<f64> = (0..5).map(f64::from).collect();
        let straight = Spline::new(times.clone(), vec![times], Ends::Rest).unwrap();
        assert!(overshoot(&straight, 0).is_none());
    }
}
