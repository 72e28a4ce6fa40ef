//! `opm plot`: pictures of recordings.

mod choice;
mod cloud;
mod grid;
mod label;
mod layout;
mod motion;
pub mod options;
mod sized;
mod slices;
mod source;
mod traces;
mod violations;
mod workspace;

use crate::args::{Output, PlotArgs};
use crate::failure::Failure;
use crate::progress::interruptible;
use opm_mcap::{PartialFile, Sink};
use opm_plot::{Size, png, svg};
use serde_json::json;
use source::Source;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The formats of pictures.
#[derive(Clone, Copy)]
enum Ending {
    Svg,
    Png,
}

pub fn run(args: &PlotArgs, output: &Output) -> Result<(), Failure> {
    let ending = match args.output.extension().and_then(|ending| ending.to_str()) {
        Some("svg") => Ending::Svg,
        Some("png") => Ending::Png,
        _ => {
            let place = args.output.display();
            let problem = format!("{place}: expected a name that ends in .svg or .png");
            return Err(Failure::flag("--output", problem));
        }
    };
    if args.output.canonicalize().is_ok_and(|output| args.file.canonicalize().ok() == Some(output))
    {
        let problem = format!("{} is also the input", args.output.display());
        return Err(Failure::flag("--output", problem));
    }
    let target = Target::create(&args.output)?;
    let progress = interruptible()?;
    let source = Source::open(&args.file, output, &progress)?;
    if let Some(shard) = source.metadata("shard").get("shard") {
        return Err(Failure::work(format!(
            "{}: shard {shard} of a sweep, which has no points of its own; join all shards with `opm \
             merge`, and draw what it writes",
            source.label
        )));
    }
    let drawing = if source.is_workspace() {
        workspace::draw(&source, args, output)?
    } else {
        motion::draw(&source, args)?
    };
    let place = args.output.display();
    let bytes = match ending {
        Ending::Svg => svg::write(&drawing).map(String::into_bytes),
        Ending::Png => png::write(&drawing),
    };
    let bytes = bytes.map_err(|error| Failure::at(&place, error))?;
    target.commit(&bytes)?;
    if !source.recording.complete {
        let label = &source.label;
        output.warn(format_args!("{label}: unfinished; what is in it was drawn"));
    }
    let Size { width, height } = drawing.size;
    let pixels = match ending {
        Ending::Svg => [width, height],
        Ending::Png => [width, height].map(|side| (side * f64::from(png::SCALE)).round()),
    };
    output.note(format_args!("{place}: {} x {} pixels", pixels[0].round(), pixels[1].round()));
    match output.format {
        crate::args::Format::Text => Ok(()),
        crate::args::Format::Json => {
            let json = json!({
                "file": place.to_string(),
                "width": pixels[0],
                "height": pixels[1],
                "complete": source.recording.complete,
            });
            output.print(&json, "")
        }
    }
}

/// The file of the picture: opened before the work, so that a wrong path costs no time.
struct Target {
    path: PathBuf,
    file: Option<PartialFile>,
}

impl Target {
    fn create(path: &Path) -> Result<Self, Failure> {
        let file = PartialFile::create(path).map_err(|e| Failure::at(path.display(), e))?;
        Ok(Self { path: path.to_owned(), file: Some(file) })
    }

    fn commit(mut self, bytes: &[u8]) -> Result<(), Failure> {
        let Some(mut file) = self.file.take() else { return Ok(()) };
        let written = match file.write_all(bytes) {
            Ok(()) => file.commit(),
            Err(error) => {
                file.discard();
                Err(error)
            }
        };
        written.map_err(|error| Failure::at(self.path.display(), error))
    }
}

impl Drop for Target {
    /// An incomplete picture is of no use.
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            file.discard();
        }
    }
}
