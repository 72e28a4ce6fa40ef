//! The pose of one measurement: the one that fits its cells best.

use crate::column::{Column, ColumnKind};
use crate::minimum::{Evaluation, minimise};
use crate::prediction::{Prediction, Predictor};
use nalgebra::DMatrix;
use opm_core::manipulator::Manipulator;
use std::f64::consts::TAU;

/// Relative changes that are rounding.
const TOLERANCE: f64 = 1e-12;

/// The cells of a row that count.
pub struct MeasuredRow<'a> {
    /// A value for each column; `None` where nothing was measured.
    pub cells: &'a [Option<f64>],
    /// One over the standard deviation of each column.
    pub weights: &'a [f64],
}

/// A solved row.
#[derive(Clone)]
pub struct Solved {
    pub pose: Vec<f64>,
    /// The columns that were measured.
    pub columns: Vec<usize>,
    /// Prediction less measurement, in standard deviations.
    pub residuals: Vec<f64>,
    /// Their derivatives by the pose: a row for each cell.
    pub by_pose: DMatrix<f64>,
}

impl MeasuredRow<'_> {
    /// The numbers of the columns that were measured.
    pub fn measured(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.cells.len()).filter(|&column| self.cells[column].is_some())
    }

    /// The residuals of a prediction.
    fn residuals(&self, predicted: &Prediction, columns: &[Column]) -> Vec<f64> {
        let residual = |column: usize| {
            let off = predicted.values[column] - self.cells[column].unwrap_or(f64::NAN);
            self.weights[column] * wrapped(off, &columns[column])
        };
        self.measured().map(residual).collect()
    }

    /// The rows of a matrix of derivatives that were measured, weighted.
    pub fn weighted(&self, by: &DMatrix<f64>) -> DMatrix<f64> {
        let measured: Vec<usize> = self.measured().collect();
        DMatrix::from_fn(measured.len(), by.ncols(), |i, j| {
            by[(measured[i], j)] * self.weights[measured[i]]
        })
    }

    /// The pose that fits best, from a start; `None` if there is none in reach.
    pub fn solve(&self, predictor: &Predictor<'_>, start: &[f64]) -> Option<Solved> {
        let columns: Vec<usize> = self.measured().collect();
        let evaluate = |pose: &[f64]| {
            let predicted = predictor.at(pose, None)?;
            let residuals = self.residuals(&predicted, predictor.columns);
            Some((residuals, self.weighted(&predicted.by_pose)))
        };
        let found = minimise(start, (columns.len(), TOLERANCE), &mut |pose, _| {
            let (residuals, jacobian) = evaluate(pose)?;
            Some(Evaluation { residuals, jacobian: Some(jacobian) })
        });
        let (residuals, by_pose) = evaluate(&found.at)?;
        Some(Solved { pose: found.at, columns, residuals, by_pose })
    }

    /// The pose that fits best in the mechanism of the file.
    pub fn first(&self, predictor: &Predictor<'_>) -> Option<Solved> {
        let starts = self.starts(predictor);
        let solved = starts.iter().filter_map(|start| self.solve(predictor, start));
        let cost = |of: &Solved| of.residuals.iter().map(|r| r * r).sum::<f64>();
        solved.min_by(|a, b| cost(a).total_cmp(&cost(b)))
    }

    /// Poses in reach from which to search: what the row says of the pose, and the assemblies for its joints.
    fn starts(&self, predictor: &Predictor<'_>) -> Vec<Vec<f64>> {
        let manipulator = &predictor.instance.manipulator;
        let home = manipulator.home_pose();
        let mut given = home.clone();
        let mut known = 0;
        for (column, cell) in predictor.columns.iter().zip(self.cells) {
            if let (ColumnKind::Coordinate(number), Some(value)) = (column.kind, cell) {
                given[number] = *value;
                known += 1;
            }
        }
        let mut starts = Vec::new();
        // What was measured may be slightly out of reach.
        const SHARES: [f64; 6] = [1.0, 0.999, 0.99, 0.95, 0.8, 0.5];
        let towards = |share: f64| -> Vec<f64> {
            home.iter().zip(&given).map(|(home, given)| home + share * (given - home)).collect()
        };
        let reached = SHARES.into_iter().map(towards);
        starts.extend(reached.into_iter().find(|pose| predictor.at(pose, None).is_some()));
        if known < home.len() {
            starts.extend(self.assembled(predictor, manipulator, &given));
            starts.push(home);
        }
        starts
    }

    /// The poses at which the actuated joints have their measured values, if all of them were measured.
    fn assembled(
        &self,
        predictor: &Predictor<'_>,
        manipulator: &Manipulator,
        near: &[f64],
    ) -> Vec<Vec<f64>> {
        let value = |joint: &usize| {
            let mut cells = predictor.columns.iter().zip(self.cells);
            cells.find_map(|(column, cell)| match column.kind {
                ColumnKind::Joint(number) if number == *joint => *cell,
                _ => None,
            })
        };
        let actuated: Option<Vec<f64>> = manipulator.actuated().iter().map(value).collect();
        let Some(actuated) = actuated else { return Vec::new() };
        let mut list = manipulator.forward(&actuated).map(|found| found.list).unwrap_or_default();
        manipulator.keep_assemblies_in(&mut list, predictor.mode);
        let mut poses: Vec<Vec<f64>> = list.into_iter().map(|assembly| assembly.pose).collect();
        for start in [near, &manipulator.home_pose()] {
            let found = manipulator.forward_near(&actuated, start, predictor.mode);
            poses.extend(found.map(|assembly| assembly.pose));
        }
        poses
    }
}

/// The difference of two values; of angles, within half a turn.
fn wrapped(off: f64, column: &Column) -> f64 {
    match column.quantity {
        opm_core::Quantity::Length => off,
        opm_core::Quantity::Angle => off - TAU * (off / TAU).round(),
    }
}
