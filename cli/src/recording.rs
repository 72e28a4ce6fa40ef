//! Recordings for the Python package, by what records for the program: the same run gives the same
//! bytes.

pub use crate::kind::Kind;

use crate::args::CloudArgs;
use crate::cloud::{Cloud, Wishes};
use crate::failure::Failure;
use crate::kind::{Questions, SetRecording, SetWishes, Study};
use crate::load::{self, Loaded};
use crate::motion::LoadedMotion;
use crate::record::Recorder;
use crate::source::Source;
use crate::trajectory;
use crate::workspace::Run;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::motion::Motion;
use opm_workspace::{ConditionLimit, Count, Grid, Modes, Progress};
use std::path::Path;
use std::sync::atomic::AtomicU64;

/// A file that goes into a recording.
#[derive(Clone, Copy, Debug)]
pub struct Attached<'a> {
    /// Its own name, without folders.
    pub name: &'a str,
    /// What is in it.
    pub text: &'a str,
}

/// A sweep that was counted.
#[derive(Clone, Copy, Debug)]
pub struct Swept<'a> {
    /// The file of the mechanism.
    pub mechanism: Attached<'a>,
    /// What was swept.
    pub manipulator: &'a Manipulator,
    /// What the workspace is of.
    pub kind: Kind,
    /// Over which poses.
    pub grid: &'a Grid,
    /// In which working modes.
    pub modes: Modes,
    /// How well conditioned poses have to be.
    pub limit: Option<ConditionLimit>,
    /// Characteristic length of condition numbers, metres.
    pub length: f64,
    /// What was found: of a set that is not of poses, its points.
    pub found: &'a Count,
}

/// What the points of a cloud show, each as the flag of its name; what is not given suits the grid.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// Three task coordinates, or `tip`; none if not given.
    pub axes: Vec<String>,
    /// Values stored with every point.
    pub scalars: Option<Vec<String>>,
    /// What the colour shows.
    pub color: Option<String>,
}

/// Refuses what is no workspace of a kind: a grid that it is not of, a limit on a condition number that there
/// is not, modes or a mechanism in which it has no meaning.
///
/// # Errors
/// What is wrong, by the flag's name without dashes.
pub fn check(
    kind: Kind,
    manipulator: &Manipulator,
    grid: &Grid,
    modes: Modes,
    limit: Option<ConditionLimit>,
) -> Result<(), String> {
    kind.check_run(manipulator, modes, limit).and_then(|()| kind.check(grid)).map_err(told)
}

/// Records the points of a sweep, as `opm workspace -o` does: in the format that the file's name ends
/// in.
///
/// # Errors
/// What was asked for and there is not, by the flag's name without dashes; a file that cannot be
/// written; that it was cancelled.
pub fn record_sweep(
    swept: &Swept<'_>,
    shown: Shown,
    path: &Path,
    progress: &Progress,
) -> Result<(), String> {
    let Shown { axes, scalars, color } = shown;
    let args = CloudArgs { output: None, axes, color, scalars };
    let record = match swept.kind.is_of_poses() {
        true => record_poses(swept, &args, path, progress),
        false => record_set(swept, &args, path, progress),
    };
    record.map_err(told)
}

impl<'a> Swept<'a> {
    fn load(&self) -> Result<Loaded, Failure> {
        let Attached { name, text } = self.mechanism;
        load::attached(name, name, text)
    }

    /// As the program knows it.
    fn run<'b>(&self, loaded: &'b Loaded) -> Run<'b>
    where
        'a: 'b,
    {
        let Self { manipulator, kind, grid, modes, limit, .. } = *self;
        Run { loaded, manipulator, kind, grid, modes, limit, conditioning: None }
    }
}

/// The shape of a set, by sweeping.
fn shape(run: &Run<'_>, progress: &Progress) -> Result<Study, Failure> {
    let questions = Questions { kind: run.kind, shape: true };
    Study::new(questions, &Source::Sweep(run.sweep()), progress)
}

fn record_poses(
    swept: &Swept<'_>,
    args: &CloudArgs,
    path: &Path,
    progress: &Progress,
) -> Result<(), Failure> {
    let Swept { manipulator, grid, found, length, .. } = *swept;
    let loaded = swept.load()?;
    let run = swept.run(&loaded);
    let wishes = Wishes::new(args, length, manipulator)?;
    Recorder::check(path, grid)?;
    let (recorder, cloud) = (Recorder::create(path)?, Cloud::new(wishes, &run));
    // As without --shape.
    let study = if run.kind == Kind::Grid { None } else { Some(shape(&run, progress)?) };
    let source = Source::Sweep(run.sweep());
    recorder.record(&run, &cloud, &source, found, study.as_ref(), progress)?;
    Ok(())
}

fn record_set(
    swept: &Swept<'_>,
    args: &CloudArgs,
    path: &Path,
    progress: &Progress,
) -> Result<(), Failure> {
    let loaded = swept.load()?;
    let run = swept.run(&loaded);
    let wishes = SetWishes::new(run.kind, args, swept.manipulator)?;
    Recorder::check_set(path, &run.kind.name())?;
    let recorder = Recorder::create(path)?;
    let study = shape(&run, progress)?;
    recorder.record_set(&run, &SetRecording::new(wishes, &run, &study)?, swept.found, progress)?;
    Ok(())
}

/// A motion that is followed.
#[derive(Clone, Copy, Debug)]
pub struct Followed<'a> {
    /// The file of the mechanism.
    pub mechanism: Attached<'a>,
    /// The file of the motion.
    pub motion_file: Attached<'a>,
    /// What follows.
    pub manipulator: &'a Manipulator,
    /// What is followed.
    pub motion: &'a Motion,
    /// In which working mode.
    pub mode: Mode,
    /// Samples a second.
    pub rate: f64,
}

/// Records a motion, as `opm trajectory -o` does.
///
/// # Errors
/// A file that cannot be written, a motion that is too long, poses that cannot be computed with; that
/// it was cancelled.
pub fn record_motion(
    followed: &Followed<'_>,
    path: &Path,
    cancelled: impl Fn() -> bool,
) -> Result<(), String> {
    let Followed { mechanism, motion_file, manipulator, motion, mode, rate } = *followed;
    let loaded = load::attached(mechanism.name, mechanism.name, mechanism.text).map_err(told)?;
    let motion = LoadedMotion {
        label: motion_file.name.to_owned(),
        file_name: motion_file.name.to_owned(),
        path: None,
        text: motion_file.text.to_owned(),
        motion: motion.clone(),
    };
    let run = trajectory::Run { loaded: &loaded, motion: &motion, manipulator, mode, rate };
    run.record(path, &AtomicU64::new(0), cancelled).map_err(told)
}

/// The message of a failure, with names of options instead of flags.
fn told(failure: Failure) -> String {
    match failure {
        Failure::Usage(message) => match message.strip_prefix("--output: ") {
            Some(of_the_path) => of_the_path.replace("--kind", "kind"),
            None => message.replace("--max-condition", "max_condition").replace("--", ""),
        },
        Failure::Work(message) | Failure::Interrupted(message) => message,
        Failure::Closed => "nobody reads what is written".to_owned(),
    }
}
