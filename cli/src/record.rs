//! The recording of a sweep: the passes that write it, and what it says of the run.

use crate::cloud::{Cloud, Points, Poses};
use crate::failure::Failure;
use crate::kind::{SetRecording, Study, pose_boundary};
use crate::text::count;
use crate::workspace::Run;
use opm_core::mechanism::file::FileUnits;
use opm_mcap::{MAX_SLICES, Metadata, PartialFile, RecordError, Workspace, WorkspaceRecorder};
use opm_workspace::{Axis, Cancelled, ConditionLimit, Count, Grid, Progress, Sweep};
use std::fs;
use std::path::{Path, PathBuf};

/// More slices than this play for longer than a quarter of an hour.
const PLAYABLE: u64 = 10_000;

/// Points between two looks at whether somebody pressed Ctrl-C.
const PORTION: u64 = 1 << 12;

/// A file that is open for a recording.
pub struct Recorder {
    path: PathBuf,
    /// `None` once there is something in it.
    file: Option<PartialFile>,
}

impl Recorder {
    /// Refuses a grid whose slowest axis alone has more values than a recording may have slices.
    pub fn check(grid: &Grid) -> Result<(), Failure> {
        let slices = grid.slices() / together(grid);
        if slices <= MAX_SLICES {
            return Ok(());
        }
        let slowest = grid.axes().last().map_or("", |axis| &axis.name);
        let (slices, most) = (count(slices), count(MAX_SLICES));
        let problem = format!("{slices} slices, one a value of {slowest}, expected at most {most}");
        Err(Failure::flag("--grid", problem))
    }

    /// Opens the file before the work starts, so that a wrong path costs no time.
    pub fn create(path: &Path) -> Result<Self, Failure> {
        if path == Path::new("-") {
            return Err(Failure::flag("--output", "a recording needs a file, not standard output"));
        }
        let file = PartialFile::create(path).map_err(|e| Failure::at(path.display(), &e))?;
        Ok(Self { path: path.to_owned(), file: Some(file) })
    }

    /// Records every point that was counted: an overview, then all of them. Returns the path.
    pub fn record(
        mut self,
        run: &Run<'_>,
        cloud: &Cloud<'_>,
        sweep: &Sweep<'_>,
        found: &Count,
        study: &Study,
        progress: &Progress,
    ) -> Result<PathBuf, Failure> {
        let color_range = cloud.color_range(sweep, found, run.grid, progress)?;
        let failed = |error: RecordError| Failure::at(self.path.display(), &error);
        let columns = cloud.columns();
        let workspace = Workspace {
            layout: cloud.layout(color_range),
            mechanism_name: &run.loaded.file_name,
            mechanism: run.loaded.text.as_bytes(),
            run: describe(run, found),
            points: found.reachable,
            slices: run.grid.slices() / together(run.grid),
        };
        let Some(file) = self.file.take() else { return Ok(self.path.clone()) };
        let mut recorder = WorkspaceRecorder::new(file, &workspace).map_err(failed)?;
        let interrupted = |failure| match failure {
            Failure::Interrupted(message) => Failure::Interrupted(format!(
                "{message}; what was recorded is in {}",
                partial(&self.path).display()
            )),
            other => other,
        };

        let together = together(run.grid);
        if let Some(lines) = pose_boundary(run.grid, study, together, |pose| cloud.place(pose)) {
            recorder.boundary(lines).map_err(failed)?;
        }
        let every = recorder.overview_every();
        let mut number = 0;
        let mut overview = Points::new(cloud, &columns);
        sweep
            .points(
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
                    let rows = overview.take()?;
                    rows.iter().try_for_each(|(_, rows)| recorder.overview(rows).map_err(failed))
                },
            )
            .map_err(interrupted)?;
        sweep
            .points(
                progress,
                |hits, points: &mut Points<'_>| points.add(hits),
                || Points::new(cloud, &columns),
                |mut points| {
                    let rows = points.take()?;
                    rows.iter()
                        .try_for_each(|(s, rows)| recorder.push(s / together, rows).map_err(failed))
                },
            )
            .map_err(interrupted)?;
        recorder.finish(&result(run, found)).map_err(failed)?;
        Ok(self.path.clone())
    }
}

impl Recorder {
    /// Records a set that is no set of poses: an overview, then every point. Returns the path.
    pub fn record_set(
        mut self,
        run: &Run<'_>,
        set: &SetRecording<'_>,
        found: &Count,
        progress: &Progress,
    ) -> Result<PathBuf, Failure> {
        let failed = |error: RecordError| Failure::at(self.path.display(), &error);
        let mut about = describe(run, found);
        about.insert("set".to_owned(), set.set_axes());
        let workspace = Workspace {
            layout: set.layout(found),
            mechanism_name: &run.loaded.file_name,
            mechanism: run.loaded.text.as_bytes(),
            run: about,
            points: found.reachable,
            slices: set.slices,
        };
        let Some(file) = self.file.take() else { return Ok(self.path.clone()) };
        let mut recorder = WorkspaceRecorder::new(file, &workspace).map_err(failed)?;
        if let Some(lines) = set.boundary() {
            recorder.boundary(lines).map_err(failed)?;
        }
        let every = recorder.overview_every();
        let going = |number: u64| match progress.is_cancelled() && number.is_multiple_of(PORTION) {
            false => Ok(()),
            true => Err(Failure::Interrupted(format!(
                "interrupted; what was recorded is in {}",
                partial(&self.path).display()
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
        Ok(self.path.clone())
    }
}

impl Drop for Recorder {
    /// A file in which nothing was recorded is not worth keeping.
    fn drop(&mut self) {
        if self.file.take().is_some() {
            let _ = fs::remove_file(partial(&self.path));
        }
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
fn describe(run: &Run<'_>, found: &Count) -> Metadata {
    let mut record: Metadata = [
        ("program", format!("opm {}", env!("CARGO_PKG_VERSION"))),
        ("mechanism", run.manipulator.mechanism().name.clone()),
        ("mechanism_file", run.loaded.file_name.clone()),
        ("kind", run.kind.name()),
        ("mode", run.mode()),
        ("poses", found.poses.to_string()),
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

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::Interrupted("interrupted".to_owned())
    }
}
