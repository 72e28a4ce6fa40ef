//! The boundary of a plane set as closed polylines: marching squares on the points of its grid.
//!
//! A line runs half-way between a point that is in and its neighbour that is out. Where two points that
//! are in meet at a corner alone, they are kept apart, as [`Components`](crate::Components) are. Where
//! the set goes up to the edge of the grid, so does the line: what is beyond is not known, and an angle
//! that comes full circle is cut open there. W. E.
//! Lorensen, H. E. Cline, *Marching cubes*, SIGGRAPH 1987, in the plane.

use crate::grid::Axis;
use crate::set::GridSet;

/// A closed polyline: the last point is joined to the first. The set lies to its left, so that it runs
/// counter-clockwise around a piece of the set, and clockwise around a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct Ring {
    /// Its corners; no three in a row are in line.
    pub points: Vec<[f64; 2]>,
}

impl Ring {
    /// The area inside, in the product of both axes' units; of a hole negative.
    pub fn area(&self) -> f64 {
        // From the first corner, so that a far-off place costs no digits.
        let Some(&[x, y]) = self.points.first() else { return 0.0 };
        let sides = self.points.windows(2);
        sides.map(|s| 0.5 * ((s[0][0] - x) * (s[1][1] - y) - (s[1][0] - x) * (s[0][1] - y))).sum()
    }
}

/// The boundary of a set, or of one slice of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// The number of the value of the set's third axis that has several values, if there is one.
    pub slice: Option<u64>,
    /// Closed polylines in the first two axes that have several values.
    pub rings: Vec<Ring>,
}

impl Outline {
    /// The area inside, holes not counted.
    pub fn area(&self) -> f64 {
        self.rings.iter().map(Ring::area).sum()
    }
}

/// The boundary of a set in the first two axes that have several values; where there is a third one, a
/// slice for each of its values. `None` of sets of fewer or more dimensions than that.
pub fn boundary(set: &GridSet) -> Option<Vec<Outline>> {
    let axes = set.varying();
    let ([x, y] | [x, y, _]) = axes[..] else { return None };
    let [x, y] = [x, y].map(|number| &set.axes()[number].axis);
    let high = y.count as usize;
    let slices = set.rows() / high;
    let outline = |slice: usize| {
        let mut inside = vec![false; (x.count * y.count) as usize];
        for row in 0..high {
            for run in set.runs(slice * high + row) {
                let first = row * x.count as usize;
                inside[first + run.from as usize..first + run.to as usize].fill(true);
            }
        }
        Outline { slice: axes.get(2).map(|_| slice as u64), rings: rings(x, y, &inside) }
    };
    Some((0..slices).map(outline).collect())
}

/// The boundary of the points of a plane grid that are `inside`, row by row.
///
/// # Panics
/// Where `inside` has another number of points than the grid.
pub fn rings(x: &Axis, y: &Axis, inside: &[bool]) -> Vec<Ring> {
    let [width, height] = [x, y].map(|axis| axis.count as i64);
    assert!(inside.len() as i64 == width * height, "{} points", inside.len());
    let mask = Mask { inside, width, height };
    // Every ring runs to the right below some point of the set.
    let mut seen = vec![false; inside.len()];
    let mut found = vec![];
    for start in 0..inside.len() {
        let point = [start as i64 % width, start as i64 / width];
        if seen[start] || !mask.has(point) || mask.has(step(point, DOWN)) {
            continue;
        }
        let first = Crossing { point, out: DOWN };
        let (mut crossing, mut corners) = (first, vec![]);
        loop {
            if crossing.out == DOWN {
                seen[(crossing.point[1] * width + crossing.point[0]) as usize] = true;
            }
            let corner = mask.corner(crossing);
            if corners.last() != Some(&corner) {
                corners.push(corner);
            }
            crossing = mask.next(crossing);
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

/// The corners at which a closed polyline turns.
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
        let turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        (turn != 0).then_some(b)
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
    /// The way to the neighbour.
    out: [i64; 2],
}

struct Mask<'a> {
    inside: &'a [bool],
    width: i64,
    height: i64,
}

impl Mask<'_> {
    fn has(&self, [i, j]: [i64; 2]) -> bool {
        let within = (0..self.width).contains(&i) && (0..self.height).contains(&j);
        within && self.inside[(j * self.width + i) as usize]
    }

    /// The crossing's place in half steps, not beyond the edge of the grid.
    fn corner(&self, Crossing { point, out }: Crossing) -> [i64; 2] {
        let [i, j] = [2 * point[0] + out[0], 2 * point[1] + out[1]];
        [i.clamp(0, 2 * (self.width - 1)), j.clamp(0, 2 * (self.height - 1))]
    }

    /// The next one with the set to the left.
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
