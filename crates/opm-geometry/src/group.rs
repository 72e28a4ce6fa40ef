//! The displacement subgroups of SE(3) that a section of a leg can move in, and their algebra.
//!
//! Each subgroup is one file, which implements the trait `Subgroup` in a frame of its own ([`Subspace`]):
//! displacements and twists, product, inverse, exponential, logarithm, action on points and on twists,
//! and steps along the intersection motion.
//!
//! | subgroup | file | displacement | twist |
//! |---|---|---|---|
//! | trivial | `identity.rs` | nothing | zero |
//! | planar, `SE(2)` | `planar.rs` | `z ↦ r z + t`, complex numbers | `(ω, vx, vy)` |
//! | spherical, `SO(3)` | `spherical.rs` | a rotation matrix | `ω` |
//! | cylindrical | `cylindrical.rs` | an angle and an advance | `(ω, v, 0)` |
//! | translational plane | `translational_plane.rs` | a complex number | `(vx, vy, 0)` |
//! | translational space | `translational_space.rs` | a vector | `(vx, vy, vz)` |
//!
//! A planar twist has the velocity of the point at the frame's origin; a twist of fewer than three
//! numbers is padded with zeros.
//!
//! [`SubspaceKind`], [`Displacement`], [`IntersectionMotion`] and [`Path`] are the closed sets of all
//! subgroups, matched exhaustively. A new subgroup is a new file and a variant of these four; the compiler
//! names every place that has to know it. Objects of two different subgroups are never combined. Code that
//! tries to do so is wrong, and panics in one place (`mismatch`).

mod cylindrical;
mod displacement;
mod frame;
mod identity;
mod intersection;
mod kind;
mod path;
mod placed;
mod planar;
pub mod screw;
mod spherical;
mod subgroup;
pub mod subspace;
mod translational_plane;
mod translational_space;

pub use crate::numbers::JointDisplacement;
pub use cylindrical::{CylindricalDisplacement, CylindricalMotion};
pub use displacement::Displacement;
pub use frame::Subspace;
pub use identity::IdentityDisplacement;
pub use intersection::{IntersectionMotion, MotionType};
pub use kind::SubspaceKind;
pub use path::{Path, PlanarPath};
pub use placed::Placed;
pub use planar::{PlanarDisplacement, PlanarMotion};
pub use spherical::SphericalMotion;
pub use translational_plane::TranslationalMotion;
pub use translational_space::SpatialMotion;

pub(crate) use identity::Identity;

// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub use {
    crate::numbers::nearest,
    cylindrical::Cylindrical,
    planar::{Planar, angular_and_linear, linear, quarter},
    spherical::{Spherical, rotated, rotation_about, rotation_vector},
    subgroup::{LocalTwist, Subgroup},
    translational_plane::TranslationalPlane,
    translational_space::TranslationalSpace,
};

/// Panics, since objects of two different subgroups are combined. [`Displacement`]s,
/// [`IntersectionMotion`]s and [`Path`]s carry their subgroup, and every caller pairs those of one
/// section.
#[cold]
#[inline(never)]
#[doc(hidden)]
pub fn mismatch(expected: SubspaceKind, found: SubspaceKind) -> ! {
    panic!("expected an object of a {expected} subspace, found one of a {found} subspace")
}

#[cfg(test)]
mod tests;
