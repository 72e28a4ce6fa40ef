//! Another order of joints, in which a mechanism that is refused would decompose: two joints of a leg exchanged, or legs
//! that were written from platform to base.
//!
//! The order changes neither the joint screws at home nor the mobility there, only into which two parts a leg can be split.
//! So an order is tried by the search for splits alone; what passes is held to everything that is held of a mechanism. A
//! mechanism that cannot move (N = 0) cannot move in any order.

use super::mobility::{frame, mobility};
use super::nearby::NearbyPose;
use super::search::{SplitCandidate, candidates, splits};
use super::{Decomposition, Sections, passive};
use crate::group::subspace::{Frame, MotionSubspace, SubspaceClass};
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use std::fmt;
use std::mem::swap;

/// The largest number of partial splits that are visited for all orders together, and of orders that are held to the whole
/// test: some 20 ms.
const MOST_VISITED: usize = 20_000;
const MOST_TESTED: usize = 6;

/// The largest number of legs of which every choice is reversed.
const MOST_LEGS: usize = 8;

/// What to change in the order of a leg's joints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OrderChange {
    /// Two joints of a leg are exchanged.
    Exchange {
        /// The name of the leg.
        leg: String,
        /// The names of the joints, from base to platform as they are.
        joints: [String; 2],
    },
    /// All joints of a leg are reversed: it was written from platform to base.
    Reverse {
        /// The name of the leg.
        leg: String,
    },
}

/// An order of the joints in which a mechanism decomposes that does not as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Reordered {
    /// What to change, one change for each leg; most often it is a single one.
    pub changes: Vec<OrderChange>,
    /// The subspace of the lower section then.
    pub lower: SubspaceClass,
    /// The subspace of the upper section then.
    pub upper: SubspaceClass,
}

impl OrderChange {
    /// The name of the leg.
    pub fn leg(&self) -> &str {
        match self {
            Self::Exchange { leg, .. } | Self::Reverse { leg } => leg,
        }
    }
}

impl fmt::Display for OrderChange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exchange { leg, joints: [a, b] } => write!(f, "leg {leg}: exchange {a} and {b}"),
            Self::Reverse { leg } => {
                write!(f, "leg {leg}: reverse its joints, which run from base to platform")
            }
        }
    }
}

impl fmt::Display for Reordered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (number, change) in self.changes.iter().enumerate() {
            write!(f, "{}{change}", if number == 0 { "" } else { "; " })?;
        }
        match &self.upper {
            SubspaceClass::Identity => {
                write!(f, ": then all its legs move in one subspace, {}", self.lower.name())
            }
            upper => {
                let (lower, upper) = (self.lower.name(), upper.name());
                write!(f, ": then it decomposes into {lower} and {upper}")
            }
        }
    }
}

/// A change of the order of a leg's joints, which are given by their numbers.
#[derive(Clone, Copy)]
enum Change {
    Exchange(usize, usize),
    Reverse,
}

impl Change {
    fn apply(self, leg: &mut Leg) {
        match self {
            Self::Exchange(a, b) => leg.joints.swap(a, b),
            Self::Reverse => leg.joints.reverse(),
        }
    }

    fn named(self, leg: &Leg) -> OrderChange {
        let name = |joint: usize| leg.joints[joint].name.clone();
        match self {
            Self::Exchange(a, b) => {
                OrderChange::Exchange { leg: leg.name.clone(), joints: [name(a), name(b)] }
            }
            Self::Reverse => OrderChange::Reverse { leg: leg.name.clone() },
        }
    }
}

/// The changes of an order, each with the number of its leg.
type Changes = Vec<(usize, Change)>;

/// Which exchanges are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Exchanges {
    /// Those of neighbours: the mechanism moves as it is, and may be meant so.
    Neighbours,
    /// Those of any two joints of a leg: it does not move as its screws at home say.
    Any,
}

/// The first order, of those with the fewest and nearest changes, in which a mechanism decomposes; `None` if there is none
/// among those that are tried.
pub(super) fn better_order(mechanism: &Mechanism, exchanges: Exchanges) -> Option<Reordered> {
    let frame = frame(mechanism);
    let screws: Vec<_> = mechanism.legs.iter().flat_map(Leg::screws).collect();
    let lambda = MotionSubspace::span(frame, &screws).dimension();
    let as_it_is: Vec<Vec<SplitCandidate>> =
        mechanism.legs.iter().map(|leg| candidates(leg, &frame)).collect();
    let mut search = Search { mechanism, frame, lambda, candidates: as_it_is, visited: 0 };
    let mut tested = 0;
    for changes in orders(mechanism, exchanges) {
        if search.visited >= MOST_VISITED || tested >= MOST_TESTED {
            return None;
        }
        if !search.splits(&changes) {
            continue;
        }
        tested += 1;
        if let Some(found) = decomposed(mechanism, &changes) {
            let named = |&(leg, change): &(usize, Change)| change.named(&mechanism.legs[leg]);
            let changes = changes.iter().map(named).collect();
            return Some(Reordered { changes, lower: found.lower, upper: found.upper });
        }
    }
    None
}

/// The preferred decomposition of a mechanism with changes.
fn decomposed(mechanism: &Mechanism, changes: &Changes) -> Option<Decomposition> {
    let changed = changed_by(mechanism, changes);
    let report = mobility(&changed).ok()?;
    passive(&changed, &report).ok()?.into_iter().next()
}

/// A mechanism with changes.
fn changed_by(mechanism: &Mechanism, changes: &Changes) -> Mechanism {
    let mut changed = mechanism.clone();
    for &(leg, change) in changes {
        change.apply(&mut changed.legs[leg]);
    }
    changed
}

/// The orders to try: exchanges of neighbours in one leg, the same in all legs with the same joints, exchanges of any two
/// joints likewise, and legs reversed.
fn orders(mechanism: &Mechanism, exchanges: Exchanges) -> Vec<Changes> {
    let legs = &mechanism.legs;
    let longest = legs.iter().map(|leg| leg.joints.len()).max().unwrap_or(0);
    let mut orders: Vec<Changes> = vec![];
    for neighbours in [true, false] {
        if !neighbours && exchanges == Exchanges::Neighbours {
            break;
        }
        let pairs: Vec<(usize, usize)> = (0..longest)
            .flat_map(|b| (0..b).map(move |a| (a, b)))
            .filter(|(a, b)| (b - a == 1) == neighbours)
            .collect();
        let exchanged = |of: &[usize], (a, b): (usize, usize)| -> Changes {
            of.iter().map(|&leg| (leg, Change::Exchange(a, b))).collect()
        };
        for of in (0..legs.len()).map(|leg| vec![leg]).chain(alike(legs)) {
            let count = legs[of[0]].joints.len();
            orders.extend(pairs.iter().filter(|(_, b)| *b < count).map(|&p| exchanged(&of, p)));
        }
    }
    if legs.len() <= MOST_LEGS {
        // Neither none nor all: with every leg reversed, the mechanism makes the inverse motion.
        let choices = 1..(1_usize << legs.len()) - 1;
        let mut reversed: Vec<Changes> = choices
            .map(|choice| (0..legs.len()).filter(move |leg| choice >> leg & 1 == 1))
            .map(|of| of.map(|leg| (leg, Change::Reverse)).collect())
            .collect();
        // A choice and all other legs are each other's inverse. Actuators tell the right one: they are near the base.
        reversed.sort_by_key(|changes| (height_of_actuators(legs, changes), changes.len()));
        orders.extend(reversed);
    }
    orders
}

/// The numbers of all legs with the same kinds of joints, for each such kind of leg of which there are several.
fn alike(legs: &[Leg]) -> Vec<Vec<usize>> {
    let kinds = |leg: &Leg| -> Vec<&'static str> {
        leg.joints.iter().map(|joint| joint.kind.name()).collect()
    };
    let mut groups: Vec<Vec<usize>> = vec![];
    for number in 0..legs.len() {
        match groups.iter_mut().find(|group| kinds(&legs[group[0]]) == kinds(&legs[number])) {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    groups.retain(|group| group.len() > 1);
    groups
}

/// The numbers of joints below the actuated ones, if some legs are reversed.
fn height_of_actuators(legs: &[Leg], reversed: &Changes) -> usize {
    let of_leg = |(number, leg): (usize, &Leg)| -> usize {
        let turned = reversed.iter().any(|(other, _)| *other == number);
        let below = |joint: usize| if turned { leg.joints.len() - 1 - joint } else { joint };
        leg.joints.iter().enumerate().filter(|(_, j)| j.actuated).map(|(i, _)| below(i)).sum()
    };
    legs.iter().enumerate().map(of_leg).sum()
}

/// The search for splits of a mechanism with changes.
struct Search<'a> {
    mechanism: &'a Mechanism,
    frame: Frame,
    lambda: usize,
    /// The ways to split each leg as it is.
    candidates: Vec<Vec<SplitCandidate>>,
    visited: usize,
}

impl Search<'_> {
    /// Whether a mechanism with changes splits into two subgroups.
    fn splits(&mut self, changes: &Changes) -> bool {
        let mechanism = changed_by(self.mechanism, changes);
        let home = NearbyPose::home(&mechanism, &self.frame);
        let of_leg =
            |&(leg, _): &(usize, Change)| (leg, candidates(&mechanism.legs[leg], &self.frame));
        let mut changed: Vec<(usize, Vec<SplitCandidate>)> = changes.iter().map(of_leg).collect();
        changed.iter_mut().for_each(|(leg, of)| swap(&mut self.candidates[*leg], of));
        let (lambda, mut found) = (self.lambda, false);
        self.visited += splits(&self.candidates, lambda, &mut |split| {
            let sections = |&shared: &usize| Sections::new(split, &home, lambda, shared);
            found = [1, 0].iter().any(|shared| sections(shared).is_some());
            !found
        });
        changed.iter_mut().for_each(|(leg, of)| swap(&mut self.candidates[*leg], of));
        found
    }
}
