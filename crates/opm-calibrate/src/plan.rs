//! Which poses to measure: those that together tell the most.
//!
//! The determinant of the information matrix is made as large as exchanges make it: of all sets of poses it is the one whose
//! confidence ellipsoid of the parameters has the least volume, or nearly so (D-optimality: V. Fedorov, *Theory of Optimal
//! Experiments*, 1972, section 3; for robots, D. Daney, Y. Papegay, B. Madeline, "Choosing measurement poses for robot
//! calibration with the local convergence method and Tabu search", Int. J. Robotics Research 24, 2005). The set starts from
//! the pose that tells the most, and then the one that adds the most, until there are enough.

use crate::calibration::{CalibrateError, Options, chosen, refuse_untold, weights};
use crate::column::Column;
use crate::fit::{Problem, stacked};
use crate::identify::Identified;
use crate::parameter::{Instance, parameters};
use fastrand::Rng;
use nalgebra::DMatrix;
use opm_core::Quantity;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::file::MechanismFile;
use opm_workspace::{Cancelled, Modes, Progress, default_grid};

/// Poses to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The numbers of the chosen candidates, in the order in which they were found.
    pub chosen: Vec<usize>,
    /// Each parameter that might vary, with the standard error that measuring there will give it; `None` if the poses do not
    /// determine it. Without standard deviations, it is for a deviation of one radian and of the characteristic length.
    pub parameters: Vec<(String, Quantity, Option<f64>)>,
    /// The number of combinations of parameters that all candidates together determine.
    pub rank_of_all: usize,
    /// The number that the chosen poses determine.
    pub rank: usize,
    /// The logarithm of the determinant of the information matrix, before exchanges and after.
    pub log_determinant: [f64; 2],
}

/// An exchange that adds less to the logarithm of the determinant is none.
const GAIN: f64 = 1e-6;
/// What stands for information before there are enough poses, relative to that of all candidates.
const PRIOR: f64 = 1e-8;

/// Chooses `count` of the candidates, which are poses. At each of them the columns will be measured.
///
/// # Errors
/// See [`CalibrateError`]; candidates out of reach are not chosen.
pub fn plan(
    file: &MechanismFile,
    columns: &[Column],
    candidates: &[Vec<f64>],
    count: usize,
    options: &Options,
    progress: &Progress,
) -> Result<Plan, CalibrateError> {
    let nominal = Instance::nominal(file)?;
    let parameters = chosen(parameters(&nominal), options)?;
    let weights = weights(columns, options, nominal.manipulator.characteristic_length())?;
    let mode = options.mode.unwrap_or(nominal.manipulator.home_mode());
    let rows = vec![vec![Some(0.0); columns.len()]; candidates.len()];
    let (nominal, rows, weights) = (&nominal, &rows[..], &weights[..]);
    let parameters = &parameters[..];
    let problem = Problem { nominal, parameters, columns, rows, weights, mode };
    let derivatives = problem.derivatives_of_rows(&problem.at(candidates));
    let (mut numbers, mut parts, mut by_pose) = (Vec::new(), Vec::new(), Vec::new());
    for (number, found) in derivatives.into_iter().enumerate() {
        if let Some(Some((part, basis))) = found {
            numbers.push(number);
            parts.push(part);
            by_pose.push(basis);
        }
    }
    if parts.is_empty() {
        return Err(CalibrateError::NoPose);
    }
    let all = stacked(&parts, parameters.len());
    refuse_untold(&problem, &all, &by_pose)?;
    let identified = Identified::new(&all, 0.0);
    let own: Vec<DMatrix<f64>> = parts.iter().map(|part| part * &identified.determined).collect();
    let squares: Vec<DMatrix<f64>> = own.iter().map(|part| part.tr_mul(part)).collect();
    let largest = squares.iter().map(DMatrix::trace).fold(0.0, f64::max);
    let mut design = Design {
        squares: &squares,
        sum: DMatrix::identity(identified.rank(), identified.rank()) * (PRIOR * largest),
        chosen: Vec::new(),
        progress,
    };
    design.grow(count)?;
    let before = log_determinant(&design.sum);
    design.exchange()?;
    let picked: Vec<DMatrix<f64>> = design.chosen.iter().map(|&k| parts[k].clone()).collect();
    let least = if options.sigma.is_some() { options.weakest.recip() } else { 0.0 };
    let told = Identified::new(&stacked(&picked, parameters.len()), least);
    let information =
        picked.iter().fold(DMatrix::zeros(told.rank(), told.rank()), |sum: DMatrix<f64>, part| {
            let own = part * &told.determined;
            sum + own.tr_mul(&own)
        });
    let inverse =
        information.try_inverse().unwrap_or_else(|| DMatrix::zeros(told.rank(), told.rank()));
    let covariance = &told.determined * inverse * told.determined.transpose();
    let error =
        |k: usize| told.identifiable(k).then(|| covariance[(k, k)].sqrt() * problem.units()[k]);
    let named = parameters.iter().enumerate().map(|(k, p)| (p.name.clone(), p.quantity, error(k)));
    Ok(Plan {
        chosen: design.chosen.iter().map(|&k| numbers[k]).collect(),
        parameters: named.collect(),
        rank_of_all: identified.rank(),
        rank: told.rank(),
        log_determinant: [before, log_determinant(&design.sum)],
    })
}

/// A set of poses that grows and changes.
struct Design<'a> {
    /// What each pose tells: its part of the information matrix.
    squares: &'a [DMatrix<f64>],
    /// The sum of the chosen ones, and of the prior.
    sum: DMatrix<f64>,
    chosen: Vec<usize>,
    progress: &'a Progress,
}

impl Design<'_> {
    /// The pose that, added to a sum, gives the largest determinant, and its logarithm.
    fn best(&self, sum: &DMatrix<f64>) -> Result<Option<(usize, f64)>, CalibrateError> {
        let mut best: Option<(usize, f64)> = None;
        for (k, square) in self.squares.iter().enumerate() {
            if self.chosen.contains(&k) {
                continue;
            }
            let logarithm = log_determinant(&(sum + square));
            if best.is_none_or(|(_, largest)| logarithm > largest) {
                best = Some((k, logarithm));
            }
        }
        self.progress.advance(1).map_err(|Cancelled| CalibrateError::Stopped)?;
        Ok(best)
    }

    fn grow(&mut self, count: usize) -> Result<(), CalibrateError> {
        while self.chosen.len() < count {
            let Some((k, _)) = self.best(&self.sum)? else { break };
            self.sum += &self.squares[k];
            self.chosen.push(k);
        }
        Ok(())
    }

    /// Exchanges poses, each for the best other one, as long as that helps.
    fn exchange(&mut self) -> Result<(), CalibrateError> {
        let mut logarithm = log_determinant(&self.sum);
        loop {
            let before = logarithm;
            for place in 0..self.chosen.len() {
                let rest = &self.sum - &self.squares[self.chosen[place]];
                if let Some((k, found)) = self.best(&rest)?
                    && found > logarithm + GAIN
                {
                    self.sum = rest + &self.squares[k];
                    self.chosen[place] = k;
                    logarithm = found;
                }
            }
            if logarithm <= before + GAIN {
                return Ok(());
            }
        }
    }
}

/// The logarithm of the determinant of a symmetric matrix; minus infinity if it is not positive definite.
fn log_determinant(matrix: &DMatrix<f64>) -> f64 {
    let factor = matrix.clone().cholesky();
    factor.map_or(f64::NEG_INFINITY, |factor| 2.0 * factor.l().diagonal().map(f64::ln).sum())
}

/// The largest condition number of a candidate that is drawn: near singularities noise is amplified, and machines seldom go
/// there.
const MOST_CONDITION: f64 = 100.0;
/// Draws for each candidate before the workspace counts as too thin.
const DRAWS: usize = 2000;

/// Poses drawn evenly from the box around the workspace: those within reach and limits, and not near a singularity. Fewer
/// where the workspace is thin.
///
/// # Errors
/// If the work was asked to stop.
pub fn candidates(
    manipulator: &Manipulator,
    mode: Mode,
    count: usize,
    seed: u64,
    progress: &Progress,
) -> Result<Vec<Vec<f64>>, Cancelled> {
    let (_, extents) = default_grid(manipulator, Modes::One(mode), progress)?;
    let mut rng = Rng::with_seed(seed);
    let (mut found, mut at) = (Vec::new(), manipulator.solution());
    let (mut jacobians, length) = (manipulator.jacobians(), manipulator.characteristic_length());
    for _ in 0..count.saturating_mul(DRAWS) {
        if found.len() == count {
            break;
        }
        progress.advance(1)?;
        let draw =
            |extent: &opm_workspace::Extent| extent.min + (extent.max - extent.min) * rng.f64();
        let pose: Vec<f64> = extents.iter().map(draw).collect();
        let Ok(Some(solved)) = manipulator.inverse(&pose, mode, &mut at) else { continue };
        let regular = solved.within_limits()
            && manipulator.differentiate(solved, &mut jacobians).is_ok_and(|regular| regular)
            && manipulator.conditioning(&jacobians, length).condition < MOST_CONDITION;
        if regular {
            found.push(pose);
        }
    }
    Ok(found)
}
