//! Workspaces of manipulators: which poses are in reach and within the limits, and what follows from that.
//!
//! A [`Sweep`] finds this out for every pose of a [`Grid`], in parallel. Its poses make sets with connected
//! components and boundaries, reachable and dexterous workspaces, and conditioning indices.
//! [`measure`](mod@measure) bounds areas and volumes with a guarantee. Results do not depend on the number of
//! threads: sums are of whole numbers, and points come in the order of their number.
//!
//! The kinematics are in [`opm_core`], which this crate exports again.
//!
//! ```
//! use opm_workspace::opm_core::Manipulator;
//! use opm_workspace::{Axis, Grid, GridSet, Modes, Progress, Sweep, boundary};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//!
//! // The workspace in x and y, with all other coordinates at home, in steps of 5 mm.
//! let axes = vec![Axis::new("x", -0.3, 0.3, 121), Axis::new("y", -0.3, 0.3, 121)];
//! let grid = Grid::new(&manipulator, axes)?;
//! let sweep = Sweep::new(&manipulator, &grid, Modes::One(manipulator.home_mode()));
//!
//! let count = sweep.count(&Progress::default())?;
//! println!("{} of {} poses are in reach", count.reachable, count.poses);
//!
//! let set = GridSet::reached(&sweep, &Progress::default())?;
//! let outline = &boundary(&set).ok_or("not a plane set")?[0];
//! println!("{} rings around {:.4} m2", outline.rings.len(), outline.area());
//! # assert!(count.reachable > 0 && outline.area() > 0.0);
//! # Ok(())
//! # }
//! ```
//!
//! # Where to find what
//!
//! | question | items |
//! |---|---|
//! | which poses | [`Grid`], [`Axis`], [`Sections`], [`default_grid`] |
//! | which of them are in reach | [`Sweep`], [`Modes`], [`Count`], [`Hits`], [`Progress`] |
//! | parts of a sweep, stored and put together | [`Shard`], [`Count::merge`], [`Poses`], [`replay`] |
//! | which poses are far from singular | [`PoseLimit`], [`Conditioned`], [`ConditioningIndex`] |
//! | the set of reachable poses | [`GridSet`], [`Components`], [`boundary`], [`mask_boundary`] |
//! | the parts that are free of singularities, and ways in them | [`Aspects`], [`aspect_at`], [`find_path`], [`singular_curves`] |
//! | places that some or all orientations reach | [`Visits`] |
//! | what rejects the other poses | [`Rejections`] |
//! | the largest disc, ball or box in a set | [`inscribed()`] |
//! | areas and volumes with guaranteed bounds | [`measure`](mod@measure) |
//!
//! Numbers are SI and radians. Work is done on the current rayon thread pool.

mod aspects;
mod boundary;
mod clearance;
mod components;
mod condition;
mod conditioning;
mod extent;
mod forest;
mod grid;
mod inscribed;
pub mod measure;
mod ordered;
mod poses;
mod progress;
mod rejections;
mod replay;
mod set;
mod sweep;
mod visits;

pub use opm_core;

pub use aspects::{
    Aspect, AspectPath, Aspects, BeyondLimits, HomeAspect, NoPath, SingularCurves, aspect_at,
    find_path, home_aspects, singular_curves,
};
pub use boundary::{MaskError, Outline, Ring, boundary, mask_boundary};
pub use clearance::{ClearanceError, ClearanceLimit};
pub use components::Components;
pub use condition::{ConditionError, Conditioned, PoseLimit};
pub use conditioning::ConditioningIndex;
pub use extent::{Extent, default_grid};
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub use ordered::in_order;

pub use grid::{Axis, Coordinate, Grid, GridError, Sections};
pub use inscribed::{Inscribed, InscribedError, InscribedShape, inscribed};
pub use poses::Poses;
pub use progress::{Cancelled, Progress};
pub use rejections::{Cause, PointsOf, RejectedPoint, Rejection, Rejections};
pub use replay::replay;
pub use set::{GridSet, SetAxis, SetError};
pub use sweep::{Count, Hits, Modes, Run, Shard, ShardError, Sweep};
pub use visits::{OtherGrid, Visits};

/// The most threads that front ends accept: a larger number is a mistake, and takes minutes to begin and to
/// stop.
pub const MOST_THREADS: u16 = 1024;
