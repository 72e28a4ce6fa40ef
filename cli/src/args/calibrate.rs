//! Arguments of `opm calibrate`.

use super::{MechanismArgs, heading};
use crate::calibrate::given::{NamedPoint, Sigmas};
use clap::ValueHint;
use std::path::PathBuf;

/// Calibration: parameters, joint places and encoder offsets from measured poses
///
/// M.csv has a row for each pose at which something was measured, and columns by name: task coordinates (x, xi), actuated
/// joints (S1: what the encoder shows), point.x, point.y, point.z (the platform's reference point), distance.NAME (its
/// distance from a --point), incline.x and incline.y (how far the platform's axes rise: a level). Values are in metres and
/// radians, unless the header says otherwise: `S1 [mm]`. An empty cell was not measured. A row tells something if it has more
/// values than the pose has coordinates.
///
/// What is calibrated: the parameters of a family (leg1.h) with the offsets of its encoders (leg1.offset.S); in a list of
/// joints the places of the joints within their subspaces (leg1.r1.offset.1, leg1.r2.angle.1, names as in `opm accuracy`) and
/// the values of actuated joints at home (S1.home). Poses and joints both have errors, of the sizes that --sigma says. What
/// the measurements cannot tell keeps its value and is named.
///
/// --plan N chooses N poses at which to measure, so that the parameters are told best. Its output is a CSV of poses and
/// joints; no measurements are read. docs/calibration.md explains everything with a worked machine.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm calibrate plano-spherical-5dof --plan 40 --sigma 20um,20urad -o plan.csv
  opm calibrate plano-spherical-5dof --measurements m.csv --sigma 20um,20urad -o machine.toml
  opm calibrate planar-3rrr --measurements m.csv --only home --format json
  opm calibrate plano-spherical-5dof --measurements m.csv --point A=0.5,0,0.2 --hold leg4")]
pub struct CalibrateArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// A CSV file of measurements; - reads standard input
    #[arg(
        long,
        value_name = "M.csv",
        value_hint = ValueHint::FilePath,
        required_unless_present = "plan",
        conflicts_with = "plan"
    )]
    pub measurements: Option<PathBuf>,
    /// Standard deviations of measured lengths and angles. Without them all values weigh the same, lengths in units of the
    /// mechanism's size, and the deviation is estimated
    #[arg(long, value_name = "LENGTH,ANGLE", allow_hyphen_values = true)]
    pub sigma: Option<Sigmas>,
    /// Those of actuated joints, if they are others
    #[arg(help_heading = heading::FIT, long, value_name = "LENGTH,ANGLE", allow_hyphen_values = true, requires = "sigma")]
    pub joint_sigma: Option<Sigmas>,
    /// A point of the base for columns distance.NAME
    #[arg(long, value_name = "NAME=X,Y,Z", allow_hyphen_values = true)]
    pub point: Vec<NamedPoint>,
    /// Calibrate only the parameters whose names have these words: leg1, home, leg1.h
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Hold the parameters whose names have these words
    #[arg(help_heading = heading::FIT, long, value_name = "NAME,...", value_delimiter = ',')]
    pub hold: Vec<String>,
    /// Leave out outliers, the worst first, until there are none
    #[arg(help_heading = heading::FIT, long, conflicts_with = "plan")]
    pub reject_outliers: bool,
    /// With --sigma: hold combinations of parameters whose standard error would be larger than this, in radians and in shares
    /// of the mechanism's size
    #[arg(help_heading = heading::FIT, long, value_name = "SHARE", default_value_t = 0.05, allow_hyphen_values = true)]
    pub weakest: f64,
    /// Choose this number of poses to measure
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub plan: Option<u32>,
    /// What will be measured at the chosen poses, instead of all task coordinates and actuated joints
    #[arg(help_heading = heading::PLAN, long, value_name = "NAME,...", value_delimiter = ',', requires = "plan")]
    pub columns: Vec<String>,
    /// Number of poses to choose from, drawn from the workspace
    #[arg(
        help_heading = heading::PLAN,
        long,
        value_name = "COUNT",
        default_value_t = 500,
        requires = "plan",
        value_parser = clap::value_parser!(u32).range(1..)
    )]
    pub candidates: u32,
    /// A CSV file of poses to choose from instead
    #[arg(help_heading = heading::PLAN, long, value_name = "IN.csv", requires = "plan", conflicts_with = "candidates", value_hint = ValueHint::FilePath)]
    pub poses: Option<PathBuf>,
    /// Seed of the draws
    #[arg(help_heading = heading::PLAN, long, value_name = "SEED", default_value_t = 0, requires = "plan")]
    pub seed: u64,
    /// Working mode of all measurements: `home`, or a sign for every two-valued choice ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Output: the calibrated mechanism file (.toml); with --plan a table of poses (.csv; standard output if it is -)
    #[arg(short, long, value_name = "OUT", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}
