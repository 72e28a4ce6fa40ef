//! The fit: parameters and the poses of all measurements, by least squares.
//!
//! The pose of each measurement is unknown, too: encoders and instruments both have errors. For given parameters each row has
//! a pose that fits it best. What is minimised is the sum of squares that is left, as a function of the parameters alone
//! (variable projection: G. Golub, V. Pereyra, "Separable nonlinear least squares: the variable projection method and its
//! applications", Inverse Problems 19, 2003; with the derivatives of L. Kaufman, BIT 15, 1975).

use crate::column::Column;
use crate::identify::{Identified, range, vector_without, without};
use crate::minimum::{Evaluation, minimise};
use crate::parameter::{Instance, Parameter};
use crate::prediction::Predictor;
use crate::row::{MeasuredRow, Solved};
use nalgebra::{DMatrix, DVector};
use opm_core::Quantity;
use opm_core::manipulator::Mode;
use rayon::prelude::*;

/// Residuals below this share of one radian or of the characteristic length, and of the measured value, are rounding.
const ROUNDING: f64 = 1e-12;

/// A relative change of the sum of squares that is nothing beside standard errors, and above the rounding of the rows' poses.
const TOLERANCE: f64 = 1e-9;

/// The problem: what was measured of which mechanism, and what may vary.
pub struct Problem<'a> {
    pub nominal: &'a Instance,
    pub parameters: &'a [Parameter],
    pub columns: &'a [Column],
    pub rows: &'a [Vec<Option<f64>>],
    /// One over the standard deviation of each column.
    pub weights: &'a [f64],
    pub mode: Mode,
}

/// The rows at some values of the parameters.
pub struct State {
    pub instance: Instance,
    /// `None` for a row that takes no part.
    pub rows: Vec<Option<Solved>>,
}

/// All derivatives by the parameters, in units of one radian and of the characteristic length, weighted.
pub struct Derivatives {
    /// A row for each cell, without what another pose of the row makes up for.
    pub reduced: DMatrix<f64>,
    /// Of each row that takes part, an orthonormal basis of what its pose makes up for.
    pub by_pose: Vec<DMatrix<f64>>,
}

impl Problem<'_> {
    /// One radian, or the characteristic length, for each parameter.
    pub fn units(&self) -> Vec<f64> {
        let length = self.nominal.manipulator.characteristic_length();
        let unit = |parameter: &Parameter| match parameter.quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => length,
        };
        self.parameters.iter().map(unit).collect()
    }

    fn row<'r>(&'r self, number: usize) -> MeasuredRow<'r> {
        MeasuredRow { cells: &self.rows[number], weights: self.weights }
    }

    /// The rows in the mechanism of the file. A row that nothing in reach fits takes no part.
    pub fn start(&self) -> State {
        let instance = Instance::nominal(&self.nominal.file).expect("it was compiled before");
        let predictor = Predictor { instance: &instance, columns: self.columns, mode: self.mode };
        let numbers = (0..self.rows.len()).into_par_iter();
        let rows = numbers.map(|number| {
            let row = self.row(number);
            if row.measured().next().is_none() { None } else { row.first(&predictor) }
        });
        let rows = rows.collect();
        State { instance, rows }
    }

    /// The rows for changes of the parameters, each from its last pose; `None` if the mechanism or a row has no solution.
    pub fn moved(&self, changes: &[f64], last: &State) -> Option<State> {
        let instance = self.nominal.changed(self.parameters, changes).ok()?;
        let predictor = Predictor { instance: &instance, columns: self.columns, mode: self.mode };
        let numbers = (0..self.rows.len()).into_par_iter();
        let solved = numbers.map(|number| match &last.rows[number] {
            None => Some(None),
            Some(solved) => {
                // Near the boundary of reach, its last pose may be beyond it now: a step that loses it would be refused.
                let again = || self.row(number).first(&predictor);
                self.row(number).solve(&predictor, &solved.pose).or_else(again).map(Some)
            }
        });
        let rows: Option<Vec<Option<Solved>>> = solved.collect();
        let rows = rows?;
        Some(State { instance, rows })
    }

    /// The derivatives at a state.
    pub fn derivatives(&self, state: &State) -> Option<Derivatives> {
        let each = self.derivatives_of_rows(state).into_iter().flatten();
        let each: Option<Vec<(DMatrix<f64>, DMatrix<f64>)>> = each.collect();
        let (parts, by_pose): (Vec<_>, Vec<_>) = each?.into_iter().unzip();
        Some(Derivatives { reduced: stacked(&parts, self.parameters.len()), by_pose })
    }

    /// Of each row, if it takes part, the derivatives that another pose does not make up for, and an orthonormal basis of what
    /// it does; `None` inside where they are not defined.
    pub fn derivatives_of_rows(&self, state: &State) -> Vec<Option<RowDerivatives>> {
        let (units, pose_units) = (self.units(), self.pose_units());
        let model = state.instance.model();
        let predictor =
            Predictor { instance: &state.instance, columns: self.columns, mode: self.mode };
        let each = state.rows.par_iter().enumerate().map(|(number, solved)| {
            let solved = solved.as_ref()?;
            let found = predictor.at(&solved.pose, Some((&model, self.parameters)));
            let Some(by) = found.and_then(|found| found.by_parameter) else { return Some(None) };
            let mut by = self.row(number).weighted(&by);
            scale_columns(&mut by, &units);
            let mut by_pose = solved.by_pose.clone();
            scale_columns(&mut by_pose, &pose_units);
            // A decomposition of what is not a number would never end.
            if !by.iter().chain(by_pose.iter()).all(|entry| entry.is_finite()) {
                return Some(None);
            }
            let basis = range(&by_pose);
            Some(Some((without(&basis, &by), basis)))
        });
        each.collect()
    }

    /// The rows at given poses instead of measurements. A pose out of reach takes no part.
    pub fn at(&self, poses: &[Vec<f64>]) -> State {
        let instance = Instance::nominal(&self.nominal.file).expect("it was compiled before");
        let predictor = Predictor { instance: &instance, columns: self.columns, mode: self.mode };
        let rows = poses.par_iter().enumerate().map(|(number, pose)| {
            let by_pose = self.row(number).weighted(&predictor.at(pose, None)?.by_pose);
            let columns: Vec<usize> = (0..self.columns.len()).collect();
            let residuals = vec![0.0; columns.len()];
            Some(Solved { pose: pose.clone(), columns, residuals, by_pose })
        });
        let rows = rows.collect();
        State { instance, rows }
    }

    fn pose_units(&self) -> Vec<f64> {
        let manipulator = &self.nominal.manipulator;
        let length = manipulator.characteristic_length();
        let unit = |c: &opm_core::task::TaskCoordinate| match c.quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => length,
        };
        manipulator.task_coordinates().iter().map(unit).collect()
    }

    /// The best state, with what the data determine free and everything else held. `watch` gets the sum of squares after each
    /// evaluation; where it says `false`, the search ends.
    pub fn solve(
        &self,
        start: State,
        identified: &Identified,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<(State, Vec<f64>), Unsolved> {
        let units = self.units();
        let changes = |z: &[f64]| -> Vec<f64> {
            let all = &identified.determined * DVector::from_column_slice(z);
            all.iter().zip(&units).map(|(change, unit)| change * unit).collect()
        };
        // Of exact measurements nothing is left to fit.
        if self.is_rounding(&start) {
            return Ok((start, vec![0.0; units.len()]));
        }
        let count = residuals(&start).len();
        // The last state that was evaluated, and where.
        let mut last: (Vec<f64>, State) = (vec![0.0; identified.rank()], start);
        let mut stopped = false;
        let found = minimise(&last.0.clone(), (count, TOLERANCE), &mut |z, with_jacobian| {
            if stopped {
                return None;
            }
            if last.0 != z {
                let state = self.moved(&changes(z), &last.1)?;
                last = (z.to_vec(), state);
            }
            let residuals = residuals(&last.1);
            stopped = !watch(residuals.iter().map(|r| r * r).sum());
            let jacobian = match with_jacobian {
                true => Some(self.derivatives(&last.1)?.reduced * &identified.determined),
                false => None,
            };
            Some(Evaluation { residuals, jacobian })
        });
        if stopped {
            return Err(Unsolved::Stopped);
        }
        let changes = changes(&found.at);
        let state = match last.0 == found.at {
            true => last.1,
            false => self.moved(&changes, &last.1).ok_or(Unsolved::Method("a pose is lost"))?,
        };
        match found.converged {
            Err(why) if !self.is_rounding(&state) => Err(Unsolved::Method(why)),
            _ => Ok((state, changes)),
        }
    }

    /// Whether nothing but rounding is left of what was measured.
    fn is_rounding(&self, state: &State) -> bool {
        let length = self.nominal.manipulator.characteristic_length();
        let unit = |column: usize| match self.columns[column].quantity {
            Quantity::Angle => 1.0,
            Quantity::Length => length,
        };
        let rows = state.rows.iter().enumerate();
        let mut rows = rows.filter_map(|(number, solved)| Some((number, solved.as_ref()?)));
        rows.all(|(number, solved)| {
            solved.columns.iter().zip(&solved.residuals).all(|(&column, residual)| {
                let value = self.rows[number][column].unwrap_or_default().abs();
                residual.abs() <= ROUNDING * self.weights[column] * value.max(unit(column))
            })
        })
    }
}

/// The derivatives of a row that another pose does not make up for, and an orthonormal basis of what it does; `None` where they
/// are not defined.
pub type RowDerivatives = Option<(DMatrix<f64>, DMatrix<f64>)>;

/// Why there is no fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsolved {
    /// It was stopped.
    Stopped,
    /// The method ended elsewhere.
    Method(&'static str),
}

/// The residuals of all cells, row by row, in standard deviations.
pub fn residuals(state: &State) -> Vec<f64> {
    state.rows.iter().flatten().flat_map(|row| row.residuals.iter().copied()).collect()
}

fn scale_columns(matrix: &mut DMatrix<f64>, units: &[f64]) {
    for (mut column, unit) in matrix.column_iter_mut().zip(units) {
        column.scale_mut(*unit);
    }
}

/// Matrices with as many columns, one below the other.
pub fn stacked(parts: &[DMatrix<f64>], columns: usize) -> DMatrix<f64> {
    let mut all = DMatrix::zeros(parts.iter().map(DMatrix::nrows).sum(), columns);
    let mut row = 0;
    for part in parts {
        all.rows_mut(row, part.nrows()).copy_from(part);
        row += part.nrows();
    }
    all
}

/// How much of each cell the fit takes up by itself, from 0 to 1: the diagonal of the hat matrix.
pub fn leverages(derivatives: &Derivatives, identified: &Identified) -> Vec<f64> {
    let own = range(&(&derivatives.reduced * &identified.determined));
    let of_poses = derivatives
        .by_pose
        .iter()
        .flat_map(|basis| (0..basis.nrows()).map(move |row| basis.row(row).norm_squared()));
    let of_parameters = own.row_iter().map(|row| row.norm_squared());
    of_poses.zip(of_parameters).map(|(a, b)| a + b).collect()
}

/// What is left of residuals that neither poses nor parameters make up for.
pub fn left_over(
    derivatives: &Derivatives,
    identified: &Identified,
    vector: &DVector<f64>,
) -> DVector<f64> {
    vector_without(&range(&(&derivatives.reduced * &identified.determined)), vector)
}
