//! `opm export`: mechanisms as models for other programs.

use crate::args::{ExportArgs, ExportFormat, MjcfArgs, Output};
use crate::failure::Failure;
use crate::load;
use crate::output::{is_stdout, print_with};
use crate::target::Target;
use opm_export::{Keyframes, MjcfOptions, Source, mjcf};
use std::io::Write;
use std::path::Path;

pub fn run(args: &ExportArgs, output: &Output) -> Result<(), Failure> {
    match &args.format {
        ExportFormat::Mjcf(args) => run_mjcf(args, output),
    }
}

fn run_mjcf(args: &MjcfArgs, output: &Output) -> Result<(), Failure> {
    let options = MjcfOptions::new(args.density, args.time_step)
        .map_err(|wrong| Failure::flag(&flag(wrong.option), wrong))?;
    let path = args.output.as_deref().filter(|path| !is_stdout(path));
    path.map_or(Ok(()), ends_in_xml)?;
    let loaded = load::open(&args.mechanism, output)?;
    if let Some(path) = path {
        loaded.refuse_as_output(path, &[])?;
    }
    let target = path.map(Target::create).transpose()?;
    let keyframes = Keyframes::of(&loaded.file.mechanism);
    let (label, count) = (&loaded.label, keyframes.reached().len());
    match keyframes.source() {
        Source::Modes | Source::Branches => {}
        Source::HomeMode => output.note(format_args!(
            "{label}: it has too many working modes for a keyframe each; home is the only one"
        )),
        Source::Home => output.note(format_args!(
            "{label}: no closed forms, so home is the only keyframe; `opm decompose` says why"
        )),
    }
    let model = mjcf(&keyframes, &options);
    match target {
        None => print_with(|out| out.write_all(model.as_bytes())),
        Some(target) => {
            target.commit(model.as_bytes())?;
            let place = path.unwrap_or(Path::new("")).display();
            let keyframes = if count == 1 { "keyframe" } else { "keyframes" };
            output.note(format_args!("{place}: {count} {keyframes}"));
            Ok(())
        }
    }
}

/// The flag of an option.
fn flag(option: &str) -> String {
    format!("--{}", option.replace('_', "-"))
}

/// MuJoCo takes the format of a file from its ending.
fn ends_in_xml(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|ending| ending == "xml") {
        return Ok(());
    }
    let problem = format!("{}: expected a name that ends in .xml", path.display());
    Err(Failure::flag("--output", problem))
}
