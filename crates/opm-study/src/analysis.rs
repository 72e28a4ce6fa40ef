//! The results for a workspace: counts, the set of its points, its shape, its conditioning.

use crate::error::StudyError;
use crate::kind::WorkspaceKind;
use crate::poses::PoseSource;
use crate::workspace::Workspace;
use opm_workspace::{
    Aspects, Components, ConditioningIndex, Count, GridSet, Outline, Progress, SingularCurves,
    Visits, boundary, singular_curves,
};

/// The results for a workspace. All of them follow from the poses in reach.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Analysis {
    /// What the workspace consists of.
    pub kind: WorkspaceKind,
    /// The number of points, and the number that was tested. A set of places or orientations counts these.
    pub count: Count,
    /// The points, if they are held in memory.
    pub set: Option<GridSet>,
    /// The number of orientations in which each place is reached, for a set of places.
    pub visits: Option<Visits>,
    /// The conditioning of the poses, if it was requested.
    pub conditioning: Option<ConditioningIndex>,
    /// The aspects, for the kind of that name.
    pub aspects: Option<Aspects>,
    /// The curves of parallel singularities among the poses, slice by slice, for the same kind. `None` if the poses vary in
    /// neither two nor three coordinates.
    pub singularities: Option<Vec<SingularCurves>>,
    /// Components and boundary, if they were requested. Of aspects these are the aspects themselves.
    pub shape: Option<Shape>,
}

/// The connected components of a set, and its boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The number of points of each component, the largest first.
    pub components: Vec<u64>,
    /// Closed lines around the set, slice by slice. `None` if the set varies in neither two nor three
    /// coordinates, or if a boundary has no meaning for its kind.
    pub boundary: Option<Vec<Outline>>,
}

impl Workspace {
    /// Counts the poses, and computes every requested result.
    ///
    /// # Errors
    /// The set does not fit in memory, or the work was cancelled.
    pub fn analyse(&self, progress: &Progress) -> Result<Analysis, StudyError> {
        let count = self.sweep().count(progress)?;
        let conditioning = self.index(&self.sweep(), progress)?;
        let mut analysis = Analysis::of_points(self, count, &self.poses(), progress)?;
        analysis.conditioning = conditioning;
        Ok(analysis)
    }
}

impl Analysis {
    /// An analysis with a count and nothing else.
    pub fn of_count(kind: WorkspaceKind, count: Count) -> Self {
        Self {
            kind,
            count,
            set: None,
            visits: None,
            conditioning: None,
            aspects: None,
            singularities: None,
            shape: None,
        }
    }

    /// The results that follow from the points of a workspace whose poses are counted. The poses are visited
    /// once more if [`Workspace::needs_points`]; the count is then that of the points.
    ///
    /// # Errors
    /// The set does not fit in memory, the poses cannot be read, or the work was cancelled.
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
        if let (WorkspaceKind::Aspects, Some(mode)) = (kind, workspace.modes().one()) {
            let aspects = Aspects::new(workspace.manipulator(), mode, &set, progress)?;
            analysis.shape = Some(Shape {
                components: aspects.list().iter().map(|aspect| aspect.poses).collect(),
                boundary: aspects.boundary()?,
            });
            analysis.aspects = Some(aspects);
            analysis.singularities =
                singular_curves(workspace.manipulator(), mode, &set, progress)?;
            (analysis.count.poses, analysis.count.reachable) = (set.points(), set.count());
            analysis.set = Some(set);
            return Ok(analysis);
        }
        analysis.shape = workspace.wants_shape().then(|| Shape {
            components: Components::new(&set).sizes().to_vec(),
            boundary: if kind.has_boundary() { boundary(&set) } else { None },
        });
        (analysis.count.poses, analysis.count.reachable) = (set.points(), set.count());
        analysis.set = Some(set);
        Ok(analysis)
    }

    /// The boundary, slice by slice, if it is known.
    pub fn boundary(&self) -> Option<&[Outline]> {
        self.shape.as_ref()?.boundary.as_deref()
    }

    /// The points in reach as a share of all points that were tested; `None` if there are none.
    pub fn fraction(&self) -> Option<f64> {
        let Count { poses, reachable, .. } = self.count;
        (poses > 0).then(|| reachable as f64 / poses as f64)
    }
}
