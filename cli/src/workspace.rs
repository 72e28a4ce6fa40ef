//! `opm workspace`: sweeps of the workspace.

use crate::args::{CloudArgs, Output, WorkspaceArgs};
use crate::cloud::{Cloud, Wishes};
use crate::failure::Failure;
use crate::kind::{self, Kind, Questions, SetRecording, SetWishes, Study};
use crate::load::{self, Loaded};
use crate::pose::GridAxis;
use crate::progress::{interruptible, watch};
use crate::record::{Recorder, expect_mcap};
use crate::shard;
use crate::source::Source;
use crate::text::{self, Table, count, short};
use crate::velocity::characteristic_length;
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_workspace::{
    Axis, Cancelled, ConditionLimit, ConditioningIndex, Count, Grid, Modes, Progress, Sections,
    Shard, Sweep, default_grid,
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
    kind.check_flags(args)?;
    let length = characteristic_length(args.length, "--length", &manipulator)?;
    let limit = args.max_condition.map(|most| ConditionLimit { most, length });
    kind.check_run(&manipulator, modes, limit)?;
    let given = given_grid(&args.grid, kind, &manipulator)?;
    let wishes = AnyWishes::new(kind, &args.cloud, length, &manipulator)?;
    wishes.check_length(args)?;
    if let Some(path) = &args.cloud.output {
        loaded.refuse_as_output(path, &[])?;
        match args.shard {
            Some(_) => expect_mcap(path, "a shard")?,
            None => Recorder::check_run(path, kind, given.as_ref())?,
        }
    }
    let recorder = match (&args.cloud.output, args.shard) {
        (Some(path), None) => Some(Recorder::create(path)?),
        _ => None,
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
    if let Some(warning) = kind.of_one_orientation(&grid) {
        output.warn(warning);
    }
    let conditioning = args.conditioning.then_some(length);
    let run = Run {
        loaded: &loaded,
        manipulator: &manipulator,
        kind,
        grid: &grid,
        modes,
        limit,
        conditioning,
    };
    let work = Work { output, pool: &pool, progress: &progress };
    if let (Some(shard), Some(path)) = (args.shard, &args.cloud.output) {
        return shard::run(&run, shard, path, args.force, &work);
    }

    let sweep = run.sweep();
    let (mut found, effort) = work.count(&sweep)?;
    let conditioning = work.conditioning(&run, &sweep)?;
    let source = Source::Sweep(sweep);
    let study = Study { conditioning, ..work.study(&run, args.shape, &source, &mut found)? };
    work.warn_of_nothing(&run, &found);
    if let Some(recorder) = recorder {
        work.record(recorder, wishes, &run, &found, &source, &study)?;
    }
    let result = Outcome { run: &run, found: &found, study: &study, effort, shard: None };
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
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        Ok((found, Effort::Counted { poses: sweep.poses(), seconds }))
    }

    /// Sums up the conditioning of the poses of a sweep, if that is asked for.
    pub fn conditioning(
        &self,
        run: &Run<'_>,
        sweep: &Sweep<'_>,
    ) -> Result<Option<ConditioningIndex>, Failure> {
        let Some(length) = run.conditioning else { return Ok(None) };
        let job = || ConditioningIndex::new(sweep, length, self.progress);
        Ok(Some(self.watch("conditioning", sweep.poses(), job)?))
    }

    /// Finds out what else is asked of the poses; of a set that is not theirs, its points are what
    /// is found. All kinds but the poses themselves are asked for their shape.
    pub fn study(
        &self,
        run: &Run<'_>,
        shape: bool,
        source: &Source<'_>,
        found: &mut Count,
    ) -> Result<Study, Failure> {
        let questions = Questions { kind: run.kind, shape: shape || run.kind != Kind::Grid };
        if !questions.need_poses() {
            return Ok(Study::nothing(run.kind));
        }
        let job = || Study::new(questions, source, self.progress);
        let study = self.watch("studying", run.grid.poses(), job)?;
        if let Some(set) = &study.set {
            (found.poses, found.reachable) = (set.points(), set.count());
        }
        Ok(study)
    }

    /// Records every point that was counted.
    pub fn record(
        &self,
        recorder: Recorder,
        wishes: AnyWishes,
        run: &Run<'_>,
        found: &Count,
        source: &Source<'_>,
        study: &Study,
    ) -> Result<(), Failure> {
        let path = match wishes {
            AnyWishes::Poses(wishes) => {
                let cloud = Cloud::new(wishes, run);
                let total = recorder.passes(&cloud) * run.grid.poses();
                let job =
                    || recorder.record(run, &cloud, source, found, Some(study), self.progress);
                self.watch("recording", total, job)?
            }
            AnyWishes::Set(wishes) => {
                let set = SetRecording::new(wishes, run, study)?;
                recorder.record_set(run, &set, found, self.progress)?
            }
        };
        self.output.note(format_args!("{}: {} points", path.display(), count(found.reachable)));
        Ok(())
    }

    /// Says so where there is nothing in reach.
    pub fn warn_of_nothing(&self, run: &Run<'_>, found: &Count) {
        if found.reachable == 0 {
            let nothing = run.kind.nothing(run.limit.is_some());
            let hint =
                run.kind.fewer(run.grid).map_or_else(String::new, |hint| format!("; {hint}"));
            self.output.warn(format_args!("{nothing}{hint}"));
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

/// What the points of a recording are asked to be made of.
pub enum AnyWishes {
    Poses(Wishes),
    Set(SetWishes),
}

impl AnyWishes {
    /// From the flags, each of which is checked; condition numbers have this characteristic length.
    pub fn new(
        kind: Kind,
        args: &CloudArgs,
        length: f64,
        manipulator: &Manipulator,
    ) -> Result<Self, Failure> {
        Ok(match kind.is_of_poses() {
            true => Self::Poses(Wishes::new(args, length, manipulator)?),
            false => Self::Set(SetWishes::new(kind, args, manipulator)?),
        })
    }

    /// Refuses a characteristic length of nothing.
    fn check_length(&self, args: &WorkspaceArgs) -> Result<(), Failure> {
        let valued = matches!(self, Self::Poses(wishes) if wishes.asks_condition());
        if args.length.is_none() || valued || args.conditioning || args.max_condition.is_some() {
            return Ok(());
        }
        let problem = "there is no condition number that it would be of; --max-condition, \
                       --conditioning or --scalars inverse_condition ask for one";
        Err(Failure::flag("--length", problem))
    }
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
    output.note(format_args!("grid fitted to the workspace: {}", grid_flags(&grid)));
    for extent in extents.iter().filter(|extent| extent.unbounded && kind.asks(extent, &grid)) {
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
    pub kind: Kind,
    pub grid: &'a Grid,
    pub modes: Modes,
    pub limit: Option<ConditionLimit>,
    /// Characteristic length of the conditioning index, where that is asked for.
    pub conditioning: Option<f64>,
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

    /// The counted share of the box of the axes of a set of some kind, those with more than one value.
    /// (Those of shards add up.) `None` of values of imaginary joints, which are on no grid.
    pub fn measure(&self, kind: Kind, found: &Count, units: FileUnits) -> Option<(f64, String)> {
        let grid = self.grid;
        if kind == Kind::Imaginary {
            return None;
        }
        let points: u64 = grid.axes()[kind.axes(grid)].iter().map(|axis| axis.count).product();
        let axes = kind.axes(grid).map(|i| (&grid.axes()[i], grid.coordinates()[i].quantity));
        Some(kind::measure(found.reachable as f64 / points as f64, axes, units))
    }
}

/// What it took to count.
#[derive(Clone, Copy, Debug)]
pub enum Effort {
    /// A sweep of so many poses and so long.
    Counted { poses: u64, seconds: f64 },
    /// Sweeps of others, whose times nobody added up.
    Merged { shards: u64 },
    /// A sweep some time ago.
    Earlier,
}

/// What came of a run, to be printed.
pub struct Outcome<'a> {
    pub run: &'a Run<'a>,
    pub found: &'a Count,
    /// What else is known of it.
    pub study: &'a Study,
    pub effort: Effort,
    /// The part of the run that this is of, if it is not the whole.
    pub shard: Option<Shard>,
}

impl Outcome<'_> {
    /// What was counted: by a shard poses, whatever they are of when all are merged.
    fn counted(&self) -> Kind {
        match (self.shard, self.run.kind.sections()) {
            (Some(_), Sections::Whole) => Kind::Grid,
            _ => self.run.kind,
        }
    }

    pub fn json(&self) -> Value {
        let Self { run, found, .. } = self;
        let axis = |a: &Axis| json!({ "min": a.min, "max": a.max, "count": a.count });
        let grid: Map<String, Value> =
            run.grid.axes().iter().map(|a| (a.name.clone(), axis(a))).collect();
        let ranges: Map<String, Value> = (run.manipulator.imaginary().iter())
            .zip(&found.imaginary)
            .map(|(joint, range)| (joint.name.clone(), json!(range)))
            .collect();
        let measure = run.measure(self.counted(), found, FileUnits::SI);
        let measure = measure
            .map(|(value, units)| json!({ "value": value, "units": units, "method": "grid" }));
        let fraction = (found.poses > 0).then(|| found.reachable as f64 / found.poses as f64);
        let mut json = json!({
            "poses": found.poses,
            "reachable": found.reachable,
            "fraction": fraction,
            "grid": grid,
            "mode": run.mode(),
            "measure": measure,
            "imaginary_range": ranges,
            "seconds": self.seconds(),
            "poses_per_second": self.rate(),
        });
        json["kind"] = run.kind.name().into();
        self.study.json(&mut json);
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
        if run.kind != Kind::Grid {
            let _ = write!(text, ", {}", run.kind.title());
        }
        let mode = run.mode();
        if !mode.is_empty() {
            let _ = write!(text, ", mode {mode}");
        }
        if let Some(shard) = self.shard {
            let _ = write!(text, ", shard {shard}");
        }
        let mut axes = Table::new(["grid", ">from", ">to", "unit", ">values"]);
        for (axis, c) in run.grid.axes().iter().zip(run.grid.coordinates()) {
            let end = |value| text::number(value, c.quantity, units);
            let symbol = units.symbol(c.quantity);
            axes.row([&*axis.name, &end(axis.min), &end(axis.max), symbol, &count(axis.count)]);
        }
        let _ = writeln!(text, "\n\n{axes}");
        if let Some(ConditionLimit { most, length }) = run.limit {
            let length = units.show(length, Quantity::Length);
            let _ = writeln!(text, "condition number at most {most} (lengths over {length})\n");
        }

        let share = match found.poses {
            0 => "no poses of its own".to_owned(),
            poses => format!("{} %", short(100.0 * found.reachable as f64 / poses as f64)),
        };
        let points = [self.counted().points(), &format!(">{}", count(found.poses)), ">"];
        let mut results = Table::new(points);
        let reached = self.counted().reached().to_owned();
        results.row([reached, count(found.reachable), share]);
        let _ = write!(text, "{results}");
        if run.grid.poses() > 1
            && let Some((value, measured)) = run.measure(self.counted(), found, units)
        {
            let _ = writeln!(text, "measure {} {measured}", short(value));
        }
        text += &self.study.text(units);

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
            Effort::Counted { poses, seconds } => {
                let rate = short(poses as f64 / seconds / 1e6);
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
            Effort::Counted { seconds, .. } => Some(seconds),
            Effort::Merged { .. } | Effort::Earlier => None,
        }
    }

    /// Poses a second.
    fn rate(&self) -> Option<f64> {
        match self.effort {
            Effort::Counted { poses, seconds } => Some(poses as f64 / seconds),
            Effort::Merged { .. } | Effort::Earlier => None,
        }
    }
}

/// A number of things, told.
pub fn plural(number: u64, what: &str) -> String {
    format!("{} {what}{}", count(number), if number == 1 { "" } else { "s" })
}
