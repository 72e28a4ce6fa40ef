//! A mechanism, decomposed and compiled to closed-form chains.
//!
//! The pose is `g = v · b`. A leg's closure `L(q_low) · U(q_up) = g` is split in two by the leg's
//! displacement `exp(I τ)` along the intersection motion, that of its imaginary joint:
//!
//! * A leg whose *upper* section lacks one freedom is split there: `exp(I τ) · U = b` gives τ and the upper
//!   joints, then `L = v · exp(I τ)` gives the lower ones.
//! * A leg whose *lower* section lacks one freedom is split there: `L · exp(-I τ) = v`, then
//!   `U = exp(-I τ) · b`.
//!
//! In both cases the two sections have as many freedoms as their subspace, and each is one
//! [`Chain`](crate::chain::Chain).
//!
//! A [`Manipulator`] solves poses, one ([`Manipulator::inverse`]) or many ([`Manipulator::inverse_many`]). What sweeps ask
//! without the values of joints is in [`reach`](crate::reach), rates are in [`velocity`](crate::velocity), and the closed
//! forms as data, for programs that write code, in [`form`].

mod all_modes;
mod angles;
pub(crate) mod batch;
mod closure;
mod compile;
mod cones;
mod continued;
pub(crate) mod dependent;
mod differences;
pub mod form;
mod inverse;
mod judged;
mod leg;
mod lift;
mod locate;
mod mode;
mod place;
pub(crate) mod plan;
mod pose;
#[cfg(feature = "files")]
mod read;
mod refused;
mod section;
mod solution;
mod whole;

pub use all_modes::AllModes;
pub use batch::{Batch, BatchError, BatchOutput};
pub(crate) use continued::{Continued, FoundDisplacements};
pub use dependent::ConstraintError;
pub(crate) use dependent::Dependent;
pub use leg::Section;
pub(crate) use lift::Lean;
pub use locate::OutsideMotion;
pub use mode::{Mode, ModeError};
pub use place::{PLACE, place};
pub use plan::NoClosedForm;
pub use pose::{FollowingCoordinate, LARGEST, PoseError};
#[cfg(feature = "files")]
pub use read::ReadError;
pub use refused::RefusedLeg;
pub(crate) use section::{ChainCoordinate, CompiledSection, chain_joints, coordinate_number};
pub use solution::{ActuatedJoints, Solution, Unreachable, part_of};

use crate::chain::limits::Limits;
use crate::decomposition::{DecomposeError, Decomposition, rerooted};
use crate::group::{JointDisplacement, MotionType, SubspaceKind};
use crate::mechanism::joint::JointCoordinate;
use crate::mechanism::leg::Leg;
use crate::mechanism::{DifferenceError, JointDifference, Mechanism};
use crate::numeric::Quantity;
use crate::numeric::four_wide::FourWide;
use crate::task::{CoordinateKind, Task, TaskCoordinate, TaskError};
use closure::Closure;
pub(crate) use closure::ClosureBuffer;
use compile::Compiled;
pub(crate) use leg::{CompiledLeg, LegBranches, LegSolution};
pub(crate) use mode::Choices;
use mode::ModeLayout;
use nalgebra::{Isometry3, Vector3};
use plan::Plan;
pub(crate) use solution::SolvedPose;
use std::ops::Range;
use std::sync::{Arc, OnceLock};
pub(crate) use whole::WholeJoint;

/// The largest number of choices in a [`Mode`].
const MOST_CHOICES: u32 = 63;

/// An imaginary joint: the displacement of a leg along the intersection motion, with a name, a value at home
/// and a sense.
#[derive(Clone, Debug, PartialEq)]
pub struct ImaginaryJoint {
    /// The joint's name.
    pub name: String,
    /// The number of the leg that it belongs to.
    pub leg: usize,
    /// Whether its value is an angle or a length.
    pub quantity: Quantity,
    /// The value at home, radians or metres.
    pub home: f64,
    /// `1` where the value grows along the intersection motion, `-1` where it grows in the opposite sense.
    pub(crate) sign: f64,
}

/// Why a mechanism cannot be compiled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompileError {
    /// The mechanism does not decompose.
    #[error(transparent)]
    Decompose(#[from] DecomposeError),
    /// A leg has no closed form.
    #[error("leg {leg}: {reason}")]
    Leg {
        /// The leg's name.
        leg: String,
        /// Why the leg has no closed form.
        reason: RefusedLeg,
    },
    /// The pose has no task coordinates.
    #[error(transparent)]
    Task(#[from] TaskError),
    /// Some of the coordinates depend on the others in a way that has no closed form.
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    /// Two joints have no difference, or it excludes home.
    #[error(transparent)]
    Difference(#[from] DifferenceError),
    /// There are more two-valued choices than a [`Mode`] can hold.
    #[error("the legs have {0} two-valued choices, expected at most {MOST_CHOICES}")]
    Choices(u32),
}

/// A mechanism compiled for closed-form inverse kinematics. Immutable; share it between threads.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let names: Vec<&str> = manipulator.task_coordinates().iter().map(|c| c.name).collect();
/// assert_eq!(names, ["x", "y", "zeta", "xi", "psi"]);
/// // Seven two-valued choices: 128 working modes.
/// assert_eq!(manipulator.modes().count(), 128);
///
/// // A text, or any `Mechanism`, is compiled in the same way.
/// let text = opm_core::mechanism::examples::find("planar-3rrr").expect("it is shipped").text;
/// assert!(Manipulator::read(text)?.imaginary().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Manipulator {
    mechanism: Mechanism,
    decomposition: Decomposition,
    task: Task,
    /// The task coordinates that a pose consists of.
    independent: Vec<TaskCoordinate>,
    /// The task coordinates that follow from them.
    dependent_coordinates: Vec<TaskCoordinate>,
    /// How they follow; `None` where all coordinates are independent.
    pub(crate) dependent: Option<Dependent>,
    pub(crate) legs: Vec<CompiledLeg>,
    coordinates: Vec<JointCoordinate>,
    limits: Vec<Limits>,
    differences: Vec<JointDifference>,
    actuated: Vec<usize>,
    imaginary: Vec<ImaginaryJoint>,
    modes: ModeLayout,
    home_mode: Mode,
    /// All task coordinates at home, dependent ones too.
    home: Vec<f64>,
    length: f64,
    /// The point whose velocity stands for the platform's twist in condition numbers, from the reference point.
    pub(crate) judged_at: Option<Vector3<f64>>,
    /// The order in which forward kinematics solve the sections, or why they have no closed form.
    pub(crate) plan: Result<Plan, NoClosedForm>,
    /// What finds all assemblies where there is no such order, once that is needed.
    pub(crate) continued: OnceLock<Option<Arc<Continued>>>,
    /// The legs' products of exponentials.
    pub(crate) closure: Closure,
    /// The instructions of the processor at hand, for one pose.
    pub(crate) arch: FourWide,
}

impl Manipulator {
    /// Decomposes a mechanism and compiles the first of its decompositions that closed forms cover. Where there is none and
    /// the mechanism is a loop of two legs, another link of it is taken as the platform: see [`rerooted`].
    ///
    /// # Errors
    /// The mechanism does not decompose, or none of its decompositions has closed forms; then the error is
    /// that of the first one.
    pub fn new(mechanism: Mechanism) -> Result<Self, CompileError> {
        match Compiled::first(&mechanism) {
            Ok((compiled, decomposition)) => Ok(compiled.complete(mechanism, decomposition)),
            Err(error) => {
                let found = rerooted(&mechanism).into_iter().find_map(|other| {
                    let (compiled, decomposition) = Compiled::first(&other).ok()?;
                    Some(compiled.complete(other, decomposition))
                });
                found.ok_or(error)
            }
        }
    }

    /// Compiles a mechanism by one of its decompositions.
    ///
    /// # Errors
    /// A leg has no closed form, or the pose has no task coordinates.
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

    /// The decomposition by which the mechanism was compiled.
    pub fn decomposition(&self) -> &Decomposition {
        &self.decomposition
    }

    /// The frames of the two subspaces, and the task coordinates.
    #[inline]
    pub fn task(&self) -> &Task {
        &self.task
    }

    /// The task coordinates that a pose consists of, in its order: as many as the mechanism has degrees of
    /// freedom.
    pub fn task_coordinates(&self) -> &[TaskCoordinate] {
        &self.independent
    }

    /// The task coordinates that follow from those of the pose, because a leg with few freedoms ties them
    /// together ([`Solution::dependent`] has their values); none in most mechanisms.
    pub fn dependent_coordinates(&self) -> &[TaskCoordinate] {
        &self.dependent_coordinates
    }

    /// The number among all task coordinates of one of those that a pose consists of.
    #[inline]
    fn number_among_all(&self, coordinate: usize) -> usize {
        self.dependent.as_ref().map_or(coordinate, |dependent| dependent.independent[coordinate])
    }

    /// How many of the coordinates of a pose are the lower section's; they come first.
    pub fn lower_coordinates(&self) -> usize {
        let lower = self.task.lower_count;
        match &self.dependent {
            None => lower,
            Some(dependent) => dependent.independent.iter().filter(|&&i| i < lower).count(),
        }
    }

    /// Whether a task coordinate says where the platform is, its *place*: those of the lower section do. Where
    /// all legs move in one subspace, the lengths do.
    pub fn is_of_place(&self, coordinate: &TaskCoordinate) -> bool {
        match self.task.upper.kind {
            SubspaceKind::Identity => coordinate.quantity == Quantity::Length,
            _ => self.task.coordinates[..self.task.lower_count]
                .iter()
                .any(|c| c.name == coordinate.name),
        }
    }

    /// The numbers of the coordinates of a pose that are its place. They stand next to each other.
    pub fn place_coordinates(&self) -> Range<usize> {
        let before = self.independent.iter().take_while(|c| !self.is_of_place(c)).count();
        let places = self.independent.iter().filter(|c| self.is_of_place(c)).count();
        before..before + places
    }

    /// The numbers of the other coordinates of a pose, its *orientation*: those of the upper section or, where
    /// all legs move in one subspace, the angles.
    pub fn orientation_coordinates(&self) -> Range<usize> {
        let Range { start, end } = self.place_coordinates();
        if start > 0 { 0..start } else { end..self.independent.len() }
    }

    /// The numbers of the legs, and of their sections, whose constraints tie task coordinates together.
    /// A leg that is solved whole constrains as a whole, without a section.
    pub fn constraining_legs(&self) -> impl Iterator<Item = (usize, Option<Section>)> + '_ {
        self.dependent.iter().flat_map(|d| d.constraining().chain(d.checked()))
    }

    /// Whether the full revolutions of a task coordinate matter: it is an angle that a helical joint turns with.
    pub fn counts_turns(&self, kind: CoordinateKind) -> bool {
        let section = match kind {
            CoordinateKind::Theta => Section::Lower,
            CoordinateKind::Phi => Section::Upper,
            CoordinateKind::X
            | CoordinateKind::Y
            | CoordinateKind::Z
            | CoordinateKind::H
            | CoordinateKind::W
            | CoordinateKind::Zeta
            | CoordinateKind::Xi
            | CoordinateKind::Psi
            | CoordinateKind::Azimuth
            | CoordinateKind::Tilt
            | CoordinateKind::Torsion
            | CoordinateKind::Roll
            | CoordinateKind::Pitch
            | CoordinateKind::Yaw
            | CoordinateKind::Mu
            | CoordinateKind::Nu => return false,
        };
        self.legs.iter().any(|leg| leg.section(section).chain.counts_turns())
    }

    /// Whether every leg is solved by itself, whole, and not by sections that all legs share.
    pub fn is_whole(&self) -> bool {
        self.decomposition.is_whole()
    }

    /// The number of legs.
    pub fn legs(&self) -> usize {
        self.legs.len()
    }

    /// Whether the two sections together decide the reachability of every pose: no leg that is split in its
    /// lower section has upper joints that are limited, actuated, or may be out of reach, and no imaginary joint has a part
    /// in a height.
    pub fn workspace_factorises(&self) -> bool {
        let free = |leg: &CompiledLeg| !leg.upper_constrains;
        !self.task.shares_height()
            && self.legs.iter().all(|leg| leg.split_section == Section::Upper || free(leg))
    }

    /// Every joint coordinate, leg by leg. This is the order of [`Solution::joints`].
    pub fn coordinates(&self) -> &[JointCoordinate] {
        &self.coordinates
    }

    /// The joint coordinates of each leg among all of them.
    pub(crate) fn coordinates_of_legs(&self) -> Vec<Range<usize>> {
        let of_leg = |leg: &Leg| leg.joints.iter().map(|joint| joint.coordinates.len()).sum();
        let counts = self.mechanism.legs.iter().map(of_leg);
        counts
            .scan(0, |next, count: usize| {
                let first = *next;
                *next += count;
                Some(first..*next)
            })
            .collect()
    }

    /// The limits of every joint coordinate, in the order of [`Manipulator::coordinates`].
    pub fn limits(&self) -> &[Limits] {
        &self.limits
    }

    /// The numbers of the actuated joint coordinates, ascending. This is the order of [`ActuatedJoints::actuated`].
    pub fn actuated(&self) -> &[usize] {
        &self.actuated
    }

    /// The imaginary joints, leg by leg. This is the order of [`Solution::imaginary`].
    pub fn imaginary(&self) -> &[ImaginaryJoint] {
        &self.imaginary
    }

    /// The characteristic length, metres: [`Frame::length`](crate::group::subspace::Frame), the root mean
    /// square of the distances of the joint axes at home from the point nearest to all of them, and of their
    /// pitches. It does not depend on where the mechanism stands, and is proportional to its size.
    pub fn characteristic_length(&self) -> f64 {
        self.length
    }

    /// The number of two-valued choices; there are `2^choices` working modes.
    pub fn choices(&self) -> u32 {
        self.modes.count()
    }

    /// Every working mode, starting with all plus; there are `2^choices`, in the order of [`AllModes::modes`].
    pub fn modes(&self) -> impl Iterator<Item = Mode> + use<> {
        (0..1u64 << self.choices()).map(Mode)
    }

    /// The working mode that the mechanism is assembled in.
    pub fn home_mode(&self) -> Mode {
        self.home_mode
    }

    /// Parses a working mode: one sign (`+` or `-`) for every choice. Spaces are ignored.
    ///
    /// # Errors
    /// The text has a character that is not a sign, or a wrong number of signs.
    pub fn parse_mode(&self, text: &str) -> Result<Mode, ModeError> {
        self.modes.parse(text)
    }

    /// Formats a working mode: one sign for every choice, in one group for each leg.
    pub fn format_mode(&self, mode: Mode) -> String {
        self.modes.format(mode)
    }

    /// The modes with every combination of the choices that the dependent coordinates are computed with, and plus for
    /// all others: a single mode where no coordinate is dependent.
    pub fn pose_modes(&self) -> impl Iterator<Item = Mode> + '_ {
        let combinations = self.dependent.as_ref().map_or(1, Dependent::combinations);
        (0..combinations).map(|combination| match &self.dependent {
            Some(dependent) => dependent.mode(combination),
            None => Mode::default(),
        })
    }

    /// The modes with every combination of the choices of one leg's sections, and plus for all others. At a pose with
    /// all its coordinates, the joints of a leg depend on these choices alone.
    pub fn leg_modes(&self, leg: usize) -> impl Iterator<Item = Mode> + use<> {
        self.modes.leg_modes(leg)
    }

    /// Those of [`Manipulator::leg_modes`] in which the leg's choices are as they are given.
    pub(crate) fn chosen_leg_modes(
        &self,
        choices: Choices,
        leg: usize,
    ) -> impl Iterator<Item = Mode> + use<> {
        self.modes.chosen_leg_modes(choices, leg).map(|(_, mode)| mode)
    }

    /// The mode with these branches of one leg's chains, and plus for all other legs.
    pub(crate) fn leg_mode(&self, leg: usize, branches: LegBranches) -> Mode {
        self.modes.leg_mode(leg, branches)
    }

    /// The branches of a leg's chains in a mode.
    #[inline]
    pub(crate) fn branches(&self, mode: Mode, leg: usize) -> LegBranches {
        self.modes.branches(mode, leg)
    }

    /// The mode in which every leg's solution at home leaves its joints at home, and the dependent coordinates
    /// follow as they are at home.
    fn mode_at_home(&self) -> Mode {
        let home = self.task.home();
        let (v, b) = self.task.sections(&home);
        let moved = |number: usize, mode: Mode| -> f64 {
            let branches = self.modes.branches(mode, number);
            match self.legs[number].solve_seldom(&self.task, [&v, &b], 0.0, branches, 0.0) {
                Ok(s) => {
                    let joints = s.lower.iter().chain(&s.upper).chain([&s.tau]);
                    joints.map(|a| a.value().abs()).sum()
                }
                Err(_) => f64::INFINITY,
            }
        };
        let of_legs = (0..self.legs.len())
            .filter_map(|number| {
                self.modes
                    .leg_modes(number)
                    .min_by(|&a, &b| moved(number, a).total_cmp(&moved(number, b)))
            })
            .fold(Mode::default(), |mode, leg| Mode(mode.0 | leg.0));
        let Some(dependent) = &self.dependent else { return of_legs };
        let displaced = |mode: Mode| {
            let mut pose = home.clone();
            match dependent.complete(self, mode, &mut pose) {
                Ok(()) => self.apart(&self.task.displacement(&pose), &Isometry3::identity()),
                Err(_) => f64::INFINITY,
            }
        };
        let modes = dependent.step_modes().map(|steps| of_legs.with(steps));
        modes.min_by(|&a, &b| displaced(a).total_cmp(&displaced(b))).unwrap_or(of_legs)
    }

    /// Takes the values at home of the dependent coordinates that follow there. Where the angles of an orientation are
    /// singular at home, the one about the third direction makes up for the last rotation.
    fn complete_home(&mut self) {
        let Some(dependent) = &self.dependent else { return };
        let (coordinates, independent) = (&dependent.coordinates, &dependent.independent);
        let Ok(mut all) = self.completed(&self.home_pose(), self.home_mode) else { return };
        let kind = |i: usize| self.task.coordinates[i].kind();
        let about_third = |&&i: &&usize| {
            matches!(kind(i), CoordinateKind::Zeta | CoordinateKind::Azimuth | CoordinateKind::Yaw)
        };
        if let Some(&found) = independent.iter().find(about_third) {
            let first = if kind(found) == CoordinateKind::Yaw { found - 2 } else { found };
            let angles: [usize; 3] = [first, first + 1, first + 2];
            let (v, b) = self.task.sections(&all);
            let displacement = if first < self.task.lower_count { v } else { b };
            let r = displacement.spherical();
            let mut factors = self.task.angles.to_factors(angles.map(|i| all[i]));
            factors[0] -= r[(1, 0)].atan2(r[(0, 0)]);
            let moved = self.task.angles.of_factors(factors);
            angles.into_iter().zip(moved).for_each(|(i, angle)| all[i] = angle);
        }
        for (coordinate, &i) in self.dependent_coordinates.iter_mut().zip(coordinates) {
            coordinate.home = all[i];
        }
        for (coordinate, &i) in self.independent.iter_mut().zip(independent) {
            coordinate.home = all[i];
        }
        self.home = all;
    }

    /// How far two displacements of the platform are apart, in radians or shares of the size.
    pub(crate) fn apart(&self, one: &Isometry3<f64>, other: &Isometry3<f64>) -> f64 {
        let reference = self.mechanism.platform;
        let offset = (one * reference - other * reference).norm() / self.length;
        offset.max(one.rotation.angle_to(&other.rotation))
    }
}

impl ImaginaryJoint {
    pub(crate) fn new(leg: &Leg, number: usize, task: &Task) -> Self {
        let quantity = match task.shared() {
            Some(MotionType::Rotation) => Quantity::Angle,
            Some(MotionType::Translation) | None => Quantity::Length,
        };
        let (home, sign) = match (&leg.imaginary, &task.intersection) {
            (Some(label), Some(axis)) => (label.home, label.positive.dot(&axis.direction).signum()),
            (None, _) | (_, None) => (0.0, 1.0),
        };
        Self { name: leg.imaginary_name(), leg: number, quantity, home, sign }
    }

    /// The displacement along the intersection motion for a value as it is reported.
    pub fn displacement(&self, value: f64) -> f64 {
        self.sign * (value - self.home)
    }

    /// The value to report for a displacement along the intersection motion; of a rotation, the angle nearest
    /// to `reference`.
    #[inline]
    pub(crate) fn value(&self, tau: JointDisplacement, reference: f64) -> f64 {
        self.home + self.sign * tau.nearest(self.sign * (reference - self.home))
    }
}
