//! Calibration: what is asked, and the answer.

use crate::column::Column;
use crate::fit::{Derivatives, Problem, State, Unsolved, left_over, leverages, residuals};
use crate::identify::{Combination, Identified};
use crate::parameter::{Instance, InstanceError, Parameter, parameters};
use crate::play::{ResidualPlay, residual_play};
use nalgebra::{DMatrix, DVector};
use opm_core::Quantity;
use opm_core::manipulator::Mode;
use opm_core::mechanism::file::MechanismFile;
use std::ops::RangeInclusive;

/// A table of measurements: a row for each pose of the platform.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurements {
    /// What is measured.
    pub columns: Vec<Column>,
    /// A value for each column, metres and radians; `None` where nothing was measured.
    pub rows: Vec<Vec<Option<f64>>>,
}

/// Standard deviations of what is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sigma {
    /// Of lengths, metres.
    pub length: f64,
    /// Of angles, radians.
    pub angle: f64,
}

/// Standard deviations whose weights stay numbers in squares and in their products with derivatives.
pub const SIGMAS: RangeInclusive<f64> = 1e-75..=1e75;

/// How to calibrate.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// The working mode of all measurements; that of home if it is not given.
    pub mode: Option<Mode>,
    /// Standard deviations of measurements. Without them all cells weigh the same, lengths in units of the characteristic
    /// length, and the standard deviation is estimated from the residuals.
    pub sigma: Option<Sigma>,
    /// Those of actuated joints, if they are others.
    pub joint_sigma: Option<Sigma>,
    /// Parts of names of the parameters that may vary, between points: `leg1`, `home`, `leg1.h`. All if it is empty.
    pub only: Vec<String>,
    /// Parts of names of parameters that keep their values.
    pub hold: Vec<String>,
    /// Whether outliers are left out, one after the other, the worst first.
    pub reject_outliers: bool,
    /// With standard deviations, a combination of parameters whose standard error would be larger than this, in radians and in
    /// units of the characteristic length, keeps its value.
    pub weakest: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            mode: None,
            sigma: None,
            joint_sigma: None,
            only: Vec::new(),
            hold: Vec::new(),
            reject_outliers: false,
            weakest: 0.05,
        }
    }
}

/// A parameter, calibrated.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Its name.
    pub name: String,
    /// Whether it is a length or an angle.
    pub quantity: Quantity,
    /// Its value in the file, metres and radians; zero for a displacement of an axis.
    pub before: f64,
    /// Its value after calibration.
    pub after: f64,
    /// Its standard error; `None` if the data do not determine it.
    pub standard_error: Option<f64>,
    /// Whether the data determine it.
    pub identifiable: bool,
}

/// One cell of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The number of the row, from 0.
    pub row: usize,
    /// The number of the column.
    pub column: usize,
    /// What was measured, metres or radians.
    pub measured: f64,
    /// Measured less predicted by the calibrated mechanism.
    pub residual: f64,
    /// The residual over its own standard deviation; `None` where the fit takes up all of the cell, so that it is not checked by
    /// others.
    pub studentised: Option<f64>,
    /// Whether it is too large for chance.
    pub outlier: bool,
    /// Whether it was left out of the fit. Then it has no studentised residual.
    pub rejected: bool,
}

/// What a calibration found.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The calibrated mechanism.
    pub file: MechanismFile,
    /// Every parameter that might vary.
    pub parameters: Vec<Estimate>,
    /// The correlations of all parameters, a row and a column for each; NaN for one that the data do not determine.
    pub correlations: DMatrix<f64>,
    /// The number of independent combinations of parameters that the data determine.
    pub rank: usize,
    /// The singular values of the weighted derivatives, the largest first: with standard deviations, each is one over the
    /// standard error of a combination, in radians and units of the characteristic length.
    pub singular_values: Vec<f64>,
    /// What the data do not determine: it keeps its value.
    pub held: Vec<Combination>,
    /// The cells of all rows that took part, row by row.
    pub cells: Vec<Cell>,
    /// The numbers of the rows that took no part, because no pose in reach comes near.
    pub unused: Vec<usize>,
    /// The number of cells that check others: cells less what poses and parameters take up.
    pub surplus: usize,
    /// The root of the sum of squares of residuals over the surplus: about 1 if the standard deviations are right; without
    /// given ones, it is their estimate, in radians and units of the characteristic length. `None` without surplus.
    pub deviation: Option<f64>,
    /// The same with the parameters of the file.
    pub deviation_before: Option<f64>,
    /// What errors that leave the class do to the joints, as far as the residuals show it.
    pub play: ResidualPlay,
}

impl Calibration {
    /// The text of the calibrated mechanism file, in the units of the file.
    pub fn text(&self) -> String {
        self.file.text()
    }
}

/// Why nothing was calibrated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrateError {
    /// The mechanism cannot be compiled.
    #[error(transparent)]
    Mechanism(#[from] InstanceError),
    /// A name of parameters means none.
    #[error("`{name}` names no parameter; expected one of {}, or a part of one between points", .known.join(", "))]
    Unknown {
        /// The name.
        name: String,
        /// Those that there are.
        known: Vec<String>,
    },
    /// Every parameter is held.
    #[error("every parameter is held: nothing to calibrate")]
    NothingVaries,
    /// A standard deviation is not a positive number, or so small or large that squares of weights overflow.
    #[error("a standard deviation is {0:?}, expected a positive number, 1e-75 to 1e75")]
    Sigma(f64),
    /// A measured value is not a number.
    #[error("row {} of column {column} is {value}, expected a number", .row + 1)]
    NotFinite {
        /// The number of the row, from 0.
        row: usize,
        /// The name of the column.
        column: String,
        /// The value.
        value: f64,
    },
    /// No row has a pose.
    #[error("no measurement is near a pose in reach of the mechanism in this working mode")]
    NoPose,
    /// Nothing is measured twice, so that nothing is known of the parameters.
    #[error(
        "the measurements say nothing of the parameters: no row has more measured values than the pose has coordinates, {0}"
    )]
    NoSurplus(usize),
    /// No parameter that may vary changes what is measured.
    #[error(
        "the measurements say nothing of the parameters that may vary: none of these changes a measured value"
    )]
    NothingTold,
    /// The standard deviations are so large that nothing is determined as well as it has to be.
    #[error(
        "the measurements are too inaccurate: with these standard deviations even the best determined combination of \
         parameters has a standard error of {error:.3}, in radians and units of the characteristic length, expected at most \
         {weakest}"
    )]
    Inaccurate {
        /// The standard error of that combination.
        error: f64,
        /// The largest that is accepted ([`Options::weakest`]).
        weakest: f64,
    },
    /// The method did not converge.
    #[error("no convergence: {0}; measurements or the mechanism may be far off")]
    NotConverged(&'static str),
    /// It was stopped.
    #[error("stopped")]
    Stopped,
}

/// The parameters that a mechanism file has for calibration, with their values.
///
/// # Errors
/// If the mechanism cannot be compiled.
pub fn parameters_of(file: &MechanismFile) -> Result<Vec<Parameter>, CalibrateError> {
    Ok(parameters(&Instance::nominal(file)?))
}

/// The mechanism file with changes of its parameters, in their order; metres and radians.
///
/// # Errors
/// If the parameters of a family do not fit any more.
///
/// # Panics
/// If there is not one change for each parameter.
pub fn with_changes(
    file: &MechanismFile,
    parameters: &[Parameter],
    changes: &[f64],
) -> Result<MechanismFile, CalibrateError> {
    assert_eq!(parameters.len(), changes.len(), "one change for each parameter");
    Ok(Instance::nominal(file)?.changed(parameters, changes)?.made())
}

/// Calibrates a mechanism. `watch` is told the sum of squares of the weighted residuals after each evaluation; where it says
/// `false`, the work stops.
///
/// # Errors
/// See [`CalibrateError`].
pub fn calibrate(
    file: &MechanismFile,
    measurements: &Measurements,
    options: &Options,
    watch: &mut dyn FnMut(f64) -> bool,
) -> Result<Calibration, CalibrateError> {
    let nominal = Instance::nominal(file)?;
    let parameters = chosen(parameters(&nominal), options)?;
    let columns = &measurements.columns;
    let weights = weights(columns, options, nominal.manipulator.characteristic_length())?;
    for (row, cells) in measurements.rows.iter().enumerate() {
        for (column, cell) in columns.iter().zip(cells) {
            if let Some(value) = cell.filter(|value| !value.is_finite()) {
                return Err(CalibrateError::NotFinite { row, column: column.name.clone(), value });
            }
        }
    }
    let mode = options.mode.unwrap_or(nominal.manipulator.home_mode());
    let least = if options.sigma.is_some() { options.weakest.recip() } else { 0.0 };
    let mut rows = measurements.rows.clone();
    let mut rejected: Vec<Cell> = Vec::new();
    loop {
        let problem = Problem {
            nominal: &nominal,
            parameters: &parameters,
            columns,
            rows: &rows,
            weights: &weights,
            mode,
        };
        let fitted = Fitted::new(&problem, least, watch)?;
        let mut calibration = fitted.report(&problem, options.sigma.is_some());
        let worst = calibration.cells.iter().filter(|cell| cell.outlier).max_by(|a, b| {
            let size = |cell: &Cell| cell.studentised.map_or(0.0, f64::abs);
            size(a).total_cmp(&size(b))
        });
        match worst.filter(|_| options.reject_outliers) {
            Some(worst) => {
                rows[worst.row][worst.column] = None;
                rejected.push(Cell { rejected: true, studentised: None, ..*worst });
            }
            None => {
                fitted.predict_rejected(&problem, &mut rejected);
                calibration.cells.extend(rejected);
                calibration.cells.sort_by_key(|cell| (cell.row, cell.column));
                return Ok(calibration);
            }
        }
    }
}

/// The parameters that may vary.
pub(crate) fn chosen(
    all: Vec<Parameter>,
    options: &Options,
) -> Result<Vec<Parameter>, CalibrateError> {
    // Whole words of a name, next to each other.
    let means = |given: &str, name: &str| {
        let (name, given) = (format!(".{name}."), format!(".{given}."));
        given.len() > 2 && name.contains(&given)
    };
    for given in options.only.iter().chain(&options.hold) {
        if !all.iter().any(|parameter| means(given, &parameter.name)) {
            let known = all.iter().map(|parameter| parameter.name.clone()).collect();
            return Err(CalibrateError::Unknown { name: given.clone(), known });
        }
    }
    let varies = |parameter: &Parameter| {
        let named = |names: &[String]| names.iter().any(|name| means(name, &parameter.name));
        (options.only.is_empty() || named(&options.only)) && !named(&options.hold)
    };
    let chosen: Vec<Parameter> = all.into_iter().filter(varies).collect();
    if chosen.is_empty() { Err(CalibrateError::NothingVaries) } else { Ok(chosen) }
}

/// One over the standard deviation of each column.
pub(crate) fn weights(
    columns: &[Column],
    options: &Options,
    length: f64,
) -> Result<Vec<f64>, CalibrateError> {
    let unknown = Sigma { length, angle: 1.0 };
    let of = |column: &Column| {
        let sigma = options.sigma.unwrap_or(unknown);
        let sigma = if column.is_joint() { options.joint_sigma.unwrap_or(sigma) } else { sigma };
        let sigma = match column.quantity {
            Quantity::Length => sigma.length,
            Quantity::Angle => sigma.angle,
        };
        match SIGMAS.contains(&sigma) {
            true => Ok(sigma.recip()),
            false => Err(CalibrateError::Sigma(sigma)),
        }
    };
    columns.iter().map(of).collect()
}

/// Refuses measurements that say nothing of the parameters, by their derivatives: those by parameters that no pose makes up
/// for, and a basis of those by the pose of each row.
pub(crate) fn refuse_untold(
    problem: &Problem<'_>,
    reduced: &DMatrix<f64>,
    by_pose: &[DMatrix<f64>],
) -> Result<(), CalibrateError> {
    // A pose that makes up for every cell of its row leaves only rounding.
    if by_pose.iter().all(|basis| basis.nrows() <= basis.ncols()) {
        let pose = problem.nominal.manipulator.task_coordinates().len();
        return Err(CalibrateError::NoSurplus(pose));
    }
    match reduced.amax() == 0.0 {
        true => Err(CalibrateError::NothingTold),
        false => Ok(()),
    }
}

/// A fit that converged.
struct Fitted {
    identified: Identified,
    state: State,
    changes: Vec<f64>,
    derivatives: Derivatives,
    before: Vec<f64>,
}

impl Fitted {
    fn new(
        problem: &Problem<'_>,
        least: f64,
        watch: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Self, CalibrateError> {
        let start = problem.start();
        if start.rows.iter().all(Option::is_none) {
            return Err(CalibrateError::NoPose);
        }
        let before = residuals(&start);
        let singular = CalibrateError::NotConverged("a measured pose is singular");
        let derivatives = problem.derivatives(&start).ok_or(singular)?;
        let identified = Identified::new(&derivatives.reduced, least);
        refuse_untold(problem, &derivatives.reduced, &derivatives.by_pose)?;
        if identified.rank() == 0 {
            let error = identified.singular_values[0].recip();
            return Err(CalibrateError::Inaccurate { error, weakest: least.recip() });
        }
        let (state, changes) =
            problem.solve(start, &identified, watch).map_err(|error| match error {
                Unsolved::Stopped => CalibrateError::Stopped,
                Unsolved::Method(why) => CalibrateError::NotConverged(why),
            })?;
        let singular = CalibrateError::NotConverged("a measured pose is singular");
        let derivatives = problem.derivatives(&state).ok_or(singular)?;
        Ok(Self { identified, state, changes, derivatives, before })
    }

    fn report(&self, problem: &Problem<'_>, known: bool) -> Calibration {
        let (identified, derivatives) = (&self.identified, &self.derivatives);
        let residuals = DVector::from_vec(residuals(&self.state));
        let poses: usize = derivatives.by_pose.iter().map(DMatrix::ncols).sum();
        let surplus = residuals.len().saturating_sub(poses + identified.rank());
        let over = |sum: f64| (surplus > 0).then(|| (sum / surplus as f64).sqrt());
        let deviation = over(residuals.norm_squared());
        let leverages = leverages(derivatives, identified);
        let checked: Vec<Option<f64>> = residuals
            .iter()
            .zip(&leverages)
            .map(|(r, h)| (1.0 - h > LEAST_CHECKED).then(|| r / (1.0 - h).sqrt()))
            .collect();
        // One standard deviation; of unknown ones, what outliers do not change.
        let one =
            if known { 1.0 } else { ROBUST * median(checked.iter().flatten().map(|t| t.abs())) };
        let limit = outlier_limit(checked.iter().flatten().count());
        let scale = if known { 1.0 } else { deviation.unwrap_or(f64::NAN) };
        let (parameters, correlations) = self.estimates(problem, scale);
        let mut cells = Vec::new();
        let mut number = 0;
        for (row, solved) in self.state.rows.iter().enumerate() {
            let Some(solved) = solved else { continue };
            for (&column, residual) in solved.columns.iter().zip(&solved.residuals) {
                let studentised = checked[number].map(|t| -t / one).filter(|t| t.is_finite());
                cells.push(Cell {
                    row,
                    column,
                    measured: problem.rows[row][column].unwrap_or(f64::NAN),
                    residual: -residual / problem.weights[column],
                    studentised,
                    outlier: studentised.is_some_and(|t| t.abs() > limit),
                    rejected: false,
                });
                number += 1;
            }
        }
        let unused = (0..problem.rows.len()).filter(|&row| self.state.rows[row].is_none());
        let left = left_over(derivatives, identified, &residuals);
        Calibration {
            file: self.state.instance.made(),
            parameters,
            correlations,
            rank: identified.rank(),
            singular_values: identified.singular_values.clone(),
            held: identified.combinations(
                problem.parameters,
                problem.nominal.manipulator.characteristic_length(),
            ),
            cells,
            unused: unused.collect(),
            surplus,
            deviation,
            deviation_before: over(self.before.iter().map(|r| r * r).sum()),
            play: residual_play(
                problem,
                &self.state,
                derivatives,
                identified,
                &(left / scale),
                scale,
            ),
        }
    }

    fn estimates(&self, problem: &Problem<'_>, scale: f64) -> (Vec<Estimate>, DMatrix<f64>) {
        let (identified, units) = (&self.identified, problem.units());
        // The covariance of the directions that vary, then of all parameters.
        let own = &self.derivatives.reduced * &identified.determined;
        let svd = own.svd(false, true);
        let right = svd.v_t.expect("it was asked for").transpose();
        let inverse = DMatrix::from_diagonal(&svd.singular_values.map(|s| s.powi(-2)));
        let inner = &right * inverse * right.transpose();
        let covariance = &identified.determined * inner * identified.determined.transpose();
        let n = problem.parameters.len();
        let known: Vec<bool> = (0..n).map(|k| identified.identifiable(k)).collect();
        let estimates = problem.parameters.iter().enumerate().map(|(k, parameter)| Estimate {
            name: parameter.name.clone(),
            quantity: parameter.quantity,
            before: parameter.before,
            after: parameter.before + self.changes[k],
            standard_error: known[k].then(|| covariance[(k, k)].sqrt() * scale * units[k]),
            identifiable: known[k],
        });
        let correlation = |i: usize, j: usize| match (known[i] && known[j], i == j) {
            (false, _) => f64::NAN,
            (true, true) => 1.0,
            (true, false) => covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt(),
        };
        (estimates.collect(), DMatrix::from_fn(n, n, correlation))
    }

    /// Compares cells that took no part with what the calibrated mechanism shows.
    fn predict_rejected(&self, problem: &Problem<'_>, cells: &mut [Cell]) {
        let predictor = crate::prediction::Predictor {
            instance: &self.state.instance,
            columns: problem.columns,
            mode: problem.mode,
        };
        for cell in cells {
            let pose = self.state.rows[cell.row].as_ref().map(|row| &row.pose);
            let found = pose.and_then(|pose| predictor.at(pose, None));
            cell.residual =
                found.map_or(f64::NAN, |found| cell.measured - found.values[cell.column]);
        }
    }
}

/// A cell of which less than this share is left to check is not checked.
const LEAST_CHECKED: f64 = 1e-6;

/// The standard deviation of a normal distribution over the median of absolute values.
const ROBUST: f64 = 1.4826;

/// The probability that any cell of a table without outliers is called one.
const FALSE_ALARM: f64 = 0.01;

/// The studentised residual that none of so many cells exceeds by chance, but for [`FALSE_ALARM`]: by the bound
/// `P(|t| > x) <= 2 exp(-x²/2)`, for each of them.
fn outlier_limit(cells: usize) -> f64 {
    (2.0 * (2.0 * cells.max(1) as f64 / FALSE_ALARM).ln()).sqrt()
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
