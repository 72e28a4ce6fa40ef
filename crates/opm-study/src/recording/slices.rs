//! The slices of a recording of poses.

use opm_mcap::{SliceAxis, Slices};
use opm_workspace::{Axis, Grid};

/// Largest number of slices. More would play for longer than a quarter of an hour.
const PLAYABLE: u64 = 10_000;

/// The first of the axes that are held within a slice; those behind it are held, too. A slice varies in two coordinates,
/// as a boundary does, and in every coordinate of the lower section. If there were too many slices for a person to play,
/// further axes are joined, the faster ones first.
fn first_held(grid: &Grid) -> usize {
    let axes = grid.axes();
    let mut varying = (0..axes.len()).filter(|&i| axes[i].count > 1);
    let third = varying.nth(2).unwrap_or(axes.len());
    let mut first = third.max(grid.lower());
    while first + 1 < axes.len() && points(&axes[first..]) > PLAYABLE {
        first += 1;
    }
    first
}

/// The number of combinations of values.
fn points(axes: &[Axis]) -> u64 {
    axes.iter().map(|axis| axis.count).product()
}

/// The number of the grid's slices that make up one slice of the recording.
pub fn slices_together(grid: &Grid) -> u64 {
    points(&grid.axes()[grid.lower()..first_held(grid)])
}

/// The slices of a recording of poses.
pub fn slices_of(grid: &Grid) -> Slices {
    let first = first_held(grid);
    let axes = grid.axes().iter().zip(grid.coordinates()).skip(first);
    let axes = axes.map(|(axis, coordinate)| slice_axis(axis, coordinate.quantity.unit()));
    Slices { axes: axes.collect(), point_area: point_area(&grid.axes()[..first]) }
}

/// An axis that is held within a slice.
pub fn slice_axis(axis: &Axis, unit: &'static str) -> SliceAxis {
    SliceAxis { name: axis.name.clone(), unit, ends: [axis.min, axis.max], count: axis.count }
}

/// The area that a point stands for, from the axes within a slice.
pub fn point_area<'a>(axes: impl IntoIterator<Item = &'a Axis>) -> f64 {
    let several = axes.into_iter().filter(|axis| axis.count > 1);
    several.map(|axis| (axis.max - axis.min) / axis.count as f64).product()
}
