//! The record of violations: when they begin and end, and how large they are at worst.

use super::{Gauge, GaugedPart, Sample, Trajectory, Violation};
use crate::velocity::SINGULAR;

/// A violation begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// The violation begins. Its end and its worst time are not known yet, except for a singularity, which
    /// ends when it begins.
    Begins(Violation),
    /// The violation has ended.
    Ends(Violation),
}

impl Change {
    /// The time of the beginning or the end, seconds.
    pub fn time(&self) -> f64 {
        match self {
            Self::Begins(violation) => violation.start,
            Self::Ends(violation) => violation.end,
        }
    }
}

impl Trajectory<'_> {
    /// Whether a gauge says that the motion cannot be followed.
    pub(super) fn violated(&self, number: usize, sample: &Sample) -> bool {
        match self.solver.gauges[number] {
            Gauge::Reach { .. }
            | Gauge::Limit { .. }
            | Gauge::Difference { .. }
            | Gauge::Motion { .. } => sample.levels[number].is_some_and(|level| level < 0.0),
            Gauge::Parallel { .. } => false,
        }
    }

    /// Whether a gauge is a singularity measure that is zero up to rounding.
    pub(super) fn is_zero(&self, number: usize, sample: &Sample) -> bool {
        match self.solver.gauges[number] {
            Gauge::Limit { .. } | Gauge::Difference { .. } | Gauge::Motion { .. } => false,
            Gauge::Reach { .. } | Gauge::Parallel { .. } => {
                sample.levels[number].is_some_and(|level| level.abs() < SINGULAR)
            }
        }
    }

    /// Opens or closes a violation where a gauge has passed zero between two samples.
    pub(super) fn switch(&mut self, number: usize, before: &Sample, after: &Sample) {
        match (self.open[number].is_some(), self.violated(number, after)) {
            (false, true) => self.begins(number, after.time, after),
            (true, false) => self.ends(number, before.time),
            _ => {}
        }
    }

    /// Opens a violation.
    pub(super) fn begins(&mut self, number: usize, time: f64, sample: &Sample) {
        let mut violation = self.violation(number, sample);
        (violation.start, violation.end, violation.worst) = (time, time, time);
        self.open[number] = Some(violation);
        self.changes.push(Change::Begins(violation));
    }

    /// Closes a violation.
    fn ends(&mut self, number: usize, time: f64) {
        if let Some(mut violation) = self.open[number].take() {
            violation.end = time.max(violation.start);
            self.changes.push(Change::Ends(violation));
        }
    }

    /// Records a singularity, which begins and ends at one time.
    pub(super) fn record_singularity(&mut self, number: usize, sample: &Sample) {
        let violation = self.violation(number, sample);
        self.changes.push(Change::Begins(violation));
        self.changes.push(Change::Ends(violation));
    }

    /// Extends the open violations to the present sample.
    pub(super) fn extend_open(&mut self) {
        if self.open.iter().all(Option::is_none) {
            return;
        }
        let sample = self.current.clone();
        for number in 0..self.solver.gauges.len() {
            if let Some(violation) = &mut self.open[number] {
                violation.end = sample.time;
                self.update_worst(number, &sample);
            }
        }
    }

    /// Updates the worst time and the amount of an open violation, if it is worse at this sample.
    pub(super) fn update_worst(&mut self, number: usize, sample: &Sample) {
        let now = self.violation(number, sample);
        if let Some(open) = &mut self.open[number]
            && now.amount > open.amount
            && sample.levels[number].is_some_and(|level| level < 0.0)
        {
            let Violation { amount, quantity, section, worst, .. } = now;
            *open = Violation { amount, quantity, section, worst, ..*open };
        }
    }

    /// The violation of one gauge at one sample.
    fn violation(&self, number: usize, sample: &Sample) -> Violation {
        let time = sample.time;
        let gauge = self.solver.gauges[number];
        let level = sample.levels[number].unwrap_or_default().abs();
        let (amount, quantity, section) = match gauge {
            Gauge::Reach { leg } => {
                match sample.solution.unreachable.iter().find(|u| u.leg == leg) {
                    Some(u) => (u.deficit.excess, Some(u.deficit.quantity), u.section),
                    None => {
                        let section = self.solver.manipulator.serial(&sample.solution, leg).1;
                        (level, None, section)
                    }
                }
            }
            Gauge::Limit { coordinate, .. } | Gauge::Motion { coordinate, .. } => {
                (level, Some(self.solver.manipulator.coordinates()[coordinate].quantity), None)
            }
            Gauge::Difference { number } => {
                (level, Some(self.solver.manipulator.differences()[number].quantity), None)
            }
            Gauge::Parallel { part: GaugedPart::Section(section) } => (level, None, Some(section)),
            Gauge::Parallel { part: GaugedPart::Whole } => (level, None, None),
        };
        Violation { gauge, start: time, end: time, worst: time, amount, quantity, section }
    }
}
