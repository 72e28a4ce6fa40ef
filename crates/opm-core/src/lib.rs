
pub mod chain;
pub mod joint;
pub mod leg;
pub mod mechanism;
pub mod screw;
