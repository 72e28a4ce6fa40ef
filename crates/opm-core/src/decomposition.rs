//! Decomposition of a mechanism into two partial subspaces. Every leg is split into a lower part
//! that moves in one group `A` and an upper part that moves in another group `B`. The two groups
//! share a one-parameter group of displacements: the intersection motion.
//!
//! Where a leg's upper part does not contain the intersection motion, an *imaginary joint* along it
//! bridges the split. This joint does not exist physically; it divides the leg's kinematics into
//! two problems in small groups. See Selvi, "Kinematic analysis of overconstrained manipulators
//! with partial subspaces using decomposition method", Robotica, section 2.
//!
//! A mechanism whose legs all move in one group is a decomposition with nothing to split: its
//! upper group is the identity. Two groups may also share nothing but the identity. Then the pose
//! fixes the displacement of each section, and no leg has an imaginary joint.
//!
//! A split found from the screws at home is valid for all poses: whatever the joint values, a leg's
//! lower part displaces by elements of `A` and its upper part by elements of `B`.

mod architecture;
mod doubts;
mod element;
pub(crate) mod height;
mod imaginary;
pub mod mobility;
mod near;
mod nearby;
mod odd;
mod order;
mod reorder;
mod reroot;
mod search;
mod survey;
pub(crate) mod whole;

#[cfg(test)]
pub(crate) mod samples;

pub use doubts::{doubts, missing_motors};
pub use height::{HeightMiss, HeightReason};
pub use near::{JointMiss, NearMiss, Snapped, nearly, slightly_off, snap};
pub use reorder::{OrderChange, Reordered};
pub use reroot::rerooted;
pub use survey::{Applies, LegSurvey, Outside, PlatformMotion, Survey, survey};
pub use whole::{Constrained, PlatformSet, WholeMiss};

use crate::chain::whole::WholeLeg;
use crate::decomposition::mobility::{HomeSingularity, Mobility, MobilityError, frame, mobility};
use crate::group::SubspaceKind;
use crate::group::subspace::{Fit, Frame, MotionSubspace, SubspaceClass, fit};
use crate::mechanism::Mechanism;
use crate::mechanism::file::FileUnits;
use crate::mechanism::joint::Joint;
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use nalgebra::Vector6;
use nearby::{NearbyPart, NearbyPose, group_of};
use reorder::Exchanges;
use search::SplitCandidate;
use std::cmp::Reverse;
use thiserror::Error;

/// One freedom of a leg: a joint, and one of its screws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Freedom {
    /// Index of the joint in its leg, counted from the base.
    pub joint: usize,
    /// Index of the freedom in its joint, in the order of
    /// [`Joint::screws`](crate::mechanism::joint::Joint::screws).
    pub index: usize,
}

impl Freedom {
    /// All freedoms of a leg, from base to platform.
    pub(crate) fn of_leg(leg: &Leg) -> Vec<Self> {
        let of =
            |(joint, count): (usize, usize)| (0..count).map(move |index| Self { joint, index });
        leg.joints.iter().map(Joint::freedoms).enumerate().flat_map(of).collect()
    }
}

/// How a leg is split into a lower and an upper part.
#[derive(Clone, Debug, PartialEq)]
pub struct LegSplit {
    /// The freedoms that move in the lower subspace, from base to platform.
    pub lower: Vec<Freedom>,
    /// The freedoms that move in the upper subspace, from base to platform.
    pub upper: Vec<Freedom>,
    /// Whether an imaginary joint bridges the split.
    pub imaginary: bool,
    /// How the leg is solved whole; `None` where it is solved by its sections. A whole leg has all freedoms in `lower`.
    pub whole: Option<WholeLeg>,
}

/// A split of a mechanism into a lower and an upper section.
///
/// ```
/// use opm_core::decomposition::decompose;
/// use opm_core::mechanism::{examples, file};
///
/// let text = examples::find("plano-spherical-5dof-joints").expect("it is shipped").text;
/// let mechanism = file::read(text)?.mechanism;
/// let preferred = &decompose(&mechanism)?[0];
/// assert_eq!((preferred.lower.name(), preferred.upper.name()), ("planar", "spherical"));
/// assert_eq!(preferred.intersection.name(), "rotation");
/// // lambda = 5, N = 5, J = 3, M = 2 (section 3.1 of the paper).
/// let d = preferred;
/// let numbers = [d.lambda, d.mobility, d.imaginary_joints, d.first_section_motions];
/// assert_eq!(numbers, [5, 5, 3, 2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Decomposition {
    /// Dimension of the span of all joint screws, `lambda`.
    pub lambda: usize,
    /// Mobility of the mechanism, `N`.
    pub mobility: usize,
    /// The group `A` in which the lower parts of the legs move.
    pub lower: SubspaceClass,
    /// The group `B` in which the upper parts of the legs move; the identity where all legs move in
    /// one group.
    pub upper: SubspaceClass,
    /// The motion that both groups share: a rotation, a translation or a helical motion; the
    /// identity where they share nothing else. Its axis points in the positive direction: to the side that the mechanism's
    /// [`TaskHints`](crate::mechanism::TaskHints) give, or else up.
    pub intersection: SubspaceClass,
    /// What constrains the platform where its motion is no group, and no product of two.
    pub constrained: Option<Constrained>,
    /// The split of each leg, in the order of the mechanism's legs.
    pub legs: Vec<LegSplit>,
    /// The mobility of the upper section with its imaginary joints, `J`, at most `mobility`; zero where
    /// the groups share no motion. The number of these joints may be another (see `redundancy` and
    /// `upper_mobility`); `legs` says which legs have one.
    pub imaginary_joints: usize,
    /// The number of motions left to the lower section with the imaginary joints held, `M = N − J`;
    /// with the upper section held, where the groups share no motion.
    pub first_section_motions: usize,
    /// Mobility of the upper section without imaginary joints, `F0`. It is 0 if the upper section
    /// is passive, that is, driven by the imaginary joints alone.
    pub upper_mobility: usize,
    /// The number of imaginary joints in excess of the motions that they give to the upper section.
    pub redundancy: usize,
    /// The largest distance of a joint screw from the group that it was assigned to: the sine of an
    /// angle, with lengths divided by the mechanism's size. For exact input it is only rounding.
    pub deviation: f64,
}

/// Why a mechanism cannot be decomposed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DecomposeError {
    /// Legs or joints are missing, or numbers are not finite.
    #[error(transparent)]
    Mobility(#[from] MobilityError),
    /// The mechanism is a structure: its mobility is zero.
    #[error(
        "the mechanism cannot move: its mobility N is 0 (its joint screws have rank lambda = \
         {lambda}){}",
        nearly_text(near.as_deref())
    )]
    NoFreedom {
        /// Dimension of the span of all joint screws.
        lambda: usize,
        /// What it misses, if it is nearly a mechanism that moves.
        near: Option<Box<NearMiss>>,
    },
    /// The home pose is singular, so that it does not represent other poses.
    #[error(
        "the home pose is singular ({}); expected the joints at a regular pose{}{}",
        list(singularities),
        reordered_text(order.as_deref()),
        nearly_text(near.as_deref())
    )]
    SingularHome {
        /// Every respect in which home is singular.
        singularities: Vec<HomeSingularity>,
        /// An order of the joints in which the mechanism decomposes.
        order: Option<Box<Reordered>>,
        /// What the mechanism misses, if it is nearly one that decomposes.
        near: Option<Box<NearMiss>>,
    },
    /// No joint is actuated.
    #[error(
        "no joint is actuated, expected `actuated = true` in at least one; the mobility is N = {mobility}"
    )]
    NoActuator {
        /// Mobility of the mechanism, `N`.
        mobility: usize,
    },
    /// The actuators do not control every motion of the platform.
    #[error(
        "the actuators do not control the platform: {actuators} actuated {} {controlled} of \
         the {mobility} freedoms of the mechanism; with all actuators locked, these motions are \
         free: {}",
        if *actuators == 1 { "freedom controls" } else { "freedoms control" },
        motions(free, *units)
    )]
    Loose {
        /// Mobility of the mechanism, `N`.
        mobility: usize,
        /// The number of freedoms of the actuated joints.
        actuators: usize,
        /// The number of the mechanism's freedoms that they control.
        controlled: usize,
        /// Independent motions of the platform with all actuators locked.
        free: Vec<SubspaceClass>,
        /// The units of the mechanism's file, for messages.
        units: FileUnits,
    },
    /// No split of the legs gives two groups that share exactly a one-parameter group.
    #[error(
        "no partial subspaces (lambda = {lambda}, mobility N = {mobility}){}; {}{}",
        subspace.as_deref().map(|group| format!(": {}", one_group(group, *units))).unwrap_or_default(),
        match height {
            Some(height) => height.to_string(),
            None => format!(
                "opm needs legs that split between two subgroups of less than {lambda} dimensions that share \
                 a one-parameter motion"
            ),
        },
        match (order, near, height, odd) {
            (Some(order), ..) => reordered_text(Some(order)),
            (None, Some(near), ..) => nearly_text(Some(near)),
            (None, None, None, Some(odd)) => format!(
                "; only joint {} of leg {} does not fit such a split: {}",
                odd.joint,
                odd.leg,
                odd.reason()
            ),
            (None, ..) => whole.as_deref().map_or_else(String::new, |whole| {
                format!("; nor can its legs be solved by themselves: {whole}")
            }),
        }
    )]
    NoPartialSubspaces {
        /// Dimension of the span of all joint screws.
        lambda: usize,
        /// Mobility of the mechanism, `N`.
        mobility: usize,
        /// An order of the joints in which the mechanism decomposes.
        order: Option<Box<Reordered>>,
        /// What the mechanism misses, if it is nearly one that decomposes.
        near: Option<Box<NearMiss>>,
        /// Otherwise, the joint without which there would be such a split, if there is exactly one.
        odd: Option<Box<JointMiss>>,
        /// What closed forms of the group miss, if it is a Schoenflies group.
        height: Option<Box<HeightMiss>>,
        /// Why the legs are not solved whole either, if that was tried.
        whole: Option<Box<WholeMiss>>,
        /// The group in which all legs move together; `None` if the span of all joint screws is not
        /// a subgroup.
        subspace: Option<Box<SubspaceClass>>,
        /// The units of the mechanism's file, for messages.
        units: FileUnits,
    },
}

/// What a mechanism is whose legs all move in one group.
fn one_group(group: &SubspaceClass, units: FileUnits) -> String {
    match group {
        SubspaceClass::Full => "the joints of all legs together move in all six dimensions".into(),
        group => {
            format!(
                "all legs move in one subgroup, {}",
                motions(std::slice::from_ref(group), units)
            )
        }
    }
}

/// Motions of the platform, as a part of a message.
fn motions(motions: &[SubspaceClass], units: FileUnits) -> String {
    let (size, unit) = (units.length.factor(), units.length.symbol());
    list(&motions.iter().map(|motion| motion.in_unit(size, unit)).collect::<Vec<_>>())
}

/// A better order of the joints, as a part of a message.
fn reordered_text(order: Option<&Reordered>) -> String {
    order.map_or_else(String::new, |order| format!("; {order}"))
}

/// What a mechanism misses, as a part of a message.
fn nearly_text(near: Option<&NearMiss>) -> String {
    near.map_or_else(String::new, |near| {
        let tolerance = near::shown(near.tolerance, Quantity::Length, near.units);
        format!("; it would decompose within a tolerance of {tolerance}: {near}")
    })
}

fn list<T: ToString>(items: &[T]) -> String {
    items.iter().map(T::to_string).collect::<Vec<_>>().join("; ")
}

/// All valid decompositions of a mechanism, the preferred one first.
///
/// The order of preference is: a passive upper section, then no redundant imaginary joints, then
/// fewer joints divided between the sections, then more freedoms in the lower section, then the
/// order of the splits of the legs by name. At most [`MAX_DECOMPOSITIONS`] are listed.
///
/// # Errors
/// [`DecomposeError`] if the mechanism is incomplete, cannot move, is singular at home, has
/// actuators that do not control the platform, or has no partial subspaces.
pub fn decompose(mechanism: &Mechanism) -> Result<Vec<Decomposition>, DecomposeError> {
    let report = mobility(mechanism)?;
    found_or_near(mechanism, &report, regular_home(&report))?;
    check_actuators(&report)?;
    found_or_near(mechanism, &report, whole::split_or_whole(mechanism, &report))
}

/// All valid decompositions of a mechanism, as [`decompose`], whatever its actuators: none yet, or too few.
///
/// # Errors
/// [`DecomposeError`] if the mechanism is incomplete, cannot move, is singular at home other than by its actuators, or
/// has no partial subspaces.
pub fn search_all(mechanism: &Mechanism) -> Result<Vec<Decomposition>, DecomposeError> {
    let report = mobility(mechanism)?;
    found_or_near(mechanism, &report, any(mechanism, &report))
}

/// As [`search_all`]. Errors do not say yet whether the mechanism nearly decomposes.
fn any(mechanism: &Mechanism, report: &Mobility) -> Result<Vec<Decomposition>, DecomposeError> {
    regular_home(report)?;
    whole::split_or_whole(mechanism, report)
}

/// The same for splits of the legs alone.
fn passive(mechanism: &Mechanism, report: &Mobility) -> Result<Vec<Decomposition>, DecomposeError> {
    regular_home(report)?;
    ranked(mechanism, report)
}

/// Checks that the mechanism moves and that the screws at home are those of other poses, too. A parallel singularity
/// is none of the screws: it depends on which joints are actuated.
fn regular_home(report: &Mobility) -> Result<(), DecomposeError> {
    if report.mobility == 0 {
        return Err(DecomposeError::NoFreedom { lambda: report.lambda, near: None });
    }
    let of_screws = |s: &&HomeSingularity| !matches!(s, HomeSingularity::Parallel { .. });
    let singularities: Vec<_> = report.singular.iter().filter(of_screws).cloned().collect();
    match singularities.is_empty() {
        true => Ok(()),
        false => Err(DecomposeError::SingularHome { singularities, order: None, near: None }),
    }
}

/// Checks that the actuators control every motion of the platform at poses near home.
///
/// # Errors
/// [`DecomposeError::NoActuator`] or [`DecomposeError::Loose`].
pub fn check_actuators(report: &Mobility) -> Result<(), DecomposeError> {
    let mobility = report.mobility;
    if report.actuators == 0 {
        return Err(DecomposeError::NoActuator { mobility });
    }
    if !report.loose.is_empty() {
        let (actuators, controlled) = (report.actuators, report.controlled);
        let (free, units) = (report.loose.clone(), report.units);
        return Err(DecomposeError::Loose { mobility, actuators, controlled, free, units });
    }
    Ok(())
}

/// The decompositions of a mechanism that moves, the preferred one first.
fn ranked(mechanism: &Mechanism, report: &Mobility) -> Result<Vec<Decomposition>, DecomposeError> {
    let mut found = order::listed(mechanism, report);
    if found.is_empty() {
        return Err(unsplit(mechanism, report));
    }
    found.sort_by_cached_key(|decomposition| preference(decomposition, mechanism));
    Ok(found)
}

/// That no two subgroups are shared by all legs.
fn unsplit(mechanism: &Mechanism, report: &Mobility) -> DecomposeError {
    let screws: Vec<_> = mechanism.legs.iter().flat_map(Leg::screws).collect();
    let subspace = MotionSubspace::span(frame(mechanism), &screws).class().map(Box::new);
    let height = subspace.as_deref().and_then(|group| height_miss(mechanism, group));
    DecomposeError::NoPartialSubspaces {
        lambda: report.lambda,
        mobility: report.mobility,
        order: None,
        near: None,
        odd: None,
        height: height.map(Box::new),
        whole: None,
        subspace,
        units: mechanism.units,
    }
}

/// Adds to an error an order of the joints in which the mechanism decomposes, or what it misses, if it nearly does.
fn found_or_near<T>(
    mechanism: &Mechanism,
    report: &Mobility,
    found: Result<T, DecomposeError>,
) -> Result<T, DecomposeError> {
    let mut error = match found {
        Ok(found) => return Ok(found),
        Err(error) => error,
    };
    let near_miss = |mechanism| near::near_miss(mechanism, near::MOST_DIMENSIONS);
    match &mut error {
        DecomposeError::NoFreedom { near, .. } => *near = near_miss(mechanism).map(Box::new),
        DecomposeError::SingularHome { near, order, singularities } => {
            // A parallel singularity is none of the order.
            let parallel = |s: &HomeSingularity| matches!(s, HomeSingularity::Parallel { .. });
            if !singularities.iter().all(parallel) {
                *order = reorder::better_order(mechanism, Exchanges::Any).map(Box::new);
            }
            if order.is_none() {
                *near = near_miss(mechanism).map(Box::new);
            }
        }
        DecomposeError::NoPartialSubspaces { order, near, odd, height, .. } => {
            // In one subgroup, the order of joints is not what is missing.
            if height.is_none() {
                *order = reorder::better_order(mechanism, Exchanges::Neighbours).map(Box::new);
            }
            if order.is_none() {
                *near = near_miss(mechanism).map(Box::new);
            }
            if order.is_none() && near.is_none() {
                *odd = odd::odd_joint(mechanism, report).map(Box::new);
            }
        }
        DecomposeError::Mobility(_)
        | DecomposeError::NoActuator { .. }
        | DecomposeError::Loose { .. } => {}
    }
    Err(error)
}

/// The largest number of decompositions that are listed. A joint along the intersection motion can
/// belong to either section, in every leg, so their number can grow exponentially with the number
/// of legs.
///
/// If there are more, the first ones found are listed, sorted by preference. The search splits
/// every leg as near to the platform as it can first. Preferred decompositions have that in common,
/// but it is not the only criterion.
pub const MAX_DECOMPOSITIONS: usize = 1024;

/// The decomposition of a mechanism whose legs all move in one proper subgroup: the subgroup is the lower
/// section, and there is no upper one. `None` if the joint screws do not span a subgroup that has closed forms.
fn one_subspace(mechanism: &Mechanism, report: &Mobility) -> Option<Decomposition> {
    let frame = frame(mechanism);
    let screws: Vec<_> =
        mechanism.legs.iter().flat_map(Leg::screws).map(|screw| frame.unit(&screw)).collect();
    let moved = || {
        let nearby = NearbyPose::new(mechanism, &frame, report);
        let parts = mechanism.legs.iter().enumerate();
        parts.flat_map(|(number, leg)| nearby.part(number, &Freedom::of_leg(leg)).screws).collect()
    };
    let group =
        group_of(&screws, moved).filter(|group| group.class.dimension() == report.lambda)?;
    // Others have no closed forms, alone.
    SubspaceKind::of(&group.class)?;
    let class = group.class.restored(&frame);
    // Nor has a Schoenflies group, where no joint of a leg carries the height.
    if height_miss(mechanism, &class).is_some() {
        return None;
    }
    let whole = |leg: &Leg| LegSplit {
        lower: Freedom::of_leg(leg),
        upper: vec![],
        imaginary: false,
        whole: None,
    };
    Some(Decomposition {
        lambda: report.lambda,
        mobility: report.mobility,
        lower: class,
        upper: SubspaceClass::Identity,
        intersection: SubspaceClass::Identity,
        constrained: None,
        legs: mechanism.legs.iter().map(whole).collect(),
        imaginary_joints: 0,
        first_section_motions: report.mobility,
        upper_mobility: 0,
        redundancy: 0,
        deviation: group.deviation,
    })
}

/// The first leg without a joint that carries the height, if all legs move in a Schoenflies group.
fn height_miss(mechanism: &Mechanism, group: &SubspaceClass) -> Option<HeightMiss> {
    let SubspaceClass::Schoenflies { axis } = group else { return None };
    let size = frame(mechanism).length;
    let missing = |leg: &Leg| height::lift(leg, &Freedom::of_leg(leg), axis, size).err();
    mechanism.legs.iter().find_map(missing)
}

/// All decompositions into two subgroups that share a group of `shared` dimensions, and the number of partial
/// splits that were visited.
fn search(mechanism: &Mechanism, report: &Mobility, shared: usize) -> (Vec<Decomposition>, usize) {
    let frame = frame(mechanism);
    let nearby = NearbyPose::new(mechanism, &frame, report);
    let candidates: Vec<Vec<SplitCandidate>> =
        mechanism.legs.iter().map(|leg| search::candidates(leg, &frame)).collect();
    let mut found = vec![];
    let visited = search::splits(&candidates, report.lambda, &mut |split| {
        let sections = Sections::new(split, &nearby, report.lambda, shared);
        found.extend(sections.map(|s| s.decomposition(mechanism, &frame, report)));
        found.len() < MAX_DECOMPOSITIONS
    });
    (found, visited)
}

/// A split of every leg whose two sections are groups that share a one-parameter group, or the identity alone.
struct Sections<'a> {
    legs: &'a [&'a SplitCandidate],
    /// The upper parts of the legs at a pose near home.
    nearby: Vec<NearbyPart>,
    lower: Fit,
    upper: Fit,
    /// `None` where they share the identity alone.
    intersection: Option<Fit>,
}

impl<'a> Sections<'a> {
    fn new(
        legs: &'a [&'a SplitCandidate],
        nearby: &NearbyPose,
        lambda: usize,
        shared: usize,
    ) -> Option<Self> {
        let partial = |screws: fn(&SplitCandidate) -> &[Vector6<f64>],
                       freedoms: fn(&SplitCandidate) -> &[Freedom]| {
            let all: Vec<_> =
                legs.iter().flat_map(|candidate| screws(candidate)).copied().collect();
            let moved = || {
                let parts = legs.iter().enumerate();
                parts.flat_map(|(leg, split)| nearby.part(leg, freedoms(split)).screws).collect()
            };
            let dimension = |fit: &Fit| fit.class.dimension();
            group_of(&all, moved).filter(|fit| (1..lambda).contains(&dimension(fit)))
        };
        let lower = partial(SplitCandidate::lower_screws, |split| &split.lower)?;
        let upper = partial(SplitCandidate::upper_screws, |split| &split.upper)?;
        let intersection = lower.basis.intersection(&upper.basis);
        if intersection.dimension() != shared {
            return None;
        }
        // Of pairs that share nothing, those are listed that have closed forms: with a group such as that of
        // Schoenflies motions, too much is such a pair.
        let solvable = |fit: &Fit| SubspaceKind::of(&fit.class).is_some();
        if shared == 0 && !(solvable(&lower) && solvable(&upper)) {
            return None;
        }
        let intersection = match shared {
            0 => None,
            _ => Some(fit(intersection.vectors())?),
        };
        let parts = legs.iter().enumerate();
        let nearby = parts.map(|(leg, split)| nearby.part(leg, &split.upper)).collect();
        Some(Self { legs, nearby, lower, upper, intersection })
    }

    fn decomposition(
        &self,
        mechanism: &Mechanism,
        frame: &Frame,
        report: &Mobility,
    ) -> Decomposition {
        let &Mobility { lambda, mobility, .. } = report;
        let parts: Vec<_> = self.nearby.iter().map(|part| part.screws.as_slice()).collect();
        let shared = self.intersection.as_ref().map(|fit| fit.basis.vectors()[0]);
        let seen: Option<Vec<_>> =
            shared.map(|shared| self.nearby.iter().map(|part| part.seen(&shared)).collect());
        let section = imaginary::UpperSection {
            basis: &self.upper.basis,
            legs: &parts,
            intersection: seen.as_deref(),
        };
        let key = |leg: &Leg, split: &SplitCandidate| {
            (split.upper.len(), split.lower.len(), leg.name.clone())
        };
        let order: Vec<_> =
            mechanism.legs.iter().zip(self.legs).map(|(leg, split)| key(leg, split)).collect();
        let choice = section.imaginary_joints(mobility, self.lower.class.dimension(), &order);
        let split = |(i, candidate): (usize, &&SplitCandidate)| LegSplit {
            lower: candidate.lower.clone(),
            upper: candidate.upper.clone(),
            imaginary: choice.legs.contains(&i),
            whole: None,
        };
        // The upper section's own motions are not those of imaginary joints, where there can be none.
        let upper_motions = choice.mobility.min(mobility);
        let mut intersection = SubspaceClass::Identity;
        let mut imaginary_joints = 0;
        if let Some(fit) = &self.intersection {
            intersection = fit.class.restored(frame);
            imaginary_joints = upper_motions;
        }
        if let Some(hint) = &mechanism.task.axis {
            intersection = intersection.towards(hint);
        }
        Decomposition {
            lambda,
            mobility,
            lower: self.lower.class.restored(frame),
            upper: self.upper.class.restored(frame),
            intersection,
            constrained: None,
            legs: self.legs.iter().enumerate().map(split).collect(),
            imaginary_joints,
            first_section_motions: mobility - upper_motions,
            upper_mobility: choice.without,
            redundancy: (choice.legs.len() + choice.without).saturating_sub(choice.mobility),
            deviation: self.lower.deviation.max(self.upper.deviation),
        }
    }
}

/// A sort key: preferred decompositions have smaller keys. It does not depend on the order of the
/// legs.
fn preference(decomposition: &Decomposition, mechanism: &Mechanism) -> impl Ord + use<> {
    let divided = |split: &LegSplit| match (split.lower.last(), split.upper.first()) {
        (Some(below), Some(above)) => below.joint == above.joint,
        _ => false,
    };
    let lower: usize = decomposition.legs.iter().map(|split| split.lower.len()).sum();
    let mut by_name: Vec<(String, Reverse<usize>, Vec<Freedom>)> = mechanism
        .legs
        .iter()
        .zip(&decomposition.legs)
        .map(|(leg, split)| (leg.name.clone(), Reverse(split.lower.len()), split.lower.clone()))
        .collect();
    by_name.sort();
    (
        decomposition.upper_mobility,
        decomposition.redundancy,
        decomposition.legs.iter().filter(|split| divided(split)).count(),
        Reverse(lower),
        by_name,
    )
}

#[cfg(test)]
mod tests;
