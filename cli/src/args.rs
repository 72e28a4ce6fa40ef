//! Every argument of the command line; the doc comments are the help.

use crate::linkage::input::InputValue;
use crate::plot::options::{PanelName, PictureSize};
use crate::pose::{GridAxis, Number, OverAxis, Pose, SliceValue};
use crate::transform::Transform;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, ValueEnum, ValueHint};
use opm_study::WorkspaceKind;
use opm_workspace::measure::check_tolerance;
use opm_workspace::{MOST_THREADS, Sections, Shard};
use std::path::PathBuf;

/// Columns of the help on a terminal that has as many.
const WIDEST: usize = 100;

/// Largest budget of a measure: no machine has the memory for more boxes.
const MOST_BOXES: f64 = 1e12;

/// Most samples per second. The clock of a recording counts nanoseconds; faster samples would coincide.
const HIGHEST_RATE: f64 = 1e9;

/// Kinematics and workspaces of overconstrained parallel manipulators
///
/// Reads a mechanism file, finds its partial subspaces and imaginary joints from the joint screws
/// alone, and solves joint values and workspaces in closed form.
///
/// Numbers without a unit are metres and radians; 10mm, 2.5cm, 1in, 15deg and 0.2rad carry theirs.
/// JSON, CSV and MCAP are always SI; text is in the units of the mechanism file.
///
/// Exit status: 0 done, 1 the work failed, 2 wrong usage, 130 interrupted.
#[derive(Debug, Parser)]
#[command(name = "opm", version, max_term_width = WIDEST, after_long_help = ROOT_EXAMPLES)]
pub struct Args {
    /// The subcommand.
    #[command(subcommand)]
    pub command: Command,
    /// Options of every subcommand.
    #[command(flatten)]
    pub output: Output,
}

const ROOT_EXAMPLES: &str = "\
Examples:
  opm examples                                         what comes with opm
  opm decompose plano-spherical-5dof                   how a mechanism falls into two sections
  opm ik plano-spherical-5dof --pose x=10mm,xi=15deg   joint values at a pose
  opm velocity plano-spherical-5dof --rates zeta=1     joint rates, and how near it is to singular
  opm fk translational-helical-3dof --joints S1=9mm,S2=-14mm,S3=5mm
                                                       poses at joint values
  opm workspace plano-spherical-5dof -o cloud.mcap     its workspace, for Foxglove or Rerun
  opm measure plano-spherical-5dof --section upper     its share of all orientations, with bounds
  opm merge part-*.mcap -o cloud.mcap                  the parts of a sweep, joined to one recording
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids -o play.mcap
                                                       a motion, as a recording that plays
  opm linkage bennett-double-spherical-6r              joint values of a loop with one input
  opm plot cloud.mcap -o cloud.svg                     a picture of a recording
  opm inspect cloud.mcap                               what a recording holds";

/// Options of every subcommand.
#[derive(Debug, clap::Args)]
pub struct Output {
    /// How results are printed
    #[arg(long, global = true, value_enum, default_value_t = Format::Text)]
    pub format: Format,
    /// No progress, notes or warnings: only results and errors
    #[arg(short, long, global = true)]
    pub quiet: bool,
}

/// How results are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// Tables for people, in the units of the mechanism file
    Text,
    /// One JSON object, in metres and radians
    Json,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    Decompose(DecomposeArgs),
    Ik(IkArgs),
    Velocity(VelocityArgs),
    Fk(FkArgs),
    Linkage(LinkageArgs),
    Trajectory(TrajectoryArgs),
    Workspace(WorkspaceArgs),
    Measure(MeasureArgs),
    Merge(MergeArgs),
    Plot(PlotArgs),
    Inspect(InspectArgs),
    Examples(ExamplesArgs),
    Completions(CompletionsArgs),
}

/// Find the partial subspaces and the imaginary joints of a mechanism
///
/// Splits every leg into a lower part, which moves in one subspace, and an upper part, which moves in
/// another; the two subspaces share one motion. A leg whose upper part cannot make that motion gets
/// an imaginary joint. Of several decompositions the preferred one comes first. The task coordinates are
/// measured in the frames that are printed; [task] in the file can set them.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm decompose plano-spherical-5dof
  opm decompose my-mechanism.toml --format json")]
pub struct DecomposeArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
}

/// Inverse kinematics: the joint values at a pose, or at every pose of a CSV file
///
/// A task coordinate that is not given has its home value; `opm decompose` lists the coordinates. A pose
/// out of reach is an answer (exit status 0): it names the legs that do not reach, and by how much.
///
/// --transform takes the platform's pose in SE(3) instead: the position of its reference point and the
/// quaternion of its orientation, both in base coordinates. The orientation at home is the identity, or
/// that of the Euler angles at home. If the manipulator cannot move the platform there at all, the answer
/// says by how much and in which direction (exit status 0). JSON has `transform` for every pose.
///
/// CSV in: a header of task coordinates in any order, then one row for each pose, in metres and radians.
/// CSV out: all task coordinates, `reachable` and `within_limits` (1 or 0), `mode`, the imaginary joints,
/// the actuated joints. A pose out of reach keeps its row; its joint cells are empty.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm ik plano-spherical-5dof --pose x=10mm,y=0,xi=15deg
  opm ik plano-spherical-5dof --pose xi=15deg --mode \"-+ ++ ++ +\"
  opm ik plano-spherical-5dof --pose xi=15deg --all-modes --format json
  opm ik plano-spherical-5dof --transform 10mm,0,0,0.8,0.6,0,0
  opm ik plano-spherical-5dof --poses poses.csv -o joints.csv
  generate-poses | opm ik plano-spherical-5dof --poses - | head")]
#[command(group = clap::ArgGroup::new("where").required(true).args(["pose", "poses", "transform"]))]
pub struct IkArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// One pose, for example x=10mm,y=0,xi=15deg
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub pose: Option<Pose>,
    /// Pose in SE(3): position of the reference point, and a unit quaternion, scalar first
    #[arg(long, value_name = "X,Y,Z,QW,QX,QY,QZ", allow_hyphen_values = true)]
    pub transform: Option<Transform>,
    /// A CSV file of poses; - reads standard input
    #[arg(long, value_name = "IN.csv", value_hint = ValueHint::FilePath)]
    pub poses: Option<PathBuf>,
    /// Every working mode in which the pose is in reach, not just one
    #[arg(long, conflicts_with = "mode")]
    pub all_modes: bool,
    /// Working mode: `home`, or a sign for every two-valued choice, grouped by leg ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Output file for the CSV; standard output if it is - or not given
    #[arg(
        short,
        long,
        value_name = "OUT.csv",
        requires = "poses",
        conflicts_with_all = ["pose", "transform"],
        value_hint = ValueHint::FilePath
    )]
    pub output: Option<PathBuf>,
}

/// Velocities: the rates of every joint for rates of the task coordinates, at a pose
///
/// Also prints the Jacobian of the actuated joints, and how near the pose is to a singularity of each
/// section: signed measures that are zero at a singularity, with the legs that come nearest to it. Serial:
/// a leg is stretched, folded or flat, and its joints have no rates there (null). Parallel: the platform
/// can move although the inputs are locked; null if there are too few inputs to hold the section at all.
///
/// The condition number relates the actuated joints to the platform's twist, with lengths divided by
/// --length. It is null if it is infinite: at a singularity, or with fewer actuators than freedoms.
/// Singularities of the Euler angles (xi = 0) are not counted; `coordinates` is 0 there. A pose out of
/// reach is an answer (exit status 0).
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm velocity plano-spherical-5dof --pose x=10mm,xi=15deg --rates zeta=1,x=10mm
  opm velocity plano-spherical-5dof --rates psi=15deg --mode \"-+ ++ ++ +\"
  opm velocity translational-helical-3dof --rates phi=1 --length 100mm --format json")]
pub struct VelocityArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// The pose, for example x=10mm,xi=15deg; other coordinates stay at home
    #[arg(long, value_name = "NAME=VALUE,...", default_value = "", hide_default_value = true)]
    pub pose: Pose,
    /// Rates of the task coordinates per second, for example zeta=1,x=10mm; other rates are 0
    #[arg(long, value_name = "NAME=VALUE,...", default_value = "", hide_default_value = true)]
    pub rates: Pose,
    /// Working mode: `home`, or a sign for every two-valued choice, grouped by leg ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Characteristic length of the condition number, instead of the spread of the joint axes
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<Number>,
}

/// Forward kinematics: every pose that given actuated joints allow
///
/// If the mechanism's sections can be solved one after the other, the closed form finds all assemblies,
/// each with its working mode and with how well its legs close (`residual`, radians and shares of the
/// mechanism's size). Otherwise, or with --near, Newton's method starts from a pose and finds one assembly,
/// in the working mode of --mode or home.
///
/// No assembly is an answer (exit status 0): it names what does not meet, and by how much. Angles count
/// modulo a revolution, except where a screw joint follows them: each revolution is then an assembly of its
/// own, one advance of the screw away. `opm ik` does not count revolutions; the angles in --joints decide.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm fk plano-spherical-5dof --joints S1=170mm,S2=165mm,S3=160mm,phi14=-150deg,phi24=130deg
  opm fk plano-spherical-5dof --joints S1=0.17,S2=0.16,S3=0.16,phi14=-2.7,phi24=2.3 --mode home
  opm fk plano-spherical-5dof --joints S1=0.17,S2=0.17,S3=0.17,phi14=-2.7,phi24=2.3 --near xi=10deg
  opm fk translational-planar-4dof --joints S1=10mm,S2=0,S3=0,S4=-10mm --format json")]
pub struct FkArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// The value of every actuated joint, for example S1=10mm,phi14=15deg
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub joints: Pose,
    /// Start Newton's method at this pose; other coordinates start at home
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub near: Option<Pose>,
    /// Only assemblies in this working mode: `home`, or a sign for every two-valued choice
    #[arg(long, value_name = "MODE", allow_hyphen_values = true)]
    pub mode: Option<String>,
}

/// Positions of a linkage: every joint for one value of its input, or for a revolution of it
///
/// The linkage is a single loop that decomposes into the loops of two sections, which share an imaginary
/// joint: planar or spherical four-bars, slider-cranks, coaxial joints (Sarrus' linkage, Bennett's double
/// spherical and plano-spherical 6R). Any joint can be the input; without --input it is the actuated one,
/// at home. The answer has every branch, named by its signs, and the range of the input; in JSON, a range
/// without an end has null there. An input out of its range is an answer (exit status 0).
///
/// --sweep follows the branch of home for one round. An input that can make a revolution makes one.
/// Otherwise it goes to the end of its range, back in the branch that meets the first one there, and so on
/// until the linkage is home. CSV: all joints, the imaginary joint, `branch`, `within_limits` (1 or 0), in
/// radians and metres. MCAP: `/joints` and `/imaginary_joints`; a round takes ten seconds.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm linkage bennett-double-spherical-6r --input a1=30deg
  opm linkage bennett-double-spherical-6r --input b3=10deg --format json
  opm linkage sarrus --input a1=45deg
  opm linkage bennett-double-spherical-6r --input a1 --sweep > turn.csv
  opm linkage bennett-double-spherical-6r --sweep --count 1001 -o turn.mcap")]
pub struct LinkageArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
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
/// The motion is a TOML file of sinusoids (duration, rate, and for each task coordinate a constant or a
/// sum of sinusoids), a CSV file of times and poses, which cubic splines join (a header of t and task
/// coordinates, in seconds, metres and radians), or the name of a shipped motion. The working mode
/// stays the same, and angles are continuous.
///
/// Where the mechanism cannot follow, the answer says when, which leg or joint, and by how much: out of
/// reach, past the limit of a joint (passive joints too), through a singularity. Violations between two
/// samples are found too, unless one comes and goes more than once there. The rest of the motion is
/// recorded; with --strict the exit status is then 1.
///
/// The recording has joints, rates, accelerations, imaginary joints, pose and condition number to plot,
/// and the mechanism as solid bodies: /scene and /tf in Foxglove and Lichtblick, the points of /bodies in
/// Rerun.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids -o play.mcap
  opm trajectory translational-helical-3dof --motion translational-helical-sinusoids --rate 1000
  opm trajectory plano-spherical-5dof --motion plano-spherical-sinusoids --strict --format json")]
pub struct TrajectoryArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// The motion: a TOML or CSV file, or the name of a shipped one
    #[arg(long, value_name = "M.toml|M.csv", value_hint = ValueHint::FilePath)]
    pub motion: PathBuf,
    /// Record it in this MCAP file
    #[arg(short, long, value_name = "OUT.mcap", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// Samples per second, instead of the motion file's rate (100 for a CSV file)
    #[arg(long, value_name = "HZ", allow_hyphen_values = true, value_parser = rate)]
    pub rate: Option<f64>,
    /// Working mode: `home`, or a sign for every two-valued choice, instead of that of the motion file
    #[arg(long, value_name = "MODE", allow_hyphen_values = true)]
    pub mode: Option<String>,
    /// Exit with status 1 if the mechanism cannot follow all of it
    #[arg(long)]
    pub strict: bool,
}

/// Sweep a grid of poses: how many are in reach, and where they are
///
/// Without --grid the grid is fitted to the workspace; with it, a coordinate that is not given stays
/// at home. Counts the poses in reach and within all joint limits; with -o, records them as point
/// clouds in an MCAP file for Foxglove, Lichtblick or Rerun: an overview, and every point slice by
/// slice.
///
/// --kind selects another set than that of poses. A place is one value for each coordinate of the lower
/// section (for example x and y), an orientation one value for each coordinate of the upper section.
/// `reachable` and `dexterous` store with each place the share of the orientations that reach it, as
/// `share`. The lower section alone has the imaginary joints as coordinates too, by their names; they stay
/// at home unless --grid says otherwise. The whole workspace is where `lower` and `upper` agree on the
/// imaginary joints.
///
/// Boundary and connected components are given for every kind; for `grid`, add --shape. A boundary needs a
/// set that varies in two coordinates, or in slices of a third. It consists of closed lines with the inside
/// on their left: in the JSON output, in the recording, and in the picture that `opm plot` makes of it.
/// `imaginary` has neither boundary nor measure, since values of joints lie on no grid.
///
/// --max-condition keeps away from singularities: see `opm velocity`. It is decided pose by pose, which
/// takes longer, and does not change the grid that is fitted.
///
/// -o points.npy writes a structured NumPy array (float64) of the coordinates and joints that --axes,
/// --scalars and --color name. -o cloud.ply writes a binary PLY file whose vertices are the points of the
/// cloud. Without --scalars, both have every task coordinate; PLY leaves out those named x, y or z. The
/// columns come in the order --axes, --scalars, --color, and none comes twice. Without --axes, coordinates
/// that vary come first; without --scalars, the other task coordinates come last. Select columns by name:
/// `points["x"]`; `points.dtype.names` lists them. Both formats hold poses only: the kinds reachable,
/// dexterous, imaginary, upper and lower, and all shards, are written as MCAP only.
///
/// --shard sweeps one part of the grid, so that several machines can share the work. A shard whose file
/// exists already is not swept again. `opm merge` joins the parts, and takes --axes, --color, --scalars and
/// --shape.
///
/// `measure` is the reachable fraction of the volume of the grid's box, over the coordinates with more than
/// one value. It is an estimate: it may be too small by half a step at every edge of the box that the
/// workspace does not touch. Angles have equal weight. `opm measure` gives bounds, and weighs orientations
/// by the Haar measure. `seconds` is the time of the count.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm workspace plano-spherical-5dof
  opm workspace plano-spherical-5dof -o cloud.mcap --color theta11
  opm workspace plano-spherical-5dof --grid x=-200mm:200mm:201 --grid y=-200mm:200mm:201
  opm workspace plano-spherical-5dof --grid xi=0:90deg:91 --grid x=10mm --mode any
  opm workspace plano-spherical-5dof --grid xi=-20deg:20deg:41 --max-condition 20
  opm workspace plano-spherical-5dof --kind constant-orientation --conditioning
  opm workspace plano-spherical-5dof --kind reachable -o places.mcap
  opm workspace plano-spherical-5dof --kind lower --grid x=0:0.2:201 --grid theta11=-0.7:0.9:17
  opm workspace plano-spherical-5dof --shard 3/8 -o part-3.mcap
  opm workspace translational-helical-3dof --axes x,y,phi -o cloud.mcap --scalars S,S1,S2,S3")]
pub struct WorkspaceArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// What the workspace consists of
    #[arg(long, value_name = "KIND", value_parser = kind(), default_value = "grid")]
    pub kind: WorkspaceKind,
    /// Values of one task coordinate: minimum, maximum and number of values, or a single value
    #[arg(long, value_name = "AXIS=MIN:MAX:COUNT|AXIS=VALUE")]
    pub grid: Vec<GridAxis>,
    /// Working mode: `home`, `any`, or a sign for every two-valued choice ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Count a pose only if its condition number is at most C in one of the working modes
    #[arg(long, value_name = "C", value_parser = condition_number, allow_hyphen_values = true)]
    pub max_condition: Option<f64>,
    /// Also compute the global conditioning index, the mean of 1 / condition number (a few us per pose)
    #[arg(long)]
    pub conditioning: bool,
    /// Characteristic length of condition numbers, instead of the spread of the joint axes
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<Number>,
    /// Also find the boundary and the connected components, as all kinds but `grid` do
    #[arg(long)]
    pub shape: bool,
    /// Sweep only part I of N (I counts from 1), and write it to -o, for `opm merge`
    #[arg(
        long,
        value_name = "I/N",
        requires = "output",
        conflicts_with_all = ["axes", "color", "scalars", "shape"]
    )]
    pub shard: Option<Shard>,
    /// Sweep a shard even if its file exists, and replace the file
    #[arg(long, requires = "shard")]
    pub force: bool,
    /// How points are recorded.
    #[command(flatten)]
    pub cloud: CloudArgs,
    /// Number of threads, instead of one per processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
}

/// How points are recorded.
#[derive(Debug, clap::Args)]
pub struct CloudArgs {
    /// Record the points in this file: MCAP, a NumPy array (its columns are --axes, then --scalars,
    /// then --color), or a PLY cloud for mesh tools
    #[arg(short, long, value_name = "OUT.mcap|.npy|.ply", value_hint = ValueHint::FilePath)]
    pub output: Option<PathBuf>,
    /// x, y and z of the cloud: three coordinates (for the kind `imaginary`, three imaginary joints), or
    /// `tip`, the position of the reference point
    #[arg(long, value_name = "A,B,C|tip", requires = "output", value_delimiter = ',')]
    pub axes: Vec<String>,
    /// The value that the colour shows: a task coordinate, an imaginary joint, an actuated joint, or
    /// `inverse_condition`, one over the condition number
    #[arg(long, value_name = "NAME", requires = "output")]
    pub color: Option<String>,
    /// Values stored with every point, with names as for --color
    #[arg(long, value_name = "A,B,...", requires = "output", value_delimiter = ',')]
    pub scalars: Option<Vec<String>>,
}

/// Join the shards of a sweep into the result of a single run
///
/// Takes all files of `opm workspace --shard`, in any order, and prints what a single run prints. Only the
/// time is unknown: `seconds` and `poses_per_second` are null. With -o, the recording equals that of a
/// single run byte for byte. Shards of different runs are an error, and so are two files of the same part.
/// If parts are missing, the error message lists the commands that make them.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  seq 8 | xargs -P 4 -I {} opm workspace plano-spherical-5dof --shard {}/8 -o part-{}.mcap
  opm merge part-*.mcap
  opm merge part-*.mcap -o cloud.mcap --color theta11")]
pub struct MergeArgs {
    /// The files of all shards
    #[arg(value_name = "PART.mcap", required = true, value_hint = ValueHint::FilePath)]
    pub parts: Vec<PathBuf>,
    /// Also find the boundary and the connected components, as all kinds but `grid` do
    #[arg(long)]
    pub shape: bool,
    /// How points are recorded.
    #[command(flatten)]
    pub cloud: CloudArgs,
    /// Number of threads, instead of one per processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
}

/// Measure the workspace: area, volume, share of all orientations, with guaranteed bounds
///
/// The ranges of --over are covered with boxes. Each box is proved to be inside the workspace or outside of
/// it, or is undecided. The least certain boxes are split until the measure is certain to within --tolerance
/// of its value. The bounds hold however the command ends, Ctrl-C
/// included, and do not depend on the number of threads. A pose counts as in `opm workspace`: if it is in
/// reach and within all joint limits.
///
/// The measure is taken over the product of all ranges. Orientations are weighed by the Haar measure, which
/// is uniform over rotations: xi by sin xi, nu by cos(nu - home). All orientations, each once, are
/// zeta=-180deg:180deg, xi=0:180deg, psi=-180deg:180deg, together 8 pi^2 rad^3. A range from negative to
/// positive xi counts orientations twice if zeta has a full revolution.
///
/// The number of boxes depends on how many coordinates have a range, and on the widths of the ranges. Three
/// coordinates take some thousand boxes. Five with full revolutions among them take more than the default
/// --budget; the result and a warning then say which accuracy was reached. To improve it, use narrower
/// ranges of --over, --section upper, or a larger --budget.
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
  opm measure plano-cylindrical-4dof --mode any --budget 1000000 --format json")]
pub struct MeasureArgs {
    /// Mechanism file, or the name of a shipped example
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
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
    #[arg(long, value_name = "BOXES", default_value = "4000000", value_parser = boxes, allow_hyphen_values = true)]
    pub budget: u64,
    /// Number of threads, instead of one per processor
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
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

/// Parses a kind of workspace; the help lists the names.
fn kind() -> impl TypedValueParser<Value = WorkspaceKind> {
    let value = |kind: WorkspaceKind| PossibleValue::new(kind.name()).help(kind.description());
    let names = PossibleValuesParser::new(WorkspaceKind::ALL.map(value));
    names.try_map(|name| name.parse::<WorkspaceKind>())
}

/// Parses the tolerance, a share of a measure.
fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.trim().parse().unwrap_or(f64::NAN);
    check_tolerance(number).map(|()| number).map_err(|expected| format!("{text:?}, {expected}"))
}

/// Parses a number of samples per second.
fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if rate > 0.0 && rate <= HIGHEST_RATE => Ok(rate),
        _ => Err(format!("expected a number of hertz above 0 and at most {HIGHEST_RATE:e}")),
    }
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

/// Parses the largest condition number that counts.
fn condition_number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number >= 1.0 && number.is_finite() => Ok(number),
        _ => Err(format!("{text:?}, expected a number of at least 1")),
    }
}

/// Draw a recording as a picture, SVG or PNG
///
/// The picture of a motion shows poses, imaginary joints, actuated joints and their velocities over time;
/// each value is beside its velocity. Spans in which the mechanism cannot follow are shaded. The picture of
/// a workspace shows slices, and the values that the imaginary joints take if they were recorded
/// (`opm workspace --scalars`). Numbers are in the units of the mechanism file, which is part of the
/// recording. An unfinished .partial file can be drawn too, as far as it was written.
///
/// Pictures stay small: curves of more than 32768 samples are drawn by their extremes in 4096 spans of
/// time, and a panel of more than 5000 cells or dots becomes an image within the picture. Fonts are part of
/// the program.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm plot cloud.mcap -o cloud.svg
  opm plot cloud.mcap -o tilted.png --slice zeta=0,psi=0,xi=30deg,xi=60deg
  opm plot cloud.mcap -o joints.svg --panels imaginary --values theta11,theta12
  opm plot turn.mcap -o turn.png --values a1,b3 --size 900x300")]
pub struct PlotArgs {
    /// MCAP file of `opm workspace`, `opm linkage` or any other command that records
    #[arg(value_name = "RECORDING", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
    /// Output file; its ending selects the format
    #[arg(short, long, value_name = "OUT.svg|OUT.png", value_hint = ValueHint::FilePath)]
    pub output: PathBuf,
    /// Panels to draw, instead of those that suit the recording
    #[arg(long, value_name = "NAME,...", value_enum, value_delimiter = ',')]
    pub panels: Vec<PanelName>,
    /// Only these values: for a motion, joints or task coordinates; for a workspace, the two task
    /// coordinates that the slices show, or stored values instead of the imaginary joints
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub values: Vec<String>,
    /// Slices of a workspace: task coordinates are held at the grid values nearest to these. One
    /// coordinate may have several values, with a slice for each
    #[arg(long, value_name = "NAME=VALUE,...", value_delimiter = ',')]
    pub slice: Vec<SliceValue>,
    /// Width and height in screen pixels, up to 4000 each, instead of a size that suits the panels; a
    /// PNG has twice as many pixels
    #[arg(long, value_name = "WxH")]
    pub size: Option<PictureSize>,
}

/// List the contents of a recording
///
/// Prints topics with their schemas and counts, the range of every value of the points, the run that made
/// the recording, and whether it is complete. An unfinished .partial file can be read too, as far as it was
/// written.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm inspect cloud.mcap
  opm inspect cloud.mcap.partial --format json")]
pub struct InspectArgs {
    /// MCAP file
    #[arg(value_name = "FILE.mcap", value_hint = ValueHint::FilePath)]
    pub file: PathBuf,
}

/// List the mechanisms and motions that come with opm, or print one
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm examples
  opm examples plano-spherical-5dof > my-mechanism.toml")]
pub struct ExamplesArgs {
    /// The example to print
    #[arg(value_name = "NAME")]
    pub name: Option<String>,
}

/// Print a completion script for a shell
///
/// The output is the script itself; --format has no effect.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm completions bash > ~/.local/share/bash-completion/completions/opm
  opm completions fish > ~/.config/fish/completions/opm.fish")]
pub struct CompletionsArgs {
    /// The shell
    #[arg(value_name = "SHELL", value_enum)]
    pub shell: clap_complete::Shell,
}

#[cfg(test)]
mod tests {
    use super::{Args, WIDEST};
    use clap::CommandFactory;

    #[test]
    fn arguments_do_not_contradict_each_other() {
        Args::command().debug_assert();
    }

    /// Examples are copied line by line, so no line may be wider than the help on a terminal.
    #[test]
    fn examples_in_the_help_are_not_wrapped() {
        let program = Args::command();
        let of = |command: &clap::Command| command.get_after_long_help().map(ToString::to_string);
        let examples: Vec<String> =
            program.get_subcommands().chain([&program]).filter_map(of).collect();
        assert!(examples.len() > 10);
        for line in examples.iter().flat_map(|text| text.lines()) {
            assert!(line.chars().count() <= WIDEST, "{line:?}");
        }
    }
}
