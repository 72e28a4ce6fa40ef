//! The recording of a motion.

use super::Run;
use super::summary::{MOST_LISTED, Summary, fields};
use crate::failure::Failure;
use crate::record::expect_mcap;
use crate::scene::{Scene, imaginary_coordinates, joint_coordinates};
use opm_core::manipulator::Manipulator;
use opm_core::skeleton;
use opm_core::trajectory::{Change, Sample, Told};
use opm_mcap::trajectory::{Coordinate, Posture, Rates, Role, Sample as Recorded, Trajectory};
use opm_mcap::{Metadata, PartialFile, RecordError, Sink, TrajectoryRecorder};
use std::path::Path;

/// A recording under way.
pub struct Player<W: Sink> {
    recorder: TrajectoryRecorder<W>,
    scene: Scene,
    place: String,
    /// Of the last message, nanoseconds.
    last: u64,
    /// Whether the upper and the lower section have a parallel singularity measure.
    parallel: [bool; 2],
    measures: Vec<f64>,
}

impl Player<PartialFile> {
    /// Opens the file before the work starts, so that a wrong path costs no time.
    pub fn create(path: &Path, run: &Run<'_>) -> Result<Self, Failure> {
        expect_mcap(path, "the recording of a motion")?;
        let place = path.display().to_string();
        let failed = |error: RecordError| Failure::at(&place, &error);
        let file = PartialFile::create(path).map_err(failed)?;
        let scene = Scene::of(run.manipulator);
        let parallel = parallel(run.manipulator);
        let recorded = run.recorded(&scene, parallel);
        let recorder = TrajectoryRecorder::new(file, &recorded).map_err(failed)?;
        Ok(Self { recorder, scene, place, last: 0, parallel, measures: Vec::new() })
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
            let frames = if self.recorder.shows(now) {
                let platform = run.manipulator.task().displacement(&instant.pose);
                self.scene.frames(&skeleton::Posture { joints, imaginary, platform })
            } else {
                &[]
            };
            Some(Posture { joints, imaginary, rates, frames })
        } else {
            None
        };
        self.measures.clear();
        self.measures.push(sample.condition);
        for (parallel, measures) in self.parallel.into_iter().zip([sample.upper, sample.lower]) {
            // Out of reach there is nothing to measure: a gap for whoever plots it.
            let told = |measure: f64| if sample.reached { measure } else { f64::NAN };
            self.measures.push(told(measures.serial));
            if parallel {
                self.measures.push(told(measures.parallel.unwrap_or_default()));
            }
        }
        let recorded = Recorded {
            pose: &instant.pose,
            pose_velocities: &instant.velocity,
            measures: &self.measures,
            valid: sample.valid(),
            posture,
        };
        self.recorder.push(now, &recorded)
    }

    /// Completes the recording.
    pub fn finish(mut self, run: &Run<'_>, summary: &Summary) -> Result<(), Failure> {
        let mut complete = || {
            for (number, violation) in summary.violations.iter().enumerate() {
                let fields = fields(&Told::new(violation, run.manipulator)).into_iter();
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
    fn recorded(&self, scene: &Scene, parallel: [bool; 2]) -> Trajectory<'_> {
        let Self { loaded, motion, manipulator, mode, rate } = self;
        Trajectory {
            pose: task_coordinates(manipulator),
            joints: joint_coordinates(manipulator.mechanism()),
            imaginary: imaginary_coordinates(manipulator.imaginary()),
            rates: true,
            measures: measures(parallel),
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

/// What `/condition` tells: what a [`Player`] gathers, by name.
fn measures(parallel: [bool; 2]) -> Vec<String> {
    let mut names = vec!["condition".to_owned()];
    for (parallel, section) in parallel.into_iter().zip(["upper", "lower"]) {
        names.push(format!("{section}_serial"));
        if parallel {
            names.push(format!("{section}_parallel"));
        }
    }
    names
}

/// Which of the sections, upper and lower, have as many inputs as motions, or more.
fn parallel(manipulator: &Manipulator) -> [bool; 2] {
    let mut measured = manipulator.singularities();
    manipulator.measure_singularities(&manipulator.jacobians(), &mut measured);
    [measured.upper, measured.lower].map(|measures| measures.parallel.is_some())
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
