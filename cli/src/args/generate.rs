//! Arguments of the commands that write the closed forms of a mechanism as source code.

use super::MechanismArgs;
use clap::{Subcommand, ValueHint};
use opm_generate::Content;
use std::path::PathBuf;

/// Write the kinematics of a mechanism as source code
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm generate c plano-spherical-5dof -o controller
  opm generate rust plano-spherical-5dof -o kinematics
  opm generate python plano-spherical-5dof -o .
  opm generate c delta --dynamics -o controller
  opm generate matlab plano-spherical-5dof -o .
  opm generate st plano-spherical-5dof -o plc")]
pub struct GenerateArgs {
    /// The language.
    #[command(subcommand)]
    pub language: Language,
}

/// The languages that code is written in.
#[derive(Debug, Subcommand)]
pub enum Language {
    /// Write the kinematics of a mechanism as C99 for a controller
    ///
    /// The code depends on math.h alone: no heap, no global variables, a few hundred lines. Files and symbols have the
    /// mechanism's name, with _ for what a name of C cannot have. NAME.h says what each function does; NAME_inverse gives every
    /// joint at a pose in a working mode, as `opm ik` does, or the number of the leg that is out of reach. One line of NAME.h
    /// makes all numbers float. The geometry is one struct: numbers of a calibration need no new code.
    ///
    /// NAME_rates gives the joint rates, NAME_forward the pose for values of the actuated joints, and, with --dynamics,
    /// NAME_inverse_dynamics their efforts.
    ///
    /// NAME_test.c compares the code with poses that opm solved, in NAME_golden.h; CMakeLists.txt builds both. NAME_linuxcnc.c is
    /// a kinematics module for LinuxCNC. Files that are there already are replaced.
    ///
    /// A note names the files; standard output stays empty, and --format has no effect.
    #[command(after_long_help = "\
Examples:
  opm generate c plano-spherical-5dof -o controller
  opm generate c my-mechanism.toml --set h=140mm -o src/kinematics
  cc -std=c99 -O2 -o test controller/NAME.c controller/NAME_test.c -lm && ./test")]
    C(CodeArgs),
    /// Write the kinematics of a mechanism as a package of Rust
    ///
    /// The package has no allocation and needs no standard library: without the feature std, which is on by default, its only
    /// dependency is the crate libm, for the functions of numbers that core lacks. One line of src/lib.rs makes all numbers
    /// f32. The geometry is one constant of a struct: numbers of a calibration need no new code.
    ///
    /// tests/golden.rs compares the code with poses that opm solved. Files that are there already are replaced.
    ///
    /// A note names the files; standard output stays empty, and --format has no effect.
    #[command(after_long_help = "\
Examples:
  opm generate rust plano-spherical-5dof -o kinematics
  cargo test --manifest-path kinematics/Cargo.toml
  cargo build --manifest-path kinematics/Cargo.toml --no-default-features --features libm")]
    Rust(CodeArgs),
    /// Write the kinematics of a mechanism as a module of Python
    ///
    /// The module NAME.py needs NumPy alone. Its functions solve arrays of poses at once, without a loop over them. NAME is
    /// the mechanism's name, with _ for what a name cannot have. The geometry is one named tuple: numbers of a calibration need
    /// no new code.
    ///
    /// test_NAME.py compares the module with poses that opm solved; pyproject.toml makes it a package. Files that are there
    /// already are replaced.
    ///
    /// A note names the files; standard output stays empty, and --format has no effect.
    #[command(after_long_help = "\
Examples:
  opm generate python plano-spherical-5dof -o kinematics
  python kinematics/test_plano_spherical_5dof.py")]
    Python(CodeArgs),
    /// Write the kinematics of a mechanism as a package of MATLAB
    ///
    /// The package +NAME has a file for each function, which needs no other file: it can be taken into a block of Simulink by
    /// itself. Octave runs it, too. NAME is the mechanism's name, with _ for what a name cannot have. The geometry is one struct:
    /// numbers of a calibration need no new code.
    ///
    /// NAME_test.m compares the package with poses that opm solved. Files that are there already are replaced.
    ///
    /// A note names the files; standard output stays empty, and --format has no effect.
    #[command(after_long_help = "\
Examples:
  opm generate matlab plano-spherical-5dof -o kinematics
  octave --path kinematics --eval plano_spherical_5dof_test")]
    Matlab(CodeArgs),
    /// Write the kinematics of a mechanism as structured text (IEC 61131-3) for a PLC
    ///
    /// NAME.st has a function block for each function: NAME_inverse gives every joint at a pose in a working mode, as `opm ik` does,
    /// or the number of the leg that is out of reach. NAME is the mechanism's name, with _ for what a name cannot have. All
    /// numbers are LREAL. A variable of the type NAME_geometry has the numbers of the mechanism from the start, and is passed to
    /// every block: numbers of a calibration need no new code.
    ///
    /// NAME_test.st has a function block that compares the code with poses that opm solved, one in each cycle. Files that are
    /// there already are replaced.
    ///
    /// A note names the files; standard output stays empty, and --format has no effect.
    #[command(after_long_help = "\
Examples:
  opm generate st plano-spherical-5dof -o plc")]
    St(CodeArgs),
}

/// Of what, how much of it, and where to.
#[derive(Debug, clap::Args)]
pub struct CodeArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Write the inverse dynamics, too: the efforts of the actuated joints for a pose with its rates and accelerations, for
    /// feed-forward. The masses of all bodies, rotors, gears, friction, the payload and gravity are in the geometry
    #[arg(long)]
    pub dynamics: bool,
    /// Directory that the files are written to; it is made if it is not there
    #[arg(short, long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    pub output: PathBuf,
}

impl CodeArgs {
    /// What the code computes.
    pub fn content(&self) -> Content {
        if self.dynamics { Content::Dynamics } else { Content::Kinematics }
    }
}
