//! Arguments of the commands that follow a motion: of a platform, or of a single loop.

use super::{MechanismArgs, MotionTableArgs, SetupArgs, ToolArgs, heading};
use crate::linkage::input::{CouplerPoint, InputValue};
use crate::pose::{GridAxis, Number};
use clap::{ValueEnum, ValueHint};
use opm_core::motion::Ends;
use std::path::PathBuf;

/// Most samples per second. The clock of a recording counts nanoseconds; faster samples would coincide.
const HIGHEST_RATE: f64 = 1e9;

/// Positions of a linkage: every joint for one value of its input, or for a revolution of it
///
/// The linkage is a single loop of two legs with one freedom: four-bars, slider-cranks, RSSR, Bennett's, Bricard's, any. Loops of
/// two sections that share an imaginary joint (Sarrus' linkage, Bennett's double spherical and plano-spherical 6R) are solved in
/// closed form, and a branch is named by its two signs. All others are traced, and all their assemblies are looked for: a branch
/// is an arc along which the input moves one way, with a number, 1 for home's. Any joint that moves can be the input; without
/// --input it is the actuated one, at home. The answer has every branch, and the range of the input; in JSON, a range without an
/// end has null there. An input out of its range is an answer (exit status 0).
///
/// --sweep follows the branch of home for one round. An input that can make a revolution makes one.
/// Otherwise it goes to the end of its range, back in the branch that meets the first one there, and so on
/// until the linkage is home. CSV: all joints, the imaginary joint if there is one, `branch`, `within_limits` (1 or 0), in
/// radians and metres, and with --coupler the columns `coupler.x`, `coupler.y` and `coupler.z`. MCAP: `/joints` and `/imaginary_joints`; a round takes ten seconds.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm linkage bennett-double-spherical-6r --input a1=30deg
  opm linkage bennett-double-spherical-6r --input b3=10deg --format json
  opm linkage sarrus --input a1=45deg
  opm linkage bennett-double-spherical-6r --input a1 --sweep > round.csv
  opm linkage sarrus --sweep --coupler 0,0,160mm > curve.csv
  opm linkage bennett-double-spherical-6r --sweep --count 1001 -o round.mcap")]
pub struct LinkageArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The joint that moves the linkage, and its value if it is not at home
    #[arg(long, value_name = "NAME[=VALUE]")]
    pub input: Option<InputValue>,
    /// One round of the input instead of one value
    #[arg(long)]
    pub sweep: bool,
    /// Number of positions of the sweep; the first and the last are home
    #[arg(
        long,
        value_name = "N",
        requires = "sweep",
        default_value_t = 361,
        value_parser = clap::value_parser!(u32).range(2..=10_000_000)
    )]
    pub count: u32,
    /// A point of the platform, where it is at home, in base coordinates: its place at each position, in a sweep its coupler
    /// curve
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub coupler: Option<CouplerPoint>,
    /// Solve for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true, conflicts_with_all = ["sweep", "coupler"])]
    pub vary: Option<GridAxis>,
    /// Output file, in the format of its ending; CSV on standard output if it is - or not given
    #[arg(
        short,
        long,
        value_name = "OUT.csv|OUT.mcap",
        requires = "sweep",
        value_hint = ValueHint::FilePath
    )]
    pub output: Option<PathBuf>,
}

/// Follow a motion of the platform: every joint, its speed and acceleration, as a recording that plays
///
/// The motion is a TOML file (duration, rate, and for each task coordinate a constant or a sum of
/// sinusoids; or points that cubic splines join), a CSV file of times and poses, which cubic splines join (a
/// header of t and task coordinates, in seconds, metres and radians; two rows are enough), or the name of a
/// shipped motion. A table may have places in SE(3) instead: t,x,y,z,qx,qy,qz,qw, metres and a unit quaternion; or be one of
/// the TUM benchmark (.tum or .txt: lines of t x y z qx qy qz qw with blanks, without a header). Splines start and end at rest, unless --ends or `ends` in the file says otherwise. The
/// working mode stays the same, and angles are continuous.
///
/// Where the mechanism cannot follow, the answer says when, which leg or joint, and by how much: out of
/// reach, past the limit of a joint (passive joints too), above its max_rate or max_acceleration, through a
/// singularity. Violations between two samples are found too, unless one comes and goes more than once
/// there. The rest of the motion is recorded; with --strict the exit status is then 1.
///
/// Two bodies that are nearer than --clearance, or that overlap without it, interfere: when, which two, and how near,
/// between samples too. The recording shows them red. The answer also names the nearest two of the whole motion.
///
/// --time-optimal keeps the sequence of poses and replaces the times: the platform starts and ends at rest, and moves
/// as fast as the limits of rates, accelerations and efforts (max_effort) in the mechanism file let it. Every actuated joint needs a
/// max_acceleration or a max_effort. Efforts are those of --efforts, with the same gravity and --wrench. --tool-speed,
/// --tool-acceleration, --tool-angular-speed and --tool-angular-acceleration cap the motion of the platform's reference point, and how
/// the platform turns, too. Joints need no limits where both accelerations are capped, or the one that the platform has.
///
/// --indices needs -o. --wrench, --gravity and --link-stiffness are those of `opm analyze`, and need --indices, --efforts or
/// --reactions.
///
/// --efforts gives what a motor is bought by: the peak and the root mean square of each actuator's effort along the motion, and its
/// power, with the inertia and the weight of all bodies (docs/dynamics.md). Masses are those of [bodies] in the file, or follow from
/// the shapes; gravity is 9.81 m/s² along -z if --gravity does not say otherwise. --reactions gives what bearings and links are bought by: what
/// passes through each joint, also of overconstrained legs, which share it by their stiffness (--link-stiffness, --joint-stiffness).
///
/// The recording (.mcap) has joints, rates, accelerations, imaginary joints, pose and condition number to plot,
/// and the mechanism as solid bodies: /scene and /tf in Foxglove and Lichtblick, the points of /bodies in
/// Rerun.
///
/// A table (.csv, or .npy for NumPy) has a row for each sample: `t`, the task coordinates, those that depend on
/// them, every joint, actuated or passive, and the imaginary joints, by their names. --rates adds `d.NAME` for each
/// of these but `t`, and --accelerations `dd.NAME`: derivatives of the coordinates themselves, so those of an
/// Euler angle are no angular velocity. --efforts adds `effort.NAME` for each actuated joint, N and N m;
/// a recording has them in /indices, and `opm plot` draws them with their max_effort. Out of reach, and where a joint has no rate, a cell is empty (NaN in NPY).
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids -o play.mcap
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids -o joints.csv --rates
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids --efforts
  opm trajectory translational-helical-3dof --motion translational-helical-sinusoids --rate 1000
  opm trajectory translational-helical-3dof --motion translational-helical-sinusoids \\
    --time-optimal --set max_acceleration.S=2
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids --time-optimal \\
    --tool-speed 200mm/s --tool-acceleration 2m/s2 --tool-angular-acceleration 5rad/s2
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids --strict --format json")]
pub struct TrajectoryArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The motion: a TOML or CSV file, one of the TUM benchmark, or the name of a shipped one
    #[arg(long, value_name = "M.toml|M.csv|M.tum", value_hint = ValueHint::FilePath)]
    pub motion: PathBuf,
    /// Output file, in the format of its ending; - prints a table as CSV
    #[arg(short, long, value_name = "OUT.mcap|OUT.csv|OUT.npy", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Also the rates in the table: first derivatives by time, as d.NAME
    #[arg(help_heading = heading::WRITTEN, long, requires = "output")]
    pub rates: bool,
    /// Also the accelerations in the table: second derivatives by time, as dd.NAME
    #[arg(help_heading = heading::WRITTEN, long, requires = "output")]
    pub accelerations: bool,
    /// Also the indices of `opm analyze` (lti, effort_per_force, clearance, ...) in the table or the recording, and the
    /// efforts of joints with --wrench or --gravity, as effort.NAME
    #[arg(help_heading = heading::WRITTEN, long, requires = "output")]
    pub indices: bool,
    /// The efforts of the actuators that move the mechanism: peak, root mean square and power of each, and effort.NAME in the
    /// table or the recording
    #[arg(help_heading = heading::WRITTEN, long, conflicts_with = "indices")]
    pub efforts: bool,
    /// What passes through each joint in the motion, with --link-stiffness: its largest force and moment, and reaction.NAME.FX
    /// ... MZ in the table
    #[arg(help_heading = heading::WRITTEN, long)]
    pub reactions: bool,
    /// What indices, efforts and reactions are computed with.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// Units of the table: SI and radians, or those of the mechanism file, which the header then names
    #[arg(help_heading = heading::WRITTEN, long, value_enum, default_value_t = TableUnits::Si, requires = "output")]
    pub units: TableUnits,
    /// How a table of poses is read.
    #[command(flatten)]
    pub table: MotionTableArgs,
    /// How the motion through the poses of a CSV file starts and ends
    #[arg(help_heading = heading::TABLE, long, value_enum)]
    pub ends: Option<EndsName>,
    /// Samples per second, instead of the motion file's rate (100 for a CSV file)
    #[arg(long, value_name = "HZ", allow_hyphen_values = true, value_parser = rate)]
    pub rate: Option<f64>,
    /// Working mode: `home`, or a sign for every two-valued choice, instead of that of the motion file
    #[arg(long, value_name = "MODE", allow_hyphen_values = true)]
    pub mode: Option<String>,
    /// The fastest timing along the same path, from rest to rest, within the joints' max_rate, max_acceleration and max_effort
    #[arg(long)]
    pub time_optimal: bool,
    /// Caps of the tool's motion in the fastest timing.
    #[command(flatten)]
    pub tool: ToolArgs,
    /// Least distance of two bodies, for example 5mm: where it is less, they interfere; with --strict that is a failure,
    /// too
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub clearance: Option<Number>,
    /// Follow it for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true, conflicts_with_all = ["output", "strict"])]
    pub vary: Option<GridAxis>,
    /// Exit with status 1 if the mechanism cannot follow all of it
    #[arg(long)]
    pub strict: bool,
}

/// The units of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TableUnits {
    /// Metres and radians; the header has names alone
    Si,
    /// Those of the mechanism file; the header has `S1 [mm]`
    File,
}

/// How a spline starts and ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum EndsName {
    /// Without speed
    Rest,
    /// Without acceleration
    Natural,
    /// As it ends, so it starts
    Periodic,
}

impl From<EndsName> for Ends {
    fn from(name: EndsName) -> Self {
        match name {
            EndsName::Rest => Self::Rest,
            EndsName::Natural => Self::Natural,
            EndsName::Periodic => Self::Periodic,
        }
    }
}

/// Parses a number of samples per second.
fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if rate > 0.0 && rate <= HIGHEST_RATE => Ok(rate),
        _ => Err(format!("expected a number of hertz above 0 and at most {HIGHEST_RATE:e}")),
    }
}
