//! A grid that suits a mechanism: how far its workspace reaches along every task coordinate.
//!
//! Found by sweeping: a coarse grid about home grows until no reachable pose lies on its faces, then
//! shrinks onto those that there are. One way for every mechanism, limits of all kinds included.

use crate::grid::{Axis, Grid};
use crate::progress::{Cancelled, Progress};
use crate::sweep::{Modes, Sweep};
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use std::f64::consts::PI;

/// Poses of a coarse grid: a few milliseconds each.
const COARSE_POSES: f64 = 1e6;

/// Poses of the default grid: a picture worth looking at, in about a second.
const DEFAULT_POSES: f64 = 4e6;

/// The default grid has this many times more values along a lower coordinate than along an upper
/// one: slices that are fine, at orientations that are few.
const FINER: f64 = 6.0;

/// How many times a coarse grid may double before a coordinate counts as unbounded.
const DOUBLINGS: usize = 8;

/// A coarse grid that shrinks by less than this has settled.
const SETTLED: f64 = 0.9;

/// How far a workspace reaches along one task coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// The task coordinate's name.
    pub name: &'static str,
    /// Lowest value, radians or metres.
    pub min: f64,
    /// Highest value, radians or metres.
    pub max: f64,
    /// The workspace goes on beyond.
    pub unbounded: bool,
}

/// A grid over the whole workspace, and how far that reaches. Angles that know no whole turns are
/// kept to one turn.
///
/// # Errors
/// When told to stop.
pub fn default_grid(
    manipulator: &Manipulator,
    modes: Modes,
    progress: &Progress,
) -> Result<(Grid, Vec<Extent>), Cancelled> {
    let extents = extents(manipulator, modes, progress)?;
    let lower = manipulator.task().lower_count;
    let (n, uppers) = (extents.len() as f64, (extents.len() - lower) as f64);
    // lower^n / FINER^uppers = DEFAULT_POSES
    let fine = (DEFAULT_POSES * FINER.powf(uppers)).powf(1.0 / n);
    let axes = extents.iter().enumerate().map(|(number, extent)| {
        let count = if number < lower { fine } else { fine / FINER };
        let (min, max) =
            (round(extent.min, extent, f64::floor), round(extent.max, extent, f64::ceil));
        axis(extent.name, min, max, odd(count))
    });
    let grid = Grid::new(manipulator, axes.collect());
    Ok((grid.expect("extents are finite and counts small"), extents))
}

/// How far the workspace reaches along every task coordinate.
fn extents(
    manipulator: &Manipulator,
    modes: Modes,
    progress: &Progress,
) -> Result<Vec<Extent>, Cancelled> {
    let coordinates = manipulator.task_coordinates();
    let count = odd(COARSE_POSES.powf(1.0 / coordinates.len() as f64));
    let size = size(manipulator);
    let mut box_: Vec<Extent> = coordinates
        .iter()
        .map(|c| {
            let (min, max) = match (c.quantity, c.name) {
                (Quantity::Length, _) => (c.home - size, c.home + size),
                // Euler angles of every orientation, each but once.
                (Quantity::Angle, "xi") => (0.0, PI),
                (Quantity::Angle, "zeta" | "psi") => (-PI, PI),
                (Quantity::Angle, _) => (c.home - PI, c.home + PI),
            };
            Extent { name: c.name, min, max, unbounded: false }
        })
        .collect();
    let grows: Vec<bool> = coordinates
        .iter()
        .map(|c| c.quantity == Quantity::Length || manipulator.task().counts_turns(c.name))
        .collect();

    for _ in 0..DOUBLINGS {
        let grid = coarse(manipulator, &box_, count);
        let Some(hit) = hits(manipulator, &grid, modes, progress)? else { break };
        let mut grown = false;
        for ((extent, &grows), &[low, high]) in box_.iter_mut().zip(&grows).zip(&hit) {
            let width = extent.max - extent.min;
            extent.unbounded = grows && (low == 0 || high + 1 == count);
            if grows && low == 0 {
                extent.min -= width / 2.0;
                grown = true;
            }
            if grows && high + 1 == count {
                extent.max += width / 2.0;
                grown = true;
            }
        }
        if !grown {
            break;
        }
    }
    loop {
        let grid = coarse(manipulator, &box_, count);
        let Some(hit) = hits(manipulator, &grid, modes, progress)? else { return Ok(box_) };
        let mut settled = true;
        for ((extent, axis), &[low, high]) in box_.iter_mut().zip(grid.axes()).zip(&hit) {
            let (min, max) =
                (axis.value(low.saturating_sub(1)), axis.value((high + 1).min(count - 1)));
            settled &= max - min > SETTLED * (extent.max - extent.min);
            (extent.min, extent.max) = (min, max);
        }
        if settled {
            return Ok(box_);
        }
    }
}

fn coarse(manipulator: &Manipulator, box_: &[Extent], count: u64) -> Grid {
    let axes = box_.iter().map(|e| axis(e.name, e.min, e.max, count)).collect();
    Grid::new(manipulator, axes).expect("extents are finite and the count is small")
}

fn axis(name: &str, min: f64, max: f64, count: u64) -> Axis {
    if min < max { Axis::new(name, min, max, count) } else { Axis::fixed(name, min) }
}

/// Lowest and highest number of the reachable poses along every axis.
fn hits(
    manipulator: &Manipulator,
    grid: &Grid,
    modes: Modes,
    progress: &Progress,
) -> Result<Option<Vec<[u64; 2]>>, Cancelled> {
    let axes = grid.axes();
    let mut found: Option<Vec<[u64; 2]>> = None;
    // Per segment only the ends matter: two numbers a coordinate.
    let ends = |hits: &crate::Hits<'_>, ends: &mut Vec<Vec<[f64; 2]>>| {
        let mut row = vec![[hits.first[0], hits.first[hits.first.len() - 1]]];
        row.extend(hits.others.iter().map(|&value| [value; 2]));
        match ends.first_mut() {
            None => ends.push(row),
            Some(known) => {
                for (known, row) in known.iter_mut().zip(row) {
                    *known = [known[0].min(row[0]), known[1].max(row[1])];
                }
            }
        }
    };
    let number = |axis: &Axis, value: f64| {
        if axis.count == 1 {
            return 0;
        }
        ((value - axis.min) / (axis.max - axis.min) * (axis.count - 1) as f64).round() as u64
    };
    Sweep::new(manipulator, grid, modes).points(progress, ends, Vec::new, |ends| {
        for row in ends {
            let row: Vec<_> =
                axes.iter().zip(row).map(|(a, [x, y])| [number(a, x), number(a, y)]).collect();
            match &mut found {
                None => found = Some(row),
                Some(found) => {
                    for (found, row) in found.iter_mut().zip(row) {
                        *found = [found[0].min(row[0]), found[1].max(row[1])];
                    }
                }
            }
        }
        Ok::<(), Cancelled>(())
    })?;
    Ok(found)
}

/// A length that the workspace is of the order of: how far the joints are spread and may travel.
fn size(manipulator: &Manipulator) -> f64 {
    let mechanism = manipulator.mechanism();
    let spread = mechanism.joints().map(|j| (j.point - mechanism.platform).norm());
    let travel = mechanism
        .coordinates()
        .filter(|c| c.quantity == Quantity::Length)
        .filter_map(|c| c.limits.map(|[low, high]| high - low));
    let size = spread.chain(travel).fold(0.0, f64::max);
    if size > 0.0 { size } else { 1.0 }
}

/// The nearest odd number, at least 3: a grid about home has home on it.
fn odd(count: f64) -> u64 {
    ((count - 1.0) / 2.0).round().max(1.0) as u64 * 2 + 1
}

/// Rounds an end outward to about a percent of the extent, in decimal steps.
fn round(end: f64, extent: &Extent, outward: impl Fn(f64) -> f64) -> f64 {
    let width = extent.max - extent.min;
    if width <= 0.0 {
        return end;
    }
    let exponent = (width / 100.0).log10().ceil() as i32;
    // Scaled by a whole power of ten both ways, the end is the double nearest to its decimals.
    let power = 10_f64.powi(exponent.abs());
    let inside = end * (1.0 - 1e-12);
    let rounded = if exponent < 0 {
        outward(inside * power) / power
    } else {
        outward(inside / power) * power
    };
    // Angles end at a whole turn, not just beyond.
    if (end.abs() - PI).abs() < 1e-12 { end } else { rounded }
}
