//! In which order the sections of a mechanism are solved forwards: found once, from which joints are
//! actuated and what the two subspaces are.

mod flat;

use super::{CompiledLeg, CompiledSection, Section};
use crate::chain::Chain;
use crate::chain::condition::{Condition, flat_joints};
use crate::chain::track::Track;
use crate::group::JointDisplacement;
use crate::task::Task;
use flat::Flat;

/// Why a mechanism's forward kinematics have no closed form here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoClosedForm {
    /// No set of legs fixes where the intersection motion takes place.
    #[error("its legs do not fix the lower section apart from the upper one")]
    Lower,
    /// Too few legs act on the upper section once the lower one is known.
    #[error("its legs do not fix the upper section once the lower one is known")]
    Upper,
    /// A revolute with a motor, which does not tell its turns, on the axis of a screw, which counts them.
    #[error("it drives a revolute on the axis of a screw: each turn is another assembly")]
    Turns,
    /// A spherical joint with a motor.
    #[error("it drives a spherical joint")]
    Ball,
}

/// The order.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What each leg holds.
    pub legs: Vec<HeldLeg>,
    /// How `v` is found, up to the intersection motion.
    pub anchor: Anchor,
}

/// The slots of a leg's two chains whose joints are actuated.
#[derive(Clone, Debug)]
pub struct HeldLeg {
    pub lower: Vec<usize>,
    pub upper: Vec<usize>,
}

/// What fixes `v`, up to the intersection motion.
#[derive(Clone, Debug)]
pub enum Anchor {
    /// A leg whose lower joints are all actuated.
    Leg(usize),
    /// Two legs, each of which keeps the axis of the shared rotation on a track.
    Tracks([Tracked; 2]),
    /// A leg that keeps `v` on a level along which the intersection motion moves: the joint that does.
    Level { leg: usize, joint: usize },
    /// Legs whose imaginary joints move as one, `functional · b`: taken as the origin of the intersection
    /// motion, it leaves as many conditions on `v` as there are freedoms.
    CoupledLegs { functional: [f64; 2], legs: Vec<usize> },
    /// All displacements add up: a linear system.
    Flat(Flat),
}

/// A leg that keeps the axis on a track.
#[derive(Clone, Copy, Debug)]
pub struct Tracked {
    pub leg: usize,
    /// The one lower joint that is free, of a leg without the cut there; the one that is held, with it.
    pub joint: usize,
}

impl Plan {
    pub fn new(task: &Task, legs: &[CompiledLeg], size: f64) -> Result<Self, NoClosedForm> {
        let held: Vec<HeldLeg> = legs
            .iter()
            .map(|leg| HeldLeg { lower: held(&leg.lower), upper: held(&leg.upper) })
            .collect();
        let ball = |section: &CompiledSection, held: &[usize]| {
            matches!(section.chain, Chain::Ball(_)) && !held.is_empty()
        };
        if legs
            .iter()
            .zip(&held)
            .any(|(leg, held)| ball(&leg.lower, &held.lower) || ball(&leg.upper, &held.upper))
        {
            return Err(NoClosedForm::Ball);
        }
        if [Section::Lower, Section::Upper].iter().any(|section| loses_turns(*section, legs, &held))
        {
            return Err(NoClosedForm::Turns);
        }
        if task.lower.kind.commutes() && task.upper.kind.commutes() {
            let flat = Flat::new(task, legs, &held, size).ok_or(NoClosedForm::Lower)?;
            return Ok(Self { legs: held, anchor: Anchor::Flat(flat) });
        }
        let anchors = anchors(task, legs, &held);
        let found = !anchors.is_empty();
        let enough = |anchor: &Anchor| fixes_upper(task, legs, &held, anchor);
        match anchors.into_iter().find(enough) {
            Some(anchor) => Ok(Self { legs: held, anchor }),
            None if found => Err(NoClosedForm::Upper),
            None => Err(NoClosedForm::Lower),
        }
    }
}

/// Whether a section on one axis has screws, and actuated revolutes.
fn loses_turns(section: Section, legs: &[CompiledLeg], held: &[HeldLeg]) -> bool {
    let (mut screws, mut driven) = (false, false);
    for (leg, held) in legs.iter().zip(held) {
        let joints = match &leg.section(section).chain {
            Chain::Cylindrical(chain) => chain.joints(),
            // Chains in other subspaces have no screws.
            Chain::Planar(_) | Chain::Spherical(_) | Chain::Ball(_) | Chain::Translational(_) => {
                return false;
            }
        };
        let held = match section {
            Section::Lower => &held.lower,
            Section::Upper => &held.upper,
        };
        screws |= joints.iter().any(|joint| joint.turn != 0.0 && joint.advance != 0.0);
        driven |= held.iter().any(|&joint| joints[joint].advance == 0.0);
    }
    screws && driven
}

fn held(section: &CompiledSection) -> Vec<usize> {
    let driven =
        |joint: &usize| section.coordinates[*joint].is_some_and(|joint| joint.actuated.is_some());
    (0..3).filter(driven).collect()
}

/// The ways in which `v` can be found, the simplest first.
fn anchors(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg]) -> Vec<Anchor> {
    let mut found = Vec::new();
    let whole = |(leg, held): (&CompiledLeg, &HeldLeg)| {
        let real = leg.lower.chain.freedoms() - usize::from(leg.split_section == Section::Lower);
        held.lower.len() == real
    };
    found.extend(legs.iter().zip(held).position(whole).map(Anchor::Leg));
    if task.lower.kind.commutes() {
        let along = task.lower_intersection.sum();
        found.extend((0..legs.len()).find_map(|leg| {
            let level = |joint: &&usize| {
                let c =
                    Condition::new(&legs[leg].lower.chain, **joint, JointDisplacement::Value(0.0));
                matches!(c, Some(Condition::Flat { normal: [a, b], .. })
                    if (a * along[0] + b * along[1]).abs() <= LEVEL * a.hypot(b))
            };
            let joint = *held[leg].lower.iter().find(level)?;
            Some(Anchor::Level { leg, joint })
        }));
        return found;
    }
    if task.intersection_point.is_some() {
        let tracked: Vec<Tracked> =
            (0..legs.len()).filter_map(|leg| tracked(leg, &legs[leg], &held[leg])).collect();
        if let [first, second, ..] = *tracked {
            found.push(Anchor::Tracks([first, second]));
        }
    }
    if task.upper.kind.commutes() {
        found.extend(coupled_legs(task, legs, held));
    }
    found
}

/// The sine of an angle between a condition's normal and the intersection motion that counts as a right
/// one's complement: both are exact up to rounding.
const LEVEL: f64 = 1e-12;

fn tracked(number: usize, leg: &CompiledLeg, held: &HeldLeg) -> Option<Tracked> {
    let joint = match leg.split_section {
        Section::Upper if held.lower.len() == 2 => {
            (0..3).find(|joint| !held.lower.contains(joint))?
        }
        Section::Lower if held.lower.len() == 1 => held.lower[0],
        _ => return None,
    };
    // Of a chain with the cut there may be one that leaves the axis where it likes.
    let displacements = [JointDisplacement::Value(0.0); 3];
    let track = match leg.split_section {
        Section::Upper => Track::of_chain(&leg.lower.chain, joint, &displacements),
        Section::Lower => {
            let condition = Condition::new(&leg.lower.chain, joint, displacements[0])?;
            Track::of_condition(&condition)
        }
    };
    track.map(|_| Tracked { leg: number, joint })
}

/// The functional of `b` that the cuts of most legs follow.
fn coupled_legs(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg]) -> Option<Anchor> {
    let along = task.upper_intersection.sum();
    // With its one upper joint passive, a leg's cut is what b has beside that joint's motion.
    let functional = |leg: &CompiledLeg, held: &HeldLeg| {
        if leg.split_section == Section::Lower || !held.upper.is_empty() {
            return None;
        }
        let [_, [p, q]] = flat_joints(&leg.upper.chain)?;
        let across = q * along[0] - p * along[1];
        Some([q / across, -p / across])
    };
    let functionals: Vec<_> =
        legs.iter().zip(held).map(|(leg, held)| functional(leg, held)).collect();
    let matches_functional = |other: &Option<[f64; 2]>, wanted: &[f64; 2]| {
        other.is_some_and(|[a, b]| {
            (a - wanted[0]).abs().max((b - wanted[1]).abs()) <= LEVEL * wanted[0].hypot(wanted[1])
        })
    };
    let group = |wanted: &[f64; 2]| -> Vec<usize> {
        (0..legs.len())
            .filter(|&i| {
                let driven = legs[i].split_section == Section::Upper && !held[i].upper.is_empty();
                matches_functional(&functionals[i], wanted) || driven
            })
            .collect()
    };
    let conditions = |group: &[usize]| -> usize {
        let own = |i: &usize| legs[*i].split_section == Section::Lower || group.contains(i);
        (0..legs.len()).filter(own).map(|i| held[i].lower.len()).sum()
    };
    let best = functionals.iter().flatten().max_by_key(|wanted| conditions(&group(wanted)))?;
    let members = group(best);
    (conditions(&members) >= task.lower.dimension())
        .then_some(Anchor::CoupledLegs { functional: *best, legs: members })
}

/// Whether the legs' conditions on `b` are enough once `v` is known.
fn fixes_upper(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg], anchor: &Anchor) -> bool {
    let mut count = 0;
    let mut normals: Vec<[f64; 2]> = Vec::new();
    for (number, (leg, held)) in legs.iter().zip(held).enumerate() {
        let known = match anchor {
            Anchor::Leg(anchor) if *anchor == number => true,
            Anchor::CoupledLegs { legs, .. } if legs.contains(&number) => true,
            _ => !held.lower.is_empty(),
        };
        let split = (leg.split_section == Section::Upper && known).then_some(0);
        for joint in split.into_iter().chain(held.upper.iter().copied()) {
            count += 1;
            if let Some(Condition::Flat { normal, .. }) =
                Condition::new(&leg.upper.chain, joint, JointDisplacement::Value(0.0))
            {
                normals.push(normal);
            }
        }
    }
    if !task.upper.kind.commutes() {
        return count >= task.upper.dimension();
    }
    normals.iter().enumerate().any(|(i, [a, b])| {
        let across = |[p, q]: &[f64; 2]| (a * q - b * p).abs() > LEVEL * a.hypot(*b) * p.hypot(*q);
        normals[..i].iter().any(across)
    })
}
