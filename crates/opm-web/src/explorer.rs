//! The mechanism that is open: its file, its changes, and what is compiled from them.

use crate::changes;
use crate::problem::Problems;
use crate::request::{Changes, Coordinates};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::file::{self, FileUnits, MechanismFile};
use opm_core::skeleton::{ImaginaryJoints, Skeleton};
use std::sync::Arc;

/// A mechanism file, its changes, and the manipulator that it describes.
#[derive(Clone, Debug)]
pub struct Explorer {
    /// The file as it was opened: changes are changes of it, so that they can be undone in any order.
    original: Arc<MechanismFile>,
    file: MechanismFile,
    manipulator: Arc<Manipulator>,
    skeleton: Skeleton,
}

impl Explorer {
    /// Reads the text of a mechanism file, changes it and compiles it.
    pub fn open(text: &str, changes: &Changes) -> Result<Self, Problems> {
        Self::new(Arc::new(file::read(text)?), changes)
    }

    /// The same file with these changes in place of all others.
    pub fn changed(&self, changes: &Changes) -> Result<Self, Problems> {
        Self::new(Arc::clone(&self.original), changes)
    }

    fn new(original: Arc<MechanismFile>, changes: &Changes) -> Result<Self, Problems> {
        let file = changes::apply(&original, changes)?;
        let manipulator = Manipulator::new(file.mechanism.clone())
            .map_err(|error| Problems::of_compile(&error, &original))?;
        let joints = ImaginaryJoints {
            decomposition: manipulator.decomposition(),
            imaginary: manipulator.imaginary(),
        };
        let skeleton = Skeleton::new(manipulator.mechanism(), Some(joints));
        Ok(Self { original, file, manipulator: Arc::new(manipulator), skeleton })
    }

    /// The file with its changes.
    pub fn file(&self) -> &MechanismFile {
        &self.file
    }

    /// The units of the file.
    pub fn units(&self) -> FileUnits {
        self.file.units
    }

    /// The manipulator.
    pub fn manipulator(&self) -> &Arc<Manipulator> {
        &self.manipulator
    }

    /// The bodies to draw.
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// The working mode of a request.
    pub fn mode(&self, given: Option<&str>) -> Result<Mode, Problems> {
        match given {
            None => Ok(self.manipulator.home_mode()),
            Some(signs) => self.manipulator.parse_mode(signs).map_err(|error| Problems::of(&error)),
        }
    }

    /// The pose of a request, SI.
    pub fn pose(&self, given: &Coordinates) -> Result<Vec<f64>, Problems> {
        let coordinates = self.manipulator.task_coordinates();
        let si = given.iter().map(|(name, &value)| {
            let known = coordinates.iter().find(|c| c.name == name);
            (&**name, known.map_or(value, |c| self.units().si(value, c.quantity)))
        });
        self.manipulator.pose(si).map_err(|error| Problems::of(&error))
    }
}
