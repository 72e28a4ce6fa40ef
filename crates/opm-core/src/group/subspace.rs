//! Motion subspaces: what a set of joint screws spans, whether that is closed under the Lie bracket
//! (so that its exponentials are a group of displacements), and which group it is.
//!
//! Up to conjugation SE(3) has a dozen kinds of connected subgroups (Hervé, "Analyse structurelle
//! des mécanismes par groupe des déplacements", Mech. Mach. Theory 13, 1978): [`SubspaceClass`].

mod basis;
mod class;
mod frame;

pub(crate) use basis::Basis;
pub(crate) use class::{Fit, fit, points_up, upward};
pub use class::{SubspaceClass, UP};
pub use frame::Frame;

use crate::group::screw::Screw;

/// What counts as zero beside the size of a mechanism, in every decision on rank and membership.
///
/// Coordinates written with six significant digits are off by up to 5e-6 of their magnitude; after
/// a displacement by several sizes of the mechanism that is some 1e-5 of its characteristic length,
/// and a few times that where it adds up over axes. A deliberate offset or pitch is larger than
/// one ten-thousandth of a mechanism.
pub const TOLERANCE: f64 = 1e-4;

/// The span of a set of screws, in a normalised frame: an orthonormal basis with the origin in the
/// middle of the mechanism and lengths over its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSubspace {
    frame: Frame,
    basis: Basis,
}

impl MotionSubspace {
    /// Span of screws in base coordinates; `frame` is that of the whole mechanism.
    pub fn span(frame: Frame, screws: &[Screw]) -> Self {
        let vectors: Vec<_> = screws.iter().map(|screw| frame.unit(screw)).collect();
        Self { frame, basis: Basis::span(&vectors) }
    }

    /// 0 to 6.
    pub fn dimension(&self) -> usize {
        self.basis.dimension()
    }

    /// Independent screws that span it, in base coordinates.
    pub fn screws(&self) -> Vec<Screw> {
        self.basis.vectors().iter().map(|vector| self.frame.restored(vector)).collect()
    }

    /// How far a screw is from being a member: the sine of its angle to the subspace in the
    /// normalised frame, 0 to 1.
    pub fn distance(&self, screw: &Screw) -> f64 {
        self.basis.residual(&self.frame.unit(screw)).norm()
    }

    /// Smallest subalgebra that contains it: brackets are added until none is new.
    #[must_use]
    pub fn closure(&self) -> Self {
        Self { frame: self.frame, basis: self.basis.closure(TOLERANCE) }
    }

    /// Whether the bracket of any two members is a member.
    pub fn is_subalgebra(&self) -> bool {
        self.basis.bracket_excess() <= TOLERANCE
    }

    /// What both contain; `other` is in the same frame.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self { frame: self.frame, basis: self.basis.intersection(&other.basis) }
    }

    /// The group that it generates, if it is closed under the bracket.
    pub fn class(&self) -> Option<SubspaceClass> {
        let fitted = fit(self.basis.vectors())?;
        Some(fitted.class.restored(&self.frame))
    }
}

#[cfg(test)]
mod tests;
