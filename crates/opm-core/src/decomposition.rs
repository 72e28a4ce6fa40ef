//! Decomposition of a mechanism into two partial subspaces: every leg is cut into a lower part that
//! moves in one group `A` and an upper part that moves in another, `B`, with a one-parameter group
//! of displacements in common: the intersection motion.
//!
//! Where a leg's upper part does not contain that motion, the cut is bridged by an *imaginary
//! joint*, a joint along the intersection motion that is not there: it splits the leg's kinematics
//! into two problems in small groups. Selvi, "Kinematic analysis of overconstrained manipulators
//! with partial subspaces using decomposition method", Robotica, section 2.
//!
//! That a mechanism's screws at home split this way says so for all of its poses: a leg's lower
//! part displaces by elements of `A` and its upper part by elements of `B`, whatever the angles.

mod imaginary;
pub mod mobility;
mod search;

#[cfg(test)]
pub(crate) mod samples;

use crate::decomposition::mobility::{HomeSingularity, MobilityError, frame, mobility};
use crate::group::subspace::{Fit, Frame, MotionSubspace, SubspaceClass, fit};
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use nalgebra::Vector6;
use search::SplitCandidate;
use std::cmp::Reverse;
use thiserror::Error;

/// One freedom of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Freedom {
    /// Index of the joint in its leg, base first.
    pub joint: usize,
    /// Index of the freedom in its joint, as in [`Joint::screws`](crate::mechanism::joint::Joint::screws).
    pub index: usize,
}

/// Where a leg is cut.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LegSplit {
    /// Freedoms that move in the lower subspace, base first.
    pub lower: Vec<Freedom>,
    /// Freedoms that move in the upper subspace, base first.
    pub upper: Vec<Freedom>,
    /// Whether an imaginary joint bridges the cut.
    pub imaginary: bool,
}

/// One way to see a mechanism as a lower and an upper section.
#[derive(Clone, Debug, PartialEq)]
pub struct Decomposition {
    /// Dimension of the span of all joint screws.
    pub lambda: usize,
    /// Mobility of the mechanism, `N`.
    pub mobility: usize,
    /// Group that the lower parts of the legs move in, `A`.
    pub lower: SubspaceClass,
    /// Group that the upper parts of the legs move in, `B`.
    pub upper: SubspaceClass,
    /// What both have in common: a rotation, translation or helical motion. Its axis is its positive
    /// direction: on the side of the mechanism's [`TaskHints`](crate::mechanism::TaskHints), else up.
    pub intersection: SubspaceClass,
    /// A split a leg, in the order of the mechanism's legs.
    pub legs: Vec<LegSplit>,
    /// Independent motions of the imaginary joints, `J`: the mobility of the upper section with
    /// them. At most `mobility`.
    pub imaginary_joints: usize,
    /// What is left for the lower section with the imaginary joints held, `M = N − J`.
    pub first_section_motions: usize,
    /// Mobility of the upper section without imaginary joints, `F0`; 0 if it is passive, driven by
    /// the imaginary joints alone.
    pub upper_mobility: usize,
    /// Legs with an imaginary joint beyond the motions that these give to the upper section.
    pub redundancy: usize,
    /// Largest distance of a joint screw from the group that it was assigned to: the sine of an
    /// angle, with lengths over the mechanism's size. Rounding only, for exact input.
    pub deviation: f64,
}

/// Why a mechanism has no decomposition.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DecomposeError {
    /// Legs or joints are missing or not numbers.
    #[error(transparent)]
    Mobility(#[from] MobilityError),
    /// A structure, not a mechanism.
    #[error("the mechanism cannot move: mobility N = 0 (joint screws of rank lambda = {lambda})")]
    NoFreedom {
        /// Rank of all joint screws.
        lambda: usize,
    },
    /// Home says less than, or something else than, all other poses.
    #[error("the home pose is singular ({}); choose another one", list(singularities))]
    SingularHome {
        /// In what respects.
        singularities: Vec<HomeSingularity>,
    },
    /// Nothing drives the platform.
    #[error("no joint is actuated; the mechanism has mobility N = {mobility}")]
    NoActuator {
        /// `N`.
        mobility: usize,
    },
    /// The actuators do not hold the platform.
    #[error(
        "the actuators leave the platform loose: {actuators} actuated freedoms control {controlled} \
         of mobility N = {mobility}; with all of them locked these are free: {}",
        list(free)
    )]
    Loose {
        /// `N`.
        mobility: usize,
        /// Freedoms of the actuated joints.
        actuators: usize,
        /// Freedoms that they control.
        controlled: usize,
        /// Independent motions of the platform with all actuators locked.
        free: Vec<SubspaceClass>,
    },
    /// No split of the legs gives two groups that meet in one dimension.
    #[error(
        "no partial subspaces: no split of the legs (lambda = {lambda}, mobility N = {mobility}) \
         gives two subgroups that are smaller than lambda and meet in one dimension{}",
        odd.as_ref().map(|[leg, joint]| format!(
            "; without joint {joint} of leg {leg} it would have some"
        )).unwrap_or_default()
    )]
    NoPartialSubspaces {
        /// Rank of all joint screws.
        lambda: usize,
        /// `N`.
        mobility: usize,
        /// Leg and joint that alone keep it from having some, if one does.
        odd: Option<[String; 2]>,
    },
}

fn list<T: ToString>(items: &[T]) -> String {
    items.iter().map(T::to_string).collect::<Vec<_>>().join("; ")
}

/// All valid decompositions, the preferred one first: a passive upper section, then imaginary
/// joints without redundancy, then joints left whole, then more freedoms in the lower section; what
/// is still equal is in the order of the splits of the legs by name. At most
/// [`MAX_DECOMPOSITIONS`] are listed.
///
/// # Errors
/// [`DecomposeError`]: the mechanism is incomplete, cannot move, is in a singular pose at home,
/// has actuators that do not control the platform, or has no partial subspaces.
pub fn decompose(mechanism: &Mechanism) -> Result<Vec<Decomposition>, DecomposeError> {
    let report = mobility(mechanism)?;
    let (lambda, mobility) = (report.lambda, report.mobility);
    if mobility == 0 {
        return Err(DecomposeError::NoFreedom { lambda });
    }
    if !report.singular.is_empty() {
        return Err(DecomposeError::SingularHome { singularities: report.singular });
    }
    if report.actuators == 0 {
        return Err(DecomposeError::NoActuator { mobility });
    }
    if !report.loose.is_empty() {
        let (actuators, controlled) = (report.actuators, report.controlled);
        let free = report.loose;
        return Err(DecomposeError::Loose { mobility, actuators, controlled, free });
    }
    let mut found = search(mechanism, lambda, mobility).0;
    if found.is_empty() {
        let odd = odd_joint(mechanism, mobility);
        return Err(DecomposeError::NoPartialSubspaces { lambda, mobility, odd });
    }
    found.sort_by_cached_key(|decomposition| preference(decomposition, mechanism));
    Ok(found)
}

/// The one joint of which it takes no more than to leave it out for there to be partial subspaces.
fn odd_joint(mechanism: &Mechanism, mobility: usize) -> Option<[String; 2]> {
    let frame = frame(mechanism);
    let mut odd = None;
    for (number, leg) in mechanism.legs.iter().enumerate().filter(|(_, leg)| leg.joints.len() > 1) {
        for joint in 0..leg.joints.len() {
            let mut others = mechanism.clone();
            let left_out = others.legs[number].joints.remove(joint).name;
            let screws: Vec<_> = others.legs.iter().flat_map(Leg::screws).collect();
            let lambda = MotionSubspace::span(frame, &screws).dimension();
            if !search(&others, lambda, mobility).0.is_empty() {
                if odd.is_some() {
                    return None;
                }
                odd = Some([leg.name.clone(), left_out]);
            }
        }
    }
    odd
}

/// Decompositions listed at most: a joint along the intersection motion can go to either section,
/// in every leg, so that their number can grow with a power of the number of legs.
///
/// Where there are more, those that were found first are listed, in order of preference among
/// themselves. The search cuts every leg as near to the platform as it can first, which is what the
/// preferred ones have in common, but not all that counts.
pub const MAX_DECOMPOSITIONS: usize = 1024;

/// All decompositions, and how many partial splits were looked at.
fn search(mechanism: &Mechanism, lambda: usize, mobility: usize) -> (Vec<Decomposition>, usize) {
    let frame = frame(mechanism);
    let candidates: Vec<Vec<SplitCandidate>> =
        mechanism.legs.iter().map(|leg| search::candidates(leg, &frame)).collect();
    let mut found = vec![];
    let visited = search::splits(&candidates, lambda, &mut |split| {
        let sections = Sections::new(split, lambda);
        found.extend(sections.map(|s| s.decomposition(mechanism, &frame, lambda, mobility)));
        found.len() < MAX_DECOMPOSITIONS
    });
    (found, visited)
}

/// A split of every leg whose two sections are groups that meet in one dimension.
struct Sections<'a> {
    legs: &'a [&'a SplitCandidate],
    lower: Fit,
    upper: Fit,
    intersection: Fit,
}

impl<'a> Sections<'a> {
    fn new(legs: &'a [&'a SplitCandidate], lambda: usize) -> Option<Self> {
        let partial = |screws: fn(&SplitCandidate) -> &[Vector6<f64>]| {
            let all: Vec<_> =
                legs.iter().flat_map(|candidate| screws(candidate)).copied().collect();
            let dimension = |fit: &Fit| fit.class.dimension();
            fit(&all).filter(|fit| (1..lambda).contains(&dimension(fit)))
        };
        let lower = partial(SplitCandidate::lower_screws)?;
        let upper = partial(SplitCandidate::upper_screws)?;
        let intersection = lower.basis.intersection(&upper.basis);
        if intersection.dimension() != 1 {
            return None;
        }
        let intersection = fit(intersection.vectors())?;
        Some(Self { legs, lower, upper, intersection })
    }

    fn decomposition(
        &self,
        mechanism: &Mechanism,
        frame: &Frame,
        lambda: usize,
        mobility: usize,
    ) -> Decomposition {
        let parts: Vec<_> = self.legs.iter().map(|candidate| candidate.upper_screws()).collect();
        let section = imaginary::UpperSection {
            basis: &self.upper.basis,
            legs: &parts,
            intersection: self.intersection.basis.vectors()[0],
        };
        let plain = |leg: &Leg, candidate: &SplitCandidate| {
            (candidate.upper.len(), candidate.lower.len(), leg.name.clone())
        };
        let order: Vec<_> = mechanism
            .legs
            .iter()
            .zip(self.legs)
            .map(|(leg, candidate)| plain(leg, candidate))
            .collect();
        let choice = section.imaginary_joints(mobility, self.lower.class.dimension(), &order);
        let split = |(i, candidate): (usize, &&SplitCandidate)| LegSplit {
            lower: candidate.lower.clone(),
            upper: candidate.upper.clone(),
            imaginary: choice.legs.contains(&i),
        };
        let imaginary_joints = choice.mobility.min(mobility);
        let mut intersection = self.intersection.class.restored(frame);
        if let Some(hint) = &mechanism.task.axis {
            intersection = intersection.towards(hint);
        }
        Decomposition {
            lambda,
            mobility,
            lower: self.lower.class.restored(frame),
            upper: self.upper.class.restored(frame),
            intersection,
            legs: self.legs.iter().enumerate().map(split).collect(),
            imaginary_joints,
            first_section_motions: mobility - imaginary_joints,
            upper_mobility: choice.without,
            redundancy: (choice.legs.len() + choice.without).saturating_sub(choice.mobility),
            deviation: self.lower.deviation.max(self.upper.deviation),
        }
    }
}

/// Sorts decompositions, the preferred one lowest, without regard to the order of the legs.
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
