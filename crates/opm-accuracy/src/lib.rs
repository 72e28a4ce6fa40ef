//! Accuracy of overconstrained parallel manipulators: how errors of actuators and of parts move the platform, and what
//! errors no motion takes up.
//!
//! Each leg is a chain of all its joints, with the errors of its parts. To first order, at a solved pose with the actuators
//! held, the legs close if
//!
//! ```text
//! Σ s q̇  +  E  +  Σ p  =  t        for each leg
//! ```
//!
//! with the screws `s` and small displacements `q̇` of its passive joints, the twist `E` of its errors, the platform's twist
//! `t`, and the *play* `p` of each joint: a small twist across what the joint allows. The legs of an overconstrained
//! mechanism cannot follow every error. What they cannot follow is the [misfit](Response::plays), which play or strain of
//! the joints has to take up. `docs/accuracy.md` has the formulas and their sources.
//!
//! ```
//! use opm_accuracy::{Budget, ErrorModel, Model};
//! use opm_core::{Manipulator, Quantity};
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof-joints")?;
//! let mut buffer = manipulator.solution();
//! let pose = manipulator.pose([("x", 0.01), ("xi", 0.26)])?;
//! let at = manipulator.inverse(&pose, manipulator.home_mode(), &mut buffer)?;
//!
//! let model = Model::new(&manipulator, None, ErrorModel::Links);
//! let response = model.at(at.expect("a pose in reach"))?;
//! // Every axis within 20 µm and 20 µrad.
//! let errors: Vec<f64> = model.sources().iter().map(|_| 20e-6).collect();
//! let budget = Budget::new(&response, &errors);
//! assert!(budget.length.worst > 20e-6 && budget.length.worst < 1e-3);
//! assert!(budget.misfit.iter().any(|joint| joint.length.worst > 1e-6));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod allocation;
mod assembly;
mod budget;
mod chain;
mod dimensions;
mod enclosed;
mod inverse;
mod largest;
mod made;
mod response;
mod sample;
mod source;
mod tolerance;
mod zonotope;

pub use allocation::{Allocation, Permitted};
pub use assembly::{Assembled, Assembler};
pub use budget::{Budget, Play, Spread};
pub use dimensions::{DimensionRates, Dimensions};
pub use enclosed::{BoxBudget, Unbounded};
pub use largest::{Largest, Worst};
pub use response::{Closure, Model, Response};
pub use sample::{Sample, Samples, draw, sample, sample_assembled};
pub use source::{ErrorModel, Source};
pub use tolerance::{Both, ToleranceErrors, Tolerances};
