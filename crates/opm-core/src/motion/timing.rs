//! The timing of a path: its parameter as a function of time.
//!
//! Between two knots the second derivative of the parameter `s` is constant, `u`. So `s` is quadratic in time, and the
//! square of its rate is linear in `s`: `ds/dt² = x + 2 u (s - s₀)`.

use super::{Instant, Path};

/// A path with another timing than its own.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPath {
    /// The path; its own time is the parameter.
    pub path: Box<Path>,
    /// The parameter as a function of time.
    pub timing: Timing,
}

/// The parameter of a path as a function of time, which never decreases.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The parameter at the knots, increasing.
    parameters: Vec<f64>,
    /// The rate of the parameter at the knots.
    rates: Vec<f64>,
    /// The times of the knots, seconds.
    times: Vec<f64>,
}

impl Timing {
    /// The timing that starts at the time `start`, with the squares of the rates of the parameter at its knots. `Err`
    /// has the number of the first knot after which the parameter would not move.
    pub(super) fn new(parameters: Vec<f64>, squares: &[f64], start: f64) -> Result<Self, usize> {
        let rates: Vec<f64> = squares.iter().map(|square| square.sqrt()).collect();
        let mut times = vec![start];
        let mut time = start;
        for i in 1..parameters.len() {
            // The mean rate between two knots is that of the two rates.
            time += 2.0 * (parameters[i] - parameters[i - 1]) / (rates[i - 1] + rates[i]);
            if !time.is_finite() {
                return Err(i - 1);
            }
            times.push(time);
        }
        Ok(Self { parameters, rates, times })
    }

    /// The parameter and its first and second derivative by time. Times beyond the ends give the values at the ends.
    pub fn at(&self, t: f64) -> [f64; 3] {
        let last = self.times.len() - 1;
        let t = t.clamp(self.times[0], self.times[last]);
        let i = self.times.partition_point(|&knot| knot <= t).clamp(1, last) - 1;
        let [from, to] = [self.rates[i], self.rates[i + 1]];
        let length = self.parameters[i + 1] - self.parameters[i];
        let second = (to - from) * (to + from) / (2.0 * length);
        let since = t - self.times[i];
        let parameter = self.parameters[i] + since * (from + 0.5 * second * since);
        [parameter.min(self.parameters[i + 1]), (from + second * since).max(0.0), second]
    }

    /// The time at the end, seconds.
    pub fn end(&self) -> f64 {
        self.times[self.times.len() - 1]
    }

    /// The times of the knots, seconds.
    pub fn times(&self) -> &[f64] {
        &self.times
    }
}

impl TimedPath {
    /// Writes the pose and its derivatives at time `t` into `out`, by the chain rule.
    pub(super) fn at(&self, t: f64, out: &mut Instant) {
        let [parameter, rate, second] = self.timing.at(t);
        self.path.at(parameter, out);
        for (velocity, acceleration) in out.velocity.iter_mut().zip(&mut out.acceleration) {
            *acceleration = *acceleration * (rate * rate) + *velocity * second;
            *velocity *= rate;
        }
    }
}
