//! The order in which forward kinematics solve the sections of a mechanism. It is found once, from the
//! actuated joints and the two subspaces.

mod flat;

use super::{CompiledLeg, CompiledSection, Lean, Section};
use crate::chain::Chain;
use crate::chain::condition::{Condition, flat_joints};
use crate::chain::track::Track;
use crate::group::{JointDisplacement, LocalTwist, MotionType, SubspaceKind};
use crate::task::Task;
use flat::Flat;
use nalgebra::Complex;

/// Why a mechanism's forward kinematics have no closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoClosedForm {
    /// No set of legs determines the lower displacement up to the intersection motion.
    #[error(
        "the actuated joints do not determine the lower section independently of the upper one"
    )]
    Lower,
    /// Too few legs constrain the upper section once the lower one is known.
    #[error("the actuated joints do not determine the upper section once the lower one is known")]
    Upper,
    /// An actuated revolute joint, which does not count revolutions, on the axis of a helical joint, which
    /// does.
    #[error(
        "an actuated revolute joint is on the axis of a helical joint: each revolution of it is another assembly"
    )]
    Turns,
    /// No actuated joint carries the height of a Schoenflies section.
    #[error("no actuated joint carries the height")]
    Height,
    /// The height of a leg depends on its imaginary joint, and is needed to find it.
    #[error(
        "the sections share a translation that is inclined to the direction of the height: closed forms expect that \
         the other actuated joints determine the imaginary joints, without those of a section whose height a passive \
         screw or inclined slider carries"
    )]
    Inclined,
    /// A spherical joint is actuated.
    #[error("a spherical joint is actuated")]
    Ball,
    /// Every leg is solved by itself, and what all actuated joints allow together is not known in closed form.
    #[error("each leg is solved by itself: their actuated joints are equations that have no order")]
    Whole,
}

/// The order in which forward kinematics solve the sections.
#[derive(Clone, Debug)]
pub struct Plan {
    /// The actuated joints of each leg.
    pub legs: Vec<HeldLeg>,
    /// What determines `v` up to the intersection motion.
    pub anchor: Anchor,
}

/// The numbers of the actuated joints in a leg's two chains.
#[derive(Clone, Debug)]
pub struct HeldLeg {
    pub lower: Vec<usize>,
    pub upper: Vec<usize>,
}

/// What determines `v` up to the intersection motion.
#[derive(Clone, Debug)]
pub enum Anchor {
    /// The subspaces share the identity alone: the actuated joints of the lower section fix `v`, and those of
    /// the upper section fix `b`, each on their own.
    Sections,
    /// A leg whose lower joints are all actuated.
    Leg(usize),
    /// Two legs, each of which keeps the axis of the intersection motion, a rotation, on a track.
    Tracks([Tracked; 2]),
    /// A leg with an actuated joint that fixes the component of `v` perpendicular to the intersection motion;
    /// `joint` is the number of that joint in the lower chain.
    Level { leg: usize, joint: usize },
    /// Coupled legs: the displacement of each along the intersection motion is `functional · b`, up to a known
    /// constant. Measured from it, the legs impose as many conditions on `v` as it has freedoms.
    CoupledLegs { functional: LocalTwist, legs: Vec<usize> },
    /// Both subspaces are commutative: the pose solves a linear system.
    Flat(Flat),
}

/// A leg that keeps the axis of the intersection motion on a track.
#[derive(Clone, Copy, Debug)]
pub struct Tracked {
    pub leg: usize,
    /// The number of a joint in the lower chain: the only free one of a leg that is split in its upper section;
    /// the actuated one of a leg that is split in its lower section.
    pub joint: usize,
}

impl Plan {
    pub fn new(task: &Task, legs: &[CompiledLeg], size: f64) -> Result<Self, NoClosedForm> {
        if legs.iter().any(|leg| leg.whole.is_some()) {
            return Err(NoClosedForm::Whole);
        }
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
        if task.height.is_some() && !legs.iter().any(CompiledLeg::drives_height) {
            return Err(NoClosedForm::Height);
        }
        // The chain of a leg that leans is not known before its own height.
        let inclined = task.slope() != 0.0;
        let unknown = |(leg, held): (&CompiledLeg, &HeldLeg)| match leg.lean {
            Some(Lean { section: Section::Lower, .. }) if !leg.drives_height() => {
                !held.lower.is_empty()
            }
            Some(Lean { section: Section::Upper, .. }) if !leg.drives_height() => {
                !held.upper.is_empty()
            }
            Some(_) | None => false,
        };
        if inclined && legs.iter().zip(&held).any(unknown) {
            return Err(NoClosedForm::Inclined);
        }
        if task.shared().is_none() {
            if !fixes(task.lower.kind, &conditions(legs, &held, Section::Lower)) {
                return Err(NoClosedForm::Lower);
            }
            if !fixes(task.upper.kind, &conditions(legs, &held, Section::Upper)) {
                return Err(NoClosedForm::Upper);
            }
            return Ok(Self { legs: held, anchor: Anchor::Sections });
        }
        if task.lower.kind.commutes() && task.upper.kind.commutes() {
            let flat = Flat::new(task, legs, &held, size).ok_or(NoClosedForm::Lower)?;
            return Ok(Self { legs: held, anchor: Anchor::Flat(flat) });
        }
        let anchors = anchors(task, legs, &held);
        let found = !anchors.is_empty();
        let enough = |anchor: &Anchor| fixes_upper(task, legs, &held, anchor);
        let lifts = legs.iter().filter(|leg| leg.drives_height()).count();
        match anchors.into_iter().find(enough) {
            Some(anchor) => Ok(Self { legs: held, anchor }),
            // The heights of several legs are conditions on the imaginary joints.
            None if inclined && lifts > 1 => Err(NoClosedForm::Inclined),
            None if found => Err(NoClosedForm::Upper),
            None => Err(NoClosedForm::Lower),
        }
    }
}

/// Whether a section on one axis has both helical joints and actuated revolute joints. Locked revolute joints have
/// no revolutions to lose.
fn loses_turns(section: Section, legs: &[CompiledLeg], held: &[HeldLeg]) -> bool {
    let (mut screws, mut driven) = (false, false);
    for (leg, held) in legs.iter().zip(held) {
        let own = leg.section(section);
        let joints = match &own.chain {
            Chain::Cylindrical(chain) => chain.joints(),
            // Chains in other subspaces have no helical joints.
            Chain::Rigid
            | Chain::Part(_)
            | Chain::Planar(_)
            | Chain::Spherical(_)
            | Chain::Ball(_)
            | Chain::Translational(_)
            | Chain::Spatial(_) => return false,
        };
        let held = match section {
            Section::Lower => &held.lower,
            Section::Upper => &held.upper,
        };
        screws |= joints.iter().any(|joint| joint.rotation != 0.0 && joint.advance != 0.0);
        let turns = |&joint: &usize| joints[joint].advance == 0.0 && !own.is_locked(joint);
        driven |= held.iter().any(turns);
    }
    screws && driven
}

/// The numbers of the joints of a chain that are actuated, or always locked.
fn held(section: &CompiledSection) -> Vec<usize> {
    (0..3).filter(|&joint| section.is_held(joint)).collect()
}

/// The anchors from which `v` can be found, the simplest first.
fn anchors(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg]) -> Vec<Anchor> {
    let mut found = Vec::new();
    let whole = |(leg, held): (&CompiledLeg, &HeldLeg)| {
        let real = leg.lower.chain.freedoms() - usize::from(leg.split_section == Section::Lower);
        held.lower.len() == real
    };
    found.extend(legs.iter().zip(held).position(whole).map(Anchor::Leg));
    if task.lower.kind.commutes() {
        found.extend((0..legs.len()).find_map(|leg| {
            let level = |joint: &&usize| {
                let held = Condition::new(&legs[leg].lower.chain, **joint, HOME);
                held.is_some_and(|condition| is_level(&condition, task))
            };
            let joint = *held[leg].lower.iter().find(level)?;
            Some(Anchor::Level { leg, joint })
        }));
        return found;
    }
    if task.shared() == Some(MotionType::Rotation) {
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

/// A joint at home.
const HOME: JointDisplacement = JointDisplacement::Value(0.0);

/// A condition's normal and the intersection motion are perpendicular where the cosine of the angle between
/// them is below this: both are exact up to rounding.
const LEVEL: f64 = 1e-12;

/// Whether a displacement of a commutative lower section along the intersection motion keeps a condition on it.
fn is_level(condition: &Condition, task: &Task) -> bool {
    let along = task.lower_intersection.sum();
    matches!(condition, Condition::Flat { normal, .. } if normal.dot(&along).abs() <= LEVEL * normal.norm())
}

/// The track on which a leg keeps the axis of the intersection motion, if it does.
fn tracked(number: usize, leg: &CompiledLeg, held: &HeldLeg) -> Option<Tracked> {
    let joint = match leg.split_section {
        Section::Upper if held.lower.len() == 2 => {
            (0..3).find(|joint| !held.lower.contains(joint))?
        }
        Section::Lower if held.lower.len() == 1 => held.lower[0],
        _ => return None,
    };
    // A held joint of a chain with the imaginary joint does not always constrain the axis.
    let displacements = [JointDisplacement::Value(0.0); 3];
    let track = match leg.split_section {
        Section::Upper => Track::of_chain(&leg.lower.chain, joint, &displacements, Complex::ZERO),
        Section::Lower => {
            let condition = Condition::new(&leg.lower.chain, joint, displacements[0])?;
            Track::of_condition(&condition)
        }
    };
    track.map(|_| Tracked { leg: number, joint })
}

/// The functional of `b` that gives the displacement along the intersection motion of the largest number of
/// legs, if those determine `v`.
fn coupled_legs(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg]) -> Option<Anchor> {
    let along = task.upper_intersection.sum();
    // With its one upper joint passive, a leg's displacement along I is the component of b along I when b is
    // decomposed along I and that joint's motion.
    let functional = |leg: &CompiledLeg, held: &HeldLeg| {
        if leg.split_section == Section::Lower || !held.upper.is_empty() {
            return None;
        }
        let [_, p, q] = flat_joints(&leg.upper.chain)?;
        let across = p.cross(&q);
        Some(across / across.dot(&along))
    };
    let functionals: Vec<_> =
        legs.iter().zip(held).map(|(leg, held)| functional(leg, held)).collect();
    let matches_functional = |other: &Option<LocalTwist>, wanted: &LocalTwist| {
        other.is_some_and(|other| (other - wanted).amax() <= LEVEL * wanted.norm())
    };
    let group = |wanted: &LocalTwist| -> Vec<usize> {
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

/// The conditions that the actuated joints of a section put on its displacement, each joint at home.
fn conditions(legs: &[CompiledLeg], held: &[HeldLeg], section: Section) -> Vec<Condition> {
    let of_leg = |(leg, held): (&CompiledLeg, &HeldLeg)| -> Vec<Condition> {
        let held = match section {
            Section::Lower => &held.lower,
            Section::Upper => &held.upper,
        };
        let chain = &leg.section(section).chain;
        held.iter().filter_map(|&joint| Condition::new(chain, joint, HOME)).collect()
    };
    legs.iter().zip(held).flat_map(of_leg).collect()
}

/// Whether conditions on the displacements of a subspace determine finitely many: there are enough of them. In
/// a commutative subspace as many have to be independent; in the others, home would not tell.
fn fixes(kind: SubspaceKind, conditions: &[Condition]) -> bool {
    if kind == SubspaceKind::Identity || !kind.commutes() {
        return conditions.len() >= kind.dimension();
    }
    let normals = conditions.iter().filter_map(|condition| match condition {
        Condition::Flat { normal, .. } => Some(*normal),
        _ => None,
    });
    let mut independent: Vec<LocalTwist> = Vec::new();
    for normal in normals {
        let rest = independent.iter().fold(normal, |rest, known| rest - known * known.dot(&rest));
        if rest.norm() > LEVEL * normal.norm() {
            independent.push(rest.normalize());
        }
    }
    independent.len() >= kind.dimension()
}

/// Whether the legs' conditions determine `b` once `v` is known.
fn fixes_upper(task: &Task, legs: &[CompiledLeg], held: &[HeldLeg], anchor: &Anchor) -> bool {
    let mut found = Vec::new();
    for (number, (leg, held)) in legs.iter().zip(held).enumerate() {
        let fixes_tau = |&joint: &usize| {
            let held = Condition::new(&leg.lower.chain, joint, HOME);
            held.is_some_and(|condition| !task.lower.kind.commutes() || !is_level(&condition, task))
        };
        let known = match anchor {
            Anchor::Leg(anchor) if *anchor == number => true,
            Anchor::CoupledLegs { legs, .. } if legs.contains(&number) => true,
            _ => held.lower.iter().any(fixes_tau),
        };
        let split = (leg.split_section == Section::Upper && known).then_some(0);
        let joints = split.into_iter().chain(held.upper.iter().copied());
        found.extend(joints.filter_map(|joint| Condition::new(&leg.upper.chain, joint, HOME)));
    }
    fixes(task.upper.kind, &found)
}
