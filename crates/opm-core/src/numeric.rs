//! Numbers: trigonometry, rotation matrices, singular values of small matrices, quantities with their
//! units, and the format of numbers in messages. This module knows nothing of mechanisms.

pub(crate) mod angle;
pub mod number;
mod quantity;
pub mod rotation;
pub(crate) mod svd;

pub use quantity::Quantity;
