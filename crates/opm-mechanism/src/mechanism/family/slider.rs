//! The PRR part of a slider leg, which several families share:
//!
//! ```text
//! A = h e(α) + S n(α)      S{i}    prismatic along n(α), actuated
//! C = A + a1 e(α+π/2+φ1)   phi1{i} revolute at A, along +z
//!                          phi2{i} revolute at C, along +z
//! ```
//!
//! The layout has `S = φ1 = φ2 = 0`: the link a1, and everything it carries, lie along the slider.

use super::assembly::{Problems, out_of_reach};
use crate::chain::Branch;
use crate::chain::planar::{PlanarChain, PlanarJoint};
use crate::group::{JointDisplacement, PlanarDisplacement};
use crate::mechanism::joint::{Joint, JointKind, JointLimits};
use crate::numeric::angle::unit;
use nalgebra::{Complex, Point3, Unit, Vector3};
use std::f64::consts::FRAC_PI_2;

/// The chain in its layout, in the base's xy plane as complex numbers, metres.
pub(super) struct SliderChain {
    /// Direction `n(α)` of the slider, unit length.
    pub along: Complex<f64>,
    /// The point A.
    pub a: Complex<f64>,
    /// The point C.
    pub c: Complex<f64>,
}

impl SliderChain {
    pub fn new(alpha: f64, h: f64, a1: f64) -> Self {
        let along = unit(alpha + FRAC_PI_2);
        let a = unit(alpha) * h;
        Self { along, a, c: a + along * a1 }
    }

    /// The values of S, φ1 and φ2 that bring C to `target` and turn what lies along the slider
    /// beyond C into `direction`.
    pub fn reach(
        &self,
        target: Complex<f64>,
        direction: Complex<f64>,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], Problems> {
        let joints = [PlanarJoint::Prismatic { along: self.along }, pivot(self.a), pivot(self.c)];
        PlanarChain::new(joints)?
            .inverse(&onto(self.c, target, direction * self.along.conj()), branch)
            .map_err(out_of_reach("links"))
    }

    /// The three joints of leg `number`, in the layout, with their limits.
    pub fn joints(&self, number: usize, limits: [JointLimits; 3]) -> [Joint; 3] {
        let at = |z: Complex<f64>| Point3::new(z.re, z.im, 0.0);
        let axis = Unit::new_unchecked(at(self.along).coords);
        let revolute = |name, point| {
            let name = format!("{name}{number}");
            Joint::new(name, JointKind::Revolute, Vector3::z_axis(), at(point))
        };
        let slider = Joint::new(format!("S{number}"), JointKind::Prismatic, axis, at(self.a));
        [
            slider.actuated().limited(limits[0]),
            revolute("phi1", self.a).limited(limits[1]),
            revolute("phi2", self.c).limited(limits[2]),
        ]
    }
}

/// The displacement that rotates by `rotation` and carries the point `from` to `to`.
pub(super) fn onto(
    from: Complex<f64>,
    to: Complex<f64>,
    rotation: Complex<f64>,
) -> PlanarDisplacement {
    PlanarDisplacement { rotation, translation: to - rotation * from }
}

/// A revolute joint about +z.
pub(super) fn pivot(at: Complex<f64>) -> PlanarJoint {
    PlanarJoint::Revolute { at, reversed: false }
}
