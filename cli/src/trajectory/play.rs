//! The recording of a motion.

use super::Run;
use super::summary::{MOST_LISTED, Summary, Told};
use crate::failure::Failure;
use crate::scene::{Scene, imaginary_coordinates, joint_coordinates};
use opm_core::manipulator::Manipulator;
use opm_core::skeleton;
use opm_core::trajectory::{Change, Sample};
use opm_mcap::trajectory::{Coordinate, Posture, Rates, Role, Sample as Recorded, Trajectory};
use opm_mcap::{Metadata, PartialFile, RecordError, Sink, TrajectoryRecorder};
use std::path::Path;

/// What `/condition` tells.
const MEASURES: [&str; 1] = ["condition"];

/// A recording under way.
pub struct Player<W: Sink> {
    recorder: TrajectoryRecorder<W>,
    scene: Scene,
    place: String,
    /// Of the last message, nanoseconds.
    last: u64,
}

impl Player<PartialFile> {
    /// Opens the file before the work starts, so that a wrong path costs no time.
    pub fn create(path: &Path, run: &Run<'_>) -> Result<Self, Failure> {
        let place = path.display().to_string();
        let failed = |error: RecordError| Failure::at(&place, &error);
        if path == Path::new("-") {
            return Err(Failure::flag("--output", "a recording needs a file, not standard output"));
        }
        let file = PartialFile::create(path).map_err(failed)?;
        let scene = Scene::of(run.manipulator);
        let recorder = TrajectoryRecorder::new(file, &run.recorded(&scene)).map_err(failed)?;
        Ok(Self { recorder, scene, place, last: 0 })
    }
}

impl<W: Sink> Player<W> {
    /// Records a sample, and what changed up to it.
    pub fn sample(
        &mut self,
        run: &Run<'_>,
        number: u64,
        sample: &Sample,
        changes: &[Change],
    ) -> Result<(), Failure> {
        let clock = |time: f64| ((time - run.motion.motion.start) * 1e9).round().max(0.0) as u64;
        // A sample's own stamp, free of the rounding of its time.
        let now = clock(run.motion.motion.start + number as f64 / run.rate);
        let now = now.min(clock(run.motion.motion.end())).max(self.last);
        self.record(run, now, sample, changes, clock)
            .map_err(|error| Failure::at(&self.place, &error))?;
        self.last = now;
        Ok(())
    }

    fn record(
        &mut self,
        run: &Run<'_>,
        now: u64,
        sample: &Sample,
        changes: &[Change],
        clock: impl Fn(f64) -> u64,
    ) -> Result<(), RecordError> {
        for change in changes {
            let line = match change {
                Change::Begins(violation) => Told::new(violation, run.manipulator).what(),
                // A singularity has been told when it began.
                Change::Ends(violation) if violation.is_singularity() => continue,
                Change::Ends(violation) => {
                    format!("no longer: {}", Told::new(violation, run.manipulator).si())
                }
            };
            self.recorder.mark(clock(change.time()).clamp(self.last, now), &line)?;
        }
        let Sample { instant, solution, motion, .. } = sample;
        let rates = sample.regular.then_some(Rates {
            velocities: &motion.joint_rates,
            imaginary: &motion.imaginary_rates,
            accelerations: &motion.joint_accelerations,
        });
        let (joints, imaginary) = (&solution.joints, &solution.imaginary);
        let posture = if sample.reached {
            let platform = run.manipulator.task().displacement(&instant.pose);
            let posture = skeleton::Posture { joints, imaginary, platform };
            let frames = self.scene.frames(&posture);
            Some(Posture { joints, imaginary, rates, frames })
        } else {
            None
        };
        let recorded = Recorded {
            pose: &instant.pose,
            pose_velocities: &instant.velocity,
            measures: &[sample.condition()],
            valid: sample.valid(),
            posture,
        };
        self.recorder.push(now, &recorded)
    }

    /// Completes the recording.
    pub fn finish(mut self, run: &Run<'_>, summary: &Summary) -> Result<(), Failure> {
        let mut complete = || {
            for (number, violation) in summary.violations.iter().enumerate() {
                let fields = Told::new(violation, run.manipulator).fields().into_iter();
                let record: Metadata = fields
                    .map(|(key, value)| {
                        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                        (key.to_owned(), text)
                    })
                    .collect();
                self.recorder.describe(&format!("violation.{}", number + 1), &record)?;
            }
            Ok(())
        };
        let result = record([
            ("samples", summary.samples.to_string()),
            ("valid", summary.valid.to_string()),
            ("violations", summary.violation_count.to_string()),
            ("violations_listed", summary.violations.len().min(MOST_LISTED).to_string()),
        ]);
        complete()
            .and_then(|()| self.recorder.finish(&result))
            .map_err(|error: RecordError| Failure::at(&self.place, &error))
    }
}

impl Run<'_> {
    /// What the recording is of.
    fn recorded(&self, scene: &Scene) -> Trajectory<'_> {
        let Self { loaded, motion, manipulator, mode, rate } = self;
        Trajectory {
            pose: task_coordinates(manipulator),
            joints: joint_coordinates(manipulator.mechanism()),
            imaginary: imaginary_coordinates(manipulator.imaginary()),
            rates: true,
            measures: MEASURES.map(String::from).into(),
            bodies: scene.bodies(),
            files: vec![
                (&loaded.file_name, loaded.text.as_bytes()),
                (&motion.file_name, motion.text.as_bytes()),
            ],
            run: record([
                ("command", "trajectory".to_owned()),
                ("program", format!("opm {}", env!("CARGO_PKG_VERSION"))),
                ("mechanism", manipulator.mechanism().name.clone()),
                ("mechanism_file", loaded.file_name.clone()),
                ("motion", motion.motion.name.clone()),
                ("motion_file", motion.file_name.clone()),
                ("mode", manipulator.format_mode(*mode)),
                ("start", motion.motion.start.to_string()),
                ("duration", motion.motion.duration.to_string()),
                ("rate", rate.to_string()),
            ]),
        }
    }
}

fn task_coordinates(manipulator: &Manipulator) -> Vec<Coordinate> {
    let coordinate = |c: &opm_core::task::TaskCoordinate| Coordinate {
        name: c.name.to_owned(),
        unit: c.quantity.unit(),
        role: Role::Task,
    };
    manipulator.task_coordinates().iter().map(coordinate).collect()
}

fn record<const N: usize>(pairs: [(&str, String); N]) -> Metadata {
    pairs.map(|(key, value)| (key.to_owned(), value)).into()
}
