//! Motions: what is reported about them, compared with inverse kinematics at far more times.

use fastrand::Rng;
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Section};
use opm_core::mechanism::joint::MotionLimit;
use opm_core::motion::{self, Harmonics, Path, PlatformMotion, Sinusoid};
use opm_core::trajectory::{Bound, Change, Gauge, GaugedPart, Trajectory, Violation};
use opm_tests::random::{Meet, Options, PAIRS, mechanism, meet};
use std::f64::consts::{PI, TAU};

/// Samples per second of the tested motion, and of the reference.
const RATE: f64 = 200.0;
const FINE: f64 = 5000.0;
/// A measure that changes its sign between values as large as this does so at a pole.
const POLE: f64 = 1e3;
/// A measure below this is zero up to rounding.
const NOISE: f64 = 1e-12;
/// Both agree on a time up to the reference's step, because it may be on one side or the other.
const STEP: f64 = 1.0 / FINE;

/// Sinusoids about home, so wide that they meet reach, limits and singularities.
fn motion(rng: &mut Rng, manipulator: &Manipulator, seconds: f64) -> PlatformMotion {
    let harmonics = |c: &opm_core::task::TaskCoordinate| {
        let most = if c.quantity == Quantity::Angle { 0.8 } else { 0.7 };
        let mut sinusoid = || Sinusoid {
            amplitude: most * rng.f64(),
            frequency: 0.1 + 0.4 * rng.f64(),
            phase: TAU * rng.f64(),
        };
        let sinusoids = vec![sinusoid(), sinusoid()];
        let first: f64 = sinusoids.iter().map(|s| s.amplitude * s.phase.sin()).sum();
        // The motion starts at home.
        Harmonics { offset: c.home - first, sinusoids }
    };
    PlatformMotion {
        name: "random".into(),
        start: 0.0,
        duration: seconds,
        rate: None,
        mode: None,
        path: Path::Harmonics(manipulator.task_coordinates().iter().map(harmonics).collect()),
    }
}

/// Every violation of a motion.
fn violations(manipulator: &Manipulator, motion: &PlatformMotion, rate: f64) -> Vec<Violation> {
    let mode = manipulator.home_mode();
    let mut trajectory = Trajectory::new(manipulator, motion, mode, rate).unwrap();
    let mut ended = Vec::new();
    let mut last = motion.start;
    while trajectory.advance().unwrap() {
        for change in trajectory.changes() {
            assert!(change.time() >= last && change.time() <= trajectory.sample().time);
            last = change.time();
            if let Change::Ends(violation) = change {
                ended.push(*violation);
            }
        }
    }
    ended.extend(trajectory.open());
    for Violation { start, end, worst, amount, .. } in &ended {
        assert!(start <= worst && worst <= end && *amount >= 0.0, "{ended:?}");
    }
    ended
}

/// The result of single poses at one time: what is violated, and the sign of each section's
/// parallel measure.
struct Seen {
    time: f64,
    violated: Vec<(Gauge, f64)>,
    known: Vec<Gauge>,
    /// The legs that are out of reach, and in which section.
    out_of_reach: Vec<(usize, Section)>,
    signs: [Option<f64>; 2],
}

fn look(manipulator: &Manipulator, motion: &PlatformMotion) -> Vec<Seen> {
    let mut solution = manipulator.solution();
    let mut jacobians = manipulator.jacobians();
    let mut measured = manipulator.singularities();
    let mut instant = motion::Instant::new(manipulator.task_coordinates().len());
    let count = (motion.duration * FINE) as u64;
    let legs = manipulator.mechanism().legs.iter().enumerate();
    let leg_of: Vec<usize> =
        legs.flat_map(|(number, leg)| leg.coordinates().map(move |_| number)).collect();
    let mut seen = Vec::new();
    let mut lost = vec![false; manipulator.mechanism().legs.len()];
    // Near a pole, an angle may turn by half a revolution from one sample to the next. Its revolutions are not known
    // from then on.
    let mut fast = vec![false; manipulator.coordinates().len()];
    let mut history: Vec<Vec<f64>> = Vec::new();
    for number in 0..=count {
        let time = number as f64 / FINE;
        motion.at(time, &mut instant);
        let mode = manipulator.home_mode();
        let reached = match number {
            0 => manipulator.inverse(&instant.pose, mode, &mut solution),
            _ => manipulator.inverse_near(&instant.pose, mode, &mut solution),
        };
        let reached = reached.unwrap().is_some();
        history.push(solution.joints().to_vec());
        let before = &history[history.len().saturating_sub(1 + (FINE / RATE) as usize)];
        for (fast, (now, before)) in fast.iter_mut().zip(solution.joints().iter().zip(before)) {
            *fast |= (now - before).abs() > PI;
        }
        let mut violated = Vec::new();
        let mut known = Vec::new();
        for (leg, lost) in lost.iter_mut().enumerate() {
            known.push(Gauge::Reach { leg });
            if let Some(u) = solution.unreachable().iter().find(|u| u.leg == leg) {
                violated.push((Gauge::Reach { leg }, u.deficit.excess));
                *lost = true;
            }
        }
        for (coordinate, c) in manipulator.coordinates().iter().enumerate() {
            let Some([low, high]) = c.limits else { continue };
            if solution.unreachable().iter().any(|u| u.leg == leg_of[coordinate]) {
                continue;
            }
            // Back in reach, an angle is the one nearest to where it was lost. If it is π away, the
            // result depends on the exact time.
            let unsure = lost[leg_of[coordinate]] || fast[coordinate];
            if unsure && c.quantity == Quantity::Angle {
                continue;
            }
            let value = solution.joints()[coordinate];
            for (bound, past) in [(Bound::Lowest, low - value), (Bound::Highest, value - high)] {
                known.push(Gauge::Limit { coordinate, bound });
                if past > 1e-9 {
                    violated.push((Gauge::Limit { coordinate, bound }, past));
                }
            }
        }
        let mut signs = [None; 2];
        if reached {
            manipulator.differentiate(&solution, &mut jacobians).unwrap();
            manipulator.measure_singularities(&jacobians, &mut measured);
            signs = [measured.upper, measured.lower].map(|m| m.parallel);
        }
        let out_of_reach =
            solution.unreachable().iter().filter_map(|u| Some((u.leg, u.section?))).collect();
        seen.push(Seen { time, violated, known, out_of_reach, signs });
    }
    seen
}

/// Whether a leg is out of reach in both of its sections, one after the other, within a sample of a time. If it
/// is back in reach in between, the two are reported as one stretch.
fn changes_section(seen: &[Seen], leg: usize, time: f64) -> bool {
    let (at, sample) = ((time * FINE).round() as usize, (FINE / RATE) as usize);
    let near = &seen[at.saturating_sub(sample)..seen.len().min(at + sample + 1)];
    let sections: Vec<Section> = near
        .iter()
        .flat_map(|seen| &seen.out_of_reach)
        .filter(|(number, _)| *number == leg)
        .map(|(_, section)| *section)
        .collect();
    sections.contains(&Section::Lower) && sections.contains(&Section::Upper)
}

#[test]
fn what_is_violated_is_reported_and_nothing_else() {
    let (mut reach, mut limit, mut crossings) = (0, 0, 0);
    // Pairs that share a motion, then the others, each with numbers of their own.
    let (bridged, others): (Vec<_>, Vec<_>) =
        PAIRS.into_iter().partition(|pair| meet(*pair) != Meet::Nothing);
    for (pairs, mut rng) in [(bridged, Rng::with_seed(7)), (others, Rng::with_seed(8))] {
        for pair in std::iter::repeat_n(pairs, 4).flatten() {
            let options = Options { limited: 0.5, balls: true };
            let (mechanism, decomposition) = mechanism(&mut rng, pair, options);
            let manipulator = Manipulator::with_decomposition(mechanism, decomposition).unwrap();
            let motion = motion(&mut rng, &manipulator, 3.0);
            let found = violations(&manipulator, &motion, RATE);
            let seen = look(&manipulator, &motion);
            let stretches: Vec<_> = found.iter().filter(|v| !v.is_singularity()).collect();
            for Seen { time, violated, known, .. } in &seen {
                for gauge in known {
                    let of = stretches.iter().filter(|v| v.gauge == *gauge);
                    let near = |v: &&&Violation| {
                        (v.start - time).abs() < STEP || (v.end - time).abs() < STEP
                    };
                    if of.clone().any(|v| near(&v)) {
                        continue;
                    }
                    let within = of.clone().find(|v| (v.start..=v.end).contains(time));
                    let reported =
                        violated.iter().find(|(g, _)| g == gauge).map(|(_, amount)| *amount);
                    if let Gauge::Reach { leg } = gauge
                        && changes_section(&seen, *leg, *time)
                    {
                        continue;
                    }
                    assert_eq!(
                        within.is_some(),
                        reported.is_some(),
                        "{pair:?} {gauge:?} at {time}: {of:?}"
                    );
                    if let (Some(within), Some(amount)) = (within, reported)
                        && within.quantity.is_some()
                        && matches!(gauge, Gauge::Limit { .. })
                    {
                        assert!(amount <= within.amount + 1e-8, "{gauge:?} at {time}: {within:?}");
                    }
                }
            }
            reach += stretches.iter().filter(|v| matches!(v.gauge, Gauge::Reach { .. })).count();
            limit += stretches.iter().filter(|v| matches!(v.gauge, Gauge::Limit { .. })).count();

            for (i, section) in [Section::Upper, Section::Lower].into_iter().enumerate() {
                let gauge = Gauge::Parallel { part: GaugedPart::Section(section) };
                let reported: Vec<f64> =
                    found.iter().filter(|v| v.gauge == gauge).map(|v| v.start).collect();
                for pair in seen.windows(2) {
                    let [Some(before), Some(after)] = [pair[0].signs[i], pair[1].signs[i]] else {
                        continue;
                    };
                    // Where the sliders of a leg become parallel they are infinitely far out, and so is the
                    // measure: it changes its sign there without being zero.
                    let pole = before.abs().min(after.abs()) > POLE;
                    // Actuators that control nothing leave rounding.
                    let noise = before.abs().max(after.abs()) < NOISE;
                    if before * after < 0.0 && !pole && !noise {
                        crossings += 1;
                        let near = |t: &f64| *t > pair[0].time - STEP && *t < pair[1].time + STEP;
                        assert!(
                            reported.iter().any(near),
                            "{section} near {}: {reported:?}",
                            pair[0].time
                        );
                    }
                }
            }
        }
    }
    // All kinds were met.
    assert!(reach > 50 && limit > 50 && crossings > 5, "{reach} {limit} {crossings}");
}

/// Passages through singularities are at the same times whatever the sample rate, and each is
/// reported once, also if a sample before it is so near that its measure counts as zero.
#[test]
fn a_passage_through_a_singularity_is_reported_once() {
    let manipulator = shipped("double-spherical-5dof");
    let text = "format = 1\nname = \"m\"\nunits = { length = \"mm\", angle = \"deg\" }\nduration = 4\n\
        rate = 200\n[coordinates]\n\
        mu = { amplitude = 15, frequency = 0.25 }\n\
        nu = { amplitude = 12, frequency = 0.5, phase = 40 }\n\
        xi = { amplitude = 10, frequency = 0.5, offset = 20 }\n\
        zeta = { amplitude = 30, frequency = 0.25 }\n\
        psi = { amplitude = 20, frequency = 0.5, phase = 70 }\n";
    let motion = motion::file::read(text, &manipulator).unwrap();
    let of = |rate: f64| -> Vec<f64> {
        violations(&manipulator, &motion, rate).iter().map(|violation| violation.start).collect()
    };
    let finest = of(3000.0);
    assert!(finest.len() > 5, "{finest:?}");
    for rate in [200.0, 290.0, 700.0, 1000.0] {
        let found = of(rate);
        assert_eq!(found.len(), finest.len(), "{rate}: {found:?}, expected {finest:?}");
        for (a, b) in found.iter().zip(&finest) {
            assert!((a - b).abs() < 1e-5, "{rate}: {found:?}, expected {finest:?}");
        }
    }
}

/// The sliders of the helical manipulator are linear in the pose (Eq. 27 of the paper). The third
/// slider passes its limit for 14 ms between two samples that are 100 ms apart, or 0.5 s apart.
#[test]
fn a_dip_between_two_samples_is_found_where_the_slopes_say_so() {
    let manipulator = shipped("translational-helical-3dof");
    let amplitude = 0.4 + 1e-4 - 0.025 * 165_f64.to_radians().sin();
    for (rate, phase) in [(10.0, 171.0), (2.0, 150.0)] {
        let x = Sinusoid { amplitude, frequency: 0.5, phase: f64::to_radians(phase) };
        let x = Harmonics { offset: 0.0, sinusoids: vec![x] };
        let still = Harmonics::constant(0.0);
        let path = Path::Harmonics(vec![x, still.clone(), still]);
        let motion = PlatformMotion {
            name: "dip".into(),
            start: 0.0,
            duration: 2.0,
            rate: None,
            mode: None,
            path,
        };
        let found = violations(&manipulator, &motion, rate);
        let [violation] = found[..] else { panic!("{rate}: {found:?}") };
        let lowest = (270.0 - phase) / 180.0;
        let half = ((amplitude - 1e-4) / amplitude).acos() / PI;
        assert!((violation.start - (lowest - half)).abs() < 1e-9, "{violation:?}");
        assert!((violation.end - (lowest + half)).abs() < 1e-9, "{violation:?}");
        assert!((violation.amount - 1e-4).abs() < 1e-12, "{violation:?}");
        assert!((violation.worst - lowest).abs() < 1e-6, "{violation:?}");
    }
}

/// The paper's arm of two links of 100 mm from (0, 75) reaches 200 mm: down to y = -125 mm at x =
/// 0. On the way there and back it folds, at y = 75 mm.
#[test]
fn the_end_of_an_arm_is_found_between_two_samples() {
    let manipulator = shipped("plano-spherical-5dof");
    let y = Sinusoid { amplitude: 0.1251, frequency: 0.25, phase: 0.1 };
    let mut path: Vec<_> =
        manipulator.task_coordinates().iter().map(|c| Harmonics::constant(c.home)).collect();
    path[1].sinusoids.push(y);
    let path = Path::Harmonics(path);
    let motion = PlatformMotion {
        name: "arm".into(),
        start: 0.0,
        duration: 4.0,
        rate: None,
        mode: None,
        path,
    };
    let found = violations(&manipulator, &motion, 5.0);
    let arm: Vec<_> = found.iter().filter(|v| v.gauge == Gauge::Reach { leg: 3 }).collect();
    let [fold, unfold, violation] = arm[..] else { panic!("{found:?}") };
    let folded = (0.075 / 0.1251_f64).asin();
    for (touch, angle) in [(fold, folded), (unfold, PI - folded)] {
        assert!(touch.is_singularity() && touch.section == Some(Section::Lower), "{touch:?}");
        assert!((touch.start - (angle - 0.1) / (PI / 2.0)).abs() < 1e-8, "{touch:?}");
    }
    assert_eq!(
        (violation.section, violation.quantity),
        (Some(Section::Lower), Some(Quantity::Length))
    );
    // The condition 0.1251 sin(π t / 2 + 0.1) = -0.125.
    let half = (0.125 / 0.1251_f64).acos() / (PI / 2.0);
    let lowest = (1.5 * PI - 0.1) / (PI / 2.0);
    assert!((violation.start - (lowest - half)).abs() < 1e-9, "{violation:?}");
    assert!((violation.end - (lowest + half)).abs() < 1e-9, "{violation:?}");
    assert!((violation.amount - 1e-4).abs() < 1e-9, "{violation:?}");
}

/// Rates are derivatives of the reported values, also where an angle passes π.
#[test]
fn joints_move_on_as_their_rates_say() {
    for example in motion::examples::MOTIONS {
        let manipulator = shipped(example.mechanism);
        let motion = motion::file::read(example.text, &manipulator).unwrap();
        let (rate, mode) = (1e4, manipulator.home_mode());
        let mut trajectory = Trajectory::new(&manipulator, &motion, mode, rate).unwrap();
        let mut held: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
        while trajectory.advance().unwrap() {
            assert!(
                trajectory.changes().is_empty(),
                "{}: {:?}",
                example.name,
                trajectory.changes()
            );
            let sample = trajectory.sample();
            assert!(sample.valid() && sample.regular && sample.condition < 100.0);
            held.push((sample.solution.joints().to_vec(), sample.motion.joint_rates.clone()));
            if held.len() == 3 {
                for (i, c) in manipulator.coordinates().iter().enumerate() {
                    let difference = (held[2].0[i] - held[0].0[i]) * 0.5 * rate;
                    // The error is the step's square times a third derivative of some ten per
                    // second cubed.
                    let off = (difference - held[1].1[i]).abs();
                    assert!(off < 1e-6, "{}: {} is off by {off}", example.name, c.name);
                }
                held.remove(0);
            }
        }
    }
}

/// The end is a sample, even if it is not a whole number of steps away, and an invalid rate is an
/// error.
#[test]
fn samples_go_from_start_to_end() {
    let manipulator = shipped("translational-helical-3dof");
    let still = vec![Harmonics::constant(0.0); 3];
    let path = Path::Harmonics(still);
    let mut motion = PlatformMotion {
        name: "still".into(),
        start: 5.0,
        duration: 0.3,
        rate: None,
        mode: None,
        path,
    };
    for (duration, rate, samples) in [(0.3, 10.0, 4), (0.35, 10.0, 5), (1.0, 0.1, 2), (2.0, 1.0, 3)]
    {
        motion.duration = duration;
        let mode = manipulator.home_mode();
        let mut trajectory = Trajectory::new(&manipulator, &motion, mode, rate).unwrap();
        assert_eq!(trajectory.samples(), samples, "{duration} {rate}");
        let mut times = Vec::new();
        while trajectory.advance().unwrap() {
            times.push(trajectory.sample().time);
        }
        assert_eq!(times.len() as u64, samples);
        assert_eq!((times[0], times[times.len() - 1]), (5.0, 5.0 + duration));
    }
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
        let mode = manipulator.home_mode();
        assert!(Trajectory::new(&manipulator, &motion, mode, rate).is_err());
    }
}

fn shipped(name: &str) -> Manipulator {
    Manipulator::example(name).unwrap()
}

/// Two sliders that are coordinates of the pose, so that their rates and accelerations are known: they swing as
/// `A sin(w t)`, and a limit of `share` of their largest rate or acceleration is passed where the cosine or the sine is
/// larger than that.
#[test]
fn rates_and_accelerations_beyond_their_limits_are_found_between_samples() {
    let (amplitude, rate, share) = (0.1, TAU * 0.5, 0.999_9);
    for (limit, at_most, first) in [
        (MotionLimit::Rate, amplitude * rate, 1.0),
        (MotionLimit::Acceleration, amplitude * rate * rate, 0.5),
    ] {
        let text = opm_core::mechanism::examples::find("cartesian-wrist-6dof").unwrap().text;
        let limits = "limits = [\"-lift\", \"lift\"]";
        let slow = format!("{limits}, {} = {}", limit.key(), 1000.0 * share * at_most);
        let text = text.replace(limits, &slow);
        let manipulator = Manipulator::read(&text).unwrap();
        let z = manipulator.task_coordinates().iter().position(|c| c.name == "z").unwrap();
        let mut path: Vec<Harmonics> =
            manipulator.task_coordinates().iter().map(|c| Harmonics::constant(c.home)).collect();
        path[z].sinusoids.push(Sinusoid { amplitude, frequency: 0.5, phase: 0.0 });
        // It starts and ends a quarter of a second away from the middle of every excess.
        let motion = PlatformMotion {
            name: "swing".into(),
            start: 0.25,
            duration: 3.0,
            rate: None,
            mode: None,
            path: Path::Harmonics(path),
        };
        let found = violations(&manipulator, &motion, 13.0);
        let half = share.acos() / rate;
        assert_eq!(found.len(), 3, "{found:?}");
        for (number, violation) in found.iter().enumerate() {
            let Gauge::Motion { coordinate, limit: what } = violation.gauge else { panic!() };
            assert_eq!((&*manipulator.coordinates()[coordinate].name, what), ("z3", limit));
            assert_eq!(violation.quantity, Some(Quantity::Length));
            let middle = first + number as f64;
            assert!((violation.start - (middle - half)).abs() < 1e-6, "{violation:?} {middle}");
            assert!((violation.end - (middle + half)).abs() < 1e-6, "{violation:?} {middle}");
            assert!((violation.worst - middle).abs() < 1e-6, "{violation:?} {middle}");
            let beyond = (1.0 - share) * at_most;
            assert!((violation.amount - beyond).abs() < 3e-9 * at_most, "{violation:?} {beyond}");
        }
        // They are no limits of the workspace.
        let mut trajectory =
            Trajectory::new(&manipulator, &motion, manipulator.home_mode(), 10.0).unwrap();
        while trajectory.advance().unwrap() {
            assert!(trajectory.sample().valid());
        }
    }
}
