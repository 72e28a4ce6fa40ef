//! Resolutions of fitted grids, for each kind of workspace.

use crate::kind::WorkspaceKind;
use opm_core::manipulator::Manipulator;
use opm_workspace::{Axis, Grid, Sections};

/// Numbers of values along each axis of the lower and of the upper section. A single value is that of home.
type Resolution = [f64; 2];

/// The resolution for these numbers of coordinates of the lower and of the upper section. `None` if it is
/// that of the grid of poses.
fn resolution(kind: WorkspaceKind, [lower, upper]: [usize; 2]) -> Option<Resolution> {
    // Fine enough for a picture, and coarse enough to take about a second.
    let share = |points: f64, axes: usize| points.powf(1.0 / axes.max(1) as f64);
    match kind {
        WorkspaceKind::Grid | WorkspaceKind::Reachable | WorkspaceKind::Dexterous => None,
        WorkspaceKind::ConstantOrientation | WorkspaceKind::Lower => {
            Some([share(2.5e5, lower).min(501.0), 1.0])
        }
        WorkspaceKind::Orientation | WorkspaceKind::Upper => {
            Some([1.0, share(2.5e5, upper).min(501.0)])
        }
        WorkspaceKind::Imaginary => Some([share(200.0, lower), share(7e4, upper).min(1001.0)]),
    }
}

/// The grid for a kind of workspace, made from the grid that is fitted to its poses.
pub fn fit(kind: WorkspaceKind, manipulator: &Manipulator, poses: Grid) -> Grid {
    let lower = manipulator.lower_coordinates();
    let upper = poses.axes().len() - lower;
    let Some(resolution) = resolution(kind, [lower, upper]) else { return poses };
    let axes = poses.axes().iter().zip(poses.coordinates()).enumerate();
    let axes = axes.filter_map(|(i, (axis, coordinate))| {
        let values = resolution[usize::from(i >= lower)];
        let has_axis = match kind.sections() {
            Sections::Whole => true,
            Sections::Upper => i >= lower,
            Sections::Lower => i < lower,
        };
        has_axis.then(|| match axis.count {
            1 => axis.clone(),
            _ if values <= 1.0 => Axis::fixed(&*axis.name, coordinate.home),
            _ => {
                // An odd number, so that the middle of the range is a value.
                let count = 2 * (0.5 * (values - 1.0)).round().max(1.0) as u64 + 1;
                Axis::new(&*axis.name, axis.min, axis.max, count)
            }
        })
    });
    Grid::of(kind.sections(), manipulator, axes.collect())
        .expect("the axes are those of a grid, with fewer values")
}
