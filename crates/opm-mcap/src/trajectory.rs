//! The recording of a motion: where every joint is, as time goes on.
//!
//! | topic | messages |
//! |---|---|
//! | `/joints` | `opm.Joints`: a double a joint coordinate, metres and radians |
//! | `/imaginary_joints` | `opm.ImaginaryJoints`: a double an imaginary joint |
//!
//! Time starts at [`START`]; no clock is read. Metadata records: `run` (what the caller tells of the
//! run), `joints` (which joint each field is, see [`crate::joints`]), and last `result`, with
//! `complete = "true"`. The mechanism file is an attachment.

use std::path::Path;

use crate::joints::{JointsTopic, fields};
use crate::log::Log;
use crate::workspace::START;
use crate::{Metadata, PartialFile, RecordError, Sink};

/// Topic of the joints.
pub const JOINTS_TOPIC: &str = "/joints";
/// Topic of the imaginary joints.
pub const IMAGINARY_TOPIC: &str = "/imaginary_joints";

/// What a recording of a motion is of.
#[derive(Debug, Clone)]
pub struct Trajectory<'a> {
    /// Names of the joint coordinates.
    pub joints: Vec<String>,
    /// Names of the imaginary joints; without any the topic is left out.
    pub imaginary: Vec<String>,
    /// Name of the mechanism file.
    pub mechanism_name: &'a str,
    /// The mechanism file itself (TOML).
    pub mechanism: &'a [u8],
    /// The run: what moves, from where to where, version.
    pub run: Metadata,
}

/// Writes a recording of a motion. Any error is final.
pub struct TrajectoryRecorder<W: Sink = PartialFile> {
    log: Log<W>,
    joints: JointsTopic,
    imaginary: Option<JointsTopic>,
    time: u64,
}

impl TrajectoryRecorder {
    /// Starts a recording that will appear as the file `path`; see [`PartialFile`].
    ///
    /// # Errors
    /// Joints without a name of their own, or a file that cannot be written.
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
        let Trajectory { joints, imaginary, .. } = trajectory;
        let mut names = Metadata::new();
        for joints in [joints, imaginary] {
            names.extend(fields(joints)?.into_iter().zip(joints.iter().cloned()));
        }
        let mut log = Log::new(sink)?;
        log.attach(trajectory.mechanism_name, "application/toml", START, trajectory.mechanism)?;
        log.metadata("run", &trajectory.run)?;
        log.metadata("joints", &names)?;
        let joints = JointsTopic::new(&mut log, JOINTS_TOPIC, "Joints", joints)?;
        let imaginary = match &**imaginary {
            [] => None,
            some => Some(JointsTopic::new(&mut log, IMAGINARY_TOPIC, "ImaginaryJoints", some)?),
        };
        Ok(Self { log, joints, imaginary, time: 0 })
    }

    /// Writes where the joints are, `time` nanoseconds after the start.
    ///
    /// # Errors
    /// Another number of values than of joints, a time before the last one, or a failed write.
    pub fn push(
        &mut self,
        time: u64,
        joints: &[f64],
        imaginary: &[f64],
    ) -> Result<(), RecordError> {
        let result = self.try_push(time, joints, imaginary);
        if result.is_err() {
            self.log.give_up();
        }
        result
    }

    fn try_push(
        &mut self,
        time: u64,
        joints: &[f64],
        imaginary: &[f64],
    ) -> Result<(), RecordError> {
        if time < self.time {
            return Err(RecordError::Time { time, last: self.time });
        }
        self.time = time;
        let time = START.saturating_add(time);
        self.joints.write(&mut self.log, time, joints)?;
        match &mut self.imaginary {
            Some(topic) => topic.write(&mut self.log, time, imaginary),
            None if imaginary.is_empty() => Ok(()),
            None => Err(RecordError::Row { values: imaginary.len(), columns: 0 }),
        }
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
