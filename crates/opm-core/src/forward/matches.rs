//! The solutions of a leg at the pose of a candidate that have the given values of its actuated joints.
//!
//! A leg's lower section depends on the candidate by `v · exp(I τ)` alone. The search has solved for both, and finds
//! many candidates `b` for them: the lower section is solved once for all of these.

use super::accept::{APART, MATCH};
use super::search::Search;
use crate::chain::Branch;
use crate::chain::condition::length;
use crate::group::{Displacement, JointDisplacement, SubspaceKind};
use crate::manipulator::{
    ChainCoordinate, CompiledSection, LegBranches, LegSolution, LowerValues, Mode, Section,
};
use crate::numeric::Quantity;
use nalgebra::Complex;

/// The upper section gives τ to within this, in radians, where it is the τ that the search has solved for: rounding
/// far from a singularity.
const ROUNDING: f64 = 1e-13;

/// A solution of a leg.
pub(super) struct Match {
    /// The signs of its choices.
    pub mode: Mode,
    pub solution: LegSolution,
    /// The values of its lower joints.
    pub lower: LowerValues,
    /// The largest error of an actuated joint, in radians or shares of the size.
    error: f64,
}

/// The solutions of a leg that match.
pub(super) struct Matches {
    pub list: Vec<Match>,
    /// The smallest error of any solution, in radians or shares of the size.
    pub least: f64,
}

impl Matches {
    /// A buffer.
    pub fn new() -> Self {
        Self { list: Vec::with_capacity(4), least: f64::INFINITY }
    }

    /// Notes a solution, if its actuated joints have their values.
    #[inline(always)]
    fn note(&mut self, mode: Mode, found: &Found<'_>, error: f64) {
        self.least = self.least.min(error);
        if error <= MATCH {
            // Written in its place: to copy it takes as long as to find it.
            let lower = found.lower.values;
            self.list.push(Match { mode, solution: LegSolution::HOME, lower, error });
            if let Some(Match { solution, .. }) = self.list.last_mut() {
                solution.lower = found.lower.displacements;
                solution.upper = *found.upper;
                solution.tau = found.tau;
            }
        }
    }
}

/// A solution of a leg.
struct Found<'a> {
    lower: &'a SolvedLower,
    upper: &'a [JointDisplacement; 3],
    /// The displacement along the intersection motion.
    tau: JointDisplacement,
}

/// A solution of a leg's lower section.
#[derive(Clone, Copy)]
struct SolvedLower {
    displacements: [JointDisplacement; 3],
    tau: JointDisplacement,
    /// The same as numbers.
    values: LowerValues,
    /// The largest error of an actuated joint.
    error: f64,
}

/// The solutions of a leg's lower section at some `v` and τ that have the given values of its actuated joints.
pub(super) struct LowerSection {
    v: Displacement,
    /// Where the section has the imaginary joint, it gives τ.
    tau: Option<JointDisplacement>,
    /// The solution on each branch.
    branches: [Option<SolvedLower>; 2],
    /// The smallest error of the others, in radians or shares of the size.
    least: f64,
}

impl LowerSection {
    /// A buffer: its τ is none that is solved for.
    pub fn new() -> Self {
        let v = SubspaceKind::Identity.identity();
        let tau = Some(JointDisplacement::Value(f64::NAN));
        Self { v, tau, branches: [None; 2], least: f64::INFINITY }
    }

    /// The solutions, with their branches.
    fn solutions(&self) -> impl Iterator<Item = (Branch, &SolvedLower)> {
        let solved = Branch::BOTH.into_iter().zip(&self.branches);
        solved.filter_map(|(branch, solved)| Some((branch, solved.as_ref()?)))
    }
}

impl Search<'_> {
    /// Finds the solutions of a leg at a pose that have the given values of its actuated joints.
    #[inline(always)]
    pub(super) fn match_leg(
        &mut self,
        leg: usize,
        pose: [&Displacement; 2],
        rise: f64,
        found: &mut Matches,
    ) {
        found.list.clear();
        found.least = f64::INFINITY;
        let compiled = &self.held.legs[leg];
        if compiled.lean.is_some() {
            self.match_leaning(leg, pose, rise, found);
        } else if compiled.split_section == Section::Lower {
            self.match_lower_first(leg, pose, rise, found);
        } else {
            self.match_upper_first(leg, pose, rise, found);
        }
        if found.list.len() > 1 {
            self.keep_distinct(leg, &mut found.list);
        }
    }

    /// Tries every combination of branches of a leg whose sections depend on its own height.
    #[cold]
    #[inline(never)]
    fn match_leaning(&self, leg: usize, pose: [&Displacement; 2], rise: f64, found: &mut Matches) {
        let m = self.manipulator;
        for mode in m.leg_modes(leg) {
            let branches = m.branches(mode, leg);
            let solved = self.held.legs[leg].solve_seldom(m.task(), pose, rise, branches, 0.0);
            if let Ok(solution) = solved {
                let LegSolution { lower: displacements, upper, tau } = solution;
                let error = self.section_error(&self.held.legs[leg].lower, &displacements);
                let values = m.lower_values(leg, &displacements, tau);
                let lower = &SolvedLower { displacements, tau, values, error };
                let solution = Found { lower, upper: &upper, tau };
                found.note(m.leg_mode(leg, branches), &solution, self.error(leg, &solution, rise));
            }
        }
    }

    /// Tries the branches of a leg whose upper section gives τ.
    #[inline(always)]
    fn match_upper_first(
        &mut self,
        leg: usize,
        [v, b]: [&Displacement; 2],
        rise: f64,
        found: &mut Matches,
    ) {
        // A leg that closes has the τ that was solved for.
        if let Some(tau @ JointDisplacement::Direction(direction)) = self.taus[leg]
            && self.held.legs[leg].bridge().is_some()
            && let Some((upper, branch)) =
                self.held.legs[leg].upper.completed(b, direction, ROUNDING)
        {
            self.note_with_lower(leg, v, (branch, upper, tau), rise, found);
            if !found.list.is_empty() {
                return;
            }
        }
        // Near a singularity that is less certain. Another τ only tells by how much a leg that does not close is off.
        for expected in [true, false] {
            for &branch in self.held.legs[leg].upper.branches() {
                let compiled = &self.held.legs[leg];
                let Ok(upper) = compiled.upper.inverse(b, branch) else { continue };
                let tau = compiled.unwound(compiled.step(&upper), 0.0);
                let known = self.taus[leg].filter(|&known| comparable(known, tau));
                if expected != known.is_none_or(|known| agrees(known, tau, APART)) {
                    continue;
                }
                let exact = known.filter(|&known| agrees(known, tau, ROUNDING));
                let tau = exact.unwrap_or(tau);
                self.note_with_lower(leg, v, (branch, upper, tau), rise, found);
                // Another branch with this τ would be the same solution, at a singularity.
                if exact.is_some() && !found.list.is_empty() {
                    return;
                }
            }
            if !found.list.is_empty() {
                return;
            }
        }
    }

    /// Notes the solutions of a leg with one of its upper section, of which the branch, the displacements and τ are given.
    #[inline(always)]
    fn note_with_lower(
        &mut self,
        leg: usize,
        v: &Displacement,
        (branch, upper, tau): (Branch, [JointDisplacement; 3], JointDisplacement),
        rise: f64,
        found: &mut Matches,
    ) {
        self.solve_lower(leg, v, Some(tau));
        let [section, _] = &self.lowers[leg];
        found.least = found.least.min(section.least);
        for (lower_branch, lower) in section.solutions() {
            let solution = Found { lower, upper: &upper, tau };
            let branches = LegBranches { lower: lower_branch, upper: branch };
            let mode = self.manipulator.leg_mode(leg, branches);
            found.note(mode, &solution, self.error(leg, &solution, rise));
        }
    }

    /// Tries the branches of a leg whose lower section gives τ.
    #[inline(always)]
    fn match_lower_first(
        &mut self,
        leg: usize,
        [v, b]: [&Displacement; 2],
        rise: f64,
        found: &mut Matches,
    ) {
        self.solve_lower(leg, v, None);
        let (compiled, [section, _]) = (&self.held.legs[leg], &self.lowers[leg]);
        found.least = section.least;
        for (lower_branch, lower) in section.solutions() {
            // U = exp(−I τ) · b
            let step = lower.tau.inverse();
            let target = self.manipulator.task().upper_intersection.before(b, step);
            for &branch in compiled.upper.branches() {
                let Ok(upper) = compiled.upper.inverse(&target, branch) else { continue };
                let solution = Found { lower, upper: &upper, tau: lower.tau };
                let branches = LegBranches { lower: lower_branch, upper: branch };
                let mode = self.manipulator.leg_mode(leg, branches);
                found.note(mode, &solution, self.error(leg, &solution, rise));
            }
        }
    }

    /// Puts a leg's lower section first among those that are kept, and solves it, unless it is one of them. Most solutions
    /// already have other actuated joints, and are rejected before the rest is solved.
    #[inline(always)]
    fn solve_lower(&mut self, leg: usize, v: &Displacement, tau: Option<JointDisplacement>) {
        let same = |lower: &LowerSection| lower.tau == tau && lower.v == *v;
        if same(&self.lowers[leg][0]) {
            return;
        }
        self.lowers[leg].swap(0, 1);
        if !same(&self.lowers[leg][0]) {
            self.lowers[leg][0] = self.lower_section(leg, v, tau);
        }
    }

    #[inline(never)]
    fn lower_section(
        &self,
        leg: usize,
        v: &Displacement,
        tau: Option<JointDisplacement>,
    ) -> LowerSection {
        let compiled = &self.held.legs[leg];
        let lower = &compiled.lower;
        let along = &self.manipulator.task().lower_intersection;
        let target = tau.map_or(*v, |tau| along.after(v, tau));
        let mut section = LowerSection { v: *v, tau, branches: [None; 2], least: f64::INFINITY };
        for (solved, &branch) in section.branches.iter_mut().zip(lower.branches()) {
            let Ok(displacements) = lower.inverse(&target, branch) else { continue };
            let error = self.section_error(lower, &displacements);
            if error <= MATCH {
                // L · exp(I c) = v, with c the imaginary joint's displacement: τ = −c.
                let step = || compiled.unwound(compiled.step(&displacements), 0.0);
                let tau = tau.unwrap_or_else(|| step().inverse());
                let values = self.manipulator.lower_values(leg, &displacements, tau);
                *solved = Some(SolvedLower { displacements, tau, values, error });
            } else {
                section.least = section.least.min(error);
            }
        }
        section
    }

    /// The largest error of an actuated joint of a leg's solution.
    #[inline(always)]
    fn error(&self, leg: usize, found: &Found<'_>, rise: f64) -> f64 {
        let m = self.manipulator;
        let compiled = &m.legs[leg];
        let mut error = found.lower.error.max(self.section_error(&compiled.upper, found.upper));
        // All lifts have one height, unless each leg has its own.
        let lift = compiled.lift.filter(|lift| lift.slope != 0.0);
        if let Some((lift, actuated)) =
            lift.and_then(|lift| Some((lift, lift.coordinate.actuated?)))
        {
            let own = lift.rise(self.held.displacements[actuated]);
            let off = own - m.task().rise_of_leg(rise, found.tau);
            error = error.max(off.abs() / m.closure.size);
        }
        error
    }

    /// Of solutions that are the same near a singularity, keeps the one with the smallest error.
    #[inline(never)]
    fn keep_distinct(&self, leg: usize, found: &mut Vec<Match>) {
        found.sort_by(|a, b| a.error.total_cmp(&b.error));
        let mut kept = 0;
        for next in 0..found.len() {
            let same = |other: &Match| self.same(leg, &other.solution, &found[next].solution);
            if !found[..kept].iter().any(same) {
                found.swap(kept, next);
                kept += 1;
            }
        }
        found.truncate(kept);
    }

    /// The largest error of an actuated joint in one section, in radians or shares of the size.
    fn section_error(
        &self,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
    ) -> f64 {
        let mut error = 0.0_f64;
        if !section.driven {
            return error;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            if let Some(ChainCoordinate { number, actuated: Some(actuated), .. }) = *coordinate {
                let (value, direction) =
                    (self.held.displacements[actuated], self.directions[actuated]);
                error = error.max(self.distance(number, displacement, value, direction));
            }
        }
        error
    }

    /// Whether two solutions of a leg are the same, up to rounding near a singularity.
    fn same(&self, leg: usize, one: &LegSolution, other: &LegSolution) -> bool {
        let compiled = &self.manipulator.legs[leg];
        let sections = [
            (&compiled.lower, &one.lower, &other.lower),
            (&compiled.upper, &one.upper, &other.upper),
        ];
        sections.iter().all(|(section, one, other)| {
            section.coordinates.iter().zip(one.iter().zip(*other)).all(
                |(coordinate, (one, other))| {
                    let Some(coordinate) = coordinate else { return true };
                    self.distance(coordinate.number, *one, other.value(), other.unit_direction())
                        < APART
                },
            )
        })
    }

    /// The distance of a joint's displacement from a value, or from the direction of that angle: in radians
    /// or shares of the size.
    fn distance(
        &self,
        coordinate: usize,
        displacement: JointDisplacement,
        value: f64,
        direction: Complex<f64>,
    ) -> f64 {
        match displacement {
            JointDisplacement::Direction(_) => length(displacement.unit_direction() - direction),
            JointDisplacement::Value(given) => {
                match self.manipulator.coordinates()[coordinate].quantity {
                    Quantity::Angle => (given - value).abs(),
                    Quantity::Length => (given - value).abs() / self.manipulator.closure.size,
                }
            }
        }
    }
}

/// Whether two τ are angles that do not count full revolutions. Of others, a part may be in `v`.
fn comparable(known: JointDisplacement, tau: JointDisplacement) -> bool {
    matches!((known, tau), (JointDisplacement::Direction(_), JointDisplacement::Direction(_)))
}

/// Whether two angles are equal to within a small one, radians.
#[inline]
fn agrees(known: JointDisplacement, tau: JointDisplacement, within: f64) -> bool {
    match (known, tau) {
        (JointDisplacement::Direction(known), JointDisplacement::Direction(tau)) => {
            let difference = known.conj() * tau;
            difference.im.abs() <= within * difference.re
        }
        _ => false,
    }
}
