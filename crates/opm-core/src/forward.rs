//! Forward kinematics: every pose of the platform that given actuated joints allow.
//!
//! The decomposition gives the order in which unknowns are found. With `L · U = v · b` and a leg's
//! displacement τ along the intersection motion `I`:
//!
//! 1. Some legs fix `v` up to `I`: one whose lower joints are all actuated, two that keep the axis of `I`
//!    on a track each, or legs whose imaginary joints are coupled (`manipulator/plan.rs`).
//! 2. With `v` known, an actuated joint in a leg's lower section is one equation in the leg's τ
//!    (`forward/along.rs`): a link swings onto a circle or a line, or an axis rotates onto a cone.
//! 3. With τ known, each leg is one condition on `b` (`chain/condition.rs`). As many conditions as the
//!    upper section has degrees of freedom fix `b` (`forward/three.rs`: at most eight solutions in a
//!    spherical subspace, six in a planar one).
//!
//! All solutions of each of these small problems are found, so that their combinations are all
//! assemblies. Where displacements commute in both sections, the whole problem is one linear system
//! (`manipulator/plan/flat.rs`).
//!
//! Where there is no such order, but the platform only translates, as that of a Delta, legs are spheres or planes
//! (`manipulator/continued/translations.rs`). Elsewhere, as of a hexapod, all legs are equations in the platform's Study parameters, and all solutions,
//! complex ones too, are found by continuation (`manipulator/continued.rs`). [`Manipulator::forward_near`] finds the one near a pose
//! in every mechanism.
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
mod assemble;
mod candidates;
mod certified;
mod distance;
mod families;
mod held;
mod least;
mod matches;
mod near;
mod nearest;
mod newton;
mod search;
mod solve;
mod three;
mod trigonometric;

pub use crate::manipulator::NoClosedForm;
pub use certified::{Certificate, Proof};
pub use families::Family;
pub use least::LeastChange;
pub use near::{NearError, NearStop, NotFound};
pub use newton::NearBuffer;

use crate::manipulator::Continued;
use crate::manipulator::{LARGEST, Manipulator, Mode, Section, Unreachable};
use search::{Memory, Search};
use std::sync::Arc;

/// The largest residual of an assembly, in radians and shares of the mechanism's size, where the joints are
/// exactly in their subspaces. A candidate with a larger residual does not close, and is rejected. Where joints
/// miss their subspaces by a [`deviation`](crate::decomposition::Decomposition::deviation), legs close to some
/// multiple of that at best; where axes are tens of sizes away from the origin, to the rounding of these distances.
pub const RESIDUAL: f64 = 1e-12;

/// The largest residual in multiples of the deviation: what six joints add up to, with a margin.
const DEVIATIONS: f64 = 20.0;

/// One assembly of the mechanism for given actuated joints. See the example in the docs of
/// [`forward`](crate::forward).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Assembly {
    /// The task coordinates, in the order of [`Manipulator::task_coordinates`], metres and radians. Angles
    /// are within π of home.
    pub pose: Vec<f64>,
    /// The dependent coordinates, in the order of [`Manipulator::dependent_coordinates`], metres and radians.
    pub dependent: Vec<f64>,
    /// The working mode of the assembly: [`Manipulator::inverse`] at this pose and in this mode gives the
    /// actuated joints back.
    pub mode: Mode,
    /// The values of all joint coordinates, in the order of [`Manipulator::coordinates`], radians and
    /// metres. Angles have the full revolutions that [`Manipulator::inverse`] gives them.
    pub joints: Vec<f64>,
    /// The values of all imaginary joints, in the order of [`Manipulator::imaginary`], radians and metres.
    pub imaginary: Vec<f64>,
    /// Whether all joint coordinates are within their limits.
    pub within_limits: bool,
    /// How far the legs fail to close: the largest distance between the platform and the end of a leg, which
    /// is computed as a product of exponentials of all joints. It is the angle between the two, in radians,
    /// plus the distance of their reference points over the mechanism's size.
    pub residual: f64,
}

/// The assemblies for given actuated joints, or why there are none. See the example in the docs of
/// [`forward`](crate::forward).
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Assemblies {
    /// All assemblies. [`Manipulator::sort_assemblies`] puts those nearest to a pose first.
    pub list: Vec<Assembly>,
    /// Why the mechanism cannot be assembled; empty if there is an assembly.
    pub unmet: Vec<Unmet>,
    /// The sections that can move while the actuated joints are held, because they are at a singularity.
    /// The poses of that motion are not listed.
    pub loose: Vec<Section>,
    /// How complete the list is.
    pub completeness: Completeness,
}

/// How complete a list of assemblies is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Completeness {
    /// All solutions were found in closed form.
    #[default]
    ClosedForm,
    /// The equations were solved by continuation. With probability one, every isolated assembly is in the list if all solutions
    /// were found. The others are where the platform can move with its actuated joints held, or several assemblies meet, or far away.
    Continuation {
        /// How many solutions were found, complex ones too.
        found: usize,
        /// How many there are for actuated joints in general.
        of: usize,
    },
}

/// How all assemblies of a mechanism are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForwardMethod {
    /// In closed form.
    ClosedForm,
    /// By continuation, which takes milliseconds, and some tenths of a second for the first ones.
    Continuation,
}

/// Working memory of [`Manipulator::forward_into`]; made by [`Manipulator::forward_buffer`]. See the example there.
#[derive(Clone, Debug)]
pub struct ForwardBuffer {
    /// The displacements of the actuated joints from home, radians and metres.
    displacements: Vec<f64>,
    memory: Memory,
}

/// Why the mechanism cannot be assembled. [`Manipulator::least_change`] tells by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Unmet {
    /// A leg cannot reach what the others have fixed. The value has its smallest deficit.
    Leg(Unreachable),
    /// The two legs with these numbers, which together fix the lower section, do not meet.
    Legs([usize; 2]),
    /// Each leg of the section closes alone, but no pose of the platform closes all of them.
    Section(Section),
    /// No pose of the platform closes all legs at once.
    Together,
    /// There are more actuated joints than degrees of freedom, and they contradict each other.
    Contradiction,
}

/// Why forward kinematics cannot be computed for given joint values.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ForwardError {
    /// The number of values is not the number of actuated joint coordinates.
    #[error("{given} values of actuated joints, expected {expected}")]
    Length {
        /// The number of values.
        given: usize,
        /// The number of actuated joint coordinates.
        expected: usize,
    },
    /// A value is not a number, infinite, or too large.
    #[error("{name} is {value:?}, expected a number of at most {LARGEST:?}")]
    NotFinite {
        /// The name of the joint coordinate.
        name: String,
        /// Its value.
        value: f64,
    },
    /// The mechanism's forward kinematics have no closed form here.
    #[error("no closed form of the forward kinematics: {0}")]
    NoClosedForm(#[from] NoClosedForm),
}

/// The same of legs that are solved whole, which close to within [`CLOSURE`](crate::chain::whole::CLOSURE).
const OF_WHOLE: f64 = 1e-10;

impl Manipulator {
    /// The largest residual of an assembly of this mechanism.
    fn largest_residual(&self) -> f64 {
        let of_deviation = DEVIATIONS * self.decomposition().deviation;
        let of_whole = if self.is_whole() { OF_WHOLE } else { 0.0 };
        RESIDUAL.max(of_deviation).max(self.closure.rounding).max(of_whole)
    }

    /// Whether the forward kinematics have a closed form, and if not, why.
    ///
    /// # Errors
    /// The reason why there is no closed form.
    pub fn forward_closed_form(&self) -> Result<(), NoClosedForm> {
        self.plan.as_ref().map(|_| ()).map_err(|error| *error)
    }

    /// How [`Manipulator::forward`] finds all assemblies. The first call for a mechanism without a closed form takes some tenths
    /// of a second.
    ///
    /// # Errors
    /// Why it cannot: there is no closed form, and what the legs demand are no quadratic equations of the platform's Study
    /// parameters.
    pub fn forward_method(&self) -> Result<ForwardMethod, NoClosedForm> {
        match &self.plan {
            Ok(_) => Ok(ForwardMethod::ClosedForm),
            Err(why) => self.continued(*why).map(|continued| match continued.is_closed() {
                true => ForwardMethod::ClosedForm,
                false => ForwardMethod::Continuation,
            }),
        }
    }

    fn continued(&self, why: NoClosedForm) -> Result<&Continued, NoClosedForm> {
        // The explorer's page has to stay small, and does without it.
        if cfg!(target_family = "wasm") {
            return Err(why);
        }
        let made = || Continued::new(self).map(Arc::new);
        self.continued.get_or_init(made).as_deref().ok_or(why)
    }

    /// Every assembly that the actuated joints allow, by the [method](Manipulator::forward_method) that the mechanism
    /// has. `actuated` has the values in the order of [`Manipulator::actuated`], radians and metres. If there is no
    /// assembly, [`Assemblies::unmet`] says why; that is not an error. By continuation a pose is listed once: of the
    /// joints that a leg can have there, those within limits, and else those of home's mode
    /// ([`Manipulator::assembly_in`] has the others).
    ///
    /// Angles count modulo 2π, unless a screw makes full revolutions matter. Inverse kinematics do not
    /// determine the full revolutions of a revolute joint in a plane that passes its rotation on to a screw:
    /// each of them is another assembly, one advance of the screw away. The assembly given here has the full
    /// revolutions that `actuated` has from home, and passive joints within π.
    ///
    /// Joint values on the boundary of reach, to within rounding, are allowed. At a parallel singularity two
    /// assemblies merge. They are listed as one, or as two that differ by about the square root of rounding.
    ///
    /// # Errors
    /// If there are too few or too many values, if one is not a finite number, or if the mechanism has no
    /// closed form.
    pub fn forward(&self, actuated: &[f64]) -> Result<Assemblies, ForwardError> {
        let mut buffer = self.forward_buffer();
        self.forward_into(actuated, &mut buffer)?;
        Ok(buffer.memory.outcome.assemblies)
    }

    /// A buffer for [`Manipulator::forward_into`].
    pub fn forward_buffer(&self) -> ForwardBuffer {
        ForwardBuffer { displacements: Vec::new(), memory: Memory::new(self) }
    }

    /// Does the same as [`Manipulator::forward`] with a buffer, which gets the assemblies. To use it again for many sets of
    /// joints saves most allocations.
    ///
    /// # Errors
    /// As [`Manipulator::forward`].
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("planar-3rrr")?;
    /// let mut buffer = manipulator.forward_buffer();
    /// let home: Vec<f64> =
    ///     manipulator.actuated().iter().map(|&i| manipulator.coordinates()[i].home).collect();
    /// for step in 0..10 {
    ///     let actuated = [home[0] + 0.01 * f64::from(step), home[1], home[2]];
    ///     let assemblies = manipulator.forward_into(&actuated, &mut buffer)?;
    ///     assert!(assemblies.list.iter().all(|assembly| assembly.residual < 1e-12));
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn forward_into<'a>(
        &self,
        actuated: &[f64],
        buffer: &'a mut ForwardBuffer,
    ) -> Result<&'a Assemblies, ForwardError> {
        let ForwardBuffer { displacements, memory } = buffer;
        self.write_displacements(actuated, displacements)?;
        match &self.plan {
            Ok(plan) => Search::new(self, plan, displacements, memory).run(),
            Err(why) => {
                let continued = self.continued(*why)?;
                memory.outcome.assemblies = self.assemblies_by(continued, displacements);
            }
        }
        Ok(&memory.outcome.assemblies)
    }

    /// Writes the displacements of the actuated joints from home, radians and metres.
    fn write_displacements(
        &self,
        actuated: &[f64],
        displacements: &mut Vec<f64>,
    ) -> Result<(), ForwardError> {
        let expected = self.actuated().len();
        if actuated.len() != expected {
            return Err(ForwardError::Length { given: actuated.len(), expected });
        }
        displacements.clear();
        for (&value, &coordinate) in actuated.iter().zip(self.actuated()) {
            let c = &self.coordinates()[coordinate];
            if value.is_nan() || value.abs() > LARGEST {
                return Err(ForwardError::NotFinite { name: c.name.clone(), value });
            }
            displacements.push(value - c.home);
        }
        Ok(())
    }
}
