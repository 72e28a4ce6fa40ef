//! The steps of the solution as plain data.

use super::constraint::{Constraint, follows};
use super::one_joint::SectionMotion;
use super::{Closed, Dependent};
use crate::chain::condition::Condition;
use crate::manipulator::leg::{CompiledLeg, Section};
use crate::task::Task;

/// How coordinates follow from the others, because a leg constrains them.
#[derive(Clone, Debug)]
pub struct StepForm {
    /// The number of the leg.
    pub leg: usize,
    /// The section of it that constrains the platform.
    pub section: Section,
    /// The numbers of the coordinates that follow, among all task coordinates.
    pub coordinates: Vec<usize>,
    /// The bit of its choice in a mode, if it has two solutions.
    pub bit: Option<u32>,
    /// How they follow.
    pub kind: StepKind,
}

/// How coordinates of one section follow.
#[derive(Clone, Debug)]
pub enum StepKind {
    /// They keep their values at home.
    Constant,
    /// One coordinate follows from a condition on the section's displacement.
    Condition {
        /// The condition.
        condition: Condition,
        /// Whether it is a harmonic function of the coordinate; otherwise it is a polynomial of degree two at most.
        harmonic: bool,
        /// The step between the values that determine a polynomial: radians or metres.
        step: f64,
        /// The unit of its values.
        unit: f64,
    },
    /// They follow from the one joint of the section that moves.
    Joint {
        /// What it does.
        motion: SectionMotion,
        /// The numbers of the section's coordinates but that of a height.
        all: Vec<usize>,
    },
}

/// A constraint that is only checked.
#[derive(Clone, Copy, Debug)]
pub struct CheckForm {
    /// The number of the leg.
    pub leg: usize,
    /// The section of it that constrains the platform.
    pub section: Section,
    /// Whether the displacement of the leg's imaginary joint matters, which the other section tells.
    pub follows: bool,
    /// The condition on the section's displacement.
    pub condition: Condition,
}

impl Dependent {
    /// The steps.
    pub(in crate::manipulator) fn step_forms(&self) -> Vec<StepForm> {
        let form = |step: &super::Step| StepForm {
            leg: step.solution.leg(),
            section: step.solution.section(),
            coordinates: step.solution.coordinates(),
            bit: step.bit,
            kind: Self::kind(&step.solution),
        };
        self.steps.iter().map(form).collect()
    }

    fn kind(solution: &Closed) -> StepKind {
        match solution {
            Closed::Constant { .. } => StepKind::Constant,
            Closed::Condition { constraint, function, .. } => StepKind::Condition {
                condition: constraint.condition,
                harmonic: function.harmonic,
                step: function.step,
                unit: function.unit,
            },
            Closed::Joint(joint) => {
                StepKind::Joint { motion: joint.motion, all: joint.all.clone() }
            }
        }
    }

    /// The constraints that are only checked.
    pub(in crate::manipulator) fn check_forms(
        &self,
        task: &Task,
        legs: &[CompiledLeg],
    ) -> Vec<CheckForm> {
        let form = |&Constraint { leg, section, condition }: &Constraint| {
            let follows = follows(task, &legs[leg], section);
            CheckForm { leg, section, follows, condition }
        };
        self.checks.iter().map(form).collect()
    }

    /// The bits of a mode on which the dependent coordinates depend.
    pub(in crate::manipulator) fn bits(&self) -> &[u32] {
        &self.bits
    }
}
