//! The recording of a sweep: the passes that write it, and what it says of the run.

use crate::cloud::{Cloud, Packing, Points, Portion};
use crate::failure::Failure;
use crate::kind::{Kind, SetRecording, Study, pose_boundary};
use crate::source::Source;
use crate::text::count;
use crate::workspace::Run;
use opm_core::mechanism::file::FileUnits;
use opm_mcap::{
    CloudLayout, MAX_SLICES, Metadata, PartialFile, RecordError, TableFormat, TableRecorder,
    Workspace, WorkspaceRecorder, table_columns,
};
use opm_workspace::{Axis, Cancelled, ConditionLimit, Count, Grid, Poses, Progress};
use std::fs;
use std::path::{Path, PathBuf};

/// What writes the files.
pub const PROGRAM: &str = concat!("opm ", env!("CARGO_PKG_VERSION"));

/// More slices than this play for longer than a quarter of an hour.
const PLAYABLE: u64 = 10_000;

/// Points between two looks at whether somebody pressed Ctrl-C.
const PORTION: u64 = 1 << 12;

/// Opens a file for a recording before the work starts, so that a wrong path costs no time.
pub fn create(path: &Path) -> Result<PartialFile, Failure> {
    no_stream(path)?;
    PartialFile::create(path).map_err(|e| Failure::at(path.display(), &e))
}

/// Refuses standard output: what is on its way to a file goes by another name until it is whole.
fn no_stream(path: &Path) -> Result<(), Failure> {
    if path == Path::new("-") {
        return Err(Failure::flag("--output", "a recording needs a file, not standard output"));
    }
    Ok(())
}

/// Refuses a name that does not end as that of an MCAP file does, of what is written as one alone.
pub fn expect_mcap(path: &Path, what: &str) -> Result<(), Failure> {
    no_stream(path)?;
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mcap")) {
        return Ok(());
    }
    let path = path.display();
    let problem = format!("{path}: {what} is written as MCAP, expected a name that ends in .mcap");
    Err(Failure::flag("--output", problem))
}

/// A file that is open for a recording.
pub struct Recorder {
    path: PathBuf,
    file: PartialFile,
    format: Format,
}

/// What points are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Mcap,
    Table(TableFormat),
}

impl Format {
    /// By the ending of the file's name.
    fn of(path: &Path) -> Result<Self, Failure> {
        no_stream(path)?;
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("mcap") => Ok(Self::Mcap),
            Some("npy") => Ok(Self::Table(TableFormat::Npy)),
            Some("ply") => Ok(Self::Table(TableFormat::Ply)),
            _ => Err(Failure::flag(
                "--output",
                format!(
                    "{}, expected a name that ends in .mcap (Foxglove, Lichtblick, Rerun), .npy \
                     (NumPy) or .ply (mesh tools)",
                    path.display()
                ),
            )),
        }
    }
}

impl Recorder {
    /// Refuses a name, or a grid, that a recording of this kind does not have.
    pub fn check_run(path: &Path, kind: Kind, grid: Option<&Grid>) -> Result<(), Failure> {
        match kind.is_of_poses() {
            true => grid.map_or(Ok(()), |grid| Self::check(path, grid)),
            false => Self::check_set(path, &kind.name()),
        }
    }

    /// Refuses a name of no known ending, and for MCAP a grid whose slowest axis alone has more values
    /// than a recording may have slices.
    pub fn check(path: &Path, grid: &Grid) -> Result<(), Failure> {
        let slices = grid.slices() / together(grid);
        if Format::of(path)? != Format::Mcap || slices <= MAX_SLICES {
            return Ok(());
        }
        let slowest = grid.axes().last().map_or("", |axis| &axis.name);
        let (slices, most) = (count(slices), count(MAX_SLICES));
        let problem = format!("{slices} slices, one a value of {slowest}, expected at most {most}");
        Err(Failure::flag("--grid", problem))
    }

    /// Refuses what a set that is no set of poses is not written as.
    pub fn check_set(path: &Path, kind: &str) -> Result<(), Failure> {
        expect_mcap(path, &format!("--kind {kind}"))
    }

    /// Opens the file.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        let format = Format::of(path)?;
        Ok(Self { path: path.to_owned(), file: create(path)?, format })
    }

    /// Records every point that was counted: an overview, then all of them. Returns the path.
    pub fn record(
        self,
        run: &Run<'_>,
        cloud: &Cloud<'_>,
        source: &Source<'_>,
        found: &Count,
        study: Option<&Study>,
        progress: &Progress,
    ) -> Result<PathBuf, Failure> {
        let Self { path, file, format } = self;
        let cloud = &match format {
            Format::Mcap => cloud.clone(),
            Format::Table(format) => cloud.clone().with_every_coordinate(format),
        };
        let color_range = cloud.color_range(source, found, run.grid, progress)?;
        let layout = cloud.layout(color_range);
        let job = Job { run, cloud, source, found, study, progress, path: &path, layout };
        match format {
            Format::Mcap => job.mcap(file)?,
            Format::Table(format) => job.table(file, format).inspect_err(|_| {
                // Nothing reads part of a table.
                let _ = fs::remove_file(partial(&path));
            })?,
        }
        Ok(path)
    }

    /// Records a set that is no set of poses: an overview, then every point. Returns the path.
    pub fn record_set(
        self,
        run: &Run<'_>,
        set: &SetRecording<'_>,
        found: &Count,
        progress: &Progress,
    ) -> Result<PathBuf, Failure> {
        let Self { path, file, .. } = self;
        let failed = |error: RecordError| Failure::at(path.display(), &error);
        let mut about = describe(run);
        about.insert("poses".to_owned(), found.poses.to_string());
        about.insert("set".to_owned(), set.set_axes());
        let workspace = Workspace {
            layout: set.layout(found),
            mechanism_name: &run.loaded.file_name,
            mechanism: run.loaded.text.as_bytes(),
            run: about,
            points: found.reachable,
            slices: set.slices,
        };
        let mut recorder = WorkspaceRecorder::new(file, &workspace).map_err(failed)?;
        if let Some(lines) = set.boundary() {
            recorder.boundary(lines).map_err(failed)?;
        }
        let every = recorder.overview_every();
        let going = |number: u64| match progress.is_cancelled() && number.is_multiple_of(PORTION) {
            false => Ok(()),
            true => Err(Failure::Interrupted(format!(
                "interrupted; what was recorded is in {}",
                partial(&path).display()
            ))),
        };
        let mut number = 0;
        set.points(|_, row| {
            going(number)?;
            let wanted = number % every == 0;
            number += 1;
            if wanted { recorder.overview(row).map_err(failed) } else { Ok(()) }
        })?;
        set.points(|slice, row| {
            number += 1;
            going(number)?;
            recorder.push(slice, row).map_err(failed)
        })?;
        recorder.finish(&result(run, found)).map_err(failed)?;
        Ok(path)
    }

    /// How often the poses are gone through.
    pub fn passes(&self, cloud: &Cloud<'_>) -> u64 {
        match self.format {
            Format::Mcap => cloud.passes(),
            Format::Table(_) => cloud.passes() - 1,
        }
    }
}

/// Everything that there is to record.
struct Job<'a> {
    run: &'a Run<'a>,
    cloud: &'a Cloud<'a>,
    source: &'a Source<'a>,
    found: &'a Count,
    study: Option<&'a Study>,
    progress: &'a Progress,
    path: &'a Path,
    layout: CloudLayout,
}

impl Job<'_> {
    /// One table of all points, in one pass.
    fn table(&self, file: PartialFile, format: TableFormat) -> Result<(), Failure> {
        let Self { run, cloud, layout, .. } = self;
        let failed = |error| self.failed(&error);
        let packing = match format {
            TableFormat::Npy => None,
            TableFormat::Ply => Some(Packing::new(layout).map_err(failed)?),
        };
        let mut columns = cloud.columns();
        if format == TableFormat::Npy {
            let names = layout.columns();
            let kept = table_columns(layout);
            let column = |name: &&str| names.iter().position(|n| n == name).map(|i| columns[i]);
            columns = kept.iter().filter_map(column).collect();
        }
        let points = self.found.reachable;
        let table = TableRecorder::new(file, format, layout, points, &describe(run));
        let mut table = table.map_err(failed)?;
        let made = || Points::new(cloud, &columns, packing.as_ref());
        let mut bytes = Vec::new();
        let mut write = |portion: Portion| {
            bytes.clear();
            bytes.extend(portion.values.iter().flat_map(|value| value.to_le_bytes()));
            table.push(&bytes).map_err(failed)?;
            table.push(&portion.packed).map_err(failed)?;
            if let Some(packing) = &packing {
                packing.reuse(portion);
            }
            Ok(())
        };
        self.source.points(
            self.progress,
            |hits, points: &mut Points<'_>| points.add(hits),
            made,
            |mut points| points.take()?.into_iter().try_for_each(&mut write),
        )?;
        table.finish().map_err(failed)
    }

    fn failed(&self, error: &RecordError) -> Failure {
        Failure::at(self.path.display(), error)
    }

    /// Tells where the rest is.
    fn interrupted(&self, failure: Failure) -> Failure {
        match failure {
            Failure::Interrupted(message) => Failure::Interrupted(format!(
                "{message}; what was recorded is in {}",
                partial(self.path).display()
            )),
            other => other,
        }
    }

    /// A recording: an overview, then all points.
    fn mcap(&self, file: PartialFile) -> Result<(), Failure> {
        let failed = |error| Failure::at(self.path.display(), &error);
        let Self { run, cloud, source, found, study, progress, .. } = *self;
        let columns = cloud.columns();
        let workspace = Workspace {
            layout: self.layout.clone(),
            mechanism_name: &run.loaded.file_name,
            mechanism: run.loaded.text.as_bytes(),
            run: describe(run),
            points: found.reachable,
            slices: run.grid.slices() / together(run.grid),
        };
        let packing = Packing::new(&workspace.layout).map_err(failed)?;
        let mut recorder = WorkspaceRecorder::new(file, &workspace).map_err(failed)?;
        let together = together(run.grid);
        let lines = study
            .and_then(|study| pose_boundary(run.grid, study, together, |pose| cloud.place(pose)));
        if let Some(lines) = lines {
            recorder.boundary(lines).map_err(failed)?;
        }
        let interrupted = |failure| self.interrupted(failure);
        let every = recorder.overview_every();
        // Of all points, how many there were, and which is the overview's next.
        let (mut seen, mut next) = (0, 0);
        let mut overview = Points::new(cloud, &columns, Some(&packing));
        let first = &run.grid.axes()[0];
        let (mut pose, mut chosen) = (vec![0.0; run.grid.axes().len()], Vec::new());
        source
            .points(
                progress,
                |hits, runs: &mut Vec<_>| runs.extend(hits.numbers(run.grid)),
                Vec::new,
                |runs| {
                    for poses in runs {
                        let end = seen + (poses.to - poses.from);
                        if next < end {
                            // A run is in one row.
                            run.grid.pose_into(poses.from, &mut pose);
                            let place = poses.from % first.count;
                            chosen.clear();
                            while next < end {
                                chosen.push(first.value(place + (next - seen)));
                                next += every;
                            }
                            overview.line(0, &chosen, &pose[1..]);
                        }
                        seen = end;
                    }
                    overview.take()?.into_iter().try_for_each(|portion| {
                        recorder.overview_packed(&portion.packed).map_err(failed)?;
                        packing.reuse(portion);
                        Ok(())
                    })
                },
            )
            .map_err(interrupted)?;
        source
            .points(
                progress,
                |hits, points: &mut Points<'_>| points.add(hits),
                || Points::new(cloud, &columns, Some(&packing)),
                |mut points| {
                    points.take()?.into_iter().try_for_each(|portion| {
                        let slice = portion.slice / together;
                        recorder.push_packed(slice, &portion.packed).map_err(failed)?;
                        packing.reuse(portion);
                        Ok(())
                    })
                },
            )
            .map_err(interrupted)?;
        recorder.finish(&result(run, found)).map_err(failed)
    }
}

/// How many of the grid's slices make one of the recording's: whole axes, the faster ones first, until
/// a person can play what is left.
pub fn together(grid: &Grid) -> u64 {
    let upper = &grid.axes()[grid.lower()..];
    let mut together = 1;
    for axis in &upper[..upper.len() - 1] {
        if grid.slices() / together > PLAYABLE {
            together *= axis.count;
        }
    }
    together
}

/// The name of an unfinished file.
pub fn partial(path: &Path) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".partial");
    name.into()
}

/// What is known of a run before it.
pub fn describe(run: &Run<'_>) -> Metadata {
    let mut record: Metadata = [
        ("program", PROGRAM.to_owned()),
        ("mechanism", run.manipulator.mechanism().name.clone()),
        ("mechanism_file", run.loaded.file_name.clone()),
        ("kind", run.kind.name()),
        ("mode", run.mode()),
        ("poses", run.grid.poses().to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into();
    if let Some(ConditionLimit { most, length }) = run.limit {
        record.insert("max_condition".to_owned(), most.to_string());
        record.insert("characteristic_length".to_owned(), length.to_string());
    }
    for Axis { name, min, max, count } in run.grid.axes() {
        record.insert(format!("grid.{name}"), format!("{min}:{max}:{count}"));
    }
    record
}

/// What came of it.
fn result(run: &Run<'_>, found: &Count) -> Metadata {
    let mut record: Metadata = [
        ("reachable", found.reachable.to_string()),
        ("fraction", (found.reachable as f64 / found.poses as f64).to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into();
    if let Some((measure, units)) = run.measure(run.kind, found, FileUnits::SI) {
        record.insert("measure".to_owned(), measure.to_string());
        record.insert("measure_units".to_owned(), units);
    }
    record.extend(ranges(run, found));
    record
}

/// The ranges of the imaginary joints, to the last digit.
pub fn ranges(run: &Run<'_>, found: &Count) -> Metadata {
    let ranges = run.manipulator.imaginary().iter().zip(&found.imaginary);
    ranges
        .filter_map(|(joint, range)| {
            let [low, high] = (*range)?;
            Some((range_key(&joint.name), format!("{low}:{high}")))
        })
        .collect()
}

/// The key of an imaginary joint's range.
pub fn range_key(joint: &str) -> String {
    format!("range.{joint}")
}

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::Interrupted("interrupted".to_owned())
    }
}
