//! The recording of a motion: joints, rates and bodies over time.
//!
//! | topic | messages |
//! |---|---|
//! | `/pose`, `/pose_velocities` | `opm.Pose`, `opm.PoseVelocities`: one double for each task coordinate |
//! | `/dependent_coordinates`, `/dependent_velocities` | one double for each task coordinate that follows from the others |
//! | `/joints`, `/velocities`, `/accelerations` | `opm.Joints` and so on: one double for each joint coordinate |
//! | `/imaginary_joints`, `/imaginary_velocities` | one double for each imaginary joint |
//! | `/condition` | `opm.Condition`: condition number, singularity measures, and `valid`, 1 or 0 |
//! | `/indices` | `opm.Indices`: what the caller judges each pose by |
//! | `/joint_states` | `foxglove.JointStates` of the joints, for viewers that know this schema; at most 60 a second |
//! | `/tf` | `foxglove.FrameTransforms`: where every body is; at most 60 a second |
//! | `/scene` | `foxglove.SceneUpdate`: what the bodies look like, each in its own frame; red while they are stuck, and those that interfere |
//! | `/scene/bodies/NAME` | a `foxglove.PointCloud` for each body, for viewers without scenes: its surface, once more where its colour changes |
//! | `/violations` | `foxglove.Log`: a line where the motion cannot be followed |
//!
//! Units are metres, radians and seconds. A topic without values is left out. Time starts at [`START`]; no
//! clock is read. Every topic of doubles has every sample. Out of reach, `/pose` goes on, `valid` is 0, the condition number
//! infinite, and everything else NaN, so that curves break; the bodies stay where they were, and turn red. Rates that a
//! singularity leaves unknown are NaN, too.
//!
//! These are the metadata records:
//!
//! * `run`: the caller's description of the run;
//! * `joints`: which joint each field is (see [`crate::joints`]);
//! * `quantities`: the unit of each position field, `rad` or `m`, and of each index that has one;
//! * `roles`: `actuated`, `passive`, `imaginary`, `task` or `dependent`, for each field; if a joint and a task
//!   coordinate have the same name, the joint's role counts;
//! * the records that the caller adds;
//! * last `result`, with `complete = "true"`.
//!
//! The mechanism file is an attachment, and so is the motion file, if there is one.
//!
//! ```
//! use opm_mcap::{
//!     Coordinate, Metadata, Posture, ReadError, Role, Sample, Trajectory, TrajectoryRecorder, read,
//! };
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("crank.mcap");
//! // One joint, recorded at 100 samples a second.
//! let crank = Coordinate { name: "crank".into(), unit: "rad", role: Role::Actuated };
//! let trajectory = Trajectory {
//!     pose: vec![],
//!     dependent: vec![],
//!     joints: vec![crank],
//!     imaginary: vec![],
//!     rates: false,
//!     measures: vec![],
//!     indices: vec![],
//!     bodies: vec![],
//!     files: vec![],
//!     run: Metadata::new(),
//! };
//! let mut recorder = TrajectoryRecorder::create(&path, &trajectory)?;
//! for i in 0..100 {
//!     let joints = [0.01 * i as f64];
//!     let posture = Posture { joints: &joints, ..Posture::default() };
//!     recorder.push(i * 10_000_000, &Sample { posture: Some(posture), ..Sample::default() })?;
//! }
//! recorder.finish(&Metadata::new())?;
//!
//! let (mut values, mut last) = (vec![], None);
//! read::<ReadError>(&path, |message| {
//!     if message.topic == "/joints" && message.values(&mut values)? {
//!         last = values.first().copied();
//!     }
//!     Ok(())
//! })?;
//! assert_eq!(last, Some(0.99));
//! # Ok(())
//! # }
//! ```

mod bodies;
mod content;

use std::path::Path;

use foxglove::Encode;
use foxglove::messages::{
    FrameTransforms, JointState, JointStates, Quaternion, Timestamp, Vector3, log::Level,
};

use crate::joints::{JointsTopic, fields};
use crate::log::{CHUNK_BYTES, Log, Topic};
use crate::scene::{State, check};
use crate::{Metadata, PartialFile, RecordError, Sink};
use bodies::Shown;
pub use content::{Coordinate, Frame, Posture, Rates, Role, Sample, Trajectory};

/// The topic of the joints.
pub const JOINTS_TOPIC: &str = "/joints";
/// The topic of the imaginary joints.
pub const IMAGINARY_TOPIC: &str = "/imaginary_joints";
/// The topic of the task coordinates.
pub const POSE_TOPIC: &str = "/pose";
/// The topic of the rates of the task coordinates.
pub const POSE_VELOCITIES_TOPIC: &str = "/pose_velocities";
/// The topic of the dependent coordinates.
pub const DEPENDENT_TOPIC: &str = "/dependent_coordinates";
/// The topic of the rates of the dependent coordinates.
pub const DEPENDENT_VELOCITIES_TOPIC: &str = "/dependent_velocities";
/// The topic of the joint rates.
pub const VELOCITIES_TOPIC: &str = "/velocities";
/// The topic of the joint accelerations.
pub const ACCELERATIONS_TOPIC: &str = "/accelerations";
/// The topic of the rates of the imaginary joints.
pub const IMAGINARY_VELOCITIES_TOPIC: &str = "/imaginary_velocities";
/// The topic of the condition number and the singularity measures.
pub const CONDITION_TOPIC: &str = "/condition";
/// The topic of what each pose is judged by.
pub const INDICES_TOPIC: &str = "/indices";
/// The topic of the joints in the schema that viewers know.
pub const JOINT_STATES_TOPIC: &str = "/joint_states";
/// The topic of the bodies' frames.
pub const FRAMES_TOPIC: &str = "/tf";
/// The topic of the bodies' shapes.
pub const SCENE_TOPIC: &str = "/scene";
/// The topic of the times at which the motion cannot be followed.
pub const VIOLATIONS_TOPIC: &str = "/violations";
/// The beginning of the topics of the bodies' clouds.
pub const BODIES_TOPIC: &str = "/scene/bodies/";

/// The time at which a motion starts, nanoseconds: as good as zero, which viewers take for a time that is not set.
pub const START: u64 = 1;

/// The shortest time between messages on `/tf` and `/joint_states`, nanoseconds: viewers warn of more than 60 a second. The
/// topics of doubles have the values of all samples.
pub const PICTURE_PERIOD: u64 = 16_666_667;

/// The field of `/condition` that says whether the pose is in reach and within all limits.
pub const VALID: &str = "valid";

/// Writes a recording of a motion. Any error is final. The [module](self) has an example.
pub struct TrajectoryRecorder<'w> {
    log: Log<'w>,
    pose: Option<JointsTopic>,
    pose_velocities: Option<JointsTopic>,
    dependent: Option<JointsTopic>,
    dependent_velocities: Option<JointsTopic>,
    joints: Option<JointsTopic>,
    velocities: Option<JointsTopic>,
    accelerations: Option<JointsTopic>,
    imaginary: Option<JointsTopic>,
    imaginary_velocities: Option<JointsTopic>,
    condition: Option<JointsTopic>,
    indices: Option<JointsTopic>,
    states: Option<(Topic, JointStates)>,
    frames: Option<(Topic, FrameTransforms)>,
    scene: Option<Shown>,
    violations: Topic,
    /// The measures and `valid`, as they are written.
    judged: Vec<f64>,
    message: Vec<u8>,
    time: u64,
    /// The time of the next message on `/tf` and `/joint_states`.
    picture: u64,
}

impl TrajectoryRecorder<'static> {
    /// Starts a recording that will appear as the file `path`; see [`PartialFile`].
    ///
    /// # Errors
    /// [`RecordError::Layout`] for joints or bodies without a name of their own, or a file that cannot be
    /// written.
    pub fn create(path: &Path, trajectory: &Trajectory<'_>) -> Result<Self, RecordError> {
        Self::new(PartialFile::create(path)?, trajectory)
    }
}

impl<'w> TrajectoryRecorder<'w> {
    /// Starts a recording that is written to `sink`.
    ///
    /// # Errors
    /// As [`create`](TrajectoryRecorder::create).
    pub fn new(sink: impl Sink + 'w, trajectory: &Trajectory<'_>) -> Result<Self, RecordError> {
        Self::begin(Box::new(sink), trajectory)
    }

    fn begin(sink: Box<dyn Sink + 'w>, trajectory: &Trajectory<'_>) -> Result<Self, RecordError> {
        let names = |coordinates: &[Coordinate]| -> Vec<String> {
            coordinates.iter().map(|c| c.name.clone()).collect()
        };
        let Trajectory { pose, dependent, joints, imaginary, rates, .. } = trajectory;
        let Trajectory { measures, indices, bodies, .. } = trajectory;
        check(bodies)?;
        let (pose_names, joint_names) = (names(pose), names(joints));
        let (dependent_names, imaginary_names) = (names(dependent), names(imaginary));
        let [mut quantities, mut roles, mut which] = [const { Metadata::new() }; 3];
        for coordinates in [pose, dependent, joints, imaginary] {
            for (field, coordinate) in fields(&names(coordinates))?.into_iter().zip(coordinates) {
                quantities.insert(field.clone(), coordinate.unit.to_owned());
                roles.insert(field.clone(), coordinate.role.name().to_owned());
                if !matches!(coordinate.role, Role::Task | Role::Dependent) {
                    which.insert(field, coordinate.name.clone());
                }
            }
        }
        let index_names: Vec<String> = indices.iter().map(|(name, _)| name.clone()).collect();
        for (field, (_, unit)) in fields(&index_names)?.into_iter().zip(indices) {
            if !unit.is_empty() {
                quantities.insert(field, (*unit).to_owned());
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
        let dependent = topic(DEPENDENT_TOPIC, "DependentCoordinates", &dependent_names, true)?;
        let dependent_velocities =
            topic(DEPENDENT_VELOCITIES_TOPIC, "DependentVelocities", &dependent_names, *rates)?;
        let joints = topic(JOINTS_TOPIC, "Joints", &joint_names, true)?;
        let velocities = topic(VELOCITIES_TOPIC, "Velocities", &joint_names, *rates)?;
        let accelerations = topic(ACCELERATIONS_TOPIC, "Accelerations", &joint_names, *rates)?;
        let imaginary = topic(IMAGINARY_TOPIC, "ImaginaryJoints", &imaginary_names, true)?;
        let imaginary_velocities =
            topic(IMAGINARY_VELOCITIES_TOPIC, "ImaginaryVelocities", &imaginary_names, *rates)?;
        let condition = topic(CONDITION_TOPIC, "Condition", &judged, true)?;
        let indices = topic(INDICES_TOPIC, "Indices", &index_names, true)?;
        let state = |name: &String| JointState { name: name.clone(), ..JointState::default() };
        let states =
            JointStates { timestamp: None, joints: joint_names.iter().map(state).collect() };
        let states = (!joint_names.is_empty())
            .then(|| Ok::<_, RecordError>((log.topic::<JointStates>(JOINT_STATES_TOPIC)?, states)))
            .transpose()?;
        let violations = log.topic::<foxglove::messages::Log>(VIOLATIONS_TOPIC)?;
        let mut recorder = Self {
            frames: None,
            scene: None,
            log,
            pose,
            pose_velocities,
            dependent,
            dependent_velocities,
            joints,
            velocities,
            accelerations,
            imaginary,
            imaginary_velocities,
            condition,
            indices,
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

    /// Whether an instant `time` nanoseconds after the start will be on `/tf` and `/joint_states`.
    pub fn shows(&self, time: u64) -> bool {
        time >= self.picture
    }

    /// Writes one instant, `time` nanoseconds after the start.
    ///
    /// # Errors
    /// [`RecordError::Row`] if there is not one value for each name, [`RecordError::Time`] for a time before
    /// the last one, or a failed write.
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
        let state = if sample.posture.is_some() { State::Moves } else { State::Stuck };
        let interfering = sample.posture.filter(|_| shows).map(|posture| posture.interfering);
        self.draw_change(time, (state, interfering))?;
        let log = &mut self.log;
        let write = |log: &mut Log<'_>, topic: &mut Option<JointsTopic>, values: &[f64]| match topic
        {
            Some(topic) => topic.write(log, time, values),
            None if values.is_empty() => Ok(()),
            None => Err(RecordError::Row { values: values.len(), columns: 0 }),
        };
        write(log, &mut self.pose, sample.pose)?;
        write(log, &mut self.pose_velocities, sample.pose_velocities)?;
        if self.condition.is_some() {
            self.judged.clear();
            self.judged.extend_from_slice(sample.measures);
            self.judged.push(f64::from(u8::from(sample.valid)));
            write(log, &mut self.condition, &self.judged)?;
        }
        write(log, &mut self.indices, sample.indices)?;
        let posture = sample.posture;
        let rates = posture.and_then(|posture| posture.rates);
        for (topic, values) in [
            (&mut self.dependent, posture.map(|posture| posture.dependent)),
            (&mut self.joints, posture.map(|posture| posture.joints)),
            (&mut self.imaginary, posture.map(|posture| posture.imaginary)),
            (&mut self.dependent_velocities, rates.map(|rates| rates.dependent)),
            (&mut self.velocities, rates.map(|rates| rates.velocities)),
            (&mut self.imaginary_velocities, rates.map(|rates| rates.imaginary)),
            (&mut self.accelerations, rates.map(|rates| rates.accelerations)),
        ] {
            match values {
                Some(values) => write(log, topic, values)?,
                None => topic.iter_mut().try_for_each(|topic| topic.write_unknown(log, time))?,
            }
        }
        let Some(posture) = posture.filter(|_| shows) else { return Ok(()) };
        self.picture = next;
        if let Some((topic, states)) = &mut self.states {
            states.timestamp = Some(stamp(time));
            for (i, state) in states.joints.iter_mut().enumerate() {
                state.position = posture.joints.get(i).copied();
                let rates = posture.rates;
                state.velocity = rates.and_then(|rates| rates.velocities.get(i).copied());
                state.acceleration = rates.and_then(|rates| rates.accelerations.get(i).copied());
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

    /// Writes a line to `/violations`: the motion cannot be followed at `time` nanoseconds after the start.
    ///
    /// # Errors
    /// [`RecordError::Time`] for a time before the last one, or a failed write.
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

    /// Completes the recording, which only now gets its name. `result` is the last metadata record, with
    /// `complete = "true"` added.
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
fn put<M: Encode>(
    log: &mut Log<'_>,
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
