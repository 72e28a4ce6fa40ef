//! Between two samples: where gauges cross zero.

use super::search::Stretch;
use super::{Gauge, Look, RESOLUTION, Sample, Trajectory, TrajectoryError, Turns};

/// Around a singularity, this share of the step before and after it is left out: a hundred times the
/// error of the time that was found.
const ASIDE: f64 = 1e-6;

/// What is left to do between two samples, in the order of time.
enum Step {
    /// Everything from where the search has come to this sample.
    WatchTo(Sample),
    /// The gauge of this number is lowest where the search has come.
    Lowest(usize),
    /// The legs are the same up to this sample: only limits and parallel singularities are left.
    StretchTo(Sample),
}

impl Trajectory<'_> {
    /// At the first sample: what is violated there has begun.
    pub(super) fn begin(&mut self) {
        let sample = self.current.clone();
        for number in 0..self.solver.gauges.len() {
            if self.violated(number, &sample) {
                self.begins(number, sample.time, &sample);
            } else if self.is_zero(number, &sample) {
                self.touches(number, &sample);
            }
        }
    }

    /// At the last sample: a parallel singularity that the motion was about to pass through.
    pub(super) fn end(&mut self) {
        let sample = self.current.clone();
        for number in 0..self.solver.gauges.len() {
            let parallel = matches!(self.solver.gauges[number], Gauge::Parallel { .. });
            if parallel && self.is_zero(number, &sample) && self.nears(number, &sample) {
                self.touches(number, &sample);
            }
        }
    }

    /// Whether a gauge goes towards zero.
    fn nears(&self, number: usize, sample: &Sample) -> bool {
        matches!((sample.levels[number], sample.slopes[number]), (Some(a), Some(b)) if a * b < 0.0)
    }

    /// Whether anything may have happened between the last two samples. Mostly nothing has.
    pub(super) fn eventful(&self) -> bool {
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

    /// Finds what happens from one sample to the next. The last sample is given back: a leg that comes
    /// back into reach in between goes on from where it came back, not from where it was lost.
    pub(super) fn watch(&mut self, from: Sample, to: Sample) -> Result<Sample, TrajectoryError> {
        // Where the search has come, and what is left to do, the next step last.
        let mut here = from;
        let mut left = vec![Step::WatchTo(to)];
        while let Some(step) = left.pop() {
            here = match step {
                Step::Lowest(number) => {
                    self.worse(number, &here);
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

    /// Goes over the first time between two samples at which a leg comes to the end of its reach. Returns
    /// the first sample after it, and the second of the two samples, unless that is the same one.
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
        self.solver.slope(&mut before, Look::Back, &mut self.probe)?;
        self.solver.slope(&mut after, Look::Ahead, &mut self.probe)?;
        if before.time > from.time {
            self.stretch(from, &before)?;
        }
        for number in 0..self.solver.gauges.len() {
            self.worse(number, &before);
            self.switch(number, &before, &after);
        }
        if after.time >= to.time {
            return Ok((to, None));
        }
        to.solution.clone_from(&after.solution);
        self.solver.solve(to.time, Turns::Held, &mut to)?;
        self.solver.rates(&mut to)?;
        let last = to.time >= self.solver.motion.end();
        let look = if last { Look::Back } else { Look::Ahead };
        self.solver.slope(&mut to, look, &mut self.probe)?;
        Ok((after, Some(to)))
    }

    /// Divides the time between two samples that the same legs reach: where a leg goes out of reach and
    /// comes back, and at a serial singularity that a leg touches. What is left to do is added to `left`.
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
                self.touches(number, &lowest);
                // A joint may go through infinity there: its gauges are continuous on either side.
                let share = (lowest.time - from.time) / step;
                if share > ASIDE && share < 1.0 - ASIDE {
                    let mut before = self.between(from, &to, share - ASIDE)?;
                    let mut after = self.between(from, &to, share + ASIDE)?;
                    self.solver.slope(&mut before, Look::Back, &mut self.probe)?;
                    self.solver.slope(&mut after, Look::Ahead, &mut self.probe)?;
                    left.extend([Step::WatchTo(to), Step::StretchTo(after), Step::WatchTo(before)]);
                    return Ok(());
                }
            }
        }
        left.push(Step::StretchTo(to));
        Ok(())
    }

    /// Limits and parallel singularities, where the same legs reach from one sample to the other.
    fn stretch(&mut self, from: &Sample, to: &Sample) -> Result<(), TrajectoryError> {
        for number in 0..self.solver.gauges.len() {
            let stretch = Stretch { number, from, to };
            let Some(levels) = stretch.levels() else { continue };
            match self.solver.gauges[number] {
                Gauge::Reach { .. } => {
                    if levels.iter().all(|&level| level < 0.0) && stretch.dips(1.0) {
                        let worst = self.extreme(&stretch, |level| level)?;
                        self.worse(number, &worst);
                    }
                }
                Gauge::Limit { .. } => self.watch_limit(&stretch, levels)?,
                Gauge::Parallel { .. } => self.watch_parallel(&stretch, levels)?,
            }
        }
        Ok(())
    }

    /// Finds where a joint passes its limit.
    fn watch_limit(
        &mut self,
        stretch: &Stretch<'_>,
        levels: [f64; 2],
    ) -> Result<(), TrajectoryError> {
        let out = levels.map(|level| level < 0.0);
        if out[0] != out[1] {
            return self.switch_once(stretch, out[0]);
        }
        // Past the limit and back, or, from past it, within it for a while.
        let sign = if out[0] { -1.0 } else { 1.0 };
        if stretch.dips(sign) {
            let turning = self.extreme(stretch, |level| sign * level)?;
            self.switch_twice(stretch, &turning)?;
        } else if out[0] && stretch.dips(1.0) {
            let worst = self.extreme(stretch, |level| level)?;
            self.worse(stretch.number, &worst);
        }
        Ok(())
    }

    /// Finds where a parallel singularity is passed through, or touched.
    fn watch_parallel(
        &mut self,
        stretch: &Stretch<'_>,
        levels: [f64; 2],
    ) -> Result<(), TrajectoryError> {
        let Stretch { number, from, to } = *stretch;
        if levels[0] * levels[1] < 0.0 {
            let [_, after] = self.crossing(stretch, |level| level < 0.0)?;
            self.touches(number, &after);
        } else if stretch.dips(levels[0].signum()) {
            let sign = levels[0].signum();
            let nearest = self.extreme(stretch, |level| sign * level)?;
            let past = |level: f64| level * sign < 0.0;
            if nearest.levels[number].is_some_and(past) {
                for (from, to) in [(from, &nearest), (&nearest, to)] {
                    let part = Stretch { number, from, to };
                    let [_, after] = self.crossing(&part, |level| level < 0.0)?;
                    self.touches(number, &after);
                }
            } else if self.is_zero(number, &nearest) {
                self.touches(number, &nearest);
            }
        } else if self.is_zero(number, to) && !self.is_zero(number, from) {
            // A gauge on its way to zero is there in a later stretch, or where the motion ends.
            if !self.nears(number, to) {
                self.touches(number, to);
            }
        }
        Ok(())
    }

    /// A limit is passed between two samples, outwards or, from `out`, inwards; on the way the joint may
    /// be farther out than at either.
    fn switch_once(&mut self, stretch: &Stretch<'_>, out: bool) -> Result<(), TrajectoryError> {
        let number = stretch.number;
        let deeper = stretch.dips(1.0);
        let worst = if deeper { Some(self.extreme(stretch, |level| level)?) } else { None };
        let [before, after] = self.crossing(stretch, |level| level < 0.0)?;
        // Where a slider would have to be infinitely long, it comes from there and not from its limit.
        let edge = if out { &before } else { &after };
        if !out {
            self.switch(number, &before, &after);
        }
        self.worse(number, edge);
        if let Some(worst) = worst {
            self.worse(number, &worst);
        }
        if out {
            self.switch(number, &before, &after);
        }
        Ok(())
    }

    /// A limit may be passed twice, before and after the turning point `at` between two samples.
    fn switch_twice(&mut self, stretch: &Stretch<'_>, at: &Sample) -> Result<(), TrajectoryError> {
        let number = stretch.number;
        let out = |sample: &Sample| sample.levels[number].map(|level| level < 0.0);
        if out(at) == out(stretch.from) || out(at).is_none() {
            return Ok(());
        }
        for (from, to) in [(stretch.from, at), (at, stretch.to)] {
            self.worse(number, at);
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
