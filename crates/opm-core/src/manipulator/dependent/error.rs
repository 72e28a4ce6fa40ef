//! Why dependent coordinates have no closed form.

use super::rows::NoRows;
use crate::chain::whole::NoOrder;
use crate::manipulator::leg::Section;
use crate::mechanism::TaskKey;

/// Why the constraining legs of a mechanism have no closed form.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// The constraint of a leg does not determine any coordinate at home.
    #[error(
        "leg {leg} constrains its {section} section, but at home no coordinate follows from that constraint"
    )]
    Singular {
        /// The leg's name.
        leg: String,
        /// The section that is constrained.
        section: Section,
    },
    /// No coordinates of the platform determine the motion of the stem at home.
    #[error(
        "leg {leg} carries the platform, but at home no task coordinates determine its joints, expected another choice of \
         `coordinates`, regular there"
    )]
    Poles {
        /// The leg's name.
        leg: String,
    },
    /// The motion of the stem has no closed form in the platform's coordinates.
    #[error(
        "leg {leg} carries the platform, but its joints do not follow from coordinates of the platform one by one: {reason}"
    )]
    Stem {
        /// The leg's name.
        leg: String,
        /// Why not.
        reason: NoOrder,
    },
    /// The constraints of several legs that are solved whole have no closed form.
    #[error(transparent)]
    Rows(NoRows),
    /// A platform is the image of its base in a plane that is not level in its coordinates.
    #[error(
        "the platform is the image of its base in a plane, expected one that is at home across the third axis of the base, and roll, \
         pitch and yaw as coordinates, zero there"
    )]
    Mirror,
    /// The file wants other independent coordinates than can be.
    #[error(
        "`independent` is {}, but the coordinates from which the others follow in closed form are {}",
        given.join(", "), expected.join(", ")
    )]
    Independent {
        /// The names in the file.
        given: Vec<String>,
        /// Those that are possible.
        expected: Vec<String>,
    },
    /// The file wants a coordinate that the mechanism does not have.
    #[error("`independent` has {name:?}, expected one of {}", expected.join(", "))]
    Unknown {
        /// The name in the file.
        name: String,
        /// The names of the task coordinates.
        expected: Vec<String>,
    },
    /// The constraints of several legs differ, or those of one have no closed form in this order.
    #[error(
        "legs {} constrain the platform in more ways than closed-form inverse kinematics covers: the mobility is \
         N = {mobility}, expected {determined}, with one constraining leg for each section, or several that \
         constrain it in the same way",
        legs.join(", ")
    )]
    Several {
        /// The names of the constraining legs.
        legs: Vec<String>,
        /// The mobility of the mechanism, `N`.
        mobility: usize,
        /// The mobility that one constraining leg for each section would leave.
        determined: usize,
    },
}

impl ConstraintError {
    /// The name of the first leg that it is about.
    pub fn leg(&self) -> Option<&str> {
        match self {
            Self::Singular { leg, .. } | Self::Stem { leg, .. } | Self::Poles { leg } => Some(leg),
            Self::Several { legs, .. } => legs.first().map(String::as_str),
            Self::Rows(NoRows::Leg { leg, .. }) => Some(leg),
            Self::Rows(_) | Self::Mirror | Self::Independent { .. } | Self::Unknown { .. } => None,
        }
    }

    /// The key of `[task]` that causes the error, if one does.
    pub fn key(&self) -> Option<TaskKey> {
        match self {
            Self::Independent { .. } | Self::Unknown { .. } | Self::Rows(NoRows::Wanted { .. }) => {
                Some(TaskKey::Independent)
            }
            _ => None,
        }
    }
}
