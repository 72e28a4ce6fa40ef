//! The search for an order in which the joints can be found one after the other.

use super::StepName;
use super::element::Kind;
use super::nodes::Nodes;
use super::objects::{Leg, Loop};
use super::step::Candidate;
use std::collections::{HashMap, HashSet};

/// So many orders are tested, at most.
const MOST_TESTED: usize = 40;
/// The search.
pub(super) struct Search<'l, 'n, 'a> {
    pub leg: Leg<'l>,
    pub nodes: &'n mut Nodes<'a>,
    pub actuated: &'l [bool],
    found: HashMap<u32, Vec<Candidate>>,
    dead: HashSet<(u32, usize)>,
    tested: usize,
    /// So many choices has an order, at most.
    most_choices: usize,
    /// The fewest joints that were left over, as bits.
    pub stuck: u32,
    /// Whether an order was cut off by the number of its choices.
    pub full: bool,
}

impl<'l, 'n, 'a> Search<'l, 'n, 'a> {
    pub fn new(
        leg: Leg<'l>,
        nodes: &'n mut Nodes<'a>,
        actuated: &'l [bool],
        most_choices: usize,
    ) -> Self {
        Self {
            leg,
            nodes,
            actuated,
            found: HashMap::new(),
            dead: HashSet::new(),
            tested: 0,
            most_choices,
            stuck: u32::MAX,
            full: false,
        }
    }

    /// The first order that passes the test.
    pub fn run<P>(
        &mut self,
        test: &mut impl FnMut(&mut Nodes<'a>, &[Candidate]) -> Option<P>,
    ) -> Option<P> {
        self.deeper(self.all(), &mut Vec::new(), test)
    }

    /// The order of a congruent leg, if it passes the test and no step of it is weak here.
    pub fn known<P>(
        &mut self,
        order: &[StepName],
        test: &mut impl FnMut(&mut Nodes<'a>, &[Candidate]) -> Option<P>,
    ) -> Option<P> {
        let joints = self.leg.elements.len();
        let (mut unknown, mut steps) = (self.all(), Vec::new());
        for name in order.iter().filter(|name| name.invariant.is_some()) {
            unknown &= !(1 << name.joint);
            let seen = Loop { joint: name.joint, joints, unknown };
            let candidates = self.leg.candidates(self.nodes, &seen);
            let same = |one: &Candidate| one.kernel.named(one.joint) == *name && !one.rank.0;
            steps.push(candidates.into_iter().find(same)?);
        }
        test(self.nodes, &steps)
    }

    /// The joints that are to be found.
    fn all(&self) -> u32 {
        let elements = self.leg.elements.iter().enumerate();
        let unknown = elements.filter(|(_, element)| !element.is_given());
        unknown.fold(0, |all, (joint, _)| all | 1 << joint)
    }

    /// Whether an order was found that did not pass.
    pub fn untrue(&self) -> bool {
        self.tested > 0
    }

    /// The joints of a set that are no balls.
    fn single(&self, unknown: u32) -> impl Iterator<Item = usize> + use<'l, 'n, 'a> {
        let elements = self.leg.elements;
        (0..elements.len())
            .filter(move |&i| unknown & (1 << i) != 0 && elements[i].kind != Kind::Ball)
    }

    fn candidates(&mut self, unknown: u32) -> Vec<Candidate> {
        if let Some(found) = self.found.get(&unknown) {
            return found.clone();
        }
        let joints = self.leg.elements.len();
        let mut found = Vec::new();
        for joint in self.single(unknown) {
            let seen = Loop { joint, joints, unknown: unknown & !(1 << joint) };
            found.extend(self.leg.candidates(self.nodes, &seen));
        }
        self.found.insert(unknown, found.clone());
        found
    }

    fn deeper<P>(
        &mut self,
        unknown: u32,
        steps: &mut Vec<Candidate>,
        test: &mut impl FnMut(&mut Nodes<'a>, &[Candidate]) -> Option<P>,
    ) -> Option<P> {
        let left = self.single(unknown).count();
        if left == 0 {
            self.tested += 1;
            return test(self.nodes, steps);
        }
        let choices = steps.iter().filter(|step| step.kernel.chooses()).count();
        if self.tested >= MOST_TESTED || self.dead.contains(&(unknown, choices)) {
            return None;
        }
        if left < self.single(self.stuck).count() {
            self.stuck = unknown;
        }
        let candidates = self.candidates(unknown);
        let motor = |one: &Candidate| self.actuated.get(one.joint).copied().unwrap_or(false);
        let waits = self.single(unknown).any(|joint| self.actuated.get(joint) == Some(&true))
            && !candidates.iter().any(motor);
        let mut ranked = Vec::new();
        for one in candidates {
            let motor = self.actuated.get(one.joint) == Some(&true);
            // Where no motor can be found yet, a joint after which one can.
            let leads = waits && {
                let next = self.candidates(unknown & !(1 << one.joint));
                next.iter().any(|then| self.actuated.get(then.joint) == Some(&true))
            };
            let (weak, chooses, kind, cost) = one.rank;
            ranked.push(((!motor, !leads, weak, chooses, kind, cost, one.joint), one));
        }
        ranked.sort_by_key(|(rank, _)| *rank);
        for (_, one) in ranked {
            if one.kernel.chooses() && choices == self.most_choices {
                self.full = true;
                continue;
            }
            steps.push(one);
            let found = self.deeper(unknown & !(1 << one.joint), steps, test);
            if found.is_some() {
                return found;
            }
            steps.pop();
        }
        self.dead.insert((unknown, choices));
        None
    }
}
