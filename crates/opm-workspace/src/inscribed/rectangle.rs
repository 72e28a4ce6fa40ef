//! The largest box with a free centre: of each range of layers, the largest rectangle in all of them.

use super::cells::{Cells, CentreAndRadii};

/// A rectangle of cells, from the first to before the last along both axes.
#[derive(Clone, Copy, Default)]
struct Rectangle {
    from: [usize; 2],
    to: [usize; 2],
}

impl Rectangle {
    fn size(&self) -> usize {
        (self.to[0] - self.from[0]) * (self.to[1] - self.from[1])
    }
}

/// The largest box of cells. All cells are equally large, so that their number is the measure.
pub(super) fn largest_box(cells: &Cells) -> Option<CentreAndRadii> {
    let [nx, ny, nz] = cells.counts;
    let mut best = (0, Rectangle::default(), [0, 0]);
    for bottom in 0..nz {
        let mut common = vec![true; nx * ny];
        for top in bottom..nz {
            for (number, common) in common.iter_mut().enumerate() {
                *common &= cells.has([number % nx, number / nx, top]);
            }
            let found = largest_rectangle(&common, nx);
            let size = found.size() * (top + 1 - bottom);
            if size > best.0 {
                best = (size, found, [bottom, top + 1]);
            }
            // Higher boxes have no larger base.
            if found.size() * (nz - bottom) <= best.0 {
                break;
            }
        }
    }
    let (size, Rectangle { from, to }, [bottom, top]) = best;
    let (from, to) = ([from[0], from[1], bottom], [to[0], to[1], top]);
    let centre = std::array::from_fn(|axis| cells.at(axis, from[axis] + to[axis]));
    let radii = std::array::from_fn(|axis| 0.5 * (to[axis] - from[axis]) as f64 * cells.step[axis]);
    (size > 0).then_some((centre, radii))
}

/// The largest rectangle of cells that are all inside, in rows of `nx`: in each row, the largest one below the columns of
/// cells that end there.
fn largest_rectangle(inside: &[bool], nx: usize) -> Rectangle {
    let mut best = Rectangle::default();
    let mut heights = vec![0; nx];
    // Columns that rise from left to right: where each begins, and its height.
    let mut open: Vec<(usize, usize)> = Vec::new();
    for (j, row) in inside.chunks(nx).enumerate() {
        for (height, &is_inside) in heights.iter_mut().zip(row) {
            *height = if is_inside { *height + 1 } else { 0 };
        }
        for i in 0..=nx {
            let height = heights.get(i).copied().unwrap_or(0);
            let mut from = i;
            while let Some(&(start, tall)) = open.last()
                && tall >= height
            {
                let found = Rectangle { from: [start, j + 1 - tall], to: [i, j + 1] };
                if found.size() > best.size() {
                    best = found;
                }
                from = start;
                open.pop();
            }
            if height > 0 {
                open.push((from, height));
            }
        }
        open.clear();
    }
    best
}
