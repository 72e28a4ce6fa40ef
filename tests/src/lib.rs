//! Tests that span the crates, and what they share: the paper's formulas as an oracle, random
//! mechanisms of every pair of partial subspaces, a numeric solver for their legs, central
//! differences, and sweeps by one call per pose.

pub mod by_inverse;
pub mod differences;
pub mod newton;
pub mod paper;
pub mod random;
pub mod structured;

/// Compiles the Rust code in the README with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;
