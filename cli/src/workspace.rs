//! `opm workspace`: sweeps of the workspace.

use crate::args::{Output, WorkspaceArgs};
use crate::cloud::{Cloud, Wishes};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::pose::GridAxis;
use crate::progress::{interruptible, watch};
use crate::record::Recorder;
use crate::shard;
use crate::source::Source;
use crate::text::{self, Table, count, short};
use crate::velocity::characteristic_length;
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_workspace::{
    Axis, Cancelled, ConditionLimit, Count, Grid, Modes, Progress, Shard, Sweep, default_grid,
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
    let wishes = Wishes::new(&args.cloud, &manipulator)?;
    if let Some(path) = &args.cloud.output {
        loaded.refuse_as_output(path, &[])?;
        given.as_ref().map_or(Ok(()), Recorder::check)?;
    }
    let recorder = match (&args.cloud.output, args.shard) {
        (Some(path), None) => Some(Recorder::create(path)?),
        _ => None,
    };
    let progress = interruptible()?;
    let pool = threads(args.threads)?;
    let grid = match given {
        Some(grid) => grid,
        None => fitted_grid(&manipulator, modes, output, &pool, &progress)?,
    };
    let run = Run { loaded: &loaded, manipulator: &manipulator, grid: &grid, modes, limit };
    let work = Work { output, pool: &pool, progress: &progress };
    if let (Some(shard), Some(path)) = (args.shard, &args.cloud.output) {
        return shard::run(&run, shard, path, args.force, &work);
    }

    let sweep = run.sweep();
    let (found, effort) = work.count(&sweep)?;
    work.warn_of_nothing(&run, &found);
    if let Some(recorder) = recorder {
        work.record(recorder, wishes, &run, &found, &Source::Sweep(sweep))?;
    }
    let result = Outcome { run: &run, found: &found, effort, shard: None };
    output.print(&result.json(), result.text())
}

/// Where the work is done, and who is told of it.
pub struct Work<'a> {
    pub output: &'a Output,
    pub pool: &'a ThreadPool,
    pub progress: &'a Progress,
}

impl Work<'_> {
    /// Counts the poses of a sweep.
    pub fn count(&self, sweep: &Sweep<'_>) -> Result<(Count, Effort), Failure> {
        let start = Instant::now();
        let poses = sweep.poses();
        let before = self.progress.done();
        let job = || sweep.count(self.progress);
        let found = self.watch("counting", poses, job).map_err(|Cancelled| {
            let (done, poses) = (count(self.progress.done() - before), count(poses));
            Failure::Interrupted(format!("interrupted; {done} of {poses} poses were decided"))
        })?;
        Ok((found, Effort::Counted { seconds: start.elapsed().as_secs_f64().max(1e-9) }))
    }

    /// Records every point that was counted.
    pub fn record(
        &self,
        recorder: Recorder,
        wishes: Wishes,
        run: &Run<'_>,
        found: &Count,
        source: &Source<'_>,
    ) -> Result<(), Failure> {
        let cloud = Cloud::new(wishes, run);
        let total = cloud.passes() * run.grid.poses();
        let job = || recorder.record(run, &cloud, source, found, self.progress);
        let path = self.watch("recording", total, job)?;
        self.output.note(format_args!("{}: {} points", path.display(), count(found.reachable)));
        Ok(())
    }

    /// Says so where there is nothing in reach.
    pub fn warn_of_nothing(&self, run: &Run<'_>, found: &Count) {
        if found.reachable == 0 {
            self.output.warn(match run.limit {
                Some(_) => {
                    "no pose of the grid is in reach, within the limits and well conditioned"
                }
                None => "no pose of the grid is in reach and within the limits",
            });
        }
    }

    /// Does a job on the threads while a bar shows how far it has come.
    pub fn watch<T: Send>(
        &self,
        label: &'static str,
        poses: u64,
        job: impl FnOnce() -> T + Send,
    ) -> T {
        let before = self.progress.done();
        let done = || self.progress.done() - before;
        watch(self.output, label, Some(poses), done, || self.pool.install(job))
    }
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
    output.note(format_args!("grid fitted to the workspace: {}", grid_flags(&grid)));
    for extent in extents.iter().filter(|extent| extent.unbounded) {
        output.warn(format_args!(
            "the workspace goes on beyond this grid along {}; limit a joint, or give --grid",
            extent.name
        ));
    }
    Ok(grid)
}

/// The flags that ask for a grid, in SI.
pub fn grid_flags(grid: &Grid) -> String {
    let flags: Vec<String> = (grid.axes().iter())
        .map(|Axis { name, min, max, count }| match count {
            1 => format!("--grid {name}={min}"),
            _ => format!("--grid {name}={min}:{max}:{count}"),
        })
        .collect();
    flags.join(" ")
}

/// A pool of so many threads, or of one a processor.
pub fn threads(number: Option<u16>) -> Result<ThreadPool, Failure> {
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

impl<'a> Run<'a> {
    /// The sweep of it.
    pub fn sweep(&self) -> Sweep<'a> {
        Sweep::new(self.manipulator, self.grid, self.modes).limited(self.limit)
    }

    /// `any`, or the signs of the mode.
    pub fn mode(&self) -> String {
        match self.modes {
            Modes::Any => "any".to_owned(),
            Modes::One(mode) => self.manipulator.format_mode(mode),
        }
    }

    /// The counted share of the grid's box, over the axes with more than one value. (Those of shards
    /// add up.)
    pub fn measure(&self, found: &Count, units: FileUnits) -> (f64, String) {
        let mut value = found.reachable as f64 / self.grid.poses() as f64;
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
}

/// What it took to count.
#[derive(Clone, Copy, Debug)]
pub enum Effort {
    /// A sweep of so long.
    Counted { seconds: f64 },
    /// Sweeps of others, whose times nobody added up.
    Merged { shards: u64 },
    /// A sweep some time ago.
    Earlier,
}

/// What came of a run, to be printed.
pub struct Outcome<'a> {
    pub run: &'a Run<'a>,
    pub found: &'a Count,
    pub effort: Effort,
    /// The part of the run that this is of, if it is not the whole.
    pub shard: Option<Shard>,
}

impl Outcome<'_> {
    pub fn json(&self) -> Value {
        let Self { run, found, .. } = self;
        let axis = |a: &Axis| json!({ "min": a.min, "max": a.max, "count": a.count });
        let grid: Map<String, Value> =
            run.grid.axes().iter().map(|a| (a.name.clone(), axis(a))).collect();
        let ranges: Map<String, Value> = (run.manipulator.imaginary().iter())
            .zip(&found.imaginary)
            .map(|(joint, range)| (joint.name.clone(), json!(range)))
            .collect();
        let (value, units) = run.measure(found, FileUnits::SI);
        let mut json = json!({
            "poses": found.poses,
            "reachable": found.reachable,
            "fraction": found.reachable as f64 / found.poses as f64,
            "grid": grid,
            "mode": run.mode(),
            "measure": { "value": value, "units": units, "method": "grid" },
            "imaginary_range": ranges,
            "seconds": self.seconds(),
            "poses_per_second": self.seconds().map(|seconds| found.poses as f64 / seconds),
        });
        if let Some(shard) = self.shard {
            json["shard"] = shard.to_string().into();
        }
        if let Some(ConditionLimit { most, length }) = run.limit {
            json["max_condition"] = most.into();
            json["characteristic_length"] = length.into();
        }
        json
    }

    pub fn text(&self) -> String {
        let Self { run, found, .. } = self;
        let units = run.loaded.file.units;
        let mut text = run.manipulator.mechanism().name.clone();
        let mode = run.mode();
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        if let Some(shard) = self.shard {
            let _ = write!(text, ", shard {shard}");
        }
        let mut axes = Table::new(["grid", ">from", ">to", "unit", ">values"]);
        for (axis, c) in run.grid.axes().iter().zip(run.manipulator.task_coordinates()) {
            let end = |value| text::number(value, c.quantity, units);
            let symbol = units.symbol(c.quantity);
            axes.row([&*axis.name, &end(axis.min), &end(axis.max), symbol, &count(axis.count)]);
        }
        let _ = writeln!(text, "\n\n{axes}");
        if let Some(ConditionLimit { most, length }) = run.limit {
            let length = units.show(length, Quantity::Length);
            let _ = writeln!(text, "condition number at most {most} (lengths over {length})\n");
        }

        let share = 100.0 * found.reachable as f64 / found.poses as f64;
        let (value, measured) = run.measure(found, units);
        let mut results = Table::new(["poses", &format!(">{}", count(found.poses))]);
        results.row(["reachable".into(), count(found.reachable), format!("{} %", short(share))]);
        let _ = write!(text, "{results}");
        if run.grid.poses() > 1 {
            let _ = writeln!(text, "measure {} {measured}", short(value));
        }

        if found.imaginary.iter().any(Option::is_some) {
            let mut ranges = Table::new(["imaginary joint", ">min", ">max", "unit"]);
            for (joint, range) in run.manipulator.imaginary().iter().zip(&found.imaginary) {
                let Some(range) = range else { continue };
                let [low, high] = range.map(|value| text::number(value, joint.quantity, units));
                ranges.row([&*joint.name, &low, &high, units.symbol(joint.quantity)]);
            }
            let _ = write!(text, "\n{ranges}");
        }
        let _ = match self.effort {
            Effort::Counted { seconds } => {
                let rate = short(found.poses as f64 / seconds / 1e6);
                writeln!(text, "\ncounted in {} s, {rate} million poses/s", short(seconds))
            }
            Effort::Merged { shards } => {
                writeln!(text, "\nmerged from {}", plural(shards, "shard"))
            }
            Effort::Earlier => Ok(()),
        };
        text
    }

    /// The time of the count; `None` where it was counted elsewhere.
    fn seconds(&self) -> Option<f64> {
        match self.effort {
            Effort::Counted { seconds } => Some(seconds),
            Effort::Merged { .. } | Effort::Earlier => None,
        }
    }
}

fn plural(number: u64, what: &str) -> String {
    format!("{} {what}{}", count(number), if number == 1 { "" } else { "s" })
}
