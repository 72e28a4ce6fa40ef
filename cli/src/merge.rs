//! `opm merge`: the shards of a sweep as the one run that they are parts of.

use crate::args::{MergeArgs, Output};
use crate::failure::Failure;
use crate::kind::{Kind, Study};
use crate::load::{self, Loaded};
use crate::progress::{interruptible, watch_reading};
use crate::record::{PROGRAM, Recorder};
use crate::shard::{self, CONDITIONING, Stored};
use crate::source::Source;
use crate::workspace::{AnyWishes, Effort, Outcome, Run, Work, grid_flags, threads};
use opm_core::manipulator::Manipulator;
use opm_mcap::Metadata;
use opm_workspace::{Axis, ConditionLimit, ConditioningIndex, Count, Grid, Modes};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Most missing shards whose commands are told one by one.
const COMMANDS: usize = 8;

pub fn run(args: &MergeArgs, output: &Output) -> Result<(), Failure> {
    let progress = interruptible()?;
    let pool = threads(args.threads)?;
    let files = AtomicU64::new(0);
    let read = || -> Result<Vec<Part>, Failure> {
        let parts = args.parts.iter().map(|path| {
            if progress.is_cancelled() {
                return Err(Failure::Interrupted("interrupted".to_owned()));
            }
            files.fetch_add(1, Ordering::Relaxed);
            Ok(Part { path: path.clone(), stored: Stored::open(path)? })
        });
        parts.collect()
    };
    let total = Some(args.parts.len() as u64);
    let mut parts = watch_reading(output, total, || files.load(Ordering::Relaxed), read)?;
    parts.sort_by_key(|part| part.stored.shard);
    let Some(first) = parts.first() else { return Ok(()) };

    let whole = Whole::of(first)?;
    let manipulator = whole.loaded.compile()?;
    let described = Described::new(&whole.record, &manipulator)
        .ok_or_else(|| first.wrong("not a run that this program knows"))?;
    let Described { kind, grid, modes, limit, conditioning } = &described;
    let run = Run {
        loaded: &whole.loaded,
        manipulator: &manipulator,
        kind: *kind,
        grid,
        modes: *modes,
        limit: *limit,
        conditioning: *conditioning,
    };
    let Joined { mut found, conditioning } = join(&run, &whole, &parts)?;

    let work = Work { output, pool: &pool, progress: &progress };
    let length = limit.map(|limit| limit.length).or(run.conditioning);
    let length = length.unwrap_or_else(|| manipulator.characteristic_length());
    let wishes = AnyWishes::new(*kind, &args.cloud, length, &manipulator)?;
    let mut recorder = None;
    if let Some(path) = &args.cloud.output {
        let inputs: Vec<&Path> = parts.iter().map(|part| &*part.path).collect();
        whole.loaded.refuse_as_output(path, &inputs)?;
        Recorder::check_run(path, *kind, Some(grid))?;
        recorder = Some(Recorder::create(path)?);
    }
    let files = parts.iter().map(|part| part.path.clone()).collect();
    let source = Source::Shards { grid, files };
    let study = Study { conditioning, ..work.study(&run, args.shape, &source, &mut found)? };
    work.warn_of_nothing(&run, &found);
    if let Some(recorder) = recorder {
        work.record(recorder, wishes, &run, &found, &source, &study)?;
    }
    let effort = Effort::Merged { shards: parts.len() as u64 };
    let outcome = Outcome { run: &run, found: &found, study: &study, effort, shard: None };
    output.print(&outcome.json(), outcome.text())
}

/// A shard and where it is.
struct Part {
    path: PathBuf,
    stored: Stored,
}

impl Part {
    fn wrong(&self, problem: &str) -> Failure {
        Failure::Work(format!("{}: {problem}", self.path.display()))
    }
}

/// What the first shard says of the whole run.
struct Whole {
    loaded: Loaded,
    record: Metadata,
}

impl Whole {
    fn of(first: &Part) -> Result<Self, Failure> {
        let record = first.stored.run().clone();
        match record.get("program") {
            Some(program) if program == PROGRAM => {}
            // Another program may count or record otherwise.
            other => {
                let other = other.map_or("nobody", |program| program);
                return Err(first.wrong(&format!("written by {other}, but this is {PROGRAM}")));
            }
        }
        let (name, text) = first.stored.mechanism()?;
        let label = first.stored.file().unwrap_or(name);
        let loaded = load::attached(label, name, text).map_err(|failure| match failure {
            Failure::Work(problem) => first.wrong(&format!("attached file {problem}")),
            other => other,
        })?;
        Ok(Self { loaded, record })
    }
}

/// A run, read back from its record.
struct Described {
    kind: Kind,
    grid: Grid,
    modes: Modes,
    limit: Option<ConditionLimit>,
    conditioning: Option<f64>,
}

impl Described {
    /// `None` where the record is not one of a run of this manipulator.
    fn new(record: &Metadata, manipulator: &Manipulator) -> Option<Self> {
        let kind = Kind::named(record.get("kind")?)?;
        let sections = kind.sections();
        let coordinates = sections.coordinates(manipulator);
        let axes = coordinates.into_iter().map(|coordinate| {
            let values = record.get(&format!("grid.{}", coordinate.name))?;
            let mut values = values.split(':');
            let mut next = || values.next();
            let [min, max] = [next()?.parse().ok()?, next()?.parse().ok()?];
            Some(Axis::new(coordinate.name, min, max, next()?.parse().ok()?))
        });
        let grid = Grid::of(sections, manipulator, axes.collect::<Option<_>>()?).ok()?;
        let modes = match &**record.get("mode")? {
            "any" => Modes::Any,
            signs => Modes::One(manipulator.parse_mode(signs).ok()?),
        };
        let number = |key: &str| record.get(key).map(|text| text.parse().ok());
        let limit = match (number("max_condition"), number("characteristic_length")) {
            (None, None) => None,
            (most, length) => Some(ConditionLimit { most: most??, length: length?? }),
        };
        let conditioning = match number(CONDITIONING) {
            None => None,
            Some(length) => Some(length?),
        };
        Some(Self { kind, grid, modes, limit, conditioning })
    }
}

/// What all shards found together.
type Joined = shard::Part;

/// What all shards found, if they are the parts of one run, each of them once.
fn join(run: &Run<'_>, whole: &Whole, parts: &[Part]) -> Result<Joined, Failure> {
    for part in parts {
        part.stored.belongs(&whole.record, &whole.loaded.text)?;
    }
    let of = parts[0].stored.shard.count();
    for pair in parts.windows(2) {
        let [a, b] = [&pair[0], &pair[1]];
        let (shard, other) = (a.stored.shard, b.stored.shard);
        if other.count() != of {
            return Err(b.wrong(&format!("shard {other}, but {} is {shard}", a.path.display())));
        }
        if shard == other {
            let path = a.path.display();
            return Err(b.wrong(&format!("shard {other} a second time, after {path}")));
        }
    }
    let there: BTreeSet<u64> = parts.iter().map(|part| part.stored.shard.number()).collect();
    if (there.len() as u64) < of {
        return Err(missing(run, parts, &there, of));
    }
    let conditioning = run.conditioning.map(ConditioningIndex::nothing);
    let nothing = Joined { found: Count::nothing(run.manipulator), conditioning };
    parts.iter().try_fold(nothing, |Joined { found, mut conditioning }, part| {
        let part = part.stored.part(run)?;
        if let (Some(all), Some(index)) = (&mut conditioning, &part.conditioning) {
            all.add(index);
        }
        Ok(Joined { found: found.merge(&part.found), conditioning })
    })
}

/// Says which shards are missing, and how to make them.
fn missing(run: &Run<'_>, parts: &[Part], there: &BTreeSet<u64>, of: u64) -> Failure {
    let gaps = gaps(there, of);
    let text: Vec<String> = (gaps.iter())
        .map(|&[from, to]| if from == to { from.to_string() } else { format!("{from}-{to}") })
        .collect();
    let missing = || gaps.iter().flat_map(|&[from, to]| from..=to);
    let number = of - there.len() as u64;
    let verb = if number == 1 { "is" } else { "are" };
    let mut message = format!("{number} of {of} shards {verb} missing: {}", text.join(","));
    for number in missing().take(COMMANDS) {
        message += &format!("\n  {}", command(run, &parts[0], number, of));
    }
    if number > COMMANDS as u64 {
        message += "\n  and so on for the others";
    }
    Failure::Work(message)
}

/// The numbers from 1 on that are not there, as ranges with both ends.
fn gaps(there: &BTreeSet<u64>, of: u64) -> Vec<[u64; 2]> {
    let mut gaps = Vec::new();
    let mut next = 1;
    for &number in there.iter().chain([&(of + 1)]) {
        if next < number {
            gaps.push([next, number - 1]);
        }
        next = number + 1;
    }
    gaps
}

/// The command that makes a shard.
fn command(run: &Run<'_>, part: &Part, number: u64, of: u64) -> String {
    let mut command = format!("opm workspace {}", quoted(&run.loaded.label));
    if run.kind != Kind::Grid {
        command += &format!(" --kind {}", run.kind.name());
    }
    command += &format!(" {}", grid_flags(run.grid));
    if !run.mode().is_empty() {
        command += &format!(" --mode {}", quoted(&run.mode()));
    }
    if let Some(ConditionLimit { most, .. }) = run.limit {
        command += &format!(" --max-condition {most}");
    }
    if run.conditioning.is_some() {
        command += " --conditioning";
    }
    if let Some(length) = run.conditioning.or(run.limit.map(|limit| limit.length)) {
        command += &format!(" --length {length}");
    }
    let output = named_like(part, number);
    command + &format!(" --shard {number}/{of} -o {}", quoted(&output.display().to_string()))
}

/// A name for another shard's file, like that of a part: with its number in place of the part's.
fn named_like(part: &Part, number: u64) -> PathBuf {
    let name = part.path.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let own = part.stored.shard.number();
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
    part.path.with_file_name(name)
}

/// A word as a shell takes it.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "._-/=:,+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_are_what_is_not_there() {
        let there = |numbers: &[u64]| numbers.iter().copied().collect();
        assert_eq!(gaps(&there(&[2, 3, 7]), 8), [[1, 1], [4, 6], [8, 8]]);
        assert_eq!(gaps(&there(&[1]), 1_000_000), [[2, 1_000_000]]);
        assert_eq!(gaps(&there(&[1, 2]), 2), [[0; 2]; 0]);
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(quoted("part-3.mcap"), "part-3.mcap");
        assert_eq!(quoted("++ -+"), "'++ -+'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
    }
}
