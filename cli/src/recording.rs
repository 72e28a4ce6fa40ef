//! Recordings for the Python package, by what records for the program: the same run gives the same
//! bytes.

use crate::args::CloudArgs;
use crate::cloud::{Cloud, Wishes};
use crate::failure::Failure;
use crate::kind::{Kind, Questions, SetRecording, SetWishes, Study};
use crate::load::{self, Loaded};
use crate::motion::LoadedMotion;
use crate::record::Recorder;
use crate::source::Source;
use crate::trajectory;
use crate::workspace::Run;
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::motion::Motion;
use opm_workspace::{Count, Grid, Modes, Progress, Sections};
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
    /// Over which poses.
    pub grid: &'a Grid,
    /// In which working modes.
    pub modes: Modes,
    /// What was found.
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

/// Records the points of a sweep, as `opm workspace -o` does: in the format that the file's name ends
/// in. A sweep of one section alone is what `--kind upper` or `lower` is.
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
    let record = match swept.grid.sections() {
        Sections::Whole => record_poses(swept, &args, path, progress),
        Sections::Upper => record_section(swept, Kind::Upper, &args, path, progress),
        Sections::Lower => record_section(swept, Kind::Lower, &args, path, progress),
    };
    record.map_err(told)
}

impl<'a> Swept<'a> {
    fn load(&self) -> Result<Loaded, Failure> {
        let Attached { name, text } = self.mechanism;
        load::attached(name, name, text)
    }

    /// As the program knows it.
    fn run<'b>(&self, loaded: &'b Loaded, kind: Kind) -> Run<'b>
    where
        'a: 'b,
    {
        let Self { manipulator, grid, modes, .. } = *self;
        Run { loaded, manipulator, kind, grid, modes, limit: None, conditioning: None }
    }
}

fn record_poses(
    swept: &Swept<'_>,
    args: &CloudArgs,
    path: &Path,
    progress: &Progress,
) -> Result<(), Failure> {
    let Swept { manipulator, grid, found, .. } = *swept;
    let loaded = swept.load()?;
    let run = swept.run(&loaded, Kind::Grid);
    let wishes = Wishes::new(args, manipulator.characteristic_length(), manipulator)?;
    Recorder::check(path, grid)?;
    let (recorder, cloud) = (Recorder::create(path)?, Cloud::new(wishes, &run));
    recorder.record(&run, &cloud, &Source::Sweep(run.sweep()), found, None, progress)?;
    Ok(())
}

fn record_section(
    swept: &Swept<'_>,
    kind: Kind,
    args: &CloudArgs,
    path: &Path,
    progress: &Progress,
) -> Result<(), Failure> {
    let loaded = swept.load()?;
    let run = swept.run(&loaded, kind);
    let wishes = SetWishes::new(kind, args, swept.manipulator)?;
    Recorder::check_set(path, &kind.name())?;
    let recorder = Recorder::create(path)?;
    let study = Study::new(Questions { kind, shape: true }, &Source::Sweep(run.sweep()), progress)?;
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
            Some(of_the_path) => of_the_path.replace("--kind", "section"),
            None => message.replace("--kind", "section").replace("--", ""),
        },
        Failure::Work(message) | Failure::Interrupted(message) => message,
        Failure::Closed => "nobody reads what is written".to_owned(),
    }
}
