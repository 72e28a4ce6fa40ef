//! Singularity curves in a plane: marching squares on the parallel measures, with every point of a line found by
//! bisection.
//!
//! W. E. Lorensen, H. E. Cline, *Marching cubes*, SIGGRAPH 1987, in the plane. Where a curve passes a line of the grid is
//! found to rounding; between two such points it is a straight line. A curve that passes no line of the grid between
//! two poses in reach, or passes the line between two neighbours twice, is not seen.

use super::levels::Levels;
use crate::ordered::in_order;
use crate::progress::{Cancelled, Progress};
use crate::set::GridSet;
use opm_core::manipulator::{Manipulator, Mode};
use std::collections::{BTreeMap, BTreeSet};

/// Bisections of the step between two neighbours: to the rounding of its length.
const HALVINGS: u32 = 52;

/// The curves of parallel singularities in a plane, or in one slice of a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct SingularCurves {
    /// The number of the value on the third axis that has several values; `None` if there are only two.
    pub slice: Option<u64>,
    /// Polylines in the first two axes that have several values, radians and metres. The last point of a closed one is its
    /// first one again.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// The curves of parallel singularities among a set of poses, which are in reach in this mode, in the first two axes that
/// have several values. If a third axis has several values, there are curves for each of them. `None` if fewer than two axes
/// or more than three have several values.
///
/// # Errors
/// [`Cancelled`] if [`Progress::cancel`] was called.
///
/// ```
/// use opm_workspace::opm_core::Manipulator;
/// use opm_workspace::{Axis, Grid, GridSet, Modes, Progress, Sweep, singular_curves};
///
/// let manipulator = Manipulator::example("five-bar")?;
/// let axes = vec![Axis::new("x", -0.4, 0.4, 81), Axis::new("y", -0.4, 0.0, 41)];
/// let (grid, mode) = (Grid::new(&manipulator, axes)?, manipulator.home_mode());
/// let sweep = Sweep::new(&manipulator, &grid, Modes::One(mode));
/// let set = GridSet::reached(&sweep, &Progress::default())?;
/// let curves = singular_curves(&manipulator, mode, &set, &Progress::default())?;
/// let curves = &curves.ok_or("not a plane set")?[0];
/// println!("{} curves", curves.lines.len());
/// # assert!(curves.lines.iter().all(|line| line.len() > 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn singular_curves(
    manipulator: &Manipulator,
    mode: Mode,
    set: &GridSet,
    progress: &Progress,
) -> Result<Option<Vec<SingularCurves>>, Cancelled> {
    let axes = set.varying();
    let ([x, y] | [x, y, _]) = axes[..] else { return Ok(None) };
    let high = set.axes()[y].axis.count as usize;
    let third = axes.len() > 2;
    let mut all = vec![];
    in_order(
        (0..set.rows() / high).map(Ok),
        || Levels::new(manipulator, mode),
        |levels, slice| {
            let mut plane = Plane { levels, set, view: [x, y], first: slice * high, high };
            let lines = plane.curves(progress)?;
            Ok(SingularCurves { slice: third.then_some(slice as u64), lines })
        },
        |curves| {
            all.push(curves);
            Ok::<(), Cancelled>(())
        },
    )?;
    Ok(Some(all))
}

/// The line between two neighbours: the place of the first, and the number of the axis in which the second is one further.
type Edge = (usize, usize, usize);

/// One slice of a set.
struct Plane<'p, 'a> {
    levels: &'p mut Levels<'a>,
    set: &'p GridSet,
    /// The numbers of the two axes that are seen.
    view: [usize; 2],
    /// The number of its first row.
    first: usize,
    /// The number of its rows.
    high: usize,
}

impl Plane<'_, '_> {
    fn curves(&mut self, progress: &Progress) -> Result<Vec<Vec<[f64; 2]>>, Cancelled> {
        let count = self.levels.parallel();
        let mut below: Vec<Option<Vec<f64>>> = vec![];
        let mut links: Vec<BTreeMap<Edge, Vec<Edge>>> = vec![BTreeMap::new(); count];
        for row in 0..self.high {
            let above = self.row(row);
            progress.advance(0)?;
            for i in 0..above.len().saturating_sub(1) {
                let corners =
                    below.get(i).zip(below.get(i + 1)).zip(Some((&above[i + 1], &above[i])));
                let Some(((Some(a), Some(b)), (Some(c), Some(d)))) = corners else { continue };
                for (number, links) in links.iter_mut().enumerate() {
                    let signs = [a, b, c, d].map(|levels| levels[number] > 0.0);
                    for [from, to] in self.cell(number, (i, row - 1), signs) {
                        links.entry(from).or_default().push(to);
                        links.entry(to).or_default().push(from);
                    }
                }
            }
            below = above;
        }
        let mut lines = vec![];
        for (number, links) in links.iter().enumerate() {
            for edges in chains(links) {
                let points = edges.iter().map(|edge| self.point(number, *edge));
                // A line ends where the way between two neighbours leaves the reach.
                let points: Vec<Option<[f64; 2]>> = points.collect();
                let parts = points.split(Option::is_none).filter(|part| part.len() > 1);
                lines.extend(parts.map(|part| part.iter().flatten().copied().collect()));
            }
        }
        Ok(lines)
    }

    /// The parallel measures of each pose of a row; `None` where it is not in the set.
    fn row(&mut self, row: usize) -> Vec<Option<Vec<f64>>> {
        let number = self.first + row;
        let mut found = vec![None; self.set.row() as usize];
        let mut values = vec![];
        for run in self.set.runs(number) {
            for place in run.from..run.to {
                let pose = self.set.point(number as u64 * self.set.row() + place);
                if self.levels.at(&pose, &mut values) {
                    found[place as usize] = Some(values[..self.levels.parallel()].to_vec());
                }
            }
        }
        found
    }

    /// The pieces of a curve in a cell, whose corners have these signs: at its place, to the right of that, diagonally
    /// across, and above it.
    fn cell(
        &mut self,
        number: usize,
        (i, j): (usize, usize),
        [a, b, c, d]: [bool; 4],
    ) -> Vec<[Edge; 2]> {
        let [bottom, right, top, left] = [(i, j, 0), (i + 1, j, 1), (i, j + 1, 0), (i, j, 1)];
        let sides = [(a != b, bottom), (b != c, right), (d != c, top), (a != d, left)];
        let crossed = sides.into_iter().filter(|side| side.0).map(|side| side.1);
        let crossed: Vec<Edge> = crossed.collect();
        match crossed[..] {
            [from, to] => vec![[from, to]],
            [..] if crossed.is_empty() => vec![],
            // All four: the middle of the cell tells which corners belong together.
            _ if self.middle(number, (i, j)).is_none_or(|middle| middle == a) => {
                vec![[bottom, right], [top, left]]
            }
            _ => vec![[left, bottom], [right, top]],
        }
    }

    /// The sign of a measure in the middle of a cell, if that is in reach.
    fn middle(&mut self, number: usize, (i, j): (usize, usize)) -> Option<bool> {
        let pose = self.between((i, j), [0.5, 0.5]);
        let mut values = vec![];
        self.levels.at(&pose, &mut values).then(|| values[number] > 0.0)
    }

    /// Where a measure is zero between two neighbours, on both axes; `None` if a pose in between is out of reach.
    fn point(&mut self, number: usize, (i, j, axis): Edge) -> Option<[f64; 2]> {
        let mut values = vec![];
        let mut at = |plane: &mut Self, share: f64| {
            let mut shares = [0.0; 2];
            shares[axis] = share;
            let pose = plane.between((i, j), shares);
            let place = plane.view.map(|view| pose[view]);
            plane.levels.at(&pose, &mut values).then(|| (values[number] > 0.0, place))
        };
        let first = at(self, 0.0)?.0;
        let [mut low, mut high] = [0.0, 1.0];
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if at(self, middle)?.0 == first { low = middle } else { high = middle }
        }
        Some(at(self, 0.5 * (low + high))?.1)
    }

    /// The pose at a share of the steps from one pose of the grid to the next, on both axes.
    fn between(&self, (i, j): (usize, usize), shares: [f64; 2]) -> Vec<f64> {
        let number = |i: usize, j: usize| (self.first + j) as u64 * self.set.row() + i as u64;
        let mut pose = self.set.point(number(i, j));
        let places = [i, j];
        for ((&view, share), place) in self.view.iter().zip(shares).zip(places) {
            let axis = &self.set.axes()[view].axis;
            if share > 0.0 {
                let next = axis.value(place as u64 + 1);
                pose[view] = pose[view] * (1.0 - share) + next * share;
            }
        }
        pose
    }
}

/// The chains that links make, open ones first. The last edge of a closed one is its first.
fn chains(links: &BTreeMap<Edge, Vec<Edge>>) -> Vec<Vec<Edge>> {
    let mut seen: BTreeSet<Edge> = BTreeSet::new();
    let mut chains = vec![];
    let ends = links.iter().filter(|(_, others)| others.len() == 1).map(|(edge, _)| *edge);
    for start in ends.chain(links.keys().copied()) {
        if !seen.insert(start) {
            continue;
        }
        let mut chain = vec![start];
        while let Some(next) =
            links[&chain[chain.len() - 1]].iter().find(|next| !seen.contains(next))
        {
            seen.insert(*next);
            chain.push(*next);
        }
        if chain.len() > 2 && links[&chain[chain.len() - 1]].contains(&start) {
            chain.push(start);
        }
        chains.push(chain);
    }
    chains
}
