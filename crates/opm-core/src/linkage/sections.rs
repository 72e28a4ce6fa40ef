//! Linkages of two sections that share an imaginary joint: each is a loop in closed form.

mod cycle;
mod drive;
mod input;
mod range;
mod section_loop;

pub use input::{SectionInput, SectionSigns};
pub use section_loop::{DeadPoint, DrivenLoop, SectionLoop};

use super::Joints;
use crate::chain::ChainJoint;
use crate::decomposition::{Decomposition, Freedom, LegSplit};
use crate::group::Subspace;
use crate::manipulator::{ImaginaryJoint, Section, chain_joints, coordinate_number};
use crate::mechanism::Mechanism;
use crate::mechanism::joint::JointKind;
use crate::mechanism::leg::Leg;
use crate::task::{IntersectionAxis, Task, TaskError};

/// What a loop of two sections has beside its joints.
#[derive(Clone, Debug)]
pub struct Sections {
    pub decomposition: Decomposition,
    pub imaginary: ImaginaryJoint,
    /// Whether the imaginary joint belongs to the second leg, so that its displacement is `-τ`.
    reversed: bool,
    sections: [LinkageSection; 2],
}

/// A section of the linkage. The first joint of its loop is the imaginary one.
#[derive(Clone, Debug)]
struct LinkageSection {
    closed: SectionLoop,
    /// Indices of the joint coordinates of the loop's other joints; those beyond its joints are zero.
    coordinates: [usize; 3],
}

impl Sections {
    /// Prepares a mechanism with one of its decompositions. `None` if it does not consist of the loops of two sections.
    ///
    /// # Errors
    /// The home value of a task coordinate is given that the mechanism does not have.
    pub fn new(
        mechanism: &Mechanism,
        decomposition: Decomposition,
    ) -> Result<Option<Self>, TaskError> {
        let ([one, two], [split_one, split_two]) = (&*mechanism.legs, &*decomposition.legs) else {
            return Ok(None);
        };
        let task = match Task::new(mechanism, &decomposition) {
            Err(TaskError::Subspace { .. } | TaskError::Screw | TaskError::Height { .. }) => {
                return Ok(None);
            }
            task => task?,
        };
        // The loop of a Schoenflies section would have five joints.
        let Some(axis) = task.intersection.as_ref().filter(|_| task.height.is_none()) else {
            return Ok(None);
        };
        let first = [0, one.coordinates().count()];
        let compile = |section: Section, subspace: &Subspace, part: fn(&LegSplit) -> &[Freedom]| {
            let legs = [(one, first[0], part(split_one)), (two, first[1], part(split_two))];
            LinkageSection::new(section, subspace, imaginary_joint(axis), legs)
        };
        let lower = compile(Section::Lower, &task.lower, |split| &split.lower);
        let upper = compile(Section::Upper, &task.upper, |split| &split.upper);
        let (Some(lower), Some(upper)) = (lower, upper) else { return Ok(None) };
        let owner = decomposition.legs.iter().position(|split| split.imaginary).unwrap_or(0);
        Ok(Some(Self {
            imaginary: ImaginaryJoint::new(&mechanism.legs[owner], owner, &task),
            reversed: owner == 1,
            decomposition,
            sections: [lower, upper],
        }))
    }

    /// Whether one leg is the whole lower section and the other leg the whole upper one.
    pub fn platform_is_imaginary(&self) -> bool {
        let [one, two] = &*self.decomposition.legs else { return false };
        let apart = |one: &LegSplit, two: &LegSplit| one.upper.is_empty() && two.lower.is_empty();
        apart(one, two) || apart(two, one)
    }

    /// The loop driven by the joint coordinate with this number; `None` if it is in neither section.
    pub fn input<'a>(&'a self, joints: &'a Joints, coordinate: usize) -> Option<SectionInput<'a>> {
        self.sections.iter().enumerate().find_map(|(section, of)| {
            let own = &of.coordinates[..of.closed.joints() - 1];
            let loop_index = own.iter().position(|&c| c == coordinate)? + 1;
            Some(SectionInput { linkage: self, joints, coordinate, section, loop_index })
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

/// The index of each freedom's coordinate, and its joint. `None` if one is a ball's, whose freedoms have no axes of their own.
fn loop_joints((leg, first, part): SectionLeg<'_>) -> Option<Vec<(usize, ChainJoint)>> {
    let ball = |freedom: &Freedom| leg.joints[freedom.joint].kind == JointKind::Spherical;
    if part.iter().any(ball) {
        return None;
    }
    let coordinates = part.iter().map(|freedom| first + coordinate_number(leg, *freedom));
    Some(coordinates.zip(chain_joints(leg, part)).collect())
}

impl LinkageSection {
    /// Builds the loop of a section: the imaginary joint, then the joints of both legs in the order of
    /// `L₂⁻¹ L₁` or of `U₂ U₁⁻¹`. `None` if it has not one freedom, or no closed form.
    fn new(
        section: Section,
        subspace: &Subspace,
        imaginary: ChainJoint,
        [one, two]: [SectionLeg<'_>; 2],
    ) -> Option<Self> {
        let (one, two) = (loop_joints(one)?, loop_joints(two)?);
        let back = |joints: Vec<_>| joints.into_iter().rev().map(|(c, joint)| (c, reversed(joint)));
        let others: Vec<(usize, ChainJoint)> = match section {
            Section::Lower => back(two).chain(one).collect(),
            Section::Upper => two.into_iter().chain(back(one)).collect(),
        };
        if others.len() != subspace.dimension() {
            return None;
        }
        let joints: Vec<_> = std::iter::once(imaginary).chain(others.iter().map(|o| o.1)).collect();
        let closed = SectionLoop::new(subspace, &joints).ok()?;
        let mut coordinates = [0; 3];
        for (slot, (coordinate, _)) in coordinates.iter_mut().zip(&others) {
            *slot = *coordinate;
        }
        Some(Self { closed, coordinates })
    }
}
