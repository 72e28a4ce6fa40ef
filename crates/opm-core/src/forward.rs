//! Forward kinematics: every pose of the platform that given actuated joints allow.
//!
//! The decomposition gives the order. With `L · U = v · b` and a leg's displacement τ along the
//! intersection motion `I`,
//!
//! 1. some legs fix `v` up to `I`: one whose lower joints are all actuated, two that keep the axis of `I`
//!    on a track each, or legs whose imaginary joints move as one (`manipulator/plan.rs`);
//! 2. with `v` known, an actuated joint in a leg's lower section is one equation in the leg's τ
//!    (`forward/along.rs`): a link that swings onto a circle or a line, an axis that turns onto a cone;
//! 3. with τ known, each leg is one condition on `b` (`chain/condition.rs`), and as many as the upper
//!    section has freedoms fix it (`forward/three.rs`: at most eight solutions in a sphere, six in a plane).
//!
//! Each is a small problem with all of its solutions, so that their combinations are all assemblies. Where
//! both sections add up, everything is one linear system (`manipulator/plan/flat.rs`). A mechanism without such an
//! order is solved by [`Manipulator::forward_near`] from a pose.
//!
//! ```
//! use opm_core::Manipulator;
//!
//! let manipulator = Manipulator::example("plano-spherical-5dof")?;
//! let (mode, mut buffer) = (manipulator.home_mode(), manipulator.solution());
//! let pose = manipulator.pose([("x", 0.01), ("xi", 15_f64.to_radians())])?;
//! let solution = manipulator.inverse(&pose, mode, &mut buffer)?.expect("a pose in reach");
//! let actuated: Vec<f64> = manipulator.actuated().iter().map(|&i| solution.joints()[i]).collect();
//!
//! // Every assembly with these actuated joints. The pose that they were computed from is one.
//! let assemblies = manipulator.forward(&actuated)?;
//! let close = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-6);
//! assert!(assemblies.list.iter().any(|assembly| close(&assembly.pose, &pose)));
//! assert!(assemblies.unmet.is_empty());
//!
//! // Inverse kinematics at an assembly give its joints back.
//! for assembly in &assemblies.list {
//!     let again = manipulator.inverse(&assembly.pose, assembly.mode, &mut buffer)?;
//!     assert!(close(again.expect("an assembled pose").joints(), &assembly.joints));
//! }
//!
//! // Newton's method finds the one assembly near a pose, here near home.
//! let near = manipulator.forward_near(&actuated, &manipulator.pose([])?, mode)?;
//! assert!(close(&near.pose, &pose));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod accept;
mod along;
mod near;
mod search;
mod three;
mod trigonometric;

pub use crate::manipulator::NoClosedForm;
pub use near::{NearError, NotFound, Stop};

use crate::manipulator::{LARGEST, Manipulator, Mode, Section, Unreachable};
use search::Search;

/// The largest residual of an assembly, in radians and sizes. What is off by more does not close.
pub const RESIDUAL: f64 = 1e-12;

/// One way in which the mechanism can be assembled for given actuated joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembly {
    /// Task coordinates, in the order of [`Manipulator::task_coordinates`]; angles within half a turn of
    /// home.
    pub pose: Vec<f64>,
    /// The working mode that it is in: [`Manipulator::inverse`] at this pose in this mode gives back the
    /// actuated joints.
    pub mode: Mode,
    /// Every joint coordinate, in the order of [`Manipulator::coordinates`]; radians and metres, angles
    /// at the turns that [`Manipulator::inverse`] gives.
    pub joints: Vec<f64>,
    /// Every imaginary joint, in the order of [`Manipulator::imaginary`]; radians and metres.
    pub imaginary: Vec<f64>,
    /// All joint coordinates are within their limits.
    pub within_limits: bool,
    /// How far the legs fail to close: the largest distance of a leg's end, by the product of exponentials
    /// of the joints as they stand in the mechanism, from the platform. Radians of the rotation plus the
    /// way of the reference point over the mechanism's size.
    pub residual: f64,
}

/// What given actuated joints allow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Assemblies {
    /// All of them.
    pub list: Vec<Assembly>,
    /// Where there is none: what does not meet.
    pub unmet: Vec<Unmet>,
    /// Sections that the actuated joints leave loose: the mechanism is on a singularity through which it
    /// moves with them held. The poses of that motion are not listed.
    pub loose: Vec<Section>,
}

/// What does not meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unmet {
    /// A leg does not reach what the others have fixed, nowhere: by how much at the least.
    Leg(Unreachable),
    /// Two legs that fix the lower section do not meet.
    Legs([usize; 2]),
    /// The legs close one by one, but not all at once with one platform.
    Section(Section),
    /// There are more actuated joints than freedoms, and they contradict each other: where that is least, one
    /// is off by so much, radians or shares of the size (infinite where a leg does not even reach).
    Contradiction(f64),
}

/// Joint values that cannot be computed with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ForwardError {
    /// Another number of values than there are actuated joints.
    #[error("{given} actuated joints, expected {expected}")]
    Length {
        /// How many were given.
        given: usize,
        /// How many there are.
        expected: usize,
    },
    /// Not a number, infinite, or too large.
    #[error("{name} is {value:?}, expected a number of at most {LARGEST:?}")]
    NotFinite {
        /// The joint.
        name: String,
        /// Its value.
        value: f64,
    },
    /// The mechanism's forward kinematics have no closed form here.
    #[error("no closed form of the forward kinematics: {0}")]
    NoClosedForm(#[from] NoClosedForm),
}
impl Manipulator {
    /// Whether [`Manipulator::forward`] has a closed form, and if not, why.
    ///
    /// # Errors
    /// What is in the way.
    pub fn forward_closed_form(&self) -> Result<(), NoClosedForm> {
        self.plan.as_ref().map(|_| ()).map_err(|error| *error)
    }

    /// Every assembly that the actuated joints allow, in closed form; `actuated` in the order of
    /// [`Manipulator::actuated`], radians and metres. None is an answer: `unmet` says what is in the way.
    ///
    /// Angles count modulo a turn, unless a screw makes their turns matter. Inverse kinematics do not tell
    /// the turns of a revolute in a plane that hands them on to a screw: each is an assembly of its own, an
    /// advance of the screw away. The one given is at the turns that `actuated` has from home, passive
    /// joints within half a turn.
    ///
    /// Joint values on the verge of what they allow, to within rounding, are allowed. On a parallel
    /// singularity two assemblies merge; they are given as one, or as two within the root of rounding.
    ///
    /// # Errors
    /// Values that cannot be computed with, or a mechanism without a closed form.
    pub fn forward(&self, actuated: &[f64]) -> Result<Assemblies, ForwardError> {
        let amounts = self.held_amounts(actuated)?;
        let plan = self.plan.as_ref().map_err(|error| *error)?;
        let mut search = Search::new(self, plan, &amounts);
        search.run();
        Ok(search.finish())
    }

    /// Displacements of the actuated joints from home.
    fn held_amounts(&self, actuated: &[f64]) -> Result<Vec<f64>, ForwardError> {
        let expected = self.actuated().len();
        if actuated.len() != expected {
            return Err(ForwardError::Length { given: actuated.len(), expected });
        }
        let coordinates = self.actuated().iter().map(|&c| &self.coordinates()[c]);
        actuated
            .iter()
            .zip(coordinates)
            .map(|(&value, c)| {
                if value.is_nan() || value.abs() > LARGEST {
                    return Err(ForwardError::NotFinite { name: c.name.clone(), value });
                }
                Ok(value - c.home)
            })
            .collect()
    }
}
