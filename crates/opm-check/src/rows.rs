//! Counts of sweeps compared with inverse kinematics of every pose.

use crate::by_inverse::by_inverse;
use crate::certificate::{Comparison, Options};
use crate::poses::pose;
use opm_core::manipulator::Manipulator;
use opm_workspace::{Axis, Grid, Modes, Progress, Sweep};

/// Poses of each row, which is along one coordinate.
const ROW: u64 = 61;

/// Rows of a plane of two coordinates.
const ROWS: u64 = 5;

/// Counts of small grids: each in the home mode, and in any mode.
pub fn rows(
    manipulator: &Manipulator,
    options: &Options,
    go_on: &mut impl FnMut() -> bool,
) -> Option<Comparison> {
    let what = "poses of random grids that sweeps count, with inverse kinematics of every pose";
    let mut found = Comparison::new("rows", what, None);
    let mut rng = options.rng(3);
    let coordinates = manipulator.task_coordinates();
    for sample in 0..options.samples {
        if !go_on() {
            return None;
        }
        let [one, other] = [pose(&mut rng, manipulator), pose(&mut rng, manipulator)];
        let along = rng.usize(..coordinates.len());
        let across = rng.usize(..coordinates.len());
        let axes = coordinates.iter().enumerate().map(|(number, c)| {
            let (low, high) = (one[number].min(other[number]), one[number].max(other[number]));
            match number {
                _ if low >= high => Axis::fixed(c.name, low),
                number if number == along => Axis::new(c.name, low, high, ROW),
                number if number == across => Axis::new(c.name, low, high, ROWS),
                _ => Axis::fixed(c.name, low),
            }
        });
        let grid = match Grid::new(manipulator, axes.collect()) {
            Ok(grid) => grid,
            Err(error) => {
                found.fail(|| error.to_string());
                continue;
            }
        };
        let modes = if sample % 2 == 0 { Modes::One(manipulator.home_mode()) } else { Modes::Any };
        let Ok(count) = Sweep::new(manipulator, &grid, modes).count(&Progress::default()) else {
            return None;
        };
        let (reached, _) = by_inverse(manipulator, &grid, modes);
        found.compared += grid.poses();
        if count.reachable != reached.len() as u64 {
            found.fail(|| {
                let axes = grid.axes().iter().map(|axis| {
                    let (first, last) = (axis.value(0), axis.value(axis.count - 1));
                    format!("{}={first:?}:{last:?}:{}", axis.name, axis.count)
                });
                format!(
                    "{} of {} poses by rows, {} by inverse kinematics: {modes:?}, {}",
                    count.reachable,
                    grid.poses(),
                    reached.len(),
                    axes.collect::<Vec<_>>().join(" ")
                )
            });
        }
    }
    Some(found)
}
