//! A grid that suits a mechanism: how far its workspace reaches along every task coordinate.
//!
//! The grid is found by sweeping. A coarse grid about home grows until no reachable pose lies on its
//! faces, then it shrinks onto the reachable poses. A workspace ends in tips and edges that are thinner
//! than the steps of such a grid. So from the farthest pose that was found along a coordinate, ever finer
//! grids about the farthest pose so far go on until none goes farther. This works for every mechanism and
//! for limits of all kinds.

use crate::grid::{Axis, Grid};
use crate::progress::{Cancelled, Progress};
use crate::sweep::{Modes, Sweep};
use opm_core::Quantity;
use opm_core::manipulator::Manipulator;
use opm_core::task::{CoordinateKind, TaskCoordinate};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The number of poses of a coarse grid, whose sweep takes a few milliseconds.
const COARSE_POSES: f64 = 1e6;

/// The number of poses of the default grid: enough for a good picture, in about a second.
const DEFAULT_POSES: f64 = 4e6;

/// Both grids have this share of their poses where legs are solved whole: poses are decided one by one.
const ONE_BY_ONE: f64 = 0.125;

/// The share of the poses of grids that a mechanism has.
fn share(manipulator: &Manipulator) -> f64 {
    if manipulator.is_whole() { ONE_BY_ONE } else { 1.0 }
}

/// The default grid has this many times more values along a coordinate of the lower section than along
/// one of the upper section: fine slices, at few orientations.
const FINER: f64 = 6.0;

/// How many times a coarse grid may double before a coordinate counts as unbounded.
const DOUBLINGS: usize = 8;

/// The number of poses of a grid about the farthest pose.
const FOLLOWING_POSES: f64 = 2e4;

/// The extent of a workspace is followed up to this share of its width.
const FOLLOWED: f64 = 0.01;

/// A coarse grid that shrinks by less than this has settled.
const SETTLED: f64 = 0.9;

/// A workspace narrower than this share of the box that it was looked for in is nearly a point: the grid
/// shrinks no further.
const NARROW: f64 = 1e-6;

/// A value this near to one of a coarse grid, in steps, is on the grid: rounding must not decide.
const ON_GRID: f64 = 1e-6;

/// How far a workspace reaches along one task coordinate.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// The name of the task coordinate.
    pub name: &'static str,
    /// The lowest value, radians or metres.
    pub min: f64,
    /// The highest value, radians or metres.
    pub max: f64,
    /// Whether the workspace continues beyond, without an end that was found.
    pub unbounded: bool,
}

/// A grid over the whole workspace, and how far the workspace reaches along each task coordinate. Angles of
/// which full revolutions do not matter are kept to one revolution, and coordinates without an end to the size of
/// the mechanism.
///
/// # Errors
/// [`Cancelled`] if [`Progress::cancel`] was called.
///
/// ```
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # use opm_core::Manipulator;
/// # let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// use opm_workspace::{Modes, Progress, default_grid};
///
/// let mode = Modes::One(manipulator.home_mode());
/// let (grid, extents) = default_grid(&manipulator, mode, &Progress::default())?;
/// let x = &extents[0];
/// assert_eq!(x.name, "x");
/// assert!(grid.axes()[0].min <= x.min && x.max <= grid.axes()[0].max);
/// # Ok(())
/// # }
/// ```
pub fn default_grid(
    manipulator: &Manipulator,
    modes: Modes,
    progress: &Progress,
) -> Result<(Grid, Vec<Extent>), Cancelled> {
    let search = Search::new(manipulator, modes, progress)?;
    let ranges = search.fit()?;
    let lower = manipulator.lower_coordinates();
    let (n, uppers) = (ranges.len() as f64, (ranges.len() - lower) as f64);
    // lower^n / FINER^uppers = DEFAULT_POSES
    let poses = DEFAULT_POSES * share(manipulator);
    let fine = (poses * FINER.powf(uppers)).powf(1.0 / n);
    let axes = ranges.iter().enumerate().map(|(number, range)| {
        let count = if number < lower { fine } else { fine / FINER };
        let [min, max] = range.rounded();
        axis(range.extent.name, min, max, odd(count))
    });
    let grid = Grid::new(manipulator, axes.collect());
    let extents = ranges.into_iter().map(|range| range.extent).collect();
    Ok((grid.expect("ranges are finite and counts small"), extents))
}

/// The range in which the workspace is looked for along one coordinate.
#[derive(Clone, Debug)]
struct Range {
    kind: CoordinateKind,
    extent: Extent,
    /// The ends that the search starts with.
    start: [f64; 2],
    /// Whether the range may go beyond them.
    grows: bool,
}

impl Range {
    fn new(manipulator: &Manipulator, coordinate: &TaskCoordinate, size: f64) -> Self {
        let (name, home) = (coordinate.name, coordinate.home);
        let [min, max] = match coordinate.quantity {
            Quantity::Length => [home - size, home + size],
            // Elsewhere the other two angles tell a tilt from its opposite.
            Quantity::Angle
                if singular_at(coordinate.kind()).is_some() && follows_tilt(manipulator) =>
            {
                [-PI, PI].map(|end| end + whole_turns(home))
            }
            Quantity::Angle => one_turn(coordinate.kind(), home),
        };
        let grows =
            coordinate.quantity == Quantity::Length || manipulator.counts_turns(coordinate.kind());
        let extent = Extent { name, min, max, unbounded: false };
        Self { kind: coordinate.kind(), extent, start: [min, max], grows }
    }

    fn width(&self) -> f64 {
        self.extent.max - self.extent.min
    }

    /// Whether it is an angle that another one makes up for where the angles of an orientation are singular: an Euler angle
    /// about the intersection motion or the platform's axis, the azimuth, a roll or a yaw.
    fn is_free_where_singular(&self) -> bool {
        use CoordinateKind::{Azimuth, Psi, Roll, Yaw, Zeta};
        matches!(self.kind, Zeta | Psi | Azimuth | Roll | Yaw)
    }

    /// The range with half its width more on both sides, if it may grow: thin parts may lie between the
    /// poses of a coarse grid.
    fn beyond(&self) -> [f64; 2] {
        let more = if self.grows && !self.extent.unbounded { 0.5 * self.width() } else { 0.0 };
        [self.extent.min - more, self.extent.max + more]
    }

    /// The ends, rounded outward to decimal steps of about a percent of the width; an angle stays within
    /// its one turn.
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
        // An end that is nearly on a step stays on it.
        let inward = 1e-12 * width;
        let low = step(min + inward, f64::floor);
        let high = step(max - inward, f64::ceil);
        if self.grows {
            return [low, high];
        }
        [low.max(self.start[0]), high.min(self.start[1])]
    }
}

/// Where the angles of an orientation are singular, up to half turns, if it is that of them which tells: for Euler angles and
/// for tilt and torsion the angle between the third directions, before and after, and else the pitch.
fn singular_at(kind: CoordinateKind) -> Option<f64> {
    use CoordinateKind::{
        Azimuth, H, Mu, Nu, Phi, Pitch, Psi, Roll, Theta, Tilt, Torsion, W, X, Xi, Y, Yaw, Z, Zeta,
    };
    match kind {
        Xi | Tilt => Some(0.0),
        Pitch => Some(FRAC_PI_2),
        X | Y | Z | H | W | Theta | Phi | Zeta | Psi | Azimuth | Torsion | Roll | Yaw | Mu | Nu => {
            None
        }
    }
}

/// Whether the last angle of an orientation follows from that which tilts, so that a tilt to the other side is another pose.
fn follows_tilt(manipulator: &Manipulator) -> bool {
    use CoordinateKind::{Psi, Roll, Torsion};
    manipulator.dependent_coordinates().iter().any(|c| matches!(c.kind(), Psi | Torsion | Roll))
}

/// The search for the extent of the workspace, by sweeps of coarse grids.
struct Search<'a> {
    manipulator: &'a Manipulator,
    modes: Modes,
    progress: &'a Progress,
    start: Vec<Range>,
    /// The number of values of a coarse grid along every coordinate.
    count: u64,
    /// Whether home is part of the workspace.
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
        let poses = COARSE_POSES * share(manipulator);
        let count = odd(poses.powf(1.0 / coordinates.len() as f64));
        Ok(Self { manipulator, modes, progress, start, count, home })
    }

    /// Ranges that hold the whole workspace. A coordinate without an end keeps its first range.
    fn grow(&self) -> Result<Vec<Range>, Cancelled> {
        let mut start = self.start.clone();
        loop {
            let mut ranges = start.clone();
            let mut last = vec![];
            for _ in 0..DOUBLINGS {
                let Some(hits) = self.hits(&ranges)? else { return Ok(ranges) };
                last.clear();
                for (number, (range, hit)) in ranges.iter_mut().zip(&hits).enumerate() {
                    let [low, high] = hit.numbers;
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
            // Ranges that still grow have no end. The extent of the others is found without them.
            for number in last {
                start[number].extent.unbounded = true;
            }
        }
    }

    /// Ranges that hold the workspace closely.
    fn fit(&self) -> Result<Vec<Range>, Cancelled> {
        let grown = self.grow()?;
        let within: Vec<[f64; 2]> = grown.iter().map(Range::beyond).collect();
        let mut ranges = self.shrink(grown)?;
        // A coarse grid over what was found may show parts that the one before it missed.
        loop {
            let Some(hits) = self.hits(&ranges)? else { return Ok(ranges) };
            let mut found = ranges.clone();
            let mut farther = false;
            // Where these are singular, as at a tilt of zero, two angles are about the same axis: going on along one of
            // them gives orientations again that the other has given. The azimuth has no meaning there.
            let tilt = ranges.iter().find_map(|range| Some((range, singular_at(range.kind)?)));
            let singular = tilt.is_some_and(|(Range { extent, .. }, at)| {
                let slack = FOLLOWED * (extent.max - extent.min);
                let nearest = at + PI * ((extent.min - at) / PI).round();
                nearest >= extent.min - slack && nearest <= extent.max + slack
            });
            for (number, range) in found.iter_mut().enumerate() {
                let least = FOLLOWED * range.width();
                if range.extent.unbounded
                    || least == 0.0
                    || singular && range.is_free_where_singular()
                {
                    continue;
                }
                let mut ends = [0.0; 2];
                for (side, end) in ends.iter_mut().enumerate() {
                    let pose = hits[number].poses[side].clone();
                    let outward = if side == 0 { -1.0 } else { 1.0 };
                    *end = self.leg_branches(pose, (number, outward), &ranges, &within)?;
                }
                let Extent { min, max, .. } = &mut range.extent;
                farther |= ends[0] < *min - least || ends[1] > *max + least;
                (*min, *max) = (min.min(ends[0]), max.max(ends[1]));
            }
            ranges = found;
            if !farther {
                return Ok(ranges);
            }
        }
    }

    /// How far the workspace reaches along one coordinate, to one side, from a pose of it. Grids about the
    /// farthest pose so far are one step of the coarse grid wide to every side, and half as wide each
    /// time that they gain little. They stay `within` a box.
    fn leg_branches(
        &self,
        mut pose: Vec<f64>,
        (number, outward): (usize, f64),
        ranges: &[Range],
        within: &[[f64; 2]],
    ) -> Result<f64, Cancelled> {
        let side = usize::from(outward > 0.0);
        let limit = within[number][side];
        let least = FOLLOWED * ranges[number].width();
        let mut steps: Vec<f64> =
            ranges.iter().map(|range| range.width() / (self.count - 1) as f64).collect();
        let count = odd(FOLLOWING_POSES.powf(1.0 / ranges.len() as f64));
        loop {
            let axes = ranges.iter().enumerate().map(|(i, range)| {
                let [mut low, mut high] = [pose[i] - steps[i], pose[i] + steps[i]];
                if i == number {
                    // No pose on the other side is farther.
                    if outward > 0.0 { low = pose[i] } else { high = pose[i] }
                }
                let [min, max] = within[i];
                axis(range.extent.name, low.clamp(min, max), high.clamp(min, max), count)
            });
            let grid = Grid::new(self.manipulator, axes.collect())
                .expect("steps are finite and the count is small");
            let mut gained = 0.0;
            if let Some(found) = self.farthest(&grid)? {
                let farther = outward * (found[number][side][number] - pose[number]);
                if farther > 0.0 {
                    gained = farther;
                    pose.clone_from(&found[number][side]);
                }
            }
            if gained < 0.5 * steps[number] {
                if steps[number] <= least {
                    break;
                }
                steps.iter_mut().for_each(|step| *step *= 0.5);
            }
        }
        let end = pose[number] + outward * steps[number];
        Ok(if outward > 0.0 { end.min(limit) } else { end.max(limit) })
    }

    /// Ranges that enclose the workspace as closely as a coarse grid shows it.
    fn shrink(&self, mut ranges: Vec<Range>) -> Result<Vec<Range>, Cancelled> {
        loop {
            let grid = self.grid(&ranges);
            let Some(hits) = self.hits(&ranges)? else { return Ok(ranges) };
            let mut settled = true;
            for ((range, axis), hit) in ranges.iter_mut().zip(grid.axes()).zip(&hits) {
                let [low, high] = hit.numbers;
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

    /// How far the reachable poses of a coarse grid go along every axis. Home counts where it is
    /// reachable, so that a workspace between the poses is not missed.
    fn hits(&self, ranges: &[Range]) -> Result<Option<Vec<Hit>>, Cancelled> {
        let grid = self.grid(ranges);
        let number = |axis: &Axis, value: f64| {
            let share = (value - axis.min) / (axis.max - axis.min);
            if axis.count == 1 { 0.0 } else { share * (axis.count - 1) as f64 }
        };
        let home: Vec<f64> = self.manipulator.task_coordinates().iter().map(|c| c.home).collect();
        let home = home.as_slice();
        let at_home = |(i, axis): (usize, &Axis)| {
            let number = number(axis, home[i]);
            let [below, above] = [(number + ON_GRID).floor(), (number - ON_GRID).ceil()];
            Hit {
                numbers: [below.max(0.0) as u64, above.max(0.0) as u64],
                poses: [home.to_vec(), home.to_vec()],
            }
        };
        let mut hits: Option<Vec<Hit>> =
            self.home.then(|| grid.axes().iter().enumerate().map(at_home).collect());
        let Some(found) = self.farthest(&grid)? else { return Ok(hits) };
        let found = found.into_iter().zip(grid.axes()).enumerate().map(|(i, (poses, axis))| Hit {
            numbers: poses.each_ref().map(|pose| number(axis, pose[i]).round() as u64),
            poses,
        });
        match &mut hits {
            None => hits = Some(found.collect()),
            Some(hits) => {
                for (i, (hit, Hit { numbers, poses })) in hits.iter_mut().zip(found).enumerate() {
                    let [low, high] = poses;
                    if low[i] < hit.poses[0][i] {
                        hit.poses[0] = low;
                    }
                    if high[i] > hit.poses[1][i] {
                        hit.poses[1] = high;
                    }
                    let known = hit.numbers;
                    hit.numbers = [known[0].min(numbers[0]), known[1].max(numbers[1])];
                }
            }
        }
        Ok(hits)
    }

    /// For every coordinate, the first reachable pose of the grid with its lowest value, and the first with
    /// its highest value.
    fn farthest(&self, grid: &Grid) -> Result<Option<Vec<[Vec<f64>; 2]>>, Cancelled> {
        let mut farthest = vec![];
        Sweep::new(self.manipulator, grid, self.modes).points(
            self.progress,
            |hits, ends: &mut Vec<[Vec<f64>; 2]>| {
                let [low, high] = [hits.first[0], hits.first[hits.first.len() - 1]];
                let pose = |first: f64| {
                    let others = hits.others.iter().copied();
                    std::iter::once(first).chain(others).collect::<Vec<f64>>()
                };
                if ends.is_empty() {
                    *ends = vec![[pose(low), pose(high)]; hits.others.len() + 1];
                    return;
                }
                for (i, ends) in ends.iter_mut().enumerate() {
                    let other = i.checked_sub(1).map(|i| hits.others[i]);
                    if other.unwrap_or(low) < ends[0][i] {
                        ends[0] = pose(low);
                    }
                    if other.unwrap_or(high) > ends[1][i] {
                        ends[1] = pose(high);
                    }
                }
            },
            Vec::new,
            |ends| {
                if farthest.is_empty() {
                    farthest = ends;
                    return Ok::<(), Cancelled>(());
                }
                for (i, ([low, high], known)) in ends.into_iter().zip(&mut farthest).enumerate() {
                    if low[i] < known[0][i] {
                        known[0] = low;
                    }
                    if high[i] > known[1][i] {
                        known[1] = high;
                    }
                }
                Ok(())
            },
        )?;
        Ok(if farthest.is_empty() { None } else { Some(farthest) })
    }
}

/// How far the reachable poses of a coarse grid go along one axis.
struct Hit {
    /// The lowest and the highest number of their values on the axis.
    numbers: [u64; 2],
    /// A pose with the lowest value, and one with the highest.
    poses: [Vec<f64>; 2],
}

/// The range of an angle whose full revolutions do not matter. Of the angles of orientations and of tilts it gives every
/// orientation or direction once, that of home among them.
pub(crate) fn one_turn(kind: CoordinateKind, home: f64) -> [f64; 2] {
    use CoordinateKind::{
        Azimuth, H, Mu, Nu, Phi, Pitch, Psi, Roll, Theta, Tilt, Torsion, W, X, Xi, Y, Yaw, Z, Zeta,
    };
    match kind {
        Xi | Tilt => [0.0, PI].map(|end| end + PI * (home / PI).floor()),
        Pitch => [-FRAC_PI_2, FRAC_PI_2].map(|end| end + PI * (home / PI).round()),
        Zeta | Psi | Azimuth | Torsion | Roll | Yaw => [-PI, PI].map(|end| end + whole_turns(home)),
        Nu => [home - FRAC_PI_2, home + FRAC_PI_2],
        Theta | Phi | Mu => [home - PI, home + PI],
        X | Y | Z | H | W => unreachable!("a length has no revolutions"),
    }
}

fn axis(name: &str, min: f64, max: f64, count: u64) -> Axis {
    if min < max { Axis::new(name, min, max, count) } else { Axis::fixed(name, min) }
}

/// The full revolutions nearest to an angle, radians; zero for an angle of at most half a turn.
fn whole_turns(angle: f64) -> f64 {
    if angle.abs() <= PI { 0.0 } else { TAU * (angle / TAU).round() }
}

/// A length of the order of the workspace's size: how far the joints are spread and how far they travel.
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

/// The nearest odd number, at least 3, so that a grid about home has home on it.
fn odd(count: f64) -> u64 {
    ((count - 1.0) / 2.0).round().max(1.0) as u64 * 2 + 1
}
