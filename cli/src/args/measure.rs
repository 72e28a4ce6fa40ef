//! Arguments of the command that measures a workspace.

use super::{ChangeArgs, heading};
use crate::pose::{GridAxis, Number, OverAxis};
use clap::{ValueEnum, ValueHint};
use opm_workspace::measure::{DEFAULT_BUDGET, check_tolerance};
use opm_workspace::{MOST_THREADS, Sections};
use std::path::PathBuf;

/// Largest budget of a measure: no machine has the memory for more boxes.
const MOST_BOXES: f64 = 1e12;

/// Measure the workspace: area, volume, share of all orientations, with guaranteed bounds
///
/// The ranges of --over are covered with boxes. Each box is proved to be inside the workspace or outside of
/// it, or is undecided. The least certain boxes are split until the measure is certain to within --tolerance
/// of its value. The bounds hold however the command ends, Ctrl-C included, and do not depend on the number
/// of threads. A pose counts as in `opm workspace`: if it is in reach and within all joint limits.
///
/// The measure is taken over the product of all ranges. Orientations are weighed by the Haar measure, which
/// is uniform over rotations: xi by sin xi, tilt by sin tilt, pitch by cos pitch, nu by cos(nu - home). All orientations,
/// each once, are zeta=-180deg:180deg, xi=0:180deg, psi=-180deg:180deg, or roll=-180deg:180deg, pitch=-90deg:90deg,
/// yaw=-180deg:180deg, together 8 pi^2 rad^3. A range from negative to positive xi counts orientations twice if zeta has a
/// full revolution.
///
/// Where legs tie coordinates together, --over takes those that the others follow from, and the measure is over
/// these. An orientation of which an angle follows is not weighed.
///
/// The number of boxes depends on how many coordinates have a range, and on the widths of the ranges. Three
/// coordinates take some thousand boxes. Where x and y of a plane have ranges, the area that the legs reach
/// there is exact, and boxes cover the other coordinates only; legs with limits on angles in the plane are an
/// exception. If the --budget ends first, the result and a warning say which accuracy was reached. To improve
/// it, use narrower ranges of --over, --section upper, or a larger --budget.
///
/// A coordinate without --over stays at home. With --section upper, an angle without --over has a full
/// revolution instead. Without any --over, ranges are fitted to the workspace as in `opm workspace`.
///
/// --section upper measures where the upper section closes by itself, in its own coordinates. --section
/// lower does the same for the lower section, in its own coordinates and the values of the imaginary
/// joints; --over takes the names of both.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm measure plano-spherical-5dof --section upper
  opm measure plano-spherical-5dof --over x=-200mm:200mm --over y=-200mm:300mm
  opm measure plano-spherical-5dof --section upper --over xi=0:60deg --tolerance 1e-4
  opm measure translational-helical-3dof --tolerance 1e-9 --over x=-1:1 --over y=-1:1 \\
      --over phi=30deg
  opm measure plano-spherical-5dof --over x=-0.2:0.2 --over y=-0.2:0.3 --vary h=100mm:160mm:7
  opm measure plano-cylindrical-4dof --mode any --budget 1000000 --format json")]
pub struct MeasureArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Snap joints that miss their subspaces by at most this, as --tolerance of the other commands does
    #[arg(help_heading = heading::MECHANISM, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub joint_tolerance: Option<Number>,
    /// What is changed of the file.
    #[command(flatten)]
    pub change: ChangeArgs,
    /// Measure for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true)]
    pub vary: Option<GridAxis>,
    /// Range of one coordinate, or a single value
    #[arg(long, value_name = "AXIS=MIN:MAX|AXIS=VALUE")]
    pub over: Vec<OverAxis>,
    /// What has to close: the whole mechanism, or one section alone
    #[arg(long, value_enum, default_value_t = SectionName::Whole)]
    pub section: SectionName,
    /// Working mode: `home`, `any`, or a sign for every two-valued choice ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Stop when the measure is certain to be within this share of its value
    #[arg(long, value_name = "SHARE", default_value = "0.01", value_parser = tolerance, allow_hyphen_values = true)]
    pub tolerance: f64,
    /// Largest number of boxes; each takes some 100 bytes of memory
    #[arg(long, value_name = "BOXES", default_value_t = DEFAULT_BUDGET, value_parser = boxes, allow_hyphen_values = true)]
    pub budget: u64,
    /// Number of threads, instead of one per processor
    #[arg(help_heading = heading::WORK, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
}

/// The part of a mechanism that is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SectionName {
    /// Poses of the platform
    Whole,
    /// The upper section alone: its own coordinates
    Upper,
    /// The lower section alone: its own coordinates, and the imaginary joints
    Lower,
}

impl SectionName {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Whole => "whole",
            Self::Upper => "upper",
            Self::Lower => "lower",
        }
    }

    /// The sections that have to close in the domain of the measure.
    pub fn sections(self) -> Sections {
        match self {
            Self::Whole => Sections::Whole,
            Self::Upper => Sections::Upper,
            Self::Lower => Sections::Lower,
        }
    }
}

/// Parses the tolerance, a share of a measure.
fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().unwrap_or(f64::NAN);
    check_tolerance(number).map(|()| number).map_err(|expected| format!("{text:?}, {expected}"))
}

/// Parses a number of boxes.
fn boxes(text: &str) -> Result<u64, String> {
    match text.trim().parse::<f64>() {
        Ok(boxes) if (1.0..=MOST_BOXES).contains(&boxes) && boxes.fract() == 0.0 => {
            Ok(boxes as u64)
        }
        _ => Err(format!("{text:?}, expected a whole number of boxes from 1 to {MOST_BOXES:e}")),
    }
}
