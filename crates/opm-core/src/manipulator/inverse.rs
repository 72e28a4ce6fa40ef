//! Inverse kinematics: one working mode, all of them, or the actuated joints alone.
//!
//! Every function here has the same convention. It takes a pose and a buffer that a method of
//! [`Manipulator`] made, and returns what it wrote to the buffer: `Ok(Some(solution))`. For a pose out of
//! reach it returns `Ok(None)`, and the buffer tells which legs do not reach it. An error means that the
//! pose is not valid. Nothing allocates.

use super::leg::{ChainCoordinate, CompiledSection, LegSolution, Section};
use super::{Manipulator, Mode};
use crate::chain::{Chain, ReachDeficit};
use crate::group::{Displacement, JointDisplacement};
use nalgebra::{Isometry3, Vector3};
use std::f64::consts::TAU;

/// The largest absolute value of a coordinate of a pose, radians or metres: the fourth power of a larger one,
/// which intermediate results contain, would overflow.
pub const LARGEST: f64 = 1e75;

/// Why a pose is not valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseError {
    /// The number of coordinates is not that of the manipulator.
    #[error("{given} coordinate{}, expected {expected}", if *given == 1 { "" } else { "s" })]
    Length {
        /// The number of coordinates given.
        given: usize,
        /// The number of task coordinates.
        expected: usize,
    },
    /// A coordinate is NaN, infinite, or larger than [`LARGEST`].
    #[error("{name} is {value:?}, expected a number of at most {LARGEST:?}")]
    NotFinite {
        /// The name of the coordinate.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The dependent coordinates of the pose have no solution.
    #[error(
        "no value of the dependent coordinates satisfies the constraint of leg {leg}, by {:.3e} {}",
        deficit.excess, deficit.quantity.unit()
    )]
    Constraint {
        /// The name of the leg.
        leg: String,
        /// By how much its constraint is missed.
        deficit: ReachDeficit,
    },
    /// A coordinate is given that follows from those of the pose.
    #[error(transparent)]
    Follows(#[from] FollowingCoordinate),
    /// There is no task coordinate with this name.
    #[error("no task coordinate is called {name}, expected {expected}")]
    Unknown {
        /// The name that was given.
        name: String,
        /// The names of the task coordinates, separated by commas.
        expected: String,
    },
}

/// A dependent coordinate where one of the pose was expected.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} {}", self.problem())]
pub struct FollowingCoordinate {
    /// The name of the dependent coordinate.
    pub name: String,
    /// The names of the coordinates of a pose, which it follows from.
    pub independent: Vec<&'static str>,
}

impl FollowingCoordinate {
    /// The problem, without the name of the coordinate.
    pub(crate) fn problem(&self) -> String {
        format!("follows from {}; give these instead", self.independent.join(", "))
    }
}

/// A leg that does not reach a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Unreachable {
    /// The number of the leg.
    pub leg: usize,
    /// The section of the leg that does not close.
    pub section: Section,
    /// The distance or angle by which the section does not reach.
    pub deficit: ReachDeficit,
}

/// Every joint in one working mode at one pose. [`Manipulator::solution`] makes a buffer of this type.
///
/// Its numbers are read-only, since velocities and Jacobians are computed from them.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("translational-helical-3dof")?;
/// let mut buffer = manipulator.solution();
/// let pose = manipulator.pose([("phi", 0.5)])?;
/// let solution = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)?;
/// let solution = solution.expect("a pose in reach");
/// // One value for each joint coordinate, and one for each imaginary joint: S = p phi (Eq. 24).
/// assert_eq!(solution.joints().len(), manipulator.coordinates().len());
/// assert!((solution.imaginary()[0] - 0.020 * 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, PartialEq)]
pub struct Solution {
    pub(crate) joints: Vec<f64>,
    pub(crate) imaginary: Vec<f64>,
    /// Every leg's displacement along the intersection motion, radians or metres, whether it is reported as an
    /// imaginary joint or not.
    pub(super) taus: Vec<f64>,
    /// The pose that was solved, from which velocities are computed.
    pub(crate) solved: SolvedPose,
    /// The values of its independent and of its dependent coordinates; empty where all are independent.
    pub(super) parts: [Vec<f64>; 2],
    /// Every leg's displacements from home, as its chains give them.
    pub(crate) legs: Vec<LegSolution>,
    pub(crate) within_limits: bool,
    pub(crate) unreachable: Vec<Unreachable>,
}

/// A pose and its two displacements, `g = v · b`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SolvedPose {
    /// All task coordinates, dependent ones too.
    pub pose: Vec<f64>,
    pub v: Displacement,
    pub b: Displacement,
}

impl Solution {
    /// The value of every joint coordinate, in the order of [`Manipulator::coordinates`]; radians and
    /// metres.
    #[inline]
    pub fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// The value of every imaginary joint, in the order of [`Manipulator::imaginary`]; radians and metres.
    #[inline]
    pub fn imaginary(&self) -> &[f64] {
        &self.imaginary
    }

    /// Whether all joint coordinates are within their limits.
    #[inline]
    pub fn within_limits(&self) -> bool {
        self.within_limits
    }

    /// The legs that the last pose is out of reach of; empty where it was reached.
    #[inline]
    pub fn unreachable(&self) -> &[Unreachable] {
        &self.unreachable
    }

    /// The pose that this is the solution of, in the order of [`Manipulator::task_coordinates`].
    #[inline]
    pub fn pose(&self) -> &[f64] {
        let [independent, _] = &self.parts;
        if independent.is_empty() { &self.solved.pose } else { independent }
    }

    /// The values of the dependent coordinates, in the order of [`Manipulator::dependent_coordinates`]; radians
    /// and metres.
    #[inline]
    pub fn dependent(&self) -> &[f64] {
        &self.parts[1]
    }

    /// The platform's displacement from home, base coordinates. `manipulator` is the one that was solved.
    pub fn displacement(&self, manipulator: &Manipulator) -> Isometry3<f64> {
        let SolvedPose { pose, v, b } = &self.solved;
        let task = &manipulator.task;
        task.raised(task.rise(pose), task.isometry(v, b))
    }

    /// Takes a pose, with its dependent coordinates, as the one that was solved.
    pub(crate) fn take_pose(&mut self, manipulator: &Manipulator, all: &[f64]) {
        self.solved.pose.copy_from_slice(all);
        (self.solved.v, self.solved.b) = manipulator.task.sections(all);
        manipulator.divide(self);
    }

    /// This solution, if every leg closes.
    #[inline]
    pub(super) fn reached(&self) -> Option<&Self> {
        self.unreachable.is_empty().then_some(self)
    }
}

/// Its joints, imaginary joints, whether it is within limits, and the legs that are out of reach.
#[cfg(feature = "serde")]
impl serde::Serialize for Solution {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        use serde::ser::SerializeStruct;
        let mut fields = serializer.serialize_struct("Solution", 4)?;
        fields.serialize_field("joints", &self.joints)?;
        fields.serialize_field("imaginary", &self.imaginary)?;
        fields.serialize_field("within_limits", &self.within_limits)?;
        fields.serialize_field("unreachable", &self.unreachable)?;
        fields.end()
    }
}

impl Clone for Solution {
    fn clone(&self) -> Self {
        Self {
            joints: self.joints.clone(),
            imaginary: self.imaginary.clone(),
            taus: self.taus.clone(),
            solved: self.solved.clone(),
            parts: self.parts.clone(),
            legs: self.legs.clone(),
            within_limits: self.within_limits,
            unreachable: self.unreachable.clone(),
        }
    }

    /// Copies another solution of the same manipulator without allocating.
    fn clone_from(&mut self, other: &Self) {
        self.joints.clone_from(&other.joints);
        self.imaginary.clone_from(&other.imaginary);
        self.taus.clone_from(&other.taus);
        self.solved.pose.clone_from(&other.solved.pose);
        (self.solved.v, self.solved.b) = (other.solved.v, other.solved.b);
        self.parts.clone_from(&other.parts);
        self.legs.clone_from(&other.legs);
        self.within_limits = other.within_limits;
        self.unreachable.clone_from(&other.unreachable);
    }
}

/// The actuated and the imaginary joints in one working mode at one pose.
/// [`Manipulator::actuated_joints`] makes a buffer of this type.
///
/// ```
/// use opm_core::Manipulator;
///
/// let manipulator = Manipulator::example("plano-spherical-5dof")?;
/// let (mode, mut few) = (manipulator.home_mode(), manipulator.actuated_joints());
/// let pose = manipulator.pose([("x", 0.01)])?;
/// let motors = manipulator.inverse_actuated(&pose, mode, &mut few)?.expect("a pose in reach");
/// // The same values as with all joints.
/// let mut all = manipulator.solution();
/// let joints = manipulator.inverse(&pose, mode, &mut all)?.expect("a pose in reach").joints();
/// for (value, &number) in motors.actuated().iter().zip(manipulator.actuated()) {
///     assert_eq!(*value, joints[number]);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ActuatedJoints {
    actuated: Vec<f64>,
    imaginary: Vec<f64>,
    within_limits: bool,
    /// All coordinates of the pose, where some are dependent.
    #[cfg_attr(feature = "serde", serde(skip))]
    all: Vec<f64>,
}

impl ActuatedJoints {
    /// The values of the actuated coordinates, in the order of [`Manipulator::actuated`]; radians and
    /// metres.
    #[inline]
    pub fn actuated(&self) -> &[f64] {
        &self.actuated
    }

    /// The value of every imaginary joint, in the order of [`Manipulator::imaginary`]; radians and metres.
    #[inline]
    pub fn imaginary(&self) -> &[f64] {
        &self.imaginary
    }

    /// Whether all joint coordinates, passive ones too, are within their limits.
    #[inline]
    pub fn within_limits(&self) -> bool {
        self.within_limits
    }
}

impl Manipulator {
    /// A buffer for [`Manipulator::inverse`]. It holds the values at home, which the first call of
    /// [`Manipulator::inverse_near`] starts from.
    pub fn solution(&self) -> Solution {
        Solution {
            joints: self.coordinates.iter().map(|c| c.home).collect(),
            imaginary: self.imaginary.iter().map(|joint| joint.home).collect(),
            taus: vec![0.0; self.legs.len()],
            parts: match &self.dependent {
                Some(d) => {
                    [self.home_pose(), d.coordinates.iter().map(|&i| self.home[i]).collect()]
                }
                None => [Vec::new(), Vec::new()],
            },
            solved: self.solved_at_home(),
            legs: vec![LegSolution::HOME; self.legs.len()],
            within_limits: false,
            unreachable: Vec::with_capacity(self.legs.len()),
        }
    }

    /// A buffer for [`Manipulator::inverse_actuated`].
    pub fn actuated_joints(&self) -> ActuatedJoints {
        ActuatedJoints {
            actuated: vec![0.0; self.actuated.len()],
            imaginary: vec![0.0; self.imaginary.len()],
            within_limits: false,
            all: vec![0.0; self.dependent.as_ref().map_or(0, |_| self.task.coordinates.len())],
        }
    }

    /// The pose at home, radians and metres.
    pub fn home_pose(&self) -> Vec<f64> {
        self.task_coordinates().iter().map(|c| c.home).collect()
    }

    pub(super) fn solved_at_home(&self) -> SolvedPose {
        let pose = self.home.clone();
        let (v, b) = self.task.sections(&pose);
        SolvedPose { pose, v, b }
    }

    /// Refuses the name of a dependent coordinate, where a coordinate of the pose is expected.
    ///
    /// # Errors
    /// [`FollowingCoordinate`]
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let five_bar = Manipulator::example("five-bar")?;
    /// assert_eq!(five_bar.refuse_following("x"), Ok(()));
    /// let error = five_bar.refuse_following("theta").unwrap_err();
    /// assert_eq!(error.to_string(), "theta follows from x, y; give these instead");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn refuse_following(&self, name: &str) -> Result<(), FollowingCoordinate> {
        match self.dependent_coordinates().iter().any(|c| c.name == name) {
            false => Ok(()),
            true => Err(FollowingCoordinate {
                name: name.to_owned(),
                independent: self.task_coordinates().iter().map(|c| c.name).collect(),
            }),
        }
    }

    /// The pose with these values of task coordinates by name (radians and metres); the others have
    /// their values at home.
    ///
    /// # Errors
    /// A name is not that of a task coordinate, or a value is not a finite number.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
    /// assert_eq!(pose, [0.01, 0.0, 0.0, 15_f64.to_radians(), 0.0]); // x y zeta xi psi
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn pose<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, f64)>,
    ) -> Result<Vec<f64>, PoseError> {
        let coordinates = self.task_coordinates();
        let mut pose = self.home_pose();
        for (name, value) in values {
            let Some(number) = coordinates.iter().position(|c| c.name == name) else {
                self.refuse_following(name)?;
                let names: Vec<_> = coordinates.iter().map(|c| c.name).collect();
                return Err(PoseError::Unknown {
                    name: name.to_owned(),
                    expected: names.join(", "),
                });
            };
            pose[number] = value;
        }
        self.check_pose(&pose)?;
        Ok(pose)
    }

    /// Every joint at a pose in one working mode, angles within half a revolution of home; `None` where
    /// the pose is out of reach in that mode ([`Solution::unreachable`] of the buffer lists the legs).
    ///
    /// # Errors
    /// The pose has the wrong length, or a coordinate that is not a finite number.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// let mut buffer = manipulator.solution();
    /// let pose = [0.01, 0.0, 0.0, 0.26, 0.0]; // x y zeta xi psi
    /// match manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)? {
    ///     Some(solution) => assert!(solution.within_limits()),
    ///     None => println!("out of reach: {:?}", buffer.unreachable()),
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[inline]
    pub fn inverse<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Result<Option<&'a Solution>, PoseError> {
        if self.displace(pose, mode, buffer, Revolutions::NearHome)? {
            self.solve_legs(mode, buffer, Revolutions::NearHome);
        }
        Ok(buffer.reached())
    }

    /// Does the same as [`Manipulator::inverse`], but each angle is the one nearest to what the buffer held before:
    /// along a trajectory no joint jumps by a revolution, not even to stay within its limits, and
    /// [`Solution::within_limits`] refers to that angle. Where the pose is out of reach, the buffer keeps the
    /// last values that were in reach.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    #[inline]
    pub fn inverse_near<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut Solution,
    ) -> Result<Option<&'a Solution>, PoseError> {
        if self.displace(pose, mode, buffer, Revolutions::NearHeld)? {
            self.solve_legs(mode, buffer, Revolutions::NearHeld);
        }
        Ok(buffer.reached())
    }

    /// The actuated and the imaginary joints alone at a pose in one working mode; `None`
    /// where the pose is out of reach. Angles are within half a revolution of home.
    ///
    /// # Errors
    /// As [`Manipulator::inverse`].
    pub fn inverse_actuated<'a>(
        &self,
        pose: &[f64],
        mode: Mode,
        buffer: &'a mut ActuatedJoints,
    ) -> Result<Option<&'a ActuatedJoints>, PoseError> {
        self.check_pose(pose)?;
        let (v, b) = match &self.dependent {
            None => self.task.sections(pose),
            Some(dependent) => {
                let all = &mut buffer.all;
                if dependent.complete_from_home(self, mode, pose, all).is_err() {
                    return Ok(None);
                }
                self.task.sections(all)
            }
        };
        buffer.within_limits = true;
        for (number, leg) in self.legs.iter().enumerate() {
            let branches = self.modes.branches(mode, number);
            let tau = if leg.upper_constrains {
                let Ok(solution) = leg.solve(&self.task, [&v, &b], branches, 0.0) else {
                    return Ok(None);
                };
                self.write_actuated(&leg.upper, &solution.upper, buffer);
                self.write_actuated(&leg.lower, &solution.lower, buffer);
                solution.tau
            } else {
                let Ok((lower, tau)) = leg.solve_actuated(&self.task, [&v, &b], branches) else {
                    return Ok(None);
                };
                self.write_actuated(&leg.lower, &lower, buffer);
                tau
            };
            if let Some(imaginary) = leg.imaginary {
                let joint = &self.imaginary[imaginary];
                buffer.imaginary[imaginary] = joint.value(tau, joint.home);
            }
        }
        for lift in self.lifts() {
            let (value, within) = self.lifted(lift, self.task.rise(pose));
            buffer.within_limits &= within;
            if let Some(actuated) = lift.coordinate.actuated {
                buffer.actuated[actuated] = value;
            }
        }
        Ok(Some(buffer))
    }

    /// Returns an error for a pose with a wrong number of coordinates, or with one that is not a finite number.
    #[inline]
    pub(crate) fn check_pose(&self, pose: &[f64]) -> Result<(), PoseError> {
        let coordinates = self.task_coordinates();
        if pose.len() != coordinates.len() {
            return Err(PoseError::Length { given: pose.len(), expected: coordinates.len() });
        }
        for (coordinate, &value) in coordinates.iter().zip(pose) {
            if value.is_nan() || value.abs() > LARGEST {
                return Err(PoseError::NotFinite { name: coordinate.name, value });
            }
        }
        Ok(())
    }

    /// Stores a pose and its displacements, or returns an error if the pose is not valid. Returns `false` where
    /// the dependent coordinates have no solution.
    #[inline]
    fn displace(
        &self,
        pose: &[f64],
        mode: Mode,
        out: &mut Solution,
        revolutions: Revolutions,
    ) -> Result<bool, PoseError> {
        self.check_pose(pose)?;
        if self.dependent.is_some() {
            return Ok(self.displace_dependent(pose, mode, out, revolutions));
        }
        out.solved.pose.copy_from_slice(pose);
        (out.solved.v, out.solved.b) = self.task.sections(pose);
        Ok(true)
    }

    #[inline]
    fn write_actuated(
        &self,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
        out: &mut ActuatedJoints,
    ) {
        out.within_limits &= section.admits(&self.limits, displacements);
        if !section.driven {
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            if let Some(ChainCoordinate { number, actuated: Some(actuated) }) = *coordinate {
                let home = self.coordinates[number].home;
                out.actuated[actuated] = home + self.limits[number].report(displacement);
            }
        }
    }

    fn solve_legs(&self, mode: Mode, out: &mut Solution, revolutions: Revolutions) {
        let SolvedPose { v, b, .. } = out.solved;
        out.unreachable.clear();
        out.within_limits = true;
        for (number, leg) in self.legs.iter().enumerate() {
            let branches = self.modes.branches(mode, number);
            let near = revolutions.near(out.taus[number], 0.0);
            match leg.solve(&self.task, [&v, &b], branches, near) {
                Ok(solution) => self.write(number, &solution, out, revolutions),
                Err((section, deficit)) => {
                    out.unreachable.push(Unreachable { leg: number, section, deficit });
                }
            }
        }
        self.write_lifts(out);
    }

    /// Writes the values of the lifts at the pose that `out` holds.
    #[inline]
    pub(crate) fn write_lifts(&self, out: &mut Solution) {
        for lift in self.lifts() {
            let (value, within) = self.lifted(lift, self.task.rise(&out.solved.pose));
            out.joints[lift.coordinate.number] = value;
            out.within_limits &= within;
        }
    }

    /// Writes a leg's solution to `out`, with angles within π of home.
    pub(crate) fn write_leg(&self, number: usize, solution: &LegSolution, out: &mut Solution) {
        self.write(number, solution, out, Revolutions::NearHome);
    }

    /// Writes a leg's solution to `out`.
    #[inline]
    pub(super) fn write(
        &self,
        number: usize,
        solution: &LegSolution,
        out: &mut Solution,
        revolutions: Revolutions,
    ) {
        let leg = &self.legs[number];
        out.legs[number] = *solution;
        self.write_section(&leg.lower, &solution.lower, out, revolutions);
        self.write_section(&leg.upper, &solution.upper, out, revolutions);
        out.taus[number] = solution.tau.nearest(revolutions.near(out.taus[number], 0.0));
        if let Some(imaginary) = leg.imaginary {
            let joint = &self.imaginary[imaginary];
            let near = revolutions.near(out.imaginary[imaginary], joint.home);
            out.imaginary[imaginary] = joint.value(solution.tau, near);
        }
    }

    #[inline]
    fn write_section(
        &self,
        section: &CompiledSection,
        displacements: &[JointDisplacement; 3],
        out: &mut Solution,
        revolutions: Revolutions,
    ) {
        let home = |number: usize| self.coordinates[number].home;
        // Otherwise the rotation vector, at most π long, is the one nearest to zero already.
        if matches!(section.chain, Chain::Ball(_)) && revolutions == Revolutions::NearHeld {
            let first = section.coordinates[0].map_or(0, |coordinate| coordinate.number);
            let near = Vector3::from_fn(|i, _| out.joints[first + i] - home(first + i));
            let vector = nearest_rotation(Vector3::from_fn(|i, _| displacements[i].value()), &near);
            for i in 0..3 {
                out.within_limits &=
                    self.limits[first + i].admits(JointDisplacement::Value(vector[i]));
                out.joints[first + i] = home(first + i) + vector[i];
            }
            return;
        }
        for (coordinate, &displacement) in section.coordinates.iter().zip(displacements) {
            let Some(ChainCoordinate { number, .. }) = *coordinate else { continue };
            let home = home(number);
            let held = (revolutions == Revolutions::NearHeld).then(|| out.joints[number] - home);
            let (value, within) = self.limits[number].place(displacement, held);
            out.joints[number] = home + value;
            out.within_limits &= within;
        }
    }
}

/// How the number of full revolutions of a reported angle is chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Revolutions {
    /// The angle is within π of home, or within the limits where that is possible.
    NearHome,
    /// The angle is the one nearest to the value that the buffer holds.
    NearHeld,
}

impl Revolutions {
    #[inline]
    fn near(self, held: f64, home: f64) -> f64 {
        match self {
            Self::NearHome => home,
            Self::NearHeld => held,
        }
    }
}

/// The rotation vector nearest to `reference` among those of the same rotation, which differ by full
/// revolutions.
fn nearest_rotation(vector: Vector3<f64>, reference: &Vector3<f64>) -> Vector3<f64> {
    /// A rotation by a smaller angle is the identity up to rounding, and its axis is arbitrary.
    const NONE: f64 = 1e-14;
    let angle = vector.norm();
    if angle < NONE {
        // Full revolutions about any axis are the identity: the nearest axis is that of the reference.
        let turns = (reference.norm() / TAU).round();
        return if turns == 0.0 { vector } else { reference.normalize() * (TAU * turns) };
    }
    let axis = vector / angle;
    let turns = (reference.dot(&axis) - angle) / TAU;
    // A rotation by π is as near as its opposite: it is not changed.
    if turns.abs() <= 0.5 { vector } else { axis * (angle + TAU * turns.round()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Limits are tested on the vector that the closed form gives, so that the reported one must be the same.
    #[test]
    fn a_rotation_by_pi_is_not_changed() {
        for half in [Vector3::z() * PI, Vector3::z() * -PI] {
            assert_eq!(nearest_rotation(half, &Vector3::zeros()), half);
            assert_eq!(nearest_rotation(half, &half), half);
        }
        let beyond = nearest_rotation(Vector3::z() * (0.1 - PI), &(Vector3::z() * PI));
        assert!((beyond - Vector3::z() * (0.1 + PI)).norm() < 1e-12);
    }

    /// A spherical joint that keeps rotating passes through a full revolution, where its rotation is the
    /// identity.
    #[test]
    fn a_full_revolution_does_not_jump_to_zero() {
        let round = Vector3::new(0.6, 0.0, -0.8) * TAU;
        for rounding in [Vector3::zeros(), Vector3::x() * 1e-16, Vector3::new(0.0, -3e-16, 1e-16)] {
            for before in [round * 0.999, round, round * 1.001, round * -2.0] {
                let turns = (before.dot(&round) / TAU / TAU).round();
                let found = nearest_rotation(rounding, &before);
                assert!((found - round * turns).norm() < 1e-14, "{rounding} {before}: {found}");
            }
            assert_eq!(nearest_rotation(rounding, &(round * 0.4)), rounding);
        }
    }
}
