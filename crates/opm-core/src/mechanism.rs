//! Mechanisms: legs between one base and one platform, given at an assembled home pose.

pub mod examples;

#[doc(inline)]
pub use opm_mechanism::mechanism::*;
