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

use super::closed_form::{self, Attempt, ClosedForm, Closes, Exception};
use super::shape::Shape;
use super::{Branch, ChainError, ReachDeficit};
use crate::chain::limits::Limits;
use crate::group::{JointDisplacement, PlanarDisplacement};
use crate::numbers::{Joint, Over, Plane, PlaneOver, REACH, Real, Truth};
use nalgebra::Complex;

/// A joint of a planar chain at home.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarJoint<Z: Plane = Complex<f64>> {
    /// Rotation about the point `at`; positive clockwise where `reversed`.
    Revolute {
        /// The position of the axis at home, metres.
        at: Z,
        /// Whether the joint's axis points against the plane's normal.
        reversed: Z::Sense,
    },
    /// Translation in the direction `along`, a unit vector.
    Prismatic {
        /// The unit direction at home.
        along: Z,
    },
}

impl<Z: Plane> PlanarJoint<Z> {
    /// The joint displaced by `g`.
    pub fn carried<T: PlaneOver<Z, Sense = Z::Sense>>(
        self,
        g: &PlanarDisplacement<T>,
    ) -> PlanarJoint<T> {
        match self {
            Self::Revolute { at, reversed } => PlanarJoint::Revolute { at: g.apply(at), reversed },
            Self::Prismatic { along } => PlanarJoint::Prismatic { along: g.rotation * along },
        }
    }
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
}

/// A revolute joint as the closed forms need it: its position, and its sense.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Pivot<Z: Plane = Complex<f64>> {
    at: Z,
    reversed: Z::Sense,
}

impl<Z: Plane> Pivot<Z> {
    fn joint(self) -> PlanarJoint<Z> {
        PlanarJoint::Revolute { at: self.at, reversed: self.reversed }
    }

    /// The joint's displacement for a rotation by the angle of `r`, counter-clockwise in the plane's frame.
    #[inline(always)]
    fn displacement<T: Over<Z::Real>>(&self, r: T::Plane) -> T::Joint {
        T::Joint::direction(r.in_sense(self.reversed))
    }

    /// The same for an angle.
    #[inline(always)]
    fn turn<T: Over<Z::Real>>(&self, angle: T) -> T::Joint {
        T::Joint::angle(T::in_sense(angle, self.reversed))
    }
}

/// The closed form of three joints in a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanarChain<Z: Plane = Complex<f64>> {
    /// Two links and a wrist.
    Rrr(Rrr<Z>),
    /// A slider and a link.
    Prr(Prr<Z>),
    /// A link that ends in a slider: the reverse of `Prr`.
    Rrp(Rrp<Z>),
    /// A telescopic link between two pivots.
    Rpr(Rpr<Z>),
    /// A pivot that carries two sliders.
    Rpp(Rpp<Z>),
    /// Two sliders that carry a pivot.
    Ppr(Ppr<Z>),
    /// A pivot between two sliders.
    Prp(Prp<Z>),
}

/// The same expression for each kind of chain.
macro_rules! each {
    ($chain:expr, $of:ident => $value:expr) => {
        match $chain {
            PlanarChain::Rrr($of) => $value,
            PlanarChain::Prr($of) => $value,
            PlanarChain::Rrp($of) => $value,
            PlanarChain::Rpr($of) => $value,
            PlanarChain::Rpp($of) => $value,
            PlanarChain::Ppr($of) => $value,
            PlanarChain::Prp($of) => $value,
        }
    };
}

impl<Z: Plane> PlanarChain<Z> {
    /// The closed form of three joints, base first.
    ///
    /// # Panics
    /// If all three are sliders.
    pub fn of(joints: [PlanarJoint<Z>; 3]) -> Self {
        use PlanarJoint::{Prismatic, Revolute};
        let pivot = |at, reversed| Pivot { at, reversed };
        match joints {
            [
                Revolute { at: p1, reversed: r1 },
                Revolute { at: p2, reversed: r2 },
                Revolute { at: p3, reversed: r3 },
            ] => Self::Rrr(Rrr::new(pivot(p1, r1), pivot(p2, r2), pivot(p3, r3))),
            [
                Prismatic { along },
                Revolute { at: p2, reversed: r2 },
                Revolute { at: p3, reversed: r3 },
            ] => Self::Prr(Prr::new(along, pivot(p2, r2), pivot(p3, r3))),
            [
                Revolute { at: p1, reversed: r1 },
                Revolute { at: p2, reversed: r2 },
                Prismatic { along },
            ] => Self::Rrp(Rrp::new(pivot(p1, r1), pivot(p2, r2), along)),
            [
                Revolute { at: p1, reversed: r1 },
                Prismatic { along },
                Revolute { at: p3, reversed: r3 },
            ] => Self::Rpr(Rpr::new(pivot(p1, r1), along, pivot(p3, r3))),
            [Revolute { at, reversed }, Prismatic { along: d2 }, Prismatic { along: d3 }] => {
                Self::Rpp(Rpp::new(pivot(at, reversed), d2, d3))
            }
            [Prismatic { along: d1 }, Prismatic { along: d2 }, Revolute { at, reversed }] => {
                Self::Ppr(Ppr::new(d1, d2, pivot(at, reversed)))
            }
            [Prismatic { along: d1 }, Revolute { at, reversed }, Prismatic { along: d3 }] => {
                Self::Prp(Prp::new(d1, pivot(at, reversed), d3))
            }
            [Prismatic { .. }, Prismatic { .. }, Prismatic { .. }] => {
                panic!("three sliders make no chain of a plane")
            }
        }
    }

    /// The joints at home, base first.
    pub fn joints(&self) -> [PlanarJoint<Z>; 3] {
        each!(self, chain => chain.joints())
    }

    /// Whether a target has two solutions, one on each branch.
    pub fn has_choice(&self) -> bool {
        matches!(self, Self::Rrr(_) | Self::Prr(_) | Self::Rrp(_) | Self::Rpr(_))
    }

    /// What has to hold for the joints to make a chain: no link vanishes, and no sliders are parallel.
    pub fn regular(&self) -> [Closes<Z::Real>; 2] {
        each!(self, chain => chain.regular())
    }
}

impl<Z: Plane, T: Over<Z::Real>> ClosedForm<T> for PlanarChain<Z>
where
    T::Plane: PlaneOver<Z>,
{
    type Target = PlanarDisplacement<T::Plane>;

    #[inline(always)]
    fn attempt(&self, target: &Self::Target, sign: T::Sign) -> Attempt<T> {
        each!(self, chain => chain.attempt(target, sign))
    }

    #[cold]
    fn exception(&self, target: &Self::Target, sign: T::Sign) -> Exception<T> {
        each!(self, chain => chain.exception(target, sign))
    }

    fn closes(&self, target: &Self::Target) -> Closes<T> {
        each!(self, chain => chain.closes(target))
    }
}

impl PlanarChain {
    /// The closed form of three joints, base first.
    ///
    /// # Errors
    /// The three joints are dependent in every configuration, or are three sliders.
    pub fn new(joints: [PlanarJoint; 3]) -> Result<Self, ChainError> {
        if joints.iter().all(|joint| matches!(joint, PlanarJoint::Prismatic { .. })) {
            return Err(ChainError::Dependent("three sliders in one plane"));
        }
        let chain = Self::of(joints);
        match chain {
            Self::Rrr(_) | Self::Prr(_) | Self::Rrp(_) if !chain.is_regular() => {
                Err(ChainError::Dependent("two pivots coincide: a zero-length link"))
            }
            Self::Rpp(_) | Self::Ppr(_) if !chain.is_regular() => {
                Err(ChainError::Dependent("two sliders are parallel"))
            }
            _ => Ok(chain),
        }
    }

    fn is_regular(&self) -> bool {
        self.regular().into_iter().all(|condition| match condition {
            Closes::Within(number, [least, most]) => number > least && number < most,
            Closes::Always | Closes::Exceeds(..) => condition.holds(0.0),
        })
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
    pub fn solve(
        &self,
        target: &PlanarDisplacement,
        branch: Branch,
        out: &mut [JointDisplacement; 3],
    ) -> Result<(), ReachDeficit> {
        each!(self, chain => closed_form::solve(chain, target, branch, out))
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
