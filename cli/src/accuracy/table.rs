//! `opm accuracy --vary`: the largest errors at a pose or over a grid for each value of a number of the mechanism file.

use super::report::significant;
use super::{Setting, note_zero};
use crate::args::{AccuracyArgs, Output};
use crate::failure::Failure;
use crate::load::Loaded;
use crate::pose::GridAxis;
use crate::progress::interruptible;
use crate::runs::{self, Cell};
use crate::unitless;
use crate::workspace::threads;
use opm_accuracy::{Allocation, Budget, Largest};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_study::{AccuracyRequest, AccuracyRow, StudyError};
use opm_workspace::{Grid, Progress, Sections};
use rayon::ThreadPool;

pub fn run(
    args: &AccuracyArgs,
    loaded: &Loaded,
    vary: &GridAxis,
    output: &Output,
) -> Result<(), Failure> {
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    if let Ok(manipulator) = loaded.compile() {
        unitless::note_pose(output, "--pose", &args.pose, loaded, &manipulator);
        let ends = args.grid.iter().flat_map(GridAxis::ends);
        unitless::note_ranges(output, "--grid", (loaded, &manipulator), ends);
        note_zero(args, output, &Setting::new(args, loaded, &manipulator)?);
    }
    runs::vary(loaded, &loaded.varied(vary)?, output, |changed| {
        let manipulator = changed.compile()?;
        let setting = Setting::new(args, changed, &manipulator)?;
        match args.grid.is_empty() {
            true => at_pose(args, &setting),
            false => over_grid(args, &setting, &pool, &progress),
        }
    })
}

/// What is told of one mechanism, radians and metres; not finite where it is not known.
struct MechanismAccuracy {
    coordinates: Vec<f64>,
    worst: [f64; 2],
    /// The largest of all joints.
    misfit: [f64; 2],
    allocation: Option<Allocation>,
}

fn at_pose(args: &AccuracyArgs, setting: &Setting<'_>) -> Result<Vec<Cell>, Failure> {
    let manipulator = setting.manipulator();
    let (pose, checks) = args.pose.resolve_with_checks(manipulator)?;
    let mut at = manipulator.solution();
    let solved = manipulator.inverse(&pose, setting.mode, &mut at);
    let reached = solved.map_err(|error| Failure::flag("--pose", error))?.is_some();
    let mut found = MechanismAccuracy::nothing(args, setting);
    if reached {
        // What follows from the others changes with the mechanism.
        let units = setting.loaded.file.units;
        let verified = checks.verify(manipulator, at.dependent(), units);
        verified.map_err(|error| Failure::work(error.0))?;
        let response = setting.model.at(&at).map_err(|error| Failure::work(error.to_string()))?;
        let budget = Budget::new(&response, &setting.sizes);
        found.coordinates = budget.coordinates.iter().map(|spread| spread.worst).collect();
        found.worst = [budget.length.worst, budget.angle.worst];
        let plays = budget.misfit.iter().map(|play| [play.length.worst, play.angle.worst]);
        found.misfit = largest(plays);
        if let Some(allocation) = &mut found.allocation {
            allocation.add(&response, setting.model.sources());
        }
    }
    let first = Cell::answer("reachable", reached);
    Ok([vec![first], found.cells(setting, reached)].concat())
}

fn over_grid(
    args: &AccuracyArgs,
    setting: &Setting<'_>,
    pool: &ThreadPool,
    progress: &Progress,
) -> Result<Vec<Cell>, Failure> {
    let manipulator: &Manipulator = setting.manipulator();
    let coordinates = Sections::Whole.coordinates(manipulator);
    let axes = args.grid.iter().map(|axis| axis.resolve(&coordinates));
    let grid = Grid::new(manipulator, axes.collect::<Result<_, _>>()?);
    let grid = grid.map_err(|error| Failure::flag("--grid", error))?;
    let clearance = args.clearance.map(|pair| pair.0);
    let (model, sizes, mode) = (&setting.model, &*setting.sizes, setting.mode);
    let request = AccuracyRequest { model, sizes, mode, clearance };
    let job = || request.over(&grid, progress, |_: &AccuracyRow| Ok::<(), StudyError>(()));
    let field = pool.install(job).map_err(|error| match error {
        StudyError::Cancelled => Failure::interrupted("interrupted"),
        other => other.into(),
    })?;
    let worst = &field.worst;
    let value = |largest: &Largest| match largest.pose.is_empty() {
        true => f64::NAN,
        false => largest.value,
    };
    let found = MechanismAccuracy {
        coordinates: worst.coordinates.iter().map(value).collect(),
        worst: [value(&worst.length), value(&worst.angle)],
        misfit: largest(worst.misfit.iter().map(|each| each.each_ref().map(value))),
        allocation: field.allocation,
    };
    let counts = [Cell::count("poses", field.poses), Cell::count("reachable", worst.poses)];
    Ok([counts.to_vec(), found.cells(setting, worst.poses > 0)].concat())
}

/// The largest play of all joints; NaN if one is not known.
fn largest(plays: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
    let larger = |a: f64, b: f64| if a.is_nan() || a > b { a } else { b };
    plays.fold([0.0; 2], |all, play| [larger(all[0], play[0]), larger(all[1], play[1])])
}

impl MechanismAccuracy {
    /// Of a mechanism that does not reach the pose.
    fn nothing(args: &AccuracyArgs, setting: &Setting<'_>) -> Self {
        let (model, unknown) = (&setting.model, f64::NAN);
        let new = |clearance| Allocation::new(clearance, model.length(), model.sources().len());
        Self {
            coordinates: vec![unknown; setting.manipulator().task_coordinates().len()],
            worst: [unknown; 2],
            misfit: [unknown; 2],
            allocation: args.clearance.map(|pair| new(pair.0)),
        }
    }

    /// The columns, with the names of those of a table of poses. Nothing is permitted where there is no pose.
    fn cells(&self, setting: &Setting<'_>, reached: bool) -> Vec<Cell> {
        let units = setting.loaded.file.units;
        let cell = |name: String, value: f64, quantity: Quantity| {
            let shown = significant(value / units.factor(quantity));
            let header = format!("{name} [{}]", units.symbol(quantity));
            Cell { header, ..Cell::new(&name, value, shown) }
        };
        let names = ["length", "angle"].into_iter().zip([Quantity::Length, Quantity::Angle]);
        let pair = |of: &str, values: [f64; 2]| {
            let each = names.clone().zip(values);
            each.map(|((name, quantity), value)| cell(format!("{of}.{name}"), value, quantity))
                .collect::<Vec<_>>()
        };
        let coordinates = setting.manipulator().task_coordinates().iter().zip(&self.coordinates);
        let mut cells: Vec<Cell> = coordinates
            .map(|(c, &value)| cell(format!("error.{}", c.name), value, c.quantity))
            .collect();
        cells.extend(pair("worst", self.worst));
        cells.extend(pair("misfit", self.misfit));
        if let Some(allocation) = &self.allocation {
            let uniform = if reached { allocation.uniform() } else { [f64::NAN; 2] };
            cells.extend(pair("uniform", uniform));
        }
        cells
    }
}
