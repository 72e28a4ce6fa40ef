//! The search for assemblies: it tries every combination of the solutions of the two sections.

use super::accept::{MATCH, Outcome};
use super::candidates::Candidates;
use super::held::{Held, Taus};
use super::matches::{KnownLeg, LowerSection, Matches};
use super::{Unmet, solve};
use crate::chain::ReachDeficit;
use crate::chain::condition::Condition;
use crate::group::{Displacement, JointDisplacement};
use crate::manipulator::plan::{Anchor, Plan};
use crate::manipulator::{Manipulator, Section};
use crate::numeric::angle::unit;
use nalgebra::Complex;

/// One run of the forward kinematics.
pub(super) struct Search<'a> {
    pub manipulator: &'a Manipulator,
    pub held: Held<'a>,
    /// The height above home, metres: that of the first actuated lift. Where legs have heights of their own, it follows
    /// for each candidate.
    pub rise: f64,
    /// Whether the conditions on the upper section had no solution for some solution of the lower one.
    pub upper_failed: bool,
    pub memory: &'a mut Memory,
}

/// The memory of a search, which the next one uses again.
#[derive(Clone, Debug)]
pub(super) struct Memory {
    /// The displacements of the actuated joints as unit complex numbers `e(angle)`.
    pub directions: Vec<Complex<f64>>,
    /// The conditions on a section.
    conditions: Vec<Condition>,
    /// For each leg, the τ for which candidates are being tried, in terms of `v` as the pose gives it, a unit vector where it
    /// is a direction; `None` where it was not solved for.
    pub taus: Vec<Option<JointDisplacement>>,
    /// For each leg, its lower section as it was solved last, and before that for another τ.
    pub lowers: Vec<[LowerSection; 2]>,
    /// What is known of each leg at all candidates with the present `v` and τ.
    pub known: Vec<KnownLeg>,
    /// The choices of each leg at a candidate.
    pub matches: Vec<Matches>,
    /// The pose of a candidate: all of its coordinates, and the independent ones.
    pub poses: [Vec<f64>; 2],
    pub candidates: Candidates,
    pub outcome: Outcome,
    /// For each leg, the smallest deficit by which it was out of reach.
    pub deficits: Vec<Option<ReachDeficit>>,
}

impl Memory {
    pub fn new(manipulator: &Manipulator) -> Self {
        let legs = manipulator.legs();
        Self {
            directions: Vec::new(),
            conditions: Vec::new(),
            taus: vec![None; legs],
            lowers: (0..legs).map(|_| [LowerSection::new(), LowerSection::new()]).collect(),
            known: Vec::with_capacity(legs),
            matches: (0..legs).map(|_| Matches::new()).collect(),
            poses: Default::default(),
            candidates: Candidates::new(manipulator),
            outcome: Outcome::new(manipulator),
            deficits: vec![None; legs],
        }
    }

    /// Forgets the last search. What it has allocated stays.
    fn clear(&mut self) {
        self.taus.fill(None);
        self.lowers.fill_with(|| [LowerSection::new(), LowerSection::new()]);
        self.candidates.clear();
        self.outcome.clear();
        self.deficits.fill(None);
    }
}

impl<'a> Search<'a> {
    pub fn new(
        manipulator: &'a Manipulator,
        plan: &'a Plan,
        displacements: &'a [f64],
        memory: &'a mut Memory,
    ) -> Self {
        let held = Held::new(manipulator, plan, displacements);
        memory.clear();
        memory.directions.clear();
        memory.directions.extend(displacements.iter().map(|&value| unit(value)));
        Self { manipulator, rise: held.rise, held, upper_failed: false, memory }
    }

    /// Finds all candidates, and accepts those that close.
    pub fn run(mut self) {
        self.find();
        self.check_candidates();
        self.give_reasons();
    }

    /// Finds all candidates.
    fn find(&mut self) {
        let (m, plan) = (self.manipulator, self.held.plan);
        let apart = self.held.contradiction_of_heights();
        if apart > MATCH && !m.task().shares_height() {
            self.memory.outcome.reject();
            return;
        }
        let mut known = vec![None; m.legs.len()];
        match &plan.anchor {
            Anchor::Sections | Anchor::CoupledLegs { .. } => {
                self.held.write_lower_conditions(&mut known, &mut self.memory.conditions);
                match solve::all(m.task().lower.kind, &self.memory.conditions, m.closure.size) {
                    Some(vs) => {
                        if vs.is_empty() {
                            self.memory
                                .outcome
                                .assemblies
                                .unmet
                                .push(Unmet::Section(Section::Lower));
                        }
                        for v in vs {
                            match plan.anchor {
                                Anchor::Sections => self.with_taus(&v, &known),
                                _ => self.with_lower(&v, &known),
                            }
                        }
                    }
                    None => self.loose(Section::Lower),
                }
            }
            Anchor::Flat(flat) => {
                let [v, b] = flat.solve(m.task(), self.held.displacements);
                self.assemble(&v, &[b]);
            }
            Anchor::Leg(leg) => {
                let v = self.held.actuated_lower_section(*leg);
                known[*leg] = Some(JointDisplacement::Value(0.0));
                self.with_lower(&v, &known);
            }
            Anchor::Tracks(tracked) => match self.held.meetings(tracked) {
                None => self.loose(Section::Lower),
                Some([None, None]) => {
                    self.memory
                        .outcome
                        .assemblies
                        .unmet
                        .push(Unmet::Legs(tracked.map(|tracked| tracked.leg)));
                }
                Some(vs) => {
                    for v in vs.into_iter().flatten() {
                        self.with_lower(&v, &known);
                    }
                }
            },
            Anchor::Level { leg, joint } => {
                let v = self.held.level(*leg, *joint);
                self.with_lower(&v, &known);
            }
        }
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
                None => match self.held.taus(leg, v) {
                    Taus::At(taus) => taus,
                    Taus::Free => [None; 2],
                    Taus::None(deficit) => {
                        let least =
                            self.memory.deficits[leg].map_or(f64::INFINITY, |least| least.excess);
                        if deficit.excess < least {
                            self.memory.deficits[leg] = Some(deficit);
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
        let mut taus = Vec::with_capacity(options.len());
        for combination in 0..1_u64 << choices.len() {
            taus.clear();
            taus.extend(options.iter().map(|option| option[0]));
            for (bit, &leg) in choices.iter().enumerate() {
                if combination >> bit & 1 == 1 {
                    taus[leg] = options[leg][1];
                }
            }
            self.with_taus(v, &taus);
        }
    }

    /// Finds `b` from the legs' conditions, with `v` and every τ known.
    fn with_taus(&mut self, v: &Displacement, taus: &[Option<JointDisplacement>]) {
        let m = self.manipulator;
        self.held.write_upper_conditions(taus, &mut self.memory.conditions);
        match solve::all(m.task().upper.kind, &self.memory.conditions, m.closure.size) {
            None => self.loose(Section::Upper),
            Some(bs) => {
                self.upper_failed |= bs.is_empty();
                for (known, tau) in self.memory.taus.iter_mut().zip(taus) {
                    *known = tau.map(|tau| match tau {
                        JointDisplacement::Direction(_) => {
                            JointDisplacement::Direction(tau.unit_direction())
                        }
                        JointDisplacement::Value(_) => tau,
                    });
                }
                self.assemble(v, &bs);
            }
        }
    }

    /// Notes that a section can move while the actuated joints are held.
    fn loose(&mut self, section: Section) {
        let loose = &mut self.memory.outcome.assemblies.loose;
        if !loose.contains(&section) {
            loose.push(section);
        }
    }
}
