//! The kinds of subspaces that have closed-form chains.

use super::subspace::SubspaceClass;
use std::fmt;

/// The subgroups that have closed-form chains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SubspaceKind {
    /// The trivial group: no motion. It is the upper subspace of a mechanism whose legs all move in one
    /// subgroup.
    Identity,
    /// `SE(2)`: the translations in a plane and the rotations about its normals.
    Planar,
    /// `SO(3)`: the rotations about a centre.
    Spherical,
    /// The rotations about and translations along one axis.
    Cylindrical,
    /// The translations in a plane.
    TranslationalPlane,
    /// All translations of space.
    TranslationalSpace,
}

impl SubspaceKind {
    /// The kind of a subspace; `None` if no closed-form chains are known for it.
    pub fn of(class: &SubspaceClass) -> Option<Self> {
        match class {
            SubspaceClass::Identity => Some(Self::Identity),
            // A Schoenflies section is a planar one at a height.
            SubspaceClass::Planar { .. } | SubspaceClass::Schoenflies { .. } => Some(Self::Planar),
            SubspaceClass::Spherical { .. } => Some(Self::Spherical),
            SubspaceClass::Cylindrical { .. } => Some(Self::Cylindrical),
            SubspaceClass::TranslationalPlane { .. } => Some(Self::TranslationalPlane),
            SubspaceClass::TranslationalSpace => Some(Self::TranslationalSpace),
            SubspaceClass::Rotation { .. }
            | SubspaceClass::Translation { .. }
            | SubspaceClass::Helical { .. }
            | SubspaceClass::PlanarHelical { .. }
            | SubspaceClass::Full => None,
        }
    }
}

impl fmt::Display for SubspaceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Identity => "identity",
            Self::Planar => "planar",
            Self::Spherical => "spherical",
            Self::Cylindrical => "cylindrical",
            Self::TranslationalPlane => "translational plane",
            Self::TranslationalSpace => "translational space",
        })
    }
}
