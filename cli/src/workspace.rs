//! `opm workspace`: sweeps of the workspace.
//!
//! The steps are: flags, request, sweep, analysis, recording, output.

pub mod advice;
mod aspects;
mod explain;
mod inscribed;
mod report;
mod several;
mod work;

pub use advice::grid_flags;
pub use report::{Effort, Outcome};
pub use work::{Work, threads};

use crate::args::{CloudArgs, Output, WorkspaceArgs};
use crate::failure::Failure;
use crate::interference;
use crate::load::{self, Loaded};
use crate::output::Shown;
use crate::pose::GridAxis;
use crate::progress::interruptible;
use crate::text::{count, plural};
use crate::unitless;
use opm_core::manipulator::Manipulator;
use opm_study::recording::{
    self, Findings, ShardCount, ShardFindings, ShardRecording, StoredShard, WorkspaceRecording,
};
use opm_study::{Analysis, PointOptions, Workspace, WorkspaceRequest};
use opm_workspace::{Modes, Sections, Shard};
use std::path::Path;
use std::sync::Arc;

pub fn run(args: &WorkspaceArgs, output: &Output) -> Result<(), Failure> {
    let loaded = load::open(&args.mechanism, output)?;
    if let Some(vary) = &args.vary {
        return several::vary(args, &loaded, vary, output);
    }
    if args.all_modes {
        return several::all_modes(args, &loaded, output);
    }
    let manipulator = Arc::new(loaded.compile()?);
    let request = request(args, &manipulator)?.check(Arc::clone(&manipulator))?;
    request.refuse_unused_length()?;
    if args.shard.is_none() {
        // What is stored with the points of shards is asked for when they are merged.
        request.refuse_unused_setup()?;
    }
    let path = args.cloud.output.as_deref();
    // Before there is a file that nobody would be told of.
    let progress = interruptible()?;
    if let Some(path) = path {
        loaded.refuse_as_output(path, &[])?;
    }
    let recording = match (path, args.shard) {
        (Some(path), None) => Some(WorkspaceRecording::create(path, &request)?),
        (Some(path), Some(_)) => {
            recording::expect_mcap(path, "a shard")?;
            None
        }
        (None, _) => None,
    };
    if args.explain && args.kind.sections() != Sections::Whole {
        let problem = format!("is of poses, and --kind {} has none", args.kind.name());
        return Err(Failure::flag("--explain", problem));
    }
    let ends = args.grid.iter().flat_map(GridAxis::ends);
    unitless::note_ranges(output, "--grid", (&loaded, &manipulator), ends);
    interference::note_clearance(output, args.clearance, (&loaded, &manipulator));
    let work = Work { output, pool: &threads(args.threads)?, progress: &progress };
    let workspace = work.fit(request, loaded.file.units)?;
    advice::before(&workspace, output);
    if let (Some(shard), Some(path)) = (args.shard, path) {
        return sweep_shard(
            &workspace,
            &loaded,
            ShardFile { shard, path, force: args.force },
            &work,
        );
    }

    let (found, effort, poses) = if recording.is_some() || workspace.needs_points() {
        work.count_and_keep(&workspace)?
    } else {
        let (found, effort) = work.count(&workspace, Shard::WHOLE)?;
        (found, effort, workspace.poses())
    };
    let poses = &poses;
    let analysis = work.analyse(&workspace, found, poses)?;
    advice::after(&workspace, &analysis, output);
    let inscribed = inscribed::find(args, &workspace, &analysis)?;
    let rejections = if args.explain { Some(work.explain(&workspace)?) } else { None };
    if let Some(recording) = recording {
        let mechanism = loaded.attachment();
        let inscribed = inscribed.as_ref().and_then(inscribed::FoundInscribed::shape);
        let (workspace, analysis) = (&workspace, &analysis);
        let rejections = rejections.as_ref();
        let findings = Findings { mechanism, workspace, poses, analysis, inscribed, rejections };
        work.record(recording, &findings)?;
    }
    let units = loaded.file.units;
    let outcome =
        Outcome { workspace: &workspace, analysis: &analysis, effort, shard: None, units };
    let (mut json, mut text) = (outcome.json(), outcome.text());
    if let Some(found) = inscribed {
        json["inscribed"] = found.json();
        text += &found.text(units);
    }
    if let Some(found) = rejections {
        let report = explain::Report { workspace: &workspace, found: &found };
        json["explain"] = report.json();
        text += &report.text(units);
    }
    output.print(&json, text)
}

/// The request that the flags make.
fn request(args: &WorkspaceArgs, manipulator: &Manipulator) -> Result<WorkspaceRequest, Failure> {
    let mut request = WorkspaceRequest::new(args.kind);
    request.modes = Some(modes(&args.mode, manipulator)?);
    let coordinates = args.kind.sections().coordinates(manipulator);
    let axes = args.grid.iter().map(|axis| axis.resolve(&coordinates));
    request.axes = axes.collect::<Result<_, _>>()?;
    request.setup = args.setup.options(args.length)?;
    request.max_condition = args.max_condition;
    request.clearance = interference::clearance(args.clearance)?;
    request.limits = args.limit.iter().map(|limit| (limit.name.clone(), limit.bound)).collect();
    request.conditioning = args.conditioning;
    request.shape = args.shape || args.inscribed.is_some();
    request.points = points(&args.cloud);
    Ok(request)
}

/// The working modes that `--mode` names.
pub fn modes(given: &str, manipulator: &Manipulator) -> Result<Modes, Failure> {
    match given {
        "any" => Ok(Modes::Any),
        mode => Ok(Modes::One(load::mode(manipulator, mode)?)),
    }
}

/// The values of every point that the flags request.
pub fn points(CloudArgs { output: _, axes, color, scalars, scale }: &CloudArgs) -> PointOptions {
    let scale = scale.unwrap_or_default();
    PointOptions { axes: axes.clone(), scalars: scalars.clone(), color: color.clone(), scale }
}

/// The requested part of a sweep, and its output file.
struct ShardFile<'a> {
    shard: Shard,
    path: &'a Path,
    /// Whether it replaces an existing file.
    force: bool,
}

/// Sweeps a shard and writes its file, unless the file exists.
fn sweep_shard(
    workspace: &Workspace,
    loaded: &Loaded,
    ShardFile { shard, path, force }: ShardFile<'_>,
    work: &Work<'_>,
) -> Result<(), Failure> {
    let output = work.output;
    let (found, effort) = if path.is_file() && !force {
        let stored = StoredShard::open(path);
        let found =
            stored.and_then(|stored| Ok(stored.count_of(workspace, loaded.attachment(), shard)?));
        let found = found.map_err(|error| match Failure::from(error) {
            Failure::Work(problem) => Failure::Work(problem.reworded(|problem| {
                format!("{problem}; use another name, or --force to replace it")
            })),
            other => other,
        })?;
        output.note(format_args!("{}: shard {shard} is there already", path.shown()));
        (found, Effort::Earlier)
    } else {
        let recording = ShardRecording::create(path)?;
        let (found, effort) = work.count(workspace, shard)?;
        let (mechanism, mechanism_label) = (loaded.attachment(), &*loaded.label);
        let findings =
            ShardFindings { mechanism, mechanism_label, workspace, shard, found: &found };
        work.record_shard(recording, &findings)?;
        let (reachable, poses) = (count(found.count.reachable), count(found.count.poses));
        let path = path.shown();
        output.note(format_args!("{path}: shard {shard}, {reachable} of {poses} poses"));
        (found, effort)
    };
    let ShardCount { count: poses, conditioning } = found;
    let mut analysis = Analysis::of_count(workspace.kind(), poses);
    analysis.conditioning = conditioning;
    if analysis.count.poses == 0 {
        let pieces = plural(workspace.sweep().pieces(), "piece");
        let of = count(shard.count());
        output.note(format_args!(
            "shard {shard} has no poses: the sweep comes in {pieces}, fewer than {of} shards"
        ));
    }
    let (shard, units) = (Some(shard), loaded.file.units);
    let outcome = Outcome { workspace, analysis: &analysis, effort, shard, units };
    output.print(&outcome.json(), outcome.text())
}
