//! Sweeps of a manipulator's workspace over grids of poses, in parallel.
//!
//! The upper section of the mechanism is solved once an orientation; per pose, only whether each
//! leg's lower chain closes is left to test. Nothing depends on the number of threads: counts and
//! ranges are reduced by operations that do not round, and points come in the order of their index.

mod boundary;
mod components;
mod condition;
mod conditioning;
mod extent;
mod grid;
pub mod measure;
mod ordered;
mod poses;
mod progress;
mod replay;
mod set;
mod sweep;
mod visits;

pub use boundary::{Outline, Ring, boundary, rings};
pub use components::Components;
pub use condition::{ConditionLimit, Conditioned};
pub use conditioning::ConditioningIndex;
pub use extent::{Extent, default_grid};
pub use grid::{Axis, Coordinate, Grid, GridError, Sections};
pub use poses::Poses;
pub use progress::{Cancelled, Progress};
pub use replay::replay;
pub use set::{GridSet, SetAxis, SetError};
pub use sweep::{Count, Hits, Modes, Run, Shard, ShardError, Sweep};
pub use visits::Visits;

/// Threads that may be asked for: more is a slip of the finger, and takes minutes to begin and to stop.
pub const MOST_THREADS: u16 = 1024;
