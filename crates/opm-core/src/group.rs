//! The displacement subgroups of SE(3) that a section of a leg can move in.

pub mod screw;
pub mod subspace;
