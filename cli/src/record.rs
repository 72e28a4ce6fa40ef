//! The recording of a sweep: what each point of the cloud is made of, and the passes that write it.

use crate::args::WorkspaceArgs;
use crate::failure::Failure;
use crate::text::count;
use crate::workspace::Run;
use opm_core::manipulator::{AllModes, Drives, Manipulator, Solution};
use opm_core::mechanism::file::FileUnits;
use opm_mcap::WorkspaceRecorder;
use opm_mcap::cloud::{COLOR_FIELDS, POSITION_FIELDS};
use opm_mcap::{CloudLayout, MAX_SLICES, Metadata, PartialFile, RecordError, Workspace};
use opm_workspace::{Axis, Cancelled, Count, Grid, Hits, Modes, Progress, Sweep};
use std::fs;
use std::path::{Path, PathBuf};

/// The name of the platform's point among the axes.
const TIP: &str = "tip";

/// One value of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    /// A task coordinate.
    Task(usize),
    /// An imaginary joint.
    Imaginary(usize),
    /// An actuated joint.
    Actuated(usize),
    /// The platform's point: x, y or z.
    Tip(usize),
}

/// What the points of a recording are made of.
pub struct Cloud<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    axes: [(String, Column); 3],
    scalars: Vec<(String, Column)>,
    color: (String, Column),
}

impl<'a> Cloud<'a> {
    /// From the flags, each of which is checked.
    pub fn new(
        args: &WorkspaceArgs,
        manipulator: &'a Manipulator,
        grid: &Grid,
        modes: Modes,
    ) -> Result<Self, Failure> {
        if args.output.as_deref() == Some(Path::new("-")) {
            return Err(Failure::flag("--output", "a recording needs a file, not standard output"));
        }
        if args.output.is_some() && grid.slices() > MAX_SLICES {
            let problem = format!(
                "{} slices (combinations of the last {} axes), at most {} can be recorded",
                count(grid.slices()),
                grid.axes().len() - grid.lower(),
                count(MAX_SLICES)
            );
            return Err(Failure::flag("--grid", problem));
        }
        let slowest = slowest(grid);
        let color = match &args.color {
            Some(name) => (name.clone(), column(manipulator, name, "--color")?),
            None => (grid.axes()[slowest].name.clone(), Column::Task(slowest)),
        };
        let axes = axes(&args.axes, manipulator, slowest)?;
        let mut scalars = Vec::new();
        match &args.scalars {
            Some(names) => {
                for name in names {
                    let column = column(manipulator, name, "--scalars")?;
                    if POSITION_FIELDS.contains(&&**name) || COLOR_FIELDS.contains(&&**name) {
                        let problem = format!("a cloud has a field {name} already; use --axes");
                        return Err(Failure::flag("--scalars", problem));
                    }
                    if scalars.iter().any(|(known, _)| known == name) {
                        return Err(Failure::flag("--scalars", format!("{name} is given twice")));
                    }
                    scalars.push((name.clone(), column));
                }
            }
            // What the colour shows can be read off, too.
            None => {
                let known = axes.iter().any(|(_, column)| *column == color.1);
                if !known && !POSITION_FIELDS.contains(&&*color.0) {
                    scalars.push(color.clone());
                }
            }
        }
        Ok(Self { manipulator, modes, axes, scalars, color })
    }

    /// How often the grid is swept to record it.
    pub fn passes(&self) -> u64 {
        if matches!(self.color.1, Column::Actuated(_)) { 3 } else { 2 }
    }

    /// The values of a row, in the order of [`CloudLayout::columns`].
    fn columns(&self, layout: &CloudLayout) -> Vec<Column> {
        let listed = || self.axes.iter().chain(&self.scalars);
        let mut columns: Vec<Column> = listed().map(|(_, column)| *column).collect();
        if layout.columns().len() > columns.len() {
            columns.push(self.color.1);
        }
        columns
    }

    /// The lowest and the highest value that the colour shows.
    fn color_range(
        &self,
        sweep: &Sweep<'_>,
        found: &Count,
        grid: &Grid,
        progress: &Progress,
    ) -> Result<[f64; 2], Failure> {
        let nothing = [f64::INFINITY, f64::NEG_INFINITY];
        let range = match self.color.1 {
            Column::Task(number) => {
                let axis = &grid.axes()[number];
                [axis.min, axis.max]
            }
            Column::Imaginary(number) => found.imaginary[number].unwrap_or(nothing),
            column @ (Column::Actuated(_) | Column::Tip(_)) => {
                let mut range = nothing;
                let widen = |range: &mut [f64; 2], values: &[f64]| {
                    for &value in values {
                        *range = [range[0].min(value), range[1].max(value)];
                    }
                };
                sweep.points::<_, Failure>(
                    progress,
                    |hits, made: &mut Points<'_>| made.add(hits),
                    || Points::new(self, vec![column]),
                    |made| {
                        for (_, values) in made.finish()? {
                            widen(&mut range, &values);
                        }
                        Ok(())
                    },
                )?;
                range
            }
        };
        Ok(if range[0] <= range[1] { range } else { [0.0; 2] })
    }
}

/// The slowest varying coordinate of the upper section with more than one value, else of the lower.
fn slowest(grid: &Grid) -> usize {
    let several = |axis: &Axis| axis.count > 1;
    let upper = &grid.axes()[grid.lower()..];
    match upper.iter().rposition(several) {
        Some(number) => grid.lower() + number,
        None => grid.axes().iter().position(several).unwrap_or(0),
    }
}

/// The coordinates that `--axes` names; without it, two of the lower section and the slowest one.
fn axes(
    given: &[String],
    manipulator: &Manipulator,
    slowest: usize,
) -> Result<[(String, Column); 3], Failure> {
    let coordinates = manipulator.task_coordinates();
    let task = |number: usize| (coordinates[number].name.to_owned(), Column::Task(number));
    let wrong = |problem: String| Failure::flag("--axes", problem);
    match given {
        [] => {
            // Every pair of subspaces has at least three coordinates.
            let mut others = (0..coordinates.len()).filter(|&number| number != slowest);
            let mut other = || others.next().unwrap_or(slowest);
            Ok([task(other()), task(other()), task(slowest)])
        }
        [one] if one == TIP => {
            Ok([0, 1, 2].map(|i| (format!("{TIP}.{}", POSITION_FIELDS[i]), Column::Tip(i))))
        }
        [a, b, c] => {
            if a == b || b == c || a == c {
                return Err(wrong("an axis is given twice".to_owned()));
            }
            let find = |name: &str| {
                let found = crate::pose::find(name, coordinates);
                found.map(task).map_err(|error| wrong(error.to_string()))
            };
            Ok([find(a)?, find(b)?, find(c)?])
        }
        _ => Err(wrong(format!("{}, expected three task coordinates, or {TIP}", given.join(",")))),
    }
}

/// What a name of `--color` or `--scalars` stands for.
fn column(manipulator: &Manipulator, name: &str, flag: &str) -> Result<Column, Failure> {
    let coordinates = manipulator.coordinates();
    let task: Vec<&str> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
    let imaginary: Vec<&str> = manipulator.imaginary().iter().map(|j| &*j.name).collect();
    let actuated: Vec<&str> =
        manipulator.actuated().iter().map(|&i| &*coordinates[i].name).collect();
    let find = |names: &[&str]| names.iter().position(|known| *known == name);
    (find(&task).map(Column::Task))
        .or_else(|| find(&imaginary).map(Column::Imaginary))
        .or_else(|| find(&actuated).map(Column::Actuated))
        .ok_or_else(|| {
            let known = [task, imaginary, actuated].concat().join(", ");
            Failure::flag(flag, format!("{name:?} is none of {known}"))
        })
}

/// A recording that has been opened.
pub struct Recorder {
    file: PartialFile,
    path: PathBuf,
}

impl Recorder {
    /// Opens the file before the work starts, so that a wrong path costs no time.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let file = PartialFile::create(path).map_err(|e| Failure::at(path.display(), &e))?;
        Ok(Self { file, path: path.to_owned() })
    }

    fn partial(&self) -> PathBuf {
        let mut name = self.path.as_os_str().to_owned();
        name.push(".partial");
        name.into()
    }

    /// Nothing was recorded, so nothing is worth keeping.
    pub fn discard(self) {
        let _ = fs::remove_file(self.partial());
    }

    /// Records every point that was counted: an overview, then all of them.
    pub fn record(
        self,
        run: &Run<'_>,
        cloud: &Cloud<'_>,
        sweep: &Sweep<'_>,
        found: &Count,
        progress: &Progress,
    ) -> Result<(), Failure> {
        let (place, partial) = (self.path.display().to_string(), self.partial());
        self.record_in(&place, run, cloud, sweep, found, progress).map_err(
            |failure| match failure {
                Failure::Interrupted(message) => {
                    let partial = partial.display();
                    Failure::Interrupted(format!("{message}; what was recorded is in {partial}"))
                }
                other => other,
            },
        )
    }

    fn record_in(
        self,
        place: &str,
        run: &Run<'_>,
        cloud: &Cloud<'_>,
        sweep: &Sweep<'_>,
        found: &Count,
        progress: &Progress,
    ) -> Result<(), Failure> {
        let failed = |error: RecordError| Failure::at(place, &error);
        let names = |columns: &[(String, Column)]| columns.iter().map(|c| c.0.clone()).collect();
        let layout = CloudLayout {
            axes: cloud.axes.clone().map(|(name, _)| name),
            scalars: names(&cloud.scalars),
            color: cloud.color.0.clone(),
            color_range: cloud.color_range(sweep, found, run.grid, progress)?,
            frame_id: if matches!(cloud.axes[0].1, Column::Tip(_)) { "base" } else { "task" }
                .into(),
        };
        let columns = cloud.columns(&layout);
        let workspace = Workspace {
            layout,
            mechanism_name: &run.loaded.file_name,
            mechanism: run.loaded.text.as_bytes(),
            run: describe(run, found),
            points: found.reachable,
            slices: run.grid.slices(),
        };
        let mut recorder = WorkspaceRecorder::new(self.file, &workspace).map_err(failed)?;

        let every = recorder.overview_every();
        let mut number = 0;
        let mut overview = Points::new(cloud, columns.clone());
        sweep.points::<_, Failure>(
            progress,
            |hits, poses: &mut Poses| poses.add(hits),
            Poses::default,
            |poses| {
                poses.each(|pose| {
                    if number % every == 0 {
                        overview.point(0, pose);
                    }
                    number += 1;
                });
                for (_, rows) in overview.take()? {
                    recorder.overview(&rows).map_err(failed)?;
                }
                Ok(())
            },
        )?;
        sweep.points::<_, Failure>(
            progress,
            |hits, points: &mut Points<'_>| points.add(hits),
            || Points::new(cloud, columns.clone()),
            |points| {
                for (slice, rows) in points.finish()? {
                    recorder.push(slice, &rows).map_err(failed)?;
                }
                Ok(())
            },
        )?;
        recorder.finish(&result(run, found)).map_err(failed)
    }
}

/// What is known of a run before it.
fn describe(run: &Run<'_>, found: &Count) -> Metadata {
    let mut record: Metadata = [
        ("program", format!("opm {}", env!("CARGO_PKG_VERSION"))),
        ("mechanism", run.manipulator.mechanism().name.clone()),
        ("mechanism_file", run.loaded.file_name.clone()),
        ("mode", run.mode()),
        ("poses", found.poses.to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into();
    for Axis { name, min, max, count } in run.grid.axes() {
        record.insert(format!("grid.{name}"), format!("{min}:{max}:{count}"));
    }
    record
}

/// What came of it.
fn result(run: &Run<'_>, found: &Count) -> Metadata {
    let (measure, units) = run.measure(found, FileUnits::SI);
    let mut record: Metadata = [
        ("reachable", found.reachable.to_string()),
        ("fraction", (found.reachable as f64 / found.poses as f64).to_string()),
        ("measure", measure.to_string()),
        ("measure_units", units),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into();
    for (joint, range) in run.manipulator.imaginary().iter().zip(&found.imaginary) {
        if let Some([low, high]) = range {
            record.insert(format!("range.{}", joint.name), format!("{low}:{high}"));
        }
    }
    record
}

/// Reachable poses, packed: points that share all but the first coordinate share the rest.
#[derive(Default)]
struct Poses {
    first: Vec<f64>,
    /// Where each run of `first` ends.
    ends: Vec<usize>,
    others: Vec<f64>,
    width: usize,
}

impl Poses {
    fn add(&mut self, hits: &Hits<'_>) {
        self.first.extend(hits.first);
        self.ends.push(self.first.len());
        self.others.extend(hits.others);
        self.width = hits.others.len();
    }

    fn each(&self, mut visit: impl FnMut(&[f64])) {
        let mut pose = vec![0.0; self.width + 1];
        let mut start = 0;
        for (number, &end) in self.ends.iter().enumerate() {
            let others = number * self.width..(number + 1) * self.width;
            pose[1..].copy_from_slice(&self.others[others]);
            for &first in &self.first[start..end] {
                pose[0] = first;
                visit(&pose);
            }
            start = end;
        }
    }
}

/// Rows of a cloud in the making, in runs of one slice.
struct Points<'a> {
    cloud: &'a Cloud<'a>,
    columns: Vec<Column>,
    joints: Joints,
    pose: Vec<f64>,
    runs: Vec<(u64, Vec<f64>)>,
    /// A pose that the sweep found and inverse kinematics did not.
    lost: Option<Vec<f64>>,
}

/// Buffers for what inverse kinematics finds.
enum Joints {
    /// No column asks for joints.
    Unused,
    One(Drives),
    Any(Box<(AllModes, Solution)>),
}

impl<'a> Points<'a> {
    fn new(cloud: &'a Cloud<'a>, columns: Vec<Column>) -> Self {
        let manipulator = cloud.manipulator;
        let asked = |c: &Column| matches!(c, Column::Imaginary(_) | Column::Actuated(_));
        let joints = match cloud.modes {
            _ if !columns.iter().any(asked) => Joints::Unused,
            Modes::One(_) => Joints::One(manipulator.drives()),
            Modes::Any => Joints::Any(Box::new((manipulator.all_modes(), manipulator.solution()))),
        };
        Self { cloud, columns, joints, pose: Vec::new(), runs: Vec::new(), lost: None }
    }

    fn add(&mut self, hits: &Hits<'_>) {
        let mut pose = std::mem::take(&mut self.pose);
        pose.clear();
        pose.push(0.0);
        pose.extend(hits.others);
        for &first in hits.first {
            pose[0] = first;
            self.point(hits.slice, &pose);
        }
        self.pose = pose;
    }

    fn point(&mut self, slice: u64, pose: &[f64]) {
        let manipulator = self.cloud.manipulator;
        let found = match (&mut self.joints, self.cloud.modes) {
            (Joints::One(drives), Modes::One(mode)) => {
                manipulator.inverse_drives(pose, mode, drives) == Ok(true)
            }
            (Joints::Any(buffers), _) => {
                let (all, solution) = &mut **buffers;
                manipulator.inverse_all(pose, all) == Ok(true)
                    && manipulator.pick_within_limits(all, solution).is_some()
            }
            _ => true,
        };
        if !found {
            self.lost.get_or_insert_with(|| pose.to_vec());
            return;
        }
        if self.runs.last().is_none_or(|(last, _)| *last != slice) {
            self.runs.push((slice, Vec::new()));
        }
        let Some((_, row)) = self.runs.last_mut() else { return };
        let mut tip = None;
        for column in &self.columns {
            row.push(match (*column, &self.joints) {
                (Column::Task(number), _) => pose[number],
                (Column::Tip(i), _) => tip.get_or_insert_with(|| {
                    manipulator.task().displacement(pose) * manipulator.mechanism().platform
                })[i],
                (Column::Imaginary(number), Joints::One(drives)) => drives.imaginary[number],
                (Column::Actuated(number), Joints::One(drives)) => drives.actuated[number],
                (Column::Imaginary(number), Joints::Any(buffers)) => buffers.1.imaginary[number],
                (Column::Actuated(number), Joints::Any(buffers)) => {
                    buffers.1.joints[manipulator.actuated()[number]]
                }
                (Column::Imaginary(_) | Column::Actuated(_), Joints::Unused) => {
                    unreachable!("Points::new has buffers for joints that columns ask for")
                }
            });
        }
    }

    /// The rows so far; the next ones start anew.
    fn take(&mut self) -> Result<Vec<(u64, Vec<f64>)>, Failure> {
        match &self.lost {
            None => Ok(std::mem::take(&mut self.runs)),
            Some(pose) => Err(Failure::Work(format!(
                "the sweep counts the pose {pose:?}, but inverse kinematics does not reach it"
            ))),
        }
    }

    fn finish(mut self) -> Result<Vec<(u64, Vec<f64>)>, Failure> {
        self.take()
    }
}

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::Interrupted("interrupted".to_owned())
    }
}
