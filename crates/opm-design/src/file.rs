//! Files of problems.
//!
//! ```toml
//! format = 1
//! mechanism = "plano-spherical-5dof"      # a file beside this one, or a shipped mechanism
//! units = { length = "mm", angle = "deg" }
//! budget = 1000
//!
//! [grid]
//! x = [-100, 100, 21]
//! y = [-100, 100, 21]
//! xi = [-20, 20, 5]
//!
//! [[objective]]
//! measure = "dexterous"
//!
//! [variables]
//! h = [80, 160]
//! "leg4.base" = [[-100, 100], [0, 150]]
//! ```

use crate::measure::Measure;
use crate::problem::{Constraint, Problem, Variable, Variables};
use opm_analysis::Setup;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file::hint::expected_one_of;
use opm_core::mechanism::file::{self, FileUnits, MechanismFile};
use opm_workspace::{Axis, Grid, InscribedShape, Sections};
use serde::de::{Error as _, IgnoredAny};
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;
use std::fmt::Display;
use toml::Spanned;
use toml::de::DeTable;

/// The version of the format.
const FORMAT: u32 = 1;
/// The most poses of a grid: some seconds for each design.
const MOST_POSES: u64 = 10_000_000;

/// What is wrong with a file of a problem: every problem, at least one, in the order of the file.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", lines(.problems, ""))]
#[non_exhaustive]
pub struct ProblemErrors {
    /// The problems, each with its line and column.
    pub problems: Vec<file::Problem>,
}

impl ProblemErrors {
    /// The text with one line for each problem, `FILE:LINE:COLUMN: message`.
    pub fn in_file(&self, file: impl Display) -> String {
        lines(&self.problems, &format!("{file}:"))
    }
}

fn lines(problems: &[file::Problem], prefix: &str) -> String {
    problems.iter().map(|p| format!("{prefix}{p}")).collect::<Vec<_>>().join("\n")
}

/// A file that is read as far as it can be without its mechanism.
#[derive(Debug)]
pub struct Draft<'t> {
    text: &'t str,
    read: Text,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Text {
    format: Spanned<u32>,
    mechanism: String,
    mode: Option<Spanned<String>>,
    budget: Spanned<Whole>,
    #[serde(default)]
    seed: Whole,
    #[serde(default)]
    split: bool,
    values: Option<Spanned<Whole>>,
    /// Read by `optional_units`, which knows the place of each part.
    #[expect(dead_code, reason = "only whether the key is known matters")]
    units: Option<IgnoredAny>,
    #[serde(default)]
    set: BTreeMap<Spanned<String>, SetText>,
    grid: Spanned<BTreeMap<Spanned<String>, AxisText>>,
    objective: Spanned<Vec<ObjectiveText>>,
    #[serde(default)]
    constraint: Vec<ConstraintText>,
    #[serde(default)]
    variables: BTreeMap<Spanned<String>, BoundsText>,
    #[serde(default)]
    upper: BTreeMap<Spanned<String>, BoundsText>,
    #[serde(default)]
    lower: BTreeMap<Spanned<String>, BoundsText>,
}

/// A number of things, or a seed.
#[derive(Clone, Copy, Debug, Default)]
struct Whole(u64);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let value = toml::Value::deserialize(from)?;
        let number = value.as_integer().and_then(|number| u64::try_from(number).ok());
        number.map(Self).ok_or_else(|| {
            D::Error::custom(format!("{value}, expected a whole number of 0 or more"))
        })
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectiveText {
    measure: Spanned<String>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ConstraintText {
    measure: Spanned<String>,
    least: Option<f64>,
    most: Option<f64>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a number, or a pair of numbers")]
enum SetText {
    Number(f64),
    Pair([f64; 2]),
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected a value, or [lowest, highest, number of values]")]
enum AxisText {
    Value(f64),
    Range(f64, f64, u64),
}

#[derive(Debug, Deserialize)]
#[serde(untagged, expecting = "expected [lowest, highest], or two of these for a point")]
enum BoundsText {
    Number([f64; 2]),
    Point([[f64; 2]; 2]),
}

type Named<'t, T> = &'t BTreeMap<Spanned<String>, T>;

impl<'t> Draft<'t> {
    /// Reads a text.
    ///
    /// # Errors
    /// It is not TOML, or lacks a key or has an unknown one.
    pub fn read(text: &'t str) -> Result<Self, ProblemErrors> {
        match toml::from_str(text) {
            Ok(read) => Ok(Self { text, read }),
            Err(error) => {
                let at = error.span().map_or(0, |span| span.start);
                let message = error.message().trim().to_owned();
                Err(ProblemErrors { problems: vec![problem(text, at, message)] })
            }
        }
    }

    /// The mechanism, as it is named: a file, or one that is shipped.
    pub fn mechanism(&self) -> &str {
        &self.read.mechanism
    }

    /// The problem for its mechanism, and the mechanism with what `[set]` changes of it.
    ///
    /// # Errors
    /// Lists what is wrong, each with its place.
    pub fn resolve(&self, file: &MechanismFile) -> Result<(Problem, MechanismFile), ProblemErrors> {
        let mut reader = Reader { text: self.text, units: FileUnits::SI, problems: Vec::new() };
        let found = reader.problem(&self.read, file);
        match found {
            Some(found) if reader.problems.is_empty() => Ok(found),
            _ => {
                reader.problems.sort();
                Err(ProblemErrors { problems: reader.problems })
            }
        }
    }
}

/// A problem at a byte of a text.
fn problem(text: &str, at: usize, message: String) -> file::Problem {
    let before = &text[..at.min(text.len())];
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    file::Problem { line, column: before[start..].chars().count() + 1, message }
}

struct Reader<'t> {
    text: &'t str,
    units: FileUnits,
    problems: Vec<file::Problem>,
}

impl Reader<'_> {
    fn report(&mut self, at: usize, message: impl Into<String>) {
        self.problems.push(problem(self.text, at, message.into()));
    }

    fn problem(&mut self, text: &Text, file: &MechanismFile) -> Option<(Problem, MechanismFile)> {
        if *text.format.get_ref() != FORMAT {
            let problem = format!("`format` is {}, expected {FORMAT}", text.format.get_ref());
            self.report(text.format.span().start, problem);
        }
        if let Ok(table) = DeTable::parse(self.text) {
            let (units, problems) = file::optional_units(table.get_ref(), self.text);
            self.units = units;
            self.problems.extend(problems);
        }
        let file = self.set(&text.set, file)?;
        let manipulator = match Manipulator::new(file.mechanism.clone()) {
            Ok(manipulator) => manipulator,
            Err(error) => {
                self.report(0, format!("the mechanism: {error}"));
                return None;
            }
        };
        if let Some(mode) = &text.mode
            && let Err(error) = manipulator.parse_mode(mode.get_ref())
        {
            self.report(mode.span().start, format!("`mode`: {error}"));
        }
        if text.budget.get_ref().0 < 2 {
            self.report(text.budget.span().start, "`budget` is less than 2 designs");
        }
        let values = text.values.as_ref().map_or(5, |values| values.get_ref().0);
        if let Some(given) = text.values.as_ref().filter(|values| values.get_ref().0 == 0) {
            self.report(given.span().start, "`values` is 0, expected at least 1");
        }
        let grid = self.grid(&text.grid, &manipulator)?;
        let objectives = self.objectives(&text.objective, &manipulator, &grid);
        let constraints =
            text.constraint.iter().filter_map(|c| self.constraint(c, &manipulator, &grid));
        let constraints = constraints.collect();
        let variables = self.variables(text, &file)?;
        if text.split {
            self.check_split(text, &manipulator);
        }
        let axes = grid
            .axes()
            .iter()
            .filter(|axis| text.grid.get_ref().keys().any(|name| *name.get_ref() == axis.name));
        let problem = Problem {
            grid: axes.cloned().collect(),
            mode: text.mode.as_ref().map(|mode| mode.get_ref().clone()),
            objectives,
            constraints,
            variables,
            budget: text.budget.get_ref().0,
            seed: text.seed.0,
            values,
        };
        Some((problem, file))
    }

    /// What a number of a mechanism file measures, or that it has no unit (`Some(None)`); an unknown name is reported.
    fn quantity(
        &mut self,
        name: &Spanned<String>,
        file: &MechanismFile,
    ) -> Option<Option<Quantity>> {
        if file.is_plain(name.get_ref()) {
            return Some(None);
        }
        let quantity = file.quantity_of(name.get_ref());
        if quantity.is_none() {
            let unknown = file.with([(name.get_ref().as_str(), ParameterValue::Number(0.0))]);
            let message = unknown.err().map_or_else(
                || format!("`{}` is neither a length nor an angle", name.get_ref()),
                |errors| errors.to_string(),
            );
            self.report(name.span().start, message);
        }
        quantity.map(Some)
    }

    /// A number of this quantity in SI.
    fn si(&self, number: f64, quantity: Option<Quantity>) -> f64 {
        quantity.map_or(number, |quantity| self.units.si(number, quantity))
    }

    fn set(&mut self, set: Named<'_, SetText>, file: &MechanismFile) -> Option<MechanismFile> {
        let mut changes = Vec::new();
        for (name, value) in set {
            let quantity = self.quantity(name, file)?;
            let value = match value {
                SetText::Number(number) => ParameterValue::Number(self.si(*number, quantity)),
                SetText::Pair(pair) => {
                    ParameterValue::Pair(pair.map(|number| self.si(number, quantity)))
                }
            };
            changes.push((name.get_ref().as_str(), value));
        }
        if changes.is_empty() {
            return Some(file.clone());
        }
        match file.with(changes) {
            Ok(changed) => Some(changed),
            Err(errors) => {
                let at = set.keys().next().map_or(0, |name| name.span().start);
                self.report(at, format!("[set]: {errors}"));
                None
            }
        }
    }

    fn grid(
        &mut self,
        text: &Spanned<BTreeMap<Spanned<String>, AxisText>>,
        manipulator: &Manipulator,
    ) -> Option<Grid> {
        let coordinates = Sections::Whole.coordinates(manipulator);
        let mut axes = Vec::new();
        for (name, axis) in text.get_ref() {
            let known = coordinates.iter().find(|c| c.name == *name.get_ref());
            // The grid names those that are known.
            let quantity = known.map_or(Quantity::Length, |c| c.quantity);
            let si = |number| self.units.si(number, quantity);
            let axis = match *axis {
                AxisText::Value(value) => Axis::fixed(name.get_ref(), si(value)),
                AxisText::Range(low, high, count) => {
                    Axis::new(name.get_ref(), si(low), si(high), count)
                }
            };
            if let Err(error) = Grid::new(manipulator, vec![axis.clone()]) {
                self.report(name.span().start, error.to_string());
            }
            axes.push(axis);
        }
        if !self.problems.is_empty() {
            return None;
        }
        let grid = Grid::new(manipulator, axes);
        let grid = grid.map_err(|error| self.report(text.span().start, error.to_string())).ok()?;
        if grid.poses() > MOST_POSES {
            let problem = format!(
                "the grid has {} poses, expected at most {MOST_POSES}: every design is judged at all of them",
                grid.poses()
            );
            self.report(text.span().start, problem);
            return None;
        }
        Some(grid)
    }

    fn measure(
        &mut self,
        name: &Spanned<String>,
        manipulator: &Manipulator,
        grid: &Grid,
    ) -> Option<Measure> {
        let found = Measure::from_name(name.get_ref());
        let known = Measure::names(manipulator);
        let refused = match &found {
            Some(Measure::Inscribed(shape)) => inscribed_problem(*shape, grid),
            Some(Measure::Worst(index)) => {
                let setup = Setup::new(manipulator.characteristic_length());
                index.check(manipulator, &setup).err().map(|error| error.to_string())
            }
            Some(Measure::Range(_)) if !known.contains(name.get_ref()) => Some(String::new()),
            Some(Measure::Reachable | Measure::Dexterous) if grid.places().is_empty() => {
                Some("the mechanism has no places".to_owned())
            }
            Some(_) => None,
            None => Some(String::new()),
        };
        match refused {
            None => found,
            Some(why) if why.is_empty() => {
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let expected = expected_one_of(name.get_ref(), &known);
                self.report(
                    name.span().start,
                    format!("`{}` is not a measure; {expected}", name.get_ref()),
                );
                None
            }
            Some(why) => {
                self.report(name.span().start, format!("`{}`: {why}", name.get_ref()));
                None
            }
        }
    }

    fn objectives(
        &mut self,
        given: &Spanned<Vec<ObjectiveText>>,
        manipulator: &Manipulator,
        grid: &Grid,
    ) -> Vec<Measure> {
        let count = given.get_ref().len();
        if !(1..=2).contains(&count) {
            self.report(given.span().start, format!("{count} objectives, expected one or two"));
        }
        let mut found: Vec<Measure> = Vec::new();
        for ObjectiveText { measure: name } in given.get_ref() {
            let Some(measure) = self.measure(name, manipulator, grid) else { continue };
            if found.contains(&measure) {
                self.report(name.span().start, format!("`{measure}` is given twice"));
            }
            found.push(measure);
        }
        found
    }

    fn constraint(
        &mut self,
        given: &ConstraintText,
        manipulator: &Manipulator,
        grid: &Grid,
    ) -> Option<Constraint> {
        let ConstraintText { measure: name, least, most } = given;
        let measure = self.measure(name, manipulator, grid)?;
        let suits = match (least, most) {
            (None, None) => false,
            (Some(least), Some(most)) => least <= most,
            (Some(bound), None) | (None, Some(bound)) => bound.is_finite(),
        };
        if !suits {
            let problem = format!("`{measure}`: expected `least`, `most` or both in this order");
            self.report(name.span().start, problem);
            return None;
        }
        let quantity = measure.quantity(manipulator);
        let si = |bound: f64| quantity.map_or(bound, |quantity| self.units.si(bound, quantity));
        Some(Constraint { measure, least: least.map(si), most: most.map(si) })
    }

    fn table(&mut self, given: Named<'_, BoundsText>, file: &MechanismFile) -> Vec<Variable> {
        let mut variables = Vec::new();
        for (name, bounds) in given {
            let Some(quantity) = self.quantity(name, file) else { continue };
            let bounds = match bounds {
                BoundsText::Number(bounds) => vec![*bounds],
                BoundsText::Point(bounds) => bounds.to_vec(),
            };
            if let Some(problem) = bounds.iter().find_map(|pair| wrong_bounds(*pair)) {
                self.report(name.span().start, format!("`{}`: {problem}", name.get_ref()));
                continue;
            }
            let bounds = bounds.iter().map(|pair| pair.map(|end| self.si(end, quantity)));
            let variable = Variable { name: name.get_ref().clone(), bounds: bounds.collect() };
            let middle: Vec<f64> = variable.bounds.iter().map(|[a, b]| 0.5 * (a + b)).collect();
            let value = match *middle {
                [first, second] => ParameterValue::Pair([first, second]),
                _ => ParameterValue::Number(middle[0]),
            };
            // A number where a point is expected, for instance. Whether it assembles is not decided here.
            let change = [(&*variable.name, value)];
            let wrong = match (file.parameter(name.get_ref()), &file.family) {
                (Some(parameter), _) => {
                    let refused = parameter.takes(value).err();
                    refused.map(|problem| format!("`{}` {problem}", name.get_ref()))
                }
                (None, Some(family)) => family.with(change).err().map(|wrong| wrong.to_string()),
                (None, None) => file.with(change).err().map(|wrong| wrong.to_string()),
            };
            if let Some(wrong) = wrong {
                self.report(name.span().start, wrong);
            }
            variables.push(variable);
        }
        variables
    }

    fn variables(&mut self, text: &Text, file: &MechanismFile) -> Option<Variables> {
        let all = self.table(&text.variables, file);
        let [upper, lower] = [&text.upper, &text.lower].map(|table| self.table(table, file));
        let mut names = [&text.variables, &text.upper, &text.lower]
            .into_iter()
            .flat_map(|table| table.keys().map(|name| (name.get_ref(), name.span().start)))
            .collect::<Vec<_>>();
        names.sort();
        for pair in names.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            self.report(pair[1].1, format!("`{}` varies already", pair[1].0));
        }
        if !self.problems.is_empty() {
            return None;
        }
        if !text.split {
            let all = [all, upper, lower].concat();
            if all.is_empty() {
                self.report(0, "nothing varies; expected [variables]");
                return None;
            }
            return Some(Variables::Undivided(all));
        }
        if !all.is_empty() || upper.is_empty() || lower.is_empty() {
            let problem = "with `split`, expected [upper] and [lower] in place of [variables]";
            self.report(0, problem);
            return None;
        }
        Some(Variables::Sections { upper, lower })
    }

    /// Refuses what has no meaning by sections.
    fn check_split(&mut self, text: &Text, manipulator: &Manipulator) {
        for sections in [Sections::Upper, Sections::Lower] {
            if let Err(error) = Grid::of(sections, manipulator, Vec::new()) {
                self.report(0, format!("`split`: {error}"));
                return;
            }
        }
        if manipulator.imaginary().is_empty() {
            self.report(0, "`split`: the mechanism has no imaginary joint");
        }
        for ObjectiveText { measure } in text.objective.get_ref() {
            if let Some(found @ (Measure::Grid | Measure::Reachable)) =
                Measure::from_name(measure.get_ref())
            {
                let problem =
                    format!("`split` designs for every orientation: `{found}` is not known");
                self.report(measure.span().start, problem);
            }
        }
    }
}

/// What is wrong with the bounds of a variable.
fn wrong_bounds([low, high]: [f64; 2]) -> Option<String> {
    if let Some(bound) = [low, high].into_iter().find(|bound| !bound.is_finite()) {
        return Some(format!("a bound is {}, expected a number", toml::Value::Float(bound)));
    }
    if low == high {
        return Some(format!("both bounds are {low}, expected two that differ"));
    }
    (low > high)
        .then(|| format!("{low} is above {high}, expected the lower bound before the higher one"))
}

/// Why a grid has no inscribed shape.
fn inscribed_problem(shape: InscribedShape, grid: &Grid) -> Option<String> {
    let varying: Vec<usize> = grid.places().filter(|&i| grid.axes()[i].count > 1).collect();
    let needed = if shape == InscribedShape::Ball { 3 } else { 2 };
    let quantities: Vec<Quantity> =
        varying.iter().map(|&i| grid.coordinates()[i].quantity).collect();
    let suits = varying.len() == needed && quantities.windows(2).all(|pair| pair[0] == pair[1]);
    (!suits)
        .then(|| format!("expected a grid whose places vary in {needed} coordinates of one unit"))
}
