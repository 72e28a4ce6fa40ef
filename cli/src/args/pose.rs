//! Arguments of the commands for one pose or many: inverse and forward kinematics, velocities.

use super::{MechanismArgs, heading};
use crate::pose::{GridAxis, Number, Pose};
use crate::transform::Transform;
use clap::ValueHint;
use opm_core::table::ColumnNames;
use std::path::PathBuf;

/// Inverse kinematics: the joint values at a pose, or at every pose of a CSV file
///
/// A task coordinate that is not given has its home value; `opm decompose` lists the coordinates. One that
/// depends on the others is only compared with the value that follows. A pose
/// out of reach is an answer (exit status 0): it names the legs that do not reach, and by how much.
///
/// --transform takes the platform's pose in SE(3) instead: the position of its reference point and the
/// quaternion of its orientation, both in base coordinates. The orientation at home is the identity, or
/// that of the Euler angles at home. If the manipulator cannot move the platform there at all, the answer
/// says by how much and in which direction (exit status 0). JSON has `transform` for every pose. Coordinates that depend on
/// the others may differ from mode to mode: then every solution has them as `dependent`, and a `transform` of its own; those
/// of the whole are those of the first solution.
///
/// The two bodies that are nearest to each other are named, with their distance: links as rods between their joints, the
/// platform, and the obstacles of the file. With --all-modes, a column has that distance for each mode. Pairs that overlap
/// at home are not tested, and named.
///
/// CSV in: a header of task coordinates in any order, then one row for each pose, in metres and radians, or in units that
/// the header names: `x [mm],xi [deg]`. A column `t`, as in the table of a motion, is carried through. Columns of
/// coordinates that depend on the others are compared with the values that follow, where a cell is not empty. The other
/// columns of tables that opm writes are not read, nor is `mode`: --mode chooses the working mode.
/// A table may have places in SE(3) instead, `x,y,z,qx,qy,qz,qw` as for --transform, or be one of the TUM benchmark: lines of
/// `t x y z qx qy qz qw` without a header. `opm trajectory --motion` reads the CSV that comes out.
///
/// CSV out: all task coordinates, those that depend on them, `reachable` and `within_limits` (1 or 0), `mode`, the imaginary joints,
/// the actuated joints, or with --all-joints every joint. A pose out of reach keeps its row; its joint cells are empty.
/// With --failures, two columns say why: `unreachable`, the legs that do not reach, and `beyond_limits`, the joints beyond
/// their limits; names have a space between them.
///
/// --nearest looks for the nearest pose in reach where one is out of reach, or beyond limits: of least distance in the
/// coordinates of the pose, where an angle counts as its radians times --length, in the working mode that is asked for, or
/// with --all-modes in any. It begins at poses in reach, bisects the way to the pose, and follows the boundary of reach
/// down. What it finds is in reach by the same computation as every other pose. Nothing proves that it is the nearest of
/// all. JSON has it as `nearest_pose`. In a table the row has that pose, and a column `distance` (m) says how far away the
/// pose is that was asked for: 0 where it is in reach itself, empty where nothing was found.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm ik plano-spherical-5dof --pose x=10mm,y=0,xi=15deg
  opm ik plano-spherical-5dof --pose xi=15deg --mode \"-+ ++ ++ +\"
  opm ik plano-spherical-5dof --pose xi=15deg --all-modes --format json
  opm ik plano-spherical-5dof --transform 10mm,0,0,0.8,0.6,0,0
  opm ik plano-spherical-5dof --pose x=400mm,xi=15deg --nearest
  opm ik plano-spherical-5dof --pose xi=15deg --vary h=100mm:160mm:7
  opm ik plano-spherical-5dof --poses poses.csv -o joints.csv
  opm ik plano-spherical-5dof --poses poses.csv --all-joints --all-modes -o joints.csv
  generate-poses | opm ik plano-spherical-5dof --poses - | head")]
#[command(group = clap::ArgGroup::new("where").required(true).args(["pose", "poses", "transform"]))]
pub struct IkArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// One pose, for example x=10mm,y=0,xi=15deg
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub pose: Option<Pose>,
    /// Pose in SE(3): position of the reference point, and a unit quaternion, scalar first
    #[arg(long, value_name = "X,Y,Z,QW,QX,QY,QZ", allow_hyphen_values = true)]
    pub transform: Option<Transform>,
    /// A CSV file of poses; - reads standard input
    #[arg(long, value_name = "IN.csv", value_hint = ValueHint::FilePath)]
    pub poses: Option<PathBuf>,
    /// The columns of --poses that are read, by the names that they have there: x=pos_x,y; others are passed over
    #[arg(help_heading = heading::TABLE, long, value_name = "NAME=HEADING,...", requires = "poses", conflicts_with_all = ["pose", "transform"])]
    pub columns: Option<ColumnNames>,
    /// Every working mode in which the pose is in reach, not just one
    #[arg(long, conflicts_with = "mode")]
    pub all_modes: bool,
    /// Where a pose is out of reach or beyond limits, also the nearest pose found that is not
    #[arg(long, conflicts_with = "vary")]
    pub nearest: bool,
    /// Characteristic length of --nearest, by which angles are multiplied, instead of the spread of the joint axes
    #[arg(help_heading = heading::ALSO, long, value_name = "LENGTH", requires = "nearest", allow_hyphen_values = true)]
    pub length: Option<Number>,
    /// Columns of the legs that do not reach, and of the joints beyond limits, in the CSV
    #[arg(help_heading = heading::WRITTEN, long, requires = "poses", conflicts_with_all = ["pose", "transform"])]
    pub failures: bool,
    /// Passive joints, too, in the CSV, in the order of the JSON of one pose
    #[arg(help_heading = heading::WRITTEN, long, requires = "poses", conflicts_with_all = ["pose", "transform"])]
    pub all_joints: bool,
    /// Working mode: `home`, or a sign for every two-valued choice, grouped by leg ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Solve for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true, conflicts_with_all = ["poses", "transform", "all_modes"])]
    pub vary: Option<GridAxis>,
    /// Output file (.csv) for the table; standard output if it is - or not given
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
/// --length; of a five-bar to the velocity of the hand. It is null if it is infinite: at a singularity, or with fewer actuators than freedoms.
/// Singularities of the Euler angles (xi = 0) are not counted; `coordinates` is 0 there. A pose out of
/// reach is an answer (exit status 0).
///
/// JSON also has `twist_jacobian`, the platform's twist for unit rates of the task coordinates, and `twist`, that for
/// --rates: the angular velocity (wx wy wz, rad/s) and the velocity of the platform's reference point (vx vy vz, m/s),
/// along the axes of the base. `transform` is the platform's pose, as in `opm ik`.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm velocity plano-spherical-5dof --pose x=10mm,xi=15deg --rates zeta=1,x=10mm
  opm velocity plano-spherical-5dof --rates psi=15deg --mode \"-+ ++ ++ +\"
  opm velocity translational-helical-3dof --rates phi=1 --length 100mm --format json")]
pub struct VelocityArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The pose, for example x=10mm,xi=15deg; other coordinates stay at home
    #[arg(long, value_name = "NAME=VALUE,...", default_value = "", hide_default_value = true)]
    pub pose: Pose,
    /// Rates of the task coordinates per second, for example zeta=1,x=10mm; other rates are 0
    #[arg(long, value_name = "NAME=VALUE,...", default_value = "", hide_default_value = true)]
    pub rates: Pose,
    /// Working mode: `home`, or a sign for every two-valued choice, grouped by leg ("++ ++ ++ +")
    #[arg(long, value_name = "MODE", default_value = "home", allow_hyphen_values = true)]
    pub mode: String,
    /// Compute for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true)]
    pub vary: Option<GridAxis>,
    /// Characteristic length of the condition number, instead of the spread of the joint axes
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub length: Option<Number>,
}

/// Forward kinematics: every pose that given actuated joints allow, or the poses of a CSV file of joints
///
/// All assemblies are found, each with its working mode and with how well its legs close (`residual`, radians and
/// shares of the mechanism's size): in closed form if the mechanism's sections can be solved one after the other,
/// else by continuation, which tells how many solutions there are, complex ones too, and lists a pose once. With
/// --near, or where neither is possible, Newton's method starts from a pose and finds one assembly, in the working
/// mode of --mode or home. The assembly nearest to home comes first.
///
/// Each is then proven with rounded intervals: within `radius` (radians, plus shares of the size) there is exactly one exact
/// assembly, and it is none of the others (`distinct`). JSON has `certificate`: "proven"; "double-suspected" where two
/// assemblies nearly meet, or a body can move with these joints held; "redundant" where more joints are actuated than the
/// platform has freedoms.
///
/// Where the platform, or a leg, can move with the joints held, that self-motion is told once, with its dimension and one of its
/// poses, and its assemblies are not listed (JSON: `families`, only where there is one). The column "home's aspect" (JSON:
/// `home_aspect`) says "shared" where the straight way from home is clear of singularities and limits, "apart" where the working mode or the sign of a
/// determinant is another, so that every way is singular, and "-" (null) where neither is known; --aspects knows more.
///
/// No assembly is an answer (exit status 0): it names what does not meet, and the least change of the joints
/// with which the mechanism can be assembled, of all together (least sum of squares, lengths over the
/// mechanism's size) and of each alone; in JSON `least_change`, null where none was found or there is no closed form. Angles count
/// modulo a revolution, except where a screw joint follows them: each revolution is then an assembly of its
/// own, one advance of the screw away. `opm ik` does not count revolutions; the angles in --joints decide.
///
/// --poses reads a header of the actuated joints in any order, then one row for each set of values, in metres and
/// radians. A column `t` is carried through; the others that `opm ik --poses` and `opm trajectory` write are not read.
/// CSV out: the task coordinates, those that depend on them, `mode`,
/// `reachable` and `within_limits` (1 or 0), the actuated joints. Every row is solved near the row before it, the
/// first one near home or --near, by Newton's method in one working mode; where that ends without an assembly, it is
/// the nearest of all in this mode. A row without an assembly keeps its place; its pose cells are empty,
/// and the next row starts where this one did. With --all there is a row for each assembly, with
/// the number of its row (`row`) and its own (`assembly`), those nearest to home or to --near first.
#[derive(Debug, clap::Args)]
#[command(after_long_help = "\
Examples:
  opm fk plano-spherical-5dof --joints S1=170mm,S2=165mm,S3=160mm,phi14=-150deg,phi24=130deg
  opm fk plano-spherical-5dof --joints S1=0.17,S2=0.16,S3=0.16,phi14=-2.7,phi24=2.3 --mode home
  opm fk plano-spherical-5dof --joints S1=0.17,S2=0.17,S3=0.17,phi14=-2.7,phi24=2.3 --near xi=10deg
  opm fk translational-planar-4dof --joints S1=10mm,S2=0,S3=0,S4=-10mm --format json
  opm fk stewart --joints S1=560mm,S2=530mm,S3=540mm,S4=535mm,S5=537mm,S6=545mm
  opm fk planar-3rpr --joints S1=14.98mm,S2=15.38mm,S3=12mm --aspects
  opm fk plano-spherical-5dof --poses joints.csv | head")]
#[command(group = clap::ArgGroup::new("given").required(true).args(["joints", "poses"]))]
pub struct FkArgs {
    /// The mechanism.
    #[command(flatten)]
    pub mechanism: MechanismArgs,
    /// The value of every actuated joint, for example S1=10mm,phi14=15deg
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub joints: Option<Pose>,
    /// A CSV file of actuated joints, from which poses are found; - reads standard input
    #[arg(long, value_name = "IN.csv", value_hint = ValueHint::FilePath)]
    pub poses: Option<PathBuf>,
    /// The columns of --poses that are read, by the names that they have there: x=pos_x,y; others are passed over
    #[arg(help_heading = heading::TABLE, long, value_name = "NAME=HEADING,...", requires = "poses", conflicts_with = "joints")]
    pub columns: Option<ColumnNames>,
    /// Every assembly of each row of --poses, not just the one near the row before
    #[arg(long, requires = "poses", conflicts_with = "joints")]
    pub all: bool,
    /// Output file (.csv) for the table; standard output if it is - or not given
    #[arg(
        short,
        long,
        value_name = "OUT.csv",
        requires = "poses",
        conflicts_with = "joints",
        value_hint = ValueHint::FilePath
    )]
    pub output: Option<PathBuf>,
    /// Also the aspect of each assembly: those with the same number are joined by paths without a singularity
    #[arg(help_heading = heading::ALSO, long, requires = "joints", conflicts_with = "poses")]
    pub aspects: bool,
    /// Grid of --aspects: minimum, maximum and number of values of a task coordinate; without it, one is fitted
    #[arg(help_heading = heading::ALSO, long, value_name = "AXIS=MIN:MAX:COUNT|AXIS=VALUE", requires = "aspects")]
    pub grid: Vec<GridAxis>,
    /// Solve for each of these values of a number that --set takes, and print a table
    #[arg(help_heading = heading::COMPARE, long, value_name = "NAME=MIN:MAX:COUNT", allow_hyphen_values = true, conflicts_with_all = ["poses", "aspects"])]
    pub vary: Option<GridAxis>,
    /// Start Newton's method at this pose; other coordinates start at home
    #[arg(long, value_name = "NAME=VALUE,...")]
    pub near: Option<Pose>,
    /// Only assemblies in this working mode: `home`, or a sign for every two-valued choice
    #[arg(long, value_name = "MODE", allow_hyphen_values = true)]
    pub mode: Option<String>,
}
