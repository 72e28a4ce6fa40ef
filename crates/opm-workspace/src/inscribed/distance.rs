//! The largest disc or ball with a free centre: an exact Euclidean distance transform finds where its centre can be, and
//! branch and bound on the distance where it is.

use super::cells::{Cells, CentreAndRadii};
use super::search::{Best, Search};

/// The largest disc or ball, and by how much its radius may be smaller than the largest.
pub(super) fn largest_ball(cells: &Cells) -> Option<(CentreAndRadii, f64)> {
    let dimension = cells.dimension();
    // One layer has no lattice across it.
    let counts: [usize; 3] = std::array::from_fn(|axis| match axis < dimension {
        true => 2 * cells.counts[axis] + 1,
        false => 1,
    });
    let mut squares = outside(cells, counts, dimension);
    let mut stride = 1;
    for (count, step) in counts.into_iter().zip(cells.step).take(dimension) {
        let mut line = Line::new(count, 0.5 * step);
        for first in 0..squares.len() {
            if first / stride % count == 0 {
                line.transform(&mut squares, first, stride);
            }
        }
        stride *= count;
    }
    let place = |number: usize| -> [f64; 3] {
        let at =
            [number % counts[0], number / counts[0] % counts[1], number / counts[0] / counts[1]];
        std::array::from_fn(|axis| if axis < dimension { cells.at(axis, at[axis]) } else { 0.0 })
    };
    let first = (0..squares.len()).max_by(|&a, &b| {
        // Of equal ones the first.
        squares[a].total_cmp(&squares[b]).then(b.cmp(&a))
    })?;
    let radius = squares[first].sqrt();
    if radius == 0.0 {
        return None;
    }
    let mut search = Search::new(cells, Best { centre: place(first), radius });
    // From a point of the lattice, a better centre is at most half of its steps away.
    let mut open: Vec<usize> =
        (0..squares.len()).filter(|&number| search.may_hold(squares[number].sqrt())).collect();
    open.sort_by(|&a, &b| squares[b].total_cmp(&squares[a]).then(a.cmp(&b)));
    for number in open {
        search.around(place(number), squares[number].sqrt());
    }
    let Best { centre, radius } = search.best;
    Some(((centre, [radius; 3]), search.short))
}

/// Zero at the points of the lattice that touch a cell outside, infinity elsewhere.
fn outside(cells: &Cells, counts: [usize; 3], dimension: usize) -> Vec<f64> {
    let mut squares = vec![f64::INFINITY; counts.iter().product()];
    let number = |[i, j, k]: [usize; 3]| (k * counts[1] + j) * counts[0] + i;
    let depth = |k: usize| if dimension == 3 { 2 * k..=2 * k + 2 } else { 0..=0 };
    for [i, j, k] in cells.outside() {
        for z in depth(k) {
            for y in 2 * j..=2 * j + 2 {
                for x in 2 * i..=2 * i + 2 {
                    squares[number([x, y, z])] = 0.0;
                }
            }
        }
    }
    for (number, square) in squares.iter_mut().enumerate() {
        let at =
            [number % counts[0], number / counts[0] % counts[1], number / counts[0] / counts[1]];
        if (0..dimension).any(|axis| at[axis] == 0 || at[axis] + 1 == counts[axis]) {
            *square = 0.0;
        }
    }
    squares
}

/// The transform of one line: the lower envelope of the parabolas `f(q) + (h (p - q))²`.
struct Line {
    values: Vec<f64>,
    step: f64,
    /// The vertices of the parabolas of the envelope.
    vertices: Vec<usize>,
    /// Where each of them begins.
    from: Vec<f64>,
}

impl Line {
    fn new(count: usize, step: f64) -> Self {
        Self { values: vec![0.0; count], step, vertices: Vec::new(), from: Vec::new() }
    }

    fn transform(&mut self, all: &mut [f64], first: usize, stride: usize) {
        let Self { values, step, vertices, from } = self;
        for (p, value) in values.iter_mut().enumerate() {
            *value = all[first + p * stride];
        }
        vertices.clear();
        from.clear();
        let square = *step * *step;
        for q in (0..values.len()).filter(|&q| values[q].is_finite()) {
            let mut begins = f64::NEG_INFINITY;
            while let (Some(&last), Some(&start)) = (vertices.last(), from.last()) {
                // Where the parabola of q comes below that of the last vertex.
                let (a, b) = (last as f64, q as f64);
                begins = 0.5 * ((values[q] - values[last]) / (square * (b - a)) + a + b);
                if begins > start {
                    break;
                }
                vertices.pop();
                from.pop();
                begins = f64::NEG_INFINITY;
            }
            vertices.push(q);
            from.push(begins);
        }
        if vertices.is_empty() {
            return;
        }
        let mut part = 0;
        for p in 0..values.len() {
            while part + 1 < vertices.len() && from[part + 1] < p as f64 {
                part += 1;
            }
            let off = vertices[part].abs_diff(p) as f64;
            all[first + p * stride] = values[vertices[part]] + square * off * off;
        }
    }
}
