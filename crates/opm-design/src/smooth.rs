//! Which problems are smooth in their variables, and designs as the polishing sees them.

use crate::evaluate::Value;
use crate::measure::Measure;
use crate::polish::Sample;
use crate::problem::Problem;

impl Measure {
    /// Whether it changes smoothly with the dimensions, but for kinks where another pose becomes the worst. Shares of a grid jump.
    pub fn is_smooth(&self) -> bool {
        match self {
            Self::Worst(_) | Self::Range(_) | Self::Size => true,
            Self::Grid | Self::Reachable | Self::Dexterous | Self::Inscribed(_) => false,
        }
    }

    /// Whether a value is one that it changes smoothly from: the worst over all poses needs all of them in reach.
    fn is_level(&self, Value { value, guide }: Value) -> bool {
        value.is_finite() && (!matches!(self, Self::Worst(_)) || guide >= 1.0)
    }
}

impl Problem {
    /// Whether the best design is polished: with one objective that is smooth.
    pub fn is_polished(&self) -> bool {
        matches!(&*self.objectives, [objective] if objective.is_smooth())
    }

    /// The most designs that are evaluated: a design may be polished with as many again.
    pub fn most_evaluations(&self) -> u64 {
        self.budget.saturating_mul(if self.is_polished() { 2 } else { 1 })
    }
}

/// A design of a problem that is polished; `None` for one that breaks a constraint which is not smooth, or is out of reach.
pub fn sample(
    problem: &Problem,
    measures: &[Measure],
    values: &[Value],
    scale: f64,
) -> Option<Sample> {
    let value = |measure: &Measure| {
        let number = measures.iter().position(|known| known == measure)?;
        values.get(number).copied()
    };
    let level = |measure: &Measure| value(measure).filter(|value| measure.is_level(*value));
    let objective = problem.objectives.first()?;
    let sign = if objective.large_is_good() { -1.0 } else { 1.0 };
    let cost = sign * level(objective)?.value / scale;
    let mut broken = Vec::new();
    for constraint in &problem.constraints {
        let smooth = constraint.measure.is_smooth();
        let value = if smooth { level(&constraint.measure)? } else { value(&constraint.measure)? };
        let relative = |bound: f64, off: f64| off / bound.abs().max(1e-3);
        let ends = [
            constraint.least.map(|least| relative(least, least - value.value)),
            constraint.most.map(|most| relative(most, value.value - most)),
        ];
        for off in ends.into_iter().flatten() {
            match smooth {
                true => broken.push(off),
                false if off > 0.0 => return None,
                false => {}
            }
        }
    }
    Some(Sample { cost, broken })
}
