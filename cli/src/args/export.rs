//! Arguments of the commands that write a mechanism for other programs.

use super::{MechanismArgs, MotionTableArgs};
use clap::{Subcommand, ValueHint};
use opm_export::MjcfOptions;
use std::path::PathBuf;

/// Write a mechanism as a model for another program
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm export mjcf plano-spherical-5dof -o plano.xml
  opm export urdf plano-spherical-5dof -o plano.urdf")]
pub struct ExportArgs {
    /// The format of the model.
    #[command(subcommand)]
    pub format: ExportFormat,
}

/// The formats that a mechanism is written in.
#[derive(Debug, Subcommand)]
pub enum ExportFormat {
    Mjcf(MjcfArgs),
    Urdf(UrdfArgs),
}

/// Write a mechanism as a model of MuJoCo (MJCF), with its closed loops
///
/// Joints have opm's names, and at every pose opm's values; a ball is one joint with a quaternion, a helical joint a
/// hinge and the slide NAME.slide. The platform is the body `platform`, at its reference point and parallel to the
/// base at home; sensors give its position and orientation. The first leg carries the platform, and a weld closes
/// each of the others. Each actuated joint has a position servo of its name. Each working mode that reaches the home
/// pose is a keyframe, named by its signs: pp_mp_p is ++ -+ +; those past limits end in _out_of_limits,
/// and those in which held motors do not hold the platform in _loose.
///
/// Bodies are those that `opm plot` draws, so their masses are a guess: set --density, or [bodies] in the file. The three
/// limits of a spherical joint are left out, because MuJoCo limits only the angle of a ball. A mechanism that does not
/// decompose is written, too, with one keyframe. All numbers are in metres, radians, kilograms and seconds.
///
/// --trajectory follows a motion and writes it beside the model, OUT.csv: a row for each time step with the time, the values
/// of qpos, and those of ctrl, in the order of the model. The model then has the keyframe `motion`, its start. Controls
/// lead the joints by what the servos lag.
///
/// The output is the model; --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm export mjcf plano-spherical-5dof -o plano.xml
  opm export mjcf my-mechanism.toml --set h=140mm --density 1200 > model.xml
  opm export mjcf five-bar -o five-bar.xml --time-step 0.0005
  opm export mjcf plano-spherical-5dof -o plano.xml --trajectory plano-spherical-sinusoids
  python -m mujoco.viewer --mjcf=plano.xml")]
pub struct MjcfArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Output file; standard output if it is - or not given
    #[arg(short, long, value_name = "OUT.xml", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Density of all bodies without a mass in the file, kilograms per cubic metre, instead of that in the file, or 2700
    #[arg(long, value_name = "KG/M3", value_parser = density, allow_negative_numbers = true)]
    pub density: Option<f64>,
    /// Time step of the simulation, seconds; the loops are held as stiffly as it allows
    #[arg(
        long,
        value_name = "SECONDS",
        default_value_t = MjcfOptions::TIME_STEP,
        value_parser = seconds,
        allow_negative_numbers = true
    )]
    pub time_step: f64,
    /// Motion to be written as a table beside the model: a TOML or CSV file, or the name of a shipped one
    #[arg(long, value_name = "M.toml|M.csv", value_hint = ValueHint::FilePath)]
    pub trajectory: Option<PathBuf>,
    /// How its table of poses is read.
    #[command(flatten)]
    pub table: MotionTableArgs,
}

/// Write a mechanism as a tree of links (URDF), and what closes its loops (YAML)
///
/// URDF, the format of ROS, has no loops. The first leg carries the link `platform`, at its reference point and parallel to
/// the base at home; every other leg ends in a link LEG.platform. OUT.yaml, beside OUT.urdf, says that these links are one:
/// `closed_loop` has pairs of links, `type` their type (6d), and `name_mot` the actuated joints, as the loader of
/// Gepetto's example-parallel-robots for Pinocchio reads them.
///
/// Joints have opm's names and values. A cylindrical or universal joint is two joints, named as its coordinates. A ball is
/// three revolute joints NAME.1 NAME.2 NAME.3: about x, then y, then z, zero at home. A helical joint is a hinge and a
/// slide NAME.slide that follows it (mimic). Where URDF wants a limit and there is none, it is 1000.
///
/// The output is the tree; --format has no effect. Without --output the closures are not written.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm export urdf plano-spherical-5dof -o plano.urdf
  opm export urdf my-mechanism.toml --set h=140mm --density 1200 > model.urdf")]
pub struct UrdfArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Output file; standard output if it is - or not given
    #[arg(short, long, value_name = "OUT.urdf", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Density of all bodies without a mass in the file, kilograms per cubic metre, instead of that in the file, or 2700
    #[arg(long, value_name = "KG/M3", value_parser = density, allow_negative_numbers = true)]
    pub density: Option<f64>,
}

/// Parses a density; its range is checked with that of the file.
fn density(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "expected a number of kg/m^3, without a unit".to_owned())
}

/// Parses a time step.
fn seconds(text: &str) -> Result<f64, String> {
    text.trim().parse().map_err(|_| "expected a number of seconds, without a unit".to_owned())
}
