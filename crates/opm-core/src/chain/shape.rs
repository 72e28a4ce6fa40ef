//! Where in a plane a chain closes, for every rotation of its target: one region, which moves as the
//! target turns.
//!
//! A target takes the point `z` to `r z + t`. A chain that ends in a pivot closes where it finds that
//! pivot's new place `r p + t` in a fixed region `R`, so for the translations `t` of `R - r p`. A chain
//! that begins in a pivot, seen from its end, does so for `p + r R`.

use super::planar::{PlanarJoint, Prp};
use super::region::Region;
use crate::chain::limits::Limits;
use crate::group::JointDisplacement;
use nalgebra::Complex;

/// The region in which a chain closes, before the target's rotation is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    motion: ShapeMotion,
    /// The rotation is a joint's, within limits.
    turn: Option<Turn>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ShapeMotion {
    /// `R - r p`.
    Carried(Region, Complex<f64>),
    /// `p + r R`.
    Turned(Region, Complex<f64>),
    /// A slider stays and another turns: a parallelogram that is not the same for all rotations.
    Sheared(Prp, [[f64; 2]; 2]),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Turn {
    /// The joint counts clockwise.
    reversed: bool,
    limits: Limits,
}

impl Shape {
    /// Of a chain that ends in a pivot at `pivot`, the places of which are `places`.
    pub fn of_places(places: Region, pivot: Complex<f64>) -> Self {
        Self { motion: ShapeMotion::Carried(places, pivot), turn: None }
    }

    /// Of a slider, a pivot and a slider, the displacements of the sliders in these ranges.
    pub(super) fn sheared(chain: Prp, ranges: [[f64; 2]; 2]) -> Self {
        Self { motion: ShapeMotion::Sheared(chain, ranges), turn: None }
    }

    /// Of a chain seen from its end, given that of its targets backwards: `-r · region(conj r)`.
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

    /// The same, but nothing where the target's rotation is beyond the limits of the pivot that makes it.
    #[must_use]
    pub(super) fn within(self, pivot: &PlanarJoint, limits: &Limits) -> Self {
        let reversed = matches!(pivot, PlanarJoint::Revolute { reversed: true, .. });
        let turn = (*limits != Limits::Free).then_some(Turn { reversed, limits: *limits });
        Self { turn, ..self }
    }

    /// The region for targets that are turned by `rotation`, after every one of its points `z` has moved
    /// to `scale · (z + shift)`; `None` where sliders are nearly parallel.
    #[inline(always)]
    pub fn at(&self, rotation: Complex<f64>, shift: Complex<f64>, scale: f64) -> Option<Region> {
        if let Some(Turn { reversed, limits }) = &self.turn {
            let turn = if *reversed { rotation.conj() } else { rotation };
            if !limits.admits(JointDisplacement::Direction(turn)) {
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
