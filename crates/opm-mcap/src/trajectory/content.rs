//! What is recorded of a motion: the head of a recording, and its samples.

use crate::Metadata;
use crate::scene::Body;

/// The role of a value in the mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The value of an actuated joint.
    Actuated,
    /// The value of a passive joint.
    Passive,
    /// The value of an imaginary joint.
    Imaginary,
    /// A task coordinate of the pose.
    Task,
    /// A task coordinate that follows from those of the pose.
    Dependent,
}

impl Role {
    /// The word for the role: `actuated`, `passive`, `imaginary`, `task` or `dependent`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Actuated => "actuated",
            Self::Passive => "passive",
            Self::Imaginary => "imaginary",
            Self::Task => "task",
            Self::Dependent => "dependent",
        }
    }
}

/// A coordinate that is recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coordinate {
    /// The name, which no other coordinate on the same topic has.
    pub name: String,
    /// The SI unit of its position: `rad` or `m`.
    pub unit: &'static str,
    /// The role of its values.
    pub role: Role,
}

/// The head of a recording of a motion: which values and bodies it has.
#[derive(Debug, Clone)]
pub struct Trajectory<'a> {
    /// The task coordinates; none for a mechanism without a platform.
    pub pose: Vec<Coordinate>,
    /// The task coordinates that follow from those of the pose; none in most mechanisms.
    pub dependent: Vec<Coordinate>,
    /// The joint coordinates.
    pub joints: Vec<Coordinate>,
    /// The imaginary joints.
    pub imaginary: Vec<Coordinate>,
    /// Whether rates and accelerations come with the positions.
    pub rates: bool,
    /// The names of the values of `/condition` beside `valid`; without any there is no such topic.
    pub measures: Vec<String>,
    /// Names and units of the values of `/indices`; without any there is no such topic.
    pub indices: Vec<(String, &'static str)>,
    /// The bodies, parents first; none for a recording without a scene.
    pub bodies: Vec<Body>,
    /// The files to attach: name and text (TOML or CSV), the mechanism file first.
    pub files: Vec<(&'a str, &'a [u8])>,
    /// The description of the run: what moves, from where to where, version.
    pub run: Metadata,
}

/// One instant of a motion. Every slice has one value for each name in the [`Trajectory`]; slices of rates are
/// empty if it has no rates.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample<'a> {
    /// The task coordinates, radians and metres.
    pub pose: &'a [f64],
    /// The rates of the task coordinates, per second.
    pub pose_velocities: &'a [f64],
    /// The values of `/condition`.
    pub measures: &'a [f64],
    /// The values of `/indices`.
    pub indices: &'a [f64],
    /// Whether the pose is in reach and within all limits.
    pub valid: bool,
    /// The joints and bodies; `None` out of reach.
    pub posture: Option<Posture<'a>>,
}

/// The joints and bodies at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Posture<'a> {
    /// The dependent coordinates, radians and metres.
    pub dependent: &'a [f64],
    /// The joint coordinates, radians and metres.
    pub joints: &'a [f64],
    /// The imaginary joints, radians and metres.
    pub imaginary: &'a [f64],
    /// The rates of the joints; `None` at a singularity, where they are not known.
    pub rates: Option<Rates<'a>>,
    /// The frame of every body except the base, in the frame of its parent. They are only read at times of
    /// which [`TrajectoryRecorder::shows`](super::TrajectoryRecorder::shows) is true.
    pub frames: &'a [Frame],
    /// The numbers of the bodies that interfere, ascending: the scene shows them red. They are only read at times of which
    /// [`TrajectoryRecorder::shows`](super::TrajectoryRecorder::shows) is true.
    pub interfering: &'a [usize],
}

/// The rates of the joints at one instant.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rates<'a> {
    /// The rates of the dependent coordinates, per second.
    pub dependent: &'a [f64],
    /// The rates of the joint coordinates, per second.
    pub velocities: &'a [f64],
    /// The rates of the imaginary joints, per second.
    pub imaginary: &'a [f64],
    /// The accelerations of the joint coordinates, per second squared.
    pub accelerations: &'a [f64],
}

/// The place of a frame in the frame of its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The position of its origin, metres.
    pub translation: [f64; 3],
    /// The rotation as a unit quaternion x, y, z, w.
    pub rotation: [f64; 4],
}
