//! Work on a workspace, on several threads, while a bar shows the progress.

use super::advice;
use super::report::Effort;
use crate::args::Output;
use crate::failure::Failure;
use crate::layout;
use crate::output::Shown;
use crate::pose::GridAxis;
use crate::progress::watch;
use crate::text::count;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::file::FileUnits;
use opm_study::recording::{
    Findings, ShardCount, ShardFindings, ShardRecording, WorkspaceRecording,
};
use opm_study::{
    Analysis, CheckedRequest, PoseSource, StudyError, Workspace, WorkspaceKind, WorkspaceRequest,
};
use opm_workspace::{Aspects, Cancelled, Count, Modes, Progress, Rejections, Shard, Sweep};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::Arc;
use std::time::Instant;

/// The thread pool of the work, and the output for its progress.
pub struct Work<'a> {
    pub output: &'a Output,
    pub pool: &'a ThreadPool,
    pub progress: &'a Progress,
}

impl Work<'_> {
    /// Fits a grid if none is given, and notes it in the units of the mechanism file.
    pub fn fit(&self, request: CheckedRequest, units: FileUnits) -> Result<Workspace, Failure> {
        if request.grid().is_some() {
            return request.fit(self.progress).map_err(StudyError::from).map_err(Failure::from);
        }
        let (progress, pool) = (self.progress, self.pool);
        let find = || pool.install(|| request.fit(progress));
        let workspace = watch(self.output, "fitting a grid", None, || progress.done(), find)
            .map_err(|Cancelled| Failure::interrupted("interrupted while fitting a grid"))?;
        advice::of_fitted(&workspace, units, self.output);
        Ok(workspace)
    }

    /// Counts the poses of a shard, and sums up their conditioning if it is requested.
    pub fn count(
        &self,
        workspace: &Workspace,
        shard: Shard,
    ) -> Result<(ShardCount, Effort), Failure> {
        let sweep = workspace.sweep().shard(shard);
        self.counted(workspace, &sweep, || Ok((sweep.count(self.progress)?, ())))
            .map(|(found, effort, ())| (found, effort))
    }

    /// As [`count`](Self::count), for all poses, with a source of them.
    pub fn count_and_keep<'w>(
        &self,
        workspace: &'w Workspace,
    ) -> Result<(ShardCount, Effort, PoseSource<'w>), Failure> {
        let count = || workspace.count_and_keep(self.progress);
        self.counted(workspace, &workspace.sweep(), count)
    }

    /// Counts the poses of a sweep of a workspace, and what belongs to that.
    fn counted<T: Send>(
        &self,
        workspace: &Workspace,
        sweep: &Sweep<'_>,
        job: impl FnOnce() -> Result<(Count, T), Cancelled> + Send,
    ) -> Result<(ShardCount, Effort, T), Failure> {
        let start = Instant::now();
        let poses = sweep.poses();
        let before = self.progress.done();
        let found = self.watch("counting", poses, job);
        let (count, more) = found.map_err(|Cancelled| {
            let (done, poses) = (count(self.progress.done() - before), count(poses));
            Failure::interrupted(format!("interrupted; {done} of {poses} poses were decided"))
        })?;
        let seconds = start.elapsed().as_secs_f64().max(1e-9);
        let conditioning = match workspace.conditioning_length() {
            None => None,
            Some(_) => {
                let job = || workspace.index(sweep, self.progress);
                self.watch("conditioning", poses, job)?
            }
        };
        Ok((ShardCount { count, conditioning }, Effort::Counted { poses, seconds }, more))
    }

    /// Computes the other requested results of a workspace whose poses are counted.
    pub fn analyse(
        &self,
        workspace: &Workspace,
        found: ShardCount,
        poses: &PoseSource<'_>,
    ) -> Result<Analysis, Failure> {
        let ShardCount { count, conditioning } = found;
        let mut analysis = match workspace.needs_points() {
            false => Analysis::of_count(workspace.kind(), count),
            true => {
                let job = || Analysis::of_points(workspace, count, poses, self.progress);
                self.watch("analysing", workspace.grid().poses(), job)?
            }
        };
        analysis.conditioning = conditioning;
        Ok(analysis)
    }

    /// Finds the aspects of a manipulator in one working mode, on a grid that is given or fitted.
    pub fn aspects(
        &self,
        manipulator: &Arc<Manipulator>,
        mode: Mode,
        grid: &[GridAxis],
        units: FileUnits,
    ) -> Result<Aspects, Failure> {
        let mut request = WorkspaceRequest::new(WorkspaceKind::Aspects).modes(Modes::One(mode));
        let coordinates = WorkspaceKind::Aspects.sections().coordinates(manipulator);
        let axes = grid.iter().map(|axis| axis.resolve(&coordinates));
        request.axes = axes.collect::<Result<_, _>>()?;
        let workspace = self.fit(request.check(Arc::clone(manipulator))?, units)?;
        let (found, _, poses) = self.count_and_keep(&workspace)?;
        let analysis = self.analyse(&workspace, found, &poses)?;
        Ok(analysis.aspects.expect("the kind is of aspects"))
    }

    /// Finds what rejects the poses.
    pub fn explain(&self, workspace: &Workspace) -> Result<Rejections, Failure> {
        let poses = workspace.grid().poses();
        self.watch("explaining", poses, || workspace.rejections(self.progress))
            .map_err(Failure::from)
    }

    /// Records every point that was counted.
    pub fn record(
        &self,
        recording: WorkspaceRecording,
        findings: &Findings<'_>,
    ) -> Result<(), Failure> {
        let poses = recording.work(findings);
        let job = || recording.write(findings, self.progress);
        let path = self.watch("recording", poses, job)?;
        let points = count(findings.analysis.count.reachable);
        self.output.note(format_args!("{}: {points} points", path.shown()));
        layout::advise(&path, self.output);
        Ok(())
    }

    /// Stores the poses of a shard.
    pub fn record_shard(
        &self,
        recording: ShardRecording,
        findings: &ShardFindings<'_>,
    ) -> Result<(), Failure> {
        let poses = findings.workspace.sweep().shard(findings.shard).poses();
        let job = || recording.write(findings, self.progress);
        Ok(self.watch("recording", poses, job)?)
    }

    /// Runs a job on the threads while a bar shows the progress.
    fn watch<T: Send>(&self, label: &'static str, poses: u64, job: impl FnOnce() -> T + Send) -> T {
        let before = self.progress.done();
        let done = || self.progress.done() - before;
        watch(self.output, label, Some(poses), done, || self.pool.install(job))
    }
}

/// A pool with this number of threads, or with one per processor.
pub fn threads(number: Option<u16>) -> Result<ThreadPool, Failure> {
    let builder = ThreadPoolBuilder::new().num_threads(number.map_or(0, usize::from));
    builder.build().map_err(|error| Failure::at("threads", error))
}
