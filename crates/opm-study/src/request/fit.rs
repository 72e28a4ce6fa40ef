//! Resolutions of fitted grids, for each kind of workspace.

use crate::kind::WorkspaceKind;
use opm_core::manipulator::Manipulator;
use opm_workspace::{Axis, Grid, Sections};

/// Numbers of values along each axis of the place and of the orientation. A single value is that of home.
type Resolution = [f64; 2];

/// The resolution for these numbers of coordinates of the place and of the orientation. `None` if it is that of
/// the grid of poses.
fn resolution(kind: WorkspaceKind, [place, orientation]: [usize; 2]) -> Option<Resolution> {
    // Fine enough for a picture, and coarse enough to take about a second.
    let share = |points: f64, axes: usize| points.powf(1.0 / axes.max(1) as f64);
    match kind {
        WorkspaceKind::Grid | WorkspaceKind::Reachable | WorkspaceKind::Dexterous => None,
        WorkspaceKind::ConstantOrientation | WorkspaceKind::Lower => {
            Some([share(2.5e5, place).min(501.0), 1.0])
        }
        WorkspaceKind::Orientation | WorkspaceKind::Upper => {
            Some([1.0, share(2.5e5, orientation).min(501.0)])
        }
        // Poses are measured one by one, which takes longer than to clip rows.
        WorkspaceKind::Aspects => Some([share(1e5, place + orientation).min(501.0); 2]),
        WorkspaceKind::Imaginary => {
            Some([share(200.0, place), share(7e4, orientation).min(1001.0)])
        }
    }
}

/// The grid for a kind of workspace, made from the grid that is fitted to its poses.
pub fn fit(kind: WorkspaceKind, manipulator: &Manipulator, poses: Grid) -> Grid {
    let (all, lower) = (poses.axes().len(), manipulator.lower_coordinates());
    let (axes, places) = match kind.sections() {
        Sections::Whole => (0..all, poses.places()),
        Sections::Upper => (lower..all, 0..lower),
        Sections::Lower => (0..lower, 0..lower),
    };
    let Some(resolution) = resolution(kind, [places.len(), all - places.len()]) else {
        return poses;
    };
    let listed = axes.map(|i| {
        let (axis, coordinate) = (&poses.axes()[i], &poses.coordinates()[i]);
        let values = resolution[usize::from(!places.contains(&i))];
        match axis.count {
            1 => axis.clone(),
            _ if values <= 1.0 => Axis::fixed(&*axis.name, coordinate.home),
            _ => {
                // An odd number, so that the middle of the range is a value.
                let count = 2 * (0.5 * (values - 1.0)).round().max(1.0) as u64 + 1;
                Axis::new(&*axis.name, axis.min, axis.max, count)
            }
        }
    });
    Grid::of(kind.sections(), manipulator, listed.collect())
        .expect("the axes are those of a grid, with fewer values")
}
