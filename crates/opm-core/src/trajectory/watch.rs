//! The events between two samples: gauges that cross zero.

use super::search::Stretch;
use super::{Gauge, NearestTo, RESOLUTION, Sample, SlopeSide, Trajectory, TrajectoryError};

/// This share of the step is left out before and after a singularity: a hundred times the error of the time
/// that was found.
const MARGIN: f64 = 1e-6;

/// A remaining step of the search between two samples. Steps are in the order of time.
enum Step {
    /// Search everything from the present sample to this one.
    WatchTo(Sample),
    /// Record that the gauge of this number is lowest at the present sample.
    Lowest(usize),
    /// Search limits and parallel singularities up to this sample, which the same legs reach.
    StretchTo(Sample),
}

impl Trajectory<'_> {
    /// Opens the violations at the first sample, and records singularities there.
    pub(super) fn begin(&mut self) {
        let sample = self.current.clone();
        for number in 0..self.solver.gauges.len() {
            if self.violated(number, &sample) {
                self.begins(number, sample.time, &sample);
            } else if self.is_zero(number, &sample) {
                self.record_singularity(number, &sample);
            }
        }
    }

    /// Records a parallel singularity that the motion reaches at the last sample.
    pub(super) fn end(&mut self) {
        let sample = self.current.clone();
        for number in 0..self.solver.gauges.len() {
            let parallel = matches!(self.solver.gauges[number], Gauge::Parallel { .. });
            if parallel && self.is_zero(number, &sample) && self.approaches_zero(number, &sample) {
                self.record_singularity(number, &sample);
            }
        }
    }

    /// Whether a gauge approaches zero at a sample.
    fn approaches_zero(&self, number: usize, sample: &Sample) -> bool {
        matches!((sample.levels[number], sample.slopes[number]), (Some(a), Some(b)) if a * b < 0.0)
    }

    /// Whether there may be an event between the last two samples. Mostly there is none.
    pub(super) fn may_have_events(&self) -> bool {
        let (from, to) = (&self.previous, &self.current);
        let differ = |a: Option<f64>, b: Option<f64>| {
            a.is_some() != b.is_some() || matches!((a, b), (Some(a), Some(b)) if a * b <= 0.0)
        };
        (0..self.solver.gauges.len()).any(|number| {
            differ(from.levels[number], to.levels[number])
                || differ(from.slopes[number], to.slopes[number])
                || self.is_zero(number, to)
        })
    }

    /// Finds the events from one sample to the next, and returns the last sample. That may differ from `to`:
    /// the angles of a leg that returns into reach in between continue from there.
    pub(super) fn watch(&mut self, from: Sample, to: Sample) -> Result<Sample, TrajectoryError> {
        // The sample up to which events are found, and the remaining steps, the next one last.
        let mut here = from;
        let mut left = vec![Step::WatchTo(to)];
        while let Some(step) = left.pop() {
            here = match step {
                Step::Lowest(number) => {
                    self.update_worst(number, &here);
                    here
                }
                Step::StretchTo(to) => {
                    self.stretch(&here, &to)?;
                    to
                }
                Step::WatchTo(to) if !self.same_legs(&here, &to) => {
                    let (after, to) = self.cross_reach(&here, to)?;
                    left.extend(to.map(Step::WatchTo));
                    after
                }
                Step::WatchTo(to) => {
                    self.divide(&here, to, &mut left)?;
                    here
                }
            };
        }
        Ok(here)
    }

    /// Finds the first time between two samples at which a leg crosses its boundary of reach. Returns the
    /// first sample after it, and the second of the two samples unless both are the same.
    fn cross_reach(
        &mut self,
        from: &Sample,
        mut to: Sample,
    ) -> Result<(Sample, Option<Sample>), TrajectoryError> {
        let [mut before, mut after] = [from.clone(), to.clone()];
        while after.time - before.time > RESOLUTION / self.solver.rate {
            let middle = self.between(&before, &after, 0.5)?;
            if middle.time <= before.time || middle.time >= after.time {
                break;
            }
            if self.same_legs(from, &middle) { before = middle } else { after = middle }
        }
        self.solver.slope(&mut before, SlopeSide::Before, &mut self.probe)?;
        self.solver.slope(&mut after, SlopeSide::After, &mut self.probe)?;
        if before.time > from.time {
            self.stretch(from, &before)?;
        }
        for number in 0..self.solver.gauges.len() {
            self.update_worst(number, &before);
            self.switch(number, &before, &after);
        }
        if after.time >= to.time {
            return Ok((to, None));
        }
        to.solution.clone_from(&after.solution);
        self.solver.solve(to.time, NearestTo::Last, &mut to)?;
        self.solver.rates(&mut to)?;
        let last = to.time >= self.solver.motion.end();
        let side = if last { SlopeSide::Before } else { SlopeSide::After };
        self.solver.slope(&mut to, side, &mut self.probe)?;
        Ok((after, Some(to)))
    }

    /// Divides the time between two samples that the same legs reach: where a leg leaves its reach and
    /// returns, and at a serial singularity that a leg touches. The remaining steps are added to `left`.
    fn divide(
        &mut self,
        from: &Sample,
        to: Sample,
        left: &mut Vec<Step>,
    ) -> Result<(), TrajectoryError> {
        let step = to.time - from.time;
        for number in 0..self.solver.gauges.len() {
            if !matches!(self.solver.gauges[number], Gauge::Reach { .. }) {
                continue;
            }
            let stretch = Stretch { number, from, to: &to };
            let reached = stretch.levels().is_some_and(|[a, b]| a > 0.0 && b > 0.0);
            if !reached || !stretch.dips(1.0) || step <= RESOLUTION / self.solver.rate {
                continue;
            }
            let lowest = self.extreme(&stretch, |level| level)?;
            if lowest.levels[number].is_some_and(|level| level < 0.0) {
                left.extend([Step::WatchTo(to), Step::Lowest(number), Step::WatchTo(lowest)]);
                return Ok(());
            }
            if self.is_zero(number, &lowest) {
                self.record_singularity(number, &lowest);
                // A joint coordinate may have a pole there. Its gauges are continuous on either side.
                let share = (lowest.time - from.time) / step;
                if share > MARGIN && share < 1.0 - MARGIN {
                    let mut before = self.between(from, &to, share - MARGIN)?;
                    let mut after = self.between(from, &to, share + MARGIN)?;
                    self.solver.slope(&mut before, SlopeSide::Before, &mut self.probe)?;
                    self.solver.slope(&mut after, SlopeSide::After, &mut self.probe)?;
                    left.extend([Step::WatchTo(to), Step::StretchTo(after), Step::WatchTo(before)]);
                    return Ok(());
                }
            }
        }
        left.push(Step::StretchTo(to));
        Ok(())
    }

    /// Finds limits and parallel singularities between two samples that the same legs reach.
    fn stretch(&mut self, from: &Sample, to: &Sample) -> Result<(), TrajectoryError> {
        for number in 0..self.solver.gauges.len() {
            let stretch = Stretch { number, from, to };
            let Some(levels) = stretch.levels() else {
                // At a singularity a joint has no rate.
                if let Gauge::Motion { .. } = self.solver.gauges[number] {
                    self.switch(number, from, to);
                }
                continue;
            };
            match self.solver.gauges[number] {
                Gauge::Reach { .. } => {
                    if levels.iter().all(|&level| level < 0.0) && stretch.dips(1.0) {
                        let worst = self.extreme(&stretch, |level| level)?;
                        self.update_worst(number, &worst);
                    }
                }
                Gauge::Limit { .. } | Gauge::Difference { .. } | Gauge::Motion { .. } => {
                    self.watch_limit(&stretch, levels)?;
                }
                Gauge::Parallel { .. } => self.watch_parallel(&stretch, levels)?,
            }
        }
        Ok(())
    }

    /// Finds where a joint, or its rate or acceleration, crosses a limit.
    fn watch_limit(
        &mut self,
        stretch: &Stretch<'_>,
        levels: [f64; 2],
    ) -> Result<(), TrajectoryError> {
        let out = levels.map(|level| level < 0.0);
        if out[0] != out[1] {
            return self.switch_once(stretch, out[0]);
        }
        // The joint may exceed the limit for a while or, if it is beyond the limit, be within it for a while.
        let sign = if out[0] { -1.0 } else { 1.0 };
        if stretch.dips(sign) {
            let turning = self.extreme(stretch, |level| sign * level)?;
            self.switch_twice(stretch, &turning)?;
        } else if out[0] && stretch.dips(1.0) {
            let worst = self.extreme(stretch, |level| level)?;
            self.update_worst(stretch.number, &worst);
        }
        Ok(())
    }

    /// Finds where the motion passes through a parallel singularity, or touches one.
    fn watch_parallel(
        &mut self,
        stretch: &Stretch<'_>,
        levels: [f64; 2],
    ) -> Result<(), TrajectoryError> {
        let Stretch { number, from, to } = *stretch;
        if levels[0] * levels[1] < 0.0 {
            let [_, after] = self.crossing(stretch, |level| level < 0.0)?;
            self.record_singularity(number, &after);
        } else if stretch.dips(levels[0].signum()) {
            let sign = levels[0].signum();
            let nearest = self.extreme(stretch, |level| sign * level)?;
            let past = |level: f64| level * sign < 0.0;
            if nearest.levels[number].is_some_and(past) {
                for (from, to) in [(from, &nearest), (&nearest, to)] {
                    let part = Stretch { number, from, to };
                    let [_, after] = self.crossing(&part, |level| level < 0.0)?;
                    self.record_singularity(number, &after);
                }
            } else if self.is_zero(number, &nearest) {
                self.record_singularity(number, &nearest);
            }
        } else if self.is_zero(number, to) && !self.is_zero(number, from) {
            // A gauge that still approaches zero reaches it in a later stretch, or where the motion ends.
            if !self.approaches_zero(number, to) {
                self.record_singularity(number, to);
            }
        }
        Ok(())
    }

    /// Records that a joint crosses a limit once between two samples: inwards if it is `out` at the first,
    /// else outwards. In between, the joint may be farther beyond the limit than at either sample.
    fn switch_once(&mut self, stretch: &Stretch<'_>, out: bool) -> Result<(), TrajectoryError> {
        let number = stretch.number;
        let deeper = stretch.dips(1.0);
        let worst = if deeper { Some(self.extreme(stretch, |level| level)?) } else { None };
        let [before, after] = self.crossing(stretch, |level| level < 0.0)?;
        // A slider with a pole comes from infinity and not from its limit.
        let edge = if out { &before } else { &after };
        if !out {
            self.switch(number, &before, &after);
        }
        self.update_worst(number, edge);
        if let Some(worst) = worst {
            self.update_worst(number, &worst);
        }
        if out {
            self.switch(number, &before, &after);
        }
        Ok(())
    }

    /// Records that a joint crosses a limit twice, before and after the turning point `at` between two
    /// samples, if it does.
    fn switch_twice(&mut self, stretch: &Stretch<'_>, at: &Sample) -> Result<(), TrajectoryError> {
        let number = stretch.number;
        let out = |sample: &Sample| sample.levels[number].map(|level| level < 0.0);
        if out(at) == out(stretch.from) || out(at).is_none() {
            return Ok(());
        }
        for (from, to) in [(stretch.from, at), (at, stretch.to)] {
            self.update_worst(number, at);
            let part = Stretch { number, from, to };
            let [before, after] = self.crossing(&part, |level| level < 0.0)?;
            self.switch(number, &before, &after);
        }
        Ok(())
    }

    /// Whether the same legs reach both samples.
    fn same_legs(&self, a: &Sample, b: &Sample) -> bool {
        let out = |sample: &Sample, leg| sample.solution.unreachable.iter().any(|u| u.leg == leg);
        a.reached && b.reached
            || (0..self.solver.manipulator.mechanism().legs.len())
                .all(|leg| out(a, leg) == out(b, leg))
    }
}
