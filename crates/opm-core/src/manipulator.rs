//! A mechanism, decomposed and compiled to closed-form chains.
//!
//! With `g = v · b` the pose, a leg's closure `L(q_low) · U(q_up) = g` is cut in two by its
//! displacement `exp(I τ)` along the intersection motion, the imaginary joint:
//!
//! * a leg whose *upper* section lacks one freedom gets the cut there: `exp(I τ) · U = b` gives τ
//!   and the upper joints, then `L = v · exp(I τ)` the lower ones;
//! * a leg whose *lower* section lacks one gets it there: `L · exp(-I τ) = v`, then
//!   `U = exp(-I τ) · b`.
//!
//! Either way both sections have as many freedoms as their subspace, and each is one
//! [`Chain`](crate::chain::Chain).

mod batch;
mod closure;
mod inverse;
mod leg;
mod locate;
mod mode;
pub(crate) mod plan;
mod reach;
mod read;
mod transitions;

pub use batch::{Batch, BatchError, BatchOutput};
pub use inverse::{ActuatedJoints, AllModes, LARGEST, PoseError, Solution, Unreachable};
pub use leg::{RefusedLeg, Section};
pub use locate::OutsideMotion;
pub use mode::{Mode, ModeError};
pub use plan::NoClosedForm;
pub use reach::LegBranch;
pub use read::ReadError;
pub use transitions::Transitions;

use crate::chain::limits::Limits;
use crate::decomposition::mobility::frame;
use crate::decomposition::{DecomposeError, Decomposition, decompose};
use crate::group::JointDisplacement;
use crate::mechanism::Mechanism;
use crate::mechanism::joint::JointCoordinate;
use crate::mechanism::leg::Leg;
use crate::numeric::Quantity;
use crate::task::{CoordinateKind, Task, TaskCoordinate, TaskError};
use closure::Closure;
use leg::CompileContext;
pub(crate) use leg::{ChainCoordinate, CompiledLeg, CompiledSection, LegBranches, LegSolution};
use mode::ModeLayout;
use plan::Plan;

/// Choices that a [`Mode`] has room for.
const MOST_CHOICES: u32 = 63;

/// An imaginary joint as it is reported.
#[derive(Clone, Debug, PartialEq)]
pub struct ImaginaryJoint {
    /// Name.
    pub name: String,
    /// Number of the leg that it belongs to.
    pub leg: usize,
    /// Angle or length.
    pub quantity: Quantity,
    /// Value at home, radians or metres.
    pub home: f64,
    /// `1` or `-1`: which way along the intersection motion counts as positive.
    pub(crate) sign: f64,
}

/// Why a mechanism cannot be compiled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompileError {
    /// It does not decompose.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// A leg has no closed form.
    #[error("leg {leg}: {reason}")]
    Leg {
        /// The leg's name.
        leg: String,
        /// Why.
        reason: RefusedLeg,
    },
    /// Its pose has no coordinates.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// More two-valued choices than a mode has room for.
    #[error("{0} two-valued choices, at most {MOST_CHOICES} are supported")]
    Choices(u32),
}

/// A mechanism compiled for closed-form inverse kinematics. Immutable; share it between threads.
#[derive(Clone, Debug)]
pub struct Manipulator {
    mechanism: Mechanism,
    decomposition: Decomposition,
    task: Task,
    pub(crate) legs: Vec<CompiledLeg>,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    actuated: Vec<usize>,
    imaginary: Vec<ImaginaryJoint>,
    modes: ModeLayout,
    home_mode: Mode,
    length: f64,
    /// How forward kinematics go about it.
    pub(crate) plan: Result<Plan, NoClosedForm>,
    /// Its legs' products of exponentials.
    pub(crate) closure: Closure,
}

impl Manipulator {
    /// Decomposes a mechanism and compiles the first of its decompositions that closed forms cover.
    ///
    /// # Errors
    /// Where it does not decompose, or what stands in the way of its preferred decomposition.
    pub fn new(mechanism: Mechanism) -> Result<Self, CompileError> {
        let mut refused = None;
        for decomposition in decompose(&mechanism)? {
            match Compiled::new(&mechanism, &decomposition) {
                Ok(compiled) => return Ok(compiled.complete(mechanism, decomposition)),
                Err(error) => refused = refused.or(Some(error)),
            }
        }
        Err(refused.expect("decompose gives at least one decomposition, or an error"))
    }

    /// Compiles a mechanism by one of its decompositions.
    ///
    /// # Errors
    /// A leg that no pair of chains covers, or subspaces without coordinates.
    pub fn with_decomposition(
        mechanism: Mechanism,
        decomposition: Decomposition,
    ) -> Result<Self, CompileError> {
        Ok(Compiled::new(&mechanism, &decomposition)?.complete(mechanism, decomposition))
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// How it was decomposed.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// Its subspaces' frames and the conversions of its pose.
    pub fn task(&self) -> &Task {
        &self.task
    }

    /// The coordinates of its pose, in order.
    pub fn task_coordinates(&self) -> &[TaskCoordinate] {
        &self.task.coordinates
    }

    /// Whether a task coordinate is an angle whose whole turns matter: a helical joint follows it.
    pub fn counts_turns(&self, kind: CoordinateKind) -> bool {
        let section = match kind {
            CoordinateKind::Theta => Section::Lower,
            CoordinateKind::Phi => Section::Upper,
            CoordinateKind::X
            | CoordinateKind::Y
            | CoordinateKind::Z
            | CoordinateKind::W
            | CoordinateKind::Zeta
            | CoordinateKind::Xi
            | CoordinateKind::Psi
            | CoordinateKind::Mu
            | CoordinateKind::Nu => return false,
        };
        self.legs.iter().any(|leg| leg.section(section).chain.counts_turns())
    }

    /// Every joint coordinate, leg by leg: the order of [`Solution::joints`].
    pub fn coordinates(&self) -> &[JointCoordinate] {
        &self.coordinates
    }

    /// The limits of every joint coordinate, in the order of [`Manipulator::coordinates`].
    pub fn limits(&self) -> &[Limits] {
        &self.limits
    }

    /// Numbers of the actuated coordinates, ascending: the order of [`ActuatedJoints::actuated`].
    pub fn actuated(&self) -> &[usize] {
        &self.actuated
    }

    /// Its imaginary joints, leg by leg: the order of [`Solution::imaginary`].
    pub fn imaginary(&self) -> &[ImaginaryJoint] {
        &self.imaginary
    }

    /// Characteristic length, metres: [`Frame::length`](crate::group::subspace::Frame), the root mean square
    /// of the distances of the joint axes at home from the point nearest to all of them, and of their
    /// pitches. The same wherever the mechanism stands; of a mechanism twice the size, twice as long.
    pub fn characteristic_length(&self) -> f64 {
        self.length
    }

    /// Number of two-valued choices; there are `2^choices` working modes.
    pub fn choices(&self) -> u32 {
        self.modes.count()
    }

    /// Every working mode, all-plus first: `2^choices`, in the order of [`AllModes::modes`].
    pub fn modes(&self) -> impl Iterator<Item = Mode> + use<> {
        (0..1u64 << self.choices()).map(Mode)
    }

    /// The working mode that the mechanism is assembled in.
    pub fn home_mode(&self) -> Mode {
        self.home_mode
    }

    /// Reads a working mode: a sign for every choice.
    ///
    /// # Errors
    /// A character that is not a sign, or another number of signs.
    pub fn parse_mode(&self, text: &str) -> Result<Mode, ModeError> {
        self.modes.parse(text)
    }

    /// Writes a working mode: a sign for every choice, a group a leg.
    pub fn format_mode(&self, mode: Mode) -> String {
        self.modes.format(mode)
    }

    /// Every combination of a leg's own choices, as modes that are plus elsewhere.
    pub(crate) fn leg_modes(&self, leg: usize) -> impl Iterator<Item = Mode> + use<> {
        self.modes.leg_modes(leg)
    }

    /// The branches of a leg's chains in a mode.
    pub(crate) fn branches(&self, mode: Mode, leg: usize) -> LegBranches {
        self.modes.branches(mode, leg)
    }

    /// Of each leg's solutions at home, the one that leaves its joints where they are.
    fn mode_at_home(&self) -> Mode {
        let home = self.task.home();
        let (v, b) = (self.task.lower(&home), self.task.upper(&home[self.task.lower_count..]));
        let moved = |number: usize, mode: Mode| -> f64 {
            let branches = self.modes.branches(mode, number);
            match self.legs[number].solve(&self.task, [&v, &b], branches, 0.0) {
                Ok(s) => s.lower.iter().chain(&s.upper).map(|a| a.value().abs()).sum(),
                Err(_) => f64::INFINITY,
            }
        };
        (0..self.legs.len())
            .filter_map(|number| {
                self.modes
                    .leg_modes(number)
                    .min_by(|&a, &b| moved(number, a).total_cmp(&moved(number, b)))
            })
            .fold(Mode::default(), |mode, leg| Mode(mode.0 | leg.0))
    }
}

/// What there is to a manipulator beside its mechanism and decomposition.
struct Compiled {
    task: Task,
    legs: Vec<CompiledLeg>,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    actuated: Vec<usize>,
    imaginary: Vec<ImaginaryJoint>,
    modes: ModeLayout,
    length: f64,
}

impl Compiled {
    fn new(mechanism: &Mechanism, decomposition: &Decomposition) -> Result<Self, CompileError> {
        let task = Task::new(mechanism, decomposition)?;
        let coordinates: Vec<_> = mechanism.coordinates().cloned().collect();
        let length = frame(mechanism).length;
        let limits: Vec<_> = coordinates.iter().map(|c| c.displacement_limits(length)).collect();
        let mut actuated = Vec::new();
        let mut actuated_numbers = Vec::with_capacity(coordinates.len());
        for joint in mechanism.joints() {
            for _ in &joint.coordinates {
                actuated_numbers.push(joint.actuated.then_some(actuated.len()));
                if joint.actuated {
                    actuated.push(actuated_numbers.len() - 1);
                }
            }
        }

        let mut legs = Vec::with_capacity(mechanism.legs.len());
        let mut imaginary = Vec::new();
        let mut first = 0;
        for (number, (leg, split)) in mechanism.legs.iter().zip(&decomposition.legs).enumerate() {
            let context = CompileContext {
                task: &task,
                actuated: &actuated_numbers,
                limits: &limits,
                size: length,
            };
            let mut compiled = CompiledLeg::new(leg, split, first, context)
                .map_err(|reason| CompileError::Leg { leg: leg.name.clone(), reason })?;
            if split.imaginary {
                compiled.imaginary = Some(imaginary.len());
                imaginary.push(ImaginaryJoint::new(leg, number, &task));
            }
            first += leg.coordinates().count();
            legs.push(compiled);
        }
        let modes = ModeLayout::new(&legs);
        if modes.count() > MOST_CHOICES {
            return Err(CompileError::Choices(modes.count()));
        }
        Ok(Self { task, legs, coordinates, limits, actuated, imaginary, modes, length })
    }

    fn complete(self, mechanism: Mechanism, decomposition: Decomposition) -> Manipulator {
        let Self { task, legs, coordinates, limits, actuated, imaginary, modes, length } = self;
        let closure = Closure::new(&mechanism);
        let mut manipulator = Manipulator {
            plan: Plan::new(&task, &legs, closure.size),
            closure,
            mechanism,
            decomposition,
            task,
            legs,
            coordinates,
            limits,
            actuated,
            imaginary,
            modes,
            home_mode: Mode::default(),
            length,
        };
        manipulator.home_mode = manipulator.mode_at_home();
        manipulator
    }
}

impl ImaginaryJoint {
    pub(crate) fn new(leg: &Leg, number: usize, task: &Task) -> Self {
        let quantity =
            if task.intersection_point.is_some() { Quantity::Angle } else { Quantity::Length };
        let (home, sign) = match &leg.imaginary {
            Some(label) => (label.home, label.positive.dot(&task.direction).signum()),
            None => (0.0, 1.0),
        };
        Self { name: leg.imaginary_name(), leg: number, quantity, home, sign }
    }

    /// The displacement along the intersection motion for a value as it is reported.
    pub fn displacement(&self, value: f64) -> f64 {
        self.sign * (value - self.home)
    }

    /// The value to report for a displacement along the intersection motion; of a turn, the one
    /// nearest to `reference`.
    #[inline]
    pub(crate) fn value(&self, tau: JointDisplacement, reference: f64) -> f64 {
        self.home + self.sign * tau.nearest(self.sign * (reference - self.home))
    }
}
