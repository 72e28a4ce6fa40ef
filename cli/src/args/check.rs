//! Arguments of `opm check`.

use super::{MechanismArgs, heading};
use crate::pose::GridAxis;

/// Hold a mechanism's closed forms to independent computations: a certificate
///
/// What the tests of opm hold on random mechanisms is held on this one, at random poses:
///
/// * closure: joint values of inverse kinematics in every mode, with the ends of the undecomposed legs;
///
/// * branches: the solutions of every leg, with those that a numeric solver finds from many starts;
///
/// * derivatives: rates and accelerations of all joints, with differences of inverse kinematics;
///
/// * rows: how many poses of random grids a sweep counts, with inverse kinematics of every pose;
///
/// * forward: assemblies, with the poses that their joint values came from.
///
/// Poses where two computations cannot be expected to agree, such as those near a singularity, are left out and counted.
/// If something does not hold, the exit status is 1 and the first place where it does not is printed: please report it.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm check plano-spherical-5dof
  opm check my-mechanism.toml --samples 2000 --seed 7
  opm check my-mechanism.toml --tolerance 0.5mm --format json
  opm check plano-spherical-5dof --vary h=100mm:160mm:4")]
pub struct CheckArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// Random poses of each comparison
    #[arg(long, value_name = "COUNT", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..))]
    pub samples: u32,
    /// Seed of the random poses: the same one gives the same certificate
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub seed: u64,
    /// Check for each of these values of a number that --set takes, and print a table of the worst differences
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true)]
    pub vary: Option<GridAxis>,
}
