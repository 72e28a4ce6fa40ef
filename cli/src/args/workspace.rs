//! Arguments of the commands that sweep a workspace, and join the shards of one.

use super::{MechanismArgs, SetupArgs, heading};
use crate::pose::{GridAxis, IndexLimit, Number, Pose};
use clap::ValueHint;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use opm_study::{AxisScale, WorkspaceKind};
use opm_workspace::{InscribedShape, MOST_THREADS, Shard};
use std::path::PathBuf;

/// Sweep a grid of poses: how many are in reach, and where they are
///
/// Without --grid the grid is fitted to the workspace; with it, a coordinate that is not given stays
/// at home. Counts the poses in reach and within all joint limits; with -o, records them as point
/// clouds in an MCAP file for Foxglove, Lichtblick or Rerun: an overview, and every point slice by
/// slice.
///
/// --kind selects another set than that of poses. A place is one value for each coordinate of the lower
/// section (for example x and y), an orientation one value for each coordinate of the upper section. Where
/// all legs move in one subspace, its lengths are the place and its angles the orientation.
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
/// `aspects` are connected parts of the poses in one working mode that have no singularity: number, sign of the parallel
/// measure, poses, measure and extent of each, and singularity curves in JSON and in the picture. A recording stores with each
/// point the number of its aspect, as `aspect`, with 0 for a singular pose. `opm path` finds paths in them.
///
/// --max-condition keeps away from singularities: see `opm velocity`. --limit does so with an index of
/// `opm analyze`: --limit lti=0.7 leaves the good-transmission workspace. Both are decided pose by pose, which
/// takes longer, and do not change the grid that is fitted.
///
/// --wrench, --gravity and --link-stiffness are those of `opm analyze`: indices that depend on a load or on springs need
/// them, as do the efforts of joints (effort.NAME) for --color and --scalars.
///
/// --clearance keeps links, platform and obstacles apart: links are rods between their joints, with the radii of the
/// mechanism file, where obstacles stand, too. It is decided by bounds over boxes of poses, and pose by pose where these do
/// not tell. It needs one working mode, and does not change the grid that is fitted. Pairs that overlap at home are not
/// tested; they are named.
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
/// --inscribed takes each point for a cell of the grid, and what lies beyond the grid for outside. A disc or a ball is the
/// largest in these cells, to 1e-9 of its radius. A box is inside the boundary that is drawn, which cuts the corners of
/// cells and ends with its points: the largest with sides at points or half-way between them. Where between two points the
/// workspace ends is known to half a step, for a disc or a ball to half of a cell's diagonal. The disc in --kind dexterous
/// is the regular dexterous workspace.
///
/// --explain solves every pose of the grid. A leg that is out of reach has no joint values, so that its limits reject
/// nothing there. With --mode any, what rejects a pose `alone` is what would have to go in one of the modes, and a leg
/// that reaches the pose in one of them rejects nothing. With -o OUT.mcap the rejected points are recorded too, coloured by
/// what rejects them, and `opm plot` draws them; a place has the cause of most of its orientations.
///
/// The size in coordinates (`measure` in JSON) is the reachable fraction of the volume of the grid's box, over the
/// coordinates with more than one value. It is an estimate: it may be too small by half a step at every edge of the box that the
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
  opm workspace plano-spherical-5dof --grid x=-0.2:0.2:201 --grid y=-0.2:0.2:201 --clearance 2mm
  opm workspace plano-spherical-5dof --grid x=-0.2:0.2:99 --grid y=-0.2:0.2:99 --limit lti=0.7
  opm workspace plano-spherical-5dof --grid x=-0.2:0.2:41 --wrench 10,0,0,0,0,0 --limit effort=20
  opm workspace plano-spherical-5dof --kind constant-orientation --conditioning
  opm workspace plano-spherical-5dof --kind reachable -o places.mcap
  opm workspace planar-3rrr --kind dexterous --grid x=-0.1:0.1:41 --grid theta=-10deg:10deg:5
  opm workspace planar-3rrr --kind dexterous --grid x=-0.1:0.1:41 --grid y=-0.1:0.1:41 \\
      --grid theta=-10deg:10deg:5 --inscribed disc
  opm workspace plano-spherical-5dof --grid x=-0.3:0.3:61 --grid y=-0.3:0.3:61 --explain \\
      -o rejected.mcap
  opm workspace plano-spherical-5dof --grid x=-0.3:0.3:61 --vary h=100mm:160mm:7
  opm workspace plano-spherical-5dof --coordinates tilt-torsion --kind dexterous \\
      --grid tilt=20deg --grid azimuth=-180deg:170deg:36 --grid x=-0.2:0.2:81 --grid y=-0.2:0.2:81
  opm workspace plano-spherical-5dof --kind lower --grid x=0:0.2:201 --grid theta11=-0.7:0.9:17
  opm workspace planar-3rrr --kind aspects --grid x=-0.2:0.2:81 --grid y=-0.2:0.2:81
  opm workspace plano-spherical-5dof --shard 3/8 -o part-3.mcap
  opm workspace translational-helical-3dof --axes x,y,phi -o cloud.mcap --scalars S,S1,S2,S3")]
pub struct WorkspaceArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
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
    #[arg(help_heading = heading::COUNTS, long, value_name = "C", value_parser = condition_number, allow_hyphen_values = true)]
    pub max_condition: Option<f64>,
    /// Count a pose only if all bodies are at least this far apart, for example 5mm: see `opm ik` for the nearest two
    #[arg(help_heading = heading::COUNTS, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub clearance: Option<Number>,
    /// Count a pose only if an index of `opm analyze` is as good as VALUE: lti=0.7, payload=50, effort=20 with --wrench,
    /// stiffness=1e5 with --link-stiffness (repeatable)
    #[arg(help_heading = heading::COUNTS, long, value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub limit: Vec<IndexLimit>,
    /// What indices are computed with.
    #[command(flatten)]
    pub setup: SetupArgs,
    /// Also compute the global conditioning index, the mean of 1 / condition number
    #[arg(help_heading = heading::ALSO, long)]
    pub conditioning: bool,
    /// Characteristic length of condition numbers, instead of the spread of the joint axes
    #[arg(help_heading = heading::ALSO, long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<Number>,
    /// Also find the boundary and the connected components, as all kinds but `grid` do
    #[arg(help_heading = heading::ALSO, long)]
    pub shape: bool,
    /// Also find what rejects the other poses: for each leg, joint and limit, how many it rejects alone, and how many
    /// with others
    #[arg(long, conflicts_with_all = ["shard", "max_condition", "limit", "clearance", "vary", "all_modes"])]
    pub explain: bool,
    /// Also find the largest disc, ball or box in the set of points
    #[arg(help_heading = heading::ALSO, long, value_name = "disc|ball|box", value_parser = inscribed(), conflicts_with = "shard")]
    pub inscribed: Option<InscribedShape>,
    /// Centre of --inscribed, in every coordinate in which the set varies; without it, the best one
    #[arg(help_heading = heading::ALSO, long, value_name = "x=..,y=..", requires = "inscribed", allow_hyphen_values = true)]
    pub centre: Option<Pose>,
    /// Sweep for each of these values of a number that --set takes, and print a table; with --grid, the counts can be
    /// compared
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true, conflicts_with_all = ["output", "all_modes"])]
    pub vary: Option<GridAxis>,
    /// Sweep the same grid in every working mode, and print a table
    #[arg(help_heading = heading::COMPARE, long, conflicts_with_all = ["output", "mode"])]
    pub all_modes: bool,
    /// Sweep only part I of N (I counts from 1), and write it to -o, for `opm merge`
    #[arg(
        help_heading = heading::WORK,
        long,
        value_name = "I/N",
        requires = "output",
        conflicts_with_all = ["axes", "color", "scalars", "shape"]
    )]
    pub shard: Option<Shard>,
    /// Sweep a shard even if its file exists, and replace the file
    #[arg(help_heading = heading::WORK, long, requires = "shard")]
    pub force: bool,
    /// How points are recorded.
    #[command(flatten)]
    pub cloud: CloudArgs,
    /// Number of threads, instead of one per processor
    #[arg(help_heading = heading::WORK, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
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
    #[arg(help_heading = heading::WRITTEN, long, value_name = "A,B,C|tip", requires = "output", value_delimiter = ',')]
    pub axes: Vec<String>,
    /// The value that the colour shows: a task coordinate, an imaginary joint, an actuated joint, `inverse_condition`
    /// (one over the condition number), an index of `opm analyze` such as lti or clearance, or, with a load, an
    /// effort such as effort.S1
    #[arg(long, value_name = "NAME", requires = "output")]
    pub color: Option<String>,
    /// Values stored with every point, with names as for --color
    #[arg(help_heading = heading::WRITTEN, long, value_name = "A,B,...", requires = "output", value_delimiter = ',')]
    pub scalars: Option<Vec<String>>,
    /// Scale of the cloud's axes in a recording: `comparable` multiplies those of another unit than the first by
    /// 1, 2 or 5 times a power of ten, `none` keeps metres and radians
    #[arg(help_heading = heading::WRITTEN, long, requires = "output", value_parser = scale(), value_name = "SCALE")]
    pub scale: Option<AxisScale>,
}

/// Parses a scale of axes.
fn scale() -> impl TypedValueParser<Value = AxisScale> {
    let names = PossibleValuesParser::new(AxisScale::NAMED.map(|named| named.0));
    names.map(|name| AxisScale::from_name(&name).unwrap_or_default())
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
    #[arg(help_heading = heading::ALSO, long)]
    pub shape: bool,
    /// How points are recorded.
    #[command(flatten)]
    pub cloud: CloudArgs,
    /// Number of threads, instead of one per processor
    #[arg(help_heading = heading::WORK, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=i64::from(MOST_THREADS)))]
    pub threads: Option<u16>,
}

/// Parses a kind of workspace; the help lists the names.
fn kind() -> impl TypedValueParser<Value = WorkspaceKind> {
    let value = |kind: WorkspaceKind| PossibleValue::new(kind.name()).help(kind.description());
    let names = PossibleValuesParser::new(WorkspaceKind::ALL.map(value));
    names.try_map(|name| name.parse::<WorkspaceKind>())
}

/// Parses a shape that is inscribed.
fn inscribed() -> impl TypedValueParser<Value = InscribedShape> {
    let names = PossibleValuesParser::new(InscribedShape::ALL.map(InscribedShape::name));
    names.map(|name| InscribedShape::from_name(&name).unwrap_or(InscribedShape::Box))
}

/// Parses the largest condition number that counts.
fn condition_number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(number) if number >= 1.0 && number.is_finite() => Ok(number),
        _ => Err(format!("{text:?}, expected a number of at least 1")),
    }
}
