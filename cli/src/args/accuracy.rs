//! Arguments of `opm accuracy`.

use super::{MechanismArgs, heading};
use crate::accuracy::sizes::Pair;
use crate::pose::{GridAxis, Number, OverAxis, Pose};
use crate::transform::Transform;
use clap::ValueHint;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use opm_accuracy::ErrorModel;
use opm_core::table::ColumnNames;
use opm_study::{BOX_BUDGET, MOST_SAMPLES};
use opm_workspace::MOST_THREADS;
use std::path::PathBuf;

/// Accuracy: pose errors, sensitivities, and errors of axes that no motion takes up
///
/// Errors of actuators and of parts move the platform. The legs of an overconstrained mechanism cannot follow all of them:
/// what is left is the misfit, which play or strain of the joints has to take up. Both are computed to first order at a
/// pose, with the actuators held. docs/accuracy.md has the definitions.
///
/// --actuators and --tolerances give the sizes of errors, each between minus and plus its size. `pose_error` is then the worst
/// case of every task coordinate, `worst` the longest displacement and the largest rotation of the platform, `misfit` the
/// largest play that each joint needs. All three are sums over all errors with the worst signs.
///
/// The errors have names: S1 of an actuated joint, leg1.h of a family's parameter, leg1.phi11.angle.1 and
/// leg1.phi11.offset.2 of an axis. `sensitivity` has a row for each of them, whatever the sizes are. Text shows those that
/// matter most.
///
/// --clearance tells how inaccurate each axis may be so that no joint needs more play: `alone` if it is the only error,
/// `share` if all come together and each may use an equal part of the clearance of every joint that it reaches, and one
/// tolerance for all axes.
///
/// --samples draws each error uniformly between minus and plus its size, assembles that mechanism numerically, beyond first
/// order, and tells the standard deviation of every task coordinate from its nominal value, and what 95 % of the mechanisms
/// do not exceed.
///
/// --over bounds the worst displacement and the worst rotation of the platform over a box of poses: no pose of it that is in
/// reach has larger ones, to first order in the errors. It takes errors of axes and actuators.
///
/// CSV in: as for `opm ik`. CSV out: the pose, `reachable`, `within_limits`, `mode`, `error.NAME` of every task coordinate,
/// `worst.length`, `worst.angle`, `misfit.JOINT.length` and `misfit.JOINT.angle`. With --grid, rows are the poses in reach and
/// within limits, and the largest errors over all of them are printed with their poses.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm accuracy plano-spherical-5dof --pose x=10mm,xi=15deg --actuators 20um,20urad
  opm accuracy plano-spherical-5dof --pose xi=15deg --axes 0.05mm,0.02deg --errors links
  opm accuracy plano-spherical-5dof --tolerances parts.toml --format json
  opm accuracy plano-spherical-5dof --pose xi=15deg --clearance 20um
  opm accuracy plano-spherical-5dof --axes 0.05mm,0.02deg --grid x=-0.1:0.1:11 \\
      --grid xi=0:30deg:4 -o field.csv
  opm accuracy plano-spherical-5dof --axes 0.05mm,0.02deg --over x=-20mm:20mm --over y=-20mm:20mm
  opm accuracy plano-spherical-5dof --axes 0.05mm,0.02deg --errors links --samples 1000
  opm accuracy plano-spherical-5dof --pose xi=15deg --axes 0.05mm,0.02deg --vary h=0.1:0.16:7
  opm accuracy planar-3rrr --poses poses.csv --actuators 20urad -o errors.csv")]
pub struct AccuracyArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The pose, for example x=10mm,xi=15deg; other coordinates stay at home
    #[arg(long, value_name = "NAME=VALUE,...", default_value = "", hide_default_value = true)]
    pub pose: Pose,
    /// The pose in SE(3) instead: position of the reference point, and a unit quaternion, scalar first
    #[arg(long, value_name = "X,Y,Z,QW,QX,QY,QZ", allow_hyphen_values = true, conflicts_with_all = ["pose", "poses", "grid", "over", "vary", "output"])]
    pub transform: Option<Transform>,
    /// A CSV file of poses; - reads standard input
    #[arg(long, value_name = "IN.csv", value_hint = ValueHint::FilePath, conflicts_with = "pose")]
    pub poses: Option<PathBuf>,
    /// The columns of --poses that are read, by the names that they have there: x=pos_x,y; others are passed over
    #[arg(help_heading = heading::TABLE, long, value_name = "NAME=HEADING,...", requires = "poses", conflicts_with_all = ["pose", "grid", "over"])]
    pub columns: Option<ColumnNames>,
    /// Values of one task coordinate, for the largest errors over a grid; other coordinates stay at home
    #[arg(
        long,
        value_name = "AXIS=MIN:MAX:COUNT|AXIS=VALUE",
        conflicts_with_all = ["pose", "poses"]
    )]
    pub grid: Vec<GridAxis>,
    /// Range of one task coordinate, or a single value, for a guaranteed bound of the errors over a box of poses; other
    /// coordinates stay at home
    #[arg(
        help_heading = heading::BOX,
        long,
        value_name = "AXIS=MIN:MAX|AXIS=VALUE",
        conflicts_with_all = ["pose", "poses", "grid", "clearance", "samples", "output"]
    )]
    pub over: Vec<OverAxis>,
    /// With --over: stop when the bounds are within this share above the largest errors found
    #[arg(
        help_heading = heading::BOX,
        long,
        value_name = "SHARE",
        default_value_t = 0.05,
        requires = "over",
        allow_hyphen_values = true
    )]
    pub gap: f64,
    /// With --over: largest number of boxes
    #[arg(
        help_heading = heading::BOX,
        long,
        value_name = "BOXES",
        default_value_t = BOX_BUDGET,
        requires = "over",
        value_parser = clap::value_parser!(u64).range(1..)
    )]
    pub budget: u64,
    /// Errors of actuators: a length for sliders, an angle for others
    #[arg(long, value_name = "LENGTH,ANGLE", allow_hyphen_values = true)]
    pub actuators: Option<Pair>,
    /// Errors of all axes: their places and their directions
    #[arg(
        long,
        value_name = "LENGTH,ANGLE",
        allow_hyphen_values = true,
        conflicts_with = "tolerances"
    )]
    pub axes: Option<Pair>,
    /// A file of tolerances, for single joints and parameters, too
    #[arg(long, value_name = "T.toml", value_hint = ValueHint::FilePath)]
    pub tolerances: Option<PathBuf>,
    /// What errors of axes are: `axes`, of the numbers in the file, so that joints fit at home; `links`, of parts, whose
    /// errors act everywhere
    #[arg(help_heading = heading::ERRORS, long, value_name = "axes|links", value_parser = errors(), default_value = "axes")]
    pub errors: ErrorModel,
    /// The play that joints have, a length and an angle, or one of them: tells which tolerances keep within it
    #[arg(help_heading = heading::ERRORS, long, value_name = "LENGTH,ANGLE", allow_hyphen_values = true, conflicts_with = "poses")]
    pub clearance: Option<Pair>,
    /// Also assemble so many mechanisms with errors drawn at random; each takes some hundred bytes of memory
    #[arg(
        help_heading = heading::SAMPLES,
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..=MOST_SAMPLES),
        conflicts_with_all = ["poses", "grid"]
    )]
    pub samples: Option<u64>,
    /// Seed of --samples: the same seed draws the same mechanisms
    #[arg(help_heading = heading::SAMPLES, long, value_name = "SEED", default_value_t = 1, requires = "samples")]
    pub seed: u64,
    /// Working mode: `home`, or a sign for every two-valued choice, grouped by leg ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Characteristic length, by which lengths and angles are compared, instead of the spread of the joint axes
    #[arg(help_heading = heading::ERRORS, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<Number>,
    /// The errors for each of these values of a number that --set takes, as a table; `misfit` is the largest of all joints,
    /// and with --clearance `uniform` is one tolerance for all axes
    #[arg(
        help_heading = heading::COMPARE,
        long,
        value_name = "NAME=MIN:MAX:COUNT",
        allow_hyphen_values = true,
        conflicts_with_all = ["poses", "over", "samples", "output"]
    )]
    pub vary: Option<GridAxis>,
    /// Number of threads of --grid, --over and --samples, instead of one per processor
    #[arg(help_heading = heading::WORK, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
    /// Output file (.csv) for the table of --poses or --grid; standard output if it is -
    #[arg(
        short,
        long,
        value_name = "OUT.csv",
        conflicts_with = "pose",
        value_hint = ValueHint::FilePath
    )]
    pub output: Option<PathBuf>,
}

/// Parses what errors of axes are.
fn errors() -> impl TypedValueParser<Value = ErrorModel> {
    let names = PossibleValuesParser::new(ErrorModel::NAMED.map(|(name, _)| name));
    names.map(|name| ErrorModel::from_name(&name).unwrap_or_default())
}
