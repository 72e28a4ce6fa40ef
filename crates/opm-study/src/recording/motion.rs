//! The recording of a motion.

use super::judged::Judged;
use super::scene::{Scene, imaginary_coordinates, joint_coordinates};
use super::{Attachment, PROGRAM, create, expect_mcap, record};
use crate::error::StudyError;
use crate::motion::{Driven, MOST_LISTED, MotionRequest, MotionSummary};
use opm_core::manipulator::{Manipulator, Solution};
use opm_core::motion::Path as MotionPath;
use opm_core::skeleton;
use opm_core::task::TaskCoordinate;
use opm_core::trajectory::{Change, Sample, Trajectory, Violation, ViolationReport};
use opm_interference::{Distances, Interference};
use opm_mcap::trajectory::{Coordinate, Posture, Rates, Role, Sample as Recorded};
use opm_mcap::{Metadata, RecordError, TrajectoryRecorder};
use serde_json::{Value, json};
use std::path::Path;

/// A recording of a motion that is being written.
pub struct MotionRecorder<'a> {
    request: MotionRequest<'a>,
    recorder: TrajectoryRecorder<'static>,
    scene: Scene,
    place: String,
    /// The time of the last message, nanoseconds.
    last: u64,
    /// Whether the upper and the lower section have a parallel singularity measure.
    parallel: [bool; 2],
    measures: Vec<f64>,
    /// What the poses are judged by, if that is recorded.
    judged: Option<Judged<'a>>,
    /// The efforts that move it, if they are recorded.
    driven: Option<Driven<'a>>,
    /// The values of both.
    indices: Vec<f64>,
    /// The pairs of bodies, if contacts are watched for.
    interference: Option<Interference>,
    /// The numbers of the scene's bodies that interfere at the present sample.
    interfering: Vec<usize>,
}

impl<'a> MotionRecorder<'a> {
    /// Opens the file before the work starts, so that a wrong path costs no time. `files` are the files of
    /// the mechanism and of the motion.
    ///
    /// # Errors
    /// The file name is not that of an MCAP file, or the file cannot be written.
    pub fn create(
        path: &Path,
        request: MotionRequest<'a>,
        files: [Attachment<'_>; 2],
    ) -> Result<Self, StudyError> {
        expect_mcap(path, "the recording of a motion")?;
        let place = path.display().to_string();
        let file = create(path)?;
        let scene = Scene::of(request.manipulator);
        let parallel = parallel(request.manipulator);
        let manipulator = request.manipulator;
        let judged = Judged::of(&request);
        let driven = request.efforts.map(|setup| Driven::new(manipulator, setup));
        let names = judged.iter().flat_map(Judged::columns);
        let names = names.map(|(name, unit)| (name.to_owned(), unit));
        let efforts = driven.iter().flat_map(|_| Driven::columns(manipulator));
        let mut recorded = recorded(&request, files, &scene, parallel);
        recorded.indices = efforts.chain(names).collect();
        let recorder = TrajectoryRecorder::new(file, &recorded);
        let recorder = recorder.map_err(|error| StudyError::record(&place, error))?;
        let interference =
            request.clearance.map(|_| Interference::new(request.manipulator.mechanism()));
        let (last, measures, interfering) = (0, Vec::new(), Vec::new());
        Ok(Self {
            request,
            recorder,
            scene,
            place,
            last,
            parallel,
            measures,
            judged,
            driven,
            indices: Vec::new(),
            interference,
            interfering,
        })
    }

    /// Follows the motion from end to end, and completes the recording: see [`MotionRequest::follow`].
    ///
    /// # Errors
    /// A pose is not finite, the file cannot be written, or the work was cancelled.
    pub fn follow(
        mut self,
        trajectory: Trajectory<'_>,
        go_on: impl Fn(u64) -> bool,
    ) -> Result<MotionSummary, StudyError> {
        let request = self.request;
        let take =
            |number, sample: &Sample, changes: &[Change]| self.sample(number, sample, changes);
        let summary = request.follow(trajectory, take, go_on)?;
        self.finish(&summary)?;
        Ok(summary)
    }

    /// Finds the bodies that interfere in a solution.
    fn find_interfering(&mut self, solution: &Solution) {
        self.interfering.clear();
        let Some((interference, clearance)) =
            self.interference.as_ref().zip(self.request.clearance)
        else {
            return;
        };
        let mut distances = Distances::new(interference);
        distances.place(self.request.manipulator, solution);
        for near in distances.nearer_than(clearance) {
            let members = interference.members_of(near.pair);
            self.interfering.extend(members.map(|member| self.scene.body_of(member)));
        }
        self.interfering.sort_unstable();
        self.interfering.dedup();
    }

    /// Records a sample, and the transitions up to it.
    fn sample(
        &mut self,
        number: u64,
        sample: &Sample,
        changes: &[Change],
    ) -> Result<(), StudyError> {
        let MotionRequest { motion, rate, .. } = self.request;
        let clock = |time: f64| ((time - motion.start) * 1e9).round().max(0.0) as u64;
        // The stamp is computed from the sample's number, so that it is free of the rounding of the time.
        let now = clock(motion.start + number as f64 / rate);
        let now = now.min(clock(motion.end())).max(self.last);
        self.record(now, sample, changes, clock)
            .map_err(|error| StudyError::record(&self.place, error))?;
        self.last = now;
        Ok(())
    }

    fn record(
        &mut self,
        now: u64,
        sample: &Sample,
        changes: &[Change],
        clock: impl Fn(f64) -> u64,
    ) -> Result<(), RecordError> {
        let manipulator = self.request.manipulator;
        for change in changes {
            let line = match change {
                Change::Begins(violation) => ViolationReport::new(violation, manipulator).what(),
                // A singularity is recorded when it begins.
                Change::Ends(violation) if violation.is_singularity() => continue,
                Change::Ends(violation) => {
                    format!("no longer: {}", ViolationReport::new(violation, manipulator).si())
                }
            };
            self.recorder.mark(clock(change.time()).clamp(self.last, now), &line)?;
        }
        let Sample { instant, solution, motion, .. } = sample;
        let rates = sample.regular.then_some(Rates {
            dependent: &motion.dependent_rates,
            velocities: &motion.joint_rates,
            imaginary: &motion.imaginary_rates,
            accelerations: &motion.joint_accelerations,
        });
        let (joints, imaginary) = (&solution.joints(), &solution.imaginary());
        let posture = if sample.reached {
            if self.recorder.shows(now) {
                self.find_interfering(solution);
            }
            let frames = if self.recorder.shows(now) {
                let platform = solution.displacement(manipulator);
                self.scene.frames(&skeleton::Configuration { joints, imaginary, platform })
            } else {
                &[]
            };
            let dependent = solution.dependent();
            let interfering = &self.interfering;
            Some(Posture { dependent, joints, imaginary, rates, frames, interfering })
        } else {
            None
        };
        self.measures.clear();
        self.measures.push(sample.condition);
        for (parallel, measures) in self.parallel.into_iter().zip([sample.upper, sample.lower]) {
            // Out of reach the measures are not defined; plots show a gap.
            let defined = |measure: f64| if sample.reached { measure } else { f64::NAN };
            self.measures.push(defined(measures.serial));
            if parallel {
                self.measures.push(defined(measures.parallel.unwrap_or_default()));
            }
        }
        let at = sample.reached.then_some(solution);
        self.indices.clear();
        if let Some(driven) = &mut self.driven {
            self.indices.extend(driven.values(sample));
        }
        if let Some(judged) = &mut self.judged {
            self.indices.extend(judged.values(at));
        }
        let recorded = Recorded {
            pose: &instant.pose,
            pose_velocities: &instant.velocity,
            measures: &self.measures,
            indices: &self.indices,
            valid: sample.valid(),
            posture,
        };
        self.recorder.push(now, &recorded)
    }

    /// Completes the recording.
    fn finish(mut self, summary: &MotionSummary) -> Result<(), StudyError> {
        let manipulator = self.request.manipulator;
        let mut complete = || {
            for (number, violation) in summary.violations.iter().enumerate() {
                let fields =
                    violation_fields(&ViolationReport::new(violation, manipulator)).into_iter();
                let record: Metadata = fields
                    .map(|(key, value)| {
                        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
                        (key.to_owned(), text)
                    })
                    .collect();
                self.recorder.describe(&format!("violation.{}", number + 1), &record)?;
            }
            for (number, contact) in contacts(summary).take(MOST_LISTED).enumerate() {
                self.recorder.describe(&format!("interference.{}", number + 1), &contact)?;
            }
            Ok(())
        };
        let result = record([
            ("samples", summary.samples.to_string()),
            ("valid", summary.valid.to_string()),
            ("violations", summary.violation_count.to_string()),
            ("interferences", contacts(summary).count().to_string()),
            ("violations_listed", summary.violations.len().min(MOST_LISTED).to_string()),
        ]);
        complete()
            .and_then(|()| self.recorder.finish(&result))
            .map_err(|error: RecordError| StudyError::record(&self.place, error))
    }
}

/// The contacts of a motion as metadata.
fn contacts(summary: &MotionSummary) -> impl Iterator<Item = Metadata> + '_ {
    let all = summary.contacts.iter();
    all.flat_map(|of| of.contacts.iter().map(move |contact| (of, contact))).map(|(of, contact)| {
        let [one, other] = of.interference.names_of(contact.pair);
        record([
            ("one", one.to_owned()),
            ("other", other.to_owned()),
            ("start", contact.start.to_string()),
            ("end", contact.end.to_string()),
            ("worst", contact.worst.to_string()),
            ("distance", contact.distance.to_string()),
        ])
    })
}

/// The description of the recorded motion.
fn recorded<'a>(
    request: &MotionRequest<'_>,
    files: [Attachment<'a>; 2],
    scene: &Scene,
    parallel: [bool; 2],
) -> opm_mcap::Trajectory<'a> {
    let MotionRequest { manipulator, motion, mode, rate, .. } = *request;
    let [mechanism_file, motion_file] = files;
    let timing = match &motion.path {
        // Lines and arcs have feed rates.
        MotionPath::Timed(timed) if !matches!(*timed.path, MotionPath::Moves(_)) => "time-optimal",
        _ => "as given",
    };
    opm_mcap::Trajectory {
        pose: task_coordinates(manipulator.task_coordinates(), Role::Task),
        dependent: task_coordinates(manipulator.dependent_coordinates(), Role::Dependent),
        joints: joint_coordinates(manipulator.mechanism()),
        imaginary: imaginary_coordinates(manipulator.imaginary()),
        rates: true,
        measures: measures(parallel),
        indices: Vec::new(),
        bodies: scene.bodies(),
        files: files.map(|file| (file.name, file.text.as_bytes())).to_vec(),
        run: record([
            ("command", "trajectory".to_owned()),
            ("program", PROGRAM.to_owned()),
            ("mechanism", manipulator.mechanism().name.clone()),
            ("mechanism_file", mechanism_file.name.to_owned()),
            ("motion", motion.name.clone()),
            ("motion_file", motion_file.name.to_owned()),
            ("mode", manipulator.format_mode(mode)),
            ("start", motion.start.to_string()),
            ("duration", motion.duration.to_string()),
            ("rate", rate.to_string()),
            ("timing", timing.to_owned()),
        ]),
    }
}

/// Keys and values of a violation, the same in JSON and in a recording.
pub fn violation_fields(report: &ViolationReport<'_>) -> Vec<(&'static str, Value)> {
    let Violation { start, end, worst, amount, .. } = *report.violation;
    let mut fields = vec![
        ("kind", json!(report.kind)),
        ("start", json!(start)),
        ("end", json!(end)),
        ("worst", json!(worst)),
        ("amount", json!(amount)),
        ("unit", json!(report.unit())),
    ];
    let words = [
        ("leg", report.leg.map(String::from)),
        ("joint", report.joint.map(String::from)),
        ("section", report.section.map(|section| section.to_string())),
        ("bound", report.bound.map(|bound| bound.name().to_owned())),
        ("singularity", report.singularity().map(String::from)),
    ];
    fields.extend(words.into_iter().filter_map(|(key, word)| Some((key, json!(word?)))));
    fields
}

/// The names of the measures in `/condition`, in the order in which a [`MotionRecorder`] collects them.
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

/// Whether the upper and the lower section have at least as many inputs as freedoms.
fn parallel(manipulator: &Manipulator) -> [bool; 2] {
    let mut measured = manipulator.singularities();
    manipulator.measure_singularities(&manipulator.jacobians(), &mut measured);
    [measured.upper, measured.lower].map(|measures| measures.parallel.is_some())
}

fn task_coordinates(list: &[TaskCoordinate], role: Role) -> Vec<Coordinate> {
    let coordinate =
        |c: &TaskCoordinate| Coordinate { name: c.name.to_owned(), unit: c.quantity.unit(), role };
    list.iter().map(coordinate).collect()
}
