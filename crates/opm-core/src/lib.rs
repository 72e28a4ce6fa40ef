//! Kinematics of overconstrained parallel manipulators with partial subspaces.

pub mod chain;
pub mod decomposition;
pub mod joint;
pub mod leg;
pub mod limits;
pub mod manipulator;
pub mod mechanism;
pub mod mobility;
pub mod screw;
pub mod subspace;
mod svd;
pub mod task;
