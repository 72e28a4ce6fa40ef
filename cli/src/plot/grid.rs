//! Values of an axis of a grid.

use opm_workspace::Axis;

/// Values of the grid and of home that differ by less are considered equal.
const ROUNDING: f64 = 1e-9;

/// The index of the grid value that is nearest to an SI value.
pub fn nearest(axis: &Axis, value: f64) -> u64 {
    let share = (value - axis.min) / (axis.max - axis.min).max(f64::MIN_POSITIVE);
    // The cast saturates.
    ((share * (axis.count - 1) as f64).round() as u64).min(axis.count - 1)
}

/// Whether a value of the grid is within half a step of home.
pub fn is_home(axis: &Axis, home: f64, value: u64) -> bool {
    let step = (axis.max - axis.min) / axis.count.saturating_sub(1).max(1) as f64;
    let slack = ROUNDING * axis.max.abs().max(axis.min.abs()).max(1.0);
    (axis.value(value) - home).abs() <= 0.5 * step + slack
}
