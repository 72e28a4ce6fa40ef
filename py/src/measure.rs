//! Measures of the workspace with guaranteed bounds.

use crate::arguments;
use crate::columns::tabled;
use crate::error::{failed, wrong};
use crate::html::{self, digits};
use crate::interrupt;
use crate::manipulator::Manipulator;
use crate::parts::{Parts, Pickled};
use crate::sweep::modes;
use opm_workspace::measure::{
    self as workspace, Bounds, Cell, CoordinateRange, Domain, Evaluator, Goal, Measured, Search,
    SearchEnd,
};
use opm_workspace::{Modes, Progress, Sections};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyMapping};
use std::num::{NonZeroU64, NonZeroUsize};

/// Least number of boxes in each part except the last. That is 12 to 64 ms of work; another process takes
/// 3.5 ms to receive the boxes and to compile the manipulator. Smaller rounds are computed in this process.
const LEAST_BOXES: u64 = 1 << 12;

/// What is measured.
const SECTIONS: [(Sections, &str); 3] =
    [(Sections::Whole, "whole"), (Sections::Upper, "upper"), (Sections::Lower, "lower")];

/// The measure of the part of a box that is in reach and within all limits, with guaranteed bounds.
///
/// Its unit is the product of those of the coordinates with a range; a tilt is weighted with its sine, so that the measure
/// of orientations is the Haar measure.
#[pyclass(frozen, module = "opm_kinematics")]
pub struct Measure {
    found: Measured,
    /// Unit of the measure: ``"m^2"``, ``"m^2 rad^3"``, ``"1"``.
    units: String,
    /// Lowest and highest value of every coordinate.
    over: Vec<(String, f64, f64)>,
}

/// Why a computation stopped.
const STOPS: [(SearchEnd, &str); 4] = [
    (SearchEnd::Tolerance, "tolerance"),
    (SearchEnd::Budget, "budget"),
    (SearchEnd::Cancelled, "cancelled"),
    (SearchEnd::Exhausted, "exhausted"),
];

/// A measure as it is pickled: bounds and whole, boxes, why it stopped, units, ranges.
type MeasureState = ([f64; 3], u64, String, String, Vec<(String, f64, f64)>);

/// The range of a coordinate: one value, or the lowest and the highest.
#[derive(FromPyObject)]
enum Range {
    Fixed(f64),
    Between((f64, f64)),
}

/// Ranges of coordinates by their names: a number, or the lowest and the highest.
pub fn ranges(over: &Bound<'_, PyMapping>) -> PyResult<Vec<CoordinateRange>> {
    let given: Vec<(String, Bound<'_, PyAny>)> = over.items()?.extract()?;
    let ranges = given.into_iter().map(|(name, range)| match range.extract() {
        Ok(Range::Fixed(value)) => Ok(CoordinateRange::new(name, value, value)),
        // A range without width has measure zero: a mistake.
        Ok(Range::Between((min, max))) if min == max => {
            let found = range.repr()?;
            Err(wrong(format!(
                "{name} is {found}, expected min below max, or one value to hold it"
            )))
        }
        Ok(Range::Between((min, max))) => Ok(CoordinateRange::new(name, min, max)),
        Err(_) => {
            let found = range.repr()?;
            Err(wrong(format!("{name} is {found}, expected a number or (min, max)")))
        }
    });
    ranges.collect()
}

/// Measure the workspace, or how much of orientations or places one section alone reaches, with guaranteed bounds.
///
/// Parameters
/// ----------
/// manipulator : Manipulator
/// over : mapping, optional
///     For each coordinate ``(min, max)`` or one value; metres and radians. A coordinate that is not given stays at home. If
///     none is given, ranges are fitted to the workspace; for the upper section alone, every orientation is measured.
/// section : str
///     ``"whole"``: poses. ``"upper"`` or ``"lower"``: one section alone, as those kinds of :func:`sweep`.
/// mode : str
///     ``"home"``, ``"any"``, or a sign for every two-valued choice.
/// tolerance : float, optional
///     How far the true measure may be from the value, as a share of it: 0.01 if not given.
/// budget : int, optional
///     Largest number of boxes to examine: 500,000 if not given.
/// threads : int, optional
///     1 to 1024, here or in each worker; the result does not depend on it. One for each processor if not given.
/// executor : concurrent.futures.Executor or callable, optional
///     Where the boxes are examined, as for :func:`sweep`; the result is that of one process, to the bit. It gets the rounds of
///     more than 4096 boxes; smaller rounds are computed in this process, which also fits the ranges. An executor that a
///     function makes serves all rounds.
/// shards : int, optional
///     How many parts of a round the executor gets: as for :func:`sweep`, but each except the last has at least 4096 boxes.
///
/// Returns
/// -------
/// Measure
///     The value with its guaranteed bounds.
///
/// Raises
/// ------
/// OpmError
///     A coordinate is unknown; its ends are not numbers in order; the section or mode is unknown; or parts were lost
///     repeatedly.
#[pyfunction]
#[pyo3(signature = (
    manipulator, /, *, over = None, section = "whole", mode = "home", tolerance = None, budget = None,
    threads = None, executor = None, shards = None
))]
#[allow(clippy::too_many_arguments)]
pub fn measure(
    py: Python<'_>,
    manipulator: Py<Manipulator>,
    over: Option<&Bound<'_, PyMapping>>,
    section: &str,
    mode: &str,
    tolerance: Option<f64>,
    #[pyo3(from_py_with = arguments::budget)] budget: Option<u64>,
    #[pyo3(from_py_with = arguments::threads)] threads: Option<NonZeroUsize>,
    executor: Option<Bound<'_, PyAny>>,
    #[pyo3(from_py_with = arguments::shards)] shards: Option<NonZeroU64>,
) -> PyResult<Measure> {
    let given = over.map(ranges).transpose()?.unwrap_or_default();
    let modes = modes(manipulator.get(), mode)?;
    let query = Query { of: manipulator, sections: sections(section)?, modes, threads };
    let goal = goal(tolerance, budget)?;
    let parts = Parts::new(executor, shards)?;
    // Arguments are checked before the sweep that fits the ranges.
    query.domain(&given)?;
    let progress = Progress::default();
    let fit = || {
        let manipulator = &query.of.get().inner;
        workspace::default_ranges(manipulator, query.sections, query.modes, &given, &progress)
    };
    let fitted = interrupt::run(py, threads, fit, || progress.cancel())?;
    let (over, _) = fitted.map_err(|error| failed(&error))?;
    query.measured(py, &over, goal, parts)
}

/// The section with this name, or both.
fn sections(word: &str) -> PyResult<Sections> {
    let known = SECTIONS.iter().find(|(_, known)| *known == word);
    let words = || SECTIONS.map(|(_, word)| word).join(", ");
    let unknown = || wrong(format!("section is {word:?}, expected one of {}", words()));
    known.map(|(sections, _)| *sections).ok_or_else(unknown)
}

/// The names of the sections.
fn word(sections: Sections) -> &'static str {
    let word = SECTIONS.iter().find(|(known, _)| *known == sections);
    word.map_or("", |(_, word)| word)
}

/// The goal, with defaults for arguments that are not given.
pub fn goal(tolerance: Option<f64>, budget: Option<u64>) -> PyResult<Goal> {
    let usual = Goal::default();
    let tolerance = tolerance.unwrap_or(usual.tolerance);
    workspace::check_tolerance(tolerance)
        .map_err(|expected| wrong(format!("tolerance is {tolerance:?}, {expected}")))?;
    Ok(Goal { tolerance, budget: budget.unwrap_or(usual.budget) })
}

/// What is measured, apart from the ranges of the coordinates.
pub struct Query {
    pub of: Py<Manipulator>,
    pub sections: Sections,
    pub modes: Modes,
    pub threads: Option<NonZeroUsize>,
}

impl Query {
    fn domain(&self, over: &[CoordinateRange]) -> PyResult<Domain> {
        let domain = Domain::new(&self.of.get().inner, self.sections, over);
        domain.map_err(|error| failed(&error))
    }

    /// Measures over these ranges.
    pub fn measured(
        self,
        py: Python<'_>,
        over: &[CoordinateRange],
        goal: Goal,
        parts: Option<Parts<'_>>,
    ) -> PyResult<Measure> {
        let domain = self.domain(over)?;
        let found = match parts {
            None => {
                let (manipulator, progress) = (&self.of.get().inner, Progress::default());
                let work =
                    || workspace::measure(manipulator, &domain, self.modes, &goal, &progress);
                interrupt::run(py, self.threads, work, || progress.cancel())?
            }
            Some(parts) => {
                let boxes = Bound::new(py, Boxes { query: self, domain: domain.clone() })?;
                parts.session(py, |workers| boxes_searched(&boxes, goal, &parts, workers))?
            }
        };
        Ok(Measure::new(found, &domain))
    }
}

/// Measures with workers, which examine the boxes of large rounds.
fn boxes_searched(
    boxes: &Bound<'_, Boxes>,
    goal: Goal,
    parts: &Parts<'_>,
    workers: &Bound<'_, PyAny>,
) -> PyResult<Measured> {
    let (py, this) = (boxes.py(), boxes.get());
    let mut search = Search::new(&this.domain, goal);
    while let Some(cells) = py.detach(|| search.round()) {
        let count = parts.count(workers, cells.len() as u64, LEAST_BOXES)? as usize;
        let bounds = if count == 1 {
            this.bounds(py, cells)?
        } else {
            let part = cells.len().div_ceil(count);
            let packed = cells.chunks(part).map(|part| {
                let bytes: Vec<u8> = part.iter().flat_map(Cell::pack).collect();
                (PyBytes::new(py, &bytes),)
            });
            let packed: Vec<_> = packed.collect();
            let known: Vec<Bound<'_, PyBytes>> =
                workers.call_method1("run", (boxes, "_ask", packed))?.extract()?;
            let known = known.iter().flat_map(|part| part.as_bytes().as_chunks().0);
            known.map(Bounds::unpack).collect()
        };
        py.detach(|| search.answer(bounds)).map_err(|error| failed(&error))?;
    }
    Ok(search.found())
}

/// The boxes of a domain, which workers examine in parts.
#[pyclass(frozen, name = "_Boxes", module = "opm_kinematics._native")]
pub struct Boxes {
    query: Query,
    domain: Domain,
}

impl Boxes {
    fn bounds(&self, py: Python<'_>, cells: &[Cell]) -> PyResult<Vec<Bounds>> {
        let (query, progress) = (&self.query, Progress::default());
        let evaluator = Evaluator::new(&query.of.get().inner, &self.domain, query.modes);
        let work = || evaluator.evaluate(cells, &progress);
        let known = interrupt::run(py, query.threads, work, || progress.cancel())?;
        known.map_err(|error| failed(&error))
    }
}

/// A domain as it is pickled: section, mode, ranges, threads.
type Spec = (String, String, Vec<(String, f64, f64)>, Option<NonZeroUsize>);

#[pymethods]
impl Boxes {
    /// The bounds on packed boxes, packed too.
    fn _ask<'py>(&self, py: Python<'py>, cells: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        let cells: Vec<Cell> = cells.as_chunks().0.iter().map(Cell::unpack).collect();
        let known: Vec<u8> = self.bounds(py, &cells)?.iter().flat_map(Bounds::pack).collect();
        Ok(PyBytes::new(py, &known))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py, (Py<Manipulator>, Spec)>> {
        let Self { query: Query { of, sections, modes, threads }, domain } = slf.get();
        let mode = match modes {
            Modes::Any => "any".to_owned(),
            Modes::One(mode) => of.get().inner.format_mode(*mode),
        };
        let over = domain.axes().iter().map(|axis| (axis.name.clone(), axis.min, axis.max));
        let spec = (word(*sections).to_owned(), mode, over.collect(), *threads);
        Ok((slf.get_type().getattr("_restored")?, (of.clone_ref(slf.py()), spec)))
    }

    #[staticmethod]
    fn _restored(of: Py<Manipulator>, spec: Spec) -> PyResult<Self> {
        let (section, mode, over, threads) = spec;
        let over = over.into_iter().map(|(name, min, max)| CoordinateRange::new(name, min, max));
        let (sections, modes) = (sections(&section)?, modes(of.get(), &mode)?);
        let query = Query { of, sections, modes, threads };
        let domain = query.domain(&over.collect::<Vec<_>>())?;
        Ok(Self { query, domain })
    }
}

tabled!(Measure);

#[pymethods]
impl Measure {
    /// The middle of the bounds.
    #[getter]
    fn value(&self) -> f64 {
        self.found.value()
    }

    /// Lower bound of the measure.
    #[getter]
    fn lower(&self) -> f64 {
        self.found.lower
    }

    /// Upper bound of the measure.
    #[getter]
    fn upper(&self) -> f64 {
        self.found.upper
    }

    /// The measure of the whole box.
    #[getter]
    fn whole(&self) -> f64 {
        self.found.whole
    }

    /// ``value / whole``.
    #[getter]
    fn fraction(&self) -> f64 {
        self.found.fraction()
    }

    /// Unit of the measure: ``"m^2"``, ``"m^2 rad^3"``, ``"1"``.
    #[getter]
    fn units(&self) -> &str {
        &self.units
    }

    /// Number of boxes that were examined.
    #[getter]
    fn boxes(&self) -> u64 {
        self.found.boxes
    }

    /// Why the computation stopped: ``"tolerance"`` is met, ``"budget"`` is used up, or ``"exhausted"`` where splitting brings
    /// the bounds no closer.
    #[getter]
    fn stop(&self) -> &'static str {
        let word = STOPS.iter().find(|(stop, _)| *stop == self.found.stop);
        word.map_or("", |(_, word)| word)
    }

    /// Lowest and highest value of every coordinate, or the value at which it is held, as :func:`measure` takes them.
    #[getter]
    fn over<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, min, max) in &self.over {
            match min == max {
                true => dict.set_item(name, min)?,
                false => dict.set_item(name, (min, max))?,
            }
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        let (found, units) = (&self.found, &self.units);
        let numbers = [found.value(), found.lower, found.upper, found.fraction()];
        let [value, low, high, share] = numbers.map(digits);
        format!("<Measure {value} {units}, from {low} to {high}: {share} of the box>")
    }

    /// Measures are equal if their ranges, bounds and numbers of boxes are equal.
    fn __eq__(&self, other: &Self) -> bool {
        (&self.found, &self.units, &self.over) == (&other.found, &other.units, &other.over)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        html::of(slf, "measure")
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Pickled<'py, MeasureState>> {
        let this = slf.get();
        let Measured { lower, upper, whole, boxes, .. } = this.found;
        let (stop, units) = (this.stop().to_owned(), this.units.clone());
        let state = ([lower, upper, whole], boxes, stop, units, this.over.clone());
        Ok((slf.get_type().getattr("_restored")?, state))
    }

    #[staticmethod]
    fn _restored(
        bounds: [f64; 3],
        boxes: u64,
        stop: &str,
        units: String,
        over: Vec<(String, f64, f64)>,
    ) -> PyResult<Self> {
        let known = STOPS.iter().find(|(_, word)| *word == stop);
        let stop = known.map(|(stop, _)| *stop);
        let stop = stop.ok_or_else(|| wrong("no measure is in the pickle"))?;
        let [lower, upper, whole] = bounds;
        Ok(Self { found: Measured { lower, upper, whole, boxes, stop }, units, over })
    }
}

impl Measure {
    fn new(found: Measured, domain: &Domain) -> Self {
        let powers = domain.powers().into_iter().filter(|(_, power)| *power > 0);
        let units = powers.map(|(quantity, power)| match power {
            1 => quantity.unit().to_owned(),
            _ => format!("{}^{power}", quantity.unit()),
        });
        let units: Vec<_> = units.collect();
        let units = if units.is_empty() { "1".to_owned() } else { units.join(" ") };
        let over = domain.axes().iter().map(|axis| (axis.name.clone(), axis.min, axis.max));
        Self { found, units, over: over.collect() }
    }
}
