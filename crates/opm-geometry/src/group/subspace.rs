//! Motion subspaces: the span of a set of joint screws, whether that span is closed under the Lie
//! bracket (so that its exponentials form a group of displacements), and which group it is.
//!
//! Up to conjugation SE(3) has a dozen kinds of connected subgroups (Hervé, "Analyse structurelle
//! des mécanismes par groupe des déplacements", Mech. Mach. Theory 13, 1978): [`SubspaceClass`].

mod basis;
mod class;
mod frame;

pub use class::{SubspaceClass, UP};
pub use frame::Frame;

// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub use {
    basis::Basis,
    class::{Fit, fit, points_up, upward},
};

use crate::group::screw::Screw;

/// The relative tolerance that counts as zero in every decision about rank and membership.
///
/// Coordinates written with six significant digits are off by up to 5e-6 of their magnitude; after
/// a displacement by several sizes of the mechanism that is some 1e-5 of its characteristic length,
/// and a few times that where it adds up over axes. A deliberate offset or pitch is larger than
/// one ten-thousandth of a mechanism.
pub const TOLERANCE: f64 = 1e-4;

/// The span of a set of screws, stored as an orthonormal basis in a normalised frame: the origin is
/// in the middle of the mechanism, and lengths are divided by the mechanism's size.
///
/// ```
/// # extern crate opm_geometry as opm_core;
/// use nalgebra::{Point3, Unit, Vector3};
/// use opm_core::group::screw::Screw;
/// use opm_core::group::subspace::{Frame, MotionSubspace, SubspaceClass};
///
/// // Three revolute axes through one point, of different directions.
/// let centre = Point3::new(0.1, 0.2, 0.3);
/// let axes = [Vector3::x(), Vector3::y(), Vector3::new(1.0, 1.0, 1.0)];
/// let screws = axes.map(|axis| Screw::rotation(Unit::new_normalize(axis), centre));
/// let frame = Frame::of(&screws.map(|screw| (screw, centre)));
/// let subspace = MotionSubspace::span(frame, &screws);
/// assert_eq!(subspace.dimension(), 3);
/// let Some(SubspaceClass::Spherical { centre: found }) = subspace.class() else { panic!() };
/// assert!((found - centre).norm() < 1e-12);
///
/// // Two of them only do not form a group: their bracket is the third rotation.
/// let pair = MotionSubspace::span(frame, &screws[..2]);
/// assert!(pair.class().is_none());
/// assert_eq!(pair.closure().dimension(), 3);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSubspace {
    frame: Frame,
    basis: Basis,
}

impl MotionSubspace {
    /// The span of screws given in base coordinates. `frame` is the frame of the whole mechanism.
    pub fn span(frame: Frame, screws: &[Screw]) -> Self {
        let vectors: Vec<_> = screws.iter().map(|screw| frame.unit(screw)).collect();
        Self { frame, basis: Basis::span(&vectors) }
    }

    /// The dimension of the subspace, 0 to 6.
    pub fn dimension(&self) -> usize {
        self.basis.dimension()
    }

    /// Independent screws that span the subspace, in base coordinates.
    pub fn screws(&self) -> Vec<Screw> {
        self.basis.vectors().iter().map(|vector| self.frame.restored(vector)).collect()
    }

    /// The distance of a screw from the subspace: the sine of the angle between them in the
    /// normalised frame, 0 to 1.
    pub fn distance(&self, screw: &Screw) -> f64 {
        self.basis.residual(&self.frame.unit(screw)).norm()
    }

    /// The smallest Lie subalgebra that contains the subspace: brackets are added until none is
    /// new.
    #[must_use]
    pub fn closure(&self) -> Self {
        Self { frame: self.frame, basis: self.basis.closure(TOLERANCE) }
    }

    /// Whether the bracket of any two members is a member.
    pub fn is_subalgebra(&self) -> bool {
        self.basis.bracket_excess() <= TOLERANCE
    }

    /// The intersection with another subspace, which must have the same frame.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self { frame: self.frame, basis: self.basis.intersection(&other.basis) }
    }

    /// The group that the subspace generates; `None` if the subspace is not closed under the
    /// bracket.
    pub fn class(&self) -> Option<SubspaceClass> {
        let fitted = fit(self.basis.vectors())?;
        Some(fitted.class.restored(&self.frame))
    }
}

#[cfg(test)]
mod tests;
