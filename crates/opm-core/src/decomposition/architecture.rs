//! The notation of the field for chains of joints, and common names of architectures.

use crate::group::subspace::SubspaceClass;
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;

/// The letter of a joint: `R`, `P`, `H`, `C`, `U` or `S`.
fn letter(kind: JointKind) -> char {
    match kind {
        JointKind::Revolute => 'R',
        JointKind::Prismatic => 'P',
        JointKind::Helical { .. } => 'H',
        JointKind::Cylindrical => 'C',
        JointKind::Universal { .. } => 'U',
        JointKind::Spherical => 'S',
    }
}

/// The joints of a leg from base to platform, such as `UPS`.
pub(super) fn chain(leg: &Leg) -> String {
    leg.joints.iter().map(|joint| letter(joint.kind)).collect()
}

/// The legs in the notation of the field, such as `6-UPS` or `3-PRRRR + RRS`. Equal chains are counted
/// together, in the order in which they first appear.
pub(super) fn notation(chains: &[String]) -> String {
    let mut counted: Vec<(&str, usize)> = vec![];
    for chain in chains {
        match counted.iter_mut().find(|(known, _)| known == chain) {
            Some((_, count)) => *count += 1,
            None => counted.push((chain, 1)),
        }
    }
    let part = |(chain, count): &(&str, usize)| match count {
        1 => (*chain).to_owned(),
        count => format!("{count}-{chain}"),
    };
    counted.iter().map(part).collect::<Vec<_>>().join(" + ")
}

/// What the platform must be able to do at home, for a common name to be right.
#[derive(Clone, Copy)]
enum Motion {
    /// The joint types decide alone.
    Any,
    Full,
    Planar,
    Spherical,
    Translations,
    Schoenflies,
}

impl Motion {
    fn is(self, platform: Option<&SubspaceClass>) -> bool {
        match self {
            Self::Any => true,
            Self::Full => matches!(platform, Some(SubspaceClass::Full)),
            Self::Planar => matches!(platform, Some(SubspaceClass::Planar { .. })),
            Self::Spherical => matches!(platform, Some(SubspaceClass::Spherical { .. })),
            Self::Translations => matches!(platform, Some(SubspaceClass::TranslationalSpace)),
            Self::Schoenflies => matches!(platform, Some(SubspaceClass::Schoenflies { .. })),
        }
    }
}

/// Common names by notation. A name is that of the architecture only: joint types and the platform's
/// motion, not dimensions.
const NAMES: [(&str, Motion, &str); 16] = [
    ("6-UPS", Motion::Full, "Gough-Stewart platform"),
    ("6-SPU", Motion::Full, "Gough-Stewart platform"),
    ("6-SPS", Motion::Full, "Gough-Stewart platform"),
    ("6-UCU", Motion::Full, "Gough-Stewart platform"),
    ("6-RUS", Motion::Full, "rotary hexapod"),
    ("6-RSS", Motion::Full, "rotary hexapod"),
    ("6-PUS", Motion::Full, "hexapod with fixed linear actuators"),
    ("3-RPS", Motion::Any, "3-RPS tripod"),
    ("3-PRS", Motion::Any, "3-PRS tripod"),
    ("3-RUU", Motion::Translations, "Delta robot, with universal joints for its parallelograms"),
    (
        "3-PUU",
        Motion::Translations,
        "linear Delta robot, with universal joints for its parallelograms",
    ),
    ("3-UPU", Motion::Translations, "translational 3-UPU"),
    ("3-UPU", Motion::Spherical, "spherical 3-UPU wrist"),
    ("4-RUU", Motion::Schoenflies, "4-RUU Schoenflies-motion generator"),
    ("3-RRR", Motion::Planar, "planar 3-RRR"),
    ("3-RRR", Motion::Spherical, "spherical 3-RRR wrist"),
];

/// The common name of an architecture, given in the notation of the field, whose platform moves in a
/// group at home; `None` if it has none, or if the group is not the one of that name.
pub(super) fn common_name(
    notation: &str,
    platform: Option<&SubspaceClass>,
) -> Option<&'static str> {
    let named =
        |(legs, motion, _): &&(&str, Motion, &str)| *legs == notation && motion.is(platform);
    NAMES.iter().find(named).map(|(_, _, name)| *name)
}
