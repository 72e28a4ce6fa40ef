//! Shards of a sweep: which run one belongs to, its file, and what that says.

use crate::failure::Failure;
use crate::kind::Study;
use crate::record::{create, describe, partial, range_key, ranges};
use crate::source::runs_of;
use crate::text::count;
use crate::workspace::{Effort, Outcome, Run, Work, plural};
use opm_mcap::{Metadata, RecordError, Recording, ShardRecorder, shard::RUNS_TOPIC};
use opm_workspace::{ConditioningIndex, Count, Progress, Shard, Sweep};
use std::path::Path;

/// Sweeps a shard and writes its file, unless that is there.
pub fn run(
    run: &Run<'_>,
    shard: Shard,
    path: &Path,
    force: bool,
    work: &Work<'_>,
) -> Result<(), Failure> {
    let outcome = |Part { found, conditioning }: &Part, effort| {
        let study = &Study { conditioning: *conditioning, ..Study::nothing(run.kind) };
        let outcome = Outcome { run, found, study, effort, shard: Some(shard) };
        if found.poses == 0 {
            let pieces = plural(run.sweep().pieces(), "piece");
            let of = count(shard.count());
            work.output.note(format_args!(
                "shard {shard} has no poses: the sweep comes in {pieces}, fewer than {of} shards"
            ));
        }
        work.output.print(&outcome.json(), outcome.text())
    };
    if path.is_file() && !force {
        let found =
            Stored::open(path).and_then(|stored| stored.of(run, shard)).map_err(|other| {
                let hint = "use another name, or --force to replace it";
                match other {
                    Failure::Work(problem) => Failure::Work(format!("{problem}; {hint}")),
                    other => other,
                }
            })?;
        work.output.note(format_args!("{}: shard {shard} is there already", path.display()));
        return outcome(&found, Effort::Earlier);
    }
    let file = create(path)?;
    let sweep = run.sweep().shard(shard);
    let (found, effort) = work.count(&sweep)?;
    let conditioning = work.conditioning(run, &sweep)?;
    let failed = |error: RecordError| Failure::at(path.display(), &error);
    let header = opm_mcap::Shard {
        mechanism_name: &run.loaded.file_name,
        mechanism: run.loaded.text.as_bytes(),
        run: describe_whole(run),
        shard: describe_shard(run, shard),
    };
    let mut recorder = ShardRecorder::new(file, &header).map_err(failed)?;
    let record = || write(&mut recorder, run, &sweep, work.progress, failed);
    work.watch("recording", sweep.poses(), record).map_err(|failure| match failure {
        Failure::Interrupted(message) => Failure::Interrupted(format!(
            "{message}; {} is no whole shard: sweep it again",
            partial(path).display()
        )),
        other => other,
    })?;
    let mut result = ranges(run, &found);
    result.extend(conditioning.iter().flat_map(describe_conditioning));
    result.insert("poses".into(), found.poses.to_string());
    result.insert("reachable".into(), found.reachable.to_string());
    recorder.finish(&result).map_err(failed)?;
    let (reachable, poses) = (count(found.reachable), count(found.poses));
    let path = path.display();
    work.output.note(format_args!("{path}: shard {shard}, {reachable} of {poses} poses"));
    outcome(&Part { found, conditioning }, effort)
}

/// What a shard found.
pub struct Part {
    pub found: Count,
    pub conditioning: Option<ConditioningIndex>,
}

/// What is known of the whole run before it: nothing that a merge can still ask for.
fn describe_whole(run: &Run<'_>) -> Metadata {
    let length = run.conditioning.map(|length| (CONDITIONING.to_owned(), length.to_string()));
    describe(run).into_iter().chain(length).collect()
}

/// The key of the characteristic length of a conditioning index, and the beginning of those of its parts.
pub const CONDITIONING: &str = "conditioning";

/// A conditioning index to the last digit.
fn describe_conditioning(index: &ConditioningIndex) -> Metadata {
    let ConditioningIndex { length: _, poses, min, max, sum } = index;
    let parts = [poses.to_string(), min.to_string(), max.to_string(), sum.to_string()];
    let keys = CONDITIONING_PARTS.map(|key| format!("{CONDITIONING}.{key}"));
    keys.into_iter().zip(parts).collect()
}

/// `sum` counts units of 2⁻⁶⁰.
const CONDITIONING_PARTS: [&str; 4] = ["poses", "min", "max", "sum"];

/// Writes the numbers of the poses, runs that go on from row to row as one.
fn write(
    recorder: &mut ShardRecorder,
    run: &Run<'_>,
    sweep: &Sweep<'_>,
    progress: &Progress,
    failed: impl Fn(RecordError) -> Failure + Sync,
) -> Result<(), Failure> {
    // The last run so far, to which the next one may belong.
    let mut open = [0; 2];
    sweep.points(
        progress,
        |hits, made: &mut Vec<[u64; 2]>| {
            made.extend(hits.numbers(run.grid).map(|run| [run.from, run.to]));
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

/// Which part of the run a shard is, and what it was made from.
fn describe_shard(run: &Run<'_>, shard: Shard) -> Metadata {
    let entries = [("shard", shard.to_string()), ("file", run.loaded.label.clone())];
    entries.map(|(key, value)| (key.to_owned(), value)).into()
}

/// A shard's file, all of which was read.
pub struct Stored {
    /// What messages call it.
    pub label: String,
    /// Which part of the run it is.
    pub shard: Shard,
    recording: Recording,
    /// The first pose and one more than the last, and how many there are.
    poses: Option<[u64; 2]>,
    reachable: u64,
}

impl Stored {
    /// Reads a file and checks that it is one of a shard, and whole.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let label = path.display().to_string();
        let mut poses: Option<[u64; 2]> = None;
        let mut reachable = 0;
        let recording = runs_of(path, |runs| {
            for run in runs {
                let [first, end] = poses.unwrap_or([run.from; 2]);
                if run.from < end {
                    let problem = format!("{label}: pose {} comes after {end}", run.from);
                    return Err(Failure::Work(problem));
                }
                poses = Some([first, run.to]);
                reachable += run.to - run.from;
            }
            Ok(())
        })?;
        let wrong = |problem| Err(Failure::Work(format!("{label}: {problem}")));
        let known = recording.metadata("shard").and_then(|record| record.get("shard"));
        let Some(shard) = known.and_then(|text| text.parse().ok()) else {
            return wrong(if recording.complete {
                "no shard of `opm workspace --shard`"
            } else {
                "cut short, before it says which shard it is: sweep that one again"
            });
        };
        if recording.topic(RUNS_TOPIC).is_none() || recording.metadata("run").is_none() {
            return wrong("not a shard that this program knows");
        }
        if !recording.complete {
            return wrong("cut short: sweep this shard again");
        }
        Ok(Self { label, shard, recording, poses, reachable })
    }

    /// The name and the text of the mechanism file.
    pub fn mechanism(&self) -> Result<(&str, &str), Failure> {
        let attached = self.recording.attachments.first();
        attached
            .and_then(|attached| {
                let content = attached.content.as_deref()?;
                Some((&*attached.name, std::str::from_utf8(content).ok()?))
            })
            .ok_or_else(|| self.wrong("no mechanism file is attached"))
    }

    /// What is said of the whole run.
    pub fn run(&self) -> &Metadata {
        self.record("run")
    }

    /// The mechanism as it was named to the run that wrote this.
    pub fn file(&self) -> Option<&str> {
        self.record("shard").get("file").map(String::as_str)
    }

    /// What it found, if it is this shard of this run.
    pub fn of(&self, run: &Run<'_>, shard: Shard) -> Result<Part, Failure> {
        if self.shard != shard {
            return Err(self.wrong(&format!("shard {}, expected {shard}", self.shard)));
        }
        self.belongs(&describe_whole(run), &run.loaded.text)?;
        self.part(run)
    }

    /// Refuses a shard of another run.
    pub fn belongs(&self, run: &Metadata, mechanism: &str) -> Result<(), Failure> {
        let found = self.run();
        let keys = run.keys().chain(found.keys().filter(|key| !run.contains_key(*key)));
        for key in keys {
            let (found, expected) = (found.get(key), run.get(key));
            let problem = match (found, expected) {
                _ if found == expected => continue,
                (Some(found), Some(expected)) => format!("{key} is {found:?}, not {expected:?}"),
                (Some(found), None) => format!("it has {key}, {found:?}"),
                (None, _) => format!("it has no {key}"),
            };
            return Err(self.wrong(&format!("a shard of another run: {problem}")));
        }
        if self.mechanism()?.1 != mechanism {
            return Err(self.wrong("a shard of another run: its mechanism file differs"));
        }
        Ok(())
    }

    /// What it found, once it is known to be of this run.
    pub fn part(&self, run: &Run<'_>) -> Result<Part, Failure> {
        let conditioning = run.conditioning.map(|length| self.conditioning(length)).transpose()?;
        Ok(Part { found: self.count(run)?, conditioning })
    }

    fn conditioning(&self, length: f64) -> Result<ConditioningIndex, Failure> {
        let result = self.record("result");
        let [poses, min, max, sum] =
            CONDITIONING_PARTS.map(|key| result.get(&format!("{CONDITIONING}.{key}")));
        let index = || {
            let (poses, sum) = (poses?.parse().ok()?, sum?.parse().ok()?);
            let (min, max) = (min?.parse().ok()?, max?.parse().ok()?);
            Some(ConditioningIndex { length, poses, min, max, sum })
        };
        index()
            .filter(|index| index.poses == self.reachable)
            .ok_or_else(|| self.wrong("its conditioning index is not that of its poses"))
    }

    fn count(&self, run: &Run<'_>) -> Result<Count, Failure> {
        let result = self.record("result");
        let sweep = run.sweep().shard(self.shard);
        let mut count = Count::nothing(run.manipulator);
        for (range, joint) in count.imaginary.iter_mut().zip(run.manipulator.imaginary()) {
            let Some(text) = result.get(&range_key(&joint.name)) else { continue };
            let ends = text
                .split_once(':')
                .and_then(|(low, high)| Some([low.parse().ok()?, high.parse().ok()?]));
            *range = Some(ends.ok_or_else(|| self.wrong(&format!("a range of {text:?}")))?);
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
            return Err(self.wrong("its poses are not those that it says"));
        }
        Ok(count)
    }

    fn record(&self, name: &str) -> &Metadata {
        static NOTHING: Metadata = Metadata::new();
        self.recording.metadata(name).unwrap_or(&NOTHING)
    }

    fn wrong(&self, problem: &str) -> Failure {
        Failure::Work(format!("{}: {problem}", self.label))
    }
}
