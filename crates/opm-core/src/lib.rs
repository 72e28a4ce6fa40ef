//! Kinematics of overconstrained parallel manipulators with partial subspaces.

pub mod joint;
pub mod leg;
pub mod mechanism;
pub mod screw;
