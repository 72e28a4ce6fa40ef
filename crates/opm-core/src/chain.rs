//! Closed forms of one chain of joints inside one motion subspace.
//!
//! A chain has exactly as many freedoms as its subspace has dimensions, so a displacement of that
//! subspace fixes its joints up to a sign. Every chain works in its subspace's own frame, on
//! displacements from home (`q = 0` is home, where the displacement is the identity), and finds
//! rotations as vectors that point at the angle: no trigonometry until somebody asks for it.
//!
//! What holds for all of them:
//! * `inverse` followed by `forward` returns the target.
//! * On the rim of reach, within [`RIM`], the two branches meet and both are given.
//! * An angle that the target leaves free is given as zero, its home value.
//! * The general case is straight arithmetic, which a loop over many targets is vectorised with; what is
//!   rare, and what is out of reach, is told apart after it (`ClosedForm`).
//! * A chain whose freedoms are dependent everywhere (a zero-length link between two revolutes, two
//!   parallel sliders) is refused when it is built.

pub(crate) mod condition;
pub mod cylindrical;
pub mod equation;
pub mod limits;
pub mod planar;
pub mod region;
pub mod shape;
pub mod spherical;
pub mod surface;
pub(crate) mod track;
pub mod translational;

use crate::chain::limits::Limits;
use crate::numeric::Quantity;
use crate::numeric::angle;
use crate::task::{Displacement, Subspace, SubspaceKind};
use cylindrical::{CoaxialJoint, CylindricalChain};
use nalgebra::{Complex, Point3, Unit, Vector3};
use planar::{PlanarChain, PlanarJoint};
use shape::Shape;
use spherical::{Ball, SphericalChain};
use std::f64::consts::TAU;
use surface::Surface;
use translational::TranslationalChain;

/// How far beyond its reach a chain still answers, as a share of its size: rounding in a target
/// that lies on the rim is of the order of 1e-15 and must not decide, and a pose on the rim counts
/// as inside.
pub const RIM: f64 = 1e-12;

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

/// A joint's displacement from home, as a chain finds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Amount {
    /// A rotation by the argument of this vector, of any length: an angle modulo a turn. Zero stands
    /// for an angle that is free, and its value is zero.
    Turn(Complex<f64>),
    /// A length, or an angle that counts whole turns.
    Value(f64),
}

impl Amount {
    /// The amount as a number; of a turn, the one in `(-π, π]`.
    #[inline(always)]
    pub fn value(self) -> f64 {
        match self {
            Self::Turn(e) => angle::atan2(e.im, e.re),
            Self::Value(value) => value,
        }
    }

    /// The amount as a number; of a turn, the one nearest to `reference`.
    #[inline]
    pub fn nearest(self, reference: f64) -> f64 {
        match self {
            Self::Turn(_) => {
                let value = self.value();
                let turns = (reference - value) / TAU;
                if turns.abs() <= 0.5 { value } else { value + TAU * turns.round() }
            }
            Self::Value(value) => value,
        }
    }

    /// One after the other.
    #[inline]
    #[must_use]
    pub(crate) fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Self::Value(a), Self::Value(b)) => Self::Value(a + b),
            _ => Self::Turn(self.turn() * other.turn()),
        }
    }

    /// The opposite displacement.
    #[inline(always)]
    #[must_use]
    pub fn inverse(self) -> Self {
        match self {
            Self::Turn(e) => Self::Turn(e.conj()),
            Self::Value(value) => Self::Value(-value),
        }
    }

    /// The rotation as a unit vector, whichever way it is held.
    #[inline(always)]
    pub fn turn(self) -> Complex<f64> {
        match self {
            Self::Turn(e) => {
                let square = e.norm_sqr();
                let length = if square > 0.0 { square.sqrt() } else { 1.0 };
                let [re, im] = if square > 0.0 { [e.re, e.im] } else { [1.0, 0.0] };
                Complex::new(re / length, im / length)
            }
            Self::Value(value) => unit(value),
        }
    }
}

/// How far a target is out of a chain's reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// By how much, radians or metres; positive, not NaN, infinite where no number tells.
    pub excess: f64,
    /// What `excess` measures.
    pub quantity: Quantity,
}

impl Gap {
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

/// `e(angle)`, the unit vector at an angle.
#[inline]
pub(crate) fn unit(angle: f64) -> Complex<f64> {
    let (sin, cos) = angle::sin_cos(angle);
    Complex::new(cos, sin)
}

/// `z` as a direction: one where it is zero against `size`, which leaves the angle free.
#[inline(always)]
fn direction(z: Complex<f64>, size: f64) -> Complex<f64> {
    // `z` is a product of two lengths: each may be as short as RIM.
    let shortest = RIM * RIM * size;
    let long = z.norm_sqr() > shortest * shortest;
    Complex::new(if long { z.re } else { 1.0 }, if long { z.im } else { 0.0 })
}

/// What a closed form makes of a target without asking what kind of target it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    /// The joints' displacements, base first; not to be read unless `holds`.
    pub amounts: [Amount; 3],
    /// The target is in reach, and not one of those that [`ClosedForm::exception`] is for.
    pub holds: bool,
    /// The target is out of reach. Where it neither holds nor is beyond, the exception tells.
    pub beyond: bool,
}

impl Attempt {
    /// Of a closed form to which every target in reach is alike.
    #[inline(always)]
    fn decided(amounts: [Amount; 3], holds: bool) -> Self {
        Self { amounts, holds, beyond: !holds }
    }

    /// Of the same joints from the other end, for the inverse of the target:
    /// `(E₁E₂E₃)⁻¹ = E₃⁻¹E₂⁻¹E₁⁻¹`, the joints backwards, each amount with the other sign.
    #[inline(always)]
    fn backwards(self) -> Self {
        let [a3, a2, a1] = self.amounts;
        Self { amounts: [a1.inverse(), a2.inverse(), a3.inverse()], ..self }
    }
}

/// A chain whose target fixes its joints up to a sign.
pub(crate) trait ClosedForm {
    /// A displacement of its subspace.
    type Target;

    /// The general case: no branch, no call, so that a loop over targets is vectorised. Which of an
    /// amount's two kinds it gives depends on the joint alone.
    fn attempt(&self, target: &Self::Target, branch: Branch) -> Attempt;

    /// What an attempt that does not hold leaves open: by how much the target is out of reach, and the
    /// targets that are unlike the rest. Not asked for where all attempts hold.
    fn exception(&self, target: &Self::Target, branch: Branch) -> Result<[Amount; 3], Gap> {
        Ok(self.attempt(target, branch).amounts)
    }

    /// The joints' displacements that move the outer link by `target`.
    #[inline(always)]
    fn solve(&self, target: &Self::Target, branch: Branch) -> Result<[Amount; 3], Gap> {
        let Attempt { amounts, holds, .. } = self.attempt(target, branch);
        if holds { Ok(amounts) } else { self.exception(target, branch) }
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

    /// Number of freedoms, which is the number of amounts that mean anything.
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
    pub fn inverse(&self, target: &Displacement, branch: Branch) -> Result<[Amount; 3], Gap> {
        let pad = |[a, b]: [Amount; 2]| [a, b, Amount::Value(0.0)];
        match (self, target) {
            (Self::Planar(chain), Displacement::Planar(g)) => chain.inverse(g, branch),
            (Self::Spherical(chain), Displacement::Spherical(r)) => chain.inverse(r, branch),
            (Self::Ball(ball), Displacement::Spherical(r)) => Ok(ball.inverse(r)),
            (Self::Cylindrical(chain), Displacement::Cylindrical(g)) => Ok(pad(chain.inverse(g))),
            (Self::Translational(chain), Displacement::Translational(t)) => {
                Ok(pad(chain.inverse(*t)))
            }
            _ => unreachable!("a chain and a target of two kinds of subspace"),
        }
    }

    /// The first joint's displacement alone, where that is all that is wanted.
    ///
    /// # Errors
    /// Out of reach: by how much.
    #[inline(always)]
    pub fn first(&self, target: &Displacement, branch: Branch) -> Result<Amount, Gap> {
        match (self, target) {
            (Self::Spherical(chain), Displacement::Spherical(r)) => {
                chain.first(&chain.third_axis(r), branch).map(Amount::Turn)
            }
            _ => self.inverse(target, branch).map(|amounts| amounts[0]),
        }
    }
}

/// What is known of a chain with one joint held, for a few amounts of each joint.
impl Chain {
    /// The targets on which the chain closes with joint number `joint` at `amount`; `None` of a ball,
    /// whose rotation vector has no closed form along a path.
    pub(crate) fn held(&self, joint: usize, amount: Amount) -> Option<Surface> {
        match self {
            Self::Planar(chain) => Some(chain.held(joint, amount)),
            Self::Spherical(chain) => Some(chain.held(joint, amount)),
            Self::Ball(_) => None,
            Self::Cylindrical(chain) => Some(chain.held(joint, amount)),
            Self::Translational(chain) => Some(chain.held(joint, amount)),
        }
    }

    /// The targets on which its two branches meet, or on which it stops closing.
    pub(crate) fn folds(&self) -> Vec<Surface> {
        let middle = match self {
            Self::Planar(chain) => chain.folds(),
            Self::Spherical(chain) => chain.folds().to_vec(),
            Self::Ball(_) | Self::Cylindrical(_) | Self::Translational(_) => Vec::new(),
        };
        middle.into_iter().filter_map(|amount| self.held(1, amount)).collect()
    }

    /// The limits of a joint as amounts that it can be held at.
    pub(crate) fn ends(&self, joint: usize, limits: &Limits) -> Option<[Amount; 2]> {
        let turns = match self {
            Self::Planar(chain) => chain.turns(joint),
            Self::Spherical(_) => true,
            Self::Ball(_) | Self::Translational(_) => false,
            Self::Cylindrical(chain) => chain.turns(joint),
        };
        if turns { limits.turns() } else { limits.values() }
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

/// A joint to build a chain from, at home in base coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChainJoint {
    /// Rotation about the line through `point` along `axis`, with `pitch` metres of advance a radian.
    Screw {
        /// Direction.
        axis: Unit<Vector3<f64>>,
        /// A point of the line.
        point: Point3<f64>,
        /// Zero for a revolute joint.
        pitch: f64,
    },
    /// Translation.
    Slide {
        /// Direction.
        axis: Unit<Vector3<f64>>,
    },
    /// A spherical joint.
    Ball,
}

/// The screws of a chain's joints at home in their subspace's own frame, base first: `(ω, vx, vy)` in a
/// plane, `ω` in a sphere, `(ω, v)` on a cylinder's axis, `(vx, vy)` in a translational plane. Those of
/// two numbers get a zero, and two joints a third one that takes what nothing moves along: then three
/// screws are always a square matrix of the right determinant.
///
/// # Errors
/// A joint that the subspace does not hold.
pub(crate) fn screws(
    subspace: &Subspace,
    joints: &[ChainJoint],
) -> Result<[Vector3<f64>; 3], ChainError> {
    let needs = |needed| ChainError::Count { needed, given: joints.len() };
    Ok(match subspace.kind {
        SubspaceKind::Planar => {
            let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
            planar_joints(subspace, joints)?.map(|joint| match joint {
                PlanarJoint::Revolute { at, reversed: false } => Vector3::new(1.0, at.im, -at.re),
                PlanarJoint::Revolute { at, reversed: true } => Vector3::new(-1.0, -at.im, at.re),
                PlanarJoint::Prismatic { along } => Vector3::new(0.0, along.re, along.im),
            })
        }
        SubspaceKind::Spherical => match joints {
            // About the base's directions, as a rotation vector is measured.
            [ChainJoint::Ball] => [0, 1, 2].map(|i| subspace.axes.row(i).transpose()),
            _ => {
                let joints: &[_; 3] = joints.try_into().map_err(|_| needs(3))?;
                spherical_axes(subspace, joints)?.map(Unit::into_inner)
            }
        },
        SubspaceKind::Cylindrical => {
            let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
            let [p, q] = coaxial_joints(subspace, joints)?;
            [
                Vector3::new(p.turn, p.advance, 0.0),
                Vector3::new(q.turn, q.advance, 0.0),
                Vector3::z(),
            ]
        }
        SubspaceKind::TranslationalPlane => {
            let joints: &[_; 2] = joints.try_into().map_err(|_| needs(2))?;
            let [u, v] = slides(subspace, joints)?;
            [Vector3::new(u.re, u.im, 0.0), Vector3::new(v.re, v.im, 0.0), Vector3::z()]
        }
    })
}

fn planar_joints(
    subspace: &Subspace,
    joints: &[ChainJoint; 3],
) -> Result<[PlanarJoint; 3], ChainError> {
    let mut planar = [PlanarJoint::Prismatic { along: Complex::new(1.0, 0.0) }; 3];
    for (planar, joint) in planar.iter_mut().zip(joints) {
        *planar = match joint {
            ChainJoint::Screw { axis, point, pitch: 0.0 } => {
                let at = subspace.point(point);
                let reversed = subspace.direction(axis).z < 0.0;
                PlanarJoint::Revolute { at: Complex::new(at.x, at.y), reversed }
            }
            ChainJoint::Slide { axis } => {
                PlanarJoint::Prismatic { along: in_plane(subspace, axis)? }
            }
            _ => return Err(ChainError::Foreign("planar")),
        };
    }
    Ok(planar)
}

fn spherical_axes(
    subspace: &Subspace,
    joints: &[ChainJoint; 3],
) -> Result<[Unit<Vector3<f64>>; 3], ChainError> {
    let mut axes = [Vector3::z_axis(); 3];
    for (local, joint) in axes.iter_mut().zip(joints) {
        match joint {
            ChainJoint::Screw { axis, pitch: 0.0, .. } => {
                *local = Unit::new_normalize(subspace.direction(axis));
            }
            _ => return Err(ChainError::Foreign("spherical")),
        }
    }
    Ok(axes)
}

fn coaxial_joints(
    subspace: &Subspace,
    joints: &[ChainJoint; 2],
) -> Result<[CoaxialJoint; 2], ChainError> {
    let mut coaxial = [CoaxialJoint { turn: 0.0, advance: 0.0 }; 2];
    for (coaxial, joint) in coaxial.iter_mut().zip(joints) {
        let sign = |axis: &Unit<Vector3<f64>>| subspace.direction(axis).z.signum();
        *coaxial = match joint {
            ChainJoint::Screw { axis, pitch, .. } => {
                CoaxialJoint { turn: sign(axis), advance: sign(axis) * pitch }
            }
            ChainJoint::Slide { axis } => CoaxialJoint { turn: 0.0, advance: sign(axis) },
            ChainJoint::Ball => return Err(ChainError::Foreign("cylindrical")),
        };
    }
    Ok(coaxial)
}

fn slides(subspace: &Subspace, joints: &[ChainJoint; 2]) -> Result<[Complex<f64>; 2], ChainError> {
    match joints {
        [ChainJoint::Slide { axis: a }, ChainJoint::Slide { axis: b }] => {
            Ok([in_plane(subspace, a)?, in_plane(subspace, b)?])
        }
        _ => Err(ChainError::Foreign("translational")),
    }
}

/// A direction of the base, laid into the plane.
fn in_plane(subspace: &Subspace, axis: &Vector3<f64>) -> Result<Complex<f64>, ChainError> {
    let d = subspace.direction(axis);
    let along = Complex::new(d.x, d.y);
    let length = along.norm();
    if length <= DEGENERATE {
        return Err(ChainError::Dependent("a slider square to the plane that it moves in"));
    }
    Ok(along / length)
}
