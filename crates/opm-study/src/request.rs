//! Requests of a workspace: its options, before anything is computed.

mod fit;

use crate::columns::{PointChoice, PointOptions};
use crate::error::{RequestError, RequestOption, StudyError};
use crate::kind::WorkspaceKind;
use crate::setup::SetupOptions;
use crate::workspace::{Clearance, Workspace};
use opm_analysis::{Index, Setup};
use opm_core::group::SubspaceKind;
use opm_core::manipulator::Manipulator;
use opm_core::task::TaskCoordinate;
use opm_workspace::{
    Aspects, Axis, Cancelled, Grid, Modes, PoseLimit, Progress, Sections, default_grid,
};
use std::sync::Arc;

/// Range of characteristic lengths, metres. Neither the square of a length nor the square of a mechanism's
/// size over it may overflow.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-75..=1e75;

/// The options of a workspace. A request does not depend on the mechanism, so that one request can be used
/// for many mechanisms.
///
/// ```
/// use opm_study::{WorkspaceKind, WorkspaceRequest};
/// use opm_workspace::Axis;
///
/// let request = WorkspaceRequest::new(WorkspaceKind::Reachable)
///     .axis(Axis::new("x", -0.1, 0.1, 41))
///     .axis(Axis::new("y", -0.1, 0.1, 41))
///     .max_condition(20.0);
/// assert_eq!(request.axes.len(), 2);
/// ```
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct WorkspaceRequest {
    /// What the workspace consists of.
    pub kind: WorkspaceKind,
    /// The axes of the grid; a coordinate that is not given stays at home. With no axis at all, the grid
    /// is fitted to the workspace.
    pub axes: Vec<Axis>,
    /// The working modes that count; by default the mode of home.
    pub modes: Option<Modes>,
    /// The largest condition number at which a pose counts.
    pub max_condition: Option<f64>,
    /// The least distance of bodies at which a pose counts, metres.
    pub clearance: Option<f64>,
    /// The worst values of indices ([`Index`]) at which a pose counts, by their names.
    pub limits: Vec<(String, f64)>,
    /// What condition numbers and indices are computed with: characteristic length, load, springs.
    pub setup: SetupOptions,
    /// Whether the global conditioning index is requested.
    pub conditioning: bool,
    /// Whether the boundary and the connected components are requested. All kinds except
    /// [`WorkspaceKind::Grid`] compute them in any case.
    pub shape: bool,
    /// The values that a recording stores with every point.
    pub points: PointOptions,
}

impl WorkspaceRequest {
    /// A request for a kind of workspace, in the working mode of home, over a grid that is fitted to it.
    pub fn new(kind: WorkspaceKind) -> Self {
        Self { kind, ..Self::default() }
    }

    /// Adds an axis to the grid.
    #[must_use]
    pub fn axis(mut self, axis: Axis) -> Self {
        self.axes.push(axis);
        self
    }

    /// Selects other working modes than that of home.
    #[must_use]
    pub fn modes(mut self, modes: Modes) -> Self {
        self.modes = Some(modes);
        self
    }

    /// Limits the condition number of the poses that count.
    #[must_use]
    pub fn max_condition(mut self, most: f64) -> Self {
        self.max_condition = Some(most);
        self
    }

    /// Limits the distance of bodies at the poses that count, metres.
    #[must_use]
    pub fn clearance(mut self, least: f64) -> Self {
        self.clearance = Some(least);
        self
    }

    /// Limits an index of the poses that count: `lti` at 0.7.
    #[must_use]
    pub fn limit(mut self, index: impl Into<String>, bound: f64) -> Self {
        self.limits.push((index.into(), bound));
        self
    }

    /// Sets the characteristic length of condition numbers, metres.
    #[must_use]
    pub fn length(mut self, length: f64) -> Self {
        self.setup.length = Some(length);
        self
    }

    /// Sets what indices are computed with: characteristic length, load, springs.
    #[must_use]
    pub fn setup(mut self, setup: SetupOptions) -> Self {
        self.setup = setup;
        self
    }

    /// Requests the global conditioning index.
    #[must_use]
    pub fn conditioning(mut self) -> Self {
        self.conditioning = true;
        self
    }

    /// Requests the boundary and the connected components.
    #[must_use]
    pub fn shape(mut self) -> Self {
        self.shape = true;
        self
    }

    /// Sets the values that a recording stores with every point.
    #[must_use]
    pub fn points(mut self, points: PointOptions) -> Self {
        self.points = points;
        self
    }

    /// Checks the request for a manipulator, without fitting a grid.
    ///
    /// # Errors
    /// The problem, with the option that is wrong.
    pub fn check(
        self,
        manipulator: impl Into<Arc<Manipulator>>,
    ) -> Result<CheckedRequest, RequestError> {
        let (manipulator, kind) = (manipulator.into(), self.kind);
        if self.conditioning && !kind.is_of_poses() {
            return Err(RequestError::NotOfPoses { kind });
        }
        let setup = Arc::new(self.setup.check(&manipulator)?);
        // The distance of bodies is decided over boxes of poses, unlike other indices.
        let (clearances, limits): (Vec<_>, Vec<_>) =
            self.limits.into_iter().partition(|(name, _)| name == Index::Clearance.name());
        let mut clearances =
            self.clearance.into_iter().chain(clearances.iter().map(|limit| limit.1));
        let clearance = clearances.next();
        if clearances.next().is_some() {
            return Err(RequestError::RepeatedLimit { name: Index::Clearance.name().to_owned() });
        }
        let limit = pose_limit(self.max_condition, &limits, &setup, &manipulator)?;
        let modes = self.modes.unwrap_or(Modes::One(manipulator.home_mode()));
        check_kind(kind, &manipulator, modes, limit.as_ref())?;
        let clearance = match clearance {
            Some(least) => {
                check_clearance(least, kind, modes)?;
                Some(Clearance::new(&manipulator, least))
            }
            None => None,
        };
        let grid = match self.axes.is_empty() {
            true => None,
            false => Some(grid(kind, &manipulator, self.axes)?),
        };
        let points = self.points.choose(kind, &manipulator, &setup)?;
        Ok(CheckedRequest {
            manipulator,
            kind,
            grid,
            modes,
            limit,
            clearance,
            setup,
            length_given: self.setup.length.is_some(),
            conditioning: self.conditioning,
            shape: self.shape,
            points,
        })
    }

    /// Checks the request, and fits a grid if none is given.
    ///
    /// # Errors
    /// The request is wrong, or the work was cancelled.
    pub fn resolve(
        self,
        manipulator: impl Into<Arc<Manipulator>>,
        progress: &Progress,
    ) -> Result<Workspace, StudyError> {
        Ok(self.check(manipulator)?.fit(progress)?)
    }
}

/// A request that is checked for its manipulator. If it has no grid, one is still to be fitted.
#[derive(Clone, Debug)]
pub struct CheckedRequest {
    manipulator: Arc<Manipulator>,
    kind: WorkspaceKind,
    grid: Option<Grid>,
    modes: Modes,
    limit: Option<PoseLimit>,
    clearance: Option<Clearance>,
    setup: Arc<Setup>,
    length_given: bool,
    conditioning: bool,
    shape: bool,
    points: PointChoice,
}

impl CheckedRequest {
    /// What the workspace consists of.
    pub fn kind(&self) -> WorkspaceKind {
        self.kind
    }

    /// The grid that was given; `None` if one will be fitted.
    pub fn grid(&self) -> Option<&Grid> {
        self.grid.as_ref()
    }

    /// The working modes that count.
    pub fn modes(&self) -> Modes {
        self.modes
    }

    /// The values that a recording stores with every point.
    pub fn points(&self) -> &PointChoice {
        &self.points
    }

    /// Refuses a characteristic length if the request has no condition number or index that uses it.
    ///
    /// # Errors
    /// [`RequestError::UnusedLength`]
    pub fn refuse_unused_length(&self) -> Result<(), RequestError> {
        let used = self.points.has_length() || self.conditioning || self.limit.is_some();
        if self.length_given && !used { Err(RequestError::UnusedLength) } else { Ok(()) }
    }

    /// Refuses a load or springs if the request has no number that uses them.
    ///
    /// # Errors
    /// [`RequestError::UnusedLoad`], [`RequestError::UnusedSprings`]
    pub fn refuse_unused_setup(&self) -> Result<(), RequestError> {
        let limits = || self.limit.iter().flat_map(|limit| limit.indices.iter());
        let uses = |test: fn(Index) -> bool| {
            limits().any(|(index, _)| test(index)) || self.points.has_index(test)
        };
        let load = self.points.has_efforts() || uses(Index::depends_on_load);
        if self.setup.load.is_some() && !load {
            return Err(RequestError::UnusedLoad { option: RequestOption::Wrench });
        }
        if self.setup.gravity.is_some() && !load && !uses(Index::depends_on_masses) {
            return Err(RequestError::UnusedLoad { option: RequestOption::Gravity });
        }
        if self.setup.springs.is_some() && !uses(Index::depends_on_springs) {
            return Err(RequestError::UnusedSprings);
        }
        Ok(())
    }

    /// Fits a grid to the workspace if none was given. The extent of the workspace of all poses is searched
    /// for.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn fit(self, progress: &Progress) -> Result<Workspace, Cancelled> {
        let Self { manipulator, kind, modes, limit, clearance, setup, conditioning, shape, .. } =
            self;
        let (grid, unbounded) = match self.grid {
            Some(grid) => (grid, None),
            None => {
                let (grid, extents) = default_grid(&manipulator, modes, progress)?;
                let grid = fit::fit(kind, &manipulator, grid);
                let varies = |name: &str| {
                    grid.axes().iter().any(|axis| axis.name == *name && axis.count > 1)
                };
                let endless = extents.iter().filter(|extent| extent.unbounded);
                let endless = endless.map(|extent| extent.name.to_string());
                let endless = endless.filter(|name| varies(name)).collect();
                (grid, Some(endless))
            }
        };
        Ok(Workspace {
            manipulator,
            kind,
            grid,
            modes,
            limit,
            clearance,
            setup,
            conditioning,
            shape,
            unbounded,
        })
    }
}

/// The characteristic length of condition numbers, metres: the given one, or the spread of the joint axes.
///
/// # Errors
/// [`RequestError::Length`]
pub fn characteristic_length(
    given: Option<f64>,
    manipulator: &Manipulator,
) -> Result<f64, RequestError> {
    let length = given.unwrap_or_else(|| manipulator.characteristic_length());
    if LENGTHS.contains(&length) { Ok(length) } else { Err(RequestError::Length(length)) }
}

/// The limit that a largest condition number and worst values of indices make together; `None` without any.
fn pose_limit(
    most: Option<f64>,
    limits: &[(String, f64)],
    setup: &Arc<Setup>,
    manipulator: &Manipulator,
) -> Result<Option<PoseLimit>, RequestError> {
    let mut limit = PoseLimit::of(Arc::clone(setup));
    match most {
        None => {}
        Some(most) if most >= 1.0 && most.is_finite() => limit.most = most,
        Some(most) => return Err(RequestError::MaxCondition(most)),
    }
    for (name, bound) in limits {
        let name = || name.clone();
        let index = Index::from_name(&name()).ok_or_else(|| {
            let known = Index::ALL.map(|index| index.name().to_owned()).into();
            RequestError::UnknownIndex { name: name(), known }
        })?;
        if limit.indices.iter().any(|(known, _)| known == index) {
            return Err(RequestError::RepeatedLimit { name: name() });
        }
        if !bound.is_finite() {
            return Err(RequestError::LimitNotFinite { name: name(), bound: *bound });
        }
        index.check(manipulator, setup)?;
        limit = limit.with_index(index, *bound);
    }
    Ok((!limit.is_none()).then_some(limit))
}

/// Refuses a clearance where it has no meaning.
fn check_clearance(least: f64, kind: WorkspaceKind, modes: Modes) -> Result<(), RequestError> {
    if !(least >= 0.0 && least.is_finite()) {
        return Err(RequestError::Clearance(least));
    }
    if kind.sections() != Sections::Whole {
        return Err(RequestError::SectionClearance { kind });
    }
    match modes {
        Modes::One(_) => Ok(()),
        Modes::Any => Err(RequestError::ClearanceModes),
    }
}

/// Refuses options that have no meaning for a kind of workspace.
fn check_kind(
    kind: WorkspaceKind,
    manipulator: &Manipulator,
    modes: Modes,
    limit: Option<&PoseLimit>,
) -> Result<(), RequestError> {
    let names = |list: &[TaskCoordinate]| list.iter().map(|c| c.name.to_owned()).collect();
    let dependent: Vec<String> = names(manipulator.dependent_coordinates());
    let one_subspace = manipulator.task().upper.kind == SubspaceKind::Identity;
    match kind {
        WorkspaceKind::Imaginary | WorkspaceKind::Upper if one_subspace => {
            return Err(RequestError::OneSubspace { kind });
        }
        WorkspaceKind::Imaginary | WorkspaceKind::Upper | WorkspaceKind::Lower
            if !dependent.is_empty() =>
        {
            return Err(RequestError::Dependent { kind, dependent });
        }
        WorkspaceKind::Upper | WorkspaceKind::Lower if manipulator.task().shares_height() => {
            return Err(RequestError::Inclined { kind });
        }
        _ => {}
    }
    if let Some(part) = kind.missing_part(manipulator) {
        let coordinates = names(manipulator.task_coordinates());
        return Err(RequestError::NoPart { kind, part, coordinates, dependent });
    }
    if kind.sections() != Sections::Whole
        && let Some(limit) = limit
    {
        return Err(match limit.indices.iter().next() {
            Some((index, _)) => RequestError::SectionIndex { kind, name: index.name() },
            None => RequestError::SectionCondition { kind },
        });
    }
    if matches!(kind, WorkspaceKind::Imaginary | WorkspaceKind::Aspects) && modes == Modes::Any {
        return Err(RequestError::SeveralModes { kind });
    }
    if kind == WorkspaceKind::Aspects && !Aspects::exist(manipulator) {
        return Err(RequestError::Loose { kind });
    }
    if kind == WorkspaceKind::Imaginary && manipulator.imaginary().is_empty() {
        return Err(RequestError::NoImaginaryJoints { kind });
    }
    Ok(())
}

/// The grid with these axes, checked for workspaces of this kind.
fn grid(
    kind: WorkspaceKind,
    manipulator: &Manipulator,
    axes: Vec<Axis>,
) -> Result<Grid, RequestError> {
    let grid = Grid::of(kind.sections(), manipulator, axes)?;
    let held = &grid.axes()[kind.held_axes(&grid)];
    match held.iter().find(|axis| axis.count > 1) {
        None => Ok(grid),
        Some(Axis { name, count, .. }) => {
            Err(RequestError::Held { kind, axis: name.clone(), count: *count })
        }
    }
}

#[cfg(test)]
mod tests;
