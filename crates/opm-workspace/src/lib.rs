//! Sweeps of a manipulator's workspace over grids of poses, in parallel.
//!
//! The upper section of the mechanism is solved once an orientation; per pose, only whether each
//! leg's lower chain closes is left to test. Nothing depends on the number of threads: counts and
//! ranges are reduced by operations that do not round, and points come in the order of their index.

mod condition;
mod extent;
mod grid;
pub mod measure;
mod progress;
mod sweep;

pub use condition::{ConditionLimit, Conditioned};
pub use extent::{Extent, default_grid};
pub use grid::{Axis, Grid, GridError};
pub use progress::{Cancelled, Progress};
pub use sweep::{Count, Hits, Modes, Run, Sweep};
