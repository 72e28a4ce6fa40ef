//! Tests that span the crates, and what they share: the paper's formulas as an oracle, and random
//! mechanisms of every pair of partial subspaces.

pub mod paper;
pub mod random;
