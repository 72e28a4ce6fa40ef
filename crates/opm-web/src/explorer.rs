//! The mechanism that is open: its file, its changes, and what is compiled from them.

use crate::changes;
use crate::problem::{ProblemKind, Problems};
use crate::request::{Changes, Coordinates};
use opm_core::manipulator::{Manipulator, Mode};
use opm_core::mechanism::file::{self, FileUnits, MechanismFile};
use opm_core::skeleton::{ImaginaryJoints, Skeleton};
use opm_interference::Interference;
use std::sync::{Arc, OnceLock};

/// A mechanism file, its changes, and the manipulator that it describes.
#[derive(Clone, Debug)]
pub struct Explorer {
    /// The name of the file.
    name: Arc<str>,
    /// The file as it was opened: changes are changes of it, so that they can be undone in any order.
    original: Arc<MechanismFile>,
    file: MechanismFile,
    manipulator: Arc<Manipulator>,
    skeleton: Skeleton,
    /// The shapes of the bodies, from the first pose on: sweeps need none.
    interference: OnceLock<Interference>,
}

impl Explorer {
    /// Reads the text of a mechanism file of this name, changes it and compiles it.
    pub fn open(name: &str, text: &str, changes: &Changes) -> Result<Self, Problems> {
        let file = file::read(text).map_err(|errors| Problems::from(errors).in_file(name))?;
        Self::new(name.into(), Arc::new(file), changes)
    }

    /// The same file with these changes in place of all others.
    pub fn changed(&self, changes: &Changes) -> Result<Self, Problems> {
        Self::new(Arc::clone(&self.name), Arc::clone(&self.original), changes)
    }

    fn new(
        name: Arc<str>,
        original: Arc<MechanismFile>,
        changes: &Changes,
    ) -> Result<Self, Problems> {
        let file = changes::apply(&original, changes).map_err(|wrong| wrong.in_file(&name))?;
        let manipulator = Manipulator::new(file.mechanism.clone())
            .map_err(|error| Problems::of_compile(&error, &original).in_file(&name))?;
        let joints = ImaginaryJoints {
            decomposition: manipulator.decomposition(),
            imaginary: manipulator.imaginary(),
        };
        let skeleton = Skeleton::new(manipulator.mechanism(), Some(joints));
        let manipulator = Arc::new(manipulator);
        Ok(Self { name, original, file, manipulator, skeleton, interference: OnceLock::new() })
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

    /// The shapes of the bodies and obstacles, and the pairs that may interfere.
    pub fn interference(&self) -> &Interference {
        self.interference.get_or_init(|| Interference::new(self.manipulator.mechanism()))
    }

    /// The working mode of a request.
    pub fn mode(&self, given: Option<&str>) -> Result<Mode, Problems> {
        match given {
            None => Ok(self.manipulator.home_mode()),
            Some(signs) => {
                let mode = self.manipulator.parse_mode(signs);
                mode.map_err(|error| Problems::of(&error).of_kind(ProblemKind::Mode))
            }
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
