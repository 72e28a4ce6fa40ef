//! Tests that span the crates, and what they share: the paper's formulas as an oracle, random
//! mechanisms of every pair of partial subspaces. What also checks mechanisms of users, such as a numeric solver for
//! legs, is in `opm-check`.

pub mod displace;
pub mod fuzzed;
pub mod height;
pub mod paper;
pub mod random;
pub mod structured;

pub use opm_check::{by_inverse, differences};

use nalgebra::Isometry3;
use opm_core::manipulator::{Manipulator, Mode};

/// The platform's displacement from home at a pose in a mode, on which dependent coordinates depend.
pub fn displacement(manipulator: &Manipulator, pose: &[f64], mode: Mode) -> Isometry3<f64> {
    let mut at = manipulator.solution();
    manipulator.inverse(pose, mode, &mut at).unwrap();
    at.displacement(manipulator)
}

/// Compiles the Rust code in the READMEs with the tests.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
pub struct Readme;

/// That of `opm-core`, too.
#[cfg(doctest)]
#[doc = include_str!("../../crates/opm-core/README.md")]
pub struct CoreReadme;

/// And that of a page.
#[cfg(doctest)]
#[doc = include_str!("../../docs/rust.md")]
pub struct RustPage;
