//! A certificate for one mechanism: what the project's tests hold on random mechanisms, held on this one.
//!
//! | comparison | of | with |
//! |---|---|---|
//! | [`closure`] | joint values of inverse kinematics in every mode | products of exponentials of the undecomposed legs |
//! | [`branches`] | the solutions of every leg | a numeric solver from many starts ([`newton`]) |
//! | derivatives | rates and accelerations of all joints | [`differences`] of inverse kinematics |
//! | rows | how many poses of grids a sweep counts | inverse kinematics of every pose ([`by_inverse`]) |
//! | forward | assemblies for joint values of inverse kinematics | the poses that these came from |
//!
//! ```
//! use opm_check::{Options, check};
//! use opm_core::Manipulator;
//!
//! let manipulator = Manipulator::example("planar-3rrr")?;
//! let options = Options { samples: 20, ..Options::default() };
//! let certificate = check(&manipulator, &options, |_| true).expect("not cancelled");
//! assert!(certificate.holds());
//! # Ok::<(), opm_core::manipulator::ReadError>(())
//! ```

pub mod branches;
pub mod by_inverse;
mod certificate;
pub mod closure;
pub mod differences;
mod forward;
pub mod newton;
mod poses;
mod rates;
mod rows;

pub use certificate::{Certificate, Comparison, Options};
pub use poses::closures;
pub use rows::rows;

use opm_core::manipulator::Manipulator;

/// Compares the closed forms of a mechanism with independent computations. `go_on` hears how many of the
/// [`Options::steps`] are done, and says whether to continue; if not, there is no certificate.
pub fn check(
    manipulator: &Manipulator,
    options: &Options,
    mut go_on: impl FnMut(u64) -> bool,
) -> Option<Certificate> {
    let mut done = 0;
    let mut step = || {
        done += 1;
        go_on(done)
    };
    let comparisons = vec![
        closures(manipulator, options, &mut step)?,
        poses::branches(manipulator, options, &mut step)?,
        rates::derivatives(manipulator, options, &mut step)?,
        rows(manipulator, options, &mut step)?,
        forward::forward(manipulator, options, &mut step)?,
    ];
    let name = manipulator.mechanism().name.clone();
    let misfit = manipulator.decomposition().deviation;
    Some(Certificate { name, options: *options, misfit, comparisons })
}
