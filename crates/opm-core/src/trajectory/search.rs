//! The times between two samples at which a gauge crosses zero or is lowest.

use super::{NearestTo, RESOLUTION, Sample, Trajectory, TrajectoryError};

/// The number of steps of a golden-section search. They shrink the interval to 1e-8 of its length, where the
/// lowest value of a smooth function is known to rounding.
const STEPS: usize = 39;
/// The golden section, `(√5 − 1) / 2`.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// A gauge between two samples that the same legs reach.
pub(super) struct Stretch<'s> {
    /// The number of the gauge.
    pub number: usize,
    /// The sample at the start.
    pub from: &'s Sample,
    /// The sample at the end.
    pub to: &'s Sample,
}

impl Stretch<'_> {
    /// The gauge's levels at both ends, if it has them.
    pub fn levels(&self) -> Option<[f64; 2]> {
        Some([self.from.levels[self.number]?, self.to.levels[self.number]?])
    }

    /// Whether `sign` times the gauge falls at the start and rises at the end.
    pub fn dips(&self, sign: f64) -> bool {
        let slope = |sample: &Sample| sample.slopes[self.number].map(|slope| sign * slope);
        matches!((slope(self.from), slope(self.to)), (Some(a), Some(b)) if a < 0.0 && b > 0.0)
    }
}

impl Trajectory<'_> {
    /// The last sample before a crossing and the first after it, by bisection. `side` maps a level of the
    /// gauge to the side of the crossing that it is on.
    pub(super) fn crossing(
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
            // The gauge has no level here: within rounding of a pole.
            if here.is_none() {
                break;
            }
            if here == first { before = middle } else { after = middle }
        }
        Ok([before, after])
    }

    /// The sample at which `value` of a gauge's level is lowest, by golden-section search.
    pub(super) fn extreme(
        &mut self,
        stretch: &Stretch<'_>,
        value: impl Fn(f64) -> f64,
    ) -> Result<Sample, TrajectoryError> {
        let Stretch { number, from, to } = *stretch;
        let height = |sample: &Sample| sample.levels[number].map_or(f64::INFINITY, &value);
        let [mut low, mut high] = [0.0, 1.0];
        let mut left = self.between(from, to, 1.0 - GOLDEN)?;
        let mut right = self.between(from, to, GOLDEN)?;
        for _ in 0..STEPS {
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

    /// The joints and the gauges, without the rates, at a share of the time from one sample to another.
    pub(super) fn between(
        &mut self,
        from: &Sample,
        to: &Sample,
        share: f64,
    ) -> Result<Sample, TrajectoryError> {
        let mut sample = from.clone();
        let time = from.time + share * (to.time - from.time);
        self.solver.solve(time, NearestTo::Last, &mut sample)?;
        sample.slopes.fill(None);
        Ok(sample)
    }
}
