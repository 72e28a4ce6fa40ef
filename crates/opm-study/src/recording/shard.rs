//! The file of a shard: written, read back and checked.

use super::describe::{conditioning, conditioning_of, describe_sharded, range_key, ranges};
use super::{Attachment, create, partial, record};
use crate::error::{ShardError, ShardProblem, StudyError};
use crate::poses::runs_of;
use crate::workspace::Workspace;
use opm_mcap::shard::RUNS_TOPIC;
use opm_mcap::{Metadata, PartialFile, RecordError, Recording, ShardRecorder};
use opm_workspace::{ConditioningIndex, Count, Progress, Shard, Sweep};
use std::path::{Path, PathBuf};

/// The result of the sweep of a shard, or of all shards together.
#[derive(Clone, Debug)]
pub struct ShardCount {
    /// The number of poses in reach.
    pub count: Count,
    /// Their conditioning, if it was requested.
    pub conditioning: Option<ConditioningIndex>,
}

/// An open file for a shard.
#[derive(Debug)]
pub struct ShardRecording {
    path: PathBuf,
    file: PartialFile,
}

/// The content of a shard: the workspace, the part of it, and the result.
#[derive(Clone, Copy)]
pub struct ShardFindings<'a> {
    /// The file of the mechanism.
    pub mechanism: Attachment<'a>,
    /// The name of the mechanism in the request: a path, or the name of an example.
    pub mechanism_label: &'a str,
    /// The whole workspace.
    pub workspace: &'a Workspace,
    /// The part.
    pub shard: Shard,
    /// The result for the part.
    pub found: &'a ShardCount,
}

impl ShardRecording {
    /// Opens a file before the work starts.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(path: &Path) -> Result<Self, StudyError> {
        Ok(Self { path: path.to_owned(), file: create(path)? })
    }

    /// Sweeps the shard again, and stores its poses.
    ///
    /// # Errors
    /// The file cannot be written, or the work was cancelled. Then [`partial`] names the unfinished file,
    /// which is not a shard.
    pub fn write(
        self,
        findings: &ShardFindings<'_>,
        progress: &Progress,
    ) -> Result<(), StudyError> {
        let ShardFindings { mechanism, mechanism_label, workspace, shard, found } = *findings;
        let failed = |error: RecordError| StudyError::record(self.path.display(), error);
        let header = opm_mcap::Shard {
            mechanism_name: mechanism.name,
            mechanism: mechanism.text.as_bytes(),
            run: describe_sharded(workspace, mechanism),
            shard: record([("shard", shard.to_string()), ("file", mechanism_label.to_owned())]),
        };
        let mut recorder = ShardRecorder::new(self.file, &header).map_err(failed)?;
        let sweep = workspace.sweep().shard(shard);
        let written = write_runs(&mut recorder, &sweep, progress, failed);
        written.map_err(|error| match error {
            StudyError::Cancelled => StudyError::CancelledShard { partial: partial(&self.path) },
            other => other,
        })?;
        let ShardCount { count, conditioning: index } = found;
        let mut result = ranges(workspace, count);
        result.extend(index.iter().flat_map(conditioning));
        result.insert("poses".into(), count.poses.to_string());
        result.insert("reachable".into(), count.reachable.to_string());
        recorder.finish(&result).map_err(failed)
    }
}

/// Writes the numbers of the poses. Runs that continue from row to row are written as one.
fn write_runs(
    recorder: &mut ShardRecorder<'_>,
    sweep: &Sweep<'_>,
    progress: &Progress,
    failed: impl Fn(RecordError) -> StudyError + Sync,
) -> Result<(), StudyError> {
    // The last run so far; the next one may continue it.
    let mut open = [0; 2];
    sweep.points(
        progress,
        |hits, made: &mut Vec<[u64; 2]>| {
            made.extend(hits.numbers(sweep.grid()).map(|run| [run.from, run.to]));
        },
        Vec::new,
        |made| {
            made.into_iter().try_for_each(|[from, to]| {
                let [start, end] = open;
                open = if from == end { [start, to] } else { [from, to] };
                if from == end || start == end {
                    return Ok(());
                }
                recorder.push(start, end).map_err(&failed)
            })
        },
    )?;
    let [start, end] = open;
    if start < end { recorder.push(start, end).map_err(failed) } else { Ok(()) }
}

/// The file of a shard, completely read.
pub struct StoredShard {
    path: PathBuf,
    shard: Shard,
    recording: Recording,
    /// The range of the poses: the first one, and one past the last.
    poses: Option<[u64; 2]>,
    reachable: u64,
}

impl StoredShard {
    /// Reads a file, and checks that it is the file of a shard and complete.
    ///
    /// # Errors
    /// The file cannot be read, or is not the file of a shard.
    pub fn open(path: &Path) -> Result<Self, StudyError> {
        let wrong = |problem| -> StudyError {
            ShardError { file: path.display().to_string(), problem }.into()
        };
        let mut poses: Option<[u64; 2]> = None;
        let mut reachable = 0;
        let recording = runs_of(path, |runs| {
            for run in runs {
                let [first, end] = poses.unwrap_or([run.from; 2]);
                if run.from < end {
                    return Err(wrong(ShardProblem::Order { pose: run.from, end }));
                }
                poses = Some([first, run.to]);
                reachable += run.to - run.from;
            }
            Ok(())
        })?;
        let known = recording.metadata("shard").and_then(|record| record.get("shard"));
        let Some(shard) = known.and_then(|text| text.parse().ok()) else {
            return Err(wrong(match recording.complete {
                true => ShardProblem::NoShard,
                false => ShardProblem::CutShortEarly,
            }));
        };
        if recording.topic(RUNS_TOPIC).is_none() || recording.metadata("run").is_none() {
            return Err(wrong(ShardProblem::UnknownShard));
        }
        if !recording.complete {
            return Err(wrong(ShardProblem::CutShort));
        }
        Ok(Self { path: path.to_owned(), shard, recording, poses, reachable })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The part of the workspace that it is.
    pub fn shard(&self) -> Shard {
        self.shard
    }

    /// The mechanism file that is attached.
    ///
    /// # Errors
    /// No mechanism file is attached.
    pub fn mechanism(&self) -> Result<Attachment<'_>, ShardError> {
        let attached = self.recording.attachments.first();
        let attached = attached.and_then(|attached| {
            let content = attached.content.as_deref()?;
            let text = std::str::from_utf8(content).ok()?;
            Some(Attachment { name: &attached.name, text })
        });
        attached.ok_or_else(|| self.wrong(ShardProblem::NoMechanism))
    }

    /// The name of the mechanism in the request.
    pub fn mechanism_label(&self) -> Option<&str> {
        self.record("shard").get("file").map(String::as_str)
    }

    /// Its description of the whole workspace.
    pub(super) fn run(&self) -> &Metadata {
        self.record("run")
    }

    /// Its result, if it is this shard of this workspace.
    ///
    /// # Errors
    /// It is another shard, or incomplete.
    pub fn count_of(
        &self,
        workspace: &Workspace,
        mechanism: Attachment<'_>,
        shard: Shard,
    ) -> Result<ShardCount, ShardError> {
        if self.shard != shard {
            let problem = ShardProblem::OtherShard { found: self.shard, expected: shard };
            return Err(self.wrong(problem));
        }
        self.expect_run(&describe_sharded(workspace, mechanism), mechanism.text)?;
        self.count(workspace)
    }

    /// Refuses a shard of another workspace.
    pub(super) fn expect_run(&self, run: &Metadata, mechanism: &str) -> Result<(), ShardError> {
        let found = self.run();
        let keys = run.keys().chain(found.keys().filter(|key| !run.contains_key(*key)));
        for key in keys {
            let (found, expected) = (found.get(key).cloned(), run.get(key).cloned());
            if found != expected {
                let key = key.clone();
                return Err(self.wrong(ShardProblem::OtherRun { key, found, expected }));
            }
        }
        if self.mechanism()?.text != mechanism {
            return Err(self.wrong(ShardProblem::OtherMechanism));
        }
        Ok(())
    }

    /// Its result, once it is known to belong to this workspace.
    pub(super) fn count(&self, workspace: &Workspace) -> Result<ShardCount, ShardError> {
        let length = workspace.conditioning_length();
        let conditioning = length.map(|length| self.conditioning(length)).transpose()?;
        Ok(ShardCount { count: self.poses_counted(workspace)?, conditioning })
    }

    fn conditioning(&self, length: f64) -> Result<ConditioningIndex, ShardError> {
        conditioning_of(self.record("result"), length)
            .filter(|index| index.poses == self.reachable)
            .ok_or_else(|| self.wrong(ShardProblem::Conditioning))
    }

    fn poses_counted(&self, workspace: &Workspace) -> Result<Count, ShardError> {
        let result = self.record("result");
        let sweep = workspace.sweep().shard(self.shard);
        let mut count = Count::nothing(&workspace.manipulator);
        for (range, joint) in count.imaginary.iter_mut().zip(workspace.manipulator.imaginary()) {
            let Some(text) = result.get(&range_key(&joint.name)) else { continue };
            let ends = text
                .split_once(':')
                .and_then(|(low, high)| Some([low.parse().ok()?, high.parse().ok()?]));
            let wrong = || self.wrong(ShardProblem::Range { text: text.clone() });
            *range = Some(ends.ok_or_else(wrong)?);
        }
        count.poses = sweep.poses();
        count.reachable = self.reachable;
        let said = |key: &str| result.get(key).and_then(|text| text.parse::<u64>().ok());
        let within = self.poses.is_none_or(|[first, end]| {
            let part = sweep.range();
            part.start <= first && end <= part.end
        });
        let consistent =
            said("poses") == Some(count.poses) && said("reachable") == Some(count.reachable);
        if !(within && consistent) {
            return Err(self.wrong(ShardProblem::Poses));
        }
        Ok(count)
    }

    fn record(&self, name: &str) -> &Metadata {
        static NOTHING: Metadata = Metadata::new();
        self.recording.metadata(name).unwrap_or(&NOTHING)
    }

    pub(super) fn wrong(&self, problem: ShardProblem) -> ShardError {
        ShardError { file: self.path.display().to_string(), problem }
    }
}
