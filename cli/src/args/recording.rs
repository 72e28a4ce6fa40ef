//! Arguments of the commands that read a recording.

use super::{ChangeArgs, heading};
use crate::plot::options::{PanelName, PictureSize};
use crate::pose::{Number, Pose, SliceValue};
use clap::ValueHint;
use std::path::PathBuf;

/// Draw a mechanism or a recording as a picture: SVG, PNG or PDF
///
/// A mechanism is drawn at home or at --pose, from above, from the front, from the right and in perspective. Its
/// links have no shapes in the file: rods run from joint to joint. The base is dark, actuated joints are orange,
/// passive ones light blue, the platform is blue. The links of both sections differ, and imaginary joints are pale.
/// A mechanism that does not decompose is drawn, too, at home.
///
/// The picture of a motion shows poses, imaginary joints, actuated joints and their velocities over time;
/// each value is beside its velocity, and its acceleration where one is too large. Limits are dashed, and spans
/// in which the mechanism cannot follow are shaded. The picture of a workspace shows slices, each that is equal
/// to others once: positions at held angles, and the tilts of a wrist in polar form. It also shows the values
/// that the imaginary joints take if they were recorded (`opm workspace --scalars`). Numbers are in the units of
/// the mechanism file, which is part of the recording. An unfinished .partial file can be drawn too, as far as
/// it was written.
///
/// Pictures stay small: curves of more than 32768 samples are drawn by their extremes in 4096 spans of
/// time, and a panel of more than 5000 cells or dots becomes an image within the picture. Texts are
/// text; a PDF carries what it uses of the fonts, which are part of the program.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm plot plano-spherical-5dof -o mechanism.svg
  opm plot my-mechanism.toml -o tilted.png --pose x=10mm,xi=15deg
  opm plot cloud.mcap -o cloud.svg
  opm plot cloud.mcap -o tilted.png --slice zeta=0,psi=0,xi=30deg,xi=60deg
  opm plot cloud.mcap -o joints.svg --panels imaginary --values theta11,theta12
  opm plot round.mcap -o round.png --values a1,b3 --size 900x300")]
pub struct PlotArgs {
    /// Mechanism file, the name of a shipped example, or a recording (MCAP) of any command
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Output file; its ending selects the format; - prints SVG
    #[arg(short, long, value_name = "OUT.svg|OUT.png|OUT.pdf", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
    /// Panels to draw, instead of those that suit the recording
    #[arg(long, value_name = "NAME,...", value_enum, value_delimiter = ',')]
    pub panels: Vec<PanelName>,
    /// Only these values: for a motion, joints or task coordinates; for a workspace, the two task
    /// coordinates that the slices show, or stored values instead of the imaginary joints
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub values: Vec<String>,
    /// Slices of a workspace: task coordinates are held at the grid values nearest to these. One
    /// coordinate may have several values, with a slice for each
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',')]
    pub slice: Vec<SliceValue>,
    /// The pose of a mechanism, for example x=10mm,xi=15deg; other coordinates stay at home
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub pose: Option<Pose>,
    /// The working mode of a mechanism: `home`, or a sign for every two-valued choice
    #[arg(long, value_name = "MODE", allow_hyphen_values = true)]
    pub mode: Option<String>,
    /// Accept joints of a mechanism that miss their subspaces by at most this length, as in `opm decompose`
    #[arg(help_heading = heading::MECHANISM, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub tolerance: Option<Number>,
    /// What is changed of a mechanism file.
    #[command(flatten)]
    pub change: ChangeArgs,
    /// Width and height in screen pixels, up to 4000 each, instead of a size that suits the panels; a
    /// PNG has twice as many pixels
    #[arg(long, value_name = "WxH")]
    pub size: Option<PictureSize>,
}

/// List the contents of a recording
///
/// Prints topics with their schemas and counts, the range of every value of the points, the run that made
/// the recording, and whether it is complete. An unfinished .partial file can be read too, as far as it was
/// written.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm inspect cloud.mcap
  opm inspect cloud.mcap.partial --format json")]
pub struct InspectArgs {
    /// MCAP file
    #[arg(value_name = "FILE.mcap", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
}

/// Recover a recording that was cut short, as far as it goes
///
/// A run that is killed, or whose disk is full, leaves a .partial file, which has no end and no index. What it holds is
/// copied into a recording that every viewer opens. Its metadata tell that it is not whole: `opm inspect` says so, and
/// `opm merge` does not take a recovered shard. A damaged file is recovered up to the damage. Tables (.csv) need no
/// recovery: every line of a .partial file but the last is whole.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm recover cloud.mcap.partial
  opm recover play.mcap.partial -o play-until-it-broke.mcap")]
pub struct RecoverArgs {
    /// MCAP file that was cut short
    #[arg(value_name = "FILE.mcap.partial", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Output file [default: NAME.recovered.mcap, beside the file]
    #[arg(short, long, value_name = "OUT.mcap", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}

/// Lay a recording out for a viewer: Foxglove, Lichtblick or Rerun
///
/// Of a workspace, the overview is beside the slice at the playhead. Of a motion, the mechanism and the log of
/// violations are beside a plot for each role and unit of the values, and one of the condition number. The camera sees
/// everything.
///
/// In Foxglove or Lichtblick: open the recording, then choose "Import from file" in the menu of layouts and take the
/// .json file. Rerun: `pip install rerun-sdk`, then run the .py file; with the name of an .rrd file as its
/// argument, it writes that instead of opening a window.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm layout cloud.mcap -o layout.json
  opm layout play.mcap -o show.py
  python show.py")]
pub struct LayoutArgs {
    /// Recording (MCAP) of a workspace or a motion
    #[arg(value_name = "FILE.mcap", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Output file; its ending selects the viewer. Without it, a layout for Foxglove goes to standard output
    #[arg(short, long, value_name = "OUT.json|OUT.py", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}
