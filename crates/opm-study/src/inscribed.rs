//! The largest disc, ball or box in the set of a workspace's points.

use crate::error::{RequestError, StudyError};
use crate::kind::WorkspaceKind;
use crate::workspace::Workspace;
use opm_core::Quantity;
use opm_workspace::{GridSet, Inscribed, InscribedShape, inscribed};

impl Workspace {
    /// The largest disc, ball or box in the set of the workspace's points, [`Analysis::set`](crate::Analysis::set), with its centre free, or
    /// given in each of the coordinates in which the set varies ([`Workspace::varying`]), radians and metres. `None` if
    /// the set is empty, or the centre is not inside it.
    ///
    /// # Errors
    /// The points are not on a grid, or the set does not suit the shape: a disc or a ball needs coordinates
    /// of one unit.
    pub fn inscribed(
        &self,
        set: &GridSet,
        shape: InscribedShape,
        centre: Option<&[f64]>,
    ) -> Result<Option<Inscribed>, StudyError> {
        if self.kind == WorkspaceKind::Imaginary {
            return Err(RequestError::NoSet { kind: self.kind }.into());
        }
        let found = inscribed(set, shape, centre).map_err(RequestError::Inscribed)?;
        let varying = self.varying();
        let round = shape != InscribedShape::Box;
        if round && varying.windows(2).any(|pair| pair[0].1 != pair[1].1) {
            let coordinates = varying.into_iter().map(|(name, _)| name).collect();
            return Err(RequestError::Round { shape, coordinates }.into());
        }
        Ok(found)
    }

    /// The names of the coordinates in which the set of points may vary, and what they measure.
    pub fn varying(&self) -> Vec<(String, Quantity)> {
        let axes = self.kind.axes(&self.grid);
        let axes = axes.filter(|&i| self.grid.axes()[i].count > 1);
        axes.map(|i| (self.grid.axes()[i].name.clone(), self.grid.coordinates()[i].quantity))
            .collect()
    }
}
