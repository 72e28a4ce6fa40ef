//! Mechanisms as models of other programs.
//!
//! Formats for robots describe trees of bodies, and closed loops come to them second. opm knows the assembled pose,
//! every passive joint and every working mode, so it can write all of a parallel mechanism:
//!
//! * [`mjcf()`] writes the model format of MuJoCo, which other simulators read, too.
//! * [`urdf()`] writes the tree of links of ROS, and what closes its loops beside it.
//! * [`explorer()`] writes a page in which a browser shows the mechanism and its workspace.
//! * [`Keyframes`] are the postures of a mechanism at its home pose, one for each working mode, by name.
//!
//! Everything in a model is in metres, radians, kilograms and seconds, with all digits. The values of joints are
//! those that opm reports.
//!
//! ```
//! use opm_export::{Keyframes, MjcfOptions, mjcf};
//!
//! let manipulator = opm_core::Manipulator::example("planar-3rrr")?;
//! let keyframes = Keyframes::of_manipulator(&manipulator);
//! assert_eq!(keyframes.reached()[0].name, "p_p_p");
//! let model = mjcf(&keyframes, &MjcfOptions::default());
//! assert!(model.contains("<mujoco model=\"planar-3rrr\">"));
//! # Ok::<(), opm_core::ReadError>(())
//! ```

mod color;
mod keyframe;
mod mjcf;
mod names;
mod page;
mod urdf;
mod xml;

pub use keyframe::{Keyframe, Keyframes, Source};
pub use mjcf::{MjcfOptions, MjcfReference, ReferenceError, mjcf};
pub use page::explorer;
pub use urdf::{Urdf, urdf};
