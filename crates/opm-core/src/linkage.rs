//! Position analysis of single loops that decompose: Bennett's double spherical 6R linkage (Selvi,
//! "Kinematic analysis of overconstrained manipulators with partial subspaces using decomposition
//! method", Robotica, Fig. 1) as an input-output linkage.
//!
//! Two legs close one loop, `L₁U₁ = L₂U₂`, where the lower parts turn about a centre `A` and the
//! upper parts about a centre `B`. Then
//!
//! ```text
//! L₂⁻¹ L₁ = U₂ U₁⁻¹ = exp(I τ)
//! ```
//!
//! lies in both groups of rotations: it is a rotation about the line of the two centres, the
//! imaginary joint. With three revolutes in each section the loop falls into two spherical
//! four-bars that share that joint,
//!
//! ```text
//! exp(-I τ) · L₂⁻¹ L₁ = 1      exp(-I τ) · U₂ U₁⁻¹ = 1
//! ```
//!
//! The one that has the input joint gives `τ`, from which the other follows: two two-valued choices,
//! so up to four positions an input. In these products a joint that is passed from its platform to
//! its base side has its axis reversed, so that its rotation is always what the joint reports.
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

/// Why a mechanism is not a linkage that this module covers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LinkageError {
    /// It does not decompose.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// It decomposes otherwise.
    #[error(
        "{0}; a linkage has two legs, with three revolute axes through each of two centres (two \
         spherical four-bars that share an imaginary joint)"
    )]
    NotCovered(Obstacle),
    /// Two neighbouring axes of a four-bar, the imaginary one among them, are parallel.
    #[error("the {section} four-bar has no closed form: {error}")]
    FourBar {
        /// Which.
        section: Section,
        /// Why.
        error: ChainError,
    },
    /// A home value for a coordinate that there is not.
    #[error(transparent)]
    Task(#[from] TaskError),
}

/// What a mechanism has instead.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Obstacle {
    /// More than one loop.
    #[error("{0} legs")]
    Legs(usize),
    /// Sections that are not spherical.
    #[error("a {lower} and a {upper} section")]
    Subspaces {
        /// The lower section's subspace.
        lower: &'static str,
        /// The upper section's subspace.
        upper: &'static str,
    },
    /// A loop of more or less than four.
    #[error("{count} joint freedoms in the {section} section")]
    Freedoms {
        /// Which section.
        section: Section,
        /// Of both legs together.
        count: usize,
    },
    /// A joint whose freedoms have no axes of their own.
    #[error("the spherical joint {0}")]
    Ball(String),
}

/// A single loop, decomposed into two spherical four-bars. Immutable; share it between threads.
#[derive(Clone, Debug)]
pub struct Linkage {
    mechanism: Mechanism,
    decomposition: Decomposition,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    imaginary: ImaginaryJoint,
    /// `τ` is the displacement of the first leg's imaginary joint, or the opposite of the second's.
    reversed: bool,
    sections: [Loop; 2],
}

/// A four-bar of the linkage: its first joint is the imaginary one.
#[derive(Clone, Debug)]
struct Loop {
    four_bar: FourBar,
    /// Numbers of the coordinates of the other three.
    coordinates: [usize; 3],
}

impl Linkage {
    /// Decomposes a mechanism, and compiles the first of its decompositions that is covered.
    ///
    /// # Errors
    /// Where it does not decompose, or what its preferred decomposition has instead of two spherical
    /// four-bars.
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

    /// Compiles a mechanism by one of its decompositions.
    ///
    /// # Errors
    /// What it has instead of two spherical four-bars.
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

        let first = [0, one.coordinates().count()];
        let axes = |(leg, number): (&Leg, usize), part: &[Freedom]| {
            let axis = |freedom: &Freedom| loop_axis(leg, first[number], *freedom);
            part.iter().map(axis).collect::<Result<Vec<_>, _>>()
        };
        let compile = |section: Section, part: fn(&LegSplit) -> &[Freedom]| {
            let one = axes((one, 0), part(split_one))?;
            let two = axes((two, 1), part(split_two))?;
            Loop::new(section, -task.direction, one, two)
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

    /// How it was decomposed.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// Every joint coordinate, leg by leg: the order of [`Position::joints`].
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

    /// The linkage moved by the joint coordinate of this name; `None` where there is none.
    pub fn input(&self, name: &str) -> Option<Input<'_>> {
        let coordinate = self.coordinates.iter().position(|c| c.name == name)?;
        self.sections.iter().enumerate().find_map(|(section, four_bar)| {
            let place = four_bar.coordinates.iter().position(|&c| c == coordinate)? + 1;
            Some(Input { linkage: self, coordinate, section, place })
        })
    }
}

/// A freedom's coordinate number, and its axis.
type LoopAxis = (usize, Unit<Vector3<f64>>);

/// A freedom of a leg whose coordinates start with the number `first`.
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
    /// The imaginary joint's axis as it is in `exp(-I τ)`, then the joints of both legs in the order
    /// of `L₂⁻¹ L₁` or of `U₂ U₁⁻¹`.
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
