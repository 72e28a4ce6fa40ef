//! What a leg does not reach of rows of a sphere.

use super::ends::{Numbers, RowEnds};
use super::scale::RowScale;
use super::{SheetRows, vectors};
use crate::chain::shell::{self, ArcHole, Shell};
use crate::chain::surface::Surface;
use crate::group::{Path, SubspaceKind};
use crate::manipulator::Manipulator;
use crate::manipulator::batch::lanes::{Column, LANES, Lane, Lanes};
use crate::manipulator::batch::{Batch, Block};
use crate::reach::{LegBranch, Reach};
use pulp::{Simd, WithSimd};
use std::f64::consts::TAU;

/// What a leg does not reach of some rows of a sphere.
#[derive(Clone, Debug)]
pub struct RowArcs {
    holes: Vec<RowHoles>,
    doubtful: Numbers,
}

/// One hole of each row.
#[derive(Clone, Debug)]
struct RowHoles {
    /// The poses that are certainly out of reach.
    certain: RowEnds,
    /// Those, and poses that rounding could move out of reach.
    possible: RowEnds,
}

impl RowArcs {
    /// Nothing.
    #[expect(clippy::new_without_default, reason = "it is working memory")]
    pub fn new() -> Self {
        Self { holes: Vec::new(), doubtful: [0; LANES] }
    }

    /// The poses of a row that are or may be out of reach, as ranges, in any order. Where a range is empty, that is between its
    /// pose and the one before, and something between them may be out of reach.
    pub fn holes(&self, row: usize) -> impl Iterator<Item = [i32; 2]> + Clone {
        self.holes.iter().map(move |hole| hole.possible.of(row))
    }

    /// Those of them that may be in reach, in any order.
    pub fn doubtful(&self, row: usize) -> impl Iterator<Item = i32> {
        let holes = self.holes.iter().filter(move |_| self.doubtful[row] != 0);
        let possible = holes.flat_map(move |hole| {
            let ([from, to], [first, after]) = (hole.possible.of(row), hole.certain.of(row));
            // Where nothing is certain, both parts meet.
            let (first, after) = if first < after { (first, after) } else { (to, to) };
            (from..first).chain(after..to)
        });
        let is_in = |pose: i32, [from, to]: [i32; 2]| from <= pose && pose < to;
        possible
            .filter(move |&pose| !self.holes.iter().any(|hole| is_in(pose, hole.certain.of(row))))
    }
}

impl Reach<'_> {
    /// Finds what a leg whose lower section moves in a sphere does not reach of some rows on a branch, whatever its limits of
    /// the first and the last joint. Returns whether the leg is one of which that is known.
    pub fn row_arcs(
        self,
        branch: &LegBranch,
        rows: &SheetRows<'_>,
        batch: &mut Batch,
        arcs: &mut RowArcs,
    ) -> bool {
        let Some(shell) = self.manipulator.legs[branch.leg].shell(branch.branches.lower) else {
            return false;
        };
        let Batch { arch, block, .. } = batch;
        arcs.holes.clear();
        arcs.doubtful = [0; LANES];
        arch.dispatch(FindArcs { manipulator: self.manipulator, branch, shell, rows, block, arcs });
        true
    }
}

/// Finds the arcs of rows.
struct FindArcs<'a> {
    manipulator: &'a Manipulator,
    branch: &'a LegBranch,
    shell: &'a Shell,
    rows: &'a SheetRows<'a>,
    block: &'a mut Block,
    arcs: &'a mut RowArcs,
}

impl WithSimd for FindArcs<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, branch, shell, rows, block, arcs } = self;
        let scale = block.start_rows(manipulator, branch, rows);
        let Path::Spherical { axis, .. } =
            manipulator.task().row(&SubspaceKind::Spherical.identity())
        else {
            return;
        };
        let (tolerance, margin) = (shell.tolerance(), scale.tie / scale.per_step);
        let lanes = vectors(rows.second.len());
        for cone in shell.cones() {
            let Surface::Cone { fixed, carried, cosine } = cone else { return };
            // The coefficients of a function of each row that is positive where the last axis is in the cone.
            let mut along = [Lanes::all(0.0); 3];
            let mut any = 0;
            for lane in 0..lanes {
                let path = Path::Spherical { start: Lane::load(&block.shifted, lane), axis };
                let function = Surface::Cone { fixed, carried, cosine }.along(&path).coefficients();
                any |= u64::from(shell::may_have_hole(function, tolerance));
                for (column, coefficient) in along.iter_mut().zip(function) {
                    column[lane] = coefficient;
                }
            }
            if any != 0 {
                let mut found =
                    HoleColumns { inner: [Lanes::all(0.0); 2], outer: [Lanes::all(0.0); 2] };
                for lane in 0..lanes {
                    let function = along.each_ref().map(|column| column[lane]);
                    found.set(lane, shell::hole(function, tolerance, margin), scale.first);
                }
                arcs.take(&found, &scale, lanes);
            }
        }
    }
}

impl RowArcs {
    /// Takes one hole of each row.
    #[inline(always)]
    fn take(&mut self, found: &HoleColumns, scale: &RowScale, lanes: usize) {
        let HoleColumns { inner, outer } = found;
        // A hole is shorter than a revolution.
        let copies = (scale.length / TAU) as usize + 2;
        for copy in 0..copies {
            let later = copy as f64 * TAU;
            let mut holes = RowHoles { certain: RowEnds::NONE, possible: RowEnds::NONE };
            let mut any = 0;
            for lane in 0..lanes {
                let is_hole = outer[0][lane] <= outer[1][lane];
                let certain = scale.inside([inner[0][lane] + later, inner[1][lane] + later]);
                let possible = scale.inside([outer[0][lane] + later, outer[1][lane] + later]);
                let possible = [
                    if is_hole { possible[0] } else { 0.0 },
                    if is_hole { possible[1] } else { 0.0 },
                ];
                holes.certain.set(lane, certain);
                holes.possible.set(lane, possible);
                let same = (certain[0] == possible[0]) & (certain[1] == possible[1]);
                let empty = possible[1] <= possible[0];
                self.doubtful[lane] |= i32::from(!(same | empty));
                any |= i32::from((possible[0] < scale.count) & (possible[1] > 0.0));
            }
            if any != 0 {
                self.holes.push(holes);
            }
        }
    }
}

/// One hole of each row.
struct HoleColumns {
    inner: [Column; 2],
    outer: [Column; 2],
}

impl HoleColumns {
    /// Stores a hole with the revolutions added that bring its end into the first one after `first`.
    #[inline(always)]
    fn set(&mut self, row: usize, ArcHole { inner, outer }: ArcHole, first: f64) {
        let by = -TAU * ((outer[1] - first) * TAU.recip()).floor();
        (self.inner[0][row], self.inner[1][row]) = (inner[0] + by, inner[1] + by);
        (self.outer[0][row], self.outer[1][row]) = (outer[0] + by, outer[1] + by);
    }
}
