//! What a designer decides by at a pose of an overconstrained parallel manipulator: the efforts of its actuators under a
//! load, the loads that they bear, and how well they move the platform.
//!
//! | question | answer |
//! |---|---|
//! | what a solved pose does for virtual motions | [`Statics`] |
//! | which efforts balance a load, and which loads are worst | [`Statics::efforts`], [`Statics::worst`] |
//! | which loads actuators with limits bear | [`Statics::capacity`], [`Statics::facets`] |
//! | which accelerations they give the platform from rest | [`Loads::acceleration_radius`] |
//! | how well motion and force are transmitted | [`Transmissions`] |
//! | what acts: a load on the platform, and the weight of all bodies | [`Loads`] |
//! | the equations of motion: mass matrix, bias, gravity, friction; accelerations and motion under efforts; the linear model | [`Dynamics`] |
//! | how much the platform gives way, how the legs share a load, its natural frequencies, and how it answers to what swings | [`Compliant`], [`Response`] |
//! | one number for a colour, a column or a limit | [`Indices`] |
//!
//! Everything is in SI and radians. The signs, the formulas and their sources are in `docs/analysis.md`.
//!
//! ```
//! use opm_analysis::{Balance, Statics, Wrench};
//! use opm_core::Manipulator;
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! let (mut buffer, mode) = (manipulator.solution(), manipulator.home_mode());
//! let pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
//! let at = manipulator.inverse(&pose, mode, &mut buffer)?.expect("a pose in reach");
//! let mut statics = Statics::new(&manipulator, manipulator.characteristic_length());
//! assert!(statics.update(at)?);
//!
//! // Ten newtons along x, and one newton metre about z.
//! let efforts = statics.efforts(&Wrench::from_components([10.0, 0.0, 0.0, 0.0, 0.0, 1.0]));
//! assert_eq!(efforts.balance, Balance::Balanced);
//! assert!(efforts.actuated.iter().all(Option::is_some));
//! // The moment about z passes through the imaginary joints, which all have vertical axes.
//! let about_z: f64 = efforts.imaginary.iter().flatten().sum();
//! assert!((about_z + 1.0).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod acceleration;
mod capacity;
mod dynamics;
mod efforts;
mod index;
mod path;
mod response;
mod screws;
mod setup;
mod simulation;
mod springs;
mod statics;
mod stiffness;
mod transmission;
mod vibration;
mod weights;
mod wrench;

pub use acceleration::AccelerationRadius;
pub use capacity::{Capacity, Facet};
pub use dynamics::Dynamics;
pub use efforts::{Balance, Efforts, Worst};
pub use index::{Facts, Index, IndexBounds, IndexError, Indices};
pub use path::{time_optimal, time_optimal_with_tool};
pub use response::{Damping, Response};
pub use screws::{Freedom, Screws};
pub use setup::{Loads, Setup};
pub use simulation::{LinearModel, SimulationError, State};
pub use springs::{SpringError, Springs};
pub use statics::{Statics, Velocity};
pub use stiffness::{Compliant, Reactions, Stiffness};
pub use transmission::{
    ConstraintIndex, InputIndices, NoTransmission, Transmission, Transmissions,
};
pub use vibration::Vibration;
pub use weights::{Gravity, JointMotion, Weights};
pub use wrench::{Load, LoadAxes, LoadPoint, Wrench};
