//! What the page asks.

use serde::Deserialize;
use std::collections::BTreeMap;

/// Values by the names of task coordinates, in the units of the file. A coordinate without a value has that of home.
pub type Coordinates = BTreeMap<String, f64>;

/// Changed numbers of the mechanism by their names, in the units of the file: one number, the two ends of limits or none
/// of them, the components of a point or of a direction.
pub type Changes = BTreeMap<String, Vec<f64>>;

/// A request, an object with the key `do`: `{ "do": "pose", "pose": { "x": 10 } }`.
///
/// The working mode is that of home where none is given.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "do", rename_all = "lowercase", deny_unknown_fields)]
pub enum Request {
    /// The mechanisms that opm ships.
    Examples {},
    /// Opens a mechanism and describes it.
    Open {
        /// The name of the mechanism file, for problems in it.
        #[serde(default)]
        name: String,
        /// The text of the mechanism file.
        text: String,
        /// What is changed of it.
        #[serde(default)]
        changes: Changes,
    },
    /// Changes the open mechanism and describes it. Numbers that are not named are those of the file. Fitted grids stay, so
    /// that counts can be compared while a number changes: the next fit is for the mechanism as it is then.
    Change {
        /// All that is changed of the file.
        changes: Changes,
    },
    /// The text of the mechanism file, with the changes.
    File {},
    /// The joints at a pose, the bodies and their distances, and the working modes that reach it.
    Pose {
        /// The pose.
        #[serde(default)]
        pose: Coordinates,
        /// The working mode.
        mode: Option<String>,
        /// Bodies that are nearer to each other than this are named, in the file's unit of lengths; without it, those that
        /// overlap.
        clearance: Option<f64>,
    },
    /// The poses of the platform for given values of the actuated joints.
    Forward {
        /// A value for each actuated joint coordinate, in the file's units.
        joints: BTreeMap<String, f64>,
        /// The assemblies nearest to this pose come first.
        #[serde(default)]
        pose: Coordinates,
    },
    /// Fits a grid to the whole workspace. The session keeps it, and those that it fits to kinds from then on, until the
    /// next fit.
    Fit {
        /// The working mode.
        mode: Option<String>,
    },
    /// Counts the reachable poses of the fitted grid.
    Whole {
        /// The working mode.
        mode: Option<String>,
    },
    /// The reachable poses of a plane grid, their number and their boundary.
    Slice {
        /// The axis across.
        x: AxisRequest,
        /// The axis upwards.
        y: AxisRequest,
        /// The other coordinates.
        #[serde(default)]
        pose: Coordinates,
        /// The working mode.
        mode: Option<String>,
    },
    /// A number for each reachable pose of a plane grid, to colour it by.
    Colours {
        /// The axis across.
        x: AxisRequest,
        /// The axis upwards.
        y: AxisRequest,
        /// The other coordinates.
        #[serde(default)]
        pose: Coordinates,
        /// The working mode.
        mode: Option<String>,
        /// `condition` for the condition number, `lti` for the local transmission index, `clearance` for the distance of
        /// the nearest two bodies, or the name of a joint.
        by: String,
    },
    /// The workspace as a body in three coordinates of the fitted grid.
    Body {
        /// The names of the coordinates.
        axes: [String; 3],
        /// What the other coordinates are.
        others: Others,
        /// The pose.
        #[serde(default)]
        pose: Coordinates,
        /// The working mode.
        mode: Option<String>,
    },
    /// The kinds of workspace, and which of them the mechanism has.
    Kinds {},
    /// Counts and measures a workspace of one kind. The session fits a grid to it in each mode, and keeps it until the
    /// next fit.
    Kind {
        /// The name of the kind.
        kind: String,
        /// Held coordinates are those of this pose.
        #[serde(default)]
        pose: Coordinates,
        /// The working mode.
        mode: Option<String>,
        /// Of places: how far the orientations are from that of the pose, in the file's unit of angles.
        turn: Option<f64>,
    },
    /// The motions that opm ships.
    Motions {},
    /// Follows a motion.
    Motion {
        /// The name of its file: a table of poses if it ends in `.csv`.
        name: String,
        /// The text of its file.
        text: String,
        /// The working mode, if the file gives none.
        mode: Option<String>,
    },
}

/// What the coordinates are in which a body is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Others {
    /// Those of the pose.
    Pose,
    /// Any values of the fitted grid.
    Any,
}

/// One axis of a plane grid: both ends are on the grid.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AxisRequest {
    /// The name of the task coordinate.
    pub name: String,
    /// The lowest value, in the file's units.
    pub min: f64,
    /// The highest value.
    pub max: f64,
    /// The number of values.
    pub count: u64,
}
