//! The optimisers: CMA-ES for one objective, differential evolution with the selection of NSGA-II for two, both of the crate
//! `fcmaes-core`.

use crate::judge::{Judged, UNASSEMBLED};
use fcmaes_core::{Cmaes, CmaesParams, Fitness, Mode, ModeParams, Rng};

/// The standard deviation of the first generation, as a share of the way between bounds.
const STEP: f64 = 0.25;

/// Designs of a generation for two objectives.
const GENERATION: i32 = 32;

/// The cost of what has none.
const LARGE: f64 = 1e9;

/// Evaluates designs, given as shares of the way between the bounds; `None` for one that does not assemble.
pub type Evaluate<'a, E> = dyn FnMut(&[Vec<f64>]) -> Result<Vec<Option<Judged>>, E> + 'a;

/// The shares of the best design of one objective, by CMA-ES (N. Hansen, A. Ostermeier, "Completely derandomized
/// self-adaptation in evolution strategies", *Evolutionary Computation* 9, 2001). It starts anew elsewhere whenever it has
/// converged.
pub fn best<E>(
    dimension: usize,
    budget: u64,
    seed: u64,
    evaluate: &mut Evaluate<'_, E>,
) -> Result<Vec<f64>, E> {
    let mut random = Rng::new(seed);
    let (mut best, mut least) = (vec![0.5; dimension], f64::INFINITY);
    let mut left = budget;
    while left > 0 {
        let start: Vec<f64> =
            random.uniform_vec(dimension).iter().map(|u| 0.25 + 0.5 * u).collect();
        let parameters = CmaesParams {
            popsize: 0,
            // What is adapted must not depend on how long it may take, so that a longer run begins as a shorter one.
            max_evaluations: u64::MAX,
            seed: random.next_u64(),
            ..CmaesParams::default()
        };
        let mut evolution = Cmaes::new(unit_cube(dimension, 1), &start, &[STEP], &parameters);
        while left > 0 && evolution.stop() == 0 {
            let mut generation = evolution.ask();
            let whole = generation.len() as u64 <= left;
            generation.truncate(usize::try_from(left).unwrap_or(usize::MAX));
            left -= generation.len() as u64;
            let judged = evaluate(&generation)?;
            let scores: Vec<f64> =
                judged.iter().map(|j| j.as_ref().map_or(UNASSEMBLED, Judged::score)).collect();
            for (shares, score) in generation.iter().zip(&scores) {
                if *score < least {
                    (best, least) = (shares.clone(), *score);
                }
            }
            if whole {
                evolution.tell(&scores);
            }
        }
    }
    Ok(best)
}

/// Searches the front of two objectives: differential evolution (R. Storn, K. Price, *Journal of Global Optimization* 11, 1997)
/// with the selection of NSGA-II (K. Deb et al., *IEEE Transactions on Evolutionary Computation* 6, 2002). The front is
/// that of all designs that were evaluated.
pub fn front<E>(
    dimension: usize,
    budget: u64,
    seed: u64,
    evaluate: &mut Evaluate<'_, E>,
) -> Result<(), E> {
    let parameters = ModeParams { popsize: GENERATION, seed, ..ModeParams::default() };
    // The third number of each design is how far it breaks the constraints.
    let mut evolution = Mode::new(unit_cube(dimension, 3), 2, 1, None, &parameters);
    let mut left = budget;
    while left > 0 {
        let mut generation = evolution.ask();
        let whole = generation.len() as u64 <= left;
        generation.truncate(usize::try_from(left).unwrap_or(usize::MAX));
        left -= generation.len() as u64;
        let judged = evaluate(&generation)?;
        let told = |judged: &Option<Judged>| match judged {
            Some(Judged { costs, violation }) => {
                let cost = |number: usize| costs[number].min(LARGE);
                vec![cost(0), cost(1), violation.min(LARGE)]
            }
            None => vec![LARGE, LARGE, 2.0 * LARGE],
        };
        if whole {
            evolution.tell(&judged.iter().map(told).collect::<Vec<_>>());
        }
    }
    Ok(())
}

fn unit_cube(dimension: usize, numbers: usize) -> Fitness {
    Fitness::bounded(dimension, numbers, &vec![0.0; dimension], &vec![1.0; dimension])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn judged(cost: f64) -> Option<Judged> {
        Some(Judged { costs: vec![cost], violation: 0.0 })
    }

    /// The optimum of a long valley is known.
    #[test]
    fn the_least_of_a_valley_is_found() {
        for dimension in [1, 2, 9] {
            let target = |i: usize| 0.2 + 0.6 * i as f64 / dimension as f64;
            let mut count = 0;
            let found = best::<Infallible>(dimension, 3000, 1, &mut |all| {
                count += all.len();
                let cost = |x: &Vec<f64>| {
                    let each = x.iter().enumerate();
                    each.map(|(i, x)| (1.0 + 30.0 * i as f64) * (x - target(i)).powi(2)).sum()
                };
                Ok(all.iter().map(|x| judged(cost(x))).collect())
            });
            let Ok(found) = found;
            assert_eq!(count, 3000);
            for (i, x) in found.iter().enumerate() {
                assert!((x - target(i)).abs() < 1e-3, "{dimension}: {found:?}");
            }
        }
    }

    /// Constraints come first: the least of x over x ≥ 0.7.
    #[test]
    fn a_constraint_is_kept() {
        let Ok(found) = best::<Infallible>(2, 1500, 3, &mut |all| {
            let of = |x: &Vec<f64>| {
                Some(Judged { costs: vec![x[0] + x[1]], violation: (0.7 - x[0]).max(0.0) })
            };
            Ok(all.iter().map(of).collect())
        });
        assert!((found[0] - 0.7).abs() < 1e-3 && found[1] < 1e-3, "{found:?}");
    }

    /// The front of the distances to two points is the line between them (J. Schaffer, 1985).
    #[test]
    fn the_front_of_two_distances_is_the_line_between() {
        let mut all = Vec::new();
        let Ok(()) = front::<Infallible>(2, 2000, 5, &mut |generation| {
            let to = |x: &[f64], at: f64| (x[0] - at).powi(2) + (x[1] - at).powi(2);
            let of = |x: &Vec<f64>| {
                let costs = vec![to(x, 0.25), to(x, 0.75)];
                Some(Judged { costs, violation: 0.0 })
            };
            all.extend(generation.iter().cloned());
            Ok(generation.iter().map(of).collect())
        });
        assert_eq!(all.len(), 2000);
        let costs = |x: &[f64]| [0.25, 0.75].map(|at| (x[0] - at).powi(2) + (x[1] - at).powi(2));
        let better = |one: &[f64; 2], other: &[f64; 2]| one[0] < other[0] && one[1] < other[1];
        let every: Vec<[f64; 2]> = all.iter().map(|x| costs(x)).collect();
        let stays = |x: &&Vec<f64>| every.iter().all(|other| !better(other, &costs(x)));
        let front: Vec<&Vec<f64>> = all.iter().filter(stays).collect();
        assert!(front.len() > 20, "{}", front.len());
        // Off the line by d, both costs are larger by d² / 2: by a hundredth of the front's range, 0.5, at 0.1.
        let off = front.iter().map(|x| (x[0] - x[1]).abs()).fold(0.0, f64::max);
        assert!(off < 0.1, "{off}");
        for part in 0..4 {
            let from = 0.25 + 0.125 * f64::from(part);
            assert!(front.iter().any(|x| (from..=from + 0.125).contains(&x[0])), "{from}");
        }
    }
}
