//! A certificate for a mechanism, and recordings that were cut short.

use crate::arguments;
use crate::columns::tabled;
use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::pickle::pickled;
use opm_check::{Comparison as Compared, Options, check};
use opm_mcap::RecoverError;
use opm_mcap::input::is_same_file;
use opm_study::recording::recovered_name;
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// What was held of a mechanism, and to what: the result of :meth:`Manipulator.check`.
#[pyclass(frozen, get_all, module = "opm_kinematics")]
pub struct Certificate {
    /// Name of the mechanism.
    name: String,
    /// Random poses of each comparison.
    samples: u32,
    /// Seed of the random poses.
    seed: u64,
    /// Whether every comparison holds.
    holds: bool,
    /// Every kind of comparison.
    comparisons: Vec<Comparison>,
}

/// One kind of comparison of a :class:`Certificate`.
#[pyclass(frozen, get_all, from_py_object, module = "opm_kinematics")]
#[derive(Clone)]
pub struct Comparison {
    /// ``"closure"``, ``"branches"``, ``"derivatives"``, ``"rows"`` or ``"forward"``.
    name: String,
    /// What was compared with what.
    what: String,
    /// Whether all that was compared agrees.
    holds: bool,
    /// The number of comparisons that were made.
    compared: u64,
    /// The number that was left out, because the two cannot be expected to agree.
    left_out: u64,
    /// Why some were left out.
    because: Option<String>,
    /// The largest difference, if it is one of numbers.
    worst: Option<f64>,
    /// The largest difference that is allowed.
    tolerance: Option<f64>,
    /// The first comparison that does not hold: what differs, and where.
    problem: Option<String>,
}

tabled!(Certificate);

pickled!(Certificate { name, samples, seed, holds, comparisons });
pickled!(Comparison { name, what, holds, compared, left_out, because, worst, tolerance, problem });

impl Comparison {
    fn new(found: &Compared) -> Self {
        Self {
            name: found.name.to_owned(),
            what: found.what.to_owned(),
            holds: found.holds(),
            compared: found.compared,
            left_out: found.left_out,
            because: found.because.clone(),
            worst: found.worst,
            tolerance: found.tolerance,
            problem: found.problem.clone(),
        }
    }
}

#[pymethods]
impl Certificate {
    fn __repr__(&self) -> String {
        let state = if self.holds { "everything compared holds" } else { "not everything holds" };
        format!("<Certificate of {}: {state}, {} samples>", self.name, self.samples)
    }
}

#[pymethods]
impl Comparison {
    fn __repr__(&self) -> String {
        let state = match (&self.problem, self.compared) {
            (Some(problem), _) => format!("does not hold: {problem}"),
            (None, 0) => "not compared".to_owned(),
            (None, compared) => format!("holds, {compared} compared, {} left out", self.left_out),
        };
        format!("<Comparison {}: {state}>", self.name)
    }
}

#[pymethods]
impl Manipulator {
    /// Hold the closed forms of the mechanism to independent computations at random poses.
    ///
    /// Closures of the undecomposed legs, numbers of branches against a numeric solver, derivatives against differences, rows
    /// of sweeps against inverse kinematics of every pose, forward kinematics against the poses that joint values came
    /// from. It is what ``opm check`` prints.
    ///
    /// Parameters
    /// ----------
    /// samples : int
    ///     Random poses of each comparison.
    /// seed : int
    ///     Seed of the random poses: the same one gives the same certificate.
    ///
    /// Returns
    /// -------
    /// Certificate
    ///     What was held, and to what.
    ///
    /// Raises
    /// ------
    /// OpmError
    ///     There are no samples.
    ///
    /// Examples
    /// --------
    /// >>> import opm_kinematics as opm
    /// >>> opm.examples.load("planar-3rrr").check(samples=20)
    /// <Certificate of planar-3rrr: everything compared holds, 20 samples>
    #[pyo3(signature = (*, samples = 200, seed = 1))]
    fn check(&self, py: Python<'_>, samples: u32, seed: u64) -> PyResult<Certificate> {
        if samples == 0 {
            return Err(wrong("samples is 0, expected a whole number of at least 1"));
        }
        let stop = AtomicBool::new(false);
        let options = Options { samples, seed };
        let work = || check(&self.inner, &options, |_| !stop.load(Ordering::Relaxed));
        let stopped = || stop.store(true, Ordering::Relaxed);
        let found = interrupt::run(py, NonZeroUsize::new(1), work, stopped)?;
        let found = found.ok_or_else(|| wrong("the check was interrupted"))?;
        Ok(Certificate {
            holds: found.holds(),
            comparisons: found.comparisons.iter().map(Comparison::new).collect(),
            name: found.name,
            samples,
            seed,
        })
    }
}

/// Recover a recording that was cut short, as far as it goes.
///
/// A run that is killed, or whose disk is full, leaves a ``.partial`` file. What it holds is copied into a recording that every
/// viewer opens, and that says that it is not whole. It is what ``opm recover`` does.
///
/// Parameters
/// ----------
/// path : path
///     The MCAP file that was cut short.
/// output : path, optional
///     The file to write; ``NAME.recovered.mcap``, beside it, if not given.
///
/// Returns
/// -------
/// str
///     Name of the file that was written.
///
/// Raises
/// ------
/// OpmError
///     The file cannot be read or written, is not MCAP, is whole, or is still being written.
#[pyfunction]
#[pyo3(signature = (path, output = None))]
pub fn recover(
    py: Python<'_>,
    #[pyo3(from_py_with = arguments::path)] path: PathBuf,
    output: Option<Bound<'_, PyAny>>,
) -> PyResult<String> {
    let target = match &output {
        Some(output) => arguments::path(output).map_err(|_| {
            wrong(format!("output is {}, expected a path", arguments::shown(output)))
        })?,
        None => recovered_name(&path),
    };
    if !target.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) {
        return Err(wrong(format!(
            "output is {}, expected a name that ends in .mcap",
            target.display()
        )));
    }
    if target == path || is_same_file(&target, &path) {
        return Err(wrong(format!("output is {}, the file to recover", path.display())));
    }
    let done = py.detach(|| opm_mcap::recover(&path, &target));
    done.map_err(|error| match error {
        RecoverError::Whole | RecoverError::Busy => wrong(format!("{}: {error}", path.display())),
        error => failed(&error),
    })?;
    Ok(target.display().to_string())
}
