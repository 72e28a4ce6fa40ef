//! `opm export`: mechanisms as models for other programs.

use crate::args::{ExportArgs, ExportFormat, MjcfArgs, Output, UrdfArgs};
use crate::failure::Failure;
use crate::load::{self, Loaded};
use crate::motion::{self, LoadedMotion, Reading};
use crate::output::{Shown, is_stdout, print_with};
use crate::target::{Target, ends_in};
use crate::text::plural;
use opm_core::skeleton::{Density, OutOfRange};
use opm_export::{Keyframes, MjcfOptions, MjcfReference, Source, mjcf, urdf};
use opm_study::MotionRequest;
use std::io::Write;
use std::path::{Path, PathBuf};

pub fn run(args: &ExportArgs, output: &Output) -> Result<(), Failure> {
    match &args.format {
        ExportFormat::Mjcf(args) => run_mjcf(args, output),
        ExportFormat::Urdf(args) => run_urdf(args, output),
    }
}

fn run_mjcf(args: &MjcfArgs, output: &Output) -> Result<(), Failure> {
    let options = Density::new(args.density)
        .and_then(|density| MjcfOptions::new(density, args.time_step))
        .map_err(out_of_range)?;
    let path = args.output.as_deref().filter(|path| !is_stdout(path));
    // MuJoCo takes the format of a file from its ending.
    path.map_or(Ok(()), |path| ends_in(path, &["xml"]))?;
    let loaded = load::open(&args.mechanism, output)?;
    warn_of_differences(&loaded, output);
    let Some(motion) = &args.trajectory else {
        if let Some(flag) = args.table.given() {
            return Err(Failure::flag(flag, "nothing uses it; --trajectory does"));
        }
        let keyframes = Keyframes::of(&loaded.file.mechanism);
        note_source(&loaded, &keyframes, output);
        let note = plural(keyframes.reached().len() as u64, "keyframe");
        let files = Files { model: (path, mjcf(&keyframes, &options)), beside: None };
        return files.write(&loaded, &[], &note, output);
    };
    let Some(path) = path else {
        let problem = "it is written beside the model; give that a file with --output";
        return Err(Failure::flag("--trajectory", problem));
    };
    let manipulator = loaded.compile()?;
    let reading = Reading { ends: None, table: &args.table };
    let motion = motion::open(motion, &reading, (&loaded, &manipulator))?;
    motion.note_doubts(output);
    let request = MotionRequest::new(&manipulator, &motion.motion, &motion.label);
    let trajectory = request.rate(options.time_step().recip()).trajectory()?;
    let reference = MjcfReference::new(&manipulator, trajectory)
        .map_err(|error| Failure::at(&motion.label, error))?;
    let keyframes = Keyframes::of_manipulator(&manipulator).with_start(&reference);
    note_source(&loaded, &keyframes, output);
    let rows = plural(reference.len() as u64, "time step");
    let note = format!("{}, {rows}", plural(keyframes.reached().len() as u64, "keyframe"));
    let beside = Some((path.with_extension("csv"), reference.csv()));
    let files = Files { model: (Some(path), mjcf(&keyframes, &options)), beside };
    let inputs: Vec<&Path> = motion_path(&motion).collect();
    files.write(&loaded, &inputs, &note, output)
}

fn run_urdf(args: &UrdfArgs, output: &Output) -> Result<(), Failure> {
    let density = Density::new(args.density).map_err(out_of_range)?;
    let path = args.output.as_deref().filter(|path| !is_stdout(path));
    path.map_or(Ok(()), |path| ends_in(path, &["urdf"]))?;
    let loaded = load::open(&args.mechanism, output)?;
    warn_of_differences(&loaded, output);
    let model = urdf(&loaded.file.mechanism, density);
    let legs = loaded.file.mechanism.legs.len() as u64;
    let note = plural(legs - 1, "closure");
    let beside = path.map(|path| (path.with_extension("yaml"), model.closures));
    Files { model: (path, model.tree), beside }.write(&loaded, &[], &note, output)
}

/// What is written: a model, to standard output if it has no path, and a file beside it.
struct Files<'a> {
    model: (Option<&'a Path>, String),
    beside: Option<(PathBuf, String)>,
}

impl Files<'_> {
    /// Writes them all, or none if one of them cannot be made.
    fn write(
        self,
        loaded: &Loaded,
        inputs: &[&Path],
        note: &str,
        output: &Output,
    ) -> Result<(), Failure> {
        let (path, model) = self.model;
        let Some(path) = path else {
            return print_with(|out| out.write_all(model.as_bytes()));
        };
        let files = [Some((path.to_owned(), model)), self.beside];
        let files: Vec<_> = files.into_iter().flatten().collect();
        for (path, _) in &files {
            loaded.refuse_as_output(path, inputs)?;
        }
        // A file beside a model that is not there yet is somebody else's.
        if let Some((beside, _)) = files.get(1)
            && beside.exists()
            && !path.exists()
        {
            let problem = format!(
                "{}, which goes beside it, is there already: expected another name",
                beside.shown()
            );
            return Err(Failure::flag("--output", problem));
        }
        let targets: Result<Vec<_>, _> =
            files.iter().map(|(path, _)| Target::create(path)).collect();
        let texts = files.iter().map(|(_, text)| text.as_bytes());
        Target::commit_all(targets?.into_iter().zip(texts))?;
        let names: Vec<_> = files.iter().map(|(path, _)| path.shown()).collect();
        output.note(format_args!("{}: {note}", names.join(", ")));
        Ok(())
    }
}

/// Warns of limits that models do not have.
fn warn_of_differences(loaded: &Loaded, output: &Output) {
    let differences = loaded.file.mechanism.joint_differences().unwrap_or_default();
    if !differences.is_empty() {
        let names: Vec<_> = differences.iter().map(|difference| &*difference.name).collect();
        output.warn(format_args!(
            "{}: the model has no limits of differences of joints ({})",
            loaded.label,
            names.join(", ")
        ));
    }
}

/// Says why there are few keyframes.
fn note_source(loaded: &Loaded, keyframes: &Keyframes<'_>, output: &Output) {
    let label = &loaded.label;
    match keyframes.source() {
        Source::Modes | Source::Branches => {}
        Source::HomeMode => output.note(format_args!(
            "{label}: it has too many working modes for a keyframe each; home is the only one"
        )),
        Source::Home => output.note(format_args!(
            "{label}: no closed forms, so home is the only keyframe; `opm decompose` says why"
        )),
    }
}

fn motion_path(motion: &LoadedMotion) -> impl Iterator<Item = &Path> {
    motion.path.as_deref().into_iter()
}

fn out_of_range(wrong: OutOfRange) -> Failure {
    Failure::flag(&format!("--{}", wrong.option.replace('_', "-")), wrong)
}
