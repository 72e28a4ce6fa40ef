//! A manipulator from the text of a mechanism file, or from one of the mechanisms that opm ships.

use super::{CompileError, Manipulator};
use crate::mechanism::{examples, file};

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
