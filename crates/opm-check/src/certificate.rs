//! What was compared, and what was held.

use std::fmt;

/// The number of comparisons of a certificate.
const COMPARISONS: u64 = 5;

/// How much is compared, and at which random poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Random poses of each comparison.
    pub samples: u32,
    /// Seed of the random poses. The same seed gives the same certificate.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Self { samples: 200, seed: 1 }
    }
}

impl Options {
    /// The number of steps of [`check`](crate::check).
    pub fn steps(&self) -> u64 {
        COMPARISONS * u64::from(self.samples)
    }

    /// The random numbers of one comparison.
    pub(crate) fn rng(&self, comparison: u64) -> fastrand::Rng {
        fastrand::Rng::with_seed(self.seed.wrapping_mul(COMPARISONS).wrapping_add(comparison))
    }
}

/// One kind of comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Its name: `closure`, `branches`, `derivatives`, `rows` or `forward`.
    pub name: &'static str,
    /// What was compared with what.
    pub what: &'static str,
    /// The number of comparisons that were made.
    pub compared: u64,
    /// The number that was left out, because the two cannot be expected to agree: see [`Comparison::because`].
    pub left_out: u64,
    /// Why some were left out, or why nothing was compared.
    pub because: Option<String>,
    /// The largest difference, if it is one of numbers.
    pub worst: Option<f64>,
    /// The largest difference that is allowed.
    pub tolerance: Option<f64>,
    /// The first comparison that does not hold: what differs, and where.
    pub problem: Option<String>,
}

impl Comparison {
    pub(crate) fn new(name: &'static str, what: &'static str, tolerance: Option<f64>) -> Self {
        let worst = tolerance.map(|_| 0.0);
        Self {
            name,
            what,
            compared: 0,
            left_out: 0,
            because: None,
            worst,
            tolerance,
            problem: None,
        }
    }

    /// Notes a difference. One that is not a number does not hold.
    pub(crate) fn note(&mut self, off: f64, place: impl FnOnce() -> String) {
        self.compared += 1;
        let off = if off.is_nan() { f64::INFINITY } else { off };
        self.worst = self.worst.map(|worst| worst.max(off));
        let tolerance = self.tolerance.unwrap_or_default();
        if off > tolerance && self.problem.is_none() {
            self.problem =
                Some(format!("off by {off:.2e}, tolerance {tolerance:.2e}: {}", place()));
        }
    }

    /// Notes that something does not agree.
    pub(crate) fn fail(&mut self, problem: impl FnOnce() -> String) {
        self.problem.get_or_insert_with(problem);
    }

    pub(crate) fn leave_out(&mut self, because: &str) {
        self.left_out += 1;
        self.because.get_or_insert_with(|| because.to_owned());
    }

    /// Whether all that was compared agrees.
    pub fn holds(&self) -> bool {
        self.problem.is_none()
    }
}

/// What was held of a mechanism, and to what.
#[derive(Clone, Debug, PartialEq)]
pub struct Certificate {
    /// Name of the mechanism.
    pub name: String,
    /// What was asked for.
    pub options: Options,
    /// By how much the joints miss their subspaces, as rounded numbers do, radians and shares of the mechanism's size. What
    /// is compared can agree to some multiple of that at best.
    pub misfit: f64,
    /// Every kind of comparison.
    pub comparisons: Vec<Comparison>,
}

impl Certificate {
    /// Whether every comparison holds.
    pub fn holds(&self) -> bool {
        self.comparisons.iter().all(Comparison::holds)
    }
}

/// A pose and a mode in a message.
pub(crate) struct PoseInMode<'a> {
    pub manipulator: &'a opm_core::Manipulator,
    pub pose: &'a [f64],
    pub mode: opm_core::manipulator::Mode,
}

impl fmt::Display for PoseInMode<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "mode {:?}", self.manipulator.format_mode(self.mode))?;
        for (c, value) in self.manipulator.task_coordinates().iter().zip(self.pose) {
            write!(f, ", {} = {value:?}", c.name)?;
        }
        Ok(())
    }
}
