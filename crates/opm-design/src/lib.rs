//! Dimensions of overconstrained parallel manipulators, by optimisation.
//!
//! A [`Problem`] says what may vary of a mechanism, between which bounds; which numbers of it decide ([`Measure`]), and
//! which bounds it has to keep. [`design`] searches the best mechanism of one objective, or the front of two. It designs
//! all variables at once, or, if they are divided, one section after the other: the imaginary joints cut a mechanism in
//! two, and its parameters with it (M. Ö. Selvi, section 3.1). The upper section is designed first, for a set of
//! orientations; what results is the range of each imaginary joint that it requires. Then the lower section is designed to
//! reach as many places as it can *with every value in these ranges*. A place that it reaches so is reached in every
//! orientation.
//!
//! Where the one objective changes smoothly with the dimensions ([`Measure::is_smooth`]), the best design that was found is
//! polished by its rates with them ([`Outcome::polished`]).
//!
//! ```
//! use opm_core::mechanism::{examples, file};
//! use opm_design::{Draft, Log, Watch, design};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let draft = Draft::read(r#"
//!     format = 1
//!     mechanism = "plano-spherical-5dof"
//!     units = { length = "mm", angle = "deg" }
//!     budget = 40
//!     grid = { x = [-100, 100, 11], y = [-100, 100, 11], xi = [-20, 20, 3] }
//!     objective = [{ measure = "dexterous" }]
//!     variables = { h = [80, 160], a1 = [150, 220] }
//! "#)?;
//! let shipped = examples::find(draft.mechanism()).ok_or("no such example")?;
//! let (problem, mechanism) = draft.resolve(&file::read(shipped.text)?)?;
//! let found = design(&problem, &mechanism, &mut Log::none(), &Watch::default())?;
//! let before = found.before.ok_or("it does not assemble")?;
//! assert!(found.designs[0].values[0] >= before[0]);
//! println!("{}", found.designs[0].file.text());
//! # Ok(())
//! # }
//! ```

mod design;
mod evaluate;
mod file;
mod judge;
mod log;
mod measure;
mod optimise;
mod polish;
mod problem;
mod smooth;

pub use design::{Design, DesignError, Outcome, Polished, Watch, columns, design};
pub use evaluate::Ranges;
pub use file::{Draft, ProblemErrors};
pub use log::{Columns, Log, LogError};
pub use measure::Measure;
pub use problem::{Constraint, Problem, Variable, Variables};
