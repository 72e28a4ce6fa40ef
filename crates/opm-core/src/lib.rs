//! Kinematics of overconstrained parallel manipulators with partial subspaces, by imaginary-joint
//! decomposition.
//!
//! The crate solves inverse, forward and velocity kinematics of such manipulators in closed form, finds
//! their singularities, and checks trajectories. It reads a mechanism from a file or from Rust code and
//! finds the decomposition from the joint screws.
//!
//! The platform moves in a product `A · B` of two subgroups of SE(3) that share a one-dimensional motion
//! `I`. Each leg is split in two where it passes from one subgroup to the other, by an *imaginary joint*
//! that moves along `I`, and both sections have closed forms. If all legs move in one subgroup, there is
//! nothing to split: `B` is the identity.
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
//! // Forward kinematics: every pose that these actuated joints allow.
//! let joints = solution.joints();
//! let actuated: Vec<f64> = manipulator.actuated().iter().map(|&i| joints[i]).collect();
//! let found = manipulator.forward(&actuated)?;
//! assert!(found.list.iter().any(|assembly| {
//!     assembly.pose.iter().zip(&pose).all(|(a, b)| (a - b).abs() < 1e-9)
//! }));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules
//!
//! | module | what it holds |
//! |---|---|
//! | [`mechanism`] | the description of a mechanism: legs, joints, files, parametric families, examples |
//! | [`decomposition`] | mobility, partial subspaces, and where each leg is split |
//! | [`task`] | task coordinates: how a pose is written |
//! | [`manipulator`] | a compiled mechanism; inverse kinematics of one pose and of many, working modes |
//! | [`reach`] | what sweeps ask: branches of a slice, regions, rows, the decision of many poses |
//! | [`forward`] | forward kinematics: the poses for given actuated joints |
//! | [`velocity`] | joint and platform velocities and accelerations, Jacobians, singularities |
//! | [`motion`] | motions of the platform: splines, tables, motion files |
//! | [`trajectory`] | joint values along a motion, and violations of limits |
//! | [`linkage`] | single loops of two sections, such as Bennett's and Sarrus' linkages |
//! | [`skeleton`] | a mechanism as lines and solids, for drawing |
//! | [`chain`] | closed forms of serial chains in one subspace |
//! | [`group`] | subgroups of SE(3), their displacements, screws |
//! | [`numbers`] | what closed forms are written over: numbers of one pose, of boxes, of source code
//! | [`numeric`] | angles, rotations, quantities, small numerical methods |
//!
//! # Features
//!
//! | feature | what it adds |
//! |---|---|
//! | `files` (default) | reading and writing mechanism and motion files, and the shipped examples |
//! | `schema` | JSON schemas of these files |
//! | `serde` | `Serialize` for results and mechanisms |
//!
//! # Conventions
//!
//! * SI units and radians everywhere.
//! * Joints are given at one assembled pose, *home*. A reported value is the value at home plus the
//!   displacement; angles are within π of home unless limits or a reference value require otherwise.
//! * A twist is `(ω; v)` in base coordinates; `v` is the velocity of the body's point at the base's origin.
//! * Products of exponentials run from base to platform: `g = L · U = v · b`, `v` in the lower
//!   subspace `A`, `b` in the upper one, `B`.
//! * Task coordinates are named in [`task`], working modes in [`manipulator::Mode`].
//! * A pose out of reach is an answer (`None`), not an error; an error means that the input is not valid.
//!   A pose on the boundary of reach, or on a limit, counts as inside.

// Layers: mechanism, decomposition, task, manipulator, reach, velocity, forward, motion, trajectory, enclosure, linkage,
// skeleton. Each uses only those before it, and the modules of opm-geometry and opm-mechanism (tests/tests/layers.rs).
pub mod decomposition;
// Public for the sibling crates of the workspace only.
#[doc(hidden)]
pub mod enclosure;
pub mod forward;
pub mod linkage;
pub mod manipulator;
pub mod mechanism;
pub mod motion;
pub mod reach;
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
#[doc(inline)]
pub(crate) use opm_geometry::boxes;
pub use opm_geometry::{chain, group, numbers, numeric, text};
#[doc(inline)]
pub use opm_mechanism::table;
pub use skeleton::Skeleton;
pub use task::TaskCoordinate;
pub use trajectory::Trajectory;
pub use velocity::{Jacobians, JointMotion};
