//! Calibration from measurements.

use crate::arguments;
use crate::columns::tabled;
use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::pickle::{frozen, pickled};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use opm_calibrate::{
    BasePoint, CalibrateError, Column, Measurements, Options, Sigma, calibrate as run,
};
use opm_core::mechanism::file;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};

/// What a calibration found. Metres and radians.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Calibration {
    /// The calibrated mechanism.
    manipulator: Py<Manipulator>,
    /// Names of the parameters that might vary: those of :attr:`Manipulator.parameters`, ``leg4.base.x`` of a point, or places
    /// of joints of a list, ``leg1.r1.offset.1``.
    parameters: Vec<String>,
    /// (p,): values in the file; zero for a displacement of an axis.
    before: Py<PyArray1<f64>>,
    /// (p,): calibrated values.
    after: Py<PyArray1<f64>>,
    /// (p,): standard errors; NaN where the measurements do not determine the parameter.
    standard_errors: Py<PyArray1<f64>>,
    /// (p,): whether the measurements determine the parameter.
    identifiable: Py<PyArray1<bool>>,
    /// (p, p): correlations of the parameters; NaN where one is not determined.
    correlations: Py<PyArray2<f64>>,
    /// Number of independent combinations of parameters that the measurements determine.
    rank: usize,
    /// (p,): singular values of the weighted derivatives, largest first; with `sigma` each is one over the standard error of a
    /// combination, in radians and units of the characteristic length.
    singular_values: Py<PyArray1<f64>>,
    /// Combinations that are not determined and keep their values: names with changes, the first of which is one.
    held: Vec<Vec<(String, f64)>>,
    /// Names of the measured columns.
    columns: Vec<String>,
    /// (n, c): measured less predicted; NaN where nothing was measured.
    residuals: Py<PyArray2<f64>>,
    /// (n, c): residuals over their own standard deviations; NaN where no other measurement checks one.
    studentised: Py<PyArray2<f64>>,
    /// (n, c): whether a residual is too large for chance.
    outliers: Py<PyArray2<bool>>,
    /// (n, c): whether a cell was left out by `reject_outliers`.
    rejected: Py<PyArray2<bool>>,
    /// Numbers of the rows that took no part: no pose in reach comes near.
    unused: Vec<usize>,
    /// Number of measured values in excess of what poses and parameters take up.
    surplus: usize,
    /// Root of the sum of squared residuals over the surplus: about 1 if `sigma` is right, and an estimate of it without. None
    /// without surplus.
    deviation: Option<f64>,
    /// The same with the values of the file.
    deviation_before: Option<f64>,
    /// How many combinations of errors that leave the class the residuals show beyond chance.
    play_combinations: usize,
    /// (length, angle) by the name of each joint: the play that it needs at least.
    play: BTreeMap<String, (f64, f64)>,
}

tabled!(Calibration);

pickled!(Calibration {
    manipulator,
    parameters,
    before,
    after,
    standard_errors,
    identifiable,
    correlations,
    rank,
    singular_values,
    held,
    columns,
    residuals,
    studentised,
    outliers,
    rejected,
    unused,
    surplus,
    deviation,
    deviation_before,
    play_combinations,
    play,
});

#[pymethods]
impl Calibration {
    fn __repr__(&self) -> String {
        let (rank, count) = (self.rank, self.parameters.len());
        let deviation = self.deviation.map_or_else(|| "None".to_owned(), |d| format!("{d:.4}"));
        format!("<Calibration of {count} parameters: rank {rank}, deviation {deviation}>")
    }
}

fn sigma(given: Option<(f64, f64)>) -> Option<Sigma> {
    given.map(|(length, angle)| Sigma { length, angle })
}

/// The numbers of a column; NaN is not measured.
fn column(name: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<Option<f64>>> {
    let numbers = arguments::list(given, name)?;
    Ok(numbers.into_iter().map(|value| (!value.is_nan()).then_some(value)).collect())
}

/// Calibrate a mechanism: its parameters, joint places and encoder offsets from measured poses and joints.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
/// measurements : mapping
///     A dictionary or a DataFrame: one sequence for each column by its name, all of the same length; NaN where nothing was measured. Columns are task
///     coordinates (``x``), actuated joints (``S1``: what the encoder shows), ``point.x``, ``point.y``, ``point.z`` (the platform's
///     reference point), ``distance.NAME`` (its distance from one of `points`), ``incline.x``, ``incline.y`` (how far the platform's
///     axes rise). Metres and radians.
/// sigma : (float, float), optional
///     Standard deviations of measured lengths and angles. Without them all cells weigh the same, lengths in units of the
///     characteristic length, and the deviation is estimated.
/// joint_sigma : (float, float), optional
///     Those of actuated joints, if they are others.
/// points : mapping, optional
///     Points (x, y, z) of the base by name, for columns ``distance.NAME``.
/// only : sequence of str, optional
///     Calibrate only parameters whose names have these words: ``leg1``, ``home``, ``leg1.h``.
/// hold : sequence of str, optional
///     Hold parameters whose names have these words.
/// reject_outliers : bool
///     Leave out outliers, the worst first, until there are none.
/// weakest : float
///     With `sigma`, hold combinations whose standard error would be larger than this, in radians and units of the
///     characteristic length.
/// mode : str
///     Working mode of all measurements.
///
/// Returns
/// -------
/// Calibration
///     The corrected mechanism, its parameters with their standard errors, and what the measurements leave.
///
/// Raises
/// ------
/// OpmError
///     A column or a parameter is unknown, or the measurements say nothing.
#[pyfunction]
#[pyo3(signature = (manipulator, measurements, *, sigma = None, joint_sigma = None, points = None, only = None, hold = None,
    reject_outliers = false, weakest = 0.05, mode = "home"))]
#[allow(clippy::too_many_arguments)]
pub fn calibrate(
    py: Python<'_>,
    manipulator: &Manipulator,
    measurements: &Bound<'_, PyAny>,
    sigma: Option<(f64, f64)>,
    joint_sigma: Option<(f64, f64)>,
    points: Option<BTreeMap<String, [f64; 3]>>,
    only: Option<Vec<String>>,
    hold: Option<Vec<String>>,
    reject_outliers: bool,
    weakest: f64,
    mode: &str,
) -> PyResult<Calibration> {
    let core = &manipulator.inner;
    let points = points.unwrap_or_default().into_iter();
    let points: Vec<BasePoint> =
        points.map(|(name, at)| BasePoint { name, at: at.into() }).collect();
    let mut columns = Vec::new();
    let mut values: Vec<Vec<Option<f64>>> = Vec::new();
    // A dictionary, or a table of pandas or polars.
    let items = measurements.getattr_opt("items")?.ok_or_else(|| {
        let expected = "a mapping or a table of columns by name";
        wrong(format!("measurements is {}, expected {expected}", arguments::shown(measurements)))
    })?;
    for item in items.call0()?.try_iter()? {
        let (name, given): (String, Bound<'_, PyAny>) = item?.extract()?;
        columns.push(Column::named(&name, core, &points).map_err(wrong)?);
        let own = column(&name, &given)?;
        if let Some(first) = values.first()
            && first.len() != own.len()
        {
            let (found, expected) = (own.len(), first.len());
            return Err(wrong(format!("{name} has {found} values, expected {expected}")));
        }
        values.push(own);
    }
    let count = values.first().map_or(0, Vec::len);
    let rows: Vec<Vec<Option<f64>>> =
        (0..count).map(|row| values.iter().map(|column| column[row]).collect()).collect();
    if !(weakest > 0.0 && weakest.is_finite()) {
        return Err(wrong(format!("weakest is {weakest:?}, expected a positive number")));
    }
    let mode = match mode {
        "home" => core.home_mode(),
        signs => core.parse_mode(signs).map_err(|error| failed(&error))?,
    };
    let options = Options {
        mode: Some(mode),
        sigma: self::sigma(sigma),
        joint_sigma: self::sigma(joint_sigma),
        only: only.unwrap_or_default(),
        hold: hold.unwrap_or_default(),
        reject_outliers,
        weakest,
    };
    let read = file::read(manipulator.text()).map_err(|errors| wrong(errors.to_string()))?;
    let measured = Measurements { columns, rows };
    let stopped = AtomicBool::new(false);
    let work = || run(&read, &measured, &options, &mut |_| !stopped.load(Ordering::Relaxed));
    let cancel = || stopped.store(true, Ordering::Relaxed);
    let found = interrupt::run(py, None, work, cancel)?;
    let found = found.map_err(|error: CalibrateError| failed(&error))?;
    let names: Vec<String> = measured.columns.iter().map(|column| column.name.clone()).collect();
    let width = names.len();
    let table = |value: &dyn Fn(&opm_calibrate::Cell) -> f64| {
        let mut all = vec![f64::NAN; count * width];
        for cell in &found.cells {
            all[cell.row * width + cell.column] = value(cell);
        }
        frozen(all.into_pyarray(py).reshape([count, width])?)
    };
    let marks = |value: &dyn Fn(&opm_calibrate::Cell) -> bool| {
        let mut all = vec![false; count * width];
        for cell in &found.cells {
            all[cell.row * width + cell.column] = value(cell);
        }
        frozen(all.into_pyarray(py).reshape([count, width])?)
    };
    let of = |value: &dyn Fn(&opm_calibrate::Estimate) -> f64| {
        frozen(found.parameters.iter().map(value).collect::<Vec<f64>>().into_pyarray(py))
    };
    let p = found.parameters.len();
    let known: Vec<bool> = found.parameters.iter().map(|estimate| estimate.identifiable).collect();
    let correlations: Vec<f64> = found.correlations.transpose().as_slice().to_vec();
    let calibrated = Manipulator::compile(found.file.clone(), found.text(), "calibrated".into())?;
    let held = found.held.iter().map(|combination| combination.terms.clone());
    let play = found.play.joints.iter();
    Ok(Calibration {
        manipulator: Py::new(py, calibrated)?,
        parameters: found.parameters.iter().map(|estimate| estimate.name.clone()).collect(),
        before: of(&|estimate| estimate.before)?,
        after: of(&|estimate| estimate.after)?,
        standard_errors: of(&|estimate| estimate.standard_error.unwrap_or(f64::NAN))?,
        identifiable: frozen(known.into_pyarray(py))?,
        correlations: frozen(correlations.into_pyarray(py).reshape([p, p])?)?,
        rank: found.rank,
        singular_values: frozen(found.singular_values.clone().into_pyarray(py))?,
        held: held.collect(),
        residuals: table(&|cell| cell.residual)?,
        studentised: table(&|cell| cell.studentised.unwrap_or(f64::NAN))?,
        outliers: marks(&|cell| cell.outlier)?,
        rejected: marks(&|cell| cell.rejected)?,
        columns: names,
        unused: found.unused.clone(),
        surplus: found.surplus,
        deviation: found.deviation,
        deviation_before: found.deviation_before,
        play_combinations: found.play.combinations,
        play: play.map(|joint| (joint.name.clone(), (joint.length, joint.angle))).collect(),
    })
}
