//! The ranges that are measured over if they are not given.

use super::CoordinateRange;
use crate::extent::{default_grid, one_turn};
use crate::grid::Sections;
use crate::progress::{Cancelled, Progress};
use crate::sweep::Modes;
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;

/// Completes the ranges that are given, which may be none. Returns the ranges to measure over, and the names of
/// the coordinates along which the workspace continues beyond them.
///
/// * In a measure of the upper section alone, an angle without a range gets a full revolution, so that Euler
///   angles take every orientation once.
/// * If no range is given, the other task coordinates get ranges that are fitted to the workspace:
///   [`default_grid`].
/// * All other coordinates stay at home.
///
/// # Errors
/// [`Cancelled`] if [`Progress::cancel`] was called.
pub fn default_ranges(
    manipulator: &Manipulator,
    sections: Sections,
    modes: Modes,
    given: &[CoordinateRange],
    progress: &Progress,
) -> Result<(Vec<CoordinateRange>, Vec<&'static str>), Cancelled> {
    let mut over = given.to_vec();
    let coordinates = sections.coordinates(manipulator);
    if sections == Sections::Upper {
        for c in &coordinates {
            let periodic = c.quantity == Quantity::Angle && !c.counts_turns;
            if let Some(kind) = c.kind
                && periodic
                && given.iter().all(|over| over.name != c.name)
            {
                let [min, max] = one_turn(kind, c.home);
                over.push(CoordinateRange::new(&*c.name, min, max));
            }
        }
    }
    // Imaginary joints are not task coordinates: they stay at home.
    let task = manipulator.task_coordinates().iter().filter(|task| {
        coordinates.iter().any(|c| c.name == task.name)
            && over.iter().all(|over| over.name != task.name)
    });
    let missing: Vec<&str> = task.map(|task| task.name).collect();
    if !given.is_empty() || missing.is_empty() {
        return Ok((over, vec![]));
    }
    let (grid, extents) = default_grid(manipulator, modes, progress)?;
    let fitted = grid.axes().iter().filter(|axis| missing.contains(&&*axis.name));
    over.extend(fitted.map(|axis| CoordinateRange::new(&*axis.name, axis.min, axis.max)));
    let beyond = extents.iter().filter(|extent| extent.unbounded).map(|extent| extent.name);
    Ok((over, beyond.filter(|name| missing.contains(name)).collect()))
}
