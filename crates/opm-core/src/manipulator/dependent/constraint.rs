//! What a leg with too few freedoms demands of a pose: a condition on the displacement of one of its sections.

use super::zeros::Function;
use crate::chain::condition::Condition;
use crate::group::{Displacement, JointDisplacement, MotionType};
use crate::manipulator::leg::{CompiledLeg, Section};
use crate::numeric::Quantity;
use crate::task::{Task, TaskCoordinate};

/// A condition on a section of a leg.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constraint {
    pub leg: usize,
    pub section: Section,
    pub condition: Condition,
}

/// The sections in the order in which their dependent coordinates are found: first the one that is taken modulo
/// the intersection motion.
pub(crate) fn order(task: &Task) -> [Section; 2] {
    match task.shared() {
        Some(MotionType::Rotation) | None => [Section::Lower, Section::Upper],
        Some(MotionType::Translation) => [Section::Upper, Section::Lower],
    }
}

/// The constraints of a leg's section.
pub(crate) fn constraints(
    legs: &[CompiledLeg],
    leg: usize,
    section: Section,
) -> impl Iterator<Item = Constraint> + use<> {
    let compiled = legs[leg].section(section);
    let (chain, partial) = (compiled.chain, compiled.partial);
    let locked = partial.into_iter().flat_map(|partial| partial.locked_joints());
    locked.filter_map(move |joint| {
        let condition = Condition::new(&chain, joint, JointDisplacement::Value(0.0))?;
        Some(Constraint { leg, section, condition })
    })
}

/// Whether the displacement τ of a leg's imaginary joint, which the other section tells, matters to this one. It
/// does not where the section is the first to be solved: then it contains the intersection motion itself.
pub(crate) fn follows(task: &Task, leg: &CompiledLeg, section: Section) -> bool {
    leg.bridge().is_some_and(|bridge| bridge != section) && order(task)[0] != section
}

/// What a section's chain has to reach at a pose: the section's displacement, after that of the imaginary joint
/// if it belongs to the other section, where its displacement along the intersection motion is `tau`.
pub(crate) fn target_of(
    task: &Task,
    leg: &CompiledLeg,
    section: Section,
    tau: JointDisplacement,
    pose: &[f64],
) -> Displacement {
    let shifted = follows(task, leg, section);
    match section {
        Section::Lower => {
            let v = task.lower(pose);
            if shifted { task.lower_intersection.after(&v, tau) } else { v }
        }
        Section::Upper => {
            let b = task.upper(&pose[task.lower_count..]);
            // exp(-I τ) · b
            if shifted { task.upper_intersection.before(&b, tau.inverse()) } else { b }
        }
    }
}

impl Constraint {
    /// The unit of the condition's value.
    pub fn unit(&self, size: f64) -> f64 {
        match self.condition {
            Condition::Circle { .. } => size * size,
            Condition::Line { .. } | Condition::CarriedLine { .. } | Condition::Flat { .. } => size,
            Condition::Heading { .. } | Condition::Cone { .. } => 1.0,
        }
    }

    /// Whether two values of a coordinate satisfy the condition, which depends on it by this function.
    pub fn has_choice(&self, function: &Function) -> bool {
        match self.condition {
            Condition::Circle { .. } => true,
            Condition::Line { .. } | Condition::CarriedLine { .. } | Condition::Cone { .. } => {
                function.harmonic
            }
            // The opposite heading is no solution.
            Condition::Heading { .. } | Condition::Flat { .. } => false,
        }
    }

    /// How the condition's value depends on one coordinate.
    pub fn function(&self, task: &Task, coordinate: usize, size: f64) -> Function {
        let TaskCoordinate { home, quantity, .. } = task.coordinates[coordinate];
        // On a cylinder angles are counted, and the condition is linear in them.
        let counted = matches!(self.condition, Condition::Flat { .. });
        match quantity {
            Quantity::Angle if !counted => Function::harmonic(home, self.unit(size)),
            Quantity::Angle => Function::polynomial(home, 1.0, self.unit(size)),
            Quantity::Length => Function::polynomial(home, size, self.unit(size)),
        }
    }

    /// The values of the condition at some places of one coordinate, with the others as in `pose`. `target` gives the
    /// displacement that the condition is on.
    pub fn values(
        &self,
        places: [f64; 3],
        coordinate: usize,
        pose: &mut [f64],
        target: impl Fn(&[f64]) -> Displacement,
    ) -> [f64; 3] {
        let held = pose[coordinate];
        let values = places.map(|place| {
            pose[coordinate] = place;
            self.condition.value(&target(pose))
        });
        pose[coordinate] = held;
        values
    }
}
