//! Arguments of `opm path`.

use super::{MechanismArgs, heading};
use crate::pose::{GridAxis, Pose};
use clap::ValueHint;
use opm_workspace::MOST_THREADS;
use std::path::PathBuf;

/// A path of the platform between two poses that passes no singularity
///
/// The working mode stays the same. If the straight way is clear, that is the path. Else the grid is divided into aspects,
/// as `opm workspace --kind aspects` does, and the path leads through the aspect that both poses are in, far from
/// singularities. The answer says if there is none: on this grid the poses are in different aspects (exit status 0; with -o,
/// which then writes nothing, 1). Without --grid the grid is fitted to the workspace; with it, a coordinate that is not given
/// stays at home. A finer grid finds narrower ways.
///
/// The path is a table of poses (-o OUT.csv: t, then the task coordinates, in seconds, metres and radians), which
/// `opm trajectory --motion` takes. The motion through it has been watched between the poses too: it is in reach, within all
/// limits of joints and without a singularity, unless one comes and goes more than once between two samples, of which there
/// are four from pose to pose, and 500 in all, or more. Angles are continuous, so that the goal may be reached after full turns. Limits of rates and
/// accelerations do not count; `opm trajectory --time-optimal` finds a timing within them.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm path five-bar --from x=-100mm,y=300mm --to x=100mm,y=250mm
  opm path planar-3rpr --from x=14.92mm --to x=-13.4mm,y=-6.6mm,theta=-23.8deg -o path.csv
  opm trajectory planar-3rpr --motion path.csv -o play.mcap
  opm path plano-spherical-5dof --from x=-0.1 --to x=0.05 --grid x=-0.2:0.2:21 \\
      --vary h=100mm:160mm:4")]
pub struct PathArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The pose that the path begins at, for example x=10mm,xi=15deg; other coordinates are at home
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub from: Pose,
    /// The pose that it leads to; other coordinates are at home
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub to: Pose,
    /// Values of one task coordinate: minimum, maximum and number of values, or a single value
    #[arg(long, value_name = "AXIS=MIN:MAX:COUNT|AXIS=VALUE")]
    pub grid: Vec<GridAxis>,
    /// Working mode: `home`, or a sign for every two-valued choice ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Time that the path takes, in seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 10.0, value_parser = seconds, allow_hyphen_values = true)]
    pub duration: f64,
    /// Look for a path for each of these values of a number that --set takes, and print a table
    #[arg(
        help_heading = heading::COMPARE,
        long,
        value_name = "NAME=MIN:MAX:COUNT",
        allow_hyphen_values = true,
        conflicts_with = "output"
    )]
    pub vary: Option<GridAxis>,
    /// Output file for the table of poses; - prints it
    #[arg(short, long, value_name = "OUT.csv", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Number of threads, instead of one per processor
    #[arg(help_heading = heading::WORK, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
}

/// Parses the duration of a path.
fn seconds(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if (1e-6..=1e9).contains(&number) => Ok(number),
        _ => Err("expected a number of seconds, 1e-6 to 1e9".to_owned()),
    }
}
