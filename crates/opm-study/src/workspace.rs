//! Workspaces that are fully defined and can be swept and analysed.

use crate::error::{RequestError, StudyError};
use crate::kind::WorkspaceKind;
use crate::measure::{Measure, grid_measure};
use crate::poses::PoseSource;
use opm_analysis::Setup;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_interference::Interference;
use opm_workspace::{
    Cancelled, ClearanceLimit, ConditioningIndex, Count, Grid, GridSet, Modes, PoseLimit, Progress,
    Rejections, Sections, SetAxis, SetError, Sweep, Visits,
};
use std::sync::Arc;

/// Most runs of poses that are kept, which take 64 MiB.
const MOST_RUNS: usize = 1 << 22;

/// The definition of a workspace: manipulator, kind, grid, working modes, and the requested results. A
/// [`WorkspaceRequest`](crate::WorkspaceRequest) makes one.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(crate) manipulator: Arc<Manipulator>,
    pub(crate) kind: WorkspaceKind,
    pub(crate) grid: Grid,
    pub(crate) modes: Modes,
    pub(crate) clearance: Option<Clearance>,
    pub(crate) limit: Option<PoseLimit>,
    pub(crate) setup: Arc<Setup>,
    pub(crate) conditioning: bool,
    pub(crate) shape: bool,
    pub(crate) unbounded: Option<Vec<String>>,
}

/// The least distance of bodies at which a pose counts.
#[derive(Clone, Debug)]
pub struct Clearance {
    /// The pairs of bodies.
    pub interference: Arc<Interference>,
    /// The least distance, metres.
    pub least: f64,
}

impl Clearance {
    /// A clearance of a manipulator's bodies, metres.
    pub(crate) fn new(manipulator: &Manipulator, least: f64) -> Self {
        let interference = Arc::new(Interference::new(manipulator.mechanism()));
        Self { interference, least }
    }
}

impl Workspace {
    /// The manipulator.
    pub fn manipulator(&self) -> &Arc<Manipulator> {
        &self.manipulator
    }

    /// The kind of workspace: what it consists of.
    pub fn kind(&self) -> WorkspaceKind {
        self.kind
    }

    /// The grid of the poses that are tested.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The working modes that count.
    pub fn modes(&self) -> Modes {
        self.modes
    }

    /// `any`, or the signs of the working mode.
    pub fn mode_name(&self) -> String {
        match self.modes {
            Modes::Any => "any".to_owned(),
            Modes::One(mode) => self.manipulator.format_mode(mode),
        }
    }

    /// What a pose has to be like to count: its condition number and its indices.
    pub fn limit(&self) -> Option<&PoseLimit> {
        self.limit.as_ref()
    }

    /// The least distance of bodies at which a pose counts.
    pub fn clearance(&self) -> Option<&Clearance> {
        self.clearance.as_ref()
    }

    /// Characteristic length of condition numbers, metres.
    pub fn length(&self) -> f64 {
        self.setup.length
    }

    /// What condition numbers and indices are computed with.
    pub fn setup(&self) -> &Arc<Setup> {
        &self.setup
    }

    /// The limit of the poses, or one that admits them all.
    pub fn limit_or_none(&self) -> PoseLimit {
        self.limit.clone().unwrap_or_else(|| PoseLimit::of(Arc::clone(&self.setup)))
    }

    /// Characteristic length of the conditioning index, if the index is requested.
    pub fn conditioning_length(&self) -> Option<f64> {
        self.conditioning.then_some(self.setup.length)
    }

    /// The coordinates along which the workspace extends beyond a fitted grid; `None` for a
    /// grid that was given.
    pub fn unbounded(&self) -> Option<&[String]> {
        self.unbounded.as_deref()
    }

    /// The same workspace, with its boundary and its connected components requested too.
    #[must_use]
    pub fn with_shape(self, shape: bool) -> Self {
        Self { shape, ..self }
    }

    /// Whether another workspace has the same kind, grid, working modes, and limit on condition numbers with
    /// their characteristic length: the same points, if it is one of the same mechanism.
    pub fn has_request_of(&self, other: &Self) -> bool {
        let clearance = |one: &Self| one.clearance.as_ref().map(|clearance| clearance.least);
        let request = |one: &Self| (one.kind, one.modes, one.setup.length, clearance(one));
        request(self) == request(other) && self.limit == other.limit && self.grid == other.grid
    }

    /// The sweep of the grid.
    pub fn sweep(&self) -> Sweep<'_> {
        let sweep = Sweep::new(&self.manipulator, &self.grid, self.modes);
        let sweep = match &self.limit {
            Some(limit) => sweep.with_limit(limit.clone()).expect("the request was checked"),
            None => sweep,
        };
        match &self.clearance {
            Some(Clearance { interference, least }) => {
                let limit = ClearanceLimit { interference, least: *least };
                sweep.with_clearance(limit).expect("the request was checked")
            }
            None => sweep,
        }
    }

    /// What rejects the poses of the grid.
    ///
    /// # Errors
    /// The kind is not one of poses of both sections, or the work was cancelled.
    pub fn rejections(&self, progress: &Progress) -> Result<Rejections, StudyError> {
        if self.kind.sections() != Sections::Whole {
            return Err(RequestError::ExplainKind { kind: self.kind }.into());
        }
        Ok(Rejections::new(&self.manipulator, &self.grid, self.modes, progress)?)
    }

    /// The poses, from a sweep.
    pub fn poses(&self) -> PoseSource<'_> {
        PoseSource::Sweep(Box::new(self.sweep()))
    }

    /// Counts the poses of the grid, and gives their source for what is to be done with them: their numbers where those
    /// fit into some memory, else the sweep once more.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn count_and_keep(
        &self,
        progress: &Progress,
    ) -> Result<(Count, PoseSource<'_>), Cancelled> {
        let sweep = self.sweep();
        let (count, kept) = sweep.count_and_keep(MOST_RUNS, progress)?;
        let poses = match kept {
            Some(runs) => PoseSource::Kept(&self.grid, runs),
            None => PoseSource::Sweep(Box::new(sweep)),
        };
        Ok((count, poses))
    }

    /// Whether the points have to be held in memory, or the poses visited again. This is so for a shape, and
    /// if the points are not poses of the grid.
    pub fn needs_points(&self) -> bool {
        self.wants_shape() || !self.kind.is_of_poses()
    }

    /// Whether the boundary and the components are requested.
    pub(crate) fn wants_shape(&self) -> bool {
        self.shape || self.kind != WorkspaceKind::Grid
    }

    /// Sums up the conditioning of the poses of the sweep, or of a shard of it, if it is requested.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn index(
        &self,
        sweep: &Sweep<'_>,
        progress: &Progress,
    ) -> Result<Option<ConditioningIndex>, StudyError> {
        let index = |length| ConditioningIndex::of(sweep, length, progress);
        Ok(self.conditioning_length().map(index).transpose()?)
    }

    /// The number of orientations of the grid at which a sweep, or a shard of it, reaches each point; `None` for
    /// a kind whose points are points of the grid. The numbers of all shards add up.
    ///
    /// # Errors
    /// The points do not fit in memory, or the work was cancelled.
    pub fn visits(
        &self,
        sweep: &Sweep<'_>,
        progress: &Progress,
    ) -> Result<Option<Vec<u64>>, SetError> {
        match self.kind {
            WorkspaceKind::Reachable | WorkspaceKind::Dexterous => {
                Ok(Some(Visits::new(sweep, progress)?.counts().to_vec()))
            }
            WorkspaceKind::Imaginary => {
                let set = GridSet::slices(sweep, progress)?;
                let mut visits = vec![0; set.points() as usize];
                set.numbers().for_each(|number| visits[number as usize] = 1);
                Ok(Some(visits))
            }
            WorkspaceKind::Grid
            | WorkspaceKind::ConstantOrientation
            | WorkspaceKind::Orientation
            | WorkspaceKind::Aspects
            | WorkspaceKind::Upper
            | WorkspaceKind::Lower => Ok(None),
        }
    }

    /// The number of orientations at which a point has to be reached to belong to the set: see
    /// [`WorkspaceKind::required_visits`].
    pub fn required_visits(&self) -> Option<u64> {
        self.kind.required_visits(&self.grid)
    }

    /// The set of the points for whose numbers `holds` is true.
    ///
    /// # Errors
    /// The set does not fit in memory.
    pub fn set(&self, holds: impl Fn(u64) -> bool) -> Result<GridSet, SetError> {
        let axis = |i: usize| SetAxis {
            axis: self.grid.axes()[i].clone(),
            circle: self.grid.is_circle(i),
        };
        GridSet::of(self.kind.axes(&self.grid).map(axis).collect(), holds)
    }

    /// The reachable share of the box that the axes of the set span, over the axes with more than one
    /// value. `None` for values of imaginary joints, which are not on a grid. The measures of shards add up.
    pub fn measure(&self, kind: WorkspaceKind, count: &Count, units: FileUnits) -> Option<Measure> {
        if kind == WorkspaceKind::Imaginary {
            return None;
        }
        let axes = kind.axes(&self.grid);
        let points: u64 = self.grid.axes()[axes.clone()].iter().map(|axis| axis.count).product();
        let axes = axes.map(|i| (&self.grid.axes()[i], self.grid.coordinates()[i].quantity));
        Some(grid_measure(count.reachable as f64 / points as f64, axes, units))
    }
}
