//! Mechanism files: TOML text is read into a [`Mechanism`], or every problem is reported with its
//! location.
//!
//! `cli/src/format.md`, which `opm help format` prints, explains the format to users.
//!
//! A file names its own units; every value after reading is SI. There are two forms:
//!
//! * **Family**: `family = "..."` and the parameters of one of the [families](super::family).
//!   `home` may be left out, as a whole or in part: missing coordinates are zero. `mode` may be left
//!   out too: every choice is then `+`.
//! * **Joints**: `[platform]` and `[[leg]]` with `joints`, at the assembled home pose. A joint is
//!   `{ name, type, ... }` with
//!
//! | type | needs | may have |
//! |---|---|---|
//! | `revolute` | `axis`, `point` | `home`, `limits`, `actuated` |
//! | `prismatic` | `axis` | `point` (where it is drawn), `home`, `limits`, `actuated` |
//! | `helical` | `axis`, `point`, `pitch` (length per radian, negative left-handed) | as revolute |
//! | `cylindrical` | `axis`, `point` | as revolute; coordinates angle, slide |
//! | `universal` | `axis`, `axis2`, `point` | as revolute; coordinates about `axis`, `axis2` |
//! | `spherical` | `point` | as revolute; coordinates x, y, z of the rotation vector |
//!
//! Every joint may have `max_rate` and `max_acceleration`, in the file's units per second and per second
//! squared, and `max_effort`, in newtons or newton metres; an actuated joint also `rotor_inertia`, `gear`, `viscous_friction` and
//! `coulomb_friction` of its drive. `home` (default zero) and these three are numbers, and `limits` is a pair `[lowest, highest]`. A
//! joint with several coordinates has an array with one entry per coordinate.
//!
//! `[task]` says how the pose is measured, where the geometry (`opm_core::task`) leaves a choice:
//!
//! ```toml
//! [task]
//! axis = [0, 0, 1]
//! lower = { x = [0, 1, 0], normal = [0, 0, -1], origin = [100, 0, 0] }
//! upper = { w = [0, 0, 1], normal = [1, 0, 0], origin = [0, 0, 50] }
//! ```
//!
//! | key | meaning | sections |
//! |---|---|---|
//! | `axis` | the positive direction of the intersection motion: the one on the side of this vector | both sections |
//! | `x` | the direction of coordinate `x`, in the plane; for a sphere or a translational space, the direction of its frame's first axis, perpendicular to the intersection motion | planes with `x y`, spheres, translational spaces |
//! | `w` | the positive direction of coordinate `w` | upper planes with `w` |
//! | `normal` | the plane's normal about which `y` and the angle are positive | planes that share a translation and have an angle or `y` |
//! | `origin` | the point that lengths are measured from | all sections with a length among their coordinates |
//! | `coordinates` | `"euler-angles"` (default), `"tilt-torsion"` or `"roll-pitch-yaw"`: the angles of an orientation, [`OrientationCoordinates`](super::OrientationCoordinates); in the files of families too | the one with `zeta xi psi` |
//! | `home` | the values of task coordinates at home, such as `{ x = 10, xi = 5 }`, of an orientation Euler angles or `roll pitch yaw`; without it lengths follow from the geometry, and angles are zero | all sections |
//!
//! Every key may be left out. `opm decompose` prints the resulting frames.
//!
//! `[bodies]`, in both forms, says what the bodies weigh, for models of simulators: `density` in kilograms per cubic metre,
//! and `masses`, a table of kilograms by the names of bodies: `platform`, or the joint that carries a link; and how thick
//! they are: `radius` of all, and `radii` by name. `[[obstacle]]` says what stands around the mechanism
//! ([`Obstacle`](super::Obstacle)).
//!
//! `[parameters]`, in both forms, names numbers, points and directions, and a number anywhere else may be an expression of them
//! (`"rod / 2"`, `"A + B"`). A `[[leg]]` with `pattern` stands for several legs that are turned or mirrored images. A file keeps these
//! texts: [`Mechanism`] holds their values, and a change of a parameter reads the text again.
//!
//! Both forms need `format = 1`, `name`, and `units = { length = "m|cm|mm|in", angle = "rad|deg" }`.
//! A leg's `name` is `leg1`, `leg2`, ... if it is not given. Some names are columns of tables and
//! cannot be names of joints: task coordinates (`x`, `phi`, ...), `reachable`, `within_limits`,
//! `mode`, `branch`, and the imaginary joints of the legs (`tau.leg1`). An unknown key is a
//! problem, and its message suggests the nearest known key.

#[cfg(feature = "files")]
mod bodies;
mod change;
pub(crate) mod checks;
#[cfg(feature = "files")]
mod differences;
#[cfg(feature = "files")]
mod edit;
#[cfg(feature = "files")]
mod expression;
mod heading;
#[doc(hidden)]
pub mod hint;
#[cfg(feature = "files")]
mod joints;
mod named;
#[cfg(feature = "files")]
mod obstacles;
#[cfg(feature = "files")]
mod parameters;
#[cfg(feature = "files")]
mod pattern;
mod problem;
#[cfg(feature = "files")]
mod read;
#[cfg(feature = "files")]
mod reader;
// For opm-core and its sibling crates only.
#[cfg(feature = "schema")]
#[doc(hidden)]
pub mod schema;
mod units;
mod writer;

pub use change::text;
#[doc(hidden)]
pub use checks::LARGEST;
pub use heading::Heading;
pub(super) use hint::nearest;
pub use named::{NamedParameter, NamedValue, ParameterUnit};
pub use problem::{FileErrors, Location, Locations, Problem};
pub use units::{AngleUnit, FileUnits, LengthUnit};
pub(super) use writer::quoted;
pub use writer::{Digits, write};

#[cfg(feature = "files")]
pub use read::read;
#[cfg(feature = "schema")]
pub use schema::schema;
#[cfg(feature = "files")]
pub(super) use {
    parameters::{read_home, read_leg, table_of, tables_of},
    read::{assembled, leg_name},
};
// For opm-core and its sibling crates only.
#[cfg(feature = "files")]
#[doc(hidden)]
pub use {
    read::{document, head, optional_units},
    reader::{Table, Value, all},
};

use super::Mechanism;
use super::family::Family;
use std::sync::Arc;

/// The content of a mechanism file.
#[derive(Clone, Debug, PartialEq)]
pub struct MechanismFile {
    /// The mechanism at its assembled home pose, SI.
    pub mechanism: Mechanism,
    /// The units of the file, for text that people read.
    pub units: FileUnits,
    /// The family and parameters from which the mechanism was assembled; `None` for a list of
    /// joints.
    pub family: Option<Family>,
    /// The working mode of home, if a family determines it; for a list of joints it follows from
    /// the joints.
    pub mode: Option<String>,
    /// Locations, in the file, of what may later turn out to be inconsistent.
    pub places: Locations,
    /// The numbers and points that the file names in `[parameters]`, in its order.
    pub parameters: Vec<NamedParameter>,
    /// Which legs are copies of each other, where the file says so by a pattern.
    pub patterns: Vec<LegPattern>,
    /// The text that it was read from, whose order and comments a changed text keeps.
    pub source: Option<Arc<Source>>,
}

/// Legs that one description gives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LegPattern {
    /// Their names.
    pub legs: Vec<String>,
    /// How they lie, for people: `120 deg apart about (0, 0, 1)`.
    pub text: String,
}

/// The text of a file, and what it gives.
#[derive(Clone, Debug)]
pub struct Source {
    text: String,
    mechanism: Mechanism,
    family: Option<Family>,
}

impl Source {
    /// The text that gives a file.
    fn of(text: String, file: &MechanismFile) -> Arc<Self> {
        let (mechanism, family) = (file.mechanism.clone(), file.family.clone());
        Arc::new(Self { text, mechanism, family })
    }
}

/// Files that give the same are equal, whatever their comments.
impl PartialEq for Source {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

#[cfg(all(test, feature = "files"))]
mod tests;
