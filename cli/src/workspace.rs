//! `opm workspace`: sweeps of the workspace.

use crate::args::{Output, WorkspaceArgs};
use crate::cloud::{Cloud, Wishes};
use crate::failure::Failure;
use crate::kind::{self, Kind, Questions, SetRecording, SetWishes, Study};
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
    Axis, Cancelled, ConditionLimit, Count, Grid, Modes, Progress, Sections, SetError, Sweep,
    default_grid,
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
    let kind = args.kind;
    kind.check_flags(args, &manipulator)?;
    let length = characteristic_length(args.length, "--length", &manipulator)?;
    let limit = args.max_condition.map(|most| ConditionLimit { most, length });
    let given = given_grid(&args.grid, kind, &manipulator)?;
    let wishes = match kind.is_of_poses() {
        true => AnyWishes::Poses(Wishes::new(args, length, &manipulator)?),
        false => AnyWishes::Set(SetWishes::new(kind, args, &manipulator)?),
    };
    let recorder = match &args.output {
        Some(path) => {
            loaded.refuse_as_output(path, &[])?;
            given.as_ref().filter(|_| kind.is_of_poses()).map_or(Ok(()), Recorder::check)?;
            Some(Recorder::create(path)?)
        }
        None => None,
    };
    let progress = interruptible()?;
    let pool = threads(args.threads)?;
    let grid = match given {
        Some(grid) => grid,
        None => fitted_grid(&manipulator, kind, modes, output, &pool, &progress)?,
    };

    if kind.sections() != Sections::Whole && !manipulator.sections_decide() {
        output.note(
            "a leg that is cut in its lower section has upper joints that are limited, actuated or may \
             be out of reach, which no section alone is asked for: the whole reaches less than both",
        );
    }
    let run = Run { loaded: &loaded, manipulator: &manipulator, kind, grid: &grid, modes, limit };
    let sweep = Sweep::new(&manipulator, &grid, modes).limited(limit);
    let before = progress.done();
    let done = || progress.done() - before;
    let start = Instant::now();
    let job = || pool.install(|| sweep.count(&progress));
    let mut found =
        watch(output, "counting", Some(grid.poses()), done, job).map_err(|Cancelled| {
            let (done, poses) = (count(done()), count(grid.poses()));
            Failure::Interrupted(format!("interrupted; {done} of {poses} poses were decided"))
        })?;
    let seconds = start.elapsed().as_secs_f64().max(1e-9);

    let conditioning = args.conditioning.then_some(length);
    let questions = Questions { kind, shape: args.shape || kind != Kind::Grid, conditioning };
    let before = progress.done();
    let done = || progress.done() - before;
    let job = || pool.install(|| Study::new(&questions, &sweep, &progress));
    let total = questions.passes() * grid.poses();
    let study = watch(output, "studying", Some(total), done, job);
    let study = study.map_err(|error| match error {
        SetError::Cancelled(cancelled) => cancelled.into(),
        SetError::Size { .. } => Failure::Work(format!("--kind {}: {error}", kind.name())),
    })?;
    if let Some(set) = &study.set {
        (found.poses, found.reachable) = (set.points(), set.count());
    }
    if found.reachable == 0 {
        output.warn(kind.nothing(limit.is_some()));
    }

    if let Some(recorder) = recorder {
        let recorded = match wishes {
            AnyWishes::Poses(wishes) => {
                let cloud = Cloud::new(wishes, &run);
                let total = cloud.passes() * grid.poses();
                let before = progress.done();
                let done = || progress.done() - before;
                let job = || recorder.record(&run, &cloud, &sweep, &found, &study, &progress);
                watch(output, "recording", Some(total), done, || pool.install(job))
            }
            AnyWishes::Set(wishes) => {
                let set = SetRecording::new(wishes, &run, &study)?;
                recorder.record_set(&run, &set, &found, &progress)
            }
        };
        output.note(format_args!("{}: {} points", recorded?.display(), count(found.reachable)));
    }
    let (mut json, mut text) = (run.json(&found, seconds), run.text(&found, &study));
    study.json(&mut json);
    let rate = short(grid.poses() as f64 / seconds / 1e6);
    let _ = writeln!(text, "\ncounted in {} s, {rate} million poses/s", short(seconds));
    output.print(&json, text)
}

/// What the points of a recording are asked to be made of.
enum AnyWishes {
    Poses(Wishes),
    Set(SetWishes),
}

/// The grid that the flags give; `None` without flags.
fn given_grid(
    given: &[GridAxis],
    kind: Kind,
    manipulator: &Manipulator,
) -> Result<Option<Grid>, Failure> {
    if given.is_empty() {
        return Ok(None);
    }
    let sections = kind.sections();
    let coordinates = sections.coordinates(manipulator);
    let axes: Result<Vec<_>, _> =
        given.iter().map(|axis| axis.resolve(sections, &coordinates)).collect();
    let grid = Grid::of(sections, manipulator, axes?);
    let grid = grid.map_err(|error| Failure::flag("--grid", error))?;
    kind.check(&grid)?;
    Ok(Some(grid))
}

/// A grid over the whole workspace.
fn fitted_grid(
    manipulator: &Manipulator,
    kind: Kind,
    modes: Modes,
    output: &Output,
    pool: &ThreadPool,
    progress: &Progress,
) -> Result<Grid, Failure> {
    let find = || pool.install(|| default_grid(manipulator, modes, progress));
    let (grid, extents) = watch(output, "fitting a grid", None, || progress.done(), find)
        .map_err(|Cancelled| Failure::Interrupted("interrupted while fitting a grid".into()))?;
    let grid = kind.fit(manipulator, grid);
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
    for extent in extents.iter().filter(|extent| extent.unbounded && kind.asks(extent, &grid)) {
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
    pub kind: Kind,
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

    /// The counted share of the box of the set's axes, those with more than one value.
    pub fn measure(&self, found: &Count, units: FileUnits) -> (f64, String) {
        let Self { kind, grid, .. } = self;
        let fraction = found.reachable as f64 / found.poses as f64;
        let axes = kind.axes(grid).map(|i| (&grid.axes()[i], grid.coordinates()[i].quantity));
        kind::measure(fraction, axes, units)
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
            "poses_per_second": self.grid.poses() as f64 / seconds,
        });
        if let Some(ConditionLimit { most, length }) = self.limit {
            json["max_condition"] = most.into();
            json["characteristic_length"] = length.into();
        }
        json
    }

    fn text(&self, found: &Count, study: &Study) -> String {
        let units = self.loaded.file.units;
        let mut text = self.manipulator.mechanism().name.clone();
        if self.kind != Kind::Grid {
            let _ = write!(text, ", {}", self.kind.title());
        }
        let mode = self.mode();
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        let mut axes = Table::new(["grid", ">from", ">to", "unit", ">values"]);
        for (axis, c) in self.grid.axes().iter().zip(self.grid.coordinates()) {
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
        let points = [self.kind.points(), &format!(">{}", count(found.poses)), ">"];
        let mut results = Table::new(points);
        let reached = self.kind.reached().to_owned();
        results.row([reached, count(found.reachable), format!("{} %", short(share))]);
        let _ = write!(text, "{results}");
        if self.grid.poses() > 1 {
            let _ = writeln!(text, "measure {} {measured}", short(value));
        }
        text += &study.text(units);

        if found.imaginary.iter().any(Option::is_some) {
            let mut ranges = Table::new(["imaginary joint", ">min", ">max", "unit"]);
            for (joint, range) in self.manipulator.imaginary().iter().zip(&found.imaginary) {
                let Some(range) = range else { continue };
                let [low, high] = range.map(|value| text::number(value, joint.quantity, units));
                ranges.row([&*joint.name, &low, &high, units.symbol(joint.quantity)]);
            }
            let _ = write!(text, "\n{ranges}");
        }
        text
    }
}
