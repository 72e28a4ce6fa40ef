//! Arguments of `opm convert`.

use super::MechanismArgs;
use clap::ValueHint;
use std::path::PathBuf;

/// Write a mechanism file anew: changed by --set or --tolerance, or a family as a list of joints
///
/// With --joints the file that is written lists every joint at home: type, axis, point, pitch, limits, motors. A file that
/// gives the parameters of a family becomes one that depends on no family. It gives the same joint values at the same
/// poses, in the same working modes and units. Only the imaginary joints have other names and zeros: in a list of joints
/// they are called tau.LEG, and are zero at home.
///
/// Without --joints the form of the file stays, and its text too, if nothing is changed.
///
/// The output is the file; --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm convert plano-spherical-5dof --joints -o joints.toml
  opm convert plano-spherical-5dof --set h=140mm -o longer.toml
  opm convert my-mechanism.toml --tolerance 0.5mm -o exact.toml")]
pub struct ConvertArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// List every joint, whatever the form of the file
    #[arg(long)]
    pub joints: bool,
    /// Output file (.toml); standard output if it is - or not given
    #[arg(short, long, value_name = "OUT.toml", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}
