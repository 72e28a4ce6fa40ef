//! `opm plot`: pictures of mechanisms and of recordings.

mod choice;
mod cloud;
mod demand;
pub mod ending;
mod grid;
mod inscribed;
mod label;
mod layout;
pub mod mechanism;
mod motion;
pub mod options;
mod singular;
mod sized;
mod slices;
mod source;
mod titles;
mod traces;
mod violations;
mod workspace;

use crate::args::{Format, Output, PlotArgs};
use crate::failure::Failure;
use crate::output::{Shown, is_stdout, print_with};
use crate::progress::interruptible;
use crate::target::{Target, refuse_inputs};
use ending::Ending;
use opm_plot::{Drawing, Size, png};
use serde_json::json;
use source::Source;
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

/// The first bytes of every MCAP file.
const MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

pub fn run(args: &PlotArgs, output: &Output) -> Result<(), Failure> {
    let printed = is_stdout(&args.output);
    if printed && output.format == Format::Json {
        let problem = "the picture takes standard output; give it a file with --output";
        return Err(Failure::flag("--format json", problem));
    }
    let ending = match printed {
        true => Ending::Svg,
        false => Ending::of(&args.output).ok_or_else(|| {
            let place = args.output.shown();
            let problem = format!("{place}: {}, or - for SVG on standard output", ending::EXPECTED);
            Failure::flag("--output", problem)
        })?,
    };
    if !printed {
        refuse_inputs("--output", &args.output, [&*args.file])?;
    }
    let target = if printed { None } else { Some(Target::create(&args.output)?) };
    let Picture { drawing, complete } = picture(args, output)?;
    let place = args.output.shown();
    let bytes = ending.bytes(&drawing).map_err(|error| Failure::at(&place, error))?;
    match target {
        Some(target) => target.commit(&bytes)?,
        None => print_with(|out| out.write_all(&bytes))?,
    }
    if !complete {
        let label = args.file.shown();
        output.warn(format_args!("{label}: unfinished; what is in it was drawn"));
    }
    let Size { width, height } = drawing.size;
    let pixels = match ending {
        Ending::Svg | Ending::Pdf => [width, height],
        Ending::Png => [width, height].map(|side| (side * f64::from(png::SCALE)).round()),
    };
    // Pages are measured; a pixel of a drawing is a 96th of an inch.
    let (factor, unit) = if ending == Ending::Pdf { (25.4 / 96.0, "mm") } else { (1.0, "pixels") };
    let [across, down] = pixels.map(|side| (side * factor).round());
    if !printed {
        output.note(format_args!("{place}: {across} x {down} {unit}"));
    }
    match output.format {
        Format::Text => Ok(()),
        Format::Json => {
            let json = json!({
                "file": place.to_string(),
                "width": pixels[0],
                "height": pixels[1],
                "complete": complete,
            });
            output.print(&json, "")
        }
    }
}

/// A picture, and whether all is in it.
struct Picture {
    drawing: Drawing,
    complete: bool,
}

/// Draws a recording or a mechanism, whichever the file is.
fn picture(args: &PlotArgs, output: &Output) -> Result<Picture, Failure> {
    if !is_recording(&args.file) {
        return Ok(Picture { drawing: mechanism::draw(args, output)?, complete: true });
    }
    for (flag, given) in [
        ("--pose", args.pose.is_some()),
        ("--mode", args.mode.is_some()),
        ("--tolerance", args.tolerance.is_some()),
        ("--set", !args.change.set.is_empty()),
        ("--coordinates", args.change.coordinates.is_some()),
    ] {
        if given {
            let problem = format!("{} is a recording, expected a mechanism", args.file.shown());
            return Err(Failure::flag(flag, problem));
        }
    }
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
    Ok(Picture { drawing, complete: source.recording.complete })
}

/// Whether a file is to be read as a recording: by its first bytes, or by its name if it is none of the two.
fn is_recording(path: &Path) -> bool {
    let named = path.extension().is_some_and(|ending| ending == "mcap" || ending == "partial");
    let mut start = [0; MAGIC.len()];
    let begins = File::open(path).and_then(|mut file| file.read_exact(&mut start));
    named || begins.is_ok() && start == MAGIC
}
