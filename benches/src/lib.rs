//! What the benchmarks share: alternating the timing of several things in one run. On a machine
//! that is used by others too, only the ratio of times is meaningful.

pub mod peers;
pub mod square_roots;

use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_workspace::{Axis, Grid};
use std::process::Command;
use std::time::{Duration, Instant};

/// The number of rounds of a comparison if they are short. The number is odd, so that the median is
/// one of them.
const ROUNDS: usize = 41;

/// The least number of rounds of a comparison, however long one takes.
const LEAST_ROUNDS: usize = 9;

/// The approximate time for all rounds, if it allows more than the least number.
const ALL_ROUNDS: Duration = Duration::from_secs(60);

/// The approximate time for one round, far above the resolution of the clock.
const ROUND: Duration = Duration::from_millis(10);

/// One piece of work to be timed.
pub struct Contender<'a> {
    /// The name in the table.
    pub name: &'static str,
    /// The number of operations in one call of `run`.
    pub operations: u64,
    /// The work.
    pub run: Box<dyn FnMut() + 'a>,
}

impl<'a> Contender<'a> {
    /// Work with this number of operations per call.
    pub fn new(name: &'static str, operations: u64, run: impl FnMut() + 'a) -> Self {
        Self { name, operations, run: Box::new(run) }
    }
}

/// The timing of a contender.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// The name of the contender.
    pub name: &'static str,
    /// The median over the rounds, in seconds per operation.
    pub seconds: f64,
    /// The median over the rounds of its time divided by the first contender's.
    pub ratio: f64,
}

/// Times the contenders alternately, round after round, and compares each with the first.
pub fn compare(mut contenders: Vec<Contender<'_>>) -> Vec<Timing> {
    let mut round = Duration::ZERO;
    let calls: Vec<u32> = contenders
        .iter_mut()
        .map(|c| {
            (c.run)();
            let start = Instant::now();
            (c.run)();
            let once = start.elapsed().max(Duration::from_nanos(1));
            let calls = (ROUND.as_secs_f64() / once.as_secs_f64()).ceil().max(1.0) as u32;
            round += once * calls;
            calls
        })
        .collect();
    let count = (ALL_ROUNDS.as_secs_f64() / round.as_secs_f64()) as usize;
    let mut rounds = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    for _ in 0..count.clamp(LEAST_ROUNDS, ROUNDS) | 1 {
        for ((contender, &calls), times) in contenders.iter_mut().zip(&calls).zip(&mut rounds) {
            let start = Instant::now();
            (0..calls).for_each(|_| (contender.run)());
            let operations = contender.operations as f64 * f64::from(calls);
            times.push(start.elapsed().as_secs_f64() / operations);
        }
    }
    contenders
        .iter()
        .zip(&rounds)
        .map(|(contender, times)| Timing {
            name: contender.name,
            seconds: median(times.clone()),
            ratio: median(times.iter().zip(&rounds[0]).map(|(t, first)| t / first).collect()),
        })
        .collect()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The program, built for release, which the variable OPM names: `make bench` sets it.
///
/// # Panics
/// If the variable is missing.
pub fn program() -> Command {
    Command::new(std::env::var_os("OPM").expect("the path of the program, in the variable OPM"))
}

/// The shipped mechanism with this name.
///
/// # Panics
/// If there is no mechanism with this name.
pub fn example(name: &str) -> Manipulator {
    Manipulator::example(name).expect("a shipped mechanism with closed forms")
}

/// A grid of `rows` rows of `points` places in the plane of the 5-DoF manipulator, and `orientations`
/// values of each Euler angle.
///
/// # Panics
/// If the manipulator has other coordinates.
pub fn sweep_grid(manipulator: &Manipulator, [points, rows, orientations]: [u64; 3]) -> Grid {
    let axes = vec![
        Axis::new("x", -0.15, 0.15, points),
        Axis::new("y", -0.15, 0.15, rows),
        Axis::new("zeta", -0.4, 0.4, orientations),
        Axis::new("xi", -0.4, 0.4, orientations),
        Axis::new("psi", -0.4, 0.4, orientations),
    ];
    Grid::new(manipulator, axes).expect("a grid")
}

/// The axes of a grid with twice as many values of one coordinate after the other, until there are `enough`.
///
/// # Panics
/// If no axis has several values.
pub fn denser(axes: &[Axis], mut enough: impl FnMut(&[Axis]) -> bool) -> Vec<Axis> {
    let varying: Vec<usize> = (0..axes.len()).filter(|&number| axes[number].count > 1).collect();
    assert!(!varying.is_empty(), "some coordinate has several values");
    let mut axes = axes.to_vec();
    for number in varying.into_iter().cycle() {
        if enough(&axes) {
            break;
        }
        axes[number].count *= 2;
    }
    axes
}

/// Random poses of the 5-DoF manipulator that every leg reaches, as in a control loop.
///
/// # Panics
/// If the manipulator has other coordinates.
pub fn reached(manipulator: &Manipulator, count: usize) -> Vec<[f64; 5]> {
    let mut rng = fastrand::Rng::with_seed(1);
    let mut solution = manipulator.solution();
    let draw = || [0.1, 0.1, 0.4, 0.4, 0.4].map(|half| half * (2.0 * rng.f64() - 1.0));
    let mode = manipulator.home_mode();
    std::iter::repeat_with(draw)
        .filter(|pose| manipulator.inverse(pose, mode, &mut solution).expect("a pose").is_some())
        .take(count)
        .collect()
}

/// The 5-DoF manipulator with the two pivots of each link that slides within 0.7 and 0.9 radians of home.
///
/// # Panics
/// If there are no such pivots.
pub fn with_limits_on_links(manipulator: &Manipulator) -> Manipulator {
    let mut mechanism = manipulator.mechanism().clone();
    for leg in &mut mechanism.legs[..3] {
        for (joint, most) in leg.joints[1..3].iter_mut().zip([0.7, 0.9]) {
            let angle = &mut joint.coordinates[0];
            angle.limits = Some([angle.home - most, angle.home + most]);
        }
    }
    Manipulator::new(mechanism).expect("limits change nothing else")
}

/// The same mechanism with limits of a radian to either side on every passive revolute joint.
///
/// # Panics
/// Never: limits change nothing else.
pub fn with_limits_on_passive_angles(manipulator: &Manipulator) -> Manipulator {
    let mut mechanism = manipulator.mechanism().clone();
    for joint in mechanism.legs.iter_mut().flat_map(|leg| &mut leg.joints) {
        if let [angle] = &mut joint.coordinates[..]
            && angle.quantity == Quantity::Angle
            && !joint.actuated
        {
            angle.limits = Some([angle.home - 1.0, angle.home + 1.0]);
        }
    }
    Manipulator::new(mechanism).expect("limits change nothing else")
}
