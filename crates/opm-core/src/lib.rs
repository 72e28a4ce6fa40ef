//! Kinematics of overconstrained parallel manipulators with partial subspaces, by imaginary-joint
//! decomposition.
//!
//! The platform moves in a product `A · B` of two subgroups of SE(3) that share one motion `I`. Each
//! leg is cut in two where it passes from one to the other, by an *imaginary joint* that moves along
//! `I`, and both halves have closed forms. The decomposition is found from the joint screws.
//!
//! ```
//! use opm_core::Manipulator;
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! assert_eq!(manipulator.decomposition().upper.name(), "spherical");
//!
//! // Every joint at a pose, in the working mode that the mechanism is assembled in.
//! let mut buffer = manipulator.solution();
//! let pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
//! let mode = manipulator.home_mode();
//! let solution = manipulator.inverse(&pose, mode, &mut buffer)?.expect("a pose in reach");
//! assert!(solution.within_limits());
//! assert!((solution.joints()[0] - 0.168806).abs() < 1e-6); // S1
//!
//! // The other way round: every pose that these actuated joints allow.
//! let joints = solution.joints();
//! let actuated: Vec<f64> = manipulator.actuated().iter().map(|&i| joints[i]).collect();
//! let found = manipulator.forward(&actuated)?;
//! assert!(found.list.iter().any(|assembly| {
//!     assembly.pose.iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-9)
//! }));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//!
//! * SI units and radians everywhere.
//! * Joints are given at one assembled pose, *home*. A reported value is the value at home plus the
//!   displacement; angles are within half a turn of home unless limits or a reference say otherwise.
//! * A twist is `(ω; v)` in base coordinates; `v` is the velocity of the point at the base's origin.
//! * Products of exponentials run from base to platform: `g = L · U = v · b`, `v` in the lower
//!   subspace `A`, `b` in the upper one, `B`.
//! * Task coordinates are named in [`task`], working modes in [`manipulator::Mode`].
//! * Out of reach is an answer, not an error; an error means that it cannot be computed. A pose on the
//!   boundary of reach, or on a limit, counts as inside.

// Layers: numeric, group, chain, mechanism, decomposition, task, manipulator, velocity, forward, motion,
// trajectory, enclosure, linkage, skeleton. Each uses only those before it (tests/layers.rs).
pub mod chain;
pub mod decomposition;
pub mod enclosure;
pub mod forward;
pub mod group;
pub mod linkage;
pub mod manipulator;
pub mod mechanism;
pub mod motion;
pub mod numeric;
pub mod skeleton;
pub mod task;
pub mod trajectory;
pub mod velocity;

pub use decomposition::{DecomposeError, Decomposition, decompose};
pub use linkage::Linkage;
#[cfg(feature = "files")]
pub use manipulator::ReadError;
pub use manipulator::{
    ActuatedJoints, AllModes, Batch, BatchError, BatchOutput, CompileError, Manipulator, Mode,
    PoseError, Solution, Unreachable,
};
pub use mechanism::Mechanism;
pub use mechanism::joint::{Joint, JointCoordinate, JointKind};
pub use mechanism::leg::{Leg, Section};
pub use motion::PlatformMotion;
pub use nalgebra;
pub use numeric::Quantity;
pub use skeleton::Skeleton;
pub use task::TaskCoordinate;
pub use trajectory::Trajectory;
pub use velocity::{Jacobians, JointMotion};
