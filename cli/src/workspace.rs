//! `opm workspace`: sweeps of the workspace.

use crate::args::{Output, WorkspaceArgs};
use crate::cloud::{Cloud, Wishes};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::GridAxis;
use crate::progress::{interruptible, watch};
use crate::record::Recorder;
use crate::text::{self, Table, count, short};
use crate::velocity::characteristic_length;
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_workspace::{
    Axis, Cancelled, ConditionLimit, Count, Grid, Modes, Progress, Sweep, default_grid,
};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use std::time::Instant;

pub fn run(args: &WorkspaceArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.file)?;
    let manipulator = loaded.compile()?;
    let modes = match &*args.mode {
        "any" => Modes::Any,
        mode => Modes::One(load::mode(&manipulator, mode)?),
    };
    let limit = limit(args, &manipulator)?;
    let given = given_grid(&args.grid, &manipulator)?;
    let wishes = Wishes::new(args, &manipulator)?;
    let recorder = match &args.output {
        Some(path) => {
            loaded.refuse_as_output(path, &[])?;
            given.as_ref().map_or(Ok(()), Recorder::check)?;
            Some(Recorder::create(path)?)
        }
        None => None,
    };
    let progress = interruptible()?;
    let pool = threads(args.threads)?;
    let grid = match given {
        Some(grid) => grid,
        None => fitted_grid(&manipulator, modes, output, &pool, &progress)?,
    };

    let run = Run { loaded: &loaded, manipulator: &manipulator, grid: &grid, modes, limit };
    let sweep = Sweep::new(&manipulator, &grid, modes).limited(limit);
    let before = progress.done();
    let done = || progress.done() - before;
    let start = Instant::now();
    let job = || pool.install(|| sweep.count(&progress));
    let found = watch(output, "counting", Some(grid.poses()), done, job).map_err(|Cancelled| {
        let (done, poses) = (count(done()), count(grid.poses()));
        Failure::Interrupted(format!("interrupted; {done} of {poses} poses were decided"))
    })?;
    let seconds = start.elapsed().as_secs_f64().max(1e-9);
    if found.reachable == 0 {
        output.warn(match limit {
            Some(_) => "no pose of the grid is in reach, within the limits and well conditioned",
            None => "no pose of the grid is in reach and within the limits",
        });
    }

    if let Some(recorder) = recorder {
        let cloud = Cloud::new(wishes, &run);
        let total = cloud.passes() * grid.poses();
        let before = progress.done();
        let done = || progress.done() - before;
        let job = || pool.install(|| recorder.record(&run, &cloud, &sweep, &found, &progress));
        let path = watch(output, "recording", Some(total), done, job)?;
        output.note(format_args!("{}: {} points", path.display(), count(found.reachable)));
    }
    output.print(&run.json(&found, seconds), run.text(&found, seconds))
}

/// The limit on the condition number that the flags give.
fn limit(
    args: &WorkspaceArgs,
    manipulator: &Manipulator,
) -> Result<Option<ConditionLimit>, Failure> {
    let Some(most) = args.max_condition else { return Ok(None) };
    let length = characteristic_length(args.length, "--length", manipulator)?;
    Ok(Some(ConditionLimit { most, length }))
}

/// The grid that the flags give; `None` without flags.
fn given_grid(given: &[GridAxis], manipulator: &Manipulator) -> Result<Option<Grid>, Failure> {
    if given.is_empty() {
        return Ok(None);
    }
    let axes: Result<Vec<_>, _> =
        given.iter().map(|axis| axis.resolve(manipulator.task_coordinates())).collect();
    Grid::new(manipulator, axes?).map(Some).map_err(|error| Failure::flag("--grid", error))
}

/// A grid over the whole workspace.
fn fitted_grid(
    manipulator: &Manipulator,
    modes: Modes,
    output: &Output,
    pool: &ThreadPool,
    progress: &Progress,
) -> Result<Grid, Failure> {
    let find = || pool.install(|| default_grid(manipulator, modes, progress));
    let (grid, extents) = watch(output, "fitting a grid", None, || progress.done(), find)
        .map_err(|Cancelled| Failure::Interrupted("interrupted while fitting a grid".into()))?;
    // As flags in SI, so that the same run can be asked for again.
    let flags: Vec<String> = grid
        .axes()
        .iter()
        .map(|Axis { name, min, max, count }| match count {
            1 => format!("--grid {name}={min}"),
            _ => format!("--grid {name}={min}:{max}:{count}"),
        })
        .collect();
    output.note(format_args!("grid fitted to the workspace: {}", flags.join(" ")));
    for extent in extents.iter().filter(|extent| extent.unbounded) {
        output.warn(format_args!(
            "the workspace goes on beyond this grid along {}; limit a joint, or give --grid",
            extent.name
        ));
    }
    Ok(grid)
}

fn threads(number: Option<u16>) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(number.map_or(0, usize::from));
    builder.build().map_err(|error| Failure::at("threads", &error))
}

/// What was swept.
pub struct Run<'a> {
    pub loaded: &'a Loaded,
    pub manipulator: &'a Manipulator,
    pub grid: &'a Grid,
    pub modes: Modes,
    pub limit: Option<ConditionLimit>,
}

impl Run<'_> {
    /// `any`, or the signs of the mode.
    pub fn mode(&self) -> String {
        match self.modes {
            Modes::Any => "any".to_owned(),
            Modes::One(mode) => self.manipulator.format_mode(mode),
        }
    }

    /// The counted share of the grid's box, over the axes with more than one value.
    pub fn measure(&self, found: &Count, units: FileUnits) -> (f64, String) {
        let mut value = found.reachable as f64 / found.poses as f64;
        let mut powers = [(Quantity::Length, 0), (Quantity::Angle, 0)];
        for (axis, coordinate) in self.grid.axes().iter().zip(self.manipulator.task_coordinates()) {
            if axis.count > 1 {
                value *= (axis.max - axis.min) / units.factor(coordinate.quantity);
                powers.iter_mut().filter(|p| p.0 == coordinate.quantity).for_each(|p| p.1 += 1);
            }
        }
        let factors = powers.iter().filter(|p| p.1 > 0).map(|&(quantity, power)| {
            let symbol = units.symbol(quantity);
            if power == 1 { symbol.to_owned() } else { format!("{symbol}^{power}") }
        });
        let units: Vec<String> = factors.collect();
        (value, if units.is_empty() { "1".to_owned() } else { units.join(" ") })
    }

    fn json(&self, found: &Count, seconds: f64) -> Value {
        let axis = |a: &Axis| json!({ "min": a.min, "max": a.max, "count": a.count });
        let grid: Map<String, Value> =
            self.grid.axes().iter().map(|a| (a.name.clone(), axis(a))).collect();
        let ranges: Map<String, Value> = (self.manipulator.imaginary().iter())
            .zip(&found.imaginary)
            .map(|(joint, range)| (joint.name.clone(), json!(range)))
            .collect();
        let (value, units) = self.measure(found, FileUnits::SI);
        let mut json = json!({
            "poses": found.poses,
            "reachable": found.reachable,
            "fraction": found.reachable as f64 / found.poses as f64,
            "grid": grid,
            "mode": self.mode(),
            "measure": { "value": value, "units": units, "method": "grid" },
            "imaginary_range": ranges,
            "seconds": seconds,
            "poses_per_second": found.poses as f64 / seconds,
        });
        if let Some(ConditionLimit { most, length }) = self.limit {
            json["max_condition"] = most.into();
            json["characteristic_length"] = length.into();
        }
        json
    }

    fn text(&self, found: &Count, seconds: f64) -> String {
        let units = self.loaded.file.units;
        let mut text = self.manipulator.mechanism().name.clone();
        let mode = self.mode();
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let mut axes = Table::new(["grid", ">from", ">to", "unit", ">values"]);
        for (axis, c) in self.grid.axes().iter().zip(self.manipulator.task_coordinates()) {
            let end = |value| text::number(value, c.quantity, units);
            let symbol = units.symbol(c.quantity);
            axes.row([&*axis.name, &end(axis.min), &end(axis.max), symbol, &count(axis.count)]);
        }
        let _ = writeln!(text, "\n\n{axes}");
        if let Some(ConditionLimit { most, length }) = self.limit {
            let length = units.show(length, Quantity::Length);
            let _ = writeln!(text, "condition number at most {most} (lengths over {length})\n");
        }

        let share = 100.0 * found.reachable as f64 / found.poses as f64;
        let (value, measured) = self.measure(found, units);
        let mut results = Table::new(["poses", &format!(">{}", count(found.poses))]);
        results.row(["reachable".into(), count(found.reachable), format!("{} %", short(share))]);
        let _ = write!(text, "{results}");
        if self.grid.poses() > 1 {
            let _ = writeln!(text, "measure {} {measured}", short(value));
        }

        if found.imaginary.iter().any(Option::is_some) {
            let mut ranges = Table::new(["imaginary joint", ">min", ">max", "unit"]);
            for (joint, range) in self.manipulator.imaginary().iter().zip(&found.imaginary) {
                let Some(range) = range else { continue };
                let [low, high] = range.map(|value| text::number(value, joint.quantity, units));
                ranges.row([&*joint.name, &low, &high, units.symbol(joint.quantity)]);
            }
            let _ = write!(text, "\n{ranges}");
        }
        let rate = short(found.poses as f64 / seconds / 1e6);
        let _ = writeln!(text, "\ncounted in {} s, {rate} million poses/s", short(seconds));
        text
    }
}
