//! Numbers: angles and vectors that point at them, singular values of small matrices, quantities and
//! their units, and how numbers are written in messages. It knows nothing of mechanisms.

pub(crate) mod angle;
pub mod number;
mod quantity;
pub mod rotation;
pub(crate) mod svd;

pub use quantity::Quantity;
