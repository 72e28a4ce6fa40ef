//! Why a motion has no fastest timing.

use crate::manipulator::PoseError;
use crate::velocity::VelocityError;

/// Why a motion has no fastest timing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimingError {
    /// Actuated joints have no limit of their accelerations, nor of their efforts.
    #[error(
        "no max_acceleration of {}: the fastest timing needs one, or a max_effort, for every actuated joint, and max_rate where there is one; caps of the tool's acceleration, and of its angular acceleration where it turns, do instead",
        .joints.join(", ")
    )]
    NoLimits {
        /// The names of the joints.
        joints: Vec<String>,
    },
    /// A cap of the tool's motion is not above zero, or no number.
    #[error("the largest {name} of the tool is {cap}, expected a number above 0")]
    Cap {
        /// What is capped.
        name: &'static str,
        /// The cap.
        cap: f64,
    },
    /// The motion is for a manipulator with another number of task coordinates.
    #[error("the motion has {given} task coordinates, expected {expected}, as the manipulator has")]
    Coordinates {
        /// The number of coordinates of the motion.
        given: usize,
        /// The number of task coordinates of the manipulator.
        expected: usize,
    },
    /// The platform or the joints that have limits do not move.
    #[error("nothing moves that has a limit, expected a motion from one pose to another")]
    Still,
    /// A leg does not reach a pose.
    #[error(
        "at t = {time} s, {leg} does not reach the pose: what cannot be followed has no timing"
    )]
    OutOfReach {
        /// The time of the motion as it is given, seconds.
        time: f64,
        /// The name of the leg.
        leg: String,
    },
    /// An actuator cannot stand the weight, the load and the dry friction, however slow the motion.
    #[error(
        "at t = {time:.6} s, {joint} needs {effort:.4} {unit} against weight, load and dry friction, more than its max_effort of {limit} {unit}: no timing is slow enough"
    )]
    Effort {
        /// The time of the motion as it is given, seconds.
        time: f64,
        /// The name of the joint.
        joint: String,
        /// The effort, N or N m.
        effort: f64,
        /// Its largest effort, N or N m.
        limit: f64,
        /// The unit of both.
        unit: &'static str,
    },
    /// Efforts are not known.
    #[error(
        "at t = {time:.6} s, the efforts of actuators with a max_effort are not determined: a singularity, or actuators that work against each other, expected a motion without, or joints without max_effort"
    )]
    NoEffort {
        /// The time of the motion as it is given, seconds.
        time: f64,
    },
    /// A joint has no rate, or the limits leave none.
    #[error("at t = {time} s, a leg is singular: its joints cannot have limited rates there")]
    Singular {
        /// The time of the motion as it is given, seconds.
        time: f64,
    },
    /// A pose of the motion cannot be computed with.
    #[error("at t = {time} s: {source}")]
    Pose {
        /// The time of the motion as it is given, seconds.
        time: f64,
        /// The reason.
        source: PoseError,
    },
    /// A velocity or acceleration of the motion cannot be computed with.
    #[error("at t = {time} s: {source}")]
    Velocity {
        /// The time of the motion as it is given, seconds.
        time: f64,
        /// The reason.
        source: VelocityError,
    },
}
