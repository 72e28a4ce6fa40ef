//! The closed-form kinematics of one mechanism as source code that depends on nothing.
//!
//! opm compiles a mechanism to closed forms at run time. A controller has one mechanism, and no room for a compiler: for
//! it, [`c()`] writes the closed forms of that mechanism as C99, a few hundred lines with the field's names, without heap
//! and global variables. [`rust()`], [`python()`], [`matlab()`] and [`st()`] write the same in other
//! languages, from one description.
//!
//! ```
//! let manipulator = opm_core::Manipulator::example("plano-spherical-5dof")?;
//! let code = opm_generate::c(&manipulator, opm_generate::Content::Kinematics)?;
//! assert_eq!(code.name, "plano_spherical_5dof");
//! assert!(code.header.contains("int plano_spherical_5dof_inverse("));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod c;
mod code;
mod dimensions;
mod golden;
mod library;
mod matlab;
mod names;
mod python;
mod rust;
mod st;
mod text;
mod trace;
mod tree;

pub use c::{CCode, c};
pub use matlab::matlab;
pub use python::python;
pub use rust::rust;
pub use st::st;

/// What the code of a mechanism computes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Content {
    /// Kinematics: joints and poses, and their rates.
    #[default]
    Kinematics,
    /// The inverse dynamics besides, with the masses of all bodies and the drives of the joints: efforts for feed-forward.
    Dynamics,
}

/// Whether the inverse dynamics of a mechanism can be written.
///
/// # Errors
/// Why they cannot.
pub fn check_dynamics(manipulator: &opm_core::Manipulator) -> Result<(), GenerateError> {
    code::Writer::new(manipulator, Content::Dynamics).map(drop)
}

/// The kinematics of one mechanism in a language: the files of a package.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Package {
    /// The mechanism's name, as an identifier.
    pub name: String,
    /// The names of the files, with `/` between folders, and what they hold.
    pub files: Vec<(String, String)>,
}

impl From<CCode> for Package {
    fn from(code: CCode) -> Self {
        let files = code.files().into_iter().map(|(name, text)| (name, text.to_owned())).collect();
        Self { name: code.name, files }
    }
}

/// Writes the kinematics of a mechanism in C99, as [`c()`] does, as the files of a package.
///
/// # Errors
/// The mechanism has more two-valued choices than an `unsigned` has bits.
pub fn c_package(
    manipulator: &opm_core::Manipulator,
    content: Content,
) -> Result<Package, GenerateError> {
    c(manipulator, content).map(Package::from)
}

/// Why no code can be written for a mechanism.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// There are more two-valued choices than an `unsigned` of C has bits.
    #[error(
        "the legs have {choices} two-valued choices, expected at most {most}: a working mode is one `unsigned` of C"
    )]
    Choices {
        /// The number of choices.
        choices: u32,
        /// The most that there may be.
        most: u32,
    },
    /// The orientation follows from the position, for which no code is written.
    #[error(
        "the orientation of the platform follows from its position (`independent` in [task]), for which no code is written: leave \
         `independent` out"
    )]
    Place,
    /// A leg slides a ball on a line, with a choice of its own.
    #[error(
        "a leg constrains the platform by a ball that slides on a line, for which no code is written"
    )]
    Rail,
    /// Inverse dynamics need as many actuated coordinates as there are degrees of freedom.
    #[error(
        "inverse dynamics: {actuators} actuated coordinates for {freedoms} degrees of freedom, expected as many: loads do not \
         determine the efforts of others; write the kinematics alone"
    )]
    Actuators {
        /// The number of actuated coordinates.
        actuators: usize,
        /// The number of degrees of freedom.
        freedoms: usize,
    },
    /// The friction of a spherical joint is about a rotation vector, for which no code is written.
    #[error(
        "inverse dynamics: the spherical joint {joint} has friction, for which no code is written: leave `viscous_friction` and \
         `coulomb_friction` of it out"
    )]
    BallFriction {
        /// The name of the joint.
        joint: String,
    },
    /// A leg with more than six freedoms has a part that turns by itself, for which no code is written.
    #[error(
        "inverse dynamics: leg {leg} has {freedoms} freedoms, expected at most 6, as a rod between two spherical joints turns about \
         itself: make one of them universal, or write the kinematics alone"
    )]
    Idle {
        /// The name of the leg.
        leg: String,
        /// The number of its freedoms.
        freedoms: usize,
    },
    /// The closed forms have what the other languages do not know: this is a defect of opm.
    #[error("the closed forms cannot be written in this language, which is a defect of opm: {0}")]
    Unread(String),
}
