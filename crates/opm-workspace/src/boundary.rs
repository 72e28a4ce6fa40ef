//! The boundary of a plane set as closed polylines: marching squares on the points of its grid.
//!
//! A line runs half-way between a point of the set and its neighbour outside. Two points of the set that
//! meet at a corner alone are kept apart, as in [`Components`](crate::Components). Where the set goes up
//! to the edge of the grid, so does the line: what is beyond is not known, and an angle that comes full
//! circle is cut open there. W. E. Lorensen, H. E. Cline, *Marching cubes*, SIGGRAPH 1987, in the plane.

use crate::grid::Axis;
use crate::set::GridSet;
use crate::sweep::{Run, runs};
use std::collections::HashSet;

/// A closed polyline, whose last point is joined to its first. The set lies to its left: it runs
/// counter-clockwise around a piece of the set, and clockwise around a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    /// The corners, as values of both axes. No three in succession are on a line.
    pub points: Vec<[f64; 2]>,
}

impl Ring {
    /// The area inside, in the product of both axes' units. It is negative for a hole.
    pub fn area(&self) -> f64 {
        // Seen from the first corner, so that a figure far from the origin keeps its digits.
        let Some(&[x, y]) = self.points.first() else { return 0.0 };
        let sides = self.points.windows(2);
        sides.map(|s| 0.5 * ((s[0][0] - x) * (s[1][1] - y) - (s[1][0] - x) * (s[0][1] - y))).sum()
    }
}

/// The boundary of a set, or of one slice of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The number of the value on the third axis that has several values; `None` if there are only two.
    pub slice: Option<u64>,
    /// The closed polylines, in the first two axes that have several values.
    pub rings: Vec<Ring>,
}

impl Outline {
    /// The area of the set, in the product of both axes' units; holes are subtracted.
    pub fn area(&self) -> f64 {
        self.rings.iter().map(Ring::area).sum()
    }
}

/// The boundary of a set in the first two axes that have several values. If a third axis has several values,
/// there is one outline for each of them. `None` if fewer than two axes or more than three have several
/// values.
///
/// ```
/// use opm_workspace::{Axis, GridSet, SetAxis, boundary};
///
/// let axis = |name: &str| SetAxis { axis: Axis::new(name, -1.0, 1.0, 201), circle: false };
/// let axes = vec![axis("x"), axis("y")];
/// let disc = GridSet::of(axes, |number| {
///     let [x, y] = [number % 201, number / 201].map(|i| i as f64 / 100.0 - 1.0);
///     x * x + y * y < 0.25
/// })?;
/// let outlines = boundary(&disc).ok_or("not a plane set")?;
/// assert_eq!((outlines.len(), outlines[0].rings.len()), (1, 1));
/// assert!((outlines[0].area() - 0.25 * std::f64::consts::PI).abs() < 0.01);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn boundary(set: &GridSet) -> Option<Vec<Outline>> {
    let axes = set.varying();
    let ([x, y] | [x, y, _]) = axes[..] else { return None };
    let [x, y] = [x, y].map(|number| &set.axes()[number].axis);
    let high = y.count as usize;
    let outline = |slice: usize| {
        let rings = trace(x, y, |row| set.runs(slice * high + row));
        Outline { slice: axes.get(2).map(|_| slice as u64), rings }
    };
    Some((0..set.rows() / high).map(outline).collect())
}

/// A mask does not have one value for each point of its grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found} points, expected {expected}")]
pub struct MaskError {
    /// The number of points of the mask.
    pub found: u64,
    /// The number of points of the grid.
    pub expected: u64,
}

/// The boundary of the points of a plane grid that are `inside`, which has one value for each point, row by
/// row: the point with numbers `i` along `x` and `j` along `y` is at `j * x.count + i`.
///
/// # Errors
/// [`MaskError`] if `inside` has another number of points than the grid.
pub fn mask_boundary(x: &Axis, y: &Axis, inside: &[bool]) -> Result<Vec<Ring>, MaskError> {
    let (found, expected) = (inside.len() as u64, x.count * y.count);
    if found != expected {
        return Err(MaskError { found, expected });
    }
    let runs = |row: &[bool]| {
        let mut runs = Vec::new();
        let numbers = (0..).zip(row).filter(|(_, inside)| **inside);
        numbers.for_each(|(number, _)| runs::push(&mut runs, number));
        runs
    };
    let rows: Vec<Vec<Run>> = inside.chunks((x.count as usize).max(1)).map(runs).collect();
    Ok(trace(x, y, |row| &rows[row]))
}

/// The boundary of a set that has these runs in each row. It takes time and memory for runs, not for points.
fn trace<'a>(x: &Axis, y: &Axis, runs: impl Fn(usize) -> &'a [Run]) -> Vec<Ring> {
    let [width, height] = [x, y].map(|axis| axis.count as i64);
    let mask = Mask { runs, width, height };
    // Every ring runs to the right below some point of the set, and each such stretch is in one ring.
    let mut seen = HashSet::new();
    let mut found = vec![];
    for start in (0..height).flat_map(|row| mask.bare_below(row)) {
        if seen.contains(&start) {
            continue;
        }
        let first = Crossing { point: start, out: DOWN };
        let (mut crossing, mut corners) = (first, vec![]);
        loop {
            if crossing.out == DOWN {
                seen.insert(crossing.point);
            }
            let end = mask.straight(crossing);
            for corner in [crossing, end].map(|crossing| mask.corner(crossing)) {
                if corners.last() != Some(&corner) {
                    corners.push(corner);
                }
            }
            crossing = mask.next(end);
            if crossing == first {
                break;
            }
        }
        let value = |axis: &Axis, twice: i64| {
            let share = twice as f64 / (2 * (axis.count - 1).max(1)) as f64;
            axis.min * (1.0 - share) + axis.max * share
        };
        let points = bends(&corners).map(|[i, j]| [value(x, i), value(y, j)]);
        found.push(Ring { points: points.collect() });
    }
    found
}

/// The corners at which a closed polyline changes its direction.
fn bends(corners: &[[i64; 2]]) -> impl Iterator<Item = [i64; 2]> {
    let mut corners = corners;
    // At a corner of the grid the line may end where it began.
    if let [first, rest @ .., last] = corners
        && first == last
    {
        corners = &corners[..=rest.len()];
    }
    let count = corners.len();
    (0..count).filter_map(move |i| {
        let [a, b, c] = [corners[(i + count - 1) % count], corners[i], corners[(i + 1) % count]];
        let cross = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        (cross != 0).then_some(b)
    })
}

const DOWN: [i64; 2] = [0, -1];

fn step(point: [i64; 2], by: [i64; 2]) -> [i64; 2] {
    [point[0] + by[0], point[1] + by[1]]
}

/// Where the line passes between a point of the set and a neighbour that is out.
#[derive(Clone, Copy, PartialEq)]
struct Crossing {
    point: [i64; 2],
    /// The step to the neighbour.
    out: [i64; 2],
}

struct Mask<F> {
    runs: F,
    width: i64,
    height: i64,
}

impl<'a, F: Fn(usize) -> &'a [Run]> Mask<F> {
    /// The runs of a row; none in rows beyond the grid.
    fn row(&self, row: i64) -> &'a [Run] {
        if (0..self.height).contains(&row) { (self.runs)(row as usize) } else { &[] }
    }

    /// The run that a point is in.
    fn run(&self, [i, j]: [i64; 2]) -> Option<Run> {
        let runs = self.row(j);
        let next = runs.partition_point(|run| run.from as i64 <= i);
        runs[..next].last().copied().filter(|run| i < run.to as i64)
    }

    fn has(&self, point: [i64; 2]) -> bool {
        self.run(point).is_some()
    }

    /// The first point of each stretch of a row below which there is nothing.
    fn bare_below(&self, row: i64) -> impl Iterator<Item = [i64; 2]> {
        let below = self.row(row - 1);
        self.row(row).iter().flat_map(move |run| {
            let first = below.partition_point(|under| under.to <= run.from);
            let under = below[first..].iter().take_while(|under| under.from < run.to);
            let bare = below.get(first).is_none_or(|under| run.from < under.from);
            let after = under.map(|under| under.to).filter(|&end| end < run.to);
            bare.then_some(run.from).into_iter().chain(after).map(move |i| [i as i64, row])
        })
    }

    /// The last crossing of the same row on a line with this one.
    fn straight(&self, crossing: Crossing) -> Crossing {
        let Crossing { point: [i, j], out } = crossing;
        let Some(run) = self.run([i, j]) else { return crossing };
        let beyond = self.row(j + out[1]);
        let end = match out {
            [0, -1] => {
                let next = beyond.partition_point(|next| next.from as i64 <= i);
                beyond.get(next).map_or(run.to, |next| next.from.min(run.to)) as i64 - 1
            }
            [0, _] => {
                let next = beyond.partition_point(|last| last.to as i64 <= i);
                beyond[..next].last().map_or(run.from, |last| last.to.max(run.from)) as i64
            }
            _ => i,
        };
        Crossing { point: [end, j], out }
    }

    /// The crossing's place in half steps, not beyond the edge of the grid.
    fn corner(&self, Crossing { point, out }: Crossing) -> [i64; 2] {
        let [i, j] = [2 * point[0] + out[0], 2 * point[1] + out[1]];
        [i.clamp(0, 2 * (self.width - 1)), j.clamp(0, 2 * (self.height - 1))]
    }

    /// The next crossing with the set to the left.
    fn next(&self, Crossing { point, out }: Crossing) -> Crossing {
        let ahead = [-out[1], out[0]];
        let left = step(point, ahead);
        let right = step(left, out);
        if !self.has(left) {
            Crossing { point, out: ahead }
        } else if !self.has(right) {
            Crossing { point: left, out }
        } else {
            Crossing { point: right, out: [-ahead[0], -ahead[1]] }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::set::{SetAxis, SetBuilder};
    use std::f64::consts::PI;

    /// A disc on a grid of more points than any machine holds.
    #[test]
    fn a_boundary_takes_no_memory_for_points() {
        const RADIUS: f64 = 0.9;
        let axes = [("x", 1_000_000_001), ("y", 10_001)];
        let axes = axes.map(|(name, count)| Axis::new(name, -1.0, 1.0, count));
        let [x, y] = &axes;
        let step = 2.0 / (x.count - 1) as f64;
        let number = |x: f64| ((x + 1.0) / step) as u64;
        let plain = axes.iter().map(|axis| SetAxis { axis: axis.clone(), circle: false });
        let mut set = SetBuilder::new(plain.collect()).unwrap();
        for row in 0..y.count {
            let half = (RADIUS * RADIUS - y.value(row).powi(2)).max(0.0).sqrt();
            let [from, to] = [-half, half].map(|end| row * x.count + number(end));
            if from < to {
                set.push(Run { from, to }).unwrap();
            }
        }
        let outlines = boundary(&set.finish()).unwrap();
        let [Outline { rings, slice: None }] = &outlines[..] else { panic!("{outlines:?}") };
        assert_eq!(rings.len(), 1);
        let area = rings[0].area();
        // Its two caps are lower than a step of y.
        assert!((area - PI * RADIUS * RADIUS).abs() < 1e-5, "{area}");
    }
}
