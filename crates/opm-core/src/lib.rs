

pub mod chain;
pub mod decomposition;
pub mod joint;
pub mod leg;
pub mod mechanism;
pub mod mobility;
pub mod screw;
pub mod subspace;
mod svd;
