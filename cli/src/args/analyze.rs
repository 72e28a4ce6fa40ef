//! Arguments of `opm analyze`.

use super::{MechanismArgs, SetupArgs, heading};
use crate::pose::{GridAxis, Number, Pose};
use crate::transform::Transform;
use clap::ValueHint;
use opm_core::table::ColumnNames;
use std::path::PathBuf;

/// Forces and transmission at a pose: efforts of the actuators, payload, transmission indices
///
/// --wrench is a load on the platform: force and moment, in newtons and newton metres. Its effort is what each
/// actuator exerts along its coordinate so that the mechanism stays at rest, in N or N m. A slider that points up
/// and carries a weight has a positive effort. The efforts of imaginary joints are what the lower section does to
/// the upper one.
///
/// An effort that the load does not determine is null: redundant actuators can work against each other. If the
/// load drives a motion that the actuators do not hold, no effort is known, and `balance` is "driven". At a serial
/// singularity it is "singular". A pose out of reach is an answer (exit status 0).
///
/// Without a load: the largest effort for a unit force and a unit moment, with its direction; the transmission
/// indices of every input, of both sections, and of the whole (`lti` is the least of all), and the constraint index where
/// legs constrain the platform; and, if joints have a `max_effort`, the largest force and moment that the actuators bear
/// in every direction. With a load, these are on top of it. `indices` has all numbers that `opm workspace` takes for
/// --limit, --color and --scalars. docs/analysis.md has the definitions.
///
/// --gravity adds the weight of links and platform. Their masses are those of the mechanism file, or follow from the shapes
/// and a density, as in models for simulators. What the platform carries is a payload in [bodies], or a --wrench. It also gives the mass matrix in task
/// coordinates (docs/dynamics.md).
///
/// Statics do not tell what the legs of an overconstrained mechanism, or redundant actuators, carry: --link-stiffness
/// and --joint-stiffness do, by the virtual joint method, for the load and for the weight of links and platform. They also give
/// the natural frequencies.
///
/// CSV in: as for `opm ik`. CSV out: the pose, `reachable`, `within_limits`, `mode`, `balance`, the efforts
/// (`effort.NAME`), and the indices that the mechanism has; with --link-stiffness the least stiffness, too.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm analyze plano-spherical-5dof --pose x=10mm,xi=15deg
  opm analyze plano-spherical-5dof --pose xi=15deg --wrench 10,0,0,0,0,0.5 --format json
  opm analyze plano-spherical-5dof --wrench 0,0,-100,0,0,0 --link-stiffness 1e7,1e4
  opm analyze plano-spherical-5dof --pose x=10mm --gravity 0,0,-9.81
  opm analyze planar-3rrr --wrench 0,-20,0,0,0,0 --at 50mm,0,0 --frame platform
  opm analyze planar-3rrr --poses poses.csv --wrench 0,-20,0,0,0,0 -o efforts.csv")]
pub struct AnalyzeArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The pose, for example x=10mm,xi=15deg; other coordinates stay at home
    #[arg(long, value_name = "NAME=VALUE,...", default_value = "", hide_default_value = true)]
    pub pose: Pose,
    /// The pose in SE(3) instead: position of the reference point, and a unit quaternion, scalar first
    #[arg(long, value_name = "X,Y,Z,QW,QX,QY,QZ", allow_hyphen_values = true, conflicts_with_all = ["pose", "poses", "vary"])]
    pub transform: Option<Transform>,
    /// A CSV file of poses; - reads standard input. Its column `mode` is not read
    #[arg(long, value_name = "IN.csv", value_hint = ValueHint::FilePath, conflicts_with = "pose")]
    pub poses: Option<PathBuf>,
    /// The columns of --poses that are read, by the names that they have there: x=pos_x,y; others are passed over
    #[arg(help_heading = heading::TABLE, long, value_name = "NAME=HEADING,...", requires = "poses", conflicts_with = "pose")]
    pub columns: Option<ColumnNames>,
    /// What acts on the mechanism, and how much it gives way.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// Working mode: `home`, or a sign for every two-valued choice, grouped by leg ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Characteristic length, by which forces and moments are compared, instead of the spread of the joint axes
    #[arg(help_heading = heading::ALSO, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<Number>,
    /// Analyze for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true, conflicts_with_all = ["poses", "link_stiffness"])]
    pub vary: Option<GridAxis>,
    /// Output file (.csv) for the table; standard output if it is - or not given
    #[arg(
        short,
        long,
        value_name = "OUT.csv",
        requires = "poses",
        conflicts_with = "pose",
        value_hint = ValueHint::FilePath
    )]
    pub output: Option<PathBuf>,
}
