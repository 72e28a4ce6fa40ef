//! A manipulator from the text of a mechanism file, or from one of the mechanisms that opm ships.

use super::{CompileError, Manipulator};
use crate::decomposition::DecomposeError;
use crate::mechanism::file::{Location, MechanismFile};
use crate::mechanism::{examples, file};
use crate::task::{OddJoint, TaskError};

/// Why a mechanism file does not give a manipulator.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The text does not describe a mechanism. The error lists every problem with its line and column.
    #[error(transparent)]
    File(#[from] file::FileErrors),
    /// The mechanism has no closed form.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// opm ships no mechanism of this name.
    #[error("no shipped mechanism is called {name:?}")]
    Example {
        /// The name that was given.
        name: String,
    },
}

impl Manipulator {
    /// Reads the text of a mechanism file, decomposes the mechanism and compiles it.
    ///
    /// # Errors
    /// Every problem of the file, or why the mechanism has no closed form.
    ///
    /// ```no_run
    /// use opm_core::Manipulator;
    ///
    /// let text = std::fs::read_to_string("mine.toml")?;
    /// let manipulator = Manipulator::read(&text)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(text: &str) -> Result<Self, ReadError> {
        Ok(Self::new(file::read(text)?.mechanism)?)
    }

    /// One of the mechanisms that opm ships, by its name ([`examples::EXAMPLES`] lists them).
    ///
    /// # Errors
    /// The name is not that of a shipped mechanism, or the mechanism has no closed form.
    ///
    /// ```
    /// use opm_core::Manipulator;
    ///
    /// let manipulator = Manipulator::example("plano-spherical-5dof")?;
    /// assert_eq!(manipulator.decomposition().upper.name(), "spherical");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn example(name: &str) -> Result<Self, ReadError> {
        match examples::find(name) {
            Some(example) => Self::read(example.text),
            None => Err(ReadError::Example { name: name.to_owned() }),
        }
    }
}

impl CompileError {
    /// The place of the file that the error is about, if it is known: a leg, or a value of `[task]`.
    pub fn location(&self, file: &MechanismFile) -> Option<Location> {
        let MechanismFile { mechanism, places, .. } = file;
        let of_leg = |leg: &str| {
            let number = mechanism.legs.iter().position(|known| known.name == leg);
            number.and_then(|number| places.legs.get(number)).copied()
        };
        match self {
            Self::Decompose(
                DecomposeError::SingularHome { order: Some(order), .. }
                | DecomposeError::NoPartialSubspaces { order: Some(order), .. },
            ) => order.changes.first().and_then(|change| of_leg(change.leg())),
            Self::Decompose(
                DecomposeError::NoFreedom { near: Some(near), .. }
                | DecomposeError::SingularHome { near: Some(near), .. }
                | DecomposeError::NoPartialSubspaces { near: Some(near), .. },
            ) => near.joints.first().and_then(|miss| of_leg(&miss.leg)),
            Self::Decompose(DecomposeError::NoPartialSubspaces { odd: Some(odd), .. }) => {
                of_leg(&odd.leg)
            }
            Self::Decompose(DecomposeError::NoPartialSubspaces {
                height: Some(height), ..
            }) => of_leg(&height.leg),
            Self::Decompose(DecomposeError::NoActuator { .. }) => places.legs.first().copied(),
            Self::Leg { leg, .. }
            | Self::Task(
                TaskError::Subspace { odd: Some(OddJoint { leg, .. }), .. }
                | TaskError::Height { odd: OddJoint { leg, .. }, .. }
                | TaskError::JointName { leg, .. },
            ) => of_leg(leg),
            Self::Constraint(error) => {
                let of_key = error.key().and_then(|key| places.of_task(key));
                of_key.or_else(|| error.leg().and_then(of_leg))
            }
            Self::Task(error) => error.key().and_then(|key| places.of_task(key)),
            _ => None,
        }
    }
}
