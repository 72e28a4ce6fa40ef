//! What is to be designed: a mechanism, what may vary of it, and what decides.

use crate::measure::Measure;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::family::ParameterValue;
use opm_core::mechanism::file::MechanismFile;
use opm_workspace::{Axis, Grid};

/// A problem of design. [`Draft`](crate::Draft) reads one from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The grid that measures are taken over, metres and radians. Coordinates without an axis stay at home.
    pub grid: Vec<Axis>,
    /// The working mode as text; `None` for that of home.
    pub mode: Option<String>,
    /// One objective, or two.
    pub objectives: Vec<Measure>,
    /// What a design has to keep.
    pub constraints: Vec<Constraint>,
    /// What may vary.
    pub variables: Variables,
    /// How many designs are evaluated.
    pub budget: u64,
    /// The seed of all random numbers: the same seed gives the same design.
    pub seed: u64,
    /// How many values of each imaginary joint, both ends of its range included, the lower section is evaluated with if it is
    /// designed for the ranges that the upper one requires.
    pub values: u64,
}

/// A bound of a measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Of what.
    pub measure: Measure,
    /// The least value.
    pub least: Option<f64>,
    /// The largest value.
    pub most: Option<f64>,
}

/// A number of a mechanism file that varies, or a point of the plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name, as [`MechanismFile::with`] takes it.
    pub name: String,
    /// The lowest and the highest value of each component, metres and radians: one, or two for a point.
    pub bounds: Vec<[f64; 2]>,
}

/// What may vary, and in which order it is designed.
#[derive(Clone, Debug, PartialEq)]
pub enum Variables {
    /// Everything at once.
    Undivided(Vec<Variable>),
    /// The upper section first, then the lower one for the ranges of the imaginary joints that the upper one requires.
    Sections {
        /// Of the upper section.
        upper: Vec<Variable>,
        /// Of the lower section.
        lower: Vec<Variable>,
    },
}

impl Variables {
    /// All of them, those of the upper section first.
    pub fn all(&self) -> Vec<&Variable> {
        match self {
            Self::Undivided(all) => all.iter().collect(),
            Self::Sections { upper, lower } => upper.iter().chain(lower).collect(),
        }
    }

    /// The same variables all at once.
    #[must_use]
    pub fn undivided(self) -> Self {
        match self {
            Self::Sections { upper, lower } => Self::Undivided([upper, lower].concat()),
            all => all,
        }
    }
}

impl Variable {
    /// The names of its components, for tables.
    pub fn components(&self) -> Vec<String> {
        match self.bounds.len() {
            1 => vec![self.name.clone()],
            _ => (1..=self.bounds.len()).map(|number| format!("{}.{number}", self.name)).collect(),
        }
    }

    /// The value of some numbers, one for each component.
    fn value(&self, numbers: &[f64]) -> ParameterValue {
        match *numbers {
            [first, second] => ParameterValue::Pair([first, second]),
            _ => ParameterValue::Number(numbers[0]),
        }
    }
}

/// The number of scalars that some variables have.
pub fn scalars<'v>(variables: impl IntoIterator<Item = &'v Variable>) -> usize {
    variables.into_iter().map(|variable| variable.bounds.len()).sum()
}

/// The shares of the way between the bounds of some numbers.
pub(crate) fn shares(variables: &[Variable], numbers: &[f64]) -> Vec<f64> {
    let bounds = variables.iter().flat_map(|variable| &variable.bounds);
    bounds.zip(numbers).map(|([low, high], x)| ((x - low) / (high - low)).clamp(0.0, 1.0)).collect()
}

/// The numbers at some shares of the way between the bounds.
pub(crate) fn numbers(variables: &[Variable], shares: &[f64]) -> Vec<f64> {
    let bounds = variables.iter().flat_map(|variable| &variable.bounds);
    bounds.zip(shares).map(|([low, high], share)| low + (high - low) * share).collect()
}

/// A file with the variables at these numbers; `None` if it does not assemble or does not compile.
pub(crate) fn changed(
    file: &MechanismFile,
    variables: &[Variable],
    numbers: &[f64],
) -> Option<(MechanismFile, Manipulator)> {
    let mut rest = numbers;
    let changes = variables.iter().map(|variable| {
        let (own, others) = rest.split_at(variable.bounds.len());
        rest = others;
        (&*variable.name, variable.value(own))
    });
    let changed = file.with(changes.collect::<Vec<_>>()).ok()?;
    let manipulator = Manipulator::new(changed.mechanism.clone()).ok()?;
    Some((changed, manipulator))
}

impl Problem {
    /// The measures of the objectives and of the constraints, each once.
    pub fn measures(&self) -> Vec<Measure> {
        let mut all: Vec<Measure> = Vec::new();
        let given = self.objectives.iter().chain(self.constraints.iter().map(|c| &c.measure));
        for measure in given {
            if !all.contains(measure) {
                all.push(measure.clone());
            }
        }
        all
    }

    /// The working mode of a manipulator that is designed.
    pub(crate) fn mode_of(&self, manipulator: &Manipulator) -> Option<Mode> {
        match &self.mode {
            None => Some(manipulator.home_mode()),
            Some(text) => manipulator.parse_mode(text).ok(),
        }
    }

    /// The axes of the places and those of the orientations.
    pub(crate) fn divided_axes(&self, manipulator: &Manipulator) -> [Vec<Axis>; 2] {
        let lower = manipulator.lower_coordinates();
        let names: Vec<&str> =
            manipulator.task_coordinates()[..lower].iter().map(|c| c.name).collect();
        let (places, orientations) =
            self.grid.iter().cloned().partition(|axis| names.contains(&&*axis.name));
        [places, orientations]
    }

    /// The grid for a manipulator.
    pub(crate) fn grid_of(&self, manipulator: &Manipulator) -> Option<Grid> {
        Grid::new(manipulator, self.grid.clone()).ok()
    }

    /// The largest radius that an inscribed shape can have: half of the shortest side of the places.
    pub(crate) fn largest_radius(&self, manipulator: &Manipulator) -> f64 {
        let names: Vec<&str> = manipulator.task_coordinates()[manipulator.place_coordinates()]
            .iter()
            .map(|c| c.name)
            .collect();
        let sides = self.grid.iter().filter(|axis| axis.count > 1 && names.contains(&&*axis.name));
        sides.map(|axis| 0.5 * (axis.max - axis.min)).fold(f64::INFINITY, f64::min)
    }
}
