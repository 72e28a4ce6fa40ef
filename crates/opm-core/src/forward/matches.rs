//! The choices with which a leg may close at a candidate, its actuated joints at the given values.
//!
//! A leg's lower section depends on the candidate by `v · exp(I τ)` alone. The search has solved for both, and finds
//! many candidates `b` for them: the lower section is solved once for all of these.

use super::accept::{APART, MATCH};
use super::search::Search;
use crate::chain::Branch;
use crate::chain::condition::length;
use crate::group::{Displacement, JointDisplacement, SubspaceKind};
use crate::manipulator::{
    ChainCoordinate, CompiledSection, LegBranches, LegSolution, Mode, Section,
};
use crate::numeric::Quantity;
use nalgebra::Complex;

/// The upper section gives τ to within this, in radians, where it is the τ that the search has solved for: rounding
/// far from a singularity.
const ROUNDING: f64 = 1e-13;

/// The choices with which a leg closes.
#[derive(Clone, Debug)]
pub(super) struct Matches {
    /// Each as a mode with plus for all other choices.
    pub list: Vec<Mode>,
}

impl Matches {
    /// A buffer.
    pub fn new() -> Self {
        Self { list: Vec::with_capacity(4) }
    }

    /// Notes choices, if the actuated joints then have their values.
    #[inline(always)]
    fn note(&mut self, mode: Mode, error: f64) {
        if error <= MATCH {
            self.list.push(mode);
        }
    }
}

/// The solutions of a leg's lower section at some `v` and τ that have the given values of its actuated joints.
#[derive(Clone, Debug)]
pub(super) struct LowerSection {
    v: Displacement,
    /// Where the section has the imaginary joint, it gives τ.
    tau: Option<JointDisplacement>,
    /// The τ of the solution on each branch.
    branches: [Option<JointDisplacement>; 2],
}

impl LowerSection {
    /// A buffer: its τ is none that is solved for.
    pub fn new() -> Self {
        let v = SubspaceKind::Identity.identity();
        let tau = Some(JointDisplacement::Value(f64::NAN));
        Self { v, tau, branches: [None; 2] }
    }

    /// The branches of the solutions, with their τ.
    #[inline(always)]
    fn solutions(&self) -> impl Iterator<Item = (Branch, JointDisplacement)> {
        let solved = Branch::BOTH.into_iter().zip(self.branches);
        solved.filter_map(|(branch, tau)| Some((branch, tau?)))
    }
}

/// What is known of a leg at all candidates with one `v` and one τ of each leg.
#[derive(Clone, Debug)]
pub(super) enum KnownLeg {
    /// It closes with these choices at each.
    Closed([Option<Mode>; 2]),
    /// Its upper section closes with this rotation of its first joint, τ, on one branch. `plus` are the choices of the lower
    /// section; `minus` is added to each where the upper section is on the branch minus.
    Rotated { tau: Complex<f64>, plus: [Option<Mode>; 2], minus: Mode },
    /// Nothing.
    Open,
}

impl Search<'_> {
    /// Finds out what is known of the legs at the candidates `v · b`, whatever `b`.
    pub(super) fn know_legs(&mut self, v: &Displacement) {
        self.memory.known.clear();
        for leg in 0..self.held.legs.len() {
            let known = self.known_leg(leg, v);
            self.memory.known.push(known);
        }
    }

    fn known_leg(&mut self, leg: usize, v: &Displacement) -> KnownLeg {
        let (compiled, tau) = (&self.held.legs[leg], self.memory.taus[leg]);
        if compiled.lean.is_some() {
            return KnownLeg::Open;
        }
        let upper_tested = compiled.upper.has_choice() || compiled.upper.driven;
        let bridged = compiled.bridge().is_some();
        let tau = match compiled.split_section {
            Section::Lower if upper_tested => return KnownLeg::Open,
            Section::Lower => None,
            Section::Upper => match tau {
                Some(tau @ JointDisplacement::Direction(_)) if bridged => Some(tau),
                _ => return KnownLeg::Open,
            },
        };
        self.solve_lower(leg, v, tau);
        let [section, _] = &self.memory.lowers[leg];
        let mode = |lower, upper| self.manipulator.leg_mode(leg, LegBranches { lower, upper });
        let mut solutions = section.solutions().map(|(lower, _)| mode(lower, Branch::Plus));
        let choices = [solutions.next(), solutions.next()];
        match (choices, tau) {
            ([None, _], _) => KnownLeg::Open,
            (plus, Some(tau)) => {
                let minus = mode(Branch::Plus, Branch::Minus);
                KnownLeg::Rotated { tau: tau.unit_direction(), plus, minus }
            }
            (choices, None) => KnownLeg::Closed(choices),
        }
    }

    /// Finds the choices with which a leg closes at a candidate. What a leg is known to close with is not tested any
    /// further: not for the reach of its upper section, nor for actuated joints of that section, nor for its lift. That is
    /// left to [`Search::check_candidates`].
    #[inline(always)]
    pub(super) fn match_leg(
        &mut self,
        leg: usize,
        candidate: [&Displacement; 2],
        rise: f64,
        found: &mut Matches,
    ) {
        found.list.clear();
        let compiled = &self.held.legs[leg];
        match self.memory.known[leg] {
            KnownLeg::Closed(choices) => {
                return found.list.extend(choices.into_iter().flatten());
            }
            // A leg that closes has the τ that was solved for.
            KnownLeg::Rotated { tau, plus, minus } => {
                if let Some(branch) = compiled.upper.branch_with(candidate[1], tau, ROUNDING) {
                    let upper = if branch == Branch::Plus { Mode::default() } else { minus };
                    return found
                        .list
                        .extend(plus.into_iter().flatten().map(|mode| mode.with(upper)));
                }
            }
            KnownLeg::Open => {}
        }
        if compiled.lean.is_some() {
            self.match_leaning(leg, candidate, rise, found);
        } else if compiled.split_section == Section::Lower {
            self.match_lower_first(leg, candidate, rise, found);
        } else {
            self.match_upper_first(leg, candidate, rise, found);
        }
    }

    /// Tries every combination of branches of a leg whose sections depend on its own height.
    #[cold]
    #[inline(never)]
    fn match_leaning(
        &self,
        leg: usize,
        candidate: [&Displacement; 2],
        rise: f64,
        found: &mut Matches,
    ) {
        let m = self.manipulator;
        for mode in m.leg_modes(leg) {
            let (compiled, branches) = (&self.held.legs[leg], m.branches(mode, leg));
            let solved = compiled.solve_seldom(m.task(), candidate, rise, branches, 0.0);
            if let Ok(LegSolution { lower, upper, tau }) = solved {
                let error = self.section_error(&compiled.lower, &lower);
                let error = error.max(self.upper_error(leg, &upper, tau, rise));
                found.note(m.leg_mode(leg, branches), error);
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
        // Near a singularity τ is less certain.
        for expected in [true, false] {
            for &branch in self.held.legs[leg].upper.branches() {
                let compiled = &self.held.legs[leg];
                let Ok(upper) = compiled.upper.inverse(b, branch) else { continue };
                let tau = compiled.unwound(compiled.step(&upper), 0.0);
                let known = self.memory.taus[leg].filter(|&known| comparable(known, tau));
                if expected != known.is_none_or(|known| agrees(known, tau, APART)) {
                    continue;
                }
                let exact = known.filter(|&known| agrees(known, tau, ROUNDING));
                let tau = exact.unwrap_or(tau);
                let error = self.upper_error(leg, &upper, tau, rise);
                self.note_with_lower(leg, v, branch, tau, error, found);
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

    /// Notes the choices of a leg with a branch of its upper section, of which τ and the error of an actuated joint are
    /// given.
    #[inline(always)]
    fn note_with_lower(
        &mut self,
        leg: usize,
        v: &Displacement,
        upper: Branch,
        tau: JointDisplacement,
        error: f64,
        found: &mut Matches,
    ) {
        self.solve_lower(leg, v, Some(tau));
        let [section, _] = &self.memory.lowers[leg];
        for (lower, _) in section.solutions() {
            found.note(self.manipulator.leg_mode(leg, LegBranches { lower, upper }), error);
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
        let (compiled, [section, _]) = (&self.held.legs[leg], &self.memory.lowers[leg]);
        let tested = compiled.upper.has_choice() || compiled.upper.driven;
        for (lower, tau) in section.solutions() {
            // U = exp(−I τ) · b
            let step = tau.inverse();
            let target = || self.manipulator.task().upper_intersection.before(b, step);
            for &upper in compiled.upper.branches() {
                let error = match tested {
                    true => match compiled.upper.inverse(&target(), upper) {
                        Ok(solved) => self.upper_error(leg, &solved, tau, rise),
                        Err(_) => continue,
                    },
                    false => 0.0,
                };
                found.note(self.manipulator.leg_mode(leg, LegBranches { lower, upper }), error);
            }
        }
    }

    /// Puts a leg's lower section first among those that are kept, and solves it, unless it is one of them. Most solutions
    /// already have other actuated joints, and are rejected before the rest is solved.
    #[inline(always)]
    fn solve_lower(&mut self, leg: usize, v: &Displacement, tau: Option<JointDisplacement>) {
        let same = |lower: &LowerSection| lower.tau == tau && lower.v == *v;
        if same(&self.memory.lowers[leg][0]) {
            return;
        }
        self.memory.lowers[leg].swap(0, 1);
        if !same(&self.memory.lowers[leg][0]) {
            self.memory.lowers[leg][0] = self.lower_section(leg, v, tau);
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
        let mut section = LowerSection { v: *v, tau, branches: [None; 2] };
        for (solved, &branch) in section.branches.iter_mut().zip(lower.branches()) {
            let Ok(displacements) = lower.inverse(&target, branch) else { continue };
            let error = self.section_error(lower, &displacements);
            if error <= MATCH {
                // L · exp(I c) = v, with c the imaginary joint's displacement: τ = −c.
                let step = || compiled.unwound(compiled.step(&displacements), 0.0);
                *solved = Some(tau.unwrap_or_else(|| step().inverse()));
            }
        }
        section
    }

    /// The largest error of an actuated joint of a leg's upper section and of its lift, where that depends on τ.
    #[inline(always)]
    fn upper_error(
        &self,
        leg: usize,
        upper: &[JointDisplacement; 3],
        tau: JointDisplacement,
        rise: f64,
    ) -> f64 {
        let m = self.manipulator;
        let compiled = &m.legs[leg];
        let mut error = self.section_error(&compiled.upper, upper);
        // All lifts have one height, unless each leg has its own.
        let lift = compiled.lift.filter(|lift| lift.slope != 0.0);
        if let Some((lift, actuated)) =
            lift.and_then(|lift| Some((lift, lift.coordinate.actuated?)))
        {
            let own = lift.rise(self.held.displacements[actuated]);
            let off = own - m.task().rise_of_leg(rise, tau);
            error = error.max(off.abs() / m.closure.size);
        }
        error
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
                    (self.held.displacements[actuated], self.memory.directions[actuated]);
                error = error.max(self.distance(number, displacement, value, direction));
            }
        }
        error
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
