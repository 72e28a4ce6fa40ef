//! A grid that suits a mechanism: how far its workspace reaches along every task coordinate.
//!
//! Found by sweeping: a coarse grid about home grows until no reachable pose lies on its faces, then
//! shrinks onto those that there are. One way for every mechanism, limits of all kinds included.

use crate::grid::{Axis, Grid};
use crate::progress::{Cancelled, Progress};
use crate::sweep::{Modes, Sweep};
use opm_core::joint::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::task::TaskCoordinate;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

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

/// A workspace narrower than this share of the box that it was looked for in is a point, or next to
/// one: the grid shrinks no further.
const NARROW: f64 = 1e-6;

/// This near to a value of a coarse grid, in steps, is on it: rounding must not decide.
const ON_GRID: f64 = 1e-6;

/// How far a workspace reaches along one task coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// The task coordinate's name.
    pub name: &'static str,
    /// Lowest value, radians or metres.
    pub min: f64,
    /// Highest value, radians or metres.
    pub max: f64,
    /// The workspace goes on beyond, without an end that was found.
    pub unbounded: bool,
}

/// A grid over the whole workspace, and how far that reaches. Angles that know no whole turns are
/// kept to one turn, and what has no end to the size of the mechanism.
///
/// # Errors
/// When told to stop.
pub fn default_grid(
    manipulator: &Manipulator,
    modes: Modes,
    progress: &Progress,
) -> Result<(Grid, Vec<Extent>), Cancelled> {
    let search = Search::new(manipulator, modes, progress)?;
    let ranges = search.shrink(search.grow()?)?;
    let lower = manipulator.task().lower_count;
    let (n, uppers) = (ranges.len() as f64, (ranges.len() - lower) as f64);
    // lower^n / FINER^uppers = DEFAULT_POSES
    let fine = (DEFAULT_POSES * FINER.powf(uppers)).powf(1.0 / n);
    let axes = ranges.iter().enumerate().map(|(number, range)| {
        let count = if number < lower { fine } else { fine / FINER };
        let [min, max] = range.rounded();
        axis(range.extent.name, min, max, odd(count))
    });
    let grid = Grid::new(manipulator, axes.collect());
    let extents = ranges.into_iter().map(|range| range.extent).collect();
    Ok((grid.expect("ranges are finite and counts small"), extents))
}

/// Where the workspace is looked for along one coordinate.
#[derive(Clone, Debug)]
struct Range {
    extent: Extent,
    /// Ends that it starts with.
    start: [f64; 2],
    /// May go beyond them.
    grows: bool,
}

impl Range {
    fn new(manipulator: &Manipulator, coordinate: &TaskCoordinate, size: f64) -> Self {
        let (name, home) = (coordinate.name, coordinate.home);
        let [min, max] = match coordinate.quantity {
            Quantity::Length => [home - size, home + size],
            Quantity::Angle => one_turn(name, home),
        };
        let grows = coordinate.quantity == Quantity::Length || manipulator.counts_turns(name);
        let extent = Extent { name, min, max, unbounded: false };
        Self { extent, start: [min, max], grows }
    }

    fn width(&self) -> f64 {
        self.extent.max - self.extent.min
    }

    /// The ends, outward to about a percent of the width, in decimal steps; not beyond those of an
    /// angle's one turn.
    fn rounded(&self) -> [f64; 2] {
        let Extent { min, max, .. } = self.extent;
        let width = self.width();
        if width <= 0.0 {
            return [min, max];
        }
        let exponent = (width / 100.0).log10().ceil() as i32;
        // Scaled by a whole power of ten both ways, an end is the double nearest to its decimals.
        let power = 10_f64.powi(exponent.abs());
        let step = |end: f64, outward: fn(f64) -> f64| {
            if exponent < 0 { outward(end * power) / power } else { outward(end / power) * power }
        };
        // What is on a step but for rounding stays on it.
        let inward = 1e-12 * width;
        let low = step(min + inward, f64::floor);
        let high = step(max - inward, f64::ceil);
        if self.grows {
            return [low, high];
        }
        [low.max(self.start[0]), high.min(self.start[1])]
    }
}

/// Sweeps of coarse grids.
struct Search<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    progress: &'a Progress,
    start: Vec<Range>,
    /// Values of a coarse grid along every coordinate.
    count: u64,
    /// Home is part of the workspace.
    home: bool,
}

impl<'a> Search<'a> {
    fn new(
        manipulator: &'a Manipulator,
        modes: Modes,
        progress: &'a Progress,
    ) -> Result<Self, Cancelled> {
        let coordinates = manipulator.task_coordinates();
        let size = size(manipulator);
        let start = coordinates.iter().map(|c| Range::new(manipulator, c, size)).collect();
        let home = Grid::new(manipulator, vec![]).expect("home alone is a grid");
        let home = Sweep::new(manipulator, &home, modes).count(progress)?.reachable == 1;
        let count = odd(COARSE_POSES.powf(1.0 / coordinates.len() as f64));
        Ok(Self { manipulator, modes, progress, start, count, home })
    }

    /// Ranges that hold the whole workspace; where it has no end, as they start.
    fn grow(&self) -> Result<Vec<Range>, Cancelled> {
        let mut start = self.start.clone();
        loop {
            let mut ranges = start.clone();
            let mut last = vec![];
            for _ in 0..DOUBLINGS {
                let Some(hit) = self.hits(&ranges)? else { return Ok(ranges) };
                last.clear();
                for (number, (range, &[low, high])) in ranges.iter_mut().zip(&hit).enumerate() {
                    let (width, extent) = (range.width(), &mut range.extent);
                    let (down, up) = (low == 0, high + 1 == self.count);
                    if range.grows && !extent.unbounded && (down || up) {
                        extent.min -= if down { width / 2.0 } else { 0.0 };
                        extent.max += if up { width / 2.0 } else { 0.0 };
                        last.push(number);
                    }
                }
                if last.is_empty() {
                    return Ok(ranges);
                }
            }
            // What still grows has no end; how far the others reach is found without it.
            for number in last {
                start[number].extent.unbounded = true;
            }
        }
    }

    /// Ranges as close about the workspace as a coarse grid shows it.
    fn shrink(&self, mut ranges: Vec<Range>) -> Result<Vec<Range>, Cancelled> {
        loop {
            let grid = self.grid(&ranges);
            let Some(hit) = self.hits(&ranges)? else { return Ok(ranges) };
            let mut settled = true;
            for ((range, axis), &[low, high]) in ranges.iter_mut().zip(grid.axes()).zip(&hit) {
                let (min, max) =
                    (axis.value(low.saturating_sub(1)), axis.value((high + 1).min(self.count - 1)));
                if max - min > NARROW * (range.start[1] - range.start[0]) {
                    settled &= max - min > SETTLED * range.width();
                    (range.extent.min, range.extent.max) = (min, max);
                }
            }
            if settled {
                return Ok(ranges);
            }
        }
    }

    fn grid(&self, ranges: &[Range]) -> Grid {
        let axes =
            ranges.iter().map(|Range { extent: e, .. }| axis(e.name, e.min, e.max, self.count));
        Grid::new(self.manipulator, axes.collect())
            .expect("ranges are finite and the count is small")
    }

    /// Lowest and highest number of the reachable poses along every axis of a coarse grid. Home
    /// counts where it is reachable, so that a workspace between the poses is not missed.
    fn hits(&self, ranges: &[Range]) -> Result<Option<Vec<[u64; 2]>>, Cancelled> {
        let grid = self.grid(ranges);
        let axes = grid.axes();
        let number = |axis: &Axis, value: f64| {
            let share = (value - axis.min) / (axis.max - axis.min);
            if axis.count == 1 { 0.0 } else { share * (axis.count - 1) as f64 }
        };
        let home = axes.iter().zip(self.manipulator.task_coordinates()).map(|(axis, c)| {
            let number = number(axis, c.home);
            let [below, above] = [(number + ON_GRID).floor(), (number - ON_GRID).ceil()];
            [below.max(0.0) as u64, above.max(0.0) as u64]
        });
        let mut found: Option<Vec<[u64; 2]>> = self.home.then(|| home.collect());
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
        let sweep = Sweep::new(self.manipulator, &grid, self.modes);
        sweep.points(self.progress, ends, Vec::new, |ends| {
            for row in ends {
                let row: Vec<_> = axes
                    .iter()
                    .zip(row)
                    .map(|(axis, ends)| ends.map(|end| number(axis, end).round() as u64))
                    .collect();
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
}

/// The range of an angle that knows no whole turns: of Euler angles and tilts every orientation or
/// direction, each but once, home's among them.
pub(crate) fn one_turn(name: &str, home: f64) -> [f64; 2] {
    match name {
        "xi" => [0.0, PI].map(|end| end + PI * (home / PI).floor()),
        "zeta" | "psi" => [-PI, PI].map(|end| end + whole_turns(home)),
        "nu" => [home - FRAC_PI_2, home + FRAC_PI_2],
        _ => [home - PI, home + PI],
    }
}

fn axis(name: &str, min: f64, max: f64, count: u64) -> Axis {
    if min < max { Axis::new(name, min, max, count) } else { Axis::fixed(name, min) }
}

/// The whole turns nearest to an angle; none for one of at most half a turn.
fn whole_turns(angle: f64) -> f64 {
    if angle.abs() <= PI { 0.0 } else { TAU * (angle / TAU).round() }
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
