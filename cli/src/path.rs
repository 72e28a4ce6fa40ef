//! `opm path`: a path between two poses without a singularity.

mod table;

use crate::args::{Format, Output, PathArgs};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::output::{Shown, is_stdout, print_with};
use crate::pose::GridAxis;
use crate::progress::{interruptible, watch};
use crate::target::{Target, ends_in};
use crate::text::{self, Table, count, short};
use crate::unitless;
use crate::workspace::{Work, threads};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::file::FileUnits;
use opm_mcap::csv::Rows;
use opm_workspace::{AspectPath, Aspects, BeyondLimits, NoPath, aspect_at, find_path};
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use std::sync::Arc;

/// Number of poses of a path that are shown in text.
const SHOWN: usize = 12;

pub fn run(args: &PathArgs, output: &Output) -> Result<(), Failure> {
    let printed = args.output.as_deref().is_some_and(is_stdout);
    if printed && output.format == Format::Json {
        let problem = "the CSV takes standard output; give it a file with --output";
        return Err(Failure::flag("--format json", problem));
    }
    let file = args.output.as_deref().filter(|path| !is_stdout(path));
    // `opm trajectory` takes the kind of a motion from its ending.
    file.map_or(Ok(()), |path| ends_in(path, &["csv"]))?;
    let loaded = load::open(&args.mechanism, output)?;
    if let Some(vary) = &args.vary {
        return table::run(args, &loaded, vary, output);
    }
    let query = Query::new(args, &loaded, Arc::new(loaded.compile()?))?;
    query.note(output);
    if let Some(path) = file {
        loaded.refuse_as_output(path, &[])?;
    }
    let target = file.map(Target::create).transpose()?;
    let (progress, pool) = (interruptible()?, threads(args.threads)?);
    let answer = query.search(&Work { output, pool: &pool, progress: &progress })?;
    if let Err(none) = &answer.found
        && let Some(failure) = of_an_end(none, loaded.file.units)
    {
        return Err(failure);
    }
    let path = match (&answer.found, &args.output) {
        (Err(none), Some(_)) => {
            return Err(Failure::work(format!("{}: no path: {none}", loaded.label)));
        }
        (Err(_), None) | (Ok(_), None) => return output.print(&answer.json(), answer.text()),
        (Ok(path), Some(_)) => path,
    };
    let table = answer.table(path).map_err(|error| Failure::work(error.to_string()))?;
    if printed {
        return print_with(|out| out.write_all(&table));
    }
    if let (Some(target), Some(file)) = (target, file) {
        target.commit(&table)?;
        let poses = count(path.poses.len() as u64);
        output.note(format_args!("{}: {poses} poses, for `opm trajectory --motion`", file.shown()));
    }
    output.print(&answer.json(), answer.text())
}

/// The failure of a path whose start or goal cannot be used.
fn of_an_end(none: &NoPath, units: FileUnits) -> Option<Failure> {
    let (end, problem) = match none {
        NoPath::End { end, problem } => (end, format!("the pose is {problem}")),
        NoPath::Limits { end, joints } => {
            let each = joints.iter().map(|BeyondLimits { name, quantity, value, limits }| {
                text::beyond_limits(name, *value, *limits, *quantity, units)
            });
            (end, format!("at this pose {}", each.collect::<Vec<_>>().join("; ")))
        }
        _ => return None,
    };
    let flag = if *end == "the start" { "--from" } else { "--to" };
    Some(Failure::flag(flag, problem))
}

/// What is asked of one mechanism.
struct Query<'a> {
    args: &'a PathArgs,
    loaded: &'a Loaded,
    manipulator: Arc<Manipulator>,
    mode: Mode,
    /// The poses of --from and --to.
    ends: [Vec<f64>; 2],
}

impl<'a> Query<'a> {
    fn new(
        args: &'a PathArgs,
        loaded: &'a Loaded,
        manipulator: Arc<Manipulator>,
    ) -> Result<Self, Failure> {
        let mode = load::mode(&manipulator, &args.mode)?;
        let from = args.from.resolve_for("--from", &manipulator)?;
        let to = args.to.resolve_for("--to", &manipulator)?;
        Ok(Self { args, loaded, manipulator, mode, ends: [from, to] })
    }

    /// Notes numbers without a unit that look misread.
    fn note(&self, output: &Output) {
        let Self { args, loaded, manipulator, .. } = self;
        for (flag, pose) in [("--from", &args.from), ("--to", &args.to)] {
            unitless::note_pose(output, flag, pose, loaded, manipulator);
        }
        let values = args.grid.iter().flat_map(GridAxis::ends);
        unitless::note_ranges(output, "--grid", (*loaded, &**manipulator), values);
    }

    fn search(&self, work: &Work<'_>) -> Result<Answer<'_>, Failure> {
        let Self { args, loaded, manipulator, mode, ends } = self;
        let progress = work.progress;
        let aspects = work.aspects(manipulator, *mode, &args.grid, loaded.file.units)?;
        let find = || {
            let ends = ends.each_ref().map(|pose| &**pose);
            find_path(manipulator, *mode, &aspects, ends, args.duration, progress)
        };
        let found = match watch(work.output, "searching", None, || progress.done(), find) {
            Err(NoPath::Cancelled(_)) => {
                return Err(Failure::interrupted("interrupted while searching"));
            }
            found => found,
        };
        let labels = ends.each_ref().map(|pose| aspect_at(manipulator, *mode, &aspects, pose));
        Ok(Answer { loaded, manipulator, aspects, labels, found })
    }
}

struct Answer<'a> {
    loaded: &'a Loaded,
    manipulator: &'a Manipulator,
    aspects: Aspects,
    /// The aspects of both ends, where the grid tells.
    labels: [Option<u32>; 2],
    found: Result<AspectPath, NoPath>,
}

impl Answer<'_> {
    /// The table of poses, as CSV.
    fn table(&self, path: &AspectPath) -> io::Result<Vec<u8>> {
        let names = self.manipulator.task_coordinates().iter().map(|c| c.name);
        let mut text = Vec::new();
        let mut rows = Rows::new(&mut text);
        rows.header(std::iter::once("t").chain(names))?;
        for (&time, pose) in path.times.iter().zip(&path.poses) {
            rows.number(time)?;
            rows.numbers(pose)?;
            rows.end()?;
        }
        rows.flush()?;
        drop(rows);
        Ok(text)
    }

    fn json(&self) -> Value {
        let ends = json!({ "from": self.labels[0], "to": self.labels[1] });
        let mut json = json!({
            "joined": self.found.is_ok(),
            "aspects": { "number": self.aspects.list().len(), "from": ends["from"], "to": ends["to"] },
        });
        match &self.found {
            Err(none) => json["reason"] = none.to_string().into(),
            Ok(AspectPath { times, poses, clearance }) => {
                let column = |i: usize| poses.iter().map(|pose| pose[i]).collect::<Vec<f64>>();
                let coordinates = self.manipulator.task_coordinates().iter().enumerate();
                let poses: Map<String, Value> =
                    coordinates.map(|(i, c)| (c.name.to_owned(), json!(column(i)))).collect();
                json["clearance"] = (*clearance).into();
                json["t"] = json!(times);
                json["poses"] = poses.into();
            }
        }
        json
    }

    fn text(&self) -> String {
        let name = &self.manipulator.mechanism().name;
        let AspectPath { times, poses, clearance } = match &self.found {
            Err(none) => return format!("{name}: no path: {none}\n"),
            Ok(path) => path,
        };
        let aspect = match self.labels {
            [Some(a), Some(b)] if a == b => format!(" in aspect {a}"),
            _ => String::new(),
        };
        let number = count(poses.len() as u64);
        let mut shown = Table::new(self.headers(self.loaded.file.units));
        let last = poses.len() - 1;
        let parts = SHOWN.min(last.max(1));
        let mut numbers: Vec<usize> = (0..=parts).map(|part| part * last / parts).collect();
        numbers.dedup();
        for i in numbers {
            let coordinates = self.manipulator.task_coordinates().iter().zip(&poses[i]);
            let units = self.loaded.file.units;
            let pose = coordinates.map(|(c, &value)| text::number(value, c.quantity, units));
            shown.row(std::iter::once(short(times[i])).chain(pose));
        }
        format!(
            "{name}: a path without a singularity{aspect}, {number} poses\n\n{shown}\nsmallest measure of \
             singularity {}\n",
            short(*clearance)
        )
    }

    fn headers(&self, units: FileUnits) -> Vec<String> {
        let coordinates = self.manipulator.task_coordinates().iter();
        let names = coordinates.map(|c| text::header(c.name, c.quantity, units));
        std::iter::once(">t [s]".to_owned()).chain(names).collect()
    }
}
