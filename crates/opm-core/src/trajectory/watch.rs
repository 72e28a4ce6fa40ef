//! Between two samples: where gauges cross zero.

use super::{Gauge, Look, Part, RESOLUTION, Sample, Trajectory, TrajectoryError, Turns, Violation};
use crate::velocity::SINGULAR;

/// Steps of a golden-section search: the interval shrinks to 1e-8 of itself, where the lowest value
/// of a smooth function is known to rounding.
const SEARCH: usize = 39;
/// A stretch is parted this share of it before and after a singularity: a hundred times what is known
/// of when that is.
const ASIDE: f64 = 1e-6;
/// The golden section.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// A violation begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// It begins: its end and its worst are not known yet. A singularity has no end of its own.
    Begins(Violation),
    /// It has ended.
    Ends(Violation),
}

impl Change {
    /// When, seconds.
    pub fn time(&self) -> f64 {
        match self {
            Self::Begins(violation) => violation.start,
            Self::Ends(violation) => violation.end,
        }
    }
}

/// A gauge over a stretch of time in which nothing else changes.
struct Stretch<'s> {
    number: usize,
    from: &'s Sample,
    to: &'s Sample,
}

impl Stretch<'_> {
    fn levels(&self) -> Option<[f64; 2]> {
        Some([self.from.levels[self.number]?, self.to.levels[self.number]?])
    }

    /// It goes down at the one end and up at the other, or (`-1`) the other way round.
    fn turns(&self, sign: f64) -> bool {
        let slope = |sample: &Sample| sample.slopes[self.number].map(|slope| sign * slope);
        matches!((slope(self.from), slope(self.to)), (Some(a), Some(b)) if a < 0.0 && b > 0.0)
    }
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

    /// At the last sample: what came so near to zero that it counts, and would go on.
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

    /// From one sample to the next, which is given back: a leg that comes back into reach in between
    /// goes on from where it came back, not from where it was lost.
    pub(super) fn watch(
        &mut self,
        from: &Sample,
        mut to: Sample,
    ) -> Result<Sample, TrajectoryError> {
        let step = to.time - from.time;
        // Where a leg comes to the end of its reach, all else changes: first up to there.
        if !self.same_legs(from, &to) {
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
                return Ok(to);
            }
            to.solution.copy_from(&after.solution);
            self.solver.solve(to.time, Turns::Held, &mut to)?;
            self.solver.rates(&mut to)?;
            let last = to.time >= self.solver.motion.end();
            let look = if last { Look::Back } else { Look::Ahead };
            self.solver.slope(&mut to, look, &mut self.probe)?;
            return self.watch(&after, to);
        }
        // A leg may have gone out of reach and come back.
        for number in 0..self.solver.gauges.len() {
            if !matches!(self.solver.gauges[number], Gauge::Reach { .. }) {
                continue;
            }
            let stretch = Stretch { number, from, to: &to };
            let reached = stretch.levels().is_some_and(|[a, b]| a > 0.0 && b > 0.0);
            if reached && stretch.turns(1.0) && step > RESOLUTION / self.solver.rate {
                let lowest = self.extreme(&stretch, |level| level)?;
                if lowest.levels[number].is_some_and(|level| level < 0.0) {
                    let lowest = self.watch(from, lowest)?;
                    self.worse(number, &lowest);
                    return self.watch(&lowest, to);
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
                        let before = self.watch(from, before)?;
                        self.stretch(&before, &after)?;
                        return self.watch(&after, to);
                    }
                }
            }
        }
        self.stretch(from, &to)?;
        Ok(to)
    }

    /// Limits and parallel singularities where the legs that reach are the same all along.
    fn stretch(&mut self, from: &Sample, to: &Sample) -> Result<(), TrajectoryError> {
        for number in 0..self.solver.gauges.len() {
            let stretch = Stretch { number, from, to };
            let Some(levels) = stretch.levels() else { continue };
            match self.solver.gauges[number] {
                Gauge::Reach { .. } => {
                    if levels.iter().all(|&level| level < 0.0) && stretch.turns(1.0) {
                        let worst = self.extreme(&stretch, |level| level)?;
                        self.worse(number, &worst);
                    }
                }
                Gauge::Limit { .. } => {
                    let out = levels.map(|level| level < 0.0);
                    if out[0] != out[1] {
                        self.switch_once(&stretch, out[0])?;
                        continue;
                    }
                    // Past the limit and back, or, from past it, within it for a while.
                    let sign = if out[0] { -1.0 } else { 1.0 };
                    if stretch.turns(sign) {
                        let turning = self.extreme(&stretch, |level| sign * level)?;
                        self.switch_twice(&stretch, &turning)?;
                    } else if out[0] && stretch.turns(1.0) {
                        let worst = self.extreme(&stretch, |level| level)?;
                        self.worse(number, &worst);
                    }
                }
                Gauge::Parallel { .. } => {
                    if levels[0] * levels[1] < 0.0 {
                        let [_, after] = self.crossing(&stretch, |level| level < 0.0)?;
                        self.touches(number, &after);
                    } else if stretch.turns(levels[0].signum()) {
                        let sign = levels[0].signum();
                        let nearest = self.extreme(&stretch, |level| sign * level)?;
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
                        // On its way to zero it is there in a later stretch, or where the motion ends.
                        if !self.nears(number, to) {
                            self.touches(number, to);
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// A limit is passed between two samples, outwards or, from `out`, inwards; on the way the joint may
    /// be farther out than at either.
    fn switch_once(&mut self, stretch: &Stretch<'_>, out: bool) -> Result<(), TrajectoryError> {
        let number = stretch.number;
        let deeper = stretch.turns(1.0);
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

    /// A limit is passed at a turning point between two samples, if it is.
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

    /// The last sample on the one side and the first on the other.
    fn crossing(
        &mut self,
        stretch: &Stretch<'_>,
        side: impl Fn(f64) -> bool,
    ) -> Result<[Sample; 2], TrajectoryError> {
        let number = stretch.number;
        let [mut before, mut after] = [stretch.from.clone(), stretch.to.clone()];
        let first = before.levels[number].map(&side);
        while after.time - before.time > RESOLUTION / self.solver.rate {
            let middle = self.between(&before, &after, 0.5)?;
            if middle.time <= before.time || middle.time >= after.time {
                break;
            }
            let here = middle.levels[number].map(&side);
            // As near as can be to a pole, in the few roundings' width where there is no answer.
            if here.is_none() {
                break;
            }
            if here == first { before = middle } else { after = middle }
        }
        Ok([before, after])
    }

    /// Where `value` of a gauge's level is lowest.
    fn extreme(
        &mut self,
        stretch: &Stretch<'_>,
        value: impl Fn(f64) -> f64,
    ) -> Result<Sample, TrajectoryError> {
        let Stretch { number, from, to } = *stretch;
        let height = |sample: &Sample| sample.levels[number].map_or(f64::INFINITY, &value);
        let [mut low, mut high] = [0.0, 1.0];
        let mut left = self.between(from, to, 1.0 - GOLDEN)?;
        let mut right = self.between(from, to, GOLDEN)?;
        for _ in 0..SEARCH {
            if height(&left) < height(&right) {
                high = low + GOLDEN * (high - low);
                right = left;
                left = self.between(from, to, high - GOLDEN * (high - low))?;
            } else {
                low = high - GOLDEN * (high - low);
                left = right;
                right = self.between(from, to, low + GOLDEN * (high - low))?;
            }
        }
        Ok(if height(&left) < height(&right) { left } else { right })
    }

    /// The joints and the gauges, not the rates, at a share of the way from one sample to another.
    fn between(
        &mut self,
        from: &Sample,
        to: &Sample,
        share: f64,
    ) -> Result<Sample, TrajectoryError> {
        let mut sample = from.clone();
        let time = from.time + share * (to.time - from.time);
        self.solver.solve(time, Turns::Held, &mut sample)?;
        sample.slopes.fill(None);
        Ok(sample)
    }

    fn same_legs(&self, a: &Sample, b: &Sample) -> bool {
        let out = |sample: &Sample, leg| sample.solution.unreachable.iter().any(|u| u.leg == leg);
        a.reached && b.reached
            || (0..self.solver.manipulator.mechanism().legs.len())
                .all(|leg| out(a, leg) == out(b, leg))
    }

    /// Whether a stretch of violation is under way.
    fn violated(&self, number: usize, sample: &Sample) -> bool {
        match self.solver.gauges[number] {
            Gauge::Reach { .. } | Gauge::Limit { .. } => {
                sample.levels[number].is_some_and(|level| level < 0.0)
            }
            Gauge::Parallel { .. } => false,
        }
    }

    /// Whether a singularity measure is zero as far as it can be known.
    fn is_zero(&self, number: usize, sample: &Sample) -> bool {
        match self.solver.gauges[number] {
            Gauge::Limit { .. } => false,
            Gauge::Reach { .. } | Gauge::Parallel { .. } => {
                sample.levels[number].is_some_and(|level| level.abs() < SINGULAR)
            }
        }
    }

    /// Opens or closes a violation where a gauge has passed zero between two samples.
    fn switch(&mut self, number: usize, before: &Sample, after: &Sample) {
        match (self.open[number].is_some(), self.violated(number, after)) {
            (false, true) => self.begins(number, after.time, after),
            (true, false) => self.ends(number, before.time),
            _ => {}
        }
    }

    fn begins(&mut self, number: usize, time: f64, sample: &Sample) {
        let mut violation = self.violation(number, sample);
        (violation.start, violation.end, violation.worst) = (time, time, time);
        self.open[number] = Some(violation);
        self.changes.push(Change::Begins(violation));
    }

    fn ends(&mut self, number: usize, time: f64) {
        if let Some(mut violation) = self.open[number].take() {
            violation.end = time.max(violation.start);
            self.changes.push(Change::Ends(violation));
        }
    }

    /// A singularity: it has no length.
    fn touches(&mut self, number: usize, sample: &Sample) {
        let violation = self.violation(number, sample);
        self.changes.push(Change::Begins(violation));
        self.changes.push(Change::Ends(violation));
    }

    /// Open violations get to know the last sample.
    pub(super) fn worsen(&mut self) {
        if self.open.iter().all(Option::is_none) {
            return;
        }
        let sample = self.current.clone();
        for number in 0..self.solver.gauges.len() {
            if let Some(violation) = &mut self.open[number] {
                violation.end = sample.time;
                self.worse(number, &sample);
            }
        }
    }

    /// An open violation gets to know a sample in it.
    fn worse(&mut self, number: usize, sample: &Sample) {
        let now = self.violation(number, sample);
        if let Some(open) = &mut self.open[number]
            && now.amount > open.amount
            && sample.levels[number].is_some_and(|level| level < 0.0)
        {
            let Violation { amount, quantity, section, worst, .. } = now;
            *open = Violation { amount, quantity, section, worst, ..*open };
        }
    }

    /// What a gauge says at one sample.
    fn violation(&self, number: usize, sample: &Sample) -> Violation {
        let time = sample.time;
        let gauge = self.solver.gauges[number];
        let level = sample.levels[number].unwrap_or_default().abs();
        let (amount, quantity, section) = match gauge {
            Gauge::Reach { leg } => {
                match sample.solution.unreachable.iter().find(|u| u.leg == leg) {
                    Some(u) => (u.gap.excess, Some(u.gap.quantity), Some(u.section)),
                    None => {
                        let section = self.solver.manipulator.serial(&sample.solution, leg).1;
                        (level, None, Some(section))
                    }
                }
            }
            Gauge::Limit { coordinate, .. } => {
                (level, Some(self.solver.manipulator.coordinates()[coordinate].quantity), None)
            }
            Gauge::Parallel { part: Part::Section(section) } => (level, None, Some(section)),
            Gauge::Parallel { part: Part::Whole } => (level, None, None),
        };
        Violation { gauge, start: time, end: time, worst: time, amount, quantity, section }
    }
}
