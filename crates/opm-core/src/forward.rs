//! Forward kinematics: every pose of the platform that given actuated joints allow.
//!
//! The decomposition gives the order. With `L · U = v · b` and a leg's displacement τ along the
//! intersection motion `I`,
//!
//! 1. some legs fix `v` up to `I`: one whose lower joints are all actuated, two that keep the axis of `I`
//!    on a track each, or legs whose imaginary joints move as one (`forward/plan.rs`);
//! 2. with `v` known, an actuated joint in a leg's lower section is one equation in the leg's τ
//!    (`forward/along.rs`): a link that swings onto a circle or a line, an axis that turns onto a cone;
//! 3. with τ known, each leg is one condition on `b` (`forward/condition.rs`), and as many as the upper
//!    section has freedoms fix it (`forward/three.rs`: at most eight solutions in a sphere, six in a plane).
//!
//! Each is a small problem with all of its solutions, so that their combinations are all assemblies. Where
//! both sections add up, everything is one linear system (`forward/flat.rs`). A mechanism without such an
//! order is solved by [`Manipulator::forward_near`] from a pose.

mod along;
mod closure;
mod condition;
mod flat;
mod near;
mod plan;
mod three;
mod track;
mod trigonometric;

pub use near::{NearError, NotFound, Stop};
pub use plan::NoClosedForm;
pub(crate) use {closure::Closure, plan::Plan};

use crate::chain::planar::{PlanarDisplacement, PlanarJoint};
use crate::chain::{Amount, Branch, Chain, Gap, planar, unit};
use crate::joint::Quantity;
use crate::manipulator::{
    CompiledSection, LARGEST, LegSolution, Manipulator, Mode, Section, Slot, Solution, Unreachable,
};
use crate::task::{Displacement, SubspaceKind};
use along::{Meeting, along};
use condition::{Condition, length};
use nalgebra::{Complex, Isometry3};
use plan::Anchor;
use std::f64::consts::TAU;
use three::Solutions;
use track::Track;

/// Conditions that miss each other by less than this, as a share of the size, meet: rounding on the verge
/// of reach must not decide.
const VERGE: f64 = 1e-13;

/// The largest residual of an assembly, in radians and sizes. What is off by more does not close.
pub const RESIDUAL: f64 = 1e-12;

/// A leg's solution at an assembled pose has the actuated joints' values to within this, radians or sizes:
/// inverse kinematics near a serial singularity give the root of the rounding.
const MATCH: f64 = 1e-6;

/// Two solutions of a leg that both match are two only if a joint of them differs by more than this; nearer
/// to each other they are one on its way through a singularity.
const APART: f64 = 1e-4;

/// A leg closes so well that what inverse kinematics say of its passive joints needs no mending.
const SETTLED: f64 = 1e-13;

/// Assemblies of one mode are one if no joint of them differs by more, radians or metres.
const SAME: f64 = 1e-9;

/// One way in which the mechanism can be assembled for given actuated joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// Task coordinates, in the order of [`Manipulator::task_coordinates`]; angles within half a turn of
    /// home.
    pub pose: Vec<f64>,
    /// The working mode that it is in: [`Manipulator::inverse`] at this pose in this mode gives back the
    /// actuated joints.
    pub mode: Mode,
    /// Every joint coordinate, in the order of [`Manipulator::coordinates`]; radians and metres, angles
    /// at the turns that [`Manipulator::inverse`] gives.
    pub joints: Vec<f64>,
    /// Every imaginary joint, in the order of [`Manipulator::imaginary`]; radians and metres.
    pub imaginary: Vec<f64>,
    /// All joint coordinates are within their limits.
    pub within_limits: bool,
    /// How far the legs fail to close: the largest distance of a leg's end, by the product of exponentials
    /// of the joints as they stand in the mechanism, from the platform. Radians of the rotation plus the
    /// way of the reference point over the mechanism's size.
    pub residual: f64,
}

/// What given actuated joints allow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assemblies {
    /// All of them.
    pub list: Vec<Assembly>,
    /// Where there is none: what does not meet.
    pub unmet: Vec<Unmet>,
    /// Sections that the actuated joints leave loose: the mechanism is on a singularity through which it
    /// moves with them held. The poses of that motion are not listed.
    pub loose: Vec<Section>,
}

/// What does not meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unmet {
    /// A leg does not reach what the others have fixed, nowhere: by how much at the least.
    Leg(Unreachable),
    /// Two legs that fix the lower section do not meet.
    Legs([usize; 2]),
    /// The legs close one by one, but not all at once with one platform.
    Section(Section),
    /// There are more actuated joints than freedoms, and they contradict each other: the residual of the
    /// least contradiction.
    Contradiction(f64),
}

/// Joint values that cannot be computed with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ForwardError {
    /// Another number of values than there are actuated joints.
    #[error("{given} actuated joints, expected {expected}")]
    Length {
        /// How many were given.
        given: usize,
        /// How many there are.
        expected: usize,
    },
    /// Not a number, infinite, or too large.
    #[error("{name} is {value:?}, expected a number of at most {LARGEST:?}")]
    NotFinite {
        /// The joint.
        name: String,
        /// Its value.
        value: f64,
    },
    /// The mechanism's forward kinematics have no closed form here.
    #[error("no closed form of the forward kinematics: {0}")]
    NoClosedForm(#[from] NoClosedForm),
}

/// The possible values of a leg's τ.
enum Taus {
    These([Option<Amount>; 2]),
    /// Nothing holds it, or nothing needs it.
    Free,
    Never(Gap),
}

impl Manipulator {
    /// Whether [`Manipulator::forward`] has a closed form, and if not, why.
    ///
    /// # Errors
    /// What is in the way.
    pub fn forward_closed_form(&self) -> Result<(), NoClosedForm> {
        self.plan.as_ref().map(|_| ()).map_err(|error| *error)
    }

    /// Every assembly that the actuated joints allow, in closed form; `actuated` in the order of
    /// [`Manipulator::actuated`], radians and metres. None is an answer: `unmet` says what is in the way.
    ///
    /// Angles count modulo a turn, unless a screw makes their turns matter. Inverse kinematics do not tell
    /// the turns of a revolute in a plane that hands them on to a screw: each is an assembly of its own, an
    /// advance of the screw away. The one given is at the turns that `actuated` has from home, passive
    /// joints within half a turn.
    ///
    /// Joint values on the verge of what they allow, to within rounding, are allowed. On a parallel
    /// singularity two assemblies merge; they are given as one, or as two within the root of rounding.
    ///
    /// # Errors
    /// Values that cannot be computed with, or a mechanism without a closed form.
    pub fn forward(&self, actuated: &[f64]) -> Result<Assemblies, ForwardError> {
        let amounts = self.held_amounts(actuated)?;
        let plan = self.plan.as_ref().map_err(|error| *error)?;
        let mut search = Search {
            manipulator: self,
            plan,
            amounts: &amounts,
            turns: amounts.iter().map(|&amount| unit(amount)).collect(),
            solution: self.solution(),
            out: Assemblies::default(),
            least: f64::INFINITY,
            upper_failed: false,
            gaps: vec![None; self.legs.len()],
        };
        search.run();
        Ok(search.finish())
    }

    /// Displacements of the actuated joints from home.
    fn held_amounts(&self, actuated: &[f64]) -> Result<Vec<f64>, ForwardError> {
        let expected = self.actuated().len();
        if actuated.len() != expected {
            return Err(ForwardError::Length { given: actuated.len(), expected });
        }
        let coordinates = self.actuated().iter().map(|&c| &self.coordinates()[c]);
        actuated
            .iter()
            .zip(coordinates)
            .map(|(&value, c)| {
                if value.is_nan() || value.abs() > LARGEST {
                    return Err(ForwardError::NotFinite { name: c.name.clone(), value });
                }
                Ok(value - c.home)
            })
            .collect()
    }
}

impl Manipulator {
    /// The assembly at a pose with the actuated joints `amounts` from home: the joints of a solution
    /// there, mended where the actuated ones are not exactly what they should be.
    fn assembly(
        &self,
        pose: &[f64],
        mode: Mode,
        amounts: &[f64],
        (solution, target): (&mut Solution, &Isometry3<f64>),
    ) -> Assembly {
        // The values that were given, at the turn at which inverse kinematics give them.
        for (&amount, &coordinate) in amounts.iter().zip(self.actuated()) {
            let c = &self.coordinates()[coordinate];
            let given = c.home + amount;
            let joint = &mut solution.joints[coordinate];
            let turns = match c.quantity {
                Quantity::Angle => ((*joint - given) / TAU).round(),
                Quantity::Length => 0.0,
            };
            *joint = given + TAU * turns;
        }
        let mut residual = self.closure.residual(&solution.joints, target);
        if residual > SETTLED {
            residual = self.closure.settle(&mut solution.joints, target, residual);
        }
        Assembly {
            pose: pose.to_vec(),
            mode,
            joints: solution.joints.clone(),
            imaginary: solution.imaginary.clone(),
            within_limits: solution.within_limits,
            residual,
        }
    }
}

/// One run of the forward kinematics.
struct Search<'a> {
    manipulator: &'a Manipulator,
    plan: &'a Plan,
    /// Displacements of the actuated joints from home.
    amounts: &'a [f64],
    /// The same as turns.
    turns: Vec<Complex<f64>>,
    /// A buffer.
    solution: Solution,
    out: Assemblies,
    /// The smallest residual of what was not accepted.
    least: f64,
    /// A combination of lower sections that the upper one does not close.
    upper_failed: bool,
    /// Of each leg, by how little it failed.
    gaps: Vec<Option<Gap>>,
}

impl Search<'_> {
    fn run(&mut self) {
        let (m, plan) = (self.manipulator, self.plan);
        let none = vec![None; m.legs.len()];
        match &plan.anchor {
            Anchor::Flat(flat) => {
                let [v, b] = flat.solve(m.task(), self.amounts);
                self.assemble(&v, &b);
            }
            Anchor::Leg(leg) => {
                let v = self.held_displacement(*leg);
                let mut known = none;
                known[*leg] = Some(Amount::Value(0.0));
                self.with_lower(&v, &known);
            }
            Anchor::Tracks(tracked) => {
                let tracks = tracked.map(|tracked| self.track(tracked.leg, tracked.slot));
                let [Some(first), Some(second)] = tracks else { return };
                match first.meetings(&second, m.closure.size) {
                    None => self.loose(Section::Lower),
                    Some(vs) => {
                        if vs.is_empty() {
                            self.out.unmet.push(Unmet::Legs(tracked.map(|t| t.leg)));
                        }
                        for v in vs {
                            self.with_lower(&v, &none);
                        }
                    }
                }
            }
            Anchor::Level { leg, slot } => {
                let Some(Condition::Flat { normal: [a, b], value }) = self.lower(*leg, *slot)
                else {
                    return;
                };
                let share = value / (a * a + b * b);
                let v = m.task().lower.kind.flat(a * share, b * share);
                self.with_lower(&v, &none);
            }
            Anchor::Together { functional, legs } => {
                let mut known = none;
                let mut conditions = Vec::new();
                for (number, (leg, held)) in m.legs.iter().zip(&plan.legs).enumerate() {
                    if legs.contains(&number) {
                        let tau = self.followed(number, functional);
                        known[number] = Some(tau);
                        let cut = m.task().lower_cut.after(&m.task().lower.kind.identity(), tau);
                        let own = held.lower.iter().filter_map(|slot| self.lower(number, *slot));
                        conditions.extend(own.map(|c| c.before(&cut)));
                    } else if leg.cut == Section::Lower {
                        let own = held.lower.iter().filter_map(|slot| self.lower(number, *slot));
                        conditions.extend(own);
                    }
                }
                match self.solve(m.task().lower.kind, &conditions) {
                    Some(vs) => {
                        if vs.is_empty() {
                            self.out.unmet.push(Unmet::Section(Section::Lower));
                        }
                        for v in vs {
                            self.with_lower(&v, &known);
                        }
                    }
                    None => self.loose(Section::Lower),
                }
            }
        }
    }

    /// The amount of a held slot.
    fn amount(&self, leg: usize, section: Section, slot: usize) -> Amount {
        let slot = self.manipulator.legs[leg].section(section).slots[slot];
        Amount::Value(slot.and_then(|slot| slot.drive).map_or(0.0, |drive| self.amounts[drive]))
    }

    /// What a held lower slot asks of `v`, or of `v · exp(I τ)`.
    fn lower(&self, leg: usize, slot: usize) -> Option<Condition> {
        let chain = &self.manipulator.legs[leg].lower.chain;
        Condition::new(chain, slot, self.amount(leg, Section::Lower, slot))
    }

    fn track(&self, leg: usize, slot: usize) -> Option<Track> {
        let compiled = &self.manipulator.legs[leg];
        match compiled.cut {
            Section::Lower => Track::of_condition(&self.lower(leg, slot)?),
            Section::Upper => {
                let amounts = [0, 1, 2].map(|slot| self.amount(leg, Section::Lower, slot));
                Track::of_chain(&compiled.lower.chain, slot, &amounts)
            }
        }
    }

    /// Where a leg whose lower joints are all actuated has its cut.
    fn held_displacement(&self, leg: usize) -> Displacement {
        let a = [0, 1, 2].map(|slot| self.amount(leg, Section::Lower, slot));
        match &self.manipulator.legs[leg].lower.chain {
            Chain::Planar(chain) => Displacement::Planar(planar::forward(&chain.joints(), &a)),
            Chain::Spherical(chain) => Displacement::Spherical(chain.forward(&a)),
            Chain::Ball(ball) => Displacement::Spherical(ball.forward(&a)),
            Chain::Cylindrical(chain) => Displacement::Cylindrical(chain.forward(&[a[0], a[1]])),
            Chain::Translational(chain) => {
                Displacement::Translational(chain.forward(&[a[0], a[1]]))
            }
        }
    }

    /// The τ of a leg whose cut follows a functional of `b`, where that is zero.
    fn followed(&self, leg: usize, functional: &[f64; 2]) -> Amount {
        let held = self.plan.legs[leg].upper.first();
        let driven = held.and_then(|&slot| {
            let chain = &self.manipulator.legs[leg].upper.chain;
            let [p, q] = condition::flat_joints(chain)?[slot];
            let amount = self.amount(leg, Section::Upper, slot).value();
            Some(-(functional[0] * p + functional[1] * q) * amount)
        });
        Amount::Value(driven.unwrap_or(0.0))
    }

    /// With `v` known: every combination of the legs' τ.
    fn with_lower(&mut self, v: &Displacement, known: &[Option<Amount>]) {
        let mut options: Vec<[Option<Amount>; 2]> = Vec::with_capacity(known.len());
        let mut closes = true;
        for (leg, known) in known.iter().enumerate() {
            options.push(match known {
                Some(_) => [*known, None],
                None => match self.taus(leg, v) {
                    Taus::These(taus) => taus,
                    Taus::Free => [None; 2],
                    Taus::Never(gap) => {
                        let least = self.gaps[leg].map_or(f64::INFINITY, |gap| gap.excess);
                        if gap.excess < least {
                            self.gaps[leg] = Some(gap);
                        }
                        closes = false;
                        continue;
                    }
                },
            });
        }
        if !closes {
            return;
        }
        let choices: Vec<usize> = (0..options.len()).filter(|&i| options[i][1].is_some()).collect();
        for combination in 0..1_u64 << choices.len() {
            let mut taus: Vec<Option<Amount>> = options.iter().map(|option| option[0]).collect();
            for (bit, &leg) in choices.iter().enumerate() {
                if combination >> bit & 1 == 1 {
                    taus[leg] = options[leg][1];
                }
            }
            self.with_cuts(v, &taus);
        }
    }

    fn taus(&self, number: usize, v: &Displacement) -> Taus {
        let m = self.manipulator;
        let (leg, held) = (&m.legs[number], &self.plan.legs[number]);
        match leg.cut {
            Section::Upper => {
                for &slot in &held.lower {
                    let Some(condition) = self.lower(number, slot) else { continue };
                    match along(&condition, v, &m.task().lower_cut, m.closure.size) {
                        Meeting::At(taus) => return Taus::These(taus),
                        Meeting::Never(gap) => return Taus::Never(gap),
                        // Another held joint may say more.
                        Meeting::Anywhere => {}
                    }
                }
                Taus::Free
            }
            Section::Lower if held.upper.is_empty() => Taus::Free,
            Section::Lower => {
                let mut taus = [None; 2];
                let mut gap = None;
                for (tau, branch) in taus.iter_mut().zip(Branch::BOTH) {
                    match leg.lower.chain.inverse(v, branch) {
                        Ok(amounts) => {
                            *tau = Some(amounts[leg.lower.chain.freedoms() - 1].inverse());
                        }
                        Err(missed) => gap = Some(missed),
                    }
                    if !leg.lower.chain.has_choice() {
                        break;
                    }
                }
                match (taus, gap) {
                    ([None, None], Some(gap)) => Taus::Never(gap),
                    ([None, tau], _) => Taus::These([tau, None]),
                    (taus, _) => Taus::These(taus),
                }
            }
        }
    }

    /// With `v` and the cuts known: `b` from the legs' conditions.
    fn with_cuts(&mut self, v: &Displacement, taus: &[Option<Amount>]) {
        let m = self.manipulator;
        let upper = m.task().upper.kind;
        let mut conditions = Vec::with_capacity(2 * taus.len());
        let splined = self.splined(taus);
        for (number, (leg, tau)) in m.legs.iter().zip(taus).enumerate() {
            let chain = &leg.upper.chain;
            let own = self.plan.legs[number].upper.iter().filter_map(|&slot| {
                Condition::new(chain, slot, self.amount(number, Section::Upper, slot))
            });
            match (leg.cut, tau) {
                (Section::Upper, Some(tau)) => {
                    let tau = match tau {
                        Amount::Turn(_) if plan::adds_up(upper) => {
                            let counted = tau.nearest(splined) + self.whole_turns(number);
                            Amount::Value(if slides(chain) { splined } else { counted })
                        }
                        Amount::Turn(_) | Amount::Value(_) => *tau,
                    };
                    conditions.extend(Condition::new(chain, 0, tau));
                    conditions.extend(own);
                }
                (Section::Upper, None) => conditions.extend(own),
                (Section::Lower, Some(tau)) => {
                    let cut = m.task().upper_cut.before(&upper.identity(), *tau);
                    conditions.extend(own.map(|condition| condition.after(&cut)));
                }
                (Section::Lower, None) => {}
            }
        }
        match self.solve(upper, &conditions) {
            None => self.loose(Section::Upper),
            Some(bs) => {
                self.upper_failed |= bs.is_empty();
                for b in bs {
                    self.assemble(v, &b);
                }
            }
        }
    }

    /// The angle that a leg whose upper joint only slides gives a platform on a cylinder: screws are then
    /// taken within half a turn. Zero where there is no such leg.
    fn splined(&self, taus: &[Option<Amount>]) -> f64 {
        let legs = self.manipulator.legs.iter().zip(taus);
        let splined = legs.filter_map(|(leg, tau)| match (leg.cut, tau) {
            (Section::Upper, Some(tau)) if slides(&leg.upper.chain) => Some(tau.value()),
            _ => None,
        });
        splined.take(1).sum()
    }

    /// The whole turns, as an angle, that the actuated revolutes of a planar section hand on to a screw.
    fn whole_turns(&self, leg: usize) -> f64 {
        let Chain::Planar(chain) = &self.manipulator.legs[leg].lower.chain else { return 0.0 };
        let joints = chain.joints();
        let turns = |&slot: &usize| match joints[slot] {
            PlanarJoint::Revolute { reversed, .. } => {
                let turns = (self.amount(leg, Section::Lower, slot).value() / TAU).round();
                if reversed { -turns } else { turns }
            }
            PlanarJoint::Prismatic { .. } => 0.0,
        };
        TAU * self.plan.legs[leg].lower.iter().map(turns).sum::<f64>()
    }

    /// The displacements that satisfy all conditions, or those of the first that are independent; `None`
    /// where there are none such.
    fn solve(&self, kind: SubspaceKind, conditions: &[Condition]) -> Option<Vec<Displacement>> {
        let size = self.manipulator.closure.size;
        if plan::adds_up(kind) {
            return crossing(kind, conditions, size).map(|g| vec![g]);
        }
        let planar = kind == SubspaceKind::Planar;
        let scaled: Vec<Condition> = conditions.iter().map(|c| c.scaled(1.0 / size)).collect();
        let n = conditions.len();
        for i in 0..n {
            for j in i + 1..n {
                for k in j + 1..n {
                    let chosen = [scaled[i], scaled[j], scaled[k]];
                    if planar {
                        if let Solutions::At(found) = three::planar(&chosen) {
                            let grown = |g: PlanarDisplacement| PlanarDisplacement {
                                translation: g.translation * size,
                                ..g
                            };
                            let grown = |g| Displacement::Planar(grown(g));
                            return Some(found.into_iter().map(grown).collect());
                        }
                    } else if let Solutions::At(found) = three::spherical(&chosen) {
                        return Some(found.into_iter().map(Displacement::Spherical).collect());
                    }
                }
            }
        }
        None
    }

    fn loose(&mut self, section: Section) {
        if !self.out.loose.contains(&section) {
            self.out.loose.push(section);
        }
    }

    /// Every assembly at `v · b`: in most mechanisms one, but a leg may close in several ways with the
    /// same actuated joints.
    fn assemble(&mut self, v: &Displacement, b: &Displacement) {
        let m = self.manipulator;
        let pose = m.task().pose(v, b);
        let Ok((v, b)) = m.displacements(&pose) else { return };
        let target = m.task().isometry(&v, &b);
        let mut ways: Vec<Vec<(Mode, LegSolution)>> = Vec::with_capacity(m.legs.len());
        for leg in 0..m.legs.len() {
            let ways_of_leg = self.ways(leg, [&v, &b]);
            if ways_of_leg.is_empty() {
                return;
            }
            ways.push(ways_of_leg);
        }
        let count: usize = ways.iter().map(Vec::len).product();
        for number in 0..count {
            let mut rest = number;
            let mut mode = Mode::default();
            self.solution.within_limits = true;
            for (leg, ways) in ways.iter().enumerate() {
                let (own, solution) = &ways[rest % ways.len()];
                rest /= ways.len();
                mode = mode.with(*own);
                m.write_leg(leg, solution, &mut self.solution);
            }
            self.accept(&pose, mode, &target);
        }
    }

    /// A leg's solutions at a pose that have the actuated joints where they are.
    fn ways(&self, leg: usize, pose: [&Displacement; 2]) -> Vec<(Mode, LegSolution)> {
        let m = self.manipulator;
        let compiled = &m.legs[leg];
        let mut found: Vec<(Mode, LegSolution, f64)> = Vec::with_capacity(4);
        // Most ways already have the lower joints elsewhere: they are dismissed before the rest is solved.
        let quick = compiled.cut == Section::Upper && !self.plan.legs[leg].lower.is_empty();
        let [v, b] = pose;
        let cuts = Branch::BOTH.map(|branch| match quick {
            true => {
                compiled.upper.chain.first(b, branch).ok().map(|tau| compiled.unwound(tau, 0.0))
            }
            false => None,
        });
        for mode in m.leg_modes(leg) {
            let branches = m.branches(mode, leg);
            if quick {
                let Some(tau) = cuts[usize::from(branches.upper == Branch::Minus)] else {
                    continue;
                };
                match compiled.solve_lower(m.task(), v, tau, branches.lower) {
                    Ok(lower) if self.section_off(&compiled.lower, &lower) <= MATCH => {}
                    _ => continue,
                }
            }
            let Ok(solution) = compiled.solve(m.task(), pose, branches, 0.0) else { continue };
            let off = self.off(leg, &solution);
            if off <= MATCH {
                found.push((mode, solution, off));
            }
        }
        found.sort_by(|a, b| a.2.total_cmp(&b.2));
        let mut kept: Vec<(Mode, LegSolution)> = Vec::with_capacity(found.len());
        for (mode, solution, _) in found {
            let same = |(_, other): &(Mode, LegSolution)| self.same(leg, other, &solution);
            if !kept.iter().any(same) {
                kept.push((mode, solution));
            }
        }
        kept
    }

    /// By how much a leg's solution has its actuated joints elsewhere.
    fn off(&self, leg: usize, solution: &LegSolution) -> f64 {
        let leg = &self.manipulator.legs[leg];
        let lower = self.section_off(&leg.lower, &solution.lower);
        lower.max(self.section_off(&leg.upper, &solution.upper))
    }

    fn section_off(&self, section: &CompiledSection, amounts: &[Amount; 3]) -> f64 {
        let mut off = 0.0_f64;
        for (slot, &amount) in section.slots.iter().zip(amounts) {
            if let Some(Slot { coordinate, drive: Some(drive) }) = *slot {
                let (value, turn) = (self.amounts[drive], self.turns[drive]);
                off = off.max(self.apart(coordinate, amount, value, turn));
            }
        }
        off
    }

    fn same(&self, leg: usize, one: &LegSolution, other: &LegSolution) -> bool {
        let m = self.manipulator;
        let compiled = &m.legs[leg];
        let sections = [
            (&compiled.lower, &one.lower, &other.lower),
            (&compiled.upper, &one.upper, &other.upper),
        ];
        sections.iter().all(|(section, one, other)| {
            section.slots.iter().zip(one.iter().zip(*other)).all(|(slot, (one, other))| {
                let Some(slot) = slot else { return true };
                self.apart(slot.coordinate, *one, other.value(), other.turn()) < APART
            })
        })
    }

    /// Distance of an amount from a value, and from its turn: radians or sizes.
    fn apart(&self, coordinate: usize, amount: Amount, value: f64, turn: Complex<f64>) -> f64 {
        match amount {
            Amount::Turn(_) => length(amount.turn() - turn),
            Amount::Value(given) => match self.manipulator.coordinates()[coordinate].quantity {
                Quantity::Angle => (given - value).abs(),
                Quantity::Length => (given - value).abs() / self.manipulator.closure.size,
            },
        }
    }

    /// Adds the assembly in the buffer, unless it does not close or is there already.
    fn accept(&mut self, pose: &[f64], mode: Mode, target: &Isometry3<f64>) {
        let m = self.manipulator;
        let assembly = m.assembly(pose, mode, self.amounts, (&mut self.solution, target));
        if assembly.residual.is_nan() || assembly.residual > RESIDUAL {
            self.least = self.least.min(assembly.residual);
            return;
        }
        let known = |other: &Assembly| {
            let joints = other.joints.iter().zip(&assembly.joints);
            other.mode == mode && joints.into_iter().all(|(a, b)| (a - b).abs() < SAME)
        };
        if !self.out.list.iter().any(known) {
            self.out.list.push(assembly);
        }
    }

    fn finish(mut self) -> Assemblies {
        for (leg, gap) in self.gaps.iter().enumerate() {
            if let Some(gap) = *gap {
                let section = Section::Lower;
                self.out.unmet.push(Unmet::Leg(Unreachable { leg, section, gap }));
            }
        }
        if self.upper_failed {
            self.out.unmet.push(Unmet::Section(Section::Upper));
        }
        if self.least.is_finite() {
            self.out.unmet.push(Unmet::Contradiction(self.least));
        }
        if !self.out.list.is_empty() {
            self.out.unmet.clear();
        }
        self.out
    }
}

/// Whether a chain of the cut and one joint is a spline: the joint slides where the cut turns.
fn slides(chain: &Chain) -> bool {
    match chain {
        Chain::Cylindrical(chain) => chain.joints()[0].turn != 0.0 && chain.joints()[1].turn == 0.0,
        _ => false,
    }
}

/// Where the first two of several lines that are not parallel meet, the most square of them.
fn crossing(kind: SubspaceKind, conditions: &[Condition], size: f64) -> Option<Displacement> {
    // Angles and advances, or lengths, over the size.
    let scale = match kind {
        SubspaceKind::Cylindrical => [1.0, size],
        _ => [size, size],
    };
    let rows: Vec<([f64; 2], f64)> = conditions
        .iter()
        .filter_map(|condition| match condition {
            Condition::Flat { normal: [a, b], value } => {
                let (a, b) = (a * scale[0], b * scale[1]);
                let length = a.hypot(b);
                Some(([a / length, b / length], value / length))
            }
            _ => None,
        })
        .collect();
    let cross = |[a, b]: [f64; 2], [p, q]: [f64; 2]| a * q - b * p;
    let mut best: Option<(f64, usize, usize)> = None;
    for j in 0..rows.len() {
        for i in 0..j {
            let determinant = cross(rows[i].0, rows[j].0);
            if best.is_none_or(|(most, ..)| determinant.abs() > most.abs()) {
                best = Some((determinant, i, j));
            }
        }
    }
    let (determinant, i, j) = best.filter(|(determinant, ..)| determinant.abs() > VERGE)?;
    let (([a, b], m), ([p, q], n)) = (rows[i], rows[j]);
    let x = (m * q - b * n) / determinant;
    let y = (a * n - m * p) / determinant;
    Some(kind.flat(x * scale[0], y * scale[1]))
}
