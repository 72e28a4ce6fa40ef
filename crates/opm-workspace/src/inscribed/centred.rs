//! The largest ball and the largest box about a given centre. Both are exact for the union of the cells that are inside.

use super::cells::{Cells, CentreAndRadii};

/// The distances from the centre to the nearer ends of the grid; infinite across a layer alone.
fn ends(cells: &Cells, centre: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let [low, high] = cells.ends[axis];
        (centre[axis] - low).min(high - centre[axis])
    })
}

fn in_space(at: &[f64]) -> [f64; 3] {
    std::array::from_fn(|axis| at.get(axis).copied().unwrap_or_default())
}

/// The largest disc or ball about a centre; `None` where that is not inside.
pub(super) fn ball(cells: &Cells, at: &[f64]) -> Option<CentreAndRadii> {
    let centre = in_space(at);
    let to_end = ends(cells, centre).into_iter().fold(f64::INFINITY, f64::min);
    let radius = cells.outside().fold(to_end, |least, cell| {
        let gap = |axis: usize| cells.gap(axis, centre[axis], cell[axis]);
        least.min(gap(0).hypot(gap(1)).hypot(gap(2)))
    });
    (radius > 0.0).then_some((centre, [radius; 3]))
}

/// The largest box about a centre; `None` where that is not inside.
///
/// A box of half sides `h` is inside if no cell outside has a gap below `h` along all axes. In a largest box, each half
/// side is such a gap, or ends with the grid: for each pair of gaps along the last two axes, the first one follows.
pub(super) fn cuboid(cells: &Cells, at: &[f64]) -> Option<CentreAndRadii> {
    let centre = in_space(at);
    let ends = ends(cells, centre);
    if ends.iter().any(|&end| end <= 0.0) {
        return None;
    }
    let gap = |cell: [usize; 3], axis: usize| cells.gap(axis, centre[axis], cell[axis]);
    let mut gaps: Vec<[f64; 3]> =
        cells.outside().map(|cell| [0, 1, 2].map(|axis| gap(cell, axis))).collect();
    gaps.sort_by(|a, b| a[1].total_cmp(&b[1]));
    let mut depths: Vec<f64> = gaps.iter().map(|gap| gap[2]).filter(|&z| z > 0.0).collect();
    depths.push(ends[2]);
    depths.retain(|&z| z <= ends[2]);
    depths.sort_by(f64::total_cmp);
    depths.dedup();
    let mut best = (0.0, [0.0; 3]);
    for depth in depths {
        let weight = if depth.is_finite() { depth } else { 1.0 };
        let mut width = ends[0];
        let mut take = |radii: [f64; 3]| {
            let size = radii[0] * radii[1] * weight;
            if size > best.0 {
                best = (size, radii);
            }
        };
        for gap in gaps.iter().filter(|gap| gap[2] < depth) {
            // With this height, none of the cells from here on is in the way.
            take([width, gap[1].min(ends[1]), depth]);
            width = width.min(gap[0]);
        }
        take([width, ends[1], depth]);
    }
    let (size, radii) = best;
    (size > 0.0).then_some((centre, radii))
}
