//! Errors that leave the class, as play of the joints.
//!
//! Parameters stay in the class. What they cannot explain is left in the residuals. Errors of the axes that leave the class
//! displace the platform to first order as `opm-accuracy` says. Of all such errors that explain what is left beyond chance,
//! the smallest are taken, and their misfit is the play that the joints need at each measured pose. What no residual shows is
//! not in it: the real play may be larger.

use crate::column::{Body, ColumnKind};
use crate::fit::{Derivatives, Problem, State, stacked};
use crate::identify::{Identified, range, without};
use crate::row::MeasuredRow;
use nalgebra::{DMatrix, DVector, RowVector6};
use opm_accuracy::{Response, Source};
use opm_core::Quantity;
use opm_core::velocity::SINGULAR;
use rayon::prelude::*;

/// The play that the joints need at the measured poses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ResidualPlay {
    /// How many independent combinations of errors the residuals show beyond chance; none: the mechanism is in its class as
    /// far as the measurements tell.
    pub combinations: usize,
    /// The largest play of each joint over all measured poses.
    pub joints: Vec<JointPlay>,
}

/// The play of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointPlay {
    /// The joint's name.
    pub name: String,
    /// The displacement of its point, metres.
    pub length: f64,
    /// The rotation, radians.
    pub angle: f64,
}

/// A component of the residuals beyond this many standard deviations is not chance.
const SIGNIFICANT: f64 = 4.0;

/// Errors of axes that explain what is left, and their misfit. `left` are the residuals over one standard deviation, without
/// what poses and parameters make up for.
pub fn residual_play(
    problem: &Problem<'_>,
    state: &State,
    derivatives: &Derivatives,
    identified: &Identified,
    left: &DVector<f64>,
    scale: f64,
) -> ResidualPlay {
    let manipulator = &state.instance.manipulator;
    let model = state.instance.model();
    let names = manipulator.mechanism().joints().map(|joint| joint.name.clone());
    let none = |name| JointPlay { name, length: 0.0, angle: 0.0 };
    let mut play = ResidualPlay { combinations: 0, joints: names.map(none).collect() };
    let length = manipulator.characteristic_length();
    let unit = |source: &Source| match (source.axes(), source.quantity) {
        (None, _) => 0.0,
        (Some(_), Quantity::Angle) => 1.0,
        (Some(_), Quantity::Length) => length,
    };
    let units: Vec<f64> = model.sources().iter().map(unit).collect();
    let solved: Vec<_> = state.rows.iter().enumerate().collect();
    let responses: Vec<Option<(Response, DMatrix<f64>)>> = solved
        .par_iter()
        .filter_map(|(number, row)| {
            let row = row.as_ref()?;
            let mut buffer = manipulator.solution();
            let at = manipulator.inverse(&row.pose, problem.mode, &mut buffer).ok().flatten();
            let found = at.and_then(|at| {
                let response = model.at(at).ok().filter(|response| response.held)?;
                let body = Body::new(manipulator, &at.displacement(manipulator));
                let by = by_errors(problem, &response, &body)?;
                let cells = MeasuredRow { cells: &problem.rows[*number], weights: problem.weights };
                let mut by = cells.weighted(&by);
                for (mut column, unit) in by.column_iter_mut().zip(&units) {
                    column.scale_mut(unit / scale);
                }
                Some((response, by))
            });
            Some(found)
        })
        .collect();
    let Some(responses) = responses.into_iter().collect::<Option<Vec<_>>>() else { return play };
    let parts: Vec<DMatrix<f64>> = responses
        .iter()
        .zip(&derivatives.by_pose)
        .map(|((_, by), basis)| without(basis, by))
        .collect();
    let by = stacked(&parts, units.len());
    let by = without(&range(&(&derivatives.reduced * &identified.determined)), &by);
    if by.is_empty() || by.nrows() < 2 || left.iter().any(|r| r.is_nan()) {
        return play;
    }
    let svd = by.svd(true, true);
    let (left_vectors, right) = (svd.u.expect("asked for"), svd.v_t.expect("asked for"));
    let zero = SINGULAR * svd.singular_values.max();
    let mut errors = DVector::zeros(units.len());
    for (k, singular) in svd.singular_values.iter().enumerate().filter(|(_, s)| **s > zero) {
        let along = left_vectors.column(k).dot(left);
        if along.abs() > SIGNIFICANT {
            errors -= right.row(k).transpose() * (along / singular);
            play.combinations += 1;
        }
    }
    for (error, unit) in errors.iter_mut().zip(&units) {
        *error *= unit;
    }
    for (response, _) in &responses {
        for (joint, plays) in play.joints.iter_mut().zip(&response.plays) {
            let twist = plays * &errors;
            joint.angle = joint.angle.max(twist.fixed_rows::<3>(0).norm());
            joint.length = joint.length.max(twist.fixed_rows::<3>(3).norm());
        }
    }
    play
}

/// The changes of the columns for units of all errors with the actuators held. `None` where a coordinate is not determined.
fn by_errors(problem: &Problem<'_>, response: &Response, body: &Body) -> Option<DMatrix<f64>> {
    let mut by = DMatrix::zeros(problem.columns.len(), response.twists.ncols());
    for (row, column) in problem.columns.iter().enumerate() {
        match (column.kind, column.by_twist(body)) {
            (ColumnKind::Coordinate(number), _) => {
                by.set_row(row, &response.coordinates.row(number));
            }
            (_, Some(by_twist)) => {
                let by_twist: RowVector6<f64> = by_twist;
                by.set_row(row, &(by_twist * &response.twists));
            }
            // Actuated joints are held; dependent coordinates are not compared.
            (_, None) => {}
        }
    }
    by.iter().all(|number| number.is_finite()).then_some(by)
}
