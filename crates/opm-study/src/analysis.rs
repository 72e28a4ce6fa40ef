//! What is found of a workspace: counts, the set of its points, its shape, its conditioning.

use crate::error::StudyError;
use crate::kind::WorkspaceKind;
use crate::poses::PoseSource;
use crate::workspace::Workspace;
use opm_workspace::{
    Components, ConditioningIndex, Count, GridSet, Outline, Progress, Visits, boundary,
};

/// What is known of a workspace. All of it follows from the poses in reach.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Analysis {
    /// What the workspace consists of.
    pub kind: WorkspaceKind,
    /// How many points it has, out of how many. Of a set of places or orientations, these are counted.
    pub count: Count,
    /// The points, where they are held in memory.
    pub set: Option<GridSet>,
    /// Of places, in how many orientations each is reached.
    pub visits: Option<Visits>,
    /// The conditioning of the poses, where it is asked for.
    pub conditioning: Option<ConditioningIndex>,
    /// Components and boundary, where they are asked for.
    pub shape: Option<Shape>,
}

/// The connected components of a set, and its boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Points of each component, the largest first.
    pub components: Vec<u64>,
    /// Closed lines around the set, slice by slice; `None` where the set does not vary in two coordinates,
    /// or in three, or where a boundary says nothing.
    pub boundary: Option<Vec<Outline>>,
}

impl Workspace {
    /// Counts the poses, and finds all that is asked of the workspace.
    ///
    /// # Errors
    /// A set that does not fit in memory; that it was cancelled.
    pub fn analyse(&self, progress: &Progress) -> Result<Analysis, StudyError> {
        let count = self.sweep().count(progress)?;
        let conditioning = self.index(&self.sweep(), progress)?;
        let mut analysis = Analysis::of_points(self, count, &self.poses(), progress)?;
        analysis.conditioning = conditioning;
        Ok(analysis)
    }
}

impl Analysis {
    /// An analysis that has counted, and no more.
    pub fn of_count(kind: WorkspaceKind, count: Count) -> Self {
        Self { kind, count, set: None, visits: None, conditioning: None, shape: None }
    }

    /// What follows from the points of a workspace whose poses are counted. The poses are gone through once
    /// more if [`Workspace::needs_points`]; then the count is that of the points.
    ///
    /// # Errors
    /// A set that does not fit in memory, or poses that cannot be had; that it was cancelled.
    pub fn of_points(
        workspace: &Workspace,
        count: Count,
        poses: &PoseSource<'_>,
        progress: &Progress,
    ) -> Result<Self, StudyError> {
        let kind = workspace.kind();
        let mut analysis = Self::of_count(kind, count);
        if !workspace.needs_points() {
            return Ok(analysis);
        }
        let set = match workspace.required_visits() {
            None => GridSet::reached(poses, progress)?,
            Some(_) if !kind.is_of_places() => GridSet::slices(poses, progress)?,
            Some(required) => {
                let visits = analysis.visits.insert(Visits::new(poses, progress)?);
                let counts = visits.counts();
                GridSet::of(visits.axes().to_vec(), |place| counts[place as usize] >= required)?
            }
        };
        analysis.shape = workspace.wants_shape().then(|| Shape {
            components: Components::new(&set).sizes().to_vec(),
            boundary: if kind.has_boundary() { boundary(&set) } else { None },
        });
        (analysis.count.poses, analysis.count.reachable) = (set.points(), set.count());
        analysis.set = Some(set);
        Ok(analysis)
    }

    /// The boundary, slice by slice, where it is known.
    pub fn boundary(&self) -> Option<&[Outline]> {
        self.shape.as_ref()?.boundary.as_deref()
    }

    /// The points in reach as a share of those that could be; `None` if there are none.
    pub fn fraction(&self) -> Option<f64> {
        let Count { poses, reachable, .. } = self.count;
        (poses > 0).then(|| reachable as f64 / poses as f64)
    }
}
