//! Chains of three revolute and prismatic joints in a plane. Displacements in `SE(2)` are complex numbers.
//!
//! A planar displacement takes the point `z` to `r z + t`, `|r| = 1`. A chain with two branches finds one
//! coordinate from a triangle and the others by complex division.

mod held;
mod link;
mod ppr;
mod prp;
mod prr;
mod rpp;
mod rpr;
mod rrp;
mod rrr;

pub use link::LinkLimits;
pub use ppr::Ppr;
pub use prp::Prp;
pub use prr::Prr;
pub use rpp::Rpp;
pub use rpr::Rpr;
pub use rrp::Rrp;
pub use rrr::Rrr;

use super::shape::Shape;
use super::{Branch, ChainError, ClosedForm, ReachDeficit};
use crate::chain::limits::Limits;
use crate::group::{JointDisplacement, PlanarDisplacement};
use nalgebra::Complex;

/// A joint of a planar chain at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarJoint {
    /// Rotation about the point `at`; positive clockwise where `reversed`.
    Revolute {
        /// The position of the axis at home, metres.
        at: Complex<f64>,
        /// Whether the joint's axis points against the plane's normal.
        reversed: bool,
    },
    /// Translation in the direction `along`, a unit vector.
    Prismatic {
        /// The unit direction at home.
        along: Complex<f64>,
    },
}

impl PlanarJoint {
    /// The displacement of the outer link that the joint makes.
    pub fn displacement(&self, displacement: JointDisplacement) -> PlanarDisplacement {
        match *self {
            Self::Revolute { at, reversed } => {
                let rotation = displacement.unit_direction();
                PlanarDisplacement::about(at, if reversed { rotation.conj() } else { rotation })
            }
            Self::Prismatic { along } => {
                PlanarDisplacement::translation(along * displacement.value())
            }
        }
    }

    /// Whether the joint's axis points against the plane's normal.
    pub(super) fn is_reversed(&self) -> bool {
        matches!(self, Self::Revolute { reversed: true, .. })
    }

    /// The joint displaced by `g`.
    pub fn carried(&self, g: &PlanarDisplacement) -> Self {
        match *self {
            Self::Revolute { at, reversed } => Self::Revolute { at: g.apply(at), reversed },
            Self::Prismatic { along } => Self::Prismatic { along: g.rotation * along },
        }
    }
}

/// A revolute joint as the closed forms need it: its position, and its sense.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pivot {
    at: Complex<f64>,
    reversed: bool,
}

impl Pivot {
    fn joint(&self) -> PlanarJoint {
        PlanarJoint::Revolute { at: self.at, reversed: self.reversed }
    }

    /// The joint's displacement for a rotation by the angle of `r`, counter-clockwise in the plane's frame.
    #[inline(always)]
    fn displacement(&self, r: Complex<f64>) -> JointDisplacement {
        JointDisplacement::Direction(Complex::new(r.re, if self.reversed { -r.im } else { r.im }))
    }
}

/// The closed form of three joints in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarChain {
    /// Two links and a wrist.
    Rrr(Rrr),
    /// A slider and a link.
    Prr(Prr),
    /// A link that ends in a slider: the reverse of `Prr`.
    Rrp(Rrp),
    /// A telescopic link between two pivots.
    Rpr(Rpr),
    /// A pivot that carries two sliders.
    Rpp(Rpp),
    /// Two sliders that carry a pivot.
    Ppr(Ppr),
    /// A pivot between two sliders.
    Prp(Prp),
}

impl PlanarChain {
    /// The closed form of three joints, base first.
    ///
    /// # Errors
    /// The three joints are dependent in every configuration, or are three sliders.
    pub fn new(joints: [PlanarJoint; 3]) -> Result<Self, ChainError> {
        use PlanarJoint::{Prismatic, Revolute};
        let pivot = |at, reversed| Pivot { at, reversed };
        Ok(match joints {
            [
                Revolute { at: p1, reversed: r1 },
                Revolute { at: p2, reversed: r2 },
                Revolute { at: p3, reversed: r3 },
            ] => Self::Rrr(Rrr::new(pivot(p1, r1), pivot(p2, r2), pivot(p3, r3))?),
            [
                Prismatic { along },
                Revolute { at: p2, reversed: r2 },
                Revolute { at: p3, reversed: r3 },
            ] => Self::Prr(Prr::new(along, pivot(p2, r2), pivot(p3, r3))?),
            [
                Revolute { at: p1, reversed: r1 },
                Revolute { at: p2, reversed: r2 },
                Prismatic { along },
            ] => Self::Rrp(Rrp::new(pivot(p1, r1), pivot(p2, r2), along)?),
            [
                Revolute { at: p1, reversed: r1 },
                Prismatic { along },
                Revolute { at: p3, reversed: r3 },
            ] => Self::Rpr(Rpr::new(pivot(p1, r1), along, pivot(p3, r3))),
            [Revolute { at, reversed }, Prismatic { along: d2 }, Prismatic { along: d3 }] => {
                Self::Rpp(Rpp::new(pivot(at, reversed), d2, d3)?)
            }
            [Prismatic { along: d1 }, Prismatic { along: d2 }, Revolute { at, reversed }] => {
                Self::Ppr(Ppr::new(d1, d2, pivot(at, reversed))?)
            }
            [Prismatic { along: d1 }, Revolute { at, reversed }, Prismatic { along: d3 }] => {
                Self::Prp(Prp::new(d1, pivot(at, reversed), d3))
            }
            [Prismatic { .. }, Prismatic { .. }, Prismatic { .. }] => {
                return Err(ChainError::Dependent("three sliders in one plane"));
            }
        })
    }

    /// The joints at home, base first.
    pub fn joints(&self) -> [PlanarJoint; 3] {
        match self {
            Self::Rrr(chain) => chain.joints(),
            Self::Prr(chain) => chain.joints(),
            Self::Rrp(chain) => chain.joints(),
            Self::Rpr(chain) => chain.joints(),
            Self::Rpp(chain) => chain.joints(),
            Self::Ppr(chain) => chain.joints(),
            Self::Prp(chain) => chain.joints(),
        }
    }

    /// Whether a target has two solutions, one on each branch.
    pub fn has_choice(&self) -> bool {
        matches!(self, Self::Rrr(_) | Self::Prr(_) | Self::Rrp(_) | Self::Rpr(_))
    }

    /// The joints' displacements that move the outer link by `target`.
    ///
    /// # Errors
    /// The reach deficit, where the target is out of reach.
    #[inline(always)]
    pub fn inverse(
        &self,
        target: &PlanarDisplacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let mut found = [JointDisplacement::Value(0.0); 3];
        self.solve(target, branch, &mut found)?;
        Ok(found)
    }

    /// Writes what [`PlanarChain::inverse`] returns; nothing where the target is out of reach.
    #[inline(always)]
    pub(crate) fn solve(
        &self,
        target: &PlanarDisplacement,
        branch: Branch,
        out: &mut [JointDisplacement; 3],
    ) -> Result<(), ReachDeficit> {
        match self {
            Self::Rrr(chain) => chain.solve(target, branch, out),
            Self::Prr(chain) => chain.solve(target, branch, out),
            Self::Rrp(chain) => chain.solve(target, branch, out),
            Self::Rpr(chain) => chain.solve(target, branch, out),
            Self::Rpp(chain) => chain.solve(target, branch, out),
            Self::Ppr(chain) => chain.solve(target, branch, out),
            Self::Prp(chain) => chain.solve(target, branch, out),
        }
    }

    /// The translations of the target at which the chain closes within its limits; `None` where limits on
    /// angles make the region more than a convex set with a convex hole.
    #[doc(hidden)]
    pub fn shape(&self, branch: Branch, limits: [&Limits; 3]) -> Option<Shape> {
        let free = |turns: &[usize]| turns.iter().all(|&i| *limits[i] == Limits::Free);
        let range = |slider: usize| <[f64; 2]>::from(limits[slider].range());
        // The rotation of a chain with two sliders is that of its pivot.
        let within = |rotation: usize, shape: Shape| {
            shape.within(&self.joints()[rotation], limits[rotation])
        };
        Some(match self {
            Self::Rrr(chain) if free(&[0, 1, 2]) => chain.shape(),
            Self::Prr(chain) => chain.shape(branch, range(0), [limits[1], limits[2]]),
            Self::Rrp(chain) => chain.shape(branch, range(2), [limits[0], limits[1]]),
            Self::Rpr(chain) if free(&[0, 2]) => chain.shape(branch, range(1)),
            Self::Rrr(_) | Self::Rpr(_) => return None,
            Self::Rpp(chain) => within(0, chain.shape([range(1), range(2)])),
            Self::Ppr(chain) => within(2, chain.shape([range(0), range(1)])),
            Self::Prp(chain) => within(1, chain.shape([range(0), range(2)])),
        })
    }
}

/// The displacement of the outer link: the product of the joints' displacements, base first.
pub fn forward(
    joints: &[PlanarJoint; 3],
    displacements: &[JointDisplacement; 3],
) -> PlanarDisplacement {
    joints
        .iter()
        .zip(displacements)
        .fold(PlanarDisplacement::IDENTITY, |g, (joint, &displacement)| {
            g.after(&joint.displacement(displacement))
        })
}

/// The third component of the cross product `a × b`.
#[inline(always)]
pub(super) fn cross(a: Complex<f64>, b: Complex<f64>) -> f64 {
    a.re * b.im - a.im * b.re
}

/// The coordinates `(m, n)` of `z = m u + n v` along two unit directions that are not parallel. `m` is
/// computed from the rounded `n`, so that the sum is `z` even where the directions are nearly parallel.
#[inline(always)]
pub(super) fn along(u: Complex<f64>, v: Complex<f64>, z: Complex<f64>) -> (f64, f64) {
    let n = cross(u, z) / cross(u, v);
    let rest = z - v * n;
    (rest.re * u.re + rest.im * u.im, n)
}
