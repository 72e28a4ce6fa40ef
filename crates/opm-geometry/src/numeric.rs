//! Numbers: trigonometry, rotation matrices, singular values of small matrices, small
//! linear systems, quantities with their
//! units, and the format of numbers in messages. This module knows nothing of mechanisms.

pub mod number;
mod quantity;
pub mod rotation;

// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod angle;
#[doc(hidden)]
pub mod continuation;
#[doc(hidden)]
pub mod extremes;
#[doc(hidden)]
pub mod four_wide;
#[doc(hidden)]
pub mod least_squares;
#[doc(hidden)]
pub mod svd;

pub use quantity::Quantity;
