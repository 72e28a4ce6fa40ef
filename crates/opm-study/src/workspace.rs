//! Workspaces that are fully defined: what there is to be swept and analysed.

use crate::error::StudyError;
use crate::kind::WorkspaceKind;
use crate::measure::{Measure, grid_measure};
use crate::poses::PoseSource;
use opm_core::manipulator::Manipulator;
use opm_core::mechanism::file::FileUnits;
use opm_workspace::{
    ConditionLimit, ConditioningIndex, Count, Grid, GridSet, Modes, Progress, SetAxis, SetError,
    Sweep, Visits,
};
use std::sync::Arc;

/// A workspace as it is defined: of which manipulator and kind, over which grid, in which working modes,
/// and what is asked of it. A [`WorkspaceRequest`](crate::WorkspaceRequest) makes one.
#[derive(Clone, Debug)]
pub struct Workspace {
    pub(crate) manipulator: Arc<Manipulator>,
    pub(crate) kind: WorkspaceKind,
    pub(crate) grid: Grid,
    pub(crate) modes: Modes,
    pub(crate) limit: Option<ConditionLimit>,
    pub(crate) length: f64,
    pub(crate) conditioning: bool,
    pub(crate) shape: bool,
    pub(crate) unbounded: Option<Vec<String>>,
}

impl Workspace {
    /// The manipulator.
    pub fn manipulator(&self) -> &Arc<Manipulator> {
        &self.manipulator
    }

    /// What it consists of.
    pub fn kind(&self) -> WorkspaceKind {
        self.kind
    }

    /// The poses that are decided.
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

    /// The largest condition number at which a pose counts.
    pub fn limit(&self) -> Option<ConditionLimit> {
        self.limit
    }

    /// Characteristic length of condition numbers, metres.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Characteristic length of the conditioning index, where that is asked for.
    pub fn conditioning_length(&self) -> Option<f64> {
        self.conditioning.then_some(self.length)
    }

    /// Of a grid that was fitted, the coordinates along which the workspace goes on beyond it; `None` of a
    /// grid that was given.
    pub fn unbounded(&self) -> Option<&[String]> {
        self.unbounded.as_deref()
    }

    /// The same workspace, asked for its boundary and its connected components too.
    #[must_use]
    pub fn with_shape(self, shape: bool) -> Self {
        Self { shape, ..self }
    }

    /// Whether another workspace has the same kind, grid, working modes, and limit on condition numbers with
    /// their characteristic length: the same points, if it is one of the same mechanism.
    pub fn is_asked_like(&self, other: &Self) -> bool {
        let asked = |one: &Self| (one.kind, one.modes, one.limit, one.length);
        asked(self) == asked(other) && self.grid == other.grid
    }

    /// The sweep of its grid.
    pub fn sweep(&self) -> Sweep<'_> {
        let sweep = Sweep::new(&self.manipulator, &self.grid, self.modes);
        match self.limit {
            Some(limit) => sweep.with_limit(limit).expect("the request was checked"),
            None => sweep,
        }
    }

    /// Its poses, by sweeping.
    pub fn poses(&self) -> PoseSource<'_> {
        PoseSource::Sweep(self.sweep())
    }

    /// Whether its points have to be held in memory, or its poses gone through again: for its shape, or
    /// where its points are not poses of the grid.
    pub fn needs_points(&self) -> bool {
        self.wants_shape() || !self.kind.is_of_poses()
    }

    /// Whether the boundary and the components are asked for.
    pub(crate) fn wants_shape(&self) -> bool {
        self.shape || self.kind != WorkspaceKind::Grid
    }

    /// Sums up the conditioning of the poses of its sweep, or of a shard of that, if it is asked for.
    ///
    /// # Errors
    /// That it was cancelled.
    pub fn index(
        &self,
        sweep: &Sweep<'_>,
        progress: &Progress,
    ) -> Result<Option<ConditioningIndex>, StudyError> {
        let index = |length| ConditioningIndex::of(sweep, length, progress);
        Ok(self.conditioning_length().map(index).transpose()?)
    }

    /// In how many slices of the grid a sweep, or a shard of it, reaches each point of the kind; `None` of
    /// a kind whose points are points of the grid. Those of all shards add up.
    ///
    /// # Errors
    /// More points than fit in memory; that it was cancelled.
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
            | WorkspaceKind::Upper
            | WorkspaceKind::Lower => Ok(None),
        }
    }

    /// In how many slices a point has to be reached to belong to the set: see
    /// [`WorkspaceKind::required_visits`].
    pub fn required_visits(&self) -> Option<u64> {
        self.kind.required_visits(&self.grid)
    }

    /// The set of the points that `holds` says are in, by their numbers.
    ///
    /// # Errors
    /// A set that does not fit in memory.
    pub fn set(&self, holds: impl Fn(u64) -> bool) -> Result<GridSet, SetError> {
        let axis = |i: usize| SetAxis {
            axis: self.grid.axes()[i].clone(),
            circle: self.grid.is_circle(i),
        };
        GridSet::of(self.kind.axes(&self.grid).map(axis).collect(), holds)
    }

    /// The counted share of the box that the axes of a kind of set span, over those with more than one
    /// value. `None` of values of imaginary joints, which are not on a grid. The measures of shards add up.
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
