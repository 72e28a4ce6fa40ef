//! Tables of numbers as CSV: lines of cells between commas, below a header that names the columns.
//!
//! ```
//! use opm_core::table::Lines;
//!
//! # fn main() -> std::io::Result<()> {
//! let mut lines = Lines::new(Box::new("x, y\n\n1, 2\n".as_bytes()));
//! let header = lines.next()?.map(|line| line.number);
//! assert_eq!(header, Some(1));
//! let row = lines.next()?.expect("a row");
//! assert_eq!((row.number, row.column(1)), (3, 4));
//! assert!(row.fields().eq([b"1", b"2"]));
//! # Ok(())
//! # }
//! ```

mod columns;
mod dialect;
mod lines;
mod plausible;
pub mod tum;

pub use columns::{ColumnNames, Suggestion};
pub use dialect::{hint, hint_of_row, not_commas};
pub use lines::{FieldPlace, Line, Lines, number};
pub use plausible::Plausible;
