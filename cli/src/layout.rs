//! `opm layout`: what a viewer shows of a recording.

use crate::args::{LayoutArgs, Output};
use crate::failure::Failure;
use crate::output::{Shown, is_stdout, print_with};
use crate::target::{Target, refuse_inputs};
use opm_mcap::{Layout, LayoutError, ReadError};
use std::io::Write;
use std::path::Path;

/// The programs that a layout is for.
#[derive(Clone, Copy)]
enum Viewer {
    Foxglove,
    Rerun,
}

pub fn run(args: &LayoutArgs, output: &Output) -> Result<(), Failure> {
    let target = args.output.as_deref().filter(|path| !is_stdout(path));
    let viewer = match target.map(|path| (path, path.extension().and_then(|end| end.to_str()))) {
        None | Some((_, Some("json"))) => Viewer::Foxglove,
        Some((_, Some("py"))) => Viewer::Rerun,
        Some((path, _)) => {
            let problem = format!(
                "{}: expected a name that ends in .json (Foxglove, Lichtblick) or .py (Rerun)",
                path.shown()
            );
            return Err(Failure::flag("--output", problem));
        }
    };
    if let Some(path) = target {
        refuse_inputs("--output", path, [&*args.file])?;
    }
    let label = args.file.shown();
    let layout = Layout::of(&args.file).map_err(|error| match error {
        LayoutError::Read(ReadError::Io { source, .. }) => Failure::at(&label, source),
        LayoutError::Read(error @ ReadError::NotMcap { .. }) => {
            Failure::because(format!("{label}: not an MCAP file"), error)
        }
        error => Failure::at(&label, error),
    })?;
    let text = match viewer {
        Viewer::Foxglove => layout.foxglove(),
        Viewer::Rerun => layout.rerun(&from_script(&args.file, target)),
    };
    let Some(path) = target else { return print_with(|out| out.write_all(text.as_bytes())) };
    Target::create(path)?.commit(text.as_bytes())?;
    let place = path.shown();
    match viewer {
        Viewer::Foxglove => output.note(format_args!(
            "{place}: open {label} in Foxglove or Lichtblick, then import this from the layout menu"
        )),
        Viewer::Rerun => output.note(format_args!("{place}: python {place} opens Rerun")),
    }
    Ok(())
}

/// The recording as its script names it: by its name alone if they are in one folder.
fn from_script(recording: &Path, script: Option<&Path>) -> String {
    let folder =
        |path: &Path| path.canonicalize().ok().and_then(|p| p.parent().map(Path::to_owned));
    let beside = script.map(|script| match script.parent() {
        Some(parent) if parent != Path::new("") => parent.canonicalize(),
        _ => Path::new(".").canonicalize(),
    });
    let same = folder(recording).zip(beside.and_then(Result::ok)).is_some_and(|(a, b)| a == b);
    let shown = match (same, recording.file_name()) {
        (true, Some(name)) => Path::new(name).to_owned(),
        _ => recording.canonicalize().unwrap_or_else(|_| recording.to_owned()),
    };
    shown.display().to_string()
}

/// Says how a recording is looked at; of a file of another kind, nothing.
pub fn advise(recording: &Path, output: &Output) {
    if recording.extension().is_none_or(|ending| ending != "mcap") {
        return;
    }
    let place = recording.shown();
    output.note(format_args!(
        "`opm layout {place} -o layout.json` lays it out for Foxglove and Lichtblick, `-o show.py` for Rerun"
    ));
}
