//! The buffers of inverse kinematics, and what they hold after a call.

use super::Manipulator;
use super::leg::{LegSolution, Section};
use crate::chain::ReachDeficit;
use crate::group::{Displacement, JointDisplacement};
use nalgebra::Isometry3;

/// A leg that does not reach a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Unreachable {
    /// The number of the leg.
    pub leg: usize,
    /// The section of the leg that does not close; `None` for a leg that is solved whole.
    pub section: Option<Section>,
    /// The distance or angle by which the section does not reach.
    pub deficit: ReachDeficit,
}

impl Unreachable {
    /// What does not close, in words: `lower section`, `upper section` or `leg`.
    pub fn part(&self) -> &'static str {
        part_of(self.section)
    }
}

/// A section of a leg, or the whole leg, in words.
pub fn part_of(section: Option<Section>) -> &'static str {
    match section {
        Some(Section::Lower) => "lower section",
        Some(Section::Upper) => "upper section",
        None => "leg",
    }
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
    /// Every leg's displacements from home, as its chains give them; without meaning for a leg that is out of reach.
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

    /// The displacement of the lower section from home, base coordinates: the frame that the upper section moves in.
    /// `manipulator` is the one that was solved.
    pub fn lower_displacement(&self, manipulator: &Manipulator) -> Isometry3<f64> {
        let SolvedPose { pose, v, .. } = &self.solved;
        let (task, v) = (&manipulator.task, manipulator.task.lower.isometry(v));
        match task.height_in(Section::Lower) {
            Some(_) => task.raised(task.rise(pose), v),
            None => v,
        }
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
    pub(super) actuated: Vec<f64>,
    pub(super) imaginary: Vec<f64>,
    pub(super) within_limits: bool,
    /// All coordinates of the pose, where some are dependent.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) all: Vec<f64>,
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
    /// The numbers of the joint coordinates that are beyond their limits in a solution; of joints that are beyond their cones,
    /// the first one's; both of a difference that is beyond its limits.
    pub fn beyond_limits<'a>(&'a self, solution: &'a Solution) -> impl Iterator<Item = usize> + 'a {
        let limits = self.coordinates.iter().zip(&self.limits);
        let joints = limits.zip(solution.joints()).enumerate();
        let beyond = joints.filter(|(_, ((c, limits), value))| {
            !limits.admits(JointDisplacement::Value(**value - c.home))
        });
        let cones = self.beyond_cones(solution.joints()).map(|(_, first)| first);
        let differences = self.beyond_differences(solution.joints());
        let differences = differences.flat_map(|number| self.differences()[number].coordinates);
        beyond.map(|(number, _)| number).chain(cones).chain(differences)
    }

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

    pub(super) fn solved_at_home(&self) -> SolvedPose {
        let pose = self.home.clone();
        let (v, b) = self.task.sections(&pose);
        SolvedPose { pose, v, b }
    }
}
