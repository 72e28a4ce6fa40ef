//! Which subgroups have closed-form chains.

use super::subspace::SubspaceClass;
use std::fmt;

/// The subgroups that have closed-form chains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubspaceKind {
    /// `SE(2)`: two translations and the rotation about their normal.
    Planar,
    /// `SO(3)`: rotations about a centre.
    Spherical,
    /// Rotation about and translation along an axis.
    Cylindrical,
    /// Two translations.
    TranslationalPlane,
}

impl SubspaceKind {
    /// The kind of a subspace, if it has closed-form chains.
    pub fn of(class: &SubspaceClass) -> Option<Self> {
        match class {
            SubspaceClass::Planar { .. } => Some(Self::Planar),
            SubspaceClass::Spherical { .. } => Some(Self::Spherical),
            SubspaceClass::Cylindrical { .. } => Some(Self::Cylindrical),
            SubspaceClass::TranslationalPlane { .. } => Some(Self::TranslationalPlane),
            SubspaceClass::Identity
            | SubspaceClass::Rotation { .. }
            | SubspaceClass::Translation { .. }
            | SubspaceClass::Helical { .. }
            | SubspaceClass::TranslationalSpace
            | SubspaceClass::PlanarHelical { .. }
            | SubspaceClass::Schoenflies { .. }
            | SubspaceClass::Full => None,
        }
    }
}

impl fmt::Display for SubspaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Planar => "planar",
            Self::Spherical => "spherical",
            Self::Cylindrical => "cylindrical",
            Self::TranslationalPlane => "translational plane",
        })
    }
}
