//! A survey of any mechanism: what its legs are, what its platform can do, and which part of this crate
//! applies to it.

use super::architecture::{chain, common_name, notation};
use super::element::{Element, generated};
use super::mobility::{Mobility, MobilityError, frame, mobility};
use super::near::{elements, near_smaller};
use super::search::candidates;
use super::{
    DecomposeError, Decomposition, Freedom, HeightMiss, JointMiss, NearMiss, PlatformSet,
    Reordered, WholeMiss, any, found_or_near, height_miss, list,
};
use crate::group::subspace::{MotionSubspace, SubspaceClass, TOLERANCE};
use crate::mechanism::Mechanism;
use crate::mechanism::leg::Leg;
use std::fmt;

/// What a mechanism is, and which part of this crate applies to it.
///
/// ```
/// use opm_core::decomposition::{Applies, survey};
/// use opm_core::mechanism::{examples, file};
///
/// let example = examples::find("plano-spherical-5dof").expect("a shipped mechanism");
/// let found = survey(&file::read(example.text)?.mechanism)?;
/// assert_eq!(found.notation, "3-PRRRR + RRS");
/// assert!(matches!(found.applies, Applies::Decomposed(_)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// The chains of the legs in the notation of the field: `6-UPS`, `3-PRRRR + RRS`.
    pub notation: String,
    /// The common name of mechanisms with these legs, if there is one and the platform moves like them.
    pub common_name: Option<&'static str>,
    /// Mobility, actuators and singularities at home.
    pub mobility: Mobility,
    /// The legs, in the order of the mechanism's legs.
    pub legs: Vec<LegSurvey>,
    /// What the platform can do at home.
    pub platform: PlatformMotion,
    /// Which part of this crate applies.
    pub applies: Applies,
    /// What the mechanism misses, if it nearly decomposes, or nearly decomposes into smaller sections
    /// than those that it has.
    pub near: Option<NearMiss>,
    /// An order of the joints in which the mechanism decomposes, if it does not as it is.
    pub order: Option<Reordered>,
    /// Why its legs are not solved whole, if they are not split either.
    pub whole: Option<WholeMiss>,
}

/// One leg by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct LegSurvey {
    /// The leg's name.
    pub name: String,
    /// Its joints from base to platform: `RPUR`, `UPS`.
    pub chain: String,
    /// The names of its actuated joints.
    pub actuated: Vec<String>,
    /// The group that its joints generate: the smallest one that contains every motion of the leg.
    pub subspace: SubspaceClass,
    /// Dimension of the span of its joint screws at home.
    pub span: usize,
}

impl LegSurvey {
    /// Whether the span of the joint screws is the Lie algebra of the group: the leg can make every
    /// motion of it.
    pub fn is_closed(&self) -> bool {
        self.span == self.subspace.dimension()
    }
}

/// The motions of the platform at home that all legs allow: its instantaneous twists.
#[derive(Clone, Debug, PartialEq)]
pub struct PlatformMotion {
    /// The number of independent twists.
    pub dimension: usize,
    /// The number of independent translations among them. The other freedoms rotate the platform.
    pub translations: usize,
    /// The group that has these twists, if there is one.
    pub subspace: Option<SubspaceClass>,
}

/// Which part of this crate applies to a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub enum Applies {
    /// It decomposes, in these ways. Actuators may be missing; see [`Survey::mobility`].
    Decomposed(Vec<Decomposition>),
    /// It nearly decomposes: see [`Survey::near`].
    Nearly,
    /// It is outside the class of mechanisms that decompose.
    Outside(Outside),
}

impl Applies {
    /// A short name: `two subspaces`, `one subspace`, `every leg`, `nearly` or `outside`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Decomposed(found) => match found.first() {
                Some(found) if found.is_whole() => "every leg",
                Some(found) if found.platform() == PlatformSet::Subgroup => "one subspace",
                Some(_) | None => "two subspaces",
            },
            Self::Nearly => "nearly",
            Self::Outside(_) => "outside",
        }
    }
}

/// Why a mechanism is outside the class.
#[derive(Clone, Debug, PartialEq)]
pub enum Outside {
    /// It is a structure: its mobility is zero.
    Structure,
    /// Home is singular, so that its screws do not represent other poses.
    SingularHome {
        /// In which respects, in words.
        singularities: Vec<String>,
    },
    /// All legs move in one group, which has no closed forms here.
    OneSubgroup {
        /// The group.
        subspace: SubspaceClass,
        /// What its closed forms miss, if it is a Schoenflies group.
        height: Option<Box<HeightMiss>>,
    },
    /// Some legs cannot be divided into two parts that each move in a proper subgroup of SE(3).
    Indivisible {
        /// Their names and chains.
        legs: Vec<[String; 2]>,
        /// Whether these are all legs.
        all: bool,
        /// The one joint without which the legs would share two groups, or move in one, if there is exactly one.
        odd: Option<Box<JointMiss>>,
    },
    /// Every leg can be divided, but not all into the same two groups.
    NothingShared {
        /// For each leg its name, and the names of the groups of its two parts.
        legs: Vec<(String, [SubspaceClass; 2])>,
        /// The one joint without which the legs would share two groups, or move in one, if there is exactly one.
        odd: Option<Box<JointMiss>>,
    },
}

impl fmt::Display for Outside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Structure => f.write_str("it cannot move: its mobility N is 0"),
            Self::SingularHome { singularities } => write!(
                f,
                "its home pose is singular ({}), so that the joint screws at home do not represent \
                 other poses; another assembled pose may decompose",
                list(singularities)
            ),
            Self::OneSubgroup { subspace, height: Some(height) } => {
                write!(f, "all legs move in one subgroup ({}); {height}", subspace.name())
            }
            Self::OneSubgroup { subspace, height: None } => write!(
                f,
                "all legs move in one subgroup ({}), for which opm has no closed forms",
                subspace.name()
            ),
            Self::Indivisible { legs, all: true, odd } => {
                let chains: Vec<&String> = legs.iter().map(|[_, chain]| chain).collect();
                let same = chains.windows(2).all(|pair| pair[0] == pair[1]);
                let chain = chains.first().filter(|_| same);
                let of = chain.map_or_else(String::new, |chain| format!(" {chain}"));
                write!(
                    f,
                    "wherever one of its{of} legs is divided, one of the two parts moves in all six \
                     dimensions; opm needs legs whose lower parts share one subgroup and whose upper \
                     parts share another{}",
                    odd_text(odd.as_deref())
                )
            }
            Self::Indivisible { legs, all: false, odd } => {
                let names: Vec<String> =
                    legs.iter().map(|[name, chain]| format!("{name} ({chain})")).collect();
                write!(
                    f,
                    "wherever leg {} is divided, one of the two parts moves in all six dimensions; \
                     opm needs legs whose lower parts share one subgroup and whose upper parts share \
                     another{}",
                    names.join(" or leg "),
                    odd_text(odd.as_deref())
                )
            }
            Self::NothingShared { legs, odd } => {
                let names = |[lower, upper]: &[SubspaceClass; 2]| match (lower, upper) {
                    (group, SubspaceClass::Identity) | (SubspaceClass::Identity, group) => {
                        format!("one {} part", group.name())
                    }
                    (lower, upper) => format!("a {} and a {} part", lower.name(), upper.name()),
                };
                let kinds: Vec<String> = legs.iter().map(|(_, groups)| names(groups)).collect();
                let same = kinds.windows(2).all(|pair| pair[0] == pair[1]);
                let divided = match kinds.first().filter(|_| same) {
                    Some(kind) => format!("each leg has {kind}"),
                    None => {
                        let of =
                            |((leg, _), kind): (&(String, _), &String)| format!("{leg} has {kind}");
                        legs.iter().zip(&kinds).map(of).collect::<Vec<_>>().join(", ")
                    }
                };
                write!(
                    f,
                    "{divided}, but the legs do not share two subgroups that have one motion in common{}",
                    odd_text(odd.as_deref())
                )
            }
        }
    }
}

/// The one joint that does not fit, as the end of a message.
fn odd_text(odd: Option<&JointMiss>) -> String {
    odd.map_or_else(String::new, |odd| {
        let JointMiss { joint, leg, .. } = odd;
        format!("; only joint {joint} of leg {leg} does not fit: {}", odd.reason())
    })
}

/// Surveys a mechanism.
///
/// # Errors
/// [`MobilityError`] if the mechanism is incomplete or has numbers that are not finite.
pub fn survey(mechanism: &Mechanism) -> Result<Survey, MobilityError> {
    let report = mobility(mechanism)?;
    let legs: Vec<_> = mechanism.legs.iter().map(|leg| leg_survey(leg, mechanism)).collect();
    let platform = platform_motion(mechanism);
    let chains: Vec<String> = legs.iter().map(|leg| leg.chain.clone()).collect();
    let notation = notation(&chains);
    let common_name = common_name(&notation, platform.subspace.as_ref());
    let (mut order, mut whole) = (None, None);
    let (applies, near) = match found_or_near(mechanism, &report, any(mechanism, &report)) {
        Ok(found) => {
            let by_itself = found.first().is_some_and(Decomposition::is_whole);
            let near = if by_itself { None } else { near_smaller(mechanism, &found) };
            (Applies::Decomposed(found), near)
        }
        Err(mut error) => {
            if let DecomposeError::SingularHome { order: better, .. }
            | DecomposeError::NoPartialSubspaces { order: better, .. } = &mut error
            {
                order = better.take().map(|better| *better);
            }
            if let DecomposeError::NoPartialSubspaces { whole: Some(miss), .. } = &error {
                whole = Some((**miss).clone());
            }
            outside(mechanism, error)
        }
    };
    Ok(Survey {
        notation,
        common_name,
        mobility: report,
        legs,
        platform,
        applies,
        near,
        order,
        whole,
    })
}

fn leg_survey(leg: &Leg, mechanism: &Mechanism) -> LegSurvey {
    let frame = frame(mechanism);
    let freedoms = Freedom::of_leg(leg);
    let actuated = leg.joints.iter().filter(|joint| joint.actuated);
    LegSurvey {
        name: leg.name.clone(),
        chain: chain(leg),
        actuated: actuated.map(|joint| joint.name.clone()).collect(),
        subspace: generated(&elements(leg, &freedoms), frame.length, TOLERANCE),
        span: MotionSubspace::span(frame, &leg.screws()).dimension(),
    }
}

/// The twists that all legs allow.
fn platform_motion(mechanism: &Mechanism) -> PlatformMotion {
    let frame = frame(mechanism);
    let spans = mechanism.legs.iter().map(|leg| MotionSubspace::span(frame, &leg.screws()));
    let common = spans.reduce(|a, b| a.intersection(&b));
    let Some(common) = common else {
        return PlatformMotion { dimension: 0, translations: 0, subspace: None };
    };
    let space = MotionSubspace::span(frame, &SubspaceClass::TranslationalSpace.screws());
    PlatformMotion {
        dimension: common.dimension(),
        translations: common.intersection(&space).dimension(),
        subspace: common.class(),
    }
}

/// Why a mechanism does not decompose, and what it misses if it nearly does.
fn outside(mechanism: &Mechanism, error: DecomposeError) -> (Applies, Option<NearMiss>) {
    let outside = |reason| (Applies::Outside(reason), None);
    match error {
        DecomposeError::NoFreedom { near: Some(near), .. }
        | DecomposeError::SingularHome { near: Some(near), .. }
        | DecomposeError::NoPartialSubspaces { near: Some(near), .. } => {
            (Applies::Nearly, Some(*near))
        }
        DecomposeError::SingularHome { singularities, .. } => {
            let singularities = singularities.iter().map(ToString::to_string).collect();
            outside(Outside::SingularHome { singularities })
        }
        DecomposeError::NoPartialSubspaces { odd, .. } => {
            outside(no_partial_subspaces(mechanism, odd))
        }
        // The last three do not come from the search.
        DecomposeError::NoFreedom { .. }
        | DecomposeError::Mobility(_)
        | DecomposeError::NoActuator { .. }
        | DecomposeError::Loose { .. } => outside(Outside::Structure),
    }
}

fn no_partial_subspaces(mechanism: &Mechanism, odd: Option<Box<JointMiss>>) -> Outside {
    let frame = frame(mechanism);
    let group = |elements: &[Element]| generated(elements, frame.length, TOLERANCE);
    let all: Vec<Element> =
        mechanism.legs.iter().flat_map(|leg| elements(leg, &Freedom::of_leg(leg))).collect();
    let subspace = group(&all);
    if subspace != SubspaceClass::Full {
        let height = height_miss(mechanism, &subspace).map(Box::new);
        return Outside::OneSubgroup { subspace, height };
    }
    // The division of each leg into the smallest groups.
    let divided = mechanism.legs.iter().map(|leg| {
        let groups = candidates(leg, &frame).into_iter().map(|candidate| {
            [&candidate.lower, &candidate.upper].map(|part| group(&elements(leg, part)))
        });
        let proper = groups.filter(|parts| !parts.contains(&SubspaceClass::Full));
        proper.min_by_key(|parts| parts.iter().map(SubspaceClass::dimension).sum::<usize>())
    });
    let divided: Vec<Option<[SubspaceClass; 2]>> = divided.collect();
    let whole: Vec<[String; 2]> = (mechanism.legs.iter().zip(&divided))
        .filter(|(_, parts)| parts.is_none())
        .map(|(leg, _)| [leg.name.clone(), chain(leg)])
        .collect();
    if !whole.is_empty() {
        let all = whole.len() == mechanism.legs.len();
        return Outside::Indivisible { legs: whole, all, odd };
    }
    let names = mechanism.legs.iter().map(|leg| leg.name.clone());
    Outside::NothingShared { legs: names.zip(divided.into_iter().flatten()).collect(), odd }
}

#[cfg(test)]
mod tests;
