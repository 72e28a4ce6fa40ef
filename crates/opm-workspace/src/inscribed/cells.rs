//! The cells of a set's points, in three dimensions; a set in a plane is one layer.

use crate::grid::Axis;
use crate::set::GridSet;

/// The centre and the radii that are found; beyond the set's coordinates without meaning.
pub(super) type CentreAndRadii = ([f64; 3], [f64; 3]);

/// Which cells of a grid are inside.
pub(super) struct Cells {
    /// The number of cells along each axis.
    pub counts: [usize; 3],
    /// The widths of a cell. A layer alone has an infinite one, whose sides are nowhere near.
    pub step: [f64; 3],
    /// The lowest side of the first cell.
    start: [f64; 3],
    /// The lowest and the highest side of all cells, beyond which nothing is known; infinite across a layer alone.
    pub ends: [[f64; 2]; 3],
    inside: Vec<bool>,
}

impl Cells {
    pub fn new(set: &GridSet, axes: &[Axis]) -> Self {
        let mut cells = Self {
            counts: [1; 3],
            step: [f64::INFINITY; 3],
            start: [f64::NEG_INFINITY; 3],
            ends: [[f64::NEG_INFINITY, f64::INFINITY]; 3],
            inside: vec![false; set.points() as usize],
        };
        for (i, axis) in axes.iter().enumerate() {
            cells.counts[i] = axis.count as usize;
            cells.step[i] = (axis.max - axis.min) / (axis.count - 1) as f64;
            cells.start[i] = axis.min - 0.5 * cells.step[i];
            cells.ends[i] = [cells.at(i, 0), cells.at(i, 2 * cells.counts[i])];
        }
        set.numbers().for_each(|number| cells.inside[number as usize] = true);
        cells
    }

    /// The halves, in every direction, of these cells within the grid. One is inside if the boundary that is drawn
    /// ([`boundary`](crate::boundary)) does not cut it: that is a line between the middles of the sides of the square of four
    /// neighbouring points, and cuts the corner off a point that has neither neighbour there.
    pub fn halves(&self) -> Self {
        let dimension = self.dimension();
        let mut halves = Self {
            counts: [1; 3],
            step: self.step.map(|step| 0.5 * step),
            start: self.start,
            ends: self.ends,
            inside: Vec::new(),
        };
        for axis in 0..dimension {
            halves.counts[axis] = 2 * (self.counts[axis] - 1);
            // From the first point to the last.
            halves.start[axis] = self.at(axis, 1);
            halves.ends[axis] = [self.at(axis, 1), self.at(axis, 2 * self.counts[axis] - 1)];
        }
        let [nx, ny, nz] = halves.counts;
        halves.inside = (0..nx * ny * nz)
            .map(|number| {
                let half = [number % nx, number / nx % ny, number / nx / ny];
                // The point that it touches, and its neighbours on the other sides of it.
                let mut point = half;
                (0..dimension).for_each(|axis| point[axis] = half[axis].div_ceil(2));
                let beside = |axis: usize| {
                    let mut other = point;
                    other[axis] =
                        if half[axis] % 2 == 0 { point[axis] + 1 } else { point[axis] - 1 };
                    self.has(other)
                };
                let without = (0..dimension).filter(|&axis| !beside(axis)).count();
                self.has(point) && without < 2
            })
            .collect();
        halves
    }

    /// Whether a cell is inside.
    pub fn has(&self, [i, j, k]: [usize; 3]) -> bool {
        self.inside[(k * self.counts[1] + j) * self.counts[0] + i]
    }

    /// The cells that are not inside.
    pub fn outside(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let [nx, ny, _] = self.counts;
        let numbers = (0..self.inside.len()).filter(|&number| !self.inside[number]);
        numbers.map(move |number| [number % nx, number / nx % ny, number / nx / ny])
    }

    /// The number of axes.
    pub fn dimension(&self) -> usize {
        self.step.iter().filter(|step| step.is_finite()).count()
    }

    /// The place of a number of half steps along an axis.
    pub fn at(&self, axis: usize, half_steps: usize) -> f64 {
        self.start[axis] + 0.5 * half_steps as f64 * self.step[axis]
    }

    /// The lowest and the highest side of a cell along an axis; infinite across a layer alone.
    pub fn sides(&self, axis: usize, cell: usize) -> [f64; 2] {
        match self.step[axis].is_finite() {
            true => [2 * cell, 2 * cell + 2].map(|half_steps| self.at(axis, half_steps)),
            false => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// The distance along an axis from a place to a cell; zero within it.
    pub fn gap(&self, axis: usize, place: f64, cell: usize) -> f64 {
        let [low, high] = self.sides(axis, cell);
        (low - place).max(place - high).max(0.0)
    }

    /// Whether a shape touches the edge of the grid.
    pub fn is_at_edge(&self, centre: [f64; 3], radii: [f64; 3], dimension: usize) -> bool {
        (0..dimension).any(|axis| {
            let near = 1e-9 * self.step[axis];
            let [low, high] = self.ends[axis];
            centre[axis] - radii[axis] <= low + near || centre[axis] + radii[axis] >= high - near
        })
    }
}
