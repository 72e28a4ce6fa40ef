//! `opm merge`: joins the shards of a sweep to the result of a single run.

use crate::args::{MergeArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::Shown;
use crate::progress::{interruptible, watch_reading};
use crate::text::shell_word;
use crate::workspace::{Effort, Outcome, Work, advice, grid_flags, points, threads};
use opm_core::mechanism::file::FileUnits;
use opm_study::recording::{Attachment, Findings, Shards, StoredShard, WorkspaceRecording};
use opm_study::{MissingShards, StudyError, Workspace, WorkspaceKind, setup_fields};
use opm_workspace::{PoseLimit, Progress};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// Largest number of missing shards whose commands are listed one by one.
const COMMANDS: usize = 8;

pub fn run(args: &MergeArgs, output: &Output) -> Result<(), Failure> {
    let progress = interruptible()?;
    let pool = threads(args.threads)?;
    let shards = read(&args.parts, output, &progress)?;
    let (Attachment { name, text }, label) = shards.mechanism()?;
    let loaded = load::attached(label, name, text).map_err(|failure| match failure {
        Failure::Work(problem) => Failure::Work(problem.reworded(|problem| {
            format!("{}: attached file {problem}", shards.first().path().shown())
        })),
        other => other,
    })?;
    let workspace = shards.workspace(loaded.compile()?)?.with_shape(args.shape);
    let found = shards.join(&workspace).map_err(|error| match error {
        StudyError::MissingShards(missing) => {
            with_commands(&missing, &workspace, label, shards.first())
        }
        other => other.into(),
    })?;

    let work = Work { output, pool: &pool, progress: &progress };
    let setup = workspace.setup();
    let points = points(&args.cloud).choose(workspace.kind(), workspace.manipulator(), setup)?;
    let recording = match &args.cloud.output {
        Some(path) => {
            loaded.refuse_as_output(path, &shards.paths().collect::<Vec<_>>())?;
            Some(WorkspaceRecording::of_workspace(path, &workspace, points)?)
        }
        None => None,
    };
    let poses = &shards.poses(&workspace);
    let analysis = work.analyse(&workspace, found, poses)?;
    advice::after(&workspace, &analysis, output);
    if let Some(recording) = recording {
        let mechanism = loaded.attachment();
        let (workspace, analysis) = (&workspace, &analysis);
        let findings =
            Findings { mechanism, workspace, poses, analysis, inscribed: None, rejections: None };
        work.record(recording, &findings)?;
    }
    let effort = Effort::Merged { shards: args.parts.len() as u64 };
    let units = loaded.file.units;
    let outcome =
        Outcome { workspace: &workspace, analysis: &analysis, effort, shard: None, units };
    output.print(&outcome.json(), outcome.text())
}

/// Reads the files of all shards.
fn read(parts: &[PathBuf], output: &Output, progress: &Progress) -> Result<Shards, Failure> {
    let files = AtomicU64::new(0);
    let read = || -> Result<Vec<StoredShard>, Failure> {
        let parts = parts.iter().map(|path| {
            if progress.is_cancelled() {
                return Err(StudyError::Cancelled.into());
            }
            files.fetch_add(1, Ordering::Relaxed);
            Ok(StoredShard::open(path)?)
        });
        parts.collect()
    };
    let total = Some(parts.len() as u64);
    let stored = watch_reading(output, total, || files.load(Ordering::Relaxed), read)?;
    Ok(Shards::new(stored)?)
}

/// The message that names the missing shards and the commands that make them.
fn with_commands(
    missing: &MissingShards,
    workspace: &Workspace,
    label: &str,
    part: &StoredShard,
) -> Failure {
    let mut message = missing.to_string();
    for number in missing.numbers().take(COMMANDS) {
        message += &format!("\n  {}", command(workspace, label, part, number, missing.of));
    }
    if missing.count() > COMMANDS as u64 {
        message += "\n  and so on for the others";
    }
    Failure::work(message)
}

/// The command that makes a shard.
fn command(workspace: &Workspace, label: &str, part: &StoredShard, number: u64, of: u64) -> String {
    let mut command = format!("opm workspace {}", shell_word(label));
    if workspace.kind() != WorkspaceKind::Grid {
        command += &format!(" --kind {}", workspace.kind());
    }
    command += &format!(" {}", grid_flags(workspace.grid(), FileUnits::SI));
    let mode = workspace.mode_name();
    if !mode.is_empty() {
        command += &format!(" --mode {}", shell_word(&mode));
    }
    let (limit, conditioning) = (workspace.limit(), workspace.conditioning_length());
    if let Some(most) = limit.and_then(opm_workspace::PoseLimit::max_condition) {
        command += &format!(" --max-condition {most}");
    }
    if let Some(clearance) = workspace.clearance() {
        command += &format!(" --clearance {}", clearance.least);
    }
    for (option, value) in setup_fields(workspace.setup(), workspace.manipulator()) {
        command += &format!(" --{} {value}", option.replace('_', "-"));
    }
    for (index, bound) in limit.iter().flat_map(|limit| limit.indices.iter()) {
        command += &format!(" --limit {index}={bound}");
    }
    if conditioning.is_some() {
        command += " --conditioning";
    }
    if let Some(length) = conditioning.or(limit.map(PoseLimit::length)) {
        command += &format!(" --length {length}");
    }
    let output = named_like(part, number);
    command + &format!(" --shard {number}/{of} -o {}", shell_word(&output.display().to_string()))
}

/// A file name for another shard, made from that of a part: its number replaces the part's.
fn named_like(part: &StoredShard, number: u64) -> PathBuf {
    let name = part.path().file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let own = part.shard().number();
    let ends = name.char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(at, _)| at + 1);
    let place = ends.rev().find_map(|end| {
        let digits = name[..end].trim_end_matches(|c: char| c.is_ascii_digit()).len();
        (name[digits..end].parse() == Ok(own)).then_some((digits, end))
    });
    let name = match place {
        Some((start, end)) => {
            format!("{}{number:0width$}{}", &name[..start], &name[end..], width = end - start)
        }
        None => format!("part-{number}.mcap"),
    };
    part.path().with_file_name(name)
}
