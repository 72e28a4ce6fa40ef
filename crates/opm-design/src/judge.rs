//! From measures to what an optimiser compares.
//!
//! A design that keeps the constraints is better than one that does not, and this better than one that does not assemble (K.
//! Deb, "An efficient constraint handling method for genetic algorithms", *Computer Methods in Applied Mechanics and
//! Engineering* 186, 2000).

use crate::evaluate::Value;
use crate::measure::Measure;
use crate::problem::Problem;

/// Weight of a guide beside the value that it leads to.
const GUIDE: f64 = 0.01;

/// What a design costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Judged {
    /// Of each objective; the smaller, the better. Infinity where the value is.
    pub costs: Vec<f64>,
    /// How far constraints are broken together; zero if all are kept.
    pub violation: f64,
}

/// The cost of a design that does not assemble, to compare designs of one objective by.
pub const UNASSEMBLED: f64 = 4.0;

impl Judged {
    /// Judges the values of a problem's measures.
    pub fn new(problem: &Problem, measures: &[Measure], values: &[Value], radius: f64) -> Self {
        let value = |measure: &Measure| {
            let number = measures.iter().position(|known| known == measure);
            values[number.expect("a measure of the problem")]
        };
        let costs = problem.objectives.iter().map(|measure| {
            let Value { value, guide } = value(measure);
            // A radius counts as a share of the largest one, so that its guide is as weak as that of a share.
            let scale = if matches!(measure, Measure::Inscribed(_)) { radius } else { 1.0 };
            let sign = if measure.large_is_good() { -1.0 } else { 1.0 };
            sign * value / scale - GUIDE * guide
        });
        let broken = problem.constraints.iter().map(|constraint| {
            let Value { value, guide } = value(&constraint.measure);
            let short = |bound: f64, off: f64| {
                let off = if off.is_finite() { off / bound.abs().max(1e-3) } else { 1e6 };
                if off > 0.0 { off + GUIDE * (1.0 - guide) } else { 0.0 }
            };
            let least = constraint.least.map_or(0.0, |least| short(least, least - value));
            least + constraint.most.map_or(0.0, |most| short(most, value - most))
        });
        Self { costs: costs.collect(), violation: broken.sum() }
    }

    /// One number for a design with one objective: from -1 to 1 if it keeps the constraints, from 2 to 3 if not.
    pub fn score(&self) -> f64 {
        let squashed = |x: f64| if x.is_finite() { x / (1.0 + x.abs()) } else { x.signum() };
        match self.violation > 0.0 {
            true => 2.0 + squashed(self.violation),
            false => squashed(self.costs[0]),
        }
    }
}
