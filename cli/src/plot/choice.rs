//! The choice of slices: the coordinates that are shown, held, or varied from tile to tile.

use super::grid::nearest;
use super::layout::{Coordinate, Layout};
use super::source::{Rate, Source};
use crate::args::PlotArgs;
use crate::failure::Failure;
use crate::text::short;
use opm_core::Quantity;
use opm_core::task::CoordinateKind;
use opm_workspace::Axis;

/// Largest number of slices that --slice may request.
const MOST: usize = 36;

/// Whether a coordinate has several values on its grid.
pub fn several(coordinate: &Coordinate) -> bool {
    coordinate.axis.as_ref().is_some_and(|axis| axis.count > 1)
}

/// The first two of the recording's axes that vary. If only one varies, it is taken twice.
pub fn fast(layout: &Layout) -> [usize; 2] {
    let varies = |number: &&usize| {
        layout.coordinates[**number].axis.as_ref().is_none_or(|axis| axis.count > 1)
    };
    let mut order: Vec<usize> = layout.axes.iter().filter(varies).copied().collect();
    if let [only] = order[..] {
        return [only; 2];
    }
    order.extend(layout.axes.iter().filter(|number| !varies(number)));
    [order.first().copied().unwrap_or(0), order.get(1).copied().unwrap_or(0)]
}

/// The direction and the tilt of a wrist, if both vary and no position does: it is drawn in polar form.
pub fn tilts(layout: &Layout, source: &Source<'_>) -> Option<[usize; 2]> {
    let of = |kinds: [CoordinateKind; 2]| {
        let known = source.manipulator()?.task_coordinates();
        let name = known.iter().find(|c| kinds.contains(&c.kind()))?.name;
        layout.find(name).filter(|number| several(&layout.coordinates[*number]))
    };
    let direction = of([CoordinateKind::Zeta, CoordinateKind::Azimuth])?;
    let tilt = of([CoordinateKind::Xi, CoordinateKind::Tilt])?;
    let is_place =
        |(quantity, axis): &(Quantity, Axis)| *quantity == Quantity::Length && axis.count > 1;
    let from = layout.coordinates[tilt].axis.as_ref()?.min;
    (from >= 0.0 && !layout.grid.iter().any(is_place)).then_some([direction, tilt])
}

/// The value nearest to home, or the middle value if the coordinate has no home.
pub fn home(coordinate: &Coordinate) -> u64 {
    match (&coordinate.axis, coordinate.home) {
        (Some(axis), Some(home)) => nearest(axis, home),
        (Some(axis), None) => axis.count / 2,
        (None, _) => 0,
    }
}

/// The selection of `--slice`: coordinates with the indices of their grid values.
pub fn selected(
    layout: &Layout,
    (source, args): (&Source<'_>, &PlotArgs),
    view: [usize; 2],
) -> Result<Vec<(usize, Vec<u64>)>, Failure> {
    let wrong = |problem: String| Err(Failure::flag("--slice", problem));
    let mut selected: Vec<(usize, Vec<u64>)> = vec![];
    for given in &args.slice {
        let name = &given.name;
        let Some(number) = layout.find(name) else {
            if layout.lost.contains(name) {
                return wrong(format!("{name} is not stored with the points of this recording"));
            }
            return wrong(format!("{name:?} is not one of {}", layout.names()));
        };
        if view.contains(&number) {
            return wrong(format!("{name} is an axis of the slices; --values chooses others"));
        }
        let c = &layout.coordinates[number];
        let Some(axis) = &c.axis else {
            return wrong(format!("{name} is on no grid"));
        };
        let value = match c.quantity {
            Some(quantity) => given.value.value_of(name, quantity),
            None => given.value.value_of(name, Quantity::Length),
        };
        let value = value.map_err(|error| Failure::flag("--slice", error))?;
        let step = (axis.max - axis.min) / axis.count.saturating_sub(1).max(1) as f64;
        if value < axis.min - 0.5 * step || value > axis.max + 0.5 * step {
            let (measure, factor) = source.measure(name, c.quantity, Rate::Position);
            let [value, min, max] = [value, axis.min, axis.max].map(|v| short(v / factor));
            let unit = measure.unit.symbol;
            return wrong(format!(
                "{name} = {value} {unit}: the grid goes from {min} to {max} {unit}"
            ));
        }
        let value = nearest(axis, value);
        match selected.iter_mut().find(|(known, _)| *known == number) {
            Some((_, values)) if values.contains(&value) => {}
            Some((_, values)) => values.push(value),
            None => selected.push((number, vec![value])),
        }
    }
    if let Some((number, values)) = selected.iter().find(|(_, values)| values.len() > MOST) {
        let name = &layout.coordinates[*number].name;
        return wrong(format!("{} values of {name}, expected at most {MOST}", values.len()));
    }
    Ok(selected)
}

/// The coordinate that has another value in each tile. It is the one with several given values, or else one
/// without given values, the cloud's third axis first.
pub fn varied(
    layout: &Layout,
    free: &[usize],
    selected: &[(usize, Vec<u64>)],
) -> Result<Option<usize>, Failure> {
    let several: Vec<usize> = selected.iter().filter(|a| a.1.len() > 1).map(|a| a.0).collect();
    if let [a, b, ..] = several[..] {
        let [a, b] = [a, b].map(|number| &layout.coordinates[number].name);
        let problem = format!("several values of both {a} and {b}, expected of one coordinate");
        return Err(Failure::flag("--slice", problem));
    }
    if let [one] = several[..] {
        return Ok(Some(one));
    }
    let open = || free.iter().copied().filter(|n| !selected.iter().any(|(known, _)| known == n));
    // The third axis of the cloud, or the value of its colours.
    let color = layout.colored.as_deref().and_then(|name| layout.find(name));
    let third = [layout.axes.get(2).copied(), color].into_iter().flatten();
    let third = third.into_iter().find(|third| open().any(|number| number == *third));
    let count = |number: &usize| layout.coordinates[*number].axis.as_ref().map_or(0, |a| a.count);
    Ok(third.or_else(|| open().max_by_key(count)))
}

/// Number of tiles in a row.
pub fn columns(tiles: usize) -> usize {
    match tiles {
        0..=3 => tiles.max(1),
        4 => 2,
        5 | 6 | 9 => 3,
        7 | 8 => 4,
        _ => tiles.div_ceil(4).min(6),
    }
}
