//! Calibration of overconstrained parallel manipulators.
//!
//! Parameters of a family, or the places of joints of a list, and the offsets of encoders follow from measured actuators and
//! poses; of poses the whole, or parts of it. Parameters stay in the class: the subspaces exist for all their values.
//! `docs/calibration.md` explains what is minimised and what the answer means.
//!
//! ```
//! use opm_calibrate::{Column, Measurements, Options, Sigma, calibrate};
//! use opm_core::Manipulator;
//! use opm_core::mechanism::{examples, family::ParameterValue, file};
//!
//! let nominal = file::read(examples::find("planar-planar-5dof").expect("it is shipped").text)?;
//! // The real machine has a link that is 0.3 mm longer. Its encoders are read at some poses.
//! let longer = nominal.family.as_ref().expect("a family").with([("leg1.a1", ParameterValue::Number(0.2003))])?;
//! let real = Manipulator::new(longer.assemble()?)?;
//! let columns = Column::all(&real);
//! let mut rows = Vec::new();
//! let mut at = real.solution();
//! for k in 0..12 {
//!     let share = f64::from(k) / 12.0;
//!     let mut pose = real.home_pose();
//!     pose.iter_mut().enumerate().for_each(|(i, q)| *q += 0.02 * (6.0 * share * (i + 1) as f64).sin());
//!     let joints = real.inverse(&pose, real.home_mode(), &mut at)?.expect("in reach").joints();
//!     let actuated = real.actuated().iter().map(|&i| joints[i]);
//!     rows.push(pose.iter().copied().chain(actuated).map(Some).collect());
//! }
//! let options = Options { only: vec!["leg1.a1".into()], ..Options::default() };
//! let found = calibrate(&nominal, &Measurements { columns, rows }, &options, &mut |_| true)?;
//! assert!((found.parameters[0].after - 0.2003).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod allowed;
mod calibration;
mod column;
mod fit;
mod identify;
mod minimum;
mod parameter;
mod plan;
mod play;
mod prediction;
mod row;

pub use calibration::{
    CalibrateError, Calibration, Cell, Estimate, Measurements, Options, SIGMAS, Sigma, calibrate,
    parameters_of, with_changes,
};
pub use column::{BasePoint, Column};
pub use identify::Combination;
pub use parameter::{InstanceError, Parameter};
pub use plan::{Plan, candidates, plan};
pub use play::{JointPlay, ResidualPlay};

#[cfg(test)]
mod tests;
