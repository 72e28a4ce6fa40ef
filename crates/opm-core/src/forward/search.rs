//! The search for assemblies: every combination of what the sections allow, one section after the other.

use super::along::{Meeting, along};
use super::three::{self, Solutions};
use super::{Assemblies, Unmet};
use crate::chain::condition::{Condition, VERGE, flat_joints};
use crate::chain::planar::PlanarJoint;
use crate::chain::track::Track;
use crate::chain::{Branch, Chain, ReachDeficit, planar};
use crate::group::{Displacement, JointDisplacement, PlanarDisplacement, SubspaceKind};
use crate::manipulator::plan::{Anchor, Plan};
use crate::manipulator::{Manipulator, Section, Solution};
use crate::numeric::angle::unit;
use crate::numeric::angle::whole_turns;
use nalgebra::Complex;
use std::f64::consts::TAU;

/// The possible values of a leg's τ.
enum Taus {
    These([Option<JointDisplacement>; 2]),
    /// Nothing holds it, or nothing needs it.
    Free,
    Never(ReachDeficit),
}

/// One run of the forward kinematics.
pub(super) struct Search<'a> {
    pub manipulator: &'a Manipulator,
    pub plan: &'a Plan,
    /// Displacements of the actuated joints from home.
    pub amounts: &'a [f64],
    /// The same as turns.
    pub turns: Vec<Complex<f64>>,
    /// A buffer.
    pub solution: Solution,
    pub out: Assemblies,
    /// Of the poses that were not accepted, the least by which a joint or a leg is off.
    pub least: Option<f64>,
    /// A combination of lower sections that the upper one does not close.
    pub upper_failed: bool,
    /// Of each leg, by how little it failed.
    pub deficits: Vec<Option<ReachDeficit>>,
}

impl<'a> Search<'a> {
    pub fn new(manipulator: &'a Manipulator, plan: &'a Plan, amounts: &'a [f64]) -> Self {
        Self {
            manipulator,
            plan,
            amounts,
            turns: amounts.iter().map(|&amount| unit(amount)).collect(),
            solution: manipulator.solution(),
            out: Assemblies::default(),
            least: None,
            upper_failed: false,
            deficits: vec![None; manipulator.legs()],
        }
    }

    /// Finds what there is, and puts it to the test.
    pub fn run(&mut self) {
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
                known[*leg] = Some(JointDisplacement::Value(0.0));
                self.with_lower(&v, &known);
            }
            Anchor::Tracks(tracked) => {
                let tracks = tracked.map(|tracked| self.track(tracked.leg, tracked.joint));
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
            Anchor::Level { leg, joint } => {
                let Some(Condition::Flat { normal: [a, b], value }) = self.lower(*leg, *joint)
                else {
                    return;
                };
                let share = value / (a * a + b * b);
                let v = m.task().lower.kind.of_sum([a * share, b * share]);
                self.with_lower(&v, &none);
            }
            Anchor::CoupledLegs { functional, legs } => {
                let mut known = none;
                let mut conditions = Vec::new();
                for (number, (leg, held)) in m.legs.iter().zip(&plan.legs).enumerate() {
                    if legs.contains(&number) {
                        let tau = self.followed(number, functional);
                        known[number] = Some(tau);
                        let cut = m.task().lower_intersection.displacement(tau);
                        let own = held.lower.iter().filter_map(|slot| self.lower(number, *slot));
                        conditions.extend(own.map(|c| c.before(&cut)));
                    } else if leg.split_section == Section::Lower {
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
    fn amount(&self, leg: usize, section: Section, slot: usize) -> JointDisplacement {
        let slot = self.manipulator.legs[leg].section(section).coordinates[slot];
        JointDisplacement::Value(
            slot.and_then(|slot| slot.actuated).map_or(0.0, |drive| self.amounts[drive]),
        )
    }

    /// What a held lower slot asks of `v`, or of `v · exp(I τ)`.
    fn lower(&self, leg: usize, slot: usize) -> Option<Condition> {
        let chain = &self.manipulator.legs[leg].lower.chain;
        Condition::new(chain, slot, self.amount(leg, Section::Lower, slot))
    }

    fn track(&self, leg: usize, slot: usize) -> Option<Track> {
        let compiled = &self.manipulator.legs[leg];
        match compiled.split_section {
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
    fn followed(&self, leg: usize, functional: &[f64; 2]) -> JointDisplacement {
        let held = self.plan.legs[leg].upper.first();
        let driven = held.and_then(|&slot| {
            let chain = &self.manipulator.legs[leg].upper.chain;
            let [p, q] = flat_joints(chain)?[slot];
            let amount = self.amount(leg, Section::Upper, slot).value();
            Some(-(functional[0] * p + functional[1] * q) * amount)
        });
        JointDisplacement::Value(driven.unwrap_or(0.0))
    }

    /// With `v` known: every combination of the legs' τ.
    fn with_lower(&mut self, v: &Displacement, known: &[Option<JointDisplacement>]) {
        // As the pose has it: then what is within half a turn here is so there.
        let (v, turned) = self.manipulator.task().without_shared_rotation(v);
        let v = &v;
        let mut options: Vec<[Option<JointDisplacement>; 2]> = Vec::with_capacity(known.len());
        let mut closes = true;
        for (leg, known) in known.iter().enumerate() {
            options.push(match known {
                Some(tau) => [Some(turned.plus(*tau)), None],
                None => match self.taus(leg, v) {
                    Taus::These(taus) => taus,
                    Taus::Free => [None; 2],
                    Taus::Never(deficit) => {
                        let least = self.deficits[leg].map_or(f64::INFINITY, |least| least.excess);
                        if deficit.excess < least {
                            self.deficits[leg] = Some(deficit);
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
            let mut taus: Vec<Option<JointDisplacement>> =
                options.iter().map(|option| option[0]).collect();
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
        match leg.split_section {
            Section::Upper => {
                for &slot in &held.lower {
                    let Some(condition) = self.lower(number, slot) else { continue };
                    match along(&condition, v, &m.task().lower_intersection, m.closure.size) {
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
    fn with_cuts(&mut self, v: &Displacement, taus: &[Option<JointDisplacement>]) {
        let m = self.manipulator;
        let upper = m.task().upper.kind;
        let mut conditions = Vec::with_capacity(2 * taus.len());
        let slider_angle = self.slider_angle(taus);
        for (number, (leg, tau)) in m.legs.iter().zip(taus).enumerate() {
            let chain = &leg.upper.chain;
            let own = self.plan.legs[number].upper.iter().filter_map(|&slot| {
                Condition::new(chain, slot, self.amount(number, Section::Upper, slot))
            });
            match (leg.split_section, tau) {
                (Section::Upper, Some(tau)) => {
                    let tau = match tau {
                        JointDisplacement::Direction(_) if upper.commutes() => {
                            let counted = tau.nearest(slider_angle) + self.whole_turns(number);
                            JointDisplacement::Value(if slides(chain) {
                                slider_angle
                            } else {
                                counted
                            })
                        }
                        JointDisplacement::Direction(_) | JointDisplacement::Value(_) => *tau,
                    };
                    conditions.extend(Condition::new(chain, 0, tau));
                    conditions.extend(own);
                }
                (Section::Upper, None) => conditions.extend(own),
                (Section::Lower, Some(tau)) => {
                    let cut = m.task().upper_intersection.displacement(*tau);
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
    fn slider_angle(&self, taus: &[Option<JointDisplacement>]) -> f64 {
        let legs = self.manipulator.legs.iter().zip(taus);
        let slider_angle = legs.filter_map(|(leg, tau)| match (leg.split_section, tau) {
            (Section::Upper, Some(tau)) if slides(&leg.upper.chain) => Some(tau.value()),
            _ => None,
        });
        slider_angle.take(1).sum()
    }

    /// The whole turns, as an angle, that the actuated revolutes of a planar section hand on to a screw.
    fn whole_turns(&self, leg: usize) -> f64 {
        let Chain::Planar(chain) = &self.manipulator.legs[leg].lower.chain else { return 0.0 };
        let joints = chain.joints();
        let turns = |&slot: &usize| match joints[slot] {
            PlanarJoint::Revolute { reversed, .. } => {
                let turns = whole_turns(self.amount(leg, Section::Lower, slot).value());
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
        match kind {
            SubspaceKind::Cylindrical | SubspaceKind::TranslationalPlane => {
                crossing(kind, conditions, size).map(|g| vec![g])
            }
            SubspaceKind::Planar => {
                first_at(conditions, size, three::planar, |g: PlanarDisplacement| {
                    let translation = g.translation * size;
                    Displacement::Planar(PlanarDisplacement { translation, ..g })
                })
            }
            SubspaceKind::Spherical => {
                first_at(conditions, size, three::spherical, Displacement::Spherical)
            }
        }
    }

    fn loose(&mut self, section: Section) {
        if !self.out.loose.contains(&section) {
            self.out.loose.push(section);
        }
    }
}

/// The solutions of the first three conditions that are independent, which are solved with lengths over
/// the size.
fn first_at<G>(
    conditions: &[Condition],
    size: f64,
    solve: fn(&[Condition; 3]) -> Solutions<G>,
    displacement: impl Fn(G) -> Displacement + Copy,
) -> Option<Vec<Displacement>> {
    let conditions: Vec<Condition> = conditions.iter().map(|c| c.scaled(1.0 / size)).collect();
    let n = conditions.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let chosen = [conditions[i], conditions[j], conditions[k]];
                if let Solutions::At(found) = solve(&chosen) {
                    return Some(found.into_iter().map(displacement).collect());
                }
            }
        }
    }
    None
}

/// Whether a chain of the cut and one joint is a spline: the joint slides where the cut turns.
fn slides(chain: &Chain) -> bool {
    match chain {
        Chain::Cylindrical(chain) => {
            chain.joints()[0].rotation != 0.0 && chain.joints()[1].rotation == 0.0
        }
        Chain::Planar(_) | Chain::Spherical(_) | Chain::Ball(_) | Chain::Translational(_) => false,
    }
}

/// Where the first two of several lines that are not parallel meet, those that are the most nearly perpendicular.
fn crossing(kind: SubspaceKind, conditions: &[Condition], size: f64) -> Option<Displacement> {
    // Angles and advances, or lengths, over the size.
    let scale = kind.sum_units(size);
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
    Some(kind.of_sum([x * scale[0], y * scale[1]]))
}
