//! Arguments of `opm new`.

use super::ChangeArgs;
use clap::ValueHint;
use std::path::PathBuf;

/// Write a mechanism file of a common architecture, with dimensions of one's own
///
/// The file is short: it names its dimensions as a drawing does, and all joints follow from them. --set gives them, here and
/// in every other command; --vary and `opm design` take them, too. `opm help format` explains the file.
///
/// Without a name, all architectures are listed, with a drawing and the dimensions of each.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm new
  opm new delta --set rb=120mm,rp=40mm,crank=150mm,rod=350mm -o mine.toml
  opm workspace mine.toml --set rod=400mm -o longer.mcap
  opm measure mine.toml --vary crank=100mm:200mm:11")]
pub struct NewArgs {
    /// The architecture
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
    /// What is changed of it.
    #[command(flatten)]
    pub change: ChangeArgs,
    /// Output file (.toml), which must not exist; standard output if it is - or not given
    #[arg(short, long, value_name = "OUT.toml", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Write over a file that exists
    #[arg(long)]
    pub force: bool,
}
