//! Near which poses of rows a leg's feasibility may change.

use super::scale::RowScale;
use super::{SheetRows, vectors};
use crate::chain::surface::{Surface, Uncertainty};
use crate::group::{Displacement, Path, PlanarPath, SubspaceKind};
use crate::manipulator::Manipulator;
use crate::manipulator::batch::lanes::{Displacements, LANES, Lane, Lanes};
use crate::manipulator::batch::{Batch, Block};
use crate::mechanism::leg::Section;
use crate::reach::{LegBranch, Reach, Transitions};
use pulp::{Simd, WithSimd};

/// For each of some rows, the numbers of poses near which a leg's feasibility may change: from the first one up to, not
/// including, the other one. Where the two are equal, that is between this pose and the one before.
#[derive(Clone, Debug)]
pub struct RowEnds {
    first: Numbers,
    after: Numbers,
}

/// One number of a pose for each row.
pub type Numbers = [i32; LANES];

/// A number of a pose plus this has the number in its last bits.
const WHOLE: f64 = 4503599627370496.0;

impl RowEnds {
    pub(super) const NONE: Self = Self { first: [0; LANES], after: [0; LANES] };

    /// All of so many poses of every row.
    pub fn everything(count: u64) -> Self {
        Self { first: [0; LANES], after: [count as i32; LANES] }
    }

    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, [first, after]: [f64; 2]) {
        self.first[row] = (first + WHOLE).to_bits() as i32;
        self.after[row] = (after + WHOLE).to_bits() as i32;
    }

    /// The numbers of a row.
    #[inline(always)]
    pub fn of(&self, row: usize) -> [i32; 2] {
        [self.first[row], self.after[row]]
    }

    /// Marks the rows of which they cut what is left: the poses `from` up to, not including, `to` of each row.
    #[inline]
    pub fn meet(&self, from: &Numbers, to: &Numbers, marks: &mut Numbers) {
        for row in 0..LANES {
            let cuts = (self.first[row] < to[row]) & (self.after[row] > from[row]);
            marks[row] |= i32::from(cuts);
        }
    }
}

impl Reach<'_> {
    /// Finds the poses of some rows near which a leg's feasibility may change. Between them,
    /// [`Reach::reaches`] is the same for all poses of a row. With `outer` being false, that is so only among poses
    /// of a convex set of the plane in which the leg closes but for a hole, be it within its limits or not, or of one of
    /// the intervals that [`RowArcs`](super::RowArcs) leave of a row on a sphere.
    pub fn row_ends(
        self,
        branch: &LegBranch,
        transitions: &Transitions,
        rows: &SheetRows<'_>,
        outer: bool,
        batch: &mut Batch,
        ends: &mut Vec<RowEnds>,
    ) {
        let Batch { arch, block, .. } = batch;
        ends.clear();
        arch.dispatch(FindEnds {
            manipulator: self.manipulator,
            branch,
            transitions,
            rows,
            outer,
            block,
            ends,
        });
    }
}

/// Finds the ends of rows.
struct FindEnds<'a> {
    manipulator: &'a Manipulator,
    branch: &'a LegBranch,
    transitions: &'a Transitions,
    rows: &'a SheetRows<'a>,
    outer: bool,
    block: &'a mut Block,
    ends: &'a mut Vec<RowEnds>,
}

impl WithSimd for FindEnds<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { manipulator, branch, transitions, rows, outer, block, ends } = self;
        let scale = block.start_rows(manipulator, branch, rows);
        let starts = &block.shifted;
        let kind = manipulator.task().form(Section::Lower).kind;
        let path = |lane| manipulator.task().row(&load(kind, starts, lane));
        let reach = scale.first.abs().max((scale.first + scale.length).abs()) + rows.step;
        // The size is a convex function of the second coordinate.
        let size = [0, rows.second.len().saturating_sub(1)].map(|row| path(row).size(reach));
        let size = size[0].max(size[1]);
        let lanes = vectors(rows.second.len());
        let finder = Finder { path: path(0), starts, lanes, scale };
        if !transitions.are_complete(size) {
            return ends.push(RowEnds::everything(rows.count));
        }
        for (surface, blur) in transitions.surfaces(outer) {
            let uncertainty = Uncertainty { size: transitions.size() + size, blur };
            finder.find(surface, surface.tolerance(uncertainty), ends);
        }
    }
}

/// Finds the ends of rows that differ in where their paths start.
struct Finder<'a> {
    /// The path of any of the rows.
    path: Path,
    starts: &'a Displacements,
    /// The number of rows, or more.
    lanes: usize,
    scale: RowScale,
}

impl Finder<'_> {
    /// Finds where the rows meet a surface.
    #[inline(always)]
    fn find(&self, surface: &Surface, tolerance: f64, ends: &mut Vec<RowEnds>) {
        // With a constant kind of path and of surface, the loop over the rows has no branches.
        macro_rules! each {
            ($start:ident => $path:expr, $surface:expr) => {{
                let surface = $surface;
                let function = |$start| surface.along(&$path);
                // It is the same for all rows.
                let first = function(Lane::load(self.starts, 0));
                let Some(repeats) = self.scale.repeats(first.period()) else {
                    return ends.push(RowEnds::everything(self.scale.count as u64));
                };
                let lanes = self.lanes.min(LANES);
                let mut along = [Lanes::all(0.0); 3];
                let mut any = 0;
                for lane in 0..lanes {
                    let $start = Lane::load(self.starts, lane);
                    let function = surface.along(&$path);
                    any |= u64::from(function.may_be_zero(tolerance));
                    for (column, coefficient) in along.iter_mut().zip(function.coefficients()) {
                        column[lane] = coefficient;
                    }
                }
                if any == 0 {
                    return;
                }
                for copy in 0..repeats.copies {
                    let (mut near, mut far) = (RowEnds::NONE, RowEnds::NONE);
                    let shift = repeats.shift(copy);
                    for lane in 0..lanes {
                        let function = first.with(along.each_ref().map(|column| column[lane]));
                        let [first, second] = function.near_zeros(tolerance);
                        near.set(lane, self.scale.poses(shift.of(first)));
                        far.set(lane, self.scale.poses(shift.of(second)));
                    }
                    ends.extend([near, far]);
                }
            }};
        }
        match (self.path, *surface) {
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Circle { point, centre, square },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Circle { point, centre, square }
            ),
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Line { point, across, at },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Line { point, across, at }
            ),
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Carried { point, across, at },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Carried { point, across, at }
            ),
            (
                Path::Planar(PlanarPath::Translation { rate, .. }),
                Surface::Rotation { rotation },
            ) => each!(
                start => Path::Planar(PlanarPath::Translation { start, rate }),
                Surface::Rotation { rotation }
            ),
            (Path::Spherical { axis, .. }, Surface::Cone { fixed, carried, cosine }) => each!(
                start => Path::Spherical { start, axis },
                Surface::Cone { fixed, carried, cosine }
            ),
            (
                Path::Cylindrical { rate, .. },
                Surface::Coaxial { rotation, advance, at, period: None },
            ) => each!(
                start => Path::Cylindrical { start, rate },
                Surface::Coaxial { rotation, advance, at, period: None }
            ),
            (
                Path::Cylindrical { rate, .. },
                Surface::Coaxial { rotation, advance, at, period: Some(period) },
            ) => each!(
                start => Path::Cylindrical { start, rate },
                Surface::Coaxial { rotation, advance, at, period: Some(period) }
            ),
            (Path::Translational { rate, .. }, Surface::Band { across, at }) => {
                each!(start => Path::Translational { start, rate }, Surface::Band { across, at });
            }
            (Path::Spatial { rate, .. }, Surface::Slab { across, at }) => {
                each!(start => Path::Spatial { start, rate }, Surface::Slab { across, at });
            }
            (path, surface) => panic!("no rows along {path:?} meet {surface:?}"),
        }
    }
}

/// The share of a period before a row's first pose in which an interval that reaches into the row may begin.
const SLACK: f64 = 0.25;

/// How often the zeros of a function are repeated in a row.
#[derive(Clone, Copy)]
struct Repeats {
    /// How many repetitions of an interval there can be.
    copies: usize,
    /// The period; `None` where nothing is repeated.
    period: Option<f64>,
    /// Where the first one begins at the earliest.
    from: f64,
}

/// What brings an interval to a place in a row.
#[derive(Clone, Copy)]
struct Shift {
    repeats: Repeats,
    /// The number of repetitions after the first.
    copy: f64,
    /// The number of periods in a unit.
    per_period: f64,
}

impl RowScale {
    /// How often a function with this period is repeated; `None` where that is within two poses.
    fn repeats(&self, period: Option<f64>) -> Option<Repeats> {
        let Some(period) = period.filter(|period| period.is_finite()) else {
            return Some(Repeats { copies: 1, period: None, from: 0.0 });
        };
        let copies = (self.length / period + SLACK) as usize + 1;
        let repeats = Repeats { copies, period: Some(period), from: self.first - SLACK * period };
        (period * self.per_step > 2.0).then_some(repeats)
    }
}

impl Repeats {
    fn shift(self, copy: usize) -> Shift {
        let per_period = self.period.unwrap_or(f64::INFINITY).recip();
        Shift { repeats: self, copy: copy as f64, per_period }
    }
}

impl Shift {
    /// The interval shifted by whole periods. One that is longer than the slack becomes everything, and an empty one stays
    /// so.
    #[inline(always)]
    fn of(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        let Some(period) = self.repeats.period else { return [from, to] };
        let by = period * (self.copy - ((from - self.repeats.from) * self.per_period).floor());
        let fits = to - from <= SLACK * period;
        let (least, most) = (f64::NEG_INFINITY, f64::INFINITY);
        let shifted = [if fits { from + by } else { least }, if fits { to + by } else { most }];
        let empty = to < from;
        [if empty { most } else { shifted[0] }, if empty { least } else { shifted[1] }]
    }
}

/// The displacement of pose number `lane`, in a subspace of this kind.
fn load(kind: SubspaceKind, from: &Displacements, lane: usize) -> Displacement {
    match kind {
        SubspaceKind::Identity => kind.identity(),
        SubspaceKind::Planar => Displacement::Planar(Lane::load(from, lane)),
        SubspaceKind::Spherical => Displacement::Spherical(Lane::load(from, lane)),
        SubspaceKind::Cylindrical => Displacement::Cylindrical(Lane::load(from, lane)),
        SubspaceKind::TranslationalPlane => Displacement::Translational(Lane::load(from, lane)),
        SubspaceKind::TranslationalSpace => Displacement::Spatial(Lane::load(from, lane)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::scale::TIE;
    use super::*;
    use crate::chain::equation::Equation;
    use proptest::prelude::*;
    use std::f64::consts::TAU;

    const TOLERANCE: f64 = 1e-10;

    fn value(equation: &Equation, t: f64) -> f64 {
        match *equation {
            Equation::Polynomial([c0, c1, c2]) => c0 + t * (c1 + t * c2),
            Equation::Harmonic([c0, c1, c2]) => c0 + c1 * t.cos() + c2 * t.sin(),
            Equation::Periodic([c0, c1], period) => {
                let value = c0 + c1 * t;
                value - period * (value / period).round()
            }
        }
    }

    /// The poses of a row near the zeros of a function.
    fn ends(equation: &Equation, scale: &RowScale) -> Vec<[f64; 2]> {
        let Some(repeats) = scale.repeats(equation.period()) else {
            return vec![[0.0, scale.count]];
        };
        let zeros = equation.near_zeros(TOLERANCE);
        let copies = (0..repeats.copies).map(|copy| repeats.shift(copy));
        copies.flat_map(|shift| zeros.map(|zero| scale.poses(shift.of(zero)))).collect()
    }

    fn row(first: f64, length: f64, count: u32) -> RowScale {
        let step = length / f64::from(count - 1);
        let count = f64::from(count);
        RowScale { first, per_step: step.recip(), length, count, tie: TIE }
    }

    /// Between two ends a function keeps its sign, and only poses at its zeros are near an end.
    fn check(equation: &Equation, scale: &RowScale) {
        let ends = ends(equation, scale);
        let near = |pose: f64| ends.iter().any(|&[first, after]| first <= pose && pose < after);
        let cut = |pose: f64| ends.iter().any(|&[first, after]| first == pose || after == pose);
        let at = |pose: f64| value(equation, scale.first + pose / scale.per_step);
        let mut alone = 0;
        for number in 0..scale.count as u32 {
            let pose = f64::from(number);
            if near(pose) {
                alone += 1;
            } else if number > 0 && !near(pose - 1.0) && !cut(pose) {
                // A periodic line jumps where it is farthest from its zeros.
                let jumps = matches!(equation, Equation::Periodic(_, period)
                    if (at(pose) - at(pose - 1.0)).abs() > 0.5 * period);
                assert!(jumps || at(pose) * at(pose - 1.0) > 0.0, "{equation:?} at {pose}");
            }
        }
        assert!(alone <= 4, "{alone} poses of {equation:?} are asked for one by one: {ends:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(20_000))]

        #[test]
        fn ends_are_where_signs_change(
            c in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0], first in -7.0..7.0_f64,
            length in 0.1..7.0_f64, count in 2..70_u32,
        ) {
            let scale = row(first, length, count);
            for equation in [
                Equation::Polynomial([c[0], c[1], c[2].abs() + 0.1]),
                Equation::Polynomial([c[0], c[1], 0.0]),
                Equation::Harmonic(c),
                Equation::Periodic([c[0], c[1]], 20.0),
            ] {
                check(&equation, &scale);
            }
        }
    }

    /// What has no zeros cuts nothing, not even a row of a full revolution; what is zero everywhere is asked for.
    #[test]
    fn constants_cut_nothing_or_everything() {
        let scale = row(-TAU / 2.0, TAU, 33);
        for c0 in [-1.1, -0.1, 0.1, 1.1] {
            for equation in [
                Equation::Polynomial([c0, 0.0, 0.0]),
                Equation::Polynomial([1.0, c0, 1.0]),
                Equation::Harmonic([c0, 0.0, 0.0]),
                Equation::Harmonic([c0 * 11.0, 0.6, -0.8]),
                Equation::Periodic([c0, 0.0], 3.0),
            ] {
                assert!(ends(&equation, &scale).iter().all(|end| end[0] == end[1]), "{equation:?}");
            }
        }
        for equation in [
            Equation::Polynomial([0.0; 3]),
            Equation::Harmonic([0.0; 3]),
            Equation::Periodic([3.0, 0.0], 3.0),
        ] {
            assert!(ends(&equation, &scale).contains(&[0.0, 33.0]), "{equation:?}");
        }
    }

    /// Zeros on poses, and two zeros that meet on one.
    #[test]
    fn a_pose_at_a_zero_is_asked_for() {
        let scale = row(-1.0, 2.0, 9);
        for (equation, pose) in [
            (Equation::Polynomial([0.0, 1.0, 0.0]), 4.0),
            (Equation::Polynomial([0.25, 1.0, 1.0]), 2.0),
            (Equation::Polynomial([-0.25, 0.0, 1.0]), 6.0),
            (Equation::Harmonic([-1.0, 1.0, 0.0]), 4.0),
            (Equation::Harmonic([0.0, 0.0, 1.0]), 4.0),
            (Equation::Periodic([5.5, 1.0], 5.0), 2.0),
        ] {
            let ends = ends(&equation, &scale);
            assert!(
                ends.iter().any(|end| end[0] <= pose && pose < end[1]),
                "{equation:?}: {ends:?}"
            );
        }
    }
}
