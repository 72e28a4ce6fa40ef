//! The search for assemblies: it tries every combination of the solutions of the two sections.

use super::accept::MATCH;
use super::along::{self, along};
use super::matches::{LowerSection, Matches};
use super::three::{self, Solutions};
use super::{Assemblies, Unmet};
use crate::chain::condition::{Condition, VERGE, flat_joints};
use crate::chain::planar::PlanarJoint;
use crate::chain::track::Track;
use crate::chain::{Branch, Chain, ReachDeficit, planar};
use crate::group::{Displacement, JointDisplacement, LocalTwist, PlanarDisplacement, SubspaceKind};
use crate::manipulator::plan::{Anchor, Plan};
use crate::manipulator::{CompiledLeg, Manipulator, Section, Solution};
use crate::numeric::angle::unit;
use crate::numeric::angle::whole_turns;
use nalgebra::Complex;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// The possible values of a leg's displacement τ along the intersection motion.
enum Taus {
    /// One value, or two.
    At([Option<JointDisplacement>; 2]),
    /// No actuated joint fixes τ, or nothing depends on it.
    Free,
    /// The leg is out of reach, by this deficit at least.
    None(ReachDeficit),
}

/// One run of the forward kinematics.
pub(super) struct Search<'a> {
    pub manipulator: &'a Manipulator,
    pub plan: &'a Plan,
    /// The displacements of the actuated joints from home, radians and metres.
    pub displacements: &'a [f64],
    /// The same displacements as unit complex numbers `e(angle)`.
    pub directions: Vec<Complex<f64>>,
    /// The height above home, metres: that of the first actuated lift. Where legs have heights of their own, it follows
    /// for each candidate.
    pub rise: f64,
    /// The legs at that height, or at their own. A leg whose own height is not known is as it is at home, with its lift.
    pub legs: Cow<'a, [CompiledLeg]>,
    /// For each leg, the τ for which candidates are being tried, in terms of `v` as the pose gives it; `None` where it
    /// was not solved for.
    pub taus: Vec<Option<JointDisplacement>>,
    /// For each leg, its lower section as it was solved last.
    pub lowers: Vec<LowerSection>,
    /// A buffer for the solutions of each leg at a candidate.
    pub matches: Vec<Matches>,
    /// Buffers for the pose of a candidate: all of its coordinates, and the independent ones.
    pub poses: [Vec<f64>; 2],
    /// A buffer for inverse kinematics.
    pub solution: Solution,
    /// A buffer for joint values.
    pub tried: Vec<f64>,
    /// The assemblies found so far.
    pub out: Assemblies,
    /// The smallest error of a joint or a leg among the rejected candidates, in radians or shares of the
    /// size.
    pub least: Option<f64>,
    /// Whether the conditions on the upper section had no solution for some solution of the lower one.
    pub upper_failed: bool,
    /// For each leg, the smallest deficit by which it was out of reach.
    pub deficits: Vec<Option<ReachDeficit>>,
}

/// The heights above home that the actuated lifts give, metres.
fn rises<'a>(m: &'a Manipulator, displacements: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    m.lifts().filter_map(|lift| Some(lift.rise(displacements[lift.coordinate.actuated?])))
}

impl<'a> Search<'a> {
    pub fn new(manipulator: &'a Manipulator, plan: &'a Plan, displacements: &'a [f64]) -> Self {
        let rise = rises(manipulator, displacements).next().unwrap_or(0.0);
        // Where legs have heights of their own, that of an actuated lift is known.
        let of_leg = |leg: &CompiledLeg| match &leg.lift {
            Some(lift) if lift.slope != 0.0 => {
                Some(lift.rise(displacements[lift.coordinate.actuated?]))
            }
            _ => Some(rise),
        };
        Self {
            manipulator,
            plan,
            displacements,
            directions: displacements.iter().map(|&value| unit(value)).collect(),
            rise,
            legs: manipulator.legs_at(of_leg),
            taus: vec![None; manipulator.legs()],
            lowers: (0..manipulator.legs()).map(|_| LowerSection::new()).collect(),
            matches: (0..manipulator.legs()).map(|_| Matches::new()).collect(),
            poses: Default::default(),
            solution: manipulator.solution(),
            tried: Vec::new(),
            out: Assemblies::default(),
            least: None,
            upper_failed: false,
            deficits: vec![None; manipulator.legs()],
        }
    }

    /// Finds all candidates, and accepts those that close.
    pub fn run(&mut self) {
        let (m, plan) = (self.manipulator, self.plan);
        let apart = |rise: f64| (rise - self.rise).abs() / m.closure.size;
        let apart = rises(m, self.displacements).map(apart).fold(0.0, f64::max);
        if apart > MATCH && !m.shares_height() {
            self.reject(apart);
            return;
        }
        let unknown = vec![None; m.legs.len()];
        match &plan.anchor {
            Anchor::Sections => {
                let conditions: Vec<Condition> = (plan.legs.iter().enumerate())
                    .flat_map(|(leg, held)| held.lower.iter().map(move |&joint| (leg, joint)))
                    .filter_map(|(leg, joint)| self.lower_condition(leg, joint))
                    .collect();
                match self.solve(m.task().lower.kind, &conditions) {
                    Some(vs) => {
                        if vs.is_empty() {
                            self.out.unmet.push(Unmet::Section(Section::Lower));
                        }
                        for v in vs {
                            self.with_taus(&v, &unknown);
                        }
                    }
                    None => self.loose(Section::Lower),
                }
            }
            Anchor::Flat(flat) => {
                let [v, b] = flat.solve(m.task(), self.displacements);
                self.assemble(&v, &b);
            }
            Anchor::Leg(leg) => {
                let v = self.actuated_lower_section(*leg);
                let mut known = unknown;
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
                            self.with_lower(&v, &unknown);
                        }
                    }
                }
            }
            Anchor::Level { leg, joint } => {
                let Some(Condition::Flat { normal, value }) = self.lower_condition(*leg, *joint)
                else {
                    return;
                };
                let v = m.task().lower.kind.of_sum(&(normal * (value / normal.norm_squared())));
                self.with_lower(&v, &unknown);
            }
            Anchor::CoupledLegs { functional, legs } => {
                let mut known = unknown;
                let mut conditions = Vec::new();
                for (number, held) in plan.legs.iter().enumerate() {
                    if legs.contains(&number) {
                        let tau = self.coupled_tau(number, functional);
                        known[number] = Some(tau);
                        let along = m.task().lower_intersection.displacement(tau);
                        let own = held
                            .lower
                            .iter()
                            .filter_map(|joint| self.lower_condition(number, *joint));
                        conditions.extend(own.map(|c| c.before(&along)));
                    } else if self.legs[number].split_section == Section::Lower {
                        let own = held
                            .lower
                            .iter()
                            .filter_map(|joint| self.lower_condition(number, *joint));
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

    /// The displacement of a joint of a leg's chain; zero if that joint is not actuated.
    fn displacement(&self, leg: usize, section: Section, joint: usize) -> JointDisplacement {
        let coordinate = self.legs[leg].section(section).coordinates[joint];
        let actuated = coordinate.and_then(|coordinate| coordinate.actuated);
        JointDisplacement::Value(actuated.map_or(0.0, |number| self.displacements[number]))
    }

    /// The condition that an actuated joint of the lower section puts on `v`, or on `v · exp(I τ)`.
    fn lower_condition(&self, leg: usize, joint: usize) -> Option<Condition> {
        self.legs[leg].lower.condition(joint, self.displacement(leg, Section::Lower, joint))
    }

    /// The track on which a leg keeps the axis of the intersection motion.
    fn track(&self, leg: usize, joint: usize) -> Option<Track> {
        let compiled = &self.legs[leg];
        match compiled.split_section {
            Section::Lower => Track::of_condition(&self.lower_condition(leg, joint)?),
            Section::Upper => {
                let displacements =
                    [0, 1, 2].map(|joint| self.displacement(leg, Section::Lower, joint));
                let foot = match &compiled.lower.offset {
                    None => Complex::ZERO,
                    Some(offset) => offset.inverse().planar().translation,
                };
                Track::of_chain(&compiled.lower.chain, joint, &displacements, foot)
            }
        }
    }

    /// The displacement of the lower section of a leg whose lower joints are all actuated.
    fn actuated_lower_section(&self, leg: usize) -> Displacement {
        let q = [0, 1, 2].map(|joint| self.displacement(leg, Section::Lower, joint));
        let lower = &self.legs[leg].lower;
        let reached = match &lower.chain {
            Chain::Rigid => SubspaceKind::Identity.identity(),
            Chain::Planar(chain) => Displacement::Planar(planar::forward(&chain.joints(), &q)),
            Chain::Spherical(chain) => Displacement::Spherical(chain.forward(&q)),
            Chain::Ball(ball) => Displacement::Spherical(ball.forward(&q)),
            Chain::Cylindrical(chain) => Displacement::Cylindrical(chain.forward(&[q[0], q[1]])),
            Chain::Translational(chain) => {
                Displacement::Translational(chain.forward(&[q[0], q[1]]))
            }
            Chain::Spatial(chain) => Displacement::Spatial(chain.forward(&q)),
        };
        match &lower.offset {
            None => reached,
            Some(offset) => reached.after(&offset.inverse()),
        }
    }

    /// The τ of one of several coupled legs, where the functional of `b` that couples them is zero.
    fn coupled_tau(&self, leg: usize, functional: &LocalTwist) -> JointDisplacement {
        let held = self.plan.legs[leg].upper.first();
        let driven = held.and_then(|&joint| {
            let chain = &self.legs[leg].upper.chain;
            let moved = flat_joints(chain)?[joint];
            let value = self.displacement(leg, Section::Upper, joint).value();
            Some(-functional.dot(&moved) * value)
        });
        JointDisplacement::Value(driven.unwrap_or(0.0))
    }

    /// Tries every combination of the legs' τ, with `v` known.
    fn with_lower(&mut self, v: &Displacement, known: &[Option<JointDisplacement>]) {
        // `v` as the pose gives it, so that angles within π here are within π there.
        let (v, removed) = self.manipulator.task().without_shared_rotation(v);
        let v = &v;
        let mut options: Vec<[Option<JointDisplacement>; 2]> = Vec::with_capacity(known.len());
        let mut all_reach = true;
        for (leg, known) in known.iter().enumerate() {
            options.push(match known {
                Some(tau) => [Some(removed.plus(*tau)), None],
                None => match self.taus(leg, v) {
                    Taus::At(taus) => taus,
                    Taus::Free => [None; 2],
                    Taus::None(deficit) => {
                        let least = self.deficits[leg].map_or(f64::INFINITY, |least| least.excess);
                        if deficit.excess < least {
                            self.deficits[leg] = Some(deficit);
                        }
                        all_reach = false;
                        continue;
                    }
                },
            });
        }
        if !all_reach {
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
            self.with_taus(v, &taus);
        }
    }

    /// The possible values of a leg's τ, with `v` known.
    fn taus(&self, number: usize, v: &Displacement) -> Taus {
        let m = self.manipulator;
        let (leg, held) = (&self.legs[number], &self.plan.legs[number]);
        match leg.split_section {
            Section::Upper => {
                for &joint in &held.lower {
                    let Some(condition) = self.lower_condition(number, joint) else { continue };
                    match along(&condition, v, &m.task().lower_intersection, m.closure.size) {
                        along::Solutions::At(taus) => return Taus::At(taus),
                        along::Solutions::None(deficit) => return Taus::None(deficit),
                        // Another actuated joint may fix τ.
                        along::Solutions::Any => {}
                    }
                }
                Taus::Free
            }
            Section::Lower if held.upper.is_empty() => Taus::Free,
            Section::Lower => {
                let mut taus = [None; 2];
                let mut deficit = None;
                for (tau, branch) in taus.iter_mut().zip(Branch::BOTH) {
                    match leg.lower.inverse(v, branch) {
                        Ok(displacements) => {
                            *tau = Some(displacements[leg.lower.chain.freedoms() - 1].inverse());
                        }
                        Err(missed) => deficit = Some(missed),
                    }
                    if !leg.lower.has_choice() {
                        break;
                    }
                }
                match (taus, deficit) {
                    ([None, None], Some(deficit)) => Taus::None(deficit),
                    ([None, tau], _) => Taus::At([tau, None]),
                    (taus, _) => Taus::At(taus),
                }
            }
        }
    }

    /// Finds `b` from the legs' conditions, with `v` and every τ known.
    fn with_taus(&mut self, v: &Displacement, taus: &[Option<JointDisplacement>]) {
        let m = self.manipulator;
        let upper = m.task().upper.kind;
        let mut conditions = Vec::with_capacity(2 * taus.len());
        let slider_angle = self.slider_angle(taus);
        for (number, (leg, tau)) in self.legs.iter().zip(taus).enumerate() {
            let chain = &leg.upper.chain;
            let own = self.plan.legs[number].upper.iter().filter_map(|&joint| {
                leg.upper.condition(joint, self.displacement(number, Section::Upper, joint))
            });
            match (leg.split_section, tau) {
                (Section::Upper, Some(tau)) => {
                    let tau = match tau {
                        JointDisplacement::Direction(_) if upper.commutes() => {
                            let counted = tau.nearest(slider_angle) + self.whole_turns(number);
                            JointDisplacement::Value(if only_slides(chain) {
                                slider_angle
                            } else {
                                counted
                            })
                        }
                        JointDisplacement::Direction(_) | JointDisplacement::Value(_) => *tau,
                    };
                    conditions.extend(leg.upper.condition(0, tau));
                    conditions.extend(own);
                }
                (Section::Upper, None) => conditions.extend(own),
                (Section::Lower, Some(tau)) => {
                    let along = m.task().upper_intersection.displacement(*tau);
                    conditions.extend(own.map(|condition| condition.after(&along)));
                }
                (Section::Lower, None) => {}
            }
        }
        match self.solve(upper, &conditions) {
            None => self.loose(Section::Upper),
            Some(bs) => {
                self.upper_failed |= bs.is_empty();
                self.taus.copy_from_slice(taus);
                for b in bs {
                    self.assemble(v, &b);
                }
            }
        }
    }

    /// The angle of a platform on a cylinder, as a leg whose upper joint only slides fixes it. The angles of
    /// screws are then taken within π of it. Zero if there is no such leg.
    fn slider_angle(&self, taus: &[Option<JointDisplacement>]) -> f64 {
        let legs = self.legs.iter().zip(taus);
        let slider_angle = legs.filter_map(|(leg, tau)| match (leg.split_section, tau) {
            (Section::Upper, Some(tau)) if only_slides(&leg.upper.chain) => Some(tau.value()),
            _ => None,
        });
        slider_angle.take(1).sum()
    }

    /// The full revolutions, as an angle in radians, that the actuated revolute joints of a planar section
    /// pass on to a screw.
    fn whole_turns(&self, leg: usize) -> f64 {
        let Chain::Planar(chain) = &self.legs[leg].lower.chain else { return 0.0 };
        let joints = chain.joints();
        let revolutions = |&joint: &usize| match joints[joint] {
            PlanarJoint::Revolute { reversed, .. } => {
                let count = whole_turns(self.displacement(leg, Section::Lower, joint).value());
                if reversed { -count } else { count }
            }
            PlanarJoint::Prismatic { .. } => 0.0,
        };
        TAU * self.plan.legs[leg].lower.iter().map(revolutions).sum::<f64>()
    }

    /// The displacements that satisfy the first independent conditions, as many as the subspace has
    /// dimensions; `None` if there are not enough independent conditions.
    fn solve(&self, kind: SubspaceKind, conditions: &[Condition]) -> Option<Vec<Displacement>> {
        let size = self.manipulator.closure.size;
        match kind {
            SubspaceKind::Identity => Some(vec![SubspaceKind::Identity.identity()]),
            SubspaceKind::Cylindrical
            | SubspaceKind::TranslationalPlane
            | SubspaceKind::TranslationalSpace => crossing(kind, conditions, size).map(|g| vec![g]),
            SubspaceKind::Planar => {
                first_independent(conditions, size, three::planar, |g: PlanarDisplacement| {
                    let translation = g.translation * size;
                    Displacement::Planar(PlanarDisplacement { translation, ..g })
                })
            }
            SubspaceKind::Spherical => {
                first_independent(conditions, size, three::spherical, Displacement::Spherical)
            }
        }
    }

    /// Notes that a section can move while the actuated joints are held.
    fn loose(&mut self, section: Section) {
        if !self.out.loose.contains(&section) {
            self.out.loose.push(section);
        }
    }
}

/// The solutions of the first three conditions that are independent. They are solved with lengths over the
/// size.
fn first_independent<G>(
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

/// Whether a chain of the imaginary joint and one other is a splined shaft: the imaginary joint rotates,
/// and the other only slides.
fn only_slides(chain: &Chain) -> bool {
    match chain {
        Chain::Cylindrical(chain) => {
            chain.joints()[0].rotation != 0.0 && chain.joints()[1].rotation == 0.0
        }
        Chain::Rigid
        | Chain::Planar(_)
        | Chain::Spherical(_)
        | Chain::Ball(_)
        | Chain::Translational(_)
        | Chain::Spatial(_) => false,
    }
}

/// The displacement of a commutative subspace that satisfies as many of several linear conditions as the subspace has
/// dimensions, two or three: those whose normals are most nearly perpendicular. `None` if too few are independent.
fn crossing(kind: SubspaceKind, conditions: &[Condition], size: f64) -> Option<Displacement> {
    // The units of the coordinates: radians, or lengths over the size.
    let scale = kind.sum_units(size);
    let rows: Vec<(LocalTwist, f64)> = conditions
        .iter()
        .filter_map(|condition| match condition {
            Condition::Flat { normal, value } => {
                let normal = normal.component_mul(&scale);
                let length = normal.norm();
                Some((normal / length, value / length))
            }
            _ => None,
        })
        .collect();
    // Two conditions are completed by one on the third number, which is zero.
    let padding = [(LocalTwist::z(), 0.0)];
    let mut best: Option<(f64, [(LocalTwist, f64); 3])> = None;
    for (k, &third) in rows.iter().enumerate() {
        for (j, &second) in rows[..k].iter().enumerate() {
            let firsts = if kind.dimension() == 3 { &rows[..j] } else { &padding };
            for &first in firsts {
                let determinant = first.0.dot(&second.0.cross(&third.0));
                if best.is_none_or(|(most, _)| determinant.abs() > most.abs()) {
                    best = Some((determinant, [first, second, third]));
                }
            }
        }
    }
    let (determinant, [(a, p), (b, q), (c, r)]) =
        best.filter(|(determinant, _)| determinant.abs() > VERGE)?;
    let sum = (b.cross(&c) * p + c.cross(&a) * q + a.cross(&b) * r) / determinant;
    Some(kind.of_sum(&sum.component_mul(&scale)))
}
