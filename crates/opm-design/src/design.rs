//! The design of a problem: what is evaluated, and what is found.

use crate::evaluate::{self, Ranges, Upper, Value};
use crate::judge::Judged;
use crate::log::{Columns, Log, LogError, fingerprint};
use crate::measure::Measure;
use crate::problem::{Problem, Variable, Variables, changed, numbers, scalars, shares};
use crate::smooth::sample;
use crate::{optimise, polish};
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::MechanismFile;
use opm_workspace::{Axis, Cancelled, Progress};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Weight of the mean width of the imaginary joints' ranges, per radian or metre, beside an orientation out of reach.
const WIDTH: f64 = 0.01;

/// How far a design has come, and the request to stop it.
#[derive(Debug, Default)]
pub struct Watch {
    /// Cancels the design.
    pub progress: Arc<Progress>,
    evaluated: AtomicU64,
}

impl Watch {
    /// Of a design that this progress cancels.
    pub fn new(progress: Arc<Progress>) -> Self {
        Self { progress, evaluated: AtomicU64::new(0) }
    }

    /// How many designs have been evaluated.
    pub fn evaluated(&self) -> u64 {
        self.evaluated.load(Ordering::Relaxed)
    }
}

/// Why there is no design.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DesignError {
    /// It was stopped.
    #[error("cancelled")]
    Cancelled,
    /// The table of evaluations cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The upper section reaches no orientation, so that nothing is known of what the lower one has to do.
    #[error(
        "the upper section reaches none of the orientations in {evaluations} designs; expected a larger budget or other bounds"
    )]
    NothingReached {
        /// How many designs of the upper section were evaluated.
        evaluations: u64,
    },
    /// No design assembles.
    #[error("none of {evaluations} designs assembles; expected other bounds")]
    NothingAssembles {
        /// How many designs were evaluated.
        evaluations: u64,
    },
}

impl From<Cancelled> for DesignError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// A mechanism that was designed.
#[derive(Clone, Debug)]
pub struct Design {
    /// The mechanism.
    pub file: MechanismFile,
    /// The numbers of all variables, metres and radians, in the order of [`Variables::all`].
    pub variables: Vec<f64>,
    /// The value of each measure ([`Problem::measures`]) of the whole mechanism.
    pub values: Vec<f64>,
    /// Whether it keeps all constraints.
    pub feasible: bool,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// The best design of one objective; the front of two, in the order of the first objective, the best first.
    pub designs: Vec<Design>,
    /// The values of the mechanism as it was given.
    pub before: Option<Vec<f64>>,
    /// The ranges of the imaginary joints, by name, that the lower section was designed for; none if all was designed at once.
    pub ranges: Ranges,
    /// How many designs the search evaluated: of the upper section, and of the lower section or the whole.
    pub evaluations: [u64; 2],
    /// What polishing did, where the objective is smooth ([`Problem::is_polished`]).
    pub polished: Option<Polished>,
}

/// What polishing the best design by rates did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polished {
    /// How many designs it evaluated, beside those of the search.
    pub evaluations: u64,
    /// The value of the objective that the search had found.
    pub from: f64,
    /// The value after it, which is as good or better, or that of a design that keeps the constraints better.
    pub to: f64,
}

/// What a design is evaluated for.
#[derive(Clone, Copy)]
enum Stage<'a> {
    /// The upper section alone.
    Upper,
    /// The lower section for these values of the imaginary joints, behind an upper section with these numbers.
    Lower { above: &'a [f64], cuts: &'a [Axis] },
    /// Everything.
    Whole,
}

impl Stage<'_> {
    fn name(self) -> &'static str {
        match self {
            Self::Upper => "upper",
            Self::Lower { .. } => "lower",
            Self::Whole => "whole",
        }
    }
}

/// The columns of the upper section's numbers: the share of the orientations in reach, and the mean width of the imaginary
/// joints' ranges. The ranges follow.
const UPPER: [&str; 2] = ["orientations", "width"];

/// The columns of a problem's table of evaluations. The fingerprint is that of all that decides on an evaluation: not of
/// the budget and the seed, so that another run of the same problem uses what is known.
pub fn columns(problem: &Problem, file: &MechanismFile) -> Columns {
    let fixed = Problem { budget: 0, seed: 0, ..problem.clone() };
    let variables = problem.variables.all().into_iter().flat_map(Variable::components).collect();
    let mut numbers = Vec::new();
    if matches!(problem.variables, Variables::Sections { .. }) {
        numbers.extend(UPPER.map(str::to_owned));
        if let Ok(manipulator) = Manipulator::new(file.mechanism.clone()) {
            let ends = |name: &String| [format!("{name}.lowest"), format!("{name}.highest")];
            numbers.extend(manipulator.imaginary().iter().flat_map(|joint| ends(&joint.name)));
        }
    }
    numbers.extend(problem.measures().iter().flat_map(|m| [m.to_string(), format!("{m}.guide")]));
    let problem = fingerprint(&format!("{fixed:?}{}", file.text()));
    Columns { problem, variables, numbers }
}

/// Designs a mechanism. Designs that the log has are not evaluated again, and those that are evaluated are added to it. The
/// result does not depend on the number of threads.
///
/// # Errors
/// It was stopped; the log cannot be written; or nothing is found.
pub fn design(
    problem: &Problem,
    file: &MechanismFile,
    log: &mut Log,
    watch: &Watch,
) -> Result<Outcome, DesignError> {
    let mut work = Work {
        problem,
        file,
        measures: problem.measures(),
        radius: Manipulator::new(file.mechanism.clone())
            .map_or(1.0, |m| problem.largest_radius(&m)),
        columns: columns(problem, file),
        all: problem.variables.all().into_iter().cloned().collect(),
        log,
        watch,
    };
    let before = work.raw(Stage::Whole, None)?.map(|raw| values(&raw));
    let (stage, part, ranges, above, cuts);
    match &problem.variables {
        Variables::Undivided(_) => (stage, part, ranges) = (Stage::Whole, 0, Vec::new()),
        Variables::Sections { upper, lower } => {
            let (of_upper, all) = (scalars(upper), scalars(upper) + scalars(lower));
            let share = (problem.budget as f64 * of_upper as f64 / all as f64).round() as u64;
            part = share.clamp(1, problem.budget - 1);
            (above, ranges) = work.upper(part)?;
            cuts = ranges
                .iter()
                .map(|(name, range)| cut(name, *range, problem.values))
                .collect::<Vec<_>>();
            stage = Stage::Lower { above: &above, cuts: &cuts };
        }
    }
    let mut seen = work.search(stage, problem.budget - part)?;
    let polished = match problem.is_polished() {
        true => work.polish(stage, &mut seen)?,
        false => None,
    };
    let designs = work.chosen(&seen)?;
    Ok(Outcome { designs, before, ranges, evaluations: [part, problem.budget - part], polished })
}

/// The values of an imaginary joint that the lower section has to reach its places with.
fn cut(name: &str, [low, high]: [f64; 2], values: u64) -> Axis {
    match low < high && values > 1 {
        true => Axis::new(name, low, high, values),
        false => Axis::fixed(name, 0.5 * (low + high)),
    }
}

/// The values in the numbers of a table: every other one is a guide.
fn values(raw: &[f64]) -> Vec<f64> {
    raw.iter().copied().step_by(2).collect()
}

/// Values with their guides from the numbers of a table.
fn pairs(raw: &[f64]) -> Vec<Value> {
    raw.chunks(2).map(|pair| Value { value: pair[0], guide: pair[1] }).collect()
}

/// A design that was evaluated.
struct Seen {
    numbers: Vec<f64>,
    judged: Judged,
    /// The value of the first objective.
    value: f64,
}

/// A design in progress.
struct Work<'a> {
    problem: &'a Problem,
    file: &'a MechanismFile,
    measures: Vec<Measure>,
    radius: f64,
    columns: Columns,
    all: Vec<Variable>,
    log: &'a mut Log,
    watch: &'a Watch,
}

impl Work<'_> {
    /// The variables that differ in a stage.
    fn variables(&self, stage: Stage<'_>) -> &[Variable] {
        match (&self.problem.variables, stage) {
            (Variables::Sections { upper, .. }, Stage::Upper) => upper,
            (Variables::Sections { lower, .. }, Stage::Lower { .. }) => lower,
            _ => &self.all,
        }
    }

    /// The numbers that a stage finds of a design with these variables, or of the mechanism as it is. `None` if it does not
    /// assemble.
    fn raw(&self, stage: Stage<'_>, design: Option<&[f64]>) -> Result<Option<Vec<f64>>, Cancelled> {
        let given = match design {
            Some(numbers) => {
                let of_stage = match stage {
                    Stage::Upper => self.variables(stage),
                    Stage::Lower { .. } | Stage::Whole => &self.all,
                };
                changed(self.file, of_stage, numbers)
            }
            None => {
                Manipulator::new(self.file.mechanism.clone()).ok().map(|m| (self.file.clone(), m))
            }
        };
        let Some((_, manipulator)) = given else { return Ok(None) };
        let progress = &self.watch.progress;
        let found = match stage {
            Stage::Upper => {
                let found = evaluate::upper(self.problem, &manipulator, progress)?;
                return Ok(found.map(|found| of_upper(&found)));
            }
            Stage::Lower { cuts, .. } => {
                evaluate::lower(self.problem, &self.measures, &manipulator, cuts, progress)?
            }
            Stage::Whole => evaluate::whole(self.problem, &self.measures, &manipulator, progress)?,
        };
        Ok(found
            .map(|all| all.iter().flat_map(|Value { value, guide }| [*value, *guide]).collect()))
    }

    /// The numbers of designs with these variables, on all threads, as far as the log does not have them.
    fn evaluated(
        &mut self,
        stage: Stage<'_>,
        designs: &[Vec<f64>],
    ) -> Result<Vec<Option<Vec<f64>>>, DesignError> {
        let known: Vec<_> = designs.iter().map(|d| self.log.known(stage.name(), d)).collect();
        let (this, counted) = (&*self, &self.watch.evaluated);
        let found: Vec<_> = designs
            .par_iter()
            .zip(known)
            .map(|(design, known)| {
                let found = match known {
                    Some(known) => (known, false),
                    None => (this.raw(stage, Some(design))?, true),
                };
                counted.fetch_add(1, Ordering::Relaxed);
                Ok(found)
            })
            .collect::<Vec<Result<_, Cancelled>>>();
        // What was found before a request to stop is kept.
        for (design, found) in designs.iter().zip(&found) {
            if let Ok((numbers, true)) = found {
                let cells = self.cells(stage, design, numbers.as_deref());
                self.log.add(stage.name(), design, &cells, numbers.clone())?;
            }
        }
        self.log.flush()?;
        found.into_iter().map(|found| Ok(found?.0)).collect()
    }

    /// The cells of a design in the table of evaluations.
    fn cells(&self, stage: Stage<'_>, design: &[f64], numbers: Option<&[f64]>) -> Vec<Option<f64>> {
        let variables = (0..self.columns.variables.len()).map(|i| design.get(i).copied());
        let mut cells: Vec<Option<f64>> = variables.collect();
        let of_measures = 2 * self.measures.len();
        let of_upper = self.columns.numbers.len() - of_measures;
        let (before, after) = match stage {
            Stage::Upper => (0, of_measures),
            Stage::Lower { .. } | Stage::Whole => (of_upper, 0),
        };
        let count = self.columns.numbers.len() - before - after;
        cells.resize(cells.len() + before, None);
        cells.extend((0..count).map(|i| numbers.and_then(|numbers| numbers.get(i).copied())));
        cells.resize(cells.len() + after, None);
        cells
    }

    /// Judges the numbers of a design.
    fn judged(&self, stage: Stage<'_>, raw: &[f64]) -> Judged {
        if let Stage::Upper = stage {
            let cost = (1.0 - raw[0]) + WIDTH * raw[1];
            return Judged { costs: vec![cost], violation: self.too_wide(&raw[UPPER.len()..]) };
        }
        Judged::new(self.problem, &self.measures, &pairs(raw), self.radius)
    }

    /// By how much the ranges of imaginary joints are wider than constraints allow, relative to these.
    fn too_wide(&self, ends: &[f64]) -> f64 {
        let names = self.columns.numbers.iter().skip(UPPER.len()).step_by(2);
        let ranges = names.zip(ends.chunks(2)).filter_map(|(name, ends)| {
            let joint = name.strip_suffix(".lowest")?;
            let of = |m: &Measure| matches!(m, Measure::Range(name) if name == joint);
            let constraint = self.problem.constraints.iter().find(|c| of(&c.measure))?;
            let most = constraint.most?;
            Some(((ends[1] - ends[0]) / most.max(1e-3) - most / most.max(1e-3)).max(0.0))
        });
        // A range that is not known is not too wide.
        ranges.filter(|over| over.is_finite()).sum()
    }

    /// Goes on from the best design by its rates with the variables of a stage, and adds what it evaluates.
    fn polish(
        &mut self,
        stage: Stage<'_>,
        seen: &mut Vec<Seen>,
    ) -> Result<Option<Polished>, DesignError> {
        let variables = self.variables(stage).to_vec();
        let best = least(seen);
        let from = best.value;
        let (above, own) = best.numbers.split_at(best.numbers.len() - scalars(&variables));
        let (above, start) = (above.to_vec(), shares(&variables, own));
        let scale = from.abs();
        if !(scale.is_finite() && scale > 0.0) {
            return Ok(None);
        }
        let mut evaluations = 0;
        polish::polish(&start, self.problem.budget, &mut |all: &[Vec<f64>]| {
            let design = |shares: &Vec<f64>| [&*above, &numbers(&variables, shares)].concat();
            let designs: Vec<Vec<f64>> = all.iter().map(design).collect();
            evaluations += designs.len() as u64;
            let found = self.evaluated(stage, &designs)?;
            let mut samples = Vec::new();
            for (numbers, raw) in designs.into_iter().zip(found) {
                samples.push(
                    raw.as_ref()
                        .and_then(|raw| sample(self.problem, &self.measures, &pairs(raw), scale)),
                );
                seen.extend(raw.map(|raw| self.seen(stage, numbers, &raw)));
            }
            Ok::<_, DesignError>(samples)
        })?;
        Ok(Some(Polished { evaluations, from, to: least(seen).value }))
    }

    /// A design with the numbers that were found of it.
    fn seen(&self, stage: Stage<'_>, numbers: Vec<f64>, raw: &[f64]) -> Seen {
        Seen { numbers, judged: self.judged(stage, raw), value: raw[0] }
    }

    /// Searches a stage, and gives all designs that assemble.
    fn search(&mut self, stage: Stage<'_>, budget: u64) -> Result<Vec<Seen>, DesignError> {
        let variables = self.variables(stage).to_vec();
        let above = match stage {
            Stage::Lower { above, .. } => above,
            Stage::Upper | Stage::Whole => &[],
        };
        let (dimension, seed) = (scalars(&variables), self.problem.seed);
        let objectives = self.problem.objectives.len();
        let mut seen = Vec::new();
        let mut evaluate = |generation: &[Vec<f64>]| {
            let designs: Vec<Vec<f64>> = generation
                .iter()
                .map(|shares| [above, &numbers(&variables, shares)].concat())
                .collect();
            let found = self.evaluated(stage, &designs)?;
            let of = |(numbers, raw): (_, Option<Vec<f64>>)| Some(self.seen(stage, numbers, &raw?));
            let all: Vec<Option<Seen>> = designs.into_iter().zip(found).map(of).collect();
            let judged = all.iter().map(|one| Some(one.as_ref()?.judged.clone())).collect();
            seen.extend(all.into_iter().flatten());
            Ok::<Vec<Option<Judged>>, DesignError>(judged)
        };
        match (stage, objectives) {
            (Stage::Lower { .. } | Stage::Whole, 2) => {
                optimise::front(dimension, budget, seed, &mut evaluate)?;
            }
            _ => {
                optimise::best(dimension, budget, seed, &mut evaluate)?;
            }
        }
        if seen.is_empty() {
            return Err(DesignError::NothingAssembles { evaluations: budget });
        }
        Ok(seen)
    }

    /// The upper section's variables, and the ranges of the imaginary joints that it requires.
    fn upper(&mut self, budget: u64) -> Result<(Vec<f64>, Ranges), DesignError> {
        let seen = self.search(Stage::Upper, budget)?;
        let best = least(&seen).numbers.clone();
        let raw = self.evaluated(Stage::Upper, std::slice::from_ref(&best))?;
        let nothing = || DesignError::NothingReached { evaluations: budget };
        let raw = raw.into_iter().flatten().next().ok_or_else(nothing)?;
        let names = self.columns.numbers.iter().skip(UPPER.len()).step_by(2);
        let named = names.filter_map(|name| name.strip_suffix(".lowest"));
        let ends = raw[UPPER.len()..].chunks(2).map(|ends| [ends[0], ends[1]]);
        let ranges: Ranges = named.map(str::to_owned).zip(ends).collect();
        match raw[0] > 0.0 && ranges.iter().all(|(_, ends)| ends.iter().all(|x| x.is_finite())) {
            true => Ok((best, ranges)),
            false => Err(nothing()),
        }
    }

    /// The best of the designs, or their front, as whole mechanisms.
    fn chosen(&self, seen: &[Seen]) -> Result<Vec<Design>, DesignError> {
        let candidates: Vec<&Seen> = match self.problem.objectives.len() {
            1 => vec![least(seen)],
            _ => not_dominated(seen),
        };
        let mut designs = Vec::new();
        for Seen { numbers, .. } in candidates {
            let Some((file, _)) = changed(self.file, &self.all, numbers) else { continue };
            let Some(raw) = self.raw(Stage::Whole, Some(numbers))? else { continue };
            // A front is one of values: guides have led to it, and count no more.
            let guideless = raw.chunks(2).flat_map(|pair| [pair[0], 0.0]).collect::<Vec<_>>();
            let judged = self.judged(Stage::Whole, &guideless);
            let feasible = judged.violation == 0.0;
            let design =
                Design { file, variables: numbers.clone(), values: values(&raw), feasible };
            designs.push((judged, design));
        }
        // Those of sections are judged once more as whole mechanisms.
        let judged: Vec<Judged> = designs.iter().map(|(judged, _)| judged.clone()).collect();
        let stays = |one: &Judged| judged.iter().all(|other| !dominates(other, one));
        designs.retain(|(one, _)| judged.len() == 1 || stays(one));
        designs.sort_by(|(one, _), (other, _)| one.costs[0].total_cmp(&other.costs[0]));
        Ok(designs.into_iter().map(|(_, design)| design).collect())
    }
}

/// The numbers of an upper section.
fn of_upper(found: &Upper) -> Vec<f64> {
    let widths: Vec<f64> = found.ranges.iter().flatten().map(|[low, high]| high - low).collect();
    let mean = widths.iter().sum::<f64>() / widths.len().max(1) as f64;
    let ends = found.ranges.iter().flat_map(|range| range.unwrap_or([f64::NAN; 2]));
    [found.reached, mean].into_iter().chain(ends).collect()
}

/// The best of designs with one objective; of equal ones the first.
fn least(seen: &[Seen]) -> &Seen {
    let mut best = &seen[0];
    for one in seen {
        if one.judged.score() < best.judged.score() {
            best = one;
        }
    }
    best
}

/// Whether a design is as good as another in everything, and better in something.
fn dominates(one: &Judged, other: &Judged) -> bool {
    if one.violation != other.violation {
        return one.violation < other.violation;
    }
    let mut pairs = one.costs.iter().zip(&other.costs);
    one.costs != other.costs && pairs.all(|(one, other)| one <= other)
}

/// The designs that no other dominates; of equal ones the first.
fn not_dominated(seen: &[Seen]) -> Vec<&Seen> {
    let mut sorted: Vec<&Seen> = seen.iter().collect();
    let key = |seen: &Seen| (seen.judged.violation, seen.judged.costs.clone());
    sorted.sort_by(|one, other| {
        key(one).partial_cmp(&key(other)).unwrap_or(std::cmp::Ordering::Equal)
    });
    let least = sorted.first().map_or(0.0, |first| first.judged.violation);
    let mut front: Vec<&Seen> = Vec::new();
    for one in sorted.into_iter().filter(|one| one.judged.violation == least) {
        // Sorted by the first cost, one is dominated unless its second is below all so far.
        if front.last().is_none_or(|last| one.judged.costs[1] < last.judged.costs[1]) {
            front.push(one);
        }
    }
    front
}
