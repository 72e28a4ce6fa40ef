//! Position analysis of single-loop linkages that decompose: Bennett's double spherical 6R linkage
//! (Selvi, "Kinematic analysis of overconstrained manipulators with partial subspaces using
//! decomposition method", Robotica, Fig. 1) as an input-output linkage.
//!
//! Two legs form one loop, `L₁U₁ = L₂U₂`. The lower parts rotate about a centre `A` and the upper
//! parts about a centre `B`. Then
//!
//! ```text
//! L₂⁻¹ L₁ = U₂ U₁⁻¹ = exp(I τ)
//! ```
//!
//! lies in both groups of rotations: it is a rotation about the line through the two centres, and
//! this line is the axis of the imaginary joint. With three revolutes in each section, the loop
//! divides into two spherical four-bars that share the imaginary joint,
//! ```text
//! exp(-I τ) · L₂⁻¹ L₁ = 1      exp(-I τ) · U₂ U₁⁻¹ = 1
//! ```
//!
//! The four-bar with the input joint determines `τ`, and `τ` determines the other one. Each of them
//! has a two-valued choice, so an input has up to four positions. Where a product passes a joint
//! from its platform side to its base side, the joint's axis is reversed, so that its rotation is
//! always the reported one.
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
pub mod four_bar;
mod input;
mod range;

pub use cycle::Cycle;
pub use input::{Input, LinkageBranch, Position};
pub use range::InputRange;

use crate::chain::ChainError;
use crate::chain::limits::Limits;
use crate::decomposition::mobility::frame;
use crate::decomposition::{DecomposeError, Decomposition, Freedom, LegSplit, decompose};
use crate::group::SubspaceKind;
use crate::manipulator::{ImaginaryJoint, Section};
use crate::mechanism::Mechanism;
use crate::mechanism::joint::{Joint, JointCoordinate, JointKind};
use crate::mechanism::leg::Leg;
use crate::task::{Task, TaskError};
use four_bar::FourBar;
use nalgebra::{Unit, Vector3};

/// Why a mechanism is not a linkage that this module can solve.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinkageError {
    /// The mechanism cannot be decomposed.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// The mechanism decomposes, but not into two spherical four-bars.
    #[error(
        "the mechanism has {0}, expected a linkage of two legs with three revolute axes through each \
         of two centres (two spherical four-bars that share an imaginary joint)"
    )]
    NotCovered(Obstacle),
    /// Two neighbouring axes of a four-bar (the imaginary joint's included) are parallel.
    #[error("the {section} four-bar has no closed form: {error}")]
    FourBar {
        /// The section of the four-bar.
        section: Section,
        /// The reason.
        error: ChainError,
    },
    /// The home value of a task coordinate is given that the mechanism does not have.
    #[error(transparent)]
    Task(#[from] TaskError),
}

/// What a mechanism has that keeps it from being two spherical four-bars.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Obstacle {
    /// More than one loop; the number of legs.
    #[error("{0} legs")]
    Legs(usize),
    /// Sections that are not spherical.
    #[error("a {lower} and a {upper} section")]
    Subspaces {
        /// The name of the lower section's subspace.
        lower: &'static str,
        /// The name of the upper section's subspace.
        upper: &'static str,
    },
    /// A section whose loop does not have three freedoms besides the imaginary joint.
    #[error("{count} joint freedoms in the {section} section")]
    Freedoms {
        /// The section.
        section: Section,
        /// The number of freedoms of both legs in this section.
        count: usize,
    },
    /// A spherical joint, whose freedoms have no axes of their own; its name.
    #[error("the spherical joint {0}")]
    Ball(String),
}

/// A single-loop linkage, decomposed into two spherical four-bars. It is immutable and can be
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
    sections: [Loop; 2],
}

/// A four-bar of the linkage. Its first joint is the imaginary one.
#[derive(Clone, Debug)]
struct Loop {
    four_bar: FourBar,
    /// Indices of the joint coordinates of the other three joints.
    coordinates: [usize; 3],
}

impl Linkage {
    /// Decomposes a mechanism and prepares the first of its decompositions that can be solved.
    ///
    /// # Errors
    /// [`LinkageError`] if the mechanism cannot be decomposed, or for its preferred decomposition
    /// if none consists of two spherical four-bars.
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
    /// [`LinkageError`] if the decomposition does not consist of two spherical four-bars.
    pub fn with_decomposition(
        mechanism: Mechanism,
        decomposition: Decomposition,
    ) -> Result<Self, LinkageError> {
        let ([one, two], [split_one, split_two]) = (&*mechanism.legs, &*decomposition.legs) else {
            return Err(LinkageError::NotCovered(Obstacle::Legs(mechanism.legs.len())));
        };
        let subspaces = Obstacle::Subspaces {
            lower: decomposition.lower.name(),
            upper: decomposition.upper.name(),
        };
        let task = match Task::new(&mechanism, &decomposition) {
            Err(TaskError::Subspace { .. } | TaskError::Screw) => {
                return Err(LinkageError::NotCovered(subspaces));
            }
            task => task?,
        };
        if [&task.lower, &task.upper].iter().any(|s| s.kind != SubspaceKind::Spherical) {
            return Err(LinkageError::NotCovered(subspaces));
        }

        let Some(axis) = &task.intersection else {
            return Err(LinkageError::NotCovered(subspaces));
        };
        let first = [0, one.coordinates().count()];
        let axes = |(leg, number): (&Leg, usize), part: &[Freedom]| {
            let axis = |freedom: &Freedom| loop_axis(leg, first[number], *freedom);
            part.iter().map(axis).collect::<Result<Vec<_>, _>>()
        };
        let compile = |section: Section, part: fn(&LegSplit) -> &[Freedom]| {
            let one = axes((one, 0), part(split_one))?;
            let two = axes((two, 1), part(split_two))?;
            Loop::new(section, -axis.direction, one, two)
        };
        let sections = [
            compile(Section::Lower, |split| &split.lower)?,
            compile(Section::Upper, |split| &split.upper)?,
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

    /// The linkage driven by the joint coordinate with this name; `None` if there is none.
    pub fn input(&self, name: &str) -> Option<Input<'_>> {
        let coordinate = self.coordinates.iter().position(|c| c.name == name)?;
        self.sections.iter().enumerate().find_map(|(section, four_bar)| {
            let loop_index = four_bar.coordinates.iter().position(|&c| c == coordinate)? + 1;
            Some(Input { linkage: self, coordinate, section, loop_index })
        })
    }
}

/// The index of a freedom's coordinate, and its axis.
type LoopAxis = (usize, Unit<Vector3<f64>>);

/// The axis of a freedom in a leg whose first coordinate has the index `first`.
fn loop_axis(leg: &Leg, first: usize, freedom: Freedom) -> Result<LoopAxis, LinkageError> {
    let joint = &leg.joints[freedom.joint];
    if joint.kind == JointKind::Spherical {
        return Err(LinkageError::NotCovered(Obstacle::Ball(joint.name.clone())));
    }
    let before: usize = leg.joints[..freedom.joint].iter().map(Joint::freedoms).sum();
    let axis = Unit::new_normalize(joint.screws()[freedom.index].angular);
    Ok((first + before + freedom.index, axis))
}

impl Loop {
    /// Builds the loop of a section: the imaginary joint's axis as in `exp(-I τ)`, then the joints
    /// of both legs in the order of `L₂⁻¹ L₁` or of `U₂ U₁⁻¹`.
    fn new(
        section: Section,
        imaginary: Unit<Vector3<f64>>,
        one: Vec<LoopAxis>,
        two: Vec<LoopAxis>,
    ) -> Result<Self, LinkageError> {
        let count = one.len() + two.len();
        let reverse = |axes: Vec<LoopAxis>| axes.into_iter().rev().map(|(c, axis)| (c, -axis));
        let joints: Vec<LoopAxis> = match section {
            Section::Lower => reverse(two).chain(one).collect(),
            Section::Upper => two.into_iter().chain(reverse(one)).collect(),
        };
        let [a, b, c] = *joints else {
            return Err(LinkageError::NotCovered(Obstacle::Freedoms { section, count }));
        };
        let four_bar = FourBar::new([imaginary, a.1, b.1, c.1])
            .map_err(|error| LinkageError::FourBar { section, error })?;
        Ok(Self { four_bar, coordinates: [a.0, b.0, c.0] })
    }
}
