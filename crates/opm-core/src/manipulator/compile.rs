//! What a manipulator has beside its mechanism and decomposition: all that is computed once.

use super::closure::Closure;
use super::cones::ConeLimit;
use super::judged::judged_at;
use super::leg::{CompileContext, CompiledLeg};
use super::mode::{Mode, ModeLayout};
use super::plan::Plan;
use super::{ChainCoordinate, CompileError, Dependent, ImaginaryJoint, MOST_CHOICES, Manipulator};
use crate::chain::limits::Limits;
use crate::decomposition::mobility::frame;
use crate::decomposition::{Decomposition, decompose};
use crate::mechanism::joint::JointCoordinate;
use crate::mechanism::{JointDifference, Mechanism};
use crate::numeric::four_wide::FourWide;
use crate::task::Task;
use std::sync::OnceLock;

/// The parts of a manipulator that are computed from its mechanism and decomposition.
pub(super) struct Compiled {
    task: Task,
    dependent: Option<Dependent>,
    legs: Vec<CompiledLeg>,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    differences: Vec<JointDifference>,
    actuated: Vec<usize>,
    imaginary: Vec<ImaginaryJoint>,
    modes: ModeLayout,
    length: f64,
}

impl Compiled {
    /// By the first decomposition that has closed forms.
    pub fn first(mechanism: &Mechanism) -> Result<(Self, Decomposition), CompileError> {
        let mut refused = None;
        for decomposition in decompose(mechanism)? {
            match Self::new(mechanism, &decomposition) {
                Ok(compiled) => return Ok((compiled, decomposition)),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        Err(refused.expect("decompose gives at least one decomposition, or an error"))
    }

    pub fn new(mechanism: &Mechanism, decomposition: &Decomposition) -> Result<Self, CompileError> {
        let task = Task::new(mechanism, decomposition)?;
        let coordinates: Vec<_> = mechanism.coordinates().cloned().collect();
        let differences = mechanism.joint_differences()?;
        let length = frame(mechanism).length;
        let limits: Vec<_> = coordinates.iter().map(|c| c.displacement_limits(length)).collect();
        let mut actuated = Vec::new();
        let mut chain_coordinates = Vec::with_capacity(coordinates.len());
        for joint in mechanism.joints() {
            for coordinate in &joint.coordinates {
                let number = chain_coordinates.len();
                chain_coordinates.push(ChainCoordinate {
                    number,
                    actuated: joint.actuated.then_some(actuated.len()),
                    home: coordinate.home,
                    limits: limits[number],
                    cone: joint.cone.is_some(),
                });
                if joint.actuated {
                    actuated.push(number);
                }
            }
        }

        let mut legs = Vec::with_capacity(mechanism.legs.len());
        let mut imaginary = Vec::new();
        let mut first = 0;
        for (number, (leg, split)) in mechanism.legs.iter().zip(&decomposition.legs).enumerate() {
            let context = CompileContext {
                mechanism,
                task: &task,
                decomposition,
                coordinates: &chain_coordinates,
                size: length,
            };
            let mut compiled = CompiledLeg::new(leg, split, first, context)
                .map_err(|reason| CompileError::Leg { leg: leg.name.clone(), reason })?;
            if split.imaginary {
                compiled.imaginary = Some(imaginary.len());
                imaginary.push(ImaginaryJoint::new(leg, number, &task));
            }
            compiled.cones = ConeLimit::of_leg(leg, first);
            first += leg.coordinates().count();
            legs.push(compiled);
        }
        let names: Vec<&str> = mechanism.legs.iter().map(|leg| leg.name.as_str()).collect();
        let mut dependent = match decomposition.constrained {
            Some(by) => Some(Dependent::of_whole(&task, mechanism, by, length)?),
            None => Dependent::new(&task, &legs, &names, decomposition.mobility, length)?,
        };
        Dependent::check_wanted(dependent.as_ref(), &task, mechanism)?;
        let choices: Vec<usize> = dependent.iter().flat_map(Dependent::choosing_legs).collect();
        let modes = ModeLayout::new(&legs, &choices);
        if let Some(dependent) = &mut dependent {
            dependent.set_bits(&task, &modes, &legs);
        }
        if modes.count() > MOST_CHOICES {
            return Err(CompileError::Choices(modes.count()));
        }
        Ok(Self {
            task,
            dependent,
            legs,
            coordinates,
            limits,
            differences,
            actuated,
            imaginary,
            modes,
            length,
        })
    }

    pub fn complete(self, mechanism: Mechanism, decomposition: Decomposition) -> Manipulator {
        let (mut independent, mut dependent_coordinates) = (Vec::new(), Vec::new());
        for (number, coordinate) in self.task.coordinates.iter().enumerate() {
            let follows = self.dependent.as_ref().is_some_and(|d| d.coordinates.contains(&number));
            let list = if follows { &mut dependent_coordinates } else { &mut independent };
            list.push(coordinate.clone());
        }
        let closure = Closure::new(&mechanism);
        let mut manipulator = Manipulator {
            plan: Plan::new(&self.task, &self.legs, closure.size),
            continued: OnceLock::new(),
            judged_at: judged_at(&mechanism, &self.task, &independent),
            closure,
            arch: FourWide::new(),
            mechanism,
            decomposition,
            task: self.task,
            independent,
            dependent_coordinates,
            dependent: self.dependent,
            legs: self.legs,
            coordinates: self.coordinates,
            limits: self.limits,
            differences: self.differences,
            actuated: self.actuated,
            imaginary: self.imaginary,
            modes: self.modes,
            home_mode: Mode::default(),
            home: Vec::new(),
            length: self.length,
        };
        manipulator.home = manipulator.task.home();
        manipulator.home_mode = manipulator.mode_at_home();
        manipulator.complete_home();
        manipulator
    }
}
