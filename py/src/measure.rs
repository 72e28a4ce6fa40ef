//! Measures of the workspace with guaranteed bounds.

use crate::error::{failed, wrong};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::sweep::{modes, sections};
use opm_core::manipulator as core;
use opm_workspace::measure::{self as workspace, Domain, Goal, Over, Stop};
use opm_workspace::{Cancelled, Modes, Progress, Sections};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

/// How much of a box is in reach, between two bounds.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Measure {
    found: workspace::Measured,
    domain: Domain,
}

/// A value, or lowest and highest value.
#[derive(FromPyObject)]
enum Range {
    Fixed(f64),
    Between((f64, f64)),
}

/// Measures the workspace over a box: `measure(m, over={"x": (min, max), "y": value})`.
#[pyfunction]
#[pyo3(signature = (
    manipulator, /, *, over = None, section = "whole", mode = "home", tolerance = None, budget = None,
    threads = None
))]
#[allow(clippy::too_many_arguments)]
pub fn measure(
    py: Python<'_>,
    manipulator: &Manipulator,
    over: Option<BTreeMap<String, Bound<'_, PyAny>>>,
    section: &str,
    mode: &str,
    tolerance: Option<f64>,
    budget: Option<u64>,
    threads: Option<NonZeroUsize>,
) -> PyResult<Measure> {
    let given = over.unwrap_or_default().into_iter().map(|(name, range)| match range.extract() {
        Ok(Range::Fixed(value)) => Ok(Over::new(name, value, value)),
        Ok(Range::Between((min, max))) => Ok(Over::new(name, min, max)),
        Err(_) => {
            let found = range.repr()?;
            Err(wrong(format!("{name} is {found}, expected a number or (min, max)")))
        }
    });
    let given: Vec<Over> = given.collect::<PyResult<_>>()?;
    let asked = (sections(section)?, modes(manipulator, mode)?);
    measured(py, &manipulator.inner, asked, &given, goal(tolerance, budget)?, threads)
}

/// The goal with what is not given as it is by default.
pub fn goal(tolerance: Option<f64>, budget: Option<u64>) -> PyResult<Goal> {
    let usual = Goal::default();
    let tolerance = tolerance.unwrap_or(usual.tolerance);
    if !(tolerance.is_finite() && tolerance >= 0.0) {
        return Err(wrong(format!("tolerance is {tolerance}, expected a number of at least 0")));
    }
    Ok(Goal { tolerance, budget: budget.unwrap_or(usual.budget) })
}

/// Measures over what is given, or over what fits where nothing is.
pub fn measured(
    py: Python<'_>,
    manipulator: &core::Manipulator,
    (sections, modes): (Sections, Modes),
    given: &[Over],
    goal: Goal,
    threads: Option<NonZeroUsize>,
) -> PyResult<Measure> {
    let progress = Progress::default();
    let work = || -> Result<Result<Measure, workspace::DomainError>, Cancelled> {
        // What is given is looked at first: a wrong name need not wait for a sweep.
        if let Err(error) = Domain::new(manipulator, sections, given) {
            return Ok(Err(error));
        }
        let (over, _) = workspace::ranges(manipulator, sections, modes, given, &progress)?;
        Ok(Domain::new(manipulator, sections, &over).map(|domain| {
            let found = workspace::measure(manipulator, &domain, modes, &goal, &progress);
            Measure { found, domain }
        }))
    };
    let done = interrupt::run(py, threads, work, || progress.cancel())?;
    done.map_err(|error| failed(&error))?.map_err(|error| failed(&error))
}

#[pymethods]
impl Measure {
    /// The middle of the bounds.
    #[getter]
    fn value(&self) -> f64 {
        self.found.value()
    }

    /// The measure is not less.
    #[getter]
    fn lower(&self) -> f64 {
        self.found.lower
    }

    /// The measure is not more.
    #[getter]
    fn upper(&self) -> f64 {
        self.found.upper
    }

    /// The measure of the whole box.
    #[getter]
    fn whole(&self) -> f64 {
        self.found.whole
    }

    /// `value / whole`.
    #[getter]
    fn fraction(&self) -> f64 {
        self.found.fraction()
    }

    /// What the measure is in: `m^2`, `rad^3`, `1`.
    #[getter]
    fn units(&self) -> String {
        let powers = self.domain.powers().into_iter().filter(|(_, power)| *power > 0);
        let units = powers.map(|(quantity, power)| match power {
            1 => quantity.unit().to_owned(),
            _ => format!("{}^{power}", quantity.unit()),
        });
        let units: Vec<_> = units.collect();
        if units.is_empty() { "1".to_owned() } else { units.join(" ") }
    }

    /// Boxes that were looked at.
    #[getter]
    fn boxes(&self) -> u64 {
        self.found.boxes
    }

    /// Why it was taken no further.
    #[getter]
    fn stop(&self) -> &'static str {
        match self.found.stop {
            Stop::Tolerance => "tolerance",
            Stop::Budget => "budget",
            Stop::Cancelled => "cancelled",
            Stop::Exhausted => "exhausted",
        }
    }

    /// The ranges that it is over, by name.
    #[getter]
    fn over<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for axis in self.domain.axes() {
            dict.set_item(&axis.name, (axis.min, axis.max))?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let (found, units) = (&self.found, self.units());
        let [low, high] = [found.lower, found.upper];
        format!(
            "<Measure {:?} {units}, from {low:?} to {high:?}: {:?} of the box>",
            found.value(),
            found.fraction()
        )
    }
}
