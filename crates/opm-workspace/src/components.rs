//! Connected components of a set. Points that are neighbours along an axis belong together.
//!
//! Runs are joined, not points, in a [`Forest`].

use crate::forest::Forest;
use crate::set::{GridSet, SetAxis};
use crate::sweep::Run;

/// The connected components of a set, the largest first. Those of the same size are in the order of their
/// first points.
///
/// Two points are neighbours if they differ by one step along one axis. On an axis that comes full circle, a
/// step from the last value leads to the first.
///
/// ```
/// use opm_workspace::{Axis, Components, GridSet, SetAxis};
///
/// let axis = Axis::new("x", 0.0, 9.0, 10);
/// let set = GridSet::of(vec![SetAxis { axis, circle: false }], |number| number != 3)?;
/// let components = Components::new(&set);
/// assert_eq!(components.sizes(), [6, 3]);
/// // The points before the gap are component 1.
/// let (run, component) = components.runs().next().ok_or("no runs")?;
/// assert_eq!((run.from, run.to, component), (0, 3, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Components<'a> {
    set: &'a GridSet,
    /// The number of points of each component.
    sizes: Vec<u64>,
    /// The number of the component that each run of the set is in.
    of_runs: Vec<u32>,
}

impl<'a> Components<'a> {
    /// The components of a set.
    pub fn new(set: &'a GridSet) -> Self {
        let mut forest = joined(set);
        let mut sizes = vec![0; forest.len()];
        for row in 0..set.rows() {
            for (number, run) in set.span(row).zip(set.runs(row)) {
                sizes[forest.root(number)] += run.to - run.from;
            }
        }
        // The root of a component is its first run: a stable sort leaves ties in the order of the points.
        let mut roots: Vec<usize> = (0..sizes.len()).filter(|&run| sizes[run] > 0).collect();
        roots.sort_by_key(|&root| std::cmp::Reverse(sizes[root]));
        let mut of_runs = vec![0; sizes.len()];
        for (number, &root) in roots.iter().enumerate() {
            of_runs[root] = number as u32;
        }
        for run in 0..sizes.len() {
            of_runs[run] = of_runs[forest.root(run)];
        }
        Self { set, sizes: roots.into_iter().map(|root| sizes[root]).collect(), of_runs }
    }

    /// The number of points of each component, the largest first.
    pub fn sizes(&self) -> &[u64] {
        &self.sizes
    }

    /// The runs of the set, by the numbers of their points in the grid, ascending. Each comes with the
    /// number of its component, from 0 on.
    pub fn runs(&self) -> impl Iterator<Item = (Run, u32)> + '_ {
        (0..self.set.rows()).flat_map(move |row| {
            let first = row as u64 * self.set.row();
            let numbered = self.set.runs(row).iter().zip(self.set.span(row));
            numbered.map(move |(run, number)| {
                (Run { from: first + run.from, to: first + run.to }, self.of_runs[number])
            })
        })
    }
}

/// The runs of a set, of which neighbours are joined.
fn joined(set: &GridSet) -> Forest {
    let runs = set.span(set.rows().saturating_sub(1)).end;
    let mut forest = Forest::new(runs);
    let row_axis = set.varying().first().copied().unwrap_or(0);
    for row in 0..set.rows() {
        let span = set.span(row);
        if set.axes()[row_axis].circle
            && let [first, .., last] = set.runs(row)
            && first.from == 0
            && last.to == set.row()
        {
            forest.join(span.start, span.end - 1);
        }
        let mut stride = 1;
        for SetAxis { axis, circle } in &set.axes()[row_axis + 1..] {
            let (count, number) = (axis.count as usize, row / stride % axis.count as usize);
            if number > 0 {
                join_rows(set, &mut forest, row, row - stride);
            }
            if *circle && number + 1 == count {
                join_rows(set, &mut forest, row, row - number * stride);
            }
            stride *= count;
        }
    }
    forest
}

/// Joins the runs of two neighbouring rows that overlap.
fn join_rows(set: &GridSet, forest: &mut Forest, a: usize, b: usize) {
    let (first_a, first_b) = (set.span(a).start, set.span(b).start);
    let (runs_a, runs_b) = (set.runs(a), set.runs(b));
    let (mut i, mut j) = (0, 0);
    while i < runs_a.len() && j < runs_b.len() {
        if runs_a[i].from < runs_b[j].to && runs_b[j].from < runs_a[i].to {
            forest.join(first_a + i, first_b + j);
        }
        if runs_a[i].to < runs_b[j].to { i += 1 } else { j += 1 }
    }
}
