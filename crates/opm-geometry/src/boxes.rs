//! Numbers over boxes of poses: affine arithmetic, the closed forms of chains in it, and the share of a box in which a number
//! lies in a range.

mod affine;
pub mod chain;
mod numbers;
mod opening;
mod share;
mod target;
pub mod whole;

pub use affine::{Affine, Plane, WIDE};
pub use share::{MOST, Share};
pub use target::{Enclosed, PlanarTarget, Rotation, Target, dot};
