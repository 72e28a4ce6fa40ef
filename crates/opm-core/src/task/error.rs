//! Why a mechanism has no task coordinates.

use crate::decomposition::{Decomposition, Freedom, LegSplit};
use crate::group::SubspaceKind;
use crate::group::screw::Screw;
use crate::group::subspace::{MotionSubspace, SubspaceClass};
use crate::mechanism::leg::{Leg, Section};
use crate::mechanism::{Mechanism, OrientationCoordinates, TaskKey};
use std::fmt;

/// Why a decomposition has no task coordinates.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// A subspace without closed-form chains.
    #[error(
        "the {section} section moves in a {name} subspace, which has no closed-form chains{}",
        odd.as_ref().map(OddJoint::to_string).unwrap_or_default()
    )]
    Subspace {
        /// The section that moves in the subspace.
        section: Section,
        /// The name of the subspace.
        name: &'static str,
        /// The joint without which there would be closed-form chains, if there is exactly one.
        odd: Option<OddJoint>,
    },
    /// The two subspaces meet in a screw motion.
    #[error(
        "the partial subspaces meet in a screw motion, for which there are no closed-form chains"
    )]
    Screw,
    /// One joint alone changes the height of a section, which other legs hold.
    #[error(
        "joint {} of leg {} alone changes the height of the {section} section; without it, the section would be {}",
        odd.joint, odd.leg, odd.without
    )]
    Height {
        /// The section.
        section: Section,
        /// The joint.
        odd: OddJoint,
    },
    /// A joint has the name of a task coordinate of this mechanism.
    #[error(
        "joint {joint} of leg {leg} has the name of a task coordinate of this mechanism, expected another"
    )]
    JointName {
        /// The name of the leg.
        leg: String,
        /// The name of the joint.
        joint: &'static str,
    },
    /// The mechanism's hint `axis` is perpendicular to the intersection motion, so that it chooses neither of
    /// its two directions.
    #[error(
        "[task] axis is {}, perpendicular to the intersection motion, expected a direction along {} or \
         opposite to it",
        triple(given),
        triple(along)
    )]
    Axis {
        /// The direction given, base coordinates.
        given: [f64; 3],
        /// The unit direction of the intersection motion, base coordinates.
        along: [f64; 3],
    },
    /// The mechanism's hint on a frame does not fit the geometry.
    #[error("[task] {key} {problem}")]
    Frame {
        /// The hint that does not fit.
        key: TaskKey,
        /// Why it does not fit the geometry.
        problem: FrameProblem,
    },
    /// The orientation at home is given in two ways.
    #[error(
        "[task] home gives the orientation by `{euler}` and by `{other}`, expected Euler angles alone, or roll, pitch \
         and yaw alone"
    )]
    HomeTwice {
        /// The name of an Euler angle that is given.
        euler: String,
        /// The name of one of the other angles.
        other: String,
    },
    /// The mechanism names a coordinate that its subspaces do not have.
    #[error("[task] home gives `{name}`, but the task coordinates are {expected}")]
    Unknown {
        /// The name given.
        name: String,
        /// The names of the task coordinates, separated by commas.
        expected: String,
    },
}

impl TaskError {
    /// The hint that causes the error, if one does.
    pub fn key(&self) -> Option<TaskKey> {
        match self {
            Self::Axis { .. } => Some(TaskKey::Axis),
            Self::Frame { key, .. } => Some(*key),
            Self::Unknown { .. } | Self::HomeTwice { .. } => Some(TaskKey::Home),
            Self::Subspace { .. } | Self::Screw | Self::Height { .. } | Self::JointName { .. } => {
                None
            }
        }
    }
}

/// The joint without which a section would have a subspace with closed-form chains.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("; without joint {joint} of leg {leg} it would be {without}")]
pub struct OddJoint {
    /// The leg's name.
    pub leg: String,
    /// The joint's name.
    pub joint: String,
    /// The name of the subspace that the section's other joints span.
    pub without: &'static str,
}

impl OddJoint {
    /// Looks for such a joint among the joints of a section; `None` unless there is exactly one.
    pub(super) fn find(
        mechanism: &Mechanism,
        decomposition: &Decomposition,
        section: Section,
    ) -> Option<Self> {
        let frame = crate::decomposition::mobility::frame(mechanism);
        let part = |split: &LegSplit| match section {
            Section::Lower => split.lower.clone(),
            Section::Upper => split.upper.clone(),
        };
        let freedoms: Vec<(&Leg, Freedom)> = mechanism
            .legs
            .iter()
            .zip(&decomposition.legs)
            .flat_map(|(leg, split)| part(split).into_iter().map(move |freedom| (leg, freedom)))
            .collect();
        let joint = |(leg, freedom): &(&Leg, Freedom)| leg.joints[freedom.joint].name.clone();
        let mut odd = freedoms.iter().filter_map(|one| {
            let others: Vec<Screw> = freedoms
                .iter()
                .filter(|other| joint(other) != joint(one))
                .map(|(leg, freedom)| leg.joints[freedom.joint].screws()[freedom.index])
                .collect();
            let class = MotionSubspace::span(frame, &others).class()?;
            // A Schoenflies section without one of its joints is one still, or has its height still.
            let has_height = matches!(
                class,
                SubspaceClass::Schoenflies { .. } | SubspaceClass::TranslationalSpace
            );
            SubspaceKind::of(&class).filter(|_| !has_height)?;
            let (leg, joint) = (one.0.name.clone(), joint(one));
            Some(Self { leg, joint, without: class.name() })
        });
        // Where several joints qualify, none of them alone is the cause.
        let first = odd.next()?;
        odd.all(|other| other.joint == first.joint).then_some(first)
    }
}

/// Why a hint on a frame does not fit the geometry. Directions have unit length.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FrameProblem {
    /// The hint sets a direction or point that the geometry already determines.
    NotFree {
        /// The name of the subspace.
        subspace: &'static str,
        /// The keys of the frame that can be chosen.
        free: Vec<&'static str>,
    },
    /// The hint orients the intersection motion, and the two subspaces share none.
    NoIntersection,
    /// The hint chooses the angles of an orientation, and the pose has none.
    NoOrientation(OrientationCoordinates),
    /// The hint is perpendicular to the line whose sense it chooses.
    Perpendicular {
        /// The direction given.
        given: [f64; 3],
        /// The direction of the line.
        line: [f64; 3],
    },
    /// The hint chooses the sense of a line, and is not along that line.
    NotAlong {
        /// The direction given.
        given: [f64; 3],
        /// The direction of the line.
        line: [f64; 3],
    },
    /// The direction given is not perpendicular to the normal or to the intersection motion.
    NotPerpendicular {
        /// The direction given.
        given: [f64; 3],
        /// The direction of the normal or of the intersection motion.
        to: [f64; 3],
    },
}

impl fmt::Display for FrameProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFree { subspace, free } => {
                write!(f, "is not free: the frame of this {subspace} subspace ")?;
                match &**free {
                    [] => write!(f, "has nothing to choose"),
                    free => write!(f, "has {} to choose", free.join(", ")),
                }
            }
            Self::NoIntersection => f.write_str(
                "orients the motion that the two subspaces share, but these share none, expected `axis` of \
                 `lower` or `upper`",
            ),
            Self::NoOrientation(angles) => {
                let words = match angles {
                    OrientationCoordinates::EulerAngles => "others",
                    OrientationCoordinates::TiltTorsion => "tilt and torsion",
                    OrientationCoordinates::RollPitchYaw => "roll, pitch and yaw",
                };
                let name = angles.name();
                write!(
                    f,
                    "is {name}, but this mechanism's pose has no Euler angles that {words} could replace"
                )
            }
            Self::Perpendicular { given, line } => {
                let (given, along) = (triple(given), triple(line));
                write!(f, "is {given}, perpendicular to the axis {along} that it orients")
            }
            Self::NotAlong { given, line } => {
                let (given, back) = (triple(given), triple(&line.map(|c| -c)));
                write!(f, "is {given}, expected {} or {back}", triple(line))
            }
            Self::NotPerpendicular { given, to } => {
                write!(
                    f,
                    "is {}, expected a direction perpendicular to {}",
                    triple(given),
                    triple(to)
                )
            }
        }
    }
}

pub(super) fn triple(v: &[f64; 3]) -> String {
    // Adding zero turns -0 into 0.
    let [x, y, z] = v.map(|c| (c * 1e6).round() / 1e6 + 0.0);
    format!("({x:.6}, {y:.6}, {z:.6})")
}
