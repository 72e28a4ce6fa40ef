//! `opm plot`: pictures of recordings.

mod choice;
mod cloud;
mod layout;
mod motion;
mod slices;
mod source;
mod traces;
mod violations;
mod workspace;

use crate::args::{Output, PlotArgs};
use crate::failure::Failure;
use crate::pose::Misread;
use crate::progress::interruptible;
use clap::ValueEnum;
use opm_mcap::{PartialFile, Sink};
use opm_plot::{Drawing, Size, TooSmall, png, svg};
use serde_json::json;
use source::Source;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What `--panels` names: what is drawn, and of a motion what of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum PanelName {
    /// Task coordinates over time
    Pose,
    /// Imaginary joints: over time, or the values that they take in a workspace
    Imaginary,
    /// Actuated joints over time
    Actuated,
    /// Passive joints over time
    Passive,
    /// Condition number and singularity measures over time
    Condition,
    /// Of a motion: positions
    Positions,
    /// Of a motion: velocities, in a second column
    Velocities,
    /// Of a motion: accelerations, in a further column
    Accelerations,
    /// Slices of a workspace
    Slices,
}

impl PanelName {
    /// As it is given.
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// What `--size` gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureSize(Size);

impl FromStr for PictureSize {
    type Err = Misread;

    fn from_str(text: &str) -> Result<Self, Misread> {
        const MOST: u32 = opm_plot::MOST as u32;
        let sides = text.split_once(['x', 'X', '×']);
        let side = |side: &str| side.trim().parse().ok().filter(|side| (1..=MOST).contains(side));
        match sides.map(|(width, height)| (side(width), side(height))) {
            Some((Some(width), Some(height))) => {
                Ok(Self(Size { width: width.into(), height: height.into() }))
            }
            _ => Err(Misread::new(format!(
                "{text:?}, expected width and height up to {MOST} pixels, for example 900x600"
            ))),
        }
    }
}

/// The formats.
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
        return Err(Failure::Work(format!(
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
    let bytes = bytes.map_err(|error| Failure::at(&place, &error))?;
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

/// Turns a figure into a picture of the size asked for.
fn drawn(
    args: &PlotArgs,
    draw: impl FnOnce(Option<Size>) -> Result<Drawing, TooSmall>,
) -> Result<Drawing, Failure> {
    draw(args.size.map(|size| size.0)).map_err(|error| match args.size {
        Some(PictureSize(Size { width, height })) => {
            Failure::flag("--size", format!("{width}x{height}: {error}"))
        }
        None => Failure::Work(format!("{error}; choose fewer with --panels or --values")),
    })
}

/// The file of the picture: opened before the work, so that a wrong path costs no time.
struct Target {
    path: PathBuf,
    file: Option<PartialFile>,
}

impl Target {
    fn create(path: &Path) -> Result<Self, Failure> {
        let file = PartialFile::create(path).map_err(|e| Failure::at(path.display(), &e))?;
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
        written.map_err(|error| Failure::at(self.path.display(), &error))
    }
}

impl Drop for Target {
    /// Half a picture is of no use.
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            file.discard();
        }
    }
}
