//! Arguments of `opm design`.

use super::heading;
use clap::ValueHint;
use opm_workspace::MOST_THREADS;
use std::path::PathBuf;

/// Find dimensions by optimisation: one objective, or the front of two
///
/// PROBLEM.toml names a mechanism, what may vary of it and between which bounds ([variables]), the grid of poses that it is
/// judged over ([grid]), and what decides ([[objective]], [[constraint]]). Measures are dexterous, reachable and grid
/// (shares of the grid), disc and ball (the radius of the largest one in the dexterous workspace), lti and other indices
/// (the worst value over the grid), range.JOINT (how far a joint moves) and size (the lengths of all links). docs/design.md
/// explains everything.
///
/// With `split = true` the sections are designed one after the other ([upper], [lower]): the upper one for the orientations
/// of the grid, then the lower one for the ranges of the imaginary joints that the upper one requires.
///
/// With two objectives the result is the front: designs none of which is better in both than another one. With -o, every
/// design is a mechanism file, and OUT.csv beside it has all evaluations; --resume goes on with these after Ctrl-C. The
/// same seed gives the same designs.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm design problem.toml -o better.toml --picture better.svg
  opm design problem.toml -o better.toml --resume
  opm design problem.toml --budget 200 --seed 3 --undivided --format json")]
pub struct DesignArgs {
    /// The problem
    #[arg(value_name = "PROBLEM.toml", value_hint = ValueHint::FilePath)]
    pub problem: PathBuf,
    /// Evaluate this number of designs, instead of the `budget` of the problem
    #[arg(help_heading = heading::SEARCH, long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    pub budget: Option<u64>,
    /// Seed of all random numbers, instead of that of the problem
    #[arg(help_heading = heading::SEARCH, long, value_name = "SEED")]
    pub seed: Option<u64>,
    /// Design all variables at once, although the problem says `split = true`
    #[arg(help_heading = heading::SEARCH, long)]
    pub undivided: bool,
    /// Go on with an interrupted run: what the evaluations beside OUT.toml have is not evaluated again
    #[arg(long, requires = "output")]
    pub resume: bool,
    /// Begin anew even if there are evaluations beside OUT.toml, and replace them
    #[arg(long, requires = "output", conflicts_with = "resume")]
    pub force: bool,
    /// Of a front, write at most this number of mechanism files, evenly spread, instead of all
    #[arg(help_heading = heading::SEARCH, long, value_name = "N", requires = "output", value_parser = clap::value_parser!(u64).range(1..))]
    pub designs: Option<u64>,
    /// Number of threads, instead of one per processor
    #[arg(help_heading = heading::SEARCH, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
    /// Draw the mechanism, or the front
    #[arg(long, value_name = "OUT.svg|OUT.png|OUT.pdf", value_hint = ValueHint::FilePath)]
    pub picture: Option<PathBuf>,
    /// Output: the mechanism file; of a front OUT-1.toml, OUT-2.toml and so on, the best of the first objective first
    #[arg(short, long, value_name = "OUT.toml", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
}
