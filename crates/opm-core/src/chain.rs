//! Closed forms of one chain of joints inside one motion subspace.
//!
//! A chain has exactly as many freedoms as its subspace has dimensions, so a displacement of that
//! subspace fixes its joints up to a sign. Every chain works in its subspace's own frame, on
//! displacements from home (`q = 0` is home, where the displacement is the identity), and finds
//! rotations as vectors that point at the angle: no trigonometry until somebody asks for it.
//!
//! What holds for all of them:
//! * `inverse` followed by `forward` returns the target.
//! * On the boundary of reach, within [`REACH_TOLERANCE`], the two branches meet and both are given.
//! * An angle that the target leaves free is given as zero, its home value.
//! * The general case is straight arithmetic, which a loop over many targets is vectorised with; what is
//!   rare, and what is out of reach, is told apart after it (`ClosedForm`).
//! * A chain whose freedoms are dependent everywhere (a zero-length link between two revolutes, two
//!   parallel sliders) is refused when it is built.

pub(crate) mod condition;
pub mod cylindrical;
pub mod equation;
mod joint;
pub mod limits;
pub mod planar;
pub mod region;
pub(crate) mod screws;
pub mod shape;
pub mod spherical;
pub mod surface;
pub(crate) mod track;
pub mod translational;

pub use joint::ChainJoint;

use crate::group::{Displacement, JointDisplacement, Subspace, SubspaceKind};
use crate::numeric::Quantity;
use cylindrical::CylindricalChain;
use joint::{coaxial_joints, planar_joints, slides, spherical_axes};
use limits::Limits;
use nalgebra::Complex;
use planar::PlanarChain;
use shape::Shape;
use spherical::{Ball, SphericalChain};
use surface::Surface;
use translational::TranslationalChain;

/// How far beyond its reach a chain still answers, as a share of its size: rounding in a target
/// that lies on the boundary of reach is of the order of 1e-15 and must not decide, and a pose on that
/// boundary counts as inside.
pub const REACH_TOLERANCE: f64 = 1e-12;

/// Shorter than this, as a share of the chain's size, a link or an angle between axes is zero.
const DEGENERATE: f64 = 1e-9;

/// One of the two solutions of a two-valued choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Branch {
    /// The solution with the plus sign.
    #[default]
    Plus,
    /// The solution with the minus sign.
    Minus,
}

impl Branch {
    /// Both, plus first.
    pub const BOTH: [Self; 2] = [Self::Plus, Self::Minus];

    /// `1.0` or `-1.0`.
    #[inline]
    pub fn sign(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

/// How far a target is out of a chain's reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachDeficit {
    /// By how much, radians or metres; positive, not NaN, infinite where no number tells.
    pub excess: f64,
    /// What `excess` measures.
    pub quantity: Quantity,
}

impl ReachDeficit {
    pub(crate) fn length(excess: f64) -> Self {
        Self::new(excess, Quantity::Length)
    }

    pub(crate) fn angle(excess: f64) -> Self {
        Self::new(excess, Quantity::Angle)
    }

    fn new(excess: f64, quantity: Quantity) -> Self {
        let excess = if excess.is_nan() { f64::INFINITY } else { excess.max(f64::MIN_POSITIVE) };
        Self { excess, quantity }
    }
}

/// Why joints do not make a closed-form chain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ChainError {
    /// The freedoms are dependent in every configuration.
    #[error("{0}")]
    Dependent(&'static str),
    /// Too few joints to reach every displacement of the subspace, or more than it can fix.
    #[error("{given} joints where the subspace has {needed} dimensions")]
    Count {
        /// Dimensions of the subspace.
        needed: usize,
        /// Freedoms given, the cut included.
        given: usize,
    },
    /// A kind of joint that no chain of the subspace takes.
    #[error("a joint that no {0} chain takes")]
    Foreign(&'static str),
}

/// `z` as a direction: one where it is zero against `size`, which leaves the angle free.
#[inline(always)]
fn direction(z: Complex<f64>, size: f64) -> Complex<f64> {
    // `z` is a product of two lengths: each may be as short as REACH_TOLERANCE.
    let shortest = REACH_TOLERANCE * REACH_TOLERANCE * size;
    let long = z.norm_sqr() > shortest * shortest;
    Complex::new(if long { z.re } else { 1.0 }, if long { z.im } else { 0.0 })
}

/// What a closed form makes of a target without asking what kind of target it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    /// The joints' displacements, base first; not to be read unless `holds`.
    pub displacements: [JointDisplacement; 3],
    /// The target is in reach, and not one of those that [`ClosedForm::exception`] is for.
    pub holds: bool,
    /// The target is out of reach. Where it neither holds nor is beyond, the exception tells.
    pub beyond: bool,
}

impl Attempt {
    /// Of a closed form to which every target in reach is alike.
    #[inline(always)]
    fn decided(displacements: [JointDisplacement; 3], holds: bool) -> Self {
        Self { displacements, holds, beyond: !holds }
    }

    /// Of the same joints from the other end, for the inverse of the target:
    /// `(E₁E₂E₃)⁻¹ = E₃⁻¹E₂⁻¹E₁⁻¹`, the joints backwards, each displacement with the other sign.
    #[inline(always)]
    fn backwards(self) -> Self {
        let [a3, a2, a1] = self.displacements;
        Self { displacements: [a1.inverse(), a2.inverse(), a3.inverse()], ..self }
    }
}

/// A chain whose target fixes its joints up to a sign.
pub(crate) trait ClosedForm {
    /// A displacement of its subspace.
    type Target;

    /// The general case: no branch, no call, so that a loop over targets is vectorised. Which of an
    /// displacement's two kinds it gives depends on the joint alone.
    fn attempt(&self, target: &Self::Target, branch: Branch) -> Attempt;

    /// What an attempt that does not hold leaves open: by how much the target is out of reach, and the
    /// targets that are unlike the rest. Not asked for where all attempts hold.
    fn exception(
        &self,
        target: &Self::Target,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        Ok(self.attempt(target, branch).displacements)
    }

    /// The joints' displacements that move the outer link by `target`.
    #[inline(always)]
    fn solve(
        &self,
        target: &Self::Target,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let Attempt { displacements, holds, .. } = self.attempt(target, branch);
        if holds { Ok(displacements) } else { self.exception(target, branch) }
    }
}

/// The closed form of one section of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chain {
    /// Three joints in a plane.
    Planar(PlanarChain),
    /// Three revolutes through a point.
    Spherical(SphericalChain),
    /// A spherical joint.
    Ball(Ball),
    /// Two coaxial joints.
    Cylindrical(CylindricalChain),
    /// Two sliders in a plane.
    Translational(TranslationalChain),
}

impl Chain {
    /// The closed form of joints given at home in base coordinates, base first, inside `subspace`.
    /// They are laid exactly into the subspace: what they are off it by is dropped.
    ///
    /// # Errors
    /// A wrong number of joints for the subspace, or joints that are dependent everywhere.
    pub fn new(subspace: &Subspace, joints: &[ChainJoint]) -> Result<Self, ChainError> {
        let needs = |needed| ChainError::Count { needed, given: joints.len() };
        match subspace.kind {
            SubspaceKind::Planar => {
                let joints: [_; 3] = joints.try_into().map_err(|_| needs(3))?;
                PlanarChain::new(planar_joints(subspace, &joints)?).map(Self::Planar)
            }
            SubspaceKind::Spherical => match joints {
                [ChainJoint::Ball] => Ok(Self::Ball(Ball { axes: subspace.axes })),
                _ => {
                    let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
                    SphericalChain::new(spherical_axes(subspace, joints)?).map(Self::Spherical)
                }
            },
            SubspaceKind::Cylindrical => {
                let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
                CylindricalChain::new(coaxial_joints(subspace, joints)?).map(Self::Cylindrical)
            }
            SubspaceKind::TranslationalPlane => {
                let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
                TranslationalChain::new(slides(subspace, joints)?).map(Self::Translational)
            }
        }
    }

    /// The translations of a plane's target at which the chain closes within its limits; `None` of other
    /// targets, and where limits on its angles make that more than a convex set less another.
    pub fn shape(&self, branch: Branch, limits: [&Limits; 3]) -> Option<Shape> {
        match self {
            Self::Planar(chain) => chain.shape(branch, limits),
            Self::Translational(chain) => Some(chain.shape(limits)),
            Self::Spherical(_) | Self::Ball(_) | Self::Cylindrical(_) => None,
        }
    }

    /// Whether a target has two solutions.
    pub fn has_choice(&self) -> bool {
        match self {
            Self::Planar(chain) => chain.has_choice(),
            Self::Spherical(_) => true,
            Self::Ball(_) | Self::Cylindrical(_) | Self::Translational(_) => false,
        }
    }

    /// Whether targets whole turns apart differ.
    pub(crate) fn counts_turns(&self) -> bool {
        match self {
            Self::Cylindrical(chain) => chain.counts_turns(),
            Self::Planar(_) | Self::Spherical(_) | Self::Ball(_) | Self::Translational(_) => false,
        }
    }

    /// Number of freedoms, which is the number of displacements that mean anything.
    pub fn freedoms(&self) -> usize {
        match self {
            Self::Planar(_) | Self::Spherical(_) | Self::Ball(_) => 3,
            Self::Cylindrical(_) | Self::Translational(_) => 2,
        }
    }

    /// The joints' displacements that move the outer link by `target`, base first; those past
    /// [`Chain::freedoms`] are zero.
    ///
    /// # Errors
    /// Out of reach: by how much.
    ///
    /// # Panics
    /// If `target` is a displacement of another kind of subspace.
    #[inline(always)]
    pub fn inverse(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let pad = |[a, b]: [JointDisplacement; 2]| [a, b, JointDisplacement::Value(0.0)];
        match self {
            Self::Planar(chain) => chain.inverse(target.planar(), branch),
            Self::Spherical(chain) => chain.inverse(target.spherical(), branch),
            Self::Ball(ball) => Ok(ball.inverse(target.spherical())),
            Self::Cylindrical(chain) => Ok(pad(chain.inverse(target.cylindrical()))),
            Self::Translational(chain) => Ok(pad(chain.inverse(*target.translational()))),
        }
    }

    /// The first joint's displacement alone, where that is all that is wanted.
    ///
    /// # Errors
    /// Out of reach: by how much.
    #[inline(always)]
    pub fn first(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<JointDisplacement, ReachDeficit> {
        match self {
            Self::Spherical(chain) => chain
                .first(&chain.third_axis(target.spherical()), branch)
                .map(JointDisplacement::Direction),
            Self::Planar(_) | Self::Ball(_) | Self::Cylindrical(_) | Self::Translational(_) => {
                self.inverse(target, branch).map(|displacements| displacements[0])
            }
        }
    }
}

/// What is known of a chain with one joint held, for a few displacements of each joint.
impl Chain {
    /// The targets on which the chain closes with joint number `joint` at `displacement`; `None` of a ball,
    /// whose rotation vector has no closed form along a path.
    pub(crate) fn held(&self, joint: usize, displacement: JointDisplacement) -> Option<Surface> {
        match self {
            Self::Planar(chain) => Some(chain.held(joint, displacement)),
            Self::Spherical(chain) => Some(chain.held(joint, displacement)),
            Self::Ball(_) => None,
            Self::Cylindrical(chain) => Some(chain.held(joint, displacement)),
            Self::Translational(chain) => Some(chain.held(joint, displacement)),
        }
    }

    /// The targets on which its two branches meet, or on which it stops closing.
    pub(crate) fn folds(&self) -> Vec<Surface> {
        let middle = match self {
            Self::Planar(chain) => chain.folds(),
            Self::Spherical(chain) => chain.folds().to_vec(),
            Self::Ball(_) | Self::Cylindrical(_) | Self::Translational(_) => Vec::new(),
        };
        middle.into_iter().filter_map(|displacement| self.held(1, displacement)).collect()
    }

    /// The limits of a joint as displacements that it can be held at.
    pub(crate) fn ends(&self, joint: usize, limits: &Limits) -> Option<[JointDisplacement; 2]> {
        let turns = match self {
            Self::Planar(chain) => chain.is_rotation(joint),
            Self::Spherical(_) => true,
            Self::Ball(_) | Self::Translational(_) => false,
            Self::Cylindrical(chain) => chain.is_rotation(joint),
        };
        if turns { limits.direction_ends() } else { limits.value_ends() }
    }

    /// No length of the chain at home is longer, metres.
    pub(crate) fn size(&self) -> f64 {
        match self {
            Self::Planar(chain) => chain.size(),
            Self::Cylindrical(chain) => chain.joints().iter().map(|j| j.advance.abs()).sum(),
            Self::Spherical(_) | Self::Ball(_) | Self::Translational(_) => 0.0,
        }
    }
}
