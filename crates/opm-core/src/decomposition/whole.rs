//! Legs that are solved whole: the platform moves in a subgroup of what each leg can do, or in all of SE(3).
//!
//! Nothing has to be shared by the legs but the motion of the platform. It is found from the twists that all legs allow
//! at home, and certified by finite displacements: every leg is solved at each of them (see [`crate::chain::whole`]). Where these
//! twists are no group, but those of one leg, that leg is the *stem*: the platform moves as it lets it. Its motion is described
//! by the coordinates of a group around it, of which some depend on the others. So is what several legs allow together.

use super::architecture::chain;
use super::mobility::{Mobility, assembled, frame, share};
use super::near::JointMiss;
use super::reorder::{self, Exchanges};
use super::{DecomposeError, Decomposition, Freedom, LegSplit, near, odd, ranked, unsplit};
use crate::chain::whole::{LegJoint, NoOrder, WholeLeg};
use crate::group::SubspaceKind;
use crate::group::screw::Screw;
use crate::group::subspace::{MotionSubspace, SubspaceClass};
use crate::mechanism::Mechanism;
use crate::mechanism::joint::{Joint, JointKind};
use crate::mechanism::leg::Leg;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use std::borrow::Cow;

/// The set in which the platform moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlatformSet {
    /// A product of two subgroups, between which each leg is split.
    Pair,
    /// One subgroup.
    Subgroup,
    /// All displacements.
    Free,
    /// The displacements that the leg with this number allows, which are no group.
    Stem(usize),
    /// The displacements that several legs allow together, which are no group.
    Constrained,
    /// The images of the base in a plane that moves: products of two reflections.
    Symmetric,
}

/// What constrains a platform whose motion is no group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constrained {
    /// The leg with this number: the platform moves as it does.
    Stem(usize),
    /// Several legs together, which leave so many freedoms.
    Legs {
        /// The number of freedoms of the platform.
        freedoms: usize,
    },
    /// Several legs, each of which is its own mirror image in a plane between base and platform.
    Mirror {
        /// The number of freedoms of the platform.
        freedoms: usize,
    },
}

impl PlatformSet {
    /// A short name: `pair`, `subgroup`, `free`, `stem`, `constrained` or `symmetric`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pair => "pair",
            Self::Subgroup => "subgroup",
            Self::Free => "free",
            Self::Stem(_) => "stem",
            Self::Constrained => "constrained",
            Self::Symmetric => "symmetric",
        }
    }
}

/// The largest distance of a twist of the platform from what a leg can do, as a sine, lengths over the size. Legs close to
/// within [`CLOSURE`](crate::chain::whole::CLOSURE), to which six joints add up.
const EXACT: f64 = 1e-10;

/// Displacements are products of two reflections to within this, in radians or shares of the size.
const MIRRORED: f64 = 1e-8;

/// Why legs are not solved whole.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WholeMiss {
    /// What all legs allow is not a group, nor what one leg allows: several legs constrain the platform together.
    #[error(
        "the platform has {dimension} freedoms that are neither those of a subgroup of SE(3) nor those of one leg, so that its \
         legs cannot be solved by themselves"
    )]
    NoGroup {
        /// The number of independent twists of the platform.
        dimension: usize,
    },
    /// The platform moves in a subgroup that has no coordinates here.
    #[error("the platform moves in a subgroup ({}) for which opm has no coordinates", .subspace.name())]
    NoCoordinates {
        /// The subgroup.
        subspace: SubspaceClass,
    },
    /// Joints are not where a leg contains all that the platform does, but nearly.
    #[error(
        "leg {leg} contains the motion of the platform only to within {deviation:.1e} (the sine of an angle, lengths over \
         the mechanism's size), expected {EXACT:e}: give directions and points with twelve digits"
    )]
    Inexact {
        /// The leg's name.
        leg: String,
        /// The largest distance of a twist of the platform from what the leg can do.
        deviation: f64,
    },
    /// A leg has no closed form.
    #[error("leg {leg} ({chain}) cannot be solved one joint after the other: {reason}")]
    Leg {
        /// The leg's name.
        leg: String,
        /// Its joints: `RRRS`.
        chain: String,
        /// Why not.
        reason: NoOrder,
    },
}

/// The motions of a subgroup in words.
fn words(class: &SubspaceClass) -> &'static str {
    match class {
        SubspaceClass::Identity => "nothing",
        SubspaceClass::Rotation { .. } => "rotations about an axis",
        SubspaceClass::Translation { .. } => "translations along a line",
        SubspaceClass::Helical { .. } => "turns of a screw",
        SubspaceClass::TranslationalPlane { .. } => "translations in a plane",
        SubspaceClass::Cylindrical { .. } => "rotations about an axis and translations along it",
        SubspaceClass::TranslationalSpace => "translations of space",
        SubspaceClass::Planar { .. } => "motions in a plane",
        SubspaceClass::Spherical { .. } => "rotations about a centre",
        SubspaceClass::PlanarHelical { .. } => {
            "translations in a plane and turns of screws across it"
        }
        SubspaceClass::Schoenflies { .. } => {
            "translations of space and rotations about one direction"
        }
        SubspaceClass::Full => "translations and rotations of space",
    }
}

impl Decomposition {
    /// The set in which the platform moves.
    pub fn platform(&self) -> PlatformSet {
        match (self.is_whole(), self.upper) {
            _ if self.constrained.is_some() => match self.constrained {
                Some(Constrained::Stem(leg)) => PlatformSet::Stem(leg),
                Some(Constrained::Mirror { .. }) => PlatformSet::Symmetric,
                Some(Constrained::Legs { .. }) | None => PlatformSet::Constrained,
            },
            (_, SubspaceClass::Identity) => PlatformSet::Subgroup,
            (true, _) => PlatformSet::Free,
            (false, _) => PlatformSet::Pair,
        }
    }

    /// Whether every leg is solved by itself, whole, and not by sections that all legs share.
    pub fn is_whole(&self) -> bool {
        self.legs.iter().any(|leg| leg.whole.is_some())
    }

    /// What the platform does, in words: `translations of space`.
    pub fn motion(&self) -> String {
        match self.platform() {
            PlatformSet::Pair => format!("{}, then {}", words(&self.lower), words(&self.upper)),
            PlatformSet::Subgroup => words(&self.lower).to_owned(),
            PlatformSet::Free => words(&SubspaceClass::Full).to_owned(),
            PlatformSet::Constrained => "what several legs allow together".to_owned(),
            PlatformSet::Symmetric => "mirror images of the base in a plane that moves".to_owned(),
            PlatformSet::Stem(stem) => match (self.upper, self.lower) {
                (_, SubspaceClass::Planar { normal: axis }) if self.legs[stem].lower.len() == 1 => {
                    words(&SubspaceClass::Rotation { axis, point: Point3::origin() }).to_owned()
                }
                (_, SubspaceClass::TranslationalSpace) if self.legs[stem].lower.len() == 1 => {
                    "translations along a line".to_owned()
                }
                (SubspaceClass::Identity, _) => {
                    format!("{} that one leg allows", words(&self.lower))
                }
                _ => "what one leg allows, with fewer freedoms than space".to_owned(),
            },
        }
    }
}

/// The decompositions of a mechanism that moves: splits of its legs, the preferred one first, or else the one in which
/// every leg is solved whole.
pub(super) fn split_or_whole(
    mechanism: &Mechanism,
    report: &Mobility,
) -> Result<Vec<Decomposition>, DecomposeError> {
    // Sections of a leg are groups, and a parallelogram is in none but with other joints.
    let split = match mechanism.parallelograms().next() {
        Some(_) => Err(unsplit(mechanism, report)),
        None => ranked(mechanism, report),
    };
    let mut error = match split {
        Ok(found) => {
            let reflected =
                is_held(mechanism, report, &found[0]) && mirrored(&assembled(mechanism)).is_some();
            let whole = reflected.then(|| whole(mechanism, report).ok()).flatten();
            return Ok(whole.into_iter().chain(found).collect());
        }
        Err(error) => error,
    };
    match whole(mechanism, report) {
        Ok(found) => Ok(vec![found]),
        Err(miss) => {
            if let DecomposeError::NoPartialSubspaces { whole, .. } = &mut error {
                *whole = Some(Box::new(miss));
            }
            Err(error)
        }
    }
}

/// Whether every leg lets the platform do less than two sections would, so that it may be a symmetric one.
fn is_held(mechanism: &Mechanism, report: &Mobility, found: &Decomposition) -> bool {
    let of_pair = found.lower.dimension() + found.upper.dimension();
    let all = of_pair - found.intersection.dimension();
    let held = |leg: &Leg| Freedom::of_leg(leg).len() < all;
    (2..=3).contains(&report.mobility) && mechanism.legs.iter().all(held)
}

/// The plane of home, as a normal and a distance from the origin, if displacements are products of two reflections, the first one in
/// this plane: rotations about lines in it.
pub(crate) fn mirrored(motions: &[Isometry3<f64>]) -> Option<(Unit<Vector3<f64>>, f64)> {
    let lines: Vec<(Vector3<f64>, Vector3<f64>)> = motions
        .iter()
        .filter(|g| g.rotation.angle() > 0.01)
        .map(|g| {
            let (turned, p) = (g.rotation.scaled_axis(), g.translation.vector);
            let (angle, axis) = (turned.norm(), turned.normalize());
            (axis, (p + axis.cross(&p) / (0.5 * angle).tan()) * 0.5)
        })
        .collect();
    let size = lines.iter().map(|(_, point)| point.norm()).fold(0.0, f64::max);
    let across = lines.iter().flat_map(|(a, _)| lines.iter().map(move |(b, _)| a.cross(b)));
    let across = across.max_by(|a, b| a.norm().total_cmp(&b.norm()))?;
    let normal = Unit::try_new(across, 1e-3)?;
    let distance = normal.dot(&lines[0].1);
    let moves_along = |g: &Isometry3<f64>| {
        let turned = g.rotation.scaled_axis();
        turned.dot(&g.translation.vector).abs() > MIRRORED * turned.norm() * size
    };
    let in_plane = |(axis, point): &(Vector3<f64>, Vector3<f64>)| {
        normal.dot(axis).abs() <= MIRRORED
            && (normal.dot(point) - distance).abs() <= MIRRORED * size
    };
    let holds = lines.len() > 3 && lines.iter().all(in_plane) && !motions.iter().any(moves_along);
    holds.then_some((normal, distance))
}

/// The decomposition of a mechanism whose legs are solved whole.
fn whole(mechanism: &Mechanism, report: &Mobility) -> Result<Decomposition, WholeMiss> {
    let frame = frame(mechanism);
    let spans =
        mechanism.legs.iter().map(|leg| MotionSubspace::span(frame, &leg.independent_screws()));
    let common = spans.reduce(|a, b| a.intersection(&b));
    let dimension = report.mobility.saturating_sub(report.idle);
    let no_group = WholeMiss::NoGroup { dimension };
    let Some(common) = common.filter(|common| common.dimension() == dimension && dimension > 0)
    else {
        return Err(no_group);
    };
    let miss = match common.class() {
        Some(SubspaceClass::Full) => {
            let found = Found {
                lower: SubspaceClass::TranslationalSpace,
                upper: SubspaceClass::Spherical { centre: mechanism.platform },
                constrained: None,
                twists: SubspaceClass::Full.screws(),
                motions: motions(&SubspaceClass::Full, frame.length),
            };
            return found.solved(mechanism, report);
        }
        Some(class) if SubspaceKind::of(&class).is_some() => {
            let found = Found {
                lower: class,
                upper: SubspaceClass::Identity,
                constrained: None,
                twists: class.screws(),
                motions: motions(&class, frame.length),
            };
            match found.solved(mechanism, report) {
                Ok(found) => return Ok(found),
                Err(miss) => miss,
            }
        }
        Some(subspace) => WholeMiss::NoCoordinates { subspace },
        None => no_group,
    };
    // A motion at home may look like a subgroup and be none: a 3-RPS on the edges of a cube.
    let is_other = match &miss {
        WholeMiss::NoGroup { .. } => true,
        WholeMiss::Leg { reason, .. } => matches!(reason, NoOrder::Unreached { .. }),
        WholeMiss::NoCoordinates { .. } | WholeMiss::Inexact { .. } => false,
    };
    if mechanism.parallelograms().next().is_some() {
        return Err(miss);
    }
    let is_stem = |leg: &Leg| Freedom::of_leg(leg).len() == dimension;
    match mechanism.legs.iter().position(is_stem) {
        Some(stem) => Found::of_stem(mechanism, stem, frame.length).solved(mechanism, report),
        None if is_other && !is_doubtful(mechanism, report) => {
            let motions = assembled(mechanism);
            let constrained = match mirrored(&motions) {
                Some(_) => Constrained::Mirror { freedoms: dimension },
                None => Constrained::Legs { freedoms: dimension },
            };
            let found = Found {
                lower: SubspaceClass::TranslationalSpace,
                upper: SubspaceClass::Spherical { centre: mechanism.platform },
                constrained: Some(constrained),
                twists: common.screws(),
                motions,
            };
            let of_group = !matches!(miss, WholeMiss::NoGroup { .. });
            found.solved(mechanism, report).map_err(|other| if of_group { miss } else { other })
        }
        None => Err(miss),
    }
}

/// Whether a mechanism has a joint that is nearly right, or in a wrong place of its leg: that is named, and the mechanism is not
/// taken as one that several legs constrain.
fn is_doubtful(mechanism: &Mechanism, report: &Mobility) -> bool {
    // Where all axes but one meet, nothing has a length that a miss could be small against.
    let axis = |miss: &JointMiss| {
        let of_leg = mechanism.legs.iter().filter(|leg| leg.name == miss.leg);
        let mut joints = of_leg.flat_map(|leg| &leg.joints);
        joints.any(|joint| joint.name == miss.joint && joint.kind == JointKind::Revolute)
    };
    reorder::better_order(mechanism, Exchanges::Neighbours).is_some()
        || near::near_miss(mechanism, near::MOST_DIMENSIONS).is_some()
        || odd::odd_joint(mechanism, report).is_some_and(|miss| axis(&miss))
}

/// What a platform does whose legs are solved whole.
struct Found {
    lower: SubspaceClass,
    upper: SubspaceClass,
    constrained: Option<Constrained>,
    /// Its twists at home.
    twists: Vec<Screw>,
    /// Some of its displacements, at random.
    motions: Vec<Isometry3<f64>>,
}

impl Found {
    /// The motion of a leg.
    fn of_stem(mechanism: &Mechanism, stem: usize, length: f64) -> Self {
        let leg = &mechanism.legs[stem];
        let (lower, upper) = match group_around(mechanism, leg) {
            Some(group) => (group, SubspaceClass::Identity),
            None => (
                SubspaceClass::TranslationalSpace,
                SubspaceClass::Spherical { centre: mechanism.platform },
            ),
        };
        let motions = configurations(leg, length).map(|values| end(leg, &values)).collect();
        Self {
            lower,
            upper,
            constrained: Some(Constrained::Stem(stem)),
            twists: leg.screws(),
            motions,
        }
    }

    fn solved(self, mechanism: &Mechanism, report: &Mobility) -> Result<Decomposition, WholeMiss> {
        let Self { lower, upper, constrained, twists, motions } = self;
        let frame = frame(mechanism);
        let deviation = |leg: &Leg| {
            let span = MotionSubspace::span(frame, &leg.independent_screws());
            twists.iter().map(|screw| span.distance(screw)).fold(0.0, f64::max)
        };
        for leg in &mechanism.legs {
            let deviation = deviation(leg);
            if deviation > EXACT {
                return Err(WholeMiss::Inexact { leg: leg.name.clone(), deviation });
            }
        }
        let mut legs: Vec<LegSplit> = Vec::new();
        for leg in &mechanism.legs {
            let alike = |other: &Leg| joints(other).map(|of| of.1).eq(joints(leg).map(|of| of.1));
            let before = mechanism.legs.iter().zip(&legs).filter(|(other, _)| alike(other));
            let before: Vec<&WholeLeg> =
                before.filter_map(|(_, split)| split.whole.as_ref()).collect();
            let whole = solved(leg, &motions, frame.length, &before).map_err(|reason| {
                WholeMiss::Leg { leg: leg.name.clone(), chain: chain(leg), reason }
            })?;
            let lower = Freedom::of_leg(leg);
            legs.push(LegSplit { lower, upper: vec![], imaginary: false, whole: Some(whole) });
        }
        Ok(Decomposition {
            lambda: report.lambda,
            mobility: report.mobility,
            lower,
            upper,
            intersection: SubspaceClass::Identity,
            constrained,
            legs,
            imaginary_joints: 0,
            first_section_motions: report.mobility,
            upper_mobility: 0,
            redundancy: 0,
            deviation: mechanism.legs.iter().map(deviation).fold(0.0, f64::max),
        })
    }
}

/// A group in which a leg moves, smaller than all displacements.
fn group_around(mechanism: &Mechanism, leg: &Leg) -> Option<SubspaceClass> {
    let screws = leg.screws();
    let generated = MotionSubspace::span(frame(mechanism), &screws).closure().class();
    let turning = screws.iter().find(|screw| screw.angular != Vector3::zeros());
    match (generated?, turning) {
        // A crank turns about its own axis in the plane across it.
        (SubspaceClass::Rotation { .. } | SubspaceClass::Planar { .. }, Some(screw)) => {
            Some(SubspaceClass::Planar { normal: Unit::new_normalize(screw.angular) })
        }
        (SubspaceClass::Translation { .. } | SubspaceClass::TranslationalPlane { .. }, _) => {
            Some(SubspaceClass::TranslationalSpace)
        }
        (group @ SubspaceClass::Spherical { .. }, _) => Some(group),
        _ => None,
    }
}

/// The displacement of a leg's end by the values of its freedoms, a ball's as a rotation vector.
pub(crate) fn end(leg: &Leg, values: &[f64]) -> Isometry3<f64> {
    let mut rest = values;
    joints(leg).fold(Isometry3::identity(), |g, (joint, _)| {
        let (own, others) = rest.split_at(joint.freedoms());
        rest = others;
        g * joint.exp(own)
    })
}

/// Values of a leg's freedoms near home, without a pattern: see [`motions`].
pub(crate) fn configurations(leg: &Leg, length: f64) -> impl Iterator<Item = Vec<f64>> {
    let units: Vec<f64> = (joints(leg))
        .flat_map(|(joint, _)| {
            let unit = if matches!(joint, LegJoint::Slide { .. }) { length } else { 1.0 };
            std::iter::repeat_n(unit, joint.freedoms())
        })
        .collect();
    SIZES.into_iter().enumerate().map(move |(sample, size)| {
        let value =
            |(i, unit): (usize, &f64)| 2.0 * share(1 + i + sample * units.len()) * size * unit;
        units.iter().enumerate().map(value).collect()
    })
}

/// The closed form of a leg for the displacements that `motions` are samples of, where those `before` have the same motors.
fn solved(
    leg: &Leg,
    motions: &[Isometry3<f64>],
    length: f64,
    before: &[&WholeLeg],
) -> Result<WholeLeg, NoOrder> {
    let (joints, actuated): (Vec<LegJoint>, Vec<bool>) = joints(leg).unzip();
    WholeLeg::new(&joints, &actuated, motions, length, before)
}

impl Decomposition {
    /// The closed form of a leg that is solved whole, which may have changed since the mechanism was decomposed; `None` where
    /// legs are split.
    pub(crate) fn whole_leg<'a>(
        &self,
        mechanism: &Mechanism,
        leg: &Leg,
        split: &'a LegSplit,
        length: f64,
    ) -> Option<Result<Cow<'a, WholeLeg>, NoOrder>> {
        let known = split.whole.as_ref()?;
        let joints: Vec<LegJoint> = joints(leg).map(|(joint, _)| joint).collect();
        if known.is_of(&joints) {
            return Some(Ok(Cow::Borrowed(known)));
        }
        let motions = match self.platform() {
            PlatformSet::Free => motions(&SubspaceClass::Full, length),
            PlatformSet::Pair | PlatformSet::Subgroup => motions(&self.lower, length),
            PlatformSet::Stem(stem) => Found::of_stem(mechanism, stem, length).motions,
            PlatformSet::Constrained | PlatformSet::Symmetric => assembled(mechanism),
        };
        Some(solved(leg, &motions, length, &[]).map(Cow::Owned))
    }
}

/// The joints of a leg, each with one freedom, a ball's three, or a parallelogram's two, and whether they are actuated.
pub(crate) fn joints(leg: &Leg) -> impl Iterator<Item = (LegJoint, bool)> {
    leg.joints.iter().enumerate().flat_map(|(number, joint)| {
        let back = leg.joints.get(number + 1).filter(|next| next.turns_back);
        let all = match back {
            _ if joint.turns_back => [None, None],
            Some(back) => {
                let (axis, point) = (joint.axis, joint.point);
                let arm = back.point - point;
                [Some(LegJoint::Parallelogram { axis, point, arm }), None]
            }
            None => elementary(joint),
        };
        let actuated = joint.actuated;
        all.into_iter().flatten().map(move |joint| (joint, actuated))
    })
}

/// A joint as one or two that have one freedom each, or as a ball.
fn elementary(joint: &Joint) -> [Option<LegJoint>; 2] {
    let (axis, point) = (joint.axis, joint.point);
    let turn = |axis: Unit<Vector3<f64>>, pitch: f64| Some(LegJoint::Screw { axis, point, pitch });
    match joint.kind {
        JointKind::Revolute => [turn(axis, 0.0), None],
        JointKind::Prismatic => [Some(LegJoint::Slide { axis }), None],
        JointKind::Helical { pitch } => [turn(axis, pitch), None],
        JointKind::Cylindrical => [turn(axis, 0.0), Some(LegJoint::Slide { axis })],
        JointKind::Universal { second } => [turn(axis, 0.0), turn(second, 0.0)],
        JointKind::Spherical => [Some(LegJoint::Ball { point }), None],
    }
}

/// How many samples there are, and how large they are: radians, and shares of the size.
const SIZES: [f64; 12] = [0.3, 0.3, 0.3, 0.2, 0.2, 0.2, 0.1, 0.1, 0.1, 0.05, 0.05, 0.05];

/// Displacements of a subgroup near home, without a pattern. Lengths are shares of `length`.
fn motions(class: &SubspaceClass, length: f64) -> Vec<Isometry3<f64>> {
    let screws = class.screws();
    let count = screws.len();
    let of_sample = |(sample, size): (usize, f64)| {
        screws.iter().enumerate().fold(Isometry3::identity(), |g, (i, screw)| {
            let unit = if screw.angular.norm() > 0.0 { 1.0 } else { length };
            g * screw.exp(2.0 * share(1 + i + sample * count) * size * unit)
        })
    };
    SIZES.into_iter().enumerate().map(of_sample).collect()
}
