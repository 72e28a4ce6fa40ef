//! What the benchmarks share: timing two things in one run, turn and turn about, since on a machine
//! that others use only their ratio means anything.

use opm_core::manipulator::Manipulator;
use opm_core::mechanism::{examples, file};
use std::time::{Duration, Instant};

/// Rounds of a comparison; the median of an odd number is one of them.
const ROUNDS: usize = 41;

/// A round is to last about this long, far above the clock's grain.
const ROUND: Duration = Duration::from_millis(10);

/// One piece of work, to be timed.
pub struct Contender<'a> {
    /// What the table calls it.
    pub name: &'static str,
    /// Operations in one call of `run`.
    pub operations: u64,
    /// The work.
    pub run: Box<dyn FnMut() + 'a>,
}

impl<'a> Contender<'a> {
    /// Work of so many operations a call.
    pub fn new(name: &'static str, operations: u64, run: impl FnMut() + 'a) -> Self {
        Self { name, operations, run: Box::new(run) }
    }
}

/// What a contender took.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// The contender.
    pub name: &'static str,
    /// Median over the rounds, seconds an operation.
    pub seconds: f64,
    /// Median of the rounds' ratios of its time to the first contender's.
    pub ratio: f64,
}

/// Times the contenders in turn, round after round, and compares each with the first.
pub fn compare(mut contenders: Vec<Contender<'_>>) -> Vec<Timing> {
    let calls: Vec<u32> = contenders
        .iter_mut()
        .map(|c| {
            (c.run)();
            let start = Instant::now();
            (c.run)();
            let once = start.elapsed().max(Duration::from_nanos(1));
            (ROUND.as_secs_f64() / once.as_secs_f64()).ceil().max(1.0) as u32
        })
        .collect();
    let mut rounds = vec![Vec::with_capacity(ROUNDS); contenders.len()];
    for _ in 0..ROUNDS {
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

/// A shipped mechanism.
///
/// # Panics
/// If there is none of this name.
pub fn example(name: &str) -> Manipulator {
    let text = examples::find(name).expect("a shipped mechanism").text;
    let file = file::read(text).expect("shipped mechanisms are read");
    Manipulator::new(file.mechanism).expect("shipped mechanisms decompose")
}
