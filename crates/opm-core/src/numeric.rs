//! Numbers: trigonometry, rotation matrices, singular values of small matrices, small
//! linear systems, quantities with their
//! units, and the format of numbers in messages. This module knows nothing of mechanisms.

pub(crate) mod angle;
pub(crate) mod extremes;
pub(crate) mod four_wide;
pub(crate) mod least_squares;
pub mod number;
mod quantity;
pub mod rotation;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod svd;

pub use quantity::Quantity;
