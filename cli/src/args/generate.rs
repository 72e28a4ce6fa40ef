//! Arguments of the commands that write the closed forms of a mechanism as source code.

use super::MechanismArgs;
use clap::{Subcommand, ValueHint};
use std::path::PathBuf;

/// Write the kinematics of a mechanism as source code
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm generate c plano-spherical-5dof -o controller")]
pub struct GenerateArgs {
    /// The language.
    #[command(subcommand)]
    pub language: Language,
}

/// The languages that code is written in.
#[derive(Debug, Subcommand)]
pub enum Language {
    C(CArgs),
}

/// Write the kinematics of a mechanism as C99 for a controller
///
/// The code depends on math.h alone: no heap, no global variables, a few hundred lines. Files and symbols have the
/// mechanism's name, with _ for what a name of C cannot have. NAME.h says what each function does; NAME_inverse gives every
/// joint at a pose in a working mode, as `opm ik` does, or the number of the leg that is out of reach. One line of NAME.h
/// makes all numbers float. The geometry is one struct: numbers of a calibration need no new code.
///
/// NAME_rates gives the joint rates, NAME_forward the pose for values of the actuated joints.
///
/// NAME_test.c compares the code with poses that opm solved, in NAME_golden.h; CMakeLists.txt builds both. NAME_linuxcnc.c is
/// a kinematics module for LinuxCNC. Files that are there already are replaced.
///
/// Nothing is printed; --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm generate c plano-spherical-5dof -o controller
  opm generate c my-mechanism.toml --set h=140mm -o src/kinematics
  cc -std=c99 -O2 -o test controller/NAME.c controller/NAME_test.c -lm && ./test")]
pub struct CArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Directory that the files are written to; it is made if it is not there
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub output: PathBuf,
}
