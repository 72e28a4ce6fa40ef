//! The recording of a workspace: the passes over its points that write it.

use super::describe::{describe, result};
use super::points::{Cloud, Packing, Points, Portion};
use super::rejected::Rejected;
use super::set::{SetCloud, pose_boundary};
use super::slices::{slices_of, slices_together};
use super::{Attachment, check_mcap, create, partial, refuse_standard_output};
use crate::analysis::Analysis;
use crate::columns::{Column, PointChoice, PointColumns};
use crate::error::{RequestError, SetPart, StudyError};
use crate::kind::WorkspaceKind;
use crate::poses::PoseSource;
use crate::request::CheckedRequest;
use crate::workspace::Workspace;
use opm_mcap::{
    CloudLayout, MAX_SLICES, PartialFile, RecordError, TableFormat, TableRecorder,
    WorkspaceRecorder, table_columns,
};
use opm_workspace::{Grid, Hits, Inscribed, Poses, Progress, RejectedPoint, Rejections};
use std::fs;
use std::path::{Path, PathBuf};

/// Number of points between two checks for cancellation.
const PORTION: u64 = 1 << 12;

/// An open file for the recording of a workspace.
///
/// It is opened before the work starts, so that a wrong path costs no time. It gets its name when it is
/// complete.
#[derive(Debug)]
pub struct WorkspaceRecording {
    path: PathBuf,
    file: PartialFile,
    format: Format,
    points: PointChoice,
}

/// The content of a recording: everything that is known about a workspace.
#[derive(Clone, Copy)]
pub struct Findings<'a> {
    /// The file of the mechanism.
    pub mechanism: Attachment<'a>,
    /// The workspace.
    pub workspace: &'a Workspace,
    /// The poses of the workspace.
    pub poses: &'a PoseSource<'a>,
    /// The results.
    pub analysis: &'a Analysis,
    /// The largest shape in the set of points, if it was asked for ([`Workspace::inscribed`]).
    pub inscribed: Option<&'a Inscribed>,
    /// What rejects the other poses, if it was asked for ([`Workspace::rejections`]). The rejected points are recorded
    /// too, in MCAP.
    pub rejections: Option<&'a Rejections>,
}

/// The file format of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Mcap,
    Table(TableFormat),
}

impl Format {
    /// The format that the ending of a file name stands for.
    fn of(path: &Path) -> Result<Self, RequestError> {
        refuse_standard_output(path)?;
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        match ending.as_deref() {
            Some("mcap") => Ok(Self::Mcap),
            Some("npy") => Ok(Self::Table(TableFormat::Npy)),
            Some("ply") => Ok(Self::Table(TableFormat::Ply)),
            _ => Err(RequestError::FileEnding { path: path.to_owned() }),
        }
    }
}

/// Refuses a name with an unknown ending, or one that is not allowed for sets of this kind. For MCAP, also
/// refuses a grid whose slowest axis has more values than a recording may have slices.
fn check(path: &Path, kind: WorkspaceKind, grid: Option<&Grid>) -> Result<(), RequestError> {
    if !kind.is_of_poses() {
        return check_mcap(path, || RequestError::KindIsMcap { path: path.to_owned(), kind });
    }
    let format = Format::of(path)?;
    let Some(grid) = grid.filter(|_| format == Format::Mcap) else { return Ok(()) };
    let slices = grid.slices() / slices_together(grid);
    if slices <= MAX_SLICES {
        return Ok(());
    }
    let axis = grid.axes().last().map_or_else(String::new, |axis| axis.name.clone());
    let (part, given, most) = (SetPart::Slices, slices, MAX_SLICES);
    Err(RequestError::TooManySlices { part, given, axis, most })
}

impl WorkspaceRecording {
    /// Opens a file for the requested workspace. The ending of the name selects the format.
    ///
    /// # Errors
    /// The name or the grid is not allowed for a recording, or the file cannot be written.
    pub fn create(path: &Path, request: &CheckedRequest) -> Result<Self, StudyError> {
        check(path, request.kind(), request.grid())?;
        Self::open(path, request.points().clone())
    }

    /// Opens a file for a workspace. These values are stored with every point.
    ///
    /// # Errors
    /// As [`WorkspaceRecording::create`].
    pub fn of_workspace(
        path: &Path,
        workspace: &Workspace,
        points: PointChoice,
    ) -> Result<Self, StudyError> {
        check(path, workspace.kind, Some(&workspace.grid))?;
        Self::open(path, points)
    }

    fn open(path: &Path, points: PointChoice) -> Result<Self, StudyError> {
        let format = Format::of(path)?;
        Ok(Self { path: path.to_owned(), file: create(path)?, format, points })
    }

    /// The number of poses that are tested again to write it. Every pass visits the whole grid. Where an overview has
    /// every point, its pass counts twice, because it is that of the slices, too.
    pub fn work(&self, findings: &Findings<'_>) -> u64 {
        let workspace = findings.workspace;
        let rejected = findings.rejections.filter(|_| self.format == Format::Mcap);
        let rejected = rejected.map_or(0, |rejections| rejections.poses);
        if !workspace.kind.is_of_poses() {
            return rejected;
        }
        let shown = PointColumns::of_poses(self.points.clone(), &workspace.grid);
        let passes = Cloud::new(workspace, shown).passes();
        let passes = if self.format == Format::Mcap { passes } else { passes - 1 };
        rejected + passes * workspace.grid.poses()
    }

    /// Writes the recording of a workspace, and returns its path.
    ///
    /// # Errors
    /// The file cannot be written, the poses cannot be read, or the work was cancelled.
    pub fn write(
        self,
        findings: &Findings<'_>,
        progress: &Progress,
    ) -> Result<PathBuf, StudyError> {
        let Self { path, file, format, points } = self;
        let Findings { mechanism, workspace, analysis, .. } = *findings;
        if !workspace.kind.is_of_poses() {
            let set = analysis.set.as_ref().ok_or(StudyError::NoSet)?;
            let cloud = SetCloud::new(workspace, analysis, set, points)?;
            record_set(findings, &cloud, file, &path, progress)?;
            return Ok(path);
        }
        let shown = PointColumns::of_poses(points, &workspace.grid);
        let cloud = Cloud::new(workspace, shown).with_aspects(analysis.aspects.as_ref());
        let cloud = match format {
            Format::Mcap => cloud,
            Format::Table(format) => cloud.with_every_coordinate(format),
        };
        let color_range = cloud.color_range(findings.poses, &analysis.count, progress)?;
        let layout = cloud.layout(color_range);
        let job =
            PoseRecording { findings, cloud: &cloud, mechanism, progress, path: &path, layout };
        match format {
            Format::Mcap => job.mcap(file)?,
            Format::Table(format) => job.table(file, format).inspect_err(|_| {
                // An incomplete table is of no use.
                let _ = fs::remove_file(partial(&path));
            })?,
        }
        Ok(path)
    }
}

/// The error for a recording that was cancelled. It names the unfinished file.
fn interrupted(path: &Path, error: StudyError) -> StudyError {
    match error {
        StudyError::Cancelled => StudyError::CancelledRecording { partial: partial(path) },
        other => other,
    }
}

/// Records a set in memory: an overview, then every point.
fn record_set(
    findings: &Findings<'_>,
    set: &SetCloud<'_>,
    file: PartialFile,
    path: &Path,
    progress: &Progress,
) -> Result<(), StudyError> {
    let Findings { mechanism, workspace, analysis, inscribed, rejections, .. } = *findings;
    let failed = |error: RecordError| StudyError::record(path.display(), error);
    let mut run = describe(workspace, mechanism);
    run.insert("poses".to_owned(), analysis.count.poses.to_string());
    run.insert("set".to_owned(), set.axis_names());
    let header = opm_mcap::Workspace {
        layout: set.layout(),
        mechanism_name: mechanism.name,
        mechanism: mechanism.text.as_bytes(),
        run,
        points: analysis.count.reachable,
        slices: set.slices(),
    };
    let mut recorder = WorkspaceRecorder::new(file, &header).map_err(failed)?;
    if let Some(lines) = set.boundary() {
        recorder.boundary(lines).map_err(failed)?;
    }
    if let Some(rejections) = rejections {
        let (shown, layout, held) = (set.shown(), &set.layout(), analysis.count.reachable);
        let rejected = Rejected { workspace, rejections, shown, layout, held };
        let slice = |point: &RejectedPoint| set.slice_of(point.point);
        let recorded = rejected.record(&mut recorder, slice, progress, failed);
        recorded.map_err(|error| interrupted(path, error))?;
    }
    let every = recorder.overview_every();
    let going = |number: u64| match progress.is_cancelled() && number.is_multiple_of(PORTION) {
        false => Ok(()),
        true => Err(StudyError::CancelledRecording { partial: partial(path) }),
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
    recorder.finish(&result(workspace, &analysis.count, inscribed)).map_err(failed)
}

/// A recording of poses that is being written.
struct PoseRecording<'a> {
    findings: &'a Findings<'a>,
    cloud: &'a Cloud<'a>,
    mechanism: Attachment<'a>,
    progress: &'a Progress,
    path: &'a Path,
    layout: CloudLayout,
}

impl PoseRecording<'_> {
    fn failed(&self, error: RecordError) -> StudyError {
        StudyError::record(self.path.display(), error)
    }

    /// One table of all points, in one pass.
    fn table(&self, file: PartialFile, format: TableFormat) -> Result<(), StudyError> {
        let Self { findings, cloud, layout, .. } = self;
        let failed = |error| self.failed(error);
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
        let points = findings.analysis.count.reachable;
        let run = describe(findings.workspace, self.mechanism);
        let table = TableRecorder::new(file, format, layout, points, &run);
        let mut table = table.map_err(failed)?;
        let made = || Points::new(cloud, &columns, packing.as_ref());
        let mut write = |portion: Portion| {
            match &packing {
                None => table.push_rows(&portion.values).map_err(failed)?,
                Some(packing) => {
                    table.push(&portion.packed).map_err(failed)?;
                    packing.reuse(portion);
                }
            }
            Ok(())
        };
        findings.poses.points(
            self.progress,
            |hits, points: &mut Points<'_>| points.add(hits),
            made,
            |mut points| points.take()?.into_iter().try_for_each(&mut write),
        )?;
        table.finish().map_err(failed)
    }

    fn interrupted(&self, error: StudyError) -> StudyError {
        interrupted(self.path, error)
    }

    /// A recording: an overview, then all points.
    fn mcap(&self, file: PartialFile) -> Result<(), StudyError> {
        let failed = |error| self.failed(error);
        let Self { cloud, findings, mechanism, progress, .. } = *self;
        let Findings { workspace, poses, analysis, inscribed, .. } = *findings;
        let (grid, count) = (&workspace.grid, &analysis.count);
        let columns = cloud.columns();
        let together = slices_together(grid);
        let header = opm_mcap::Workspace {
            layout: self.layout.clone(),
            mechanism_name: mechanism.name,
            mechanism: mechanism.text.as_bytes(),
            run: describe(workspace, mechanism),
            points: count.reachable,
            slices: slices_of(grid),
        };
        let packing = Packing::new(&header.layout).map_err(failed)?;
        let mut recorder = WorkspaceRecorder::new(file, &header).map_err(failed)?;
        if let Some(lines) = pose_boundary(grid, analysis, together, |pose| cloud.place(pose)) {
            recorder.boundary(lines).map_err(failed)?;
        }
        if let Some(rejections) = findings.rejections {
            let (shown, layout, held) = (cloud.shown(), &self.layout, count.reachable);
            let rejected = Rejected { workspace, rejections, shown, layout, held };
            let within = grid.poses() / grid.slices() * together;
            let slice = |point: &RejectedPoint| point.pose / within;
            let recorded = rejected.record(&mut recorder, slice, progress, failed);
            recorded.map_err(|error| self.interrupted(error))?;
        }
        let each_point = |write: &mut (dyn FnMut(Portion) -> Result<(), StudyError> + Send)| {
            let made = || Points::new(cloud, &columns, Some(&packing));
            let add = |hits: &Hits<'_>, points: &mut Points<'_>| points.add(hits);
            let visit =
                |mut points: Points<'_>| points.take()?.into_iter().try_for_each(&mut *write);
            poses.points(progress, add, made, visit).map_err(|error| self.interrupted(error))
        };
        let push = |recorder: &mut WorkspaceRecorder<'_>, portion: Portion| {
            let slice = portion.slice / together;
            recorder.push_packed(slice, &portion.packed).map_err(failed)?;
            packing.reuse(portion);
            Ok(())
        };
        if recorder.overview_every() > 1 {
            self.overview(&mut recorder, &packing, &columns)?;
            each_point(&mut |portion| push(&mut recorder, portion))?;
        } else if poses.are_kept() && cloud.is_plain() {
            // The overview has every point. It takes less time to make them again than to get
            // memory for all of them from the system.
            each_point(&mut |portion| {
                recorder.overview_packed(&portion.packed).map_err(failed)?;
                packing.reuse(portion);
                Ok(())
            })?;
            each_point(&mut |portion| push(&mut recorder, portion))?;
        } else {
            // There are few enough to keep them for the slices.
            let mut kept = Vec::new();
            each_point(&mut |portion| {
                recorder.overview_packed(&portion.packed).map_err(failed)?;
                kept.push(portion);
                Ok(())
            })?;
            progress.advance(grid.poses()).map_err(|error| self.interrupted(error.into()))?;
            kept.into_iter().try_for_each(|portion| push(&mut recorder, portion))?;
        }
        recorder.finish(&result(workspace, count, inscribed)).map_err(failed)
    }

    /// The overview of a recording in which it does not have every point.
    fn overview(
        &self,
        recorder: &mut WorkspaceRecorder<'_>,
        packing: &Packing,
        columns: &[Column],
    ) -> Result<(), StudyError> {
        let grid = &self.findings.workspace.grid;
        let every = recorder.overview_every();
        // The number of points so far, and the number of the next point of the overview.
        let (mut seen, mut next) = (0, 0);
        let mut overview = Points::new(self.cloud, columns, Some(packing));
        let first = &grid.axes()[0];
        let (mut pose, mut chosen) = (vec![0.0; grid.axes().len()], Vec::new());
        self.findings
            .poses
            .points(
                self.progress,
                |hits, runs: &mut Vec<_>| runs.extend(hits.numbers(grid)),
                Vec::new,
                |runs| {
                    for poses in runs {
                        let end = seen + (poses.to - poses.from);
                        if next < end {
                            // All poses of a run are in one row.
                            grid.pose_into(poses.from, &mut pose);
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
                        recorder
                            .overview_packed(&portion.packed)
                            .map_err(|error| self.failed(error))?;
                        packing.reuse(portion);
                        Ok(())
                    })
                },
            )
            .map_err(|error| self.interrupted(error))
    }
}
