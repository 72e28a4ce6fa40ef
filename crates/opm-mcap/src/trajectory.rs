//! The recording of a motion: where everything is, as time goes on.
//!
//! | topic | messages |
//! |---|---|
//! | `/pose`, `/pose_velocities` | `opm.Pose`, `opm.PoseVelocities`: a double a task coordinate |
//! | `/joints`, `/velocities`, `/accelerations` | `opm.Joints` and so on: a double a joint coordinate |
//! | `/imaginary_joints`, `/imaginary_velocities` | a double an imaginary joint |
//! | `/condition` | `opm.Condition`: condition number, singularity measures, and `valid`, 1 or 0 |
//! | `/joint_states` | `foxglove.JointStates` of the joints, for viewers that know it; at most 200 a second |
//! | `/tf` | `foxglove.FrameTransforms`: where every body is; at most 200 a second |
//! | `/scene` | one `foxglove.SceneUpdate`: what the bodies look like, each in its own frame |
//! | `/bodies/NAME` | one `foxglove.PointCloud` a body, for viewers without scenes: its surface |
//! | `/violations` | `foxglove.Log`: a line where the motion cannot be followed |
//!
//! Metres, radians and seconds; what has no values in a recording has no topic. Time starts at
//! [`START`]; no clock is read. Where the mechanism cannot be, `/pose` and `/condition` (`valid` 0, the
//! condition number infinite, the measures NaN) go on and the joints pause.
//!
//! Metadata records: `run` (what the caller tells of the run), `joints` (which joint each field is, see
//! [`crate::joints`]), `quantities` (what each field of a position measures, `rad` or `m`), `roles`
//! (what each field is: `actuated`, `passive`, `imaginary` or `task`; a joint that has a task
//! coordinate's name wins), whatever the caller adds, and last `result`, with `complete = "true"`.
//! The mechanism file is an attachment, and so is the motion file where there is one.

use std::path::Path;

use foxglove::Encode;
use foxglove::messages::{
    FrameTransform, FrameTransforms, JointState, JointStates, Quaternion, Timestamp, Vector3,
    log::Level,
};

use crate::joints::{JointsTopic, fields};
use crate::log::{CHUNK_BYTES, Log, Topic};
use crate::scene::{Body, check, surface, update};
use crate::workspace::START;
use crate::{Metadata, PartialFile, RecordError, Sink};

/// Topic of the joints.
pub const JOINTS_TOPIC: &str = "/joints";
/// Topic of the imaginary joints.
pub const IMAGINARY_TOPIC: &str = "/imaginary_joints";
/// Topic of the task coordinates.
pub const POSE_TOPIC: &str = "/pose";
/// Topic of the rates of the task coordinates.
pub const POSE_VELOCITIES_TOPIC: &str = "/pose_velocities";
/// Topic of the joint rates.
pub const VELOCITIES_TOPIC: &str = "/velocities";
/// Topic of the joint accelerations.
pub const ACCELERATIONS_TOPIC: &str = "/accelerations";
/// Topic of the rates of the imaginary joints.
pub const IMAGINARY_VELOCITIES_TOPIC: &str = "/imaginary_velocities";
/// Topic of the condition number and the singularity measures.
pub const CONDITION_TOPIC: &str = "/condition";
/// Topic of the joints as viewers know them.
pub const JOINT_STATES_TOPIC: &str = "/joint_states";
/// Topic of the bodies' frames.
pub const FRAMES_TOPIC: &str = "/tf";
/// Topic of the bodies' shapes.
pub const SCENE_TOPIC: &str = "/scene";
/// Topic of the places where the motion cannot be followed.
pub const VIOLATIONS_TOPIC: &str = "/violations";
/// What the names of the bodies' clouds begin with.
pub const BODIES_TOPIC: &str = "/bodies/";

/// What is looked at, `/tf` and `/joint_states`, comes at most every so many nanoseconds: three times
/// as often as screens show pictures. All values of all samples are on the other topics.
pub const PICTURE_PERIOD: u64 = 5_000_000;

/// The field of `/condition` that says whether the mechanism can be there.
pub const VALID: &str = "valid";

/// What a value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Of a joint with a motor.
    Actuated,
    /// Of a joint without one.
    Passive,
    /// Of an imaginary joint.
    Imaginary,
    /// Of the pose.
    Task,
}

impl Role {
    /// `actuated`, `passive`, `imaginary` or `task`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Actuated => "actuated",
            Self::Passive => "passive",
            Self::Imaginary => "imaginary",
            Self::Task => "task",
        }
    }
}

/// A coordinate that is recorded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coordinate {
    /// Name, unique on its topic.
    pub name: String,
    /// SI unit of its position: `rad` or `m`.
    pub unit: &'static str,
    /// What it is.
    pub role: Role,
}

/// What a recording of a motion is of.
#[derive(Debug, Clone)]
pub struct Trajectory<'a> {
    /// Task coordinates; none for what has no pose.
    pub pose: Vec<Coordinate>,
    /// Joint coordinates.
    pub joints: Vec<Coordinate>,
    /// Imaginary joints.
    pub imaginary: Vec<Coordinate>,
    /// Whether rates and accelerations come with the positions.
    pub rates: bool,
    /// Names of what `/condition` tells beside `valid`; none for no such topic.
    pub measures: Vec<String>,
    /// The bodies, parents first; none for a recording without pictures.
    pub bodies: Vec<Body>,
    /// Files to attach: name and text (TOML or CSV), the mechanism file first.
    pub files: Vec<(&'a str, &'a [u8])>,
    /// The run: what moves, from where to where, version.
    pub run: Metadata,
}

/// One instant. Every slice has the length of what [`Trajectory`] names, rates none where it has none.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sample<'a> {
    /// Task coordinates.
    pub pose: &'a [f64],
    /// Their rates.
    pub pose_velocities: &'a [f64],
    /// The measures of `/condition`.
    pub measures: &'a [f64],
    /// The mechanism can be there, within its limits.
    pub valid: bool,
    /// Where the joints are; `None` out of reach.
    pub posture: Option<Posture<'a>>,
}

/// Where the joints and the bodies are.
#[derive(Debug, Clone, Copy, Default)]
pub struct Posture<'a> {
    /// Joint coordinates.
    pub joints: &'a [f64],
    /// Imaginary joints.
    pub imaginary: &'a [f64],
    /// How they move; `None` in a singularity, where that is not known.
    pub rates: Option<Rates<'a>>,
    /// The frame of every body in its parent's, the base's left out. Only read where
    /// [`TrajectoryRecorder::shows`] says so.
    pub frames: &'a [Frame],
}

/// How the joints move.
#[derive(Debug, Clone, Copy, Default)]
pub struct Rates<'a> {
    /// Of the joint coordinates, a second.
    pub velocities: &'a [f64],
    /// Of the imaginary joints, a second.
    pub imaginary: &'a [f64],
    /// Of the joint coordinates, a second squared.
    pub accelerations: &'a [f64],
}

/// Where a frame is in its parent's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Of its origin, metres.
    pub translation: [f64; 3],
    /// Unit quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// Writes a recording of a motion. Any error is final.
pub struct TrajectoryRecorder<W: Sink = PartialFile> {
    log: Log<W>,
    pose: Option<JointsTopic>,
    pose_velocities: Option<JointsTopic>,
    joints: Option<JointsTopic>,
    velocities: Option<JointsTopic>,
    accelerations: Option<JointsTopic>,
    imaginary: Option<JointsTopic>,
    imaginary_velocities: Option<JointsTopic>,
    condition: Option<JointsTopic>,
    states: Option<(Topic, JointStates)>,
    frames: Option<(Topic, FrameTransforms)>,
    violations: Topic,
    /// The measures and `valid`, as they are written.
    judged: Vec<f64>,
    message: Vec<u8>,
    time: u64,
    /// When the next picture is due.
    picture: u64,
}

impl TrajectoryRecorder {
    /// Starts a recording that will appear as the file `path`; see [`PartialFile`].
    ///
    /// # Errors
    /// Joints or bodies without a name of their own, or a file that cannot be written.
    pub fn create(path: &Path, trajectory: &Trajectory<'_>) -> Result<Self, RecordError> {
        Self::new(PartialFile::create(path)?, trajectory)
    }
}

impl<W: Sink> TrajectoryRecorder<W> {
    /// Starts a recording that goes to `sink`.
    ///
    /// # Errors
    /// As [`create`](TrajectoryRecorder::create).
    pub fn new(sink: W, trajectory: &Trajectory<'_>) -> Result<Self, RecordError> {
        let names = |coordinates: &[Coordinate]| -> Vec<String> {
            coordinates.iter().map(|c| c.name.clone()).collect()
        };
        let Trajectory { pose, joints, imaginary, rates, measures, bodies, .. } = trajectory;
        check(bodies)?;
        let (pose_names, joint_names) = (names(pose), names(joints));
        let imaginary_names = names(imaginary);
        let [mut quantities, mut roles, mut which] = [const { Metadata::new() }; 3];
        for coordinates in [pose, joints, imaginary] {
            for (field, coordinate) in fields(&names(coordinates))?.into_iter().zip(coordinates) {
                quantities.insert(field.clone(), coordinate.unit.to_owned());
                roles.insert(field.clone(), coordinate.role.name().to_owned());
                if coordinate.role != Role::Task {
                    which.insert(field, coordinate.name.clone());
                }
            }
        }
        let mut log = Log::new(sink, CHUNK_BYTES)?;
        for (name, text) in &trajectory.files {
            let kind = if name.ends_with(".csv") { "text/csv" } else { "application/toml" };
            log.attach(name, kind, START, text)?;
        }
        for (name, record) in [
            ("run", &trajectory.run),
            ("joints", &which),
            ("quantities", &quantities),
            ("roles", &roles),
        ] {
            log.metadata(name, record)?;
        }

        let mut topic = |name: &str, message: &str, fields: &[String], wanted: bool| {
            let wanted = wanted && !fields.is_empty();
            wanted.then(|| JointsTopic::new(&mut log, name, message, fields)).transpose()
        };
        let judged = if measures.is_empty() {
            Vec::new()
        } else {
            measures.iter().cloned().chain([VALID.to_owned()]).collect()
        };
        let pose_velocities = topic(POSE_VELOCITIES_TOPIC, "PoseVelocities", &pose_names, *rates)?;
        let pose = topic(POSE_TOPIC, "Pose", &pose_names, true)?;
        let joints = topic(JOINTS_TOPIC, "Joints", &joint_names, true)?;
        let velocities = topic(VELOCITIES_TOPIC, "Velocities", &joint_names, *rates)?;
        let accelerations = topic(ACCELERATIONS_TOPIC, "Accelerations", &joint_names, *rates)?;
        let imaginary = topic(IMAGINARY_TOPIC, "ImaginaryJoints", &imaginary_names, true)?;
        let imaginary_velocities =
            topic(IMAGINARY_VELOCITIES_TOPIC, "ImaginaryVelocities", &imaginary_names, *rates)?;
        let condition = topic(CONDITION_TOPIC, "Condition", &judged, true)?;
        let state = |name: &String| JointState { name: name.clone(), ..JointState::default() };
        let states =
            JointStates { timestamp: None, joints: joint_names.iter().map(state).collect() };
        let states = (!joint_names.is_empty())
            .then(|| Ok::<_, RecordError>((log.topic::<JointStates>(JOINT_STATES_TOPIC)?, states)))
            .transpose()?;
        let violations = log.topic::<foxglove::messages::Log>(VIOLATIONS_TOPIC)?;
        let mut recorder = Self {
            frames: None,
            log,
            pose,
            pose_velocities,
            joints,
            velocities,
            accelerations,
            imaginary,
            imaginary_velocities,
            condition,
            states,
            violations,
            judged: Vec::with_capacity(judged.len()),
            message: Vec::new(),
            time: 0,
            picture: 0,
        };
        if !bodies.is_empty() {
            recorder.show(bodies)?;
        }
        Ok(recorder)
    }

    /// Writes what the bodies look like, once.
    fn show(&mut self, bodies: &[Body]) -> Result<(), RecordError> {
        let mut scene = self.log.topic::<foxglove::messages::SceneUpdate>(SCENE_TOPIC)?;
        put(&mut self.log, &mut self.message, &mut scene, START, &update(bodies, stamp(START)))?;
        for body in bodies {
            let name = format!("{BODIES_TOPIC}{}", body.frame);
            let mut topic = self.log.topic::<foxglove::messages::PointCloud>(&name)?;
            let cloud = surface(body, bodies, stamp(START))?;
            self.log.message(&mut topic, START, &cloud)?;
        }
        let transform = |body: &Body| {
            body.parent.map(|parent| FrameTransform {
                timestamp: None,
                parent_frame_id: bodies[parent].frame.clone(),
                child_frame_id: body.frame.clone(),
                translation: None,
                rotation: None,
            })
        };
        let transforms = bodies.iter().filter_map(transform).collect();
        let topic = self.log.topic::<FrameTransforms>(FRAMES_TOPIC)?;
        self.frames = Some((topic, FrameTransforms { transforms }));
        Ok(())
    }

    /// Whether an instant so many nanoseconds after the start will be on `/tf` and `/joint_states`.
    pub fn shows(&self, time: u64) -> bool {
        time >= self.picture
    }

    /// Writes one instant, `time` nanoseconds after the start.
    ///
    /// # Errors
    /// Another number of values than were named, a time before the last one, or a failed write.
    pub fn push(&mut self, time: u64, sample: &Sample<'_>) -> Result<(), RecordError> {
        let result = self.try_push(time, sample);
        if result.is_err() {
            self.log.give_up();
        }
        result
    }

    fn try_push(&mut self, time: u64, sample: &Sample<'_>) -> Result<(), RecordError> {
        let shows = self.shows(time);
        let next = time.saturating_add(PICTURE_PERIOD);
        let time = self.advance(time)?;
        let log = &mut self.log;
        let mut write = |topic: &mut Option<JointsTopic>, values: &[f64]| match topic {
            Some(topic) => topic.write(log, time, values),
            None if values.is_empty() => Ok(()),
            None => Err(RecordError::Row { values: values.len(), columns: 0 }),
        };
        write(&mut self.pose, sample.pose)?;
        write(&mut self.pose_velocities, sample.pose_velocities)?;
        if self.condition.is_some() {
            self.judged.clear();
            self.judged.extend_from_slice(sample.measures);
            self.judged.push(f64::from(u8::from(sample.valid)));
            write(&mut self.condition, &self.judged)?;
        }
        let Some(posture) = sample.posture else { return Ok(()) };
        write(&mut self.joints, posture.joints)?;
        write(&mut self.imaginary, posture.imaginary)?;
        if let Some(rates) = posture.rates {
            write(&mut self.velocities, rates.velocities)?;
            write(&mut self.imaginary_velocities, rates.imaginary)?;
            write(&mut self.accelerations, rates.accelerations)?;
        }
        if !shows {
            return Ok(());
        }
        self.picture = next;
        if let Some((topic, states)) = &mut self.states {
            states.timestamp = Some(stamp(time));
            for (i, state) in states.joints.iter_mut().enumerate() {
                state.position = Some(posture.joints[i]);
                state.velocity = posture.rates.map(|rates| rates.velocities[i]);
                state.acceleration = posture.rates.map(|rates| rates.accelerations[i]);
            }
            put(&mut self.log, &mut self.message, topic, time, states)?;
        }
        if let Some((topic, frames)) = &mut self.frames {
            let (values, columns) = (posture.frames.len(), frames.transforms.len());
            if values != columns {
                return Err(RecordError::Row { values, columns });
            }
            for (transform, frame) in frames.transforms.iter_mut().zip(posture.frames) {
                let ([x, y, z], [qx, qy, qz, qw]) = (frame.translation, frame.rotation);
                transform.timestamp = Some(stamp(time));
                transform.translation = Some(Vector3 { x, y, z });
                transform.rotation = Some(Quaternion { x: qx, y: qy, z: qz, w: qw });
            }
            put(&mut self.log, &mut self.message, topic, time, frames)?;
        }
        Ok(())
    }

    /// Marks that the motion cannot be followed from `time` nanoseconds after the start, in words.
    ///
    /// # Errors
    /// A time before the last one, or a failed write.
    pub fn mark(&mut self, time: u64, message: &str) -> Result<(), RecordError> {
        let time = self.advance(time)?;
        let line = foxglove::messages::Log {
            timestamp: Some(stamp(time)),
            level: Level::Warning as i32,
            message: message.to_owned(),
            name: "opm".to_owned(),
            file: String::new(),
            line: 0,
        };
        put(&mut self.log, &mut self.message, &mut self.violations, time, &line)
    }

    /// Adds a metadata record.
    ///
    /// # Errors
    /// A failed write.
    pub fn describe(&mut self, name: &str, record: &Metadata) -> Result<(), RecordError> {
        self.log.metadata(name, record)
    }

    /// The time on the recording's clock, which does not go back.
    fn advance(&mut self, time: u64) -> Result<u64, RecordError> {
        if time < self.time {
            let last = self.time;
            self.log.give_up();
            return Err(RecordError::Time { time, last });
        }
        self.time = time;
        Ok(START.saturating_add(time))
    }

    /// Completes the recording: `result` is the last metadata record, with `complete = "true"`
    /// added. Only now does the file get its name.
    ///
    /// # Errors
    /// A failed write.
    pub fn finish(mut self, result: &Metadata) -> Result<(), RecordError> {
        let mut result = result.clone();
        result.insert("complete".into(), "true".into());
        self.log.metadata("result", &result)?;
        self.log.finish()
    }
}

fn stamp(time: u64) -> Timestamp {
    let seconds = u32::try_from(time / 1_000_000_000).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (time % 1_000_000_000) as u32)
}

/// Writes a message of a well-known type.
fn put<W: Sink, M: Encode>(
    log: &mut Log<W>,
    buffer: &mut Vec<u8>,
    topic: &mut Topic,
    time: u64,
    message: &M,
) -> Result<(), RecordError> {
    buffer.clear();
    message
        .encode(buffer)
        .map_err(|reason| RecordError::Layout(format!("the message: {reason}")))?;
    log.message(topic, time, buffer)
}
