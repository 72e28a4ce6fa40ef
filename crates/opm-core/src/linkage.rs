//! Position analysis of single-loop linkages that decompose, as input-output linkages (Selvi,
//! "Kinematic analysis of overconstrained manipulators with partial subspaces using decomposition
//! method", Robotica, on Bennett's double spherical 6R linkage of Fig. 1).
//!
//! Two legs form one loop, `L₁U₁ = L₂U₂`. The lower parts move in one subspace and the upper parts in
//! another one, and the two share a one-parameter group: a rotation or a translation. Then
//!
//! ```text
//! L₂⁻¹ L₁ = U₂ U₁⁻¹ = exp(I τ)
//! ```
//!
//! lies in both groups: it is the displacement of an imaginary joint. The loop divides into the
//! [loops](SectionLoop) of the two sections, which share this joint,
//! ```text
//! exp(-I τ) · L₂⁻¹ L₁ = 1      exp(-I τ) · U₂ U₁⁻¹ = 1
//! ```
//!
//! Each has one joint more than its subspace has dimensions, so it is a four-bar, a slider-crank or
//! another loop with one freedom:
//!
//! * Bennett's linkage consists of two spherical four-bars that share a revolute joint;
//! * Sarrus' linkage consists of two planar slider-cranks that share the slider: the platform moves
//!   along the line in which the two planes meet;
//! * a planar four-bar or slider-crank and a spherical four-bar share a revolute joint along the
//!   plane's normal through the centre;
//! * coaxial joints and a planar loop share a rotation, if the axis is perpendicular to the plane, or a
//!   translation, if it lies in the plane.
//!
//! The loop with the input joint determines `τ`, and `τ` determines the other one. Most loops have a
//! two-valued choice, so an input has up to four positions. Where a product passes a joint from its
//! platform side to its base side, the joint's axis is reversed, so that its displacement is always
//! the reported one.
//!
//! ```
//! use opm_core::linkage::Linkage;
//! use opm_core::mechanism::{examples, file};
//!
//! let text = examples::find("bennett-double-spherical-6r").unwrap().text;
//! let linkage = Linkage::new(&file::read(text)?.mechanism)?;
//! let crank = linkage.input("a1").unwrap();
//! assert!(crank.range().is_full_turn());
//! for position in crank.solve(30_f64.to_radians()) {
//!     println!("{}: {:?}, tau = {}", position.branch, position.joints, position.imaginary);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cycle;
mod drive;
mod input;
mod range;
mod section_loop;

pub use cycle::{Cycle, NoCycle};
pub use input::{Input, LinkageBranch, Position, Rates};
pub use range::InputRange;
pub use section_loop::{DeadPoint, DrivenLoop, SectionLoop};

use crate::chain::limits::Limits;
use crate::chain::{ChainError, ChainJoint};
use crate::decomposition::mobility::frame;
use crate::decomposition::{DecomposeError, Decomposition, Freedom, LegSplit, decompose};
use crate::group::Subspace;
use crate::manipulator::{ImaginaryJoint, Section, chain_joints, coordinate_number};
use crate::mechanism::Mechanism;
use crate::mechanism::joint::{JointCoordinate, JointKind};
use crate::mechanism::leg::Leg;
use crate::task::{IntersectionAxis, Task, TaskError};

/// Why a mechanism is not a linkage that this module can solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkageError {
    /// The mechanism cannot be decomposed.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// The mechanism decomposes, but not into the loops of two sections.
    #[error(
        "the mechanism has {0}, expected a linkage of two legs, each section of which closes a loop with \
         the imaginary joint (two planar or spherical four-bars, slider-cranks, or coaxial joints)"
    )]
    NotCovered(Obstacle),
    /// Some joints of a section's loop (the imaginary joint included) are dependent everywhere.
    #[error("the loop of the {section} section has no closed form: {error}")]
    Loop {
        /// The section.
        section: Section,
        /// The reason.
        error: ChainError,
    },
    /// The home value of a task coordinate is given that the mechanism does not have.
    #[error(transparent)]
    Task(#[from] TaskError),
}

/// What a mechanism has that keeps it from being a linkage of two sections.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Obstacle {
    /// More than one loop; the number of legs.
    #[error("{0} legs")]
    Legs(usize),
    /// One subspace for everything, so that there is no second section; its name.
    #[error("a single section, which is {0}")]
    OneSection(&'static str),
    /// Sections that share no motion.
    #[error("a {lower} and a {upper} section that share no motion")]
    NothingShared {
        /// The name of the lower section's subspace.
        lower: &'static str,
        /// The name of the upper section's subspace.
        upper: &'static str,
    },
    /// Sections without closed-form chains, or that share a helical motion.
    #[error("a {lower} and a {upper} section that share a {shared}")]
    Subspaces {
        /// The name of the lower section's subspace.
        lower: &'static str,
        /// The name of the upper section's subspace.
        upper: &'static str,
        /// The name of the motion that they share.
        shared: &'static str,
    },
    /// A section whose loop does not have one freedom.
    #[error(
        "{count} joint {} in the {section} section, where its subspace has {dimension} dimensions",
        if *count == 1 { "freedom" } else { "freedoms" }
    )]
    Freedoms {
        /// The section.
        section: Section,
        /// The number of freedoms of both legs in this section.
        count: usize,
        /// The number of dimensions of the section's subspace.
        dimension: usize,
    },
    /// A spherical joint, whose freedoms have no axes of their own; its name.
    #[error("the spherical joint {0}")]
    Ball(String),
}

/// A single-loop linkage, decomposed into the loops of two sections. It is immutable and can be
/// shared between threads. See the example in the docs of [`linkage`](crate::linkage).
#[derive(Clone, Debug)]
pub struct Linkage {
    mechanism: Mechanism,
    decomposition: Decomposition,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    imaginary: ImaginaryJoint,
    /// Whether the imaginary joint belongs to the second leg, so that its displacement is `-τ`.
    reversed: bool,
    sections: [LinkageSection; 2],
    /// The mechanism's size, metres.
    size: f64,
}

/// A section of the linkage. The first joint of its loop is the imaginary one.
#[derive(Clone, Debug)]
struct LinkageSection {
    closed: SectionLoop,
    /// Indices of the joint coordinates of the loop's other joints; those beyond its joints are zero.
    coordinates: [usize; 3],
}

impl Linkage {
    /// Decomposes a mechanism and prepares the first of its decompositions that can be solved.
    ///
    /// # Errors
    /// [`LinkageError`] if the mechanism cannot be decomposed, or for its preferred decomposition
    /// if none consists of the loops of two sections.
    pub fn new(mechanism: &Mechanism) -> Result<Self, LinkageError> {
        let mut refused = None;
        for decomposition in decompose(mechanism)? {
            match Self::with_decomposition(mechanism.clone(), decomposition) {
                Ok(linkage) => return Ok(linkage),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        Err(refused.expect("decompose gives at least one decomposition, or an error"))
    }

    /// Prepares a mechanism with one of its decompositions.
    ///
    /// # Errors
    /// [`LinkageError`] if the decomposition does not consist of the loops of two sections.
    pub fn with_decomposition(
        mechanism: Mechanism,
        decomposition: Decomposition,
    ) -> Result<Self, LinkageError> {
        let ([one, two], [split_one, split_two]) = (&*mechanism.legs, &*decomposition.legs) else {
            return Err(LinkageError::NotCovered(Obstacle::Legs(mechanism.legs.len())));
        };
        let (lower, upper) = (decomposition.lower.name(), decomposition.upper.name());
        let subspaces = if decomposition.upper.dimension() == 0 {
            Obstacle::OneSection(lower)
        } else if decomposition.intersection.dimension() == 0 {
            Obstacle::NothingShared { lower, upper }
        } else {
            Obstacle::Subspaces { lower, upper, shared: decomposition.intersection.name() }
        };
        let task = match Task::new(&mechanism, &decomposition) {
            Err(TaskError::Subspace { .. } | TaskError::Screw | TaskError::Height { .. }) => {
                return Err(LinkageError::NotCovered(subspaces));
            }
            task => task?,
        };
        // The loop of a Schoenflies section would have five joints.
        if task.height.is_some() {
            return Err(LinkageError::NotCovered(subspaces));
        }
        let Some(axis) = &task.intersection else {
            return Err(LinkageError::NotCovered(subspaces));
        };
        let first = [0, one.coordinates().count()];
        let compile = |section: Section, subspace: &Subspace, part: fn(&LegSplit) -> &[Freedom]| {
            let legs = [(one, first[0], part(split_one)), (two, first[1], part(split_two))];
            LinkageSection::new(section, subspace, imaginary_joint(axis), legs)
        };
        let sections = [
            compile(Section::Lower, &task.lower, |split| &split.lower)?,
            compile(Section::Upper, &task.upper, |split| &split.upper)?,
        ];
        let owner = decomposition.legs.iter().position(|split| split.imaginary).unwrap_or(0);
        let coordinates: Vec<_> = mechanism.coordinates().cloned().collect();
        let size = frame(&mechanism).length;
        Ok(Self {
            imaginary: ImaginaryJoint::new(&mechanism.legs[owner], owner, &task),
            reversed: owner == 1,
            limits: coordinates.iter().map(|c| c.displacement_limits(size)).collect(),
            coordinates,
            sections,
            size,
            mechanism,
            decomposition,
        })
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// The decomposition of the mechanism.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// Every joint coordinate, leg by leg. [`Position::joints`] has this order.
    pub fn coordinates(&self) -> &[JointCoordinate] {
        &self.coordinates
    }

    /// The limits of every joint coordinate, in the order of [`Linkage::coordinates`].
    pub fn limits(&self) -> &[Limits] {
        &self.limits
    }

    /// The imaginary joint.
    pub fn imaginary(&self) -> &ImaginaryJoint {
        &self.imaginary
    }

    /// Whether one leg is the whole lower section and the other leg the whole upper one. The platform
    /// then moves as the imaginary joint does: along or about the intersection motion (Sarrus' linkage).
    pub fn platform_is_imaginary(&self) -> bool {
        let [one, two] = &*self.decomposition.legs else { return false };
        let apart = |one: &LegSplit, two: &LegSplit| one.upper.is_empty() && two.lower.is_empty();
        apart(one, two) || apart(two, one)
    }

    /// The linkage driven by the joint coordinate with this name; `None` if there is none.
    pub fn input(&self, name: &str) -> Option<Input<'_>> {
        let coordinate = self.coordinates.iter().position(|c| c.name == name)?;
        self.sections.iter().enumerate().find_map(|(section, of)| {
            let own = &of.coordinates[..of.closed.joints() - 1];
            let loop_index = own.iter().position(|&c| c == coordinate)? + 1;
            Some(Input { linkage: self, coordinate, section, loop_index })
        })
    }
}

/// The imaginary joint of a section's loop, with the displacement `exp(-I τ)`.
fn imaginary_joint(axis: &IntersectionAxis) -> ChainJoint {
    match axis.point {
        Some(point) => ChainJoint::Screw { axis: -axis.direction, point, pitch: 0.0 },
        None => ChainJoint::Slide { axis: -axis.direction },
    }
}

/// The same joint, passed from its platform side to its base side.
fn reversed(joint: ChainJoint) -> ChainJoint {
    match joint {
        ChainJoint::Screw { axis, point, pitch } => ChainJoint::Screw { axis: -axis, point, pitch },
        ChainJoint::Slide { axis } => ChainJoint::Slide { axis: -axis },
        ChainJoint::Ball => ChainJoint::Ball,
    }
}

/// A leg, the index of its first coordinate, and its freedoms in one section.
type SectionLeg<'a> = (&'a Leg, usize, &'a [Freedom]);

/// The index of each freedom's coordinate, and its joint.
fn loop_joints((leg, first, part): SectionLeg<'_>) -> Result<Vec<(usize, ChainJoint)>, Obstacle> {
    let ball = |freedom: &&Freedom| leg.joints[freedom.joint].kind == JointKind::Spherical;
    if let Some(freedom) = part.iter().find(ball) {
        return Err(Obstacle::Ball(leg.joints[freedom.joint].name.clone()));
    }
    let coordinates = part.iter().map(|freedom| first + coordinate_number(leg, *freedom));
    Ok(coordinates.zip(chain_joints(leg, part)).collect())
}

impl LinkageSection {
    /// Builds the loop of a section: the imaginary joint, then the joints of both legs in the order of
    /// `L₂⁻¹ L₁` or of `U₂ U₁⁻¹`.
    fn new(
        section: Section,
        subspace: &Subspace,
        imaginary: ChainJoint,
        [one, two]: [SectionLeg<'_>; 2],
    ) -> Result<Self, LinkageError> {
        let [one, two] = [loop_joints(one), loop_joints(two)];
        let (one, two) =
            (one.map_err(LinkageError::NotCovered)?, two.map_err(LinkageError::NotCovered)?);
        let back = |joints: Vec<_>| joints.into_iter().rev().map(|(c, joint)| (c, reversed(joint)));
        let others: Vec<(usize, ChainJoint)> = match section {
            Section::Lower => back(two).chain(one).collect(),
            Section::Upper => two.into_iter().chain(back(one)).collect(),
        };
        let (count, dimension) = (others.len(), subspace.dimension());
        if count != dimension {
            let obstacle = Obstacle::Freedoms { section, count, dimension };
            return Err(LinkageError::NotCovered(obstacle));
        }
        let joints: Vec<_> = std::iter::once(imaginary).chain(others.iter().map(|o| o.1)).collect();
        let closed = SectionLoop::new(subspace, &joints)
            .map_err(|error| LinkageError::Loop { section, error })?;
        let mut coordinates = [0; 3];
        for (slot, (coordinate, _)) in coordinates.iter_mut().zip(&others) {
            *slot = *coordinate;
        }
        Ok(Self { closed, coordinates })
    }
}
