//! Closed forms of one chain of joints inside one motion subspace.
//!
//! A chain has exactly as many freedoms as its subspace has dimensions, so a displacement of that
//! subspace fixes its joints up to a sign. Every chain works in its subspace's own frame, on
//! displacements from home (`q = 0` is home, where the displacement is the identity). It finds a
//! rotation as a vector that points in the direction of the angle, and computes the angle itself only
//! where a caller needs it.
//!
//! All chains have these properties:
//! * `inverse` followed by `forward` returns the target.
//! * On the boundary of reach, within [`REACH_TOLERANCE`], the two branches meet and both are given.
//! * An angle that the target leaves free is given as zero, its home value.
//! * The general case is straight-line arithmetic, so that a loop over many targets is vectorised. Rare
//!   cases, and targets out of reach, are handled after it (`ClosedForm`).
//! * A chain whose freedoms are dependent everywhere (a zero-length link between two revolutes, two
//!   parallel sliders) is refused when it is built.

// Public for the sibling crates of the workspace only.
mod closed_form;
#[doc(hidden)]
pub mod condition;
pub mod cylindrical;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod equation;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod joint;
pub mod kernel;
pub mod limits;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod partial;
pub mod planar;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod region;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod screws;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod shape;
pub mod shell;
pub mod spatial;
pub mod spherical;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod surface;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod track;
pub mod translational;
pub mod whole;

pub use closed_form::{Attempt, ClosedForm, Closes, Exception};
pub use joint::ChainJoint;

use crate::group::{Displacement, JointDisplacement, Subspace, SubspaceKind};
use crate::numbers::{self, REACH};
use crate::numeric::Quantity;
use cylindrical::CylindricalChain;
use joint::{coaxial_joint, each, planar_joint, slide, spatial_slide, spherical_axis};
use limits::Limits;
use nalgebra::Complex;
use planar::PlanarChain;
use shape::Shape;
use spatial::SpatialChain;
use spherical::{Ball, SphericalChain};
use surface::Surface;
use translational::TranslationalChain;

/// How far beyond its reach a chain still closes, as a fraction of its size: [`REACH`].
pub const REACH_TOLERANCE: f64 = REACH.share;

/// A link length (as a fraction of the chain's size) or an angle between axes (radians) below this counts
/// as zero.
pub const DEGENERATE: f64 = numbers::DEGENERATE.share;

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
    /// Both branches, `Plus` first.
    pub const BOTH: [Self; 2] = [Self::Plus, Self::Minus];

    /// The sign of the branch: `1.0` or `-1.0`.
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
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ReachDeficit {
    /// The distance or angle by which the target is out of reach, metres or radians. It is positive and
    /// not NaN; it is infinite where it is unknown.
    pub excess: f64,
    /// Whether `excess` is a length or an angle.
    pub quantity: Quantity,
}

impl ReachDeficit {
    /// A lack of length, metres.
    pub fn length(excess: f64) -> Self {
        Self::new(excess, Quantity::Length)
    }

    /// A lack of an angle, radians.
    pub fn angle(excess: f64) -> Self {
        Self::new(excess, Quantity::Angle)
    }

    fn new(excess: f64, quantity: Quantity) -> Self {
        let excess = if excess.is_nan() { f64::INFINITY } else { excess.max(f64::MIN_POSITIVE) };
        Self { excess, quantity }
    }
}

/// Why joints do not make a closed-form chain.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// The freedoms are dependent in every configuration.
    #[error("{0}")]
    Dependent(&'static str),
    /// Too few joints to reach every displacement of the subspace, or more than it can fix.
    #[error("{given} joint{}, expected {needed}, the dimension of the subspace", if *given == 1 { "" } else { "s" })]
    Count {
        /// The dimension of the subspace.
        needed: usize,
        /// The number of joints given, the imaginary joint included.
        given: usize,
    },
    /// A kind of joint that no chain of the subspace can have. The field names the subspace.
    #[error("a joint of a kind that a {0} chain cannot have")]
    Foreign(&'static str),
}

/// The closed form of one section of a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Chain {
    /// No joints, in the trivial subspace: the outer link is the inner one.
    Rigid,
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
    /// Three sliders in space.
    Spatial(SpatialChain),
    /// Some joints of a leg that is solved [whole](whole::WholeLeg). They are no chain by themselves.
    Part(Part),
}

/// Up to three freedoms of a leg that is solved [whole](whole::WholeLeg).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Part {
    /// How many they are.
    pub freedoms: usize,
    /// Whether they are those of a spherical joint.
    pub ball: bool,
    /// Whether one of the leg's two-valued choices is counted as theirs.
    pub choice: bool,
}

impl Chain {
    /// The closed form of a chain in `subspace`. Its joints are in the order from the base, as they are at home, in
    /// base coordinates. What they deviate from the subspace by is dropped.
    ///
    /// # Errors
    /// A wrong number of joints for the subspace, or joints that are dependent everywhere.
    pub fn new(subspace: &Subspace, joints: &[ChainJoint]) -> Result<Self, ChainError> {
        let needs = |needed| ChainError::Count { needed, given: joints.len() };
        match subspace.kind {
            SubspaceKind::Identity => match joints {
                [] => Ok(Self::Rigid),
                _ => Err(needs(0)),
            },
            SubspaceKind::Planar => {
                let joints: [_; 3] = joints.try_into().map_err(|_| needs(3))?;
                PlanarChain::new(each(&joints, |joint| planar_joint(subspace, joint))?)
                    .map(Self::Planar)
            }
            SubspaceKind::Spherical => match joints {
                [ChainJoint::Ball] => Ok(Self::Ball(Ball { axes: subspace.axes })),
                _ => {
                    let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
                    SphericalChain::new(each(joints, |joint| spherical_axis(subspace, joint))?)
                        .map(Self::Spherical)
                }
            },
            SubspaceKind::Cylindrical => {
                let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
                CylindricalChain::new(each(joints, |joint| coaxial_joint(subspace, joint))?)
                    .map(Self::Cylindrical)
            }
            SubspaceKind::TranslationalPlane => {
                let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
                TranslationalChain::new(each(joints, |joint| slide(subspace, joint))?)
                    .map(Self::Translational)
            }
            SubspaceKind::TranslationalSpace => {
                let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
                SpatialChain::new(each(joints, |joint| spatial_slide(subspace, joint))?)
                    .map(Self::Spatial)
            }
        }
    }

    /// The translations of a planar target at which the chain closes within its limits. `None` for chains
    /// of other subspaces, and where limits on angles make the region more than a convex set with a convex
    /// hole.
    #[doc(hidden)]
    pub fn shape(&self, branch: Branch, limits: [&Limits; 3]) -> Option<Shape> {
        match self {
            Self::Planar(chain) => chain.shape(branch, limits),
            Self::Translational(chain) => Some(chain.shape(limits)),
            Self::Rigid
            | Self::Part(_)
            | Self::Spherical(_)
            | Self::Ball(_)
            | Self::Cylindrical(_)
            | Self::Spatial(_) => None,
        }
    }

    /// Whether its joints are those of a spherical joint.
    pub fn is_ball(&self) -> bool {
        match self {
            Self::Ball(_) => true,
            Self::Part(part) => part.ball,
            Self::Rigid
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => false,
        }
    }

    /// Whether a target has two solutions.
    pub fn has_choice(&self) -> bool {
        match self {
            Self::Planar(chain) => chain.has_choice(),
            Self::Spherical(_) => true,
            Self::Part(part) => part.choice,
            Self::Rigid
            | Self::Ball(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => false,
        }
    }

    /// Whether targets that are full revolutions apart differ.
    pub fn counts_turns(&self) -> bool {
        match self {
            Self::Cylindrical(chain) => chain.counts_turns(),
            Self::Rigid
            | Self::Part(_)
            | Self::Planar(_)
            | Self::Spherical(_)
            | Self::Ball(_)
            | Self::Translational(_)
            | Self::Spatial(_) => false,
        }
    }

    /// The number of freedoms. Only so many of the three displacements of a solution are used.
    pub fn freedoms(&self) -> usize {
        match self {
            Self::Rigid => 0,
            Self::Part(part) => part.freedoms,
            Self::Planar(_) | Self::Spherical(_) | Self::Ball(_) | Self::Spatial(_) => 3,
            Self::Cylindrical(_) | Self::Translational(_) => 2,
        }
    }

    /// The joints' displacements that move the outer link by `target`, base first; those past
    /// [`Chain::freedoms`] are zero.
    ///
    /// # Errors
    /// The reach deficit, where the target is out of reach.
    ///
    /// # Panics
    /// If `target` is a displacement of another kind of subspace.
    #[inline(always)]
    pub fn inverse(
        &self,
        target: &Displacement,
        branch: Branch,
    ) -> Result<[JointDisplacement; 3], ReachDeficit> {
        let mut found = [JointDisplacement::Value(0.0); 3];
        self.solve(target, branch, &mut found)?;
        Ok(found)
    }

    /// Writes what [`Chain::inverse`] returns; nothing where the target is out of reach. Copying the displacements would
    /// take as long as finding some of them.
    #[inline(always)]
    pub fn solve(
        &self,
        target: &Displacement,
        branch: Branch,
        out: &mut [JointDisplacement; 3],
    ) -> Result<(), ReachDeficit> {
        let pad = |[a, b]: [JointDisplacement; 2]| [a, b, JointDisplacement::Value(0.0)];
        match self {
            Self::Rigid => *out = [JointDisplacement::Value(0.0); 3],
            // Its leg is what is solved.
            Self::Part(_) => return Err(ReachDeficit::length(f64::INFINITY)),
            Self::Planar(chain) => return chain.solve(target.planar(), branch, out),
            Self::Spherical(chain) => {
                return closed_form::solve(chain, target.spherical(), branch, out);
            }
            Self::Ball(ball) => *out = ball.inverse(target.spherical()),
            Self::Cylindrical(chain) => *out = pad(chain.inverse(target.cylindrical())),
            Self::Translational(chain) => *out = pad(chain.inverse(*target.translational())),
            Self::Spatial(chain) => *out = chain.inverse(target.spatial()),
        }
        Ok(())
    }

    /// The branch on which the chain moves the outer link by `target` with a known displacement of the first joint: cheaper
    /// than to solve for it. `None` where that displacement misses one with which the chain closes by more than `within`
    /// radians, and for chains that are not spherical.
    #[inline(always)]
    pub fn branch_with(
        &self,
        target: &Displacement,
        first: Complex<f64>,
        within: f64,
    ) -> Option<Branch> {
        match self {
            Self::Spherical(chain) => chain.branch_with(target.spherical(), first, within),
            Self::Rigid
            | Self::Part(_)
            | Self::Planar(_)
            | Self::Ball(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => None,
        }
    }

    /// The first joint's displacement alone; cheaper than [`Chain::inverse`] for a spherical chain.
    ///
    /// # Errors
    /// The reach deficit, where the target is out of reach.
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
            Self::Rigid
            | Self::Part(_)
            | Self::Planar(_)
            | Self::Ball(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => {
                self.inverse(target, branch).map(|displacements| displacements[0])
            }
        }
    }
}

/// Properties of a chain with one joint held.
impl Chain {
    /// The targets at which the chain closes with joint number `joint` held at `displacement`. `None` for a
    /// spherical joint, whose rotation vector has no closed form along a path, and for a chain without joints.
    pub fn held(&self, joint: usize, displacement: JointDisplacement) -> Option<Surface> {
        match self {
            Self::Planar(chain) => Some(chain.held(joint, displacement)),
            Self::Spherical(chain) => Some(chain.held(joint, displacement)),
            Self::Rigid | Self::Part(_) | Self::Ball(_) => None,
            Self::Cylindrical(chain) => Some(chain.held(joint, displacement)),
            Self::Translational(chain) => Some(chain.held(joint, displacement)),
            Self::Spatial(chain) => Some(chain.held(joint, displacement)),
        }
    }

    /// The targets at which the two branches meet, or at which the chain stops closing, without those that limits of the
    /// middle joint clearly exclude; each with its number among them.
    pub fn folds(&self, limits: &Limits) -> Vec<(usize, Surface)> {
        let middle = match self {
            Self::Planar(chain) => chain.folds(),
            Self::Spherical(chain) => chain.folds().to_vec(),
            Self::Rigid
            | Self::Part(_)
            | Self::Ball(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => Vec::new(),
        };
        let all = middle.into_iter().enumerate();
        let within = all.filter(|&(_, displacement)| limits.nearly_admits(displacement));
        within.filter_map(|(i, displacement)| Some((i, self.held(1, displacement)?))).collect()
    }

    /// Whether a fold bounds a convex set of the plane outside of which the chain does not close: a row that leaves it there
    /// does not come back. In a ring, the outer circle is such a fold, and the inner one is not.
    pub fn is_convex_fold(&self, fold: usize) -> bool {
        match self {
            Self::Planar(PlanarChain::Rrr(_)) => fold == 0,
            Self::Planar(PlanarChain::Prr(_) | PlanarChain::Rrp(_)) => true,
            Self::Planar(_)
            | Self::Spherical(_)
            | Self::Rigid
            | Self::Part(_)
            | Self::Ball(_)
            | Self::Cylindrical(_)
            | Self::Translational(_)
            | Self::Spatial(_) => false,
        }
    }

    /// The two ends of a joint's limits, as displacements at which the joint can be held.
    pub fn ends(&self, joint: usize, limits: &Limits) -> Option<[JointDisplacement; 2]> {
        if self.is_rotation(joint) { limits.direction_ends() } else { limits.value_ends() }
    }

    /// Whether a joint's displacement is a rotation that does not count revolutions.
    pub fn is_rotation(&self, joint: usize) -> bool {
        match self {
            Self::Planar(chain) => chain.is_rotation(joint),
            Self::Spherical(_) => true,
            Self::Rigid
            | Self::Part(_)
            | Self::Ball(_)
            | Self::Translational(_)
            | Self::Spatial(_) => false,
            Self::Cylindrical(chain) => chain.is_rotation(joint),
        }
    }

    /// An upper bound of the chain's lengths at home, metres.
    pub fn size(&self) -> f64 {
        match self {
            Self::Planar(chain) => chain.size(),
            Self::Cylindrical(chain) => chain.joints().iter().map(|j| j.advance.abs()).sum(),
            Self::Rigid
            | Self::Part(_)
            | Self::Spherical(_)
            | Self::Ball(_)
            | Self::Translational(_)
            | Self::Spatial(_) => 0.0,
        }
    }
}
