//! Singularity curves in the slices of a recording of aspects. They are computed anew: the recording has the mechanism.

use super::source::Source;
use crate::failure::Failure;
use opm_core::manipulator::{Manipulator, Mode};
use opm_study::StudyError;
use opm_workspace::{Axis, Grid, GridSet, Modes, Progress, Sweep, singular_curves};

/// What the curves follow from.
pub struct Singular<'a> {
    manipulator: &'a Manipulator,
    mode: Mode,
    progress: &'a Progress,
}

impl<'a> Singular<'a> {
    /// The mechanism and the working mode of a recording, if it has them.
    pub fn of(source: &'a Source<'_>) -> Option<Self> {
        let manipulator = source.manipulator()?;
        let mode = manipulator.parse_mode(source.metadata("run").get("mode")?).ok()?;
        Some(Self { manipulator, mode, progress: source.progress() })
    }

    /// The curves in the plane of two coordinates, with others held at these values. There are none if the coordinates are
    /// not all those of a pose.
    pub fn curves(
        &self,
        view: [&Axis; 2],
        held: &[(&str, f64)],
    ) -> Result<Vec<Vec<[f64; 2]>>, Failure> {
        let fixed = held.iter().map(|&(name, value)| Axis::fixed(name, value));
        let axes = view.into_iter().cloned().chain(fixed).collect();
        let Ok(grid) = Grid::new(self.manipulator, axes) else { return Ok(vec![]) };
        let sweep = Sweep::new(self.manipulator, &grid, Modes::One(self.mode));
        let set = GridSet::reached(&sweep, self.progress).map_err(StudyError::from)?;
        let found = singular_curves(self.manipulator, self.mode, &set, self.progress);
        let found = found.map_err(StudyError::from)?.unwrap_or_default();
        // The grid's axes are in the order of the pose, and the picture's may be the other way round.
        let number = |name: &str| grid.axes().iter().position(|axis| axis.name == name);
        let turned = number(&view[0].name) > number(&view[1].name);
        let point = |&[x, y]: &[f64; 2]| if turned { [y, x] } else { [x, y] };
        let lines = found.iter().flat_map(|curves| &curves.lines);
        Ok(lines.map(|line| line.iter().map(point).collect()).collect())
    }
}
