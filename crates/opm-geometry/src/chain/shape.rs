//! The region of the plane in which a chain closes, for every rotation of its target: a fixed region that
//! moves as the target rotates.
//!
//! A target takes the point `z` to `r z + t`. A chain that ends in a pivot `p` closes where the
//! pivot's place `r p + t` is in a fixed region `R`, so for the translations `t` in `R - r p`. A chain that
//! begins with a pivot is the reverse of such a chain, and closes for the translations in `p + r R`.

use super::planar::{LinkLimits, PlanarJoint, Prp};
use super::region::Region;
use crate::chain::limits::Limits;
use crate::group::JointDisplacement;
use nalgebra::Complex;

/// The region in which a chain closes, before the target's rotation is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    motion: ShapeMotion,
    /// The limits of the joint that makes the target's rotation, where one joint does and has limits.
    rotation_limits: Option<RotationLimits>,
    /// The limits on the direction of the link of a slider with a link.
    link_limits: Option<LinkLimits>,
}

/// How the region in which a chain closes moves as the target rotates by `r`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ShapeMotion {
    /// The region `R - r p`.
    Carried(Region, Complex<f64>),
    /// The region `p + r R`.
    Turned(Region, Complex<f64>),
    /// A parallelogram between a fixed slider and one that rotates with the target; the fields are the chain
    /// and the ranges of its sliders.
    Sheared(Prp, [[f64; 2]; 2]),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct RotationLimits {
    /// Whether the joint's angle is positive clockwise.
    reversed: bool,
    limits: Limits,
}

impl Shape {
    /// The shape of a chain that ends in a pivot, at `pivot` at home, which can be in `places`.
    pub fn of_places(places: Region, pivot: Complex<f64>) -> Self {
        Self {
            motion: ShapeMotion::Carried(places, pivot),
            rotation_limits: None,
            link_limits: None,
        }
    }

    /// The shape of a slider, a pivot and a slider, with the sliders' displacements in these ranges.
    pub(super) fn sheared(chain: Prp, ranges: [[f64; 2]; 2]) -> Self {
        Self {
            motion: ShapeMotion::Sheared(chain, ranges),
            rotation_limits: None,
            link_limits: None,
        }
    }

    /// The shape of the reversed chain, whose targets are the inverses: `-r · region(conj r)`.
    #[must_use]
    pub(super) fn backwards(self) -> Self {
        let motion = match self.motion {
            ShapeMotion::Carried(region, at) => {
                ShapeMotion::Turned(region.turned((-1.0).into()), at)
            }
            ShapeMotion::Turned(region, at) => {
                ShapeMotion::Carried(region.turned((-1.0).into()), at)
            }
            sheared @ ShapeMotion::Sheared(..) => sheared,
        };
        Self { motion, ..self }
    }

    /// The same shape, but only the part of it that these limits allow.
    #[must_use]
    pub(super) fn with_link(self, link_limits: Option<LinkLimits>) -> Self {
        Self { link_limits, ..self }
    }

    /// The same shape, but empty where the target's rotation is beyond the limits of the pivot that makes it.
    #[must_use]
    pub(super) fn within(self, pivot: &PlanarJoint, limits: &Limits) -> Self {
        let reversed = pivot.is_reversed();
        let rotation_limits =
            (*limits != Limits::Free).then_some(RotationLimits { reversed, limits: *limits });
        Self { rotation_limits, ..self }
    }

    /// How the region moves, whatever the limits on the rotation and on links.
    pub fn motion(&self) -> &ShapeMotion {
        &self.motion
    }

    /// The limits on the target's rotation, and whether they are those of the opposite rotation.
    pub fn rotation_limits(&self) -> Option<(bool, &Limits)> {
        self.rotation_limits.as_ref().map(|of| (of.reversed, &of.limits))
    }

    /// Calls `found` with the regions that limits on a link's direction leave, which are all to be met, placed as that of
    /// [`Shape::at`].
    pub fn link_regions(
        &self,
        rotation: Complex<f64>,
        shift: Complex<f64>,
        scale: f64,
        mut found: impl FnMut(Region),
    ) {
        let Some(limits) = &self.link_limits else { return };
        match &self.motion {
            ShapeMotion::Carried(_, pivot) => limits.places(rotation, |places| {
                found(places.placed(shift - rotation * pivot, scale));
            }),
            ShapeMotion::Turned(_, pivot) => limits.places(rotation.conj(), |places| {
                found(places.turned(-rotation).placed(shift + pivot, scale));
            }),
            ShapeMotion::Sheared(..) => {}
        }
    }

    /// Whether a link's direction is limited.
    pub fn limits_link(&self) -> bool {
        self.link_limits.is_some()
    }

    /// The region for targets with this rotation, with each of its points `z` moved to `scale · (z + shift)`, without limits
    /// on links; `None` where sliders are nearly parallel.
    #[inline(always)]
    pub fn at(&self, rotation: Complex<f64>, shift: Complex<f64>, scale: f64) -> Option<Region> {
        if let Some(RotationLimits { reversed, limits }) = &self.rotation_limits {
            let angle = if *reversed { rotation.conj() } else { rotation };
            if !limits.admits(JointDisplacement::Direction(angle)) {
                return Some(Region::NOTHING);
            }
        }
        Some(match &self.motion {
            ShapeMotion::Carried(places, pivot) => places.placed(shift - rotation * pivot, scale),
            ShapeMotion::Turned(region, pivot) => {
                region.turned(rotation).placed(shift + pivot, scale)
            }
            ShapeMotion::Sheared(chain, ranges) => {
                chain.region(rotation, *ranges)?.placed(shift, scale)
            }
        })
    }
}
