//! The cells of a set's points, in three dimensions; a set in a plane is one layer.

use crate::grid::Axis;
use crate::set::GridSet;

/// The centre and the radii that are found; beyond the set's coordinates without meaning.
pub(super) type Found = ([f64; 3], [f64; 3]);

/// Which cells of a grid are inside.
pub(super) struct Cells {
    /// The number of cells along each axis.
    pub counts: [usize; 3],
    /// The widths of a cell. A layer alone has an infinite one, whose sides are nowhere near.
    pub step: [f64; 3],
    /// The lowest side of the first cell.
    pub start: [f64; 3],
    inside: Vec<bool>,
}

impl Cells {
    pub fn new(set: &GridSet, axes: &[Axis]) -> Self {
        let mut cells = Self {
            counts: [1; 3],
            step: [f64::INFINITY; 3],
            start: [f64::NEG_INFINITY; 3],
            inside: vec![false; set.points() as usize],
        };
        for (i, axis) in axes.iter().enumerate() {
            cells.counts[i] = axis.count as usize;
            cells.step[i] = (axis.max - axis.min) / (axis.count - 1) as f64;
            cells.start[i] = axis.min - 0.5 * cells.step[i];
        }
        set.numbers().for_each(|number| cells.inside[number as usize] = true);
        cells
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

    /// The highest side of the last cell.
    pub fn end(&self, axis: usize) -> f64 {
        self.at(axis, 2 * self.counts[axis])
    }

    /// The distance along an axis from a place to a cell; zero within it.
    pub fn gap(&self, axis: usize, place: f64, cell: usize) -> f64 {
        if self.step[axis].is_infinite() {
            return 0.0;
        }
        let [low, high] = [2 * cell, 2 * cell + 2].map(|half_steps| self.at(axis, half_steps));
        (low - place).max(place - high).max(0.0)
    }

    /// Whether a shape touches the edge of the grid.
    pub fn is_at_edge(&self, centre: [f64; 3], radii: [f64; 3], dimension: usize) -> bool {
        (0..dimension).any(|axis| {
            let near = 1e-9 * self.step[axis];
            centre[axis] - radii[axis] <= self.start[axis] + near
                || centre[axis] + radii[axis] >= self.end(axis) - near
        })
    }
}
