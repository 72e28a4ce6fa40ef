//! Polishing of the best design of one objective that is smooth in its variables: a projected quasi-Newton method.
//!
//! The update is that of Broyden, Fletcher, Goldfarb and Shanno, on the variables that are free to move between their bounds
//! (D. Bertsekas, "Projected Newton methods for optimization problems with simple constraints", *SIAM Journal on Control and
//! Optimization* 20, 1982). Smooth constraints are part of an augmented Lagrangian (J. Nocedal, S. Wright, *Numerical
//! Optimization*, 2006, sections 17.3 and 17.4). Rates are central differences of designs, which are evaluated together, as
//! those of `opm_accuracy::Dimensions` are. What is not smooth, as a share of a grid, is a wall: designs behind it are not taken.

use opm_core::nalgebra::{DMatrix, DVector};

/// Half the distance of the designs whose difference is a rate, as a share of the way between bounds: the third root of what
/// is rounding.
const APART: f64 = 1e-5;

/// The lengths of a step that are tried, as shares of the whole one: the shorter ones together, where the longer ones fail.
const LENGTHS: [&[f64]; 2] = [&[1.0, 0.25], &[0.0625, 0.015, 1e-3]];

/// How much of the decrease that the slope promises a step has to bring.
const DECREASE: f64 = 1e-4;

/// The largest projected slope at which a design counts as least, as a share of the cost: what differences still tell.
const LEVEL: f64 = 1e-9;

/// How far from its bound a constraint is kept, relative to it, so that what is found keeps it in spite of rounding.
const INSIDE: f64 = 1e-9;

/// The first weight of broken constraints, and by how much it grows where they stay broken.
const WEIGHT: [f64; 2] = [100.0, 10.0];

/// How often the multipliers of constraints are improved.
const ROUNDS: usize = 12;

/// A design as the method sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// What is to become small.
    pub cost: f64,
    /// By how much each smooth constraint is broken, relative to its bound; not above zero where it is kept.
    pub broken: Vec<f64>,
}

/// Evaluates designs, given as shares of the way between the bounds; `None` for one behind a wall.
pub type Evaluate<'a, E> = dyn FnMut(&[Vec<f64>]) -> Result<Vec<Option<Sample>>, E> + 'a;

/// Goes on from a design to a better one, with at most so many evaluations. What is evaluated is for the caller to keep: the best
/// of it is never worse than the start.
pub fn polish<E>(start: &[f64], budget: u64, evaluate: &mut Evaluate<'_, E>) -> Result<(), E> {
    let mut search = Search {
        left: budget,
        evaluate,
        multipliers: Vec::new(),
        weight: WEIGHT[0],
        inverse: None,
    };
    let mut at = DVector::from_column_slice(start);
    let first = search.all(std::slice::from_ref(&at))?.pop().flatten();
    let Some(mut sample) = first else { return Ok(()) };
    search.multipliers = vec![0.0; sample.broken.len()];
    let rounds = if sample.broken.is_empty() { 1 } else { ROUNDS };
    let mut worst = f64::INFINITY;
    for _ in 0..rounds {
        (at, sample) = search.descend(at, sample)?;
        let off = |(broken, multiplier): (&f64, &f64)| {
            (broken + INSIDE).max(-multiplier / search.weight).abs()
        };
        let now = sample.broken.iter().zip(&search.multipliers).map(off).fold(0.0, f64::max);
        for (multiplier, broken) in search.multipliers.iter_mut().zip(&sample.broken) {
            *multiplier = (*multiplier + search.weight * (broken + INSIDE)).max(0.0);
        }
        if now < INSIDE || search.left == 0 {
            break;
        }
        if now > 0.25 * worst {
            search.weight *= WEIGHT[1];
        }
        worst = now;
    }
    Ok(())
}

/// A search with the evaluations that it has left.
struct Search<'a, 'e, E> {
    left: u64,
    evaluate: &'a mut Evaluate<'e, E>,
    multipliers: Vec<f64>,
    weight: f64,
    /// The inverse of the curvature, as far as steps have told it.
    inverse: Option<DMatrix<f64>>,
}

impl<E> Search<'_, '_, E> {
    /// Samples of designs, if the budget has them.
    fn all(&mut self, designs: &[DVector<f64>]) -> Result<Vec<Option<Sample>>, E> {
        let count = designs.len() as u64;
        if count > self.left {
            self.left = 0;
            return Ok(vec![None; designs.len()]);
        }
        self.left -= count;
        let designs: Vec<Vec<f64>> = designs.iter().map(|x| x.as_slice().to_vec()).collect();
        (self.evaluate)(&designs)
    }

    /// The augmented Lagrangian.
    fn value(&self, sample: &Sample) -> f64 {
        let weight = self.weight;
        let of = |(broken, multiplier): (&f64, &f64)| {
            let shifted = (broken + INSIDE + multiplier / weight).max(0.0);
            0.5 * weight * (shifted * shifted - (multiplier / weight).powi(2))
        };
        sample.cost + sample.broken.iter().zip(&self.multipliers).map(of).sum::<f64>()
    }

    /// Descends as far as the slope goes down, and gives where it ends.
    fn descend(
        &mut self,
        mut at: DVector<f64>,
        mut here: Sample,
    ) -> Result<(DVector<f64>, Sample), E> {
        let count = at.len();
        let Some(mut slope) = self.slope(&at, &here)? else { return Ok((at, here)) };
        loop {
            let value = self.value(&here);
            // A variable at its bound whose slope leads out stays there.
            let free = DVector::from_fn(count, |i, _| match (at[i], slope[i]) {
                (x, g) if x <= 0.0 && g >= 0.0 => 0.0,
                (x, g) if x >= 1.0 && g <= 0.0 => 0.0,
                _ => 1.0,
            });
            let level = slope.component_mul(&free);
            if level.amax() <= LEVEL * (1.0 + value.abs()) {
                break;
            }
            let known = self.inverse.as_ref();
            let ahead = known.map(|inverse| -(inverse * &level).component_mul(&free));
            let way = match ahead.filter(|way| way.dot(&level) < 0.0) {
                Some(way) => way,
                // The first step has no curvature to go by.
                None => -&level * (0.1 / level.amax()).min(1.0),
            };
            let Some((end, sample)) = self.step(&at, &way, &level, value)? else {
                // The curvature may be that of another place.
                if self.inverse.take().is_none() || self.left == 0 {
                    break;
                }
                continue;
            };
            let Some(next) = self.slope(&end, &sample)? else {
                (at, here) = (end, sample);
                break;
            };
            self.bend(&(&end - &at), &(&next - &slope));
            (at, here, slope) = (end, sample, next);
        }
        Ok((at, here))
    }

    /// The best of the designs at some lengths of a step, if one goes down far enough.
    fn step(
        &mut self,
        at: &DVector<f64>,
        way: &DVector<f64>,
        level: &DVector<f64>,
        value: f64,
    ) -> Result<Option<(DVector<f64>, Sample)>, E> {
        for lengths in LENGTHS {
            let end = |length: &f64| (at + way * *length).map(|x| x.clamp(0.0, 1.0));
            let ends: Vec<DVector<f64>> = lengths.iter().map(end).collect();
            let found = self.all(&ends)?;
            let better = ends.into_iter().zip(found).filter_map(|(end, sample)| {
                let sample = sample?;
                let reached = self.value(&sample);
                let enough = reached <= value + DECREASE * level.dot(&(&end - at));
                (enough && reached < value).then_some((reached, end, sample))
            });
            let best = better.reduce(|one, other| if other.0 < one.0 { other } else { one });
            if let Some((_, end, sample)) = best {
                return Ok(Some((end, sample)));
            }
        }
        Ok(None)
    }

    /// Takes what a step tells of the curvature, where that is positive.
    fn bend(&mut self, step: &DVector<f64>, change: &DVector<f64>) {
        let along = step.dot(change);
        if along <= 1e-14 * step.norm() * change.norm() {
            return;
        }
        let first = || DMatrix::identity(step.len(), step.len()) * (along / change.norm_squared());
        let inverse = self.inverse.get_or_insert_with(first);
        let turned = &*inverse * change;
        let scale = (1.0 + change.dot(&turned) / along) / along;
        *inverse += step * step.transpose() * scale
            - (&turned * step.transpose() + step * turned.transpose()) / along;
    }

    /// The slope of the augmented Lagrangian: `None` if designs on both sides of this one are behind a wall.
    fn slope(&mut self, at: &DVector<f64>, here: &Sample) -> Result<Option<DVector<f64>>, E> {
        let beside = |i: usize, apart: f64| {
            let mut x = at.clone();
            x[i] = (x[i] + apart).clamp(0.0, 1.0);
            x
        };
        let sides = (0..at.len()).flat_map(|i| [beside(i, -APART), beside(i, APART)]);
        let designs: Vec<DVector<f64>> = sides.collect();
        let values: Vec<Option<f64>> =
            self.all(&designs)?.iter().map(|s| s.as_ref().map(|s| self.value(s))).collect();
        let rate = |i: usize| {
            let [less, more] = [2 * i, 2 * i + 1].map(|k| Some((designs[k][i], values[k]?)));
            let here = (at[i], self.value(here));
            let ((x, one), (y, other)) = (less.unwrap_or(here), more.unwrap_or(here));
            (y > x).then(|| (other - one) / (y - x))
        };
        let rates: Option<Vec<f64>> = (0..at.len()).map(rate).collect();
        Ok(rates.map(DVector::from_vec))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    /// The best design with all constraints kept, and how many were evaluated.
    fn best(
        start: &[f64],
        budget: u64,
        of: impl Fn(&[f64]) -> Option<Sample>,
    ) -> (Vec<f64>, f64, u64) {
        let (mut best, mut least, mut count) = (start.to_vec(), f64::INFINITY, 0);
        let Ok(()) = polish::<Infallible>(start, budget, &mut |all| {
            count += all.len() as u64;
            let samples: Vec<_> = all.iter().map(|x| of(x)).collect();
            for (x, sample) in all.iter().zip(&samples) {
                let Some(Sample { cost, broken }) = sample else { continue };
                if *cost < least && broken.iter().all(|broken| *broken <= 0.0) {
                    (best, least) = (x.clone(), *cost);
                }
            }
            Ok(samples)
        });
        (best, least, count)
    }

    fn free(cost: f64) -> Option<Sample> {
        Some(Sample { cost, broken: vec![] })
    }

    /// The valley of Rosenbrock, whose least is at (0.6, 0.6) here.
    #[test]
    fn the_least_of_a_bent_valley_is_found() {
        let of = |x: &[f64]| {
            let [x, y] = [x[0] + 0.4, x[1] + 0.4];
            free((1.0 - x).powi(2) + 100.0 * (y - x * x).powi(2))
        };
        let (found, least, count) = best(&[0.1, 0.9], 1000, of);
        // Differences at a distance of 1e-5 tell a slope of this valley to some 1e-8.
        assert!(found.iter().all(|x| (x - 0.6).abs() < 1e-7), "{found:?}");
        assert!(least < 1e-14 && count < 400, "{least} {count}");
    }

    /// The least of a bowl over a box is its centre, moved into the box.
    #[test]
    fn bounds_are_kept() {
        let centre = [-0.3, 0.4, 1.7];
        let of = |x: &[f64]| {
            assert!(x.iter().all(|x| (0.0..=1.0).contains(x)));
            let off: Vec<f64> = x.iter().zip(centre).map(|(x, c)| x - c).collect();
            free(off.iter().map(|off| off * off).sum::<f64>() + 0.3 * (off[1] * off[1]))
        };
        let (found, ..) = best(&[0.5, 0.9, 0.5], 400, of);
        assert!(found[0] == 0.0 && found[2] == 1.0 && (found[1] - 0.4).abs() < 1e-8, "{found:?}");
    }

    /// The nearest point of a disc: on its rim, on the way to its centre. The multiplier is found, and the disc is not left.
    #[test]
    fn smooth_constraints_are_kept_to_the_last_digits() {
        let of = |x: &[f64]| {
            let rim = (x[0] - 0.2).powi(2) + (x[1] - 0.2).powi(2) - 0.25;
            Some(Sample { cost: 3.0 - x[0] - 2.0 * x[1], broken: vec![rim / 0.25, x[0] - 0.9] })
        };
        let (found, ..) = best(&[0.3, 0.3], 4000, of);
        let expected = [1.0, 2.0].map(|part| 0.2 + 0.5 * part / 5_f64.sqrt());
        for (x, expected) in found.iter().zip(expected) {
            assert!((x - expected).abs() < 1e-6, "{found:?} {expected:?}");
        }
    }

    /// Behind a wall there is nothing; the way to it is.
    #[test]
    fn a_wall_is_not_passed() {
        let of = |x: &[f64]| if x[0] > 0.25 { free((x[0] - 0.1).powi(2)) } else { None };
        let (found, ..) = best(&[0.7], 400, of);
        assert!(found[0] > 0.25 && found[0] < 0.26, "{found:?}");
        let (found, _, count) = best(&[0.2], 400, of);
        assert_eq!((found, count), (vec![0.2], 1));
    }

    #[test]
    fn the_budget_is_kept() {
        for budget in [0, 1, 2, 7, 30] {
            let of = |x: &[f64]| free((x[0] - 0.3).powi(4) + (x[1] - x[0]).powi(2));
            assert!(best(&[0.9, 0.2], budget, of).2 <= budget);
        }
    }
}
