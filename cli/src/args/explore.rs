//! Arguments of the command that writes a page.

use super::MechanismArgs;
use clap::ValueHint;
use std::path::PathBuf;

/// Write a page that shows a mechanism and its workspace in a browser
///
/// The page is one HTML file that needs no network and no other file: mail it, or put it beside a paper. It shows the
/// mechanism in space and a slice of its workspace. Both follow the platform, the working mode and every dimension while
/// they are moved. What is shown is in the page's address, so that a link shares it. The page opens other mechanism
/// files, too, and saves what was changed.
///
/// The output is the page; --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm explore plano-spherical-5dof -o robot.html
  opm explore my-mechanism.toml --set h=140mm -o robot.html")]
pub struct ExploreArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Output file; standard output if it is - or not given
    #[arg(short, long, value_name = "OUT.html", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}
